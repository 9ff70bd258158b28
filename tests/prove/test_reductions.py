"""Restricted motions on which forces act: the section is kept, or a point shows that it is not."""

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.derive.mechanics import external
from coadjoint.derive.times_vector import find_product
from coadjoint.errors import ClaimError, SpecError
from coadjoint.prove import Verdict
from tests.specs import prove_claims, spec, verdicts_of

#: Two oscillators with a spring of any kind between them, driven alike, which move as one.
IN_STEP = """
title = "Two oscillators in step"
routes = ["canonical", "poisson"]
[poisson]
canonical = [["q1", "p1"], ["q2", "p2"]]
[variables]
q1 = { role = "coordinate" }
p1 = { role = "coordinate" }
q2 = { role = "coordinate" }
p2 = { role = "coordinate" }
[parameters]
k = { positive = true, default = 1 }
c = { positive = true, default = "0.1" }
[inputs]
u = { default = 0 }
[time]
name = "t"
[hamiltonian]
h = "(p1^2 + p2^2)/2 + (q1^2 + q2^2)/2 + k*(q1 - q2)^4"
[forces]
p1 = "-c*p1 + u*sin(t)"
p2 = "-c*p2 + u*sin(t)"
[reduction]
where = ["q1 - q2", "p1 - p2"]
section = { q2 = "q1", p2 = "p1" }
"""
#: A body that turns about one of its axes.
ABOUT_AN_AXIS = """
title = "Body about its third axis"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
across = { role = "momentum", block = ["J1", "J2"] }
along = { role = "momentum", block = ["J3"] }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
c = { positive = true, default = 1 }
[hamiltonian]
h = "across1^2/(2*I1) + across2^2/(2*I2) + along^2/(2*I3)"
[forces]
along = "-c*along"
[reduction]
where = ["across"]
section = { across = "vector(0, 0)" }
"""
FRICTION = ('p2 = "-c*p2 + u*sin(t)"', 'p2 = "-c*p2"')
TORQUE = ('along = "-c*along"', 'across = "vector(c, 0)"\nalong = "-c*along"')
UNFORCED = ('[forces]\np1 = "-c*p1 + u*sin(t)"\np2 = "-c*p2 + u*sin(t)"', "")
LAW = "the energy changes by the power of the forces"


@pytest.mark.parametrize("text", [IN_STEP, ABOUT_AN_AXIS])
def test_a_section_that_forces_keep_is_proved(text):
    """For all inputs and at all times; the energy is that on the section, and so is its balance."""
    found = verdicts_of(text)
    assert set(found.values()) == {Verdict.PROVED}
    assert sum(each.startswith(("the motion keeps", "the whole motion")) for each in found) == 2
    assert LAW in found
    assert "the energy is conserved" not in found


def test_the_motion_on_the_section_is_typed_by_hand():
    """A driven oscillator with friction, ``q'' = -q - c q' + u sin t``, by both routes."""
    q, p, c, u, t = sympy.symbols("q1 p1 c u t")
    declared = spec(IN_STEP)
    for route in declared.routes:
        found = derive(declared, route)
        assert tuple(map(str, found.state)) == ("q1", "p1")
        assert list(found.rates) == [p, -q - c * p + u * sympy.sin(t)]
        assert sympy.expand(found.energy - p**2 - q**2) == 0


@pytest.mark.parametrize(("text", "change"), [(IN_STEP, FRICTION), (ABOUT_AN_AXIS, TORQUE)])
def test_a_force_that_leaves_the_section_is_refuted(text, change):
    """With a point; the same motion without that force keeps it."""
    certificate = prove_claims(spec(text, change))
    false = {each.statement for each in certificate.claims if each.verdict is Verdict.REFUTED}
    assert any(each.startswith("the whole motion keeps") for each in false)
    assert any(each.startswith("the motion keeps") for each in false)
    with pytest.raises(ClaimError, match=r"refuted: the whole motion keeps .* At "):
        certificate.require()


@pytest.mark.parametrize("factor", [0, 2, -1])
def test_spoiled_forces_break_the_balance_on_the_section(factor, monkeypatch):
    """The power is taken from the spec, not from what the route has added."""
    added = external.added_rates
    spoiled = lambda setting: [factor * force for force in added(setting)]  # noqa: E731
    monkeypatch.setattr(external, "added_rates", spoiled)
    found = verdicts_of(IN_STEP)
    assert found[LAW] is Verdict.REFUTED
    assert found["the motion keeps q2 = q1, p2 = p1"] is Verdict.PROVED


