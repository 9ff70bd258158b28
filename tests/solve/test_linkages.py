"""Rods that hang on each other are found by the energy, and drawn with their joints."""

import numpy as np
import pytest

from coadjoint.solve.illustrate import describe
from coadjoint.solve.linkages import find_lengths
from coadjoint.solve.plot import draw
from coadjoint.solve.scenes import find_paths
from coadjoint.systems import double_spherical_pendulum

pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")


def test_rods_hang_on_each_other():
    """Joints of a double pendulum by its energy, with rods of 0.6 m and 1.4 m."""
    parameters = {"m1": 5.0, "m2": 2.0, "l1": 0.6, "l2": 1.4}
    motion = double_spherical_pendulum.simulate(None, (0, 3), parameters, samples=40)
    paths = find_paths(motion)
    assert (paths.labels, paths.linked) == (("gamma1", "gamma2"), True)
    first = 0.3 * motion["gamma1"]
    np.testing.assert_allclose(paths.members, [first, first + 0.7 * motion["gamma2"]], rtol=1e-12)
    assert "found by the energy" in describe(motion)
    figure = draw(motion)
    (rods,) = (line for line in figure.axes[0].lines if line.get_label() == "rods at the end")
    np.testing.assert_allclose(np.array(rods.get_data_3d())[:, 1:].T, paths.members[:, :, -1])
    np.testing.assert_allclose(find_lengths(motion, ["v1", "v2"]), [0.3, 0.7], rtol=1e-12)
    assert find_lengths(motion, ["v1", "gamma2"]) is None  # without a product of both
