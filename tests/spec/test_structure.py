"""Structure: algebras and representations declared in a spec are the ones of the books."""

from fractions import Fraction

import pytest

from coadjoint.algebra import algebra_by_name
from coadjoint.errors import AlgebraError, LimitError, SpecError
from tests.specs import RIGID_BODY, spec

BY_BRACKETS = """
title = "Heisenberg"
routes = ["lie-poisson"]
[algebra]
basis = ["e1", "e2", "e3"]
brackets = { "[e1, e2]" = "e3" }
blocks = { plane = ["e1", "e2"], centre = ["e3"] }
[representations.shift]
matrices = { e1 = [[0, 1], [0, 0]] }
[variables]
p = { role = "momentum", block = "plane" }
c = { role = "momentum", block = "centre" }
a = { role = "advected", representation = "shift" }
[hamiltonian]
h = "dot(p, p)/2 + c*a[1]"
"""
BY_MATRICES = """
title = "Rotations"
routes = ["lie-poisson"]
[algebra.matrices]
J1 = [[0, 0, 0], [0, 0, -1], [0, 1, 0]]
J2 = [[0, 0, 1], [0, 0, 0], [-1, 0, 0]]
J3 = [[0, -1, 0], [1, 0, 0], [0, 0, 0]]
[variables]
Pi = { role = "momentum" }
Gamma = { role = "advected", representation = "vector" }
[hamiltonian]
h = "dot(Pi, Pi)/2 + Gamma1"
"""


def refused(*changes, text=BY_BRACKETS, kind=SpecError):
    """The error that a changed spec gives."""
    with pytest.raises(kind) as caught:
        spec(text, *changes)
    return caught.value


def test_declared_brackets_are_the_constants():
    """Heisenberg: [e1, e2] = e3, and the other order has the other sign."""
    algebra = spec(BY_BRACKETS).algebra
    assert {pair: dict(row) for pair, row in algebra.constants.items()} == {(0, 1): {2: 1}}
    other = spec(BY_BRACKETS, ('"[e1, e2]" = "e3"', '"[e2, e1]" = "-2*e3/4"')).algebra
    assert other.constants[0, 1][2] == Fraction(1, 2)
    assert algebra.name == "sample"


def test_combinations_are_exact():
    """Sums, multiples and quotients of basis names, in any order."""
    change = ('"[e1, e2]" = "e3"', '"[e1, e2]" = "2*(e3 - e3/3) + e1*0 + 0"')
    assert dict(spec(BY_BRACKETS, change).algebra.constants[0, 1]) == {2: Fraction(4, 3)}
    assert not spec(BY_BRACKETS, ('"[e1, e2]" = "e3"', '"[e1, e2]" = "0"')).algebra.constants


def test_declared_matrices_give_the_algebra_of_the_catalogue():
    """The hat matrices typed by hand span so(3), and act on vectors as there."""
    declared, known = spec(BY_MATRICES), algebra_by_name("so(3)")
    assert declared.algebra.constants == known.constants
    assert declared.variables[1].shape == (3,)
    assert declared.variables[1].representation.matrices == known.matrices


def test_blocks_give_vectors_and_scalars():
    """A block of one basis vector is a scalar, and a list of names is a block as well."""
    p, c, a = spec(BY_BRACKETS).variables
    assert (p.shape, p.block, c.shape, c.block, a.shape) == ((2,), (0, 1), (), (2,), (2,))
    swapped = spec(BY_BRACKETS, ('block = "plane"', 'block = ["e2", "e1"]')).variables[0]
    assert swapped.block == (1, 0)
    assert spec(BY_BRACKETS, ('block = "centre"', 'block = "e3"')).variables[1].block == (2,)


def test_parameters_have_exact_defaults():
    """One number serves all components; lists go row by row; decimals are exact."""
    for default, values in (
        ("0.1", [Fraction(1, 10)] * 4),
        ("[[1, '2.5'], [3, '1/3']]", [1, Fraction(5, 2), 3, Fraction(1, 3)]),
    ):
        declared = spec(RIGID_BODY + f"[parameters.A]\nshape = [2, 2]\ndefault = {default}\n")
        assert list(declared.parameters[1].default) == values
        assert declared.parameters[1].components == ("A11", "A12", "A21", "A22")
    assert spec(RIGID_BODY, (", default = [1, 2, 3]", "")).parameters[0].default is None


