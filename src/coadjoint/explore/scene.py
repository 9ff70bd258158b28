"""What the page of a system shows: chosen by its records, and never by its name.

Comes in: a Spec and what was rendered of it. Goes out: plain values for the page. They say which
rows are the angular velocity, the attitude, the vertical, a place, an arm; the page finds lengths
and shapes by the generated functions: the surface of a body that rolls is where its arm ends.
Read next: `coadjoint.explore.page`.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from typing import Any, Final

from coadjoint.declared import KernelContext, Quantity
from coadjoint.errors import KernelArgumentError
from coadjoint.lower.compositions import SPLITTINGS, list_schedules
from coadjoint.methods import JudgedMethod
from coadjoint.notation.names import spell
from coadjoint.pipeline import Rendered
from coadjoint.render.families import FamilyContext
from coadjoint.resources import derivations_folder
from coadjoint.spec import Spec
from coadjoint.spec.model import Variable

#: Rows of a state that a page moves at the most.
MOST_ROWS: Final = 4096
#: Rows of a state at the most that a page shows by its first three where it knows nothing better.
PORTRAIT: Final = 40
#: Members at the most of which each has sliders for its parameters.
MOST_SLIDERS: Final = 12

Rows = dict[str, Any]


def describe_scene(spec: Spec, rendered: Rendered) -> dict[str, Any]:
    """All that the page of a system is told.

    Raises:
        KernelArgumentError: It shows no such system.
    """
    if rendered.family is not None:
        return _describe_family(spec, rendered.family.context, rendered)
    context = rendered.context
    assert context is not None
    if spec.noise:
        raise _refuse(spec, "it has noise", "a motion that its start decides")
    finder = _Finder(context)
    return {
        **_describe(spec, rendered, context.unit_of_time),
        "tables": {
            "state": _list(context.state, spec),
            "parameters": _list(context.parameters, spec),
            "inputs": _list(context.inputs, spec),
            "observables": _list(context.observables, spec),
            "reconstructed": _list(context.reconstructed, spec),
        },
        "functions": [each.name for each in context.programs],
        "takes": {each.name: list(each.arrays) for each in context.programs},
        "sizes": {each.name: len(each.outputs) for each in context.programs},
        "time": bool(context.time),
        "domain": [{"name": each.label, "strict": each.strict} for each in context.domain],
        "members": 0,
        "methods": _describe_methods(context.methods, context),
        **_choose(spec, finder, rendered),
    }


def _refuse(spec: Spec, problem: str, expected: str) -> KernelArgumentError:
    """The error for a system without a page."""
    known = spec.name if spec.path.parent == derivations_folder() else spec.path
    return KernelArgumentError(
        f"{spec.name} has no page to explore: {problem}; expected {expected}. "
        f"Simulate it: coadjoint simulate {known} --help says how.",
        found=spec.name,
        expected=expected,
    )


def _describe(spec: Spec, rendered: Rendered, unit: str) -> dict[str, Any]:
    """What the page says of a system."""
    record = json.loads(rendered.texts["certificate.json"])
    return {
        "name": spec.name,
        "title": spec.title or spec.name,
        "source": spec.source,
        "description": " ".join(spec.description.split()),
        "unitOfTime": unit,
        "spheres": record.get("structure", {}).get("spheres", []),
    }


def _drop_member(name: str) -> str:
    """The name of a variable of members, without the number of one.

    >>> _drop_member("p_12")
    'p'
    """
    return re.sub(r"_[0-9]+$", "", name)


def _list(quantities: Iterable[Quantity], spec: Spec) -> list[dict[str, Any]]:
    """Quantities with their units, explanations and defaults."""
    declared: list[Any] = [*spec.variables, *spec.parameters, *spec.observables, *spec.inputs]
    docs = {each.name: each.doc for each in [*declared, *spec.reconstruction]}
    docs = {_drop_member(name): doc for name, doc in docs.items()} | docs
    return [
        {
            "name": each.name,
            "written": spell(each.name),
            "components": list(each.components),
            "letters": [spell(name) for name in each.components],
            "units": [each.unit_of(name) for name in each.components],
            "doc": docs.get(each.name, ""),
            "default": None if each.default is None else list(each.default),
            "positive": each.positive,
            "conserved": each.conserved,
            "upright": each.upright,
            "quaternion": each.is_quaternion,
        }
        for each in quantities
    ]


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
        raise _refuse(
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


def _describe_family(spec: Spec, context: FamilyContext, rendered: Rendered) -> dict[str, Any]:
    """The same of equal members, or of a field at the points of its grid.

    Raises:
        KernelArgumentError: Something drives it, it has too many rows, or nothing in it is shown.
    """
    size = context.index.size or context.small
    names = [name for each in context.state for name in each.components]
    for is_other, what in (
        (context.torus is not None, "it is a field in a plane"),
        (context.index.of_rows, "its members are entries of matrices"),
    ):
        if is_other:
            raise _refuse(spec, what, "a body, particles or a field along a line")
    if size * len(names) > MOST_ROWS:
        raise _refuse(
            spec, f"{size * len(names)} rows of its state are too many", f"at most {MOST_ROWS}"
        )
    driven = (context.shared_noise, context.indexed_noise, context.time)
    if any((*driven, context.shared_inputs, context.indexed_inputs)):
        raise _refuse(spec, "something drives it from outside", "a motion that its start decides")
    state = _list(context.state, spec)
    for each in state:
        each["default"] = _spread(each, context, size)
    return {
        **_describe(spec, rendered, context.unit_of_time),
        "tables": {
            "state": state,
            "parameters": [*_list(context.shared, spec), *_list_indexed(spec, context, size)],
            "inputs": [],
            "observables": _list(context.observables, spec),
            "reconstructed": [],
        },
        "functions": list(context.loops),
        "takes": {name: ["state", "parameters"] for name in context.loops},
        "time": False,
        "domain": [],
        "members": size,
        "methods": [
            {"name": each.name, "keeps": list(each.exactly), "schedule": []}
            for each in sorted(context.methods, key=_by_rank)
            if each.name == "midpoint" and each.rank
        ],
        **(_choose_field if spec.space else _choose_member)(spec, context),
    }


def _spread(each: dict[str, Any], context: FamilyContext, size: int) -> list[float] | None:
    """Defaults of a quantity of members, component after component, each for all members."""
    name, count = each["name"], len(each["components"])
    own = list(context.defaults.get(name, ()))
    if not own:
        return each["default"] and [value for value in each["default"] for _ in range(size)]
    known = len(own) // count
    if known != size and name not in context.repeating:
        return None
    return [own[known * k + i % known] for k in range(count) for i in range(size)]


def _list_indexed(spec: Spec, context: FamilyContext, size: int) -> list[dict[str, Any]]:
    """Parameters of each member: of few members, each component has a slider."""
    found = _list(context.indexed, spec)
    for each in found:
        first, own = context.index.first, each["components"]
        each["default"] = _spread(each, context, size)
        each["components"] = [f"{name}_{first + i}" for name in own for i in range(size)]
        each["letters"] = [spell(name) for name in each["components"]]
        each["units"] = [unit for unit in each["units"] for _ in range(size)]
        each["hidden"] = size > MOST_SLIDERS
    return found


def _choose_field(spec: Spec, context: FamilyContext) -> dict[str, Any]:
    """A field is a curve: of its first vector, or of its first component."""
    names = [name for each in context.state for name in each.components]
    vectors = [each for each in context.state if len(each.components) == 3]
    first = [names.index(name) for name in vectors[0].components] if vectors else []
    return {"kind": "strand" if first else "profile", "curve": first or [0]}


def _choose_member(spec: Spec, context: FamilyContext) -> dict[str, Any]:
    """What is drawn of a member, by the roles and shapes of its variables, and their components.

    Raises:
        KernelArgumentError: None of them is a frame, a place, a vector or a number with its rate.
    """
    names = [name for each in context.state for name in each.components]
    declared = {_drop_member(each.name): each for each in spec.variables}
    own = [(declared[each.name], each.components) for each in context.state]
    frames = [parts for each, parts in own if each.turning]
    places = [parts for each, parts in own if each.role == "coordinate"]
    momenta = [parts for each, parts in own if each.role in ("momentum", "velocity")]
    widths = [len(each) for each in places]
    shape = ""
    place: tuple[str, ...] = ()
    if frames and len(frames[0]) in (9, 12):
        shape, place = "frames", frames[0]
    elif widths[:1] == [3]:
        shape, place = "globe" if context.spheres else "space", places[0]
    elif widths[:1] == [2] or (widths == [1, 1] and not momenta):
        shape, place = "plane", tuple(each for parts in places for each in parts)[:2]
    elif widths == [] and momenta and len(momenta[0]) == 3:
        shape, place = "arrows", momenta[0]
    elif widths[:1] == [1]:
        shape, place = "stems", (*places[0], *(momenta[0][:1] if momenta else ()))
    if not shape:
        raise _refuse(
            spec,
            "its equal members have none of what is drawn",
            "a frame, a place, a vector or a number",
        )
    return {
        "kind": "members",
        "shape": shape,
        "place": [names.index(name) for name in place],
        "ring": context.index.periodic,
        "first": context.index.first,
    }
