"""Claims about fields: brackets, conserved densities, what grids keep, and wrong claims."""

import re
from dataclasses import replace

import numpy as np
import pytest

from coadjoint.derive import derive
from coadjoint.derive.fields import generic, hamiltonian
from coadjoint.derive.fields.generic import GenericPoint
from coadjoint.derive.fields.grid import make_grid
from coadjoint.derive.fields.hamiltonian import field_equations
from coadjoint.derive.fields.jets import jets_of
from coadjoint.derive.fields.operators import Term
from coadjoint.derive.fields.structure import field_operator
from coadjoint.derive.fields.sums import explain_change, find_bracket_defects, find_sum_defects
from coadjoint.errors import ClaimError
from coadjoint.pipeline import render
from coadjoint.prove import Verdict, prove
from coadjoint.prove import fields as claims_of_fields
from coadjoint.prove.fields import (
    about_fields,
    decide_density,
    decide_jacobi,
    decide_skew,
)
from coadjoint.prove.grids import about_grid
from coadjoint.prove.zero import Discovery, decide_zero
from coadjoint.solve.folders import load_texts
from coadjoint.spec import read_spec_text
from tests.fields import grid_of
from tests.specs import emitted, shipped

NAMES = (
    "spin_chain",
    "spin_chain_chiral",
    "landau_lifshitz",
    "kdv",
    "camassa_holm",
    "burgers",
    "hunter_saxton",
    "sp2_strand",
    "two_time_body",
)


def bracket_of(name):
    """The bracket of a shipped system, and its jets."""
    setting = emitted(name).setting
    return field_operator(setting), jets_of(setting)


