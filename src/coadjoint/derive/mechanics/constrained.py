r"""Constrained motion: what the routes with constraints share in addition to the kinematics.

A route puts matrix and right side into :math:`\mathcal{M} \dot\eta = k`; constraints that are kept
join them with their multipliers, the kernel solves, and the reactions follow. A force may be
proportional to reactions, as friction is: with :math:`k = k_0 + C \lambda` and
:math:`u = -\lambda` the kernel solves

.. math::
    \begin{pmatrix} \mathcal{M} & A^T + C \\ A & 0 \end{pmatrix}
    \begin{pmatrix} \dot\eta \\ u \end{pmatrix}
        = \begin{pmatrix} k_0 \\ -\dot A \eta + \dot b \end{pmatrix}.

Comes in: the Kinematics of a system, and what a route makes of it. Goes out: Equations.
Read next: `coadjoint.derive.routes.nonholonomic`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from coadjoint.derive.emitted import list_emitted
from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.almost_poisson import almost_poisson, reduced_momenta
from coadjoint.derive.mechanics.configuration import LARGEST_BLOCK, coupled_blocks, mechanics
from coadjoint.derive.mechanics.decided import Decided
from coadjoint.derive.mechanics.distribution import Distribution, Equation, Row
from coadjoint.derive.mechanics.frames import Frame
from coadjoint.derive.mechanics.kinematics import (
    Kinematics,
    Matrix,
    kinematics,
    multiplier_name,
    rate_name,
)
from coadjoint.derive.mechanics.relaxed import relaxed
from coadjoint.derive.mechanics.solver import Definition, Solve, definitions_under, solve_in_kernel
from coadjoint.derive.records import Exact, Step, write_entries, write_step
from coadjoint.derive.setting import Setting, fault, lagrangian_fault
from coadjoint.errors import DerivationError, LimitError
from coadjoint.exact import Element
from coadjoint.exact.ranks import certain_minors, generic_rank
from coadjoint.exact.roots import simplify_roots
from coadjoint.limits import OPERATIONS
from coadjoint.notation.elements import write_element


@dataclass(frozen=True)
class ConstrainedMotion:
    """What a route makes of the kinematics: what the kernel solves for, and what rests on it.

    Attributes:
        kinematics: Of the system, shared by all routes.
        decided: What is known exactly of the definitions of this route.
    """

    kinematics: Kinematics
    decided: Decided

    @property
    def distribution(self) -> Distribution:
        """What the constraints allow."""
        return self.kinematics.distribution

    @property
    def frame(self) -> Frame:
        """The velocities and their fields."""
        return self.distribution.frame

    @cached_property
    def accelerations(self) -> Row:
        """``d eta/dt``, symbols."""
        setting = self.frame.setting
        return setting.elements([rate_name(name) for name in self.distribution.independent])

    def of_kept(self) -> tuple[Matrix, Row]:
        """``A eta' = k`` of the constraints that are kept."""
        field, known, name = self.frame.setting.field, [], self.kinematics.name_of_entry
        eta = self.frame.setting.elements(self.distribution.independent)
        matrix = [tuple(map(name, row[:-1])) for row in self.distribution.kept_rows]
        for *row, rest in self.distribution.kept_rows:
            carried = [self.kinematics.rate(a) * x for a, x in zip(row, eta, strict=True)]
            known.append(-field.sum([*carried, self.kinematics.rate(rest)]))
        return tuple(matrix), tuple(known)

    def pull(self, known: Sequence[Element]) -> Row:
        """``k + A^T lambda``, with the reactions of the constraints that are kept."""
        field, (rows, _) = self.frame.setting.field, self.of_kept()
        reactions = self.frame.setting.elements(self.pressing)
        return tuple(
            force + field.sum(row[i] * x for row, x in zip(rows, reactions, strict=True))
            for i, force in enumerate(known)
        )

    def show_kept(self) -> Step:
        """The step that differentiates the constraints that are kept; without them no line."""
        field, (rows, known) = self.frame.setting.field, self.of_kept()
        sides = (
            field.sum(a * x for a, x in zip(row, self.accelerations, strict=True)) for row in rows
        )
        return write_step(
            "Constraints, differentiated",
            "A eta' = b' - A' eta",
            r"A \dot\eta = \dot b - \dot A \eta",
            zip((write_element(field, side) for side in sides), known, strict=True),
            by="constraints",
        )

    def solves(self, mass: Matrix, known: Sequence[Element]) -> tuple[Solve, ...]:
        """The linear equations of accelerations and multipliers, block by block.

        ``[[mass, A^T + C], [A, 0]] (eta', u) = (k_0, k)`` with u minus the multipliers, symmetric
        where no force names a reaction. Entries that are identically zero are zero, so that every
        route finds the same blocks.

        Args:
            mass: The reduced mass matrix.
            known: What it times the accelerations is, where reactions may be named.
        """
        field, of, value = self.frame.setting.field, self.distribution, self.decided.value
        rows, carried = self.of_kept()
        none = [field.zero] * len(rows)
        pulls = [field.gradient(k, self.pressing) for k in known]
        whole = [
            *(
                (*map(value, row), *(a[i] + value(c) for a, c in zip(rows, pulls[i], strict=True)))
                for i, row in enumerate(mass)
            ),
            *((*row, *none) for row in rows),
        ]
        sides = [*map(value, map(self.without_reactions, known)), *map(value, carried)]
        names = [
            *map(rate_name, of.independent),
            *map(multiplier_name, range(len(rows))),
        ]
        unlike = {i for i, row in enumerate(pulls) if any(row)}
        return tuple(
            Solve(
                matrix=tuple(tuple(whole[i][j] for j in block) for i in block),
                known=[sides[i] for i in block],
                block=block,
                names=[names[i] for i in block],
                symmetric=not unlike & {*block},
            )
            for block in coupled_blocks(tuple(whole))
        )

    @cached_property
    def pressing(self) -> list[str]:
        """The reactions of the constraints that are kept, which forces may name."""
        return [equation.reaction for equation, _ in self.distribution.kept]

    def without_reactions(self, force: Element) -> Element:
        """What is left of a force where all reactions are zero."""
        field = self.frame.setting.field
        if not field.reach(force) & {*self.pressing}:
            return force
        return field.substitute(force, dict.fromkeys(self.pressing, field.zero))

    def reactions(self, mass: Matrix, forces: Sequence[Element]) -> list[Definition]:
        """Rates of the velocities that constraints give, then the multipliers of all constraints.

        Args:
            mass: ``d2l/dxi2`` in the frame.
            forces: ``F - M c - dp/dz dz/dt`` in the frame, as a route names them.
        """
        field, of = self.frame.setting.field, self.distribution
        known, names = self.kinematics, self.frame.velocities
        turned = [
            field.sum(b * x for b, x in zip(row, self.accelerations, strict=True))
            for row in known.B
        ]
        rates = [(rate_name(names[n]), turned[n] + known.c[n]) for n in known.solved]
        values = {
            equation.reaction: -field[multiplier_name(n)] for n, (equation, _) in enumerate(of.kept)
        }
        rows = dict(zip((each.reaction for each in of.equations), of.A, strict=True))
        for place, equation in self._order_given():
            inertia = field.sum(m * t for m, t in zip(mass[place], turned, strict=True))
            others = field.sum(
                rows[name][place] * field[name] for name in values if rows[name][place] != 0
            )
            own = rows[equation.reaction][place]
            values[equation.reaction] = (inertia - forces[place] - others) / own
        return [*rates, *values.items()]

    def _order_given(self) -> Iterator[tuple[int, Equation]]:
        """Given velocities with their constraints, those first that no other constraint names.

        Along such a velocity ``p' - F = A^T lambda`` has but one multiplier that is not known yet.
        """
        of, waiting = self.distribution, list(self.kinematics.solved)
        giving = {
            self.frame.velocities.index(each.solves): (each, row)
            for each, row in zip(of.equations, of.A, strict=True)
            if each.solves
        }
        while waiting:
            place = next(n for n in waiting if all(giving[o][1][n] == 0 for o in waiting if o != n))
            waiting.remove(place)
            yield place, giving[place][0]


