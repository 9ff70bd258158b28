"""Printers: text that reads back as the tree, in as few parentheses as its order allows."""

import ast
import random
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings

from coadjoint.crosscheck.bits import find_differing_bits
from coadjoint.crosscheck.parse_back import as_printed
from coadjoint.errors import SpecError
from coadjoint.lower.evaluation import evaluate
from coadjoint.lower.program import Add, Divide, Multiply, Negate, Number, Symbol
from coadjoint.render.printers import (
    WIDTH,
    number_text,
    python_call,
)
from coadjoint.render.targets.c.printer import C
from coadjoint.render.targets.c.reader import read_expression as read_c_expression
from coadjoint.render.targets.numpy.printer import NUMPY
from coadjoint.render.targets.numpy.reader import read_expression as read_python_expression
from tests.programs import node
from tests.trees import NAMES, numbers, trees

a, b, c = map(Symbol, "abc")


@pytest.mark.parametrize(
    ("tree", "text"),
    [
        (Add(Add(a, b), c), "a + b + c"),
        (Add(a, Add(b, c)), "a + (b + c)"),
        (Add(a, Negate(b)), "a - b"),
        (Add(a, Negate(Add(b, c))), "a - (b + c)"),
        (Add(Negate(a), b), "-a + b"),
        (Add(a, Number(Fraction(-2))), "a - 2.0"),
        (Add(a, Negate(Number(Fraction(-2)))), "a - -2.0"),
        (Multiply(a, Multiply(b, c)), "a * (b * c)"),
        (Multiply(Multiply(a, b), c), "a * b * c"),
        (Multiply(Divide(a, b), c), "a / b * c"),
        (Divide(a, Divide(b, c)), "a / (b / c)"),
        (Divide(a, Multiply(b, c)), "a / (b * c)"),
        (Multiply(Add(a, b), c), "(a + b) * c"),
        (Negate(Multiply(a, b)), "-(a * b)"),
        (Multiply(Negate(a), b), "-a * b"),
        (Multiply(a, Negate(b)), "a * -b"),
        (Negate(Negate(a)), "-(-a)"),
        (Negate(Number(Fraction(-1, 2))), "-(-0.5)"),
    ],
)
def test_parentheses_are_those_that_the_order_needs(tree, text):
    """Both languages print the same text, and not one parenthesis more."""
    assert NUMPY.text(tree) == C.text(tree) == text


@given(numbers)
def test_a_number_reads_back_as_the_nearest_double(value):
    """The text of a constant is the double nearest to it, and has a decimal point or exponent."""
    assert float(number_text(value)) == value.numerator / value.denominator
    assert isinstance(ast.literal_eval(number_text(value)), float)


@pytest.mark.parametrize(
    "value", [Fraction(10) ** 400, -(Fraction(10) ** 309), Fraction(1, 10**400)]
)
def test_a_number_without_a_double_is_refused(value):
    """A constant beyond the doubles is an error that shows its size, not inf or 0."""
    with pytest.raises(SpecError, match=r"1e-?(400|309)") as caught:
        number_text(value)
    assert caught.value.found in str(caught.value)


@settings(deadline=None)
@given(trees())
def test_python_text_reads_back_as_the_tree(tree):
    """Python's own parser finds the tree in what we print."""
    assert read_python_expression(NUMPY.text(tree), "f") == as_printed(tree)


@settings(deadline=None)
@given(trees())
def test_c_text_reads_back_as_the_tree(tree):
    """A reader of C that shares no code with the printer finds the tree in what we print."""
    assert read_c_expression(C.text(tree), "f") == as_printed(tree)


@settings(deadline=None)
@given(trees())
def test_broken_assignments_read_back_as_the_tree(tree):
    """Breaking a long line moves no operand."""
    line = ast.parse(NUMPY.assignment(tree, to="x", column=0, comment="dPi1/dt")).body[0]
    assert read_python_expression(ast.unparse(line.value), "f") == as_printed(tree)
    head, text = C.assignment(tree, to="x", column=8).split("=", 1)
    assert (head, text[-1]) == ("x ", ";")
    assert read_c_expression(text[:-1], "f") == as_printed(tree)


@settings(deadline=None)
@given(trees(functions=("sqrt",)))
def test_python_text_evaluates_to_the_same_bits(tree):
    """The text, evaluated by Python, gives the very double that the tree gives."""
    values = {name: np.float64(1.25 + 0.37 * k) for k, name in enumerate(NAMES)}
    with np.errstate(all="ignore"):
        expected = evaluate(tree, values, np.float64, lambda function, x: np.sqrt(x))
        text = NUMPY.text(tree).replace("np.sqrt", "sqrt")
        floats = ast.unparse(_DoubleConstants().visit(ast.parse(text, mode="eval")))
        found = eval(floats, {**values, "sqrt": np.sqrt, "double": np.float64})
    assert not find_differing_bits(np.float64(found), expected)


class _DoubleConstants(ast.NodeTransformer):
    """Wraps constants, so that a division by zero gives inf as arrays do."""

    def visit_Constant(self, constant):
        call = ast.Call(ast.Name("double", ast.Load()), [constant], [])
        return ast.copy_location(call, constant)


def test_lines_are_short_where_they_can_be():
    """A sum of forty products stands on lines of at most 100 columns."""
    long = node(" + ".join(f"Omega{i}*Gamma{i}" for i in range(40)))
    for text in (NUMPY.assignment(long, to="out[0]"), C.assignment(long, to="out[0]", column=12)):
        lines = text.splitlines()
        assert 40 <= len(lines) <= 43
        assert max(map(len, lines)) <= WIDTH


def long_tree(source, depth):
    """A random tree deep and wide enough to be broken, which hypothesis seldom draws."""
    if depth == 0:
        return Symbol(source.choice(NAMES))
    left, right = long_tree(source, depth - 1), long_tree(source, source.randrange(depth))
    kind = source.choice([Add, Add, Multiply, Multiply, Divide, None])
    return kind(left, right) if kind else Add(left, Negate(right))


def test_our_formatter_leaves_assignments_as_they_are(tmp_path):
    """`ruff format` changes nothing in 400 assignments, long and short, with and without notes."""
    source = random.Random(5)
    lines = ["def f():"]
    for row in range(400):
        tree, note = long_tree(source, source.randrange(8)), source.choice(["", "dPi1/dt"])
        lines.append("    " + NUMPY.assignment(tree, to=f"out[{row}]", comment=note))
    check_formatted("\n".join(lines) + "\n", tmp_path)


@pytest.mark.parametrize("count", [1, 5, 9, 30])
def test_our_formatter_leaves_entries_as_they_are(tmp_path, count):
    """`ruff format` changes nothing in declarations of any length."""
    names = ", ".join(f'"Gamma{i}"' for i in range(count)) + ("," if count == 1 else "")
    arguments = ['"Gamma"', f"shape=({count},)", f"components=({names})"]
    entry = python_call(arguments, to="Quantity", column=4, end=",")
    check_formatted(f"STATE = Quantities(\n    {entry}\n)\n", tmp_path)


def check_formatted(text, folder):
    """Our formatter, at our line length, leaves the text as it is."""
    (folder / "text.py").write_text(text)
    command = [
        sys.executable,
        "-m",
        "ruff",
        "format",
        "--isolated",
        f"--line-length={WIDTH}",
        "--diff",
    ]
    result = subprocess.run([*command, "text.py"], cwd=folder, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr


def test_formatter_check_sees_a_space(tmp_path):
    """The check above can fail: one space too many and it does."""
    with pytest.raises(AssertionError):
        check_formatted("x = a  + b\n", tmp_path)
