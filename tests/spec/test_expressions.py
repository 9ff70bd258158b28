"""Expressions: precedence as in mathematics, exact numbers, faults at their place, limits."""

import ast
from fractions import Fraction
from time import process_time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadjoint import limits
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.faults import ExpressionError
from coadjoint.spec.core.tree import Binary, Call, Index, Name, Negate, Number, Power, walk, walk_up

VALUES = {"x": Fraction(3), "y": Fraction(-5, 2), "a_b": Fraction(7)}


def value(node):
    """The value of a tree of scalars; an evaluator of nothing but this test."""
    match node:
        case Number(value=number):
            return number
        case Name(name=name):
            return VALUES[name]
        case Negate(operand=operand):
            return -value(operand)
        case Power(base=base, exponent=exponent):
            return value(base) ** exponent
        case Binary(operator=operator, left=left, right=right):
            a, b = value(left), value(right)
            return {"+": a + b, "-": a - b, "*": a * b, "/": a / b if b else None}[operator]
    raise AssertionError(node)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("-x^2", -9),
        ("(-x)^2", 9),
        ("-x**2*y", Fraction(45, 2)),
        ("2 - 3 - 4", -5),
        ("2/3/4", Fraction(1, 6)),
        ("2/3*4", Fraction(8, 3)),
        ("2 + 3*4^2", 50),
        ("2*-x", -6),
        ("2--x", 5),
        ("+x - +2", 1),
        ("x^-1", Fraction(1, 3)),
        ("x^(-2)", Fraction(1, 9)),
        ("(x + y)^3", Fraction(1, 8)),
        ("a_b/2 - 0.1", Fraction(17, 5)),
        ("x\n  + 1", 4),
        ("0.1 + 0.2", Fraction(3, 10)),
    ],
)
def test_precedence_is_that_of_mathematics(text, expected):
    """Values worked out by hand; unary minus binds weaker than a power."""
    assert value(read_expression(text)) == expected


@pytest.mark.parametrize(
    ("text", "exponent"),
    [
        ("x^0.5", Number(Fraction(1, 2))),
        ("x**n", Name("n")),
        ("x^-n", Negate(Name("n"))),
        ("x^(1/2)", Binary("/", Number(Fraction(1)), Number(Fraction(2)))),
        ("x^(-1.5)", Negate(Number(Fraction(3, 2)))),
        ("x^dot(a, b)", Call("dot", (Name("a"), Name("b")))),
    ],
)
def test_a_power_with_another_exponent_is_a_call(text, exponent):
    """All but a literal integer is an exponent of the function pow."""
    assert read_expression(text) == Call("pow", (Name("x"), exponent))
    assert read_expression(f"-{text}*y") == Binary(
        "*", Negate(Call("pow", (Name("x"), exponent))), Name("y")
    )


def test_pi_is_exact():
    """The ratio of a circle is four times the angle whose tangent is 1."""
    assert read_expression("pi") == Binary("*", Number(Fraction(4)), Call("atan", (Number(1),)))


def test_names_components_and_calls_become_nodes():
    """Subscripts count from 1, functions keep their arguments in order."""
    tree = read_expression("dot(Omega, diag(I)*Omega) + A[1, 2]*Omega[3]")
    assert tree == Binary(
        "+",
        Call("dot", (Name("Omega"), Binary("*", Call("diag", (Name("I"),)), Name("Omega")))),
        Binary("*", Index("A", (1, 2)), Index("Omega", (3,))),
    )


def test_nodes_know_their_place():
    """Start and end of every node cut its text out of the expression."""
    text = "x + dot( A , B[2] )^2 - 0.50"
    found = {text[n.start : n.end] for n in walk(read_expression(text))}
    assert {"x", "dot( A , B[2] )", "dot( A , B[2] )^2", "A", "B[2]", "0.50", text} <= found


def test_walks_visit_every_node_in_order():
    """Parents first one way, children first the other, left to right."""
    tree = read_expression("x - y*2")
    assert [type(n).__name__ for n in walk(tree)] == ["Binary", "Name", "Binary", "Name", "Number"]
    assert [type(n).__name__ for n in walk_up(tree)][-1] == "Binary"
    assert [n.name for n in walk_up(tree) if isinstance(n, Name)] == ["x", "y"]


