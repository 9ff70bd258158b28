"""Poisson: declared brackets are read as typed, and a slip in one is shown where it is."""

import pytest

from coadjoint.errors import SpecError
from coadjoint.spec.core.tree import Name
from tests.spec.texts import refused
from tests.specs import RIGID_BODY, spec

NAMBU = """
title = "x"
routes = ["nambu", "poisson"]
[poisson]
nambu = ["dot(x, x)/2"]
[variables]
x = { role = "coordinate", shape = [3] }
[parameters]
k = { default = 1 }
[hamiltonian]
h = "x[3]^2/2 + k*x1"
[claims]
casimirs = ["dot(x, x)"]
"""
BRACKETS = NAMBU.replace(', "poisson"', "").replace("nambu", "poisson", 1)
BRACKETS = BRACKETS.replace(
    'nambu = ["dot(x, x)/2"]', 'brackets = { "{x1, x2}" = "k*x3", "{x3,x1}" = "x2" }'
)
CANONICAL = """
title = "x"
routes = ["poisson"]
[poisson]
canonical = [["q", "p"], ["angle", "L"]]
magnetic = { "{p1, p2}" = "B*q[1]", "{p2, L}" = "0" }
[variables]
p = { role = "coordinate", shape = [2] }
q = { role = "coordinate", shape = [2] }
angle = { role = "coordinate" }
L = { role = "coordinate" }
[parameters]
B = {}
[hamiltonian]
h = "dot(p, p)/2 + L^2/2 - cos(angle)"
"""


def test_nambu_functions_are_read():
    """One function of three coordinates, and no algebra."""
    declared = spec(NAMBU)
    assert declared.algebra is None
    assert declared.invariance == "left"
    assert declared.poisson.kind == "nambu"
    assert [f.text for f in declared.poisson.functions] == ["dot(x, x)/2"]
    assert [f.key for f in declared.poisson.functions] == ["poisson.nambu[1]"]
    assert [v.name for v in declared.state] == ["x"]
    assert declared.state[0].shape == (3,)


def test_brackets_are_kept_as_typed():
    """{x3, x1} stays in its order; pairs left out are 0."""
    poisson = spec(BRACKETS).poisson
    assert poisson.kind == "brackets"
    assert [(i, j, f.text) for i, j, f in poisson.entries] == [(0, 1, "k*x3"), (2, 0, "x2")]
    assert poisson.entries[1][2].tree == Name("x2")


def test_canonical_pairs_are_places_of_components():
    """Whole variables pair up, in the order of the state, which is that of the declaration."""
    declared = spec(CANONICAL)
    assert [c for v in declared.state for c in v.components] == [
        "p1",
        "p2",
        "q1",
        "q2",
        "angle",
        "L",
    ]
    assert declared.poisson.pairs == ((2, 0), (3, 1), (4, 5))
    assert [(i, j) for i, j, _ in declared.poisson.entries] == [(0, 1), (1, 5)]
    single = spec(CANONICAL, ('["q", "p"]', '["q1", "p2"], ["q2", "p1"]')).poisson
    assert single.pairs == ((2, 1), (3, 0), (4, 5))
    assert spec(CANONICAL, ('magnetic = { "{p1, p2}" = "B*q[1]", "{p2, L}" = "0" }', "")).poisson


def test_coordinates_may_be_matrices():
    """Six coordinates of the form symmetric are a 3 by 3 matrix."""
    text = NAMBU.replace("nambu", "poisson", 1).replace(', "poisson"', "")
    declared = spec(
        text,
        ('nambu = ["dot(x, x)/2"]', 'brackets = { "{x12, x33}" = "x[3, 2]" }'),
        ("shape = [3]", 'shape = [6], form = "symmetric"'),
        ("x[3]^2/2 + k*x1", "trace(x*x)/2 + det(x)"),
        ("dot(x, x)", "x11"),
    )
    assert declared.state[0].components == ("x11", "x12", "x13", "x22", "x23", "x33")
    assert [(i, j) for i, j, _ in declared.poisson.entries] == [(1, 5)]


@pytest.mark.parametrize(
    ("text", "change", "key", "found", "said"),
    [
        (NAMBU, ('["dot(x, x)/2"]', '["x1", "x2"]'), "poisson.nambu", 2, "expected 1, two fewer"),
        (NAMBU, ("[3] }", "[4] }"), "poisson.nambu", 1, "expected 2, two fewer"),
        (NAMBU, ("[3] }", "[2] }"), "poisson.nambu", 1, "at least 3 coordinates"),
        (NAMBU, ('["dot(x, x)/2"]', '["dot(x, y)"]'), "poisson.nambu[1]", "y", "not declared"),
        (NAMBU, ('["dot(x, x)/2"]', '["x"]'), "poisson.nambu[1]", "a 3-vector", "a scalar"),
        (BRACKETS, ("{x1, x2}", "{x1, y2}"), "poisson.brackets.{x1, y2}", "y2", "x1, x2, x3"),
        (BRACKETS, ("{x1, x2}", "{x, x2}"), "poisson.brackets.{x, x2}", "x", "x1, x2, x3"),
        (BRACKETS, ("{x1, x2}", "[x1, x2]"), "poisson.brackets.[x1, x2]", "[x1, x2]", "'{x1, x2}'"),
        (BRACKETS, ("{x1, x2}", "{x1, x3}"), "poisson.brackets.{x3,x1}", "{x3,x1}", "twice"),
        (BRACKETS, ("{x1, x2}", "{x1, x1}"), "poisson.brackets.{x1, x1}", "{x1, x1}", "is 0"),
        (BRACKETS, ('"k*x3"', '"k*x4"'), "poisson.brackets.{x1, x2}", "x4", "not declared"),
        (CANONICAL, ('["q", "p"]', '["Q", "p"]'), "poisson.canonical[1][1]", "Q", "p, q, angle, L"),
        (CANONICAL, ('["q", "p"]', '["q", "p1"]'), "poisson.canonical[1]", "q, p1", "2 components"),
        (CANONICAL, (', ["angle", "L"]', ""), "poisson.canonical", "angle", "as a parameter"),
        (
            CANONICAL,
            ('["angle", "L"]', '["angle", "L"], ["q1", "p1"]'),
            "poisson.canonical",
            "p1",
            "more than one pair",
        ),
        (CANONICAL, ('["q", "p"]', '["q", "q"]'), "poisson.canonical", "p1", "no pair"),
        (CANONICAL, ("{p1, p2}", "{q1, p2}"), "poisson.magnetic.{q1, p2}", "q1", "p1, p2, L"),
        (CANONICAL, ('"B*q[1]"', '"C*q[1]"'), "poisson.magnetic.{p1, p2}", "C", "not declared"),
    ],
)
def test_slip_in_a_bracket_is_refused_at_its_place(text, change, key, found, said):
    """Unknown coordinates, doubled pairs, functions too few or many."""
    error = refused(change, text=text)
    assert (error.key, error.found) == (key, found)
    assert said in str(error)


