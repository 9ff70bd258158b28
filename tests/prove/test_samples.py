"""Random points of constrained motions: constraints hold there, and rates are the kernel's."""

from fractions import Fraction
from itertools import islice
from random import Random

import pytest

from coadjoint.exact import Field
from coadjoint.exact.linear import PRIME, primes
from coadjoint.prove.functions import Experiment, Functions, FunctionsAtPoint
from coadjoint.prove.samples import Samples, leading
from tests.prove.rolling import motion

#: A slope that does not move.
PARAMETER = ("[parameters]", '[parameters]\nalpha = { default = 1, unit = "1", doc = "slope" }')


def test_points_satisfy_constraints_and_lengths():
    """A sample has Gamma.Gamma = 1 and Gamma.Omega = 0, and the motion keeps both there."""
    samples = Samples(motion("veselova"))
    point = next(samples.points())
    assert len(samples.where.relations) == 2
    for relation in samples.where.relations:
        assert point.value(relation) == 0
        assert point.differentiate(samples.slopes(relation)) == 0
    assert point.value(samples.field["Omega1"]) != 0
    assert point.differentiate(samples.slopes(samples.field["Omega1"])) != 0


def test_points_are_the_same_in_every_run():
    """Two samples of one motion begin with the same point, and their points differ."""
    along = motion("veselova")
    first, second = (Samples(along).points() for _ in range(2))
    one, other = next(first), next(second)
    assert one == other
    assert next(first) != one


def test_rates_at_points_are_those_of_the_closed_form():
    """A rate by the kernel's definitions equals the quotient of determinants, modulo the prime."""
    along = motion("veselova")
    point, function = next(Samples(along).points()), along.field["Omega1"]
    rate = point.differentiate(point.samples.slopes(function))
    assert rate == point.value(along.rate(function)) != 0


def test_given_parameters_are_taken():
    """Numbers replace parameters, zero among them, and no symbol of these is left in rates."""
    along = motion("chaplygin_ball")
    numbers = dict.fromkeys(along.equations.setting.parameters, Fraction(1)) | {"chi1": Fraction(0)}
    point = next(Samples(along, numbers).points())
    assert [point[name] for name in ("I1", "chi1")] == [1, 0]
    rate = along.at(numbers).rate(along.field["Omega1"])
    assert along.field.reach(rate) <= set(along.equations.setting.state)
    assert rate != 0


def test_leading_coefficients_have_a_sign():
    """Of -2 x + y/3 over m it is -2."""
    ring = motion("veselova").field
    x, y, m = (ring[name] for name in ("Omega1", "Omega2", "I1"))
    assert leading((y / 3 - 2 * x) / m) == -2


