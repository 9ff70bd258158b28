"""Lowering undone: a Program run on exact elements gives back the equations it came from.

Comes in: Equations and a Program. Goes out: nothing, or an error that names the output. This is the
second rung of the ladder: sharing, factoring and naming may not change a single value.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from functools import partial
from itertools import islice
from typing import Any

from coadjoint.derive import Equations
from coadjoint.derive.formulas import rows_of
from coadjoint.derive.mechanics.iteration import SETTLE, SETTLE_LAST
from coadjoint.derive.reference import Reference
from coadjoint.errors import CrossCheckError, LimitError
from coadjoint.exact import Element
from coadjoint.exact.linear import primes
from coadjoint.exact.residues import Residue, draw, residue
from coadjoint.limits import C_STATEMENTS, OPERATIONS, TABLE_ENTRIES
from coadjoint.lower.evaluation import run
from coadjoint.lower.program import LEVELS, ZERO, Output, Program, count_loop
from coadjoint.lower.vanishing import find_vanishing

#: Points modulo a prime at which Programs without a closed form are compared.
POINTS = 3
#: Points that are tried, each modulo another prime.
TRIES = 30
#: An output by its place, with what the Program computes and what the equations say.
_Pair = tuple[int, Output, Any, Any]


def expected_outputs(equations: Equations, name: str) -> list[Element]:
    """What a Program must compute, in state and parameters alone, straight from the equations."""
    assert not equations.kept, "velocities that the kernel solves for have no closed form"
    rows = rows_of(equations, name)
    assert rows is not None, name
    values = [rows.of.close(element) for element in rows.elements]
    if not rows.by:
        return values
    return [slope for value in values for slope in rows.of.setting.field.gradient(value, rows.by)]


def check_programs(equations: Equations, programs: Mapping[str, Program]) -> None:
    """Hold each function to the equations that it was lowered from.

    Raises:
        CrossCheckError: Lowering changed a value.
    """
    for program in programs.values():
        check_inverse(equations, program)


def check_sizes(equations: Equations, programs: Mapping[str, Program]) -> None:
    """Hold each function to the limits of size.

    Raises:
        LimitError: One is too large.
    """
    for program in programs.values():
        check_size(equations, program)


def check_size(equations: Equations, program: Program) -> None:
    """Refuse what a compiler would need minutes for.

    Raises:
        LimitError: More operations or statements than docs/limits.md allows.
    """
    operations = sum(sum(program.operation_counts(level).values()) for level in LEVELS)
    loops = (count_loop(statement.value) for statement in program.statements)
    operations -= sum(sum(counts.values()) for counts in loops)
    # Outputs that are zero everywhere are set by one loop, and those of a table by another one.
    results = sum(output.value != ZERO for output in program.outputs)
    statements = len(program.statements) + (0 if program.table else results)
    entries = len(program.table.entries) if program.table else 0
    for count, most, what, limit in (
        (0 if program.table else operations, OPERATIONS, "operations", "OPERATIONS"),
        (entries, TABLE_ENTRIES, "entries of its table", "TABLE_ENTRIES"),
        (statements, C_STATEMENTS, "statements", "C_STATEMENTS"),
    ):
        if count > most:
            fewer = (
                "observables" if "observables" in program.name else "coupled variables or members"
            )
            raise LimitError(
                f"{equations.spec.path}: {program.name} takes {count} {what}; expected at most "
                f"{most} ({limit}). Declare fewer {fewer}.",
                path=str(equations.spec.path),
                found=count,
                limit=most,
            )


def check_inverse(equations: Equations, program: Program) -> None:
    """Run a Program on the symbols themselves and compare with the equations exactly.

    Where the kernel solves for velocities there is no closed form to compare with, and loops have
    closed forms that are too large: Program and equations are evaluated at random points modulo a
    prime of 61 bits instead. Two rational
    functions of degree d that differ agree at such a point with a chance of d / 2^61.

    Raises:
        CrossCheckError: An output differs.
    """
    by_residues = equations.kept or program.table
    different = _find_differing_residues if by_residues else _find_differing_elements
    for place, output, a, b in different(equations, program):
        # the relations between functions, which residues do not have, may make an output zero
        if output.value == ZERO and list(find_vanishing(program.name, [place], equations)):
            continue
        raise CrossCheckError(
            f"{equations.spec.name}: lowering changed {program.name}, output {output.label}: "
            f"the Program computes {a!r}, the equations say {b!r}. This is a fault of "
            "coadjoint, please report it.",
            system=equations.spec.name,
            function=program.name,
            output=output.label,
        )


def _find_differing_elements(equations: Equations, program: Program) -> Iterator[_Pair]:
    """Outputs that are not what the equations say, as elements."""
    rows = rows_of(equations, program.name)
    assert rows is not None, program.name
    field = rows.of.setting.field
    inputs = {name: field[name] for name in program.names}
    computed = run(program, inputs, field.number, field.call)
    expected = expected_outputs(equations, program.name)
    assert len(computed) == len(expected) > 0, (program.name, len(computed), len(expected))
    for n, (output, a, b) in enumerate(zip(program.outputs, computed, expected, strict=True)):
        if not field.is_zero(a - b):
            yield n, output, a, b


def _find_differing_residues(equations: Equations, program: Program) -> Iterator[_Pair]:
    """Outputs that are not what the equations say at some points modulo a prime."""
    source, reference = random.Random(1), Reference(equations, implicit=False)  # noqa: S311
    names, reached = program.names, 0
    for prime in islice(primes(), TRIES):
        number, call = partial(residue, prime=prime), partial(call_residue, prime=prime)
        inputs = {name: Residue(source.randrange(1, prime), prime) for name in names}
        try:
            computed = run(program, inputs, number, call)
            expected = reference.evaluate(program.name, inputs, number, call)
        except ZeroDivisionError:  # a pole, which about one point in 2^61 is
            continue
        reached += 1
        assert len(computed) == len(expected) > 0, (program.name, len(computed), len(expected))
        for n, (output, a, b) in enumerate(zip(program.outputs, computed, expected, strict=True)):
            if a != b:
                yield n, output, a, b
        if reached == POINTS:
            return
    raise CrossCheckError(
        f"{equations.spec.name}: {program.name} has values at {reached} of {TRIES} random points; "
        f"expected {POINTS}, at which it is compared. Look for a division by zero in the spec.",
        system=equations.spec.name,
        function=program.name,
    )


def call_residue(function: str, *arguments: Residue, prime: int) -> Residue:
    """A number that an elementary function has at an argument: any, but always the same.

    Lowering knows no relation between values of functions, so it may not need any.
    """
    if function in (SETTLE, SETTLE_LAST):
        return arguments[0]
    return draw(f"{function} {' '.join(str(each.value) for each in arguments)}", prime)
