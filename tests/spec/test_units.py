"""Units: their texts, what formulas and laws demand of them, and what is inferred."""

from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import pytest

from coadjoint.errors import SpecError
from coadjoint.spec.core.dimensions import _RULES, Balance, Demand, Measured, measure
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.shapes import FUNCTIONS
from coadjoint.spec.core.units import ONE, UnitError, label_unit, read_unit, unknown, write_unit
from tests.constrained import SLEIGH
from tests.specs import RIGID_BODY, shipped, spec

END = "[claims]"

# -- texts ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("N m", "kg m^2/s^2"),
        ("J", "kg*m^2*s^-2"),
        ("s/(kg m^2)", "kg^-1 m^-2 s"),
        ("m^(1/2)", "m^(2/4)"),
        ("rad", "1"),
        ("V A", "W"),
        ("T m^2", "V s"),
        ("F V", "C"),
        ("ohm S", "1"),
        ("m^3/kg/s^2", "m^3/(kg s^2)"),
        ("m s/s", "m"),
        ("L", "dm^3"),
        ("min", "s min/s"),
    ],
)
def test_texts_of_one_unit(text, same):
    """By the definitions of the SI."""
    assert read_unit(text) == read_unit(same)


@pytest.mark.parametrize(
    ("one", "other", "ratio"),
    [
        ("km", "m", 1000),
        ("g", "kg", Fraction(1, 1000)),
        ("mg", "ug", 1000),
        ("h", "min", 60),
        ("d", "h", 24),
        ("hPa", "bar", Fraction(1, 1000)),
        ("arcmin", "arcsec", 60),
        ("eV", "J", Fraction(1602176634, 10**28)),
    ],
)
def test_units_that_differ_by_a_number(one, other, ratio):
    """They are not the same, and the number is exact."""
    quotient = read_unit(one) / read_unit(other)
    assert quotient != ONE
    number = Fraction(1)
    for prime, exponent in quotient.powers:
        number *= Fraction(int(prime)) ** int(exponent)
    assert number == ratio


def test_a_degree_is_pi_over_180():
    """No product of primes is: it differs from a radian."""
    assert dict(read_unit("deg").powers)["pi"] == 1
    assert write_unit(read_unit("deg") / read_unit("rad")) == "1/180 pi"


@pytest.mark.parametrize(
    ("text", "problem", "advice"),
    [
        ("kgg", "'kgg' is no unit", "'kg'"),
        ("Nm", "'Nm' is no unit", "'N m'"),
        ("degrees", "'degrees' is no unit", "'deg'"),
        ("furlong", "'furlong' is no unit", "SI"),
        ("J/kg K", "divides by what stands at 'K'", "K before the sign /"),
        ("10 m", "no unit stands at '10'", "Numbers belong to formulas"),
        ("m^", "no exponent from 1 to 99 stands at the end", ""),
        ("m^x", "no exponent", ""),
        ("m^(1/0)", "no exponent", ""),
        ("m^100", "no exponent", ""),
        ("(m", "no closing parenthesis", ""),
        ("m)", "no unit stands at ')'", ""),
        ("m/", "no unit stands at the end", ""),
        ("-", "no unit stands", ""),
    ],
)
def test_texts_of_no_unit(text, problem, advice):
    """What stands where it cannot, and what was meant."""
    with pytest.raises(UnitError) as caught:
        read_unit(text)
    assert problem in caught.value.problem
    assert advice in caught.value.hint
    assert 0 <= caught.value.start <= caught.value.end <= len(text)


def test_a_label_is_written_in_the_symbols_of_the_spec_or_not_at_all():
    """A factor that no symbol carries would be lost in a label."""
    speed = read_unit("km") / read_unit("h")
    own = {"km": read_unit("km"), "h": read_unit("h")}
    assert label_unit(speed, own) == "km/h"
    assert label_unit(speed) == ""
    assert label_unit(read_unit("N"), own) == ""
    assert label_unit(read_unit("J/N")) == "m"


# -- formulas -------------------------------------------------------------------------------------

UNITS = {"m": "kg", "v": "m/s", "I": "kg m^2", "Omega": "1/s", "x": "m"}
VECTORS = ("v", "I", "Omega", "x")