def test_square_roots_exist_modulo_the_prime_that_is_taken():
    """3 has no square root modulo 2^61 - 1, so that another prime is taken; of 4 it is 2."""
    along = motion("chaplygin_sleigh", ("m*(v^2", "sqrt(m)*(v^2"))
    root = along.field.call("sqrt", along.field["m"])
    assert pow(3, (PRIME - 1) // 2, PRIME) == PRIME - 1
    for number in (3, 4, 12):
        numbers = {"m": Fraction(number), "I": Fraction(1), "a": Fraction(1)}
        samples = Samples(along, numbers)
        assert samples.obstacle == ""
        point = next(samples.points())
        value = point.value(root)
        assert value * value % samples.prime == number
        assert (samples.prime == PRIME) == (number == 4)
        assert (value == 2) == (number == 4)


def test_a_root_of_a_negative_number_is_named():
    """No real motion has it."""
    along = motion("chaplygin_sleigh", ("m*(v^2", "sqrt(m)*(v^2"))
    numbers = {"m": Fraction(-2), "I": Fraction(1), "a": Fraction(1)}
    assert Samples(along, numbers).obstacle == "a square root of a negative number occurs"
    assert list(Samples(along, numbers).points()) == []


def test_functions_of_parameters_do_not_move():
    """cos(alpha) is one number in all points, cos(phi) is not; both lie on a circle."""
    change = ("vx == r*cos(phi)", "vx == r*cos(alpha)*cos(phi)")
    along = motion("rolling_disk_vertical", change, PARAMETER)
    call = along.field.call
    alpha, phi = along.field["alpha"], along.field["phi"]
    points = list(islice(Samples(along).points(), 4))
    for argument, count in ((alpha, 1), (phi, 4)):
        cosine, sine = call("cos", argument), call("sin", argument)
        assert len({point.value(cosine) for point in points}) == count
        assert {point.value(cosine**2 + sine**2) for point in points} == {1}
    at_zero = Samples(along, dict.fromkeys(along.equations.setting.parameters, Fraction(0)))
    given = at_zero.functions.lattices["sin", "cos"]
    assert [bool(multiples) for multiples in given.multiples] == [False, True]


#: Arguments with the relation between their sines and cosines, which no normal form has to know.
RELATED = {
    "double": (("2*phi", "phi"), lambda c, s: c[0] - c[1] ** 2 + s[1] ** 2),
    "half": (("phi/2", "phi"), lambda c, s: s[1] - 2 * s[0] * c[0]),
    "negative": (("-phi", "phi"), lambda c, s: s[0] + s[1]),
    "sum": (
        ("phi + theta", "phi", "theta"),
        lambda c, s: c[0] - c[1] * c[2] + s[1] * s[2],
    ),
    "difference": (
        ("phi - theta", "phi", "theta"),
        lambda c, s: s[0] - s[1] * c[2] + c[1] * s[2],
    ),
    "shift": (
        ("phi + alpha", "phi - alpha", "2*alpha"),
        lambda c, s: c[2] - c[0] * c[1] - s[0] * s[1],
    ),
}


@pytest.mark.parametrize("name", RELATED)
def test_functions_satisfy_addition_theorems(name):
    """Sines and cosines of multiples, sums and differences are those of the theorems."""
    texts, relation = RELATED[name]
    ring = Field(["phi", "theta", "alpha"], slots=6)
    names = {each: ring[each] for each in ring.names}
    arguments = [eval(text, {}, names) for text in texts]
    c, s = ([ring.call(f, a) for a in arguments] for f in ("cos", "sin"))
    defect = relation(c, s)
    functions = Functions(ring, [defect, *c], ["phi", "theta"], ["alpha"], {})
    assert functions.obstacle == ""
    for seed in range(3):
        experiment = Experiment(functions, PRIME, Random(seed))
        call = FunctionsAtPoint(experiment)
        point = {x: experiment.draw() for x in ring.names}
        call.learn(point)
        assert ring.evaluate(defect, point, experiment.number, call).value == 0
        assert ring.evaluate(defect + c[0], point, experiment.number, call).value != 0


def test_exponentials_multiply_and_roots_of_numbers_too():
    """exp(x + 2 y) is exp(x) exp(y)^2, and sqrt(6) is sqrt(2) sqrt(3), whatever their signs."""
    ring = Field(["x", "y"], slots=8)
    x, y = ring["x"], ring["y"]
    first, second, both = (ring.call("exp", a) for a in (x, y, x + 2 * y))
    roots = [ring.call("sqrt", ring.number(n)) for n in (2, 3, 6)]
    product = roots[0] * roots[1]
    defects = [both - first * second**2, product - roots[2]]
    functions = Functions(ring, [first, second, both, *roots], ["x", "y"], [], {})
    seen = 0
    for prime in islice(primes(), 30):
        try:
            experiment = Experiment(functions, prime, Random(1))
        except ZeroDivisionError:  # no square root of 2 or of 3
            continue
        point = {name: experiment.draw() for name in ring.names}
        call = FunctionsAtPoint(experiment)
        call.learn(point)
        for defect in defects:
            assert ring.evaluate(defect, point, experiment.number, call).value == 0
        assert ring.evaluate(product + roots[2], point, experiment.number, call).value != 0
        seen += 1
    assert seen > 3


@pytest.mark.parametrize(
    ("functions", "reason"),
    [
        (lambda f, x, y: [f("log", x), f("log", x * y)], "logarithms of 2 arguments"),
        (lambda f, x, y: [f("exp", f("exp", x))], "exp is taken of functions"),
        (lambda f, x, y: [f("sin", 1 / (x + y)), f("sin", x)], "functions of 2 arguments"),
        (lambda f, x, y: [f("exp", x * 0 + 2), f("log", x * 0 + 2)], "logarithms of numbers"),
    ],
)
def test_relations_that_may_be_missed_are_named(functions, reason):
    """Values that satisfy all relations are known only where all relations are."""
    ring = Field(["x", "y"], slots=8)
    elements = functions(ring.call, ring["x"], ring["y"])
    assert reason in Functions(ring, elements, ["x", "y"], [], {}).obstacle


def test_roots_that_are_made_of_others_are_an_obstacle():
    """sqrt(m + 2 + 2 sqrt(m + 1)) is 1 + sqrt(m + 1), which signs modulo a prime may contradict."""
    root = "sqrt(m + 2 + 2*sqrt(m + 1))"
    related = Samples(motion("chaplygin_sleigh", ("m*(v^2", f"{root}*(v^2")))
    assert related.obstacle == "square roots occur that may be made of each other"
    assert list(related.points()) == []
    free = Samples(motion("chaplygin_sleigh", ("m*(v^2", f"{root.replace('2*', '3*')}*(v^2")))
    assert free.obstacle == ""
