"""Velocities in densities of fields: functions of the state, not constants."""

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.derive import derive
from coadjoint.prove import Verdict, prove
from coadjoint.solve.folders import load_texts
from coadjoint.spec import read_spec_text
from tests.specs import shipped

STRAND = shipped("spin_chain").path.read_text(encoding="utf-8")
BY_ENERGY = (
    'h = "dot(Pi, inverse(diag(I))*Pi)/2 + dot(Xi, diag(K)*Xi)/2"',
    'routes  = ["lie-poisson"]',
)
CLAIMED = 'conserved = ["energy", "P"]'
SYMPLECTIC = shipped("sp2_strand").path.read_text(encoding="utf-8")
#: Burgers' equation u_t = -3 u u_s, with a mass and a drift: m = a u + b.
CIRCLE = """
title  = "Burgers"
routes = ["lie-poisson", "euler-poincare"]
[space]
s = { length = "L", size = 8, derivatives = 2 }
[diffeomorphisms]
[variables]
u = { role = "velocity" }
m = { role = "momentum" }
[parameters]
a = { positive = true, default = 2 }
b = { default = 1 }
L = { positive = true, default = 10 }
[lagrangian]
l = "a*u^2/2 + b*u"
[observables]
q = "OBSERVED"
[claims]
conserved = ["energy", "CLAIMED"]
"""


def by_energy(text):
    """The strand declared by its Hamiltonian alone."""
    head, _, tail = text.partition("[lagrangian]")
    lines = tail.splitlines()
    tail = "\n".join(["[hamiltonian]", BY_ENERGY[0], *lines[2:]])
    return head.replace(head[head.index("routes") :].splitlines()[0], BY_ENERGY[1]) + tail


def verdict_of(text, formula):
    """What is said of the integral of a formula."""
    certificate = prove(read_spec_text(text, "strand.toml"))
    (found,) = (c for c in certificate.claims if f"the integral of {formula} " in c.statement)
    return found.verdict


@pytest.mark.parametrize("alone", [False, True], ids=["lagrangian", "hamiltonian"])
@pytest.mark.parametrize(
    ("formula", "verdict"),
    [
        ("dot(diag(I)*Omega, Xi)", Verdict.PROVED),  # Pi . Xi
        ("dot(Omega_s, diag(I)*Omega)", Verdict.PROVED),  # the derivative of half Omega . I Omega
        ("dot(Omega, Omega)", Verdict.REFUTED),
        ("Omega1", Verdict.REFUTED),
    ],
)
def test_velocities_of_a_strand_change(formula, verdict, alone):
    """As constants, all of them would be conserved but the first, which would not."""
    text = by_energy(STRAND) if alone else STRAND
    claimed = text.replace(CLAIMED, f'conserved = ["{formula}"]')
    assert claimed != text
    assert verdict_of(claimed, formula) is verdict


@pytest.mark.parametrize(
    ("formula", "verdict"),
    [
        ("u^2", Verdict.PROVED),
        ("(a*u + b)^3", Verdict.PROVED),
        ("u*u_ss", Verdict.REFUTED),
        ("u*m_s + m*u_s", Verdict.PROVED),
    ],
)
def test_velocities_of_the_circle_change(formula, verdict):
    """All functions of m are conserved, as of any law m_t = f(m)_s; products of slopes are not."""
    claimed = CIRCLE.replace("OBSERVED", "m").replace("CLAIMED", formula)
    assert verdict_of(claimed, formula) is verdict


def test_observables_of_velocities_are_those_of_the_state():
    """T = Omega . Omega is Pi1^2/I1^2 + ..., on each route."""
    text = STRAND.replace('"dot(Pi, Xi)"', '"dot(Omega, Omega)"').replace(CLAIMED, "conserved = []")
    spec = read_spec_text(text, "strand.toml")
    for route in spec.routes:
        equations = derive(spec, route)
        field = equations.setting.field
        (value,) = equations.exact.emitted[1].values
        own = [field[f"Pi{n}"] / field[f"I{n}"] for n in (1, 2, 3)]
        assert field.is_zero(value - sum((x * x for x in own), field.zero))


def test_a_matrix_of_velocities_is_one_of_momenta():
    """On Sp(2) with l = tr(T T)/2 - ... the momentum is T itself."""
    text = SYMPLECTIC.replace('"trace(M*S)"', '"trace(T*S)"')
    assert text != SYMPLECTIC
    assert verdict_of(text, "p") is Verdict.PROVED


def test_kernels_compute_what_names_velocities():
    """The integrals of u^3 and of u^2 times its slope by differences, in both targets."""
    text = CIRCLE.replace("OBSERVED", "u^3 + u^2*u_s").replace('"CLAIMED"', '"m"')
    m = np.random.default_rng(2).normal(size=8)
    u = (m - 1) / 2
    slope = (2 * (np.roll(u, -1) - np.roll(u, 1)) / 3 - (np.roll(u, -2) - np.roll(u, 2)) / 12) * 0.8
    with load_texts(pipeline.render(read_spec_text(text, "circle.toml")).texts) as system:
        for target in ("numpy", "c"):
            energy, found = system.observables(m, target=target)
            assert energy == pytest.approx((u**2).sum() * 10 / 8, rel=1e-12)
            assert found == pytest.approx((u**3 + u**2 * slope).sum() * 10 / 8, rel=1e-12)


def test_a_pair_may_name_velocities():
    """M of the chiral model by Omega in the place of Pi; with twice Omega there is curvature."""
    text = shipped("spin_chain_chiral").path.read_text(encoding="utf-8")
    old = '"(hat(Pi + Xi)*(1 + mu) + hat(Pi - Xi)*(1 + 1/mu))/4"'
    assert text.count(old) == 1
    for factor, verdict in (("", Verdict.PROVED), ("2*", Verdict.REFUTED)):
        new = text.replace(old, old.replace("Pi", f"{factor}Omega"))
        claims = prove(read_spec_text(new, "chiral.toml")).claims
        assert {c.verdict for c in claims if c.kind == "lax" and "for every mu" in c.statement} == {
            verdict
        }
