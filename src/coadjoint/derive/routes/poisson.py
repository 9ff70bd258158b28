r"""The Poisson route: from a Hamiltonian and any Poisson bracket of the state.

Theorem (Holm 2011, section 2.5.1): with a bracket that is bilinear, antisymmetric, a derivation and
satisfies the Jacobi identity, the motion of every function is :math:`\dot f = \{f, h\}`, so
:math:`\dot x_i = \{x_i, x_j\}\, \partial h / \partial x_j`.
Comes in: a Setting with a Hamiltonian and a declared bracket. Goes out: Equations.
Read next: `coadjoint.derive.routes.lie_poisson`, where an algebra gives the bracket.
"""

from __future__ import annotations

from itertools import combinations

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.emission import emit
from coadjoint.derive.mechanics.legendre import alone_velocities
from coadjoint.derive.mechanics.solver import Definition, Solve, solve_in_kernel
from coadjoint.derive.mechanics.variational import normal_extremals, show_extremals
from coadjoint.derive.records import bracket, write_rates, write_slopes, write_step
from coadjoint.derive.setting import Setting
from coadjoint.derive.structure import canonical_pairs, poisson_structure
from coadjoint.exact import Element

#: Title, text and LaTeX of the step that states the bracket.
Law = tuple[str, str, str]


def derive(setting: Setting) -> Equations:
    """Equations of motion by the declared bracket.

    Raises:
        DerivationError: A formula divides by zero.
    """
    law = ("Poisson bracket of the coordinates", "{x_i, x_j}", r"\{x_i, x_j\}")
    return hamiltonian_equations(setting, "poisson", setting.hamiltonian, law)


def hamiltonian_equations(
    setting: Setting, route: str, h: Element, law: Law, solves: tuple[Solve, ...] = ()
) -> Equations:
    """``dx/dt = {x, h}`` by the bracket of the state.

    Where the spec names velocities, ``xi = dh/dmu`` are definitions that the rates use.

    Args:
        setting: The spec and the field.
        route: Name of the route.
        h: The Hamiltonian, stationary in the velocities that it names.
        law: What the step says that states the bracket.
        solves: What the kernel solves for these velocities.
    """
    field, tensor = setting.field, poisson_structure(setting).tensor
    gradient = dict(zip(setting.state, field.gradient(h, setting.state), strict=True))
    given = _conjugate_velocities(setting)
    pairs = dict(zip(setting.momenta, given, strict=bool(given)))
    weights = dict(zip(setting.momenta, setting.weights, strict=True))
    definitions = velocities_of(setting, h, solves)
    named = gradient | {mu: field[xi] * (1 / weights[mu]) for mu, xi in pairs.items()}
    of_product = dict(_velocities_of_product(setting))
    named |= {
        p: field[of_product[p]] / w for _, p, w in canonical_pairs(setting) if p in of_product
    }
    slopes = [named[x] for x in setting.state]
    rates = field.vector(
        sum(entry * slope for entry, slope in zip(row, slopes, strict=True) if entry != 0)
        for row in tensor
    )
    if setting.spec.is_first_order:
        definitions, rates = name_velocities(setting, rates)
    brackets = [
        (bracket(a, b), tensor[i][j])
        for (i, a), (j, b) in combinations(enumerate(setting.state), 2)
        if tensor[i][j] != 0
    ]
    steps = (
        *show_extremals(setting),
        write_step("Hamiltonian", "h(x)", lines={"h": h}, by="hamilton"),
        write_step(*law, brackets, by=route),
        write_step(
            "Derivatives of the Hamiltonian",
            "dh/dx",
            r"\partial h / \partial x",
            write_slopes("h", setting.state, gradient.values()),
            by="hamilton",
        ),
        write_step(
            "Hamilton's equations",
            "dx/dt = {x, h}",
            r"\dot x = \{x, h\}",
            write_rates(setting.state, rates),
            by="hamilton",
        ),
    )
    return emit(setting, route, rates, steps, h, definitions, solves)


def _velocities_of_product(setting: Setting) -> list[tuple[str, str]]:
    """Momenta of coordinates next to an algebra, with their velocities where these are named."""
    spec = setting.spec
    pairs = (
        (spec.partner("momentum", q.name), spec.partner("velocity", q.name))
        for q in (spec.having_role("coordinate") if canonical_pairs(setting) else ())
    )
    return [
        pair for p, v in pairs if p and v for pair in zip(p.components, v.components, strict=True)
    ]


def name_velocities(
    setting: Setting, rates: tuple[Element, ...]
) -> tuple[tuple[Definition, ...], tuple[Element, ...]]:
    """The velocities of coordinates as definitions, and rates that name them.

    So it is where a Lagrangian of first order, on another route, names them.
    """
    pairs = dict(zip(setting.positions, setting.velocities, strict=True))
    known = dict(zip(setting.state, rates, strict=True))
    definitions = tuple((v, known[q]) for q, v in pairs.items())
    named = (setting.field[pairs[x]] if x in pairs else rate for x, rate in known.items())
    return definitions, tuple(named)


def _conjugate_velocities(setting: Setting) -> tuple[str, ...]:
    """The velocities that momenta give; others are themselves state, or rates of it."""
    return setting.velocities if setting.momenta and not setting.spec.is_first_order else ()


def velocities_of(
    setting: Setting, h: Element, solves: tuple[Solve, ...] = ()
) -> tuple[Definition, ...]:
    """``xi = dh/dmu`` for the velocities that the spec names, or what the kernel solves for them.

    Args:
        setting: The spec and the field.
        h: The Hamiltonian, stationary in the velocities that it names.
        solves: What the kernel solves for these.
    """
    if setting.spec.variational:
        return normal_extremals(setting).definitions
    field, given = setting.field, _conjugate_velocities(setting)
    solved = [line for solve in solves for line in solve_in_kernel(field, solve)]
    known = {name for name, _ in solved}
    alone = alone_velocities(setting)
    return (
        *solved,
        *(
            (xi, alone.get(xi, weight * field.derivative(h, mu)))
            for mu, weight, xi in zip(setting.momenta, setting.weights, given, strict=bool(given))
            if xi not in known
        ),
        *(line for line in _define_of_product(setting, h) if line[0] not in known),
    )


def _define_of_product(setting: Setting, h: Element) -> list[Definition]:
    """``v = {q, h}`` of these."""
    weights = {p: weight for _, p, weight in canonical_pairs(setting)}
    pairs, alone = _velocities_of_product(setting), alone_velocities(setting)
    return [(v, alone.get(v, setting.field.derivative(h, p) * weights[p])) for p, v in pairs]
