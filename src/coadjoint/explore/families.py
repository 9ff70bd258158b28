"""What the page of equal members shows, of fields at points, and of entries of matrices.

Comes in: a Spec and what was rendered of it. Goes out: plain values for the page.
Read next: `coadjoint.explore.surfaces`, fields on a surface.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

from coadjoint.derive.fields.profiles import sample_profiles
from coadjoint.explore.records import describe, drop_member, list_quantities, refuse
from coadjoint.explore.surfaces import describe_surface
from coadjoint.notation.names import spell
from coadjoint.pipeline import Rendered
from coadjoint.render.families import FamilyContext
from coadjoint.spec import Spec

#: Rows of a state that a page moves at the most.
MOST_ROWS: Final = 4096
#: Members at the most of which each has sliders for its parameters.
MOST_SLIDERS: Final = 12


def describe_family(spec: Spec, context: FamilyContext, rendered: Rendered) -> dict[str, Any]:
    """The same of equal members, or of a field at the points of its grid.

    Raises:
        KernelArgumentError: Something drives it, it has too many rows, or nothing in it is shown.
    """
    size = context.index.count_members(context.index.size or context.small)
    names = [name for each in context.state for name in each.components]
    if size * len(names) > MOST_ROWS:
        raise refuse(
            spec, f"{size * len(names)} rows of its state are too many", f"at most {MOST_ROWS}"
        )
    driven = (context.shared_noise, context.indexed_noise, context.time)
    if any((*driven, context.shared_inputs, context.indexed_inputs)):
        raise refuse(spec, "something drives it from outside", "a motion that its start decides")
    context = replace(context, defaults={**context.defaults, **_begin(spec)})
    state = list_quantities(context.state, spec)
    for each in state:
        each["default"] = _spread(each, context, size)
        if spec.space is not None and context.index.size and each["default"] is None:
            each["default"] = [0.0] * (size * len(each["components"]))
    return {
        **describe(spec, rendered),
        "tables": {
            "state": state,
            "parameters": [
                *list_quantities(context.shared, spec),
                *([] if context.torus else _list_indexed(spec, context, size)),
            ],
            "inputs": [],
            "observables": list_quantities(context.observables, spec),
            "reconstructed": [],
        },
        "functions": list(context.loops),
        "takes": {name: ["state", "parameters"] for name in context.loops},
        "time": False,
        "domain": [],
        "members": size,
        "methods": [
            {"name": each.name, "keeps": list(each.exactly), "schedule": []}
            for name in ("isospectral_midpoint", "midpoint")
            for each in context.methods
            if each.name == name and (each.rank or context.index.of_rows)
        ],
        **(
            describe_surface(spec, context)
            or (_choose_field if spec.space else _choose_member)(spec, context)
        ),
    }


def _begin(spec: Spec) -> dict[str, tuple[float, ...]]:
    """Fields at the beginning, component after component; nothing without a number of points."""
    sampled = {} if spec.space is None else sample_profiles(spec)
    return {name: tuple(float(x) for row in rows for x in row) for name, rows in sampled.items()}


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
    found = list_quantities(context.indexed, spec)
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
    return {
        "kind": "strand" if first else "profile",
        "curve": first or [0],
        "ring": context.index.periodic,
    }


def _choose_member(spec: Spec, context: FamilyContext) -> dict[str, Any]:
    """What is drawn of a member, by the roles and shapes of its variables, and their components.

    Raises:
        KernelArgumentError: None of them is a frame, a place, a vector or a number with its rate.
    """
    names = [name for each in context.state for name in each.components]
    declared = {drop_member(each.name): each for each in spec.variables}
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
        raise refuse(
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
