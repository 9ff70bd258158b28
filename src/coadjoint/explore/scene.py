"""What the page of a system shows: chosen by its records, and never by its name.

Comes in: a Spec and what was rendered of it. Goes out: plain values for the page. They say which
rows are the angular velocity, the attitude, the vertical, a place, an arm; the page finds lengths
and shapes by the generated functions: the surface of a body that rolls is where its arm ends.
Read next: `coadjoint.explore.page`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Final

from coadjoint.declared import KernelContext, Quantity
from coadjoint.explore.families import describe_family
from coadjoint.explore.records import describe, list_quantities, refuse
from coadjoint.lower import normals
from coadjoint.lower.compositions import SPLITTINGS, list_schedules
from coadjoint.methods import JudgedMethod
from coadjoint.pipeline import Rendered
from coadjoint.solve.methods.spherical_midpoint import NEAR, ROUNDINGS
from coadjoint.solve.stochastic import SOLVED
from coadjoint.spec import Spec
from coadjoint.spec.model import Variable

#: Rows of a state at the most that a page shows by its first three where it knows nothing better.
PORTRAIT: Final = 40

Rows = dict[str, Any]


def describe_scene(spec: Spec, rendered: Rendered) -> dict[str, Any]:
    """All that the page of a system is told.

    Raises:
        KernelArgumentError: It shows no such system.
    """
    if rendered.family is not None:
        return describe_family(spec, rendered.family.context, rendered)
    context = rendered.context
    assert context is not None
    finder = _Finder(context)
    return {
        **describe(spec, rendered),
        "tables": {
            "state": list_quantities(context.state, spec),
            "parameters": list_quantities(context.parameters, spec),
            "inputs": list_quantities(context.inputs, spec),
            "observables": list_quantities(context.observables, spec),
            "reconstructed": list_quantities(context.reconstructed, spec),
        },
        "functions": [each.name for each in context.programs],
        "takes": {each.name: list(each.arrays) for each in context.programs},
        "sizes": {each.name: len(each.outputs) for each in context.programs},
        "time": bool(context.time),
        "domain": [{"name": each.label, "strict": each.strict} for each in context.domain],
        "members": 0,
        "methods": _describe_methods(context.methods, context),
        "noise": _describe_noise(spec),
        **_choose(spec, finder, rendered),
    }


def _describe_noise(spec: Spec) -> dict[str, Any] | None:
    """The Wiener processes, and the tables from which their normal numbers are computed."""
    if not spec.noise:
        return None
    return {
        "processes": [each.name for each in spec.noise],
        "multipliers": normals.MULTIPLIERS,
        "weyl": normals.WEYL,
        "rounds": normals.ROUNDS,
        "middle": normals.MIDDLE,
        "tail": normals.TAIL,
        "far": normals.FAR,
        "series": normals.SERIES,
        "log2": normals.LOG2,
        "sweeps": normals.SWEEPS,
        "solved": SOLVED,
        "near": NEAR,
        "roundings": ROUNDINGS,
    }


def _describe_methods(
    methods: Iterable[JudgedMethod], context: KernelContext
) -> list[dict[str, Any]]:
    """Methods that the page has, the preferred first: splittings, spherical and plain midpoints."""
    flows = [each.name for each in context.maps]
    schedules = list_schedules(flows) if flows else {}
    ranked = sorted((each for each in methods if each.rank), key=_by_rank)
    return [
        {
            "name": each.name,
            "keeps": list(each.exactly),
            "schedule": [
                [flow, part] for flow, part in schedules[each.name]
            ] if each.name in SPLITTINGS else [],
        }
        for each in ranked
        if each.name in (*SPLITTINGS, "spherical_midpoint", "midpoint", "gauss4")
    ]  # fmt: skip


def _by_rank(method: JudgedMethod) -> int:
    """The place of a method in the order in which they are taken."""
    return method.rank


class _Finder:
    """Finds the rows of variables in the arrays of a kernel.

    Args:
        context: What the generated files say.
    """

    def __init__(self, context: KernelContext) -> None:
        tables: Mapping[str, tuple[Quantity, ...]] = {
            "state": context.state,
            "observables": context.observables,
            "reconstructed": context.reconstructed,
        }
        self.rows: dict[str, tuple[str, int]] = {}
        for table, quantities in tables.items():
            names = [name for each in quantities for name in each.components]
            for row, name in enumerate(names):
                self.rows.setdefault(name, (table, row))

    def find(self, variable: Variable | None) -> Rows | None:
        """The table and the rows of a variable; None if it is in no table, or in several."""
        if variable is None:
            return None
        found = [self.rows[name] for name in variable.components if name in self.rows]
        tables = {table for table, _ in found}
        if len(found) != len(variable.components) or len(tables) != 1:
            return None
        return {"name": variable.name, "table": tables.pop(), "rows": [row for _, row in found]}


def _choose(spec: Spec, finder: _Finder, rendered: Rendered) -> dict[str, Any]:
    """What is drawn: its kind, and the rows that it is made of.

    Raises:
        KernelArgumentError: Nothing is known of its place in space, and it is large.
    """
    context = rendered.context
    assert context is not None
    velocities = spec.having_role("velocity")
    blocks = _find_blocks(spec)
    parts, momenta = (
        {
            name: next((v for v in own if v.block == blocks.get(name) and v.shape == (3,)), None)
            for name in ("rotation", "translation")
        }
        for own in (velocities, spec.having_role("momentum"))
    )
    attitude = next((each for each in context.reconstructed if each.is_quaternion), None)
    own = spec.attitude
    drawn: dict[str, Any] = {
        "turning": finder.find(parts["rotation"]),
        "moving": finder.find(parts["translation"]),
        "spinning": finder.find(momenta["rotation"]),
        "pushing": finder.find(momenta["translation"]),
        "vertical": _find_vertical(spec, finder),
        "attitude": finder.find(own) if own is not None and own.shape == (4,) else None,
        "stick": next((each.name for each in context.inputs if each.shape == (3,)), "")
        if parts["rotation"] is not None and parts["rotation"].name in spec.forces
        else "",
    }
    if spec.rolling and spec.rolling.normal and attitude and drawn["turning"]:
        return {"kind": "rolling", **drawn}
    slips = _find_slips(spec, context, finder, drawn)
    if slips:
        return {"kind": "rolling", **drawn, "slips": slips}
    if drawn["turning"] and spec.invariance == "left":
        return {"kind": "body", **drawn}
    if spec.algebra and spec.algebra.name == "se(2)" and len(context.reconstructed) == 3:
        named = [blocks["rotation"], *((n,) for n in blocks["translation"])]
        along = [finder.find(v) for v in velocities if v.block in named]
        angles = [finder.find(v) for v in spec.having_role("coordinate")]
        if len(along) == 3 and all(each and each["table"] == "state" for each in along):
            return {"kind": "planar", "frame": along, "angles": [each for each in angles if each]}
        if len(along) == 3 and all(along):
            return _describe_carriage(spec, finder, named)
    places = [v for v in spec.having_role("coordinate") if v.shape in ((2,), (3,))]
    partners = [
        spec.partner("velocity", v.name) or spec.partner("momentum", v.name) for v in places
    ]
    found = [
        (finder.find(v), finder.find(partner)) for v, partner in zip(places, partners, strict=True)
    ]
    if found and all(at and speed for at, speed in found):
        return {
            "kind": "particles",
            "places": [at for at, _ in found],
            "speeds": [speed for _, speed in found],
        }
    count = sum(len(each.components) for each in context.state)
    if count > PORTRAIT or count < 2:
        raise refuse(
            spec,
            f"its state has {count} rows, none of them a body, a place or a field",
            f"one of these, or from 2 to {PORTRAIT} rows",
        )
    return {"kind": "portrait"}


def _describe_carriage(
    spec: Spec, finder: _Finder, blocks: list[tuple[int, ...]]
) -> dict[str, Any]:
    """A vehicle some of whose velocities follow from others: its frame, and angles with rates."""
    turning, first, second = blocks
    own = {v.block: finder.find(v) for v in spec.having_role("velocity")}
    free = [finder.find(v) for v in spec.having_role("velocity")]
    angles = [(v, spec.partner("velocity", v.name)) for v in spec.having_role("coordinate")]
    found = [(finder.find(v), finder.find(rate)) for v, rate in angles]
    return {
        "kind": "carriage",
        "frame": [own[first], own[second], own[turning]],
        "free": [each["rows"][0] for each in free if each and each["table"] == "state"],
        "turns": [
            {"angle": angle, "rate": rate}
            for angle, rate in found
            if angle and rate and angle["table"] == "state" and rate["table"] == "observables"
        ],
    }


def _find_slips(
    spec: Spec, context: KernelContext, finder: _Finder, drawn: Mapping[str, Any]
) -> list[Rows]:
    """Vectors that may be the velocity of a body's point at a contact that slides.

    Where one condition alone binds turning and moving, a body may slide on a plane. The page takes
    the first of these that depends on the velocities as ``Y - Omega x s``, and whose part along the
    vertical is that condition; without one it shows a body.
    """
    names = ("turning", "moving", "vertical")
    residual = next((each for each in context.programs if each.name == "constraint_residual"), None)
    alone = residual is not None and len(residual.outputs) == 1
    if not alone or not all(drawn[name] and drawn[name]["table"] == "state" for name in names):
        return []
    declared = {each.name for each in spec.observables}
    vectors = [q for q in context.observables if q.name in declared and q.shape == (3,)]
    return [
        {
            "name": each.name,
            "table": "observables",
            "rows": [finder.rows[c][1] for c in each.components],
        }
        for each in vectors
    ]


def _find_blocks(spec: Spec) -> dict[str, tuple[int, ...]]:
    """The blocks of the algebra; its translations only if rotations turn them."""
    if spec.algebra is None:
        return {}
    blocks, constants = dict(spec.algebra.blocks), spec.algebra.constants
    turned = {j for i, j in constants if i in blocks.get("rotation", ())}
    if not turned & set(blocks.get("translation", ())):
        blocks.pop("translation", None)
    return blocks


def _find_vertical(spec: Spec, finder: _Finder) -> Rows | None:
    """The advected vector that the attitude turns upright: of a plane in space, its normal."""
    for each in spec.having_role("advected"):
        found, action = finder.find(each), each.representation
        size = 0 if action is None else len(each.components)
        if found is not None and not each.strain and each is not spec.attitude and size in (3, 4):
            return {**found, "rows": found["rows"][:3], "depth": found["rows"][3:]}
    return None