def spoil(operator, places, order):
    """A bracket of a strand with the sign changed of terms of an order in some blocks."""
    return tuple(
        tuple(
            tuple(
                Term(-t.left, t.order, t.right)
                if (i // 3, j // 3) in places and t.order == order
                else t
                for t in entry
            )
            for j, entry in enumerate(row)
        )
        for i, row in enumerate(operator)
    )


@pytest.mark.parametrize("name", NAMES)
def test_every_claim_of_shipped_fields_is_proved(name):
    """Brackets, routes, densities and grids; a statement about each of these is there."""
    certificate = prove(shipped(name)).require()
    kinds = {claim.kind for claim in certificate.claims}
    assert {"jacobi", "posed", "conserved", "equivalence"} <= kinds
    assert certificate.count(Verdict.PROVED) == len(certificate.claims) >= 9


@pytest.mark.parametrize(
    ("places", "triple"),
    [([(0, 0)], "(Pi"), ([(0, 1), (1, 0)], "(Pi")],
    ids=["Pi x", "Xi x"],
)
def test_a_wrong_sign_at_points_breaks_the_jacobi_identity(places, triple):
    """Of Pi x or of Xi x alone: the bracket stays antisymmetric, and the triple is named."""
    operator, jets = bracket_of("spin_chain")
    spoiled = spoil(operator, places, 0)
    assert decide_skew(spoiled, jets).verdict is Verdict.PROVED
    found = decide_jacobi(spoiled, jets)
    assert found.verdict is Verdict.REFUTED
    assert f"for the triple {triple}" in found.method


def test_a_wrong_sign_of_one_derivative_breaks_antisymmetry():
    """Of the two d_s one alone; the pair is named."""
    operator, jets = bracket_of("spin_chain")
    found = decide_skew(spoil(operator, [(0, 1)], 1), jets)
    assert found.verdict is Verdict.REFUTED
    assert "{Pi1, Xi1}" in found.method


@pytest.mark.parametrize("spoiled", [False, True])
def test_wrong_signs_of_both_derivatives_are_refuted_by_compatibility_alone(monkeypatch, spoiled):
    """The cocycle may have any factor: the bracket stays one, and its motion keeps the energy.

    But Xi_t - Omega_s is no more what mixed derivatives of g leave of it, of which the route over
    the group knows, and so the holonomy of Xi.
    """
    operator, right = bracket_of("spin_chain")[0], emitted("spin_chain", "hamilton-pontryagin")
    operator = spoil(operator, [(0, 1), (1, 0)], 1) if spoiled else operator
    for module in (hamiltonian, claims_of_fields, generic):
        monkeypatch.setattr(module, "field_operator", lambda _: operator)
    wrong = field_equations(right.setting, "lie-poisson")
    refuted = list[str]()
    for statement, _, decide in about_fields((wrong, right)):
        found = decide()
        decision = decide_zero(found, right.setting.field) if isinstance(found, list) else found
        if getattr(decision, "verdict", Verdict.PROVED) is not Verdict.PROVED:
            refuted.append(statement)
    compatible = [
        "the route hamilton-pontryagin gives the same motion and energy as lie-poisson",
        "the trace of the holonomy of dpsi/ds = psi Xi around the circle is conserved",
    ]
    assert refuted == compatible * spoiled


def test_another_energy_is_another_motion_or_not_the_same_energy():
    """With a constant in the energy of one route its motion is the same, and the claim refuted."""
    first, other = (emitted("spin_chain", name) for name in shipped("spin_chain").routes[:2])
    energy = other.exact.energy + first.setting.field.one
    shifted = replace(other, exact=replace(other.exact, energy=energy))
    for each, same in ((other, True), (shifted, False)):
        (decide,) = (d for s, _, d in about_fields((first, each)) if "gives the same motion" in s)
        assert (not any(decide())) is same


def test_the_bracket_of_the_circle_needs_its_factor_two():
    """-(m D + D m) is Poisson; -(m D + D m)/1 with m^2 in the place of m is none."""
    operator, jets = bracket_of("kdv")
    assert decide_jacobi(operator, jets).verdict is Verdict.PROVED
    m, one = jets.field["m"], jets.field.one
    spoiled = (((Term(-(m**2), 1, one), Term(-one, 1, m**2), Term(-one, 3, one)),),)
    assert decide_skew(spoiled, jets).verdict is Verdict.PROVED
    assert decide_jacobi(spoiled, jets).verdict is Verdict.REFUTED


def test_the_holonomy_of_a_wrong_pair_is_not_claimed_as_proved():
    """L of the chiral model with another factor: zero curvature and the trace fail together."""
    text = shipped("spin_chain_chiral").path.read_text(encoding="utf-8")
    wrong = text.replace("hat(Pi - Xi)*(1 + 1/mu))/4", "hat(Pi - Xi)*(1 + 2/mu))/4")
    assert wrong != text
    claims = prove(read_spec_text(wrong.replace(', "lax"]', ', "lax"]'), "chain.toml")).claims
    pairs = [each for each in claims if "psi L" in each.statement or "dL/dt" in each.statement]
    assert [each.verdict for each in pairs] == [Verdict.REFUTED, Verdict.REFUTED]


def test_fluxes_are_exhibited():
    """Of the energy of the spin chain, -K Xi . Omega (Holm 2011, chapter 10)."""
    found = decide_density(emitted("spin_chain"), [emitted("spin_chain").exact.energy])
    assert found.method.endswith("the flux -Pi1*Xi1*K1/I1 - Pi2*Xi2*K2/I2 - Pi3*Xi3*K3/I3")


@pytest.mark.parametrize(("name", "symbol"), [("spin_chain", "Pi1"), ("kdv", "m_s")])
def test_a_density_that_is_not_conserved_is_refuted_by_a_field(name, symbol):
    """The total momentum of a chain of unequal bodies, and the square of a slope of KdV."""
    field = emitted(name).setting.field
    found = decide_density(emitted(name), [field[symbol] ** 2])
    assert found.verdict is Verdict.REFUTED
    assert found.point
    assert found.defect not in ("", "0")


def test_a_wrong_claim_of_a_spec_is_refused():
    """J of KdV with the other sign of c; the counterexample names derivatives at a point."""
    text = shipped("kdv").path.read_text(encoding="utf-8")
    wrong = text.replace("m^3/2 - c*m_s^2/2", "m^3/2 + c*m_s^2/2")
    assert wrong != text
    with pytest.raises(ClaimError, match="integral of J is conserved"):
        prove(read_spec_text(wrong, "kdv.toml")).require()


def test_a_wrong_pair_has_curvature():
    """With 1 - mu in one place the entry at fault is named."""
    text = shipped("spin_chain_chiral").path.read_text(encoding="utf-8")
    wrong = text.replace("hat(Pi - Xi)*(1 + 1/mu))/4", "hat(Pi - Xi)*(1 - 1/mu))/4")
    assert wrong != text
    certificate = prove(read_spec_text(wrong, "chiral.toml"))
    refuted = {claim.kind for claim in certificate.refuted}
    assert "lax" in refuted


def test_fluxes_of_camassa_and_holm_are_those_of_books():
    """These are u m + u^2/2 - alpha^2 u_s^2/2 of m, and u^2 m of the energy, with m = A u."""
    equations = emitted("camassa_holm")
    field = equations.setting.field
    for part, flux in (
        (field["m"], "3/2*u^2 - u*alpha^2*u_ss - 1/2*alpha^2*u_s^2"),
        (equations.exact.energy, "m*u^2"),
    ):
        assert decide_density(equations, [part]).method.endswith(f"the flux {flux}")


def test_what_camassa_and_holm_do_not_conserve_is_refuted():
    """The square of m, though its root is a Casimir."""
    found = decide_density(
        emitted("camassa_holm"), [emitted("camassa_holm").setting.field["m"] ** 2]
    )
    assert found.verdict is Verdict.REFUTED
    text = shipped("camassa_holm").path.read_text(encoding="utf-8")
    wrong = text.replace('["sqrt(m)"]', '["m^2"]')
    claims = prove(read_spec_text(wrong, "c.toml")).claims
    assert [c.verdict for c in claims if c.kind == "casimir"] == [Verdict.REFUTED]


def test_a_velocity_of_another_equation_moves_other_rings():
    """The generic point with velocities of the wrong sign is not the ring by its matrix."""
    grid = grid_of("camassa_holm")
    wrong = {n: {key: -u for key, u in each.items()} for n, each in grid.velocities.items()}
    found = statements(replace(grid, velocities=wrong))
    (same,) = (d for s, d in found.items() if "generic point" in s)
    assert same.verdict is Verdict.REFUTED
    (same,) = (d for s, d in statements(grid).items() if "generic point" in s)
    assert same.verdict is Verdict.PROVED


def test_the_lengths_of_spins_are_a_casimir_and_others_are_not():
    """dot(S, S) is one, the first component is none, and a total derivative is one of no value."""
    text = shipped("landau_lifshitz").path.read_text(encoding="utf-8")
    wrong = text.replace(
        'casimirs  = ["dot(S, S)"]', 'casimirs  = ["dot(S, S)", "S1", "dot(S, S_s)"]'
    )
    verdicts = [
        c.verdict for c in prove(read_spec_text(wrong, "m.toml")).claims if c.kind == "casimir"
    ]
    assert verdicts == [Verdict.PROVED, Verdict.REFUTED, Verdict.PROVED]


# -- on a grid ----------------------------------------------------------------------------


#: Each point moves by the group of scalings and shifts, and by no other point.
SCALED = """
title   = "Momenta of scalings and shifts"
source  = "by hand"
license = "BSD-3-Clause"
routes  = ["lie-poisson"]

[space]
s = { length = "L", size = 32, order = 4 }

[algebra]
name       = "aff(1)"
invariance = "left"

[variables]
S = { role = "momentum" }

[parameters]
c = { default = 2 }
L = { positive = true, default = 20 }

[hamiltonian]
h = "c*S1"

[observables]
Q = { expression = "log(S2)" }

[claims]
conserved = ["energy", "Q"]
"""


def test_what_grows_by_a_constant_is_not_conserved():
    """{S1, S2} = -S2, so that S2_t = c S2 and log(S2) grows everywhere at the rate c.

    A constant has no variation, but the integral c L, and the sum c N over the points.
    """
    equations = derive(read_spec_text(SCALED, "scaled.toml"))
    field = equations.setting.field
    assert equations.exact.rates[1] == field["c"] * field["S2"]
    found = decide_density(equations, equations.exact.emitted[1].values)
    assert found.verdict is Verdict.REFUTED
    assert found.method.endswith("of its rate for fields that do not depend on space")
    assert not [s for s in statements(make_grid(equations)) if s.startswith("Q ")]


def test_a_rate_without_flux_is_none_of_a_constant():
    """Of log(S2) it is S2_s with h = S1 S2_s.

    With h = c S1 S2_s/S2 it is c times the derivative of log(S2), which no homotopy finds.
    """
    for h, flux in (("S1*S2_s", "the flux -S2"), ("c*S1*S2_s/S2", "a flux, since")):
        equations = derive(read_spec_text(SCALED.replace("c*S1", h), "scaled.toml"))
        found = decide_density(equations, equations.exact.emitted[1].values)
        assert found.verdict is Verdict.PROVED
        assert flux in found.method


def test_where_still_fields_tell_no_constant_nothing_is_proved():
    """S2_ss/S2_s, the derivative of log(S2_s), has no value for fields that do not depend on s."""
    equations = derive(read_spec_text(SCALED, "scaled.toml"))
    field = equations.setting.field
    rates = (field.zero, field["S2"] * field["S2_ss"] / field["S2_s"])
    spoiled = replace(equations, exact=replace(equations.exact, rates=rates))
    found = decide_density(spoiled, equations.exact.emitted[1].values)
    assert found.verdict is Verdict.SUPPORTED
    assert "no value for fields that do not depend on space" in found.method


@pytest.mark.parametrize(
    ("rate", "verdict"),
    [
        ("(S1*S2_s - S2*S1_s)/(S1^2 + S2^2)", Verdict.SUPPORTED),
        ("S2_s/S2 - S1_s/S1", Verdict.PROVED),
        ("S2_s/S2 - S1_s/S1 + 1/(1 + S1^2)", Verdict.REFUTED),
    ],
)
def test_an_integral_that_counts_turns_is_not_proved_to_vanish(rate, verdict):
    """That of the derivative of the angle of (S1, S2) is 2 pi times the turns about 0.

    With S = (cos 2 pi s/L, sin 2 pi s/L), which winds once; logarithms of positive fields do not.
    """
    equations = derive(read_spec_text(SCALED.replace("log(S2)", rate), "scaled.toml"))
    (value,), field = equations.exact.emitted[1].values, equations.setting.field
    moved = replace(equations, exact=replace(equations.exact, rates=(field.zero, value)))
    found = decide_density(moved, [field["S2"]])
    assert found.verdict is verdict
    assert ("wind about" in found.method) is (verdict is Verdict.SUPPORTED)


#: What is called by a density: the claim, whether differences keep it, and its term at a point.
CALLED = {
    "landau_lifshitz": ("exp(-dot(S, S))", True, lambda S: np.exp(-(S**2).sum(axis=0))),
    "burgers": ("log(1 + m^2)", False, lambda m: np.log(1 + m[0] ** 2)),
}


@pytest.mark.parametrize("name", CALLED)
def test_densities_may_call_functions(name):
    """Each point has its own: of lengths of spins kept exactly, of others up to O(h^p)."""
    formula, kept, term = CALLED[name]
    text = shipped(name).path.read_text(encoding="utf-8")
    whole = re.sub(r"(?s)\[observables\].*?\n\n", "", text)
    whole = re.sub(r"conserved = .*", 'conserved = ["energy", "Q"]', whole)
    rendered = render(read_spec_text(f'{whole}\n[observables]\nQ = "{formula}"\n', "called.toml"))
    claims = {c.statement: c.verdict for c in rendered.certificate.claims}
    assert claims["the integral of Q is conserved"] is Verdict.PROVED
    assert any(s.startswith("Q is conserved, at N >= ") for s in claims) is kept
    with load_texts(rendered.texts) as system:
        own = system.resize({"s": 16})
        state = np.random.default_rng(4).normal(size=(own.STATE.size // 16, 16))
        given = {"L": 3.0}
        for target in ("numpy", "c"):
            _, found = own.observables(state.ravel(), given, target=target)
            assert found == pytest.approx(term(state).sum() * 3 / 16, rel=1e-12)


def test_what_was_not_examined_of_a_sum_is_said():
    """Functions of a momentum that all velocities give; a rate without a value at equal fields."""
    text = shipped("camassa_holm").path.read_text(encoding="utf-8")
    text = re.sub(r"(?s)\[observables\].*?\n\n", "", text)
    text = re.sub(r"conserved = .*", 'conserved = ["energy", "Q"]', text)
    spec = read_spec_text(f'{text}\n[observables]\nQ = "exp(m)"\n', "called.toml")
    assert "not examined" in explain_change(GenericPoint(derive(spec)), "Q")
    text = SCALED.replace("c*S1", "c*S1 + S2_s^2")
    point = GenericPoint(derive(read_spec_text(text, "scaled.toml")))
    field, (_, densities) = point.lattice.field, point.exact_point
    here, after, further = (field[f"S2{end}"] for end in ("", "[+1]", "[+2]"))
    for rate, reason in (
        (1 / (further - after) - 1 / (after - here), "no value at equal fields"),
        (field["c"], "not 0 at equal fields"),
        (here, "variation of its rate over the points is not 0"),
    ):
        point.exact_point = [field.zero, here * rate], densities
        assert reason in explain_change(point, "Q")


@pytest.mark.parametrize(("strain", "found"), [("Xi1^2 + Xi2^2 + Xi3^2", 0), ("Xi1^2 + Xi2^2", 1)])
def test_waves_of_a_symbol_with_a_block_are_told_of(strain, found):
    """Without stiffness against twist Xi3_t = Omega3_s and Pi3_t has no derivative."""
    text = shipped("spin_chain").path.read_text(encoding="utf-8")
    new = text.replace("dot(Xi, diag(K)*Xi)/2", f"K1*({strain})/2")
    assert new != text
    said = [f for f in prove(read_spec_text(new, "strand.toml")).findings if f.kind == "posed"]
    assert [f.statement for f in said] == [
        "short waves may grow faster the shorter they are, by terms of lower order"
    ] * found


def test_sums_over_points_are_told_from_constants_at_equal_fields():
    """Of log(S2) with the rates g[+1] - g, and what is not 0 or has no value at equal fields."""
    point = GenericPoint(derive(read_spec_text(SCALED.replace("c*S1", "c*S1 + S2_s^2"), "s.toml")))
    field, (_, densities) = point.lattice.field, point.exact_point
    before, here, after = (field[f"S2{end}"] for end in ("[-1]", "", "[+1]"))
    for rate, kept in (
        (after - here, True),
        (after - here + field["c"], False),
        ((after - here) ** 2, False),
        (after - before * 2 + here, True),
        (1 / (after - here) - 1 / (here - before), False),
    ):
        point.exact_point = [field.zero, here * rate], densities
        assert (explain_change(point, "Q") == "") is kept


def statements(grid):
    """What is said of a grid, with what decides it."""
    return {statement: decide() for statement, _, decide in about_grid(grid)}


def test_what_differences_keep_is_said_of_each_density():
    """Of KdV the energy and the momentum exactly, the third integral up to O(h^6)."""
    found = statements(grid_of("kdv"))
    kept = [
        s.split(" is conserved")[0]
        for s, d in found.items()
        if getattr(d, "verdict", None) is Verdict.PROVED and " is conserved" in s
    ]
    assert kept == ["the energy", "the energy", "M", "M"]  # by both kinds of derivatives
    assert any(s.startswith("J is conserved up to O(h^6)") for s in found)
    assert any("Jacobi identity of the bracket fails" in s for s in found)


def test_of_what_the_field_changes_no_order_is_said():
    """J with the other sign of c is refuted, and is not kept up to O(h^6) by points."""
    text = shipped("kdv").path.read_text(encoding="utf-8")
    wrong = text.replace("m^3/2 - c*m_s^2/2", "m^3/2 + c*m_s^2/2")
    found = statements(make_grid(derive(read_spec_text(wrong, "kdv.toml"))))
    assert not [s for s in found if s.startswith("J ")]
    assert [s for s in found if s.startswith("M is conserved")]


def test_the_bracket_of_a_magnet_stays_one_on_a_grid():
    """Brackets at different points commute, and each is that of so(3)."""
    found = statements(grid_of("landau_lifshitz"))
    (jacobi,) = (d for s, d in found.items() if "Jacobi" in s)
    assert jacobi.verdict is Verdict.PROVED


def test_a_bracket_of_few_points_that_is_one_says_nothing_of_more():
    """{m_0, m_1} = m_0 alone: two points have the identity of Jacobi, which is no proof for all."""
    grid = grid_of("kdv")
    ring = grid.windows[0]
    field, (m, *others) = ring.setting.field, ring.setting.state
    rows = [[field.zero] * (1 + len(others)) for _ in ring.setting.state]
    rows[0][1], rows[1][0] = field[m], -field[m]
    few = replace(ring, exact=replace(ring.exact, poisson_tensor=tuple(map(tuple, rows))))
    found = statements(replace(grid, windows=(few, grid.windows[1])))
    assert isinstance(found["the bracket satisfies the Jacobi identity"], Discovery)
    assert not [s for s in found if "Jacobi" in s and "N >=" in s]


def test_a_bracket_with_products_differentiated_loses_the_energy():
    """-(2 m D + m_s) is the same as -(m D + D m) for fields, and not antisymmetric on a grid."""
    grid = grid_of("kdv")
    brackets = dict(grid.brackets)
    (a, b, r) = next(key for key in brackets if key[2] == 1)
    brackets[a, b, r] = brackets[a, b, r] * 2
    found = statements(replace(grid, brackets=brackets))
    (energy,) = (d for s, d in found.items() if s.startswith("the energy") and "differences" in s)
    assert energy.verdict is Verdict.REFUTED


def test_another_antisymmetric_bracket_is_not_that_of_the_rings():
    """Twice the bracket is antisymmetric, too, and so is none; the matrices of rings are others."""
    grid = grid_of("kdv")
    twice = {key: 2 * x for key, x in grid.brackets.items()}
    for brackets in (twice, {}):
        found = statements(replace(grid, brackets=brackets))
        (same,) = (d for s, d in found.items() if "generic point" in s)
        assert same.verdict is Verdict.REFUTED


def test_fourier_derivatives_keep_the_energy_by_a_bracket_whose_terms_balance():
    """With 2 m D + D m in the place of m D + D m the claim about all D is refuted, too."""
    claim = "the energy is conserved, at N points, with Fourier derivatives"
    assert statements(grid_of("kdv"))[claim].verdict is Verdict.PROVED
    point = GenericPoint(emitted("kdv"))
    ((one, *others),) = point.operator[0]
    point.operator = (((Term(2 * one.left, one.order, one.right), *others),),)
    found = statements(replace(grid_of("kdv"), defects=tuple(find_bracket_defects(point))))
    assert found[claim].verdict is Verdict.REFUTED


@pytest.mark.parametrize(("name", "total"), [("kdv", "M"), ("spin_chain", "P")])
def test_sums_that_fourier_derivatives_keep_are_said_where_terms_balance(name, total):
    """With one term times a field nothing is said; nor of J, which has derivatives."""
    claim = f"{total} is conserved, at N points, with Fourier derivatives"
    found = statements(grid_of(name))
    assert found[claim].verdict is Verdict.PROVED
    assert not [s for s in found if s.startswith("J ") and "Fourier" in s]
    point = GenericPoint(emitted(name))
    row = next(n for n, entry in enumerate(point.operator[0]) if any(t.order for t in entry))
    (one, *others), rows = point.operator[0][row], [list(each) for each in point.operator]
    spoiled = one.left * point.setting.field[point.setting.state[0]]
    rows[0][row] = (Term(spoiled, one.order, one.right), *others)
    point.operator = tuple(map(tuple, rows))
    sums = {total: find_sum_defects(point, [total])}
    assert claim not in statements(replace(grid_of(name), sums=sums))


def test_a_wrong_rate_of_the_generic_point_is_seen_in_rings():
    """The two derivations of the motion on a grid are compared."""
    grid = grid_of("spin_chain")
    wrong = (-grid.rates[0], *grid.rates[1:])
    found = statements(replace(grid, rates=wrong))
    (same,) = (d for s, d in found.items() if "generic point" in s)
    assert same.verdict is Verdict.REFUTED
    assert make_grid(grid.equations) is grid
