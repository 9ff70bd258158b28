"""Core: what every table of a spec is read with: text, positions, expressions, shapes, units.

Read next: `coadjoint.spec.core.expressions`.
"""
