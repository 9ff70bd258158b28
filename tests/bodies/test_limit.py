"""Lattices of strands tend to these: generic bodies against the field's equations and waves."""

from functools import cache
from random import Random

import mpmath
import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

from coadjoint.derive import derive
from coadjoint.solve.strands import transport
from tests.bodies.lattices import (
    STIFF,
    TOPS,
    compile_rates,
    family_of,
    family_of_chain,
    lattice_of,
    strand,
)
from tests.derive.test_lattice_limit import PI, STRAIN, a, curve
from tests.fields import precessing_wave
from tests.specs import shipped


@cache
def family_by_hand():
    """The generic body of the lattice that ships."""
    return family_of(shipped("spin_chain_lattice"))


def test_the_lattice_of_the_spin_chain_is_the_shipped_one():
    """The same rates of the generic body, from the energy of the strand and from a spec by hand."""
    found, known = family_of_chain(), family_by_hand()
    assert (found.states, found.neighbours) == (known.states, known.neighbours)
    pairs = zip(found.rates, known.rates, strict=True)
    assert [sympy.expand(one - other) for one, other in pairs] == [0] * 12


RIGHT = ('"left"', '"right"')
ODD = (STIFF, f"{STIFF} - Xi[3]/2 - Xi[1]*Xi[2]*Xi[3]")


def transposed(state):
    """The inverses of all attitudes, and minus the momenta."""
    attitudes = state[:9].reshape(3, 3, -1).transpose(1, 0, 2).reshape(9, -1)
    return np.vstack([attitudes, -state[9:]])


def test_a_right_invariant_chain_is_a_left_one_of_inverses():
    """Velocities and strains of the inverse are minus these: odd terms change their sign.

    Without that rates are other ones.
    """
    found = compile_rates(family_of_chain(RIGHT, ODD))
    state, given = np.random.default_rng(8).normal(size=(12, 5)), [1, 2, 3, 3, 2, 1, 0.3]
    turned = transposed(state)
    for sign, agrees in (("+", True), ("-", False)):
        odd = (STIFF, f"{STIFF} {sign} Xi[3]/2 {sign} Xi[1]*Xi[2]*Xi[3]")
        known = compile_rates(family_of_chain(odd))
        other = transposed(known(turned, given))
        assert np.allclose(found(state, given), other, rtol=1e-11, atol=1e-11) == agrees


def test_rates_tend_to_those_of_a_right_invariant_strand():
    """Of momenta of a curve of turns g' = hat(Xi) g, the transpose of one from the left: order 2.

    Against the left invariant strand the difference does not become less.
    """
    declared = strand(RIGHT, ODD)
    rates = compile_rates(family_of_chain(RIGHT, ODD), modules="mpmath")

    def of_transposes(state, parameters):
        turned = transposed(state)
        turned[9:] *= -1
        return rates(turned, parameters)

    with mpmath.workdps(50):
        # from the left -Xi turns into the inverse of what Xi turns into from the right
        right, wrong = (_differences(of_transposes, of, -1) for of in (declared, strand(ODD)))
    assert all(3.9 < one / other < 4.1 for one, other in right)
    assert any(0.9 < one / other < 1.1 for one, other in wrong)


def test_a_right_invariant_chain_begins_as_its_strain_turns():
    """About two axes: R' = hat(Xi) R, by a method of SciPy; from the left it is another turn."""
    profile = ('"vector(0, sin(2*pi*s/L)/2, 0)"', '"vector(s/L, 1/3, 0)"')
    free = (("order = 4", 'order = 4, ends = "free"'), ('"energy", "P"', '"energy"'))
    declared = lattice_of(strand(RIGHT, profile, *free), 4)
    rows = np.array(declared.family.defaults["R"], dtype=float).reshape(3, 3, 4)
    errors = []
    for side in (1, -1):

        def flow(s, R, side=side):
            x, y = s / 10, 1 / 3
            hat = np.array([[0, 0, y], [0, 0, -x], [-y, x, 0]])
            factors = (hat, R.reshape(3, 3))[::side]
            return (factors[0] @ factors[1]).ravel()

        run = solve_ivp(flow, (1.25, 8.75), np.eye(3).ravel(), rtol=1e-11, atol=1e-12)
        errors.append(np.abs(run.y[:, -1].reshape(3, 3) - rows[..., -1]).max())
    assert errors[0] < 1e-8
    assert errors[1] > 0.1