def start_motion(setting: Setting) -> ConstrainedMotion:
    """The motion of a system before a route has added to the kinematics."""
    known = kinematics(setting)
    assert known.definitions is not None, "they are decided first"
    return ConstrainedMotion(known, known.decided.copy())


def emit_motion(
    motion: ConstrainedMotion,
    route: str,
    mass: Matrix,
    known: Sequence[Element],
    steps: Callable[[Exact], Iterable[Step]],
    *,
    named: Sequence[Definition] = (),
    reactions: Sequence[Definition] = (),
) -> Equations:
    """The Equations as a kernel computes them.

    Args:
        motion: The kinematics.
        route: Name of the route.
        mass: The reduced mass matrix of eta.
        known: What it times ``d eta/dt`` is.
        steps: The derivation; steps without lines are left out.
        named: What the route computes before the solve, after the kinematics.
        reactions: What rests on the accelerations.
    """
    setting, of = motion.frame.setting, motion.distribution
    _check_linear_in_reactions(motion, known)
    gained, relaxing = relaxed(setting), list[Definition]()
    if gained is not None:
        relaxing = motion.decided.list_computed(gained.definitions)
        forces = map(motion.decided.value, gained.forces)
        known = [a + b for a, b in zip(known, forces, strict=True)]
    field, definitions = setting.field, (*motion.kinematics.definitions, *named, *relaxing)
    solves = motion.solves(mass, known)
    for solve in solves:
        _check_regular(motion, solve, definitions)
    solved = [line for solve in solves for line in solve_in_kernel(field, solve, motion.decided)]
    moving = dict(zip(of.independent, motion.accelerations, strict=True))
    for name, rate in motion.kinematics.position_rates.items():
        own = field.zero if gained is None else motion.decided.value(gained.added[name])
        moving[name] = rate + own
    energy = mechanics(setting).energy
    closed = field.substitute(energy, of.solved)
    # sin^2 + cos^2 = 1, where velocities are along a turning frame
    short = simplify_roots(field, closed)
    energy = short if len(field.terms(short)) < len(field.terms(closed)) else energy
    exact = Exact(
        definitions=(*definitions, *solved, *motion.decided.list_computed(reactions)),
        rates=tuple(moving[name] for name in setting.state),
        energy=energy,
        emitted=list_emitted(setting, energy, reduced_momenta(of)),
        poisson_tensor=almost_poisson(setting),
        solves=solves,
        residuals=(
            *((each.name, each.residual) for each in of.equations),
            *(() if of.frame.touch is None else of.frame.touch.residuals),
        ),
    )
    shown = tuple(step for step in steps(exact) if step.lines)
    return Equations(setting=setting, route=route, exact=exact, steps=shown, distribution=of)


