"""Claims of equal members say for which numbers of them they are proved, and false ones fail."""

from dataclasses import replace

import pytest
import sympy

from coadjoint.errors import ClaimError, LimitError, SpecError
from coadjoint.prove import prove
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.indexed import extend
from coadjoint.spec.reader import read_spec_text
from tests.conftest import FAMILIES
from tests.families import (
    BEADS,
    BY_VELOCITIES,
    CHAIN,
    CHARGES,
    CLOSED,
    DRAG,
    DRIVEN,
    HELD,
    NECKLACE,
    PEAKONS,
    PLANAR,
    RING,
    SPRINGS,
    TOPS,
    VORTICES,
    WALLS,
    are_equal,
    family_of,
    read,
    value_of,
    write_beads,
    write_chain,
    write_necklace,
    write_ring,
    write_vortices,
)
from tests.specs import shipped

TEXTS = {"ring": (RING, write_ring), "chain": (CHAIN, write_chain)}


@pytest.mark.parametrize("name", [each for each in FAMILIES if "zeitlin" not in each])
def test_every_claim_is_proved_for_every_number_of_members(name):
    """No claim names a number alone, and the certificate is not empty."""
    spec = shipped(name)
    claims = prove(spec).require().claims
    assert {claim.verdict for claim in claims} == {Verdict.PROVED}
    assert all(f"for every N >= {spec.family.least}" in claim.statement for claim in claims)
    said = " ".join(claim.statement for claim in claims)
    wanted = [*spec.casimirs, *(each.formula for each in spec.conserved)]
    for formula in wanted:
        text = formula.in_one_line
        assert f"{'the ' if text == 'energy' else ''}{text} is" in said


def test_what_a_proof_leaves_out_is_said_of_all_members():
    """Not of those that were written out: peakons pass each other where their distance is 0."""
    claims = prove(read(PEAKONS)).require().claims
    jumps = [claim.method for claim in claims if "jumps" in claim.method]
    assert len(jumps) == 4
    assert all("where and while no function of any members jumps" in method for method in jumps)
    assert not any("q_0" in claim.method for claim in claims)


