"""Formulas that are written as text, such as ``(N^2 - 1)*V[i, j+1]``, in every format.

Laws of this package that no element of a field holds are texts, as generated code shows them: of
matrices with any number of rows. Comes in: a text. Goes out: a `Written`.
Read next: `coadjoint.notation.written`.
"""

from __future__ import annotations

import ast
import re
from dataclasses import replace

from coadjoint.notation.names import name
from coadjoint.notation.written import (
    ATOM,
    Written,
    add,
    attach,
    bracket,
    call,
    divide,
    enclose,
    literal,
    multiply,
    negate,
    number,
    operator,
    power,
    root,
    row,
)


def write_text(text: str) -> Written:
    r"""A formula by its text, which stays as it is.

    Two names side by side are an operator and what it acts on, brackets alone a commutator.

    >>> write_text("(L V)[i, j+1]").latex, write_text("4*pi/N*L V").text
    ('\\left(L\\,V\\right)_{i,j + 1}', '4*pi/N*L V')
    """
    plain = re.sub(r"\|(\w+)\|", r"abs(\1)", text.replace("^", "**"))
    plain = plain.replace(" mod ", "^").replace(" to ", "|")  # which bind less than a sum
    plain = re.sub(r"(?<=\w) (?=[A-Z])", "*", plain)
    rate = re.fullmatch(r"d(\w+)/dt", text)
    shown = name(rate[1], dot=True) if rate else _write(ast.parse(plain, mode="eval").body)
    return replace(shown, text=text)


def _write(node: ast.expr) -> Written:
    """A part of it."""
    match node:
        case ast.Name(id=label):
            return name(label)
        case ast.Constant(value=int(value)):
            return number(value)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return negate(_write(operand))
        case ast.BinOp(left=left, op=op, right=right):
            return _join(_write(left), op, right)
        case ast.Call(func=ast.Name(id="sqrt"), args=[argument]):
            return root(_write(argument))
        case ast.Call(func=ast.Name(id="abs"), args=[argument]):
            return enclose([_write(argument)], "||")
        case ast.Call(func=ast.Name(id=function), args=arguments):
            return call(function, [_write(each) for each in arguments])
        case ast.List(elts=parts):
            return enclose([_write(each) for each in parts])
        case ast.Tuple(elts=parts):
            return _side_by_side([_write(each) for each in parts], ", ", operator(","))
        case ast.Subscript(value=of, slice=place):
            below = place.elts if isinstance(place, ast.Tuple) else [place]
            whole = _write(of)
            if isinstance(of, ast.Subscript):
                whole = enclose([whole], "()")
            return attach(bracket(whole, ATOM), below=[_write(each) for each in below])
    raise AssertionError(ast.dump(node))


def _join(left: Written, op: ast.operator, right: ast.expr) -> Written:
    """Two parts with a sign between them."""
    own = _write(right)
    match op:
        case ast.Add():
            return add([left, own])
        case ast.Sub():
            return add([left, negate(own)])
        case ast.Mult():
            return multiply([left, own])
        case ast.Div():
            return divide(left, own)
        case ast.Pow():
            return power(left, own)
        case ast.BitXor():
            return _side_by_side([left, own], " mod ", "<mo>mod</mo>")
        case ast.BitOr():
            return _side_by_side([left, own], " to ", "<mo>to</mo>")
    raise AssertionError(op)


def _side_by_side(parts: list[Written], joint: str, sign: str) -> Written:
    """Formulas with a word or a comma between them."""
    word = joint.strip().isalpha()
    return literal(
        joint.join(each.text for each in parts),
        (rf"\;\mathrm{{{joint.strip()}}}\;" if word else r",\;").join(e.latex for e in parts),
        row(*[piece for each in parts for piece in (sign, each.mathml)][1:]),
        (f' "{joint.strip()}" ' if word else ", ").join(each.typst for each in parts),
    )
