r"""Constrained motion: what the routes with constraints share beside the kinematics.

A route puts matrix and right side into :math:`\mathcal{M} \dot\eta = k`; constraints that are kept
join them with their multipliers, the kernel solves, and the reactions follow.
Comes in: the Kinematics of a distribution. Goes out: the Exact part of Equations.
Read next: `coadjoint.derive.routes.nonholonomic`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from coadjoint.derive.emitted import emitted
from coadjoint.derive.mechanics.almost_poisson import almost_poisson, reduced_momenta
from coadjoint.derive.mechanics.configuration import coupled_blocks, fault, mechanics
from coadjoint.derive.mechanics.distribution import Distribution, Equation, Row
from coadjoint.derive.mechanics.kinematics import (
    Kinematics,
    Matrix,
    kept_rows,
    multiplier_name,
    rate_name,
)
from coadjoint.derive.mechanics.solver import Definition, Solve, solve_in_kernel
from coadjoint.derive.records import Exact
from coadjoint.errors import DerivationError, LimitError
from coadjoint.exact import Element
from coadjoint.exact.ranks import generic_rank
from coadjoint.exact.roots import lifted
from coadjoint.limits import COUPLED_VELOCITIES
from coadjoint.spec.model import Section


@dataclass(frozen=True)
class ConstrainedMotion(Kinematics):
    """Kinematics with accelerations: what the kernel solves for, and what rests on it."""

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
        Entries that are identically zero are zero, so that every route finds the same blocks.
        """
        field, found, value = self.frame.setting.field, self.distribution, self.decided.value
        rows, carried = self.of_kept()
        none = [field.zero] * len(rows)
        whole = [
            *((*map(value, row), *(a[i] for a in rows)) for i, row in enumerate(mass)),
            *((*row, *none) for row in rows),
        ]
        sides = [*map(value, known), *map(value, carried)]
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
    definitions: Sequence[Definition],
    mass: Matrix,
    known: Sequence[Element],
    reactions: Sequence[Definition],
) -> Exact:
    """The equations as a kernel computes them.

    Args:
        motion: The kinematics.
        definitions: What a route computes before the solve.
        mass: The reduced mass matrix of eta.
        known: What it times ``d eta/dt`` is.
        reactions: What rests on the accelerations.
    """
    setting = motion.frame.setting
    field = setting.field
    solves = motion.solves(mass, known)
    for solve in solves:
        _check_regular(motion, solve, definitions)
    solved = [line for solve in solves for line in solve_in_kernel(field, solve, motion.decided)]
    moving = dict(zip(motion.distribution.independent, motion.accelerations, strict=True))
    moving |= motion.position_rates
    rates = tuple(moving[name] for name in setting.state)
    energy = mechanics(setting).energy
    closed = field.substitute(energy, motion.distribution.solved)
    short = lifted(field, closed)  # sin^2 + cos^2 = 1, where velocities are along a turning frame
    energy = short if len(field.terms(short)) < len(field.terms(closed)) else energy
    residuals = tuple((e.name, e.residual) for e in motion.distribution.equations)
    along = [
        *reduced_momenta(motion.distribution),
        *section_momenta(motion.distribution),
    ]
    return Exact(
        (*definitions, *solved, *motion.computed(reactions)),
        rates,
        energy,
        emitted(setting, energy, along),
        almost_poisson(setting),
        solves,
        residuals,
    )


def section_momenta(found: Distribution) -> list[tuple[str, Element]]:
    """``<dl/dxi, B sigma>`` of every declared section sigma, in all velocities."""
    setting = found.setting
    momenta = mechanics(setting).momenta
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
    along = section_components(found, section)
    return tuple(
        found.setting.field.sum(b * x for b, x in zip(row, along, strict=True)) for row in found.B
    )


def section_components(found: Distribution, section: Section) -> Row:
    """``sigma``: the components of a section along the independent velocities."""
    setting = found.setting
    parts = dict.fromkeys(found.independent, setting.field.zero)
    for variable in setting.spec.variables:
        if variable.name in section.section:
            values = setting.components(section.section[variable.name])
            parts |= dict(zip(variable.components, values, strict=True))
    return tuple(parts.values())


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
