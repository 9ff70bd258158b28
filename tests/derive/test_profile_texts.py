"""Texts of profiles: the values of 50 digits, by Python's math alone, and at any points."""

import math
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from importlib import import_module

import numpy as np
import pytest

from coadjoint.cli.simulate import find_start
from coadjoint.derive.fields.profile_texts import write_profiles
from coadjoint.derive.fields.profiles import evaluate_profile
from coadjoint.errors import KernelArgumentError
from coadjoint.spec import read_spec_text
from coadjoint.systems import euler_2d, kdv, spin_chain
from tests.specs import shipped

FIELDS = (
    "burgers",
    "camassa_holm",
    "hunter_saxton",
    "kdv",
    "landau_lifshitz",
    "se3_strand",
    "sp2_strand",
    "spin_chain",
    "spin_chain_chiral",
    "two_time_body",
)


def kdv_from(profile):
    """The spec of Korteweg and de Vries with another profile."""
    text = shipped("kdv").path.read_text(encoding="utf-8")
    assert text.count('"cos(2*pi*s/L)/3"') == 1
    return read_spec_text(text.replace('"cos(2*pi*s/L)/3"', f'"{profile}"'), "kdv.toml")


def evaluate(written, place, **parameters):
    """A text at a place, with nothing but Python's math."""
    scope = {name: getattr(math, name) for name in written.called}
    (text,) = written.texts["m"]
    return eval(text, {"__builtins__": {}, **scope}, {"s": place, **parameters})


@pytest.mark.parametrize(
    "profile",
    [
        "exp(-(s - L/2)^2)/sqrt(1 + s^2)",
        "exp(-abs(s - 0.1))",
        "sign(s - L/2) + 2*sign(L/3 - s)",
        "max(s, L - s) - min(s, 1/3)",
        "pow(2 + s, 1/3) + pow(s, 3/2)",
        "atan2(s, L) - log(1 + s)^-2",
        "1/(2 + s)^3 - 2^3*pi/7",
        "s^2/3 - 1/3 - (s - (L - s))",
        "-(s - 2)^2/-(s + 1)/(s + 3)*s",
        "det(rows(vector(1, s), vector(2, s)))*norm(vector(s, 1, 2))",
        "dot(cross(vector(1, s, 0), vector(0, 1, s)), vector(s, 2, 3))",
    ],
)
def test_texts_have_the_values_of_many_digits(profile):
    """At places left and right of where signs change."""
    spec = kdv_from(profile)
    written = write_profiles(spec)
    assert written.arguments == ("s", "c", "L")
    for part in (Fraction(1, 7), Fraction(3, 10), Fraction(6, 7)):
        (known,) = evaluate_profile(spec, "m", part)
        found = evaluate(written, float(part) * 2, c=0.000484, L=2.0)
        assert math.isclose(found, known, rel_tol=1e-13, abs_tol=1e-14)


def test_texts_are_what_a_person_writes():
    """Numbers that are doubles are computed, and pi is pi."""
    written = write_profiles(kdv_from("-cos(2*pi*s/L)*(3 - 1)/4 + 0*c"))
    assert written.texts["m"] == ("0.25 * (-cos(2 * pi * s / L) * 2)",)
    assert written.called == ("cos", "pi")
    assert write_profiles(shipped("rigid_body")) is None


@pytest.mark.parametrize("name", FIELDS)
@pytest.mark.parametrize("points", [33, None])
def test_a_package_begins_at_the_profile_at_any_number_of_points(name, points):
    """That of the spec to 50 digits, component after component; a point further on it is not."""
    spec = shipped(name)
    system = import_module(f"coadjoint.systems.{name}").system
    points = points or system.size
    system = system.resize({spec.space.name: points})
    compared = 0
    for field in spec.profiles:
        found = np.array([system.STATE.defaults[c] for c in system.STATE[field].components])
        found = found.reshape(-1, points)
        for n in (0, 1, points // 2, points - 1):
            known = np.array(list(map(float, evaluate_profile(spec, field, Fraction(n, points)))))
            np.testing.assert_allclose(found[:, n], known, rtol=1e-13, atol=1e-15)
            compared += known.size
        if found.std(axis=1).any():
            moved = list(map(float, evaluate_profile(spec, field, Fraction(2, points))))
            assert np.abs(found[:, 1] - moved).max() > 1e-6
    assert compared >= 4


def test_a_plane_begins_at_its_profile():
    """Along the second coordinate first."""
    spec, system = shipped("euler_2d"), euler_2d.system.resize({"x": 8, "y": 5})
    found = np.array([system.STATE.defaults[c] for c in system.STATE.components]).reshape(8, 5)
    for place in ((0, 0), (3, 1), (7, 4)):
        (known,) = evaluate_profile(spec, "w", Fraction(place[0], 8), Fraction(place[1], 5))
        assert math.isclose(found[place], known, abs_tol=1e-15)
    run = system.resize({"x": 8, "y": 8}).simulate(None, (0, 0.1), step=0.1)
    assert run.status == "OK"


def test_a_line_begins_with_a_point_at_each_end():
    """Its last point is at L."""
    system = kdv.system
    line = system._copy(replace(system.index, periodic=False, size=9))
    found = [line.STATE.defaults[f"m[{n}]"] for n in (0, 4, 8)]
    np.testing.assert_allclose(found, [1 / 3, -1 / 3, 1 / 3])


def test_there_is_no_start_where_a_formula_has_no_value():
    """A point on a pole at one number of points, and not at another."""
    system = kdv.system

    def pole(s, c, L):
        return (1 / (s - L / 2),)

    system = system._copy(system.index)
    system.profiles = type(system.profiles)(("L",), {"m": pole})
    few = system.resize({"s": 32})
    assert not few.STATE.defaults
    for start in (lambda: few.simulate(None, (0, 1)), lambda: find_start(few, [])):
        with pytest.raises(KernelArgumentError, match="profile of m of kdv has no value"):
            start()
    assert find_start(few, [("m[0]", [1.0])])[0] == find_start(few, [("", [1.0] * 32)])[0] == 1
    assert len(system.resize({"s": 33}).STATE.defaults) == 33


def test_fourier_derivatives_begin_there_too():
    """After a change of the number of points."""
    run = spin_chain.system.resize({"s": 16}).with_derivatives("fourier").simulate(None, (0, 0.1))
    np.testing.assert_allclose(
        run["Pi"][0, :, 0], np.cos(2 * np.pi * np.arange(16) / 16), atol=1e-15
    )


def test_packages_are_imported_without_what_derives():
    """Neither NumPy nor the reader of specs."""
    code = (
        "import sys; from coadjoint.systems import spin_chain, euler_2d; "
        "spin_chain.system.resize({'s': 300}); "
        "print([x for x in ('numpy', 'sympy', 'pydantic', 'scipy') if x in sys.modules])"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "[]"
