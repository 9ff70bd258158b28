"""Two charges on a line by Darwin's Lagrangian: convex at rest where a condition says so.

L. D. Landau and E. M. Lifshitz, The Classical Theory of Fields, 4th ed. (1975), equation 65.7. No
formula gives velocities of the momenta ``p = m v + m v^3/(2 c^2) + k u/(c^2 r)``. Expected values
come from the roots of both cubics, one at the last value of the other, and from an integral.
"""

import mpmath
import numpy as np
import pytest

from coadjoint.derive import derive
from coadjoint.errors import DerivationError
from coadjoint.lower.lowering import lower
from coadjoint.prove.declaration import kernel_context
from tests.solve.systems import build
from tests.specs import prove_claims, spec

CHARGES = """
title = "Two charges by Darwin's Lagrangian"
routes = ["euler-lagrange", "canonical"]
[variables]
x = { role = "coordinate", unit = "m", default = 1 }
y = { role = "coordinate", unit = "m", default = -1 }
p = { role = "momentum", of = "x", unit = "kg m/s", default = "0.2" }
q = { role = "momentum", of = "y", unit = "kg m/s", default = "-0.1" }
v = { role = "velocity", of = "x", unit = "m/s" }
u = { role = "velocity", of = "y", unit = "m/s" }
[parameters]
m = { positive = true, default = 1, unit = "kg" }
n = { positive = true, default = 2, unit = "kg" }
c = { positive = true, default = 4, unit = "m/s" }
k = { default = 1, unit = "kg m^3/s^2" }
[domain]
apart = "x > y"
far = "m*n > k^2/(c^4*(x - y)^2)"
[lagrangian]
l = "m*v^2/2 + n*u^2/2 + (m*v^4 + n*u^4)/(8*c^2) - k/(x - y) + k*v*u/(c^2*(x - y))"
[claims]
conserved = ["energy", "p + q"]
"""
FAR = 'far = "m*n > k^2/(c^4*(x - y)^2)"'


def root(m, c, p):
    """The real root of ``m v + m v^3/(2 c^2) = p``, by the hyperbolic sine of a third."""
    scale = c * mpmath.sqrt(mpmath.mpf(8) / 3)
    return scale * mpmath.sinh(mpmath.asinh(3 * p / (m * scale)) / 3)


def find_rates(state, parameters):
    """Velocities, and ``dp/dt = k/r^2 - k v u/(c^2 r^2)`` with its opposite."""
    with mpmath.workdps(60):
        x, y, p, q, m, n, c, k = map(mpmath.mpf, (*state, *parameters))
        near, v, u = k / (c**2 * (x - y)), mpmath.mpf(0), mpmath.mpf(0)
        for _ in range(2000):
            before = v, u
            v, u = root(m, c, p - near * u), root(n, c, q - near * v)
            if abs(v - before[0]) + abs(u - before[1]) < mpmath.mpf(10) ** -50:
                break
        force = k / (x - y) ** 2 * (1 - v * u / c**2)
        return [float(each) for each in (v, u, force, -force)]


@pytest.fixture(scope="module")
def charges(tmp_path_factory):
    """Their system."""
    equations = derive(spec(CHARGES))
    context = kernel_context(equations, lower(equations), 0)
    return build(context, tmp_path_factory.mktemp("charges"))


def test_charges_are_proved_on_both_routes():
    """Energy, the momentum of both, and that the iteration ends at the velocities."""
    proved = prove_claims(spec(CHARGES)).claims
    assert all(claim.verdict.name == "PROVED" for claim in proved)
    assert sum("Newton's iteration" in claim.statement for claim in proved) == 2


def test_their_rates_are_those_of_the_cubics(charges):
    """At 200 states of any speed up to that of light and beyond, in the domain."""
    source, compared = np.random.default_rng(3), 0
    parameters = np.array([1.0, 2.0, 1.5, 1.0])
    for _ in range(200):
        y, r = source.uniform(-1, 1), source.uniform(0.5, 3)
        state = np.array([y + r, y, *source.uniform(-4, 4, 2)])
        found, expected = charges.rhs(state, parameters), np.array(find_rates(state, parameters))
        assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()
        compared += 1
    assert compared == 200
    close = [0.25, 0.0, 0.1, 0.0]  # where the kinetic energy is not convex at rest
    assert charges.domain(close, parameters)[1] < 0


def test_equal_charges_part_as_an_integral_says(charges):
    """At rest at r = 2; ``m v^2 + 3 m v^4/(4 c^2) + (k/r)(1 - v^2/c^2) = k/2`` gives v of r."""
    c = 1.5

    def slowness(s):
        """``s/v``, where r = 2 + s^2: that of dr/(2 v) without its pole at rest."""
        r = 2 + s**2
        a, b, e = 3 / (4 * c**2), 1 - 1 / (c**2 * r), 1 / (2 * r)
        return mpmath.sqrt((b + mpmath.sqrt(b * b + 4 * a * e * s**2)) / (2 * e))

    end = mpmath.quad(slowness, [0, 1, mpmath.sqrt(3)])
    run = charges.simulate(
        [1, -1, 0, 0], (0, float(end)), {"m": 1, "n": 1, "c": c, "k": 1}, rtol=1e-12, atol=1e-12
    )
    assert run.status == "OK"
    assert run.final["x"] - run.final["y"] == pytest.approx(5, abs=1e-10)
    assert run.drift["energy"] < 1e-13


def test_without_the_condition_they_are_refused():
    """A condition that says less does not do either; one that is a multiple does."""
    for other in ("", 'far = "m*n > 0"', 'far = "m*n >= k^2/(c^4*(x - y)^2)"'):
        with pytest.raises(DerivationError, match="not positive definite there for certain"):
            derive(spec(CHARGES, (FAR, other)))
    derive(spec(CHARGES, (FAR, 'far = "2*m*n*c^4*(x - y)^2 > 2*k^2"')))
