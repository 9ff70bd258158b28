"""Structure: variables have the place, and parameters the shape, that the spec gives them."""

from fractions import Fraction

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.errors import SpecError
from tests.spec.texts import BY_BRACKETS, check_shown, refused
from tests.specs import RIGID_BODY, spec


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
        (('n = "shift"', 'n = "shft"'), "variables.a.representation", "shft", "'shift'?"),
        ((', representation = "shift"', ""), "variables.a", "a", 'representation = "coadjoint"'),
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
    check_shown(error, key, found, said)


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


def test_parameter_may_be_a_matrix_of_a_form():
    """Its components are the entries that it keeps; in formulas it is the whole matrix."""
    text = RIGID_BODY.replace(
        "[lagrangian]",
        'N = { shape = [3], form = "antisymmetric", default = [1, 2, 3] }\n'
        'S = { shape = [6], form = "symmetric", positive = true, default = 1 }\n'
        'J = { form = "antisymmetric", default = -1 }\n'
        '[observables]\nx = "dot(Pi, N*S*Pi) + N[3, 1] + S[3, 2] + N12 + S33 + J[2, 1]"\n'
        "[lagrangian]",
    )
    declared = spec(text)
    _, N, S, J = declared.parameters
    assert (N.shape, N.value_shape, N.components) == ((3,), (3, 3), ("N12", "N13", "N23"))
    assert S.components == ("S11", "S12", "S13", "S22", "S23", "S33")
    assert (J.components, J.default) == (("J12",), (-1,))
    value = derive(declared).observables["x"]
    n, s, p = (
        sympy.symbols(names) for names in ("N12 N13 N23", "S11 S12 S13 S22 S23 S33", "Pi1 Pi2 Pi3")
    )
    antisymmetric = sympy.Matrix([[0, n[0], n[1]], [-n[0], 0, n[2]], [-n[1], -n[2], 0]])
    symmetric = sympy.Matrix([s[:3], [s[1], *s[3:5]], [s[2], s[4], s[5]]])
    Pi = sympy.Matrix(p)
    by_hand = (Pi.T * antisymmetric * symmetric * Pi)[0] - n[1] + s[4] + n[0] + s[5]
    assert sympy.expand(value - by_hand + sympy.Symbol("J12")) == 0


@pytest.mark.parametrize(
    ("declared", "key", "found", "said"),
    [
        ('shape = [4], form = "antisymmetric"', "parameters.A.form", 4, "n(n - 1)/2"),
        ('shape = [3, 3], form = "antisymmetric"', "parameters.A.form", 9, "n(n - 1)/2"),
        ('shape = [2], form = "symmetric"', "parameters.A.form", 2, "n(n + 1)/2"),
        ('shape = [3], form = "matrix"', "parameters.A.form", "matrix", "'antisymmetric' or"),
        (
            'shape = [3], form = "symmetric", default = [[1, 2], [2, 3]]',
            "parameters.A.default",
            "a list of 2 lists of 2",
            "a list of 3 numbers",
        ),
        (
            'shape = [3], form = "symmetric", positive = true, default = [1, 0, 1]',
            "parameters.A.default",
            "0",
            "positive",
        ),
    ],
)
def test_parameter_that_fills_no_matrix_is_refused(declared, key, found, said):
    """The kept entries are a list, as many as a matrix of the form has."""
    error = refused(("[lagrangian]", f"A = {{ {declared} }}\n[lagrangian]"), text=RIGID_BODY)
    assert (error.key, said in str(error)) == (key, True), str(error)
    assert error.found == found


# -- matrices -------------------------------------------------------------------------------------

MANAKOV = """
title = "x"
routes = ["lie-poisson"]
[algebra]
name = "so(4)"
[variables]
M = { role = "momentum", form = "antisymmetric" }
S = { role = "advected", representation = "symmetric", form = "symmetric" }
Q = { role = "advected", representation = "columns", form = "matrix" }
[hamiltonian]
h = "-trace(M*M)/4 + trace(S*transpose(Q)) + M[2, 1]*S[2, 1] + M12*S12 + Q[4, 3]"
"""


def test_matrices_are_stored_by_their_independent_entries():
    """The entries of so(4) above the diagonal, of S with it, of Q all."""
    declared = spec(MANAKOV)
    M, S, Q = declared.variables
    assert (M.shape, S.shape, Q.shape) == ((6,), (10,), (16,))
    assert M.components == ("M12", "M13", "M14", "M23", "M24", "M34")
    assert M.components == tuple(name.replace("E", "M") for name in declared.algebra.basis)
    assert S.components[:5] == ("S11", "S12", "S13", "S14", "S22")
    assert Q.components[:5] == ("Q11", "Q12", "Q13", "Q14", "Q21")
    assert {v.value_shape for v in declared.variables} == {(4, 4)}


@pytest.mark.parametrize(
    ("change", "key", "found", "said"),
    [
        (('"so(4)"', '"u(2)"'), "variables.M.form", 4, "n(n - 1)/2"),
        (('"antisymmetric" }', '"matrix" }'), "variables.M.form", 6, "n^2 components"),
        (('"symmetric", form = "symmetric"', '"vector", form = "symmetric"'), None, 4, "(n + 1)/2"),
        (('"antisymmetric" }', '"antisym" }'), "variables.M.form", "antisym", "'antisymmetric'?"),
        (("M[2, 1]", "M[2]"), "hamiltonian.h", None, "a scalar + a 4-vector"),
        (("M[2, 1]", "M[5, 1]"), "hamiltonian.h", "M[5, 1]", "1 to 4"),
        (("M12", "M21"), "hamiltonian.h", "M21", "not declared"),
        (
            ("trace(M*M)", "dot(M, M)"),
            "hamiltonian.h",
            "a 4 by 4 matrix and a 4 by 4 matrix",
            "dot",
        ),
    ],
)
def test_matrix_that_does_not_fit_is_refused(change, key, found, said):
    """Counts that fill no square, and formulas that take the matrix for a list."""
    error = refused(change, text=MANAKOV)
    assert key is None or error.key == key
    assert found is None or error.found == found
    assert said in str(error)


def test_single_component_may_be_a_matrix():
    """so(2): one entry above the diagonal, stored as a list of one."""
    text = MANAKOV.replace("so(4)", "so(2)").replace("Q[4, 3]", "Q[2, 1]")
    M = spec(text).variables[0]
    assert (M.shape, M.components, M.matrix_size) == ((1,), ("M12",), 2)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            '"momentum" }',
            '"momentum", default = [1, 2] }',
            r"(?s)default of 'Pi'.*a list of 3.*\[1, 2\]",
        ),
        ('"velocity" }', '"velocity", default = 1 }', "velocity 'Omega' has a default.*state"),
    ],
)
def test_where_a_motion_begins_fits_the_state(old, new, said):
    """A default has the shape of its quantity, and velocities of an algebra have none."""
    with pytest.raises(SpecError, match=said):
        spec(RIGID_BODY, (old, new))
    momentum = spec(RIGID_BODY, ('"momentum" }', '"momentum", default = [1, 2, "0.5"] }')).state[0]
    assert momentum.default == (1, 2, Fraction(1, 2))
