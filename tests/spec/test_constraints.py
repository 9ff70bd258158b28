"""[constraints] and its companions: what gives a velocity, and every fault with place and fix."""

import pytest

from coadjoint.errors import SpecError
from coadjoint.spec.core.faults import list_names
from tests.constrained import BALL, PARTICLE, SLEIGH
from tests.specs import RIGID_BODY, spec

BLADE = 'blade = "w == y*u"'


def given(*lines, text=PARTICLE, more=()):
    """Constraint and side by the velocity that it gives."""
    declared = spec(text, (BLADE, "\n".join(lines)), *more)
    return {each.solves: (each.name, each.sign) for each in declared.constraints if each.solves}


def test_a_side_that_is_one_velocity_gives_it():
    """On either side; a multiple and a side that names it on the right give none."""
    assert given('c = "w == y*u"') == {"w": ("c", 1)}
    assert given('c = "y*u == w"') == {"w": ("c", -1)}
    assert given('c = "w - y*u == 0"') == {}
    assert given('c = "2*w == y*u"') == {}
    assert given('c = "w == y*u - w"') == {}


#: The ball with other constraints.
FREE_BALL = BALL.replace('rolling = "Y == cross(Omega, s)"', BLADE)


def test_a_side_that_is_a_component_gives_it():
    """The others are the state, each by its own name; the whole is still a vector in formulas."""
    assert given('c = "Omega3 == 0"', text=FREE_BALL) == {"Omega3": ("c", 1)}
    assert given('c = "r*Omega1 + 1 == Omega3"', text=FREE_BALL) == {"Omega3": ("c", -1)}
    ball = spec(FREE_BALL, (BLADE, 'c = "Omega3 == 0"'))
    names = ["Omega1", "Omega2", "Y", "Gamma"]
    assert [v.name for v in ball.state] == names
    assert [v.name for v in ball.defined] == ["Omega3"]


@pytest.mark.parametrize(
    "second",
    ["Omega3 == Omega1*Omega3", "Omega3 == dot(Omega, s)", "Omega3 == Y1", "2*Omega3 == 0"],
)
def test_a_component_that_depends_on_itself_is_kept(second):
    """By its name, by that of the whole, or through what an earlier constraint gives."""
    lines = 'a = "Y == cross(Omega, s)"', f'c = "{second}"'
    assert given(*lines, text=FREE_BALL) == {"Y": ("a", 1)}


def test_a_velocity_is_given_once():
    """A component of what is given gives nothing more, nor does the whole of a component."""
    lines = 'a = "Y == cross(Omega, s)"', 'c = "Y1 == 0"'
    assert given(*lines, text=FREE_BALL) == {"Y": ("a", 1)}
    assert given(*reversed(lines), text=FREE_BALL) == {"Y1": ("c", 1)}


def test_a_parameter_may_be_called_like_a_component():
    """Of a vector with fewer components; it is no velocity."""
    more = [("[parameters]", "[parameters]\nOmega9 = { default = 1 }")]
    assert given('c = "Omega9 == Omega3"', text=FREE_BALL, more=more) == {"Omega3": ("c", -1)}


def test_of_two_velocities_alone_the_left_one_is_given():
    """The equation "u == v" gives u; v is free then."""
    assert given('c = "u == v"') == {"u": ("c", 1)}
    assert [q.name for q in spec(PARTICLE, (BLADE, 'c = "u == v"')).state] == [*"xyz", "v", "w"]


def test_velocities_may_be_given_through_each_other_but_not_by_themselves():
    """A chain gives both; where it closes, the last constraint is kept."""
    assert given('c = "u == k*w"', 'd = "w == k*v"') == {"u": ("c", 1), "w": ("d", 1)}
    assert given('c = "u == k*w"', 'd = "w == k*v"', 'e = "v == y*u"') == {
        "u": ("c", 1),
        "w": ("d", 1),
    }
    assert given('c = "u == k*w"', 'd = "w == y*u"') == {"u": ("c", 1)}
    assert given('c = "u == k*w"', 'd = "u == y*v"') == {"u": ("c", 1)}


