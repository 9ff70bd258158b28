"""Relations between elementary functions: rewriting them in functions that have none.

Comes in: the functions of a field that occur in an element. Goes out: for each of them an element
of another ring, so that hidden zeros become the polynomial 0: ``exp(a + b) = exp(a) exp(b)``, sines
and cosines of sums and multiples, ``sqrt(a) sqrt(b) = sqrt(a b)``, ``sqrt(a^2) = |a|``,
``log(a b) = log|a| + log|b|``. Nothing depends on the order in which functions were adjoined.

- Arguments of exponentials, and of sines, generate a lattice over the integers. Its basis gives the
  generators; each function is a product, or a sum by the addition theorem, of theirs.
- A radicand is a product of factors. Where radicands multiply to a square, one root is the quotient
  of that square's root by the others. A root is not negative: it is the absolute value, whose sign
  factors are 1, unknown (a generator of square 1 for each factor), or follow from one another,
  since every radicand, argument of a logarithm and condition of the field is positive.

What is zero in the new ring is zero wherever it is defined. What is not zero there may still be a
hidden zero: only a point proves that it is none (`coadjoint.exact.witness`).
Read next: `coadjoint.exact.lattices`, `coadjoint.exact.signs`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property, reduce
from math import prod
from operator import mul

from sympy.polys.rings import PolyElement

from coadjoint.exact.element import Element
from coadjoint.exact.factors import (
    Factor,
    Powers,
    SignRow,
    eliminate_signs,
    exact,
    factors_of,
    multiply,
    number_factors,
    odd_factors,
    reduce_signs,
)
from coadjoint.exact.field import Field
from coadjoint.exact.lattices import Lattice
from coadjoint.exact.signs import sign_of_sum
from coadjoint.exact.witness import witness_nonzero
from coadjoint.exact.written import Adjoined

#: Terms of a sine of a sum; one with more keeps a generator of its own.
EXPANDED = 64
#: Generators for signs and logarithms beyond one for each factor of a radicand or an argument.
SPARE = 3


#: What a term costs to rewrite, in products of two terms.
WORK = 20


class Relations:
    """Some functions of a field in independent ones.

    Args:
        field: Where the functions live.
        names: Their generators, with those in their arguments.

    >>> field = Field(["x", "y"], slots=3)
    >>> sines = [field.call("sin", field["x"] * n) for n in (1, 2, 3)]
    >>> cosine = field.call("cos", field["x"])
    >>> relations = Relations(field, sorted(field.adjoined))
    >>> relations.vanishes(sines[1] - 2 * sines[0] * cosine)
    True
    >>> relations.vanishes(sines[2] - 2 * sines[0] * cosine)
    False
    """

    def __init__(self, field: Field, names: Iterable[str]) -> None:
        self.field, self.names = field, frozenset(names)
        called = [known for name, known in field.adjoined.items() if name in self.names]
        powers = [known for known in called if known.function == "exp"]
        angles = [known for known in called if known.function in ("sin", "cos")]
        products = [known for known in called if known.function in ("sqrt", "log")]
        roots = sum(known.function == "sqrt" for known in products)
        self._exponents = Lattice(field, [known.argument for known in powers], halved=roots > 0)
        self._angles = Lattice(field, [known.argument for known in angles])
        self._lonely = [n for n, row in enumerate(self._angles.rows) if _terms(row) > EXPANDED]
        count = len(self._exponents.basis) + 2 * len(self._angles.basis) + 2 * len(self._lonely)
        count += sum(SPARE + len(_polynomial_factors(field, known.argument)) for known in products)
        self._free = [f"__{n + 1}" for n in range(count)]
        self.ring = Field([*field.names, *self._free], positive=field.positive)
        self._positive = set(field.positive)
        self._squares: dict[str, Element] = {}
        self._images: dict[str, Element] = {}
        self._radicals: list[Radical] = []
        self._signs: dict[Factor, Element] = {}
        self._logarithms: dict[Factor, Element] = {}
        self._rows: list[SignRow] = []
        self._powers = [self._new(positive=True) for _ in self._exponents.basis]
        self._circles = [self._circle() for _ in self._angles.basis]
        self._angles_of = {known.generator: n for n, known in enumerate(angles)}
        self._exponents_of = {known.generator: n for n, known in enumerate(powers)}
        self._alone: dict[tuple[Fraction, ...], tuple[Element, Element]] = {}
        for known in called:
            self._images[known.generator] = self._image_of(known)
        for condition in field.conditions:
            if condition.element and field.functions_in(condition.element) <= self.names:
                self._note_positive(self._factored(self._image(condition.element)))

    # -- the test -------------------------------------------------------------------------

    def vanishes(self, element: Element) -> bool:
        """Whether an element is zero by the relations; only numerators count."""
        if not element:
            return True
        top, _ = self.field.fraction(element.combined())
        return not self._reduced(self._reduced(self._of_polynomial(top)), self._known_signs())

    @cached_property
    def are_any(self) -> bool:
        """Whether a function is more than a generator of its own."""
        angles = set(self._angles.vectors)
        if len(self._exponents.rows) + len(angles) > len(self._powers) + len(self._circles):
            return True
        products = [
            image
            for name, image in self._images.items()
            if self.field.adjoined[name].function in ("sqrt", "log")
        ]
        own = {str(self.ring[name]) for name in self.ring.names[len(self.field.names) :]}
        plain = {text for image in products if (text := str(image)) in own}
        return len(plain) < len(products)

    def _known_signs(self) -> dict[str, Element]:
        """The signs of factors by others, as all that is positive together says."""
        rows = eliminate_signs(self._rows, list(self._signs))
        found = {}
        for factor, generator in self._signs.items():
            left, number = reduce_signs(frozenset([factor]), rows)
            if left != {factor} and left <= self._signs.keys():
                value = reduce(mul, (self._signs[f] for f in left), self.ring.one)
                found[str(generator)] = value * (-1) ** number
        return found

    # -- images ---------------------------------------------------------------------------

    def _image(self, element: Element) -> Element:
        """An element in the new ring, as one quotient."""
        values = {name: self.ring[name] for name in self.field.names} | self._images
        result = self.field.rewritten(element, values, self.ring.number)
        return self._reduced(result)

    def _of_polynomial(self, p: PolyElement) -> Element:
        return self._image(self.field.from_polynomial(p))

    def _reduced(self, element: Element, values: Mapping[str, Element] | None = None) -> Element:
        """An element with squares replaced, and signs that are known."""
        if values:
            element = self.ring.substitute(element, values)
        for name in reversed(self._squares):
            element = self.ring.reduce_squares(element.combined(), name, self._squares[name])
        return element.combined()

    def _new(self, *, positive: bool = False, square: Element | None = None) -> Element:
        """A new generator.

        Raises:
            OverflowError: There are more factors than the ring has room for.
        """
        if not self._free:
            raise OverflowError("no generator left")
        name = self._free.pop(0)
        if positive:
            self._positive.add(name)
        if square is not None:
            self._squares[name] = square
        return self.ring[name]

    def _circle(self) -> tuple[Element, Element]:
        """Cosine and sine of a new angle."""
        cosine = self._new()
        sine = self._new(square=1 - cosine**2)
        self._radicals.append(Radical(sine, self._factored(1 - cosine**2), signed=True))
        return cosine, sine

    def _image_of(self, known: Adjoined) -> Element:
        """A function in the new ring."""
        match known.function:
            case "exp":
                row = self._exponents.rows[self._exponents_of[known.generator]]
                return _product(self.ring, zip(self._powers, row, strict=True))
            case "sqrt":
                return self._root(self._image(known.argument))
            case "log":
                return self._logarithm(self._image(known.argument))
        place = self._angles_of[known.generator]
        cosine, sine = self._turned(place)
        return cosine if known.function == "cos" else sine

    def _turned(self, place: int) -> tuple[Element, Element]:
        """Cosine and sine of the argument in a place, by the addition theorem."""
        row = self._angles.rows[place]
        if place in self._lonely:
            key = self._angles.vectors[place]
            if key not in self._alone:
                self._alone[key] = self._circle()
            return self._alone[key]
        cosine, sine = self.ring.one, self.ring.zero
        for (c, s), count in zip(self._circles, row, strict=True):
            for _ in range(abs(count)):
                s_turn = s if count > 0 else -s
                cosine, sine = cosine * c - sine * s_turn, sine * c + cosine * s_turn
        return self._reduced(cosine), self._reduced(sine)

    # -- roots ----------------------------------------------------------------------------

    def _root(self, radicand: Element) -> Element:
        """The square root of an element."""
        if radicand == 0:
            return radicand
        vector = self._factored(radicand)
        self._note_positive(vector)
        odd, members = self._dependent(odd_factors(vector))
        if odd:
            return self._new_root(vector)
        for radical in members:
            vector = multiply(vector, radical.square)
        whole = self._absolute({f: e // 2 for f, e in vector.items()})
        for radical in members:
            value = radical.value
            if radical.signed:
                value = value * self._sign_of({self._only(value): 1})
            whole = whole * value / self._multiplied(radical.square)
        return self._reduced(whole)

    def _new_root(self, vector: Powers) -> Element:
        """A root that no others give: its square factors come out, the rest is a generator."""
        inner = dict.fromkeys(odd_factors(vector), 1)
        outer = self._absolute({f: e // 2 for f, e in vector.items()})
        root = self._new(positive=True, square=self._multiplied(inner))
        self._radicals.append(Radical(root, inner))
        return self._reduced(outer * root)

    def _dependent(self, odd: frozenset[Factor]) -> tuple[frozenset[Factor], list[Radical]]:
        """What is left of a product of factors modulo squares and radicands, and which of these."""
        rows: list[tuple[Factor, frozenset[Factor], frozenset[int]]] = []
        for n, radical in enumerate(self._radicals):
            rest, used = odd_factors(radical.square), frozenset([n])
            for pivot, row, members in rows:
                if pivot in rest:
                    rest, used = rest ^ row, used ^ members
            if rest:
                rows.append((min(rest, key=str), rest, used))
        chosen = frozenset[int]()
        for pivot, row, members in rows:
            if pivot in odd:
                odd, chosen = odd ^ row, chosen ^ members
        return odd, [self._radicals[n] for n in sorted(chosen)]

    def _absolute(self, vector: Powers) -> Element:
        """The absolute value of a product of powers of factors."""
        positive = {f: e for f, e in vector.items() if f != -1}
        return self._multiplied(positive) * self._sign_of(positive)

    def _sign_of(self, vector: Powers) -> Element:
        """The sign of a product: a number, or a product of generators of square 1."""
        rest, number = self._plain_signs(odd_factors(vector))
        signs = [self._sign_generator(f) for f in sorted(rest, key=str)]
        return reduce(mul, signs, self.ring.number((-1) ** number))

    def _sign_generator(self, factor: Factor) -> Element:
        """The sign of a factor."""
        if factor not in self._signs:
            self._signs[factor] = self._new(square=self.ring.one)
        return self._signs[factor]

    def _plain_signs(self, factors: frozenset[Factor]) -> tuple[frozenset[Factor], int]:
        """The factors without a sign of their own, and how many others are negative."""
        left, number = frozenset[Factor](), 0
        signs = {_numerator(sign): factor for factor, sign in self._signs.items()}
        for factor in factors:
            found = self._own_sign(factor)
            number += found < 0
            if not found:
                left ^= {signs.get(factor, factor)}  # a sign has that of its factor
        return left, number % 2

    def _own_sign(self, factor: Factor) -> int:
        """The sign of a factor that its terms show; of one that may be 0, its other values'."""
        if isinstance(factor, int):
            return 1 if factor > 0 else -1
        generators = self.ring.generators
        return sign_of_sum(factor, lambda n: 2 * (generators[n] in self._positive), strict=False)

    def _note_positive(self, vector: Powers) -> None:
        """Remember that a product of powers of factors is positive."""
        left, number = self._plain_signs(odd_factors(vector))
        if left:
            self._rows.append((left, number))

    # -- logarithms -----------------------------------------------------------------------

    def _logarithm(self, argument: Element) -> Element:
        """The sum of the logarithms of the absolute values of factors."""
        if argument == 0:
            raise ZeroDivisionError("the logarithm of 0")
        vector = self._factored(argument)
        self._note_positive(vector)
        parts = [self._logarithm_of(f) * e for f, e in vector.items()]
        return self._reduced(self.ring.sum(parts))

    def _logarithm_of(self, factor: Factor) -> Element:
        """The logarithm of the absolute value of a factor."""
        if factor == -1 or factor in map(_numerator, self._signs.values()):
            return self.ring.zero
        for base, power in zip(self._exponents.basis, self._powers, strict=True):
            known = self.field.functions_in(base) <= self._images.keys()
            if known and factor == _numerator(power):
                return self._image(base)
        for radical in self._radicals:
            if factor == _numerator(radical.value) and not radical.signed:
                parts = [self._logarithm_of(f) * e for f, e in radical.square.items()]
                return self.ring.sum(parts) / 2
            *others, last = sorted(radical.square, key=str)
            if radical.signed and factor == last:  # log|1 - cos| = 2 log|sin| - log|1 + cos|
                sine = self._logarithm_of(self._only(radical.value))
                return 2 * sine - self.ring.sum(map(self._logarithm_of, others))
        if factor not in self._logarithms:
            self._logarithms[factor] = self._new()
        return self._logarithms[factor]

    # -- factors --------------------------------------------------------------------------

    def _factored(self, element: Element) -> Powers:
        """A nonzero element as powers of factors."""
        top, bottom = self.ring.fraction(element.combined())
        vector: Powers = {}
        for p, power in [(top, 1), *((p, -e) for p, e in bottom)]:
            content, factors = factors_of(p)
            numbers = number_factors(exact(content))
            vector = multiply(vector, {f: e * power for f, e in numbers.items()})
            vector = multiply(vector, {f: e * power for f, e in factors})
        return vector

    def _multiplied(self, vector: Powers) -> Element:
        """The product of powers of factors."""
        return _product(
            self.ring,
            (
                (self.ring.number(f) if isinstance(f, int) else self.ring.from_polynomial(f), e)
                for f, e in vector.items()
            ),
        )

    def _only(self, generator: Element) -> PolyElement:
        """A generator as a factor."""
        return _numerator(generator)


