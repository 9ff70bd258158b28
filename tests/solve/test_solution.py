"""Solutions: drift as defined, names, and tables."""

import numpy as np
import pytest

from coadjoint.solve.drift import list_owners, tell_drift
from coadjoint.solve.solution import Solution
from coadjoint.systems import rigid_body

TIME = np.array([0.0, 1.0, 2.0])
# I = (1, 1, 1): casimir1 is |Pi|^2 or a multiple of it, here (1, 4, 2.25) times that.
STATE = np.array([[1.0, 2.0, 1.5], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])


def made(state=STATE, status="OK", message=""):
    """A solution from numbers that no integrator made."""
    return Solution(rigid_body.system, TIME, state, np.ones(3), status, message)


def test_drift_is_the_largest_change_over_the_largest_size():
    """Drift is max |q(t) - q(0)| / max |q(t)|: here (4 - 1)/4 for both invariants."""
    shrinking = made(STATE[:, [1, 0, 2]])
    assert shrinking.drift == {"energy": 0.75, "casimir1": 0.75}
    assert shrinking.absolute_drift == ()


def test_what_begins_at_zero_drifts_by_its_change():
    """Its ratio to its own values would be 1, of roundings as of a wrong motion: 1e-16 is told."""
    small = made(STATE * np.array([0.0, 1e-8, 0.5e-8]))
    assert small.drift["energy"] == pytest.approx(2e-16, rel=1e-12)
    assert small.absolute_drift == ("energy", "casimir1")
    assert made().drift["energy"] == 1.5  # from 0.5 to 2: more than it was
    assert tell_drift(small, "energy") == f"{small.drift['energy']:.1e} absolute"


def test_a_component_drifts_relative_to_the_whole():
    """By hand: of (4, 0) that becomes (4, 1) the second changes by 1/4 of the largest size."""
    turned = np.array([[4.0, 4.0, 4.0], [0.0, 0.5, 1.0], [0.0, 0.0, 0.0]])
    assert list_owners(made()) == {"energy": "energy", "casimir1": "casimir1"}
    told = [tell_drift(made(turned), "Omega", f"Omega{n}") for n in (1, 2, 3)]
    assert told == ["0.0e+00", "2.5e-01", "0.0e+00"]
    grown = made(np.array([[0.0, 3, 0], [1.0, 1, 1], [0.0, 0, 0]]))
    assert tell_drift(grown, "Omega", "Omega1") == "3.0e+00 absolute"


def test_what_stays_zero_has_no_drift():
    """No division of zero by zero."""
    assert made(np.zeros((3, 3))).drift == {"energy": 0.0, "casimir1": 0.0}


def test_observables_are_those_of_the_states():
    """Angular velocity of a body with unit moments is its momentum."""
    assert np.array_equal(made()["Omega"], STATE)
    assert np.array_equal(made()["Omega1"], STATE[0])
    assert made()["energy"].tolist() == [0.5, 2.0, 1.125]


def test_a_solution_says_how_far_it_came():
    """Status, samples, times and drift in the text; the same, escaped, in a notebook."""
    found = made(status="MAX_STEPS", message="stopped")
    assert "rigid_body: MAX_STEPS, 3 samples, t = 0 .. 2" in repr(found)
    assert "drift of energy: 1.5e+00 absolute" in repr(found)
    assert "<p>Solution of rigid_body: MAX_STEPS" in found._repr_html_()
    summary = found.summary()
    assert (summary["status"], summary["message"], summary["time"]) == ("MAX_STEPS", "stopped", 2.0)
    assert summary["final"] == {"Pi1": 1.5, "Pi2": 0.0, "Pi3": 0.0}
    assert len(found) == summary["samples"] == 3


def test_xarray_is_asked_for_by_name_where_it_is_missing(monkeypatch):
    """The message has the pip command."""
    monkeypatch.setitem(__import__("sys").modules, "xarray", None)
    with pytest.raises(Exception, match=r"pip install 'coadjoint\[data\]'"):
        made().to_xarray()
