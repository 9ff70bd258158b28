"""What the page of a field on a surface shows: a plane, or entries of matrices on sphere or torus.

Comes in: a Spec and the context of its family. Goes out: what the page transforms by.
Read next: `coadjoint.solve.matrix_functions`, the functions that matrices stand for.
"""

from __future__ import annotations

from typing import Any

from coadjoint.explore.records import refuse
from coadjoint.families import Torus
from coadjoint.render.families import FamilyContext
from coadjoint.solve.matrix_functions import find_towers
from coadjoint.spec import Spec
from coadjoint.spec.core import tree
from coadjoint.spec.core.expressions import read_expression

#: Digits of the weights by which a matrix becomes colours on a sphere.
DIGITS = 7


def describe_surface(spec: Spec, context: FamilyContext) -> dict[str, Any]:
    """The surface and what the page computes on it; empty for what is no field on one.

    Raises:
        KernelArgumentError: Nobody has said how many points the plane has.
    """
    if context.torus is not None:
        return {"kind": "surface", "surface": "plane", "plane": _describe_plane(spec, context)}
    if not context.index.of_rows:
        return {}
    rows = context.index.size or context.small
    return {
        "kind": "surface",
        "surface": context.index.surface,
        "matrix": rows,
        "towers": _list_towers(rows) if context.index.surface == "sphere" else [],
    }


def _describe_plane(spec: Spec, context: FamilyContext) -> dict[str, Any]:
    """The points of a plane, and where derivatives come from in the order of the kernels."""
    torus = context.torus
    assert torus is not None, "asked for of planes alone"
    if None in torus.sizes:
        sizes = " ".join(f"--size {name}=32" for name in torus.coordinates)
        raise refuse(
            spec, "nobody has said how many points its plane has", f"sizes in [space], or {sizes}"
        )
    shared = [name for each in context.shared for name in each.components]
    (solved,) = torus.solved
    return {
        "counts": list(torus.sizes),
        "coordinates": list(torus.coordinates),
        "lengths": [shared.index(name) for name in torus.lengths],
        "derivatives": [
            [int(torus.derivatives[name][0] == solved), *torus.derivatives[name][1:]]
            for each in context.indexed
            for name in each.components
        ],
        "operator": _list_factors(torus, shared),
    }


def _list_factors(torus: Torus, shared: list[str]) -> list[list[Any]]:
    """Orders along both coordinates, and the factor of that derivative as nested lists."""
    ((_, operator),) = torus.solved.values()
    return [[i, j, _nest(read_expression(text), shared)] for (i, j), text in operator.items()]


def _nest(node: tree.Node, shared: list[str]) -> Any:
    """An expression in parameters: numbers, rows of parameters and operations on two parts."""
    match node:
        case tree.Number(value=value):
            return float(value)
        case tree.Name(name=name):
            return {"row": shared.index(name)}
        case tree.Negate(operand=operand):
            return ["-", 0.0, _nest(operand, shared)]
        case tree.Binary(operator=operator, left=left, right=right):
            return [operator, _nest(left, shared), _nest(right, shared)]
        case tree.Power(base=base, exponent=exponent):
            return ["^", _nest(base, shared), exponent]
        case tree.Call(function=function, arguments=(argument,)):
            return [function, _nest(argument, shared), 0.0]
    raise AssertionError(node)


def _list_towers(rows: int) -> list[list[list[float]]]:
    """By order and degree the weights of entries on a diagonal, rounded for colours."""
    return [
        [[float(f"{value:.{DIGITS}g}") for value in row] for row in towers]
        for towers in find_towers(rows)
    ]
