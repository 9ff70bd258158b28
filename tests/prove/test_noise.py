"""Noise by Hamiltonians: fields, Ito's drift, what is kept, and spoiled noise is caught."""

from dataclasses import replace

import numpy as np
import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.derive.mechanics import noise
from coadjoint.errors import SpecError
from coadjoint.prove import Verdict
from coadjoint.resources import derivations_folder
from tests.prove.test_reductions import IN_STEP
from tests.specs import RIGID_BODY, shipped, spec, verdicts_of

PARAMETER = ("[parameters]", "[parameters]\ns = { shape = [3], default = [1, 2, 3] }")
TABLE = '[noise]\ndW1 = "s1*Pi1"\ndW2 = "dot(s, Pi)"\n'
#: A heavy top, whose Casimirs noise of momenta and of the vertical keeps.
TOP = """
title = "Heavy top with noise"
routes = ["euler-poincare", "lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
Pi = { role = "momentum" }
Gamma = { role = "advected", representation = "vector" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
chi = { shape = [3], default = [0, 0, 1] }
s = { default = 1 }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 - dot(Gamma, chi)"
[noise]
dW1 = "s*Pi3"
dW2 = "s*Gamma1"
[claims]
casimirs = ["dot(Gamma, Gamma)", "dot(Pi, Gamma)"]
conserved = ["dot(Gamma, Gamma)", "dot(Pi, Gamma)"]
"""
OSCILLATOR = """
title = "An oscillator that is shaken"
routes = ["canonical", "poisson"]
[poisson]
canonical = [["q", "p"]]
[variables]
q = { role = "coordinate" }
p = { role = "coordinate" }
[parameters]
a = { default = 1 }
[hamiltonian]
h = "p^2/2 + q^2/2"
[noise]
dW1 = "-a*q"
"""


def noisy(table=TABLE, *changes):
    """A body with noise."""
    return spec(RIGID_BODY, ("[claims]", f"{table}[claims]"), PARAMETER, *changes)


def fields_of(declared):
    """The fields of the noise, and what Ito's drift has in addition, as SymPy has them."""
    setting = derive(declared).setting
    write = lambda values: [sympy.expand(setting.field.to_sympy(v)) for v in values]  # noqa: E731
    fields = {each.name: write(each.field) for each in noise.noise_fields(setting)}
    return fields, write(noise.ito_drift(setting))


def test_the_fields_of_a_body_are_cross_products():
    """``Pi x sigma`` for each process, and ``(Pi x sigma) x sigma/2`` for Ito (Arnaudon, 2018)."""
    fields, added = fields_of(noisy())
    Pi = sympy.Matrix(sympy.symbols("Pi1:4"))
    s1, s2, s3 = sympy.symbols("s1:4")
    axes = {"dW1": sympy.Matrix([s1, 0, 0]), "dW2": sympy.Matrix([s1, s2, s3])}
    assert fields == {name: list(Pi.cross(axis)) for name, axis in axes.items()}
    twice = sum((Pi.cross(axis).cross(axis) for axis in axes.values()), sympy.zeros(3, 1))
    assert added == [sympy.expand(each / 2) for each in twice]


def test_noise_on_a_canonical_pair_kicks_the_momentum():
    """``h1 = -a q`` adds ``a o dW1`` to dp and nothing to dq; Ito's drift is the same."""
    fields, added = fields_of(spec(OSCILLATOR))
    assert fields == {"dW1": [0, sympy.Symbol("a")]}
    assert added == [0, 0]


def test_a_body_with_noise_keeps_its_momentum_and_not_its_energy():
    """Each law is proved; processes along two axes do not commute, which a point shows."""
    found = verdicts_of(noisy())
    assert set(found.values()) == {Verdict.PROVED}
    assert "the noise keeps dot(Pi, Pi) on each path: {C, h_k} = 0" in found
    assert "the energy changes by the noise, {h, h_k} o dW_k" in found
    assert "the drift of the motion by euler-poincare is {x, h}" in found
    assert any(text.startswith("dW1 and dW2 do not commute") for text in found)
    assert not any("energy is conserved" in text or "reversible" in text for text in found)


def test_a_heavy_top_with_noise_keeps_both_casimirs():
    """Noise of a momentum and of a component of the vertical."""
    found = verdicts_of(spec(TOP))
    assert set(found.values()) == {Verdict.PROVED}
    assert "the noise keeps dot(Pi, Gamma) on each path: {C, h_k} = 0" in found


