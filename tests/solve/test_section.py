"""Sections: drawn, on the axes that vary, and errors that say what to do."""

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.events import Event
from coadjoint.systems import heavy_top

pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")


@pytest.fixture(scope="module")
def events():
    """A top that passes through two planes."""
    asked = [Event("Gamma1", direction=1, name="rises"), "Pi2 - 0.1", "Gamma3 == 9"]
    return heavy_top.simulate([0.3, 0.1, 4.0, 0.0, 0.6, 0.8], (0, 40), events=asked).events


def test_a_section_is_drawn_on_two_components(events, tmp_path):
    """All states at events are points; the axes are those asked for."""
    figure = events.plot(axes=("Pi1", "Omega2"))
    (plane,) = figure.axes
    assert plane.get_xlabel().startswith("Pi1")
    assert plane.get_ylabel().startswith("Omega2")
    drawn = [np.asarray(each.get_offsets()) for each in plane.collections]
    assert [len(each) for each in drawn] == [len(events["rises"]), len(events["Pi2 - 0.1"])]
    assert np.array_equal(drawn[0][:, 0], events["rises"]["Pi1"])
    assert np.array_equal(drawn[1][:, 1], events["Pi2 - 0.1"]["Omega2"])
    events.plot(tmp_path / "section.png")
    assert (tmp_path / "section.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_the_axes_are_those_that_vary():
    """Of one plane the component that the event fixes is none of them."""
    found = heavy_top.simulate([0.3, 0.1, 4.0, 0.0, 0.6, 0.8], (0, 40), events="Pi2 - 0.1")
    (plane,) = found.events.plot().axes
    assert not {plane.get_xlabel()[:3], plane.get_ylabel()[:3]} & {"Pi2"}


@pytest.mark.parametrize(
    ("axes", "offending"),
    [
        (("Pi1", "Pj"), "'Pj' is not known at events"),
        (("Pi1",), "the names of two components"),
        ("Pi1", "the names of two components"),
        (("Pi", "Pi1"), "'Pi' has 3 components"),
    ],
)
def test_axes_that_cannot_be_drawn_are_refused(events, axes, offending):
    """With the names that can be."""
    with pytest.raises(KernelArgumentError, match=offending):
        events.plot(axes=axes)


def test_without_events_there_is_nothing_to_draw(events):
    """And a name that was not looked for is refused with those that were."""
    none = heavy_top.simulate([0.3, 0.1, 4.0, 0.0, 0.6, 0.8], (0, 1), events="Gamma3 == 9").events
    with pytest.raises(KernelArgumentError, match="there is no event to draw"):
        none.plot()
    with pytest.raises(KernelArgumentError, match="'Gamma3' is not among the events"):
        none["Gamma3"]
    assert "Gamma3" not in none
    assert repr(events).count("\n") == 2
