"""Units: their texts as exact exponents, and back.

Comes in: a unit text such as ``kg m^2/s``. Goes out: a `Unit`, exact rational exponents of the base
units of the SI. A factor such as the 1000 of a kilometre is kept as powers of its primes, that of
a degree with a power of pi, so that one comparison of exponents tells kilometres from metres.
Nothing is ever converted. Read next: `coadjoint.spec.core.dimensions`.

    unit   = factor {("*" | "." | "/" | " ") factor}      where / divides by the next factor alone
    factor = (SYMBOL | "1" | "(" unit ")") ["^" exponent]
    exponent = ["-"] INTEGER | "(" ["-"] INTEGER ["/" INTEGER] ")"
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from types import MappingProxyType

from coadjoint.spec.core.faults import find_near

#: Exact; an integer where it is one, which is faster by far than a fraction.
Exponent = int | Fraction
#: What a base unit of the SI is, what a prime factor is, and pi; and what is not known yet.
BASE = ("kg", "m", "s", "A", "K", "mol", "cd")
UNKNOWN = "?"

_DERIVED = {
    "rad": "1", "sr": "1", "Hz": "1/s", "N": "kg m/s^2", "Pa": "N/m^2", "J": "N m", "W": "J/s",
    "C": "A s", "V": "W/A", "F": "C/V", "ohm": "V/A", "S": "A/V", "Wb": "V s", "T": "Wb/m^2",
    "H": "Wb/A", "lm": "cd", "lx": "lm/m^2", "Bq": "1/s", "Gy": "J/kg", "Sv": "J/kg",
    "kat": "mol/s",
}  # fmt: skip
_SCALED = {
    "g": (Fraction(1, 1000), "kg"), "t": (Fraction(1000), "kg"), "min": (Fraction(60), "s"),
    "h": (Fraction(3600), "s"), "d": (Fraction(86400), "s"), "L": (Fraction(1, 1000), "m^3"),
    "bar": (Fraction(100000), "Pa"), "eV": (Fraction(1602176634, 10**28), "J"),
}  # fmt: skip
_DEGREES = {"deg": 180, "arcmin": 180 * 60, "arcsec": 180 * 3600}
_PREFIXES = {
    "Y": 24, "Z": 21, "E": 18, "P": 15, "T": 12, "G": 9, "M": 6, "k": 3, "h": 2, "da": 1, "d": -1,
    "c": -2, "m": -3, "u": -6, "n": -9, "p": -12, "f": -15, "a": -18, "z": -21, "y": -24,
}  # fmt: skip
_UNPREFIXED = ("kg", "t", "min", "h", "d", *_DEGREES)
_WORDS = {
    "sec": "s", "second": "s", "seconds": "s", "meter": "m", "meters": "m", "metre": "m",
    "metres": "m", "kilogram": "kg", "kilograms": "kg", "radian": "rad", "radians": "rad",
    "degree": "deg", "degrees": "deg", "dimensionless": "1", "none": "1", "newton": "N",
    "joule": "J", "watt": "W", "hour": "h", "hours": "h", "minute": "min", "minutes": "min",
}  # fmt: skip
_TOKEN = re.compile(r" *(?:(?P<symbol>[A-Za-z]+)|(?P<number>\d+)|(?P<mark>[()^*./-])) *| +")
#: Sums of exponents stay small; a text that asks for more is a slip.
_LARGEST = 99


class UnitError(ValueError):
    """A text is no unit.

    Attributes:
        problem: What was found, as a clause.
        start: Offset of the characters at fault.
        end: Offset after them.
        hint: The likely fix, as a sentence, or "".
    """

    def __init__(self, problem: str, start: int, end: int, hint: str = "") -> None:
        super().__init__(problem)
        self.problem, self.start, self.end, self.hint = problem, start, end, hint


@dataclass(frozen=True)
class Unit:
    """A product of powers.

    Attributes:
        powers: Base symbols, primes and what is unknown, in order, with exponents that are not 0;
            empty for a pure number.

    >>> read_unit("N m") == read_unit("kg m^2/s^2"), read_unit("km") == read_unit("m")
    (True, False)
    """

    powers: tuple[tuple[str, Exponent], ...] = ()

    def __mul__(self, other: Unit) -> Unit:
        return product_of(((self, 1), (other, 1)))

    def __truediv__(self, other: Unit) -> Unit:
        return product_of(((self, 1), (other, -1)))

    def __pow__(self, exponent: Exponent) -> Unit:
        return product_of(((self, exponent),))

    @property
    def unknowns(self) -> tuple[str, ...]:
        """The symbols in it that stand for what is not known yet."""
        return tuple(name for name, _ in self.powers if name.startswith(UNKNOWN))


ONE = Unit()


def product_of(factors: Iterable[tuple[Unit, Exponent]]) -> Unit:
    """A product of powers of units.

    >>> write_unit(product_of([(read_unit("kg m/s"), 2), (read_unit("kg"), -1)]))
    'kg m^2/s^2'
    """
    powers: dict[str, Exponent] = {}
    for unit, times in factors:
        for name, exponent in unit.powers:
            powers[name] = powers.get(name, 0) + exponent * times
    whole = ((n, e.numerator if e.denominator == 1 else e) for n, e in powers.items() if e)
    return Unit(tuple(sorted(whole)))


def unknown(name: str) -> Unit:
    """A unit that is not known yet, called by a name."""
    return Unit(((UNKNOWN + name, 1),))


# -- texts to units -------------------------------------------------------------------------------


@cache
def read_unit(text: str) -> Unit:
    """The unit that a text says.

    Raises:
        UnitError: It is none.

    >>> read_unit("s/(kg m^2)") == read_unit("kg^-1 m^-2 s")
    True
    """
    reader = _Reader(text)
    unit = reader.product()
    if reader.kind:
        raise reader.fault("no unit stands")
    return unit


class _Reader:
    """One reading of one text."""

    def __init__(self, text: str) -> None:
        self.text, self.at = text, 0
        self.tokens: list[tuple[str, str, int, int]] = []
        while self.at < len(text):
            match = _TOKEN.match(text, self.at)
            if match is None:
                raise UnitError(f"{text[self.at]!r} is not part of a unit", self.at, self.at + 1)
            if match.lastgroup:
                kind = match[0].strip() if match.lastgroup == "mark" else match.lastgroup
                start, end = match.span(match.lastgroup)
                self.tokens.append((kind, match[match.lastgroup], start, end))
            self.at = match.end()
        self.tokens.append(("", "", len(text), len(text)))
        self.at = 0

    @property
    def kind(self) -> str:
        """What comes next; "" at the end."""
        return self.tokens[self.at][0]

    def take(self) -> str:
        """The next token, passed."""
        self.at += 1
        return self.tokens[self.at - 1][1]

    def fault(self, what: str, hint: str = "") -> UnitError:
        """What stands where it cannot."""
        _, text, start, end = self.tokens[self.at]
        where = f"at {text!r}" if text else "at the end"
        return UnitError(f"{what} {where}", min(start, max(len(self.text) - 1, 0)), end, hint)

    def product(self) -> Unit:
        """Factors joined by signs, or by a blank."""
        unit, divided = self.factor(), False
        while self.kind not in ("", ")"):
            sign = self.take() if self.kind in ("*", ".", "/") else " "
            if sign == " " and divided:
                shown = self.tokens[self.at][1]
                hint = f"Write {shown} before the sign /, or what is below it in parentheses."
                raise self.fault("it is not clear whether / divides by what stands", hint)
            unit = unit / self.factor() if sign == "/" else unit * self.factor()
            divided = sign == "/"
        return unit

    def factor(self) -> Unit:
        """A symbol, 1, or a unit in parentheses, with its power."""
        if self.kind == "(":
            self.take()
            unit = self.product()
            if self.kind != ")":
                raise self.fault("there is no closing parenthesis")
            self.take()
        elif self.kind == "symbol":
            _, symbol, start, end = self.tokens[self.at]
            unit = find_symbol(symbol) or ONE
            if find_symbol(symbol) is None:
                raise UnitError(f"{symbol!r} is no unit", start, end, _advise(symbol))
            self.take()
        elif self.kind == "number" and self.tokens[self.at][1] == "1":
            self.take()
            unit = ONE
        else:
            hint = "Numbers belong to formulas." if self.kind == "number" else ""
            raise self.fault("no unit stands", hint)
        if self.kind == "^":
            self.take()
            unit = unit ** self.exponent()
        return unit

    def exponent(self) -> Fraction:
        """An integer, or a fraction in parentheses."""
        closing = self.kind == "(" and bool(self.take())
        sign = -1 if self.kind == "-" and self.take() else 1
        above = self.integer()
        below = 1
        if closing and self.kind == "/":
            self.take()
            below = self.integer()
        if closing and not (self.kind == ")" and self.take()):
            raise self.fault("there is no closing parenthesis")
        return Fraction(sign * above, below)

    def integer(self) -> int:
        """A positive integer, small as exponents are."""
        text = self.tokens[self.at][1]
        if self.kind != "number" or len(text) > 2 or not 0 < int(text) <= _LARGEST:
            raise self.fault("no exponent from 1 to 99 stands")
        return int(self.take())


@cache
def find_symbol(symbol: str) -> Unit | None:
    """The unit of a symbol, perhaps with a prefix; None for what is none.

    >>> find_symbol("km") == product_of([(find_symbol("m"), 1), (factor_unit(Fraction(1000)), 1)])
    True
    """
    if symbol in BASE:
        return Unit(((symbol, 1),))
    if symbol in _DERIVED:
        return read_unit(_DERIVED[symbol])
    if symbol in _SCALED:
        factor, text = _SCALED[symbol]
        return factor_unit(factor) * read_unit(text)
    if symbol in _DEGREES:
        return Unit((("pi", 1),)) / factor_unit(Fraction(_DEGREES[symbol]))
    for prefix, power in _PREFIXES.items():
        rest = symbol.removeprefix(prefix)
        known = (*BASE, *_DERIVED, *_SCALED)
        if rest != symbol and rest in known and rest not in _UNPREFIXED:
            return factor_unit(Fraction(10) ** power) * (find_symbol(rest) or ONE)
    return None


def factor_unit(factor: Fraction) -> Unit:
    """A number as a product of powers of primes."""
    powers: dict[str, Exponent] = {}
    for whole, sign in ((factor.numerator, 1), (factor.denominator, -1)):
        rest, prime = whole, 2
        while rest > 1:
            if prime * prime > rest:
                prime = rest
            while rest % prime == 0:
                rest //= prime
                powers[str(prime)] = powers.get(str(prime), 0) + sign
            prime += 1
    return Unit(tuple(sorted(powers.items())))


def _advise(symbol: str) -> str:
    """What a symbol that is none was meant to be."""
    if symbol in _WORDS:
        return f"Write {_WORDS[symbol]!r}."
    for cut in range(len(symbol) - 1, 0, -1):  # Nm: no prefix, so that a blank is missing
        parts = [find_symbol(part) for part in (symbol[:cut], symbol[cut:])]
        bases = [{name for name, _ in part.powers} & {*BASE} for part in parts if part]
        if len(bases) == len(parts) and bases[0] != bases[1]:
            return f"Write '{symbol[:cut]} {symbol[cut:]}'."
    near = find_near(symbol, (*BASE, *_DERIVED, *_SCALED, *_DEGREES))
    return f"Did you mean {near[0]!r}?" if near else "Units are those of the SI, or 1 for a number."


# -- units to texts -------------------------------------------------------------------------------


def write_unit(unit: Unit, own: Mapping[str, Unit] = MappingProxyType({})) -> str:
    """A unit as text, ``1`` for a pure number; what is unknown is its name in square brackets.

    Args:
        unit: A unit.
        own: Symbols in which to write what is in units with a factor, as km and deg.

    >>> write_unit(read_unit("N m")), write_unit(read_unit("km/h"))
    ('kg m^2/s^2', '5/18 m/s')
    >>> write_unit(read_unit("km/h"), {"km": read_unit("km"), "h": read_unit("h")})
    'km/h'
    """
    words: list[tuple[str, Exponent]] = []
    for symbol, each in own.items():
        powers, has = dict(each.powers), dict(unit.powers)
        base = [name for name in powers if name in BASE] or ["pi"]
        times = Fraction(has.get(base[0], 0)) / powers.get(base[0], 1)
        if times:
            unit = unit / each**times
            words.append((symbol, times))
    factor = _write_factor([(name, e) for name, e in unit.powers if name.isdigit()])
    rest = [(name, e) for name, e in unit.powers if not name.isdigit()]
    words += [(f"[{n[1:]}]" if n.startswith(UNKNOWN) else n, e) for n, e in rest]
    over = [_power(name, e) for name, e in sorted(words) if e > 0]
    under = [_power(name, -e) for name, e in sorted(words) if e < 0]
    return "/".join([" ".join([*factor, *over]) or "1", *under])


def is_plain(unit: Unit) -> bool:
    """Whether it is known and has no factor, so that it can be written as a label."""
    return all(name in BASE for name, _ in unit.powers)


def label_unit(unit: Unit, own: Mapping[str, Unit] = MappingProxyType({})) -> str:
    """A unit as text for a label; "" where it is not known, or has a factor that no symbol has."""
    rest = unit
    for each in own.values():
        base = [name for name, _ in each.powers if name in BASE] or ["pi"]
        times = Fraction(dict(rest.powers).get(base[0], 0)) / dict(each.powers)[base[0]]
        rest = rest / each**times * Unit(tuple((n, times) for n in base if n in BASE and times))
    return write_unit(unit, own) if is_plain(rest) else ""


def find_own(texts: Iterable[str]) -> dict[str, Unit]:
    """The symbols in unit texts that carry a factor and measure one thing: km, g, h, deg."""
    symbols = dict.fromkeys(s for text in texts for s in re.findall("[A-Za-z]+", text))
    own: dict[str, Unit] = {}
    measured: set[str] = set()
    for symbol in symbols:
        unit = find_symbol(symbol) or ONE
        bases = [name for name, _ in unit.powers if name in BASE]
        base = bases[0] if bases else "pi"
        if len(bases) > 1 or base not in dict(unit.powers) or base in measured:
            continue
        measured.add(base)
        if not is_plain(unit):
            own[symbol] = unit
    return own


def split_units(text: str, count: int) -> Sequence[tuple[str, int]] | None:
    """The units of some components with their offsets; None if they are not as many.

    >>> split_units("1, m", 2), split_units("m", 2)
    ([('1', 0), ('m', 2)], [('m', 0), ('m', 0)])
    """
    parts = text.split(",")
    if len(parts) == 1:
        return [(text, 0)] * count
    starts = [sum(len(p) + 1 for p in parts[:place]) for place in range(len(parts))]
    return (
        [(p.strip(), s) for p, s in zip(parts, starts, strict=True)]
        if len(parts) == count
        else None
    )


def _write_factor(powers: Sequence[tuple[str, Exponent]]) -> list[str]:
    """The number in front of a unit."""
    whole = [(int(name), int(e)) for name, e in powers if e.denominator == 1]
    number = Fraction(1)
    for prime, exponent in whole:
        number *= Fraction(prime) ** exponent
    roots = [_power(name, e) for name, e in powers if e.denominator != 1]
    return [*([str(number)] if number != 1 else []), *roots]


def _power(name: str, exponent: Exponent) -> str:
    if exponent == 1:
        return name
    text = str(exponent)
    return f"{name}^({text})" if "/" in text else f"{name}^{text}"