def test_a_double_bracket_acts_on_the_whole():
    """Its conditions are claims about the whole system; one that pulls a single body leaves."""
    change = (UNFORCED, ('["canonical", "poisson"]', '["poisson"]'), ('[time]\nname = "t"\n', ""))
    along = '[double_bracket]\nG = "c*u^2"\n[reduction]'
    found = verdicts_of(IN_STEP, *change, ("[reduction]", along))
    assert set(found.values()) == {Verdict.PROVED}
    assert "G is positive semidefinite (of the whole system)" in found
    assert "dh/dt = -<P dh, G P dh>: the energy never grows" in found
    single = '[double_bracket]\nG = "u^2*diag(vector(c, c, 0, 0))"\n[reduction]'
    found = verdicts_of(IN_STEP, *change, ("[reduction]", single))
    assert found["the motion keeps q2 = q1, p2 = p1"] is Verdict.REFUTED


def test_a_metriplectic_bracket_on_a_section_has_no_discrete_gradient():
    """It acts on the whole system, whose tensor times a vector is none of the section."""
    table = '[metriplectic]\nS = "1"\nG = "c"\n[reduction]'
    undriven = ("[inputs]\nu = { default = 0 }\n", "")
    change = (
        undriven,
        UNFORCED,
        ('["canonical", "poisson"]', '["poisson"]'),
        ('[time]\nname = "t"\n', ""),
    )
    found = find_product(derive(spec(IN_STEP, *change, ("[reduction]", table))))
    assert isinstance(found, str)
    assert "not on a section of it" in found


#: The oscillators with momenta of coordinates, whose velocities follow, and friction by R.
RAYLEIGH = (
    ('routes = ["canonical", "poisson"]', 'routes = ["canonical"]'),
    ('[poisson]\ncanonical = [["q1", "p1"], ["q2", "p2"]]\n', ""),
    ('p1 = { role = "coordinate" }', 'p1 = { role = "momentum", of = "q1" }'),
    (
        'p2 = { role = "coordinate" }',
        'p2 = { role = "momentum", of = "q2" }\nv1 = { role = "velocity", of = "q1" }\n'
        'v2 = { role = "velocity", of = "q2" }',
    ),
    ('p1 = "-c*p1 + u*sin(t)"', 'v1 = "u*sin(t)"'),
    ('p2 = "-c*p2 + u*sin(t)"', 'v2 = "u*sin(t)"\n[dissipation]\nR = "c*(v1^2 + v2^2)/2"'),
    ("(p1^2 + p2^2)/2 +", "(p1^2 + p2^2)/(2*m) +"),
    ("[inputs]", "m = { positive = true, default = 2 }\n[inputs]"),
)
QUARTIC = ("c*(v1^2 + v2^2)/2", "c*(v1^4 + v2^4)/4")
UNEVEN = ("c*(v1^2 + v2^2)/2", "c*(v1^2 + 2*v2^2)/2")
LOST = f"{LAW} and -2 R"


@pytest.mark.parametrize(
    ("more", "law", "friction"),
    [((), LOST, "c*v"), ((QUARTIC,), f"{LAW} and -<dR/dxi, xi>", "c*v**3")],
)
def test_rayleighs_function_acts_on_the_whole(more, law, friction):
    """By velocities that momenta give: ``q' = v, p' = -q - dR/dv + u sin t``, with v = p/m."""
    declared = spec(IN_STEP, *RAYLEIGH, *more)
    found = verdicts_of(declared)
    assert set(found.values()) == {Verdict.PROVED}
    assert law in found
    q, p, m, u, t = sympy.symbols("q1 p1 m u t")
    equations = derive(declared)
    lost = sympy.sympify(friction).subs("v", p / m)
    wanted = [p / m, -q - lost + u * sympy.sin(t)]
    assert [sympy.expand(a - b) for a, b in zip(equations.rates, wanted, strict=True)] == [0, 0]
    assert [equations.observables[name] - p / m for name in ("v1", "v2")] == [0, 0]


def test_a_body_about_an_axis_with_friction_in_its_bearing():
    """Velocities over an algebra: ``I3 w' = -c w``."""
    velocities = 'w = { role = "velocity", block = ["J3"] }\n'
    velocities += 'turn = { role = "velocity", block = ["J1", "J2"] }\n'
    bearing = ('[forces]\nalong = "-c*along"', '[dissipation]\nR = "c*w^2/2 + c*dot(turn, turn)"')
    declared = spec(ABOUT_AN_AXIS, ("[parameters]", f"{velocities}[parameters]"), bearing)
    found = verdicts_of(declared)
    assert set(found.values()) == {Verdict.PROVED}
    assert "the energy changes by -2 R" in found
    along, c, inertia = sympy.symbols("along c I3")
    assert list(derive(declared).rates) == [-c * along / inertia]


def test_uneven_friction_leaves_the_section():
    """Friction of one oscillator alone parts them; the balance there fails with it."""
    certificate = prove_claims(spec(IN_STEP, *RAYLEIGH, UNEVEN))
    false = {each.statement for each in certificate.claims if each.verdict is Verdict.REFUTED}
    assert {"the motion keeps q2 = q1, p2 = p1", LOST} <= false


