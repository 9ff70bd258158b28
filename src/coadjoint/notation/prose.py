"""Formulas within sentences: ``{K, P} = -M*diag(m) is proved`` holds one, and three words.

What was proved of a system is told in sentences of plain text, in which formulas stand as code
writes them. Here they are found, by reading: a stretch of a sentence is a formula if it reads as
one and is more than a word or a number. Comes in: a text. Goes out: words as they are, and
`Formula`s. Read next: `coadjoint.notation.reading`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final

from coadjoint.notation.reading import CLOSING, SIGNS, NoFormulaError, Reading, is_symbol
from coadjoint.notation.written import (
    PRODUCT,
    SUM,
    Written,
    add,
    bracket,
    literal,
    operator,
    row,
)

#: Characters up to which a formula is one piece of a line, and is not broken before its signs.
SHORT: Final = 20
#: Pieces of a text that are read: of a longer one nothing is.
LONGEST: Final = 2000
_OPERATION: Final = re.compile(r"(\d+) ([-*/+])(?=[,;]|$)")
_OPERATIONS: Final = {
    "*": (r"\times", "×", "times"),
    "-": ("-", "−", "-"),
    "+": ("+", "+", "+"),
    "/": ("/", "/", '"/"'),
}


@dataclass(frozen=True)
class Formula:
    """A formula in a line of text.

    Attributes:
        written: It as a whole; LaTeX and Typst break it by themselves.
        pieces: The MathML of stretches between which a line of a page may end.
    """

    written: Written
    pieces: tuple[str, ...]


def read_prose(text: str, names: Mapping[str, Written] | None = None) -> list[str | Formula]:
    r"""The words and the formulas of a text, in order.

    Args:
        text: Plain text, with formulas as code writes them.
        names: How some names are written, in the place of their own way.

    >>> [each if isinstance(each, str) else each.written.latex
    ...  for each in read_prose("the height dot(Gamma, s) is kept for N >= 2.")]
    ['the height ', '\\Gamma \\cdot s', ' is kept for ', 'N \\ge 2', '.']
    """
    return _join(text, _Sentences(text, names or {}).list_formulas())


def read_counts(text: str) -> list[str | Formula]:
    r"""A list of operations such as ``2 *, 1 sqrt``, with the signs of a book.

    >>> [each if isinstance(each, str) else each.written.latex for each in read_counts("2 *, 1 +")]
    ['2\\,{\\times}', ', ', '1\\,{+}']
    """
    found = _OPERATION.finditer(text)
    return _join(
        text, ((*each.span(), _as_formula([("", _count(*each.groups()))])) for each in found)
    )


def _count(times: str, sign: str) -> Written:
    """How often an operation is made; a line does not end between the number and the sign."""
    latex, shown, typst = _OPERATIONS[sign]
    return literal(
        f"{times} {sign}",
        rf"{times}\,{{{latex}}}",
        row(f"<mn>{times}</mn>", '<mspace width="0.17em"/>', operator(shown, "0")),
        f"{times} space.thin {typst}",
    )


def _join(text: str, found: Iterator[tuple[int, int, Formula]]) -> list[str | Formula]:
    """Formulas by where they begin and end, and the words between them."""
    parts, done = list[str | Formula](), 0
    for start, end, formula in found:
        parts += [*([text[done:start]] if start > done else []), formula]
        done = end
    return parts + ([text[done:]] if done < len(text) else [])


class _Sentences(Reading):
    """A text in which formulas are looked for."""

    def list_formulas(self) -> Iterator[tuple[int, int, Formula]]:
        """Where formulas begin and end, and what they are."""
        first = 0 if len(self.tokens) <= LONGEST else len(self.tokens)
        while first < len(self.tokens):
            self.at = first
            try:
                made = self.sides()
            except NoFormulaError:
                made = []
            if made and self._is_formula(first):
                span = self.tokens[first].start(), self.tokens[self.at - 1].end()
                yield *span, _as_formula(made)
                first = self.at
            else:
                first += 4 if self._is_plural(first) else 1

    def _is_plural(self, at: int) -> bool:
        """Whether a word with the ending of a plural begins at a token: ``point(s)``."""
        first, *others = (each[0] for each in self.tokens[at : at + 4])
        return others == ["(", "s", ")"] and not is_symbol(first)

    def _is_formula(self, first: int) -> bool:
        """Whether tokens that read as a formula are more than words and numbers in brackets."""
        tokens = self.tokens[first : self.at]
        if self._is_attached(first) or self._is_attached(self.at):
            return False
        if len(tokens) == 1:
            token = tokens[0]
            lead = token[0] == "A" and self.text[: token.start()].rstrip()[-1:] in ("", ".", ":")
            is_name = token["name"] and (is_symbol(token[0]) or self._is_known(token[0]))
            return bool(token["rate"] or token["ten"]) or bool(is_name and not lead)
        if len(tokens) == 4 and self._is_plural(first):
            return False
        plain = tokens[0][0] in ("(", "[") and self._find_closing(first) == self.at - 1
        return not plain or (tokens[0][0] == "[" and any(each[0] == "," for each in tokens))

    def _is_known(self, text: str) -> bool:
        """Whether a name, or that of what it is a component or rate of, has a way of its own.

        Those that are words, such as ``spin``, stay words.
        """
        if re.fullmatch(r"d\w+_dt", text):
            return True
        of = text.rstrip("0123456789")
        return not (text.isalpha() and text.islower()) and (text in self.names or of in self.names)

    def _is_attached(self, at: int) -> bool:
        """Whether a letter stands right before a token: of a word that has been left."""
        if not 0 < at < len(self.tokens):
            return False
        before, token = self.tokens[at - 1], self.tokens[at]
        joined = (before["other"] or "") + (token["other"] or "")
        return before.end() == token.start() and any(
            each.isalnum() or each in "_'" for each in joined
        )

    def _find_closing(self, at: int) -> int:
        """The token that closes the bracket at ``at``."""
        opening, deep = self.tokens[at][0], 0
        for k in range(at, len(self.tokens)):
            deep += (self.tokens[k][0] == opening) - (self.tokens[k][0] == CLOSING[opening])
            if not deep:
                return k
        return -1


def _as_formula(sides: list[tuple[str, Written]]) -> Formula:
    """A relation as a whole and in pieces: a line may end before each of its signs."""
    latex, mathml, typst, pieces = list[str](), list[str](), list[str](), list[str]()
    for sign, side in sides:
        whole = add([side]) if side.sign < 0 else side
        shown = SIGNS.get(sign, ("", "", ""))
        lead = [f'<mo form="infix">{shown[1]}</mo>'] if sign else []
        latex += [*filter(None, [shown[0]]), whole.latex]
        typst += [*filter(None, [shown[2]]), whole.typst]
        mathml += [*lead, whole.mathml]
        for n, part in enumerate([each for group in whole.groups for each in group] or [whole]):
            mark = "&#x2212;" if part.sign < 0 else "+"
            signed = [f'<mo form="infix">{mark}</mo>'] if n else []
            level = PRODUCT if n and part.sign < 0 else SUM
            own = bracket(replace(part, sign=1), level) if n else add([part])
            pieces.append(row(*([] if n else lead), *signed, own.mathml))
    written = literal(" ", " ".join(latex), row(*mathml), " ".join(typst))
    long = sum(len(re.sub("<[^>]*>", "", each)) for each in pieces) > SHORT
    return Formula(
        written=replace(written, level=SUM), pieces=tuple(pieces) if long else (written.mathml,)
    )
