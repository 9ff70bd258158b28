"""Building: C text becomes a loaded library, through a compiler and a verified private cache.

Comes in: a generated folder. Goes out: functions to call. Read next: `coadjoint.build.library`.
"""