def test_another_lattice_is_another():
    """With a term of degree 4 rates of momenta differ."""
    found = family_of_chain((STIFF, f"{STIFF} - Xi[1]^4/24"))
    pairs = zip(found.rates, family_by_hand().rates, strict=True)
    assert sum(sympy.expand(one - other) != 0 for one, other in pairs) == 3


MORE = {
    "quartic": " - dot(Xi, Xi)^2/4",
    "odd": " - Xi[3]/2 - Xi[1]*Xi[2]/3 - Xi[1]*Xi[2]*Xi[3]",
    "cubic": " - Xi[2]^3/5",
}


@pytest.mark.parametrize(
    "kind",
    ["odd", *(pytest.param(each, marks=pytest.mark.campaign) for each in ("quartic", "cubic"))],
)
def test_rates_tend_to_those_of_the_strand(kind):
    """Of momenta at rational strains with their slopes, to 50 digits: with order 2.

    Against the strand without the term the difference does not become less.
    """
    declared = strand((STIFF, STIFF + MORE[kind]))
    rates = compile_rates(family_of(lattice_of(declared)), modules="mpmath")
    with mpmath.workdps(50):
        right, wrong = (_differences(rates, of) for of in (declared, strand()))
    assert all(3.9 < one / other < 4.1 for one, other in right)
    assert all(abs(other) < 0.01 for _, other in right)
    assert any(0.9 < one / other < 1.1 for one, other in wrong)


def _differences(rates, of, sign=1):
    """Rates of the generic body less those of a strand, at two distances, by component.

    Where the sign is -1 the strain of the strand is minus the one that turns bodies.
    """
    equations, random = derive(of, "lie-poisson"), Random(3)
    values = {x: mpmath.mpf(random.randint(-9, 9)) / 7 for row in [*STRAIN, PI] for x in row}
    given = {sympy.Symbol(f"{n}{k}"): mpmath.mpf(k + 1) for n in "IK" for k in (1, 2, 3)}
    function = sympy.lambdify([*values, *given], equations.rates[:3], modules="mpmath")
    known = function(*(v if x in PI else sign * v for x, v in values.items()), *given.values())
    errors = []
    for distance in (mpmath.mpf(1) / 1000, mpmath.mpf(1) / 2000):
        state = np.zeros((12, 3), dtype=object)
        state[9:] = np.array([[values[x]] for x in PI])
        for n in (-1, 0, 1):
            matrix = sympy.lambdify([a, *values], list(curve(n * a)), modules="mpmath")
            state[:9, n + 1] = matrix(distance, *values.values())
        found = rates(state, [*given.values(), distance])[9:, 1]
        errors.append([one - other for one, other in zip(found, known, strict=True)])
    return list(zip(*errors, strict=True))


def test_tops_of_a_lattice_turn_as_those_of_the_strand():
    """The torque of the field on a body, and the rate of the field, are those at each point."""
    declared = strand(*TOPS)
    family, points = family_of(lattice_of(declared, 4)), derive(declared, "lie-poisson")
    names = [str(each) for each in family.states]
    rates = dict(zip(names, family.rates, strict=True))
    Pi = sympy.Matrix(sympy.symbols("Pi1:4"))
    Gamma = sympy.Matrix(sympy.symbols("Gamma1:4"))
    w, inertia = sympy.Symbol("w"), sympy.symbols("I1:4")
    Omega = sympy.Matrix([p / i for p, i in zip(Pi, inertia, strict=True)])
    torque = sympy.Matrix([0, 0, w]).cross(Gamma)
    expected = [*(-torque), *Gamma.cross(Omega)]
    known = dict(zip(points.variables, points.rates, strict=True))
    for place, name in enumerate(["Pi1", "Pi2", "Pi3", "Gamma1", "Gamma2", "Gamma3"]):
        parts = (x[name] if place >= 3 else w * sympy.diff(x[name], w) for x in (rates, known))
        assert [sympy.expand(part - expected[place]) for part in parts] == [0, 0], name
    assert any(expected[:3])


