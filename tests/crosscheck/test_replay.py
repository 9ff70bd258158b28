"""Replay: what is written down once has the values of the equations, in every arithmetic."""

from fractions import Fraction

import numpy as np
import pytest

from coadjoint.crosscheck.oracle import OutsideDomain, oracle
from coadjoint.crosscheck.replay import Replayed
from coadjoint.derive.reference import Reference
from tests.conftest import rational_points
from tests.sources import textbook
from tests.specs import emitted


@pytest.mark.parametrize("system", ["heavy_top", "rolling_disk", "rocking_disk", "bloch"])
def test_what_is_repeated_is_what_the_equations_say(system):
    """To the last of 60 digits, at points other than the one at which it was written down."""
    direct = Reference(emitted(system))
    again = Replayed(direct)
    for point in rational_points((*direct.state, *textbook.GIVEN[system]), 4, seed=3):
        inputs = {name: float(value) for name, value in textbook.rational(system, point).items()}
        for function in ("rhs", "jacobian", "observables"):
            found = oracle(again, function, inputs)
            for one, other in zip(found, oracle(direct, function, inputs), strict=True):
                assert (one.value, one.envelope) == (other.value, other.envelope)


class Equations:
    """``x*y + 1/3``, ``x/y``, ``-x`` and ``sqrt(x*y)``; how often they were evaluated."""

    count = 0

    def evaluate(self, function, inputs, number, call):
        """As a `Reference`."""
        self.count += 1
        x, y = inputs["x"], inputs["y"]
        return [x * y + number(Fraction(1, 3)), x / y, -x, call("sqrt", x * y)]


def test_equations_are_evaluated_once_in_any_arithmetic():
    """What is done twice is done once, inputs that are not read may be missing."""
    equations, calls = Equations(), []
    again = Replayed(equations)

    def call(function, *arguments):
        calls.append((function, *arguments))
        return arguments[0]

    found = again.evaluate("f", {"x": 2, "y": Fraction(1, 2), "z": 0}, Fraction, call)
    assert found == [Fraction(4, 3), 4, -2, 1]
    assert calls == [("sqrt", 1)]
    values = again.evaluate("f", {"x": np.array([1.0, 2.0]), "y": 4.0}, np.float64, call)
    assert values[0].tolist() == [4 + 1 / 3, 8 + 1 / 3]
    assert values[1].tolist() == [0.25, 0.5]
    assert equations.count == 1
    assert [operation for operation, _, _ in again._functions["f"].steps].count("sqrt") == 1
    assert len(again._functions["f"].steps) == 5  # x*y once


def test_points_outside_the_domain_are_still_refused():
    """A quotient by zero and a root of a negative number, which the first point does not show."""
    again = Replayed(Equations())
    assert len(oracle(again, "f", {"x": 1.0, "y": 4.0})) == 4
    for y in (0.0, -1.0):
        with pytest.raises(OutsideDomain):
            oracle(again, "f", {"x": 1.0, "y": y})


class Replaced(Equations):
    """A derivative that another rule replaces, and a function that has a value where x > 0."""

    def evaluate(self, function, inputs, number, call):
        """As a `Reference`."""
        x, y = inputs["x"], inputs["y"]
        for _ in (x / y + y, call("log", x)):
            pass
        return [x * y]


def test_what_no_output_rests_on_is_left_out_but_for_calls():
    """A quotient by zero that nobody reads says nothing of a point, a function's domain does."""
    again = Replayed(Replaced())
    assert len(oracle(again, "f", {"x": 1.0, "y": 0.0})) == 1
    assert len(again._functions["f"].steps) == 2  # the product, and the call
    with pytest.raises(OutsideDomain):
        oracle(again, "f", {"x": -1.0, "y": 1.0})
