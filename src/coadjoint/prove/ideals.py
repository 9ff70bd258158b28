r"""Ideals: what is zero where given relations hold, such as ``Pi . Gamma = 0``.

Comes in: the relations, as elements of the field. Goes out: remainders modulo the ideal that their
numerators generate, and the branches of their zero set. A remainder of zero proves that an element
vanishes wherever the relations do and its denominator does not. One that is not zero proves
nothing: ``x y = 0`` holds where x = 0, and where y = 0, and there each relation is looked at anew.

.. math:: Z(f g, r) = Z(f, r) \cup Z(g, r), \qquad
    Z(s x + t, r) = Z(x + t/s, r) \setminus Z(s) \;\cup\; Z(s, t, r)

A factor that a declared sign or inequality keeps from zero is dropped. So is one of parameters
alone, since claims hold for almost all parameters, and the text says so.
Read next: `coadjoint.prove.zero`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property, lru_cache, reduce
from itertools import islice
from operator import mul
from typing import Any

from sympy.polys.groebnertools import groebner
from sympy.polys.orderings import grevlex
from sympy.polys.rings import PolyElement, PolyRing

from coadjoint.exact import Element, Field, element_text
from coadjoint.exact.division import find_remainder
from coadjoint.exact.element import numerator
from coadjoint.exact.irreducible import FACTORED, all_factors
from coadjoint.exact.signs import Signs, is_factor
from coadjoint.prove.points import Branch, Points, Values

#: Branches of a zero set that are told apart; beyond them relations stay as they are.
BRANCHES = 32
#: Addends of a factor by which a relation is divided, on a separate branch where it vanishes.
SLOPE = 4

_Numerators = dict[tuple[int, ...], PolyElement]


class Ideal:
    """The ideal of the numerators of some elements.

    Args:
        field: Where the elements live.
        relations: What is zero.
        text: The relations for people, ``dot(Pi, Gamma) = 0``.
        variables: Symbols that may be solved for; by default all but parameters.
        nonzero: What is not zero where the relations are looked at, apart from what has a declared
            sign: where the rows of constraints vanish, no motion is defined.

    >>> field = Field(["x", "y", "z"])
    >>> x, y, z = field["x"], field["y"], field["z"]
    >>> ideal = Ideal(field, [x * y - z], "x*y = z")
    >>> ideal.contains(x**2 * y / z - x), ideal.contains(x - y)
    (True, False)
    >>> [dict(branch.solved) for branch in Ideal(field, [x * y]).branches]
    [{'x': 0}, {'y': 0}]
    """

    def __init__(
        self,
        field: Field,
        relations: Sequence[Element],
        text: str = "",
        variables: Sequence[str] = (),
        nonzero: Sequence[Element] = (),
    ) -> None:
        self.field = field
        self.text = text
        self.nonzero = tuple(nonzero)
        self._signs = Signs(field, strict=True, more=field.region.bounds)
        parameters = field.region.parameters
        self._variables = frozenset(variables or field.names) - parameters
        self._declared: Sequence[Element] | None = None  # relations of parameters, once these split
        self.excluded: list[Element] = []  # factors that nothing declared keeps from zero
        normal = [each for each in map(field.normal, relations) if each != 0]
        self.given = tuple(normal)
        self._between_parameters = [each for each in normal if self._is_generic(each)]
        self.relations = tuple(map(self._strip, normal))
        numerators = list(map(numerator, self.relations))
        numerators += map(numerator, self._of_functions())
        self._places = sorted(
            {n for p in numerators for exponents in p for n, e in enumerate(exponents) if e}
        )
        if numerators:
            whole = numerators[0].ring
            symbols = [whole.symbols[n] for n in self._places]
            self._ring = PolyRing(symbols, whole.domain, grevlex)  # half the time of lex
        self._basis = _groebner_basis(
            [poly for p in numerators for poly in self._coefficients(p).values()]
        )

    def also(self, relations: Sequence[Element], text: str) -> Ideal:
        """The ideal with further relations, under a text for all; what is not zero stays so."""
        whole = Ideal(self.field, [*relations, *self.relations], text, nonzero=self.nonzero)
        whole.excluded += [each for each in self.excluded if each not in whole.excluded]
        return whole

    @property
    def scope(self) -> str:
        """The relations for people, and what is not zero where they hold."""
        shown = sorted(element_text(self.field, each) for each in self.excluded)
        return ", ".join([*filter(None, [self.text]), *(f"{each} not 0" for each in shown)])

    # -- the ideal ------------------------------------------------------------------------

    def remainder(self, element: Element) -> Element:
        """The remainder of an element's numerator; 0 only if the ideal contains it."""
        combined = self.field.normal(element).combine()
        if combined == 0 or not self._basis:
            return combined
        terms: dict[tuple[int, ...], Any] = {}
        top = numerator(combined)
        for outer, inner in self._coefficients(top).items():
            for exponents, value in find_remainder(inner, self._basis).terms():
                whole = list(outer)
                for place, exponent in zip(self._places, exponents, strict=True):
                    whole[place] = exponent
                terms[tuple(whole)] = value
        names = [str(symbol) for symbol in top.ring.symbols]  # functions among them
        return self.field.normal(self.field.polynomial(names, terms))

    def contains(self, element: Element) -> bool:
        """Whether an element vanishes wherever the relations do, as the ideal shows."""
        return bool(self.remainder(element) == 0)

    def _coefficients(self, top: PolyElement) -> _Numerators:
        """A polynomial as one in the symbols that no relation has; its coefficients by exponents.

        Each is reduced by itself, among the few symbols of the relations: for two coupled bodies,
        one of 30 symbols whole takes a hundred times as long.
        """
        parts: dict[tuple[int, ...], dict[tuple[int, ...], Any]] = {}
        for exponents, value in top.terms():
            outer = [0 if n in self._places else e for n, e in enumerate(exponents)]
            inner = tuple(exponents[n] for n in self._places)
            parts.setdefault(tuple(outer), {})[inner] = value
        return {outer: self._ring.from_dict(terms) for outer, terms in parts.items()}

    def _of_functions(self) -> list[Element]:
        """The relations of the functions that the relations have: ``s^2 + c^2 = 1``."""
        field, generators = self.field, list[Element]()
        called = {g for each in self.relations for g in field.functions_in(each)}
        for known in field.adjoined.values():
            own = field[known.generator]
            square = field.square_of(known)
            if square is not None and {known.generator, known.partner} & called:
                generators.append(own**2 - square)
        return generators

    def _strip(self, relation: Element) -> Element:
        """A relation without factors that are not zero; those that only we exclude are noted."""
        factors = self._factors(relation)
        generic = [] if self._between_parameters else list(filter(self._is_generic, factors))
        kept = [factor for factor in factors if factor not in generic]
        if not kept:  # a relation between parameters, or one that holds nowhere
            return relation
        for factor in factors:
            if factor not in kept:
                self._exclude(factor)
        return reduce(mul, kept)

    def may_vanish(self, element: Element) -> bool:
        """Whether a polynomial in what moves may vanish where it is not known to be nonzero."""
        value = self.field.normal(element)  # cos^2 + sin^2 is 1
        moves = not self.field.reach(value) <= self.field.region.parameters
        factors = list(all_factors(self.field, value)) or [value]
        return moves and not all(self._signs.is_nonzero(each, self.excluded) for each in factors)

    # -- branches of the zero set ---------------------------------------------------------

    @cached_property
    def branches(self) -> tuple[Branch, ...]:
        """Parts of the zero set that are all of it, but for what is excluded; none if it is empty.

        What holds on each of them, and has no pole there, holds on the zero set.
        """
        self._count, own = 0, self._between_parameters
        others = [each for each in self.relations if each not in own]
        branches = list[Branch]()
        for first in tuple(
            self._split_branches(own, Branch())
        ):  # all before what follows is generic
            self._declared = first.rest
            start = Branch(first.solved, (), first.nonzero)
            branches += self._split_branches([*first.rest, *others], start)
        return tuple(regular for branch in branches for regular in self._regular(branch))

    def _regular(self, branch: Branch) -> list[Branch]:
        """A branch with what must not vanish there; none if that vanishes on all of it."""
        rest, regular = Ideal(self.field, branch.rest), list[Element]()
        if rest.contains(self.field.one):  # an empty branch
            return []
        for element in self.nonzero:
            try:
                value = self.field.normal(self._on(branch, element))
            except ZeroDivisionError:  # no value, and so no motion
                return []
            if rest.contains(value):
                self._exclude(self._vanishing_factor(element, branch, rest))
                return []
            if self.field.as_number(value) is None and value not in regular:
                regular.append(value)
        return [replace(branch, regular=tuple(regular))]

    def _vanishing_factor(self, element: Element, branch: Branch, rest: Ideal) -> Element:
        """The factor that makes an element vanish on a branch; all of it if no factor does."""
        for factor in all_factors(self.field, element):
            with suppress(ZeroDivisionError):
                if rest.contains(self._on(branch, factor)):
                    return factor
        return element

    @cached_property
    def some_points(self) -> tuple[tuple[Points, Values], ...]:
        """A point of the zero set, in the assumed region; none if none is found."""
        return tuple(islice(self.points(), 1))

    def points(self, defined: Sequence[Element] = ()) -> Iterator[tuple[Points, Values]]:
        """Points of the zero set; the first ones near the defaults, where none need be solved for.

        Args:
            defined: Functions that must have values there.
        """
        functions = (*self.given, *defined)
        start = Branch(rest=self.relations, regular=self.nonzero)
        whole = Points(self.field, (), start, functions)
        yield from ((whole, point) for point in whole.near_defaults())
        for branch in self.branches:
            with suppress(ZeroDivisionError):
                points = Points(self.field, (), branch, functions)
                yield from ((points, point) for point in points)

    def _split_branches(self, relations: Sequence[Element], branch: Branch) -> Iterator[Branch]:
        """The branches of some relations below what is solved for already."""
        try:
            left = [self.field.normal(self._on(branch, each)) for each in relations]
        except ZeroDivisionError:  # where that vanishes is another branch
            return
        left = [each for each in left if each != 0]
        if self._count >= BRANCHES:
            yield Branch(branch.solved, tuple(left), branch.nonzero)
            return
        for n, relation in enumerate(left):
            factors = [f for f in self._factors(relation, branch.nonzero) if self._may_vanish(f)]
            if len(factors) != 1:
                others = [*left[:n], *left[n + 1 :]]
                for count, factor in enumerate(factors):
                    self._count += count > 0
                    yield from self._split_branches([factor, *others], branch)
                return
            left[n] = factors[0]
        squares = [self._signs.squares(relation) for relation in left]
        if any(squares):
            parts = (s or [r] for s, r in zip(squares, left, strict=True))
            yield from self._split_branches([each for part in parts for each in part], branch)
            return
        yield from self._solve(left, branch)

    def _solve(self, left: list[Element], branch: Branch) -> Iterator[Branch]:
        """The branches of irreducible relations: one is solved, and the others are looked at."""
        choices = sorted(self._linear(left, branch), key=lambda choice: choice[0])
        if not choices:
            yield Branch(branch.solved, tuple(left), branch.nonzero)
            return
        (divides, size, *_), n, name, slope = choices[0]
        field, relation = self.field, left[n]
        # An irreducible relation alone generates a prime ideal, on all of which vanishes what does
        # where the slope is not 0; with functions it need not be irreducible.
        factored = len(numerator(relation)) <= FACTORED
        alone = len(left) == 1 and factored and field.is_function_free(relation)
        if divides and not alone and size > SLOPE:
            yield Branch(branch.solved, tuple(left), branch.nonzero)
            return
        rest = field.substitute(relation, {name: field.zero})
        root, others = -rest / slope, [*left[:n], *left[n + 1 :]]
        try:
            known = {x: field.substitute(v, {name: root}) for x, v in branch.solved.items()}
        except ZeroDivisionError:
            return
        nonzero = (*branch.nonzero, slope) if divides else branch.nonzero
        yield from self._split_branches(others, Branch({**known, name: root}, (), nonzero))
        if divides and not alone:
            self._count += 1
            yield from self._split_branches([slope, rest, *others], branch)

    def _linear(
        self, left: Sequence[Element], branch: Branch
    ) -> Iterator[tuple[tuple[Any, ...], int, str, Element]]:
        """Symbols for which relations can be solved, with their slopes; keys sort the best first.

        The best slope is one that vanishes nowhere, then one of few addends.
        """
        for n, relation in enumerate(left):
            names = self.field.reach(relation)
            between_parameters = names <= self.field.region.parameters
            allowed = names if between_parameters else names & self._variables
            for name in sorted(allowed, key=self.field.names.index):
                if not self._has_room(name):
                    continue
                slope = self.field.derivative(relation, name)
                if slope == 0 or name in self.field.reach(slope):
                    continue
                divides = not self._signs.is_nonzero(slope, branch.nonzero)
                size = len(self.field.terms(slope))
                yield (divides, size, n, self.field.names.index(name)), n, name, slope

    def _has_room(self, name: str) -> bool:
        """Whether the functions of a symbol can be called with another argument."""
        called = [g for g in self.field.adjoined if name in self.field.reach(self.field[g])]
        return 2 * len(called) <= self.field.room

    def _factors(self, relation: Element, nonzero: Sequence[Element] = ()) -> list[Element]:
        """The irreducible factors of a numerator that may vanish, each once."""
        factors = list[Element]()
        if len(numerator(relation)) > FACTORED:
            return [relation]
        for element in all_factors(self.field, relation):
            if self._signs.is_nonzero(element, nonzero):
                continue
            if is_factor(self.field, element, self.nonzero):
                self._exclude(element)
                continue
            root = self._radicand(element)  # sqrt(u) = 0 where u = 0
            factors += self._factors(root, nonzero) if root is not None else [element]
        return [each for n, each in enumerate(factors) if each not in factors[:n]]

    def _radicand(self, element: Element) -> Element | None:
        """The argument of an element that is a square root."""
        for known in self.field.adjoined.values():
            if known.function == "sqrt" and element == self.field[known.generator]:
                return known.argument
        return None

    def _may_vanish(self, factor: Element) -> bool:
        """Whether a factor is not a relation of parameters that only the others bring about."""
        if self._declared is not None and self._is_generic(factor, self._declared):
            self._exclude(factor)
            return False
        return True

    def _is_generic(self, element: Element, but: Sequence[Element] = ()) -> bool:
        """Whether an element has symbols, and these are parameters; some are declared to vanish."""
        reached = self.field.reach(element)
        return bool(reached) and reached <= self.field.region.parameters and element not in but

    def _exclude(self, factor: Element) -> None:
        if factor not in self.excluded:
            self.excluded.append(factor)

    def _on(self, branch: Branch, element: Element) -> Element:
        return self.field.substitute(element, branch.solved)

    # -- one branch for what is said of almost all points ----------------------------------

    @property
    def solved(self) -> Mapping[str, Element]:
        """Some symbols in terms of the others, on the first branch: at its generic points."""
        return self.branches[0].solved if self.branches else {}

    @property
    def is_solved(self) -> bool:
        """Whether there is one branch, and `solved` gives all of it but for poles."""
        return len(self.branches) == 1 and not self.branches[0].rest

    def on_zero_set(self, element: Element) -> Element:
        """An element with the solved symbols replaced."""
        return self.field.substitute(element, self.solved)


