"""Points: the same in every run, as hard as they claim to be, and where parameters may be."""

import numpy as np
import pytest

from coadjoint.crosscheck.points import ODD_SIZES, Points, move_to_cancellation, safe_exponent
from tests.programs import HEAVY_TOP, PENDULUM, program

POINTS = Points(states=6, positive=(True,) * 4 + (False,) * 4, exponent=225)
FAMILIES = POINTS.families(seed=0, count=200)


def test_points_are_the_same_in_every_run():
    """The same seed gives the same bytes, another seed others."""
    again = POINTS.families(seed=0, count=200)
    other = POINTS.families(seed=1, count=200)
    for name, batch in FAMILIES.items():
        assert batch.state.tobytes() == again[name].state.tobytes()
        assert batch.parameters.tobytes() == again[name].parameters.tobytes()
        assert batch.state.tobytes() != other[name].state.tobytes()


@pytest.mark.parametrize(
    "batch", [*FAMILIES.values(), POINTS.draw_special(0, 2000)], ids=[*FAMILIES, "special"]
)
def test_positive_parameters_are_positive(batch):
    """What a spec declares positive is positive in every family, NaN included; the rest is not."""
    assert (batch.parameters[:4] > 0).all()
    assert (batch.parameters[4:] < 0).any()


def test_point_families_match_their_names():
    """Each family has the property of its name: integers, nearly equal, huge, tiny."""
    integers = FAMILIES["integers"].state
    assert (integers == np.round(integers)).all()
    assert np.signbit(integers[integers == 0]).any()
    assert not np.signbit(integers[integers == 0]).all()
    equal = np.abs(FAMILIES["nearly equal"].parameters)
    spread = np.ptp(equal, axis=0) / equal[0]
    assert 0 < spread.max() < 1e-14
    wide = np.abs(FAMILIES["huge and tiny"].state)
    assert wide.max() > 2.0**200
    assert wide.min() < 2.0**-200
    assert np.isfinite(wide).all()
    random = FAMILIES["random"]
    assert len(np.unique(random.state)) == random.state.size


def test_special_points_contain_every_special_value():
    """Infinities, NaN, subnormals and both zeros occur."""
    values = POINTS.draw_special(0, 2000).state
    assert np.isnan(values).any()
    assert np.isposinf(values).any()
    assert np.isneginf(values).any()
    assert ((values != 0) & (np.abs(values) < np.finfo(float).tiny)).any()
    assert np.signbit(values[values == 0]).any()


def test_batches_have_odd_sizes_and_single_members():
    """Sizes include one member and ends inside a vector register."""
    assert {1, 2, 3, 7, 8, 15, 17, 1001} == set(ODD_SIZES)


def test_cancelling_moves_outputs_near_zero():
    """Moved points bring outputs down by ten orders of magnitude for half of the members."""
    start = POINTS.families(seed=3, count=100)["random"]

    def cross(batch):
        state = batch.state
        return np.stack([state[0] * state[1] - state[2] * state[3] + state[4] - state[5]])

    moved = move_to_cancellation(cross, start, seed=4)
    terms = np.abs(moved.state).max(axis=0) ** 2 + np.abs(moved.state).max(axis=0)
    small = np.abs(cross(moved)[0]) / terms
    assert np.median(small) < 1e-10
    assert np.isfinite(moved.state).all()
    assert moved.parameters is start.parameters
    assert (moved.state != start.state).any(axis=0).sum() > 50


def test_magnitudes_keep_products_in_range():
    """The exponent is 900 over the degree, and small where exponentials are called."""
    top = {each.name: each for each in HEAVY_TOP.programs}
    degree = 4  # Pi1/I1*Pi2 has three factors, and so has m*g*(Gamma*chi) ... four
    assert safe_exponent(top, elementary=False) == 900 // degree
    pendulum = {each.name: each for each in PENDULUM.programs}
    assert safe_exponent(pendulum, elementary=True) == 5
    constant = {"rhs": program("rhs", "x", "", "", "1", (1,))}
    assert safe_exponent(constant, elementary=False) == 900


def test_shared_parameters_are_those_of_the_first_member():
    """A shared batch has one set of parameters, contiguous."""
    shared = FAMILIES["random"].share("parameters")
    assert shared.parameters.shape == (8,)
    assert shared.parameters.tolist() == FAMILIES["random"].parameters[:, 0].tolist()