class Radical:
    """A function whose square is a product of others.

    Args:
        value: The function.
        square: Its square.
        signed: Whether it may be negative, as a sine; a root is not.
    """

    def __init__(self, value: Element, square: Powers, *, signed: bool = False) -> None:
        self.value, self.square, self.signed = value, square, signed


def relations_of(field: Field, names: frozenset[str]) -> Relations | None:
    """The relations of some functions, remembered by the field; None where there are none.

    Where all functions of the field are independent, so are some of them.

    Args:
        field: Where the functions live.
        names: Their generators, with those in their arguments.
    """
    for asked in (frozenset(field.adjoined), names):
        if asked not in field.relations:
            field.relations[asked] = None  # for what the arguments themselves ask
            try:
                field.relations[asked] = _found_relations(field, asked)
            except BaseException:  # a budget that is spent says nothing of relations
                del field.relations[asked]
                raise
        if field.relations[asked] is None:
            return None
    known = field.relations[names]
    return known if isinstance(known, Relations) else None


def _found_relations(field: Field, names: frozenset[str]) -> Relations | str | None:
    """The relations; None if the functions are independent, or why they were not found."""
    try:
        found = Relations(field, names)
    except (OverflowError, ZeroDivisionError) as error:  # no room, or defined nowhere
        return str(error)
    return found if found.are_any else None