CLAIM = 'conserved = ["energy"'
#: Friction acts on the last member alone.
DAMPED = SPRINGS.replace("size = 6", 'size = 6, count = "n"')
DAMPED = DAMPED.replace("c*sum(i, (v[i] - v[i+1])^2)/2", "2*c*v[n-1]^2/2")
DAMPED = DAMPED.replace('conserved = ["P"]', "")
LONG = NECKLACE.replace("size = 6", "size = 60")
#: False claims, of a sum with a wrong sign, a wrong neighbour and a wrong end.
FALSE = [
    (RING, (CLAIM, 'conserved = ["sum(i, S[i, 1])", "energy"')),
    (RING, (CLAIM, 'conserved = ["sum(i, dot(S[i], S[i+2]))", "energy"')),
    (RING, (CLAIM, 'conserved = ["S[i, 3]", "energy"')),
    (CHAIN, (CLAIM, 'conserved = ["sum(i, p[i]) - sum(i, p[i+1])", "energy"')),
    (CHAIN, ("sum(i, p[i]^2/2) +", "sum(i, p[i]^2/2) + sum(i, q[i]^2) +")),
    (VORTICES, (CLAIM, 'conserved = ["sum(i, c[i]*x[i])", "Y"')),
    (BEADS, (CLAIM, 'conserved = ["sum(i, c[i]*p[i])", "energy"')),
    (BEADS, ("c[i]*c[j]/(1 + (q[i] - q[j])^2)", "c[i]*c[j]/(1 + q[i]^2*q[j]^2)")),
    (NECKLACE, ("sum(i, p[i]^2/2)", "sum(i, p[i]^2/2) + sum(i, q[i]*q[i+1])")),
    (LONG, (CLAIM, 'conserved = ["sum(i, p[i]*p[i+1])", "energy"')),
    (DRAG, ("[observables]", '[claims]\nconserved = ["energy"]\n[observables]')),
    (DRAG, ("[observables]", '[claims]\nconserved = ["sum(i, p[i])"]\n[observables]')),
    (SPRINGS, ('conserved = ["P"]', 'conserved = ["energy"]')),
    (SPRINGS, ('conserved = ["P"]', 'conserved = ["K"]')),
    (SPRINGS, ('h = "sum(i, p[i]^2/(2*m[i]))', 'h = "sum(i, p[i]^2/m[i])')),
    (TOPS, (CLAIM, 'conserved = ["sum(i, dot(R[i]*Pi[i], R[i]*Pi[i]))", "energy"')),
    (TOPS, ("- w[i]*R[i, 3, 3]", "- w[i]*R[i, 1, 3]")),
    (VORTICES, ('1/c[i]"', '1/c[i]^2"'), (CLAIM, 'conserved = ["sum(i, c[i]*x[i])"')),
    # what holds in the middle, and fails at one end alone
    (WALLS, (CLAIM, 'conserved = ["P"'), ("k[1]*q[1]*q[2]^2 + ", "")),
    (WALLS, (CLAIM, 'conserved = ["P"'), (" + k[n]*q[n]^4/4", "")),
    (CLOSED, ("(q[0] - q[n-1])^4", "(q[0] + q[n-1])^4")),
    (CLOSED, ('"energy", "P"', '"energy", "sum(i, p[i]) + p[n-1]"')),
    (HELD, (CLAIM, 'conserved = ["P"'), (" + q[n-1]^4", "")),
    (BY_VELOCITIES, ('conserved = ["energy"]', 'conserved = ["sum(i, m[i]*v[i])"]')),
    (CHARGES, ("m[i]*m[j]/(1 + dot(q[i] - q[j], q[i] - q[j]))", "q[i, 1]*q[j, 1]")),
    (DAMPED, ("2*c", "c"), ("[claims]", '[claims]\nconserved = ["energy"]')),
]


@pytest.mark.parametrize("number", range(len(FALSE)))
def test_a_false_claim_is_refuted(number):
    """With a counterexample and the number of members that it has."""
    text, *changes = FALSE[number]
    with pytest.raises(ClaimError, match=r"for every N >= \d") as caught:
        prove(read(text, *changes)).require()
    assert "refuted" in str(caught.value)


#: Springs to the centre of mass of n members: only for their own number the total momentum is kept.
CENTRED = """
title = "Springs to the centre of mass"
routes = ["canonical"]
[index]
i = { size = 4, count = "n" }
[variables]
q = { role = "coordinate", index = "i" }
p = { role = "momentum", of = "q", index = "i" }
[hamiltonian]
h = "sum(i, p[i]^2 + (1 - 1/n)*q[i]^2)/2 - sum(i, j, i < j, q[i]*q[j])/n"
[observables]
P = "sum(i, p[i])"
[claims]
conserved = ["energy", "P"]
"""


def test_a_claim_that_needs_the_number_of_members_says_what_was_asked():
    """In proofs n is any number: refuted is that P is kept for each of them, and nothing else."""
    certificate = prove(read(CENTRED))
    (failed,) = certificate.failures
    assert failed.statement == "P is conserved, for every N >= 2 and n > 0"
    assert "the energy is conserved, for every N >= 2 and n > 0" in {
        claim.statement for claim in certificate.claims
    }
    whole = prove(read(CENTRED, ('count = "n"', 'count = "n", written_out = true'))).require()
    assert "P is conserved, for n = 4" in {claim.statement for claim in whole.claims}


#: Friction between neighbours in a ring; what one loses the other gains.
FRICTION = '[forces]\np = "c*(p[i+1] - p[i]) - c*(p[i] - p[i-1])"\n[observables]'


