"""The equations of the generic member are those of all members, written out by hand."""

from dataclasses import replace
from math import cos, exp, isclose, log, pi, sin, sqrt
from xml.etree import ElementTree as ET

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.derive.differences import tidy
from coadjoint.derive.document import document
from coadjoint.errors import AlgebraError, DerivationError, SpecError
from coadjoint.spec.reader import read_spec_text
from tests.families import (
    BEADS,
    BY_VELOCITIES,
    CHAIN,
    CHARGES,
    CLOSED,
    DRAG,
    DRIVEN,
    HELD,
    MEAN,
    NECKLACE,
    PLANAR,
    RING,
    SPRINGS,
    TOPS,
    VORTICES,
    WALLS,
    are_equal,
    check_rates,
    family_of,
    member,
    rates_of_members,
    read,
    value_of,
    write_beads,
    write_chain,
    write_charges,
    write_closed,
    write_drag,
    write_driven,
    write_held,
    write_mean,
    write_necklace,
    write_ring,
    write_springs,
    write_tops,
    write_velocities,
    write_vortices,
    write_walls,
)
from tests.specs import emitted, shipped

SYSTEMS = {
    "ring": (RING, write_ring, (2, 3, 4, 5)),
    "chain": (CHAIN, write_chain, (4, 5, 6)),
    "vortices": (VORTICES, write_vortices, (2, 3, 4)),
    "beads": (BEADS, write_beads, (2, 3, 5)),
    "necklace": (NECKLACE, write_necklace, (2, 4, 7)),
    "tops": (TOPS, write_tops, (2, 3)),
    "drag": (DRAG, write_drag, (2, 3)),
    "springs": (SPRINGS, write_springs, (2, 3, 5)),
    "driven": (DRIVEN, write_driven, (2, 3, 5)),
    "walls": (WALLS, write_walls, (3, 4, 7)),
    "closed": (CLOSED, write_closed, (2, 3, 6)),
    "held": (HELD, write_held, (2, 3, 5)),
    "mean": (MEAN, write_mean, (2, 3, 5)),
    "velocities": (BY_VELOCITIES, write_velocities, (2, 3, 5)),
    "charges": (CHARGES, write_charges, (2, 3)),
}
CASES = [(name, n) for name, (_, _, sizes) in SYSTEMS.items() for n in sizes]


@pytest.fixture(scope="module")
def families():
    """The equations of the generic member of each system."""
    return {name: family_of(read(text)) for name, (text, _, _) in SYSTEMS.items()}


@pytest.mark.parametrize(("name", "n"), CASES)
def test_the_generic_member_moves_as_each_of_all_members(families, name, n):
    """Also in a ring of two, whose members are each other's neighbour twice."""
    check_rates(families[name], SYSTEMS[name][1](n), n)


def spoil_sign(family):
    """A rate with the other sign."""
    first, *rest = family.rates
    return replace(family, rates=(-first, *rest))


def spoil_neighbour(family):
    """The neighbours change places."""
    turned = {(c, -shift): s for (c, shift), s in family.neighbours.items()}
    return replace(family, neighbours=turned)


def spoil_end(family):
    """The two ends change places."""
    return replace(family, ends={k: family.ends[-k - 1] for k in family.ends})


def spoil_sides(family):
    """The first and the last member change places."""
    ends = dict(family.ends)
    ends[0], ends[-1] = ends[-1], family.rates
    return replace(family, ends=ends)


def spoil_drag(family):
    """No force acts."""
    (c,) = family.indexed
    return replace(family, rates=tuple(rate.subs(c, 0) for rate in family.rates))


def spoil_count(family):
    """Three members are taken for all."""
    (n,) = family.count
    sums = tuple(replace(each, term=each.term.subs(n, 3)) for each in family.pair_sums)
    return replace(family, pair_sums=sums)


def spoil_pairs(family):
    """A partner pushes instead of pulling."""
    sums = tuple(replace(each, term=-each.term) for each in family.pair_sums)
    return replace(family, pair_sums=sums)


@pytest.mark.parametrize(
    ("name", "n", "spoil"),
    [
        ("ring", 4, spoil_sign),
        ("chain", 5, spoil_neighbour),
        ("chain", 5, spoil_end),
        ("vortices", 3, spoil_pairs),
        ("beads", 4, spoil_end),
        ("beads", 4, spoil_pairs),
        ("necklace", 5, spoil_neighbour),
        ("tops", 3, spoil_end),
        ("drag", 2, spoil_drag),
        ("springs", 3, spoil_neighbour),
        ("walls", 4, spoil_sides),
        ("closed", 4, spoil_sides),
        ("held", 4, spoil_sides),
        ("mean", 4, spoil_count),
        ("mean", 4, spoil_sides),
        ("velocities", 3, spoil_sides),
        ("charges", 3, spoil_pairs),
    ],
)
def test_a_wrong_rate_is_seen(families, name, n, spoil):
    """The check above can fail: by a sign, a neighbour, an end and a partner."""
    with pytest.raises(AssertionError):
        check_rates(spoil(families[name]), SYSTEMS[name][1](n), n)


