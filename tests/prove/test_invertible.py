"""The Legendre transform: where it is invertible, and that a hidden zero is no determinant."""

import mpmath
import pytest

from coadjoint.derive import derive
from coadjoint.errors import DerivationError
from coadjoint.prove import Verdict
from tests.specs import prove_claims, spec

MOTION = """
title = "Two coordinates"
routes = ["canonical"]
[variables]
q = { role = "coordinate" }
r = { role = "coordinate" }
p = { role = "momentum", of = "q" }
s = { role = "momentum", of = "r" }
v = { role = "velocity", of = "q" }
w = { role = "velocity", of = "r" }
[parameters]
m = { positive = true, default = 1 }
[lagrangian]
l = "LAGRANGIAN"
[domain]
far = "r > 1"
[claims]
conserved = ["energy"]
"""

EVERYWHERE = "in all of [domain], wherever the Lagrangian is defined and the declared signs hold"


def invertible(lagrangian, *changes):
    """The claim that the Legendre transform of a Lagrangian is invertible."""
    certificate = prove_claims(spec(MOTION, ("LAGRANGIAN", lagrangian), *changes))
    (found,) = [c for c in certificate.claims if "Legendre transform is invertible" in c.statement]
    assert found.verdict == Verdict.PROVED
    return found


@pytest.mark.parametrize(
    "lagrangian",
    [
        "(exp(2*q)*v^2 + 2*exp(q)*v*w + w^2)/2",
        "(v^2*sin(q)^2 + v*w*sin(2*q) + w^2*cos(q)^2)/2",
        "(v^2 + (sqrt(q)*sqrt(r) - sqrt(q*r))*w^2)/2",
        "(v^2 + (log(q^2) - 2*log(q))*w^2)/2",
        "(v^2 + (sqrt((r - 1)^2) + 1 - r)*w^2)/2",
    ],
)
def test_a_hidden_zero_is_no_determinant(lagrangian):
    """The determinant is zero by a relation between functions: there is no transform."""
    with pytest.raises(DerivationError, match="has no invertible Legendre transform"):
        derive(spec(MOTION, ("LAGRANGIAN", lagrangian)))


def test_a_coefficient_without_a_sign_may_make_it_singular():
    """The mass 2 + q (1 + cos q) is 2 at q = 0 and 2 - 4 pi at q = -2 pi: it vanishes between."""
    found = invertible("((2 + q*(1 + cos(q)))*v^2 + w^2)/2")
    assert found.statement.endswith("is invertible almost everywhere")


def test_what_may_be_zero_is_refused():
    """sqrt(q + 1 + 2 sqrt(q)) is 1 + sqrt(q), which no relation says: no point, no proof."""
    hidden = "(v^2 + (sqrt(q + 1 + 2*sqrt(q)) - 1 - sqrt(q))*w^2)/2"
    with pytest.raises(DerivationError, match=r"no point was found at which det d2l/d\(w\)2"):
        derive(spec(MOTION, ("LAGRANGIAN", hidden)))


@pytest.mark.parametrize(
    "lagrangian",
    [
        "m*(v^2 + w^2)/2",
        "m*(v^2 + (2 + cos(q))*w^2)/2",
        "m*(v^2 + (1 + sin(q)^2)*w^2)/2",
        "m*(exp(q)*v^2 + w^2)/2",
        "m*(v^2 + r*w^2)/2",
        "m*(v^2 + (r - 1)*w^2)/2",
        "m*(v^2 + w^2/sqrt(q))/2",
        "m*(v^2 + (1 + q^2 + r^2 - 2*q*r*cos(q))*w^2)/2",
    ],
)
def test_a_determinant_with_a_sign_is_invertible_everywhere(lagrangian):
    """Positive symbols, squares, exponentials and the declared domain r > 1 give a sign."""
    assert invertible(lagrangian).statement.endswith(EVERYWHERE)


@pytest.mark.parametrize(
    "lagrangian",
    ["m*(v^2 + q*w^2)/2", "m*(v^2 + sin(q)^2*w^2)/2", "m*(v^2 + 3*v*w + (2 + cos(q))*w^2)/2"],
)
def test_a_determinant_without_a_sign_is_not_zero_almost_everywhere(lagrangian):
    """Analytic determinants that vanish at some points: the proof shows another point."""
    found = invertible(lagrangian)
    assert found.statement.endswith("is invertible almost everywhere")
    assert " at q = " in found.method


def test_the_sign_needs_the_declared_domain():
    """Without r > 1 the mass r - 1 has no sign."""
    found = invertible("m*(v^2 + (r - 1)*w^2)/2", ('[domain]\nfar = "r > 1"\n', ""))
    assert found.statement.endswith("almost everywhere")


def test_a_sign_without_a_domain_names_none():
    """Masses m and 2 m are positive everywhere; no [domain] is declared that could be meant."""
    found = invertible("m*(v^2 + 2*w^2)/2", ('[domain]\nfar = "r > 1"\n', ""))
    assert found.statement.endswith("is invertible " + EVERYWHERE.partition(", ")[2])


@pytest.mark.parametrize(
    ("potential", "verdict"),
    [
        ("-m*cos(q)", Verdict.PROVED),
        ("m*sin(q/2)^2", Verdict.PROVED),
        ("exp(2*q) + exp(-q)^2", Verdict.PROVED),
        ("sqrt(1 + sin(q)^2) + cos(q)*cos(2*q)", Verdict.PROVED),
        ("m*sin(q)", Verdict.REFUTED),
        ("exp(2*q) + exp(-q)", Verdict.REFUTED),
    ],
)
def test_even_potentials_have_a_mirror_symmetry(potential, verdict):
    """The pendulum is its own mirror image, and not where the potential is not even."""
    motion = spec(
        MOTION.split("[lagrangian]", maxsplit=1)[0]
        + f'[hamiltonian]\nh = "p^2/(2*m) + s^2/2 + {potential}"\n'
        + '[transformations.mirror]\nmap = { q = "-q", p = "-p" }\n'
        + '[claims]\nconserved = ["energy"]\n'
    )
    (found,) = [c for c in prove_claims(motion).claims if c.statement.startswith("mirror takes")]
    assert found.verdict == verdict


def test_roots_bind_the_proof_to_a_part_of_the_domain():
    """sqrt(q^2) + q is zero for q < 0 and 2 q for q > 0: the statement names the part."""
    found = invertible("m*(v^2 + (sqrt(q^2) + q)*w^2)/2")
    head, point = found.statement.split("connected part of its domain with ")
    values = dict(each.split(" = ") for each in point.split(", "))
    assert head.endswith("almost everywhere on the ")
    assert mpmath.mpf(values["q"].split("/")[0]) > 0
