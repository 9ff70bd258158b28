"""Kernels are compared inside their domain, wherever that lies."""

import numpy as np
import pytest

import coadjoint
from coadjoint.crosscheck.inside import points_inside
from coadjoint.crosscheck.points import Points
from coadjoint.derive import derive
from tests.specs import spec

FAR = """
title = "A system whose domain lies far away"
routes = ["poisson"]
[poisson]
brackets = { "{x, y}" = "z", "{y, z}" = "SLOPE", "{z, x}" = "y" }
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
z = { role = "coordinate" }
[hamiltonian]
h = "y"
"""
INSIDE = '[domain]\ninside = "{}"\n'


@pytest.mark.parametrize(
    ("slope", "domain"),
    [
        ("log(x - 2)", INSIDE.format("x > 3")),
        ("log(log(x) - 9)", ""),  # x > exp(9), about 8103
        ("sqrt((x - 777)*(778 - x))", ""),
    ],
)
def test_systems_with_a_distant_domain_are_checked(slope, domain, tmp_path):
    """The rate of z is {z, y}, minus the slope; few or none of the ordinary points have values."""
    path = tmp_path / "far.toml"
    path.write_text(FAR.replace("SLOPE", slope) + domain)
    system = coadjoint.load(path)
    (x,) = points_inside(derive(spec(path.read_text())), ["x"])
    for value in x:
        expected = -eval(slope, {"log": np.log, "sqrt": np.sqrt, "x": value})
        np.testing.assert_allclose(system.rhs([value, 0.5, 0.25])[2], expected, rtol=1e-9)


def test_points_inside_have_values():
    """A window of width 1: all points lie in it, and y and z may be anything."""
    equations = derive(spec(FAR.replace("SLOPE", "sqrt((x - 777)*(778 - x))")))
    found = points_inside(equations, ["x", "y", "z"])
    assert found.shape[1] > 0
    assert ((found[0] > 777) & (found[0] < 778)).all()
    assert np.isnan(found[1:]).all()
    batch = Points(3, (), 5).draw_around(found, 1, 1001)
    assert np.isfinite(batch.state).all()
    share = ((batch.state[0] > 777) & (batch.state[0] < 778)).mean()
    assert 0.2 < share < 1  # from a millionth of 777 on, and beyond the window