def vanish_by_relations(field: Field, element: Element, called: frozenset[str]) -> bool:
    """Whether the relations of functions show that an element is zero.

    Args:
        field: Where it lives.
        element: A single quotient.
        called: Generators of the functions in it, and of those that were cancelled: where a root is
            defined, its radicand is not negative.
    """
    known = relations_of(field, called)
    if known is not None:
        element.factors.spend(WORK * len(field.terms(element)))
    defined = [field[name] for name in sorted(called)]
    if known is None or witness_nonzero(field, element, defined, tries=1) is not None:
        return False
    return known.vanishes(element)


def _polynomial_factors(field: Field, element: Element) -> list[PolyElement]:
    """The factors of the numerator and the denominator of an element."""
    if element == 0:
        return []
    top, bottom = field.fraction(element.combined())
    return [f for p in (top, *(p for p, _ in bottom)) for f, _ in factors_of(p)[1]]


def _numerator(element: Element) -> PolyElement:
    return element.parts[0].numer


def _terms(row: Sequence[int]) -> int:
    """How many terms the cosine of a combination has, at most."""
    return prod(abs(n) + 1 for n in row)


def _product(ring: Field, powers: Iterable[tuple[Element, int]]) -> Element:
    return reduce(mul, (base**e for base, e in powers if e), ring.one)
