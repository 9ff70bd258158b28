"""Lowering: exact inverse, shared work counted, derivatives by another road."""

import dataclasses
from fractions import Fraction

import pytest

from coadjoint.derive import derive
from coadjoint.errors import CrossCheckError, LimitError
from coadjoint.lower.check import check_inverse, check_size
from coadjoint.lower.graph import Graph
from coadjoint.lower.lowering import lower
from coadjoint.lower.products import share_pairs
from coadjoint.lower.program import (
    Add,
    Multiply,
    Negate,
    Number,
    Output,
    Symbol,
    evaluate,
    run,
    walk,
)
from tests.conftest import rational_points
from tests.sources import textbook
from tests.specs import RIGID_BODY, shipped, spec


def total(counts):
    """All operations."""
    return sum(counts.values())


def test_lowering_is_undone_exactly(system):
    """Every Program run on the symbols gives the equations back."""
    equations = derive(shipped(system))
    programs = lower(equations)
    assert list(programs) == ["rhs", "jacobian", "energy", "observables", "poisson_tensor"]
    for program in programs.values():
        check_inverse(equations, program)


@pytest.mark.parametrize("function", ["rhs", "jacobian", "energy", "observables"])
def test_the_inverse_check_sees_one_changed_node(function):
    """Negate one output, or one statement, and the check names it."""
    equations = derive(shipped("heavy_top"))
    program = lower(equations)[function]
    place = next(n for n, o in enumerate(program.outputs) if o.value != Number(Fraction(0)))
    outputs = list(program.outputs)
    outputs[place] = Output(outputs[place].label, Negate(outputs[place].value))
    with pytest.raises(CrossCheckError, match="lowering changed") as caught:
        check_inverse(equations, dataclasses.replace(program, outputs=tuple(outputs)))
    assert caught.value.output == outputs[place].label
    first = dataclasses.replace(
        program.statements[0], value=Multiply(Number(Fraction(2)), program.statements[0].value)
    )
    spoiled = dataclasses.replace(program, statements=(first, *program.statements[1:]))
    with pytest.raises(CrossCheckError):
        check_inverse(equations, spoiled)


def test_operations_do_not_exceed_a_careful_hand_derivation(system):
    """Per member: rigid body 12, heavy top 33, Kirchhoff 48, as written out by hand."""
    # Omega_i = Pi_i/I_i (3), cross product (9); the top adds a torque of 12 and 9 for Gamma; the
    # vehicle has six velocities of 3 operations each, and three cross products with one sum (30).
    by_hand = {"rigid_body": 12, "heavy_top": 33, "kirchhoff": 48}
    rhs = lower(derive(shipped(system)))["rhs"]
    assert total(rhs.operation_counts()) <= by_hand[system]


@pytest.mark.parametrize("limit", ["OPERATIONS", "C_STATEMENTS"])
def test_programs_that_compilers_choke_on_are_refused(limit, monkeypatch):
    """The function, the count and the limit are named."""
    equations = derive(spec())
    jacobian = lower(equations)["jacobian"]
    check_size(equations, jacobian)
    monkeypatch.setattr(f"coadjoint.lower.check.{limit}", 5)
    with pytest.raises(LimitError, match=rf"jacobian takes \d+ .* at most 5 .{limit}."):
        check_size(equations, jacobian)


def test_statements_are_assigned_once_and_used(system):
    """Single assignment, no dead code, definitions before use."""
    for program in lower(derive(shipped(system))).values():
        known = set(program.state) | set(program.parameters)
        for statement in program.statements:
            reads = {n.name for n in walk(statement.value) if isinstance(n, Symbol)}
            assert reads <= known
            assert statement.name not in known
            known.add(statement.name)
        assert {s.name for s in program.statements} <= program.used()


def test_parameter_statements_read_parameters_alone(system):
    """What is hoisted out of the loop over members does not depend on the member."""
    for program in lower(derive(shipped(system))).values():
        fixed = set(program.parameters)
        for statement in program.at_level("parameters"):
            assert {n.name for n in walk(statement.value) if isinstance(n, Symbol)} <= fixed
            fixed.add(statement.name)


