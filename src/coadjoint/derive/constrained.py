r"""Constrained motion: what the routes with constraints share beside the distribution itself.

The kernel computes in the order of a careful hand: moving entries of B (``_b1``), the velocities
that constraints give, the rates of positions (``dGamma1_dt``), those of the entries (``_e1``), the
part :math:`c = \dot B \eta + \dot\beta` of the accelerations that needs none (``_c1``), then what a
route puts into :math:`\mathcal{M} \dot\eta = k`, and at last the reactions.
Comes in: a Distribution. Goes out: these definitions, and the Exact part of Equations. Routes make
matrix and right side by themselves.
Read next: `coadjoint.derive.nonholonomic`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from coadjoint.derive.almost_poisson import almost_poisson, reduced_momenta
from coadjoint.derive.configuration import fault
from coadjoint.derive.distribution import Distribution, Equation, Row, distribution
from coadjoint.derive.equations import Exact
from coadjoint.derive.frames import Frame
from coadjoint.derive.legendre import coupled_blocks
from coadjoint.derive.observables import observables
from coadjoint.derive.setting import make_setting
from coadjoint.derive.solver import Definition, Solve, solve_in_kernel, solver_names
from coadjoint.errors import DerivationError, LimitError
from coadjoint.exact import Element
from coadjoint.limits import COUPLED_VELOCITIES
from coadjoint.poisson.ranks import generic_rank
from coadjoint.spec import Spec
from coadjoint.spec.model import Section
from coadjoint.spec.names import derived_names

Matrix = tuple[Row, ...]


def rate_name(name: str) -> str:
    """Name of a time derivative: ``dOmega1_dt``."""
    return next(iter(derived_names([name])))


def multiplier_name(place: int) -> str:
    """Name of minus the multiplier of a constraint that is kept."""
    return f"_u{place + 1}"


def symbols(spec: Spec) -> tuple[str, ...]:
    """The names that the definitions of a constrained motion need."""
    found = distribution(make_setting(spec))
    solved = len(found.solved)
    count = len(_moving_entries(found))
    size = len(found.independent) + len(found.kept)
    return (
        *(f"_b{n + 1}" for n in range(count)),
        *map(rate_name, found.frame.positions),
        *(f"_e{n + 1}" for n in range(count)),
        *(f"_c{n + 1}" for n in range(solved)),
        *(f"_k{n + 1}" for n in range(len(found.frame.velocities))),
        *map(rate_name, found.frame.velocities),
        *solver_names(range(size)),
        *map(multiplier_name, range(len(found.kept))),
        *(equation.reaction for equation in found.equations),
    )


def _moving_entries(found: Distribution) -> list[Element]:
    """Entries of B, beta and A that move and are no symbols, each up to its sign."""
    field, moving = found.setting.field, set(found.frame.positions)
    kept = [e for row in kept_rows(found) for e in row]
    places = [n for n, name in enumerate(found.frame.velocities) if name in found.solved]
    given = [e for n in places for e in (*found.B[n], found.beta[n])]
    known: list[Element] = []
    for entry in (*given, *kept):
        if not field.reach(entry) & moving or is_symbol(found, entry):
            continue
        if not any(entry == other or entry == -other for other in known):
            known.append(entry)
    return known


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
    return any(entry in (field[name], -field[name]) for name in found.frame.positions)


@dataclass(frozen=True)
class ConstrainedMotion:
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

    def named(self, entry: Element) -> Element:
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
        return self.moved(entry)

    def moved(self, function: Element) -> Element:
        """``dz/dt . df/dz`` of a function of positions, with the rates by their names."""
        field = self.frame.setting.field
        pairs = zip(
            field.gradient(function, self.frame.positions), self.frame.positions, strict=True
        )
        return field.sum(slope * self.position_rates[name] for slope, name in pairs if slope != 0)

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
        return tuple(tuple(map(self.named, row)) for row in self.distribution.B)

    @cached_property
    def c(self) -> Row:
        """``dB/dt eta + dbeta/dt`` by name, a component for each velocity of the frame."""
        field = self.frame.setting.field
        names = {place: f"_c{n + 1}" for n, place in enumerate(self.solved)}
        return tuple(
            field[names[n]] if n in names and self._convected[n] != 0 else field.zero
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
                        self.named(found.beta[n]),
                    ]
                ),
            )
            for n in self.solved
        ]

    def kinematics(self) -> list[Definition]:
        """Everything that rests on velocities and positions alone, in order."""
        rates = self.frame_rates
        entries = [(f"_b{n + 1}", entry) for n, entry in enumerate(self.entries)]
        moved = [(f"_e{n + 1}", self.moved(entry)) for n, entry in enumerate(self.entries)]
        positions = [
            (rate_name(name), rates[name])
            for name in self.frame.positions
            if not self._is_velocity(name)
        ]
        convected = [
            (f"_c{n + 1}", self._convected[place])
            for n, place in enumerate(self.solved)
            if self._convected[place] != 0
        ]
        return [*entries, *self.velocities(), *positions, *moved, *convected]

    # -- accelerations ------------------------------------------------------------------

    @cached_property
    def accelerations(self) -> Row:
        """``d eta/dt``, symbols."""
        setting = self.frame.setting
        return setting.elements([rate_name(name) for name in self.distribution.independent])

    def of_kept(self) -> tuple[Matrix, Row]:
        """``A eta' = k`` of the constraints that are kept."""
        field, found = self.frame.setting.field, self.distribution
        eta = self.frame.setting.elements(found.independent)
        matrix, known = [], []
        for *row, rest in kept_rows(found):
            matrix.append(tuple(map(self.named, row)))
            carried = [self.rate(a) * x for a, x in zip(row, eta, strict=True)]
            known.append(-field.sum([*carried, self.rate(rest)]))
        return tuple(matrix), tuple(known)

    def solves(self, mass: Matrix, known: Sequence[Element]) -> tuple[Solve, ...]:
        """The linear equations of accelerations and multipliers, block by block.

        ``[[mass, A^T], [A, 0]] (eta', u) = (known, k)``, symmetric, with u minus the multipliers.
        """
        field, found = self.frame.setting.field, self.distribution
        rows, carried = self.of_kept()
        none = [field.zero] * len(rows)
        whole = [
            *((*row, *(a[i] for a in rows)) for i, row in enumerate(mass)),
            *((*row, *none) for row in rows),
        ]
        sides = [*known, *carried]
        names = [
            *map(rate_name, found.independent),
            *map(multiplier_name, range(len(rows))),
        ]
        return tuple(
            Solve(
                tuple(tuple(whole[i][j] for j in block) for i in block),
                [sides[i] for i in block],
                block,
                [names[i] for i in block],
            )
            for block in coupled_blocks(tuple(whole))
        )

    def reactions(self, mass: Matrix, forces: Sequence[Element]) -> list[Definition]:
        """Rates of the velocities that constraints give, then the multipliers of all constraints.

        Args:
            mass: ``d2l/dxi2`` in the frame.
            forces: ``F - M c - dp/dz dz/dt`` in the frame, as a route names them.
        """
        field, found = self.frame.setting.field, self.distribution
        turned = [
            field.sum(b * x for b, x in zip(row, self.accelerations, strict=True)) for row in self.B
        ]
        rates = [(rate_name(self.frame.velocities[n]), turned[n] + self.c[n]) for n in self.solved]
        values = {
            equation.reaction: -field[multiplier_name(n)]
            for n, (equation, _) in enumerate(found.kept)
        }
        rows = dict(zip((each.reaction for each in found.equations), found.A, strict=True))
        for place, equation in self._unravelled():
            inertia = field.sum(m * t for m, t in zip(mass[place], turned, strict=True))
            others = field.sum(
                rows[name][place] * field[name] for name in values if rows[name][place] != 0
            )
            own = rows[equation.reaction][place]
            values[equation.reaction] = (inertia - forces[place] - others) / own
        return [*rates, *values.items()]

    def _unravelled(self) -> Iterator[tuple[int, Equation]]:
        """Given velocities with their constraints, those first that no other constraint names.

        Along such a velocity ``p' - F = A^T lambda`` has but one multiplier that is not known yet.
        """
        found, waiting = self.distribution, list(self.solved)
        giving = {
            self.frame.velocities.index(each.solves): (each, row)
            for each, row in zip(found.equations, found.A, strict=True)
            if each.solves
        }
        while waiting:
            place = next(n for n in waiting if all(giving[o][1][n] == 0 for o in waiting if o != n))
            waiting.remove(place)
            yield place, giving[place][0]


