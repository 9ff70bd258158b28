"""Lowering, entries of a Jacobian that are zero everywhere although the kernel would compute them.

Comes in: the Program ``jacobian``. Goes out: the places of these entries. The rates rest on
definitions, and on functions with relations between them, so that an entry may vanish only once
everything is put in. What is not zero at a random point modulo a prime is not zero; of the others
the closed forms of the rates decide, exactly.
Read next: `coadjoint.derive.decided`, which decides the definitions.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator
from contextlib import suppress

from coadjoint.algebra.linear import PRIME
from coadjoint.derive import Equations
from coadjoint.derive.decided import TRIES, Decided, call_modulo
from coadjoint.lower.program import ZERO, Program, run
from coadjoint.poisson.ranks import Residue, residue


def hidden_zeros(program: Program, equations: Equations) -> list[int]:
    """Places of the entries that are computed and zero everywhere."""
    return list(vanishing(_suspects(program), equations))


def vanishing(places: Iterable[int], equations: Equations) -> Iterator[int]:
    """Those of some entries of a Jacobian whose closed forms are zero."""
    field, state, known = equations.setting.field, equations.setting.state, None
    for place in places:
        if known is None:
            known = Decided(field, state)
            for name, value in equations.exact.definitions:
                known.define(name, value)
        i, j = divmod(place, len(state))
        rate = known.closed(equations.exact.rates[i])
        if rate is not None and field.is_zero(field.derivative(rate, state[j])):
            yield place


def _suspects(program: Program) -> list[int]:
    """Places of the entries that are computed, and zero at a random point modulo a prime."""
    source, names = random.Random(1), (*program.state, *program.parameters)  # noqa: S311
    for _ in range(TRIES):
        inputs = {name: Residue(source.randrange(1, PRIME)) for name in names}
        with suppress(ZeroDivisionError):  # a pole, or no square root
            found = run(program, inputs, residue, call_modulo)
            pairs = enumerate(zip(found, program.outputs, strict=True))
            return [n for n, (x, output) in pairs if not x.value and output.value != ZERO]
    return []
