r"""Charts: a motion in variables of its own, with the map that takes them to the state.

A route such as clebsch or cayley-klein moves other variables than the declared state, and a spec
may declare such variables under [charts]: by their rates, by Hamilton's equations

.. math:: \dot q = \partial h / \partial p, \qquad \dot p = -\partial h / \partial q,

or by Lagrange's, :math:`M \dot v = \partial l/\partial q - (\partial_q \partial_v l)\, v`.
Comes in: a Setting and the motion of a chart. Goes out: Equations in the chart, to be proved the
same motion. Read next: `coadjoint.prove.charts`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from coadjoint.derive.equations import Equations
from coadjoint.derive.interpret import Value
from coadjoint.derive.mechanics.configuration import inverse_in_blocks
from coadjoint.derive.mechanics.driving import explicit_rate
from coadjoint.derive.mechanics.solver import Definition
from coadjoint.derive.records import Chart, Exact, Relation, write_rates, write_step
from coadjoint.derive.setting import Setting, fault, shape
from coadjoint.derive.symmetries import evaluate_components
from coadjoint.errors import DerivationError
from coadjoint.exact import Element
from coadjoint.exact.dense import apply
from coadjoint.spec import Spec
from coadjoint.spec.sections.charts import DeclaredChart


def in_chart(
    setting: Setting,
    route: str,
    rates: Mapping[str, Element],
    image: Mapping[str, Element],
    through: str,
    *,
    relations: Sequence[Relation] = (),
    definitions: Sequence[Definition] = (),
    energy: Element | None = None,
) -> Equations:
    """Equations in variables of their own, without steps.

    Args:
        setting: The spec and its field.
        route: Name of the route, or of a declared chart.
        rates: The rate of each variable, in the order of the variables.
        image: Components of the state in terms of these; those left out are variables themselves.
        through: The map in words.
        relations: What vanishes where the variables live.
        definitions: Velocities in terms of these.
        energy: In terms of these, if it is known.
    """
    state = tuple(image.get(name, setting.field[name]) for name in setting.state)
    chart = Chart(variables=tuple(rates), state=state, through=through, relations=tuple(relations))
    exact = Exact(
        definitions=tuple(definitions),
        rates=tuple(rates.values()),
        energy=energy,
        emitted=(),
        poisson_tensor=None,
    )
    return Equations(setting=setting, route=route, exact=exact, steps=(), chart=chart)


def symbols(spec: Spec) -> tuple[str, ...]:
    """The components of the variables of declared charts."""
    return tuple(n for each in _list_declared(spec) for v in each.variables for n in v.components)


def _list_declared(spec: Spec) -> tuple[DeclaredChart, ...]:
    charts: tuple[DeclaredChart, ...] = spec.records.get("charts", ())
    return charts


def declared_charts(first: Equations) -> list[Equations]:
    """The equations of each declared chart.

    Args:
        first: The emitted route.

    Raises:
        DerivationError: A Lagrangian does not give its accelerations.
    """
    return [_equations(first.setting, chart) for chart in _list_declared(first.spec)]


def _equations(setting: Setting, chart: DeclaredChart) -> Equations:
    """The motion that one chart declares."""
    known = dict[str, Value]()
    for v in chart.variables:
        parts = setting.elements(v.components)
        known |= {**dict(zip(v.components, parts, strict=True)), v.name: shape(parts, v.shape)}
    if chart.kind == "rates":
        rates = {
            name: value
            for v in chart.variables
            for name, value in zip(
                v.components, setting.components(chart.motion[v.name], known), strict=True
            )
        }
    else:
        rates = _motion(setting, chart, setting.formula(chart.motion[chart.kind], known))
    image = evaluate_components(setting, chart.map, known)
    through = ", ".join(f"{name} = {formula.in_one_line}" for name, formula in chart.map.items())
    relations = [
        Relation(f"{each.in_one_line} = 0", setting.formula(each, known)) for each in chart.where
    ]
    motion = in_chart(setting, chart.name, rates, image, through, relations=relations)
    assert motion.chart is not None, "just made"
    lines = write_rates(tuple(rates), rates.values())
    step = write_step("Motion in the chart", "dy/dt = Y(y)", r"\dot y = Y(y)", lines, by="chart")
    return replace(motion, chart=replace(motion.chart, name=chart.name), steps=(step,))


def _motion(setting: Setting, chart: DeclaredChart, function: Element) -> dict[str, Element]:
    """Hamilton's or Lagrange's equations of the declared pairs, in the order of the variables."""
    field, components = setting.field, {v.name: v.components for v in chart.variables}
    q = [name for one, _ in chart.pairs for name in components[one]]
    p = [name for _, other in chart.pairs for name in components[other]]
    if chart.kind == "hamiltonian":
        named = dict(zip(q, field.gradient(function, p), strict=True))
        named |= {n: -slope for n, slope in zip(p, field.gradient(function, q), strict=True)}
    else:
        named = dict(zip(q, setting.elements(p), strict=True))
        named |= zip(p, _accelerations(setting, chart, function, q, p), strict=True)
    return {name: named[name] for names in components.values() for name in names}


def _accelerations(
    setting: Setting, chart: DeclaredChart, function: Element, q: list[str], v: list[str]
) -> tuple[Element, ...]:
    """``M^-1 (dl/dq - d2l/dvdq v - d2l/dvdt)``."""
    field, formula = setting.field, chart.motion["lagrangian"]

    def refuse(problem: str, places: Sequence[int]) -> DerivationError:
        names = ", ".join(v[place] for place in places)
        return fault(setting, formula, f"d2l/d({names})2 {problem}.", names)

    momenta = field.gradient(function, v)
    mass = tuple(field.gradient(momentum, v) for momentum in momenta)
    mixed = tuple(field.gradient(momentum, q) for momentum in momenta)
    carried = apply(mixed, setting.elements(v))
    own = [explicit_rate(setting, momentum, "a momentum of a chart") for momentum in momenta]
    slopes = zip(field.gradient(function, q), carried, own, strict=True)
    return apply(inverse_in_blocks(field, mass, refuse), [slope - c - e for slope, c, e in slopes])