def test_forces_of_members_are_part_of_what_is_proved():
    """Friction between neighbours keeps the momentum and changes the energy by its power."""
    ring = ("size = 6", "size = 6, periodic = true"), ("[parameters]", "[parameters]\nc = {}")
    claims = prove(
        read(CHAIN, *ring, (CLAIM + ", ", "conserved = ["), ("[observables]", FRICTION))
    ).require()
    said = {each.statement: each.method for each in claims.claims}
    assert "the motion by canonical is {x, h} and the forces, for every N >= 1" in said
    power = said["the energy changes by the power of the forces, for every N >= 1"]
    assert "antisymmetric" not in power
    assert "P is conserved, for every N >= 1" in said
    wrong = FRICTION.replace("- p[i-1]", "+ p[i-1]")
    changes = (*ring, (CLAIM + ", ", "conserved = ["), ("[observables]", wrong))
    with pytest.raises(ClaimError, match="refuted"):
        prove(read(CHAIN, *changes)).require()


def test_time_changes_the_energy_of_all_members():
    """The energy is not claimed to be kept; what an equal force adds to all momenta is known."""
    claims = prove(read(DRIVEN)).require().claims
    energy = [claim for claim in claims if claim.statement.startswith("the energy")]
    said = "the energy changes by its explicit dependence on time: dh/dt = dh/dt|explicit"
    assert [claim.statement for claim in energy] == [f"{said}, for every N >= 2"]
    free = (" + k*q[i]^2/2", ""), ("k = { default = 1 }\n", "")
    J = "sum(i, p[i] - F*sin(w*t)/w)"
    kept = prove(read(f'{DRIVEN}[claims]\nconserved = ["{J}"]', *free)).require().claims
    assert any(c.statement == f"{J} is conserved, for every N >= 2" for c in kept)
    with pytest.raises(ClaimError):
        prove(read(f'{DRIVEN}[claims]\nconserved = ["energy"]')).require()
    wrong = J.replace("sin", "cos")
    with pytest.raises(ClaimError):
        prove(read(f'{DRIVEN}[claims]\nconserved = ["{wrong}"]', *free)).require()


def test_routes_of_members_are_compared_and_friction_has_a_power():
    """Each member has a Legendre transform of its own; Rayleigh's function couples neighbours."""
    said = [each.statement for each in prove(read(SPRINGS)).require().claims]
    same = "euler-lagrange and canonical give the same motion, through the Legendre transform"
    assert f"{same}, for every N >= 2" in said
    assert "the energy changes by -2 R, for every N >= 2" in said
    assert "P is conserved, for every N >= 2" in said


def test_attitudes_of_members_stay_rotations_and_need_to_be_some():
    """Each claim is about every member, and no name of a written-out one is left in it."""
    said = [each.statement for each in prove(read(TOPS)).require().claims]
    where = "where R[i]*transpose(R[i]) = 1, det(R[i]) = 1"
    assert f"J is conserved {where}, for every N >= 2" in said
    assert "R[i]*transpose(R[i]) is conserved, for every N >= 2" in said
    law = "dR[i]/dt = R[i]*hat((dh/dPi1[i], dh/dPi2[i], dh/dPi3[i])), for every N >= 2"
    assert law in said
    moved = "the solvers move R[i] back: R[i]*transpose(R[i]) = 1 + D becomes 1 + D^2 (D - 3)/4"
    assert f"{moved}, for every N >= 2" in said
    assert not any("_0" in each or "_1" in each for each in said)
    assert len(said) == len(set(said))


def test_claims_of_chains_with_members_alone_say_from_where_they_hold():
    """From where both ends keep apart; the momentum of a closed chain is kept."""
    walls, closed = (prove(read(text)).require().claims for text in (WALLS, CLOSED))
    assert all(each.statement.endswith("for every N >= 6") for each in walls)
    said = {each.statement: each.method for each in closed}
    assert "with 4 and with 5 members" in said["P is conserved, for every N >= 4"]
    power = "the energy changes by -2 R, for every N >= 4"
    assert power in {each.statement for each in prove(read(DAMPED)).require().claims}


