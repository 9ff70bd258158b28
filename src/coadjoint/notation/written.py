r"""Pieces of formulas, each written as text, LaTeX, MathML and Typst, and how they are joined.

Comes in: pieces. Goes out: the piece that they make. A piece knows how tightly it binds, so that
brackets stand only where they are needed. Read next: `coadjoint.notation.names`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import prod
from typing import Final

from markupsafe import escape

#: The dot of a rate; the accent of fonts is too small to be seen on a bold letter. Its size is an
#: attribute of MathML: pages whose policy knows their style by its hash refuse a style here.
DOT_ABOVE: Final = '<mo mathsize="1.3em">.</mo>'
#: How tightly a piece binds: a sum, a product, a power, a single symbol.
SUM: Final = 1
PRODUCT: Final = 2
POWER: Final = 3
ATOM: Final = 4
#: Of a bracket that does not stretch, and of the second one, which slanted letters would touch.
STILL, CLOSE = ' stretchy="false"', ' lspace="0.08em"'
#: Elements that are higher than a line; a power is nearly as high as its base.
_TALL: Final = re.compile("<m(frac|table|under|munderover)")
#: The text of a number, which has no sign.
_NUMBER: Final = re.compile(r"\d+(/\d+)?", re.ASCII)
#: Characters of text that a line of a page may be long, about.
WIDTH: Final = 80
#: Characters of a left side beyond which the right one stands below it.
LONG_LEFT: Final = 40


@dataclass(frozen=True)
class Written:
    """A piece of a formula in every format.

    Attributes:
        text: Plain ASCII text.
        latex: LaTeX in math mode.
        mathml: Presentation MathML, a single element.
        typst: Typst in math mode.
        level: How tightly it binds: `SUM`, `PRODUCT`, `POWER` or `ATOM`.
        sign: -1 where the piece is minus what is written, for a sum to write between addends.
        between: Whether it is a product with a sign between its factors.
        factors: Of a product, its factors; empty for all else.
        groups: Of a sum, the addends that fit on each line of a page.
        addends: Of a fraction whose numerator fills several lines, a fraction for each of them.
        fraction: Of a fraction, what is above and below the line.
    """

    text: str
    latex: str
    mathml: str
    typst: str
    level: int = ATOM
    sign: int = 1
    between: bool = False
    factors: tuple[Written, ...] = ()
    groups: tuple[tuple[Written, ...], ...] = ()
    addends: tuple[Written, ...] = ()
    fraction: tuple[Written, ...] = ()


def literal(text: str, latex: str = "", mathml: str = "", typst: str = "") -> Written:
    """A symbol as it is."""
    return Written(
        text=text,
        latex=latex or text,
        mathml=mathml or f"<mi>{escape(text)}</mi>",
        typst=typst or text,
    )


PI: Final = literal("pi", r"\pi", "<mi>π</mi>", "pi")


def row(*elements: str) -> str:
    """Elements of MathML as one."""
    return elements[0] if len(elements) == 1 else f"<mrow>{''.join(elements)}</mrow>"


def operator(text: str, space: str = "") -> str:
    """An operator of MathML."""
    spaced = f' lspace="{space}" rspace="{space}"' if space else ""
    return f"<mo{spaced}>{text}</mo>"


def fence(first: str, inside: str, last: str) -> tuple[str, str, str]:
    """Brackets of MathML around elements, as high as a line, or as what is higher inside.

    Those that stretch are set apart from what they hold, even where they have nothing to do.
    """
    if _TALL.search(inside):
        return operator(first), inside, operator(last)
    return f"<mo{STILL}>{first}</mo>", inside, f"<mo{STILL}{CLOSE}>{last}</mo>"


def number(value: Fraction | int) -> Written:
    """A number; a negative one carries its sign."""
    value = Fraction(value)
    size, sign = abs(value), -1 if value < 0 else 1
    top, bottom = (
        Written(text=str(n), latex=str(n), mathml=f"<mn>{n}</mn>", typst=str(n))
        for n in (size.numerator, size.denominator)
    )
    if size.denominator == 1:
        return replace(top, sign=sign)
    return replace(divide(top, bottom), sign=sign)


def bracket(part: Written, level: int) -> Written:
    """A piece that binds at least so tightly, in brackets where it does not."""
    if part.sign < 0:
        part = add([part])
    if part.level >= level:
        return part
    return Written(
        text=f"({part.text})",
        latex=rf"\left({part.latex}\right)",
        mathml=row(*fence("(", fold(part), ")")),
        typst=f"({part.typst})",
    )


def add(parts: Sequence[Written]) -> Written:
    """A sum, each addend with its sign."""
    parts = [each for part in parts for each in _list_addends(part)]
    if not parts:
        return number(0)
    if len(parts) == 1 and parts[0].sign > 0:
        return parts[0]
    texts, pieces, groups, width = ["", "", ""], list[str](), [list[Written]()], 0
    for n, part in enumerate(parts):
        plain = bracket(replace(part, sign=1), PRODUCT if part.sign < 0 else SUM)
        sign = "-" if part.sign < 0 else "+"
        first = sign if sign == "-" else ""
        for k, text in enumerate((plain.text, plain.latex, plain.typst)):
            texts[k] += (f" {sign} " if n else first) + text
        width += len(f" {sign} {plain.text}")
        if width > WIDTH and n:
            groups.append([])
            width = len(f" {sign} {plain.text}")
        groups[-1].append(part)
        if n or first:
            pieces.append(operator("&#x2212;" if sign == "-" else "+"))
        pieces.append(plain.mathml)
    return Written(
        text=texts[0],
        latex=texts[1],
        mathml=row(*pieces),
        typst=texts[2],
        level=SUM,
        groups=tuple(map(tuple, groups)),
    )


def _list_addends(part: Written) -> list[Written]:
    """What a sum prints of a part without brackets: addends of its own, each with its sign."""
    if part.addends:
        return [replace(each, sign=each.sign * part.sign) for each in part.addends]
    if part.sign > 0 and part.groups:
        return [each for group in part.groups for each in group]
    return [part]


def stack_latex(part: Written) -> str:
    """The LaTeX of a right side, a long sum on further lines of an ``align``."""
    if len(part.groups) < 2:
        return part.latex
    first, *others = (add(group).latex for group in part.groups)
    signed = (each if each.startswith("-") else f"+ {each}" for each in others)
    return " \\\\\n&\\quad ".join([first, *signed])


def stack(part: Written) -> str:
    """The MathML of a right side, a long sum in rows below each other."""
    return part.mathml if len(part.groups) < 2 else _table(_list_rows(part))


def stack_sides(left: Written, right: Written) -> str:
    """The MathML of an equation whose right side begins a row below the left one."""
    first, *others = _list_rows(right)
    equals = '<mspace width="1em"/><mo form="infix">=</mo>'  # which templates do not part
    behind = (f'<mrow><mspace width="2em"/>{each}</mrow>' for each in others)
    return _table([*_list_rows(left), f"<mrow>{equals}{first}</mrow>", *behind])


def fold(part: Written) -> str:
    """The MathML of a sum within a fraction or brackets, where no line ends: short rows."""
    addends = [each for group in part.groups for each in group]
    if len(part.text) <= WIDTH or not addends:
        return part.mathml
    rows, room = [list[Written]()], 0
    for each in addends:
        room += len(each.text) + 3
        if room > WIDTH // 2 and rows[-1]:
            rows.append([])
            room = len(each.text) + 3
        rows[-1].append(each)
    return _table(_list_rows(replace(part, groups=tuple(map(tuple, rows)))))


def _list_rows(part: Written) -> list[str]:
    """The rows of a sum, each but the first with its sign."""
    if len(part.groups) < 2:
        return [part.mathml]
    return [
        row(*([operator("+")] if n and group[0].sign > 0 else []), add(group).mathml)
        for n, group in enumerate(part.groups)
    ]


def _table(rows: Sequence[str]) -> str:
    """Rows of MathML below each other, from the left."""
    left = 'style="text-align: left; padding: 0.25em 0"'
    cells = (f"<mtr><mtd {left}>{each}</mtd></mtr>" for each in rows)
    return f'<mtable displaystyle="true">{"".join(cells)}</mtable>'


def negate(part: Written) -> Written:
    """Minus a piece; in a sum it takes the sign between addends."""
    return replace(part, sign=-part.sign)


def multiply(parts: Sequence[Written], *, joint: str = " ") -> Written:
    """A product without a sign between factors.

    Its numbers are one, before the others, which is left out if it is 1: a fraction and a whole
    number side by side would be read as their sum.
    """
    sign = 1
    for part in parts:
        sign *= part.sign
    plain = [each for p in parts for each in (p.factors or (replace(p, sign=1),))]
    numbers = [Fraction(part.text) for part in plain if _NUMBER.fullmatch(part.text)]
    plain = [part for part in plain if not _NUMBER.fullmatch(part.text)]
    if (whole := prod(numbers, start=Fraction(1))) != 1 or not plain:
        plain.insert(0, number(whole))
    if len(plain) == 1:
        return replace(plain[0], sign=sign)
    *before, last = plain
    # a product of vectors before another factor could be taken for a part of it
    own = [bracket(part, POWER if part.between else PRODUCT) for part in before]
    own.append(bracket(last, PRODUCT))
    return Written(
        text=joint.join(part.text for part in own),
        latex=r"\,".join(part.latex for part in own),
        mathml=row(*_spaced([part.mathml for part in own])),
        typst=" ".join(part.typst for part in own),
        level=PRODUCT,
        sign=sign,
        between=last.between,
        factors=tuple(plain),
    )


def _spaced(factors: Sequence[str]) -> list[str]:
    """Factors with a thin space between them."""
    thin = '<mspace width="0.17em"/>'
    spaced = [piece for factor in factors for piece in (thin, factor)]
    return spaced[1:]


def divide(top: Written, bottom: Written) -> Written:
    """A fraction; one whose numerator fills several lines is a sum of a fraction for each."""
    if len(top.groups) > 1:
        tops = [group[0] if len(group) == 1 else add(group) for group in top.groups]
        each = [divide(each, bottom) for each in tops]
        own = tuple(replace(part, sign=part.sign * top.sign) for part in each)
        return replace(add(own), addends=own)
    sign, top = top.sign, replace(top, sign=1)
    upper, lower = bracket(top, PRODUCT), bracket(bottom, POWER)
    if top.fraction:  # a fraction over something is one over the product
        first, second = top.fraction
        made = divide(first, multiply([second, bottom]))
        return replace(made, text=f"{upper.text}/{lower.text}", sign=sign * made.sign)
    return Written(
        text=f"{upper.text}/{lower.text}",
        latex=rf"\frac{{{_enlarge_latex(top.latex)}}}{{{_enlarge_latex(bottom.latex)}}}",
        mathml=f"<mfrac>{_enlarge(top.mathml)}{_enlarge(fold(bottom))}</mfrac>",
        typst=f"frac({top.typst}, {bottom.typst})",
        level=PRODUCT,
        sign=sign,
        fraction=(top, bottom),
    )


def _enlarge(mathml: str) -> str:
    """A part of a fraction; with fractions in it as large as a formula by itself."""
    if "<mfrac>" not in mathml:
        return mathml
    return f'<mstyle displaystyle="true" scriptlevel="0">{mathml}</mstyle>'


def _enlarge_latex(latex: str) -> str:
    """The same of LaTeX."""
    return latex.replace(r"\frac", r"\dfrac")


def power(base: Written, exponent: Written | int) -> Written:
    """A power; of a number or symbol without brackets."""
    if exponent == 1:
        return base
    raised = number(exponent) if isinstance(exponent, int) else exponent
    raised = add([raised]) if raised.sign < 0 else raised
    own = bracket(base, ATOM)
    shown = raised.text if raised.level == ATOM else f"({raised.text})"
    # TeX ends no line within braces, which a long absolute value does without
    latex = own.latex if own.latex.startswith(r"\lvert") else f"{{{own.latex}}}"
    return Written(
        text=f"{own.text}^{shown}",
        latex=f"{latex}^{{{raised.latex}}}",
        mathml=f"<msup>{own.mathml}{raised.mathml}</msup>",
        typst=f"{own.typst}^({raised.typst})",
        level=POWER,
    )


def root(part: Written) -> Written:
    """A square root."""
    inner = add([part]) if part.sign < 0 else part
    return Written(
        text=f"sqrt({inner.text})",
        latex=rf"\sqrt{{{inner.latex}}}",
        mathml=f"<msqrt>{inner.mathml}</msqrt>",
        typst=f"sqrt({inner.typst})",
    )


def call(function: str, arguments: Sequence[Written]) -> Written:
    """A function of arguments, by its name in upright letters."""
    inner = [add([part]) if part.sign < 0 else part for part in arguments]
    known = function in _LATEX_FUNCTIONS
    comma = "".join(piece for part in inner for piece in (operator(","), part.mathml)).removeprefix(
        operator(",")
    )
    shown = {"trace": "tr"}.get(function, function)
    latex_name = rf"\{function}" if known else rf"\operatorname{{{shown}}}"
    return Written(
        text=f"{function}({', '.join(part.text for part in inner)})",
        latex=rf"{latex_name}\left({', '.join(part.latex for part in inner)}\right)",
        mathml=f"<mrow><mi>{shown}</mi>{operator('&#x2061;')}"
        f"<mrow>{''.join(fence('(', comma, ')'))}</mrow></mrow>",
        typst=f"{function if known else 'op(' + chr(34) + shown + chr(34) + ')'}"
        f"({', '.join(part.typst for part in inner)})",
    )


_LATEX_FUNCTIONS: Final = frozenset(
    [
        "sin",
        "cos",
        "tan",
        "exp",
        "log",
        "arcsin",
        "arccos",
        "arctan",
        "sinh",
        "cosh",
        "tanh",
        "det",
        "min",
        "max",
    ]
)


def between(left: Written, sign: tuple[str, str, str, str], right: Written) -> Written:
    """A product of vectors, by the sign that stands between its factors."""
    outer = left.sign * right.sign
    a, b = (bracket(replace(part, sign=1), POWER) for part in (left, right))
    text, latex, mathml, typst = sign
    return Written(
        text=f"{a.text} {text} {b.text}",
        latex=f"{a.latex} {latex} {b.latex}",
        mathml=row(a.mathml, operator(mathml), b.mathml),
        typst=f"{a.typst} {typst} {b.typst}",
        level=PRODUCT,
        sign=outer,
        between=True,
    )


#: Signs between vectors: text, LaTeX, MathML, Typst.
CROSS: Final = ("x", r"\times", "&#xD7;", "times")
DOT: Final = (".", r"\cdot", "&#x22C5;", "dot.op")
OUTER: Final = ("(x)", r"\otimes", "&#x2297;", "⊗")


def enclose(parts: Sequence[Written], marks: str = "[]") -> Written:
    """Pieces with commas between them in brackets: ``[]``, ``{}``, ``()``, ``<>`` or ``||``."""
    inner = [add([part]) if part.sign < 0 else part for part in parts]
    first, last = marks[0], marks[1]
    braces = {"{": r"\{", "}": r"\}", "<": r"\langle ", ">": r"\rangle"}
    shown = [{"<": "⟨", ">": "⟩"}.get(mark, mark) for mark in (first, last)]
    opens, closes = (
        (r"\lvert ", r"\rvert")
        if first == "|"
        else (braces.get(first, first), braces.get(last, last))
    )
    typst = ", ".join(part.typst for part in inner)
    return Written(
        text=first + ", ".join(part.text for part in inner) + last,
        latex=opens + ", ".join(part.latex for part in inner) + closes,
        mathml=row(*fence(shown[0], operator(",").join(map(fold, inner)), shown[1])),
        typst=f"abs({typst})" if first == "|" else f"{shown[0]}{typst}{shown[1]}",
    )


def matrix(rows: Sequence[Sequence[Written]]) -> Written:
    """Entries in rows, in round brackets."""
    shown = [[add([entry]) if entry.sign < 0 else entry for entry in each] for each in rows]
    cells = ("".join(f"<mtd>{entry.mathml}</mtd>" for entry in each) for each in shown)
    table = "".join(f"<mtr>{each}</mtr>" for each in cells)
    return Written(
        text=f"rows({', '.join(enclose(each, '()').text for each in rows)})",
        latex=r"\begin{pmatrix}"
        + r" \\ ".join(" & ".join(entry.latex for entry in each) for each in shown)
        + r"\end{pmatrix}",
        mathml=row(operator("("), f"<mtable>{table}</mtable>", operator(")")),
        typst=f"mat({'; '.join(', '.join(entry.typst for entry in each) for each in shown)})",
    )


def attach(
    base: Written, *, below: Sequence[Written] = (), above: Written | None = None, dot: bool = False
) -> Written:
    r"""A symbol with subscripts, a superscript or a dot, the dot over the symbol alone.

    >>> attach(literal("Pi", r"\Pi"), below=[number(1)], dot=True).latex
    '\\dot{\\Pi}_1'
    """
    latex, mathml, typst = base.latex, base.mathml, base.typst
    if dot and latex.startswith(r"\dot{"):  # the rate of what is a rate by its name
        latex, typst = rf"\d{latex[1:]}", typst.replace("dot(", "dot.double(", 1)
        mathml = mathml.replace(DOT_ABOVE, DOT_ABOVE.replace(".<", "..<"))
    elif dot:
        latex = rf"\dot{{{latex}}}"
        mathml = f"<mover>{mathml}{DOT_ABOVE}</mover>"
        typst = f"dot({typst})"
    if below:
        comma = ",".join(each.latex for each in below)
        latex = f"{latex}_{{{comma}}}" if len(comma) > 1 else f"{latex}_{comma}"
        lower = operator(",").join(each.mathml for each in below)
        mathml = f"<msub>{mathml}{row(lower) if len(below) == 1 else row(lower, '')}</msub>"
        typst = f"{typst}_({', '.join(each.typst for each in below)})"
    if above is not None:
        latex = f"{latex}^{{{above.latex}}}"
        mathml = f"<msup>{mathml}{above.mathml}</msup>"
        typst = f"{typst}^({above.typst})"
    return replace(base, latex=latex, mathml=mathml, typst=typst)


def aligned(rows: Iterable[str]) -> str:
    r"""Rows ``left &= right`` of LaTeX as one block.

    >>> aligned(["a &= b", "c &= d"])
    '\\begin{aligned}\na &= b \\\\\nc &= d\n\\end{aligned}'
    """
    return "\\begin{aligned}\n" + " \\\\\n".join(rows) + "\n\\end{aligned}"
