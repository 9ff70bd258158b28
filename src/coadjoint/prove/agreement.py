"""Agreement: that all routes of a spec give the same motion, and what the Legendre transform does.

Comes in: Equations by the routes of one Spec. Goes out: statements, and what must be zero. Motions
in momenta are compared through the Legendre transform, charts through their map, and constrained
motions by the linear equations of their accelerations.
Read next: `coadjoint.prove.equivalence`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

from coadjoint.derive import Equations
from coadjoint.derive.charts import declared_charts
from coadjoint.derive.mechanics.iteration import STEPS
from coadjoint.exact import Element
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.charts import ChartMap, reach
from coadjoint.prove.constraints import same_accelerations, same_solves
from coadjoint.prove.driven import while_constant
from coadjoint.prove.duality import about_duality
from coadjoint.prove.equivalence import LegendreMap
from coadjoint.prove.zero import Decision, Examined


def about_legendre(routes: Sequence[Equations]) -> Iterator[Examined]:
    """The Legendre transform and its energy, on every route."""
    pulled = LegendreMap(routes[0])
    invertible = pulled.invertible
    yield (
        f"the Legendre transform is {'locally ' * pulled.is_local}invertible {invertible.where}",
        "legendre",
        lambda: Decision(verdict=Verdict.PROVED, method=invertible.method),
    )
    for equations in routes:
        yield from about_duality(equations)
        if equations.chart is not None or equations.exact.energy is None:
            continue
        if equations.kept:
            yield (
                _solve_text(equations),
                "legendre",
                partial(pulled.solution_defects, equations),
            )
        yield (
            f"h(dl/dxi) = <dl/dxi, xi> - l on the route {equations.route}",
            "legendre",
            partial(pulled.energy_defects, equations),
        )
        if pulled.momenta:
            yield (
                f"dh/dmu = xi on the route {equations.route}",
                "legendre",
                partial(pulled.velocity_defects, equations),
            )


def _solve_text(equations: Equations) -> str:
    """What the kernel does to find velocities."""
    text = (
        f"the kernel solves for the velocities on the route {equations.route}: L D L^T = d2l/dxi2"
    )
    if not equations.iterations:
        return text
    return (
        f"{text}, in Newton's iteration of {STEPS} steps from rest and in the step after it, of "
        "which the velocities at mu = dl/dxi are a fixed point"
    )


def about_equality(routes: Sequence[Equations]) -> Iterator[Examined]:
    """That the other routes and the declared charts give the motion of the first route."""
    first, *others = routes
    pulled = LegendreMap(first) if LegendreMap.applies(first) else None
    for other in (*others, *declared_charts(first)):
        same, through = partial(_same_rates, first, other), ""
        if other.chart is not None:
            yield from _about_chart(first, other)
            continue
        if first.distribution is not None:
            solved = same_accelerations if other.distribution is None else same_solves
            same = partial(solved, first, other)
        elif pulled is not None:
            same = partial(pulled.rate_defects, first, other)
            through = ", through the Legendre transform"
        yield f"{first.route} and {other.route} give the same motion{through}", "equivalence", same


def _about_chart(first: Equations, other: Equations) -> Iterator[Examined]:
    """That a motion in other variables is the same motion, and where."""
    assert other.chart is not None
    chart_map = ChartMap(first, other)
    relations = ", ".join(relation.text for relation in other.chart.relations)
    where = f", where {relations}" if relations else ""
    elements = [relation.element for relation in other.chart.relations]
    held = while_constant(other, [*elements, *other.chart.state])
    name = other.way if other.chart.name else other.route
    through = f"through {other.chart.through}{where}{held}"
    yield (
        f"{first.route} and {name} give the same motion, {through}",
        "equivalence",
        chart_map.decide_related,
    )
    if first.distribution is not None and first.distribution.kept:
        kept = ", ".join(f"{equation.name} = 0" for equation, _ in first.distribution.kept)
        yield f"{other.way} lies where {kept}", "equivalence", chart_map.decide_bound
    if relations:
        yield f"{other.way} keeps {relations}{held}", "equivalence", chart_map.decide_kept
    statement, decision = reach(chart_map)
    yield statement, "equivalence", lambda: decision


def _same_rates(first: Equations, other: Equations) -> list[Element]:
    pairs = zip(first.exact.rates, other.exact.rates, strict=True)
    return [first.close(a) - other.close(b) for a, b in pairs]