def test_energies_of_lagrangians_are_kept_by_their_theorem():
    """Without a Hamiltonian there is a Legendre transform of each member."""
    charges, wire = (prove(read(text)).require().claims for text in (CHARGES, BY_VELOCITIES))
    (energy,) = (each for each in wire if each.statement.startswith("the energy"))
    assert energy.statement == "the energy is conserved, for every N >= 4"
    assert energy.method.endswith("the Lagrangian does not name the time")
    said = [each.statement for each in charges]
    assert "J is conserved, for every N >= 2" in said
    same = "euler-lagrange and canonical give the same motion, through the Legendre transform"
    assert f"{same}, for every N >= 2" in said


def test_symmetries_of_members_have_momentum_maps_for_every_number_of_them():
    """Noether's theorem, and a cocycle that is a sum over members."""
    said = {each.statement: each.method for each in prove(read(PLANAR)).require().claims}
    scope = ", for every N >= 1"
    noether = "is conserved by Noether's theorem, since its flow keeps h"
    for name in ("L", "P", "G1"):
        assert "one more member" in said[f"{name} {noether}{scope}"]
    assert f"{{P_xi, P_eta}} = P_[xi, eta]: P is a Poisson map{scope}" in said
    law = "{G_xi, G_eta} = G_[xi, eta] + Sigma(xi, eta) with a constant 2-cocycle Sigma, the sum of"
    assert f"{law} those of all members{scope}" in said
    assert not any("m_0" in each or "dq_0" in each for each in said)


#: What spoils the momentum maps above, and the statement that is refuted.
WRONG_MAPS = [
    (("sum(i, dot(a, p[i]))", "-sum(i, dot(a, p[i]))"), "P is their momentum map"),
    (("A*q[i]", "A*vector(q[i, 1], 2*q[i, 2])"), "L is conserved"),
    (("q[i+1] - q[i], q[i+1] - q[i]", "q[i+1] - q[i], q[i+1] + q[i]"), "P is conserved"),
]


@pytest.mark.parametrize(("change", "refuted"), WRONG_MAPS)
def test_a_wrong_momentum_map_is_refuted(change, refuted):
    """By a sign, an action that shears, and an energy that translations change."""
    claims = prove(read(PLANAR, change)).claims
    (false,) = (c for c in claims if c.statement.startswith(refuted) and "Noether" not in c.method)
    assert false.verdict is Verdict.REFUTED
    assert not any(c.statement.startswith(f"{refuted} by Noether") for c in claims)


def test_a_false_casimir_is_refuted():
    """A component of a spin commutes with itself alone."""
    with pytest.raises(ClaimError, match="is a Casimir"):
        prove(read(RING, ("dot(S[i], S[i])", "S[i, 3]^2"))).require()


@pytest.mark.parametrize(
    ("text", "write", "n", "claim"),
    [
        (RING, write_ring, 2, "S_0[3] + S_1[3]"),
        (RING, write_ring, 3, "S_0[3] + S_1[3] + S_2[3]"),
        (RING, write_ring, 6, " + ".join(f"S_{k}[3]" for k in range(6))),
        (CHAIN, write_chain, 6, " + ".join(f"p_{k}" for k in range(6))),
        (BEADS, write_beads, 7, " + ".join(f"p_{k}" for k in range(7))),
        (NECKLACE, write_necklace, 7, " + ".join(f"p_{k}" for k in range(7))),
    ],
)
def test_what_is_proved_for_all_holds_where_all_are_written_out(text, write, n, claim):
    """By the ordinary way, from texts without an index, also for small numbers."""
    whole = f'{write(n)}\n[claims]\nconserved = ["{claim}"]'
    claims = prove(read_spec_text(whole, "whole.toml")).require().claims
    assert any(each.statement == f"{claim} is conserved" for each in claims)


