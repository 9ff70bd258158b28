"""Consistency: names are free and single, blocks tile, and routes find what they start from."""

import pytest

from coadjoint.errors import LimitError
from tests.specs import RIGID_BODY, refused, spec

KIRCHHOFF = """
title = "x"
routes = ["euler-poincare", "lie-poisson"]
[algebra]
name = "se(3)"
[variables]
Omega = { role = "velocity", block = "rotation" }
v = { role = "velocity", block = "translation" }
Pi = { role = "momentum", block = "rotation" }
P = { role = "momentum", block = "translation" }
[lagrangian]
l = "dot(Omega, Omega)/2 + dot(v, v)/2"
"""
MOMENTA_ONLY = """
title = "x"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Pi = { role = "momentum" }
[hamiltonian]
h = "dot(Pi, Pi)/2"
"""


def test_momenta_alone_serve_the_lie_poisson_route():
    """A Hamiltonian needs no velocities."""
    assert spec(MOMENTA_ONLY).lagrangian is None
    assert spec(KIRCHHOFF).hamiltonian is None


def test_basis_names_may_be_component_names():
    """se(3) has a translation P1, and the impulse P has a component P1: different things."""
    assert "P1" in spec(KIRCHHOFF).algebra.basis


@pytest.mark.parametrize(
    ("change", "found", "said"),
    [
        (("Pi =", "lambda ="), "lambda", ["keyword of Python", "'lam'"]),
        (("Pi =", "double ="), "double", ["keyword of C"]),
        (("Pi =", "state ="), "state", ["generated code", "'state_0'"]),
        (("Pi =", "NAN ="), "NAN", ["C headers"]),
        (("Pi =", "cross ="), "cross", ["function"]),
        (("Pi =", "casimir ="), "casimir1", ["component of 'casimir'"]),
        (("Pi =", "x" * 31 + " ="), "x" * 31 + "1", ["NAME_CHARACTERS"]),
        (("Pi =", '"a b" ='), "a b", ["'a b' is not a name", "'a_b'"]),
        (("Pi =", '"\u03a0" ='), "\u03a0", ["'\\u03a0' is not a name"]),
        (("[parameters]", "[parameters]\nI1 = {}"), "I1", ["parameters.I1 has that name too"]),
        (("[parameters]", "[parameters]\nOmega2 = {}"), "Omega2", ["variables.Omega"]),
        (("[parameters]", "[parameters]\nPi = {}"), "Pi", ["variables.Pi"]),
        (("[parameters]", "[parameters]\ndPi1_dt = {}"), "dPi1_dt", ["variables.Pi"]),
        (("[claims]", '[observables]\nI3 = "1"\n[claims]'), "I3", ["parameters.I"]),
        (("[claims]", '[observables]\nenergy = "1"\n[claims]'), "energy", ["results use"]),
    ],
)
def test_reserved_or_doubled_name_is_refused(change, found, said):
    """The message has the name, who has it already, and points at the key."""
    error = refused(change)
    assert error.found == found
    assert all(part in str(error) for part in said), str(error)


@pytest.mark.parametrize(
    ("change", "found", "said"),
    [
        (
            ('v = { role = "velocity", block = "translation"', 'v = { role = "velocity"'),
            "v",
            "'v' and 'Omega' both span J1",
        ),
        (
            (
                'P = { role = "momentum", block = "translation"',
                'P = { role = "momentum", block = "rotation"',
            ),
            "P",
            "both span J1",
        ),
        (
            ('P = { role = "momentum", block = "translation" }\n', ""),
            "v",
            "the velocity 'v' has no momentum of the same block",
        ),
        (
            ('v = { role = "velocity", block = "translation" }\n', ""),
            "P",
            "the momentum 'P' has no velocity of the same block",
        ),
        (
            (
                'Pi = { role = "momentum", block = "rotation" }',
                'Pi = { role = "momentum", block = ["J3", "J1", "J2"] }',
            ),
            "Omega",
            "the same block",
        ),
    ],
)
def test_blocks_that_do_not_tile_are_refused(change, found, said):
    """Overlaps and partners that are missing are named."""
    error = refused(change, text=KIRCHHOFF)
    assert error.found == found
    assert said in str(error)


@pytest.mark.parametrize(
    ("text", "changes", "key", "said"),
    [
        (
            RIGID_BODY,
            [('[lagrangian]\nl = "dot(Omega, diag(I)*Omega)/2"', "")],
            "routes[1]",
            "the route euler-poincare has no Lagrangian",
        ),
        (
            MOMENTA_ONLY,
            [('[hamiltonian]\nh = "dot(Pi, Pi)/2"', "")],
            "routes[1]",
            "neither a Hamiltonian nor a Lagrangian",
        ),
        (
            RIGID_BODY,
            [('Pi = { role = "momentum" }\n', "")],
            "variables",
            'Pi = { role = "momentum" }',
        ),
        (
            RIGID_BODY,
            [('Omega = { role = "velocity" }\n', "")],
            "variables",
            'Omega = { role = "velocity" }',
        ),
        (
            MOMENTA_ONLY,
            [('"momentum" }', '"momentum", block = ["J1", "J2"] }')],
            "variables",
            'block = ["J3"]',
        ),
        (
            RIGID_BODY,
            [(', "lie-poisson"', ""), ("[claims]", '[hamiltonian]\nh = "dot(Pi, Pi)"\n[claims]')],
            "hamiltonian",
            "no route uses the Hamiltonian",
        ),
    ],
)
def test_route_without_what_it_needs_is_refused(text, changes, key, said):
    """The message says what is missing and how to write it."""
    error = refused(*changes, text=text)
    assert error.key == key
    assert said in str(error)


def test_too_many_components_are_refused():
    """State and parameters have a limit each."""
    error = refused(("[parameters]", "[parameters]\nA = { shape = [16, 16] }"), kind=LimitError)
    assert (error.limit, error.found) == ("PARAMETER_COMPONENTS", 259)
    extra = "".join(
        f'a{n}_ = {{ role = "advected", representation = "vector" }}\n'.replace("_", "x")
        for n in range(85)
    )
    error = refused(("[parameters]", extra + "[parameters]"), kind=LimitError)
    assert (error.limit, error.found) == ("STATE_COMPONENTS", 258)
