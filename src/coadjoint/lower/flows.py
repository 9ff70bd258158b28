"""Flows as Programs: the state after a time ``_h``, which stands below it in the first argument.

Comes in: a `Splitting`, or the rates of a quadratic motion. Goes out: a Program for each flow of
the parts, held to the elements that were proved; or that of a step of Kahan's method, held to the
equation that it solves.
Read next: `coadjoint.lower.compositions`, the products of such flows.
"""

from __future__ import annotations

from dataclasses import replace

from coadjoint.derive import Equations
from coadjoint.derive.setting import STEP
from coadjoint.derive.splittings import Part, Splitting
from coadjoint.errors import CrossCheckError
from coadjoint.lower.lowering import lower_rows
from coadjoint.lower.program import Program, run


def lower_flows(splitting: Splitting) -> tuple[Program, ...]:
    """The flows of the parts, in order.

    Raises:
        CrossCheckError: Lowering changed a value.
    """
    return tuple(
        _lower_flow(splitting.equations, f"flow{n}", part)
        for n, part in enumerate(splitting.parts, 1)
    )


def _lower_flow(equations: Equations, name: str, part: Part) -> Program:
    """One flow."""
    field, state = equations.setting.field, equations.setting.state
    names = tuple(part.flow.define(field))
    own = replace(equations, exact=replace(equations.exact, definitions=names, solves=()))
    lines = [
        (f"{row} after {STEP}", value) for row, value in zip(state, part.flow.values, strict=True)
    ]
    program = lower_rows(own, name, lines, (*state, STEP))
    known = {each: field[each] for each in program.names}
    for row, (_, value), found in zip(
        state, lines, run(program, known, field.number, field.call), strict=True
    ):
        if not field.is_zero(own.close(value) - found):
            raise CrossCheckError(
                f"{equations.spec.name}: lowering changed {name}, output {row}. This is a fault of "
                "coadjoint, please report it.",
                system=equations.spec.name,
                function=name,
                output=row,
            )
    return program
