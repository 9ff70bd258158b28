"""Velocities that follow from their momentum alone, in closed form: expected values by hand."""

from math import asinh, atanh, cos, cosh, exp, inf, log, pi, sinh, sqrt, tan

import numpy as np
import pytest

from coadjoint.derive import derive
from coadjoint.derive.mechanics import inverses, legendre
from coadjoint.derive.mechanics.inverses import Inverse, find_inverse
from coadjoint.errors import DerivationError, KernelArgumentError
from coadjoint.exact import Field
from tests.solve.domains import built
from tests.specs import prove_claims, spec

#: A particle on a line, by its Lagrangian and the domain.
PARTICLE = """
title = "A particle"
routes = ["canonical", "euler-lagrange"]
[variables]
q = {{ role = "coordinate" }}
p = {{ role = "momentum", of = "q" }}
v = {{ role = "velocity", of = "q" }}
[parameters]
k = {{ positive = true, default = 2 }}
n = {{ positive = true, default = 3 }}
[domain]
{domain}
[lagrangian]
l = "{lagrangian}"
[claims]
conserved = ["energy"]
"""
FAST = 'fast = "v > 0"'
K, Q = 2.0, 0.25

#: l, its domain, v(p) and h(q, p) by hand, and the momenta that have a velocity.
CASES = {
    "log": (
        "v*log(v) - k*q",
        FAST,
        lambda p: exp(p - 1),
        lambda p: exp(p - 1) + K * Q,
        (-inf, inf),
    ),
    "factors": (
        "(1 + q^2)*(v*log(v) - v) - q*v",
        FAST,
        lambda p: exp((p + Q) / (1 + Q**2)),
        lambda p: (1 + Q**2) * exp((p + Q) / (1 + Q**2)),
        (-inf, inf),
    ),
    "exp": (
        "exp(k*v) + q",
        "",
        lambda p: log(p / K) / K,
        lambda p: (p * log(p / K) - p) / K - Q,
        (0, inf),
    ),
    "sinh": (
        "cosh(v) - k*q",
        "",
        asinh,
        lambda p: p * asinh(p) - sqrt(1 + p**2) + K * Q,
        (-inf, inf),
    ),
    "tanh": (
        "log(cosh(v)) - k*q",
        "",
        atanh,
        lambda p: p * atanh(p) + log(1 - p**2) / 2 + K * Q,
        (-1, 1),
    ),
    "atan": (
        "v*atan(v) - log(1 + v^2)/2 - k*q",
        "",
        tan,
        lambda p: -log(cos(p)) + K * Q,
        (-pi / 2, pi / 2),
    ),
    "asinh": ("v*asinh(v) - sqrt(1 + v^2) - k*q", "", sinh, lambda p: cosh(p) + K * Q, (-inf, inf)),
    "root": (
        "v^(3/2) - k*q",
        FAST,
        lambda p: 4 * p**2 / 9,
        lambda p: 4 * p**3 / 27 + K * Q,
        (0, inf),
    ),
    "square": ("v^3/3 - k*q", FAST, sqrt, lambda p: 2 * p**1.5 / 3 + K * Q, (0, inf)),
    "inverse square": (
        "1/v - k*q",
        FAST,
        lambda p: 1 / sqrt(-p),
        lambda p: -2 * sqrt(-p) + K * Q,
        (-inf, 0),
    ),
    "quotient": (
        "v - log(1 + v) - k*q",
        "",
        lambda p: p / (1 - p),
        lambda p: -p - log(1 - p) + K * Q,
        (-inf, 1),
    ),
    "moved": (
        "-2*sqrt(1 - v) - k*q",
        "",
        lambda p: 1 - 1 / p**2,
        lambda p: p + 1 / p + K * Q,
        (0, inf),
    ),
}


def particle(lagrangian, domain=""):
    """The particle with a Lagrangian."""
    return PARTICLE.format(lagrangian=lagrangian, domain=domain)