@pytest.mark.parametrize(
    ("change", "key", "found", "said"),
    [
        (('"[e1, e2]"', '"[e1, e4]"'), "algebra.brackets.[e1, e4]", "e4", "[e1, e2]"),
        (('"[e1, e2]"', '"e1 e2"'), "algebra.brackets.e1 e2", "e1 e2", "[e1, e2]"),
        (('"e3" }', '"e1*e2" }'), "algebra.brackets.[e1, e2]", "", "no linear combination"),
        (('"e3" }', '"e3 + 1" }'), "algebra.brackets.[e1, e2]", "", "no linear combination"),
        (('"e3" }', '"e3^2" }'), "algebra.brackets.[e1, e2]", "", "no linear combination"),
        (('"e3" }', '"2/e3" }'), "algebra.brackets.[e1, e2]", "", "no linear combination"),
        (('"e3" }', '"e5" }'), "algebra.brackets.[e1, e2]", "e5", "'e5' is not declared"),
        (('["e1", "e2"]', '["e1", "e5"]'), "algebra.blocks.plane[2]", "e5", "e1, e2, e3"),
        (('"e1", "e2", "e3"', '"e1", "_e2", "e3"'), "algebra.basis[2]", "_e2", "not a name"),
        (("e1 = [[0", "e7 = [[0"), "representations.shift.matrices.e7", "e7", "e1, e2, e3"),
        (("[0, 0]]", "[0]]"), "representations.shift.matrices.e1", "2, 1", "2 rows of 2"),
        (("[[0, 1], [0, 0]]", "[]"), "representations.shift.matrices.e1", "", "1 rows of 1"),
        (("s.shift]", "s.vector]"), "representations.vector", "vector", "every algebra has"),
        (('n = "shift"', 'n = "shft"'), "variables.a.representation", "shft", "'shift'?"),
        ((', representation = "shift"', ""), "variables.a", "a", 'representation = "vector"'),
        (('"plane" }', '"plne" }'), "variables.p.block", "plne", "'plane'?"),
        (('"plane" }', '["e1", "e1"] }'), "variables.p.block", "e1, e1", "each name once"),
        (('"shift" }', '"shift", block = "e1" }'), "variables.a.block", "e1", "Remove block"),
        (
            ('"plane" }', '"plane", representation = "shift" }'),
            "variables.p.representation",
            "shift",
            "Remove representation",
        ),
    ],
)
def test_misfit_is_refused_at_its_place(change, key, found, said):
    """Unknown names, wrong sizes and keys out of place are shown with what would fit."""
    error = refused(change)
    assert (error.key, error.found) == (key, found)
    assert said in str(error)
    assert str(error).endswith("^")


@pytest.mark.parametrize(
    ("change", "text", "said"),
    [
        (('"e3" }', '"e3", "[e2, e1]" = "e3" }'), BY_BRACKETS, "declared twice"),
        (('"[e1, e2]" = "e3"', '"[e1, e1]" = "e3"'), BY_BRACKETS, "[e1, e1] is declared"),
        (('"e3" }', '"e3", "[e1, e3]" = "e1" }'), BY_BRACKETS, "Jacobi"),
        (("[[0, 1], [0, 0]]", "[[0, 1], [0, 0]], e3 = [[1, 0], [0, 0]]"), BY_BRACKETS, "commute"),
        (('n = "shift"', 'n = "vector"'), BY_BRACKETS, "no matrices"),
        (("J3 = [[0, -1", "J3 = [[0, -2"), BY_MATRICES, "not in the span"),
        (
            ("[[0, 0, 1], [0, 0, 0], [-1, 0, 0]]", "[[0, 0, 0], [0, 0, 2], [0, -2, 0]]"),
            BY_MATRICES,
            "linearly dependent",
        ),
        (('name = "so(3)"', 'name = "so3"'), RIGID_BODY, "'so(3)'?"),
    ],
)
def test_what_makes_no_algebra_is_refused_with_its_line(change, text, said):
    """The error names the law that fails and points into the file."""
    error = refused(change, text=text, kind=AlgebraError)
    assert said in str(error)
    assert str(error).startswith(f"sample.toml:{error.line}:")


def test_incomplete_matrices_are_refused():
    """A declared basis needs a matrix for each of its names."""
    error = refused(
        ("[algebra.matrices]", '[algebra]\nbasis = ["J1", "J2", "J3", "J4"]\n[algebra.matrices]'),
        text=BY_MATRICES,
    )
    assert (error.key, error.found) == ("algebra.matrices", "J4")


@pytest.mark.parametrize(
    ("shape", "default", "found"),
    [
        ("[3]", "[1, 2]", "a list of 2"),
        ("[]", "[1]", "a list of 1"),
        ("[2]", "[[1], [2]]", "a list of 2"),
        ("[2, 2]", "[1, 2]", "a list of 2"),
        ("[2, 2]", "[[1, 2], [3]]", "a list of 2 lists"),
        ("[2, 2]", "[[1, 2], 3]", "a list of 2 lists"),
    ],
)
def test_default_of_another_shape_is_refused(shape, default, found):
    """The message has both shapes."""
    text = RIGID_BODY + f"[parameters.A]\nshape = {shape}\ndefault = {default}\n"
    error = refused(text=text)
    assert error.key == "parameters.A.default"
    assert str(error.found).startswith(found)
    assert shape in str(error)


def test_default_that_is_not_positive_is_refused():
    """A positive parameter has a positive default."""
    error = refused(("[1, 2, 3]", "[1, -2.5, 3]"), text=RIGID_BODY)
    assert error.found == "-5/2"


def test_large_algebras_are_refused_with_their_limit():
    """A long basis and many matrices are refused before they are worked on."""
    names = ", ".join(f'"e{n}"' for n in range(257))
    error = refused(('"e1", "e2", "e3"', names), kind=LimitError)
    assert error.limit == "STATE_COMPONENTS"
    rows = "[" + ", ".join(["[" + "0, " * 64 + "1]"] * 65) + "]"
    error = refused(("J1 = ", f"J0 = {rows}\nJ1 = "), text=BY_MATRICES, kind=LimitError)
    assert error.limit == "MATRIX_ENTRIES"
