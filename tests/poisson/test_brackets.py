"""The constructors of Poisson structures, and what they refuse."""

import pytest

from coadjoint.algebra import algebra_by_name
from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.poisson import (
    canonical,
    declare_bracket,
    lie_poisson,
    magnetic,
    nambu,
)
from coadjoint.theory import freeze_bracket

PAIRS = [(f"r{n}", f"v{n}") for n in (1, 2, 3)]


def monopole_field():
    """Positions, velocities and the strength of a monopole, with the distance adjoined."""
    field = Field([*(r for r, _ in PAIRS), *(v for _, v in PAIRS), "lam"], slots=1)
    distance = field.call("sqrt", sum((field[r] ** 2 for r, _ in PAIRS), field.zero))
    return field, distance


def two_form(field, distance, power=3):
    """B_ij = lam eps_ijk r_k / r^power."""
    r = [field[name] for name, _ in PAIRS]
    strength = field["lam"] / distance**power
    return {
        ("v1", "v2"): strength * r[2],
        ("v2", "v3"): strength * r[0],
        ("v3", "v1"): strength * r[1],
    }


def test_canonical_brackets_are_those_of_position_and_momentum():
    """{q_a, p_b} = delta_ab, and q and p commute among themselves."""
    field = Field(["q1", "q2", "p1", "p2"])
    structure = canonical(field, [("q1", "p1"), ("q2", "p2")])
    table = [[structure.bracket(field[a], field[b]) for b in field.names] for a in field.names]
    assert table == [[0, 0, 1, 0], [0, 0, 0, 1], [-1, 0, 0, 0], [0, -1, 0, 0]]
    structure.check_jacobi()
    assert structure.generic_rank() == 4


def test_the_monopole_is_a_closed_two_form():
    """B = lam r/r^3 is closed away from the origin, so the bracket is Poisson, of full rank."""
    field, distance = monopole_field()
    structure = magnetic(field, PAIRS, two_form(field, distance))
    assert structure.jacobi_defects() == {}
    assert structure.generic_rank() == 6


def test_a_field_with_sources_is_refused():
    """B = lam r/r^2 has a divergence; the message shows it."""
    field, distance = monopole_field()
    with pytest.raises(AlgebraError, match=r"not closed: dB has the component .*lam") as caught:
        magnetic(field, PAIRS, two_form(field, distance, power=2))
    assert caught.value.triple == ["v1", "v2", "v3"]


def test_a_magnetic_field_may_not_depend_on_momenta():
    """The message names the momentum."""
    field = Field(["x", "y", "p", "q"])
    with pytest.raises(AlgebraError, match=r"depends on q; expected a function of x, y"):
        magnetic(field, [("x", "p"), ("y", "q")], {("p", "q"): field["q"]})


def test_a_magnetic_term_names_momenta():
    """A pair of coordinates is refused with the momenta there are."""
    field = Field(["x", "y", "p", "q"])
    with pytest.raises(AlgebraError, match="'x' is not a coordinate; expected one of p, q"):
        magnetic(field, [("x", "p"), ("y", "q")], {("x", "q"): field.one})


def test_nambu_agrees_in_three_and_four_dimensions():
    """With the fourth coordinate as second Casimir, R^4 has the bracket of R^3."""
    field = Field(["x", "y", "z", "w"])
    x, y, z, w = (field[name] for name in field.names)
    c = x**3 + y * z + z**2
    small, large = nambu(field, ("x", "y", "z"), [c]), nambu(field, field.names, [c, w])
    for i in range(3):
        for j in range(3):
            assert small.tensor[i][j] == large.tensor[i][j]
    assert any(map(any, small.tensor))
    assert large.generic_rank() == 2


def test_nambu_functions_are_casimirs_with_any_density():
    """{f, c} = 0 for each distinguished function; another function is none."""
    field = Field(["x", "y", "z", "w"])
    x, y, z, w = (field[name] for name in field.names)
    structure = nambu(field, field.names, [x * y - z**2, w**2 + x], density=1 + x**2)
    structure.check_jacobi()
    assert structure.is_casimir((x * y - z**2) * (w**2 + x))
    assert not structure.is_casimir(x * y)


def test_nambu_wants_the_right_number_of_functions():
    """The message shows the number given and the one expected."""
    field = Field(["x", "y", "z"])
    with pytest.raises(AlgebraError, match="2 distinguished functions are given; expected 1"):
        nambu(field, field.names, [field["x"], field["y"]])


def test_frozen_brackets_are_constant_and_take_a_cocycle():
    """{x_i, x_j} = -c_ij^k p_k + w_ij."""
    algebra = algebra_by_name("so(3)")
    field = Field(algebra.basis)
    structure = freeze_bracket(algebra, field, algebra.basis, [0, 0, 5], cocycle={(1, 2): 2})
    assert [structure.tensor[i][j] for i, j in ((0, 1), (0, 2), (1, 2))] == [-5, 0, 2]
    structure.check_jacobi()


@pytest.mark.parametrize("brackets", [{(0, 1): 1, (1, 0): -1}, {(1, 1): 1}])
def test_a_declared_pair_stands_once(brackets):
    """A pair given twice or with itself is refused by name."""
    field = Field(["q", "p"])
    with pytest.raises(AlgebraError, match=r"\{p, [pq]\} is declared (twice|with itself)"):
        declare_bracket(field, field.names, {pair: field.number(n) for pair, n in brackets.items()})


def test_lie_poisson_wants_a_coordinate_for_each_generator():
    """The message shows how many are given."""
    field = Field(["x", "y"])
    with pytest.raises(AlgebraError, match="2 coordinates are given; expected 3"):
        lie_poisson(algebra_by_name("so(3)"), field, field.names)


def test_the_sign_of_a_lie_poisson_bracket_is_a_sign():
    """2 is refused."""
    algebra = algebra_by_name("so(3)")
    with pytest.raises(AlgebraError, match="bracket is 2; expected -1"):
        lie_poisson(algebra, Field(algebra.basis), algebra.basis, 2)