def inside(low, high):
    """Three momenta between two bounds."""
    left = low if low > -inf else (high - 2 if high < inf else -1.0)
    right = high if high < inf else left + 2
    return [left + (right - left) * part for part in (0.2, 0.55, 0.9)]


@pytest.mark.parametrize("case", CASES)
def test_closed_forms_are_proved(case):
    """Both routes, the transform both ways and its energy; nothing is iterated."""
    lagrangian, domain, *_ = CASES[case]
    sample = spec(particle(lagrangian, domain))
    assert not derive(sample).iterations
    certificate = prove_claims(sample)
    assert certificate.holds, str(certificate)
    assert "dh/dmu = xi on the route canonical" in [each.statement for each in certificate.claims]


@pytest.mark.parametrize("case", CASES)
def test_kernels_compute_what_a_hand_does(case):
    """dq/dt and h of both targets, to a few roundings, and where momenta have a velocity."""
    lagrangian, domain, velocity, energy, (low, high) = CASES[case]
    module = built(particle(lagrangian, domain))
    momenta = inside(low, high)
    states = np.array([[Q] * len(momenta), momenta])
    for target in ("numpy", "c"):
        found = module.rhs(states, target=target)[0]
        assert found == pytest.approx([velocity(p) for p in momenta], rel=1e-14)
        h = module.energy(states, target=target)
        assert h == pytest.approx([energy(p) for p in momenta], rel=1e-13)
        for p in (low, high):
            outside = np.array([[Q], [p + (0.01 if p == high else -0.01)]])
            if abs(p) < inf:
                values = module.domain(outside, target=target)
                assert not (values > 0).all(), p
        assert not module.DOMAIN or (module.domain(states, target=target) > 0).all()


def test_what_a_kernel_computes_holds_no_pair_of_inverse_functions():
    """H of v*log(v) is exp(p - 1) + k q: one exponential, no logarithm."""
    sample = derive(spec(particle("v*log(v) - k*q", FAST)))
    field = sample.setting.field
    p, k, q = (field[name] for name in "pkq")
    by_hand = field.call("exp", p - 1) + k * q
    energy = sample.close(sample.exact.energy)
    assert energy == by_hand
    assert {field.adjoined[g].function for g in field.functions_in(energy)} == {"exp"}


def test_a_momentum_beyond_the_range_is_refused():
    """tan(2) has a value, and no velocity has the momentum 2."""
    module = built(particle(*CASES["atan"][:2]))
    with pytest.raises(KernelArgumentError, match=r"no v has these momenta.*p = 2"):
        module.simulate([0, 2], (0, 1), target="numpy")
    run = module.simulate([0, 1], (0, 5), target="numpy")  # p = 1 - 2 t
    assert run.status in ("DOMAIN", "STEP_UNDERFLOW")
    assert run.time_reached == pytest.approx((1 + pi / 2) / 2, rel=1e-6)


def test_next_to_an_algebra_each_velocity_follows_by_itself():
    """Euler's equations with Omega1 = asinh(Pi1/I1), Omega3 = atanh(Pi3/I3); dq/dt = atanh(p)."""
    body = """
title = "A body"
routes = ["euler-poincare", "lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
Pi = { role = "momentum" }
q = { role = "coordinate" }
v = { role = "velocity", of = "q" }
p = { role = "momentum", of = "q" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
[lagrangian]
l = "I1*cosh(Omega1) + I2*Omega2^2/2 + I3*log(cosh(Omega3)) + log(cosh(v)) - q^2/2"
[claims]
conserved = ["energy"]
casimirs = ["dot(Pi, Pi)"]
"""
    assert prove_claims(spec(body)).holds
    Pi, p = np.array([0.5, 1.0, 1.5]), 0.25
    Omega = [asinh(0.5), 0.5, atanh(0.5)]
    for target in ("numpy", "c"):
        rates = built(body).rhs(np.array([*Pi, Q, p]), target=target)
        assert rates == pytest.approx([*np.cross(Pi, Omega), atanh(p), -Q], rel=1e-14)