def test_vortices_in_a_plane_without_walls_keep_their_impulse():
    """With the potential x^2 the other component is lost: the same spec proves Y alone."""
    free = (" + sum(i, x[i]^2)", "")
    both = (CLAIM, 'conserved = ["sum(i, c[i]*x[i])", "Y", "energy"')
    assert prove(read(VORTICES, free, both)).holds
    claim = " + ".join(f"c_{k}*x_{k}" for k in range(4))
    text = write_vortices(4).replace(" + x_0^2 + x_1^2 + x_2^2 + x_3^2", "")
    assert prove(read_spec_text(f'{text}\n[claims]\nconserved = ["{claim}"]', "w.toml")).holds


@pytest.mark.parametrize(("text", "numbers"), [(BEADS, (2, 3, 4)), (NECKLACE, (4, 5, 6))])
def test_pairs_and_neighbours_are_proved_for_three_numbers_of_members(text, numbers):
    """Springs with span 1 and the momentum: w = 1. The reason is that of two new members."""
    (claim,) = (c for c in prove(read(text)).require().claims if c.statement.startswith("P is"))
    said = "with {}, with {} and with {} members; two more members far from each other"
    assert claim.statement == f"P is conserved, for every N >= {numbers[0]}"
    assert said.format(*numbers) in claim.method


def test_a_ring_with_pairs_that_is_too_short_is_written_out():
    """Three beads in a ring: an ordinary system, as a short open chain is."""
    short = read(NECKLACE, sizes={"i": 3})
    assert short.family is None
    assert len(short.state) == 6
    with pytest.raises(SpecError, match="at least 2 for pairs"):
        read(NECKLACE, sizes={"i": 1})


def test_three_windows_see_what_two_do_not():
    """A rate that is 0 for two numbers of members, and not for the third, is refuted."""
    spec = read(NECKLACE)
    small, middle, large = prove_windows(spec)
    (wrong,) = (c for c in large.claims if c.statement == "P is conserved")
    refuted = replace(wrong, verdict=Verdict.REFUTED)
    claims = tuple(refuted if c is wrong else c for c in large.claims)
    certificate = extend(spec, [small, middle, replace(large, claims=claims)])
    (found,) = (c for c in certificate.claims if c.statement.startswith("P is conserved"))
    assert found.verdict is Verdict.REFUTED
    assert found.method.endswith("with 6 members")


def prove_windows(spec):
    """The certificates of the windows."""
    return [prove(window) for window in spec.family.windows]


LOADED = (CLAIM, 'conserved = ["sum(i, S[i, 3])^2", "energy"')


def test_a_claim_that_is_no_sum_is_proved_for_the_loaded_size_alone():
    """Its sentence says the size; a false one is refuted; a size that is too large is refused."""
    claims = prove(read(RING, LOADED, ("size = 6", "size = 3"))).require().claims
    (claim,) = (each for each in claims if "^2 is conserved" in each.statement)
    assert claim.statement == "sum(i, S[i, 3])^2 is conserved, for N = 3 alone"
    false = (CLAIM, 'conserved = ["sum(i, S[i, 1])^2", "energy"')
    with pytest.raises(ClaimError, match="for N = 3 alone"):
        prove(read(RING, false, ("size = 6", "size = 3"))).require()
    with pytest.raises(LimitError, match="PROVED_MEMBERS"):
        read(RING, LOADED, ("size = 6", "size = 60"))
    with pytest.raises(SpecError, match="Give the index a size"):
        read(RING, LOADED, ("size = 6, ", ""))


