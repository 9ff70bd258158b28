r"""Elements of a field as formulas: quotients with their addends, parameters before the state.

Comes in: an element, and the names of the parameters. Goes out: a `Written`, whose text is the one
of `coadjoint.exact.text`. Read next: `coadjoint.derive.lines`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import sympy

from coadjoint.exact import Element, Field, element_text
from coadjoint.exact.rationals import Monomial
from coadjoint.notation.functions import CALLS
from coadjoint.notation.names import name
from coadjoint.notation.written import (
    PI,
    Written,
    add,
    call,
    divide,
    literal,
    multiply,
    negate,
    number,
    power,
)


def write_element(field: Field, element: Element) -> Written:
    r"""An element as a formula.

    >>> field = Field(["x", "m"])
    >>> written = write_element(field, field["x"] ** 2 / (2 * field["m"]))
    >>> written.text, written.latex
    ('1/2*x^2/m', '\\frac{{x}^{2}}{2\\,m}')
    """
    parts = [q for each in field.partial_fractions(element) for q in field.quotients(each)]
    addends = list[Written]()
    for part in parts:
        turns = sum(e for d, e in part.divisors if _is_eighth(field, d))
        scaled = [replace(m, number=m.number * 4**turns) for m in part.monomials]  # 1/atan(1)
        bottom = [
            (PI if _is_eighth(field, d) else write_element(field, d), e) for d, e in part.divisors
        ]
        if not bottom or len(scaled) == 1:
            addends += [_write_term(field, each, bottom) for each in scaled]
            continue
        top = add([_write_term(field, each, []) for each in scaled])
        addends.append(divide(top, multiply([power(d, e) for d, e in bottom])))
    whole = add(addends) if addends else number(0)
    return replace(whole, text=element_text(field, element))


def _write_term(field: Field, monomial: Monomial, bottom: list[tuple[Written, int]]) -> Written:
    """One addend over its divisors, numbers and parameters first."""
    value, upper = monomial.number, list[tuple[tuple[bool, bool], Written]]()
    lower = [power(part, exponent) for part, exponent in bottom]
    for factor, exponent in monomial.powers:
        written, fixed = _write_symbol(field, factor), factor in field.region.parameters
        if written is PI:
            value /= 4**exponent  # the field has atan(1)
        rank = (not (fixed or written is PI), fixed and factor[-1].isdigit())
        upper.append((rank, power(written, exponent)))
    whole, parts = abs(value), [part for _, part in sorted(upper, key=lambda each: each[0])]
    if whole.numerator != 1 or not parts:
        parts.insert(0, number(whole.numerator))
    if whole.denominator != 1:
        lower.insert(0, number(whole.denominator))
    if lower == [number(2)] and len(parts) > 1:
        made = multiply([number(Fraction(1, 2)), *parts])
    elif lower:
        made = divide(multiply(parts), multiply(lower))
    else:
        made = multiply(parts)
    return negate(made) if value < 0 else made


def _is_eighth(field: Field, divisor: Element) -> bool:
    """Whether a divisor is an eighth of a turn, ``atan(1)``, and nothing else."""
    return any(
        known.function == "atan" and known.argument == 1 and divisor == field[name]
        for name, known in field.adjoined.items()
    )


def _write_symbol(field: Field, text: str) -> Written:
    """A symbol, or the function that stands for one."""
    known = field.adjoined.get(text)
    if known is None:
        return name(text)
    if known.function == "atan" and known.argument == 1:
        return PI
    arguments = [write_element(field, each) for each in known.arguments]
    return write_call(known.function, arguments)


def write_call(function: str, arguments: list[Written]) -> Written:
    """A function of scalars."""
    special = CALLS.get(function)
    return special(*arguments) if special else call(function, arguments)


def write_sympy(value: sympy.Expr, symbols: Callable[[str], Written]) -> Written:
    """A SymPy expression, its symbols written as told."""
    if value.is_Add:
        return add([write_sympy(each, symbols) for each in value.as_ordered_terms()])
    if value.is_Mul:
        return _write_product(value, symbols)
    if value.is_Pow:
        base, exponent = value.as_base_exp()
        if exponent == sympy.Rational(1, 2) and base.is_Pow and base.exp == 2:
            return write_call("abs", [write_sympy(base.base, symbols)])  # all symbols are real
        if exponent == sympy.Rational(1, 2):
            return write_call("sqrt", [write_sympy(base, symbols)])
        if exponent.is_negative:
            return divide(number(1), write_sympy(base**-exponent, symbols))
        if exponent.is_Rational and not exponent.is_Integer:
            raised = literal(str(exponent), str(exponent), f"<mn>{exponent}</mn>", str(exponent))
            return power(write_sympy(base, symbols), raised)
        return power(write_sympy(base, symbols), write_sympy(exponent, symbols))
    if value.is_Rational:
        return number(Fraction(int(value.p), int(value.q)))
    if value is sympy.pi:
        return PI
    if value.is_Symbol:
        return symbols(value.name)
    if value is sympy.E:
        return literal("e")
    if value.is_Function:
        function = {"Abs": "abs"}.get(value.func.__name__, value.func.__name__)
        return write_call(function, [write_sympy(each, symbols) for each in value.args])
    return literal(str(value), sympy.latex(value))


def _write_product(value: sympy.Expr, symbols: Callable[[str], Written]) -> Written:
    """A product, what has negative powers below a line."""
    above, below = list[Written](), list[Written]()
    sign, factors = 1, list(value.as_ordered_factors())
    for factor in factors:
        if factor.is_Rational:
            sign *= -1 if factor < 0 else 1
            top, bottom = abs(int(factor.p)), int(factor.q)
            above += [number(top)] * (top != 1)
            below += [number(bottom)] * (bottom != 1)
            continue
        base, exponent = factor.as_base_exp()
        if exponent.is_negative and exponent.is_Rational:
            below.append(write_sympy(base**-exponent, symbols))
        else:
            above.append(write_sympy(factor, symbols))
    made = multiply(above or [number(1)])
    if below:
        made = divide(made, multiply(below))
    return negate(made) if sign < 0 else made
