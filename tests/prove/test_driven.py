"""Claims about driven motions: what time and inputs leave, and where statements say so."""

import pytest

from coadjoint.errors import ClaimError, DerivationError
from coadjoint.prove import Verdict
from tests.driven_specs import BELT, BOOST, PENDULUM, ROD, SUSLOV, TOP, VELOCITIES
from tests.specs import prove_claims, spec, verdicts_of


def conserved(text, *changes):
    """The statements on integrals and the energy, all of them proved."""
    found = verdicts_of(text, *changes)
    assert set(found.values()) == {Verdict.PROVED}
    words = ("is conserved", "energy changes")
    return {statement for statement in found if any(each in statement for each in words)}


def test_the_boost_of_a_free_particle():
    """K = t P - m r depends on time and is conserved; its flow takes motions to motions."""
    found = verdicts_of(BOOST)
    assert found["K is conserved"] is Verdict.PROVED
    assert found["the flow of K takes motions to motions, a transformation of positions"]
    assert set(found.values()) == {Verdict.PROVED}


@pytest.mark.parametrize("wrong", ["t*P + m*r", "2*t*P - m*r", "t*P - m*r + t*r"])
def test_a_spoiled_boost_is_refuted(wrong):
    """With a point at which its rate is not zero."""
    with pytest.raises(ClaimError, match="K is conserved"):
        prove_claims(spec(BOOST, ("t*P - m*r", wrong))).require()


BOOSTS = """
[symmetries.B]
algebra = "R^3"
vector = "xi"
generators = { r = "t*xi", P = "m*xi" }
map = "dot(xi, t*P - m*r)"
[transformations.boost]
map = { r = "r + t*c", P = "P + m*c" }
exchanges = { K = "K" }
[transformations.backwards]
map = { P = "-P" }
reverses_time = true
exchanges = { K = "K" }
"""


def test_galilean_boosts():
    """A symmetry and a transformation that name time; K keeps its value under both maps."""
    boosted = BOOST.replace("m = {", "c = { shape = [3] }\nm = {") + BOOSTS
    found = verdicts_of(boosted)
    assert set(found.values()) == {Verdict.PROVED}
    assert "B is their momentum map: {x, B} = dx/ds" in found
    assert not any("Noether" in statement for statement in found)
    for wrong in (
        ("r + t*c", "r + 2*t*c"),
        ('exchanges = { K = "K" }', 'exchanges = { K = "-K" }'),
    ):
        with pytest.raises(ClaimError, match="boost takes"):
            prove_claims(spec(boosted.replace(*wrong))).require()


REVERSED = """
title = "Shaken oscillator"
routes = ["canonical"]
[variables]
q = { role = "coordinate" }
p = { role = "momentum", of = "q" }
[time]
name = "t"
[hamiltonian]
h = "p^2/2 + q^2/2 + q*cos(t)"
[transformations.back]
map = { p = "-p" }
reverses_time = true
"""


def test_motions_run_backwards_with_their_time():
    """cos(t) is even, sin(t) is not."""
    assert set(verdicts_of(REVERSED).values()) == {Verdict.PROVED}
    with pytest.raises(ClaimError, match="back takes the motion to its reverse"):
        prove_claims(spec(REVERSED, ("cos(t)", "sin(t)"))).require()


def test_where_inputs_have_to_be_constant():
    """The energy of the field needs it; what the field does not enter does not."""
    assert conserved(TOP) == {
        "the energy is conserved while the inputs are constant",
        "dot(Pi, Gamma) is conserved",
    }


def test_charts_that_keep_an_input():
    """On the route kaluza-klein the charges p = -u are kept while u is; with time it is refused."""
    further = ('"newton-euler"]', '"newton-euler", "kaluza-klein", "clebsch"]')
    found = {s for s, v in verdicts_of(TOP, further).items() if v is Verdict.PROVED}
    kept = "the route kaluza-klein keeps p1 = -u1, p2 = -u2, p3 = -u3"
    assert f"{kept} while the inputs are constant" in found
    same = "euler-poincare and clebsch give the same motion, through Pi = p_Gamma x Gamma"
    assert same in found
    timed = ("[inputs]", '[time]\nname = "t"\n[inputs]')
    changes = (further, (" - dot(u, Gamma)", " - t*dot(u, Gamma)"), timed)
    with pytest.raises(DerivationError, match=r"dl/dGamma1 = -u1\*t depends on t"):
        prove_claims(spec(TOP, *changes))


def test_an_input_that_cancels_needs_nothing():
    """It is the value that counts, not the text."""
    claimed = 'conserved = ["dot(Pi, Gamma) + u[1] - u[1]", "u[1]*dot(Pi, Gamma)"]'
    found = conserved(TOP, ('conserved = ["energy", "dot(Pi, Gamma)"]', claimed))
    assert "dot(Pi, Gamma) + u[1] - u[1] is conserved" in found
    assert "u[1]*dot(Pi, Gamma) is conserved while the inputs are constant" in found


