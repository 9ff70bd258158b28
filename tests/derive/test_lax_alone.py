"""Systems that a Lax pair declares without any energy: Toda, Lotka and Volterra, Euler."""

import json

import numpy as np
import pytest
import sympy

from coadjoint import pipeline
from coadjoint.derive import derive, integrals, pairs
from coadjoint.errors import ClaimError, DerivationError, SpecError
from coadjoint.prove import Verdict
from tests.driven_specs import build
from tests.specs import prove_claims, spec, verdicts_of

#: In Flaschka's variables, with ``dL/dt = [B, L]``, so that M = -B.
TODA = """
title = "Open Toda lattice of three particles"
routes = ["lax"]
[variables]
a = { role = "coordinate", shape = [2] }
b = { role = "coordinate", shape = [3] }
[lax]
L = "rows(vector(b1, a1, 0), vector(a1, b2, a2), vector(0, a2, b3))"
M = "rows(vector(0, -a1, 0), vector(a1, 0, -a2), vector(0, a2, 0))"
"""
PAIR_OF_PARTICLES = """
title = "Toda lattice of two particles"
routes = ["lax"]
[variables]
a = { role = "coordinate" }
b = { role = "coordinate", shape = [2] }
[lax]
L = "rows(vector(b1, a), vector(a, b2))"
M = "rows(vector(0, -a), vector(a, 0))"
"""
#: ``L = T + a T^-1`` and ``M = -(T^2 + a + T a T^-1)`` with the shift T of a closed chain.
VOLTERRA = """
title = "Closed chain of Lotka and Volterra"
routes = ["lax"]
[variables]
a = { role = "coordinate", shape = [3] }
[lax]
L = "rows(vector(0, 1, a1/lambda), vector(a2, 0, 1), vector(lambda, a3, 0))"
M = "-rows(vector(a1 + a2, 0, 1), vector(lambda, a2 + a3, 0), vector(0, lambda, a3 + a1))"
"""
EULER = """
title = "Rigid body by its Lax pair"
routes = ["lax"]
[variables]
Pi = { role = "coordinate", shape = [3] }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
[lax]
L = "hat(Pi)"
M = "hat(inverse(diag(I))*Pi)"
"""
#: The bracket of Flaschka's variables, with the pair as a second statement.
WITH_BRACKET = (
    "[lax]",
    '[poisson]\nbrackets = { "{a1, b1}" = "-a1/4", "{a1, b2}" = "a1/4", "{a2, b2}" = "-a2/4", '
    '"{a2, b3}" = "a2/4" }\n[claims]\ncasimirs = ["b1 + b2 + b3"]\n[lax]',
)


def toda(a1, a2, b1, b2, b3):
    """Flaschka (1974): ``a_k' = a_k (b_{k+1} - b_k)``, ``b_k' = 2 (a_k^2 - a_{k-1}^2)``."""
    return a1 * (b2 - b1), a2 * (b3 - b2), 2 * a1**2, 2 * (a2**2 - a1**2), -2 * a2**2


def volterra(a1, a2, a3):
    """``a_i' = a_i (a_{i+1} - a_{i-1})``."""
    return a1 * (a2 - a3), a2 * (a3 - a1), a3 * (a1 - a2)


def euler(p1, p2, p3):
    """``Pi' = Pi x Omega``."""
    w1, w2, w3 = (p / sympy.Symbol(f"I{n}") for n, p in enumerate((p1, p2, p3), 1))
    return p2 * w3 - p3 * w2, p3 * w1 - p1 * w3, p1 * w2 - p2 * w1


CASES = [(TODA, toda, 3), (VOLTERRA, volterra, 2), (EULER, euler, 1)]


@pytest.mark.parametrize(("text", "typed", "count"), CASES)
def test_a_pair_alone_gives_the_motion_and_its_integrals(text, typed, count):
    """The equations as they are known, and as many independent integrals as there are."""
    declared = spec(text)
    equations = derive(declared)
    known = typed(*map(sympy.Symbol, map(str, equations.state)))
    for found, expected in zip(equations.rates, known, strict=True):
        assert sympy.simplify(found - expected) == 0
    assert list(equations.observables) == [f"integral{n + 1}" for n in range(count)]
    certificate = prove_claims(declared)
    assert certificate.holds
    assert {claim.verdict for claim in certificate.claims} == {Verdict.PROVED}
    assert sum(claim.statement.endswith("is conserved") for claim in certificate.claims) == count


@pytest.mark.parametrize(("text", "typed", "count"), CASES)
def test_nothing_speaks_of_an_energy(text, typed, count):
    """No function, no claim, no step of the derivation."""
    rendered = pipeline.render(spec(text))
    assert {"rhs", "jacobian", "observables"} <= set(rendered.programs)
    assert not {"energy", "poisson_tensor"} & set(rendered.programs)
    record = json.loads(rendered.texts["certificate.json"])
    refused = {each["decides"] for each in record.pop("methods") if not each["cost"]}
    assert "energy" in " ".join(refused)  # which such methods ask for
    assert "energy" not in json.dumps(record).lower()
    for name in ("kernel.py", "kernel.h", "__init__.py"):
        assert "energy" not in rendered.texts[name].lower(), name
    steps = [step.title for step in rendered.equations.steps]
    assert len(steps) == 3
    assert not any("energy" in title or "Velocities" in title for title in steps)