def test_definitions_are_looked_through():
    """A velocity that a definition hides depends on itself all the same; arguments do, too."""
    hidden = ("[lagrangian]", '[definitions]\nq = "y*w"\n"f(s)" = "s + q"\n[lagrangian]')
    assert given('c = "w == q"', more=[hidden]) == {}
    assert given('c = "u == q"', 'd = "w == f(v)"', more=[hidden]) == {"u": ("c", 1)}
    assert given('c = "u == f(v)"', more=[hidden]) == {"u": ("c", 1)}


def test_the_state_is_what_no_constraint_gives():
    """In declared order; what is given is emitted beside the dynamics."""
    ball = spec(BALL)
    assert [v.name for v in ball.state] == ["Omega", "Gamma"]
    assert [v.name for v in ball.defined] == ["Y"]
    assert [c.reactions for c in ball.constraints] == [
        ("rolling_reaction1", "rolling_reaction2", "rolling_reaction3")
    ]
    assert [v.name for v in spec(SLEIGH).state] == ["omega", "v"]
    kept = spec(SLEIGH, ('"u == 0"', '"u + 0*v == 0"'))
    assert [v.name for v in kept.state] == ["omega", "v", "u"]


def test_forces_sections_and_dissipation_are_read():
    """Forces know velocities; a section knows positions and is along velocities that are free."""
    declared = spec(
        PARTICLE,
        ("[claims]", '[forces]\nu = "-k*u"\nw = "k"\n[claims]'),
        ("[claims]", '[dissipation]\nR = "k*dot(vector(u, w), vector(u, w))"\n[claims]'),
        ("[claims]", '[momenta.J]\nsection = { u = "y", v = "k" }\nunit = "1"\n[claims]'),
    )
    assert {name: f.text for name, f in declared.forces.items()} == {"u": "-k*u", "w": "k"}
    assert declared.dissipation is not None
    (section,) = declared.sections
    assert (section.name, list(section.section), section.unit) == ("J", ["u", "v"], "1")


ROUTES = 'routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]'
CLAIMS = "[claims]"
FAULTS = [
    ((BLADE, ""), "constraints", "an empty table", "expected at least 1 item."),
    ((BLADE, "blade = 3"), "constraints.blade", "3", "expected text in quotes"),
    (
        (ROUTES, 'routes = ["euler-lagrange"]'),
        "routes[1]",
        "euler-lagrange",
        "does not accept [constraints]",
    ),
    (
        ('"nonholonomic-hamilton-pontryagin"]', '"euler-lagrange"]'),
        "routes[3]",
        "euler-lagrange",
        'Remove "euler-lagrange", or remove [constraints].',
    ),
    ((ROUTES, 'routes = ["hamel"]'), "routes[1]", "hamel", 'Put "nonholonomic" first.'),
    (("[lagrangian]\nl", "[hamiltonian]\nh"), "routes[1]", "nonholonomic", "has no Lagrangian"),
    (
        ("[parameters]", 'p = { role = "momentum", of = "x" }\n[parameters]'),
        "variables.p.role",
        "momentum",
        "'p' is a momentum, and the state has velocities on these routes",
    ),
    ((CLAIMS, '[forces]\nq = "3"\n[claims]'), "forces.q", "q", "expected one of u, v, w"),
    (
        (CLAIMS, '[forces]\nx = "3"\n[claims]'),
        "forces.x",
        "x",
        "'x' is a coordinate; expected one of u, v, w. Write u in its place.",
    ),
    (
        (CLAIMS, '[forces]\nu = "vector(u, v)"\n[claims]'),
        "forces.u",
        "a 2-vector",
        "expected a scalar, as 'u' is",
    ),
    (
        (CLAIMS, '[forces]\nu = "edge_reaction"\n[claims]'),
        "forces.u",
        "edge_reaction",
        "'edge_reaction' is not declared",
    ),
    (
        (BLADE, BLADE + '\nslow = "u == pull*v"\n[definitions]\npull = "blade_reaction"'),
        "constraints.slow",
        "pull",
        "Write pull without reactions, or use it in [forces] alone.",
    ),
    (
        (CLAIMS, '[dissipation]\nR = "vector(u, v)"\n[claims]'),
        "dissipation.R",
        "a 2-vector",
        "expected a scalar",
    ),
    ((CLAIMS, '[dissipation]\nS = "u^2"\n[claims]'), "dissipation.S", None, "unknown key 'S'"),
    (
        (CLAIMS, '[momenta.J]\nsection = { w = "1" }\n[claims]'),
        "momenta.J.section.w",
        "w",
        "expected one of u, v",
    ),
    (
        (CLAIMS, '[momenta.J]\nsection = { u = "v" }\n[claims]'),
        "momenta.J.section.u",
        "v",
        "'v' is a velocity",
    ),
    (
        (CLAIMS, '[momenta.J]\nsection = { u = "vector(x, y)" }\n[claims]'),
        "momenta.J.section.u",
        "a 2-vector",
        "as 'u' is",
    ),
    ((CLAIMS, '[momenta.u]\nsection = { u = "1" }\n[claims]'), "momenta.u", "u", "is doubled"),
    (
        ("k = {", "blade_reaction = {"),
        "constraints.blade",
        "blade_reaction",
        "The multiplier of the constraint blade is blade_reaction: rename one of them.",
    ),
    (
        (CLAIMS, '[observables]\nblade_reaction = "u"\n[claims]'),
        "observables.blade_reaction",
        "blade_reaction",
        "The multiplier of the constraint blade is blade_reaction: rename one of them.",
    ),
    ((BLADE, BLADE + '\nu = "v == 0"'), "constraints.u", "u", "variables.u has that name too"),
    ((BLADE, '1blade = "v == 0"'), "constraints.1blade", "1blade", "'1blade' is not a name"),
]


