"""The contact oscillator: McLachlan and Perlmutter (2006), J. Nonlinear Sci. 16, example 5.2.

A model of a continuously variable transmission (Modin and Verdier 2014, arXiv:1212.6618): y drives,
x and z are coupled by ``x' + y z' = 0``, and every coordinate is an oscillator.
"""

from functools import cache

import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.prove import Verdict
from tests.sources.test_multipliers import written_out
from tests.specs import prove_claims, spec

TEXT = """
title = "Contact oscillator"
routes = ["nonholonomic", "hamel"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
z = { role = "coordinate" }
vx = { role = "velocity", of = "x" }
vy = { role = "velocity", of = "y" }
vz = { role = "velocity", of = "z" }
[parameters]
eps = { default = "0.3" }
[lagrangian]
l = "(vx^2 + vy^2 + vz^2)/2 - (x^2 + y^2 + z^2 + eps*x^2*z^2)/2"
[constraints]
contact = "vx == -y*vz"
[claims]
conserved = ["energy", "y^2 + vy^2", "x^2 + (1 + eps*x^2)*z^2 + (1 + y^2)*vz^2"]
"""
x, y, z, vy, vz, eps = sympy.symbols("x y z vy vz eps")


@cache
def rates(*changes):
    """Rates and reactions by name."""
    return written_out(derive(spec(TEXT, *changes)))


def multiplier(sign=1):
    """From ``x'' = F_x + lambda, z'' = F_z + y lambda`` and the rate of the constraint."""
    force = (-x - eps * x * z**2, -z - eps * x**2 * z)
    return -(force[0] + sign * y * force[1] + vy * vz) / (1 + y**2)


def test_its_motion_is_that_of_a_multiplier_in_space():
    """The driver goes free, z'' = F_z + y lambda, and lambda is the reaction."""
    found = rates()
    assert found["vy"] == -y
    expected = -z - eps * x**2 * z + y * multiplier()
    assert sympy.simplify(found["vz"] - expected) == 0
    assert sympy.simplify(found["contact_reaction"] - multiplier()) == 0
    wrong = -z - eps * x**2 * z + y * multiplier(-1)
    assert sympy.simplify(found["vz"] - wrong) != 0


def test_the_driver_and_the_driven_keep_their_energies():
    """Energy, that of y, and what is left; with a force of x on y neither of the last two."""
    assert all(claim.verdict is Verdict.PROVED for claim in prove_claims(spec(TEXT)).claims)
    coupled = spec(TEXT, ("eps*x^2*z^2)/2", "eps*x^2*y^2)/2"))
    refuted = {claim.statement for claim in prove_claims(coupled).refuted}
    assert refuted == {
        "y^2 + vy^2 is conserved",
        "x^2 + (1 + eps*x^2)*z^2 + (1 + y^2)*vz^2 is conserved",
    }


@pytest.mark.parametrize("change", [("-y*vz", "y*vz"), ("-y*vz", "-vz")])
def test_another_transmission_moves_otherwise(change):
    """The ratio of the gear tells."""
    assert sympy.simplify(rates(change)["vz"] - rates()["vz"]) != 0
