r"""Kinematics of a constrained motion: everything that rests on velocities and positions alone.

The kernel computes in the order of a careful hand: moving entries of B (``_b1``), the velocities
that constraints give, the rates of positions (``dGamma1_dt``), those of square roots (``_g1``) and
of the entries (``_e1``), and the part :math:`c = \dot B \eta + \dot\beta` of the accelerations
that needs none (``_c1``). What is identically zero is left out.
Comes in: a Setting. Goes out: these definitions, and what they are called: built once, for every
route.
Read next: `coadjoint.derive.mechanics.constrained`, which solves for the accelerations.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from coadjoint.derive.assembly import make_setting
from coadjoint.derive.mechanics.configuration import (
    LARGEST_BLOCK,
    coupled_blocks,
    sampled_mechanics,
)
from coadjoint.derive.mechanics.contact import contact_names
from coadjoint.derive.mechanics.decided import Decided
from coadjoint.derive.mechanics.distribution import Distribution, Row, distribution
from coadjoint.derive.mechanics.driving import explicit_rate
from coadjoint.derive.mechanics.frames import Frame
from coadjoint.derive.mechanics.parts import part_names, parts
from coadjoint.derive.mechanics.solver import (
    WRITTEN,
    Definition,
    loop_names,
    names_for,
    solver_names,
)
from coadjoint.derive.setting import Setting, once
from coadjoint.errors import DerivationError
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


def moved_names(spec: Spec) -> dict[str, str]:
    """Names of the entries of attitudes that were moved back to rotations, by those before."""
    turning = (name for each in spec.turning for name in each.components)
    return {name: f"_v{n}" for n, name in enumerate(turning, 1)}


def symbols(spec: Spec) -> tuple[str, ...]:
    """The names that the definitions of a motion over a frame need."""
    blocks = None if spec.in_frame else _find_blocks(spec)
    if blocks is not None and max(map(len, blocks), default=0) <= LARGEST_BLOCK:
        return ()
    known = kinematics(make_setting(spec))
    of = known.distribution
    entries = range(1, len(known.entries) + 1)
    return (
        *(f"_b{n}" for n in entries),
        *map(rate_name, of.frame.positions),
        *(contact_names() if of.frame.touch else ()),
        *(name for names in part_names(spec).values() for name in names),
        *(f"_g{n + 1}" for n in range(len(known.roots))),
        *(f"_e{n}" for n in entries),
        *(f"_c{n + 1}" for n in range(len(known.solved))),
        *(f"_k{n + 1}" for n in range(len(of.frame.velocities))),
        *map(rate_name, of.frame.velocities),
        *_names_of_solves(blocks, len(of.independent) + len(of.kept)),
        *map(multiplier_name, range(len(of.kept))),
        *map(shift_name, range(len(of.independent) if of.kept else 0)),
        *(moved_names(spec).values() if of.kept or of.frame.touch else ()),
        *(equation.reaction for equation in of.equations),
    )


def _names_of_solves(blocks: Sequence[Sequence[int]] | None, count: int) -> list[str]:
    """The names that the solves of so many unknowns need: of their blocks, where they are known.

    Every name of the field slows down all that is computed in it.
    """
    if blocks is None:
        loops = loop_names(range(count)) if count > WRITTEN else []
        return list(dict.fromkeys((*solver_names(range(count)), *loops)))
    return list(dict.fromkeys(name for block in blocks for name in names_for(block)))


def _find_blocks(spec: Spec) -> list[tuple[int, ...]]:
    """Which velocities are coupled, where those of coordinates are the state; else none."""
    if (
        spec.kind != "configuration"
        or spec.lagrangian is None
        or spec.having_role("momentum")
        or "euler-lagrange" not in spec.routes
    ):
        return []
    try:
        return coupled_blocks(sampled_mechanics(spec).mass)
    except DerivationError:  # the route will say so
        return []


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
    def _moving(self) -> frozenset[str]:
        """Names that a motion changes by itself: positions, inputs with known rates, and time."""
        return frozenset((*self.frame.positions, *self.frame.setting.own_rates))

    @cached_property
    def entries(self) -> list[Element]:
        """What ``_b1``, ... are: moving entries of B, beta and A, no symbols, up to their signs."""
        field, of = self.frame.setting.field, self.distribution
        symbols = [sign * field[name] for name in self._moving for sign in (1, -1)]
        given = [e for n in self.solved for e in (*of.B[n], of.beta[n])]
        known: list[Element] = []
        for entry in (*given, *(e for row in of.kept_rows for e in row)):
            if not field.reach(entry) & self._moving or entry in symbols:
                continue
            if not any(entry == other or entry == -other for other in known):
                # a minus sign in front costs a negation
                negative = field.quotients(entry)[0].monomials[0].number < 0
                known.append(-entry if negative else entry)
        return known

    def _look_up(self, entry: Element, letter: str) -> Element | None:
        """The name for an entry, up to its sign; None where it has none."""
        field = self.frame.setting.field
        for n, known in enumerate(self.entries, 1):
            if entry in (known, -known):
                return field[f"{letter}{n}"] if entry == known else -field[f"{letter}{n}"]
        return None

    def name_of_entry(self, entry: Element) -> Element:
        """An entry of B, beta or A, by its name where it has one."""
        named = self._look_up(entry, "_b")
        return entry if named is None else named

    def rate(self, entry: Element) -> Element:
        """The time derivative of an entry, by its name where it has one."""
        named = self._look_up(entry, "_e")
        return self.differentiate(entry) if named is None else named

    def differentiate(self, function: Element, name: str = "") -> Element:
        """``dz/dt . df/dz + df/dt`` of a function of positions, with the rates by their names.

        A square root h moves by its rate: ``N/h`` by ``(N' - (N/h) h')/h``, with the name of N/h.
        """
        setting = self.frame.setting
        field, rates = setting.field, {**self.position_rates, **setting.own_rates}
        explicit_rate(setting, function, "a constraint or a momentum")
        slopes = dict(zip(rates, field.gradient(function, rates), strict=True))
        parts = []
        for n, root in enumerate(self.roots, 1):
            outer = field.derivative(function, root)
            if outer == 0:
                continue
            inner = zip(rates, field.gradient(field[root], rates), strict=True)
            slopes |= {z: slopes[z] - outer * slope for z, slope in inner}
            rest = function + field[root] * outer  # what is not over h
            if name and root not in field.functions_in(rest):
                outer = (rest - field[name]) / field[root]
            parts.append(outer * field[f"_g{n}"])
        return field.sum([*(s * rates[z] for z, s in slopes.items() if s != 0), *parts])

    @cached_property
    def roots(self) -> list[str]:
        """Square roots in moving entries, whose rates ``_g1``, ``_g2``, ... are computed once."""
        field = self.frame.setting.field
        present = frozenset[str]().union(*map(field.functions_in, self.entries))
        return [
            name
            for name, known in field.adjoined.items()
            if name in present
            and known.function == "sqrt"
            and field.is_function_free(known.argument)
        ]

    def _rates_of_roots(self) -> list[Definition]:
        """``h' = u'/(2 h)`` of ``h = sqrt(u)``."""
        field = self.frame.setting.field
        return [
            (f"_g{n}", self.differentiate(field.adjoined[root].argument) / (2 * field[root]))
            for n, root in enumerate(self.roots, 1)
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
        velocities = self.frame.setting.elements(self.frame.velocities)
        return {**self.frame.rates_apart(velocities), **self._touching[1]}

    @cached_property
    def _touching(self) -> tuple[list[Definition], Mapping[str, Element]]:
        """What is computed once of a body that touches a surface, and the rates in terms of it."""
        frame = self.frame
        if frame.touch is None:
            return [], {}
        return frame.touch.list_lines(frame.turning(frame.setting.elements(frame.velocities)))

    def _is_velocity(self, position: str) -> bool:
        field, value = self.frame.setting.field, self.frame_rates[position]
        return any(value == field[name] for name in self.frame.velocities)

    @cached_property
    def solved(self) -> list[int]:
        """Places of the velocities that constraints give."""
        names = self.distribution.solved
        return [n for n, name in enumerate(self.frame.velocities) if name in names]

    @cached_property
    def B(self) -> Matrix:
        """``d xi / d eta`` with names for its moving entries."""
        return tuple(tuple(map(self.name_of_entry, row)) for row in self.distribution.B)

    @cached_property
    def c(self) -> Row:
        """``dB/dt eta + dbeta/dt`` by name, a component for each velocity of the frame."""
        field, computed = self.frame.setting.field, {name for name, _ in self.definitions}
        names = {place: f"_c{n + 1}" for n, place in enumerate(self.solved)}
        return tuple(
            field[names[n]] if names.get(n) in computed else field.zero
            for n in range(len(self.frame.velocities))
        )

    @cached_property
    def _convected(self) -> Row:
        """The same, in the rates of the entries."""
        field, of = self.frame.setting.field, self.distribution
        eta = self.frame.setting.elements(of.independent)
        return tuple(
            field.sum([*(self.rate(b) * x for b, x in zip(row, eta, strict=True)), self.rate(beta)])
            for row, beta in zip(of.B, of.beta, strict=True)
        )

    def velocities(self) -> list[Definition]:
        """The velocities that constraints give, each from eta."""
        field, of = self.frame.setting.field, self.distribution
        eta = self.frame.setting.elements(of.independent)
        sums = {n: [b * x for b, x in zip(self.B[n], eta, strict=True)] for n in self.solved}
        return [
            (self.frame.velocities[n], field.sum([*parts, self.name_of_entry(of.beta[n])]))
            for n, parts in sums.items()
        ]

    @cached_property
    def decided(self) -> Decided:
        """What is known exactly of the definitions."""
        setting = self.frame.setting
        return Decided(setting.field, setting.state)

    @cached_property
    def definitions(self) -> list[Definition]:
        """Everything that rests on velocities and positions alone, in order."""
        entries = [(f"_b{n}", entry) for n, entry in enumerate(self.entries, 1)]
        rates = [(f"_e{name[2:]}", self.differentiate(entry, name)) for name, entry in entries]
        positions = [
            (rate_name(name), rate)
            for name, rate in self.frame_rates.items()
            if not self._is_velocity(name)
        ]
        convected = [(f"_c{n + 1}", self._convected[place]) for n, place in enumerate(self.solved)]
        roots, own = self._rates_of_roots(), parts(self.frame.setting)
        return self.decided.list_computed(
            [
                *(*entries, *self.velocities(), *self._touching[0]),
                *(*positions, *roots, *rates, *convected, *own),
            ]
        )


@once
def kinematics(setting: Setting) -> Kinematics:
    """The kinematics of a system, shared by all its routes."""
    return Kinematics(distribution(setting))
