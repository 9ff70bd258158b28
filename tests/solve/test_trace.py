"""Traces: the path on the plane is drawn to one scale, or what is missing is said."""

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.paths import PIECES
from coadjoint.systems import rigid_body
from tests.rolling import FOLLOWED_SLEIGH, built

pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")


@pytest.fixture(scope="module")
def sleigh():
    """A sleigh with its place."""
    return built(FOLLOWED_SLEIGH).simulate([1, 1], (0, 2), target="numpy", reconstruct=True)


def test_the_path_is_drawn_to_one_scale_with_its_start(sleigh):
    """Equal axes with units, the curve through all samples, start and end marked."""
    axes = sleigh.trace().axes[0]
    assert axes.get_aspect() == 1
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [m]", "y [m]")
    path, start, _ = axes.lines
    points = path.get_xydata().T[:, ::PIECES]
    np.testing.assert_array_equal(points, [sleigh["x"], sleigh["y"]])
    assert start.get_xydata().tolist() == [[0.0, 3.0]]
    assert start.get_label() == "start"


def test_a_picture_is_written(sleigh, tmp_path):
    """A PNG, and no temporary file beside it."""
    sleigh.trace(tmp_path / "trace.png")
    assert (tmp_path / "trace.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert len(list(tmp_path.iterdir())) == 1


def test_without_a_path_there_is_no_picture(sleigh, tmp_path):
    """A body without x and y, and a run that did not follow them."""
    free = rigid_body.simulate([1, 2, 3], (0, 1), samples=3)
    with pytest.raises(KernelArgumentError, match="rigid_body leaves no trace: no x and no y"):
        free.trace(tmp_path / "trace.png")
    alone = sleigh.system.simulate([1, 1], (0, 1), target="numpy", samples=3)
    with pytest.raises(KernelArgumentError, match="'x' is not in this solution"):
        alone.trace(tmp_path / "trace.png")
    assert not list(tmp_path.iterdir())
