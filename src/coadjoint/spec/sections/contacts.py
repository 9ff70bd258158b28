"""Contacts: the keys of [rolling] for a body that rolls on any surface.

Where the point of contact has no closed form it is part of the state: X in space, where the surface
F(X) = 0 is, and s on the body, whose surface is f(s) = 0. A ball has no s.
Comes in: the keys. Goes out: a `Contact`.
Read next: `coadjoint.derive.mechanics.contact`, which gives the rates of X and s.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.faults import list_names
from coadjoint.spec.core.formulas import Formula, make_scope, misfit, read_fitting
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading
from coadjoint.spec.core.tree import Index, Name, walk
from coadjoint.spec.sections.algebras import ALGEBRA
from coadjoint.spec.sections.variables import SPACE, VARIABLES

#: Keys for a body on a surface, and those that each needs.
NEEDS = {
    "surface": ("contact",),
    "contact": ("surface",),
    "body": ("point", "surface"),
    "point": ("body",),
    "radius": ("surface",),
    "turning": ("surface",),
    "axes": ("surface",),
}
#: Tables that know nothing of points of contact.
ALONE = ("symmetries", "transformations", "charts", "momenta", "reduction")


@dataclass(frozen=True)
class Contact:
    """Where a body touches a surface.

    Attributes:
        surface: F, positive on the side of the body.
        place: Name of the point of contact X, seen from space.
        body: f, negative inside the body; None of a ball.
        point: Name of the point of contact s, seen from the body; "" of a ball.
        radius: Of a ball; None of another body.
        turning: Angular velocity of the surface about the origin, in space; None if it is at rest.
        axes: Names of the axes of space, seen from the body; empty where velocities are seen from
            space.
        centre: Name of the position of the centre of a ball in space; "" if there is none.
    """

    surface: Formula
    place: str
    body: Formula | None
    point: str
    radius: Formula | None
    turning: Formula | None
    axes: tuple[str, ...]
    centre: str

    @property
    def texts(self) -> dict[str, str]:
        """What is 0 while the surfaces touch, for people, by the rows of its kernel function."""
        rows = {"rolling_surface": f"{self.surface.in_one_line} == 0, the surfaces touch"}
        if self.body is not None:
            rows["rolling_body"] = f"{self.body.in_one_line} == 0, the surfaces touch"
            text = "the normals of the surfaces that touch are opposite"
            rows |= {f"rolling_normals{n + 1}": text for n in range(SPACE)}
        elif self.centre:
            text = f"{self.centre} is at the radius from the surface that is touched"
            rows |= {f"rolling_centre{n + 1}": text for n in range(SPACE)}
        return rows


def read_contact(reading: Reading, part: Any) -> Contact:
    """Where a body touches a surface.

    Raises:
        SpecError: A key is missing that another needs, a name is none of a point of contact or of
            an axis, or a surface is not a function of its point.
    """
    _check_keys(reading, part)
    for table in ALONE:
        if getattr(reading.file, table):
            problem = f"there are [{table}] and points of contact that are state"
            raise reading.fault((table,), problem, table, "one of them", f"Remove [{table}].")
    place, point = (_check_point(reading, key, getattr(part, key)) for key in ("contact", "point"))
    constant = dict[str, Shape]()
    radius = turning = None
    if part.radius is not None:
        radius = _read(reading, "radius", part.radius, constant, ())
    if part.turning is not None:
        turning = _read(reading, "turning", part.turning, constant, (SPACE,))
    surface = _read_surface(reading, "surface", part.surface, place)
    body = None if part.body is None else _read_surface(reading, "body", part.body, point)
    centres = [v.name for v in VARIABLES.of(reading) if v.role == "coordinate"]
    return Contact(
        surface=surface,
        place=place,
        body=body,
        point=point,
        radius=radius,
        turning=turning,
        axes=_read_axes(reading, part),
        centre=centres[0] if centres else "",
    )


def _check_keys(reading: Reading, part: Any) -> None:
    """Keys come with those that they need, and a body has one surface."""
    if part.turning is not None and (part.axes is not None or part.radius is None):
        problem = "the surface turns, and what rolls on it is no ball that is seen from space"
        expected = 'a radius and invariance = "right" with turning'
        raise reading.fault(("rolling", "turning"), problem, part.turning, expected)
    for key, needed in NEEDS.items():
        for other in needed if getattr(part, key) is not None else ():
            if getattr(part, other) is None:
                problem = f"there is {key} and no {other}"
                raise reading.fault(("rolling", key), problem, key, f"{other} with {key}")
    if (part.body is None) == (part.radius is None):
        problem = "the body has " + ("no surface" if part.body is None else "two surfaces")
        expected = "either body and point, or the radius of a ball"
        raise reading.fault(("rolling", "surface"), problem, "surface", expected)
    if part.normal is not None:
        problem, expected = "there are a surface and the normal of a plane", "one of them"
        raise reading.fault(("rolling", "normal"), problem, part.normal, expected)


def _check_point(reading: Reading, key: str, name: str | None) -> str:
    """The name of a variable that is a point of contact."""
    if name is None:
        return ""
    points = [v.name for v in VARIABLES.of(reading) if v.role == "contact"]
    if name not in points:
        problem = f"there is no point of contact {name!a}"
        raise reading.unknown(("rolling", key), problem, name, points)
    return name


def _read(
    reading: Reading, key: str, text: str, names: Mapping[str, Shape], shape: Shape
) -> Formula:
    """A formula of parameters and of a few names."""
    others = [each for each in reading.quantities if each.name not in names]
    scope = make_scope(f"what {key} says", (), others, names, driven=())
    scope = replace(scope, takes=" and ".join([*list(names)[:1], scope.takes]))
    return read_fitting(reading.source, ("rolling", key), text, scope, shape, key)


def _read_surface(reading: Reading, key: str, text: str, point: str) -> Formula:
    """A function of a point whose zero is a surface."""
    place: KeyPath = ("rolling", key)
    variable = next(v for v in VARIABLES.of(reading) if v.name == point)
    names = {point: variable.shape} | dict.fromkeys(variable.components, ())
    formula = _read(reading, key, text, names, ())
    if not any(isinstance(n, Name | Index) and n.name in names for n in walk(formula.tree)):
        raise misfit(reading.source, place, formula, f"a function of {point}, 0 on the surface")
    return formula


def _read_axes(reading: Reading, part: Any) -> tuple[str, ...]:
    """The axes of space, which a body sees turn."""
    key: KeyPath = ("rolling", "axes")
    vectors = [
        v.name for v in VARIABLES.of(reading) if v.role == "advected" and v.shape == (SPACE,)
    ]
    if ALGEBRA.of(reading).invariance != "left":
        if part.axes is None:
            return ()
        problem = "velocities are seen from space, and so are its axes"
        raise reading.fault(key, problem, list_names(part.axes), 'no axes, or invariance = "left"')
    if part.axes is None or len(set(part.axes)) != SPACE:
        problem = "velocities are seen from the body, and the axes of space are not named"
        expected = 'axes = ["E1", "E2", "E3"], advected vectors'
        raise reading.fault(("rolling",), problem, list_names(part.axes or ()), expected)
    for name in part.axes:
        if name not in vectors:
            problem = f"there is no advected vector {name!a}"
            raise reading.unknown(key, problem, name, vectors)
    return tuple(part.axes)
