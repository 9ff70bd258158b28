"""Render, documents: a derivation as plain text, as a LaTeX file or as a web page.

Comes in: a `coadjoint.derive.document.Document` as plain JSON values, so that it may come from a
child process. Goes out: text. Titles and sources are free text of a spec: each format escapes
whatever a template prints, unless the template marks a formula as safe, and formulas are made of
restricted names only.
Read next: `templates/document/text.j2`, the shortest of the three.
"""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from itertools import groupby
from typing import Any, Final

from jinja2.sandbox import ImmutableSandboxedEnvironment
from markupsafe import Markup
from markupsafe import escape as escape_html

from coadjoint.methods import MAPPED, NOISY, STRUCTURED
from coadjoint.notation.names import name
from coadjoint.notation.prose import Formula, read_counts, read_prose
from coadjoint.notation.tex import is_formula, to_mathml
from coadjoint.notation.written import LONG_LEFT, Written
from coadjoint.render.strict import make_environment
from coadjoint.render.sums import fit_paper, is_narrow, split_sides

FORMATS: Final = ("text", "latex", "html", "typst")
#: Columns of the text format; longer formulas go on under their right-hand side.
WIDTH: Final = 100
#: Columns that the text format leaves at the left of formulas.
INDENT: Final = 6
#: Lines of a section that stay below each other; more stand side by side where they are short.
LONG: Final = 24
#: Characters of MathML up to which rates stand on a page twice, in the lead and in their step.
REPEATED: Final = 20_000

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


def render_document(document: Mapping[str, Any], form: str = "text", width: int = WIDTH) -> str:
    """A derivation, ready to read.

    Args:
        document: The fields of a `coadjoint.derive.document.Document`.
        form: ``"text"``, ``"latex"``, ``"html"`` or ``"typst"``.
        width: Characters of a line of text; formulas without blanks may be longer.

    >>> section = {"title": "Momenta", "law": "mu = dl/dxi", "law_latex": ""}
    >>> section |= {"lines": (), "words": (), "table": (), "vectors": (), "rows": ()}
    >>> top = {"title": "A top", "about": "System top.", "source": "", "description": ""}
    >>> print(render_document({**top, "sections": [section]}))
    A top
    =====
    System top.
    <BLANKLINE>
    1. Momenta
       mu = dl/dxi
    <BLANKLINE>
    """
    filled = _fill(document)
    if form == "html":
        filled["sections"] = leave_out_repeated(filled["sections"])
    if form != "text":
        filled = set_prose(filled, form)
    template = _environment(form, width).get_template(f"document/{form}.j2")
    return template.render(document=filled)


def _fill(document: Mapping[str, Any]) -> dict[str, Any]:
    """A document with everything that templates ask for, which may be empty."""
    empty = {"vectors": (), "rows": (), "kind": "step", "lines": (), "words": (), "table": ()}
    empty |= {"theorem": "", "law_latex": ""}
    sections = [{**empty, **section} for section in document["sections"]]
    _mark_told(sections)
    heads = {"picture": "", "caption": "", "description": ""}
    return {**heads, **document, "sections": sections}


def _mark_told(sections: Sequence[dict[str, Any]]) -> None:
    """Mark components of the motion that steps have too: paper has no folds and needs them once."""
    told = {line["mathml"] for each in sections if each["kind"] == "step" for line in each["lines"]}
    for each in sections:
        lines = {line["mathml"] for line in each["lines"]}
        each["told_below"] = each["kind"] == "motion" and lines <= told


