r"""The nonholonomic route: Lagrange and d'Alembert's principle on a system with a frame.

Theorem (Holm 2011, sections 12.2 and 12.3.2; Schneider 2002): with constraints
:math:`\xi = B(z)\,\eta + \beta(z)`, imposed after the variation, virtual displacements are the
columns of B, and

.. math::
    B^T \Big( \frac{d}{dt}\frac{\partial l}{\partial \xi}
        - \mathrm{ad}^*_\xi \frac{\partial l}{\partial \xi}
        - \frac{\partial l}{\partial a} \diamond a - f \Big) = 0.

With :math:`p = \partial l/\partial\xi`, :math:`M = \partial^2 l/\partial\xi^2` and
:math:`\dot\xi = B\dot\eta + c`, :math:`c = \dot B \eta + \dot\beta`, this is

.. math::
    B^T M B\,\dot\eta = B^T (F - M c - \partial_z p\,\dot z), \qquad
    F = \mathrm{ad}^*_\xi p + \frac{\partial l}{\partial a} \diamond a + f,

which the kernel solves. Constraints :math:`A\eta = b` that are kept join it with their multipliers.
The multipliers are recovered from the complementary projection, with the sign of

.. math:: \dot p - F = A^T \lambda, \qquad A = \partial(\text{left} - \text{right})/\partial\xi.

Comes in: a Setting with a Lagrangian and constraints. Goes out: Equations in velocities.
Read next: `coadjoint.derive.routes.hamel`, which starts from the constrained Lagrangian.
"""

from __future__ import annotations

from itertools import combinations

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.constrained import (
    ConstrainedMotion,
    emit_motion,
    show_mass,
    start_motion,
)
from coadjoint.derive.mechanics.distribution import Row
from coadjoint.derive.mechanics.external import external_forces
from coadjoint.derive.mechanics.followed import rates_followed
from coadjoint.derive.mechanics.frames import frame_of
from coadjoint.derive.mechanics.kinematics import Matrix
from coadjoint.derive.mechanics.solver import Definition
from coadjoint.derive.records import (
    Exact,
    Left,
    Step,
    bracket,
    component,
    rate,
    write_slopes,
    write_step,
)
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element
from coadjoint.exact.roots import simplify_roots

#: Terms of a bracket up to which the document shows it.
SHOWN = 8


def derive(setting: Setting) -> Equations:
    """Equations of motion by Lagrange and d'Alembert's principle.

    Raises:
        DerivationError: A constraint is not linear in the velocities or not independent of the
            others, the Lagrangian is not quadratic, or its reduced mass matrix is singular.
    """
    motion, whole = start_motion(setting), mechanics(setting)
    forces, named = _forces(motion)
    reduced = _project_mass(motion, whole.mass)
    known = _project_forces(motion, forces)
    reactions = motion.reactions(whole.mass, forces)

    def steps(exact: Exact) -> tuple[Step, ...]:
        return _steps(motion, named, reduced, known, reactions, _brackets(setting, exact))

    return emit_motion(
        motion, "nonholonomic", reduced, known, steps, named=named, reactions=reactions
    )


def _forces(motion: ConstrainedMotion) -> tuple[Row, list[Definition]]:
    """``F - M c - dp/dz dz/dt`` along each velocity, with names along those that are given."""
    frame, known, field = motion.frame, motion.kinematics, motion.frame.setting.field
    whole, xi = mechanics(frame.setting), frame.setting.elements(frame.velocities)
    parts = zip(
        frame.inertial(whole.momenta, xi),
        (simplify_roots(field, slope) for slope in frame.slopes(whole.lagrangian)),
        external_forces(frame.setting, frame.velocities),
        whole.mass,
        whole.momenta,
        strict=True,
    )
    forces = []
    named: list[Definition] = []
    for n, (inertial, slope, declared, row, p) in enumerate(parts):
        convected = field.sum(m * c for m, c in zip(row, known.c, strict=True))
        force = motion.without_reactions(declared)
        value = inertial + slope + force - convected - known.differentiate(p)
        if n in known.solved:
            lines = motion.decided.list_computed([(f"_k{n + 1}", value)])
            named += lines
            value = field[lines[0][0]] if lines else field.zero
        forces.append(value + (declared - force))
    return tuple(forces), named


def _project_mass(motion: ConstrainedMotion, mass: Matrix) -> Matrix:
    """``B^T M B``."""
    field, columns = motion.frame.setting.field, list(zip(*motion.kinematics.B, strict=True))
    turned = [
        [field.sum(m * b for m, b in zip(row, column, strict=True) if m and b) for row in mass]
        for column in columns
    ]
    return tuple(
        tuple(field.sum(b * x for b, x in zip(column, other, strict=True) if b) for other in turned)
        for column in columns
    )


