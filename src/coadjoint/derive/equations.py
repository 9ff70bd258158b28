"""The Equations of motion: what every route derives and every later step reads.

Comes in: exact elements from a route. Goes out: a frozen record with two faces. `exact` holds field
elements in the form in which a careful person would compute them (velocities as named
definitions); the properties give closed SymPy expressions of state and parameters to read and use.
Read next: `coadjoint.prove.claims` and `coadjoint.lower.lowering`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import sympy

from coadjoint.derive.closed import ClosedForms, LinearEquations, closed_forms
from coadjoint.derive.fields.operators import Operator
from coadjoint.derive.mechanics.contact import touch_of
from coadjoint.derive.mechanics.distribution import Distribution
from coadjoint.derive.mechanics.followed import rates_followed
from coadjoint.derive.mechanics.iteration import Newton
from coadjoint.derive.mechanics.projection import back_then_onto, nearest_state
from coadjoint.derive.mechanics.solver import Solve, definitions_under, list_loops
from coadjoint.derive.pairs import LaxPair
from coadjoint.derive.records import Chart, Exact, Step, rate, symbol
from coadjoint.derive.setting import STEP, Setting, vector_names
from coadjoint.exact import Element
from coadjoint.notation.elements import write_element
from coadjoint.notation.written import aligned
from coadjoint.spec import Spec


@dataclass(frozen=True)
class Equations:
    """Derived equations of motion of one system by one route.

    Attributes:
        setting: The spec and the exact field.
        route: ``euler-poincare``, ``lie-poisson``.
        exact: The equations as field elements.
        steps: The derivation, step by step.
        chart: The route's own variables and the map to the declared state; None if that is what
            the route moves.
        pair: The Lax pair by which the route goes, if it is one of those.
        distribution: What the constraints allow; None for motions that are free.
        operator: The bracket of fields by which the route goes, if it does.
        built: What functions under `coadjoint.derive.setting.once` have built of them.
    """

    setting: Setting
    route: str
    exact: Exact
    steps: tuple[Step, ...]
    chart: Chart | None = None
    pair: LaxPair | None = None
    distribution: Distribution | None = None
    operator: Operator | None = None
    built: dict[Any, object] = field(default_factory=dict, init=False, repr=False, compare=False)

    @property
    def spec(self) -> Spec:
        """The spec the equations were derived from."""
        return self.setting.spec

    @property
    def way(self) -> str:
        """The route or the declared chart, in words."""
        declared = self.chart is not None and self.chart.name
        return f"the chart {declared}" if declared else f"the route {self.route}"

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of what the rates are the rates of: the declared state, or the route's own."""
        return self.setting.state if self.chart is None else self.chart.variables

    @property
    def state(self) -> tuple[sympy.Symbol, ...]:
        """Symbols of the variables, in order."""
        return tuple(map(sympy.Symbol, self.variables))

    @property
    def parameters(self) -> tuple[sympy.Symbol, ...]:
        """Parameter symbols in declared order."""
        return tuple(map(sympy.Symbol, self.setting.parameters))

    @cached_property
    def rates(self) -> tuple[sympy.Expr, ...]:
        """Time derivative of each variable, in variables, parameters, inputs and time alone.

        Where more is solved for than can be written out, rates name the unknowns of `unsolved`.
        """
        return tuple(map(self._sympy, self.exact.rates))

    @property
    def unsolved(self) -> tuple[LinearEquations, ...]:
        """Linear equations whose solution is not written out: unknowns, matrix and right side."""
        return self._closed_forms.unsolved

    @cached_property
    def energy(self) -> sympy.Expr | None:
        """The energy, closed as the rates are; None where there is none."""
        return None if self.exact.energy is None else self._sympy(self.exact.energy)

    @cached_property
    def observables(self) -> dict[str, sympy.Expr]:
        """Scalars emitted in addition to the rates, closed as the rates are."""
        return {name: self._sympy(value) for name, value in self.exact.observables}

    @cached_property
    def velocities(self) -> dict[str, sympy.Expr]:
        """Velocities in state and parameters alone, or as the kernel solves for them."""
        return {name: self._write(value) for name, value in self.exact.definitions}

    @cached_property
    def poisson_tensor(self) -> sympy.ImmutableMatrix | None:
        """Matrix of the brackets ``{x_i, x_j}`` of the state; None where the route has none."""
        tensor = self.exact.poisson_tensor
        if tensor is None:
            return None
        return sympy.ImmutableMatrix([[self._sympy(entry) for entry in row] for row in tensor])

    def close(self, element: Element) -> Element:
        """An element with the definitions substituted: in state and parameters alone.

        The names of `kept` stay, where the kernel solves for velocities, and those of `opaque`.
        """
        return self.setting.field.substitute(element, self._closed_definitions)

    @cached_property
    def _closed_definitions(self) -> dict[str, Element]:
        known: dict[str, Element] = {}
        for name, value in self.exact.definitions:
            if name not in self.kept and name not in self.opaque:
                known[name] = self.setting.field.substitute(value, known)
        return known

    @cached_property
    def opaque(self) -> tuple[str, ...]:
        """Functions of positions that are not written out, which would fill pages.

        They are those of two curved surfaces that touch. What is zero whatever these are is zero;
        nothing that holds these may be differentiated by the state.
        """
        touch = touch_of(self.setting)
        names = set() if touch is None or not touch.point else {*touch.functions}
        return tuple(name for name, _ in self.exact.definitions if name in names)

    def definitions_of(self, elements: Iterable[Element]) -> list[tuple[str, Element]]:
        """The definitions on which elements rest, in their order."""
        return definitions_under(self.setting.field, self.exact.definitions, elements)

    @cached_property
    def numbers(self) -> dict[str, Fraction]:
        """Definitions that are numbers, such as a velocity that a constraint keeps at 0."""
        field, known, numbers = self.setting.field, dict[str, Element](), dict[str, Fraction]()
        for name, value in self.exact.definitions:
            closed = field.substitute(value, known)
            number = field.as_number(closed)
            if number is not None:
                known[name], numbers[name] = closed, number
        return numbers

    @cached_property
    def kept(self) -> tuple[str, ...]:
        """Definitions without a closed form: intermediates of a solve, and what rests on them."""
        solved, names = self.intermediates, list[str]()
        for name, value in self.exact.definitions:
            if name in solved or self.setting.field.reach(value) & solved.union(names):
                names.append(name)
        return tuple(names)

    @cached_property
    def followed(self) -> tuple[tuple[str, Element], ...]:
        """What follows from the motion without acting on it: each variable with its rate."""
        return rates_followed(self.setting, self.distribution)

    def work(self, function: Element) -> Element:
        """What external forces add to the rate of a function of the state."""
        field, closed = self.setting.field, self.close(function)
        slopes = field.gradient(closed, self.setting.state)
        pairs = zip(slopes, self.exact.forces, strict=bool(self.exact.forces))
        return field.sum(slope * self.close(force) for slope, force in pairs if slope and force)

    @cached_property
    def onto_constraints(self) -> Equations | None:
        """The nearest state on the constraints that are kept, in place of the rates."""
        nearest = nearest_state(self.setting, self.distribution, self.exact)
        return None if nearest is None else replace(self, exact=nearest, steps=())

    @cached_property
    def projection(self) -> Equations | None:
        """Where solvers move a state: attitudes back to rotations, then onto the constraints."""
        onto = self.onto_constraints
        if not self.spec.turning:
            return onto
        moved = back_then_onto(self.setting, None if onto is None else onto.exact)
        return replace(self, exact=moved, steps=())

    @cached_property
    def intermediates(self) -> frozenset[str]:
        """Names of L, D, y and z of the solves in the kernel."""
        names = {name for each in self.exact.solves for name in each.intermediates}
        return frozenset(names.union(self.guesses))

    @property
    def guesses(self) -> frozenset[str]:
        """Names of what Newton's iterations in the kernel find."""
        return frozenset(name for newton in self.iterations for name in newton.names)

    @cached_property
    def loops(self) -> dict[str, Solve]:
        """The solves that are loops in the kernel, by the symbols for what they give."""
        return list_loops(self.exact.solves)

    @property
    def iterations(self) -> list[Newton]:
        """Newton's iterations in the kernel."""
        return [each.newton for each in self.exact.solves if each.newton is not None]

    @cached_property
    def moving(self) -> frozenset[str]:
        """Names whose values depend on the member: state, inputs, time, and what rests on them."""
        names = {*self.setting.state, *self.setting.velocities, *self.setting.driving}
        names |= {name for each in self.spec.reconstruction for name in each.components}
        names |= self.guesses.union(vector_names(len(self.setting.state)), [STEP])
        for name, value in self.exact.definitions:
            if self.setting.field.reach(value) & names:
                names.add(name)
        return frozenset(names)

    def _sympy(self, element: Element) -> sympy.Expr:
        """An element in state, parameters, inputs and time, but for the unknowns of `unsolved`."""
        return self._write(element).xreplace(self._closed_forms.values)

    def _write(self, element: Element) -> sympy.Expr:
        """An element in these, and in what the kernel solves for."""
        written = self.setting.field.to_sympy(self.close(element))
        return written.xreplace(self._opaque_forms) if self.opaque else written

    @cached_property
    def _opaque_forms(self) -> dict[sympy.Symbol, sympy.Expr]:
        """What is not written out, as expressions of the state that nobody has expanded."""
        forms, values = dict[sympy.Symbol, sympy.Expr](), dict(self.exact.definitions)
        for name in self.opaque:
            value = self.setting.field.to_sympy(self.close(values[name]))
            forms[sympy.Symbol(name)] = value.xreplace(forms)
        return forms

    @cached_property
    def _closed_forms(self) -> ClosedForms:
        named = set(self.kept) - self.intermediates
        return closed_forms(self.exact, named, self._write)

    def latex(self) -> str:
        """The definitions and rates as a LaTeX ``aligned`` block; of noise, the drift."""
        field = self.setting.field
        lines = [(symbol(name), value) for name, value in self.exact.definitions]
        lines += zip(map(rate, self.variables), self.exact.rates, strict=True)
        return aligned(
            f"{left.latex} &= {write_element(field, value).latex}" for left, value in lines
        )

    def __repr__(self) -> str:
        count = f"{len(self.variables)} rates"
        return f"<Equations of {self.spec.name} by {self.way}: {count}>"

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        from coadjoint.notebook import show_equations

        return show_equations(self)

    def _repr_latex_(self) -> str:
        """What a notebook shows that takes no HTML, and an export to LaTeX."""
        from coadjoint.notebook import write_equations

        return write_equations(self)