@pytest.mark.parametrize(
    ("text", "change", "key", "found", "said"),
    [
        (
            NAMBU,
            ("[poisson]", '[algebra]\nname = "so(3)"\n[poisson]'),
            "poisson",
            "poisson",
            "both",
        ),
        (NAMBU, ('[poisson]\nnambu = ["dot(x, x)/2"]', ""), "routes[1]", "nambu", "[algebra] or"),
        (NAMBU, ('"nambu", "poisson"', '"lie-poisson"'), "routes[1]", "lie-poisson", "[algebra]"),
        (BRACKETS, ('["poisson"]', '["nambu"]'), "routes[1]", "nambu", "nambu functions"),
        (
            RIGID_BODY,
            ('"lie-poisson"', '"poisson"'),
            "routes[2]",
            "poisson",
            "starts from [poisson]",
        ),
        (NAMBU, ('h = "x[3]^2/2 + k*x1"', ""), "hamiltonian", "h", "Write for instance h ="),
        (
            NAMBU,
            ('[hamiltonian]\nh = "x[3]^2/2 + k*x1"', ""),
            "routes[1]",
            "nambu",
            "Hamiltonian",
        ),
        (
            NAMBU,
            ("[hamiltonian]", '[lagrangian]\nl = "k"\n[hamiltonian]'),
            "lagrangian",
            "lagrangian",
            "no route uses the Lagrangian",
        ),
        (
            NAMBU,
            ("[hamiltonian]", "[representations.r]\nmatrices = { e1 = [[0]] }\n[hamiltonian]"),
            "representations",
            "representations",
            "only with [algebra]",
        ),
        (NAMBU, ('"coordinate", shape = [3]', '"velocity"'), "variables.x.role", "velocity", "'x'"),
        (NAMBU, ('"coordinate", shape = [3]', '"momentum"'), "variables.x.role", "momentum", "'x'"),
        (NAMBU, ("shape = [3]", 'block = "x1"'), "variables.x.block", "x1", "Remove block"),
        (
            RIGID_BODY,
            ('role = "momentum"', 'role = "coordinate"'),
            "variables",
            "J1, J2, J3",
            "no momentum spans",
        ),
        (
            RIGID_BODY.replace('"lie-poisson"', '"clebsch"'),
            ('role = "momentum"', 'role = "coordinate"'),
            "variables.Pi.role",
            "coordinate",
            "with [algebra]",
        ),
        (
            RIGID_BODY,
            ('role = "momentum"', 'role = "momentum", shape = [3]'),
            "variables.Pi.shape",
            "[Fraction(3, 1)]",
            "Remove shape",
        ),
        (NAMBU, ("shape = [3]", "shape = [3, 3]"), "variables.x.shape", "a list of 2", "at most 1"),
        (NAMBU, ("nambu = [", "nambus = ["), "poisson.nambus", "nambus", "'nambu'?"),
        (
            NAMBU,
            ("nambu = [", 'canonical = [["x1", "x2"]]\nnambu = ['),
            "poisson",
            "a table of 2",
            "exactly one of nambu, brackets and canonical",
        ),
        (
            NAMBU,
            ("nambu = [", 'magnetic = { "{x1, x2}" = "k" }\nnambu = ['),
            "poisson",
            "a table of 2",
            "only with canonical",
        ),
        (CANONICAL, ('["q", "p"]', '["q", "p", "L"]'), "poisson.canonical[1]", "a list of 3", "2"),
    ],
)
def test_wrong_combination_is_refused(text, change, key, found, said):
    """Routes, roles and tables go with an algebra or with a bracket, not with the other."""
    error = refused(change, text=text)
    assert error.key == key
    assert said in str(error)
    if not found.startswith("[Fraction"):
        assert error.found == found


def test_formulas_of_coordinates_take_coordinates_alone():
    """The message says what a Hamiltonian is a function of."""
    with pytest.raises(SpecError) as caught:
        spec(NAMBU, ("k*x1", "k*y1"))
    assert caught.value.found == "y1"
    declared = spec(
        NAMBU, ("[claims]", '[observables]\ntilt = "x3"\n[claims]\nconserved = ["tilt"]')
    )
    assert declared.observables[0].formula.text == "x3"
