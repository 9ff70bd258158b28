"""Relations between elementary functions: rewriting them in functions that have none.

Comes in: the functions of a field that occur in an element. Goes out: for each of them an element
of another ring, so that hidden zeros become the polynomial 0: ``exp(a + b) = exp(a) exp(b)``, sines
and cosines of sums and multiples, ``sqrt(a) sqrt(b) = sqrt(a b)``, ``sqrt(a^2) = |a|``,
``log(a b) = log|a| + log|b|``. Algebraic numbers are polynomials in one of them
(`coadjoint.exact.constants`). Nothing depends on the order in which functions were adjoined.

- Arguments of exponentials, and of sines, generate a lattice over the integers. Its basis gives the
  generators; each function is a product, or a sum by the addition theorem, of theirs.
- A radicand is a product of factors. Where radicands multiply to a square, one root is the quotient
  of that square's root by the others. A root is not negative: it is the absolute value, whose sign
  factors are 1, unknown (a generator of square 1 for each factor), or follow from one another,
  since every radicand, argument of a logarithm and condition of the field is positive.

What is zero in the new ring is zero wherever it is defined. What is not zero there may still be a
hidden zero: only a point proves that it is none (`coadjoint.exact.witness`).
Read next: `coadjoint.exact.lattices`, `coadjoint.exact.products`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import cached_property
from math import lcm, prod

from sympy.polys.rings import PolyElement

from coadjoint.elementary import Arithmetic, evaluate
from coadjoint.exact.constants import find_constants, minimal_of_cosine
from coadjoint.exact.element import Element, numerator
from coadjoint.exact.factors import Factor, factors_of
from coadjoint.exact.field import Adjoined, Field, refuse_call
from coadjoint.exact.lattices import Lattice
from coadjoint.exact.products import Products, product
from coadjoint.exact.values import half_turns
from coadjoint.exact.witness import witness_nonzero

#: Functions in exponentials e of their arguments.
EXPONENTIALS = {
    "exp": "e",
    "sinh": "(e - 1/e)/2",
    "cosh": "(e + 1/e)/2",
    "tanh": "(e*e - 1)/(e*e + 1)",
}
#: Terms of a sine of a sum; one with more keeps a generator of its own.
EXPANDED = 64
#: Generators for signs and logarithms beyond one for each factor of a radicand or an argument.
SPARE = 3
#: Parts of a half turn whose cosines are algebraic numbers; with more, equations are too long.
PARTS = 60
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
        powers = [known for known in called if known.function in EXPONENTIALS]
        angles = [known for known in called if known.function in ("sin", "cos")]
        products = [known for known in called if known.function in ("sqrt", "log")]
        roots = sum(known.function == "sqrt" for known in products)
        self._exponents = Lattice(field, [known.argument for known in powers], halved=roots > 0)
        self._angles = Lattice(field, [known.argument for known in angles])
        self._lonely = [n for n, row in enumerate(self._angles.rows) if _terms(row) > EXPANDED]
        count = len(self._exponents.basis) + 2 * len(self._angles.basis) + 2 * len(self._lonely)
        count += 1 + sum(
            SPARE + len(_polynomial_factors(field, known.argument)) for known in products
        )
        count += len(called) - len(powers) - len(angles) - len(products)  # one for each other
        free = [f"__{n + 1}" for n in range(count)]
        self.ring = Field([*field.names, *free], positive=field.positive)
        self.products = Products(self.ring, free, self._exponent_of)
        self._images: dict[str, Element] = {}
        self._has_numbers = False
        self._powers = [self.products.new(positive=True) for _ in self._exponents.basis]
        self._turns = [half_turns(field, each) for each in self._angles.basis]
        parts = [lcm(2, turn.denominator) for turn in self._turns if turn is not None]
        self._take_numbers(called, max([each for each in parts if each <= PARTS], default=0))
        self._circles = [
            self.products.circle() if turn is None else self._part_of_turn(turn)
            for turn in self._turns
        ]
        self._angles_of = {known.generator: n for n, known in enumerate(angles)}
        self._exponents_of = {known.generator: n for n, known in enumerate(powers)}
        self._alone: dict[tuple[Fraction, ...], tuple[Element, Element]] = {}
        for known in called:
            if known.generator not in self._images:
                self._images[known.generator] = self._image_of(known)
        for condition in field.region.conditions:
            if condition.element and field.functions_in(condition.element) <= self.names:
                self.products.note_positive(self.products.factor(self._image(condition.element)))

    # -- the test -------------------------------------------------------------------------

    def vanishes(self, element: Element) -> bool:
        """Whether an element is zero by the relations; only numerators count."""
        if not element:
            return True
        top, _ = self.field.fraction(element.combine())
        image = self._image(self.field.from_polynomial(top))
        whole = self.products.normalize(image)  # over one denominator: squares come up again
        return not self.products.normalize(whole, self.products.derive_signs())

    @cached_property
    def are_any(self) -> bool:
        """Whether a function is more than a generator of its own."""
        angles = set(self._angles.vectors)
        if self._has_numbers or any(turn is not None for turn in self._turns):
            return True
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

    # -- images ---------------------------------------------------------------------------

    def _take_numbers(self, called: Sequence[Adjoined], parts: int) -> None:
        """Algebraic numbers by one of them; ``parts`` of a half turn have a cosine that occurs."""
        self._cosine = self.ring.one
        constants = find_constants(self.field, called, parts)
        if constants is None:
            if parts:
                self._cosine = self.products.algebraic(minimal_of_cosine(parts))
            return
        number = self.products.algebraic(constants.numbers.minimal)
        values = [
            self.ring.sum(number**n * c for n, c in constants.powers_of(place).items())
            for place in range(len(constants.roots) + bool(parts))
        ]
        self._images |= dict(zip(constants.roots, values, strict=False))
        self._cosine = values[-1]
        self._has_numbers = True
        for generator in constants.roots:
            known = self.field.adjoined[generator]
            if known.function == "sqrt":
                self.products.know_root(self._images[generator], self._image(known.argument))

    def _image(self, element: Element) -> Element:
        """An element in the new ring, as one quotient."""
        values = {name: self.ring[name] for name in self.field.names} | self._images
        result = self.field.evaluate(element, values, self.ring.number)
        return self.products.normalize(result)

    def _exponent_of(self, factor: Factor) -> Element | None:
        """The argument of the exponential that a factor is, if it can be written by now."""
        for base, power in zip(self._exponents.basis, self._powers, strict=True):
            known = self.field.functions_in(base) <= self._images.keys()
            if known and factor == numerator(power):
                return self._image(base)
        return None

    def _image_of(self, known: Adjoined) -> Element:
        """A function in the new ring."""
        match known.function:
            case "sqrt":
                return self.products.root(self._image(known.argument))
            case "log":
                return self.products.logarithm(self._image(known.argument))
            case "sin" | "cos":
                cosine, sine = self._turn(self._angles_of[known.generator])
                return cosine if known.function == "cos" else sine
            case "sign":
                return self.products.sign_of(self._image(known.argument))
            case function if function in EXPONENTIALS:
                row = self._exponents.rows[self._exponents_of[known.generator]]
                power = product(self.ring, zip(self._powers, row, strict=True))
                own = Arithmetic(number=self.ring.number, call=refuse_call)
                return self.products.normalize(evaluate(EXPONENTIALS[function], own, e=power))
        return self.products.new()

    def _part_of_turn(self, turn: Fraction) -> tuple[Element, Element]:
        """Cosine and sine of a rational multiple of pi, in the cosine of a smallest part."""
        parts = lcm(2, turn.denominator)
        if parts > PARTS:
            return self.products.circle()
        count = int(turn * parts)
        both = (cosine_of_multiple(self.ring, self._cosine, n) for n in (count, parts // 2 - count))
        first, second = map(self.products.normalize, both)
        return first, second

    def _turn(self, place: int) -> tuple[Element, Element]:
        """Cosine and sine of the argument in a place, by the addition theorem."""
        row = self._angles.rows[place]
        if place in self._lonely:
            key = self._angles.vectors[place]
            if key not in self._alone:
                self._alone[key] = self.products.circle()
            return self._alone[key]
        cosine, sine = self.ring.one, self.ring.zero
        for (c, s), count in zip(self._circles, row, strict=True):
            for _ in range(abs(count)):
                s_turn = s if count > 0 else -s
                cosine, sine = cosine * c - sine * s_turn, sine * c + cosine * s_turn
        return self.products.normalize(cosine), self.products.normalize(sine)


def cosine_of_multiple(ring: Field, cosine: Element, count: int) -> Element:
    """``cos(n*a)`` as Chebyshev's polynomial of ``cos(a)``."""
    last, result = cosine, ring.one  # cos(-a), cos(0)
    for _ in range(abs(count)):
        last, result = result, 2 * cosine * result - last
    return result


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
                field.relations[asked] = _find_relations(field, asked)
            except BaseException:  # a budget that is spent says nothing of relations
                del field.relations[asked]
                raise
        if field.relations[asked] is None:
            return None
    known = field.relations[names]
    return known if isinstance(known, Relations) else None


def _find_relations(field: Field, names: frozenset[str]) -> Relations | str | None:
    """The relations; None if the functions are independent, or why they were not found."""
    try:
        result = Relations(field, names)
    except (OverflowError, ZeroDivisionError) as error:  # no room, or defined nowhere
        return str(error)
    return result if result.are_any else None


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
    top, bottom = field.fraction(element.combine())
    return [f for p in (top, *(p for p, _ in bottom)) for f, _ in factors_of(p)[1]]


def _terms(row: Sequence[int]) -> int:
    """How many terms the cosine of a combination has, at most."""
    return prod(abs(n) + 1 for n in row)
