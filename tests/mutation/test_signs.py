"""Any single sign: of a structure constant, a term of ad* or a bracket, minus or plus.

Every place is tried, not a sample: what is flipped is the data inside one process. Each flip must
be refused by the engine or contradict the book, for routes in variables of their own through the
map to the declared state. `tests.mutation.test_mutants` does the same to the text of the engine.
What is one place of the engine for all systems, the side, is turned for the smallest system of each
route, in campaigns for all: that a spec has the right one is seen by the rates of books.
"""

import re
from dataclasses import replace

import pytest

from coadjoint.algebra import LieAlgebra
from coadjoint.derive import derive, make_setting, structure
from coadjoint.derive.setting import Setting
from coadjoint.errors import AlgebraError, DerivationError, SpecError
from coadjoint.poisson.structure import antisymmetric
from tests.algebra.laws import spoiled_constants
from tests.conftest import SYSTEMS
from tests.sources import textbook
from tests.sources.test_equations import carried, in_chart, points, same, solved, values
from tests.specs import prove_claims, shipped, spec


def bare(declared, routes=()):
    """A spec by some routes, without what is emitted beside the motion: that is judged alone.

    A declared Lax pair is left out, too: it says by itself which way the motion runs.
    """
    kept = routes or tuple(route for route in declared.routes if route != "lax")
    beside = dict.fromkeys(("casimirs", "conserved", "observables", "symmetries", "brackets"), ())
    return replace(declared, routes=kept, lax=None, **beside)


def whole(name):
    """A shipped spec; of a restricted motion, that of the whole system."""
    declared = shipped(name)
    return declared if declared.reduction is None else declared.reduction.whole


ON_ALGEBRAS = [name for name in SYSTEMS if shipped(name).algebra is not None]
#: Those that take as long as ten others, and use nothing that no other uses.
LONG = ("orbiting_body", "veselova_so4", "zeitlin_su_4")
#: Balls of one moment of inertia: I omega x omega is zero, so that the side says nothing.
ALIKE = ("ball_in_sphere", "ball_on_turntable")
BY_SIDE = [
    (name, route)
    for name in SYSTEMS
    if whole(name).algebra is not None
    for route in bare(shipped(name)).routes
]
SMALLEST = {
    route: min(
        (name for name, each in BY_SIDE if each == route and name not in ALIKE),
        key=lambda name: len(textbook.STATES[name]),
    )
    for _, route in BY_SIDE
}
EACH_SIDE = [
    pytest.param(name, route, marks=[pytest.mark.campaign] * (name != SMALLEST[route]))
    for name, route in BY_SIDE
]
BY_LIE_POISSON = [name for name, route in BY_SIDE if route == "lie-poisson" and name in ON_ALGEBRAS]
#: Beyond six dimensions the entries are many and alike.
SMALL = [name for name in BY_LIE_POISSON if len(textbook.STATES[name]) <= 6]
#: Which routes move by which operation of the algebra; the others have tables of their own.
OPERATIONS = {
    "euler-poincare": "ad_star",
    "hamilton-pontryagin": "bracket",
    "kaluza-klein": "bracket",
    "complexification": "bracket",
}
BY_OPERATION = [
    (name, route) for name, route in BY_SIDE if route in OPERATIONS and name in ON_ALGEBRAS
]


def in_campaigns(arguments):
    """Arguments, those of long systems marked."""
    tuples = [each if isinstance(each, tuple) else (each,) for each in arguments]
    return [
        pytest.param(*each, marks=[pytest.mark.campaign] * (each[0] in LONG)) for each in tuples
    ]


def agrees(equations, name):
    """Whether derived rates are the book's at a random point; of a chart, at its image.

    With constraints the reactions count, too: some constants move nothing, and the constraint
    bears the force that they make.
    """
    in_state = equations.chart is None
    moved = equations.rates if in_state else carried(equations)
    ((point, x, p),) = points(name, 1) if in_state else in_chart(equations, name, 1)
    at = solved(equations, point)
    borne = [r for each in equations.spec.constraints for r in each.reactions if r in at]
    expected = textbook.OBSERVABLES[name](x, p) if borne else {}
    found = [*values(moved, at), *values([equations.observables[r] for r in borne], at)]
    return same(found, [*textbook.RATES[name](x, p), *(expected[r] for r in borne)])