@pytest.mark.parametrize("second", ["s2*Pi1^2", "s2*dot(Pi, Pi)", "s1*Pi1"])
def test_processes_that_commute_are_told(second):
    """Functions of one momentum, and a Casimir."""
    found = verdicts_of(noisy(f'[noise]\ndW1 = "s1*Pi1"\ndW2 = "{second}"\n'))
    assert found["dW1 and dW2 commute: [g_k, g_l] = 0"] is Verdict.PROVED


def test_noise_by_the_energy_keeps_it():
    """A random clock: the Hamiltonian of the noise is the energy."""
    table = '[noise]\ndW1 = "s1*dot(Pi, inverse(diag(I))*Pi)/2"\n'
    found = verdicts_of(noisy(table, ("[claims]", '[claims]\nconserved = ["energy"]')))
    assert found["the energy is conserved"] is Verdict.PROVED


@pytest.mark.parametrize("claim", ["energy", "Pi1"])
def test_what_the_noise_changes_is_not_conserved(claim):
    """The energy, and a momentum that the motion of a symmetric body would keep."""
    changes = [("[claims]", f'[claims]\nconserved = ["{claim}"]')]
    changes += [("diag(I)*Omega", "I1*Omega")] * (claim != "energy")
    assert Verdict.REFUTED in verdicts_of(noisy('[noise]\ndW2 = "Pi2*Pi3"\n', *changes)).values()
    without = spec(RIGID_BODY, *changes)
    assert set(verdicts_of(without).values()) == {Verdict.PROVED}


def test_a_double_bracket_with_noise_does_not_only_fall():
    """Casimirs are kept, and no sentence says that the energy never grows."""
    found = verdicts_of(noisy(f'[double_bracket]\nG = "s1^2"\n{TABLE}'))
    assert set(found.values()) == {Verdict.PROVED}
    law = "the energy changes by -<P dh, G P dh> and the noise, {h, h_k} o dW_k"
    assert law in found
    assert not any("never grows" in text for text in found)


@pytest.mark.parametrize(
    ("spoil", "caught"),
    [
        (lambda field: (-field[0], *field[1:]), "keeps the Poisson bracket"),
        (lambda field: (field[0], field[1] * 2, field[2]), "moves the state by"),
        (lambda field: (field[0] + 1, *field[1:]), "the noise keeps dot(Pi, Pi) on each path"),
    ],
    ids=["sign", "factor", "constant"],
)
def test_spoiled_noise_is_caught(spoil, caught, monkeypatch):
    """Each law refutes a field that is not the bracket with its Hamiltonian."""
    right = noise.noise_fields

    def wrong(setting):
        return tuple(replace(each, field=spoil(each.field)) for each in right(setting))

    for module in ("derive.mechanics.noise", "prove.noise", "prove.identities"):
        monkeypatch.setattr(f"coadjoint.{module}.noise_fields", wrong)
    found = verdicts_of(noisy('[noise]\ndW1 = "dot(s, Pi)"\n'))
    assert any(caught in text for text, said in found.items() if said is Verdict.REFUTED)


def test_a_spoiled_drift_of_ito_is_caught(monkeypatch):
    """Ito's drift without its half."""
    right = noise.ito_drift
    wrong = lambda setting: tuple(2 * each for each in right(setting))  # noqa: E731
    monkeypatch.setattr("coadjoint.prove.noise.ito_drift", wrong)
    found = verdicts_of(noisy())
    said = found["in the sense of Ito the drift has 1/2 sum_k {{x, h_k}, h_k} in addition"]
    assert said is Verdict.REFUTED


def test_routes_without_momenta_refuse_noise():
    """Velocities as the state have no bracket of their own."""
    changes = [('routes = ["euler-poincare", "lie-poisson"]', 'routes = ["nonholonomic"]')]
    changes += [('Pi = { role = "momentum" }\n', ""), ('["dot(Pi, Pi)"]', "[]")]
    with pytest.raises(SpecError, match=r"the route nonholonomic does not accept \[noise\]"):
        spec(RIGID_BODY, ("[claims]", '[noise]\ndW1 = "1"\n[claims]'), *changes)


@pytest.mark.parametrize("unit", ["1/s", "s"])
def test_a_wrong_unit_of_noise_is_refused(unit):
    """A Wiener process is the square root of a time."""
    text = shipped("stochastic_rigid_body").path.read_text(encoding="utf-8")
    with pytest.raises(SpecError, match="square root of a time"):
        spec(text, ("1/s^(1/2)", unit))


