"""Declared symmetries, transformations and brackets: what is read, and each fault at its place."""

import pytest

from coadjoint.errors import AlgebraError, SpecError
from tests.spec.texts import refused
from tests.specs import spec

TEXT = """
title = "particle"
routes = ["poisson"]
[poisson]
canonical = [["q", "p"], ["S", "P"]]
[variables]
q = { role = "coordinate", shape = [3] }
p = { role = "coordinate", shape = [3] }
S = { role = "coordinate", shape = [6], form = "symmetric" }
P = { role = "coordinate", shape = [6], form = "symmetric" }
[parameters]
m = { default = 1 }
[hamiltonian]
h = "dot(p, p)/(2*m) + trace(P*P)/2"
[observables]
L = "cross(q, p)"
[symmetries.J]
algebra    = "so(3)"
matrix     = "A"
generators = { q = "A*q", S = "A*S + S*transpose(A)" }
[symmetries.U]
algebra = "sp(6)"
linear  = ["q", "p"]
[transformations.flip]
map       = { p = "-p" }
exchanges = { L = "-L" }
[claims]
conserved = ["J"]
[claims.brackets]
"{L, q}"               = "-hat(q)"
"{dot(q, p), p[1]}"    = "p[1]"
"{(q[1] + m*q[2]), J}" = "0*J"
"""


def test_a_spec_with_symmetries():
    """Names, shapes, sides and both sides of a bracket, cut at the comma outside parentheses."""
    found = spec(TEXT)
    assert [(s.name, s.components, s.side) for s in found.symmetries] == [
        ("J", ("J1", "J2", "J3"), "left"),
        ("U", tuple(f"U{n}" for n in range(1, 22)), "left"),
    ]
    sides = [(claim.left.text, claim.right.text) for claim in found.brackets]
    assert sides == [("L", "q"), ("dot(q, p)", "p[1]"), ("(q[1] + m*q[2])", "J")]
    (flip,) = found.transformations
    assert list(flip.map) == ["p"]
    assert flip.exchanges["L"].text == "-L"


def test_the_form_of_a_momentum_map():
    """gl(3) in the form of a matrix has J11, ...; in formulas it is the matrix."""
    changed = spec(
        TEXT,
        ('"so(3)"\nmatrix ', '"gl(3,R)"\nform = "matrix"\nmatrix '),
        ("0*J", "0*q"),
        ("m*q[2]), J}", "m*q[2]), J[1]}"),
    )
    J = changed.symmetries[0]
    assert J.components[:4] == ("J11", "J12", "J13", "J21")
    assert J.value_shape == (3, 3)


@pytest.mark.parametrize(
    ("change", "culprit", "expected"),
    [
        (('q = "A*q"', 'q = "A*A*q"'), "'A'", "linear in A"),
        (('q = "A*q"', 'q = "A*q + q"'), "'A'", "linear in A"),
        (('q = "A*q"', 'q = "q/trace(A)"'), "'A'", "linear in A"),
        (('q = "A*q"', 'q = "A"'), "a 3 by 3 matrix", "as 'q' is"),
        (('q = "A*q"', 'x = "A*q"'), "'x'", "q, p, S"),
        (('matrix     = "A"', 'matrix     = "m"'), "'m'", "nothing else has"),
        (('matrix     = "A"', 'form = "matrix"\nmatrix = "A"'), "3 components", "n^2"),
        (('matrix     = "A"', ""), "symmetries.J", "vector or matrix"),
        (("[symmetries.J]", "[symmetries.q]"), "'q'", "differ"),
        (('["q", "p"]\n[trans', '["q"]\n[trans'), "3 components", "6 components"),
        (('["q", "p"]\n[trans', '["q", "r"]\n[trans'), "'r'", "q, p, S"),
        (('p = "-p"', 'r = "-p"'), "'r'", "q, p, S"),
        (('p = "-p"', 'p = "dot(p, p)"'), "a scalar", "as 'p' is"),
        (('{ L = "-L" }', '{ K = "-L" }'), "'K'", "L"),
        (('{ L = "-L" }', '{ L = "-dot(L, L)" }'), "a scalar", "as 'L' is"),
        (('"{L, q}"  ', '"{L; q}"  '), "'{L; q}'", "'{L, A}'"),
        (('"{L, q}"  ', '"{L, r}"  '), "'r'", ""),
        (('"{L, q}"  ', '"{L, S}"  '), "'S'", "scalars and vectors"),
        (('"-hat(q)"', '"-q"'), "a 3-vector", "3 by 3 matrix"),
    ],
)
def test_faults_of_symmetries(change, culprit, expected):
    """Each message names the guilty value and what is expected."""
    error = refused(change, text=TEXT)
    assert culprit in str(error), error
    assert expected in str(error), error


@pytest.mark.parametrize(
    "text", ["A*vector(q[1], 0, 0)", "A*q + vector(0, 0, 0)", "0*(A*q)", "vector(0, A[1, 2], 0)"]
)
def test_zeros_are_linear_in_anything(text):
    """A zero has every degree, as an addend, a factor and a component."""
    assert spec(TEXT, ('q = "A*q"', f'q = "{text}"')).symmetries[0].name == "J"


def test_an_unknown_algebra_is_refused_at_its_line():
    """The message names the algebra and the line."""
    error = refused(('"so(3)"\n', '"so(x)"\n'), text=TEXT, kind=AlgebraError)
    assert "so(x)" in str(error)
    assert ":18:14:" in str(error)


def test_pairs_of_one_form():
    """A symmetric matrix is paired with a symmetric one; entries beside the diagonal have 1/2."""
    weights = spec(TEXT).poisson.weights
    assert [str(w) for w in weights] == ["1"] * 3 + ["1", "1/2", "1/2", "1", "1/2", "1"]
    with pytest.raises(SpecError, match="'P' has 6 components; expected a position and a momentum"):
        spec(
            TEXT,
            (
                'P = { role = "coordinate", shape = [6], form = "symmetric" }',
                'P = { role = "coordinate", shape = [6] }',
            ),
            ("trace(P*P)", "dot(P, P)"),
        )
