"""Render, documents: a derivation as plain text, as a LaTeX file or as a web page.

Comes in: a `coadjoint.derive.document.Document` as plain JSON values, so that it may come from a
child process. Goes out: text. Titles and sources are free text of a spec: each format escapes
whatever a template prints, unless the template marks a formula as safe, and formulas are made of
restricted names only.
Read next: `templates/document/text.j2`, the shortest of the three.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from itertools import groupby
from typing import Any, Final

from jinja2.sandbox import ImmutableSandboxedEnvironment
from markupsafe import Markup

from coadjoint.errors import make_printable
from coadjoint.notation.tex import is_formula, to_mathml
from coadjoint.notation.written import LONG_LEFT, Written
from coadjoint.render.prose import ESCAPES, Prose, set_prose
from coadjoint.render.strict import make_environment
from coadjoint.render.sums import break_inline, fit_paper, fit_phone, is_narrow, split_sides

#: Columns of the text format; longer formulas go on under their right-hand side.
WIDTH: Final = 100
#: Columns that the text format leaves at the left of formulas.
INDENT: Final = 6
#: Lines of a section that stay below each other; more stand side by side where they are short.
LONG: Final = 24
#: Characters of a column of words in text, at the least, and of a line with two columns of them.
COLUMN: Final = 14
TWO_COLUMNS: Final = 64
#: A blank at which no line ends: no text has this character, which no terminal would show.
_KEPT: Final = "\x00"
#: Characters of MathML up to which rates stand on a page twice, in the lead and in their step.
REPEATED: Final = 20_000


def render_document(document: Mapping[str, Any], form: str = "text", width: int = WIDTH) -> str:
    """A derivation, ready to read.

    Args:
        document: The fields of a `coadjoint.derive.document.Document`.
        form: ``"text"``, ``"latex"``, ``"html"`` or ``"typst"``.
        width: Characters of a line of text; names may be longer.

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
        finalize=_escape_unless_safe(ESCAPES.get(form, make_printable)),
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
        "with_phones": lambda lines: zip(lines, fit_phone(lines), strict=True),
        "sides": split_sides,
        "tabulated": partial(tabulate, width=width),
        "wrapped": partial(wrap, width=width),
    }
    return made


def _escape_unless_safe(escape: Callable[[str], str]) -> Callable[[Any], Any]:
    """``escape`` for every printed value that no template has marked as safe."""
    return lambda value: value if isinstance(value, Markup) else escape(str(value))


def write_law(section: Mapping[str, Any]) -> Markup | str:
    """The general law of a section: a formula where it is one that is known, else its words."""
    if is_formula(section["law_latex"], section["law"]):
        maths = to_mathml(section["law_latex"])
        if maths is not None:
            return Markup(break_inline(maths))  # noqa: S704 - made of elements alone, its letters escaped
    law: str = section["law"]
    return law


def list_rows(rows: Sequence[Sequence[Any]], width: int = WIDTH) -> list[str]:
    """Rows of words in columns, wrapped where a line would be longer than there is room.

    Where a line has no room for columns, each row is an entry with its heads before its cells.

    >>> list_rows([["name", "unit"], ["m", "kg"]])
    ['name  unit', 'm     kg']
    >>> list_rows([["claim", "verdict"], ["the energy is conserved", "proved"]], 28)
    ['the energy is', 'conserved', '  verdict: proved']
    """
    texts = [[cell["text"] if isinstance(cell, Mapping) else str(cell) for cell in r] for r in rows]
    if any(isinstance(row[0], Mapping) for row in rows):
        texts = [row[1:] for row in texts]  # a symbol is its name in text
    room, columns = width - INDENT, [*zip(*texts, strict=True)]
    widths = [max(map(len, column)) for column in columns]
    words = [max(map(len, " ".join(column).split()), default=0) for column in columns]
    least = [max(word, min(most, COLUMN)) for word, most in zip(words, widths, strict=True)]
    if sum(least) + 2 * (len(least) - 1) > room:
        return [line for row in texts[1:] for line in _list_entry(texts[0], row, room)]
    while sum(widths) + 2 * (len(widths) - 1) > room:
        wide = [n for n, most in enumerate(widths) if most > least[n]]
        widths[max(wide, key=widths.__getitem__)] -= 1
    listed = list[str]()
    for row in texts:
        cells = [textwrap.wrap(cell, most) or [""] for cell, most in zip(row, widths, strict=True)]
        for n in range(max(map(len, cells))):
            parts = [c[n] if n < len(c) else "" for c in cells]
            line = "  ".join(part.ljust(w) for part, w in zip(parts, widths, strict=True))
            listed.append(line.rstrip())
    return listed


def _list_entry(heads: Sequence[str], row: Sequence[str], room: int) -> list[str]:
    """A row of a table without columns: its first cell, and the others below it by their heads."""
    first, *others = row
    told = [f"  {head}: {cell}" for head, cell in zip(heads[1:], others, strict=True) if cell]
    return [*wrap(first, 0, room), *(line for each in told for line in wrap(each, 4, room))]


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


