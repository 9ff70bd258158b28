"""The bracket in momenta along a distribution, against brackets computed by hand."""

import math
from dataclasses import replace
from fractions import Fraction
from itertools import chain
from operator import mul

import pytest

from coadjoint.prove import Verdict
from coadjoint.prove.almost_poisson import (
    ReducedBracket,
    _inverse_of_numbers,
    about_reduced_bracket,
    about_reduced_jacobi,
)
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.integrability import Basis
from coadjoint.prove.zero import Decision, decide_zero
from tests.constrained import BALL, PARTICLE, PENDULUM, SLEIGH, SUSLOV, derived, motion


def examined(rates):
    """Every claim about the bracket with its decision."""
    found = {}
    for statement, kind, examine in chain(
        about_reduced_bracket(rates), about_reduced_jacobi(rates)
    ):
        result = examine()
        decided = result if isinstance(result, Decision) else decide_zero(result, rates.field)
        found[statement] = (kind, decided.verdict)
    return found


def spoiled(change):
    """The ball's motion, its emitted tensor changed."""
    (equations, *_) = derived(BALL).values()
    rows = [list(row) for row in equations.exact.poisson_tensor]
    change(rows, equations.setting.field)
    exact = replace(equations.exact, poisson_tensor=tuple(map(tuple, rows)))
    return ConstrainedRates(replace(equations, exact=exact))


@pytest.mark.parametrize("text", [PARTICLE, SLEIGH, SUSLOV, PENDULUM, BALL])
def test_motions_are_brackets_with_the_energy(text):
    """In momenta along the distribution every motion is J grad H, J antisymmetric."""
    found = examined(motion(text))
    assert len(found) == 4
    assert {verdict for _, verdict in found.values()} == {Verdict.PROVED}
    assert [kind for kind, _ in found.values()] == ["bracket"] * 3 + ["jacobi"]


def test_the_bracket_of_the_particle_by_hand():
    """{M_v, M_u} = <p, [D_u, D_v]> = -m w, {x, M_u} = 1, {z, M_u} = y."""
    (equations, *_) = derived(PARTICLE).values()
    names, field = equations.setting.state, equations.setting.field
    tensor = equations.exact.poisson_tensor
    entry = {(a, b): tensor[i][j] for i, a in enumerate(names) for j, b in enumerate(names)}
    assert entry["v", "u"] == -field["m"] * field["w"]
    assert (entry["x", "u"], entry["z", "u"], entry["y", "v"]) == (1, field["y"], 1)
    assert entry["z", "v"] == entry["x", "y"] == 0


def test_the_bracket_of_the_sleigh_by_hand():
    """{M_omega, M_v} = -<p, [J, P1]> = -<p, P2> = -m (u + a omega) = -m a omega."""
    bracket = ReducedBracket(motion(SLEIGH).equations)
    field, names = bracket.field, bracket.names
    value = bracket.tensor[names.index("omega")][names.index("v")]
    assert value == -field["m"] * field["a"] * field["omega"]


def test_a_sleigh_satisfies_jacobi_as_anything_of_two_variables():
    """The defect has three arguments, so that two momenta alone have none."""
    assert "the bracket satisfies the Jacobi identity, as any of 2 variables" in examined(
        motion(SLEIGH)
    )


def test_the_defect_of_the_particle_by_hand():
    """{z, {M_u, M_v}} + cyclic = [D_u, D_v] z - P [D_u, D_v] z = -1 + y^2/(1 + y^2)."""
    bracket = ReducedBracket(motion(PARTICLE).equations)
    field = bracket.field
    triple = tuple(map(bracket.names.index, ("z", "u", "v")))
    y = field["y"]
    expected = -1 / (1 + y**2)
    point = dict.fromkeys(field.names, 2)
    place = tuple(sorted(triple))
    (found,) = (v for t, v in bracket._defects_at(point, True).items() if t == place)
    assert abs(found) == abs(field.evaluate(expected, point, lambda x: x, None))
    assert any(
        statement.startswith("the bracket is not Poisson on any open set, for almost all")
        for statement in examined(motion(PARTICLE))
    )


def test_exact_defects_and_those_at_a_point_agree():
    """The Schouten bracket in exact form, evaluated, is that of the numbers."""
    bracket = ReducedBracket(motion(PARTICLE).equations)
    field = bracket.field
    point = {name: n + 2 for n, name in enumerate(field.names)}
    whole = [field.evaluate(d, point, lambda x: x, None) for d in bracket.jacobi_defects()]
    numbers = list(bracket._defects_at(point, True).values())
    assert sorted(x for x in whole if x) == sorted(x for x in numbers if x)
    assert any(whole)


def test_a_holonomic_constraint_has_a_poisson_bracket():
    """With dz = k dx in place of dz = y dx the bracket is canonical and satisfies Jacobi."""
    found = examined(motion(PARTICLE, ("w == y*u", "w == k*u")))
    assert found["the bracket satisfies the Jacobi identity"] == ("jacobi", Verdict.PROVED)


