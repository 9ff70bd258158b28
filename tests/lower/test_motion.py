"""How few products give the rates: counted by hand, and equal to the Program in fractions."""

from fractions import Fraction

import pytest

from coadjoint.lower import motion
from coadjoint.lower.evaluation import evaluate, run
from coadjoint.lower.jets import make_jets
from coadjoint.lower.motion import Function, Quotient, find_plan
from coadjoint.lower.polynomials import add
from coadjoint.lower.program import Symbol, walk
from tests.programs import program


def rates(state, rows, parameters="", statements=""):
    """A Program of rates."""
    return program("rhs", state, parameters, statements, rows, (len(state.split()),))


CROSS = "{a}2*{b}3 - {a}3*{b}2; {a}3*{b}1 - {a}1*{b}3; {a}1*{b}2 - {a}2*{b}1"
KIRCHHOFF = rates(
    "Pi1 Pi2 Pi3 P1 P2 P3",
    "; ".join(
        f"({left}) + ({right})"
        for left, right in zip(
            CROSS.format(a="Pi", b="w").split(";"),
            CROSS.format(a="P", b="v").split(";"),
            strict=True,
        )
    )
    + "; "
    + CROSS.format(a="P", b="w"),
    "a1 a2 a3 d1 d2 d3 m1 m2 m3",
    "; ".join(
        [f"w{i} = a{i}*Pi{i} - d{i}*P{i}" for i in (1, 2, 3)]
        + [f"v{i} = m{i}*P{i} - d{i}*Pi{i}" for i in (1, 2, 3)]
    ),
)
#: The distance of two things is a difference, and is kept.
PAIR = rates(
    "x y",
    "(x - y)*(x - y)*k; (x - y)*x",
    "k",
)
#: What is cubic cancels: x y is left.
CANCELLING = rates("x y z", "x*(y*z + y) - y*(x*z); 0; 0", "", "")
#: Two unknowns over one pivot: quotients, and no reciprocal of its own.
SOLVED = rates("x y", "r*x; r*(x*y)", "", "d = 1 + x*x; r = 1/d")
SINES = rates("x y", "sin(k*x)*cos(k*x) + y/k; exp(y)/x + log(2 + x)*sqrt(1 + y*y)", "k")


@pytest.mark.parametrize(
    ("rhs", "products"),
    [
        # Pi_i Pi_j and P_i P_j of three pairs, P_i Pi_j of six; as it stands there are 18
        (KIRCHHOFF, 12),
        # (x - y)^2 and (x - y) x
        (PAIR, 2),
        # x y
        (CANCELLING, 1),
        # x x, x y, and two quotients
        (SOLVED, 4),
    ],
    ids=["kirchhoff", "pair", "cancelling", "solved"],
)
def test_products_are_as_few_as_by_hand(rhs, products):
    """Sums over orders, of which each costs as many operations as there are orders."""
    assert make_jets(rhs).products == products


def test_a_difference_of_like_things_is_no_sum_of_products():
    """The difference of two coordinates is a value of its own wherever it is a factor."""
    meanings = find_plan(PAIR).meanings
    assert any(
        set(meaning) == {(("x",), ()), (("y",), ())}
        for meaning in meanings.values()
        if isinstance(meaning, dict)
    )


def value_of(plan, values, call):
    """The rates of a plan, in fractions."""
    known = dict(values)
    for statement in plan.fixed:
        known[statement.name] = evaluate(statement.value, known, Fraction, call)

    def total(polynomial):
        found = Fraction(0)
        for (product, rest), factor in polynomial.items():
            for name in (*product, *rest):
                factor *= known[name]
            found += factor
        return found

    for name, meaning in plan.meanings.items():
        match meaning:
            case Quotient(above=above, below=below):
                known[name] = (known[above] if above else Fraction(1)) / known[below]
            case Function(name=function, of=argument):
                known[name] = call(function, *(known[each] for each in argument))
            case _:
                known[name] = total(meaning)
    return [total(rate) for rate in plan.rates]


@pytest.mark.parametrize("rhs", [KIRCHHOFF, PAIR, CANCELLING, SOLVED, SINES])
def test_a_plan_has_the_value_of_the_program(rhs):
    """In fractions; functions are some other ones, which the plan cannot know."""
    names = (*rhs.state, *rhs.parameters)
    values = {name: Fraction(3 * n + 2, 2 * n + 5) for n, name in enumerate(names)}

    def call(function, argument):
        return argument * argument + len(function)

    assert value_of(find_plan(rhs), values, call) == run(rhs, values, Fraction, call)


def test_no_sum_reads_a_name_that_is_not_made():
    """Cells come in an order in which they can be computed."""
    for rhs in (KIRCHHOFF, PAIR, CANCELLING, SOLVED, SINES):
        jets = make_jets(rhs)
        fixed = {statement.name for statement in jets.fixed}
        known = {*jets.state, *jets.driving, *rhs.parameters, *fixed}
        for cell in jets.cells:
            read = {node.name for node in walk(cell.value) if isinstance(node, Symbol)}
            assert read <= known
            known.add(cell.name)


def factorized(size):
    """Rates by a dense factorization, each entry of which is read by all behind it."""
    places = range(1, size + 1)
    pairs = [(i, j) for j in places for i in places[j:]]
    lines = [f"a{i}_{j} = x{i}*x{j} + x{i}" for j in places for i in places[j - 1 :]]
    for j in places:
        lines.append(f"d{j} = a{j}_{j}" + "".join(f" - w{j}_{k}*l{j}_{k}" for k in range(1, j)))
        for i in (i for i, column in pairs if column == j):
            before = "".join(f" - w{i}_{k}*l{j}_{k}" for k in range(1, j))
            lines += [f"w{i}_{j} = a{i}_{j}{before}", f"l{i}_{j} = w{i}_{j}/d{j}"]
    state = " ".join(f"x{i}" for i in places)
    return rates(state, "; ".join(f"d{i}" for i in places), "", "; ".join(lines))


def test_plans_that_multiply_a_factorization_out_are_left(monkeypatch):
    """Terms of all plans together are few: one that is larger than the best is not finished."""
    terms = []
    monkeypatch.setattr(motion, "add", lambda *each: terms.append(len(s := add(*each))) or s)
    own = factorized(10)
    plan = find_plan.__wrapped__(own)
    size = sum(1 for value in own.values() for _ in walk(value))
    assert plan.cost < size
    assert 100 < sum(terms) < 400 * size, sum(terms) / size
