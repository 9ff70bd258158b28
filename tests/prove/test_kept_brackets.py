"""Almost-Poisson brackets where constraints are kept or affine, against a projection in numbers.

The bracket of van der Schaft and Maschke is that of the field ``X_f`` in ``H = F n TC`` with
``omega(X_f, Y) = df(Y)`` for all Y in H: F has the velocities that the constraints allow, C is the
set of momenta on which they hold. In the tests below this is linear algebra with floats.
"""

from fractions import Fraction

import numpy as np
import pytest

from coadjoint.derive.symmetries import structure_of
from coadjoint.prove import Verdict
from coadjoint.prove.almost_poisson import ReducedBracket, about_reduced_jacobi
from coadjoint.prove.brackets import about_casimirs
from coadjoint.prove.carried import carry_over
from coadjoint.prove.integrals import is_conserved
from tests.constrained import BALL, PARTICLE, PENDULUM, SLEIGH, SUSLOV, motion
from tests.prove.test_carried import TOP
from tests.specs import prove_claims, spec, verdicts_of

#: The same constraint as one that gives a velocity, and as one that does not, with two poles.
ROADS = {
    "given": ("w == y*u", "w == y*u"),
    "kept": ("w == y*u", "2*w == 2*y*u"),
    "factor": ("w == y*u", "x*w == x*y*u"),
    "affine": ("w == y*u", "w == y*u + k"),
    "affine and kept": ("w == y*u", "2*w == 2*y*u + 2*k"),
    "affine with a factor": ("w == y*u", "x*w == x*y*u + x*k"),
}
CLAIMS = 'conserved = ["energy"]'


def entries(*claims):
    """Verdict by statement; claims replace that of the energy."""
    text, claimed, *changes = claims
    assert CLAIMS in text
    changed = (CLAIMS, claimed), *changes
    return verdicts_of(text, *changed)


def projected(form, position, momenta, mass, slope):
    """The brackets of (q, p) by the projection.

    Args:
        form: A, the constraint is ``A q' = b``.
        position: q.
        momenta: p, on the constraint.
        mass: A number.
        slope: dA/dq, a row for each entry of A, minus those of b.
    """
    n = len(position)
    on = np.concatenate([slope.T @ (momenta / mass), form / mass])  # d(A p/m - b)
    rows = np.array([on, np.concatenate([form, np.zeros(n)])])
    H = np.linalg.svd(rows)[2][2:].T
    omega = np.block([[np.zeros((n, n)), np.eye(n)], [-np.eye(n), np.zeros((n, n))]])
    return H @ np.linalg.solve((H.T @ omega @ H).T, H.T)  # {x_i, x_j} = dx_i (X_j)


def carried(rates, point):
    """The brackets of the state at a point, in floats."""
    whole, field = carry_over(rates).equations, rates.field
    at = {name: Fraction(x) for name, x in point.items()}
    state, structure = [whole.close(field[x]) for x in rates.setting.state], structure_of(whole)
    values = [[structure.bracket(a, b) for b in state] for a in state]
    return np.array([[float(field.evaluate(e, at, Fraction, None)) for e in r] for r in values])


@pytest.mark.parametrize("road", ROADS)
def test_brackets_of_a_particle_are_projected_ones(road):
    """For dz = y dx + k dt, with k = 0 unless the constraint is affine."""
    rates = motion(PARTICLE, ROADS[road])
    k = Fraction(3) if "affine" in road else Fraction(0)
    point = {"x": 2, "y": 5, "z": 7, "u": 11, "v": 13, "m": 4, "k": k}
    point["w"] = point["y"] * point["u"] + k
    form = np.array([-5.0, 0.0, 1.0])
    slope = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    p = 4 * np.array([11.0, 13.0, float(point["w"])])
    whole = projected(form, np.array([2.0, 5.0, 7.0]), p, 4.0, slope)
    whole[3:] /= 4  # of velocities
    whole[:, 3:] /= 4
    places = [("x", "y", "z", "u", "v", "w").index(name) for name in rates.setting.state]
    found = carried(rates, point)
    assert np.abs(found).max() > 0.5
    np.testing.assert_allclose(found, whole[np.ix_(places, places)], rtol=0, atol=1e-12)