@pytest.mark.parametrize(
    ("name", "n"),
    [
        ("ring", 2),
        ("ring", 5),
        ("chain", 5),
        ("vortices", 4),
        ("beads", 4),
        ("tops", 3),
        ("walls", 5),
        ("closed", 4),
        ("held", 3),
        ("mean", 4),
        ("velocities", 4),
        ("charges", 3),
    ],
)
def test_the_energy_is_that_of_all_members(families, name, n):
    """Sums begin and end where the energy that is written out has its terms."""
    energy = derive(read_spec_text(SYSTEMS[name][1](n), "whole.toml")).energy
    family = families[name]
    (total,) = (each for each in family.totals if each.name == "energy")
    assert are_equal(value_of(family, total, n), energy)


def numbers(family, n, values):
    """The rates of n members at values by component and member, as numbers."""
    point = {member(c, k): v for (c, k), v in values.items()}
    return [[float(r.subs(point)) for r in rates] for rates in rates_of_members(family, n)]


def test_a_spin_wave_turns_as_the_book_says():
    """The frequency is 2 J cos(theta) (1 - cos(k)) (Heisenberg's ring, eight spins)."""
    family, n, theta, J = family_of(shipped("heisenberg_lattice")), 8, 0.7, 1.3
    k = 2 * pi / n
    omega = 2 * J * cos(theta) * (1 - cos(k))
    spins = [(sin(theta) * cos(k * i), sin(theta) * sin(k * i), cos(theta)) for i in range(n)]
    values = {(c, i): s[a] for i, s in enumerate(spins) for a, c in enumerate(family.states)}
    rates = rates_of_members(family, n)
    point = {member(c, i): v for (c, i), v in values.items()} | {sympy.Symbol("J"): J}
    for i, (s, rate) in enumerate(zip(spins, rates, strict=True)):
        found = [float(each.subs(point)) for each in rate]
        assert found == pytest.approx([omega * s[1], -omega * s[0], 0], abs=1e-12), i


def test_observables_may_name_members_at_the_ends(families):
    """A length has no sum, and a sum may be less a member; by the last member but one, too."""
    values = {each.name: value_of(families["walls"], each, 4) for each in families["walls"].totals}
    q, p = (sympy.symbols(f"{name}_:4") for name in "qp")
    k = sympy.Symbol("k_2")
    assert values["length"] == q[3] - q[0]
    wanted = 2 * sum(each**2 for each in p) - p[0] ** 2 + k * q[3]
    assert sympy.expand(values["D"] - wanted) == 0


def test_momentum_maps_are_sums_over_members():
    """Lifted, declared, and found for what moves the whole state of a member."""
    family = family_of(read(PLANAR))
    values = {each.name: value_of(family, each, 3) for each in family.totals}
    q = [sympy.symbols(f"q_{k}_1 q_{k}_2") for k in range(3)]
    p = [sympy.symbols(f"p_{k}_1 p_{k}_2") for k in range(3)]
    turned = sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(q, p, strict=True))
    assert sympy.expand(values["L"] ** 2 - turned**2) == 0  # up to the sign of the basis
    assert [values["P1"], values["P2"]] == [sum(each[c] for each in p) for c in range(2)]
    assert [values["G1"], values["G2"]] == [sum(x for x, _ in p), -sum(x for x, _ in q)]


def test_observables_may_be_functions_of_sums():
    """A centre of mass, and products and functions of sums; the first component has all sums."""
    family = family_of(read(PLANAR))
    totals = {each.name: each for each in family.totals}
    x, y = totals["centre1"], totals["centre2"]
    q = [sympy.symbols(f"q_{k}_1 q_{k}_2") for k in range(3)]
    p = [sympy.symbols(f"p_{k}_1 p_{k}_2") for k in range(3)]
    m = sympy.symbols("m_:3")
    for n, each in enumerate((x, replace(y, sums=x.sums))):
        wanted = sum(w * place[n] for w, place in zip(m, q, strict=True)) / sum(m)
        assert are_equal(value_of(family, each, 3), wanted)
    turned = sum(a[0] * b[1] for a, b in zip(q, p, strict=True))
    along = sum(b[0] for b in p)
    found = value_of(family, totals["turning"], 3)
    assert are_equal(found, turned * along**2 - sympy.atan2(along, sum(m)))


