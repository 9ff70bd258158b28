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
Read next: `coadjoint.derive.routes.hamel`, the road by the constrained Lagrangian.
"""

from __future__ import annotations

from itertools import combinations

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.almost_poisson import Tensor
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.constrained import ConstrainedMotion, emission
from coadjoint.derive.mechanics.distribution import Distribution, Row, distribution
from coadjoint.derive.mechanics.external import external_forces
from coadjoint.derive.mechanics.followed import rates_followed
from coadjoint.derive.mechanics.kinematics import Matrix, symbols
from coadjoint.derive.mechanics.solver import Definition
from coadjoint.derive.records import Left, Step, bracket, component, partial, rate, symbol
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element
from coadjoint.exact.roots import simplify_roots

__all__ = ["derive", "symbols"]

#: Terms of a bracket up to which the document shows it.
SHOWN = 8


def derive(setting: Setting) -> Equations:
    """Equations of motion by Lagrange and d'Alembert's principle.

    Raises:
        DerivationError: A constraint is not linear in the velocities or not independent of the
            others, the Lagrangian is not quadratic, or its reduced mass matrix is singular.
    """
    motion = ConstrainedMotion(distribution(setting))
    lagrangian, whole = setting.lagrangian, mechanics(setting)
    whole.check_quadratic()
    mass = whole.mass
    forces, named = _forces(motion, lagrangian, mass)
    reduced = _project_mass(motion, mass)
    known = _project_forces(motion, forces)
    definitions = [*motion.kinematics, *named]
    reactions = motion.reactions(mass, forces)
    exact = emission(motion, definitions, reduced, known, reactions)
    steps = _steps(motion, lagrangian, named, reduced, known, reactions, exact.poisson_tensor)
    return Equations(setting, "nonholonomic", exact, steps, distribution=motion.distribution)


def _forces(
    motion: ConstrainedMotion, lagrangian: Element, mass: Matrix
) -> tuple[Row, list[Definition]]:
    """``F - M c - dp/dz dz/dt`` along each velocity, with names along those that are given."""
    frame, field = motion.frame, motion.frame.setting.field
    xi = frame.setting.elements(frame.velocities)
    momenta = field.gradient(lagrangian, frame.velocities)
    parts = zip(
        frame.inertial(momenta, xi),
        (simplify_roots(field, slope) for slope in frame.slopes(lagrangian)),
        external_forces(frame.setting, frame.velocities),
        mass,
        momenta,
        strict=True,
    )
    forces = []
    named: list[Definition] = []
    for n, (inertial, slope, declared, row, p) in enumerate(parts):
        convected = field.sum(m * c for m, c in zip(row, motion.c, strict=True))
        force = motion.without_reactions(declared)
        value = inertial + slope + force - convected - motion.differentiate(p)
        if n in motion.solved:
            lines = motion.list_computed([(f"_k{n + 1}", value)])
            named += lines
            value = field[lines[0][0]] if lines else field.zero
        forces.append(value + (declared - force))
    return tuple(forces), named


def _project_mass(motion: ConstrainedMotion, mass: Matrix) -> Matrix:
    """``B^T M B``."""
    field, columns = motion.frame.setting.field, list(zip(*motion.B, strict=True))
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
        for column in zip(*motion.B, strict=True)
    )


def _steps(
    motion: ConstrainedMotion,
    lagrangian: Element,
    named: list[Definition],
    reduced: Matrix,
    known: Row,
    reactions: list[Definition],
    tensor: Tensor | None,
) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    setting, found = motion.frame.setting, motion.distribution
    momenta = setting.field.gradient(lagrangian, motion.frame.velocities)
    steps = (
        Step("Reduced Lagrangian", "l(xi, z)", r"l(\xi, z)", ((symbol("l"), lagrangian),)),
        Step(
            "Constraints, imposed after the variation",
            "left - right = 0",
            r"A \xi = b",
            tuple((symbol(each.name), each.residual) for each in found.equations),
        ),
        Step(
            "Distribution",
            "xi = B(z) eta + beta(z)",
            r"\xi = B(z) \eta + \beta(z)",
            tuple((symbol(name), value) for name, value in found.solved.items()),
        ),
        Step(
            "Momenta",
            "p = dl/dxi",
            r"p = \partial l / \partial \xi",
            tuple(zip((partial("l", v) for v in motion.frame.velocities), momenta, strict=True)),
        ),
        Step(
            "Kinematics",
            "z' = X_xi z, c = B' eta + beta'",
            r"\dot z = X_\xi z, \qquad c = \dot B \eta + \dot \beta",
            tuple(
                (symbol(name), value)
                for name, value in motion.kinematics
                if name not in found.solved
            ),
        ),
        Step(
            "Reduced mass matrix",
            "B^T M B",
            "B^T M B",
            tuple(
                (symbol(f"M_{i + 1}{j + 1}"), entry)
                for i, row in enumerate(reduced)
                for j, entry in enumerate(row)
                if j >= i and entry != 0
            ),
        ),
        Step(
            "Forces along the velocities that constraints give",
            "k = ad*_xi p + dl/da <> a + f - M c - dp/dz z'",
            r"k = \mathrm{ad}^*_\xi p + (\partial l/\partial a) \diamond a + f - M c"
            r" - \partial_z p \, \dot z",
            tuple((symbol(name), value) for name, value in named),
        ),
        Step(
            "Equations of motion, solved for the accelerations in the kernel",
            "B^T M B eta' = B^T (ad*_xi p + dl/da <> a + f - M c - dp/dz z')",
            r"B^T M B \dot\eta = B^T (\mathrm{ad}^*_\xi p + (\partial l/\partial a) \diamond a + f"
            r" - M c - \partial_z p \, \dot z)",
            tuple(
                (component("B^T M B eta'", r"B^T M B \dot\eta", n), value)
                for n, value in enumerate(known, 1)
            ),
        ),
        Step(
            "Accelerations of the other velocities, and reactions",
            "p' - F = A^T lambda",
            r"\dot p - F = A^T \lambda",
            tuple((symbol(name), value) for name, value in reactions),
        ),
        Step(
            "Almost-Poisson bracket of the momenta M = B^T p",
            "{M_i, M_j} = -<p, [D_i, D_j]>",
            r"\{M_i, M_j\} = -\langle p, [D_i, D_j] \rangle",
            tuple(_brackets(found, tensor)),
        ),
        Step(
            "Reconstruction, after the motion",
            "the rates of what acts on nothing",
            r"\dot g = g \xi",
            tuple((rate(name), value) for name, value in rates_followed(setting, found)),
        ),
    )
    return tuple(step for step in steps if step.lines)


def _brackets(found: Distribution, tensor: Tensor | None) -> list[tuple[Left, Element]]:
    """The brackets of the momenta that are not zero; none at all where any of them is long."""
    names = found.setting.state
    values = [
        (bracket(f"M_{names[i]}", f"M_{names[j]}"), tensor[i][j])
        for i, j in combinations(range(len(names)), 2)
        if tensor is not None and {names[i], names[j]} <= set(found.independent)
    ]
    short = all(len(found.setting.field.terms(value)) <= SHOWN for _, value in values)
    return [pair for pair in values if short and pair[1] != 0]