@pytest.mark.parametrize(
    "claim", ["M^2", "energy*sum(i, S[i, 3])", "D[i]*sum(i, S[i, 3])", "energy + M", "M + D[i]"]
)
def test_what_is_not_linear_in_sums_is_proved_for_the_loaded_size_alone(claim):
    """Functions of sums may be constant for few members, and not for more of them."""
    change = (CLAIM, f'conserved = ["{claim}", "energy"')
    claims = prove(read(RING, change, ("size = 6", "size = 3"))).claims
    (found,) = (each for each in claims if each.statement.startswith(f"{claim} is conserved"))
    assert found.statement.endswith("for N = 3 alone")


def test_a_function_of_sums_is_no_casimir_of_every_number_of_members():
    """A power sum of few numbers is a polynomial in lower ones: 0 here for two members alone."""
    power = [f"sum(i, c[i]^{n})" for n in (1, 2, 3)]
    newton = f"2*{power[2]} - 3*{power[0]}*{power[1]} + {power[0]}^3"
    with pytest.raises(SpecError, match="neither of each member nor a sum"):
        read(VORTICES, ("[claims]", f'[claims]\ncasimirs = ["{newton}"]'))
    assert read(VORTICES, ("[claims]", f'[claims]\ncasimirs = ["{power[1]}"]'))


def test_a_pair_observable_is_no_total_whose_rate_is_a_sum_over_pairs():
    """Also by the name of its component."""
    pairs = 'V = "sum(i, j, i < j, c[i]*c[j]*vector((x[i] - x[j])^2, c[i] + c[j]))"\n'
    for name in ("V", "V2", "V[2]"):
        changes = [('Y = "sum', f'{pairs}Y = "sum'), (CLAIM, f'conserved = ["{name}", "energy"')]
        spec = read(VORTICES, *changes, ("size = 6", "size = 3"))
        assert [each.formula.text for each in spec.family.loaded.conserved] == [name]


def test_an_open_chain_that_is_too_short_is_written_out():
    """It is an ordinary system then, with the same claims and no sentence about other numbers."""
    short = read(CHAIN, sizes={"i": 3})
    assert short.family is None
    assert len(short.state) == 6
    assert not any("N >=" in claim.statement for claim in prove(short).require().claims)


TODA = shipped("toda_lattice").path.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "change",
    [
        ("0, -exp((q[i] - q[i+1])/2)/2)", "0, exp((q[i] - q[i+1])/2)/2)"),
        ("/2, -p[i]/2, exp", "/2, p[i]/2, exp"),
        ("/2, -p[i]/2, exp", "/2, -p[i], exp"),
        ("sum(i, exp(q[i] - q[i+1]))", "sum(i, exp(q[i] - q[i+1])) + sum(i, exp(q[i]))"),
    ],
)
def test_a_wrong_lax_pair_is_refuted(change):
    """By a sign of M, of time, a factor, and a chain that is tied to a wall."""
    claims = prove(read(TODA, change)).claims
    (claim,) = (each for each in claims if each.kind == "lax")
    assert claim.verdict is Verdict.REFUTED
    assert claim.counterexample


def test_the_lax_pair_of_toda_gives_the_claimed_integrals():
    """P = -2 tr L, energy = 2 tr L^2 and T = -8/3 tr L^3, by matrices written out here."""
    n = 4
    q, p = (sympy.symbols(f"{name}_:{n}") for name in "qp")
    a = [sympy.exp((q[k] - q[k + 1]) / 2) / 2 for k in range(n - 1)]
    entries = {(k, k): -p[k] / 2 for k in range(n)}
    entries |= {(k, k + 1): a[k] for k in range(n - 1)} | {(k + 1, k): a[k] for k in range(n - 1)}
    L = sympy.SparseMatrix(n, n, entries)
    family = family_of(shipped("toda_lattice"))
    values = {each.name: value_of(family, each, n) for each in family.totals}
    assert are_equal(values["P"], -2 * L.trace())
    assert are_equal(values["energy"], 2 * (L * L).trace())
    assert are_equal(values["T"], -sympy.Rational(8, 3) * (L * L * L).trace())
