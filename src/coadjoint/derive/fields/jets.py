r"""Jets: the derivative along space on the exact field, and what follows from it.

Fields u and their derivatives :math:`u_k = \partial_s^k u` are symbols. On functions of these

.. math::
    D f = \sum_k u_{k+1} \frac{\partial f}{\partial u_k}, \qquad
    E_u f = \sum_k (-D)^k \frac{\partial f}{\partial u_k},

the total derivative and the Euler operator, which is the variational derivative of the integral of
f over the circle (Olver 1993, Applications of Lie Groups to Differential Equations, 2nd ed.,
theorem 4.7). f is a total derivative, ``f = D P``, if and only if ``E f = 0`` for every u, where
f is a polynomial. For one of degree n the homotopy formula gives P:

.. math:: P = \frac{1}{n} \sum_u \sum_{k \ge 0} u_k \sum_{j > k} (-D)^{j-k-1}
    \frac{\partial f}{\partial u_j}.

Comes in: a field with symbols for jets. Goes out: derivatives, as elements.
Read next: `coadjoint.derive.fields.operators`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise

from coadjoint.derive.setting import Setting, list_components, once
from coadjoint.exact import Element, Field
from coadjoint.spec import Spec
from coadjoint.spec.core.tree import Name, walk
from coadjoint.spec.sections.space import jet_name

#: The symbol by which degrees are counted.
DEGREE = "_degree"
#: The highest order of an operator, beyond two for each derivative of a density.
_OPERATOR = 3


def depth(spec: Spec) -> int:
    """The highest derivative for which a field has a symbol.

    The rate of a density of order d along a motion of order r has the order d + r, and the Euler
    operator doubles that.
    """
    assert spec.space is not None, spec.name
    order = spec.space.derivatives
    return 2 * (order + 2 * order + _OPERATOR) + 1


def solved(spec: Spec) -> tuple[str, ...]:
    """The velocity on the circle, if a linear equation along all of it gives it: m = A u."""
    if spec.diffeomorphisms is None or spec.lagrangian is None:
        return ()
    (velocity,) = spec.having_role("velocity")
    named = {node.name for node in walk(spec.lagrangian.tree) if isinstance(node, Name)}
    jets = {each.name for each in spec.jets if each.of.name == velocity.name}
    return (velocity.name,) if named & jets else ()


def symbols(spec: Spec) -> tuple[str, ...]:
    """Names of the derivatives beyond those that formulas name, and the symbol of degrees."""
    if spec.space is None:
        return ()
    declared = {name for each in spec.jets for name in each.components}
    names = [
        jet_name(name, spec.space.name, order)
        for name in (*list_components(spec.state), *solved(spec))
        for order in range(1, depth(spec) + 1)
    ]
    return (*(name for name in names if name not in declared), DEGREE)


@dataclass(frozen=True)
class Jets:
    """Fields and their derivatives in an exact field.

    Attributes:
        field: Where they are symbols.
        towers: Of each field its symbol and those of its derivatives, in order.
    """

    field: Field
    towers: Mapping[str, tuple[str, ...]]

    def only(self, names: Sequence[str]) -> Jets:
        """Of some of the fields."""
        return Jets(self.field, {name: self.towers[name] for name in names})

    @cached_property
    def orders(self) -> dict[str, tuple[str, int]]:
        """Of each symbol the field, and how often it is differentiated."""
        return {x: (name, n) for name, tower in self.towers.items() for n, x in enumerate(tower)}

    @cached_property
    def _next(self) -> dict[str, str]:
        """The derivative of each symbol."""
        pairs = map(pairwise, self.towers.values())
        return {a: b for pair in pairs for a, b in pair}

    def total(self, element: Element, order: int = 1) -> Element:
        """``D^order`` of an element.

        >>> field = Field(["u", "u_s", "u_ss", DEGREE])
        >>> jets = Jets(field, {"u": ("u", "u_s", "u_ss")})
        >>> jets.total(field["u"] ** 2)
        2*u*u_s
        """
        for _ in range(order):
            reached = self.field.reach(element)
            tops = {each[-1] for each in self.towers.values()} & reached
            assert not tops, f"no symbol for the derivative of {tops}"
            element = self.field.sum(
                self.field.derivative(element, a) * self.field[b]
                for a, b in self._next.items()
                if a in reached
            )
        return element

    def slopes(self, element: Element, name: str) -> list[Element]:
        """Derivatives of an element by a field, its first derivative and so on."""
        tower, reached = self.towers[name], self.field.reach(element)
        found = [n for n, each in enumerate(tower) if each in reached]
        return list(self.field.gradient(element, tower[: max(found, default=-1) + 1]))

    def euler(self, element: Element, name: str) -> Element:
        """The variational derivative of the integral of an element by a field.

        >>> field = Field(["u", "u_s", "u_ss", DEGREE])
        >>> jets = Jets(field, {"u": ("u", "u_s", "u_ss")})
        >>> jets.euler(field["u_s"] ** 2 / 2 + field["u"] * field["u_s"], "u")
        -u_ss
        """
        result = self.field.zero
        for slope in reversed(self.slopes(element, name)):
            result = slope - self.total(result)
        return result

    def variation(self, element: Element) -> dict[str, Element]:
        """The variational derivatives by all fields."""
        return {name: self.euler(element, name) for name in self.towers}

    def rate(self, element: Element, rates: Mapping[str, Element]) -> Element:
        """The time derivative of an element where each field has a rate."""
        terms = list[Element]()
        for name, rate in rates.items():
            for order, slope in enumerate(self.slopes(element, name)):
                rate = self.total(rate, min(order, 1))
                terms += [slope * rate] if slope and rate else []
        return self.field.sum(terms)

    def integrate(self, element: Element) -> Element | None:
        """P with ``D P`` equal to an element whose variation is zero.

        None where no sum of homogeneous functions of the jets is seen: there, and for parts of
        degree 0, the formula says nothing.

        >>> field = Field(["u", "u_s", "u_ss", DEGREE])
        >>> jets = Jets(field, {"u": ("u", "u_s", "u_ss")})
        >>> jets.integrate(field["u"] * field["u_ss"] + field["u_s"] ** 2)
        u*u_s
        """
        field, symbols = self.field, [x for each in self.towers.values() for x in each]
        scaled = field.substitute(element, {x: field[DEGREE] * field[x] for x in symbols})
        try:
            parts = field.coefficients(scaled, DEGREE)
        except ValueError:  # in a sum below a line, or in a function
            return None
        if 0 in parts:
            return None
        return field.sum(self._homotopy(p) * Fraction(1, n) for n, p in parts.items())

    def _homotopy(self, element: Element) -> Element:
        """N P of a polynomial of degree n."""
        terms = list[Element]()
        for name, tower in self.towers.items():
            inner = self.field.zero
            slopes = self.slopes(element, name)
            for k in range(len(slopes) - 1, 0, -1):
                inner = slopes[k] - self.total(inner)
                terms.append(self.field[tower[k - 1]] * inner)
        return self.field.sum(terms)


@once
def jets_of(setting: Setting) -> Jets:
    """The fields of a spec, and their derivatives."""
    space = setting.spec.space
    assert space is not None, setting.spec.name
    orders, names = range(depth(setting.spec) + 1), (*setting.state, *solved(setting.spec))
    return Jets(
        setting.field,
        {name: tuple(jet_name(name, space.name, n) for n in orders) for name in names},
    )


def narrow(jets: Jets, density: Element) -> Element:
    """A density with the same integral, whose products of two derivatives are summed by parts.

    >>> field = Field(["u", "u_s", "u_ss", "c", "_degree"])
    >>> jets = Jets(field, {"u": ("u", "u_s", "u_ss")})
    >>> narrow(jets, field["c"] * field["u_s"] ** 2 / 2 + field["u"] ** 3)
    -c*u*u_ss/2 + u**3
    """
    field, found = jets.field, list[Element]()
    for term in field.terms(density):
        named = sorted(field.reach(term) & jets.orders.keys())
        factors = _read_pair(field, term, named)
        if factors is None:
            found.append(term)
            continue
        (first, j), (second, k) = (jets.orders[x] for x in factors)
        constant = term / (field[factors[0]] * field[factors[1]])
        moved = field[first] * field[jets.towers[second][j + k]]
        found.append(constant * moved * (-1) ** j)
    return field.sum(found)


def _read_pair(field: Field, term: Element, named: Sequence[str]) -> tuple[str, str] | None:
    """The two jets of a term that is their product and a constant; None of any other."""
    if len(named) not in (1, 2) or field.functions_in(term):
        return None
    first, second = named[0], named[-1]
    rest = term / (field[first] * field[second])
    return None if field.reach(rest) & {first, second} else (first, second)
