r"""Values of elementary functions modulo a prime that satisfy every relation between them.

Ranks modulo a prime bound true ones only if evaluation is a homomorphism: what is zero as a
function has to be zero there. So exponentials and sines follow the addition theorems: their
arguments are whole combinations of a basis that is independent over the rational numbers, and only
the basis has values of its own. By the theorems of Lindemann and Weierstrass and of Kolchin and
Ostrowski (Kolchin 1968) there are no relations but these. Those of the basis that do not move, such
as a slope alpha of a plane, keep their value from point to point.

A square root is a new number only where it is not a combination of those before it, which a point
proves at which these exist and it does not: else its sign would matter, and nothing modulo a prime
has a sign. Of numbers, roots are products of those of their prime factors. What is not known to be
free of further relations, as the logarithms of x and of x y, is an obstacle that is named.
Comes in: the elements to be evaluated. Goes out: values of the functions in them.
Read next: `coadjoint.prove.samples`.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from sympy import factorint

from coadjoint.exact import Element, Field
from coadjoint.exact.field import Adjoined
from coadjoint.exact.lattices import coordinates, lattice_basis
from coadjoint.exact.residues import Residue, residue, square_root

#: Numbers under square roots up to which prime factors are searched for.
LARGEST = 10**18
#: Values of functions by their name and by that of their argument.
Table = dict[tuple[str, int], Residue]
#: A point ``(x, y)`` of the circle, or ``(x, 0)`` for an exponential; both multiply like x + iy.
Turn = tuple[Residue, Residue]
#: An argument as whole multiples of the members of a basis.
Multiples = dict[int, int]
#: Functions that follow addition theorems, each group with a basis of its own.
GROUPS = (("sin", "cos"), ("exp",))
LOGARITHMS = ("log",)
#: All functions whose relations are known here.
RELATED = ("sqrt", *LOGARITHMS, *(name for group in GROUPS for name in group))


@dataclass(frozen=True)
class Lattice:
    """A basis of the arguments of some functions over the whole numbers.

    Attributes:
        moving: Whether a member depends on the state.
        multiples: The arguments in this basis.
    """

    moving: tuple[bool, ...]
    multiples: tuple[Multiples, ...]


class Functions:
    """The functions that occur in some elements, and the relations between them.

    Args:
        field: Where the elements live.
        elements: What will be evaluated, with its derivatives.
        state: Symbols that change from point to point.
        parameters: Symbols that do not.
        numbers: Values of the parameters, where they are given.

    Attributes:
        obstacle: Why no values are known to satisfy all relations; else empty.
        places: Of the argument of each function among those of its group, by generator.
        roots: The square roots of what is not a number.
        proper: Those that a point has shown to be new numbers.
    """

    def __init__(
        self,
        field: Field,
        elements: Iterable[Element],
        state: Sequence[str],
        parameters: Sequence[str],
        numbers: Mapping[str, Fraction],
    ) -> None:
        self.field, self._state, self._numbers = field, frozenset(state), dict(numbers)
        used = frozenset[str]().union(*map(field.functions_in, elements))
        partners = {field.adjoined[name].partner for name in used}
        self.known = [a for name, a in field.adjoined.items() if name in used | partners]
        self.arguments = {
            group: _distinct(a.argument for a in self.known if a.function in group)
            for group in (*GROUPS, LOGARITHMS)
        }
        self.places = {
            a.generator: self.arguments[group].index(a.argument)
            for group in GROUPS
            for a in self.known
            if a.function in group
        }
        roots = [a for a in self.known if a.function == "sqrt"]
        numbered = {a.generator: self._number(a.argument) for a in roots}
        self.surds = {name: x for name, x in numbered.items() if x is not None}
        self.roots = frozenset(numbered.keys() - self.surds.keys())
        self.proper = set[str]()
        self.lattices = dict[tuple[str, ...], Lattice]()
        self.obstacle = self._obstacle({*state, *parameters})

    def _number(self, argument: Element) -> Fraction | None:
        """The rational number that an argument is at the given parameters, or None."""
        if not self.field.is_function_free(argument):
            return None
        return self.field.as_number(self._settle(argument))

    def _settle(self, argument: Element) -> Element:
        """A function-free argument at the given parameters."""
        numbers = {name: self.field.number(x) for name, x in self._numbers.items()}
        return self.field.substitute(argument, numbers)

    # -- relations --------------------------------------------------------------------------

    def _obstacle(self, known: set[str]) -> str:
        """Why relations may be missed; the bases of arguments are made on the way."""
        for each in self.known:
            if each.function not in RELATED:
                return f"{each.function} occurs, which may be related to other functions"
            if not self.field.reach(each.argument) <= known:
                return f"{each.function} has an argument that depends on more than the state"
            inner = self.field.functions_in(each.argument)
            if each.function != "sqrt" and any(
                self.field.adjoined[name].function != "sqrt" for name in inner
            ):
                return f"{each.function} is taken of functions, and they may be related"
        if any(number < 0 for number in self.surds.values()):
            return "a square root of a negative number occurs"
        if any(max(x.numerator, x.denominator) > LARGEST for x in self.surds.values()):
            return "a square root of a long number occurs, which is not factored"
        for group in GROUPS:
            lattice = self._lattice(self.arguments[group])
            if lattice is None:
                count = len(self.arguments[group])
                return f"functions of {count} arguments occur, which may be related"
            self.lattices[group] = lattice
        logarithms = self.arguments[LOGARITHMS]
        symbols = [self.field[name] for name in known - self._numbers.keys()]
        if len(logarithms) > 1 and not all(argument in symbols for argument in logarithms):
            return f"logarithms of {len(logarithms)} arguments occur, which may be related"
        if any(map(self._fixed_number, logarithms)) and any(
            map(self._fixed_number, (a for group in GROUPS for a in self.arguments[group]))
        ):
            return "logarithms of numbers and other functions of numbers both occur"
        return ""

    def _fixed_number(self, argument: Element) -> bool:
        return not self.field.reach(argument) - self._numbers.keys()

    def _lattice(self, arguments: Sequence[Element]) -> Lattice | None:
        """A basis of some arguments; None where sums below the bar or roots may hide relations."""
        if len(arguments) < 2 and not any(map(self._vanishes, arguments)):
            moves = tuple(bool(self.field.reach(a) & self._state) for a in arguments)
            return Lattice(moves, tuple({0: 1} for _ in arguments))
        if self._numbers and not all(map(self.field.is_function_free, arguments)):
            return None  # roots of numbers may be numbers
        settled = [self._settle(a) if self._numbers else a for a in arguments]
        vectors = [self._vector(argument) for argument in settled]
        if any(vector is None for vector in vectors):
            return None
        return self._reduce([vector for vector in vectors if vector is not None])

    def _vanishes(self, argument: Element) -> bool:
        return self.field.is_function_free(argument) and self._settle(argument) == 0

    def _vector(self, argument: Element) -> dict[Any, Fraction] | None:
        """The coefficients of an argument by its products of powers; None with sums below a bar."""
        numbers = dict[Any, Fraction]()
        for quotient in self.field.quotients(self.field.normal(argument)):
            powers = dict[str, int]()
            for divisor, exponent in quotient.divisors:
                single = [name for name in self.field.names if self.field[name] == divisor]
                if not single:
                    return None
                powers[single[0]] = -exponent
            for monomial in quotient.monomials:
                whole = dict(powers)
                for name, exponent in monomial.powers:
                    whole[name] = whole.get(name, 0) + exponent
                key = tuple(sorted((name, e) for name, e in whole.items() if e))
                numbers[key] = numbers.get(key, Fraction(0)) + monomial.number
        return {key: x for key, x in numbers.items() if x}

    def _reduce(self, vectors: Sequence[Mapping[Any, Fraction]]) -> Lattice:
        """The arguments in a basis whose last members are those that do not move.

        With the products that move in front, rows of the echelon form that begin behind these are
        a basis of all combinations of the arguments that do not move.
        """
        present = {key for vector in vectors for key in vector}
        keys = sorted(present, key=lambda key: (not self._moves(key), key))
        rows = [tuple(vector.get(key, Fraction(0)) for key in keys) for vector in vectors]
        basis = lattice_basis(rows)
        pivots = [next(n for n, x in enumerate(row) if x) for row in basis]
        return Lattice(
            tuple(self._moves(keys[pivot]) for pivot in pivots),
            tuple(coordinates(rows, basis)),
        )

    def _moves(self, key: Any) -> bool:
        """Whether a product of powers depends on the state."""
        return any(self.field.reach(self.field[name]) & self._state for name, _ in key)


class Experiment:
    """Values that do not move, modulo a prime, and functions at points that share them.

    Args:
        functions: The functions.
        prime: The prime.
        source: Where random numbers come from.

    Raises:
        ZeroDivisionError: A square root of a number does not exist modulo the prime.
    """

    def __init__(self, functions: Functions, prime: int, source: random.Random) -> None:
        self.functions, self.prime, self._source = functions, prime, source
        self._resting = {
            group: [None if moves else self._turn(group) for moves in lattice.moving]
            for group, lattice in functions.lattices.items()
        }
        self._surds = {name: self._surd(x) for name, x in functions.surds.items()}
        self._logarithms = {1: Residue(0, prime)}

    def draw(self) -> Residue:
        """A random number other than 0."""
        return Residue(self._source.randrange(1, self.prime), self.prime)

    def number(self, value: Fraction) -> Residue:
        """A rational number modulo the prime."""
        return residue(value, self.prime)

    def _turn(self, group: Sequence[str]) -> Turn:
        """A random point of the circle, or a random number."""
        t, one = self.draw(), Residue(1, self.prime)
        if "exp" in group:
            return t, Residue(0, self.prime)
        below = one + t * t
        return (one + -(t * t)) / below, (t + t) / below

    def _surd(self, number: Fraction) -> Residue:
        """The square root of a number by those of its prime factors.

        Roots of different primes are independent of each other (Besicovitch 1940), so that their
        signs are free.
        """
        result = Residue(1, self.prime)
        for value, below in ((number.numerator, False), (number.denominator, True)):
            for factor, exponent in factorint(value).items() if value > 1 else ():
                power = residue(int(factor) ** (exponent // 2), self.prime)
                if exponent % 2:
                    power = power * square_root(residue(int(factor), self.prime))
                result = result / power if below else result * power
        return result if number else Residue(0, self.prime)

    def logarithm(self, argument: Residue) -> Residue:
        """A number for each argument, the same at all points."""
        return self._logarithms.setdefault(argument.value, self.draw())

    def surd(self, name: str) -> Residue:
        """The square root of a number, by its generator."""
        return self._surds[name]

    def turns(self) -> dict[tuple[str, ...], list[Turn]]:
        """The members of each basis at a new point."""
        return {
            group: [turn or self._turn(group) for turn in turns]
            for group, turns in self._resting.items()
        }


class FunctionsAtPoint:
    """The functions at one point, as evaluation calls them.

    Args:
        experiment: What it has in common with other points.
    """

    def __init__(self, experiment: Experiment) -> None:
        self._experiment, self._functions = experiment, experiment.functions
        self.number = experiment.number
        self._turns = experiment.turns()
        self._waiting = list(self._functions.known)
        self._table = Table()

    def __call__(self, function: str, argument: Residue) -> Residue:
        """The value of a function, by its name and that of its argument."""
        return self._table[function, argument.value]

    def learn(self, values: Mapping[str, Residue]) -> None:
        """Give values to all functions whose arguments have values now.

        Raises:
            ZeroDivisionError: An argument has a pole, a root does not exist or is 0, or two
                arguments meet, so that their functions cannot be told apart.
        """
        field, left = self._functions.field, list[Adjoined]()
        for each in self._waiting:
            if not field.reach(each.argument) <= values.keys():
                left.append(each)
                continue
            argument = field.evaluate(each.argument, values, self._experiment.number, self)
            place, value = (each.function, argument.value), self._value(each, argument)
            if self._table.setdefault(place, value) != value:
                raise ZeroDivisionError("two arguments meet")
        self._waiting = left

    def _value(self, each: Adjoined, argument: Residue) -> Residue:
        """The value of one function."""
        match each.function:
            case "log" if not argument.value:
                raise ZeroDivisionError("a logarithm of 0")
            case "log":
                return self._experiment.logarithm(argument)
            case "sqrt":
                return self._root(each.generator, argument)
        group = next(group for group in GROUPS if each.function in group)
        place = self._functions.places[each.generator]
        multiples = self._functions.lattices[group].multiples[place]
        if multiples and not argument.value:  # the argument is 0, and nobody knew
            raise ZeroDivisionError(f"{each.function} of 0")
        x, y = self._add_turns(group, multiples)
        return y if each.function == "sin" else x

    def _root(self, name: str, argument: Residue) -> Residue:
        """A square root; one that is not there is a new number, where those before it are there.

        Points at which an argument is 0 are passed over: there a root may be singular, and show
        nothing.
        """
        if name not in self._functions.roots:
            return self._experiment.surd(name)
        if not argument.value:
            raise ZeroDivisionError("a square root of 0")
        try:
            return square_root(argument)
        except ZeroDivisionError:
            self._functions.proper.add(name)
            raise

    def _add_turns(self, group: tuple[str, ...], multiples: Multiples) -> Turn:
        """The product of powers of turns: addition of arguments."""
        prime = self._experiment.prime
        result = Residue(1, prime), Residue(0, prime)
        for place, multiple in multiples.items():
            turn = self._turns[group][place]
            turn = turn if multiple > 0 else _inverse(turn)
            for bit in range(abs(multiple).bit_length()):
                if abs(multiple) >> bit & 1:
                    result = _product(result, turn)
                turn = _product(turn, turn)
        return result


def _product(a: Turn, b: Turn) -> Turn:
    return a[0] * b[0] + -(a[1] * b[1]), a[0] * b[1] + a[1] * b[0]


def _inverse(a: Turn) -> Turn:
    norm = a[0] * a[0] + a[1] * a[1]
    return a[0] / norm, -a[1] / norm


def _distinct(arguments: Iterable[Element]) -> list[Element]:
    distinct = list[Element]()
    for argument in arguments:
        if argument not in distinct:
            distinct.append(argument)
    return distinct