def show_mass(mass: Matrix, text: str, latex: str) -> Step:
    """The step that gives the reduced mass matrix."""
    return write_step(
        "Reduced mass matrix", text, latex, write_entries("M", mass), by="constraints"
    )


def _check_regular(
    motion: ConstrainedMotion, solve: Solve, definitions: Sequence[Definition]
) -> None:
    """The leading minors of a block, of which the pivots are quotients, vanish nowhere generic."""
    setting = motion.frame.setting
    if solve.operations > OPERATIONS:
        raise LimitError(
            f"{setting.spec.path}: constraints, kinetic energy and forces that name reactions "
            f"couple {len(solve.block)} accelerations and multipliers; to solve for them takes "
            f"about {solve.operations} operations; expected at most {OPERATIONS} (OPERATIONS). "
            "Write constraints as Y == ..., which gives velocities.",
            path=str(setting.spec.path),
            found=solve.operations,
            limit=OPERATIONS,
        )
    known: dict[str, Element] = {}
    entries = [entry for row in solve.matrix for entry in row]
    for name, value in definitions_under(setting.field, definitions, entries):
        known[name] = setting.field.substitute(value, known)
    matrix = [[setting.field.substitute(e, known) for e in row] for row in solve.matrix]
    if len(matrix) > LARGEST_BLOCK and certain_minors(setting.field, matrix) == len(matrix):
        return
    for k in range(1, len(matrix) + 1):
        leading = [{j: e for j, e in enumerate(row[:k]) if e != 0} for row in matrix[:k]]
        if generic_rank(setting.field, leading) < k:
            raise _singular(motion, solve, k)


def _check_linear_in_reactions(motion: ConstrainedMotion, known: Sequence[Element]) -> None:
    """Forces are linear in the reactions that they name, so that the kernel can solve for them."""
    field = motion.frame.setting.field
    for force in known:
        for name, slope in zip(
            motion.pressing, field.gradient(force, motion.pressing), strict=True
        ):
            if not field.reach(slope) & {*motion.pressing}:
                continue
            raise _fault_of_force(
                motion,
                name,
                f"the forces are not linear in {name}; expected forces proportional to reactions, "
                "which the kernel solves for together with the accelerations. Write what presses "
                "as a scalar constraint of its own, such as dot(Gamma, v) == 0, whose reaction is "
                "the normal force, and friction as its multiple along the slip velocity.",
            )


def _fault_of_force(motion: ConstrainedMotion, reaction: str, message: str) -> DerivationError:
    """A fault of the force, or of Rayleigh's function, that names a reaction."""
    setting = motion.frame.setting
    spec = setting.spec
    acting = [*spec.forces.values(), *([spec.dissipation] if spec.dissipation else [])]
    values = ((each, setting.components(each, setting.reactions)) for each in acting)
    naming = (
        formula
        for formula, parts in values
        if any(reaction in setting.field.reach(part) for part in parts)
    )
    return fault(setting, next(naming), message, reaction)


def _singular(motion: ConstrainedMotion, solve: Solve, size: int) -> DerivationError:
    """What is wrong where the first unknowns of a block are not determined."""
    setting, names = motion.frame.setting, solve.names[:size]
    multipliers = {multiplier_name(n): name for n, name in enumerate(motion.pressing)}
    if not solve.symmetric and names[-1] in multipliers:
        name = multipliers[names[-1]]
        return _fault_of_force(
            motion,
            name,
            f"the forces cancel {name} in its own constraint, so that nothing determines it; "
            "expected forces that leave the reaction its effect on the constraint. Remove "
            f"{name} from the force, or let it act along the directions that the constraint "
            "leaves free, as friction does.",
        )
    text = ", ".join(name for name in names if not name.startswith("_"))
    return lagrangian_fault(
        setting,
        f"the reduced mass matrix is singular: nothing gives {text}; expected a kinetic energy "
        "that is positive for every velocity that the constraints allow. Add the missing kinetic "
        "term, or constrain the velocity.",
        text,
    )
