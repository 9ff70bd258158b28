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

from coadjoint.bodies.energy import Strand, pair_components, read_strand, refuse
from coadjoint.bodies.starts import Starts, find_starts
from coadjoint.derive.interpret import entries
from coadjoint.errors import LimitError, SpecError
from coadjoint.exact import Element
from coadjoint.exact.text import element_text
from coadjoint.spec import Spec, read_spec_text
from coadjoint.spec.core.components import kept_places, matrix_size

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.spec.model import Observable, Parameter

    Array = NDArray[np.float64]

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
#: Digits behind the point of momenta and attitudes at the beginning.
_DIGITS: Final = 14


def write_lattice(spec: Spec, bodies: int | None = None) -> str:
    """The spec of a lattice of rigid bodies whose limit is a strand, as text.

    Args:
        spec: A strand on so(3), left invariant, around a circle or between ends, whose energy
            per length is the sum of a function of momenta and advected vectors and a polynomial
            of strains.
        bodies: How many there are by default; as many as the strand has points if left out.

    Returns:
        The text of a spec with an index, which `coadjoint.read_spec` and `coadjoint.load` read from
        a file. Parameters are those of the strand with the distance of bodies in the place of the
        length; momenta and the energy are per length. Bodies begin with the momenta of the profile,
        and with the attitudes that its strain turns into, unless a ring does not close with them.

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
        taken = {strand.momentum.name, *(each.name for each in spec.parameters)} - {self.length}
        taken |= {each.name for each in spec.observables}
        taken |= {each.name for each in strand.advected}
        self.names = {use: self._choose(use, names, taken) for use, names in _NAMES.items()}
        self.place = self.names["index"]
        self.distance = self.names["distance"]
        self.attitude = self.names["attitude"]
        self.body = f"{self.attitude}[{self.place}]"

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
            for each in (self.strand.momentum, *self.strand.advected)
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
        yield '[algebra]\nname = "so(3)"\ninvariance = "left"'
        yield "[variables]\n" + "\n".join(self._variables())
        yield "[parameters]\n" + "\n".join(self._parameters())
        terms = [f"  sum({i}, {self.write(self.strand.own)})"]
        if self.strand.potential:
            yield "[definitions]\n" + "\n".join(self._definitions())
            turned = f"transpose({R})"
            terms.append(f"+ sum({i}, {self._call(f'{turned}*{self.attitude}[{i}+1]')})")
        if self._has_walls:  # the first wall has the attitude 1
            last = f"transpose({self.attitude}[{self.names['count']}-1])*{self.names['wall']}"
            terms += [f"+ {self._call(link)}" for link in (f"{self.attitude}[0]", last)]
        lines = "\n".join(terms)
        yield f'# the energy over {self.distance}\n[hamiltonian]\nh = """\n{lines}\n"""'
        left = self._left_out()
        note = f"# of the strand alone: {', '.join(left)}\n" if left else ""
        yield note + "[observables]\n" + "\n".join(self._observables.values())
        kept = [name for name in ("energy", *self._observables) if self._is_kept(name)]
        casimirs = [f"trace({R}*transpose({R}))", f"det({R})"]
        in_space = [f"({R}*{each.name}[{i}])" for each in self.strand.advected]
        casimirs += [f"{vector}[{n}]" for vector in in_space for n in (1, 2, 3)]
        yield f"[claims]\ncasimirs = {json.dumps(casimirs)}\nconserved = {json.dumps(kept)}"

    def _describe(self) -> str:
        row = "a row with free ends" if self.is_open else "a ring"
        row = "a row between two walls, which stand still," if self.is_clamped else row
        closes = "" if self.is_open else ", and the ring closes exactly"
        begin = "the profiles of the strand say"
        if self._starts.attitudes is None:
            begin += ", but that all stand alike"
        if self._starts.gap:
            begin += f": the holonomy of its strain is not 1 but for {self._starts.gap:.2g}"
        return (
            f"Rigid bodies in {row} at distances {self.distance}, with attitudes {self.attitude}, "
            f"whose limit is the strand of {self.spec.name}. The turn from one body to the next is "
            f"a rotation{closes}. Momenta and the energy are per length. Bodies begin as {begin}."
        )

    @cached_property
    def _starts(self) -> Starts:
        return find_starts(self.strand, self.bodies)

    def _variables(self) -> Iterator[str]:
        starts, Pi = self._starts, self.strand.momentum
        doc = Pi.doc or "angular momenta in body axes, per length"
        yield self._variable(self.attitude, "attitude", starts.attitudes, "from a body to space")
        yield self._variable(Pi.name, "momentum", starts.fields.get(Pi.name), doc, Pi.unit)
        for each in self.strand.advected:
            doc = each.doc or "in body axes"
            given = starts.fields.get(each.name)
            yield self._variable(each.name, "advected", given, doc, each.unit)

    def _variable(self, name: str, role: str, given: Array | None, doc: str, unit: str = "") -> str:
        """The line of a variable."""
        default = "" if given is None else f", default = {json.dumps(_write_numbers(given))}"
        more = ', representation = "vector"' if role == "advected" else ""
        keys = f'role = "{role}"{more}, index = "{self.place}"{default}{_unit(unit)}'
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
            wall = np.eye(3) if self._starts.wall is None else self._starts.wall
            rows = json.dumps(_write_numbers(wall))
            doc = "attitude of the wall behind the last body; that of the first wall is 1"
            yield f'{self.names["wall"]} = {{ shape = [3, 3], default = {rows}, doc = "{doc}" }}'

    # -- the potential --------------------------------------------------------------------

    @cached_property
    def _uses(self) -> tuple[bool, bool]:
        """Whether the potential has entries of x, and of S."""
        pairs = [pair_components(exponents) for exponents in self.strand.potential]
        return any(left for left, _ in pairs), any(paired for _, paired in pairs)

    def _arguments(self) -> Iterator[tuple[str, str]]:
        """What the potential depends on: the name of the function of links, and of the argument."""
        names = self.names
        either = (("turn", "first"), ("squares", "second"))
        for used, (function, argument) in zip(self._uses, either, strict=True):
            if used:
                yield names[function], names[argument]

    def _definitions(self) -> Iterator[str]:
        U, a, names = self.names["link"], self.distance, self.names
        first, second = self._uses
        if first:
            yield "# tends to the strain"
            parts = f"{U}[3, 2] - {U}[2, 3], {U}[1, 3] - {U}[3, 1], {U}[2, 1] - {U}[1, 2]"
            yield f'"{names["turn"]}({U})" = "vector({parts})/(2*{a})"'
        if second:
            yield "# tends to the products of components of the strain"
            one = f"(1 - trace({U}))*diag(vector(1, 1, 1))"
            yield f'"{names["squares"]}({U})" = "({U} + transpose({U}) + {one})/{a}^2"'
        arguments = ", ".join(argument for _, argument in self._arguments())
        if arguments:
            yield f'"{names["potential"]}({arguments})" = {_quote(self._write_potential())}'

    @property
    def _has_walls(self) -> bool:
        """Whether there are links to walls, which turn with nothing."""
        return self.is_clamped and any(self._uses)

    def _call(self, link: str) -> str:
        """The potential of a link."""
        values = [f"{function}({link})" for function, _ in self._arguments()]
        return f"{self.names['potential']}({', '.join(values)})"

    def _write_potential(self) -> str:
        """The potential as a formula in x and S."""
        x, S, terms = self.names["first"], self.names["second"], list[str]()
        # by degrees, and the first components first
        known = self.strand.potential
        for exponents in sorted(known, key=lambda each: (sum(each), [-n for n in each])):
            factor = known[exponents]
            left, pairs = pair_components(exponents)
            parts = [f"{x}[{n + 1}]" for n in left]
            parts += [f"{S}[{m + 1}, {n + 1}]" for m, n in pairs]
            text = self.write(factor)
            whole = f"({text})" if " " in text else text
            terms.append("*".join([whole, *parts]) if parts else whole)
        return " + ".join(terms).replace("+ -", "- ")

    # -- observables and claims -----------------------------------------------------------

    @cached_property
    def _observables(self) -> Mapping[str, str]:
        """The total momentum in space, and what the strand has without strains, by names."""
        i, J, Pi = self.place, self.names["momentum"], self.strand.momentum
        doc = f"total angular momentum in space, over {self.distance}"
        total = f"sum({i}, {self.body}*{Pi.name}[{i}])"
        rows = {J: f'{J} = {{ expression = "{total}"{_unit(Pi.unit)}, doc = "{doc}" }}'}
        for each in self.spec.observables:
            values = self._of_momenta(each)
            if values is None:
                continue
            texts = [self.write(value) for value in values]
            inner = f"vector({', '.join(texts)})" if each.formula.shape else texts[0]
            doc = f"{each.doc}, over {self.distance}" if each.doc else f"over {self.distance}"
            rows[each.name] = (
                f"{each.name} = {{ expression = {_quote(f'sum({i}, {inner})')}{_unit(each.unit)}, "
                f"doc = {_quote(doc)} }}"
            )
        return rows

    def _of_momenta(self, each: Observable) -> tuple[Element, ...] | None:
        """An observable of the strand by components, if it names no strains."""
        if len(each.formula.shape) > 1:
            return None
        equations, field = self.strand.equations, self.strand.field
        values = entries(equations.setting.value(each.formula))
        closed = tuple(map(equations.close, values))
        own = (self.strand.momentum, *self.strand.advected)
        known = {*(n for x in own for n in x.components), *field.adjoined}
        known |= {n for x in self.spec.parameters for n in x.components} - {self.length}
        return closed if all(field.reach(value) <= known for value in closed) else None

    def _is_kept(self, name: str) -> bool:
        """Whether the lattice keeps it: of the strand's, linear functions of momenta it keeps."""
        if name == "energy":
            return True
        if self.is_clamped or self.strand.advected:  # walls and fields turn bodies
            return False
        if name == self.names["momentum"]:
            return True
        claimed = {each.formula.text for each in self.spec.conserved if not each.where}
        momenta, field = self.strand.momentum.components, self.strand.field
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