def _groebner_basis(polynomials: Sequence[PolyElement]) -> list[PolyElement]:
    """A Groebner basis; of one polynomial it is that polynomial.

    Of polynomials that share no symbol the bases together are one, since their leading monomials
    have no common factor: attitudes of many bodies are looked at one by one.
    """
    basis = list[PolyElement]()
    for symbols, part in _split_apart(polynomials):
        whole, places = part[0].ring, sorted(symbols)
        few = PolyRing([f"x{n}" for n in range(len(places))], whole.domain, whole.order)
        given = (few.from_dict(_pick(each, places)) for each in part)
        for found in _solve_part(tuple(given)) if len(part) > 1 else given:
            rows = (dict(zip(places, exponents, strict=True)) for exponents in found)
            spread = (tuple(row.get(n, 0) for n in range(whole.ngens)) for row in rows)
            basis.append(whole.from_dict(dict(zip(spread, found.values(), strict=True))))
    return basis


def _pick(polynomial: PolyElement, places: Sequence[int]) -> dict[tuple[int, ...], Any]:
    """A polynomial in the symbols at some places, which has no others."""
    return {tuple(exponents[n] for n in places): x for exponents, x in polynomial.items()}


@lru_cache(maxsize=16)
def _solve_part(polynomials: tuple[PolyElement, ...]) -> list[PolyElement]:
    """A Groebner basis; that of equal bodies is found once."""
    return list(groebner(list(polynomials), polynomials[0].ring))


def _split_apart(polynomials: Sequence[PolyElement]) -> list[tuple[set[int], list[PolyElement]]]:
    """Polynomials in groups that share no symbol, with the places of their symbols."""
    groups: list[tuple[set[int], list[PolyElement]]] = []
    for each in polynomials:
        named = {n for exponents in each for n, e in enumerate(exponents) if e}
        near = [group for group in groups if group[0] & named]
        groups = [group for group in groups if group not in near]
        symbols = named.union(*(group[0] for group in near))
        groups.append((symbols, [*(p for group in near for p in group[1]), each]))
    return groups
