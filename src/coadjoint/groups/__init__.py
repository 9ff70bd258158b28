"""Group actions that derivations and proofs use: quaternions, vector fields, Galilean motions.

Comes in: components of anything that adds and multiplies. Goes out: rotations, Lie derivatives,
transformed states. Groups with AD, Ad, ad and their duals are theory for library users, in
`coadjoint.theory`. Read next: `coadjoint.groups.quaternions`, `coadjoint.groups.vector_fields`.
"""