def emission(
    motion: ConstrainedMotion,
    lagrangian: Element,
    definitions: Sequence[Definition],
    mass: Matrix,
    known: Sequence[Element],
    reactions: Sequence[Definition],
) -> Exact:
    """The equations as a kernel computes them.

    Args:
        motion: The kinematics.
        lagrangian: l in all velocities.
        definitions: What a route computes before the solve.
        mass: The reduced mass matrix of eta.
        known: What it times ``d eta/dt`` is.
        reactions: What rests on the accelerations.
    """
    setting, frame = motion.frame.setting, motion.frame
    field = setting.field
    solves = motion.solves(mass, known)
    for solve in solves:
        _check_regular(motion, solve, definitions)
    solved = [line for solve in solves for line in solve_in_kernel(field, solve)]
    moving = dict(zip(motion.distribution.independent, motion.accelerations, strict=True))
    moving |= motion.position_rates
    rates = tuple(moving[name] for name in setting.state)
    xi = setting.elements(frame.velocities)
    momenta = field.gradient(lagrangian, frame.velocities)
    energy = field.sum(p * x for p, x in zip(momenta, xi, strict=True)) - lagrangian
    residuals = tuple((e.name, e.residual) for e in motion.distribution.equations)
    along = [
        *reduced_momenta(motion.distribution, lagrangian),
        *section_momenta(motion.distribution, lagrangian),
    ]
    return Exact(
        (*definitions, *solved, *reactions),
        rates,
        energy,
        observables(setting, energy, along),
        almost_poisson(motion.distribution, lagrangian),
        solves,
        residuals,
    )


