r"""The Euler-Lagrange route: from a Lagrangian on coordinates q and velocities v = dq/dt.

Theorem (Holm 2011, sections 2.2 and 2.2.1): the action :math:`\int l(q, \dot q)\,dt` is stationary
for fixed ends exactly if

.. math:: \frac{d}{dt}\frac{\partial l}{\partial v} = \frac{\partial l}{\partial q}.

With momenta p in the state these are rates of p. Without them the left side is written out,

.. math:: M \dot v = \frac{\partial l}{\partial q} - \frac{\partial^2 l}{\partial v\,\partial q} v,
    \qquad M = \frac{\partial^2 l}{\partial v^2},

which for a kinetic energy alone is the geodesic equation :math:`\dot v^c = -\Gamma^c_{ab} v^a v^b`
(section 2.2.4). Where l depends on time explicitly, :math:`-\partial^2 l/\partial v\,\partial t`
stands on the right side, too.
The kernel solves for the accelerations of more velocities than the inverse of M is written for.
Comes in: a Setting with a Lagrangian and no algebra. Goes out: Equations.
Read next: `coadjoint.derive.routes.canonical`, the same motion from a Hamiltonian.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.configuration import Mechanics, in_state_order, mechanics
from coadjoint.derive.mechanics.constrained import emit_motion, start_motion
from coadjoint.derive.mechanics.driving import explicit_rate
from coadjoint.derive.mechanics.emission import emit, emit_in_momenta
from coadjoint.derive.mechanics.external import external_forces
from coadjoint.derive.mechanics.legendre import LegendreTransform, legendre
from coadjoint.derive.records import (
    Exact,
    Step,
    component,
    write_entries,
    write_rates,
    write_slopes,
    write_step,
)
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element
from coadjoint.exact.dense import apply

#: ``table[c][a][b]``.
Table = tuple[tuple[tuple[Element, ...], ...], ...]
_LAW = "d/dt dl/dv = dl/dq,  dq/dt = v"
_LATEX = r"\frac{d}{dt} \frac{\partial l}{\partial v} = \frac{\partial l}{\partial q}, \quad "
_LATEX += r"\dot q = v"


def derive(setting: Setting) -> Equations:
    """Equations of motion by Hamilton's principle.

    Raises:
        DerivationError: The mass matrix is singular, or velocities cannot be solved for.
    """
    known = mechanics(setting)
    return _in_momenta(known) if setting.momenta else _in_velocities(known)


def _in_velocities(known: Mechanics) -> Equations:
    """``dq/dt = v, dv/dt = M^-1 (dl/dq - d2l/dvdq v)``."""
    setting = known.setting
    v = setting.elements(setting.velocities)
    carried = apply(known.mixed, v)
    own = [explicit_rate(setting, p, "a momentum dl/dv") for p in known.momenta]
    forces = [slope - c - e for slope, c, e in zip(known.slopes, carried, own, strict=True)]
    if known.is_long:
        return _solve_in_kernel(known, forces)
    moved = apply(known.inverse_mass, forces)
    named = dict(zip(setting.positions + setting.velocities, v + moved, strict=True))
    rates = in_state_order(setting, named)
    return emit(setting, "euler-lagrange", rates, _steps(known, rates), known.energy)


def _solve_in_kernel(known: Mechanics, forces: Sequence[Element]) -> Equations:
    """``M dv/dt = dl/dq - d2l/dvdq v + f``, solved for more velocities than M^-1 is written for."""
    setting = known.setting
    acting = external_forces(setting, setting.velocities)
    right = tuple(a + b for a, b in zip(forces, acting, strict=True))

    def steps(exact: Exact) -> tuple[Step, ...]:
        law = (
            "Accelerations, solved for in the kernel",
            "M dv/dt = dl/dq - d2l/dvdq v + f",
            r"M \dot v = \partial l / \partial q - (\partial^2 l / \partial v\,\partial q) v + f",
        )
        left = ("M dv/dt", r"M \dot v", "M dot(v)")
        lines = ((component(*left, n), value) for n, value in enumerate(right, 1))
        solved = write_step(*law, lines, by="legendre")
        *before, last = _steps(known, exact.rates, show_geometry=False)
        return (*before, solved, last)

    return emit_motion(start_motion(setting), "euler-lagrange", known.mass, right, steps)


def _in_momenta(known: Mechanics) -> Equations:
    """``dq/dt = v, dp/dt = dl/dq`` with v from ``p = dl/dv``."""
    setting = known.setting
    transform = legendre(setting)
    pairs = zip(setting.momenta, known.slopes, setting.weights, strict=True)
    named = dict(zip(setting.positions, setting.elements(setting.velocities), strict=True))
    named |= {p: slope * weight for p, slope, weight in pairs}
    rates = in_state_order(setting, named)
    return emit_in_momenta(setting, "euler-lagrange", rates, _steps(known, rates, transform))


# -- geodesics ------------------------------------------------------------------------------------


def christoffel_first(known: Mechanics) -> Table:
    """``Gamma_cab = (dM_ca/dq_b + dM_cb/dq_a - dM_ab/dq_c)/2``, of the first kind."""
    field, q, mass = known.setting.field, known.setting.positions, known.mass
    size = range(len(q))
    slope = [[field.gradient(entry, q) for entry in row] for row in mass]
    half = field.number(Fraction(1, 2))
    return tuple(
        tuple(
            tuple((slope[c][a][b] + slope[c][b][a] - slope[a][b][c]) * half for b in size)
            for a in size
        )
        for c in size
    )


def christoffel(known: Mechanics) -> Table:
    """``Gamma^c_ab``, of the second kind, for the metric that is the mass matrix.

    Source:
        Holm (2011), Geometric Mechanics II, section 2.2.4.
    """
    first = christoffel_first(known)
    size = range(len(first))
    columns = [
        [apply(known.inverse_mass, [first[c][a][b] for c in size]) for b in size] for a in size
    ]
    return tuple(tuple(tuple(columns[a][b][c] for b in size) for a in size) for c in size)


def is_natural(known: Mechanics) -> bool:
    """Whether velocities occur in l as ``M_ab(q) v_a v_b/2`` alone."""
    field, names = known.setting.field, known.setting.velocities
    v = known.setting.elements(names)
    moving = [m - x for m, x in zip(known.momenta, apply(known.mass, v), strict=True)]
    named = set(names).intersection(
        *[set().union(*(field.reach(e) for r in known.mass for e in r))]
    )
    return not named and all(map(field.is_zero, moving))


# -- the derivation in words ----------------------------------------------------------------------


def _steps(
    known: Mechanics,
    rates: tuple[Element, ...],
    transform: LegendreTransform | None = None,
    *,
    show_geometry: bool = True,
) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    setting = known.setting
    steps = [
        write_step("Lagrangian", "l(q, v)", lines={"l": known.lagrangian}, by="stationary-action"),
        write_step(
            "Momenta",
            "p = dl/dv",
            r"p = \partial l / \partial v",
            write_slopes("l", setting.velocities, known.momenta),
            by="legendre",
        ),
        write_step(
            "Mass matrix",
            "M_ab = d2l/dv_a dv_b",
            r"M_{ab} = \partial^2 l / \partial v_a \partial v_b",
            write_entries("M", known.mass),
            by="euler-lagrange",
        ),
    ]
    if transform is not None:
        law, latex = f"v solved from p = dl/dv{transform.iterations}", "v = v(q, p)"
        latex = "" if transform.iterations else latex
        steps.append(write_step("Velocities", law, latex, transform.definitions, by="legendre"))
    elif show_geometry and is_natural(known):
        steps += _geometry(known)
    latex = r"E = v \cdot \partial l / \partial v - l"
    steps.append(write_step("Energy", "E = v . dl/dv - l", latex, {"E": known.energy}, by="energy"))
    motion = write_rates(setting.state, rates)
    return (
        *steps,
        write_step("Euler-Lagrange equations", _LAW, _LATEX, motion, by="euler-lagrange"),
    )


def _geometry(known: Mechanics) -> list[Step]:
    """Christoffel symbols, where the metric is not constant."""
    first, second = christoffel_first(known), christoffel(known)
    if not any(entry for row in first for line in row for entry in line):
        return []
    return [
        write_step(
            "Christoffel symbols of the first kind",
            "Gamma_cab = (dM_ca/dq_b + dM_cb/dq_a - dM_ab/dq_c)/2",
            r"\Gamma_{cab} = \tfrac12(\partial_b M_{ca} + \partial_a M_{cb} - \partial_c M_{ab})",
            _symbols("Gamma_{}{}", first),
            by="geodesic",
        ),
        write_step(
            "Christoffel symbols of the second kind",
            "Gamma^c_ab = (M^-1)_cd Gamma_dab,  dv_c/dt = -Gamma^c_ab v_a v_b + forces",
            r"\Gamma^c_{ab} = (M^{-1})_{cd} \Gamma_{dab}",
            _symbols("Gamma^{}_{}", second),
            by="geodesic",
        ),
    ]


def _symbols(form: str, table: Table) -> list[tuple[str, Element]]:
    """Christoffel symbols that are not zero, a <= b; the form has places for c and for a, b."""
    return [
        (form.format(c, f"{a}{b}"), entry)
        for c, rows in enumerate(table, 1)
        for a, row in enumerate(rows, 1)
        for b, entry in enumerate(row, 1)
        if a <= b and entry
    ]
