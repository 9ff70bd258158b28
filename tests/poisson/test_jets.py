"""Undetermined functions and their derivatives."""

import pytest

from coadjoint.poisson.jets import Jet


def test_total_derivatives_obey_the_chain_rule():
    """D_1 (c_2 c) = c_12 c + c_2 c_1, and mixed derivatives do not depend on their order."""
    jet = Jet(["c"], 2)
    slopes = dict(jet.slopes(jet["c_2"] * jet["c"]))
    assert slopes[0] == jet["c_12"] * jet["c"] + jet["c_2"] * jet["c_1"]
    assert dict(jet.slopes(jet["c_1"]))[1] == dict(jet.slopes(jet["c_2"]))[0] == jet["c_12"]


def test_third_derivatives_are_not_there():
    """A derivative beyond the second order is a fault of ours, named."""
    jet = Jet(["c"], 2)
    with pytest.raises(AssertionError, match="c_12 is beyond"):
        jet.slopes(jet["c_12"])
