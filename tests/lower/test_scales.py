"""Scales of the state: fewer coefficients, the same rates, and a check that sees a wrong scale."""

from __future__ import annotations

import numpy as np
import pytest

from coadjoint.derive import derive
from coadjoint.errors import CrossCheckError
from coadjoint.lower.check import check_inverse
from coadjoint.lower.evaluation import run
from coadjoint.lower.lowering import lower
from coadjoint.lower.scales import Scales, cost, find_scales
from coadjoint.resources import derivations_folder
from coadjoint.spec import read_spec


@pytest.fixture(scope="module")
def body():
    """Manakov's body on so(6)."""
    return derive(read_spec(derivations_folder() / "so6_body.toml"))


def test_scales_are_the_second_derivatives_of_the_energy(body):
    """Omega_ij = M_ij/(a_i + a_j), for each of the fifteen components."""
    field, scales = body.setting.field, find_scales(body)
    assert len(scales) == 15
    for name, scale in scales.items():
        i, j = name[1], name[2]
        assert scale * (field[f"a{i}"] + field[f"a{j}"]) == 1


def test_rates_are_products_of_velocities(body):
    """dM_ij/dt = (a_i - a_j) (Omega^2)_ij: 15 velocities, 60 products and 15 differences."""
    counts = lower(body)["rhs"].operation_counts()
    assert counts == {"add": 45, "multiply": 15 + 60 + 15}


def test_rates_agree_with_the_matrices(body):
    """[M, Omega] with M = A Omega + Omega A, by matrices of doubles."""
    program = lower(body)["rhs"]
    source = np.random.default_rng(0)
    a, names = source.uniform(1.0, 3.0, 6), program.state
    omega = source.normal(size=(6, 6))
    omega = omega - omega.T
    m = a[:, None] * omega + omega * a
    values = {name: m[int(name[1]) - 1, int(name[2]) - 1] for name in names}
    values |= {f"a{i + 1}": a[i] for i in range(6)}
    found = run(program, values, float, lambda *_: pytest.fail("nothing is called"))
    rate = m @ omega - omega @ m
    expected = [rate[int(name[1]) - 1, int(name[2]) - 1] for name in names]
    assert np.abs(expected).min() > 1e-3
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_a_wrong_scale_is_seen(body, monkeypatch):
    """The exact check of lowering fails where a velocity is not what its products stand for."""
    take = Scales.take

    def twice(self, name):
        scale, component = take(self, name)
        return (scale * 2 if component == "M12" else scale), component

    monkeypatch.setattr(Scales, "take", twice)
    with pytest.raises(CrossCheckError, match="dM"):
        check_inverse(body, lower(body)["rhs"])


@pytest.mark.parametrize("name", ["rigid_body", "so4_body", "manakov_so4", "heavy_top"])
def test_products_of_momenta_stay_where_they_are_cheaper(name):
    """Two coefficients in place of two velocities and one: no operation is added."""
    equations = derive(read_spec(derivations_folder() / f"{name}.toml"))
    program = lower(equations)["rhs"]
    most = {"rigid_body": 6, "so4_body": 30, "manakov_so4": 30, "heavy_top": 30}
    assert cost(program) <= most[name]


@pytest.mark.parametrize(
    ("name", "most", "gone"),
    [("chaplygin_ball", 119, {"Y1", "_e1", "_c1"}), ("routh_sphere", 90, set())],
)
def test_definitions_that_cancel_are_written_out(name, most, gone):
    """Rates take fewer operations without them, and are the same function."""
    equations = derive(read_spec(derivations_folder() / f"{name}.toml"))
    program = lower(equations)["rhs"].factored
    check_inverse(equations, program)
    assert cost(program) <= most
    assert not gone & {statement.name for statement in program.statements}
    assert gone <= {name for name, _ in equations.definitions_of(equations.exact.rates)}


def test_a_definition_that_cancels_wrongly_is_seen(monkeypatch):
    """The exact check of lowering fails where another value is written out."""
    equations = derive(read_spec(derivations_folder() / "chaplygin_ball.toml"))
    close = type(equations).close
    monkeypatch.setattr(type(equations), "close", lambda self, element: close(self, element) * 2)
    with pytest.raises(CrossCheckError, match="dOmega"):
        check_inverse(equations, lower(equations)["rhs"])
