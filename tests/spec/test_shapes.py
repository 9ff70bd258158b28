"""Shapes: each function and operator takes what it says, and refuses the rest in words."""

from dataclasses import replace

import pytest

from coadjoint.spec.core import tree
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.faults import ExpressionError
from coadjoint.spec.core.shapes import FUNCTIONS, shape_of, words

SCOPE = {
    "s": (),
    "u": (3,),
    "w": (3,),
    "Omega": (3,),
    "q": (4,),
    "A": (3, 3),
    "B": (3, 3),
    "C": (2, 3),
    "F": (4, 4),
    "Omega1": (),
}


@pytest.mark.parametrize(
    ("text", "shape"),
    [
        ("1", ()),
        ("s*u", (3,)),
        ("u*s", (3,)),
        ("-u + w", (3,)),
        ("A*u", (3,)),
        ("C*A", (2, 3)),
        ("A*transpose(C)", (3, 2)),
        ("A/s", (3, 3)),
        ("A^2", (3, 3)),
        ("F^3", (4, 4)),
        ("A^-1", (3, 3)),
        ("s^-2", ()),
        ("u[3]", ()),
        ("C[2, 3]", ()),
        ("Omega1", ()),
        ("dot(q, q)", ()),
        ("cross(u, w)", (3,)),
        ("commutator(A, B)", (3, 3)),
        ("trace(F)", ()),
        ("transpose(C)", (3, 2)),
        ("det(A)", ()),
        ("inverse(A)*u", (3,)),
        ("hat(u)", (3, 3)),
        ("complex(C, 2*C)", (4, 6)),
        ("diag(q)", (4, 4)),
        ("diag(A)", (3,)),
        ("norm(q)", ()),
        ("qmul(q, conjugate(q))", (4,)),
        ("rotate(q, u)", (3,)),
        ("rotation(q)*A", (3, 3)),
        ("rotation(C)*translation(C)", (2,)),
        ("outer(u, q)", (3, 4)),
        ("rows(u, w)", (2, 3)),
        ("rows(q)", (1, 4)),
        ("vector(s, s*s, u[1])", (3,)),
        ("cross(u, vector(s, 0, s))", (3,)),
        ("C[2]", (3,)),
        ("rows(A[1], cross(A[2], A[3]), u)*w", (3,)),
        ("sqrt(s) + sin(s)*cos(s)/tan(s) - exp(s)*log(s)", ()),
        ("sinh(s)/cosh(s) - tanh(s) + asin(s) - acos(s) + atan(s) - atan2(s, u[1])", ()),
        ("asinh(s)*atanh(s)", ()),
        ("abs(s) + min(s, 1) - max(s, u[1])*sign(s) + pow(s, u[2])", ()),
    ],
)
def test_shape_of_what_fits(text, shape):
    """Each function and operator has the shape a book gives it."""
    assert shape_of(read_expression(text), SCOPE) == shape


def test_every_function_is_tried_above():
    """No function of the table is missing from the test above."""
    texts = " ".join(test_shape_of_what_fits.pytestmark[0].args[1][n][0] for n in range(42))
    assert all(f"{name}(" in texts for name in FUNCTIONS)