def test_normal_modes_between_walls_are_those_of_the_book():
    """omega_k = 2 sqrt(k/m) sin(pi k/(2 (N + 1))), with sines as modes (Fermi, Pasta and Ulam)."""
    linear = "k[i]*(q[i+1] - q[i])^3/3)", "c*(q[i+1] - q[i])^2/2)"
    walls = "c*(k[1]*q[1]*q[2]^2 + k[n]*q[n]^4/4)", "c*q[1]^2/2 + c*q[n]^2/2"
    family, n, c = family_of(read(WALLS, linear, walls)), 9, 2.5
    q, _ = family.states
    for mode in (1, 4, 9):
        omega = 2 * sqrt(c) * sin(pi * mode / (2 * (n + 1)))
        values = {(q, j): sin(pi * mode * (j + 1) / (n + 1)) for j in range(n)}
        point = {member(x, j): v for (x, j), v in values.items()} | {sympy.Symbol("c"): c}
        for j, (_, rate) in enumerate(rates_of_members(family, n)):
            assert isclose(float(rate.subs(point)), -(omega**2) * values[q, j], abs_tol=1e-12)


def test_two_vortices_turn_about_each_other():
    """At (Gamma1 + Gamma2)/(2 pi d^2), anticlockwise for positive circulations (Kirchhoff)."""
    family = family_of(shipped("point_vortices"))
    x, y = family.states
    (gamma,) = family.indexed
    values = {(x, 0): 3.0, (y, 0): 0.0, (x, 1): 0.0, (y, 1): 0.0, (gamma, 0): 2.0, (gamma, 1): 5.0}
    (_, up), (_, down) = numbers(family, 2, values)
    assert isclose(up, 5 / (2 * pi * 3))
    assert isclose((up - down) / 3, (2 + 5) / (2 * pi * 9))


def test_two_vortices_on_a_sphere_turn_about_their_moment():
    """At |M|/(2 pi R d^2) with the chord d between them (Newton)."""
    family = family_of(shipped("sphere_vortices"))
    (gamma,), R = family.indexed, 1.5
    places = [(R, 0.0, 0.0), (0.0, R * 0.6, R * 0.8)]
    strengths = [2.0, -5.0]
    M = [sum(g * x[c] for g, x in zip(strengths, places, strict=True)) for c in range(3)]
    d2 = sum((a - b) ** 2 for a, b in zip(*places, strict=True))
    values = {(c, k): x[n] for k, x in enumerate(places) for n, c in enumerate(family.states)}
    values |= {(gamma, k): g for k, g in enumerate(strengths)}
    point = {member(c, k): v for (c, k), v in values.items()} | {sympy.Symbol("R"): R}
    for place, rates in zip(places, rates_of_members(family, 2), strict=True):
        found = [float(each.subs(point)) for each in rates]
        turned = sympy.Matrix(M).cross(sympy.Matrix(place)) / (2 * pi * R * d2)
        assert found == pytest.approx([float(each) for each in turned], abs=1e-12)


def test_two_particles_of_toda_follow_the_closed_form():
    """exp(q1 - q2) = kappa^2/cosh(kappa t)^2, so that q1 - q2 has the second derivative -2 exp."""
    family = family_of(shipped("toda_lattice"))
    q, p = family.states
    kappa = 1.5
    values = {(q, 0): log(kappa**2), (q, 1): 0.0, (p, 0): 0.0, (p, 1): 0.0}
    (_, first), (_, second) = numbers(family, 2, values)
    assert isclose(first - second, -2 * kappa**2)
    assert isclose(first, -exp(log(kappa**2)))


def test_three_bodies_on_an_equilateral_triangle_turn_together():
    """The square of the rate is G (m1 + m2 + m3)/a^3, whatever the masses are (Lagrange)."""
    family = family_of(shipped("n_body"))
    r, m, a = family.states[:3], family.indexed[0], 2.0
    places = [(0, 0, 0), (a, 0, 0), (a / 2, a * sqrt(3) / 2, 0)]
    masses = [3.0, 4.0, 5.0]
    centre = [sum(w * x[c] for w, x in zip(masses, places, strict=True)) / 12 for c in range(3)]
    values = {(c, k): x[n] for k, x in enumerate(places) for n, c in enumerate(r)}
    values |= {(c, k): 0.0 for c in family.states[3:] for k in range(3)}
    values |= {(m, k): w for k, w in enumerate(masses)}
    point = {member(c, k): v for (c, k), v in values.items()} | {sympy.Symbol("G"): 0.7}
    omega2 = 0.7 * 12 / a**3
    for k, rates in enumerate(rates_of_members(family, 3)):
        force = [float(each.subs(point)) for each in rates[3:]]
        expected = [-omega2 * masses[k] * (places[k][c] - centre[c]) for c in range(3)]
        assert force == pytest.approx(expected, abs=1e-12)


