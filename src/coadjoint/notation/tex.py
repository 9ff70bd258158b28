r"""The LaTeX of general laws as MathML, as far as laws of this package use it.

Comes in: LaTeX that this package wrote, such as ``\dot\mu = \mathrm{ad}^*_\xi \mu``. Goes out:
MathML, or None for a command that is not known here; pages then show the law as plain text.
"""

from __future__ import annotations

import re
from typing import Final

from markupsafe import escape

from coadjoint.notation.names import GREEK
from coadjoint.notation.written import CLOSE, DOT_ABOVE, STILL, row

_PIECE = re.compile(r"\\[A-Za-z]+|\\.|\d+|[^\s]")
_OPERATORS: Final = {
    "partial": "∂", "nabla": "∇", "cdot": "⋅", "times": "×", "diamond": "⋄", "sum": "∑",
    "int": "∫", "circ": "∘", "mp": "∓", "pm": "±", "mapsto": "↦", "wedge": "∧", "to": "→",
    "notin": "∉", "ge": "≥", "le": "≤", "ne": "≠", "langle": "⟨", "rangle": "⟩", "ldots": "…",
    "dots": "…", "Longrightarrow": "⟹", "{": "{", "}": "}", "|": "‖", "iota": "ι", "in": "∈",
    "otimes": "⊗", "top": "⊤", "infty": "∞",
}  # fmt: skip
_OPENING, _ENDING = ("(", "[", "{", "⟨"), (")", "]", "}", "⟩")
_SPACES: Final = {",": "0.17em", ";": "0.28em", "quad": "1em", "qquad": "2em", " ": "0.3em"}
_ACCENTS: Final = {"ddot": "¨", "hat": "^", "tilde": "~", "bar": "¯"}
_SIZES: Final = ("left", "right", "big", "Big", "bigl", "bigr", "Bigl", "Bigr")
_WORDS: Final = ("sin", "cos", "tan", "exp", "log", "det", "min", "max")
_LETTERS: Final = {"varphi": "φ", "ell": "ℓ"}


class _UnknownError(Exception):
    """A command that stands in no table."""


def to_mathml(latex: str) -> str | None:
    r"""MathML of a law.

    >>> to_mathml(r"\mu_1")
    '<math><msub><mi>μ</mi><mn>1</mn></msub></math>'
    >>> to_mathml(r"\tfrac12(x)") == to_mathml(r"\tfrac{1}{2}(x)")
    True
    >>> to_mathml(r"\unknown") is None
    True
    """
    try:
        reader = _Reader(_PIECE.findall(latex))
        return f"<math>{row(*reader.row(stop=''))}</math>"
    except (_UnknownError, IndexError):
        return None


class _Reader:
    """One reading of one law."""

    def __init__(self, pieces: list[str]) -> None:
        self.pieces, self.at = pieces, 0

    def row(self, stop: str) -> list[str]:
        """Elements up to a piece, with what is above and below them."""
        parts = list[str]()
        while self.at < len(self.pieces) and self.pieces[self.at] != stop:
            parts.append(self._scripted())
        if stop:
            self._take()
        return parts or ["<mrow></mrow>"]

    def _take(self) -> str:
        self.at += 1
        return self.pieces[self.at - 1]

    def _scripted(self) -> str:
        """One element with its subscript and its superscript."""
        base, scripts = self._atom(), dict[str, str]()
        while self.at < len(self.pieces) and self.pieces[self.at] in ("_", "^", "'"):
            kind = self._take()
            scripts["^" if kind == "'" else kind] = "<mo>′</mo>" if kind == "'" else self._atom()
        match sorted(scripts):
            case ["^"]:
                return f"<msup>{base}{scripts['^']}</msup>"
            case ["_"]:
                return f"<msub>{base}{scripts['_']}</msub>"
            case ["^", "_"]:
                return f"<msubsup>{base}{scripts['_']}{scripts['^']}</msubsup>"
        return base

    def _atom(self) -> str:
        piece = self._take()
        if piece == "{":
            return row(*self.row(stop="}"))
        if not piece.startswith("\\"):
            return _plain(piece)
        name = piece[1:]
        if name in GREEK:
            return f"<mi>{GREEK[name][1]}</mi>"
        if name in _LETTERS:
            return f"<mi>{_LETTERS[name]}</mi>"
        if name in _OPERATORS:
            return _sign(_OPERATORS[name])
        if name in _SPACES:
            return f'<mspace width="{_SPACES[name]}"/>'
        if name == "dot":
            return f"<mover>{self._atom()}{DOT_ABOVE}</mover>"
        if name in _ACCENTS:
            return f'<mover accent="true">{self._atom()}<mo>{_ACCENTS[name]}</mo></mover>'
        if name in _SIZES:
            return self._atom().replace(STILL, "")
        if name in _WORDS:
            return f"<mi>{name}</mi>"
        if name in ("frac", "tfrac"):
            return f"<mfrac>{self._argument()}{self._argument()}</mfrac>"
        if name == "sqrt":
            return f"<msqrt>{self._atom()}</msqrt>"
        if name in ("mathrm", "operatorname", "text", "mathcal", "mathbf"):
            return self._words(upright=name != "mathcal")
        raise _UnknownError(name)

    def _argument(self) -> str:
        """What stands in braces, or else one piece: of a number its first digit."""
        piece = self.pieces[self.at]
        if piece.isdigit() and len(piece) > 1:
            self.pieces[self.at] = piece[1:]
            return _plain(piece[0])
        return self._atom()

    def _words(self, *, upright: bool) -> str:
        """Letters in braces as one word."""
        if self._take() != "{":
            raise _UnknownError
        letters = list[str]()
        while (piece := self._take()) != "}":
            letters.append(piece)
        text = escape("".join(letters))
        return f'<mi mathvariant="normal">{text}</mi>' if upright else f"<mi>{text}</mi>"


def _plain(piece: str) -> str:
    """A letter, a number or a sign."""
    if piece.isdigit():
        return f"<mn>{piece}</mn>"
    if piece.isalpha():
        return f"<mi>{piece}</mi>"
    return _sign("−" if piece == "-" else escape(piece))


def _sign(text: str) -> str:
    """An operator; a bracket as high as a line, unless its size is given, and none for itself."""
    if text in _OPENING:
        return f'<mo form="prefix"{STILL}>{text}</mo>'
    return (
        f'<mo form="postfix"{STILL}{CLOSE}>{text}</mo>' if text in _ENDING else f"<mo>{text}</mo>"
    )


def is_formula(latex: str, text: str) -> bool:
    """Whether the LaTeX of a law is one, and not its words once more.

    >>> is_formula("imposed before the variation", "imposed before the variation")
    False
    """
    return bool(latex) and (latex != text or not re.search(r"[A-Za-z]{3}", text))