@pytest.mark.parametrize(
    ("text", "guilty", "said"),
    [
        ("Omgea", "Omgea", ["'Omgea' is not declared", "Did you mean 'Omega'?"]),
        ("xyzzy + s", "xyzzy", ["'xyzzy' is not declared", "Declared are s, u, w"]),
        ("u + A", "u + A", ["a 3-vector + a 3 by 3 matrix"]),
        ("u + 1", "u + 1", ["a 3-vector + a scalar"]),
        ("u + q", "u + q", ["a 3-vector + a 4-vector"]),
        ("u*w", "u*w", ["dot(a, b)", "cross(a, b)"]),
        ("u*A", "u*A", ["transpose(A)*a"]),
        ("A*q", "A*q", ["a 3 by 3 matrix * a 4-vector"]),
        ("A*C", "A*C", ["a 3 by 3 matrix * a 2 by 3 matrix"]),
        ("s/u", "s/u", ["division by a 3-vector", "a scalar divisor"]),
        ("u/A", "u/A", ["inverse(A)*x"]),
        ("u^2", "u^2", ["a 3-vector has no power", "dot(a, a)"]),
        ("C^2", "C^2", ["a 2 by 3 matrix has no power"]),
        ("F^-1", "F^-1", ["a 4 by 4 matrix is inverted", "at most 3 by 3"]),
        ("dot(A, B)", "dot(A, B)", ["trace(transpose(A)*B)"]),
        ("dot(u, q)", "dot(u, q)", ["a 3-vector and a 4-vector"]),
        ("dot(u)", "dot(u)", ["1 argument", "two vectors"]),
        ("cross(q, q)", "cross(q, q)", ["two 3-vectors"]),
        ("det(F)", "det(F)", ["a 4 by 4 matrix", "inside the kernels"]),
        ("inverse(C)", "inverse(C)", ["a 2 by 3 matrix"]),
        ("sin(u)", "sin(u)", ["sin is given a 3-vector", "a scalar"]),
        ("hat(q)", "hat(q)", ["a 4-vector", "a 3-vector"]),
        ("diag(C)", "diag(C)", ["a 2 by 3 matrix"]),
        ("norm(s)", "norm(s)", ["a scalar", "a vector"]),
        ("trace(C)", "trace(C)", ["a square matrix"]),
        ("transpose(u)", "transpose(u)", ["a 3-vector", "a matrix"]),
        ("commutator(A, F)", "commutator(A, F)", ["a 3 by 3 matrix and a 4 by 4 matrix"]),
        ("u[0]", "u[0]", ["out of range", "1 to 3", "counted from 1"]),
        ("u[4]", "u[4]", ["u[4]", "1 to 3"]),
        ("u[1, 2]", "u[1, 2]", ["u is a 3-vector", "u[1]"]),
        ("A[4]", "A[4]", ["A[4]", "1 to 3"]),
        ("1 + A[1]", "1 + A[1]", ["a scalar + a 3-vector"]),
        ("outer(A, u)", "outer(A, u)", ["a 3 by 3 matrix and a 3-vector", "two vectors"]),
        ("outer(u)", "outer(u)", ["1 argument"]),
        ("rows(u, q)", "rows(u, q)", ["a 3-vector and a 4-vector", "of one length"]),
        ("rows(s, s)", "rows(s, s)", ["a scalar and a scalar", "vectors"]),
        ("rows(A)", "rows(A)", ["a 3 by 3 matrix", "vectors"]),
        ("vector(u, s)", "vector(u, s)", ["a 3-vector and a scalar", "scalars"]),
        ("s[1]", "s[1]", ["s is a scalar", "without a subscript"]),
        ("C[3, 1]", "C[3, 1]", ["1 to 2"]),
        ("1 + sin(Omgea)*u", "Omgea", ["'Omgea'"]),
    ],
)
def test_misfit_is_said_in_words(text, guilty, said):
    """Both shapes are named, the guilty part is pointed at, and the fix is guessed."""
    with pytest.raises(ExpressionError) as caught:
        shape_of(read_expression(text), SCOPE)
    error = caught.value
    assert text[error.start : error.end] == guilty
    message = f"{error.problem}; expected {error.expected}. {error.hint}"
    assert all(part in message for part in said), message


def test_shapes_in_words():
    """Articles are those of speech."""
    assert [words(s) for s in ((), (8,), (11,), (18,), (80,), (3, 2))] == [
        "a scalar",
        "an 8-vector",
        "an 11-vector",
        "an 18-vector",
        "an 80-vector",
        "a 3 by 2 matrix",
    ]


def test_long_sum_does_not_exhaust_the_stack():
    """A sum of 500 terms is 500 levels deep and has a shape all the same."""
    assert shape_of(read_expression("s" + "+s" * 499), SCOPE) == ()


def test_members_sums_and_vee_have_shapes():
    """Those of one member, of the term, and of the vector whose hat a matrix is."""
    at, scope = {"index": "i", "shift": 1}, {"S": (3,), "R": (3, 3)}
    S = tree.Member(name="S", indices=(), **at)
    assert shape_of(S, scope) == (3,)
    assert shape_of(replace(S, indices=(2,)), scope) == ()
    sides = (tree.Name("j"), tree.Name("i"))
    assert shape_of(tree.Sum(indices=("j",), term=S, sides=sides, sign="!="), scope) == (3,)
    for name, shape in (("R", (3,)), ("S", None)):
        vee = tree.Call(function="vee", arguments=(tree.Name(name),))
        if shape is None:
            with pytest.raises(ExpressionError, match="vee is given a 3-vector"):
                shape_of(vee, scope)
        else:
            assert shape_of(vee, scope) == shape
    with pytest.raises(ExpressionError, match="'q' is not declared"):
        shape_of(replace(S, name="q"), scope)


def test_no_formula_calls_vee():
    """Equations are written with it, and no spec."""
    with pytest.raises(ExpressionError, match="vee"):
        read_expression("vee(R)")