def test_the_bracket_of_a_rod_is_a_projected_one():
    """A = (x, y): no constraint gives a velocity, and the bracket is that of a pendulum."""
    rates = motion(PENDULUM)
    point = {"x": 3, "y": 4, "u": 8, "v": -6, "m": 2, "g": 1}
    p = 2 * np.array([8.0, -6.0])
    whole = projected(np.array([3.0, 4.0]), np.array([3.0, 4.0]), p, 2.0, np.eye(2))
    whole[2:] /= 2
    whole[:, 2:] /= 2
    np.testing.assert_allclose(carried(rates, point), whole, rtol=0, atol=1e-12)
    wrong = projected(np.array([3.0, 4.0]), np.array([3.0, 4.0]), p, 2.0, -np.eye(2))
    wrong[2:] /= 2
    wrong[:, 2:] /= 2
    assert np.abs(wrong - whole).max() > 0.1


@pytest.mark.parametrize("road", ROADS)
def test_claimed_brackets_are_decided_alike_on_all_roads(road):
    """{z, M_u} = D_u z = y and {M_v, M_u} = -<p, [D_v, D_u]> = -m w, M_u = m (u + y w)."""
    right = '"{z, u + y*w}" = "y/m"\n"{v, u + y*w}" = "-w/m"\n"{x, z}" = "0"'
    if road in ("given", "affine"):  # w is given, and is named by its value
        right = right.replace("w/m", "(y*u + b)/m").replace("y*w", "y*(y*u + b)")
        right = right.replace("b", "k" if road == "affine" else "0")
    found = entries(PARTICLE, f"[claims.brackets]\n{right}", ROADS[road])
    assert Verdict.REFUTED not in found.values()
    assert sum(text.startswith("{") for text in found) == 3
    wrong = right.replace('= "-', '= "')
    found = entries(PARTICLE, f"[claims.brackets]\n{wrong}", ROADS[road])
    refuted = [text for text, verdict in found.items() if verdict is Verdict.REFUTED]
    assert len(refuted) == 1
    assert refuted[0].startswith("{v, ")


@pytest.mark.parametrize("road", ROADS)
def test_a_bracket_that_is_not_integrable_has_no_casimir(road):
    """The rank 4 of 5 leaves room for one, which the commutators of the fields exclude."""
    found = entries(PARTICLE, 'casimirs = ["z"]', ROADS[road])
    assert found["z is a Casimir"] is Verdict.REFUTED
    none = "there are no Casimirs but constants, near almost every point"
    assert any(text.startswith(none) for text in found)
    assert any(text.startswith("the bracket is not Poisson on any open set") for text in found)


#: The centred ball: its Gamma is fixed in space.
CENTRED = BALL.replace(" + chi", "").replace("- m*g*dot(Gamma, chi)", "").replace("g = {", "k = {")
FLAT = SLEIGH + f"[claims]\n{CLAIMS}\n"
#: A system, its constraint, two like it, a Casimir, what is none, and whether Jacobi holds.
BOTH = {
    "plane": (PARTICLE, "w == y*u", "w == k*u", "m*w == m*k*u", "z - k*x", "z", True),
    "parabola": (PARTICLE, "w == y*u", "w == y*v", "3*w == 3*y*v", "2*z - y^2", "z", True),
    "moving": (PARTICLE, "w == y*u", "w == k", "m*w == m*k", "z", "x", True),
    "sleigh": (FLAT, "u == 0", "u == 0", "2*u == 0", "m", "omega", True),
    "suslov": (SUSLOV, "spin == 0", "spin == 0", "2*spin == 0", "b", "turn1", True),
    "ball": (
        CENTRED.replace('chi = { shape = [3], default = ["0.1", "0.2", "0.3"] }\n', ""),
        "Y == cross(Omega, s)",
        "Y == cross(Omega, s)",
        "2*Y == 2*cross(Omega, s)",
        "dot(Gamma, Gamma)",
        "dot(Omega, Gamma)",
        False,
    ),
}


@pytest.mark.parametrize("name", BOTH)
def test_given_and_kept_constraints_have_the_same_casimirs(name):
    """The same verdicts on Casimirs, on their number and on the Jacobi identity."""
    text, old, given, kept, casimir, other, holds = BOTH[name]
    claimed = f'casimirs = ["{casimir}", "{other}"]'
    text = text.replace(CLAIMS, claimed) if CLAIMS in text else f"{text}[claims]\n{claimed}\n"
    counts = []
    for constraint in (given, kept):
        rates = motion(text, (f'"{old}"', f'"{constraint}"'))
        assert bool(rates.kept) == (constraint == kept)
        found = {
            statement: decided() for statement, _, decided in about_casimirs(carry_over(rates))
        }
        assert found[f"{casimir} is a Casimir"].verdict is Verdict.PROVED
        assert found[f"{other} is a Casimir"].verdict is Verdict.REFUTED
        counts.append([each for each in found if "Casimir is a" in each or "no Casimirs" in each])
        ((jacobi, _, proof),) = about_reduced_jacobi(rates)
        assert jacobi.startswith("the bracket satisfies" if holds else "the bracket is not Poisson")
        assert proof().verdict is Verdict.PROVED
    assert counts[0][-1] == counts[1][-1]