def with_constants(name, constants):
    """A shipped system on an algebra with other structure constants."""
    declared = bare(shipped(name))
    return replace(declared, algebra=replace(declared.algebra, constants=constants))


def try_route(changed, route, setting):
    """The equations by a route of a changed spec, or the words with which it is refused."""
    try:
        return derive(changed, route, setting=setting)
    except (AlgebraError, DerivationError) as error:
        return str(error)


def derive_routes(changed):
    """The equations by each route of a changed spec that does not refuse the algebra."""
    setting = make_setting(changed)
    found = [try_route(changed, route, setting) for route in changed.routes]
    assert all(changed.algebra.name in each for each in found if isinstance(each, str)), found
    return [each for each in found if not isinstance(each, str)]


@pytest.mark.parametrize("name", in_campaigns(ON_ALGEBRAS))
def test_the_unchanged_algebra_agrees_with_the_book(name):
    """Rebuilding the algebra without a flip changes nothing."""
    same_again = with_constants(name, shipped(name).algebra.constants)
    found = derive_routes(same_again)
    assert [equations.route for equations in found] == list(same_again.routes)
    for equations in found:
        assert agrees(equations, name), equations.route


@pytest.mark.parametrize("name", in_campaigns(ON_ALGEBRAS))
def test_every_sign_of_every_structure_constant(name):
    """Each flip violates Jacobi or the action, or every route refuses it or contradicts the book.

    A route by a Lax pair that it finds among matrices needs no constants: the others leave it.
    """
    algebra = shipped(name).algebra
    flips = [(pair, k, -c) for pair, row in algebra.constants.items() for k, c in row.items()]
    assert flips
    for flip in flips:
        try:
            changed = with_constants(name, spoiled_constants(algebra, *flip))
        except AlgebraError:
            continue
        routes = derive_routes(changed)
        for equations in routes:
            if equations.route == "hamel":  # it knows no reactions, which may be all that is made
                continue
            by_matrices = equations.pair is not None
            assert agrees(equations, name) == by_matrices, (flip, equations.route)
        assert not routes or not all(equations.pair for equations in routes), flip


def flip_term(operation, term):
    """ad* or the bracket, with one of the terms ``c_ij^k x_i y_k`` or ``c_ij^k x_i y_j`` turned."""
    right = getattr(LieAlgebra, operation)

    def wrong(self, x, y):
        found = list(right(self, x, y))
        for i, j, k, c in self.structure():  # in the field of the route
            if (i, j, k) == term:
                out, other = (j, k) if operation == "ad_star" else (k, j)
                found[out] = found[out] - 2 * c * x[i] * y[other]
        return tuple(found)

    return wrong


def record_terms(operation, met):
    """ad* or the bracket, noting its terms."""
    right = getattr(LieAlgebra, operation)

    def noting(self, x, y):
        met.update((i, j, k) for i, j, k, _ in self.structure())
        return right(self, x, y)

    return noting


@pytest.mark.parametrize(("name", "route"), in_campaigns(BY_OPERATION))
def test_every_sign_of_every_term_of_an_operation(name, route, monkeypatch):
    """The equations contradict the book for each flipped term of ad* or of the bracket."""
    declared, operation = bare(shipped(name), (route,)), OPERATIONS[route]
    setting, met = make_setting(declared), set()
    monkeypatch.setattr(LieAlgebra, operation, record_terms(operation, met))
    assert agrees(derive(declared, route, setting=setting), name)
    monkeypatch.undo()
    assert met
    for term in sorted(met):
        monkeypatch.setattr(LieAlgebra, operation, flip_term(operation, term))
        assert not agrees(derive(declared, route, setting=setting), name), term
        monkeypatch.undo()


