"""Families as loops: what a part computes is what the family says, and few operations do it."""

from dataclasses import replace

import pytest

from coadjoint.errors import CrossCheckError
from coadjoint.lower.families import lower_family
from coadjoint.lower.family_check import check_loops
from coadjoint.methods import ACTION
from tests.families import (
    CHAIN,
    CLOSED,
    HELD,
    PEAKONS,
    PLANAR,
    RING,
    TOPS,
    VORTICES,
    WALLS,
    family_of,
    read,
)

TEXTS = {"ring": RING, "chain": CHAIN, "vortices": VORTICES, "peakons": PEAKONS, "tops": TOPS}
TEXTS |= {"walls": WALLS, "closed": CLOSED, "held": HELD, "planar": PLANAR}
#: Operations of a member and of a pair, counted by hand before the kernels were looked at. A spin:
#: three sums of neighbours, three by J, the anisotropy 2 D S3, a cross product. Vortices: two
#: differences, the square of the distance, one quotient; for each vortex of a pair its strength by
#: 2 and two products for each of two sums, of which two are subtracted.
BY_HAND = {"ring": (21, 0), "vortices": (8, 18)}


@pytest.fixture(scope="module")
def families():
    """The equations of the generic member of each system."""
    return {name: family_of(read(text)) for name, text in TEXTS.items()}


@pytest.mark.parametrize("name", TEXTS)
def test_loops_compute_what_the_family_says(families, name):
    """Rates, their derivative along a vector, energy and observables, of every kind of family."""
    loops = lower_family(families[name])
    more = {"constraint_residual", "projection"} if name == "tops" else set(ACTION)
    if name in ("ring", "peakons"):  # a quadratic energy, and one with kinks
        more = set()
    assert set(loops) == {"rhs", "jacobian_vector", "energy", "observables", *more}
    check_loops(families[name], loops)


FUNCTIONS = ["rhs", "jacobian_vector", "energy", "observables"]
CASES = [
    (name, function) for name in ("ring", "chain", "vortices", "walls") for function in FUNCTIONS
]


@pytest.mark.parametrize(
    ("name", "function"),
    [
        *CASES,
        ("tops", "constraint_residual"),
        ("tops", "projection"),
        *((name, function) for name in ("chain", "vortices") for function in ACTION),
    ],
)
def test_a_wrong_part_is_seen(families, name, function):
    """The check above can fail: the outputs of one part change places or signs."""
    loops = lower_family(families[name])
    own = loops[function]
    field = "member" if own.member is not None else "finish"
    part = getattr(own, field)
    program = part.program
    first, *others = program.outputs
    swapped = replace(program, outputs=(*others, first) if others else (program.outputs * 2)[:2])
    loops[function] = replace(own, **{field: replace(part, program=swapped)})
    with pytest.raises(CrossCheckError, match="rung 2"):
        check_loops(families[name], loops)


def test_a_wrong_partner_is_seen(families):
    """A pair's term that reads the partner where it should read the member."""
    loops = lower_family(families["vortices"])
    own = loops["rhs"].partners
    reads = tuple(
        replace(read, of_partner=not read.of_partner) if read.blocks == 0 else read
        for read in own.reads
    )
    loops["rhs"] = replace(loops["rhs"], partners=replace(own, reads=reads))
    with pytest.raises(CrossCheckError, match="rung 2"):
        check_loops(families["vortices"], loops)


@pytest.mark.parametrize("function", ["rhs", "jacobian_vector"])
def test_a_wrong_term_of_the_second_member_is_seen(families, function):
    """A pair's terms of both members: those of the second change places."""
    loops = lower_family(families["vortices"])
    part = loops[function].partners
    first, second, third, fourth = part.program.outputs
    program = replace(part.program, outputs=(first, second, fourth, third))
    loops[function] = replace(loops[function], partners=replace(part, program=program))
    with pytest.raises(CrossCheckError, match="rung 2"):
        check_loops(families["vortices"], loops)


def test_pairs_of_two_members_have_one_quotient():
    """Also where each of them has one sum with one quotient, and what stands above it differs."""
    rates = "-sum(i, j, i < j, c[i]*c[j]*log((x[i] - x[j])^2 + (y[i] - y[j])^2))"
    changes = [(rates, "sum(i, j, i < j, c[i]^2*c[j]^2/(1 + (x[i] - x[j])^2))")]
    loops = lower_family(family_of(read(VORTICES, *changes)))["rhs"]
    assert loops.pair_sums == 1
    assert loops.partners.program.operation_counts()["divide"] == 1


@pytest.mark.parametrize("name", BY_HAND)
def test_operations_are_few(families, name):
    """No more of them than an expert would write."""
    loops = lower_family(families[name])["rhs"]
    member, pair = BY_HAND[name]
    assert sum(loops.member.program.operation_counts().values()) <= member
    if loops.partners is not None:
        assert sum(loops.partners.program.operation_counts().values()) <= pair


def test_ends_have_rates_of_their_own(families):
    """The chain couples members two apart: two at each end lack neighbours."""
    loops = lower_family(families["chain"])["rhs"]
    assert [place for place, _ in loops.ends] == [0, 1, -2, -1]
    assert len(loops.first_ends) == len(loops.last_ends) == 2