@pytest.mark.parametrize(("change", "key", "found", "said"), FAULTS)
def test_faults_are_shown_at_their_place(change, key, found, said):
    """The key, what was found, and what was expected or would do."""
    with pytest.raises(SpecError) as caught:
        spec(PARTICLE, change)
    message = str(caught.value)
    assert said in message
    assert f": {key}: " in message
    assert found is None or found == str(caught.value.parts["found"])


@pytest.mark.parametrize("route", ["clebsch", "cayley-klein", "kaluza-klein"])
def test_a_route_in_variables_of_its_own_is_not_emitted(route):
    """Its rates are not those of the declared state, so another one comes first."""
    with pytest.raises(SpecError, match="cannot be the first") as caught:
        spec(RIGID_BODY, ('["euler-poincare", "lie-poisson"]', f'["{route}", "lie-poisson"]'))
    assert caught.value.parts["found"] == route
    assert 'Put "euler-poincare" first.' in str(caught.value)
    assert list_names(["euler-poincare", "lie-poisson"]) in str(caught.value)


@pytest.mark.parametrize("table", ["[claims]\ngalilean = true", '[lax]\nL = "v"\nM = "v"'])
def test_what_rests_on_other_routes_is_refused(table):
    """Neither Galilean relativity nor a Lax pair is spoken of beside constraints."""
    with pytest.raises(SpecError, match=r"there is no \[newton\]|no route uses the table \[lax\]"):
        spec(SLEIGH + table)


def test_names_of_momenta_are_taken():
    """The momentum of v is emitted as v_momentum, which nothing else may be called."""
    assert [each.name for each in spec(SLEIGH).reduced_momenta] == ["omega_momentum", "v_momentum"]
    with pytest.raises(SpecError, match="'v_momentum' is doubled") as caught:
        spec(SLEIGH, ("k = {", "v_momentum = {"))
    assert "parameters.v_momentum has that name too" in str(caught.value)


def test_sections_and_forces_know_components():
    """A section goes along a component that is left; a force along the whole velocity."""
    more = [
        (BLADE, 'c = "Omega3 == 0"'),
        (
            "[constraints]",
            '[momenta.J]\nsection = { Omega1 = "r" }\n[forces]\nOmega = "-Omega"\n[constraints]',
        ),
    ]
    ball = spec(FREE_BALL, *more)
    assert list(ball.sections[0].section) == ["Omega1"]
    assert list(ball.forces) == ["Omega"]
    with pytest.raises(SpecError, match="Omega3"):
        spec(FREE_BALL, *more, ("{ Omega1 =", "{ Omega3 ="))
