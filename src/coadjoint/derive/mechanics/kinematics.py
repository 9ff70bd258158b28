r"""Kinematics of a constrained motion: everything that rests on velocities and positions alone.

The kernel computes in the order of a careful hand: moving entries of B (``_b1``), the velocities
that constraints give, the rates of positions (``dGamma1_dt``), those of square roots (``_g1``) and
of the entries (``_e1``), and the part :math:`c = \dot B \eta + \dot\beta` of the accelerations
that needs none (``_c1``). What is identically zero is left out.
Comes in: a Distribution. Goes out: these definitions, and what they are called.
Read next: `coadjoint.derive.mechanics.constrained`, which solves for the accelerations.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

from coadjoint.derive.mechanics.decided import Decided
from coadjoint.derive.mechanics.distribution import Distribution, Row, distribution
from coadjoint.derive.mechanics.driving import explicit_rate
from coadjoint.derive.mechanics.frames import Frame
from coadjoint.derive.mechanics.parts import part_names, parts
from coadjoint.derive.mechanics.solver import Definition, solver_names
from coadjoint.derive.setting import make_setting
from coadjoint.exact import Element
from coadjoint.spec import Spec
from coadjoint.spec.core.names import derived_names

Matrix = tuple[Row, ...]


def rate_name(name: str) -> str:
    """Name of a time derivative: ``dOmega1_dt``."""
    return next(iter(derived_names([name])))


def multiplier_name(place: int) -> str:
    """Name of minus the multiplier of a constraint that is kept."""
    return f"_u{place + 1}"


def shift_name(place: int) -> str:
    """Name of the change of a velocity by which it comes onto the constraints that are kept."""
    return f"_s{place + 1}"


def symbols(spec: Spec) -> tuple[str, ...]:
    """The names that the definitions of a constrained motion need."""
    found = distribution(make_setting(spec))
    solved = len(found.solved)
    count = len(_moving_entries(found))
    size = len(found.independent) + len(found.kept)
    return (
        *(f"_b{n + 1}" for n in range(count)),
        *map(rate_name, found.frame.positions),
        *(name for names in part_names(spec).values() for name in names),
        *(f"_g{n + 1}" for n in range(len(_moving_roots(found)))),
        *(f"_e{n + 1}" for n in range(count)),
        *(f"_c{n + 1}" for n in range(solved)),
        *(f"_k{n + 1}" for n in range(len(found.frame.velocities))),
        *map(rate_name, found.frame.velocities),
        *solver_names(range(size)),
        *map(multiplier_name, range(len(found.kept))),
        *map(shift_name, range(len(found.independent) if found.kept else 0)),
        *(equation.reaction for equation in found.equations),
    )


def _moving_entries(found: Distribution) -> list[Element]:
    """Entries of B, beta and A that move and are no symbols, each up to its sign."""
    field = found.setting.field
    moving = {*found.frame.positions, *found.setting.own_rates}
    kept = [e for row in kept_rows(found) for e in row]
    places = [n for n, name in enumerate(found.frame.velocities) if name in found.solved]
    given = [e for n in places for e in (*found.B[n], found.beta[n])]
    known: list[Element] = []
    for entry in (*given, *kept):
        if not field.reach(entry) & moving or is_symbol(found, entry):
            continue
        if not any(entry == other or entry == -other for other in known):
            known.append(-entry if _is_negative(found, entry) else entry)
    return known


def _moving_roots(found: Distribution) -> list[str]:
    """Square roots in moving entries, of which each has its rate computed once."""
    field = found.setting.field
    present = frozenset[str]().union(*map(field.functions_in, _moving_entries(found)))
    return [
        name
        for name, known in field.adjoined.items()
        if name in present and known.function == "sqrt" and field.is_function_free(known.argument)
    ]


def _is_negative(found: Distribution, entry: Element) -> bool:
    """Whether an entry begins with a minus sign, which costs a negation."""
    return found.setting.field.quotients(entry)[0].monomials[0].number < 0


def kept_rows(found: Distribution) -> list[Row]:
    """``(A, -b)`` of the kept constraints, in eta."""
    field = found.setting.field
    rest = dict.fromkeys(found.independent, field.zero)
    return [
        (*field.gradient(residual, found.independent), field.substitute(residual, rest))
        for _, residual in found.kept
    ]


def is_symbol(found: Distribution, entry: Element) -> bool:
    """Whether an element is a name or minus a name, which needs no other."""
    field = found.setting.field
    names = (*found.frame.positions, *found.setting.own_rates)
    return any(entry in (field[name], -field[name]) for name in names)


@dataclass(frozen=True)
class Kinematics:
    """The kinematics of a distribution, its recurring values named.

    Attributes:
        distribution: What the constraints allow.
    """

    distribution: Distribution

    @property
    def frame(self) -> Frame:
        """The velocities and their fields."""
        return self.distribution.frame

    @cached_property
    def entries(self) -> list[Element]:
        """What ``_b1``, ``_b2``, ... are."""
        return _moving_entries(self.distribution)

    def name_of_entry(self, entry: Element) -> Element:
        """An entry of B, beta or A, by its name where it has one."""
        field = self.frame.setting.field
        for n, known in enumerate(self.entries):
            if entry == known:
                return field[f"_b{n + 1}"]
            if entry == -known:
                return -field[f"_b{n + 1}"]
        return entry

    def rate(self, entry: Element) -> Element:
        """The time derivative of an entry, by its name where it has one."""
        field = self.frame.setting.field
        for n, known in enumerate(self.entries):
            if entry == known:
                return field[f"_e{n + 1}"]
            if entry == -known:
                return -field[f"_e{n + 1}"]
        return self.differentiate(entry)

    def differentiate(self, function: Element, name: str = "") -> Element:
        """``dz/dt . df/dz + df/dt`` of a function of positions, with the rates by their names.

        A square root h moves by its rate: ``N/h`` by ``(N' - (N/h) h')/h``, with the name of N/h.
        """
        setting = self.frame.setting
        field, rates = setting.field, {**self.position_rates, **setting.own_rates}
        explicit_rate(setting, function, "a constraint or a momentum")
        slopes = dict(zip(rates, field.gradient(function, rates), strict=True))
        parts = []
        for n, root in enumerate(self.roots):
            outer = field.derivative(function, root)
            if outer == 0:
                continue
            inner = zip(rates, field.gradient(field[root], rates), strict=True)
            slopes |= {z: slopes[z] - outer * slope for z, slope in inner}
            rest = function + field[root] * outer  # what is not over h
            if name and root not in field.functions_in(rest):
                outer = (rest - field[name]) / field[root]
            parts.append(outer * field[f"_g{n + 1}"])
        return field.sum([*(s * rates[z] for z, s in slopes.items() if s != 0), *parts])

    @cached_property
    def roots(self) -> list[str]:
        """The generators of the square roots of which ``_g1``, ``_g2``, ... are the rates."""
        return _moving_roots(self.distribution)

    def _rates_of_roots(self) -> list[Definition]:
        """``h' = u'/(2 h)`` of ``h = sqrt(u)``."""
        field = self.frame.setting.field
        return [
            (
                f"_g{n + 1}",
                self.differentiate(field.adjoined[root].argument) / (2 * field[root]),
            )
            for n, root in enumerate(self.roots)
        ]

    @cached_property
    def position_rates(self) -> Mapping[str, Element]:
        """``dz/dt`` of the positions: a velocity where it is one, else a name."""
        field = self.frame.setting.field
        return {
            name: self.frame_rates[name] if self._is_velocity(name) else field[rate_name(name)]
            for name in self.frame.positions
        }

    @cached_property
    def frame_rates(self) -> Mapping[str, Element]:
        """``dz/dt`` in the velocities."""
        return self.frame.rates(self.frame.setting.elements(self.frame.velocities))

    def _is_velocity(self, position: str) -> bool:
        field, value = self.frame.setting.field, self.frame_rates[position]
        return any(value == field[name] for name in self.frame.velocities)

    @cached_property
    def solved(self) -> list[int]:
        """Places of the velocities that constraints give."""
        names = self.distribution.solved
        return [n for n, name in enumerate(self.frame.velocities) if name in names]

    @cached_property
    def independent(self) -> list[int]:
        """Places of the others."""
        return [n for n in range(len(self.frame.velocities)) if n not in self.solved]

    @cached_property
    def B(self) -> Matrix:
        """``d xi / d eta`` with names for its moving entries."""
        return tuple(tuple(map(self.name_of_entry, row)) for row in self.distribution.B)

    @cached_property
    def c(self) -> Row:
        """``dB/dt eta + dbeta/dt`` by name, a component for each velocity of the frame."""
        field, computed = self.frame.setting.field, {name for name, _ in self.kinematics}
        names = {place: f"_c{n + 1}" for n, place in enumerate(self.solved)}
        return tuple(
            field[names[n]] if names.get(n) in computed else field.zero
            for n in range(len(self.frame.velocities))
        )

    @cached_property
    def _convected(self) -> Row:
        """The same, in the rates of the entries."""
        field, found = self.frame.setting.field, self.distribution
        eta = self.frame.setting.elements(found.independent)
        return tuple(
            field.sum([*(self.rate(b) * x for b, x in zip(row, eta, strict=True)), self.rate(beta)])
            for row, beta in zip(found.B, found.beta, strict=True)
        )

    def velocities(self) -> list[Definition]:
        """The velocities that constraints give, each from eta."""
        field, found = self.frame.setting.field, self.distribution
        eta = self.frame.setting.elements(found.independent)
        return [
            (
                self.frame.velocities[n],
                field.sum(
                    [
                        *(b * x for b, x in zip(self.B[n], eta, strict=True)),
                        self.name_of_entry(found.beta[n]),
                    ]
                ),
            )
            for n in self.solved
        ]

    @cached_property
    def decided(self) -> Decided:
        """What is known exactly of the definitions so far."""
        setting = self.frame.setting
        return Decided(setting.field, setting.state)

    def list_computed(self, definitions: Iterable[Definition]) -> list[Definition]:
        """Definitions as the kernel computes them; intermediates that are zero are left out."""
        lines = [(name, self.decided.define(name, value)) for name, value in definitions]
        return [(name, value) for name, value in lines if value != 0 or not name.startswith("_")]

    @cached_property
    def kinematics(self) -> list[Definition]:
        """Everything that rests on velocities and positions alone, in order."""
        rates = self.frame_rates
        entries = [(f"_b{n + 1}", entry) for n, entry in enumerate(self.entries)]
        moved = [
            (f"_e{n + 1}", self.differentiate(entry, f"_b{n + 1}"))
            for n, entry in enumerate(self.entries)
        ]
        positions = [
            (rate_name(name), rates[name])
            for name in self.frame.positions
            if not self._is_velocity(name)
        ]
        convected = [(f"_c{n + 1}", self._convected[place]) for n, place in enumerate(self.solved)]
        roots = self._rates_of_roots()
        own = parts(self.frame.setting)
        return self.list_computed(
            [*entries, *self.velocities(), *positions, *roots, *moved, *convected, *own]
        )
