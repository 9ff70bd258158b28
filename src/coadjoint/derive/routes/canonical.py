r"""The canonical route: Hamilton's equations of coordinates and momenta, by partial derivatives.

Theorem (Holm 2011, sections 2.5 and 2.5.1): the Legendre transform :math:`h = p \cdot v - l` of a
Lagrangian turns its equations into

.. math:: \dot q = \frac{\partial h}{\partial p}, \qquad
          \dot p = -\frac{\partial h}{\partial q} + B \frac{\partial h}{\partial p},

where B is zero unless the spec declares magnetic terms :math:`\{p_i, p_j\} = B_{ij}(q)` (exercise
3.1.39). Where the state has velocities and no momenta, the route moves momenta of its own,
:math:`p = \partial l / \partial v`. If no closed form gives v of these, the equations are pulled
back along :math:`(q, v) \mapsto (q, p)` instead (Abraham and Marsden, Foundations of Mechanics, 2nd
ed., section 3.5): with the energy :math:`E = h(q, p(q, v))`, ``dE`` is the two-form ``dq^dp``
contracted with the motion,

.. math:: M \dot q = \frac{\partial E}{\partial v}, \qquad M \dot v =
    \left(\frac{\partial p}{\partial q}\right)^T \dot q - \frac{\partial p}{\partial q} \dot q
    - \frac{\partial E}{\partial q} - \frac{\partial p}{\partial t},

with :math:`M = \partial p / \partial v` and :math:`\dot q = v`. An entry of symmetric matrices off
the diagonal is paired twice by :math:`\mathrm{tr}(P\,dS/dt)`, so its two equations have a factor
1/2.
Comes in: a Setting with a Hamiltonian or a Lagrangian. Goes out: Equations.
Read next: `coadjoint.derive.routes.newton`, which needs no energy.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from coadjoint.derive.charts import in_chart
from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.configuration import (
    SINGULAR,
    UNKNOWN,
    Mechanics,
    conjugates,
    in_state_order,
    mechanics,
)
from coadjoint.derive.mechanics.constrained import emit_motion, start_motion
from coadjoint.derive.mechanics.driving import explicit_rate
from coadjoint.derive.mechanics.emission import emit
from coadjoint.derive.mechanics.external import external_forces, metric
from coadjoint.derive.mechanics.legendre import alone_velocities, hamiltonian
from coadjoint.derive.mechanics.solver import solve_in_kernel
from coadjoint.derive.mechanics.variational import normal_extremals, show_extremals
from coadjoint.derive.records import Step, write_rates, write_slopes, write_step
from coadjoint.derive.setting import Setting, fault
from coadjoint.derive.symbols import choose_names
from coadjoint.errors import DerivationError
from coadjoint.exact import Element
from coadjoint.exact.dense import apply, transpose
from coadjoint.spec import Spec

#: A coordinate, its momentum and their bracket.
Pair = tuple[str, str, Fraction]
#: ``{p_i, p_j}`` by names, in both orders.
Magnetic = Mapping[tuple[str, str], Element]


def derive(setting: Setting) -> Equations:
    """Hamilton's equations.

    Raises:
        DerivationError: The Legendre transform cannot be inverted, or nothing says what the momenta
            of a declared Hamiltonian are.
    """
    if setting.spec.poisson is None and not setting.momenta:
        return _in_own_momenta(setting)
    h, solves = hamiltonian(setting)
    field, pairs = setting.field, _pairs(setting)
    velocities = dict(zip(setting.momenta, setting.velocities, strict=False))
    slopes = dict(zip(setting.state, field.gradient(h, setting.state), strict=True))
    solved = [line for solve in solves for line in solve_in_kernel(field, solve)]
    alone = alone_velocities(setting)
    written = [
        (velocities[p], alone.get(velocities[p], slopes[p] * weight))
        for _, p, weight in pairs
        if p in velocities and velocities[p] not in dict(solved)
    ]
    if setting.spec.variational:
        written = list(normal_extremals(setting).definitions)
    named = {p: field[v] for p, v in velocities.items()}
    rates = in_state_order(setting, _hamilton(setting, pairs, slopes, named, _magnetic(setting)))
    steps = (*show_extremals(setting), *_steps(setting.state, h, slopes, rates))
    return emit(setting, "canonical", rates, steps, h, (*solved, *written), solves)


def symbols(spec: Spec) -> tuple[str, ...]:
    """Momenta of its own, where the state has velocities and no bracket is declared."""
    if spec.poisson is not None or spec.having_role("momentum"):
        return ()
    coordinates = spec.having_role("coordinate")
    return choose_names(spec, [f"p_{name}" for q in coordinates for name in q.components])


def _pairs(setting: Setting) -> list[Pair]:
    """Coordinates with their momenta."""
    bracket, names = setting.spec.poisson, setting.state
    if bracket is None:
        return list(zip(setting.positions, setting.momenta, setting.weights, strict=True))
    places = zip(bracket.pairs, bracket.weights, strict=True)
    return [(names[i], names[j], weight) for (i, j), weight in places]


def _magnetic(setting: Setting) -> Magnetic:
    """The declared magnetic terms."""
    bracket, names = setting.spec.poisson, setting.state
    terms: dict[tuple[str, str], Element] = {}
    for i, j, formula in bracket.entries if bracket is not None else ():
        value = setting.formula(formula)
        terms |= {(names[i], names[j]): value, (names[j], names[i]): -value}
    return terms


def _hamilton(
    setting: Setting,
    pairs: Sequence[Pair],
    slopes: Mapping[str, Element],
    velocities: Mapping[str, Element],
    magnetic: Magnetic,
) -> dict[str, Element]:
    """``dq/dt = w h_p`` and ``dp/dt = -w h_q + B h_p``, by name.

    Args:
        setting: The spec and the field.
        pairs: q, p and w.
        slopes: The partial derivatives of h.
        velocities: Symbols that stand for ``w h_p``, by momentum.
        magnetic: B.
    """
    field = setting.field
    rates = dict.fromkeys(setting.state, field.zero)  # what is in no pair rests
    for q, p, weight in pairs:
        rates[q] = velocities[p] if p in velocities else slopes[p] * weight
        turning = field.sum(magnetic[p, k] * slopes[k] for _, k, _ in pairs if (p, k) in magnetic)
        rates[p] = turning - slopes[q] * weight
    return rates


def _in_own_momenta(setting: Setting) -> Equations:
    """Hamilton's equations of (q, p) with ``p = dl/dv``, mapped to the declared (q, v)."""
    spec, field, q = setting.spec, setting.field, setting.positions
    if spec.lagrangian is None:
        assert spec.hamiltonian is not None, "the reader asks for one of the two"
        message = (
            "the route canonical finds no momenta for this Hamiltonian: the state has velocities. "
            'Declare momenta with role = "momentum", or the bracket, as [poisson] canonical = '
            '[["q", "v"]].'
        )
        raise fault(setting, spec.hamiltonian, message, spec.hamiltonian.text)
    known, own = mechanics(setting), symbols(spec)
    p = setting.elements(own)

    def refuse(problem: str, places: Sequence[int]) -> DerivationError:
        known_problem = problem in (SINGULAR, UNKNOWN)
        return known.refusal(problem, places) if known_problem else _NoClosedFormError(problem)

    try:
        v = conjugates(field, known.lagrangian, setting.velocities, p, refuse)
    except _NoClosedFormError:
        return _pull_back(known)
    solved = dict(zip(setting.velocities, v, strict=True))
    products = (a * b for a, b in zip(p, v, strict=True))
    h = field.sum(products) - field.substitute(known.lagrangian, solved)
    variables = (*q, *own)
    slopes = dict(zip(variables, field.gradient(h, variables), strict=True))
    pairs = [(a, b, Fraction(1)) for a, b in zip(q, own, strict=True)]
    named = _hamilton(setting, pairs, slopes, {}, {})
    gained = _relaxed(setting, pairs, named, solved)
    for name, force in zip(own, external_forces(setting, setting.velocities), strict=True):
        named[name] += field.substitute(force, solved)
    named = {x: rate + gained.get(x, field.zero) for x, rate in named.items()}
    rates = {x: named[x] for x in variables}
    motion = in_chart(setting, "canonical", rates, solved, "p = dl/dv", energy=h)
    transform = write_step(
        "Legendre transform",
        "v solved from p = dl/dv",
        r"p = \partial l / \partial v",
        solved,
        by="legendre",
    )
    return replace(motion, steps=(transform, *_steps(variables, h, slopes, motion.exact.rates)))


