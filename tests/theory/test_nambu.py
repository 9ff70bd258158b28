"""What holds for every Nambu bracket, with undetermined functions, and each proof spoiled once."""

import pytest

from coadjoint.algebra import algebra_by_name
from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.poisson import lie_poisson, nambu
from coadjoint.poisson.structure import PoissonStructure, antisymmetric
from coadjoint.theory.nambu import (
    mixing,
    quadratic_nambu,
    rigid_body_pendulum,
    undetermined_nambu,
)

#: A quadratic form of each signature, with the Killing signature of its algebra.
FORMS = [
    ([[2, 1, 0], [1, 2, 1], [0, 1, 2]], "so(3)", (0, 3, 0)),
    ([[1, 0, 0], [0, 1, 0], [0, 0, -1]], "so(2,1)", (2, 1, 0)),
    ([[-1, 0, 0], [0, 1, 0], [0, 0, -1]], "so(2,1)", (2, 1, 0)),
    ([[1, 0, 0], [0, 3, 0], [0, 0, 0]], "se(2)", (0, 1, 2)),
    ([[0, 1, 0], [1, 0, 0], [0, 0, 0]], "e(1,1)", (1, 0, 2)),
    ([[0, 0, 0], [0, -2, 0], [0, 0, 0]], "h(1)", (0, 0, 3)),
    ([[0, 0, 0], [0, 0, 0], [0, 0, 0]], "R^3", (0, 0, 3)),
]


@pytest.mark.parametrize("dimension", [3, 4])
def test_nambu_brackets_satisfy_jacobi_for_all_smooth_functions(dimension):
    """Undetermined distinguished functions and density: every component is zero."""
    structure = undetermined_nambu(dimension)
    assert structure.jacobi_defects() == {}
    assert all(structure.tensor[i][j] for i in range(dimension) for j in range(i))


def test_the_proof_for_undetermined_functions_can_fail():
    """One entry with the other sign, or one that no gradient gives, leaves a defect."""
    structure = undetermined_nambu()
    field, tensor = structure.field, structure.tensor
    right = {(0, 1): tensor[0][1], (0, 2): tensor[0][2], (1, 2): tensor[1][2]}
    for spoiled in (right | {(0, 1): -right[0, 1]}, right | {(1, 2): field["c1_x2"]}):
        wrong = PoissonStructure(field, structure.names, antisymmetric(field, 3, spoiled))
        assert list(wrong.jacobi_defects()) == [(0, 1, 2)]


def test_functions_of_the_casimir_are_casimirs():
    """{f, Phi(c)} = 0 with undetermined f, Phi and c: gradients along grad c move nothing."""
    structure = undetermined_nambu(3, ["f", "slope"])
    field = structure.field
    c, f = ([field[f"{name}_x{n}"] for n in (1, 2, 3)] for name in ("c1", "f"))
    along = [field["slope"] * entry for entry in c]  # grad Phi(c), the slope being Phi'(c)
    for row in structure.tensor:
        assert field.sum(e * s for e, s in zip(row, along, strict=True)) == 0
        assert field.sum(e * s for e, s in zip(row, f, strict=True)) != 0
    assert structure.is_casimir(field["c1"])
    assert not structure.is_casimir(field["f"])


def test_the_bracket_is_minus_the_triple_product():
    """{x_i, x_j} = -density eps_ijk dc/dx_k, typed in."""
    structure = undetermined_nambu()
    field = structure.field
    c1, c2, c3 = (field["density"] * field[f"c1_x{n}"] for n in (1, 2, 3))
    zero = field.zero
    assert structure.tensor == ((zero, -c3, c2), (c3, zero, -c1), (-c2, c1, zero))


def test_the_motion_keeps_under_unimodular_mixing():
    """(alpha c + beta h, gamma c + delta h) moves like (c, h) where the determinant is one."""
    found = mixing()
    field = found.field
    alpha, beta, gamma = field["alpha"], field["beta"], field["gamma"]
    one = {"delta": (1 + beta * gamma) / alpha}
    assert [field.substitute(m, one) for m in found.mixed] == list(found.motion)
    assert all(found.motion)