@pytest.mark.parametrize("name", SMALL)
def test_every_sign_of_every_entry_of_the_bracket(name, monkeypatch):
    """The Lie-Poisson equations contradict the book for each flipped {x_i, x_j}."""
    right, declared = structure.lie_poisson, bare(shipped(name), ("lie-poisson",))
    setting = make_setting(declared)
    entire = structure.poisson_structure(setting)
    size = entire.dimension
    pairs = [(i, j) for i in range(size) for j in range(i) if entire.tensor[i][j]]
    assert pairs
    for pair in pairs:

        def wrong(algebra, field, names, sign, pair=pair):
            found = right(algebra, field, names, sign)
            entries = {(i, j): found.tensor[i][j] for i in range(size) for j in range(i)}
            entries[pair] = -entries[pair]
            return replace(found, tensor=antisymmetric(field, size, entries))

        monkeypatch.setattr(structure, "lie_poisson", wrong)
        setting.built.clear()  # the bracket is built once
        assert not agrees(derive(declared, setting=setting), name), pair


@pytest.mark.parametrize(("name", "route"), EACH_SIDE)
def test_minus_and_plus(name, route, monkeypatch):
    """Taking left for right only reverses time; the rates of the book detect it.

    Newton's law of mass points that are fixed in a body needs no sign: there the proof that routes
    are equal sees it.
    """
    emitted = bare(shipped(name)).routes[0]
    declared = bare(shipped(name), tuple(dict.fromkeys((emitted, route))))
    wrong = -make_setting(declared).sign
    monkeypatch.setattr(Setting, "sign", property(lambda setting: wrong))
    setting = make_setting(declared)
    routes = [derive(declared, each, setting=setting) for each in declared.routes]
    if name in ALIKE:
        assert all(agrees(each, name) for each in routes)
    elif agrees(routes[-1], name):
        assert not agrees(routes[0], name)
        assert any(route in claim.statement for claim in prove_claims(declared, routes).refuted)


@pytest.mark.parametrize(("name", "route"), EACH_SIDE)
def test_minus_and_plus_in_a_spec(name, route):
    """A spec with the other side contradicts the book or is refused."""
    other = {"left": "right", "right": "left"}[shipped(name).invariance]
    text, count = re.subn(
        r'(invariance +=) "\w+"', rf'\1 "{other}"', shipped(name).path.read_text()
    )
    assert count == 1
    # what rolls is refused as right invariant when it is read; the route shall see it by itself
    text = re.sub(r"\[rolling\]\n(.+\n)+", "", text)
    if any(each.turning == "pose" for each in shipped(name).variables):
        with pytest.raises(SpecError, match="has no pose"):
            spec(text)
        return
    wrong = bare(spec(text), (route,))
    found = try_route(wrong, route, make_setting(wrong))
    if isinstance(found, str):
        assert "the system is right-invariant; expected a left-invariant one" in found
    else:
        assert agrees(found, name) == (name in ALIKE)


@pytest.mark.parametrize("name", BY_LIE_POISSON)
def test_minus_and_plus_of_the_bracket(name, monkeypatch):
    """With the plus bracket alone no system agrees with the book."""
    right = structure.lie_poisson
    monkeypatch.setattr(
        structure, "lie_poisson", lambda a, field, names, sign: right(a, field, names, -sign)
    )
    assert not agrees(derive(bare(shipped(name), ("lie-poisson",))), name)


def test_every_system_and_kind_of_route_is_tried():
    """The lists above contain all shipped systems that they should."""
    algebraic = {name for name in SYSTEMS if "[algebra]" in shipped(name).path.read_text()}
    assert {name for name, _ in BY_SIDE} == algebraic > set(ON_ALGEBRAS) >= set(BY_LIE_POISSON)
    assert {route for _, route in BY_OPERATION} == set(OPERATIONS)
    assert {name for name, _ in BY_OPERATION} <= set(ON_ALGEBRAS)
    assert len(SMALL) >= 10
