"""The spec of a lattice of bodies, as text.

Comes in: the Spec of a strand. Goes out: TOML, which `coadjoint.read_spec` reads from a file.
Read next: `coadjoint.derive.indexed`, for what is derived from it.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from fractions import Fraction
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from coadjoint.bodies.energy import Strand, read_strand, refuse
from coadjoint.bodies.links import Links
from coadjoint.bodies.starts import Starts, find_starts
from coadjoint.derive.interpret import entries
from coadjoint.errors import LimitError, SpecError
from coadjoint.exact import Element
from coadjoint.exact.text import element_text
from coadjoint.spec import Spec, read_spec_text
from coadjoint.spec.core.components import kept_places, matrix_size

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.spec.model import Observable, Parameter

#: Names for what the strand has not, in the order in which they are tried.
_NAMES: Final = {
    "index": ("i", "j", "k"),
    "count": ("n", "m", "count"),
    "wall": ("E", "B", "C"),
    "distance": ("a", "b", "d"),
    "attitude": ("R", "Q", "A"),
    "momentum": ("J", "M", "N"),
    "turn": ("turn", "axial", "twist"),
    "squares": ("squares", "products", "pairs"),
    "potential": ("V", "W", "F"),
    "link": ("U", "T", "G"),
    "first": ("x", "y", "z"),
    "second": ("S", "Y", "Z"),
}
#: Names of what rods have in addition, or in the place of these.
_RODS: Final = {
    "attitude": ("g", "q", "p"),
    "linear": ("L", "H", "linear"),
    "rise": ("D", "c", "rise"),
    "third": ("e", "u", "v"),
    "stretch": ("stretch", "shear", "pull"),
    "bond": ("bond", "pair", "tie"),
    "here": ("Q", "O", "here"),
    "next": ("T", "N", "next"),
    "step": ("w", "r", "step"),
}
#: Digits behind the point of momenta and attitudes at the beginning.
_DIGITS: Final = 14


def write_lattice(spec: Spec, bodies: int | None = None) -> str:
    """The spec of a lattice of rigid bodies whose limit is a strand, as text.

    Args:
        spec: A strand on so(3), or a left invariant rod on se(3), around a circle or between
            ends, whose energy per length is the sum of a function of momenta and advected vectors
            and a polynomial of strains.
        bodies: How many there are by default; as many as the strand has points if left out.

    Returns:
        The text of a spec with an index, which `coadjoint.read_spec` and `coadjoint.load` read from
        a file. Parameters are those of the strand with the distance of bodies in the place of the
        length; momenta and the energy are per length. Bodies begin with the momenta of the profile,
        and with the attitudes and places that its strain integrates to. A ring of attitudes that
        do not close begins with all alike. A rod that goes round a circle of s without closing in
        space is a period of an endless one along the third axis.

    Raises:
        SpecError: The strand has no such lattice, with the reason; or there is no body.
        DerivationError: The energy of the strand cannot be derived.

    Source:
        Demoures, Gay-Balmaz and Ratiu, Discrete and Continuous Dynamical Systems S 9 (2016) 1061.
    """
    strand = read_strand(spec)
    count = _count_points(spec) if bodies is None else bodies
    if count < 1:
        message = f"{spec.path}: the lattice has {count} bodies; expected at least 1. Write 16."
        raise SpecError(message, path=str(spec.path), found=count)
    lattice = _Lattice(strand, count)
    text = "\n\n".join(lattice.sections()) + "\n"
    _check_size(spec, text, {lattice.place: count})
    return text


def _check_size(spec: Spec, text: str, sizes: Mapping[str, int]) -> None:
    """What is written can be read.

    Raises:
        SpecError: The energy, or the numbers at the beginning, are longer than a spec may be.
    """
    try:
        read_spec_text(text, Path("lattice.toml"))
    except LimitError as error:
        if "EXPRESSION_NODES" in str(error):
            problem = "its energy has too many terms of strains (EXPRESSION_NODES)"
            hint = "Leave out terms of the highest degree."
            raise refuse(spec, problem, "a shorter polynomial", hint) from error
        (bodies,) = sizes.values()
        problem = f"its spec would be too long with where each of {bodies} bodies begins"
        hint = f"Write fewer, and give so many a state of their own: system.resize({dict(sizes)})."
        raise refuse(spec, problem, "some hundred bodies at most", hint) from error


def _count_points(spec: Spec) -> int:
    """How many points the strand has.

    Raises:
        SpecError: That is chosen when it is loaded.
    """
    assert spec.space is not None, spec.name
    if spec.space.size is None:
        name = spec.space.name
        hint = f"Write it, coadjoint new NAME --lattice-of {spec.name} --bodies 16, or load the "
        problem = "[space] has no number of points, and no number of bodies is given"
        raise refuse(spec, problem, "a number", f"{hint}spec with sizes={{{name!r}: 16}}.")
    return spec.space.size


class _Lattice:
    """The lattice of a strand, with the names that it gives."""

    def __init__(self, strand: Strand, bodies: int) -> None:
        spec, space = strand.spec, strand.spec.space
        assert space is not None, spec.name
        self.strand, self.spec, self.bodies, self.length = strand, spec, bodies, space.length
        self.is_open, self.is_clamped = space.has_ends, space.ends == "clamped"
        taken = {each.name for each in spec.parameters} - {self.length}
        taken |= {each.name for each in (*strand.momenta, *strand.advected)}
        taken |= {each.name for each in spec.observables}
        self.names = {
            use: self._choose(use, names, taken)
            for use, names in (_NAMES | (_RODS if strand.is_rod else {})).items()
        }
        self.place = self.names["index"]
        self.distance = self.names["distance"]
        self.attitude = self.names["attitude"]
        self.links = Links(strand, self.names, self.write)
        self.body = self.links.turn_of(self.place)

    def _choose(self, use: str, names: tuple[str, ...], taken: set[str]) -> str:
        """A name that the strand does not use.

        Raises:
            SpecError: It uses all of them.
        """
        free = [name for name in names if not any(re.fullmatch(f"{name}\\d*", x) for x in taken)]
        if not free:
            problem = f"{', '.join(names)} are names of the strand"
            expected = f"one of them free for the {use} of the lattice"
            raise refuse(self.spec, problem, expected, "Rename one.")
        return free[0]

    def write(self, element: Element) -> str:
        """An element as a formula, with momenta of a body."""
        known = {
            component: f"{each.name}[{self.place}, {n}]"
            for each in (*self.strand.momenta, *self.strand.advected)
            for n, component in enumerate(each.components, 1)
        }
        for parameter in self.spec.parameters:
            known |= _place_components(parameter)
        text = element_text(self.strand.field, element)
        return re.sub(r"[A-Za-z]\w*", lambda found: known.get(found[0], found[0]), text)

    # -- tables ---------------------------------------------------------------------------

    def sections(self) -> Iterator[str]:
        """The tables of the spec, as text."""
        spec, i, R = self.spec, self.place, self.body
        head = {"title": f"{spec.title}, as a lattice of bodies", "source": spec.source}
        head |= {"license": spec.license}
        rows = [f"{key} = {_quote(value)}" for key, value in head.items() if value]
        yield "\n".join([*rows, 'routes = ["lie-poisson"]'])
        yield f"description = {_quote(self._describe())}"
        ring = json.dumps(not self.is_open)
        count = f", count = {_quote(self.names['count'])}" if self._has_walls else ""
        yield f"[index]\n{i} = {{ size = {self.bodies}, periodic = {ring}{count} }}"
        assert spec.algebra is not None, spec.name
        yield f'[algebra]\nname = "{spec.algebra.name}"\ninvariance = "{self.strand.side}"'
        yield "[variables]\n" + "\n".join(self._variables())
        yield "[parameters]\n" + "\n".join(self._parameters())
        terms = [f"  sum({i}, {self.write(self.strand.own)})"]
        if self.links.has_any:
            yield "[definitions]\n" + "\n".join(self.links.definitions())
            links = self.links.terms(rises=self._starts.rise > 0, has_walls=self._has_walls)
            terms += [f"+ {each}" for each in links]
        lines = "\n".join(terms)
        yield f'# the energy over {self.distance}\n[hamiltonian]\nh = """\n{lines}\n"""'
        left = self._left_out()
        note = f"# of the strand alone: {', '.join(left)}\n" if left else ""
        yield note + "[observables]\n" + "\n".join(self._observables.values())
        kept = [name for name in ("energy", *self._observables) if self._is_kept(name)]
        casimirs = [f"trace({R}*transpose({R}))", f"det({R})"]
        turn = self.links.turn_over
        kept_vectors = [f"({turn(f'{each.name}[{i}]')})" for each in self.strand.advected]
        casimirs += [f"{vector}[{n}]" for vector in kept_vectors for n in (1, 2, 3)]
        yield f"[claims]\ncasimirs = {json.dumps(casimirs)}\nconserved = {json.dumps(kept)}"

    @property
    def _has_walls(self) -> bool:
        """Whether there are links to walls, which stand still."""
        return self.is_clamped and self.links.has_any

    def _describe(self) -> str:
        row = "a row with free ends" if self.is_open else "a ring"
        row = "a row between two walls, which stand still," if self.is_clamped else row
        if self._starts.rise:
            return self._describe_period()
        closes = "" if self.is_open else ", and the ring closes exactly"
        what = "attitudes and places" if self.strand.is_rod else "attitudes"
        begin = "the profiles of the strand say"
        if self._starts.attitudes is None:
            begin += ", but that all stand alike"
        if self._starts.gap:
            begin += f": the holonomy of its strain is not 1 but for {self._starts.gap:.2g}"
        return (
            f"Rigid bodies in {row} at distances {self.distance}, with {what} {self.attitude}, "
            f"whose limit is the strand of {self.spec.name}. The turn from one body to the next is "
            f"a rotation{closes}. Momenta and the energy are per length. Bodies begin as {begin}."
        )

    def _describe_period(self) -> str:
        i, a, g, rise = self.place, self.distance, self.attitude, self.names["rise"]
        return (
            f"Rigid bodies at distances {a} along a rod, with attitudes and places {g}, whose "
            f"limit is the strand of {self.spec.name}. The rod does not close in space: it is a "
            f"period of an endless one, which goes on along the third axis by {a}*{rise} a body. "
            f"Body {i} is at translation({g}[{i}]) + ({i} + k*N)*{a}*{rise}*(0, 0, 1) for all "
            "whole k. Momenta and the energy are per length, and totals are of one period. Bodies "
            "begin as the profiles of the strand say, turned so that the rod goes along this axis."
        )

    @cached_property
    def _starts(self) -> Starts:
        return find_starts(self.strand, self.bodies)

    def _variables(self) -> Iterator[str]:
        starts = self._starts
        axes = "in body axes" if self.strand.side == "left" else "in axes of space"
        role, doc = "attitude", "from a body to space"
        if self.strand.is_rod:
            role, doc = "pose", "attitude and place"
        yield self._variable(self.attitude, role, starts.attitudes, doc, self._pose_unit)
        for each in self.strand.momenta:
            what = "angular momenta" if 0 in each.block else "momenta"
            what = "angular momenta and momenta" if len(each.block) == 6 else what
            role = "momentum"
            if self.strand.is_rod and len(each.block) == 3:
                role += f'", block = "{"rotation" if 0 in each.block else "translation"}'
            given = starts.fields.get(each.name)
            doc = each.doc or f"{what} {axes}, per length"
            yield self._variable(each.name, role, given, doc, each.unit)
        for each in self.strand.advected:
            doc = each.doc or axes
            given = starts.fields.get(each.name)
            role = 'advected", representation = "vector'
            role += '", block = "rotation' if self.strand.is_rod else ""
            yield self._variable(each.name, role, given, doc, each.unit)

    @property
    def _pose_unit(self) -> str:
        """The unit of entries of a pose: its last column is a place."""
        (unit,) = (each.unit for each in self.spec.parameters if each.name == self.length)
        row = f"1, 1, 1, {unit}"
        return f"{row}, {row}, {row}" if self.strand.is_rod and unit not in ("", "1") else ""

    def _variable(self, name: str, role: str, given: Array | None, doc: str, unit: str = "") -> str:
        """The line of a variable."""
        default = "" if given is None else f", default = {json.dumps(_write_numbers(given))}"
        keys = f'role = "{role}", index = "{self.place}"{default}{_unit(unit)}'
        return f"{name} = {{ {keys}, doc = {_quote(doc)} }}"

    def _parameters(self) -> Iterator[str]:
        for each in self.spec.parameters:
            own, doc, name = each.default, each.doc, each.name
            if each.name == self.length:
                name, doc = self.distance, "distance of bodies"
                own = None if own is None else (own[0] / (self.bodies + self.is_clamped),)
            keys = [f"shape = {json.dumps(each.shape)}"] if each.shape else []
            keys += [f"form = {_quote(each.form)}"] if each.form else []
            keys += ["positive = true"] if each.positive else []
            if own is not None:
                keys.append(f"default = {_write_default(own, each.shape)}")
            keys += [f"doc = {_quote(doc)}"] if doc else []
            yield f"{name} = {{ {', '.join(keys)}{_unit(each.unit)} }}"
        if self._has_walls:
            columns, doc, name = 3, "attitude", self.names["wall"]
            if self.strand.is_rod:
                columns, doc = 4, "attitude and place"
            wall = np.eye(3, columns) if self._starts.wall is None else self._starts.wall
            rows, unit = json.dumps(_write_numbers(wall)), _unit(self._pose_unit)
            doc += " of the wall behind the last body; the first wall has the attitude 1"
            doc += " and the place 0" if self.strand.is_rod else ""
            yield f'{name} = {{ shape = [3, {columns}], default = {rows}{unit}, doc = "{doc}" }}'
        if self._starts.rise:
            doc = "step to the next body along the third axis, per length"
            rise = json.dumps(_write_numbers(np.array(self._starts.rise)))
            yield f'{self.names["rise"]} = {{ default = {rise}, doc = "{doc}" }}'

    # -- observables and claims -----------------------------------------------------------

    @cached_property
    def _observables(self) -> Mapping[str, str]:
        """The total momenta in space, and what the strand has without strains, by names."""
        rows = {name: self._total(name, *total) for name, total in self._totals().items()}
        for each in self.spec.observables:
            values = self._of_momenta(each)
            if values is None:
                continue
            texts = [self.write(value) for value in values]
            inner = f"vector({', '.join(texts)})" if each.formula.shape else texts[0]
            rows[each.name] = self._total(each.name, inner, each.unit, each.doc or "total")
        return rows

    def _totals(self) -> Mapping[str, tuple[str, str, str]]:
        """The momenta of a body in space by names of their totals, with units and what they are."""
        J, place, turn = (
            self.names["momentum"],
            self.links.place_of(self.place),
            self.links.turn_over,
        )
        spin, unit = self._part((0, 1, 2))
        axes = "space" if self.strand.side == "left" else "body axes"
        angular, doc = turn(spin), f"total angular momentum in {axes}"
        if not self.strand.is_rod:
            return {J: (angular, unit, doc)}
        moved, unit_of_moved = self._part((3, 4, 5))
        angular += f" + cross({place}, {turn(moved)})"
        if self._starts.rise:
            angular, doc = f"({angular})[3]", "total angular momentum about the third axis in space"
        linear = (turn(moved), unit_of_moved, "total momentum in space")
        return {self.names["linear"]: linear, J: (angular, unit, doc)}

    def _part(self, block: tuple[int, ...]) -> tuple[str, str]:
        """The momentum of a body along a block of the algebra, a vector, and its unit."""
        for each in self.strand.momenta:
            if each.block == block:
                return f"{each.name}[{self.place}]", each.unit
        (whole,) = self.strand.momenta
        entries = ", ".join(f"{whole.name}[{self.place}, {n + 1}]" for n in block)
        return f"vector({entries})", ""

    def _total(self, name: str, term: str, unit: str, doc: str) -> str:
        """The line of an observable that is a sum over bodies."""
        doc = f"{doc}, over {self.distance}"
        return (
            f"{name} = {{ expression = {_quote(f'sum({self.place}, {term})')}{_unit(unit)}, "
            f"doc = {_quote(doc)} }}"
        )

    def _of_momenta(self, each: Observable) -> tuple[Element, ...] | None:
        """An observable of the strand by components, if it names no strains."""
        if len(each.formula.shape) > 1:
            return None
        equations, field = self.strand.equations, self.strand.field
        values = entries(equations.setting.value(each.formula))
        closed = tuple(map(equations.close, values))
        own = (*self.strand.momenta, *self.strand.advected)
        known = {*(n for x in own for n in x.components), *field.adjoined}
        known |= {n for x in self.spec.parameters for n in x.components} - {self.length}
        return closed if all(field.reach(value) <= known for value in closed) else None

    def _is_kept(self, name: str) -> bool:
        """Whether the lattice keeps it: of the strand's, linear functions of momenta it keeps."""
        if name == "energy":
            return True
        if self.is_clamped:  # walls push and turn bodies
            return False
        if name == self.names.get("linear"):
            return True
        if self.strand.advected:  # fields turn bodies
            return False
        if name == self.names["momentum"]:
            return True
        claimed = {each.formula.text for each in self.spec.conserved if not each.where}
        momenta = [name for each in self.strand.momenta for name in each.components]
        field = self.strand.field
        (each,) = (x for x in self.spec.observables if x.name == name)
        slopes = (field.gradient(x, momenta) for x in self._of_momenta(each) or ())
        linear = all(not field.reach(x) & {*momenta} for slope in slopes for x in slope)
        return name in claimed and linear

    def _left_out(self) -> list[str]:
        """What the strand has and the lattice has not."""
        kept = {"energy", *self._observables}
        observed = [each.name for each in self.spec.observables if each.name not in kept]
        claimed = [each.formula.text for each in self.spec.conserved]
        claimed += [each.text for each in self.spec.casimirs]
        more = [text for text in claimed if text not in {*kept, *observed}]
        pair = ["the Lax pair"] if self.spec.lax is not None else []
        return [" ".join(text.split()) for text in (*observed, *more)] + pair


