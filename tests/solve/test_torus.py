"""A field in a plane: rates by sums over waves, steady flows, what is kept, and what is refused."""

import pickle
import subprocess
import sys

import numpy as np
import pytest
import sympy

import coadjoint
from coadjoint.errors import KernelArgumentError
from coadjoint.solve.plane_waves import PlaneWaves
from coadjoint.solve.torus import TorusSystem
from coadjoint.systems import euler_2d
from tests.specs import shipped

LENGTHS = {"Lx": 2.0, "Ly": 3.0}


def plane(*sizes):
    """The fluid at so many points."""
    return euler_2d.system.resize(dict(zip("xy", sizes, strict=True)))


def mix(sizes, seed=0):
    """A field of all waves that move, of random sizes and phases, without a mean."""
    source, (x, y) = np.random.default_rng(seed), (np.arange(n) / n for n in sizes)
    most = [(n - 1) // 3 for n in sizes]
    w = np.zeros(sizes)
    for a in range(-most[0], most[0] + 1):
        for b in range(-most[1], most[1] + 1):
            phase = 2 * np.pi * (a * x[:, None] + b * y) + source.uniform(0, 7)
            w += source.normal() * np.cos(phase) * ((a, b) != (0, 0))
    return w


def sum_over_waves(w, lengths):
    """The rates by sums over pairs of waves, which know nothing of points."""
    sizes = w.shape
    series = np.fft.fft2(w) / w.size
    most = [(n - 1) // 3 for n in sizes]
    waves = [(a, b) for a in range(-most[0], most[0] + 1) for b in range(-most[1], most[1] + 1)]
    rates = np.zeros_like(series)
    factor = (2 * np.pi) ** 2 / (lengths[0] * lengths[1])
    for p, q in waves:
        if (p, q) == (0, 0):
            continue
        psi = series[p, q] / ((2 * np.pi * p / lengths[0]) ** 2 + (2 * np.pi * q / lengths[1]) ** 2)
        for r, s in waves:
            if (p + r, q + s) in waves:  # {e_k, e_l} = -(k x l) e_(k + l)
                rates[p + r, q + s] -= factor * (p * s - q * r) * psi * series[r, s]
    return np.fft.ifft2(rates).real * w.size


@pytest.mark.parametrize("sizes", [(10, 13), (8, 9), (4, 5)])
def test_rates_are_sums_over_waves(sizes):
    """Odd and even numbers of points, in C and in NumPy with the same bits."""
    w, system = mix(sizes), plane(*sizes)
    expected = sum_over_waves(w, (2.0, 3.0))
    found = [system.rhs(w.ravel(), LENGTHS, target=t).reshape(sizes) for t in ("numpy", "c")]
    np.testing.assert_allclose(found[0], expected, atol=1e-13 * np.abs(expected).max())
    assert np.array_equal(*found)
    assert np.abs(found[0] + expected).max() > np.abs(expected).max()  # the sign is seen


def test_vorticity_is_carried_by_the_velocity():
    """-u.grad w of three waves, differentiated by SymPy, which 16 points do not truncate."""
    x, y = sympy.symbols("x y")
    psi = sympy.cos(x) + sympy.sin(2 * y) / 2 + sympy.cos(x + y) / 3
    w = -psi.diff(x, 2) - psi.diff(y, 2)
    rate = -(psi.diff(y) * w.diff(x) - psi.diff(x) * w.diff(y))
    at = np.meshgrid(*[2 * np.pi * np.arange(16) / 16] * 2, indexing="ij")
    start, expected = (sympy.lambdify((x, y), each)(*at) for each in (w, rate))
    found = plane(16, 16).rhs(start.ravel()).reshape(16, 16)
    np.testing.assert_allclose(found, expected, atol=1e-13)
    assert np.abs(expected).max() > 1


def test_waves_of_one_length_are_steady():
    """(5, 0), (3, 4) and (4, -3) have 25; with (5, 1) in the place of one the flow moves."""
    x, y = np.meshgrid(*[2 * np.pi * np.arange(32) / 32] * 2, indexing="ij")
    steady = np.cos(5 * x) + 0.7 * np.sin(3 * x + 4 * y) + 0.3 * np.cos(4 * x - 3 * y)
    system = plane(32, 32)
    assert np.abs(system.rhs(steady.ravel())).max() < 1e-13
    moved = steady + np.cos(5 * x + y)
    assert np.abs(system.rhs(moved.ravel())).max() > 0.01


def test_energy_and_enstrophy_are_kept_and_the_third_power_is_not():
    """Their rates at a random field; with one wave more than N > 3 K allows they change."""
    sizes = (9, 12)
    w, system = mix(sizes), plane(*sizes)
    rate = system.rhs(w.ravel(), LENGTHS)
    step = 1e-4 / np.abs(rate).max()
    after, before = (
        system.observables(w.ravel() + sign * step * rate, LENGTHS) for sign in (1, -1)
    )
    changes = (after - before) / (2 * step)
    scale = np.abs(system.observables(w.ravel(), LENGTHS)) * np.abs(rate).max()
    assert (np.abs(changes[:2]) < 1e-11 * scale[:2]).all()
    assert abs(changes[2]) > 1e-3 * scale[2]


def test_one_wave_more_than_points_allow_changes_the_energy(monkeypatch):
    """With N = 3 K false waves come back."""
    sizes = (9, 9)
    w = mix((10, 10))[:9, :9]
    series = np.fft.fft2(w)
    series[0, 0] = 0
    keep = np.abs(np.fft.fftfreq(9, 1 / 9)) <= 3
    w = np.fft.ifft2(series * np.outer(keep, keep)).real

    def change():
        system = plane(*sizes)
        rate = system.rhs(w.ravel(), LENGTHS)
        step = 1e-4 / np.abs(rate).max()
        both = [system.energy(w.ravel() + s * step * rate, LENGTHS) for s in (1, -1)]
        return abs(both[0] - both[1]) / (2 * step) / np.abs(rate).max()

    good = change()
    made = PlaneWaves.__init__

    def spoiled(self, *given):
        made(self, *given)
        self._kept = np.outer(keep, keep[:5])[..., np.newaxis]

    monkeypatch.setattr(PlaneWaves, "__init__", spoiled)
    assert good < 1e-10 < 1e-6 < change()


def test_a_run_keeps_energy_and_enstrophy():
    """By SciPy's method of order 8, as far as its tolerance; the shape is that of the points."""
    start = {"w": mix((12, 12))}
    run = plane(12, 12).simulate(start, (0, 0.5), samples=5, rtol=1e-11, atol=1e-11)
    assert run["w"].shape == (12, 12, 5)
    assert {*run.drift} == {"energy", "Z"}
    assert max(run.drift.values()) < 1e-9
    assert abs(run["w"][..., -1] - run["w"][..., 0]).max() > 1


def test_points_stand_at_equal_distances_from_zero():
    """Along both coordinates, each with its own length; of several lengths there are none."""
    system = plane(4, 5)
    found = system.find_coordinates(np.array([2.0, 10.0]))
    np.testing.assert_array_equal(found["x"], [0, 0.5, 1, 1.5])
    np.testing.assert_array_equal(found["y"], [0, 2, 4, 6, 8])
    assert system.find_coordinates(np.array([[2.0, 3.0], [10.0, 10.0]])) == {}


def test_several_trajectories_at_once():
    """Each with its own lengths."""
    w, system = np.stack([mix((8, 9), seed) for seed in (0, 1)], axis=-1), plane(8, 9)
    lengths = np.array([[2.0, 4.0], [3.0, 5.0]])
    both = system.rhs(w.reshape(-1, 2), lengths)
    for n in range(2):
        alone = system.rhs(w[..., n].ravel(), lengths[:, n])
        np.testing.assert_allclose(both[:, n], alone, atol=1e-13 * np.abs(alone).max())


def test_a_system_is_pickled_with_its_sizes():
    """By reference."""
    again = pickle.loads(pickle.dumps(plane(8, 9)))
    assert isinstance(again, TorusSystem)
    assert again.counts == (8, 9)
    assert repr(again) == "<System euler_2d: 8 x 9 points; state w; parameters Lx, Ly>"
    assert again.STATE.components[:2] == ("w[0,0]", "w[0,1]")


def test_a_plane_of_ones_own(tmp_path):
    """Shallow water by its stream function: psi itself is part of A, so that w may have a mean."""
    text = shipped("euler_2d").path.read_text(encoding="utf-8")
    text = text.replace("(psi_x^2 + psi_y^2)/2", "(psi_x^2 + psi_y^2 + F*psi^2)/2")
    text = text.replace("[parameters]\n", "[parameters]\nF = { positive = true, default = 2 }\n")
    text = text.replace("[profiles]\n", "[profiles]\n").replace("size = 32", "size = 8")
    path = tmp_path / "water.toml"
    path.write_text(text, encoding="utf-8")
    system = coadjoint.load(path)
    # one wave with a mean: psi = mean/F + cos(x)/(1 + F)
    x = 2 * np.pi * np.arange(8) / 8
    w = np.broadcast_to(3 + np.cos(x)[:, None], (8, 8))
    energy = 2 * np.pi**2 * (9 / 2 + 1 / 2 / 3)
    assert np.isclose(system.energy(w.ravel()), energy, rtol=1e-14)
    assert system.simulate({"w": w}, (0, 1), samples=2).status == "OK"


@pytest.mark.parametrize(
    ("sizes", "message"),
    [
        ({"x": 8, "z": 8}, "expected a number of points for each of x and y"),
        ({"point": 64}, "Choose them"),
        ({"x": 3, "y": 8}, "at least 4"),
        ({"x": 8.0, "y": 8}, "whole number"),
    ],
)
def test_sizes_that_are_none(sizes, message):
    """Other names, and too few points."""
    with pytest.raises(KernelArgumentError, match=message):
        euler_2d.system.resize(sizes)


def test_fields_that_do_not_fit_are_refused():
    """A mean, and waves that are left out; the advice works."""
    system, w = plane(8, 8), mix((8, 8))
    with pytest.raises(KernelArgumentError, match="Subtract the mean"):
        system.simulate({"w": w + 1}, (0, 1))
    with pytest.raises(KernelArgumentError, match="waves beyond 2 and 2"):
        system.simulate({"w": w + (-1.0) ** np.arange(8)}, (0, 1))
    with pytest.raises(KernelArgumentError, match="waves beyond 2 and 3"):
        plane(9, 10).simulate({"w": mix((9, 10)) + (-1.0) ** np.arange(10)}, (0, 1))
    assert system.simulate({"w": w}, (0, 1e-3), samples=2).status == "OK"
    with pytest.raises(KernelArgumentError, match="'fourier', which a plane has alone"):
        system.with_derivatives("spectral")
    assert system.with_derivatives("fourier") is system


def test_a_size_that_is_missing_is_asked_for(tmp_path):
    """By both names."""
    text = shipped("euler_2d").path.read_text(encoding="utf-8").replace(", size = 32", "")
    path = tmp_path / "fluid.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(KernelArgumentError, match="'x': 64, 'y': 64"):
        coadjoint.load(path)
    assert coadjoint.load(path, sizes={"x": 8, "y": 9}).counts == (8, 9)


def test_the_system_is_imported_without_what_few_runs_need():
    """As every other one: no NumPy, no reader of specs."""
    code = (
        "import sys; import coadjoint.systems.euler_2d as e; print(e.system); print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    told, modules = done.stdout.splitlines()
    assert "32 x 32 points" in told
    assert {"coadjoint.solve.torus"} <= {*modules.split()}
    assert not {"numpy", "pydantic", "sympy", "scipy"} & {*modules.split()}


def test_an_event_names_a_point_as_rows_do():
    """Counted from 0 along both coordinates; a point that is none is refused."""
    system = euler_2d.system.resize({"x": 16, "y": 12})
    run = system.simulate(None, (0, 1), samples=9, method="scipy:DOP853", rtol=1e-9)
    for place in ("w[3,5]", "w[0, 1]", "w[15,11]"):
        row = system.STATE.rows(place.replace(" ", ""))
        level = float(np.mean(run.state[row]))
        options = {"samples": 2, "method": "scipy:DOP853", "rtol": 1e-9}
        found = system.simulate(None, (0, 1), events=[f"{place} = {level!r}"], **options)
        (event,) = found.events.values()
        assert len(event.time) > 0
        np.testing.assert_allclose(event.state[row], level, rtol=1e-7)
    for place in ("w[16,0]", "w[0,12]", "w[3]"):
        with pytest.raises(KernelArgumentError, match=r"no member .* 0, 0 to 15, 11"):
            system.simulate(None, (0, 1), events=[f"{place} = 0"])
