"""Momentum maps over a bracket: lifts, generating functions, and laws that can fail."""

import pytest

from coadjoint.algebra import algebra_by_name
from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.exact.dense import cross
from coadjoint.groups.vector_fields import VectorField
from coadjoint.poisson import canonical, lie_poisson, magnetic
from coadjoint.poisson.momentum_maps import MomentumMap, generating_function, lift

NAMES = ("q1", "q2", "q3", "p1", "p2", "p3")
SO3 = algebra_by_name("so(3)")


def rotations(sign=1, factor=1):
    """Rotations of one particle; sign -1 calls them a right action, a factor scales J."""
    field = Field(NAMES)
    pairs = [(NAMES[n], NAMES[n + 3], field.one) for n in range(3)]
    space = canonical(field, [pair[:2] for pair in pairs])
    q = [field[name] for name in NAMES[:3]]
    units = ([int(i == k) for k in range(3)] for i in range(3))
    turns = [dict(zip(NAMES, SO3.bracket(unit, q), strict=False)) for unit in units]
    generators = tuple(lift(space, pairs, turn) for turn in turns)
    values = tuple(factor * x for x in cross(q, [field[name] for name in NAMES[3:]]))
    return MomentumMap(SO3, space, generators, values, sign)


def test_rotations_obey_every_law():
    """The lift rotations act from the left, keep the bracket, and q x p generates them."""
    J = rotations()
    assert not any(J.action_defects())
    assert not any(J.bracket_defects())
    assert not any(J.field_defects())
    assert not J.cocycle
    q1, q2, p2, q3, p3 = (J.structure.field[n] for n in ("q1", "q2", "p2", "q3", "p3"))
    assert J.values[0] == q2 * p3 - q3 * p2
    assert J.rates(q1) == (0, q3, -q2)


def test_the_laws_see_the_side_and_the_size():
    """Called a right action the commutators are wrong; twice J generates twice the motion."""
    assert any(rotations(sign=-1).action_defects())
    assert any(rotations(factor=2).field_defects())
    assert any(rotations(factor=2).constancy_defects())


def test_a_scaling_does_not_keep_the_bracket():
    """The bracket law sees q -> 2q, p -> 2p."""
    field = Field(("q", "p"))
    plane = canonical(field, [("q", "p")])
    growth = VectorField(field, ("q", "p"), (field["q"], field["p"]))
    J = MomentumMap(algebra_by_name("R^1"), plane, (growth,), (field["q"] * field["p"],))
    assert any(J.bracket_defects())
    with pytest.raises(AlgebraError, match="does not preserve the bracket"):
        generating_function(plane, growth)


def test_generating_functions_by_integration():
    """A squeeze has J = q p; a rotation about a uniform magnetic field has J with B q^2/2."""
    field = Field(("x", "y", "u", "v", "B"))
    x, y, u, v, B = (field[name] for name in field.names)
    plane = magnetic(field, [("x", "u"), ("y", "v")], {("u", "v"): B})
    turn = VectorField(field, plane.names, (-y, x, -v, u))
    J = generating_function(plane, turn)
    # {u, J} = -dJ/dx + B dJ/dv = -v asks for + B x in dJ/dx
    assert field.is_zero(J - (x * v - y * u + B * (x**2 + y**2) / 2))
    assert plane.hamiltonian_vector_field(J) == turn.components


def test_a_degenerate_bracket_does_not_say_its_momentum_map():
    """On so(3)* the map must be declared."""
    field = Field(("x", "y", "z"))
    body = lie_poisson(SO3, field, field.names)
    X = VectorField(field, field.names, (-field["y"], field["x"], field.zero))
    with pytest.raises(AlgebraError, match="the bracket is degenerate"):
        generating_function(body, X)


def test_a_generator_that_is_no_polynomial_is_refused():
    """The message shows the term."""
    field = Field(("q", "p"))
    plane = canonical(field, [("q", "p")])
    X = VectorField(field, plane.names, (1 / field["p"], field.zero))
    with pytest.raises(AlgebraError, match="1/p is not a polynomial"):
        generating_function(plane, X)


def test_counts_are_checked():
    """The message says how many were given."""
    J = rotations()
    with pytest.raises(AlgebraError, match="2 generators and 3 values; expected 3 of each"):
        MomentumMap(SO3, J.structure, J.generators[:2], J.values)


def test_weights_of_symmetric_pairs():
    """{q, p} = 1/2 with a magnetic term: the closedness condition has the weights in it."""
    field = Field(("x", "y", "z", "u", "v", "w"))
    x, y = field["x"], field["y"]
    pairs = [("x", "u"), ("y", "v"), ("z", "w")]
    form = {("u", "v"): field["z"], ("v", "w"): -2 * x, ("u", "w"): y}
    with pytest.raises(AlgebraError, match="not closed"):
        magnetic(field, pairs, form)  # d_z B_uv + d_x B_vw + d_y B_wu = 1 - 2 - 1
    half = field.one / 2
    magnetic(
        field, pairs, {**form, ("u", "w"): -y}, [field.one * 2, 2, 2 * half * 2]
    ).check_jacobi()
    with pytest.raises(AlgebraError, match="not closed"):
        magnetic(field, pairs, {**form, ("u", "w"): -y}, [1, half, 1])