def wrap(text: str, indent: int = 0, room: int = 0, width: int = WIDTH) -> list[str]:
    r"""A paragraph in lines of the text format, whatever its own line breaks.

    Args:
        text: The paragraph.
        indent: Blanks before its lines but the first.
        room: Characters of a line; 0 for those of the page less the indent.
        width: Characters of a line of the page.

    >>> wrap("one\ntwo")
    ['one two']
    """
    most = max(room or width - indent, 1)
    return textwrap.wrap(
        _break_products(text, most - indent),
        most,
        subsequent_indent=" " * indent,
        break_long_words=False,
        break_on_hyphens=False,
    )


def _break_products(text: str, room: int) -> str:
    """A text in which products that are longer than a line have blanks behind some of their signs.

    >>> _break_products("x = a11*b22*c33/(d44*e55)", 8)
    'x = a11*b22* c33/ (d44* e55)'
    """
    words = text.split(" ")
    for n, word in enumerate(words):
        if len(word) <= room:
            continue
        parts = [""]
        for factor in re.findall(r"[^*/]+[*/]*|[*/]+", word):
            if parts[-1] and len(parts[-1] + factor) > room:
                parts.append("")
            parts[-1] += factor
        words[n] = " ".join(parts)
    return " ".join(words)


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


def tabulate(rows: Sequence[Sequence[Mapping[str, str]]], width: int = WIDTH) -> list[str]:
    """A table with a line under its heads; on a narrow page in blocks of columns.

    Where not even one column has room, its entries but 0 are lines, with both heads before them.

    >>> table = [[{"text": t} for t in row] for row in (("", "H", "X"), ("H", ".", "2*X"))]
    >>> tabulate(table)
    ['   |   H   X', '---+--------', ' H |   . 2*X']
    >>> tabulate(table, 14)
    ['   |   H', '---+----', ' H |   .', '', '   |   X', '---+----', ' H | 2*X']
    >>> tabulate(table, 13)
    ['H, X:', '    2*X']
    """
    heads, *others = [[cell["text"] for cell in row] for row in rows]
    first = max(len(row[0]) for row in (heads, *others))
    cell = max(len(text) for row in (heads, *others) for text in row[1:])
    number = (width - INDENT - first - len("  |")) // (cell + 1)
    if number < 1:
        told = [
            f"{row[0]}, {head}: {text}"
            for row in others
            for head, text in zip(heads[1:], row[1:], strict=True)
            if text not in ("0", ".")
        ]
        return [line for each in told for line in wrap(each, 4, width - INDENT)]
    listed = list[str]()
    for start in range(1, len(heads), number):
        block = [[row[0], *row[start : start + number]] for row in (heads, *others)]
        texts = [
            f" {head:<{first}} |" + "".join(f" {text:>{cell}}" for text in entries)
            for head, *entries in block
        ]
        rule = "-" * (first + 2) + "+" + "-" * (len(texts[0]) - first - 3)
        listed += [*([""] if listed else []), texts[0], rule, *texts[1:]]
    return listed


def describe(words: Sequence[Sequence[str]], width: int = WIDTH) -> list[str]:
    """Names with what is said of them in a second column, long texts continued.

    On a narrow page a text that has no room behind its name stands below it.

    >>> describe([("rank", "2"), ("Killing form", "3 minus")])
    ['rank          2', 'Killing form  3 minus']
    >>> describe([("rank", "2"), ("theorem", "that of Euler and Poincare")], 36)
    ['rank  2', 'theorem', '  that of Euler and Poincare']
    """
    if width >= TWO_COLUMNS:
        return _columns(words, "  ", width)
    room, listed = width - INDENT, list[str]()
    for left, right in words:
        if len(whole := f"{left}  {right}".rstrip()) <= room:
            listed.append(whole)
        else:
            listed += [*wrap(left, 2, room), *wrap(f"  {right}", 2, room)]
    return listed


def _columns(sides: Sequence[Sequence[str]], joint: str, width: int) -> list[str]:
    """Two columns, the second one wrapped; a right side stands below a left one that is long.

    So does one with a word that has no room behind the first column.
    """
    room = width - INDENT
    longest = min(LONG_LEFT, room // 2)
    first = max((len(left) for left, _ in sides if len(left) <= longest), default=0)
    listed = list[str]()
    for left, right in sides:
        word = max(map(len, right.split()), default=0)
        if len(left) > longest or first + len(joint) + word > room:
            listed += wrap(left, 2, room)
            listed += wrap(f"  {joint.strip()} {right}", 4, room)
        else:
            indent = first + len(joint)
            whole = f"{left:<{first}}{joint}{_keep_brackets(right, (room - indent) // 2)}"
            listed += [line.replace(_KEPT, " ") for line in wrap(whole, indent, room)]
    return listed


def _keep_brackets(text: str, most: int) -> str:
    """A text whose short brackets have blanks at which no line ends.

    >>> _keep_brackets("a x (b, c)", 9).replace(_KEPT, "_")
    'a x (b,_c)'
    """
    return re.sub(
        r"\([^()]*\)", lambda m: m[0].replace(" ", _KEPT) if len(m[0]) <= most else m[0], text
    )
