"""Brackets, Casimirs, momentum maps and transformations where velocities are the state."""

import pytest

from coadjoint.derive import derive
from coadjoint.prove import Verdict
from coadjoint.prove.almost_poisson import ReducedBracket
from coadjoint.prove.integrals import is_conserved
from tests.constrained import PARTICLE
from tests.specs import spec, verdicts_of

#: Lagrange's top in velocities; its brackets are those of Pi = I Omega, divided by I.
TOP = """
title = "Lagrange's top in velocities"
routes = ["nonholonomic", "hamel"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
Gamma = { role = "advected", representation = "vector" }
[parameters]
A = { positive = true, default = 1 }
C = { positive = true, default = 2 }
[lagrangian]
l = "(A*Omega1^2 + A*Omega2^2 + C*Omega3^2)/2 - Gamma3"
[claims]
casimirs = ["dot(Gamma, Gamma)", "A*Omega1*Gamma1 + A*Omega2*Gamma2 + C*Omega3*Gamma3"]
conserved = ["energy", "Omega3"]
[claims.brackets]
"{Omega, Gamma3}" = "vector(Gamma2/A, -Gamma1/A, 0)"
"{Omega, Omega3}" = "vector(Omega2/C, -Omega1/C, 0)"
[symmetries.spin]
algebra = "so(2)"
vector = "a"
generators = { Omega = "a*vector(Omega2, -Omega1, 0)", Gamma = "a*vector(Gamma2, -Gamma1, 0)" }
map = "a*C*Omega3"
[transformations.turn]
map = { Omega = "vector(-Omega1, -Omega2, Omega3)", Gamma = "vector(-Gamma1, -Gamma2, Gamma3)" }
exchanges = { spin = "spin" }
[transformations.back]
map = { Omega = "-Omega" }
reverses_time = true
exchanges = { spin = "-spin" }
"""
DRAG = ("[claims]", '[forces]\nOmega = "vector(-Omega1, -Omega2, 0)"\n[claims]')


def test_a_top_in_velocities_has_what_it_has_in_momenta():
    """{Pi_i, Gamma_j} = -eps_ijk Gamma_k and {Pi_i, Pi_j} = -eps_ijk Pi_k, with Pi = I Omega."""
    found = verdicts_of(TOP)
    assert set(found.values()) == {Verdict.PROVED}
    assert "{Omega, Gamma3} = vector(Gamma2/A, -Gamma1/A, 0)" in found
    assert "spin is their momentum map: {x, spin} = dx/ds" in found
    assert "spin is conserved by Noether's theorem, since its flow keeps h" in found
    assert any(text.startswith("every Casimir is a function of the 2 known") for text in found)


WRONG = [
    ('casimirs = ["dot(Gamma, Gamma)"', 'casimirs = ["dot(Omega, Gamma)"', "is a Casimir"),
    ("vector(Gamma2/A, -Gamma1/A, 0)", "vector(-Gamma2/A, Gamma1/A, 0)", "{Omega, Gamma3}"),
    ("vector(Omega2/C, -Omega1/C, 0)", "vector(Omega2, -Omega1, 0)", "{Omega, Omega3}"),
    ("a*C*Omega3", "a*A*Omega3", "spin is their momentum map"),
    ("-Omega2, Omega3)", "Omega2, Omega3)", "turn takes the motion to itself"),
    ('spin = "-spin"', 'spin = "spin"', "back takes spin to spin"),
]


@pytest.mark.parametrize(("old", "new", "statement"), WRONG)
def test_wrong_claims_about_a_top_in_velocities_are_refuted(old, new, statement):
    """Each of them by itself, with a point."""
    found = verdicts_of(TOP, (old, new))
    assert (
        {text for text, verdict in found.items() if verdict is Verdict.REFUTED}
        == {text for text in found if statement in text and found[text] is Verdict.REFUTED}
        != set()
    )


def test_a_spoiled_bracket_in_velocities_is_caught(monkeypatch):
    """With one entry of the bracket of momenta too large."""
    right = ReducedBracket.tensor.func

    def wrong(self):
        tensor = [list(row) for row in right(self)]
        tensor[0][1], tensor[1][0] = 2 * tensor[0][1], 2 * tensor[1][0]
        return tuple(map(tuple, tensor))

    monkeypatch.setattr(ReducedBracket, "tensor", property(wrong))
    assert Verdict.REFUTED in verdicts_of(TOP).values()


