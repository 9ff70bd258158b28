"""Command ``crosscheck``: the ladder's numeric rungs on the files as they stand, with figures.

Comes in: a spec and its generated files. Goes out: for each function and target the error against
50 digits and the points at which it has the same bits as NumPy. Read next:
`coadjoint.crosscheck.ladder`.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from coadjoint import limits
from coadjoint.budget import allowed_seconds
from coadjoint.cli.arguments import load_system, seconds_option, spec_path, system_argument
from coadjoint.cli.output import json_option, print_json, print_table, say
from coadjoint.errors import OutputError
from coadjoint.sandbox_child import prepared_by, report_progress

if TYPE_CHECKING:
    from coadjoint.spec import Spec


@click.command("crosscheck")
@system_argument
@click.option(
    "--points",
    type=click.IntRange(1, 10_000_000),
    default=200_000,
    show_default=True,
    help="Least number of points at which NumPy and C are compared bit for bit. Of equal members "
    "and fields there are a few points for each of some numbers of members.",
)
@seconds_option
@json_option
def command(system: str, points: int, seconds: int | None, as_json: bool) -> None:
    """Compare kernels with 50 digits and with each other."""
    from coadjoint.sandbox import run_bounded

    path, folder = spec_path(system), load_system(system, seconds).folder
    report = run_bounded(
        "coadjoint.cli.crosscheck:report_record",
        {"path": str(path), "folder": str(folder), "points": points},
        seconds=allowed_seconds(seconds),
        memory=limits.WORKER_BYTES,
        subject=str(path),
    )
    if as_json:
        print_json(report)
    else:
        _print(report)


@prepared_by("coadjoint.pipeline:prepare")
def report_record(argument: Mapping[str, Any]) -> dict[str, Any]:
    """Figures of the ladder as JSON values; runs in a bounded child."""
    from coadjoint.crosscheck.ladder import crosscheck
    from coadjoint.derive import derive
    from coadjoint.derive.reference import Reference
    from coadjoint.lower.lowering import lower
    from coadjoint.lower.mapped import lower_maps
    from coadjoint.render.targets import TARGETS
    from coadjoint.solve.folders import load_folder
    from coadjoint.solver_kinds import FILES, list_kinds
    from coadjoint.spec import read_spec

    folder, spec = Path(argument["folder"]), read_spec(Path(argument["path"]))
    report_progress("derive", 0, 2)
    if spec.family is not None or spec.space is not None:
        return _report_members(spec, folder)
    equations = derive(spec)
    programs = lower(equations)
    missing = set(FILES).difference(*(kind.files for kind in list_kinds(programs)))
    files = [file for target in TARGETS.values() for file in target.files if file not in missing]
    texts = {file: _text(folder / file) for file in files}
    report_progress("compile and cross-check", 1, 2)
    report = crosscheck(
        programs,
        texts,
        Reference(equations),
        load_folder(folder),
        bit_points=argument["points"],
        maps=lower_maps(equations, programs["rhs"]).programs,
    )
    return report.as_record()


def _report_members(spec: Spec, folder: Path) -> dict[str, Any]:
    """The same of equal members or fields, for some numbers of these."""
    from coadjoint import pipeline
    from coadjoint.crosscheck.families import crosscheck_family
    from coadjoint.solve.folders import load_folder

    rendered = pipeline.render(spec)
    own = rendered.family
    assert own is not None, spec.name
    texts = {file: _text(folder / file) for file in rendered.texts}
    report_progress("compile and cross-check", 1, 2)
    return crosscheck_family(own, texts, load_folder(folder)).as_record()


def _text(path: Path) -> str:
    """A generated file.

    Raises:
        OutputError: It cannot be read.
    """
    try:
        return path.read_text("utf-8")
    except OSError as error:
        raise OutputError(
            f"{path} cannot be read: {error.strerror}. Run `coadjoint regenerate`.", path=str(path)
        ) from error


def _print(report: Mapping[str, Any]) -> None:
    """The figures as a table, and the rungs below it."""
    rows = [
        (
            function,
            target,
            f"{figures['k']:.2f}",
            f"{figures['ulp']:.3g}",
            str(figures["points"]),
            _compare_with_numpy(report, function, target),
        )
        for function, targets in report["figures"].items()
        for target, figures in targets.items()
    ]
    columns = ("function", "target", ">k", ">ulp", ">points", ">with NumPy")
    print_table(columns, rows, title=f"Cross-check of {report['system']}")
    for kind, figures in report["solvers"].items():
        _print_solvers(kind, figures)
    for rung, status in report["rungs"].items():
        say(f"rung {rung}: {status}")
    say(f"k: error in units of 2^-53 of the envelope; allowed {report['threshold']:g}")


def _print_solvers(kind: str, figures: Mapping[str, Any]) -> None:
    """What was compared of the solvers of a kind, by the name of their files."""
    say(
        f"{kind}.c, {kind}.py: {figures['coefficients']} coefficients and {figures['lines']} lines "
        f"compared, {figures['choices']} lengths of steps"
    )
    for method, targets in figures["steps"].items():
        worst = ", ".join(f"{target} k {each['k']:.2f}" for target, each in targets.items())
        equal, together = (figures[name].get(method, 0) for name in ("equal", "together"))
        bits = f"; same bits of {equal} numbers" if equal else ""
        bits = f"; within the bound at {together} members" if together else bits
        say(f"{method}: {worst}{bits}")


def _compare_with_numpy(report: Mapping[str, Any], function: str, target: str) -> str:
    """Where a target and NumPy agree: bit for bit, or within k with functions beyond sqrt."""
    equal = report["equal"].get(function, {}).get(target, 0)
    together = report["together"].get(function, {}).get(target, 0)
    return f"same bits at {equal}" if equal else f"within k at {together}" if together else ""