def test_two_particles_move_as_a_hyperbolic_secant(tmp_path):
    """``a = c / cosh(2 c t)`` and ``b1 = c tanh(2 c t)``, by the kernel; the integrals stay."""
    system = build(pipeline.render(spec(PAIR_OF_PARTICLES)).texts, tmp_path / "sample")
    c, times = 0.8, np.linspace(0, 2, 21)
    motion = system.simulate([c, 0, 0], (0, 2), samples=21)
    assert np.allclose(motion["a"], c / np.cosh(2 * c * times), atol=1e-8)
    assert np.allclose(motion["b"][0], c * np.tanh(2 * c * times), atol=1e-8)
    assert set(motion.drift) == {"integral1", "integral2"}


def test_a_bracket_without_an_energy_proves_involution():
    """Its Casimir is claimed and no integral; the others commute."""
    found = verdicts_of(TODA, WITH_BRACKET)
    assert set(found.values()) == {Verdict.PROVED}
    assert "b1 + b2 + b3 is a Casimir" in found
    assert "integral1, integral2 are in involution" in found
    assert not any("energy" in statement for statement in found)


def test_a_wrong_matrix_is_refuted_in_its_entry():
    """One sign of M: the equations contradict each other, and the entry is named."""
    wrong = ("vector(a1, 0, -a2)", "vector(a1, 0, a2)")
    certificate = prove_claims(spec(TODA, wrong))
    claim = certificate.claims[0]
    assert claim.verdict is Verdict.REFUTED
    assert "in the entry (1, 3) at lambda^0 of dL/dt - [L, M]" in claim.method
    with pytest.raises(ClaimError, match=r"refuted: dL/dt = \[L, M\]"):
        certificate.require()


def test_spoiled_integrals_are_caught(monkeypatch):
    """A trace with one factor lost is no integral."""
    traces = integrals.traces

    def spoiled(field, L):
        first, *others = traces(field, L)
        return [first, *(x + L[0][0] for x in others)]

    monkeypatch.setattr(integrals, "traces", spoiled)
    found = prove_claims(spec(TODA)).claims
    refuted = {claim.statement for claim in found if claim.verdict is Verdict.REFUTED}
    assert any(statement.startswith("integral2") for statement in refuted)


def test_spoiled_rates_are_caught(monkeypatch):
    """The pair is held against the rates, entry by entry."""
    rates_of = pairs.rates_of
    monkeypatch.setattr(
        "coadjoint.derive.routes.lax.rates_of",
        lambda *given: (-rates_of(*given)[0], *rates_of(*given)[1:]),
    )
    with pytest.raises(ClaimError, match=r"refuted: dL/dt = \[L, M\]"):
        prove_claims(spec(TODA)).require()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("a2, b3)", "a2, b2)"), r"L does not determine b3.*Put it into L\."),
        (("vector(b1, a1", "vector(b1^2, a1"), r"not affine.*entries of L as variables\."),
    ],
)
def test_a_pair_that_gives_no_rates_is_refused(change, message):
    """There is no other road that the message could name."""
    with pytest.raises(DerivationError, match=message):
        derive(spec(TODA, change))


MOMENTUM = ('b = { role = "coordinate", shape = [3] }', 'b = { role = "velocity", of = "a" }')
ENERGY = ("[lax]", '[hamiltonian]\nh = "b^2/2 + exp(a)"\n[lax]')
PAIRED = 'p = { role = "momentum", of = "q" }'
OSCILLATOR = f"""
title = "Oscillator"
routes = ["canonical", "lax"]
[variables]
q = {{ role = "coordinate" }}
{PAIRED}
[hamiltonian]
h = "(p^2 + q^2)/2"
[lax]
L = "rows(vector(p, q), vector(q, -p))"
M = "rows(vector(0, 1), vector(-1, 0))/2"
"""


@pytest.mark.parametrize(
    ("text", "changes", "message"),
    [
        (TODA, (MOMENTUM,), "no energy to follow from"),
        (TODA, (("[lax]", '[claims]\nconserved = ["energy"]\n[lax]'),), "'energy' is not declared"),
        (TODA, (('"lax"]', '"lax", "poisson"]'),), "the route poisson starts from"),
        (OSCILLATOR, (), "has no bracket of coordinates with velocities or momenta"),
    ],
)
def test_what_cannot_be_read_is_refused(text, changes, message):
    """Velocities and energies that are not there, and energies without a bracket."""
    with pytest.raises(SpecError, match=message):
        spec(text, *changes)


def test_the_advice_about_brackets_works():
    """Momenta declared as coordinates, with a canonical bracket: both routes, one motion."""
    with pytest.raises(SpecError, match=r"canonical = \[\[\"q\", \"p\"\]\]"):
        spec(OSCILLATOR)
    declared = '[poisson]\ncanonical = [["q", "p"]]\n[hamiltonian]'
    paired = (PAIRED, 'p = { role = "coordinate" }')
    certificate = prove_claims(spec(OSCILLATOR, paired, ("[hamiltonian]", declared)))
    assert certificate.holds
    assert any(c.statement.startswith("canonical and lax") for c in certificate.claims)