class _NoClosedFormError(DerivationError):
    """Velocities are not written in momenta."""


def _pull_back(known: Mechanics) -> Equations:
    """Hamilton's equations in (q, v): ``dE`` is the contraction of ``dq^dp`` with the motion.

    The first half of them, ``M dq/dt = dE/dv``, has the solution v, which is proved here.
    """
    setting = known.setting
    field, v = setting.field, setting.elements(setting.velocities)
    lifting = field.gradient(known.energy, setting.velocities)
    defects = [a - b for a, b in zip(apply(known.mass, v), lifting, strict=True)]
    assert all(map(field.is_zero, defects)), "dE/dv is not M v"
    pull = field.gradient(known.energy, setting.positions)
    own = [explicit_rate(setting, p, "a momentum dl/dv") for p in known.momenta]
    turned, carried = apply(transpose(known.mixed), v), apply(known.mixed, v)
    right = [a - b - slope - e for a, b, slope, e in zip(turned, carried, pull, own, strict=True)]
    if known.is_long:
        acting = external_forces(setting, setting.velocities)
        forced = tuple(a + b for a, b in zip(right, acting, strict=True))
        return emit_motion(
            start_motion(setting),
            "canonical",
            known.mass,
            forced,
            lambda exact: _pulled_steps(known, pull, exact.rates),
        )
    moved = apply(known.inverse_mass, right)
    named = dict(zip(setting.positions + setting.velocities, v + moved, strict=True))
    rates = in_state_order(setting, named)
    return emit(setting, "canonical", rates, _pulled_steps(known, pull, rates), known.energy)


