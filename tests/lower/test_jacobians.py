"""Derivatives by inputs and parameters: typed by hand, by differences, and refused where absent."""

import dataclasses
import random
from fractions import Fraction

import numpy as np
import pytest

from coadjoint.derive import derive
from coadjoint.derive.mechanics.decided import call_modulo
from coadjoint.errors import CrossCheckError, KernelArgumentError
from coadjoint.exact.linear import PRIME
from coadjoint.exact.residues import Residue, residue
from coadjoint.lower.check import check_inverse
from coadjoint.lower.evaluation import run
from coadjoint.lower.lowering import lower
from coadjoint.lower.program import Negate, Number, Output
from coadjoint.render.targets import BUILDS
from tests.driven_specs import PENDULUM, SUSLOV, build, rendered
from tests.specs import render_claims, shipped, spec

TARGETS = tuple(BUILDS)


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Systems built from specs, shipped by name or driven as text, each once."""
    known = {}

    def make(which):
        if which not in known:
            name = f"built{len(known)}"
            shippeds = None if "\n" in which else render_claims(shipped(which))
            texts = (shippeds or rendered(which, name=name)).texts
            known[which] = build(texts, tmp_path_factory.mktemp("jacobians") / which.split()[0][:9])
        return known[which]

    return make


@pytest.mark.parametrize("target", TARGETS)
def test_a_rigid_body_by_its_moments(built, target):
    """dPi1/dt = (1/I3 - 1/I2) Pi2 Pi3: by I2 it is Pi2 Pi3/I2^2, by I3 minus Pi2 Pi3/I3^2."""
    (x, y, z), (a, b, c) = (2.0, 3.0, 5.0), (1.0, 2.0, 4.0)
    found = built("rigid_body").parameter_jacobian([x, y, z], [a, b, c], target=target)
    expected = [
        [0.0, y * z / b**2, -y * z / c**2],
        [-z * x / a**2, 0.0, z * x / c**2],
        [x * y / a**2, -x * y / b**2, 0.0],
    ]
    np.testing.assert_allclose(found, expected, rtol=1e-15)


@pytest.mark.parametrize("target", TARGETS)
def test_a_pendulum_by_its_torque(built, target):
    """The torque u moves p alone, by 1; shapes follow the batch."""
    state, u, t = np.ones((2, 7)), np.zeros((1, 7)), np.arange(7.0)
    found = built(PENDULUM).input_jacobian(state, None, u, time=t, target=target)
    assert found.shape == (2, 1, 7)
    np.testing.assert_array_equal(found, np.broadcast_to([[[0.0]], [[1.0]]], (2, 1, 7)))


def test_a_body_by_its_torques(built):
    """I1 Omega1' = u1, I2 Omega2' = u2, Omega3' = 0, through the solve in the kernel."""
    found = built(SUSLOV).input_jacobian([0.3, 0.4, 0.0], [2.0, 4.0, 5.0], [1.0, 1.0, 1.0])
    np.testing.assert_allclose(found, [[0.5, 0, 0], [0, 0.25, 0], [0, 0, 0]], rtol=0, atol=1e-15)


@pytest.mark.parametrize("name", ["heavy_top", "chaplygin_ball", "snakeboard", PENDULUM, SUSLOV])
@pytest.mark.parametrize("by", ["parameter", "input"])
def test_differences_of_the_rates(built, name, by):
    """Central differences of the rates, whose error is of second order in the step."""
    system, source = built(name), np.random.default_rng(3)
    table = system.PARAMETERS if by == "parameter" else system.INPUTS
    if not table:
        pytest.skip("no inputs")
    state = source.uniform(0.5, 1.0, system.STATE.size)
    given = {
        "parameters": source.uniform(1.0, 2.0, system.PARAMETERS.size),
        "inputs": source.uniform(1.0, 2.0, system.INPUTS.size) if system.INPUTS else None,
    }
    time = {"time": 0.7} if system.TIME else {}
    found = getattr(system, f"{by}_jacobian")(state, **given, **time)
    assert np.abs(found).max() > 1e-3

    def rates(place, step):
        values = given[f"{by}s"].copy()
        values[place] += step
        return system.rhs(state, **(given | {f"{by}s": values}), **time)

    step = 2.0**-17
    columns = [(rates(n, step) - rates(n, -step)) / (2 * step) for n in range(table.size)]
    size = 1 + np.abs(found).max()
    np.testing.assert_allclose(found, np.transpose(columns), rtol=0, atol=1e-7 * size)


@pytest.mark.parametrize("function", ["input_jacobian", "parameter_jacobian"])
@pytest.mark.parametrize("text", [PENDULUM, SUSLOV], ids=["closed", "solved"])
def test_a_changed_sign_is_caught(text, function):
    """The inverse check names the function and the output."""
    equations = derive(spec(text))
    program = lower(equations)[function]
    place = next(n for n, o in enumerate(program.outputs) if o.value != Number(Fraction(0)))
    outputs = list(program.outputs)
    outputs[place] = Output(outputs[place].label, Negate(outputs[place].value))
    check_inverse(equations, program)
    with pytest.raises(CrossCheckError, match=f"changed {function}"):
        check_inverse(equations, dataclasses.replace(program, outputs=tuple(outputs)))


def test_only_systems_with_inputs_have_their_jacobian(built):
    """The message lists the functions that are there."""
    with pytest.raises(KernelArgumentError, match="no function 'input_jacobian'; expected one of"):
        built("rigid_body").input_jacobian([1.0, 2.0, 3.0])


@pytest.fixture
def along_a_vector(monkeypatch):
    """Programs of a system as if its Jacobian were too large, and as it is."""

    def make(name):
        equations = derive(shipped(name))
        written = lower(equations)
        monkeypatch.setattr("coadjoint.lower.lowering.WRITTEN_SLOPES", 0)
        return equations, written, lower(equations)

    return make


@pytest.mark.parametrize("name", ["n_link_chain", "snakeboard", "chaplygin_ball"])
def test_solves_that_are_too_large_have_the_product_with_a_vector(along_a_vector, name):
    """It is the Jacobian times the vector, modulo a prime; a row that is dropped is caught."""
    equations, written, large = along_a_vector(name)
    assert set(large) == set(written) - {"jacobian"} | {"jacobian_vector"}
    product, matrix = large["jacobian_vector"], written["jacobian"]
    check_inverse(equations, product)
    n, source = len(matrix.state), random.Random(1)
    inputs = {name: Residue(source.randrange(1, PRIME)) for name in product.names}
    vector = [inputs[name] for name in product.state[n:]]
    found, slopes = (run(each, inputs, residue, call_modulo) for each in (product, matrix))
    rows = [slopes[k : k + n] for k in range(0, n * n, n)]
    zero = Residue(0)
    sums = [sum((a * h for a, h in zip(row, vector, strict=True)), zero) for row in rows]
    assert len(found) == n
    assert [x.value for x in found] == [x.value for x in sums]
    last = max(place for place, x in enumerate(found) if x.value)
    outputs = list(product.outputs)
    outputs[last] = Output(outputs[last].label, Number(Fraction(0)))
    wrong = dataclasses.replace(product, outputs=tuple(outputs))
    with pytest.raises(CrossCheckError, match="lowering changed jacobian_vector"):
        check_inverse(equations, wrong)
