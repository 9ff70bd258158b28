"""Fields: variables along a coordinate of space, as differential polynomials and on a grid.

Derivatives along space, the jets of the fields, are symbols of the exact field, so that routes and
proofs are those of finite systems with one more derivation. Read next:
`coadjoint.derive.fields.jets`.
"""
