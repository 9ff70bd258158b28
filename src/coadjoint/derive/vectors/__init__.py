"""Equations of motion by whole vectors and matrices, recognised in what a route derived.

Read `coadjoint.derive.vectors.recognise` first.
"""

from coadjoint.derive.vectors.form import vector_form
from coadjoint.derive.vectors.lines import VectorForm, VectorLine

__all__ = ["VectorForm", "VectorLine", "vector_form"]
