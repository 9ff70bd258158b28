"""Interpretation: trees become elements, vectors and matrices as a book would write them out."""

from dataclasses import replace

import pytest

from coadjoint.derive.interpret import LONG_SUM, entries, interpret
from coadjoint.errors import DerivationError
from coadjoint.exact import Field
from coadjoint.spec.core.definitions import expand, functions
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.model import Definition

FIELD = Field(["a1", "a2", "b1", "b2", "b3", "A11", "A12", "A21", "A22"])
x = {name: FIELD[name] for name in FIELD.names}
VALUES = {
    **x,
    "a": (x["a1"], x["a2"]),
    "b": (x["b1"], x["b2"], x["b3"]),
    "A": ((x["A11"], x["A12"]), (x["A21"], x["A22"])),
}


def value(text, definitions=()):
    """The value of a text, with definitions put in."""
    known = {d.name: d for d in definitions}
    tree = expand(read_expression(text, functions(known)), known)
    return interpret(tree, VALUES, FIELD)


def define(name, arguments, text, shape):
    """A definition that uses no other."""
    tree = read_expression(text)
    return Definition(name=name, arguments=arguments, text=text, typed=tree, tree=tree, shape=shape)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            "outer(a, b)",
            (
                (x["a1"] * x["b1"], x["a1"] * x["b2"], x["a1"] * x["b3"]),
                (x["a2"] * x["b1"], x["a2"] * x["b2"], x["a2"] * x["b3"]),
            ),
        ),
        ("outer(a, b)*b/dot(b, b) - a", (FIELD.zero, FIELD.zero)),
        ("rows(a, 2*a)", ((x["a1"], x["a2"]), (2 * x["a1"], 2 * x["a2"]))),
        ("rows(b)", ((x["b1"], x["b2"], x["b3"]),)),
        ("vector(a1, 2*b2)", (x["a1"], 2 * x["b2"])),
        ("A[2]", (x["A21"], x["A22"])),
        ("rows(A[2], A[1])*a", (x["A21"] * x["a1"] + x["A22"] * x["a2"],
                                x["A11"] * x["a1"] + x["A12"] * x["a2"])),
        ("det(rows(A[1], A[2])) - det(A)", FIELD.zero),
        ("cross(b, vector(a1, a2, 0))[3]", x["b1"] * x["a2"] - x["b2"] * x["a1"]),
        ("2*(A*a)[2]", 2 * (x["A21"] * x["a1"] + x["A22"] * x["a2"])),
        ("outer(a, b)[2, 3]", x["a2"] * x["b3"]),
        ("A[1, 2] - dot(A[1], a)", x["A12"] - x["A11"] * x["a1"] - x["A12"] * x["a2"]),
    ],
)  # fmt: skip
def test_matrices_are_put_together_and_taken_apart(text, expected):
    """outer, rows and a single subscript, component by component."""
    assert value(text) == expected
    assert value(text) != value("A + A")


def test_components_of_what_is_put_in_are_its_components():
    """u[2] of u = A a is the second component of the product; p[1] of an argument, of that."""
    u = define("u", (), "A*a", (2,))
    first = define("f", ("p",), "p[1]*p[2]", None)
    lower = x["A21"] * x["a1"] + x["A22"] * x["a2"]
    upper = x["A11"] * x["a1"] + x["A12"] * x["a2"]
    assert value("u[2]", [u]) == lower
    assert value("f(A*a)", [first]) == upper * lower
    assert value("f(u)", [first, u]) == upper * lower != lower * lower


def test_deep_trees_do_not_exhaust_the_stack():
    """1000 signs in a row, which definitions can pile up, have a value."""
    tree, negative = read_expression("a1"), define("n", (), "a1", ())
    for _ in range(999):
        tree = expand(read_expression("-n"), {"n": replace(negative, tree=tree)})
    assert interpret(tree, VALUES, FIELD) == -x["a1"]


@pytest.mark.parametrize("term", ["a1*b1", "a"])
def test_long_sums_are_the_sums_of_their_addends(term):
    """A sum that is added in pairs, of scalars and of vectors, with a difference within."""
    count = LONG_SUM + 3
    whole = value(f"{term} - 2*{term}" + f" + {term}" * count)
    assert whole == value(f"{count - 1}*({term})")
    assert whole != value(f"{count}*({term})")


def test_entries_are_read_row_by_row():
    """Scalars, vectors and matrices as a list of components."""
    names = ["A11", "A12", "A21", "A22"]
    assert entries(VALUES["A"]) == tuple(x[name] for name in names)
    assert entries(VALUES["a"]) == (x["a1"], x["a2"])
    assert entries(x["a1"]) == (x["a1"],)


def test_a_power_in_a_denominator_stays_a_power():
    """1/d^2 has the factor d twice, so that its derivative is -2 d'/d^3 with nothing to cancel."""
    field = Field(["x", "y"])
    tree = read_expression("x/(x + y)^2")
    value = interpret(tree, {name: field[name] for name in "xy"}, field)
    d = field["x"] + field["y"]
    slope = field.derivative(value, "y")
    assert slope == -2 * field["x"] / d / d / d
    (written,) = field.quotients(slope)
    assert [power for _, power in written.divisors] == [3]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1/(sin(a1)^2 + cos(a1)^2 - 1)", "divides by zero identically"),
        ("a1/(exp(2*a1) - exp(a1)^2)^2", "divides by zero identically"),
        ("(log(b1^2) - 2*log(b1))^(-1)", "divides by zero identically"),
        ("a1/(sqrt(a2 + 1 + 2*sqrt(a2)) - 1 - sqrt(a2))", "may be 0 everywhere"),
        ("a1/sqrt(-1 - a1^2)", "may be 0 everywhere"),
        ("log(sin(-a1) + sin(a1))", "the logarithm of 0"),
        ("inverse(rows(vector(exp(2*a1), exp(a1)), vector(exp(a1), 1)))", "singular matrix"),
        ("rows(vector(sin(a1)^2 - 1, cos(a1)), vector(cos(a1), -1))^(-1)", "singular matrix"),
    ],
)
def test_what_may_be_zero_is_no_divisor(text, message):
    """Zero by a relation between functions, or not known to differ from zero at any point."""
    field = Field(FIELD.names, slots=8)
    values = {name: field[name] for name in field.names}
    with pytest.raises(DerivationError, match=message):
        interpret(read_expression(text, functions({})), values, field)


def test_a_divisor_with_functions_is_shown_to_be_nonzero():
    """A point of the domain shows it, also of a narrow one: 100 < a1 < 101."""
    field = Field(FIELD.names, slots=8)
    values = {name: field[name] for name in field.names}
    text = "a2/sqrt((a1 - 100)*(101 - a1)) + 1/(exp(a1) - 1) + 1/(sin(a1)^2 - 1)"
    assert interpret(read_expression(text, functions({})), values, field)
