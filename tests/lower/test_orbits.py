"""Tests of what decides whether methods on coadjoint orbits apply to a system."""

from __future__ import annotations

from dataclasses import replace

import pytest

from coadjoint.lower import orbits
from coadjoint.lower.orbits import find_spheres, is_bracket, stays_on_orbits
from coadjoint.lower.program import Add, Divide, Multiply, Negate, Symbol
from coadjoint.methods import ACTION, STRUCTURED, Sphere, list_structured
from coadjoint.render.solvers import describe_structured, select_programs
from tests.specs import lowered

#: Files of discrete gradients.
GRADIENTS = ("average_gradient", "discrete_gradient")
ON_ORBITS = {"midpoint", "gauss", "coadjoint_mean", *GRADIENTS}
#: Spheres by system, from the order of the momenta and vectors that its spec declares.
SPHERES = {
    "rigid_body": (Sphere((0, 1, 2)),),
    "heavy_top": (Sphere((3, 4, 5), (0, 1, 2)),),
    "kirchhoff": (Sphere((3, 4, 5), (0, 1, 2)),),
    "steklov": (Sphere((3, 4, 5), (0, 1, 2)),),
    "se2_pendulum": (),
    "two_field_top": (),
    "so5_body": (),
    "sl2_r2": (),
}


@pytest.mark.parametrize("system", SPHERES)
def test_spheres_are_those_of_the_algebra(system):
    """One for each factor so(3) and se(3), and none where there is another factor."""
    programs = lowered(system)
    assert stays_on_orbits(programs)
    assert find_spheres(programs) == SPHERES[system]


@pytest.mark.parametrize(
    ("system", "why"),
    [
        ("heavy_top_damped", "friction"),
        ("lorenz_gyrostat", "a bracket that is affine"),
        ("kepler", "a canonical bracket"),
        ("magnetic_bottle", "a bracket with a field"),
        ("quadrotor", "thrust"),
        ("stochastic_rigid_body", "noise"),
        ("chaplygin_ball", "constraints"),
        ("suslov_so5", "a linear bracket without the identity of Jacobi"),
    ],
)
def test_other_motions_do_not_stay_on_orbits(system, why):
    """Neither where something is added to the bracket, nor where no Lie algebra has it."""
    assert not stays_on_orbits(lowered(system)), why


def test_the_identity_of_jacobi_alone_refuses_a_bracket(monkeypatch):
    """Of linear almost-Poisson brackets one has it, `chaplygin_sleigh`, and one has not."""
    assert stays_on_orbits(lowered("chaplygin_sleigh"))
    monkeypatch.setattr(orbits, "_is_of_lie_algebra", lambda programs: True)
    assert stays_on_orbits(lowered("suslov_so5"))


@pytest.mark.parametrize("system", ["euler_disk", "rattleback", "kepler", "guiding_centre"])
def test_motions_are_brackets(system):
    """Of momenta along a distribution too; a spoiled tensor or gradient is none."""
    programs = lowered(system)
    assert is_bracket(programs)
    for name in ACTION:
        first, *others = programs[name].outputs
        wrong = replace(
            programs[name], outputs=(replace(first, value=Negate(first.value)), *others)
        )
        assert not is_bracket(programs | {name: wrong}), name


def test_a_symmetric_part_is_no_bracket():
    """What a tensor adds that a gradient does not see: it has to be antisymmetric."""
    programs = lowered("rigid_body")
    own = programs["bracket_vector"]
    first, *others = own.outputs
    # (Pi2/I2) v1 - (Pi1/I1) v2: zero for v = (Pi1/I1, Pi2/I2, ...), and v1 has a diagonal entry
    one, other = (
        Multiply(Divide(Symbol(momentum), Symbol(inertia)), Symbol(along))
        for momentum, inertia, along in (
            ("Pi2", "I2", own.state[3]),
            ("Pi1", "I1", own.state[4]),
        )
    )
    more = Add(one, Negate(other))
    wrong = replace(own, outputs=(replace(first, value=Add(first.value, more)), *others))
    assert not is_bracket(programs | {"bracket_vector": wrong})


def test_a_spoiled_function_is_caught():
    """A sign that is wrong in the gradient or in the bracket makes the system another one."""
    programs = lowered("heavy_top")
    for name in ("energy_gradient", "bracket_vector"):
        own = programs[name]
        first, *others = own.outputs
        wrong = replace(own, outputs=(replace(first, value=Negate(first.value)), *others))
        assert not stays_on_orbits(programs | {name: wrong}), name
    wrong = replace(
        programs["bracket_vector"],
        outputs=tuple(reversed(programs["bracket_vector"].outputs)),
    )
    assert find_spheres(programs | {"bracket_vector": wrong}) == ()


@pytest.mark.parametrize(
    ("system", "methods"),
    [
        ("heavy_top", {"midpoint", "gauss", "coadjoint_mean", "spherical_midpoint", *GRADIENTS}),
        ("so5_body", {*ON_ORBITS, "isospectral_midpoint"}),
        ("se2_pendulum", {*ON_ORBITS, "isospectral_midpoint"}),
        ("heisenberg", ON_ORBITS),
        ("heavy_top_damped", {"midpoint", "gauss", *GRADIENTS}),
        ("euler_disk", {"midpoint", "gauss", *GRADIENTS}),
        ("suslov", {"midpoint", "gauss"}),
    ],
)
def test_a_system_lists_the_methods_that_apply(system, methods):
    """By its functions, each method in three orders."""
    found = describe_structured(select_programs(lowered(system).values()))["structured"]["methods"]
    names = {each.name for each in found}
    assert {each.file for each in found} == methods
    composed = methods - {"gauss", *GRADIENTS}
    assert all({f"{name}{order}" for order in ("", 4, 6)} <= names for name in composed)
    assert {each.order for each in found if each.file in composed} == {2, 4, 6}
    assert {"gauss4", "gauss6", "gauss8"} <= names


def test_every_method_says_what_it_expects():
    """For messages: a clause about motions; and functions that are missing leave it out."""
    for each in STRUCTURED.values():
        assert each.expects
        assert each.keeps
        assert each not in list_structured(["rhs", "noise"])
    names = {each.name for each in list_structured([*ACTION, "orbits"])}
    assert "coadjoint_mean" in names
    assert "spherical_midpoint" not in names