ARROWS = """
title = "Arrows"
routes = ["lie-poisson"]
[index]
i = { size = 5, periodic = true }
[algebra]
name = "so(3)"
[representations.turned]
matrices.J1 = [[0, 0, 0], [0, 0, -1], [0, 1, 0]]
matrices.J2 = [[0, 0, 1], [0, 0, 0], [-1, 0, 0]]
matrices.J3 = [[0, -1, 0], [1, 0, 0], [0, 0, 0]]
[variables]
G = { role = "advected", representation = "turned", index = "i" }
Pi = { role = "momentum", index = "i" }
[hamiltonian]
h = "sum(i, Pi[i, 1]^2/2 + Pi[i, 2]^2 + Pi[i, 3]^2/4) - sum(i, dot(G[i], G[i+1]))"
"""


def test_a_declared_representation_is_that_of_each_member():
    """Vectors turn as those of space do; matrices that do not commute so are refused."""
    known = 'representation = "turned"', 'representation = "vector"'
    assert family_of(read(ARROWS)).rates == family_of(read(ARROWS, known)).rates
    wrong = "matrices.J3 = [[0, -1, 0]", "matrices.J3 = [[0, 1, 0]"
    with pytest.raises(AlgebraError, match="do not commute"):
        read(ARROWS, wrong)
    with pytest.raises(SpecError, match="'J4' is not in the basis"):
        read(ARROWS, ("matrices.J3", "matrices.J4"))


def test_the_number_of_the_first_member_is_that_of_formulas_alone():
    """The generic member is the same, whether members are counted from 0 or from 1."""
    one = family_of(read(RING, ("size = 6,", "size = 6, first = 1,")))
    assert one.rates == family_of(read(RING)).rates


def test_a_pair_counts_the_same_in_both_orders():
    """A term that changes when its members change places is refused, and the advice works."""
    term = ("c[i]*c[j]*log", "c[i]*log")
    with pytest.raises(DerivationError, match="change places"):
        family_of(read(VORTICES, term))
    assert family_of(read(VORTICES, ("c[i]*c[j]*log", "(c[i] + c[j])/2*log")))


def test_differences_are_written_as_differences():
    """The polynomial is the same, and does not cancel far from the origin."""
    r, s, t, m = sympy.symbols("r s t m")
    whole = r**2 - 2 * r * s + s**2 + m * (r - t)
    written = tidy(sympy.expand(whole), [(r, s, t)])
    assert sympy.expand(written - whole) == 0
    far = {r: 1e9 + 1, s: 1e9, t: 1e9 + 1, m: 1}
    assert float(written.subs(far)) == 1.0
    assert tidy(r**2 + s**2, [(r, s)]) == r**2 + s**2


def test_a_document_shows_the_generic_member_and_the_ends():
    """Toda's equations as a book has them, in all formats."""
    whole = document(emitted("toda_lattice"))
    generic, ends = whole.sections[:2]
    assert [line.text for line in generic.lines] == [
        "dq[i]/dt = p[i]",
        "dp[i]/dt = -exp(-q[i+1] + q[i]) + exp(q[i-1] - q[i])",
    ]
    assert generic.lines[0].latex == r"\dot{q}_i &= p_i"
    assert [line.text for line in ends.lines] == [  # dq/dt = p is that of every member
        "dp[0]/dt = -exp(q[0] - q[1])",
        "dp[N-1]/dt = exp(-q[N-1] + q[N-2])",
    ]
    for line in (*generic.lines, *ends.lines):
        ET.fromstring(line.mathml)
    principle = next(part for part in whole.sections if part.kind == "principle")
    assert dict(principle.words)["steps"] == "those of 4 members"


def test_steps_of_a_document_show_one_member():
    """Of one with all its neighbours; the energy is a sum, and no rate is repeated."""
    equations = emitted("toda_lattice")
    steps = {each.title: each for each in document(equations).sections if each.kind == "step"}
    (energy,) = steps["Hamiltonian"].lines
    assert energy.text.startswith("h = sum(")
    slopes = [line.text for line in steps["Derivatives of the Hamiltonian"].lines]
    assert [text.split(" = ")[0] for text in slopes] == ["dh/dq_2", "dh/dp_2"]
    assert steps["Derivatives of the Hamiltonian"].words == (
        ("shown", "member 2; left out are the lines of 0, 1, 3"),
    )
    assert not steps["Hamilton's equations"].lines
    assert [name for name, _ in steps["Hamilton's equations"].words] == ["rates"]
    assert len(equations.steps[-1].lines) == 8  # which are those of all members


def test_a_document_shows_sums_over_partners():
    """The velocity of a vortex."""
    (section, *_) = document(emitted("point_vortices")).sections
    x = section.lines[2]
    assert x.text.startswith("x_pairs[i] = sum(j != i, Gamma[j]*(-y[i] + y[j])/(2*pi*")
    assert r"\sum_{j \ne i}" in x.latex
    ET.fromstring(x.mathml)
