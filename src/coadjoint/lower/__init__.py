"""Lowering: Equations become Programs, straight-line statements without a language.

Read next: `coadjoint.lower.program` for the record, `coadjoint.lower.lowering` for the way to it.
"""