def test_forces_stand_beside_the_bracket():
    """Dissipation leaves the bracket as it is and joins the motion."""
    damped = ("[constraints]", '[dissipation]\nR = "k*v^2/2"\n[constraints]')
    found = examined(motion(SLEIGH, damped))
    (statement,) = (s for s in found if "the motion of" in s)
    assert statement.endswith("is the bracket with H and the forces")
    assert found[statement][1] is Verdict.PROVED


def test_moving_constraints_add_a_drift_to_the_bracket():
    """Where u == k the energy is not H, and no kernel computes the bracket."""
    moving = ("u == 0", "u == k")
    found = examined(motion(SLEIGH, moving))
    assert {verdict for _, verdict in found.values()} == {Verdict.PROVED}
    law = "the motion of (M_omega, M_v) is the bracket with H and the drift along beta"
    assert found[law] == ("bracket", Verdict.PROVED)
    assert any(text.endswith("and H = E - <p, beta>") for text in found)
    assert motion(SLEIGH, moving).equations.exact.poisson_tensor is None


@pytest.mark.parametrize("change", ["k", "k*m", "t*k"])
def test_the_energy_is_not_h_where_constraints_move(change, monkeypatch):
    """With H = E in its place the gradient is another one."""
    timed = ("[lagrangian]", '[time]\nname = "t"\n[lagrangian]') if "t" in change else ("", "")
    rates = motion(SLEIGH, ("u == 0", f"u == {change}"), timed)
    found = examined(rates)
    assert {verdict for _, verdict in found.values()} == {Verdict.PROVED}
    drift = Basis.drift.func
    monkeypatch.setattr(Basis, "drift", property(lambda self: tuple(0 * x for x in drift(self))))
    bracket = ReducedBracket(rates.equations)
    assert decide_zero(bracket.gradient_defects(), rates.field).verdict is Verdict.REFUTED
    assert decide_zero(bracket.motion_defects(rates), rates.field).verdict is Verdict.REFUTED


def test_kept_constraints_emit_no_bracket():
    """Momenta of velocities that are not independent have no bracket of their own."""
    assert motion(PENDULUM).equations.exact.poisson_tensor is None


def test_a_wrong_bracket_is_refuted():
    """With the sign of {M1, M2} turned on both sides the motion is not the bracket with H."""

    def turn(rows, field):
        rows[0][1], rows[1][0] = rows[1][0], rows[0][1]

    found = examined(spoiled(turn))
    (statement,) = (s for s in found if "is the bracket with H" in s)
    assert found[statement][1] is Verdict.REFUTED
    assert found["the bracket is antisymmetric"][1] is Verdict.PROVED


def test_a_bracket_that_is_not_antisymmetric_is_refuted():
    """One entry off, and antisymmetry is refuted."""

    def add(rows, field):
        rows[0][3] += field["m"]

    assert examined(spoiled(add))["the bracket is antisymmetric"][1] is Verdict.REFUTED


def test_a_wrong_energy_has_another_gradient():
    """An energy that counts gravity twice is not H of the momenta."""
    (equations, *_) = derived(BALL).values()
    field = equations.setting.field
    more = equations.exact.energy + field["m"] * field["g"] * field["Gamma3"]
    wrong = replace(equations, exact=replace(equations.exact, energy=more))
    defects = ReducedBracket(wrong).gradient_defects()
    assert decide_zero(defects, field).verdict is Verdict.REFUTED


def test_defects_with_functions_are_known_by_bounds():
    """The blade dz = sin(y) dx has the defect -cos(y)/(1 + sin(y)^2), whose sign is certain."""
    bracket = ReducedBracket(motion(PARTICLE, ("w == y*u", "w == sin(y)*u")).equations)
    _, decision = bracket.defect_somewhere()
    assert decision.verdict is Verdict.PROVED
    place = tuple(sorted(map(bracket.names.index, ("z", "u", "v"))))
    point = {name: Fraction(0) for name in bracket.field.names} | {
        "y": Fraction(1),
        "m": Fraction(1),
    }
    values = bracket._defects_at(point, False)
    expected = math.cos(1) / (1 + math.sin(1) ** 2)
    assert abs(float(values[place].mid)) == pytest.approx(expected, rel=1e-12)


def test_bounds_that_hold_zero_show_no_defect():
    """With dz = cos(x) dx the constraint is holonomic, whatever is rounded."""
    bracket = ReducedBracket(motion(PARTICLE, ("w == y*u", "w == cos(x)*u")).equations)
    assert bracket.defect_somewhere() is None


def test_matrices_of_numbers_are_inverted_by_elimination():
    """A product with the inverse is 1, also where a pivot must be looked for; singular ones end."""
    rows = [[0, 2, 1], [3, 0, 1], [1, 1, 1]]
    matrix = [[Fraction(x) for x in row] for row in rows]
    back = _inverse_of_numbers(matrix)
    product = [[sum(map(mul, row, column)) for column in zip(*back, strict=True)] for row in matrix]
    assert product == [[int(i == j) for j in range(3)] for i in range(3)]
    with pytest.raises(ZeroDivisionError):
        _inverse_of_numbers([[Fraction(1), Fraction(2)], [Fraction(2), Fraction(4)]])
