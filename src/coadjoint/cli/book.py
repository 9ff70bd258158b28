"""Command ``book``: all systems as one page, in the order of Holm's book, with a table of proofs.

Comes in: names of systems, by default all that are shipped. Goes out: a page of HTML. Read next:
`coadjoint.cli.show`, which makes a chapter.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import click

from coadjoint.cli.arguments import seconds_option, shipped_names
from coadjoint.cli.output import progress_bars, say, write_text
from coadjoint.cli.show import make_chapter

#: Chapters of D. D. Holm, Geometric Mechanics, Part II, 2nd edition (2011).
CHAPTERS: Final = (
    "Galileo",
    "Newton, Lagrange, Hamilton and the rigid body",
    "Quaternions",
    "Adjoint and coadjoint actions",
    "The special orthogonal group SO(3)",
    "Adjoint and coadjoint semidirect-product group actions",
    "Euler-Poincare and Lie-Poisson equations on SE(3)",
    "Heavy-top equations",
    "The Euler-Poincare theorem",
    "Lie-Poisson Hamiltonian form of a continuum spin chain",
    "Momentum maps",
    "Round, rolling rigid bodies",
)
_PLACE = re.compile(
    r"Geometric Mechanics II\b.*?\b(section|sections|chapter|appendix) (\d+|[A-Z])(?:\.(\d+))?"
)


@click.command("book")
@click.argument("names", metavar="[SYSTEM]...", nargs=-1)
@click.option(
    "--output",
    type=click.Path(path_type=Path),
    default=Path("book.html"),
    show_default=True,
    help="Page to write.",
)
@seconds_option
def command(names: Sequence[str], output: Path, seconds: int | None) -> None:
    """Write a book of all systems, or of some, as one page."""
    from coadjoint.render.document import render_book

    chapters = list[dict[str, Any]]()
    wanted = list(names) or shipped_names()
    with progress_bars() as progress:
        for done, name in enumerate(wanted):
            progress("book", name, done, len(wanted))
            chapters.append(describe(name, make_chapter(name, None, "html", seconds=seconds)))
    chapters.sort(key=lambda chapter: (chapter["place"], chapter["title"]))
    write_text(output, render_book(chapters))
    say(f"{output}: {len(chapters)} systems")


def describe(name: str, record: Mapping[str, Any]) -> dict[str, Any]:
    """A chapter with its place in the book, and with the verdicts of its routes."""
    rows = [
        row for part in record["sections"] if part.get("kind") == "verdicts" for row in part["rows"]
    ]
    verdicts = Counter(verdict for _, verdict, _ in rows[1:])
    routes = _routes(record)
    place = find_place(record["source"])
    return {
        **record,
        "name": Path(name).stem,
        "place": place,
        "part": _title_of(place[0]),
        "routes": routes,
        "marks": mark_routes(routes, rows[1:]),
        "proved": verdicts["proved"],
        "others": verdicts.total() - verdicts["proved"],
    }


def _routes(record: Mapping[str, Any]) -> list[str]:
    """The routes of a system, the one of its code first."""
    for part in record["sections"]:
        if part.get("kind") == "principle":
            words = dict(part["words"])
            others = words.get("proved equal to", "")
            return [words["route"], *filter(None, others.split(", "))]
    return []


def mark_routes(routes: Sequence[str], rows: Sequence[Sequence[str]]) -> dict[str, str]:
    """A mark for each route: the code's own, proved equal to it, or neither.

    >>> rows = [("a and b give the same motion, through the map of c", "proved", "normal form")]
    >>> mark_routes(["a", "b", "c"], rows)
    {'a': '1', 'b': '=', 'c': '?'}
    """
    same = [
        statement.partition(", through")[0]
        for statement, verdict, _ in rows
        if verdict == "proved" and "the same motion" in statement
    ]
    proved = {
        route
        for route in routes
        if any(re.search(rf"(?<![\w-]){re.escape(route)}(?![\w-])", each) for each in same)
    }
    marks = {route: "=" if route in proved else "?" for route in routes}
    return marks | dict.fromkeys(routes[:1], "1")


def find_place(source: str) -> tuple[int, int]:
    """Chapter and section of the book; those of appendices and other sources come last.

    >>> find_place("Holm (2011), Geometric Mechanics II, 2nd ed., sections 8.1 to 8.3")
    (8, 1)
    >>> find_place("Kirchhoff (1876), lecture 20")
    (99, 0)
    """
    found = _PLACE.search(source)
    if found is None:
        return 99, 0
    _, chapter, own = found.groups()
    number = int(chapter) if chapter.isdigit() else 50 + ord(chapter) - ord("A")
    return number, int(own or 0)


def _title_of(chapter: int) -> str:
    """The heading of a part of the contents."""
    if chapter <= len(CHAPTERS):
        return f"{chapter}. {CHAPTERS[chapter - 1]}"
    return "Other sources" if chapter == 99 else f"Appendix {chr(chapter - 50 + ord('A'))}"