def test_energy_changes_with_time():
    """By its explicit part: in momenta that of h, in velocities minus that of l."""
    assert conserved(PENDULUM) == {
        "the energy changes by its explicit dependence on time: dh/dt = dh/dt|explicit while the "
        "inputs are constant"
    }
    assert conserved(VELOCITIES) == {
        "the energy changes by its explicit dependence on time: dE/dt = -dl/dt|explicit while the "
        "inputs are constant"
    }


def test_claimed_energy_of_a_driven_motion_is_refuted():
    """Who claims it conserved all the same is shown a point."""
    with pytest.raises(ClaimError, match="energy is conserved"):
        prove_claims(spec(PENDULUM + '[claims]\nconserved = ["energy"]\n')).require()


def test_forces_need_no_constant_inputs():
    """Their power is what it is at each moment."""
    assert conserved(SUSLOV) == {"the energy changes by the power of the forces"}
    assert any("not integrable" in statement for statement in verdicts_of(SUSLOV))


def test_constraints_that_move_with_time():
    """They work; both routes agree."""
    found = verdicts_of(ROD)
    assert set(found.values()) == {Verdict.PROVED}
    assert (
        "the energy changes by the power of the forces and the work of the moving constraints"
        in found
    )
    assert "nonholonomic and hamel give the same motion" in found


def test_a_constraint_that_an_input_moves():
    """With the rate of the input as another one, the same is proved, and needs no condition."""
    found = verdicts_of(BELT)
    assert set(found.values()) == {Verdict.PROVED}
    assert (
        "the energy changes by the power of the forces and the work of the moving constraints"
        in found
    )


def test_reversed_rates():
    """Turned back in time, a rate turns its sign; the rate of a rate does not."""
    text = REVERSED.replace("[hamiltonian]", "[inputs]\n%s\n[hamiltonian]").replace(
        "q*cos(t)", "q*cos(t)*(%s)"
    )
    inputs = 'c = { rate = "b" }\nb = { }\na = { rate = "c" }'  # a -> c -> b
    assert set(verdicts_of(text % (inputs, "a + b + c^2 + t*c")).values()) == {Verdict.PROVED}
    with pytest.raises(ClaimError, match="back takes the motion to its reverse"):
        prove_claims(spec(text % (inputs, "a + b + c"))).require()


@pytest.mark.parametrize("belt", ["vy == t^2*vx", "vy == (t + x)*vx"])
def test_linear_constraints_that_move_do_no_work(belt):
    """Energy is gained by the force alone; the momentum along the moving field gains <p, dD/dt>."""
    found = verdicts_of(ROD, ("vy == t^2*vx + sin(t)", belt))
    assert set(found.values()) == {Verdict.PROVED}
    assert "the energy changes by the power of the forces" in found
    assert "the motion of (x, y, M_vx) is the bracket with H and the forces" in found


def test_a_lagrangian_of_time_beside_constraints():
    """The balance gains minus the explicit part of l, as a third term."""
    found = conserved(ROD, ('"m*(vx^2 + vy^2)/2"', '"m*(vx^2 + vy^2)/2*(1 + t^2) - t*x"'))
    assert found == {
        "the energy changes by the power of the forces, the work of the moving constraints and "
        "its explicit dependence on time"
    }


FLOATING = """
title = "Kept constraint that moves"
routes = ["nonholonomic", "hamel"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
vx = { role = "velocity", of = "x" }
vy = { role = "velocity", of = "y" }
[time]
name = "t"
[lagrangian]
l = "(vx^2 + vy^2)/2 - y"
[constraints]
belt = "cos(t)*vx + (2 + x^2)*vy - t == 0"
[momenta]
M = { section = { vx = "x", vy = "1" } }
"""


def test_a_kept_constraint_that_moves():
    """Its residual keeps its value along the motion, and the momentum equation holds."""
    found = verdicts_of(FLOATING)
    assert set(found.values()) == {Verdict.PROVED}
    assert "the motion keeps belt" in found


PARTICLES = """
title = "Two points"
routes = ["newton"]
[variables]
x = { role = "coordinate", shape = [3] }
y = { role = "coordinate", shape = [3] }
u = { role = "velocity", of = "x" }
w = { role = "velocity", of = "y" }
[inputs]
k = { default = 1 }
[time]
name = "t"
[newton]
x = { force = "FACTOR*(y - x)" }
y = { force = "FACTOR*(x - y)" }
[claims]
conserved = ["u + w", "t*(u + w) - x - y"]
galilean = true
[observables]
pull = "k*dot(x, y)"
"""


@pytest.mark.parametrize("factor", ["(1 + t)", "k"])
def test_laws_that_change_are_not_galilean(factor):
    """Time shifts take a law that depends on time, or on an input, to another one."""
    assert set(verdicts_of(PARTICLES, ("FACTOR", "2")).values()) == {Verdict.PROVED}
    found = verdicts_of(PARTICLES, ("FACTOR", factor))
    refuted = {statement for statement, verdict in found.items() if verdict is not Verdict.PROVED}
    assert refuted == {"Newton's law is the same after a time shift of space and time"}
