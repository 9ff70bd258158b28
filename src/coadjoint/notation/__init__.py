"""Notation: formulas as a small tree of pieces, written in every format at once.

Read `coadjoint.notation.written` first, then `coadjoint.notation.names`; `coadjoint.notation.trees`
and `coadjoint.notation.elements` write the trees of specs and the elements of fields.
"""
