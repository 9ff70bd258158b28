"""Claims about strands: the holonomy, and advected quantities along a strand."""

from dataclasses import replace

import pytest

from coadjoint.derive import derive
from coadjoint.prove import Verdict
from coadjoint.prove.strands import about_strand
from tests.bodies.lattices import TOPS, strand
from tests.specs import emitted

#: A heavy top at each point, from the left, and what makes it one from the right.
RIGHT = ('invariance = "left"', 'invariance = "right"')
TOPS_TURN = "dGamma/ds = {}Xi Gamma holds at all times if it does at the beginning"


@pytest.mark.parametrize("name", ["spin_chain", "sp2_strand", "spin_chain_chiral"])
def test_the_holonomy_of_a_strand_keeps_its_trace(name, monkeypatch):
    """Left and right invariant; with the other sign of the bracket the curvature is not zero."""
    first = emitted(name)
    ((statement, kind, decide),) = about_strand(first)
    side = "S psi" if name == "sp2_strand" else "psi Xi"
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
