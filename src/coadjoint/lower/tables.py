"""Lowering, tables: rates that are sums of many products of two values, as loops.

Comes in: Equations. Goes out: a `Table` where the rates are such sums, and the Programs of the
rates, of their derivative along a vector, and of energy and observables of the same form. The
terms of a bracket on so(n) grow with the cube of n: written out, those of so(20) are 10 000
operations, and the entries of its Jacobian 7000 statements. A loop over a table of coefficients has
a text that compilers read at once.
Read next: `coadjoint.lower.check`, which undoes this exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, Final

from coadjoint.derive import Equations
from coadjoint.derive.formulas import Rows
from coadjoint.exact import Element, Field
from coadjoint.lower.program import (
    Multiply,
    Number,
    Output,
    Program,
    Statement,
    Symbol,
    Table,
)

#: Products in all rates together beyond which they are loops: so(8) has 336 and is written out,
#: so(9) has 504 (docs/decisions/coefficient-tables.md).
UNROLLED_PRODUCTS: Final = 400
#: The name of the value that is the number 1.
_ONE: Final = ""
#: A term: factors that are values, its number, and what else is in it: factors and denominators.
_Term = tuple[tuple[str, ...], Fraction, Any]
#: A product of two names: their number, and the names in the order of the field.
_Product = tuple[Fraction, str, str]


def find_products(equations: Equations) -> list[list[_Product]]:
    """The rates as sums of products of two values; none where they are no such sums.

    The values are components of the state and definitions, such as velocities, that are a
    component of the state times what depends on parameters alone. Systems that solve for
    velocities, or that have something to reconstruct, have none.
    """
    exact, state = equations.exact, equations.setting.state
    if exact.solves or equations.followed or not exact.definitions:
        return []
    rows = [_split(equations.setting.field, rate) for rate in exact.rates]
    names = {name for row in rows for _, *pair in row for name in pair}
    values = equations.moving.intersection({*state, *dict(exact.definitions)})
    return rows if all(rows) and values.difference(equations.numbers) >= names else []


def _split(field: Field, rate: Element) -> list[_Product]:
    """The terms of a rate, if all of them are products of two names; else none."""
    found = list[_Product]()
    for written in field.quotients(rate):
        for monomial in written.monomials:
            factors = [name for name, power in monomial.powers for _ in range(power)]
            if written.divisors or len(factors) != 2:
                return []
            found.append((monomial.number, factors[0], factors[1]))
    return found


def loop_over(
    definitions: Program, rows: Rows, products: Sequence[Sequence[_Product]]
) -> Program | None:
    """The Program of rates that loops over a table; None where a definition has another form.

    Args:
        definitions: A Program of the definitions alone.
        rows: What the function computes.
        products: The rates.
    """
    statements = definitions.statements_at("member")
    state, scaled, scales = rows.state, list[int](), list[Number | Symbol]()
    for statement in statements:
        match statement.value:
            case Multiply(left=(Number() | Symbol()) as scale, right=Symbol(name=name)):
                if name not in state or (isinstance(scale, Symbol) and scale.name in state):
                    return None
                scaled.append(state.index(name))
                scales.append(scale)
            case _:
                return None
    names = (*state, *(statement.name for statement in statements))
    place = {name: n for n, name in enumerate(names)}
    table = Table(
        entries=tuple(
            (i, place[a], place[b], number)
            for i, row in enumerate(products)
            for number, a, b in row
        ),
        vectors=(names,),
        scaled=tuple(scaled),
        scales=tuple(scales),
        passes=((0, 0),),
    )
    return _add_sums(definitions, rows, table)


def differentiate_along(rhs: Program, rows: Rows) -> Program:
    """The derivative of looped rates along a vector: ``c dx y + c x dy`` for each ``c x y``.

    Args:
        rhs: The rates, whose outputs are those of a table.
        rows: What the function computes, and the components of the vector.
    """
    assert rhs.table is not None, rhs.name
    slopes = tuple(f"_g{n + 1}" for n in range(len(rhs.table.scaled)))
    vectors = (*rhs.table.vectors, (*rows.along, *slopes))
    table = replace(rhs.table, vectors=vectors, passes=((1, 0), (0, 1)))
    statements = [Statement(name, value, "member") for name, value in table.products()]
    program = replace(
        rhs,
        name="jacobian_vector",
        state=rows.state,
        statements=(*rhs.statements_at("parameters"), *statements),
    )
    return _add_sums(program, rows, table)


def loop_rows(rows: Rows, name: str, rhs: Program) -> Program | None:
    """A function of the values of looped rates as a Program that loops over them, too.

    Args:
        rows: What the function computes: the energy, or observables.
        name: Its name.
        rhs: The rates.

    Returns:
        None where a row is no sum of products of two values, of values and of numbers.
    """
    assert rhs.table is not None, rhs.name
    splitting = _Splitting(rows.of, rhs)
    products = [splitting.split(element) for element in rows.elements]
    if not all(products):
        return None
    place = {each: n for n, each in enumerate((*rhs.table.vectors[0], _ONE))}
    entries = (
        (i, place[a], place[b], number) for i, row in enumerate(products) for number, a, b in row
    )
    table = replace(rhs.table, entries=tuple(entries))
    return _add_sums(replace(rhs, name=name, shape=rows.shape), rows, table)


class _Splitting:
    """Elements as sums of products of two values, each with a number.

    Args:
        equations: Where the elements are from.
        rhs: The looped rates, which say what the values are.
    """

    def __init__(self, equations: Equations, rhs: Program) -> None:
        assert rhs.table is not None, rhs.name
        self.field, names = equations.setting.field, rhs.table.vectors[0]
        self._values = frozenset(names)
        self._scaled: dict[str, tuple[str, _Term]] = {}
        known = dict(equations.exact.definitions)
        for name, place in zip(names[len(rhs.state) :], rhs.table.scaled, strict=True):
            terms = self._terms(known[name])
            if len(terms) == 1:
                self._scaled[rhs.state[place]] = name, terms[0]

    def split(self, element: Element) -> list[_Product]:
        """The terms; none where one has another form."""
        found = list(map(self._match, self._terms(element)))
        return [each for each in found if each] if all(found) else []

    def _terms(self, element: Element) -> list[_Term]:
        """The terms as they are written."""
        found = list[_Term]()
        for written in self.field.quotients(element):
            for monomial in written.monomials:
                product = tuple(
                    name
                    for name, power in monomial.powers
                    if name in self._values
                    for _ in range(power)
                )
                rest = tuple(each for each in monomial.powers if each[0] not in self._values)
                found.append((product, monomial.number, (rest, written.divisors)))
        return found

    def _match(self, term: _Term) -> _Product | None:
        """A term of two values; one that is scaled stands for a component and all of the rest."""
        product, number, rest = term
        if len(product) > 2:
            return None
        left, right = (*product, _ONE, _ONE)[:2]
        if rest == ((), ()):
            return number, left, right
        for name, other in ((left, right), (right, left)):
            scaled, (_, part, own) = self._scaled.get(name, ("", ((), number, None)))
            if rest == own:
                return number / part, scaled, other
        return None


def _add_sums(program: Program, rows: Rows, table: Table) -> Program:
    """A Program with the rows of a table as its outputs."""
    labels = (label for label, _ in rows.lines)
    outputs = tuple(Output(*pair) for pair in zip(labels, table.sums(), strict=True))
    return replace(program, outputs=outputs, shape=rows.shape, table=table)