# -- what can fail ---------------------------------------------------------------------------------


@pytest.mark.parametrize("wrong", [lambda field, z: (field.call("exp", z) + 1, ())])
def test_a_wrong_inverse_is_none(monkeypatch, wrong):
    """What comes out is put into dl/dv: exp(p - 1) + 1 is no solution, and nothing else is left."""
    monkeypatch.setattr(inverses, "_INVERSES", {"log": wrong})
    with pytest.raises(DerivationError, match="at rest"):
        derive(spec(particle("v*log(v) - k*q", FAST)))


def test_a_certificate_sees_a_wrong_velocity(monkeypatch):
    """Had the search not looked, the claims of both routes would be refuted."""

    def spoil(of, block):
        field = of.setting.field
        return Inverse(value=field.call("exp", field["p"]), known={}, range=())

    monkeypatch.setattr(legendre, "_solve_alone", spoil)
    certificate = prove_claims(spec(particle("v*log(v) - k*q", FAST)))
    assert not certificate.holds


#: Functions with several inverses, of two functions, or of a power that is not solved for.
NO_INVERSE = ("sin(v)", "cosh(v)", "sinh(v) + v", "exp(v) + exp(2*v)", "v + v^2", "v^5", "exp(v)*v")


@pytest.mark.parametrize("text", NO_INVERSE)
def test_what_has_no_inverse_here_is_left_alone(text):
    """Neither a branch is guessed, nor a formula that is right on a part."""
    field = Field(["v", "p"], slots=12)
    calls = {name: lambda x, f=name: field.call(f, x) for name in ("sin", "cosh", "sinh", "exp")}
    function = eval(text.replace("^", "**"), calls | {"v": field["v"]})
    assert find_inverse(field, function, "v", field["p"]) is None


@pytest.mark.parametrize(
    "lagrangian", ["v*sinh(v) - cosh(v) - k*q", "-log(cos(v)) - k*q", "v^2/2 + v^3/3"]
)
def test_the_kernel_iterates_where_there_is_no_closed_form(lagrangian):
    """As before, and proved."""
    sample = spec(particle(lagrangian))
    assert derive(sample).iterations
    assert prove_claims(sample).holds


def test_what_is_real_in_the_domain_alone_may_be_iterated():
    """Of v^2/2 + 2 v^(5/2)/5 = l for v > 0: p = v + v^(3/2), so that p = 2 has v = 1."""
    text = particle("v^2/2 + 2*v^(5/2)/5 - k*q", FAST)
    assert prove_claims(spec(text)).holds
    assert built(text).rhs(np.array([Q, 2.0]))[0] == pytest.approx(1.0, rel=1e-13)


def test_the_advice_of_the_refusal_works():
    """A symbolic power has no closed form here, and is singular at rest: both ways out are open."""
    text = particle("v^n/n - k*q", FAST)
    with pytest.raises(DerivationError, match="at rest") as caught:
        derive(spec(text))
    said = str(caught.value)
    line, carets = said.splitlines()[-2:]
    assert line[carets.index("^") : len(carets)] == '"v^n/n - k*q"'
    assert "Give a [hamiltonian] and the route canonical" in said
    assert "remove p and take the route euler-lagrange" in said
    head, _, _ = text.partition("[lagrangian]")
    power = '[hamiltonian]\nh = "p^(n/(n - 1))*(n - 1)/n + k*q"\n[claims]\nconserved = ["energy"]\n'
    given = (head + power).replace(FAST, 'fast = "p > 0"').replace(', "euler-lagrange"', "")
    given = given.replace('v = { role = "velocity", of = "q" }\n', "")
    assert prove_claims(spec(given)).holds
    own = text.replace('p = { role = "momentum", of = "q" }\n', "").replace('"canonical", ', "")
    assert prove_claims(spec(own)).holds