def _project_forces(motion: ConstrainedMotion, forces: Row) -> Row:
    """``B^T`` times the forces."""
    field = motion.frame.setting.field
    return tuple(
        field.sum(b * f for b, f in zip(column, forces, strict=True) if b and f)
        for column in zip(*motion.kinematics.B, strict=True)
    )


def _steps(
    motion: ConstrainedMotion,
    named: list[Definition],
    reduced: Matrix,
    known: Row,
    reactions: list[Definition],
    brackets: list[tuple[Left, Element]],
) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    setting, of, velocities = motion.frame.setting, motion.distribution, motion.frame.velocities
    kinematics = motion.kinematics.definitions
    row, row_latex = "B^T M B eta'", r"B^\top M B \dot\eta"
    row_typst = "B^T M B dot(eta)"
    pull, pull_latex = (" + A^T lambda", r" + A^\top \lambda") if of.kept else ("", "")
    followed = rates_followed(setting, of)
    return (
        write_step(
            "Reduced Lagrangian",
            "l(xi, z)",
            r"l(\xi, z)",
            {"l": setting.lagrangian},
            by="stationary-action",
        ),
        write_step(
            "Constraints, imposed after the variation",
            "left - right = 0",
            r"A \xi = b",
            ((each.name, each.residual) for each in of.equations),
            by="constraints",
        ),
        write_step(
            "Distribution",
            "xi = B(z) eta + beta(z)",
            r"\xi = B(z) \eta + \beta(z)",
            of.solved,
            by="constraints",
        ),
        write_step(
            "Momenta",
            "p = dl/dxi",
            r"p = \partial l / \partial \xi",
            write_slopes("l", velocities, mechanics(setting).momenta),
            by="legendre",
        ),
        write_step(
            "Kinematics",
            "z' = X_xi z, c = B' eta + beta'",
            r"\dot z = X_\xi z, \qquad c = \dot B \eta + \dot \beta",
            (line for line in kinematics if line[0] not in of.solved),
            by="nonholonomic",
        ),
        show_mass(reduced, "B^T M B", r"B^\top M B"),
        write_step(
            "Forces along the velocities that constraints give",
            "k = ad*_xi p + dl/da <> a + f - M c - dp/dz z'",
            r"k = \mathrm{ad}^*_\xi p + (\partial l/\partial a) \diamond a + f - M c"
            r" - \partial_z p \, \dot z",
            named,
            by="nonholonomic",
        ),
        write_step(
            "Equations of motion, solved for the accelerations in the kernel",
            f"{row} = B^T (ad*_xi p + dl/da <> a + f - M c - dp/dz z'){pull}",
            rf"{row_latex} = B^\top (\mathrm{{ad}}^*_\xi p + (\partial l/\partial a) \diamond a + f"
            rf" - M c - \partial_z p \, \dot z){pull_latex}",
            (
                (component(row, row_latex, row_typst, n), x)
                for n, x in enumerate(motion.pull(known), 1)
            ),
            by="nonholonomic",
        ),
        motion.show_kept(),
        write_step(
            "Accelerations of the other velocities, and reactions",
            "p' - F = A^T lambda",
            r"\dot p - F = A^\top \lambda",
            (line for line in reactions if line[0] not in motion.pressing),
            by="constraints",
        ),
        write_step(
            "Almost-Poisson bracket of the momenta M = B^T p",
            "{M_i, M_j} = -<p, [D_i, D_j]>",
            r"\{M_i, M_j\} = -\langle p, [D_i, D_j] \rangle",
            brackets,
            by="almost-poisson",
        ),
        write_step(
            "Reconstruction, after the motion",
            "the rates of what acts on nothing",
            r"\dot g = g \xi",
            ((rate(name), value) for name, value in followed),
            by="reconstruction",
        ),
    )


def _brackets(setting: Setting, exact: Exact) -> list[tuple[Left, Element]]:
    """The brackets of the momenta that are not zero; none at all where any of them is long."""
    names, tensor = setting.state, exact.poisson_tensor
    moving = {*frame_of(setting).velocities}
    values = [
        (bracket(f"M_{names[i]}", f"M_{names[j]}"), tensor[i][j])
        for i, j in combinations(range(len(names)), 2)
        if tensor is not None and {names[i], names[j]} <= moving
    ]
    short = all(len(setting.field.terms(value)) <= SHOWN for _, value in values)
    return [pair for pair in values if short and pair[1] != 0]
