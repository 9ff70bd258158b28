"""Claims about strands: the holonomy, and advected quantities along a strand."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from coadjoint.algebra.matrices import take_image
from coadjoint.derive import derive
from coadjoint.derive.fields.jets import jets_of
from coadjoint.prove import Verdict, fluxes, prove
from coadjoint.prove.certificate import failure_text
from coadjoint.prove.fluxes import decide_law
from coadjoint.prove.strands import about_strand
from coadjoint.spec import read_spec_text
from tests.bodies.lattices import TOPS, strand
from tests.specs import emitted, shipped

#: A heavy top at each point, from the left, and what makes it one from the right.
RIGHT = ('invariance = "left"', 'invariance = "right"')
TOPS_TURN = "dGamma/ds = {}Xi Gamma holds at all times if it does at the beginning"


@pytest.mark.parametrize("name", ["spin_chain", "sp2_strand", "spin_chain_chiral"])
def test_the_holonomy_of_a_strand_keeps_its_trace(name, monkeypatch):
    """Left and right invariant; with the other sign of the bracket the curvature is not zero."""
    first = emitted(name)
    ((statement, kind, decide),) = about_strand(first)
    side = "N S psi" if name == "sp2_strand" else "psi Xi"
    assert statement == (
        f"the trace of the holonomy of dpsi/ds = {side} around the circle is conserved"
    )
    assert kind == "lax"
    found = decide()
    assert found.verdict is Verdict.PROVED
    assert "zero curvature" in found.method
    sign = first.setting.sign
    monkeypatch.setattr(type(first.setting), "sign", property(lambda _: -sign))
    assert decide().verdict is Verdict.REFUTED


def test_the_matrix_of_a_bracket_is_that_between_the_factors():
    """A number in its place is written out; brackets alone have the adjoint action."""
    text = shipped("sp2_strand").path.read_text(encoding="utf-8")
    old = 'N = { shape = [1], form = "antisymmetric"'
    assert old in text
    twice = text.replace("X*N*Y - Y*N*X", "2*X*N*Y - 2*Y*N*X")
    ((statement, _, decide),) = about_strand(derive(read_spec_text(twice, "twice.toml")))
    assert "dpsi/ds = [[0, 2*N12], [-2*N12, 0]] S psi around" in statement
    assert decide().verdict is Verdict.PROVED
    bare = emitted("spin_chain")
    algebra = take_image(bare.setting.algebra, matrices=())
    spoiled = SimpleNamespace(
        spec=bare.spec,
        exact=bare.exact,
        setting=SimpleNamespace(algebra=algebra, advected=bare.setting.advected),
    )
    ((statement, _, _),) = about_strand(spoiled)
    assert "dpsi/ds = psi ad(Xi) around" in statement


def tops(*changes):
    """A strand of tops in a field that is given along it, and what decides the field's claim."""
    first = derive(strand(*TOPS, *changes))
    (examined,) = (each for each in about_strand(first) if each[0].startswith("dGamma/ds"))
    return first, examined


@pytest.mark.parametrize(("changes", "signs"), [((), "-+-"), ((RIGHT,), ["", "-", ""])])
@pytest.mark.parametrize("ends", [(), (("order = 4", 'order = 4, ends = "free"'),)])
def test_what_turns_along_a_strand_does_so_at_all_times(changes, signs, ends):
    """Both equations of Gamma agree, left and right invariant (Holm and Ivanov 2013)."""
    _, (statement, kind, decide) = tops(*changes, *ends)
    assert statement == TOPS_TURN.format(signs[0])
    assert kind == "lax"
    found = decide()
    assert found.verdict is Verdict.PROVED
    assert f"E = dGamma/ds {signs[1]} Xi Gamma, obeys dE/dt = {signs[2]}(dh/dmu) E" in found.method


@pytest.mark.parametrize("changes", [(), (RIGHT,)])
def test_with_a_wrong_sign_it_does_not(changes, monkeypatch):
    """Of both turns; of the rate of Gamma alone, and of Xi alone: each is seen."""
    first, (_, _, decide) = tops(*changes)
    rates = first.exact.rates
    for places in (slice(3, 6), slice(6, 9)):  # of Xi, and of Gamma
        wrong = [-x if n in range(*places.indices(9)) else x for n, x in enumerate(rates)]
        spoiled = replace(first, exact=replace(first.exact, rates=tuple(wrong)))
        (_, (_, _, decide_spoiled)) = about_strand(spoiled)
        found = decide_spoiled()
        assert found.verdict is Verdict.REFUTED
        assert found.point
    sign = first.setting.sign
    monkeypatch.setattr(type(first.setting), "sign", property(lambda _: -sign))
    assert decide().verdict is Verdict.REFUTED


