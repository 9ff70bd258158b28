r"""Functions of a spec as a book writes them: ``cross(a, b)`` is a product with a sign.

Comes in: arguments, written. Goes out: what they make, written. No tree is known here, so that
documents are printed without the reader of specs. Read next: `coadjoint.notation.written`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Final

from coadjoint.notation.written import (
    ATOM,
    CROSS,
    DOT,
    OUTER,
    SUM,
    Written,
    add,
    between,
    bracket,
    enclose,
    literal,
    multiply,
    operator,
    power,
    root,
    row,
)

LAPLACIAN: Final = literal("Laplacian", r"\Delta", '<mi mathvariant="normal">Δ</mi>', "Delta")
#: Relations, as LaTeX, MathML and Typst have them.
RELATIONS: Final[Mapping[str, tuple[str, str, str]]] = {
    "=": ("=", "=", "="),
    "==": ("=", "=", "="),
    "!=": (r"\ne", "≠", "!="),
    "<": ("<", "&lt;", "<"),
    ">": (">", "&gt;", ">"),
    "<=": (r"\le", "≤", "<="),
    "~=": (r"\approx", "≈", "approx"),
    ">=": (r"\ge", "≥", ">="),
}
#: Functions that have a sign, by name.
CALLS: Final[Mapping[str, Callable[..., Written]]] = {
    "dot": lambda a, b: between(a, DOT, b),
    "cross": lambda a, b: between(a, CROSS, b),
    "outer": lambda a, b: between(a, OUTER, b),
    "commutator": lambda a, b: enclose([a, b]),
    "jacobian": lambda a, b: enclose([a, b], "{}"),
    "laplacian": lambda a: multiply([LAPLACIAN, a]),
    "qmul": lambda a, b: multiply([a, b]),
    "transpose": lambda a: raise_mark(a, "T", "⊤"),
    "conjugate": lambda a: raise_mark(a, "*", "*"),
    "inverse": lambda a: power(a, -1),
    "norm": lambda a: enclose([a], "||"),
    "abs": lambda a: enclose([a], "||"),
    "sqrt": root,
    "exp": lambda a: _exponential(a),
    "vector": lambda *a: enclose(a, "()"),
    "pow": power,
    "hat": lambda a: _hat(a),
    "vee": lambda a: replace(raise_mark(a, "vee", "∨"), text=f"vee({a.text})"),
}


#: Marks between vectors and their matrices, by their names in LaTeX, as Typst has them.
_BETWEEN: Final = {"vee": "or", "wedge": "and"}


def raise_mark(base: Written, text: str, mark: str) -> Written:
    """A mark above: of a transpose, of its inverse, a conjugate."""
    own = bracket(base, ATOM)
    latex, typst = text.replace("T", r"\top"), text.replace("T", "top").replace("*", "ast")
    if text in _BETWEEN:
        latex, typst = rf"\{text}", _BETWEEN[text]
    return Written(
        text=f"{own.text}^{text}",
        latex=f"{own.latex}^{{{latex}}}",
        mathml=f"<msup>{own.mathml}<mo>{mark}</mo></msup>",
        typst=f"{own.typst}^({typst})",
    )


def _exponential(exponent: Written) -> Written:
    base = literal("e", "e", "<mi>e</mi>", "e")
    inner = add([exponent]) if exponent.sign < 0 else exponent
    return replace(power(base, inner), text=f"exp({inner.text})", level=ATOM)


def _hat(vector: Written) -> Written:
    """The matrix of a vector: a hat over a symbol; a wedge behind what a hat would not cover."""
    if vector.level < ATOM:
        return replace(raise_mark(vector, "wedge", "∧"), text=f"hat({vector.text})")
    return Written(
        text=f"hat({vector.text})",
        latex=rf"\widehat{{{vector.latex}}}",
        mathml=f'<mover accent="true">{vector.mathml}{operator("^")}</mover>',
        typst=f"hat({vector.typst})",
    )


def write_rate(of: Written) -> Written:
    """The rate of what has no dot of its own."""
    return Written(
        text=f"d({of.text})/dt" if of.level < ATOM else f"d{of.text}/dt",
        latex=rf"\frac{{d}}{{dt}} {bracket(of, ATOM).latex}",
        mathml=row(
            "<mfrac><mi>d</mi><mrow><mi>d</mi><mi>t</mi></mrow></mfrac>", bracket(of, ATOM).mathml
        ),
        typst=f"frac(dif, dif t) {bracket(of, ATOM).typst}",
    )


def write_noise(of: Written, process: Written) -> Written:
    """What a process moves, times its increment in the sense of Stratonovich."""
    increment = Written(
        text=f"o {process.text}",
        latex=rf"\circ {process.latex}",
        mathml=row(operator("∘"), process.mathml),
        typst=f"compose {process.typst}",
    )
    return multiply([of, increment])


def write_sum(indices: tuple[str, ...], below: list[Written], sign: str) -> Written:
    """A sum over members, with the two sides of its condition before its term."""
    *sides, term = below
    listed = ", ".join(indices)
    text, latex, typst = listed, listed, listed
    mathml = operator(",").join(f"<mi>{i}</mi>" for i in indices)
    if sides:
        in_latex, shown, in_typst = RELATIONS[sign]
        a, b = sides
        text = f"{listed}, {a.text} {sign} {b.text}"
        latex, typst = f"{a.latex} {in_latex} {b.latex}", f"{a.typst} {in_typst} {b.typst}"
        mathml = row(a.mathml, operator(shown), b.mathml)
    outer, term = term.sign, replace(term, sign=1)
    own = bracket(term, SUM + 1)
    return Written(
        text=f"sum({text}, {term.text})",
        latex=rf"\sum_{{{latex}}} {own.latex}",
        mathml=row(f"<munder><mo>∑</mo>{row(mathml)}</munder>", own.mathml),
        typst=f"sum_({typst}) {own.typst}",
        level=SUM + 1,
        sign=outer,
    )