def test_drag_leaves_one_casimir_and_the_spin():
    """Gamma is only turned; Pi . Gamma loses, and the torque has no part along the third axis."""
    found = verdicts_of(
        TOP, DRAG, ('"energy", "Omega3"', '"Omega3"'), ("reverses_time = true\n", "")
    )
    assert found["dot(Gamma, Gamma) is conserved: forces and dissipation do not change it"]
    mixed = "A*Omega1*Gamma1 + A*Omega2*Gamma2 + C*Omega3*Gamma3"
    assert found[f"{mixed} changes only by forces and dissipation"] is Verdict.PROVED
    assert any(
        "Noether" in text and "forces and dissipation do not change it" in text for text in found
    )
    refuted = {text for text, verdict in found.items() if verdict is Verdict.REFUTED}
    assert refuted == {"back takes the motion to itself"}


def test_only_casimirs_that_are_kept_are_shown_as_kept():
    """Of the two, drag leaves the first one."""
    equations = derive(spec(TOP, DRAG, ('"energy", "Omega3"', '"Omega3"')))
    kept = [is_conserved(equations, each) for each in equations.exact.emitted]
    names = [each.name for each in equations.exact.emitted]
    assert [n for n, is_kept in zip(names, kept, strict=True) if is_kept] == ["casimir1"]


def test_casimirs_of_an_almost_poisson_bracket():
    """Of dz = y dx with h = (1 + y^2) u^2/2 + v^2/2: z - ... has none; m u sqrt(1 + y^2) is kept.

    M_u = m (1 + y^2) u, and J(M_u, M_v) = -<p, [D_u, D_v]> = m y u, J(x, M_u) = J(y, M_v) = 1 and
    J(z, M_u) = y: so C = M_u/sqrt(1 + y^2), for which dC/dM_u y u m = -dC/dy, commutes with M_v,
    and not with x.
    """
    claimed = ('conserved = ["energy"]', 'conserved = ["u*sqrt(1 + y^2)"]')
    assert verdicts_of(PARTICLE, claimed)["u*sqrt(1 + y^2) is conserved"] is Verdict.PROVED
    no_casimir = ('conserved = ["energy"]', 'casimirs = ["u*sqrt(1 + y^2)"]')
    assert Verdict.REFUTED in verdicts_of(PARTICLE, no_casimir).values()
    bracket = ('conserved = ["energy"]', 'brackets = { "{x, u*(1 + y^2)}" = "1/m" }')
    assert verdicts_of(PARTICLE, bracket)["{x, u*(1 + y^2)} = 1/m"] is Verdict.PROVED
    other = ('conserved = ["energy"]', 'brackets = { "{z, u*(1 + y^2)}" = "y/m" }')
    assert verdicts_of(PARTICLE, other)["{z, u*(1 + y^2)} = y/m"] is Verdict.PROVED
    turned = ('conserved = ["energy"]', 'brackets = { "{z, u*(1 + y^2)}" = "-y/m" }')
    assert verdicts_of(PARTICLE, turned)["{z, u*(1 + y^2)} = -y/m"] is Verdict.REFUTED


def test_a_transformation_of_a_sleigh_keeps_its_constraint():
    """The map x -> -x, z -> -z turns dz = y dx into itself; x -> -x alone does not."""
    both = '[transformations.flip]\nmap = { x = "-x", u = "-u", z = "-z" }\n'
    kept = ('"w == y*u"', '"2*w == 2*y*u"')
    assert verdicts_of(PARTICLE + both)["flip takes the motion to itself"] is Verdict.PROVED
    whole = both.replace('z = "-z"', 'z = "-z", w = "-w"')
    assert verdicts_of(PARTICLE + whole, kept)["flip takes the motion to itself"] is Verdict.PROVED
    for text, changes in ((both.replace(', z = "-z"', ""), ()), (both, (kept,))):
        found = verdicts_of(PARTICLE + text, *changes)
        assert found["flip takes the motion to itself"] is Verdict.REFUTED
