"""Vector fields: refusals, the operator they are, Hamiltonian fields."""

import pytest

from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.groups.vector_fields import VectorField, lie_derivative
from coadjoint.theory.jets import JetField
from coadjoint.theory.vector_fields import (
    curl,
    divergence,
    flow,
    hamiltonian_vector_field,
    push_forward,
)


@pytest.fixture
def plane():
    """Coordinates x and y."""
    return Field(["x", "y"])


def test_components_must_match_the_coordinates(plane):
    """Three components in the plane are refused with both counts."""
    with pytest.raises(AlgebraError) as caught:
        VectorField(plane, ("x", "y"), (plane.one, plane.one, plane.one))
    assert caught.value.found == 3
    assert "in (x, y) has 3 components; expected 2" in str(caught.value)


def test_a_map_needs_its_own_inverse(plane):
    """A push-forward by a map with a wrong inverse is refused, the coordinate named."""
    x, y = plane["x"], plane["y"]
    X = VectorField(plane, ("x", "y"), (x, y))
    with pytest.raises(AlgebraError) as caught:
        push_forward((x + y**2, y), (x + y**2, y), X)
    assert caught.value.coordinate == "x"
    assert caught.value.found in str(caught.value)
    assert "expected x again" in str(caught.value)


def test_a_one_sided_inverse_is_no_inverse(plane):
    """Both orders are tried: (x, y) -> (x, 0) after its would-be inverse is not the identity."""
    x, y = plane["x"], plane["y"]
    X = VectorField(plane, ("x", "y"), (x, y))
    with pytest.raises(AlgebraError, match="take y to 0"):
        push_forward((x, 0 * y), (x, y), X)


def test_a_vector_field_is_a_derivation(plane):
    """X(f g) = X(f) g + f X(g), and numbers as components become elements."""
    x, y = plane["x"], plane["y"]
    X = VectorField(plane, ("x", "y"), (1, x / y))
    f, g = x**2 + y, x * y
    assert X.derivative(f * g) == X.derivative(f) * g + f * X.derivative(g)
    assert X.derivative(f * g) != X.derivative(f) * g
    assert X.components[0].__class__ is x.__class__


def test_coordinates_not_moved_are_constants(plane):
    """A field in x alone leaves y where it is."""
    X = VectorField(plane, ("x",), (plane["y"],))
    assert X.derivative(plane["y"]) == 0
    assert flow(X, plane.number(2), order=3) == (plane["x"] + 2 * plane["y"],)


def test_hamiltonian_fields_have_no_divergence_and_keep_their_energy():
    """X_H(H) = 0, div X_H = 0 and [X_F, X_H] = -X_{F,H}, for undetermined F and H."""
    names = (("q1", "q2"), ("p1", "p2"))
    field = JetField([*names[0], *names[1]], ["F", "H"], order=3)
    F, H = field["F"], field["H"]
    X_F, X_H = (hamiltonian_vector_field(field, *names, function) for function in (F, H))
    assert X_H.derivative(H) == 0
    assert divergence(X_H) == 0
    assert X_H.derivative(F) == -X_F.derivative(H)
    bracket = hamiltonian_vector_field(field, *names, X_H.derivative(F))
    assert lie_derivative(X_F, X_H) == -bracket
    assert lie_derivative(X_F, X_H) != bracket


def test_curl_of_a_gradient_and_divergence_of_a_curl():
    """``rot grad f = 0`` and ``div rot u = 0``; rot u itself is not 0."""
    names = ("x", "y", "z")
    field = JetField(names, ["f", "u", "v", "w"], order=2)
    assert curl(VectorField(field, names, field.gradient(field["f"], names))).is_zero()
    u = VectorField(field, names, (field["u"], field["v"], field["w"]))
    assert divergence(curl(u)) == 0
    assert not curl(u).is_zero()
