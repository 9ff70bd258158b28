"""Symbols: free names for the variables that a route needs beyond those of a spec.

Comes in: a Spec and the names that a reader would like to see. Goes out: these names, or ones near
them where the spec has taken some. Read next: `coadjoint.derive.routes.clebsch`.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count

from coadjoint.spec import Parameter, Spec, Variable
from coadjoint.spec.model import Input, Jet, Time


def choose_names(spec: Spec, names: Sequence[str]) -> tuple[str, ...]:
    """The names, or all of them with one ending if the spec has one of them already.

    >>> from coadjoint.spec import read_spec
    >>> from coadjoint.resources import derivations_folder
    >>> spec = read_spec(derivations_folder() / "rigid_body.toml")
    >>> choose_names(spec, ["Q1", "Q2"]), choose_names(spec, ["I0", "I1"])
    (('Q1', 'Q2'), ('I0_0', 'I1_0'))
    """
    quantities: list[Variable | Parameter | Input | Time | Jet] = [
        *spec.variables,
        *spec.parameters,
        *spec.driving,
        *spec.jets,
    ]
    taken = {name for each in quantities for name in (each.name, *each.components)}
    if not taken & set(names):
        return tuple(names)
    for n in count():
        numbered = [f"{name}_{n}" for name in names]
        if not taken & set(numbered):
            return tuple(numbered)
    raise AssertionError("some number is free")