def _place_components(each: Parameter) -> dict[str, str]:
    """How formulas name the components of a parameter: ``K[1]`` of ``K1``."""
    if not each.shape:
        return {each.name: each.name}
    size = matrix_size(each.shape[0], each.form)
    places = kept_places(size, each.form) if size else product(*map(range, each.shape))
    counted = (", ".join(str(n + 1) for n in place) for place in places)
    return {c: f"{each.name}[{n}]" for c, n in zip(each.components, counted, strict=True)}


def _unit(unit: str) -> str:
    return "" if unit in ("", "1") else f", unit = {_quote(unit)}"


def _quote(text: str) -> str:
    """A string of TOML."""
    return json.dumps(text, ensure_ascii=False)


def _number(value: Fraction) -> str:
    return str(value) if value.denominator == 1 else f'"{value}"'


def _write_default(values: tuple[Fraction, ...], shape: tuple[int, ...]) -> str:
    """One number, a list, or a list of rows."""
    texts = [_number(value) for value in values]
    if not shape:
        return texts[0]
    width = shape[-1]
    rows = [f"[{', '.join(texts[n : n + width])}]" for n in range(0, len(texts), width)]
    return rows[0] if len(shape) == 1 else f"[{', '.join(rows)}]"


def _write_numbers(values: Array) -> object:
    """Lists of numbers, those that are not whole as texts of decimals."""
    if values.ndim:
        return [_write_numbers(value) for value in values]
    rounded = round(float(values), _DIGITS)
    return int(rounded) if rounded == int(rounded) else f"{rounded:.{_DIGITS}f}".rstrip("0")