def weigh(text, **more):
    """The units of a formula, and the demands that it makes."""
    names = {
        name: Measured((3,), (read_unit(unit),) * 3)
        if name in VECTORS
        else Measured((), (read_unit(unit),))
        for name, unit in {**UNITS, **more}.items()
    }
    asked = []
    value = measure(read_expression(text), names, asked.append)
    return value, asked


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("m*dot(v, v)/2", "kg m^2/s^2"),
        ("dot(Omega, diag(I)*Omega)/2 + m*dot(v, v)/2", "kg m^2/s^2"),
        ("norm(v)/norm(x)", "1/s"),
        ("sqrt(dot(x, x))", "m"),
        ("sqrt(norm(x))", "m^(1/2)"),
        ("inverse(diag(I))*x", "1/kg/m"),
        ("cos(norm(x)/norm(x)) - x[1]^0", "1"),
        ("x[2]^-2", "1/m^2"),
        ("outer(x, v)", "m^2/s"),
        ("trace(rows(x, x, x))", "m"),
        ("det(rows(x, x, v))", "m^3/s"),
        ("rows(x, x, x)^7", "m^7"),
        ("cross(x, v) + 0*x", "m^2/s"),
        ("commutator(hat(x), hat(v))*Omega", "m^2/s^2"),
        ("diag(rows(x, x, x))", "m"),
        ("(0 + 0)*x + x", "m"),
    ],
)
def test_the_unit_of_a_formula(text, expected):
    """One for all entries; nothing is demanded that does not hold."""
    value, asked = weigh(text)
    assert {write_unit(entry) for entry in value.entries if entry is not None} == {expected}
    assert asked == []


def test_components_have_units_of_their_own():
    """A vector of unlike entries is one; its product with a matrix sums like terms."""
    value, asked = weigh("vector(m, x[1], 0)")
    assert [entry and write_unit(entry) for entry in value.entries] == ["kg", "m", None]
    assert asked == []
    _, asked = weigh("dot(vector(m, x[1], 0), x)")
    assert len(asked) == 1
    _, asked = weigh("dot(vector(m, x[1], 0), vector(x[1], m, v[1]))")
    assert asked == []


@pytest.mark.parametrize(
    ("text", "found", "expected"),
    [
        ("m + norm(v)", "m/s", "kg"),
        ("x - v", "m/s", "m"),
        ("sin(m)", "kg", "1"),
        ("exp(norm(x))", "m", "1"),
        ("1 + norm(x)", "m", "1"),
        ("norm(x)^2 - norm(x)", "m", "m^2"),
        ("dot(vector(m, 1, 1), vector(1, 1, 1))", "1", "kg"),
        ("norm(vector(m, norm(x), 0))", "m", "kg"),
        ("det(diag(vector(1, m, 1))) + 1", "1", "kg"),
        ("commutator(hat(x), hat(x) + hat(v))", "m/s", "m"),
    ],
)
def test_what_does_not_fit_in_a_formula(text, found, expected):
    """The first demand that a declared unit cannot meet."""
    _, asked = weigh(text)
    bad = [demand for demand in asked if not Balance().meet(demand)]
    assert (write_unit(bad[0].found), write_unit(bad[0].expected)) == (found, expected)


def test_the_inverse_of_a_matrix_has_its_zeros():
    """Units of blocks that nothing joins are not compared; those that something joins are."""
    blocks = "inverse(rows(vector(m, 0), vector(0, norm(x))))*vector(norm(v), 1)"
    value, asked = weigh(blocks)
    assert [write_unit(entry) for entry in value.entries] == ["m/kg/s", "1/m"]
    assert asked == []
    _, asked = weigh("inverse(rows(vector(m, norm(v)), vector(1, norm(x))))")
    assert asked


def test_every_function_has_a_rule():
    """A new function of the language needs a line that says what its units are."""
    assert FUNCTIONS.keys() <= _RULES.keys()


def test_unknown_units_are_found_by_exact_elimination():
    """k^2 m = kg and k c = m/s give c; a third demand that agrees is met, another is not."""
    k, c, balance = unknown("k"), unknown("c"), Balance()
    assert balance.meet(Demand(found=k**2 * read_unit("m"), expected=read_unit("kg")))
    assert balance.meet(Demand(found=k * c, expected=read_unit("m/s")))
    assert write_unit(balance.reduce(c)) == "m^(3/2)/kg^(1/2)/s"
    assert balance.meet(Demand(found=c**2, expected=read_unit("m^3/kg/s^2")))
    assert not balance.meet(Demand(found=c, expected=read_unit("m")))


def test_a_long_chain_of_unknown_units_is_no_recursion():
    """x1 = x2 = ... = x3000, and the last one is a metre: so is the first."""
    chain, balance = [unknown(f"x{n}") for n in range(3000)], Balance()
    for one, other in pairwise(chain):
        assert balance.meet(Demand(found=one, expected=other))
    assert balance.meet(Demand(found=chain[-1], expected=read_unit("m")))
    assert write_unit(balance.reduce(chain[0])) == "m"
    assert not balance.meet(Demand(found=chain[7], expected=read_unit("s")))


# -- specs ----------------------------------------------------------------------------------------

BODY = RIGID_BODY.replace('role = "velocity"', 'role = "velocity", unit = "1/s"').replace(
    "I = { ", 'I = { unit = "kg m^2", '
)