def leave_out_repeated(sections: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Sections of a page, on which long rates stand once and not twice.

    They are the components of the equations of motion, and what the last step gives. By vectors
    the former are read without them; else the step refers to them.
    """
    made = [dict(section) for section in sections]
    motion = next((each for each in made if each["kind"] == "motion"), None)
    if motion is None or sum(len(line["mathml"]) for line in motion["lines"]) < REPEATED:
        return made
    rates = {line["mathml"] for line in motion["lines"]}
    for step in made:
        if step["kind"] != "step" or not rates <= {line["mathml"] for line in step["lines"]}:
            continue
        if motion["vectors"]:
            motion["words"] = [*motion["words"], ("in components", f"see {step['title']}")]
            motion["lines"] = ()
            break
        step["lines"] = [line for line in step["lines"] if line["mathml"] not in rates]
        step["words"] = [*step["words"], ("rates", f"see {motion['title']}")]
    return made


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
        escape = _ESCAPES.get(form, _escape_html)
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
    return str(escape_html(make_printable(text)))


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


def render_fragment(
    sections: Sequence[Mapping[str, Any]], names: Mapping[str, Written] | None = None
) -> str:
    """Sections as HTML without a page around them.

    Args:
        sections: Those of a document.
        names: How some names are written, in addition to a table of symbols among the sections.
    """
    filled = set_prose(_fill({"sections": sections}), "html", names)["sections"]
    return _environment("html").get_template("document/fragment.html.j2").render(sections=filled)


def render_book(chapters: Sequence[Mapping[str, Any]]) -> str:
    """One page of many derivations, with a table of contents and a table of all proofs.

    Args:
        chapters: Documents in order with, in addition, ``name``, ``part``, ``routes``, ``marks``
            by route, and how many claims are ``proved``, and how many ``others`` there are.
    """
    filled = [_fill(chapter) for chapter in chapters]
    for n, chapter in enumerate(filled):
        chapter["sections"] = leave_out_repeated(chapter["sections"])
        filled[n] = set_prose(chapter, "html")
    contents = [
        {"title": part, "chapters": list(own)}
        for part, own in groupby(filled, key=lambda chapter: chapter["part"])
    ]
    routes = list(dict.fromkeys(route for chapter in filled for route in chapter["routes"]))
    template = _environment("html").get_template("document/book.html.j2")
    return template.render(chapters=filled, parts_of_book=contents, routes=routes)


@cache
def _environment(form: str, width: int = WIDTH) -> ImmutableSandboxedEnvironment:
    """The environment of a format: everything printed is escaped, unless marked safe."""
    delimiters = {"variable_start_string": "<<", "variable_end_string": ">>"} | {
        "block_start_string": "<%",
        "block_end_string": "%>",
        "comment_start_string": "<#",
        "comment_end_string": "#>",
    }
    made = make_environment(
        autoescape=form == "html",
        finalize=_escape_unless_safe(_ESCAPES.get(form, make_printable)),
        **(delimiters if form == "latex" else {}),  # braces are LaTeX's own
    )
    made.filters |= {
        "aligned": partial(align, width=width),
        "columns": choose_columns,
        "abreast": count_abreast,
        "described": partial(describe, width=width),
        "fit": fit_paper,
        "listed": partial(list_rows, width=width),
        "law": write_law,
        "narrow": is_narrow,
        "sides": split_sides,
        "tabulated": tabulate,
        "wrapped": partial(wrap, width=width),
    }
    return made


def _escape_unless_safe(escape: Callable[[str], str]) -> Callable[[Any], Any]:
    """``escape`` for every printed value that no template has marked as safe."""
    return lambda value: value if isinstance(value, Markup) else escape(str(value))


def make_printable(text: str) -> str:
    r"""Text without control characters, which a terminal would obey.

    >>> make_printable("a\x1b[2Jb\nc")
    'a [2Jb c'
    """
    return "".join(character if character.isprintable() else " " for character in text)


def escape_latex(text: str) -> str:
    r"""Text in which LaTeX sees no command.

    >>> escape_latex(r"\write18{rm}")
    '\\textbackslash{}write18\\{rm\\}'
    """
    return make_printable(text).translate(_LATEX_ESCAPES)


_TYPST_ESCAPES: Final = str.maketrans({c: f"\\{c}" for c in "\\#*_`$<>@[]=-+/~"})


def escape_typst(text: str) -> str:
    r"""Text in which Typst sees no command.

    >>> escape_typst("#read('x')")
    "\\#read('x')"
    """
    return make_printable(text).translate(_TYPST_ESCAPES)


_ESCAPES: Final[Mapping[str, Callable[[str], str]]] = {
    "latex": escape_latex,
    "typst": escape_typst,
}


def write_law(section: Mapping[str, Any]) -> Markup | str:
    """The general law of a section: a formula where it is one that is known, else its words."""
    if is_formula(section["law_latex"], section["law"]):
        maths = to_mathml(section["law_latex"])
        if maths is not None:
            return Markup(maths)  # noqa: S704 - made of elements alone, its letters escaped
    law: str = section["law"]
    return law


def list_rows(rows: Sequence[Sequence[Any]], width: int = WIDTH) -> list[str]:
    """Rows of words in columns, wrapped where a line would be longer than there is room.

    >>> list_rows([["name", "unit"], ["m", "kg"]])
    ['name  unit', 'm     kg']
    """
    texts = [[cell["text"] if isinstance(cell, Mapping) else str(cell) for cell in r] for r in rows]
    if any(isinstance(row[0], Mapping) for row in rows):
        texts = [row[1:] for row in texts]  # a symbol is its name in text
    widths = [max(len(row[n]) for row in texts) for n in range(len(texts[0]))]
    columns = zip(*texts, strict=True)
    words = [max(map(len, " ".join(column).split()), default=0) for column in columns]
    while sum(widths) + 2 * len(widths) > max(width - INDENT, 3 * len(widths)):
        wide = [n for n, most in enumerate(widths) if most > words[n]] or range(len(widths))
        widths[max(wide, key=widths.__getitem__)] -= 1
    listed = list[str]()
    for row in texts:
        cells = [textwrap.wrap(cell, most) or [""] for cell, most in zip(row, widths, strict=True)]
        for n in range(max(map(len, cells))):
            parts = [c[n] if n < len(c) else "" for c in cells]
            line = "  ".join(part.ljust(w) for part, w in zip(parts, widths, strict=True))
            listed.append(line.rstrip())
    return listed


def choose_columns(rows: Sequence[Sequence[Any]]) -> str:
    r"""The columns of a table in LaTeX, long cells wrapped: each has room by its longest cell.

    >>> choose_columns([["name", "unit"], ["m", "kg"]])
    'll'
    >>> choose_columns([["name", "meaning"], ["m", "mass " * 40]]).count("raggedright")
    2
    """
    widths = [max(map(_measure, column)) for column in zip(*rows, strict=True)]
    room = WIDTH - 2 * len(widths)
    if sum(widths) <= room:
        return "l" * len(widths)
    # no column takes more than half of the line, and 6 % are left for the gaps between them
    widths = [max(6, min(width, room // 2)) for width in widths]
    shares = [0.94 * width / sum(widths) * room / WIDTH for width in widths]
    return "".join(
        rf">{{\raggedright\arraybackslash}}p{{{share:.3f}\linewidth}}" for share in shares
    )


def _measure(cell: Any) -> int:
    """The characters of a cell, as plain text."""
    if isinstance(cell, Prose):
        return len(cell.plain)
    return len(cell["text"] if isinstance(cell, Mapping) else str(cell))


def wrap(text: str, indent: int = 0, width: int = WIDTH) -> list[str]:
    r"""A paragraph in lines of the text format, whatever its own line breaks.

    >>> wrap("one\ntwo")
    ['one two']
    """
    return textwrap.wrap(
        text,
        max(width - indent, 1),
        subsequent_indent=" " * indent,
        break_long_words=False,
        break_on_hyphens=False,
    )


def align(lines: Sequence[Mapping[str, str]], width: int = WIDTH) -> list[str]:
    """Lines ``left = right`` with their equals signs in one column, long ones continued.

    Many short lines stand in several such columns, to be read down.

    >>> align([{"text": "a = 1"}, {"text": "long = 2"}])
    ['a    = 1', 'long = 2']
    """
    rows = _columns([line["text"].split(" = ", 1) for line in lines], " = ", width)
    number = count_abreast(lines, width)
    if number == 1:
        return rows
    height = -(-len(rows) // number)
    cell = (width - INDENT) // number
    return ["".join(row.ljust(cell) for row in rows[n::height]).rstrip() for n in range(height)]


def count_abreast(lines: Sequence[Mapping[str, str]], width: int = WIDTH) -> int:
    """How many lines of a section stand side by side: one, unless they are many and short.

    >>> count_abreast([{"text": "a = 1"}] * 9), count_abreast([{"text": "[E12, E13] = -E23"}] * 90)
    (1, 4)
    """
    if len(lines) <= LONG:
        return 1
    widest = max(len(line["text"]) for line in lines)
    return max(1, min(4, (width - INDENT) // (widest + 3)))


def tabulate(rows: Sequence[Sequence[Mapping[str, str]]]) -> list[str]:
    """A table with a line under its heads.

    >>> tabulate([[{"text": t} for t in row] for row in (("", "H", "X"), ("H", ".", "2*X"))])
    ['   |   H   X', '---+--------', ' H |   . 2*X']
    """
    first = max(len(row[0]["text"]) for row in rows)
    width = max(len(cell["text"]) for row in rows for cell in row[1:])
    texts = [
        f" {row[0]['text']:<{first}} |" + "".join(f" {cell['text']:>{width}}" for cell in row[1:])
        for row in rows
    ]
    rule = "-" * (first + 2) + "+" + "-" * (max(map(len, texts)) - first - 3)
    return [texts[0], rule, *texts[1:]]


def describe(words: Sequence[Sequence[str]], width: int = WIDTH) -> list[str]:
    """Names with what is said of them in a second column, long texts continued.

    >>> describe([("rank", "2"), ("Killing form", "3 minus")])
    ['rank          2', 'Killing form  3 minus']
    """
    return _columns(words, "  ", width)


def _columns(sides: Sequence[Sequence[str]], joint: str, width: int) -> list[str]:
    """Two columns, the second one wrapped; below a left side that is long the right one stands."""
    longest = min(LONG_LEFT, (width - INDENT) // 2)
    first = max((len(left) for left, _ in sides if len(left) <= longest), default=0)
    listed = list[str]()
    for left, right in sides:
        if len(left) > longest:
            listed += _wrap_columns(left, 2, width)
            listed += _wrap_columns(f"  {joint.strip()} {right}", 4, width)
        else:
            listed += _wrap_columns(f"{left:<{first}}{joint}{right}", first + len(joint), width)
    return listed


def _wrap_columns(text: str, indent: int, width: int) -> list[str]:
    """A line of columns, its further lines behind some blanks."""
    return textwrap.wrap(
        text,
        width - INDENT,
        subsequent_indent=" " * indent,
        break_long_words=False,
        break_on_hyphens=False,
    )
