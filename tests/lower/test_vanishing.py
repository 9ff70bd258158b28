"""Entries of a Jacobian that vanish only once all definitions and relations are put in."""

import dataclasses
import math
import random

import pytest

from coadjoint.derive import derive
from coadjoint.errors import CrossCheckError
from coadjoint.lower.check import check_inverse
from coadjoint.lower.evaluation import run
from coadjoint.lower.lowering import lower
from coadjoint.lower.program import ZERO
from tests.specs import shipped

#: The spin of a disk changes however fast it spins. Wheels that allow cos(phi) v2 = 0 alone leave a
#: board dv2/dt = tan(phi) vphi v2.
ZEROS = {
    "euler_disk": [("dOmega3/dt", "Omega3"), ("dOmega3/dt", "Gamma3")],
    "snakeboard": [("dv2/dt", "v1"), ("dv2/dt", "omega")],
}


def lowered(system, function="jacobian"):
    """Equations with the Program of their Jacobian, or another one."""
    equations = derive(shipped(system))
    return equations, lower(equations)[function]


@pytest.mark.parametrize(
    ("system", "function"),
    [
        ("euler_disk", "jacobian"),
        ("rolling_disk", "jacobian"),
        ("snakeboard", "jacobian"),
        ("snakeboard", "projection"),  # the wheels allow v2 = 0 alone
        ("suslov", "jacobian"),
        ("veselova", "projection"),
    ],
)
def test_what_is_zero_to_rounding_is_zero(system, function):
    """No output that the kernel computes is below 1e-12 at four random points."""
    _, program = lowered(system, function)
    source, largest = random.Random(5), [0.0] * len(program.outputs)
    for _ in range(4):
        names = (*program.state, *program.parameters)
        inputs = {name: source.uniform(0.3, 0.7) for name in names}
        found = run(program, inputs, float, lambda f, u: getattr(math, f)(u))
        largest = [max(a, abs(b)) for a, b in zip(largest, found, strict=True)]
    computed = [n for n, output in enumerate(program.outputs) if output.value != ZERO]
    assert computed
    assert all(largest[n] > 1e-12 for n in computed)


@pytest.mark.parametrize("system", sorted(ZEROS))
def test_hidden_zeros_are_found(system):
    """Relations of roots and of sines make these entries zero."""
    equations, program = lowered(system)
    zeros = {output.label for output in program.outputs if output.value == ZERO}
    check_inverse(equations, program)
    for rate, name in ZEROS[system]:
        assert f"d({rate})/d{name}" in zeros


def test_a_zero_that_is_none_is_seen():
    """An entry of the disk's Jacobian that is set to zero is no hidden zero."""
    equations, program = lowered("euler_disk")
    place = next(n for n, output in enumerate(program.outputs) if output.value != ZERO)
    outputs = list(program.outputs)
    outputs[place] = dataclasses.replace(outputs[place], value=ZERO)
    with pytest.raises(CrossCheckError, match="lowering changed jacobian"):
        check_inverse(equations, dataclasses.replace(program, outputs=tuple(outputs)))
