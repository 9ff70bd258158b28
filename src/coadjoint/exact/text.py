"""Elements as plain text, in our own order: the same bytes whatever the version of SymPy.

Comes in: an element. Goes out: ASCII text of names, numbers and operators, as it stands in the head
of generated files and in documents.
"""

from __future__ import annotations

from dataclasses import replace

from coadjoint.elementary import ELEMENTARY
from coadjoint.exact.element import Element
from coadjoint.exact.field import Field
from coadjoint.exact.rationals import Monomial, Written

#: What comes before the places where functions jump, in the words of a method of proof.
WHILE = ", where and while "
#: Characters of an element that a sentence has room for.
ROOM = 80


def element_text(field: Field, element: Element) -> str:
    """An element as text.

    >>> field = Field(["x", "y", "m"])
    >>> x, y, m = (field[name] for name in field.names)
    >>> element_text(field, (x**2 / 2 - y) / (m * (m + 1)))
    '(1/2*x^2 - y)/(m*(m + 1))'
    >>> element_text(field, x**2 / (2 * m) - m * y)
    '1/2*x^2/m - y*m'
    """
    parts = [part for whole in field.partial_fractions(element) for part in field.quotients(whole)]
    first, *others = (_fraction(field, part) for part in parts) if parts else ("0",)
    for other in others:
        first += f" - {other[1:]}" if other.startswith("-") else f" + {other}"
    return first


def brief_text(field: Field, element: Element) -> str:
    """The text of an element that is told within a sentence; "" where it has no room there.

    >>> field = Field(["x", "y"])
    >>> brief_text(field, field["x"] ** 2), brief_text(field, (field["x"] + field["y"] + 1) ** 9)
    ('x^2', '')
    """
    text = element_text(field, element)
    return text if len(text) <= ROOM else ""


def _fraction(field: Field, quotient: Written) -> str:
    """One quotient as text."""
    turns = {d: e for d, e in quotient.divisors if _is_turn(field, d)}
    scale = 4 ** sum(turns.values())  # 1/atan(1) is 4/pi
    top = _sum(field, tuple(replace(m, number=m.number * scale) for m in quotient.monomials))
    bottom = [_power("pi" if d in turns else _bracket(field, d), e) for d, e in quotient.divisors]
    if not bottom:
        return top
    lead = f"({top})" if len(quotient.monomials) > 1 else top
    return f"{lead}/{bottom[0]}" if len(bottom) == 1 else f"{lead}/({'*'.join(bottom)})"


def _sum(field: Field, monomials: tuple[Monomial, ...]) -> str:
    """Addends with their signs."""
    text = ""
    for monomial in monomials:
        sign = "-" if monomial.number < 0 else "+"
        addend = _product(field, monomial)
        text = f"{text} {sign} {addend}" if text else ("-" if sign == "-" else "") + addend
    return text or "0"


def _product(field: Field, monomial: Monomial) -> str:
    """One addend without its sign."""
    number = abs(monomial.number)
    for name, exponent in monomial.powers:  # pi is 4*atan(1)
        number = number / 4**exponent if _is_eighth(field, name) else number
    factors = [_power(_name(field, name), exponent) for name, exponent in monomial.powers]
    return "*".join(([] if number == 1 and factors else [str(number)]) + factors)


def _power(base: str, exponent: int) -> str:
    return base if exponent == 1 else f"{base}^{exponent}"


def _bracket(field: Field, element: Element) -> str:
    """A factor of a denominator: in brackets unless it is a single name."""
    text = element_text(field, element)
    return text if text.isidentifier() else f"({text})"


def _is_turn(field: Field, divisor: Element) -> bool:
    """Whether a divisor is an eighth of a turn, and nothing else."""
    return any(_is_eighth(field, name) and divisor == field[name] for name in field.adjoined)


def _is_eighth(field: Field, name: str) -> bool:
    """Whether a generator is an eighth of a turn, ``atan(1)``."""
    known = field.adjoined.get(name)
    return known is not None and known.function == "atan" and known.argument == 1


def _name(field: Field, name: str) -> str:
    """A symbol, or the function that an adjoined generator stands for."""
    known = field.adjoined.get(name)
    if known is None:
        return name
    if _is_eighth(field, name):
        return "pi"
    arguments = (element_text(field, each) for each in known.arguments)
    return f"{known.function}({', '.join(arguments)})"


def text_of_jumps(field: Field) -> str:
    """What proofs in a field leave out: they hold between jumps of functions, not across them.

    A quantity such as ``sign(q)`` has the rate 0 and changes all the same.
    """
    texts = list[str]()
    for known in field.adjoined.values():
        if known.function == "sign":
            texts.append(f"{element_text(field, known.argument)} is not 0")
        elif ELEMENTARY[known.function].jumps[0]:
            zero, side = (element_text(field, each) for each in known.arguments)
            either = f"{zero} is not 0 or " if known.arguments[0] != 0 else ""
            texts.append(f"{either}{side} is positive")
    return f"{WHILE}{' and '.join(texts)}" if texts else ""