def section_momenta(found: Distribution, lagrangian: Element) -> list[tuple[str, Element]]:
    """``<dl/dxi, B sigma>`` of every declared section sigma, in all velocities."""
    setting, names = found.setting, found.frame.velocities
    momenta = setting.field.gradient(lagrangian, names)
    return [
        (
            each.name,
            setting.field.sum(
                p * x for p, x in zip(momenta, section_vector(found, each), strict=True) if x != 0
            ),
        )
        for each in setting.spec.sections
    ]


def section_vector(found: Distribution, section: Section) -> Row:
    """``B sigma``: a section as a vector of the frame."""
    setting = found.setting
    parts = dict.fromkeys(found.independent, setting.field.zero)
    for variable in setting.spec.variables:
        if variable.name in section.section:
            values = setting.components(section.section[variable.name])
            parts |= dict(zip(variable.components, values, strict=True))
    along = list(parts.values())
    return tuple(
        setting.field.sum(b * x for b, x in zip(row, along, strict=True)) for row in found.B
    )


def _check_regular(
    motion: ConstrainedMotion, solve: Solve, definitions: Sequence[Definition]
) -> None:
    """The leading minors of a block, of which the pivots are quotients, vanish nowhere generic."""
    setting = motion.frame.setting
    if len(solve.block) > COUPLED_VELOCITIES:
        raise LimitError(
            f"{setting.spec.path}: constraints and kinetic energy couple {len(solve.block)} "
            f"accelerations and multipliers; at most {COUPLED_VELOCITIES} (COUPLED_VELOCITIES) are "
            "solved for in the kernel. Write constraints as Y == ..., which gives velocities.",
            path=str(setting.spec.path),
            found=len(solve.block),
        )
    known: dict[str, Element] = {}
    for name, value in definitions:
        known[name] = setting.field.substitute(value, known)
    matrix = [[setting.field.substitute(e, known) for e in row] for row in solve.matrix]
    for k in range(1, len(matrix) + 1):
        leading = [{j: e for j, e in enumerate(row[:k]) if e != 0} for row in matrix[:k]]
        if generic_rank(setting.field, leading) < k:
            raise _singular(motion, solve.names[:k])


def _singular(motion: ConstrainedMotion, names: Sequence[str]) -> DerivationError:
    setting = motion.frame.setting
    formula = setting.spec.lagrangian
    assert formula is not None, "the reader asks for a Lagrangian"
    text = ", ".join(name for name in names if not name.startswith("_"))
    return fault(
        setting,
        formula,
        f"the reduced mass matrix is singular: nothing gives {text}; expected a kinetic energy "
        "that is positive for every velocity that the constraints allow. Add the missing kinetic "
        "term, or constrain the velocity.",
        text,
    )