@pytest.mark.parametrize(
    ("text", "guilty", "said"),
    [
        ("1e5", "1e5", "Write 100000."),
        ("2.5e-3*x", "2.5e-3", "Write 0.0025."),
        ("1e999", "1e999", "Write the digits out."),
        ("x.real", ".", "no attributes"),
        (".5*x", ".", "digits on both sides"),
        ("__import__('os')", "__import__", "Names begin"),
        ("x._a", ".", "no attributes"),
        ("x__y", "x__y", "single underscores"),
        ("'os'", "'", "transpose(A)"),
        ('"os"', '"', "no text"),
        ("y = x", "=", "right-hand side"),
        ("|x|", "|", "norm(a)"),
        ("x; y", ";", "one formula"),
        ("A @ B", "@", "Write *"),
        ("2 Omega", "Omega", "Write 2*Omega."),
        ("2x", "x", "Write 2*x."),
        ("x y", "y", "Write x*y."),
        ("(x)(y)", "(", "Write * for a product."),
        ("2(x + 1)", "(", "Write * for a product."),
        ("I(1)", "I", "I[1]"),
        ("nrom(x)", "nrom", "Did you mean 'norm'?"),
        ("sin x", "sin", "sin(...)"),
        ("(x", "(", "')' after it"),
        ("dot(x, y", "(", "')' after it"),
        ("x)", ")", "'(' before it"),
        ("x +", "+", "a number, a name"),
        ("x * / y", "/", "a number, a name"),
        ("dot(x,)", ")", "a number, a name"),
        ("dot()", ")", "a number, a name"),
        ("A[1][2]", "[", "A[1, 2]"),
        ("A[x]", "x", "counted from 1"),
        ("A[-1]", "-", "counted from 1"),
        ("A[1.5]", "1.5", "counted from 1"),
        ("(x + y)[1][2]", "[", "(x + y)[1, 2]"),
        ("dot(x, y)[z]", "z", "counted from 1"),
        ("2[1]", "[", "Numbers have no subscripts."),
        ("x^n^2", "x^n^", "(a^b)^c"),
        ("x^pi(2)", "(", "Write * for a product."),
        ("x^", "^", "a number, a name"),
        ("pi[1]", "[", "Numbers have no subscripts."),
        ("x^2^3", "x^2^", "(a^b)^c"),
        ("9**9**9", "9**9**", "(a^b)^c"),
        ("\u03a9*x", "\u03a9", "Write Omega."),
        ("x\u00b2", "\u00b2", "Write ^2."),
        ("x \u00d7 y", "\u00d7", "cross(a, b)"),
        ("{x}", "{", "round parentheses"),
        ("x # y", "#", "outside the quotes"),
        ("x < y", "<", "+ - * /"),
        ("x % 2", "%", "a/b"),
        ("lambda: 1", ":", "+ - * /"),
        ("[x]", "[", "a number, a name"),
        ("", "", "a formula"),
    ],
)
def test_fault_points_at_the_guilty_characters(text, guilty, said):
    """Every mistake is shown at its place, with what was probably meant."""
    with pytest.raises(ExpressionError) as caught:
        read_expression(text)
    error = caught.value
    assert text[error.start : error.end] == guilty
    assert error.found.startswith(guilty) or guilty in error.problem or guilty in error.found
    assert said in f"{error.expected} {error.hint}"


@pytest.mark.parametrize(
    ("text", "limit"),
    [
        ("x" + "+x" * 3000, "EXPRESSION_CHARACTERS"),
        ("(" * 100_000 + "x" + ")" * 100_000, "EXPRESSION_CHARACTERS"),
        ("(" * 49 + "x" + ")" * 49, "EXPRESSION_NESTING"),
        ("-" * 4000 + "x", "EXPRESSION_NESTING"),
        ("sin(" * 49 + "x" + ")" * 49, "EXPRESSION_NESTING"),
        ("x" + "+x" * 500, "EXPRESSION_NODES"),
        ("x^33", "EXPONENT"),
        ("x^(-99999999999999999999)", "EXPONENT"),
        ("1" * 41, "INTEGER_DIGITS"),
        ("0." + "1" * 41, "DECIMAL_DIGITS"),
        ("x" * 32, "NAME_CHARACTERS"),
    ],
)
def test_limit_is_named(text, limit):
    """A refusal names the limit, and comes at once."""
    start = process_time()
    with pytest.raises(ExpressionError) as caught:
        read_expression(text)
    assert caught.value.limit == limit
    assert limit in caught.value.expected
    assert process_time() - start < 1  # hostile ones took minutes


def test_expressions_at_the_limits_are_read():
    """What a limit allows passes: the limits are not off by one."""
    assert value(read_expression("(" * 48 + "x" + ")" * 48)) == 3
    assert value(read_expression("x" + "+1" * 499)) == 502
    assert read_expression("x^32") == Power(Name("x"), limits.EXPONENT)
    assert read_expression("x" * 31) == Name("x" * 31)
    assert value(read_expression("9" * 40 + "." + "9" * 40)) == Fraction("9" * 40 + "." + "9" * 40)


ATOMS = st.sampled_from(["x", "y", "a_b", "2", "0.5", "7.25"])


def compound(inner):
    """Texts with every operator, with and without parentheses, beside their Python reading."""
    return st.one_of(
        st.tuples(inner, st.sampled_from(["+", "-", "*", "/"]), inner).map(" ".join),
        inner.map(lambda text: f"({text})"),
        inner.map(lambda text: f"-{text}"),
        inner.map(lambda text: f"({text})^3"),
    )


class Exact(ast.NodeTransformer):
    """Makes the numbers of a Python expression fractions."""

    def visit_Constant(self, node):
        """``0.5`` becomes ``Fraction("0.5")``, exponents excepted."""
        call = ast.Call(ast.Name("Fraction", ast.Load()), [ast.Constant(str(node.value))], [])
        return ast.copy_location(ast.fix_missing_locations(call), node)


@given(st.recursive(ATOMS, compound, max_leaves=12))
def test_random_expressions_have_the_value_that_python_finds(text):
    """Python's own parser is the other road; its numbers and powers are made ours."""
    tree = Exact().visit(ast.parse(text.replace("^3", "**3"), mode="eval"))
    try:
        code = compile(ast.fix_missing_locations(tree), "", "eval")
        expected = eval(code, {"Fraction": lambda s: Fraction(s)}, VALUES)  # our own text only
    except (ZeroDivisionError, TypeError):
        return
    if isinstance(expected, Fraction):
        assert value(read_expression(text)) == expected


def refusal_of(text):
    """The error that a text gives, or None."""
    try:
        read_expression(text)
    except ExpressionError as error:
        return error
    return None


@given(st.text(max_size=80) | st.text(alphabet="xyA12.0()[],+-*/^ dotsin_", max_size=120))
def test_any_text_is_read_or_refused(text):
    """Nothing but our own error comes out, whatever goes in, and it points into the text."""
    error = refusal_of(text)
    if error is not None:
        assert 0 <= error.start <= error.end <= len(text)
        assert error.problem
