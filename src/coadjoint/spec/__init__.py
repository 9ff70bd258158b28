"""Specs: a TOML file to a checked `Spec`; no SymPy, no NumPy, and nothing of a text is executed.

Read next: `coadjoint.spec.reader`, which has the order of the steps, then
`coadjoint.spec.core.expressions`.
"""

from coadjoint.spec.core import tree
from coadjoint.spec.core.shapes import FUNCTIONS
from coadjoint.spec.model import (
    Formula,
    Observable,
    Parameter,
    Poisson,
    Shape,
    Spec,
    Variable,
    component_names,
    unpack,
)
from coadjoint.spec.reader import read_spec, read_spec_text
from coadjoint.spec.schema import json_schema

__all__ = [
    "FUNCTIONS",
    "Formula",
    "Observable",
    "Parameter",
    "Poisson",
    "Shape",
    "Spec",
    "Variable",
    "component_names",
    "json_schema",
    "read_spec",
    "read_spec_text",
    "tree",
    "unpack",
]
