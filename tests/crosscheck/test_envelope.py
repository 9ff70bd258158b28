"""Envelopes near a pole: what is carefully written passes at every distance, what is wrong fails.

The family is a function of D = R^2 - X.Y on so(3)* x so(3)*, two point vortices on a sphere with
h = -log(D)/4 among it; D is brought near zero by the choice of R.
"""

from __future__ import annotations

import numpy as np
import pytest

from coadjoint.crosscheck.ladder import crosscheck
from coadjoint.crosscheck.oracle import error_in_envelopes, oracle
from coadjoint.crosscheck.subject import depth
from coadjoint.derive.reference import Reference
from coadjoint.solve.folders import load_folder
from coadjoint.spec import read_spec
from tests.specs import render_claims

SPEC = """
title   = "Two vortices"
license = "BSD-3-Clause"
routes  = ["lie-poisson"]
algebra = {{ direct_sum = ["so(3)", "so(3)"], invariance = "left" }}
hamiltonian = {{ h = "{energy}" }}
[variables]
X = {{ role = "momentum", block = "rotation_1" }}
Y = {{ role = "momentum", block = "rotation_2" }}
[parameters]
R = {{ positive = true, default = 1 }}
"""
D = "(R^2 - dot(X, Y))"
FAMILY = {
    "1 over D": f"1/{D}",
    "1 over D squared": f"1/{D}^2",
    "log D": f"-log{D}/4",
    "sqrt D": f"sqrt{D}",
}
#: Size of D relative to its terms.
SIZES = (1.0, 1e-2, 1e-5, 1e-9)
POINTS = 6
NAMES = ("X1", "X2", "X3", "Y1", "Y2", "Y3", "R")


def rendered(folder, energy):
    """A system of the family, not compiled."""
    path = folder / "vortices.toml"
    path.write_text(SPEC.format(energy=energy))
    return render_claims(read_spec(path))


def loaded(folder, found):
    """Its generated files as a System."""
    target = folder / "vortices"
    target.mkdir()
    for name, text in found.texts.items():
        (target / name).write_text(text)
    return load_folder(target)


def near_the_pole(size):
    """States and radii at which D has a size relative to its terms."""
    source = np.random.default_rng(5)
    X, Y = source.normal(size=(2, 3, POINTS))
    dots = (X * Y).sum(axis=0)
    Y *= np.sign(dots)
    return np.vstack([X, Y]), np.sqrt(np.abs(dots) * (1 + size))


def largest_k(reference, function, values, state, radii):
    """The largest k of computed values, shape (rows, points)."""
    ks = []
    for point in range(POINTS):
        inputs = dict(zip(NAMES, [*state[:, point].tolist(), float(radii[point])], strict=True))
        exact = oracle(reference, function, inputs)
        assert any(each.value != 0 for each in exact)
        ks += [
            error_in_envelopes(float(value), each)
            for value, each in zip(values[:, point], exact, strict=True)
        ]
    return max(ks)


@pytest.mark.parametrize("energy", FAMILY.values(), ids=FAMILY)
def test_kernels_pass_at_every_distance_from_the_pole(energy, tmp_path):
    """The k stays below 2, whatever the size of D, and so below the depth of each function."""
    found = rendered(tmp_path, energy)
    system, reference = loaded(tmp_path, found), Reference(found.equations)
    for size in SIZES:
        state, radii = near_the_pole(size)
        for function in ("rhs", "jacobian", "energy"):
            values = getattr(system, function)(state, radii[np.newaxis], target="numpy")
            k = largest_k(reference, function, values.reshape(-1, POINTS), state, radii)
            assert 0.01 < k < 2 < depth(found.programs[function]) + 1


def test_two_vortices_pass_the_ladder(tmp_path):
    """Their Jacobian cancels in a way that no formula of doubles avoids."""
    found = rendered(tmp_path, FAMILY["log D"])
    reference, system = Reference(found.equations), loaded(tmp_path, found)
    report = crosscheck(found.programs, found.texts, reference, system, ("numpy",))
    assert report.k < 4 < report.threshold == 16
    assert all(figures["numpy"].points > 100 for figures in report.figures.values())


def textbook(state, radii, wrong=0.0):
    """The Jacobian of dX/dt = -(X x Y)/(4 D) and dY/dt = -dX/dt by the quotient rule.

    Of h = -log(D)/4 the gradients are Y/(4 D) and X/(4 D), and {f, h} = -X.(df/dX x dh/dX) - ...
    gives dX/dt = X x dh/dX. The term with the slope of D is wrong by a factor ``1 + wrong``.
    """
    X, Y = state[:3], state[3:]
    bottom = radii**2 - (X[0] * Y[0] + X[1] * Y[1] + X[2] * Y[2])
    top = np.cross(X, Y, axis=0)
    slopes = np.concatenate([-Y, -X])
    rows = np.empty((6, 6, POINTS))
    for j in range(6):
        unit = np.zeros((3, POINTS))
        unit[j % 3] = 1.0
        change = np.cross(unit, Y, axis=0) if j < 3 else np.cross(X, unit, axis=0)
        rows[:3, j] = (change / bottom - (1 + wrong) * top * slopes[j] / bottom**2) / 4
    rows[3:] = -rows[:3]
    return rows.reshape(36, POINTS)


@pytest.fixture(scope="module")
def vortices(tmp_path_factory):
    """The equations of two vortices."""
    return Reference(rendered(tmp_path_factory.mktemp("spec"), FAMILY["log D"]).equations)


@pytest.mark.parametrize("size", SIZES)
def test_the_textbook_jacobian_agrees(vortices, size):
    """The quotient rule, typed by hand, has a k below 2 at every distance from the pole."""
    state, radii = near_the_pole(size)
    assert largest_k(vortices, "jacobian", textbook(state, radii), state, radii) < 2


@pytest.mark.parametrize("size", SIZES)
def test_errors_above_rounding_are_caught_at_every_distance(vortices, size):
    """A term that is off by 1e-13 over the size of D fails the bound of 16."""
    state, radii = near_the_pole(size)
    values = textbook(state, radii, wrong=1e-13 / size)
    assert largest_k(vortices, "jacobian", values, state, radii) > 16


def test_wrong_last_digits_are_caught_away_from_the_pole(vortices):
    """A term that is off by 1e-12 fails where D has a tenth of the size of its terms."""
    state, radii = near_the_pole(1e-1)
    values = textbook(state, radii, wrong=1e-12)
    assert largest_k(vortices, "jacobian", values, state, radii) > 16
