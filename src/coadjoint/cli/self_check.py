"""The check of a system as a command: ``python -m coadjoint.systems.NAME --check``.

Comes in: a System and arguments. Goes out: a table of its methods, measured; the exit status is 1
where a run contradicts what is claimed, and 2 where arguments are wrong.
Read next: `coadjoint.solve.self_check`.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from coadjoint.cli.output import print_table, say
from coadjoint.errors import CoadjointError
from coadjoint.methods import tell_order
from coadjoint.solve.self_check import Measured, check_methods

if TYPE_CHECKING:
    from coadjoint.solve.system import System


def main(system: System, package: str, arguments: Sequence[str] | None = None) -> int:
    """Measure the methods of a system; the exit status.

    Args:
        system: The System.
        package: The name under which it was run.
        arguments: Those of the command line; None for its own.
    """
    parser = argparse.ArgumentParser(
        prog=f"python -m {package}",
        description=f"The system {system.name}. With --check its methods that keep structure are "
        "run: order, distance from a Poisson map, and drift of integrals.",
    )
    parser.add_argument(
        "--check",
        nargs="*",
        metavar="METHOD",
        help="the methods to run, or all; without a name those that method='auto' takes",
    )
    given = parser.parse_args(arguments)
    if given.check is None:
        parser.print_usage(sys.stderr)
        return 2
    try:
        found = list(check_methods(system, given.check or None))
    except CoadjointError as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return 2
    if not found:
        say(f"No method that keeps structure applies to {system.name}: nothing to check.")
        return 0
    columns = ("method", ">order", ">measured", ">Poisson defect", "drift of what is kept",
               "drift of the rest", "result")  # fmt: skip
    print_table(columns, list(map(_row, found)), f"Methods of {system.name}, on runs")
    wrong = [each for each in found if each.failures]
    compared = sum(each.compared for each in found)
    numbers = "1 number was" if compared == 1 else f"{compared} numbers were"
    say(f"{len(found) - len(wrong)} of {len(found)} methods do what is claimed; {numbers} compared "
        "with claims.")  # fmt: skip
    for each in wrong:
        say(f"{each.method.name}: {'; '.join(each.failures)}.")
    return int(bool(wrong) or not compared)


def _row(each: Measured) -> tuple[str, ...]:
    """A line of the table."""
    kept = {name: each.drifts[name] for name in each.method.exactly if name in each.drifts}
    kept |= {name: max(0.0, missed) for name, missed in each.laws.items()}
    rest = {name: x for name, x in each.drifts.items() if name not in kept}
    return (
        each.method.name,
        tell_order(each.method.name, each.method.order),
        "rounding" if each.order is None else f"{each.order:.1f}",
        "-" if each.defect is None else f"{each.defect:.0e}",
        _list(kept),
        _list(rest),
        "failed" if each.failures else "as claimed",
    )


def _list(drifts: dict[str, float]) -> str:
    """Drifts by name: ``energy 2e-15``."""
    return ", ".join(f"{name} {drift:.0e}" for name, drift in drifts.items()) or "-"
