"""Render, words: texts of a document with their formulas set, as a format has them.

Comes in: texts of a `coadjoint.derive.document.Document`. Goes out: `Prose`, escaped, which
templates print as it is. Read next: `coadjoint.render.document`.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from markupsafe import Markup
from markupsafe import escape as escape_html

from coadjoint.errors import make_printable
from coadjoint.methods import MAPPED, NOISY, STRUCTURED
from coadjoint.notation.names import name
from coadjoint.notation.prose import Formula, read_counts, read_prose
from coadjoint.notation.written import Written

#: Names and words of titles as their languages write them; specs and terminals have plain letters.
_ACCENTS: Final = {
    "Poincare": "Poincaré",
    "Ito": "Itô",
    "Fasso": "Fassò",
    "Mecanique": "Mécanique",
    "fuer": "für",
    "ueber": "über",
}
_PLAIN: Final = re.compile(rf"\b({'|'.join(_ACCENTS)})\b")


def set_accents(text: str) -> str:
    """Text in which well-known names have their accents.

    >>> set_accents("Euler-Poincare")
    'Euler-Poincaré'
    """
    return _PLAIN.sub(lambda found: _ACCENTS[found[0]], make_printable(text))


_LATEX_ESCAPES: Final = str.maketrans(
    {character: f"\\{character}" for character in "{}$&#_%"}
    | {
        "\\": r"\textbackslash{}",
        "^": r"\textasciicircum{}",
        "~": r"\textasciitilde{}",
        "<": r"\textless{}",
        ">": r"\textgreater{}",
    }
)


def escape_latex(text: str) -> str:
    r"""Text in which LaTeX sees no command.

    >>> escape_latex(r"\write18{rm}")
    '\\textbackslash{}write18\\{rm\\}'
    """
    return set_accents(text).translate(_LATEX_ESCAPES)


_TYPST_ESCAPES: Final = str.maketrans({c: f"\\{c}" for c in "\\#*_`$<>@[]=-+/~"})


def escape_typst(text: str) -> str:
    r"""Text in which Typst sees no command.

    >>> escape_typst("#read('x')")
    "\\#read('x')"
    """
    return set_accents(text).translate(_TYPST_ESCAPES)


#: What keeps words from being commands, by format; those of HTML are escaped by Jinja.
ESCAPES: Final[Mapping[str, Callable[[str], str]]] = {
    "html": set_accents,
    "latex": escape_latex,
    "typst": escape_typst,
}


@dataclass(frozen=True)
class Code:
    """A name as a person types it."""

    text: str


#: What a line of text is made of.
Part = str | Formula | Code


class Prose(Markup):
    """Words with formulas between them, as a format has them, ready to be printed.

    Attributes:
        plain: The text that it was, by which columns are measured.
    """

    plain: str

    @classmethod
    def of(cls, parts: Sequence[Part], plain: str, form: str) -> Prose:
        """Words, escaped, names of code, and formulas of `coadjoint.notation.prose`."""
        escape = _escape_html if form == "html" else ESCAPES[form]
        texts = [escape(p) if isinstance(p, str) else _set(p, form) for p in parts]
        if form == "html":
            texts = _keep_together(parts, texts)
        made = cls("".join(texts))
        made.plain = plain
        return made


def _keep_together(parts: Sequence[Part], texts: Sequence[str]) -> list[str]:
    """Texts of a page in which no line begins with the comma or point behind a formula."""
    kept = list(texts)
    for n, part in enumerate(parts[1:], 1):
        behind = re.match(r"[,.;:)]+", kept[n]) if isinstance(part, str) else None
        if behind and isinstance(parts[n - 1], Formula):
            lead, _, last = kept[n - 1].rpartition("<math>")
            kept[n - 1] = f'{lead}<span class="kept"><math>{last}{behind[0]}</span>'
            kept[n] = kept[n][behind.end() :]
    return kept


def _escape_html(text: str) -> str:
    """Text in which a page sees no element."""
    return str(escape_html(set_accents(text)))


def _set(formula: Formula | Code, form: str) -> str:
    """A formula, or a name of code, in a line."""
    if isinstance(formula, Code):
        if form == "typst":
            return f"#raw({json.dumps(make_printable(formula.text), ensure_ascii=False)})"
        # a line may end behind a _, or names overflow narrow columns
        if form == "latex":
            escaped = escape_latex(formula.text).replace(r"\_", r"\_\allowbreak{}")
            return rf"\texttt{{{escaped}}}"
        return f"<code>{_escape_html(formula.text).replace('_', '_<wbr>')}</code>"
    if form == "html":
        return " ".join(f"<math>{each}</math>" for each in formula.pieces)
    return f"${formula.written.latex if form == 'latex' else formula.written.typst}$"


def set_text(text: str, form: str = "html") -> str:
    """A text by itself, with its formulas set as formulas.

    >>> print(set_text("moves in C^3"))
    moves in <math><msup><mi>C</mi><mn>3</mn></msup></math>
    """
    return Prose.of(read_prose(text), text, form)


#: Names of methods, as a reason why some do not apply may have them.
_METHOD: Final = re.compile(rf"\b({'|'.join(sorted({*STRUCTURED, *MAPPED, *NOISY}))})\b")
#: Between entries of a list: no comma within brackets.
_COMMA: Final = re.compile(r", (?![^(]*\))")
#: Sections whose words name books and routes, and hold no formula.
_NO_FORMULAS: Final = ("principle", "references")


def set_prose(
    document: Mapping[str, Any], form: str, names: Mapping[str, Written] | None = None
) -> dict[str, Any]:
    """A document in which formulas between words are set as formulas.

    Names are written as its table of symbols has them, or as is given. The title is words.
    """
    sections = document["sections"]
    setter = _Setter({**(names or {}), **list_names(sections)}, form)
    made = [dict(part) for part in sections]
    for part in made:
        if part["kind"] == "cost":
            part["words"] = [(setter.code(n), setter.counts(t)) for n, t in part["words"]]
        elif part["kind"] not in _NO_FORMULAS:
            part["title"] = setter.prose(part["title"])
            part["words"] = [tuple(map(setter.prose, words)) for words in part["words"]]
        if columns := setter.columns(part["kind"]):
            head, *rows = part["rows"] or [()]
            part["rows"] = [head] * bool(head) + [
                tuple(write(cell) for write, cell in zip(columns, row, strict=True)) for row in rows
            ]
        if not part["law_latex"]:
            part["law"] = setter.prose(part["law"])
    return {**document, "description": setter.prose(document["description"]), "sections": made}


@dataclass(frozen=True)
class _Setter:
    """Texts of a document in a format.

    Attributes:
        names: How its table of symbols writes names.
        form: The format.
    """

    names: Mapping[str, Written]
    form: str

    def columns(self, kind: str) -> tuple[Callable[[Any], Any], ...]:
        """How cells of a table are set, by columns, the head apart; none where they stay."""

        def stay(cell: Any) -> Any:
            return cell

        return {
            "verdicts": (self.prose, stay, self.prose),
            "symbols": (stay, self.code, self.prose, stay),
            "methods": (self.code, stay, self.quantities, self.prose),
            "unfit": (self.code, self.reason),
        }.get(kind, ())

    def prose(self, text: str) -> str:
        """Words with formulas between them."""
        return self._made(read_prose(text, self.names), text)

    def counts(self, text: str) -> str:
        """Numbers of operations."""
        return self._made(read_counts(text), text)

    def code(self, text: str) -> str:
        """Names of code, with commas between them."""
        return self._made(_with_commas([Code(each)] for each in text.split(", ")), text)

    def quantities(self, text: str) -> str:
        """Names of what is kept, each with its sign, or as a word where it has none."""
        parts = list[list[str | Formula]]()
        for each in _COMMA.split(text):
            if each.isidentifier() and not re.fullmatch("[a-z]{2,}", each):
                sign = self.names.get(each) or name(each)
                parts.append([Formula(sign, (sign.mathml,))])
            else:
                parts.append(self._read(each))
        return self._made(_with_commas(parts), text)

    def reason(self, text: str) -> str:
        """A sentence that may name methods; its letters are those of no system."""
        parts = _METHOD.split(text)
        read = [[Code(p)] if n % 2 else read_prose(p) for n, p in enumerate(parts) if p]
        return self._made([each for part in read for each in part], text)

    def _read(self, text: str) -> list[str | Formula]:
        return read_prose(text, self.names)

    def _made(self, parts: Sequence[Part], text: str) -> str:
        """As a format has it; text that is words alone stays what it is."""
        return text if parts == [text] else Prose.of(parts, text, self.form)


def _with_commas(entries: Iterable[Sequence[Part]]) -> list[Part]:
    """A list of names."""
    listed = list[Part]()
    for n, entry in enumerate(entries):
        listed += [", "] * bool(n) + [*entry]
    return listed


def list_names(sections: Sequence[Mapping[str, Any]]) -> dict[str, Written]:
    """How the table of symbols writes names."""
    return {
        label: Written(
            text=label,
            latex=cell["latex"],
            mathml=cell["mathml"].removeprefix("<math>").removesuffix("</math>"),
            typst=cell["typst"],
        )
        for part in sections
        if part["kind"] == "symbols"
        for cell, label, *_ in part["rows"]
        if isinstance(cell, Mapping)
    }
