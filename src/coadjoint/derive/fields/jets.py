r"""Jets: the derivative along space on the exact field, and what follows from it.

Fields u and their derivatives :math:`u_k = \partial_s^k u` are symbols. On functions of these

.. math::
    D f = \sum_k u_{k+1} \frac{\partial f}{\partial u_k}, \qquad
    E_u f = \sum_k (-D)^k \frac{\partial f}{\partial u_k},

the total derivative and the Euler operator, which is the variational derivative of the integral of
f over the circle. f is a total derivative, ``f = D P``, if and only if ``E f = 0`` for every u,
where f is a polynomial (Olver 1993, Applications of Lie Groups to Differential Equations, 2nd ed.,
theorem 4.7). For one of degree n the homotopy formula gives P:

.. math:: P = \frac{1}{n} \sum_u \sum_{k \ge 0} u_k \sum_{j > k} (-D)^{j-k-1}
    \frac{\partial f}{\partial u_j}.

In a plane there are two derivations, :math:`u_{ij} = \partial_x^i \partial_y^j u`, the Euler
operator is :math:`\sum (-D_x)^i (-D_y)^j \partial f / \partial u_{ij}`, and f is a divergence
``D_x P + D_y Q``: P takes the derivatives along x from u, Q then those along y.
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

#: Symbols by how often they are differentiated along the first coordinate, row by row.
Rows = tuple[tuple[str, ...], ...]
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
    if spec.space.across is not None:  # all in psi: 4 for each derivative, and that doubled
        return 8 * order + 1
    return 2 * (order + 2 * order + _OPERATOR) + 1


def solved(spec: Spec) -> tuple[str, ...]:
    """The velocity on a circle, if a linear equation along all of it gives it: m = A u.

    In a plane it is the stream function.
    """
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
        symbol
        for name in (*list_components(spec.state), *solved(spec))
        for row in list_rows(name, spec.space.coordinates, depth(spec))
        for symbol in row
        if symbol != name
    ]
    return (*(name for name in names if name not in declared), DEGREE)


def list_rows(name: str, coordinates: Sequence[str], depth: int) -> Rows:
    """The symbols of a field and its derivatives up to an order, row by row.

    >>> list_rows("u", ["s"], 2), list_rows("w", ["x", "y"], 1)
    ((('u', 'u_s', 'u_ss'),), (('w', 'w_x'), ('w_y',)))
    """
    x, *y = coordinates
    return tuple(
        tuple(jet_name(name, x, i, *y, across=j) for i in range(depth - j + 1))
        for j in range(depth + 1 if y else 1)
    )


@dataclass(frozen=True)
class Jets:
    """Fields and their derivatives in an exact field.

    Attributes:
        field: Where they are symbols.
        rows: Of each field its symbol and those of its derivatives along the first coordinate, in
            order; in a plane then those of its first derivative along the second one, and so on.
    """

    field: Field
    rows: Mapping[str, Rows]

    def only(self, names: Sequence[str]) -> Jets:
        """Of some of the fields."""
        return Jets(self.field, {name: self.rows[name] for name in names})

    @cached_property
    def towers(self) -> dict[str, tuple[str, ...]]:
        """The first row of each field."""
        return {name: rows[0] for name, rows in self.rows.items()}

    @cached_property
    def coordinates(self) -> tuple[str, ...]:
        """The letters of the coordinates, by the names of the first derivatives."""
        name, rows = next(iter(self.rows.items()))
        firsts = (rows[0][1], rows[1][0]) if len(rows) > 1 else (rows[0][1],)
        return tuple(each.removeprefix(f"{name}_") for each in firsts)

    @cached_property
    def places(self) -> dict[str, tuple[str, int, int]]:
        """Of each symbol the field, and how often it is differentiated along both coordinates."""
        return {
            symbol: (name, i, j)
            for name, rows in self.rows.items()
            for j, row in enumerate(rows)
            for i, symbol in enumerate(row)
        }

    @cached_property
    def orders(self) -> dict[str, tuple[str, int]]:
        """Of each symbol along a line the field, and how often it is differentiated."""
        return {symbol: (name, i) for symbol, (name, i, _) in self.places.items()}

    @cached_property
    def _next(self) -> tuple[dict[str, str], dict[str, str]]:
        """The derivative of each symbol along both coordinates."""
        every = self.rows.values()
        return (
            {a: b for rows in every for row in rows for a, b in pairwise(row)},
            {
                a: b
                for rows in every
                for pair in pairwise(rows)
                for a, b in zip(*pair, strict=False)
            },
        )

    def total(self, element: Element, order: int = 1, across: int = 0) -> Element:
        """``D^order`` of an element, and so many derivatives along the second coordinate.

        >>> field = Field(["u", "u_s", "u_ss", DEGREE])
        >>> jets = Jets(field, {"u": list_rows("u", ["s"], 2)})
        >>> jets.total(field["u"] ** 2)
        2*u*u_s
        """
        along, aside = self._next
        for derived in (*[along] * order, *[aside] * across):
            reached = self.field.reach(element)
            tops = (reached & self.places.keys()) - derived.keys()
            assert not tops, f"no symbol for the derivative of {tops}"
            element = self.field.sum(
                self.field.derivative(element, a) * self.field[b]
                for a, b in derived.items()
                if a in reached
            )
        return element

    def slopes(self, element: Element, name: str) -> list[Element]:
        """Derivatives of an element by a field, its first derivative and so on, along a line."""
        (first, *_) = self._find_slopes(element, name) or [[]]
        return first

    def _find_slopes(self, element: Element, name: str) -> list[list[Element]]:
        """Derivatives by all symbols of a field, row by row, as far as there are any."""
        reached, found = self.field.reach(element), list[list[Element]]()
        for row in self.rows[name]:
            last = max((n for n, each in enumerate(row) if each in reached), default=-1)
            found.append(list(self.field.gradient(element, row[: last + 1])))
        while found and not found[-1]:
            found.pop()
        return found

    def _move(self, slopes: list[list[Element]], name: str) -> tuple[Element, Element, Element]:
        """``E f``, and the P and Q with ``sum u_ij f_ij = u E f + D_x P + D_y Q``."""
        field, along, aside = self.field, list[Element](), list[Element]()
        result, rows = field.zero, self.rows[name]
        for j in range(len(slopes) - 1, -1, -1):
            inner = field.zero
            for i in range(len(slopes[j]) - 1, -1, -1):
                inner = slopes[j][i] - self.total(inner)
                along += [field[rows[j][i - 1]] * inner] if i else []
            result = inner - self.total(result, 0, 1) if result else inner
            aside += [field[rows[j - 1][0]] * result] if j else []
        return result, field.sum(along), field.sum(aside)

    def euler(self, element: Element, name: str) -> Element:
        """The variational derivative of the integral of an element by a field.

        >>> field = Field(["u", "u_s", "u_ss", DEGREE])
        >>> jets = Jets(field, {"u": list_rows("u", ["s"], 2)})
        >>> jets.euler(field["u_s"] ** 2 / 2 + field["u"] * field["u_s"], "u")
        -u_ss
        """
        return self._move(self._find_slopes(element, name), name)[0]

    def variation(self, element: Element) -> dict[str, Element]:
        """The variational derivatives by all fields."""
        return {name: self.euler(element, name) for name in self.rows}

    def rate(self, element: Element, rates: Mapping[str, Element]) -> Element:
        """The time derivative of an element where each field has a rate."""
        terms = list[Element]()
        for name, rate in rates.items():
            for j, row in enumerate(self._find_slopes(element, name)):
                rate = moved = self.total(rate, 0, min(j, 1))
                for i, slope in enumerate(row):
                    moved = self.total(moved, min(i, 1))
                    terms += [slope * moved] if slope and moved else []
        return self.field.sum(terms)

    def integrate(self, element: Element) -> tuple[Element, ...] | None:
        """P with ``D P``, or P and Q with ``D_x P + D_y Q``, equal to an element without variation.

        None where no sum of homogeneous functions of the jets is seen: there, and for parts of
        degree 0, the formula says nothing.

        >>> field = Field(["u", "u_s", "u_ss", DEGREE])
        >>> jets = Jets(field, {"u": list_rows("u", ["s"], 2)})
        >>> jets.integrate(field["u"] * field["u_ss"] + field["u_s"] ** 2)
        (u*u_s,)
        """
        field = self.field
        scaled = field.substitute(element, {x: field[DEGREE] * field[x] for x in self.places})
        try:
            parts = field.coefficients(scaled, DEGREE)
        except ValueError:  # in a sum below a line, or in a function
            return None
        if 0 in parts:
            return None
        fluxes = [
            [flux * Fraction(1, n) for flux in self._move(self._find_slopes(part, name), name)[1:]]
            for n, part in parts.items()
            for name in self.rows
        ]
        along, aside = (
            (field.sum(own) for own in zip(*fluxes, strict=True))
            if fluxes
            else (
                field.zero,
                field.zero,
            )
        )
        in_plane = any(len(rows) > 1 for rows in self.rows.values())
        return (along, aside) if in_plane else (along,)

    def still(self, element: Element) -> Element:
        """An element where fields do not depend on space.

        A function without variation has one integral for all fields that can be deformed into one
        another where it is finite; so it has no integral if it is 0 there, as no constant is.

        Raises:
            ZeroDivisionError: It has no value there.

        >>> field = Field(["u", "u_s", "u_ss", DEGREE])
        >>> jets = Jets(field, {"u": list_rows("u", ["s"], 2)})
        >>> jets.still(field["u"] ** 2 + field["u_s"])
        u**2
        """
        zeros = {symbol: self.field.zero for symbol, (_, i, j) in self.places.items() if i or j}
        return self.field.substitute(element, zeros)

    def diverge(self, fluxes: Sequence[Element]) -> Element:
        """``D P``, or ``D_x P + D_y Q``."""
        return self.field.sum(self.total(flux, 1 - n, n) for n, flux in enumerate(fluxes))


@once
def jets_of(setting: Setting) -> Jets:
    """The fields of a spec, and their derivatives."""
    space = setting.spec.space
    assert space is not None, setting.spec.name
    names, coordinates = (*setting.state, *solved(setting.spec)), space.coordinates
    deep = depth(setting.spec)
    return Jets(setting.field, {name: list_rows(name, coordinates, deep) for name in names})


def narrow(jets: Jets, density: Element) -> Element:
    """A density with the same integral, whose products of two derivatives are summed by parts.

    >>> field = Field(["u", "u_s", "u_ss", "c", "_degree"])
    >>> jets = Jets(field, {"u": list_rows("u", ["s"], 2)})
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