def test_the_motion_is_scaled_by_another_determinant():
    """The mixed motion is alpha delta - beta gamma times the motion, so it differs in general."""
    found = mixing()
    assert [m - found.determinant * x for m, x in zip(found.mixed, found.motion, strict=True)] == [
        0,
        0,
        0,
    ]
    assert all(m != x for m, x in zip(found.mixed, found.motion, strict=True))
    two = {"alpha": 2, "beta": 0, "gamma": 0, "delta": 1}
    numbers = {name: found.field.number(value) for name, value in two.items()}
    doubled = [found.field.substitute(m, numbers) for m in found.mixed]
    assert doubled == [2 * x for x in found.motion]


@pytest.mark.parametrize(("form", "kind", "killing"), FORMS)
def test_quadratic_brackets_are_classified_by_signature(form, kind, killing):
    """The Nambu bracket of x.Cx/2 is the Lie-Poisson bracket of the algebra that is named."""
    found = quadratic_nambu(form)
    assert found.kind == kind
    assert found.algebra.killing_signature() == killing
    field = Field(["x", "y", "z"])
    x = [field[name] for name in field.names]
    c = sum((form[i][j] * x[i] * x[j] / 2 for i in range(3) for j in range(3)), field.zero)
    assert (
        lie_poisson(found.algebra, field, field.names).tensor
        == nambu(field, field.names, [c]).tensor
    )
    if kind not in ("e(1,1)",):  # the others are in the catalogue: the same center and series
        named = algebra_by_name(kind)
        assert named.killing_signature() == killing
        assert len(named.center()) == len(found.algebra.center())
        assert named.is_abelian == found.algebra.is_abelian


def test_classification_sees_one_wrong_sign():
    """Another sign in C is another algebra."""
    assert quadratic_nambu([[1, 0, 0], [0, 1, 0], [0, 0, 1]]).kind != "so(2,1)"
    assert quadratic_nambu([[1, 0, 0], [0, 1, 0], [0, 0, -1]]).kind == "so(2,1)"


def test_a_form_that_is_not_symmetric_is_refused():
    """The message shows the two entries."""
    with pytest.raises(AlgebraError, match=r"5 at \(1, 2\) and 0 at \(2, 1\)"):
        quadratic_nambu([[1, 5, 0], [0, 1, 0], [0, 0, 1]])


def pendulum():
    """The reduction with symbols for the moments of inertia."""
    field = Field(["x1", "x2", "x3", "I1", "I2", "I3"], slots=1)
    x, inertia = field.names[:3], [field[name] for name in field.names[3:]]
    return field, rigid_body_pendulum(field, x, inertia), inertia


def test_the_rigid_body_is_a_pendulum():
    """Exactly theta'' = -A sin(2 theta), with A constant and theta, x3 canonical up to a factor."""
    field, found, (i1, i2, i3) = pendulum()
    x1, x2, x3 = (field[name] for name in ("x1", "x2", "x3"))
    assert field.is_zero(found.acceleration + found.amplitude * found.sine)
    assert not field.is_zero(found.acceleration - found.amplitude * found.sine)
    assert field.is_zero(found.conjugate**2 - (1 - i3 / i1) * (1 - i3 / i2))
    assert field.is_zero(found.rate - found.conjugate * x3 / i3)
    assert field.derivative(found.cylinder, "x3") == 0
    euler = [
        (1 / i3 - 1 / i2) * x2 * x3,
        (1 / i1 - 1 / i3) * x3 * x1,
        (1 / i2 - 1 / i1) * x1 * x2,
    ]
    slopes = field.gradient(found.amplitude, ("x1", "x2", "x3"))
    assert sum((a * b for a, b in zip(slopes, euler, strict=True)), field.zero) == 0
    slopes = field.gradient(found.rate, ("x1", "x2", "x3"))
    second = sum((a * b for a, b in zip(slopes, euler, strict=True)), field.zero)
    assert field.is_zero(second - found.acceleration)
