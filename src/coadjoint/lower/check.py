"""Lowering undone: a Program run on exact elements gives back the equations it came from.

Comes in: Equations and a Program. Goes out: nothing, or an error that names the output. This is the
second rung of the ladder: sharing, factoring and naming may not change a single value.
"""

from __future__ import annotations

from coadjoint.derive import Equations
from coadjoint.errors import CrossCheckError, LimitError
from coadjoint.exact import Element
from coadjoint.limits import C_STATEMENTS, OPERATIONS
from coadjoint.lower.program import LEVELS, ZERO, Program, run


def expected_outputs(equations: Equations, name: str) -> list[Element]:
    """What a Program must compute, in state and parameters alone, straight from the equations."""
    exact, setting = equations.exact, equations.setting
    match name:
        case "rhs":
            return [equations.closed(rate) for rate in exact.rates]
        case "jacobian":
            rates = expected_outputs(equations, "rhs")
            return [
                slope for rate in rates for slope in setting.field.gradient(rate, setting.state)
            ]
        case "energy":
            return [equations.closed(exact.energy)]
        case "observables":
            return [equations.closed(value) for _, value in exact.observables]
    assert name == "poisson_tensor", name
    return [equations.closed(entry) for row in exact.poisson_tensor for entry in row]


def check_size(equations: Equations, program: Program) -> None:
    """Refuse what a compiler would need minutes for.

    Raises:
        LimitError: More operations or statements than docs/limits.md allows.
    """
    operations = sum(sum(program.operation_counts(level).values()) for level in LEVELS)
    # Outputs that are zero everywhere are set by one loop.
    results = sum(output.value != ZERO for output in program.outputs)
    statements = len(program.statements) + results
    for found, most, what, limit in (
        (operations, OPERATIONS, "operations", "OPERATIONS"),
        (statements, C_STATEMENTS, "statements", "C_STATEMENTS"),
    ):
        if found > most:
            raise LimitError(
                f"{equations.spec.path}: {program.name} takes {found} {what}; expected at most "
                f"{most} ({limit}). Declare a smaller system, or fewer observables.",
                path=str(equations.spec.path),
                found=found,
                limit=most,
            )


def check_inverse(equations: Equations, program: Program) -> None:
    """Run a Program on the symbols themselves and compare with the equations exactly.

    Raises:
        CrossCheckError: An output differs.
    """
    field = equations.setting.field
    inputs = {name: field[name] for name in (*program.state, *program.parameters)}
    found = run(program, inputs, field.number, field.call)
    expected = expected_outputs(equations, program.name)
    assert len(found) == len(expected) > 0, (program.name, len(found), len(expected))
    for output, a, b in zip(program.outputs, found, expected, strict=True):
        if not field.is_zero(a - b):
            raise CrossCheckError(
                f"{equations.spec.name}: lowering changed {program.name}, output {output.label}: "
                f"the Program computes {a!r}, the equations say {b!r}. This is a fault of "
                "coadjoint, please report it.",
                system=equations.spec.name,
                function=program.name,
                output=output.label,
            )
