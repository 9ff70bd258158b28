"""Ideals: what vanishes where relations hold is told from what does not."""

from fractions import Fraction

import pytest
from sympy.polys.rings import PolyElement

from coadjoint.exact import Field
from coadjoint.prove import Verdict
from coadjoint.prove.ideals import Ideal
from coadjoint.prove.zero import UndecidedError, decide_zero

NAMES = ("P1", "P2", "P3", "G1", "G2", "G3")


@pytest.fixture
def plane():
    """The field of two vectors and the ideal of P . G = 0."""
    field = Field(NAMES)
    P, G = ([field[name] for name in NAMES[n : n + 3]] for n in (0, 3))
    product = field.sum(p * g for p, g in zip(P, G, strict=True))
    return field, Ideal(field, [product], "dot(P, G) = 0"), product


def test_multiples_of_a_relation_vanish_and_others_do_not(plane):
    """A multiple over any denominator is in the ideal; a factor alone is not."""
    field, ideal, product = plane
    assert ideal.contains(product * field["P1"] ** 2 / field["G2"])
    assert not ideal.contains(field["P1"])
    assert ideal.remainder(field["P1"] * field["G1"]) == -(
        field["P2"] * field["G2"] + field["P3"] * field["G3"]
    )


def test_zero_where_a_relation_holds_is_proved_and_named(plane):
    """|P x G|^2 = |P|^2 |G|^2 where P . G = 0 (Lagrange's identity), and nowhere else."""
    field, ideal, _ = plane
    P, G = ([field[name] for name in NAMES[n : n + 3]] for n in (0, 3))
    cross = [P[i - 2] * G[i - 1] - P[i - 1] * G[i - 2] for i in range(3)]
    squares = [field.sum(x * x for x in vector) for vector in (cross, P, G)]
    defect = squares[0] - squares[1] * squares[2]
    assert decide_zero([defect], field).verdict is Verdict.REFUTED
    decision = decide_zero([defect], field, ideal)
    assert decision.verdict is Verdict.PROVED
    assert "dot(P, G) = 0" in decision.method


def test_counterexample_lies_on_the_zero_set(plane):
    """What is not zero there is refuted at a point where the relation holds."""
    field, ideal, product = plane
    decision = decide_zero([field["P1"] * field["G1"]], field, ideal)
    assert decision.verdict is Verdict.REFUTED
    point = dict.fromkeys(NAMES, Fraction(1)) | {n: Fraction(v) for n, v in decision.point.items()}
    assert field.evaluate(product, point, Fraction, None) == 0
    assert point["P1"] * point["G1"] == Fraction(decision.defect)


def test_relation_that_is_linear_in_nothing_still_proves():
    """c^2 = 1 - s^2 on the circle; what is nonzero there is refuted by its remainder."""
    field = Field(["c", "s"])
    c, s = field["c"], field["s"]
    circle = Ideal(field, [c**2 + s**2 - 1], "c^2 + s^2 = 1")
    assert not circle.is_solved
    assert decide_zero([c**4 - (1 - s**2) ** 2], field, circle).verdict is Verdict.PROVED
    refuted = decide_zero([c**3 - c], field, circle)
    assert refuted.verdict is Verdict.REFUTED
    c_value, s_value = (float(refuted.point[name]) for name in "cs")
    assert c_value**2 + s_value**2 == pytest.approx(1, abs=1e-14)
    assert c_value**3 - c_value == pytest.approx(float(refuted.defect), abs=1e-14)


def test_where_a_sum_of_squares_vanishes_each_square_does():
    """The ideal of x^2 + x*y + y^2 holds neither x nor y, but its only real point is the origin."""
    field = Field(["x", "y"])
    x, y = field["x"], field["y"]
    point = Ideal(field, [x**2 + x * y + y**2], "x^2 + x*y + y^2 = 0")
    assert not point.contains(x)
    assert decide_zero([x, y], field, point).verdict is Verdict.PROVED
    assert decide_zero([x + 1], field, point).verdict is Verdict.REFUTED


def test_real_zero_sets_may_be_smaller_than_ideals_tell():
    """A definite quartic vanishes at the origin alone, and no sign tells: supported, no more."""
    field = Field(["x", "y"])
    x, y = field["x"], field["y"]
    point = Ideal(field, [x**4 + x**2 * y**2 + x * y**3 + y**4], "that = 0")
    decision = decide_zero([x], field, point)
    assert decision.verdict is Verdict.SUPPORTED
    assert "points where that = 0" in decision.method
    assert decide_zero([x + 1], field, point).verdict is Verdict.REFUTED


@pytest.mark.parametrize("constant", [1, Fraction(1, 10**6)])
@pytest.mark.parametrize("power", [2, 4])
def test_empty_zero_sets_decide_nothing(power, constant):
    """Nothing real satisfies x^2 + 1 = 0; neither is x zero there, nor is it not."""
    field = Field(["x"])
    empty = Ideal(field, [field["x"] ** power + constant], "x^2 + 1 = 0")
    for element in (field["x"], field.zero, field["x"] ** power + constant):
        with pytest.raises(UndecidedError, match=r"x\^2 \+ 1 = 0"):
            decide_zero([element], field, empty)


def test_several_relations_are_reduced_together():
    """The twisted cubic y = x^2, z = x^3 lies on x z = y^2, which neither relation gives alone."""
    field = Field(["x", "y", "z"])
    x, y, z = field["x"], field["y"], field["z"]
    cubic = Ideal(field, [y - x**2, z - x**3], "y = x^2, z = x^3")
    assert cubic.contains(x * z - y**2)
    assert not Ideal(field, [y - x**2], "y = x^2").contains(x * z - y**2)
    assert cubic.is_solved


def test_relations_that_share_a_symbol_are_solved_one_after_the_other():
    """Both x = y and x = z leave one symbol free, and give the other two."""
    field = Field(["x", "y", "z"])
    x, y, z = field["x"], field["y"], field["z"]
    diagonal = Ideal(field, [x - y, x - z], "x = y = z")
    assert dict(diagonal.solved) == {"x": z, "y": z}
    decision = decide_zero([x + y - z], field, diagonal)
    assert decision.verdict is Verdict.REFUTED
    assert decision.method.startswith("exact")


def test_only_named_variables_are_solved_for(plane):
    """Parameters are not solved for where variables are named."""
    field, _, product = plane
    assert set(Ideal(field, [product], "", ("G2",)).solved) == {"G2"}


def test_quadratic_products_are_factored_without_luck(monkeypatch):
    """Two energies of a top, of eight symbols: SymPy's lifting takes up to minutes, or none."""

    def refuse(self):
        raise AssertionError("lifted from random points")

    monkeypatch.setattr(PolyElement, "factor_list", refuse)
    field = Field(["P1", "P2", "P3", "G1", "G3", "s", "c"])
    p1, p2, p3, g1, g3, s, c = map(field.__getitem__, field.names)
    energy = (p1**2 + p2**2) / 2 + s * p3**2 + c * g3 + g1 / 2
    ideal = Ideal(field, [(energy - 3) * (2 * energy - 9) * p1**2], "that = 0")
    roots = [branch.solved for branch in ideal.branches]
    assert len(roots) == 3
    assert {"P1": 0} in [dict(root) for root in roots]
    values = {str(field.substitute(energy, root)) for root in roots if "P1" not in root}
    assert values == {"3", "9/2"}
