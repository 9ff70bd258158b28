"""Kernels of all targets against the formulas of books in exact arithmetic.

The kernels are those of `generated/`, which `tests.test_regenerate` compares with a fresh run, so
that a change anywhere between a spec and a compiled kernel shows. Some are built here from specs.
"""

from fractions import Fraction
from functools import cache

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.render.targets import BUILDS
from coadjoint.solve.folders import load_folder
from tests.sources import textbook
from tests.specs import rendered
from tests.trees_of_files import ROOT, folder_until_exit

#: Inputs lie in [1/8, 8], so that sums stay below 2^13 and their rounding errors below 2^-37.
TOLERANCE = 2.0**-37
SYSTEMS = sorted(textbook.RATES)
TARGETS = tuple(BUILDS)
MEMBERS = 7


#: Systems built here: mutants of templates and of lowering are judged by them.
BUILT = tuple(name for name in SYSTEMS if name.startswith(("heavy_top", "bargmann")))


@pytest.fixture
def built(request):
    """A system that is named; with few points of cross-check, the book is the judge here."""
    return build(request.param)


@cache  # tests of a system do not follow one another
def build(system):
    """The same, once in a process."""
    if system not in BUILT:
        return load_folder(ROOT / "generated" / system)
    folder = folder_until_exit() / system
    folder.mkdir()
    for name, text in rendered(system).texts.items():
        (folder / name).write_text(text)
    return load_folder(folder)


def in_campaigns(name, target):
    """What is not built here was held to exact C when it was written, in every other target."""
    return pytest.mark.campaign if target != "c" and name not in BUILT else ()


#: Of every system each target.
each_target = pytest.mark.parametrize(
    ("built", "target"),
    [
        pytest.param(name, target, marks=in_campaigns(name, target))
        for name in SYSTEMS
        for target in TARGETS
    ],
    indirect=["built"],
)


def inputs(name, shared):
    """Dyadic random states, and parameters with inputs and time: exact as doubles and fractions."""
    source = np.random.default_rng(11)
    sizes = len(textbook.STATES[name]), len(textbook.GIVEN[name])
    state, parameters = (
        source.integers(1, 64, (n, MEMBERS)) / 8 * source.choice([-1, 1], (n, MEMBERS))
        for n in sizes
    )
    parameters = np.abs(parameters) + np.arange(1, sizes[1] + 1)[:, None] / 16
    named = dict(zip(textbook.GIVEN[name], parameters, strict=True))
    parameters = np.array(list(textbook.within(name, named).values())).reshape(parameters.shape)
    return state, parameters[:, 0].copy() if shared else parameters


def call(built, function, state, given, target="c"):
    """A function of a kernel, with inputs and time where it takes them."""
    count = len(textbook.PARAMETERS[built.name])
    parameters, driving = given[:count], given[count:]
    time = {"time": driving[-1]} if built.TIME else {}
    inputs = [driving[: len(driving) - len(time)]] if built.INPUTS else []
    return getattr(built, function)(state, parameters, *inputs, **time, target=target)


def members(state, parameters):
    """Each member's state and parameters as fractions."""
    for n in range(state.shape[1]):
        own = parameters if parameters.ndim == 1 else parameters[:, n]
        yield n, [Fraction(x) for x in state[:, n].tolist()], [Fraction(p) for p in own.tolist()]


def check(found, expected):
    """Floats against fractions."""
    assert np.isfinite(found).all()
    assert any(expected)
    for a, b in zip(found, expected, strict=True):
        assert abs(Fraction(float(a)) - b) <= TOLERANCE * max(1, abs(b)), (float(a), float(b))


@cache
def rates_of_the_book(name, shared):
    """Of all members, one after the other; targets are compared with the same numbers."""
    given = members(*inputs(name, shared))
    return [rate for _, x, p in given for rate in textbook.RATES[name](x, p)]


@cache
def slopes_of_the_book(name):
    """Of each member row by row.

    Rates quadratic in each component: central differences of the textbook's are exact. Where rates
    are quotients, a step of 1e-20 is as good as exact.
    """
    size = Fraction(1, 10**20) if name in textbook.QUOTIENTS else Fraction(1)
    found = []
    for _, x, p in members(*inputs(name, shared=False)):
        slopes = []
        for j in range(len(x)):
            step = [size * (i == j) for i in range(len(x))]
            up = textbook.RATES[name]([a + b for a, b in zip(x, step, strict=True)], p)
            down = textbook.RATES[name]([a - b for a, b in zip(x, step, strict=True)], p)
            slopes.append([(a - b) / (2 * size) for a, b in zip(up, down, strict=True)])
        found.append([row[i] for i in range(len(x)) for row in slopes])
    return found


@cache
def observables_of_the_book(name):
    """Of each member by name."""
    return [textbook.OBSERVABLES[name](x, p) for _, x, p in members(*inputs(name, shared=False))]


@cache
def tensors_of_the_book(name):
    """Of each member row by row."""
    given = members(*inputs(name, shared=True))
    return [[value for row in textbook.TENSORS[name](x, p) for value in row] for _, x, p in given]


@each_target
@pytest.mark.parametrize("shared", [True, False], ids=["shared", "own"])
def test_rates_are_those_of_the_book(built, target, shared):
    """The rhs of every member equals the textbook's rates."""
    found = call(built, "rhs", *inputs(built.name, shared), target)
    # of all members at once: some of them may rest
    check(found.T.ravel(), rates_of_the_book(built.name, shared))


@each_target
def test_jacobian_is_the_derivative_of_the_book_formula(built, target):
    """Rates need not depend on every component, but they do on some."""
    found = call(built, "jacobian", *inputs(built.name, shared=False), target)
    for n, slopes in enumerate(slopes_of_the_book(built.name)):
        check(found[:, :, n].ravel(), slopes)


@each_target
def test_observables_are_those_of_the_book(built, target):
    """Every observable under its name; energy alone, too."""
    given = inputs(built.name, shared=False)
    found, energy = (call(built, each, *given, target) for each in ("observables", "energy"))
    names = built.OBSERVABLES.components
    for n, expected in enumerate(observables_of_the_book(built.name)):
        assert set(names) == set(expected)
        check(found[:, n], [expected[name] for name in names])
        check([energy[n]], [expected["energy"]])


@each_target
def test_poisson_tensor_is_that_of_the_book(built, target):
    """Every bracket of two state components."""
    if built.name not in textbook.TENSORS:
        with pytest.raises(KernelArgumentError, match="no function 'poisson_tensor'"):
            built.poisson_tensor(*inputs(built.name, shared=True), target=target)
        return
    found = call(built, "poisson_tensor", *inputs(built.name, shared=True), target)
    for n, expected in enumerate(tensors_of_the_book(built.name)):
        check(found[:, :, n].ravel(), expected)


@pytest.mark.parametrize("built", BUILT, indirect=True)
def test_the_comparison_sees_a_wrong_member(built):
    """One member's rates moved to another are noticed."""
    state, parameters = inputs(built.name, shared=False)
    found = call(built, "rhs", state, parameters)
    _, x, p = next(members(state, parameters))
    expected = textbook.RATES[built.name](x, p)
    check(found[:, 0], expected)
    with pytest.raises(AssertionError):
        check(found[:, 1], expected)
