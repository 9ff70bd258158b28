"""Units along trajectories: events are checked, and time has a unit in every output."""

from dataclasses import replace

import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.solve.labels import unit_label
from coadjoint.systems import rigid_body
from tests.solve.systems import FALL, OSCILLATOR, build


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("Pi1 - Omega1", "1/s"),
        ("Pi1 == Omega1", "1/s"),
        ("sin(Pi1)", "kg m^2/s"),
        ("energy - t", "s"),
        ("norm(Pi)^2 - dot(Omega, Omega)", "1/s^2"),
        ("(Pi1 + 1)*Pi2", "1"),
    ],
)
def test_an_event_of_unlike_units_is_refused(text, found):
    """With the unit that was found, before anything is integrated."""
    with pytest.raises(KernelArgumentError, match="expected") as caught:
        rigid_body.simulate([0.5, 0.0, 1.0], (0, 1), events=text)
    assert caught.value.parts["unit"] == found
    assert found in str(caught.value) or found == "1"


@pytest.mark.parametrize(
    "text", ["Pi1", "Pi1 - 0.5", "Pi1 == 1/2", "Pi1/I1 - Omega2", "t == 1", "energy - Pi1*Omega1"]
)
def test_an_event_of_one_unit_is_found(text):
    """A number that is a term of its own is in the unit of the rest."""
    assert rigid_body.simulate([0.5, 0.0, 1.0], (0, 2), events=text, target="numpy").events


def test_what_the_spec_does_not_tell_fits_everything(tmp_path):
    """A unit "" is unknown; a system of pure numbers is not checked at all."""
    plain = build(OSCILLATOR, tmp_path)
    assert plain.simulate([0.0, 1.0], (0, 1), events="sin(t) - x", target="numpy").events
    told = (replace(FALL.state[0], unit="m"), replace(FALL.state[1], unit=""))
    system = build(replace(FALL, name="told", state=told), tmp_path)
    assert system.simulate([1.0, 0.0], (0, 1), events="y - v", target="numpy").events
    with pytest.raises(KernelArgumentError, match="terms of one unit"):
        system.simulate([1.0, 0.0], (0, 1), events="y - t", target="numpy")


def test_time_has_its_unit_in_every_output(tmp_path):
    """Hours in the table, the dataset and the plot; seconds where nothing else is said."""
    hours = replace(FALL, name="hours", unit_of_time="h")
    system = build(hours, tmp_path)
    solution = system.simulate([1.0, 0.0], (0, 1), samples=3, target="numpy")
    assert solution.unit("time") == solution.unit("t") == "h"
    solution.to_csv(tmp_path / "table.csv")
    assert '"time": "h"' in (tmp_path / "table.csv").read_text()
    dataset = solution.to_xarray()
    assert dataset["time"].attrs["units"] == "h"
    assert rigid_body.system.unit_of_time == "s"
    assert unit_label("1") == ""
