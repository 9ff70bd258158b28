"""Flows as Programs: what a time ``_h``, below the state in the first argument, adds to a state.

The sum with the state is the method's, which keeps what rounding takes of it.

Comes in: a `Splitting`, or the rates of a quadratic motion. Goes out: a Program for each flow of
the parts, held to the elements that were proved; or that of a step of Kahan's method, held to the
equation that it solves.
Read next: `coadjoint.lower.compositions`, the products of such flows.
"""

from __future__ import annotations

import random
from dataclasses import replace
from functools import partial
from itertools import islice

from coadjoint.derive import Equations
from coadjoint.derive.setting import STEP
from coadjoint.derive.splittings import Part, Splitting
from coadjoint.errors import CrossCheckError
from coadjoint.exact.linear import primes
from coadjoint.exact.residues import Residue, residue
from coadjoint.lower.check import call_residue
from coadjoint.lower.evaluation import run
from coadjoint.lower.kahan import POINTS
from coadjoint.lower.lowering import lower_rows
from coadjoint.lower.program import Program


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
        (f"rise of {row} in {STEP}", value - field[row])
        for row, value in zip(state, part.flow.values, strict=True)
    ]
    program = lower_rows(own, name, lines, (*state, STEP))
    _check(equations, part, program)
    return program


def _check(equations: Equations, part: Part, program: Program) -> None:
    """Hold a flow to the elements that were proved, at points modulo primes of 61 bits.

    Two rational functions of degree d that differ agree at such a point with a chance of d / 2^61;
    multiplied out, flows of large parts have too many terms to be compared.

    Raises:
        CrossCheckError: Lowering changed a value.
    """
    field, source = equations.setting.field, random.Random(1)  # noqa: S311
    for prime in islice(primes(), POINTS):
        number, call = partial(residue, prime=prime), partial(call_residue, prime=prime)
        known = {name: Residue(source.randrange(1, prime), prime) for name in program.names}
        found = run(program, known, number, call)
        for name, element in part.flow.define(field):
            known[name] = field.evaluate(element, known, number, call)
        rows = zip(equations.setting.state, part.flow.values, found, strict=True)
        for row, value, one in rows:
            if field.evaluate(value, known, number, call) != known[row] + one:
                raise CrossCheckError(
                    f"{equations.spec.name}: lowering changed {program.name}, output {row}. This "
                    "is a fault of coadjoint, please report it.",
                    system=equations.spec.name,
                    function=program.name,
                    output=row,
                )