def refused(text, *changes):
    """The error of a changed spec."""
    with pytest.raises(SpecError) as caught:
        spec(text, *changes)
    return caught.value


def units_of(text, *changes):
    """Units by name."""
    read = spec(text, *changes)
    groups = (read.variables, read.parameters, read.inputs, read.observables, read.reconstruction)
    units = {each.name: each.unit for group in groups for each in group}
    return units | {"energy": read.units.label(read.units.names["energy"].entries)}


def with_table(lines):
    """Further tables."""
    return (END, f"{lines}\n{END}")


def test_a_spec_without_units_stays_unitless():
    """Nothing is checked, and every unit is 1."""
    sloppy = with_table('[observables]\nodd = "sin(Pi1) + Omega1^3"')
    assert set(units_of(RIGID_BODY, sloppy).values()) == {"1"}
    assert "unlike" not in str(refused(BODY, sloppy))


def test_units_that_are_left_out_are_inferred():
    """From formulas and from the laws of motion."""
    observed = with_table('[observables]\nspin = "norm(Omega)"\nodd = "Omega*norm(Pi)"')
    assert units_of(BODY, observed) == {
        "Omega": "1/s",
        "Pi": "kg m^2/s",
        "I": "kg m^2",
        "energy": "kg m^2/s^2",
        "spin": "1/s",
        "odd": "kg m^2/s^2",
    }


def test_what_cannot_be_inferred_stays_open_and_is_no_error():
    """A length alone says nothing of masses."""
    found = units_of(SLEIGH, ("[parameters]", '[parameters]\nlength = { unit = "m" }'))
    assert found["length"] == "m"
    assert found["m"] == ""
    assert found["omega"] == "1/s"


def test_components_of_their_own_units_are_inferred_and_counted():
    """A momentum of se(2) has two units."""
    text = """
title = "A body in the plane"
routes = ["lie-poisson"]
[algebra]
name = "se(2)"
[variables]
mu = { role = "momentum" }
[parameters]
m = { positive = true, unit = "kg" }
I = { positive = true, unit = "kg m^2" }
[hamiltonian]
h = "mu1^2/(2*I) + (mu2^2 + mu3^2)/(2*m)"
[forces]
mu = "vector(0, f1, f2)"
[inputs]
f = { shape = [2], unit = "N" }
"""
    assert units_of(text)["mu"] == "kg m^2/s, kg m/s, kg m/s"
    error = refused(text, ('role = "momentum"', 'role = "momentum", unit = "N s, m"'))
    assert (error.key, error.found) == ("variables.mu.unit", "N s, m")
    assert "one for each component" in error.expected


@pytest.mark.parametrize(
    ("lines", "key", "found", "expected"),
    [
        ('[observables]\nx = { expression = "Pi1", unit = "m" }', "observables.x.expression",
         "kg m^2/s", "m"),
        ('[observables]\nx = "Pi1 + Omega1"', "observables.x", "1/s", "two of one unit around +"),
        ('[observables]\nx = "exp(Omega1)"', "observables.x", "1/s", "a pure number"),
        ('[domain]\nx = "Pi1 > Omega1"', "domain.x", "1/s", "two sides of one unit"),
        ('[dissipation]\nR = "dot(Omega, diag(I)*Omega)"', "dissipation.R", "kg m^2/s^2",
         "kg m^2/s^3"),
        ('[forces]\nOmega = "Pi"', "forces.Omega", "kg m^2/s", "kg m^2/s^2"),
        ('[double_bracket]\nG = "I1"', "double_bracket.G", "kg m^2", "s/kg/m^2"),
        ('[reconstruction]\nx = { rate = "Omega1", unit = "s" }', "reconstruction.x.rate", "1/s",
         "1"),
        ('[inputs]\nu = { unit = "m", rate = "w" }\nw = { unit = "m" }\n'
         '[observables]\nx = "u*w"', "inputs.w", "m", "m/s"),
        ('[time]\nunit = "h"\n[domain]\nx = "t*Omega1 > 1"', "variables.Omega.unit",
         "1/s", "1/3600/s"),
        ('[time]\n[observables]\nx = "cos(t)"', "observables.x", "s", "a pure number"),
        ('[definitions]\nu = "Pi + Omega"\n[observables]\nx = "u"', "observables.x", "1/s",
         "two of one unit around +"),
        ('[claims]\nconserved = ["dot(Pi, Pi) + Pi1"]', "claims.conserved[1]", "kg m^2/s",
         "two of one unit around +"),
        ('[lax]\nL = "hat(Pi)"\nM = "hat(Pi)"', "lax.M", "kg m^2/s", "1/s"),
        ('[transformations.x.map]\nPi = "diag(I)*Pi"', "transformations.x.map.Pi",
         "kg^2 m^4/s", "kg m^2/s"),
        ('[symmetries.x]\nalgebra = "so(3)"\nvector = "xi"\ngenerators = { Pi = "cross(xi, Pi)" }\n'
         'unit = "kg"', "symmetries.x.unit", "kg", "kg m^2/s"),
        ('[charts.x]\nvariables = { y = [3] }\nrates = { y = "y" }\nmap = { Pi = "y" }',
         "charts.x.rates.y", "kg m^2/s", "kg m^2/s^2"),
        ('[claims]\nbrackets = { "{Pi1, Pi2}" = "Pi3^2" }', "claims.brackets.{Pi1, Pi2}",
         "kg^2 m^4/s^2", "kg m^2/s"),
    ],
)  # fmt: skip
def test_a_wrong_unit_is_shown_at_its_place(lines, key, found, expected):
    """Every table that holds formulas: what was found, and what is expected."""
    others = ', "lax"' if "[lax]" in lines else ""
    routes = ('"euler-poincare", "lie-poisson"', f'"euler-poincare"{others}')
    claims = (f'{END}\ncasimirs = ["dot(Pi, Pi)"]', lines if lines.startswith(END) else END)
    error = refused(BODY, routes, claims, *([] if END in lines else [with_table(lines)]))
    assert (error.key, error.found, error.expected) == (key, found, expected)
    assert error.line > 0