#: Tops at which the momentum along the strand is claimed, and that about the vertical.
CLAIMED = (
    *(TOPS[n] for n in (0, 1, 3)),
    ("[observables]", '[observables]\nV = "dot(Pi, Gamma)"'),
    ('"energy", "P"', '"energy", "P", "V"'),
)


def claims_of(*changes):
    """What is said of the densities of tops, with the findings, by their first words."""
    certificate = prove(strand(*CLAIMED, *changes))
    said = [each for each in certificate.claims if each.statement.startswith("the integral of")]
    found = [each.statement for each in certificate.findings]
    return {each.statement.split()[3]: each for each in said}, found


@pytest.mark.parametrize(("changes", "sign"), [((), "-"), ((RIGHT,), "")])
def test_what_is_kept_where_both_equations_hold_is_said_with_them(changes, sign):
    """Momentum along the strand, whose flux is <nu, Xi> - l, and about the vertical, Gamma . nu.

    As nu = -K Xi; from the right the flux of the second one is the same (Holm and Ivanov 2013).
    """
    said, found = claims_of(*changes)
    where = f"where dGamma/ds = {sign}Xi Gamma"
    assert [each.verdict for each in said.values()] == [Verdict.PROVED] * 3
    assert said["P"].statement == f"the integral of P is conserved {where}"
    assert "Gamma" not in said["the"].statement  # the energy, everywhere
    squares = (f"- 1/2*{x}^2{of}" for x, of in [("Pi{}", "/I{}"), ("Xi{}", "*K{}")])
    flux = " ".join(each.format(n, n) for each in squares for n in (1, 2, 3)) + " + Gamma3*w,"
    assert f"the {flux}" in said["P"].method.replace("flux -", "- ")
    assert "the flux -Xi1*Gamma1*K1 - Xi2*Gamma2*K2 - Xi3*Gamma3*K3," in said["V"].method
    for name in ("P", "V"):
        assert f"{name} is conserved up to O(h^4) by N points, h = L/N, {where}" in found


def test_what_is_kept_everywhere_is_said_without_the_turn():
    """The length of what is advected, which the motion alone keeps."""
    first = derive(strand(*CLAIMED))
    field = first.setting.field
    square = field.sum(field[f"Gamma{n}"] ** 2 for n in (1, 2, 3))
    decision, where = decide_law(first, [square])
    assert (decision.verdict, where) == (Verdict.PROVED, "")
    assert "left out" not in decision.method


def test_a_wrong_momentum_is_kept_nowhere():
    """Another sign of one term, about another axis; the advice names no set, which fields lack."""
    said, found = claims_of(
        ("dot(Pi, Xi)", "dot(Pi, Xi) - 2*Pi[1]*Xi[1]"), ("dot(Pi, Gamma)", "Pi[1]*Gamma[1]")
    )
    assert {name: each.verdict for name, each in said.items()} == {
        "the": Verdict.PROVED,
        "P": Verdict.REFUTED,
        "V": Verdict.REFUTED,
    }
    assert not [each for each in found if "conserved" in each]
    told = failure_text(said["P"])
    assert "the variational derivative of the rate is" in told
    assert told.endswith("Correct the claim, or the formulas of the spec that contradict it.")


def test_a_wrong_turn_along_a_strand_keeps_no_momentum(monkeypatch):
    """With the other sign of it the rate is no total derivative."""
    first = derive(strand(*CLAIMED))
    (density,) = first.setting.components(first.spec.observables[0].formula)
    assert decide_law(first, [density])[0].verdict is Verdict.PROVED
    right = fluxes.turn_along(first)
    field, jets = first.setting.field, jets_of(first.setting)
    back = {name: -field[name] for name in first.setting.advected[0].components}
    assert {*back} == {"Xi1", "Xi2", "Xi3"}

    def turn_wrongly(element):
        named = field.reach(element) & {x for n in (1, 2, 3) for x in jets.towers[f"Gamma{n}"][1:]}
        wrong = {x: field.substitute(right(field[x]), back) for x in named}
        return field.substitute(element, wrong)

    monkeypatch.setattr(fluxes, "turn_along", lambda _: turn_wrongly)
    assert decide_law(first, [density])[0].verdict is Verdict.REFUTED


def test_what_has_another_representation_turns_along_a_strand_too():
    """A symmetric matrix of three rows, as an inertia that is given in space."""
    _, (_, _, decide) = tops(
        ('representation = "vector"', 'representation = "symmetric"'),
        ("0, cos(2*pi*s/L))", "0, cos(2*pi*s/L), 0, 0, 1)"),
    )
    assert decide().verdict is Verdict.PROVED


def test_a_strand_without_advected_quantities_says_nothing_of_them():
    """Of the chain the trace of the holonomy is all; of its ring of tops there is one more."""
    assert len([*about_strand(emitted("spin_chain"))]) == 1
    first, _ = tops()
    assert len([*about_strand(first)]) == 2
