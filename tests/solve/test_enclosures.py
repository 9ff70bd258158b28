"""Enclosures against the values and rates of the same formulas on fine grids."""

import importlib
import pkgutil
from functools import partial

import numpy as np
import pytest

from coadjoint import systems
from coadjoint.render.targets.modules import KernelModule
from coadjoint.solve import crossings
from coadjoint.solve.enclosures import Enclosure
from coadjoint.solve.family import FamilySystem
from coadjoint.systems import heavy_top, kapitza_top

SOURCE = np.random.default_rng(4)
#: Parts of a step.
PARTS = np.linspace(0.0, 1.0, 201)
#: Formulas of two numbers x and y, which enclosures and arrays take alike.
FORMULAS = {
    "sum": lambda x, y: 2.0 - x + y * 3.0 - (y - 1.5),
    "product": lambda x, y: x * y,
    "square": lambda x, y: x * x * x - y * y,
    "quotient": lambda x, y: x / (y + 4.0) + 1.0 / (x + 5.0) + x / 3.0,
    "sqrt": lambda x, y: np.sqrt(x * x + y * y + 0.1),
    "functions": lambda x, y: np.exp(0.5 * x) * np.sin(2.0 * y) - np.cos(x) + np.log(y + 4.0),
    "tangent": lambda x, y: np.tan(0.3 * x) * np.float64(0.5),
}


def make_steps(count, degree=9, decay=0.3):
    """Polynomials as steps have them, and two of these on the grid, ``(count, grid)``."""
    weights = decay ** np.arange(degree + 1)
    size = SOURCE.uniform(0.1, 3.0, count)
    pairs = []
    for _ in range(2):
        path = SOURCE.normal(size=(count, degree + 1)) * weights
        values = (path[:, :, np.newaxis] * PARTS ** np.arange(degree + 1)[:, np.newaxis]).sum(1)
        scaled = path / size[:, np.newaxis] ** np.arange(degree + 1)
        pairs.append((Enclosure.of_polynomial(np.ascontiguousarray(scaled.T), size), values))
    return pairs


def is_within(enclosure, values):
    """Whether values, and what they rise by between grid points, are within an enclosure."""
    line = np.add.outer(PARTS * 0, enclosure.start) + np.multiply.outer(PARTS, enclosure.rise)
    slopes = np.diff(values, axis=1) / np.diff(PARTS)
    off = np.abs(values - line.T).max(axis=1) <= enclosure.off
    return off & (np.abs(slopes.T - enclosure.rise).max(axis=0) <= enclosure.bend + 1e-11)


@pytest.mark.parametrize("name", FORMULAS)
def test_values_and_rates_are_within(name):
    """Of formulas of polynomials; and most enclosures are narrow enough to say something."""
    (x, xs), (y, ys) = make_steps(300)
    formula = FORMULAS[name]
    with np.errstate(all="ignore"):
        found, values = formula(x, y), formula(xs, ys)
        known = np.isfinite(found.off) & np.isfinite(values).all(axis=1)
        good = is_within(found, values) & (np.abs(values).max(axis=1) <= abs(found).top)
    assert good[known].all()
    assert known.mean() > 0.5
    spread = np.ptp(values, axis=1)
    assert np.median((found.off / spread)[known]) < 0.5
    assert found.is_monotone[known].mean() > 0.02


@pytest.mark.parametrize("part", ["off", "bend", "start", "rise"])
def test_an_enclosure_that_is_too_narrow_is_seen(part):
    """Spoiled: one of its numbers, by a twentieth of what a step does."""
    (x, xs), (y, ys) = make_steps(300)
    found = FORMULAS["product"](x, y)
    assert is_within(found, xs * ys).all()
    spoiled = {
        "off": 0.3 * found.off,
        "bend": 0.2 * found.bend,
        "start": found.start + 2 * found.off,
        "rise": found.rise + 2 * found.bend,
    }
    setattr(found, part, spoiled[part])
    assert not is_within(found, xs * ys).all()


