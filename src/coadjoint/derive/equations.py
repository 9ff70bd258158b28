"""The Equations of motion: what every route derives and every later step reads.

Comes in: exact elements from a route. Goes out: a frozen record with two faces. `exact` holds field
elements in the form in which a careful person would compute them (velocities as named
definitions); the properties give closed SymPy expressions of state and parameters to read and use.
Read next: `coadjoint.prove.claims` and `coadjoint.lower.lowering`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property
from typing import TYPE_CHECKING

import sympy
from sympy.printing.mathml import mathml

from coadjoint.derive.mechanics.solver import Solve, solver_names
from coadjoint.derive.pairs import LaxPair
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element
from coadjoint.spec import Spec

if TYPE_CHECKING:
    from coadjoint.derive.mechanics.distribution import Distribution


@dataclass(frozen=True)
class Left:
    """The left side of a line of a derivation: plain text, LaTeX and presentation MathML."""

    text: str
    latex: str
    mathml: str


#: How kernels call a time derivative.
_RATE = re.compile(r"d(?P<of>.+)_dt")


def is_of_kernel(name: str) -> bool:
    """Whether a name is one that kernels give: of an intermediate, or of a rate."""
    return name.startswith("_") or _RATE.fullmatch(name) is not None


@cache  # every route writes the same names
def symbol(name: str) -> Left:
    """The symbol itself: ``Pi1``; names of kernels as a book would write them."""
    moving = _RATE.fullmatch(name)
    if moving:
        return replace(rate(moving["of"]), text=name)
    plain = sympy.Symbol(name.removeprefix("_"))
    return Left(name, sympy.latex(plain), mathml(plain, printer="presentation"))


def signed(sign: int, text: str) -> str:
    """A sum, or minus it in brackets.

    >>> signed(1, "a + b"), signed(-1, "a + b")
    ('a + b', '-(a + b)')
    """
    return text if sign == 1 else f"-({text})"


def rate(name: str) -> Left:
    """Its time derivative: ``dPi1/dt``."""
    of = symbol(name)
    fraction = f"<mfrac><mrow><mi>d</mi>{of.mathml}</mrow><mrow><mi>d</mi><mi>t</mi></mrow></mfrac>"
    return Left(f"d{name}/dt", rf"\dot{{{of.latex}}}", fraction)


def partial(function: str, name: str) -> Left:
    """A partial derivative: ``dl/dOmega1``."""
    by = symbol(name)
    fraction = (
        f"<mfrac><mrow><mo>&#x2202;</mo><mi>{function}</mi></mrow>"
        f"<mrow><mo>&#x2202;</mo>{by.mathml}</mrow></mfrac>"
    )
    return Left(f"d{function}/d{name}", rf"\partial {function} / \partial {by.latex}", fraction)


def component(text: str, latex: str, n: int) -> Left:
    """A component of a vector that is written out: ``(M eta')_1``."""
    inner = f"<mo>(</mo><mtext>{text}</mtext><mo>)</mo>"
    return Left(
        f"({text})_{n}", f"({latex})_{{{n}}}", f"<msub><mrow>{inner}</mrow><mn>{n}</mn></msub>"
    )


def bracket(a: str, b: str) -> Left:
    """A Poisson bracket: ``{Pi1, Pi2}``."""
    x, y = symbol(a), symbol(b)
    braced = f"<mo>{{</mo>{x.mathml}<mo>,</mo>{y.mathml}<mo>}}</mo>"
    return Left(f"{{{a}, {b}}}", rf"\{{{x.latex}, {y.latex}\}}", braced)


def algebra_bracket(a: str, b: str) -> Left:
    """A bracket of a Lie algebra: ``[J1, J2]``."""
    x, y = symbol(a), symbol(b)
    braced = f"<mo>[</mo>{x.mathml}<mo>,</mo>{y.mathml}<mo>]</mo>"
    return Left(f"[{a}, {b}]", rf"[{x.latex}, {y.latex}]", braced)


@dataclass(frozen=True)
class Step:
    """One step of a derivation, for the document.

    Attributes:
        title: What is done.
        text: The general law as plain text, from the theorem and not from the spec.
        latex: The same law as LaTeX.
        lines: Left and right sides of what it gives for this system.
    """

    title: str
    text: str
    latex: str
    lines: tuple[tuple[Left, Element], ...] = ()


@dataclass(frozen=True)
class Exact:
    """The equations as field elements.

    Attributes:
        definitions: Velocities by name, each in terms of the state; rates and observables may use
            these names. In the order in which they can be computed. Names with a leading underscore
            are intermediates of a solve in the kernel (`coadjoint.derive.mechanics.solver`).
        rates: Time derivative of each state component.
        energy: The Hamiltonian, in terms of the state; None for forces without a potential.
        observables: Name and value of each scalar emitted beside the dynamics, energy included.
        poisson_tensor: ``{x_i, x_j}`` for the state x; None where the route knows no bracket.
        solves: Linear equations that definitions solve in the kernel, in that order.
        residuals: What vanishes on the constraints, by the names of these.
        forces: What external forces add to each rate; empty where none act, and with constraints.
    """

    definitions: tuple[tuple[str, Element], ...]
    rates: tuple[Element, ...]
    energy: Element | None
    observables: tuple[tuple[str, Element], ...]
    poisson_tensor: tuple[tuple[Element, ...], ...] | None
    solves: tuple[Solve, ...] = ()
    residuals: tuple[tuple[str, Element], ...] = ()
    forces: tuple[Element, ...] = ()


@dataclass(frozen=True)
class Relation:
    """A function that vanishes where variables live, such as ``chi . r`` or ``q . q - 1``.

    Attributes:
        text: The relation for people: ``dot(chi, r) = 0``.
        element: What vanishes.
    """

    text: str
    element: Element


@dataclass(frozen=True)
class Chart:
    """The variables in which a route moves, where they are not the declared state.

    Attributes:
        variables: Their names, in the order of the route's rates.
        state: Each component of the declared state as a function of them.
        through: The map in words for certificates: ``Pi = P x Q``.
        relations: What vanishes where the variables live; the motion must keep it so.
    """

    variables: tuple[str, ...]
    state: tuple[Element, ...]
    through: str
    relations: tuple[Relation, ...] = ()


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
    """

    setting: Setting
    route: str
    exact: Exact
    steps: tuple[Step, ...]
    chart: Chart | None = None
    pair: LaxPair | None = None
    distribution: Distribution | None = None

    @property
    def spec(self) -> Spec:
        """The spec the equations were derived from."""
        return self.setting.spec

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
        """Time derivative of each variable, in variables and parameters alone."""
        return tuple(map(self._sympy, self.exact.rates))

    @cached_property
    def energy(self) -> sympy.Expr | None:
        """The energy, in state and parameters alone; None where there is none."""
        return None if self.exact.energy is None else self._sympy(self.exact.energy)

    @cached_property
    def observables(self) -> dict[str, sympy.Expr]:
        """Scalars emitted beside the dynamics, in state and parameters alone."""
        return {name: self._sympy(value) for name, value in self.exact.observables}

    @cached_property
    def velocities(self) -> dict[str, sympy.Expr]:
        """Velocities in state and parameters alone, or as the kernel solves for them."""
        return {name: self._sympy(value) for name, value in self.exact.definitions}

    @cached_property
    def poisson_tensor(self) -> sympy.ImmutableMatrix | None:
        """Matrix of the brackets ``{x_i, x_j}`` of the state; None where the route has none."""
        tensor = self.exact.poisson_tensor
        if tensor is None:
            return None
        return sympy.ImmutableMatrix([[self._sympy(entry) for entry in row] for row in tensor])

    @cached_property
    def derivatives(self) -> dict[str, tuple[str, ...]]:
        """The functions that are derivatives of the rates: by which names each of them is.

        By inputs and parameters only where there are some.
        """
        setting = self.setting
        by = {"input_jacobian": setting.inputs, "parameter_jacobian": setting.parameters}
        return {"jacobian": setting.state} | {name: names for name, names in by.items() if names}

    def closed(self, element: Element) -> Element:
        """An element with the definitions substituted: in state and parameters alone.

        The names of `kept` stay, where the kernel solves for velocities.
        """
        return self.setting.field.substitute(element, self._closed_definitions)

    @cached_property
    def _closed_definitions(self) -> dict[str, Element]:
        known: dict[str, Element] = {}
        for name, value in self.exact.definitions:
            if name not in self.kept:
                known[name] = self.setting.field.substitute(value, known)
        return known

    def definitions_of(self, elements: Iterable[Element]) -> list[tuple[str, Element]]:
        """The definitions on which elements rest, in their order."""
        wanted = frozenset[str]().union(*map(self.setting.field.reach, elements))
        found = []
        for name, value in reversed(self.exact.definitions):
            if name in wanted:
                wanted |= self.setting.field.reach(value)
                found.append((name, value))
        return found[::-1]

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
            if name in solved or self.setting.field.reach(value) & set(names):
                names.append(name)
        return tuple(names)

    @cached_property
    def followed(self) -> tuple[tuple[str, Element], ...]:
        """What follows from the motion without acting on it: each variable with its rate."""
        from coadjoint.derive.mechanics.followed import rates_followed  # which needs distributions

        return rates_followed(self.setting, self.distribution)

    def work(self, function: Element) -> Element:
        """What external forces add to the rate of a function of the state."""
        field, closed = self.setting.field, self.closed(function)
        slopes = field.gradient(closed, self.setting.state)
        pairs = zip(slopes, self.exact.forces, strict=bool(self.exact.forces))
        return field.sum(slope * self.closed(force) for slope, force in pairs if slope and force)

    @cached_property
    def projection(self) -> Equations | None:
        """The nearest state on the constraints that are kept, in place of the rates."""
        from coadjoint.derive.mechanics.projection import projected  # which makes Equations

        return projected(self)

    @cached_property
    def intermediates(self) -> frozenset[str]:
        """Names of L, D, y and z of the solves in the kernel."""
        return frozenset(name for each in self.exact.solves for name in solver_names(each.block))

    @cached_property
    def moving(self) -> frozenset[str]:
        """Names whose values depend on the member: state, inputs, time, and what rests on them."""
        names = {*self.setting.state, *self.setting.velocities, *self.setting.driving}
        names |= {name for each in self.spec.reconstruction for name in each.components}
        for name, value in self.exact.definitions:
            if self.setting.field.reach(value) & names:
                names.add(name)
        return frozenset(names)

    def _sympy(self, element: Element) -> sympy.Expr:
        return self.setting.field.to_sympy(self.closed(element))

    def latex(self) -> str:
        """The definitions and rates as a LaTeX ``aligned`` block."""
        field = self.setting.field
        lines = [(symbol(name), value) for name, value in self.exact.definitions]
        lines += zip(map(rate, self.variables), self.exact.rates, strict=True)
        rows = [f"{left.latex} &= {sympy.latex(field.to_sympy(value))}" for left, value in lines]
        return "\\begin{aligned}\n" + " \\\\\n".join(rows) + "\n\\end{aligned}"

    def _repr_latex_(self) -> str:
        """What a notebook shows."""
        return f"$\\displaystyle {self.latex()}$"
