"""Mechanics: what the routes share: frames, constraints, momenta, forces, the mass matrix.

Read next: `coadjoint.derive.mechanics.frames`.
"""
