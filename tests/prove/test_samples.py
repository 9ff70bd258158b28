"""Random points of constrained motions: constraints hold there, and rates are the kernel's."""

from fractions import Fraction

from coadjoint.algebra.linear import PRIME
from coadjoint.prove.samples import AtNumbers, Samples, leading
from tests.prove.rolling import motion


def test_points_satisfy_constraints_and_lengths():
    """A sample has Gamma.Gamma = 1 and Gamma.Omega = 0, and the motion keeps both there."""
    samples = Samples(motion("veselova"))
    point = next(samples.points())
    assert len(samples.where.relations) == 2
    for relation in samples.where.relations:
        assert point.value(relation) == 0
        assert point.moved(samples.slopes(relation)) == 0
    assert point.value(samples.field["Omega1"]) != 0
    assert point.moved(samples.slopes(samples.field["Omega1"])) != 0


def test_points_are_the_same_in_every_run():
    """Two samples of one motion begin with the same point, and their points differ."""
    along = motion("veselova")
    first, second = (Samples(along).points() for _ in range(2))
    one, other = next(first), next(second)
    assert one.values == other.values
    assert next(first).values != one.values


def test_rates_at_points_are_those_of_the_closed_form():
    """A rate by the kernel's definitions equals the quotient of determinants, modulo the prime."""
    along = motion("veselova")
    point, function = next(Samples(along).points()), along.field["Omega1"]
    rate = point.moved(point.samples.slopes(function))
    assert rate == point.value(along.rate(function)) != 0


def test_given_parameters_are_taken():
    """Numbers replace parameters, zero among them, and no symbol of these is left in rates."""
    along = motion("chaplygin_ball")
    numbers = dict.fromkeys(along.equations.setting.parameters, Fraction(1)) | {"chi1": Fraction(0)}
    point = next(Samples(along, numbers).points())
    assert [point.values[name].value for name in ("I1", "chi1")] == [1, 0]
    rate = AtNumbers(along, numbers).rate(along.field["Omega1"])
    assert along.field.reach(rate) <= set(along.equations.setting.state)
    assert rate != 0


def test_leading_coefficients_have_a_sign():
    """Of -2 x + y/3 over m it is -2."""
    ring = motion("veselova").field
    x, y, m = (ring[name] for name in ("Omega1", "Omega2", "I1"))
    assert leading((y / 3 - 2 * x) / m) == -2
