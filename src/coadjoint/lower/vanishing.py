"""Lowering, outputs that are zero everywhere although the kernel would compute them.

Comes in: Programs of functions that may hide zeros: derivatives, and ``projection``. Goes out: the
places of these outputs. They rest on definitions, and on functions with relations between them, so
that an output may vanish only once everything is substituted. What is not zero at a random point
modulo a prime is not zero; of the others closed forms decide, exactly.
Read next: `coadjoint.derive.mechanics.decided`, which decides the definitions.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator
from contextlib import suppress

from coadjoint.derive import Equations
from coadjoint.derive.formulas import rows_of
from coadjoint.derive.mechanics.decided import TRIES, Decided
from coadjoint.exact.linear import PRIME
from coadjoint.exact.residues import Residue, call_modulo, residue
from coadjoint.lower.evaluation import run
from coadjoint.lower.program import ZERO, Program


def find_hidden_zeros(program: Program, equations: Equations) -> list[int]:
    """Places of the outputs that are computed and zero everywhere."""
    return list(find_vanishing(program.name, _list_suspects(program), equations))


def find_vanishing(function: str, places: Iterable[int], equations: Equations) -> Iterator[int]:
    """Those of some outputs of a function that may hide zeros whose closed forms are zero."""
    rows = rows_of(equations, function)
    if rows is None or not rows.may_hide_zeros:
        return
    own, values, variables = rows.of, rows.elements, rows.by
    field, known = own.setting.field, None
    for place in places:
        if known is None:
            known = Decided(field, own.setting.state)
            for name, value in own.exact.definitions:
                known.define(name, value)
        i, j = divmod(place, len(variables)) if variables else (place, None)
        closed = known.close(values[i])
        if closed is None:
            continue
        if field.is_zero(closed if j is None else field.derivative(closed, variables[j])):
            yield place


def _list_suspects(program: Program) -> list[int]:
    """Places of the outputs that are computed, and zero at a random point modulo a prime."""
    source, names = random.Random(1), program.names  # noqa: S311
    for _ in range(TRIES):
        inputs = {name: Residue(source.randrange(1, PRIME)) for name in names}
        with suppress(ZeroDivisionError):  # a pole, or no square root
            values = run(program, inputs, residue, call_modulo)
            pairs = enumerate(zip(values, program.outputs, strict=True))
            return [n for n, (x, output) in pairs if not x.value and output.value != ZERO]
    return []
