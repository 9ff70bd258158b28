"""Lifts of maps: they agree with difference quotients, and the identity lifts to itself."""

from fractions import Fraction

from coadjoint.exact import Field
from coadjoint.groups.vector_fields import cotangent_lift, jacobian
from coadjoint.theory.vector_fields import compose, tangent_lift


def test_tangent_lift_is_the_first_order_of_the_map():
    """d/de f(x + e v) = Tf(v) at e = 0, and not -Tf(v)."""
    field = Field(["x", "y", "v", "w", "e"])
    x, y, v, w, e = (field[name] for name in "xyvwe")
    f = (x**3 * y, 1 / (1 + x * y))
    lifted = tangent_lift(field, f, ("x", "y"), (v, w))
    moved = compose(field, f, ("x", "y"), (x + e * v, y + e * w))
    slopes = [field.substitute(field.derivative(c, "e"), {"e": field.zero}) for c in moved]
    assert slopes == list(lifted)
    assert slopes != [-component for component in lifted]


def test_the_identity_lifts_to_the_identity():
    """Tid = id and T*id = id; the Jacobian is the unit matrix."""
    field = Field(["x", "y"])
    here = (field["x"], field["y"])
    vector = (Fraction(2), Fraction(-5))
    assert tangent_lift(field, here, ("x", "y"), vector) == vector
    assert cotangent_lift(field, here, ("x", "y"), vector) == vector
    assert jacobian(field, here, ("x", "y")) == ((1, 0), (0, 1))
