"""Captions of pictures say what each colour is."""

import numpy as np
import pytest

from coadjoint.solve.illustrate import describe
from coadjoint.systems import (
    chaplygin_ball,
    euler_disk,
    kepler,
    n_body,
    rigid_body,
    roller_racer,
    so8_body,
)

pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")

STARTS = {rigid_body: [1, 0.3, -0.8], kepler: [1, 0, 0, 0, 1.1, 0], so8_body: [0.1] * 28}
TIME = "Colour is time, dark at the start."


@pytest.mark.parametrize(
    ("module", "told", "untold"),
    [
        (rigid_body, (TIME,), ("cap", "member")),
        (kepler, (TIME,), ("cap", "member")),
        (n_body, ("Each member has a colour of its own.",), ("time,",)),
        (chaplygin_ball, ("coloured by time", "gray line", "two blues", "orange cap"), ("member",)),
        (euler_disk, ("coloured by time", "gray line", "two blues"), ("cap",)),
        (roller_racer, ("coloured by time", "vehicle is black"), ("cap", "blue")),
        (so8_body, ("by the generated code.",), ("olour", "cap")),
    ],
)
def test_a_caption_tells_the_colours_of_its_picture(module, told, untold):
    """Of spheres, orbits, members, bodies that roll and vehicles; components have a legend."""
    options = {"reconstruct": True} if module.system.RECONSTRUCTED else {}
    motion = module.simulate(STARTS.get(module), (0, 4), samples=1001, progress=False, **options)
    caption = describe(motion)
    assert [each for each in told if each not in caption] == []
    assert [each for each in untold if each in caption] == []
    assert np.isfinite(motion.state).all()