@pytest.mark.parametrize("factor", [0, 2, -1])
def test_spoiled_friction_breaks_the_balance_on_the_section(factor, monkeypatch):
    """R is taken from the spec, not from what the route has added."""
    added = external.added_rates
    spoiled = lambda setting: [factor * force for force in added(setting)]  # noqa: E731
    monkeypatch.setattr(external, "added_rates", spoiled)
    assert verdicts_of(IN_STEP, *RAYLEIGH)[LOST] is Verdict.REFUTED


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (('section = { q2 = "q1", p2 = "p1" }', 'section = { q2 = "q1", v2 = "p1" }'), "variable"),
        (('p2 = "p1" }', 'p2 = "m*v1" }'), "'v1' is a velocity"),
        (('"p1 - p2"]', '"v1 - v2"]'), "'v1' is a velocity"),
        (("[hamiltonian]", '[lagrangian]\nl = "v1^2"\n[hamiltonian]'), "Remove .lagrangian."),
    ],
)
def test_a_section_is_over_the_state(change, said):
    """Velocities follow from it, on the section too."""
    routes = ('routes = ["canonical"]', 'routes = ["canonical", "euler-lagrange"]')
    with pytest.raises(SpecError, match=said):
        spec(IN_STEP, *RAYLEIGH, *([routes] if "lagrangian" in change[1] else []), change)


def test_friction_by_rayleighs_function_leads_to_forces():
    """Where no velocities are declared the advice names what works, as above."""
    rayleigh = ("[forces]", '[dissipation]\nR = "p1^2"\n[forces]')
    with pytest.raises(SpecError, match=r"names no velocity.*along a momentum in \[forces\]"):
        spec(IN_STEP, rayleigh)


#: A heavy top that swings in a plane, of which three components are left.
SWING = """
title = "A swing"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Pi = { role = "momentum" }
Gamma = { role = "advected", representation = "vector" }
[parameters]
I = { shape = [3], positive = true }
w = {}
[hamiltonian]
h = "dot(Pi, inverse(diag(I))*Pi)/2 + w*Gamma3"
[reduction]
section = { Pi1 = "0", Pi3 = "0", Gamma2 = "0" }
[claims]
casimirs = ["dot(Gamma, Gamma)"]
conserved = ["energy"]
"""


def test_components_of_a_section_are_given_one_by_one():
    """What is left moves as a pendulum: Pi2' = -w Gamma1, Gamma' = Gamma x (0, Pi2/I2, 0)."""
    motion = derive(spec(SWING))
    Pi2, G1, G3, I2, w = sympy.symbols("Pi2 Gamma1 Gamma3 I2 w")
    assert motion.variables == ("Pi2", "Gamma1", "Gamma3")
    expected = [-w * G1, -G3 * Pi2 / I2, G1 * Pi2 / I2]
    assert [sympy.simplify(a - b) for a, b in zip(motion.rates, expected, strict=True)] == [0] * 3
    assert prove_claims(spec(SWING)).holds


def test_entries_of_a_matrix_may_be_given_one_by_one():
    """A body in four dimensions with a fixed axis is Euler's body."""
    text = (
        """
title = "Three planes"
routes = ["lie-poisson"]
[algebra]
name = "so(4)"
[variables]
M = { role = "momentum", form = "antisymmetric" }
[parameters]
c = { shape = [6], positive = true }
[hamiltonian]
h = """
        + '"c1*M12^2 + c2*M13^2 + c3*M14^2 + c4*M23^2 + c5*M24^2 + c6*M34^2"'
        + """
[reduction]
section = { M14 = "0", M24 = "0", M34 = "0" }
[claims]
casimirs = ["trace(M*M)"]
"""
    )
    motion = derive(spec(text))
    assert motion.variables == ("M12", "M13", "M23")
    assert prove_claims(spec(text)).holds


@pytest.mark.parametrize("change", [('Pi1 = "0"', 'Pi1 = "Pi2"'), (', Gamma2 = "0"', "")])
def test_components_that_the_motion_does_not_keep_are_refuted(change):
    """At the line of the section."""
    with pytest.raises(ClaimError, match=r"section\.Pi1: refuted: the motion keeps Pi1 ="):
        prove_claims(spec(SWING, change)).require()


def test_a_component_is_given_once():
    """Alone or with the vector."""
    with pytest.raises(SpecError, match="'Pi1' is given twice"):
        spec(SWING, ('Pi3 = "0"', 'Pi = "vector(0, Gamma1, 0)"'))


def test_a_chart_gives_the_components_that_are_left():
    """The angle of the pendulum; with the other sign of its rate it is none."""
    chart = """[charts.angle]
variables = { a = [], L = [] }
map = { Pi2 = "L", Gamma1 = "sin(a)", Gamma3 = "cos(a)" }
rates = { a = "-L/I2", L = "-w*sin(a)" }
[claims]"""
    assert prove_claims(spec(SWING, ("[claims]", chart))).holds
    wrong = chart.replace("-L/I2", "L/I2")
    assert not prove_claims(spec(SWING, ("[claims]", wrong))).holds