def _pulled_steps(
    known: Mechanics, pull: Sequence[Element], rates: Sequence[Element]
) -> tuple[Step, ...]:
    """The derivation in positions and velocities as a person would write it down."""
    setting = known.setting
    momenta = write_slopes("l", setting.velocities, known.momenta)
    contracted = r"\iota_X (dq \wedge dp) = dE, \quad p = \partial l / \partial v"
    return (
        write_step("Momenta", "p = dl/dv", r"p = \partial l / \partial v", momenta, by="legendre"),
        write_step("Energy", "E = p . v - l", lines={"E": known.energy}, by="energy"),
        write_step(
            "Slopes of the energy at fixed velocities",
            "dE/dq",
            r"\partial E / \partial q",
            write_slopes("E", setting.positions, pull),
            by="canonical",
        ),
        write_step(
            "Hamilton's equations in velocities",
            "M dq/dt = dE/dv,  M dv/dt = (dp/dq)^T dq/dt - (dp/dq) dq/dt - dE/dq",
            contracted,
            write_rates(setting.state, rates),
            by="canonical",
        ),
    )


def _relaxed(
    setting: Setting,
    pairs: Sequence[Pair],
    free: Mapping[str, Element],
    solved: Mapping[str, Element],
) -> dict[str, Element]:
    """What a symmetric bracket of (q, v) adds to the rates of (q, p): none is there without one.

    With ``x = x(q, p)`` and ``D = dx/d(q, p)`` a double bracket adds ``J D^T G D J dh`` with the
    canonical J; a metriplectic one adds ``D^-1 G dS``, where ``D^-1`` is ``d(q, p)/dx``.
    """
    relaxation, field = setting.spec.relaxation, setting.field
    if relaxation is None:
        return {}
    q, p = [pair[0] for pair in pairs], [pair[1] for pair in pairs]
    names, G = [*q, *p], [[field.substitute(x, solved) for x in row] for row in metric(setting)]
    if relaxation.S is None:
        state = (field.substitute(field[x], solved) for x in setting.state)
        D = tuple(field.gradient(x, names) for x in state)
        covector = apply(transpose(D), apply(G, apply(D, [free[x] for x in names])))
        by_q, by_p = covector[: len(q)], covector[len(q) :]
        return dict(zip(names, [*by_p, *(-x for x in by_q)], strict=True))
    S = field.gradient(setting.formula(relaxation.S), setting.state)
    pushed = apply(G, [field.substitute(x, solved) for x in S])
    momenta = dict(zip(p, mechanics(setting).momenta, strict=True))
    values = (momenta.get(x, field[x]) for x in names)
    turn = [[field.substitute(x, solved) for x in field.gradient(v, setting.state)] for v in values]
    return dict(zip(names, apply(turn, pushed), strict=True))


def _steps(
    names: Sequence[str],
    h: Element,
    slopes: Mapping[str, Element],
    rates: Sequence[Element],
) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    return (
        write_step("Hamiltonian", "h(q, p)", lines={"h": h}, by="hamilton"),
        write_step(
            "Derivatives of the Hamiltonian",
            "dh/dq, dh/dp",
            r"\partial h / \partial q, \quad \partial h / \partial p",
            write_slopes("h", names, (slopes[name] for name in names)),
            by="canonical",
        ),
        write_step(
            "Hamilton's equations",
            "dq/dt = dh/dp,  dp/dt = -dh/dq + B dh/dp",
            r"\dot q = \partial h / \partial p, \quad "
            r"\dot p = -\partial h / \partial q + B\, \partial h / \partial p",
            write_rates(names, rates),
            by="canonical",
        ),
    )