def test_the_derivation_shows_the_noise():
    """Both steps are in the document, with the fields and Ito's terms."""
    *_, fields, ito = derive(noisy()).steps
    assert [left.text for left, _ in fields.lines][:3] == ["h_dW1", "h_dW2", "{Pi1, h_dW1}"]
    added = [f"1/2 sum(k, {{{{Pi{n}, h_k}}, h_k}})" for n in (1, 2, 3)]
    assert [left.text for left, _ in ito.lines] == added


def test_a_kernel_has_the_noise():
    """Rows are components, columns processes: ``Pi x sigma`` again, in numbers."""
    from coadjoint.systems import stochastic_rigid_body as body

    Pi, sigma = np.array([0.3, -0.5, 0.7]), np.array([0.2, 0.1, 0.3])
    for target in ("numpy", "python"):
        found = body.noise(Pi, target=target)
        assert np.allclose(found, np.cross(Pi, np.diag(sigma)).T, rtol=1e-15, atol=0)


#: A ball that a hand and a Wiener process turn about one axis.
DRIVEN = """
title = "A ball turned by hand, with noise"
routes = ["lie-poisson", "nambu"]
[algebra]
name = "so(3)"
[variables]
Pi = { role = "momentum" }
[parameters]
s = { default = "0.3" }
[inputs]
u = { default = 0 }
a = { default = 1 }
[hamiltonian]
h = "u*Pi1"
[noise]
dW1 = "a*s*Pi1"
[claims]
casimirs = ["dot(Pi, Pi)"]
conserved = ["dot(Pi, Pi)"]
"""
TORQUE = ("[noise]", '[forces]\nPi = "vector(0, 0, u)"\n[noise]')
KEPT = "the noise keeps dot(Pi, Pi) on each path: {C, h_k} = 0"


def test_inputs_drive_a_motion_with_noise():
    """By hand ``dPi = Pi x e1 (u dt + a s o dW)``; each path keeps the sphere, for all inputs."""
    declared = spec(DRIVEN)
    fields, added = fields_of(declared)
    p2, p3, s, a, u = sympy.symbols("Pi2 Pi3 s a u")
    assert fields == {"dW1": [0, a * s * p3, -a * s * p2]}
    assert added == [0, -(a**2) * s**2 * p2 / 2, -(a**2) * s**2 * p3 / 2]
    assert list(derive(declared).rates) == [0, p3 * u, -p2 * u]
    found = verdicts_of(declared)
    assert set(found.values()) == {Verdict.PROVED}
    assert KEPT in found
    assert "the energy changes by its explicit dependence on time" not in found


def test_a_torque_changes_the_casimir_and_the_noise_does_not():
    """The drive does not allow it; with the claim the certificate is refuted."""
    found = verdicts_of(spec(DRIVEN, TORQUE))
    assert found.pop("dot(Pi, Pi) is conserved") is Verdict.REFUTED
    assert set(found.values()) == {Verdict.PROVED}
    assert "dot(Pi, Pi) changes only by forces and dissipation" in found
    assert KEPT in found


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        ('[reconstruction]\ntheta = "s"\n', "is moved by rates, and noise has none"),
        ('[transformations.flip]\nmap = { Pi = "-Pi" }\n', "claimed of motions without noise"),
    ],
)
def test_the_reason_of_each_refusal_is_said(table, reason):
    """Each table has its own; without it the spec is read."""
    with pytest.raises(SpecError, match=reason):
        spec(DRIVEN, ("[noise]", f"{table}[noise]"))


def test_noise_under_constraints_is_refused_with_its_reason():
    """It need not be a motion that the constraints allow."""
    noise = ("[constraints]", '[noise]\ndW1 = "Gamma1"\n[constraints]')
    text = (derivations_folder() / "veselova.toml").read_text(encoding="utf-8")
    with pytest.raises(SpecError, match="move positions otherwise than the constraints allow"):
        spec(text, noise)


def test_noise_on_a_section_is_refused_with_its_reason():
    """Nothing examines whether it keeps the section."""
    with pytest.raises(SpecError, match="a path leaves the section unless"):
        spec(IN_STEP, ("[reduction]", '[noise]\ndW1 = "q1"\n[reduction]'))