def test_a_number_alone_in_a_condition_is_in_the_unit_of_the_other_side():
    """What a person means by r > 0.001 where r is in metres."""
    assert spec(BODY, with_table('[domain]\nfast = "norm(Omega) > 1/2"'))
    assert "1 + [" not in str(refused(BODY, with_table('[domain]\nfast = "1 + Omega1 > 2"')))


PENDULUM = """
title = "A pendulum"
routes = ["euler-lagrange", "canonical"]
[variables]
phi = { role = "coordinate", unit = "rad" }
v = { role = "velocity", of = "phi", unit = "rad/s" }
p = { role = "momentum", of = "phi", unit = "kg m^2/s" }
[parameters]
m = { positive = true, unit = "kg" }
L = { positive = true, unit = "m" }
g = { positive = true, unit = "m/s^2" }
[lagrangian]
l = "m*L^2*v^2/2 + m*g*L*cos(phi)"
[hamiltonian]
h = "p^2/(2*m*L^2) - m*g*L*cos(phi)"
"""


def test_a_pendulum_is_in_units_and_in_no_others():
    """Degrees, an energy of kg m, grams."""
    assert units_of(PENDULUM)["energy"] == "kg m^2/s^2"
    energy = refused(
        PENDULUM,
        ('l = "m*L^2*v^2/2 + m*g*L*cos(phi)"', 'l = "m*L*cos(phi) + 0*v"'),
        ('h = "p^2/(2*m*L^2) - m*g*L*cos(phi)"', 'h = "m*L*cos(phi) + 0*p"'),
    )
    assert (energy.found, energy.expected) == ("kg m", "kg m^2/s^2")
    assert energy.key == "lagrangian.l"
    said = "the unit of the energy is kg m; expected kg m^2/s^2. A momentum times its velocity is"
    assert said in str(energy)
    assert said in (Path(__file__).parents[2] / "docs" / "specs.md").read_text()
    degrees = refused(PENDULUM, ('"rad"', '"deg"'), ('"rad/s"', '"deg/s"'))
    assert "deg" in degrees.found or "deg" in str(degrees)
    assert "nothing is converted" in str(refused(PENDULUM, ('"kg"', '"g"')))


def test_other_bases_are_fine_if_all_are_in_them():
    """Grams, centimetres and milliseconds, with labels in the same."""
    text = PENDULUM.replace("kg", "g").replace('"m"', '"cm"').replace("m^2", "cm^2")
    text = text.replace("m/s^2", "cm/s^2").replace("/s", "/ms").replace("L^2*cm", "L^2*m")
    text = text.replace("L^cm", "L^m").replace("ccm", "cm")
    assert units_of(text)["energy"] == "cm^2 g/ms^2"


@pytest.mark.parametrize(
    "name", ["rigid_body", "heavy_top", "kirchhoff", "quadrotor", "snakeboard"]
)
def test_energies_of_shipped_specs_are_joules(name):
    """The declared units agree with the formulas."""
    units = shipped(name).units
    assert units.label(units.names["energy"].entries) == "kg m^2/s^2"


@pytest.mark.parametrize(("name", "unit"), [("kepler", "m^2/s^2"), ("bloch", "1/s")])
def test_energies_need_not_be_joules(name, unit):
    """Of a unit mass, and of a spin."""
    units = shipped(name).units
    assert units.label(units.names["energy"].entries) == unit


def test_time_may_be_a_pure_number():
    """Where all units are 1, so is that of rates."""
    units = shipped("knife_edge_cvt").units
    assert units.label(units.names["energy"].entries) == "1"
