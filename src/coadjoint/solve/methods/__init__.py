"""Methods that keep the structure of a motion, in NumPy: one module each.

Read next: `coadjoint.solve.steps`, with what all methods share.
"""