def test_jacobian_equals_divided_differences_exactly(system):
    """For rates quadratic in the state, central differences are exact: another road."""
    programs = lower(derive(shipped(system)))
    rhs, jacobian = programs["rhs"], programs["jacobian"]
    (point,) = rational_points((*rhs.state, *rhs.parameters), 1, seed=5)
    found = run(jacobian, point, Fraction, None)
    n, h = len(rhs.state), Fraction(1, 7)
    for j, name in enumerate(rhs.state):
        up = run(rhs, {**point, name: point[name] + h}, Fraction, None)
        down = run(rhs, {**point, name: point[name] - h}, Fraction, None)
        slopes = [(a - b) / (2 * h) for a, b in zip(up, down, strict=True)]
        assert [found[i * n + j] for i in range(n)] == slopes


def test_programs_give_the_book_formulas(system):
    """The Program of rhs, run on fractions, equals the textbook's rates."""
    rhs = lower(derive(shipped(system)))["rhs"]
    for point in rational_points((*rhs.state, *rhs.parameters), 3, seed=6):
        x, p = [point[n] for n in rhs.state], [point[n] for n in rhs.parameters]
        assert run(rhs, point, Fraction, None) == textbook.RATES[system](x, p)


def test_functions_are_lowered_and_differentiated():
    """sin, cos, sqrt, exp and log survive lowering, with state-dependent divisors."""
    text = RIGID_BODY.replace(
        'Pi = { role = "momentum" }',
        'Pi = { role = "momentum" }\na = { role = "advected", representation = "vector" }',
    ).replace(
        'diag(I)*Omega)/2"',
        'diag(I)*Omega)/2 - sin(a1*I1)*exp(a2)/(2 + a3^2) - sqrt(I2)*log(2 + a1^2) - cos(a1*I1)"',
    )
    text = text.replace('["dot(Pi, Pi)"]', '["dot(a, a)"]')
    equations = derive(spec(text))
    for program in lower(equations).values():
        check_inverse(equations, program)


def test_a_mass_that_depends_on_the_state_is_divided_by():
    """A kinetic energy with advected factors: the member's own divisions stay in the loop."""
    text = RIGID_BODY.replace(
        'Pi = { role = "momentum" }',
        'Pi = { role = "momentum" }\na = { role = "advected", representation = "vector" }',
    ).replace('/2"', '/2 + (Omega1*a1)^2/2 + Omega1*Omega2*a3/3"')
    equations = derive(spec(text.replace('["dot(Pi, Pi)"]', '["dot(a, a)"]')))
    programs = lower(equations)
    assert programs["rhs"].operation_counts()["divide"] >= 1
    for program in programs.values():
        check_inverse(equations, program)


def test_equal_values_are_one_node_and_signs_move_out():
    """The graph shares by construction and folds constants exactly."""
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    assert graph.multiply(x, y) == graph.multiply(x, y)
    assert graph.add(x, graph.number(0)) == x
    assert graph.multiply(graph.negate(x), graph.negate(y)) == graph.multiply(x, y)
    third = graph.divide(graph.number(1), graph.number(3))
    assert graph.payload[third] == Fraction(1, 3)
    assert graph.is_zero(graph.multiply(x, graph.number(0)))


def test_shared_pairs_multiply_out_to_the_same_products():
    """Replacing pairs changes no product, and shortens the common ones."""
    products = [("m", "g", "a"), ("m", "g", "b"), ("x", "x", "x", "x"), ("m", "g", "a")]
    found, pairs = share_pairs(products, "q{}".format)

    def expand(name):
        return [name] if name not in pairs else [f for part in pairs[name] for f in expand(part)]

    for before, after in zip(products, found, strict=True):
        assert sorted(before) == sorted(f for name in after for f in expand(name))
    assert len(found[0]) == 2
    assert len(found[2]) <= 3


def test_operation_counts_count_differences_once():
    """A difference a - b is one addition; -a alone is a negation."""
    a, b = Symbol("a"), Symbol("b")
    program = lower(derive(spec()))["rhs"]
    changed = dataclasses.replace(
        program,
        statements=(),
        outputs=(Output("x", Add(a, Negate(b))), Output("y", Negate(a))),
    )
    assert changed.operation_counts() == {"add": 1, "negate": 1}
    assert evaluate(Add(a, Negate(b)), {"a": 5, "b": 3}, int, None) == 2