def test_what_may_be_undefined_is_not_excluded():
    """Where a root, a logarithm or a quotient may not be finite, nothing is said."""
    (x, xs), _ = make_steps(300)
    with np.errstate(all="ignore"):
        for formula in (np.sqrt, np.log, lambda a: 1.0 / a, lambda a: np.tan(2.0 * a)):
            found = formula(x)
            bad = ~np.isfinite(formula(xs)).all(axis=1) | (np.abs(formula(xs)).max(axis=1) > 1e6)
            assert not ((found.low > 0) | (found.high < 0) | found.is_monotone)[bad].any()
        assert (np.sqrt(x).low > 0).any()


def test_kernels_compute_with_enclosures():
    """The observables of every system with solvers, at the middle of polynomials of low degree."""
    checked = 0
    for module in pkgutil.iter_modules(systems.__path__, "coadjoint.systems."):
        system = importlib.import_module(module.name).system
        if "observables" not in system.functions or isinstance(system, FamilySystem):
            continue
        kernel = KernelModule(system, "kernel.py").function("_observables")
        middle = SOURCE.uniform(0.5, 1.0, (system.STATE.size, 20))
        slope = 1e-3 * SOURCE.normal(size=middle.shape)
        state = [Enclosure.of_line(m - s / 2, s) for m, s in zip(middle, slope, strict=True)]
        driving = [np.full(system.INPUTS.size, 0.3)] if system.INPUTS else []
        driving += [np.array([0.2])] if system.TIME else []
        parameters = SOURCE.uniform(0.5, 1.0, system.PARAMETERS.size)
        out = np.empty(system.OBSERVABLES.size, object)
        values = np.empty((len(out), 20))
        with np.errstate(all="ignore"):
            kernel(np.array(state, object), parameters, *driving, out)
            kernel(middle, parameters, *driving, values)
        for found, value in zip(out, values, strict=True):
            if isinstance(found, Enclosure) and np.isfinite(found.off).all():
                assert (np.abs(value - (found.start + found.rise / 2)) <= found.off).all()
                checked += 1
    assert checked > 100


@pytest.mark.parametrize(
    ("simulate", "event", "end"),
    [
        (partial(heavy_top.simulate, parameters={"m": 1.5}), "Pi1 - 3", 2),
        (heavy_top.simulate, "Pi1^2 + 2*Pi2^2 + Gamma1*Pi3 == 30", 2),
        (heavy_top.simulate, "energy - 3*Omega1^2 - 2", 2),
        (heavy_top.simulate, "exp(Gamma1) - sqrt(Pi1^2 + 2) + sin(t)", 2),
        (partial(heavy_top.simulate, parameters={"m": np.linspace(1, 2, 8)}), "energy*m - Pi1", 2),
        (kapitza_top.simulate, "energy - 8 - cos(10*t)", 0.1),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_most_steps_are_not_looked_at(monkeypatch, simulate, event, end):
    """And those that are not have no event: without enclosures the same are found, to the bit."""
    state = np.random.default_rng(3).normal(size=(6, 8))
    state[3:] /= np.linalg.norm(state[3:], axis=0)
    looked = []

    def count(function, many, *rest):
        looked.append(many)
        return find(function, many, *rest)

    monkeypatch.setattr("coadjoint.solve.units.check_units", lambda *_: None)  # of any sums
    find = crossings.find_knots
    monkeypatch.setattr(crossings, "find_knots", count)
    run = {"t": (0, end), "samples": 1, "target": "numpy", "events": event}
    (few,) = simulate(state, **run).events.values()
    closely, looked[:] = sum(looked), []
    monkeypatch.setattr("coadjoint.solve.lookout.enclose", lambda *_: None)
    (all_,) = simulate(state, **run).events.values()
    assert closely < 0.4 * sum(looked)
    assert few.direction.tobytes() == all_.direction.tobytes()
    np.testing.assert_allclose(few.time, all_.time, rtol=1e-13)
    assert len(few) or "30" in event
