"""Results: what a benchmark measured, as JSON, as a table, and as a plot of time over error.

Comes in: points, figures and what they were measured with. Goes out: files in `results/`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from os import getloadavg
from pathlib import Path
from typing import Any

from figures import VERDICTS, Figure
from run import processor

from coadjoint.build.compiler import find_compiler

FOLDER = Path(__file__).parent / "results"


@dataclass(frozen=True)
class Point:
    """A competitor at one tolerance.

    Attributes:
        who: The competitor.
        tolerance: Its tolerance; None for its own.
        order: Of its method; 0 where it has none.
        microseconds: Processor time for each member: median, fastest, slowest round.
        error: Median of the relative errors.
        worst: The largest of them.
    """

    who: str
    tolerance: float | None
    order: int
    microseconds: tuple[float, float, float]
    error: float
    worst: float


@dataclass(frozen=True)
class Table:
    """Numbers that figures follow from.

    Attributes:
        title: What they are.
        columns: What stands in each column; the first has names.
        rows: Names and values.
    """

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Any]]


def write(
    stem: str,
    setting: Mapping[str, Any],
    points: Sequence[Point],
    figures: Sequence[Figure],
    tables: Sequence[Table] = (),
) -> None:
    """JSON, Markdown and, where there are points, a plot.

    Args:
        stem: Name of the files without their endings.
        setting: What was measured, by name.
        points: Competitors.
        figures: What follows from them.
        tables: More of what was measured.
    """
    FOLDER.mkdir(exist_ok=True)
    machine = {
        "machine": processor(),
        "busy": f"{getloadavg()[0]:.1f} processes wanted a processor",
        "compiler": find_compiler().version,
    }
    record = {
        **setting,
        **machine,
        "tables": [asdict(table) for table in tables],
        "points": [asdict(point) for point in points],
        "figures": [asdict(figure) for figure in figures],
    }
    path = FOLDER / stem
    path.with_suffix(".json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    text = markdown(stem, {**setting, **machine}, points, figures, tables)
    path.with_suffix(".md").write_text(text, encoding="utf-8")
    if points:
        plot(stem, points, path.with_suffix(".png"))


def markdown(
    title: str,
    setting: Mapping[str, Any],
    points: Sequence[Point],
    figures: Sequence[Figure],
    tables: Sequence[Table],
) -> str:
    """The tables."""
    lines = [
        f"# {title.replace('_', ' ')}",
        "",
        *(f"- {name}: {value}" for name, value in setting.items()),
        "",
    ]
    if points:
        lines += [
            "| competitor | tolerance | order | us a member | fastest | slowest | error | worst |",
            "|---|---|---|---|---|---|---|---|",
        ]
    for point in points:
        own = "its own" if point.tolerance is None else f"{point.tolerance:g}"
        times = " | ".join(f"{each:.2f}" for each in point.microseconds)
        ends = f"{point.error:.1e} | {point.worst:.1e}"
        lines.append(f"| {point.who} | {own} | {point.order} | {times} | {ends} |")
    lines += [""] * bool(points) + ["| figure | target | measured | |", "|---|---|---|---|"]
    lines += [f"| {f.what} | {f.target} | {f.measured} | {VERDICTS[f.met]} |" for f in figures]
    for table in tables:
        lines += ["", f"## {table.title}", "", f"| {' | '.join(table.columns)} |"]
        lines += ["|" + "---|" * len(table.columns)]
        lines += [f"| {' | '.join(map(str, row))} |" for row in table.rows]
    return "\n".join(lines) + "\n"


def plot(title: str, points: Sequence[Point], path: Path) -> None:
    """Time over error, where matplotlib is installed."""
    try:
        from matplotlib.figure import Figure as Canvas
    except ImportError:
        print(f"{path.name} is not drawn: matplotlib is not installed")
        return
    canvas = Canvas(figsize=(6, 4.5), layout="constrained")
    axes = canvas.add_subplot()
    for who in dict.fromkeys(point.who for point in points):
        some = sorted((p for p in points if p.who == who), key=lambda p: p.error)
        axes.loglog(
            [p.error for p in some], [p.microseconds[0] for p in some], marker="o", label=who
        )
    axes.set(xlabel="median relative error", ylabel="processor time of a member (us)")
    axes.set_title(title.replace("_", " "))
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    canvas.savefig(path, dpi=120)