CLAMPED = (("order = 4", 'order = 4, ends = "clamped"'), ('"energy", "P"', '"energy"'))


def miss_between_walls(window, distance, turned):
    """How far momenta are from K u_ss at each body between two walls, next to these as well.

    All are turned about the first axis by ``u = s/3 + s^2/4 + s^3/5``, the second wall by
    ``turned`` times as much.
    """
    equations = derive(window, "lie-poisson")
    count = len(equations.variables) // 12

    def u(s):
        return s / 3 + s**2 / 4 + s**3 / 5

    def turn(angle):
        c, s = np.cos(angle), np.sin(angle)
        return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])

    s = distance * np.arange(1, count + 2)
    bodies, wall = [turn(u(each)) for each in s[:-1]], turn(turned * u(s[-1]))
    state = np.concatenate([*(R.ravel() for R in bodies), np.zeros(3 * count)])
    given = [1.0, 2.0, 3.0, 3.0, 2.0, 1.0, distance, *wall.ravel()]
    function = sympy.lambdify(
        [*equations.variables, *equations.setting.parameters], equations.rates
    )
    found = np.array(function(*state, *given), dtype=float)[9 * count :: 3]
    return np.abs(found - 3.0 * (0.5 + 1.2 * s[:-1])).max()


def test_rates_between_walls_tend_to_those_of_clamped_ends():
    """With order 2 at all bodies; with a wall that is turned otherwise they tend to nothing."""
    window = lattice_of(strand(*CLAMPED), 6).family.windows[0]
    misses = [miss_between_walls(window, a, 1) for a in (0.002, 0.001)]
    assert misses[1] < 1e-5
    np.testing.assert_allclose(np.log2(misses[0] / misses[1]), 2, atol=0.1)
    assert miss_between_walls(window, 0.001, 1.1) > 1


def test_bodies_between_walls_begin_as_the_strand_is_turned():
    """At equal distances from one another and from both walls; of the second one by the strain."""
    old = '"vector(0, sin(2*pi*s/L)/2, 0)"'
    declared = lattice_of(strand(*CLAMPED, (old, '"vector(1/20, 0, 0)"')), 4)
    (E,) = (each.default for each in declared.parameters if each.name == "E")
    (a,) = (each.default for each in declared.parameters if each.name == "a")
    assert a == (2,)
    assert np.array(E, dtype=float).reshape(3, 3)[2, 1] == pytest.approx(np.sin(0.5), abs=1e-12)
    rows = np.array(declared.family.defaults["R"], dtype=float).reshape(3, 3, 4)
    np.testing.assert_allclose(rows[2, 1], np.sin(np.arange(1, 5) / 10), atol=1e-12)


def wave_error(rates_of, N):
    """How far rates of momenta are from those of the precessing wave, next to bodies inside."""
    s = np.arange(N) * 10.0 / N
    fields, rates = precessing_wave(s, 0.0)
    Pi, (x, y, z) = fields[:3], fields[3:]
    o = np.zeros(N)
    R = transport(np.array([[o, -z, y], [z, o, -x], [-y, x, o]]), 10.0)[..., :N]
    found = rates_of(np.vstack([R.reshape(9, N), Pi]), [10.0 / N])
    return np.abs(found[9:] - rates[:3])[:, 1:-1].max()


def test_rates_tend_to_those_of_the_precessing_wave():
    """Of the chiral model, known in closed form: with order 2 (the strain closes no ring)."""
    rates = compile_rates(family_of(lattice_of(shipped("spin_chain_chiral"))))
    errors = [wave_error(rates, N) for N in (32, 64, 128)]
    assert errors[-1] < 1e-2
    np.testing.assert_allclose(np.log2(errors[1] / errors[2]), 2, atol=0.1)
