"""Sizes: what would explode when multiplied out is refused before it is, and nothing else."""

from fractions import Fraction
from time import process_time

import pytest
import sympy

from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.faults import ExpressionError
from coadjoint.spec.core.sizes import check_size

SCOPE = {"x": (), "y": (), "z": (), "I": (3,), "u": (3,), "A": (3, 3), "F": (8, 8)}


@pytest.mark.parametrize(
    ("text", "limit"),
    [
        ("(x + y + z + 1)^32*(x + y + 1)^8", "EXPANDED_TERMS"),
        ("((x + y)^32)^8", "EXPANDED_TERMS"),
        ("((x^32)^32)^32", "EXPANDED_DEGREE"),
        ("(x*y)^32*(x*z)^32*(y*z)^32*(x*y*z)^32", "EXPANDED_DEGREE"),
        ("F^32", "EXPANDED_TERMS"),
        ("A^-16", "EXPANDED_TERMS"),
        ("det(A^6)", "EXPANDED_TERMS"),
        ("norm(A^5*u)", "EXPANDED_TERMS"),
        ("commutator(F^3, F^3)", "EXPANDED_TERMS"),
        ("(99^32)^32", "CONSTANT_BITS"),
        ("(10000000000*x)^32*(10000000000*y)^32", "CONSTANT_BITS"),
        ("(9^32)^32*x", "CONSTANT_BITS"),
        ("trace(outer(F^5*F[1], F[2])^5)", "EXPANDED_TERMS"),
        ("det(rows(A^3*A[1], A^3*A[2], A^3*A[3]))", "EXPANDED_TERMS"),
        ("exp(1001)", "FUNCTION_ARGUMENT"),
        ("exp(2^32)", "FUNCTION_ARGUMENT"),
        ("exp(exp(7))", "FUNCTION_ARGUMENT"),
        ("exp(1 + sqrt(2))", "FUNCTION_ARGUMENT"),
        ("x^1000.5", "EXPONENT"),
        ("x^(11*3)", "EXPONENT"),
    ],
)
def test_explosion_is_refused_with_its_limit(text, limit):
    """Each refusal names the limit and comes at once."""
    tree, start = read_expression(text), process_time()
    with pytest.raises(ExpressionError) as caught:
        check_size(tree, SCOPE)
    assert caught.value.limit == limit
    assert limit in caught.value.expected
    assert process_time() - start < 2  # multiplied out it would never end


@pytest.mark.parametrize(
    "text",
    [
        "(x + y + 1)^32",
        "dot(u, inverse(diag(I))*u)/2",
        "dot(u, inverse(diag(I)*diag(I) - diag(u)^2)*(diag(I)*u - diag(u)*u))/2",
        "det(A) + trace(A^3) + norm(A*u) + dot(cross(u, I), hat(u)*I)",
        "trace(outer(u, I)^3) + det(rows(A[1], A*A[2], u)) + dot(F[1], F[2])",
        "sqrt(2)*exp(1000) + log(1/1000) + sin(-1000)",
        "exp(exp(x)) + sqrt(x^2 + y^2)",
        "(0.1*x)^32",
        "x" + " + 0.123456789*x*y" * 100,
    ],
)
def test_what_books_write_passes(text):
    """The limits let through what mechanics needs."""
    check_size(read_expression(text), SCOPE)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x/0", "divides by zero"),
        ("x/(1 - 1)", "divides by zero"),
        ("0^-1", "divides by zero"),
        ("sqrt(-2)", "sqrt of -2"),
        ("log(0)", "log of 0"),
    ],
)
def test_constant_without_value_is_refused(text, said):
    """Constants are worked out exactly, so these are seen when the spec is read."""
    with pytest.raises(ExpressionError, match=said):
        check_size(read_expression(text), SCOPE)


@pytest.mark.parametrize(
    "text", ["(x + y + z)^7", "(x + y)^3*(x - z)^2", "(2*x - y/3)^9", "x*(y + z)*(x + 1)^2"]
)
def test_estimate_is_no_less_than_the_truth(text, monkeypatch):
    """With the limits at the true counts less one, the expression is refused."""
    from coadjoint import limits

    poly = sympy.Poly(sympy.sympify(text), *sympy.symbols("x y z"))
    monkeypatch.setattr(limits, "EXPANDED_TERMS", len(poly.terms()) - 1)
    with pytest.raises(ExpressionError, match="terms"):
        check_size(read_expression(text), SCOPE)
    monkeypatch.undo()
    monkeypatch.setattr(limits, "EXPANDED_DEGREE", poly.total_degree() - 1)
    with pytest.raises(ExpressionError, match="degree"):
        check_size(read_expression(text), SCOPE)
    monkeypatch.undo()
    longest = max(
        Fraction(int(c.p), int(c.q)).numerator.bit_length() + int(c.q).bit_length() - 1
        for c in poly.coeffs()
    )
    monkeypatch.setattr(limits, "CONSTANT_BITS", longest - 1)
    with pytest.raises(ExpressionError, match="bits"):
        check_size(read_expression(text), SCOPE)