def test_a_platform_that_rises_changes_its_height():
    """The Casimir z has the rate k, and its kernel does not show it as an invariant."""
    found = entries(PARTICLE, 'casimirs = ["z"]', ("w == y*u", "w == k"))
    text = "z changes only by the drift of the affine constraints"
    assert found[text] is Verdict.PROVED
    equations = motion(PARTICLE, (CLAIMS, 'casimirs = ["z"]'), ("w == y*u", "w == k")).equations
    kept = {each.name: is_conserved(equations, each) for each in equations.exact.emitted}
    assert not kept["casimir1"]


def test_a_drift_that_a_casimir_does_not_see():
    """Gamma is only turned, whatever the spin that is imposed."""
    turned = ("[lagrangian]", '[constraints]\nspun = "2*Omega3 == 2*A"\n[lagrangian]')
    text = TOP[: TOP.index("[claims]")] + f"[claims]\n{CLAIMS}\n"
    found = entries(text, 'casimirs = ["dot(Gamma, Gamma)"]', turned)
    kept = "dot(Gamma, Gamma) is conserved: the drift of the affine constraints does not change it"
    assert found[kept] is Verdict.PROVED
    mixed = "A*Omega1*Gamma1 + A*Omega2*Gamma2 + C*Omega3*Gamma3"
    found = entries(text, f'casimirs = ["{mixed}"]', turned)
    assert found[f"{mixed} is a Casimir"] is Verdict.REFUTED


@pytest.mark.parametrize("name", ["moving", "PARTICLE"])
def test_a_spoiled_drift_is_caught(name, monkeypatch):
    """With the opposite drift the motion is not the bracket with H and the drift."""
    right = ReducedBracket.added.func
    monkeypatch.setattr(
        ReducedBracket, "added", property(lambda self: tuple(-x for x in right(self)))
    )
    change = "w == k" if name == "moving" else "w == y*u + k"
    found = entries(PARTICLE, 'casimirs = ["z"]', ("w == y*u", change))
    (law,) = (each for each in found if "the drift along beta" in each)
    assert found[law] is Verdict.REFUTED
    if name == "moving":
        assert found["z changes only by the drift of the affine constraints"] is Verdict.REFUTED


def test_friction_at_a_kept_constraint_leaves_a_casimir():
    """The force names the reaction that the kernel solves for; Gamma is only turned."""
    sliding = (
        CENTRED.replace("rolling =", "plane =")
        .replace('"Y == cross(Omega, s)"', '"dot(Gamma, Y) == 0"')
        .replace("[lagrangian]", '[forces]\nY = "-k*(plane_reaction + m)*Y"\n[lagrangian]')
    )
    claimed = '[claims]\ncasimirs = ["dot(Gamma, Gamma)", "dot(Gamma, Omega)"]\n'
    sliding = sliding.replace("r = { default = 1 }\n", "").replace('s = "r*Gamma"', "")
    sliding = sliding.replace("[definitions]\n\n", "")
    rates = motion(sliding + claimed)
    found = {statement: decided() for statement, _, decided in about_casimirs(carry_over(rates))}
    kept = "dot(Gamma, Gamma) is conserved: forces and dissipation do not change it"
    assert found[kept].verdict is Verdict.PROVED
    assert found["dot(Gamma, Omega) is a Casimir"].verdict is Verdict.REFUTED


def test_inertia_that_depends_on_time_leaves_noethers_theorem():
    """The spin of a top whose inertia grows is C (1 + t^2) Omega3, and its flow keeps h."""
    timed = ("[lagrangian]", '[time]\nname = "t"\n[lagrangian]')
    text = TOP.replace("C*Omega3^2", "(1 + t^2)*C*Omega3^2").replace("a*C*Om", "a*(1 + t^2)*C*Om")
    text = text[: text.index("[claims]")] + "[symmetries" + text.split("[symmetries")[1]
    text = text[: text.index("[transformations")]
    claims = prove_claims(spec(text, timed)).claims
    found = {each.statement: each.verdict for each in claims}
    assert set(found.values()) == {Verdict.PROVED}
    assert "spin is conserved by Noether's theorem, since its flow keeps h" in found
