"""Fields on a grid: central differences, and the motion of the points."""

import re
from dataclasses import replace
from fractions import Fraction
from math import perm

import numpy as np
import pytest
import sympy

from coadjoint.derive import derive
from coadjoint.derive.fields import profiles
from coadjoint.derive.fields.grid import make_grid
from coadjoint.derive.fields.jets import DEGREE, Jets, list_rows, narrow
from coadjoint.derive.fields.lattice import Calculus
from coadjoint.derive.fields.profiles import sample_profiles
from coadjoint.derive.fields.stencils import find_largest, stencil, width_of
from coadjoint.derive.fields.torus import make_torus
from coadjoint.derive.reference import Reference
from coadjoint.errors import DerivationError, KernelArgumentError, ResourceError
from coadjoint.exact import Field
from coadjoint.prove import prove
from coadjoint.spec import read_spec_text
from tests.families import family_of
from tests.fields import (
    breaking_wave,
    cnoidal_wave,
    family_by_order,
    fields_by_order,
    find_rates,
    grid_of,
    helix,
    precessing_wave,
    smooth_length,
    smooth_wave,
)
from tests.specs import shipped

ORDERS = (2, 4, 6, 8)


@pytest.mark.parametrize("derivative", [1, 2, 3, 4])
@pytest.mark.parametrize("order", ORDERS)
def test_stencils_are_those_of_interpolation(derivative, order):
    """SymPy's weights on as many points (Fornberg 1988), and symmetric or antisymmetric."""
    width = width_of(derivative, order)
    places = list(range(-width, width + 1))
    weights = sympy.finite_diff_weights(derivative, places, 0)[-1][-1]
    found = stencil(derivative, order)
    assert [sympy.Rational(str(found.get(r, 0))) for r in places] == list(weights)
    assert all(found[-r] == (-1) ** derivative * c for r, c in found.items())
    assert len(found) >= 2


def test_stencils_are_those_that_books_print():
    """Of order 8: 4/5, -1/5, 4/105, -1/280."""
    printed = ("4/5", "-1/5", "4/105", "-1/280")
    assert [stencil(1, 8)[r] for r in range(1, 5)] == [Fraction(x) for x in printed]


@pytest.mark.parametrize("derivative", [1, 2, 3, 4])
@pytest.mark.parametrize("order", ORDERS)
def test_stencils_multiply_no_wave_by_more_than_is_said(derivative, order):
    """The largest eigenvalue of a circulant matrix of many rows, to five digits."""
    row = np.zeros(1 << 12)
    for r, c in stencil(derivative, order).items():
        row[r] = float(c)
    largest = np.abs(np.fft.fft(row)).max()
    assert find_largest(derivative, order) == pytest.approx(largest, rel=1e-5)


@pytest.mark.parametrize("order", ORDERS)
def test_differences_of_polynomials_are_derivatives(order):
    """Of degrees below k + p exactly, with h = 2/5 at s = 6/5, and not of the next one."""
    calculus = Calculus(order=order, inverse=Fraction(5, 2), number=Fraction)
    for k in range(5):
        for n in range(k, k + order + 1):
            found = calculus.differentiate(lambda i, n=n: Fraction(2 * i, 5) ** n, k)(3)
            assert (found == perm(n, k) * Fraction(6, 5) ** (n - k)) == (n < k + order or k == 0)


def test_differences_of_slopes_have_the_signs_of_sums_by_parts():
    """F - D g + D_2 h for the slopes f = 5, g = s^2 and h = s^3 is 5 - 2 s + 6 s, by hand."""
    calculus = Calculus(order=2, inverse=Fraction(5, 2), number=Fraction)
    powers = [lambda i, n=n: Fraction(2 * i, 5) ** n for n in range(4)]
    vary = calculus.vary([lambda i: 5 * powers[0](i), powers[2], powers[3]])
    assert vary(3) == 5 + 4 * Fraction(6, 5)


def test_products_of_derivatives_are_summed_by_parts():
    """u_s v_ss becomes -u v_sss; what has a factor that is a field stays."""
    rows = {x: list_rows(x, ["s"], 4) for x in "uv"}
    names = [name for (tower,) in rows.values() for name in tower]
    jets = Jets(Field([*names, "c", DEGREE]), rows)
    u, u_s, v_ss, v_sss, c = (jets.field[x] for x in ("u", "u_s", "v_ss", "v_sss", "c"))
    assert narrow(jets, c * u_s * v_ss) == -c * u * v_sss
    assert narrow(jets, u * u_s**2) == u * u_s**2
    assert narrow(jets, u_s) == u_s


def waves():
    """Exact solutions with the system that they solve, parameters, and numbers of points.

    The precessing wave tests the sign of [Xi, Omega], to which equal fields are blind. Of order 8
    fewer points are taken: with more the error is that of rounding.
    """
    return {
        "spin_chain_chiral": (precessing_wave, 10.0, [10.0], (64, 128), (32, 64)),
        "landau_lifshitz": (helix, 20.0, [0, 0, 0.6, 0, 0, 0.3, 20.0], (64, 128), (32, 64)),
        "kdv": (cnoidal_wave, 12.0, [1.3, 12.0], (80, 160), (72, 96)),
        "camassa_holm": (
            smooth_wave,
            smooth_length(),
            [0.9, smooth_length()],
            (64, 128),
            (96, 128),
        ),
        "hunter_saxton": (breaking_wave, 7.0, [7.0], (96, 192), (96, 128)),
    }


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("name", waves())
def test_rates_of_exact_waves_converge_as_claimed(name, order):
    """The error of the rates falls with the spacing to the power of the order, within 0.1."""
    solution, length, parameters, *counts = waves()[name]
    family, errors = family_by_order(name, order), []
    counts = counts[order == 8]
    for N in counts:
        fields, rates = solution(np.arange(N) * length / N, 0.3)
        errors.append(np.abs(find_rates(family, fields, parameters) - rates).max())
    assert errors[1] > 0
    measured = np.log(errors[0] / errors[1]) / np.log(counts[1] / counts[0])
    assert abs(measured - order) < 0.1


def test_waves_see_a_wrong_sign():
    """With Xi -> -Xi in the rates the precessing wave is no solution: the check above can fail."""
    solution, length, parameters, (N, _), _ = waves()["spin_chain_chiral"]
    fields, rates = solution(np.arange(N) * length / N, 0.3)
    spoiled = fields * np.array([1, 1, 1, -1, -1, -1])[:, None]
    found = find_rates(grid_of("spin_chain_chiral").family, spoiled, parameters)
    assert np.abs(found - rates).max() > 0.1


def test_small_waves_disperse_as_the_chain_says():
    """About zero omega^2 = K/I k^2, with the symbol (8 sin kh - sin 2kh)/(6h) for k."""
    N, L, n, eps = 32, 10.0, 3, 1e-7
    I, K = np.array([1.0, 2.0, 3.0]), np.array([3.0, 2.0, 1.0])  # noqa: E741
    s, k = np.arange(N) * L / N, 2 * np.pi * n / L
    h = L / N
    symbol = (8 * np.sin(k * h) - np.sin(2 * k * h)) / (6 * h)
    for axis in range(3):
        omega = np.sqrt(K[axis] / I[axis]) * symbol
        fields = np.zeros((6, N))
        fields[axis] = eps * np.cos(k * s)  # Pi
        rates = find_rates(grid_of("spin_chain").family, fields, [*I, *K, L])
        np.testing.assert_allclose(
            rates[3 + axis], -eps * np.sin(k * s) * symbol / I[axis], atol=1e-15
        )
        second = find_rates(grid_of("spin_chain").family, rates, [*I, *K, L])
        np.testing.assert_allclose(second[axis], -(omega**2) * fields[axis], atol=2e-13)


def test_the_lattice_of_spins_is_the_magnet_in_order_two():
    """Heisenberg's lattice is the thread with differences of order 2, J = 1/h^2, time reversed.

    Both generic members, one with the plus and the other with the minus bracket: S_i x (S_{i-1} +
    S_{i+1}) J with opposite signs, since S x S = 0.
    """
    lattice = family_of(shipped("heisenberg_lattice"))
    thread = family_by_order("landau_lifshitz", 2)
    names = {s: sympy.Symbol(s.name) for s in thread.states}
    free = {sympy.Symbol(f"{x}{n}"): 0 for x in "aB" for n in (1, 2, 3)}
    spacing = {sympy.Symbol("J"): sympy.Symbol("N") ** 2 / sympy.Symbol("L") ** 2}
    assert [*names.values()] == [*lattice.states]
    for one, other in zip(lattice.rates, thread.rates, strict=True):
        assert sympy.expand(one.xreplace(spacing) + other.xreplace(free)) == 0
        assert other.xreplace(free) != 0


def test_the_lattice_of_spins_tends_to_the_magnet():
    """Taylor's expansion of the shipped lattice: -J a^2 (S x S_ss + a^2/12 S x S_ssss + ...)."""
    lattice, a = family_of(shipped("heisenberg_lattice")), sympy.Symbol("a")
    jets = {s: [sympy.Symbol(f"{s}_{k}") for k in range(7)] for s in lattice.states}
    new = {s: tower[0] for s, tower in jets.items()}
    for (component, shift), symbol in lattice.neighbours.items():
        terms = (jets[component][k] * (shift * a) ** k / sympy.factorial(k) for k in range(7))
        new[symbol] = sympy.Add(*terms)
    S, S_ss, S_4 = (sympy.Matrix([jets[s][k] for s in lattice.states]) for k in (0, 2, 4))
    expected = sympy.Symbol("J") * (S.cross(S_ss) * a**2 + S.cross(S_4) * a**4 / 12)
    for rate, known in zip(lattice.rates, expected, strict=True):
        series = sympy.expand(rate.xreplace(new))
        low = sum(series.coeff(a, k) * a**k for k in range(6))
        assert sympy.expand(low - known) == 0
        assert low != 0


def test_rings_are_the_matrices_of_the_bracket():
    """A ring of KdV by hand: -(m D m + D(m m)) - c D3 m with circulant matrices."""
    ring = grid_of("kdv").windows[0]
    N = len(ring.setting.state)
    source, order = np.random.default_rng(0), shipped("kdv").space.order
    m, c, L = source.normal(size=N), 0.7, 3.0
    D, D3 = (
        sum(float(x) * np.roll(np.eye(N), r, axis=1) for r, x in stencil(k, order).items())
        * (N / L) ** k
        for k in (1, 3)
    )
    given = dict(zip(ring.setting.state, m.tolist(), strict=True)) | {"c": c, "L": L}
    found = Reference(ring).evaluate("rhs", given, float, lambda *_: 0.0)
    np.testing.assert_allclose(found, -(m * (D @ m) + D @ (m * m)) - c * D3 @ m, rtol=1e-11)
    assert grid_of("kdv").family.small <= N
    # no neighbour is another one, and a second number shows how rates depend on it
    sizes = [len(each.setting.state) for each in grid_of("kdv").windows]
    assert sizes == [2 * width_of(3, order) + 1, 2 * width_of(3, order) + 2]


def test_profiles_are_sampled_to_rounding():
    """The default of KdV is the cosine over 3 at each point."""
    spec = shipped("kdv")
    few, none = (replace(spec, space=replace(spec.space, size=n)) for n in (8, None))
    (values,) = sample_profiles(few)["m"]
    expected = np.cos(2 * np.pi * np.arange(8) / 8) / 3
    np.testing.assert_allclose([float(x) for x in values], expected, atol=1e-16)
    assert sample_profiles(none) == {}


def test_profiles_of_a_line_and_of_a_plane_are_sampled_in_their_order():
    """A line has a point at s = L; in a plane y runs first, along which the cosine has 4 points."""
    text = shipped("spin_chain").path.read_text(encoding="utf-8")
    line = re.sub(r"s = {.*", 's = { length = "L", size = 5, order = 2, ends = "free" }', text)
    line = line.replace('"energy", "P"]', '"energy"]')
    values = sample_profiles(read_spec_text(line, "line.toml"))["Pi"][0]
    np.testing.assert_allclose([float(x) for x in values], [1, 0, -1, 0, 1], atol=1e-15)
    text = shipped("euler_2d").path.read_text(encoding="utf-8")
    plane = re.sub(r'\nw = ".*', '\nw = "3*cos(2*pi*x/Lx) + cos(2*pi*y/Ly)"', text)
    plane = plane.replace('"Lx", size = 32', '"Lx", size = 2').replace("size = 32", "size = 4")
    (values,) = sample_profiles(read_spec_text(plane, "plane.toml"))["w"]
    assert [round(float(x), 14) for x in values] == [4, 3, 2, 3, -2, -3, -4, -3]


def test_profiles_are_evaluated_to_many_digits():
    """A square and its terms cancel at a tenth of the way, and a root is a power."""
    text = shipped("kdv").path.read_text(encoding="utf-8")
    for formula, part, known in (
        ("(1 + s/L)^2 - 1 - 2*s/L - (s/L)^2", 10, 0.0),
        ("2^(s/L)", 2, 2**0.5),
    ):
        spec = read_spec_text(text.replace('"cos(2*pi*s/L)/3"', f'"{formula}"'), "kdv.toml")
        (found,) = profiles.evaluate_profile(spec, "m", Fraction(1, part))
        assert abs(float(found) - known) < 1e-40 + 1e-15 * known


def test_a_wave_of_camassa_and_holm_is_one_by_fourier_series():
    """The wave by quadrature solves m_t = -(m u_s + (m u)_s) with u = (1 + alpha^2 k^2)^-1 m."""
    N, L = 64, smooth_length()
    (m,), (rate,) = smooth_wave(np.arange(N) * L / N, 0.3)
    k = 2 * np.pi / L * np.fft.rfftfreq(N, 1 / N)
    u = np.fft.irfft(np.fft.rfft(m) / (1 + 0.9**2 * k**2), N)
    slope = lambda f: np.fft.irfft(1j * k * np.fft.rfft(f), N)  # noqa: E731
    np.testing.assert_allclose(-(m * slope(u) + slope(m * u)), rate, atol=1e-13)
    assert np.ptp(m) > 0.3


def test_a_wave_of_hunter_and_saxton_is_one_by_fourier_series():
    """The wave by particles solves m_t = -(m u_s + (m u)_s) with u = m/k^2 of mean 0."""
    N, L = 128, 7.0
    (m,), (rate,) = breaking_wave(np.arange(N) * L / N, 0.3)
    k = 2 * np.pi / L * np.fft.rfftfreq(N, 1 / N)
    modes = np.fft.rfft(m)
    assert abs(modes[0]) < 1e-12
    u = np.fft.irfft(np.concatenate([[0], modes[1:] / k[1:] ** 2]), N)
    slope = lambda f: np.fft.irfft(1j * k * np.fft.rfft(f), N)  # noqa: E731
    np.testing.assert_allclose(-(m * slope(u) + slope(m * u)), rate, atol=1e-12)
    assert np.ptp(m) > 0.3


@pytest.mark.parametrize("order", ORDERS)
def test_a_level_velocity_is_that_of_the_whole_matrix(order):
    """-D_2 u is m without its mean, and the mean of u is 0, for m that have one."""
    grid = make_grid(fields_by_order("hunter_saxton", order))
    (equation,), ring = grid.family.solved, grid.windows[0]
    field, size = ring.setting.field, len(ring.setting.state)
    weight = field.number(size) ** 2 / field["L"] ** 2
    u = [grid.velocities[size]["u", i] for i in range(size)]
    m = [field[name] for name in ring.setting.state]
    mean = field.sum(m) * Fraction(1, size)
    assert field.is_zero(field.sum(u))
    for i in range(size):
        terms = (u[(i + r) % size] * weight * c for r, c in stencil(2, order).items())
        assert field.is_zero(field.sum(terms) + m[i] - mean)
    assert equation.level
    assert len(equation.factors) == order // 2


@pytest.mark.parametrize("order", ORDERS)
def test_the_velocity_of_a_ring_solves_its_equation(order):
    """A u = m with circulant matrices of 1 - alpha^2 D_2, by exact numbers."""
    grid = make_grid(fields_by_order("camassa_holm", order))
    (equation,), ring = grid.family.solved, grid.windows[0]
    field, size = ring.setting.field, len(ring.setting.state)
    values = {name: field[name] for name in ("alpha", "L")} | {"N": field.number(size)}
    weight = values["alpha"] ** 2 * values["N"] ** 2 / values["L"] ** 2
    for i in range(size):
        terms = (
            grid.velocities[size]["u", (i + r) % size] * ((r == 0) - weight * c)
            for r, c in stencil(2, order).items()
        )
        assert field.is_zero(field.sum(terms) - field[ring.setting.state[i]])
    assert len(equation.factors) == 1 + order // 2


@pytest.mark.parametrize(
    ("name", "old", "new", "message"),
    [
        ("kdv", "size = 256", "size = 4", r"of s of kdv is 4; expected .* at least 9, from which"),
        ("euler_2d", "size = 32", "size = 3", r"of x of euler_2d is 3; expected .* at least 4"),
    ],
)
def test_too_few_points_of_a_spec_are_refused(name, old, new, message):
    """As those that are chosen, with the file; the least number is accepted."""
    text = shipped(name).path.read_text(encoding="utf-8")
    spec = read_spec_text(text.replace(old, new), f"{name}.toml")
    make = make_torus if spec.in_plane else make_grid
    with pytest.raises(KernelArgumentError, match=rf"^{name}\.toml: the size {message}") as found:
        make(derive(spec))
    assert found.value.exit_status == 2
    enough = text.replace(old, f"size = {found.value.expected}")
    assert make(derive(read_spec_text(enough, f"{name}.toml"))).family.totals


def test_points_of_a_spec_beyond_the_memory_are_refused_where_it_is_read():
    """Of this machine, and of what works on a spec; the advice is to choose them later."""
    text = shipped("kdv").path.read_text(encoding="utf-8")
    for size, message in (
        (10**12, "10{12} rows at the size of s that is chosen, which take about 1000000.0 GB"),
        (2 * 10**6, r"2000000 rows at .* half of the 2\.1 GB in which a spec .* Declare a smaller"),
    ):
        with pytest.raises(ResourceError, match=message):
            read_spec_text(text.replace("size = 256", f"size = {size}"), "kdv.toml")
    plane = shipped("euler_2d").path.read_text(encoding="utf-8")
    with pytest.raises(ResourceError, match=r"10{12} rows at the size of x and y"):
        read_spec_text(plane.replace("size = 32", f"size = {10**6}"), "euler_2d.toml")


@pytest.mark.parametrize("pole", ["1/s", "1/(s - s)", "log(s)", "sqrt(s - L/2)"])
def test_a_profile_without_a_value_at_the_first_point_is_refused(pole):
    """With its line and its name; one with a pole elsewhere depends on the number of points."""
    text = shipped("kdv").path.read_text(encoding="utf-8")
    old = '"cos(2*pi*s/L)/3"'
    line = text[: text.index(old)].count("\n") + 1
    message = rf"^kdv\.toml:{line}: profiles\.m: the profile of m has no value at s = 0; expected"
    with pytest.raises(DerivationError, match=message):
        make_grid(derive(read_spec_text(text.replace(old, f'"{pole}"'), "kdv.toml")))
    assert make_grid(derive(read_spec_text(text.replace(old, '"1/(s - 1)"'), "kdv.toml")))


def test_a_grid_does_not_look_at_each_point(monkeypatch):
    """Profiles are formulas: their values at many points are asked for by nobody, but the first."""
    evaluate, looked = profiles.evaluate_profile, list[Fraction]()

    def count(spec, name, *parts):
        looked.extend(parts)
        return evaluate(spec, name, *parts)

    monkeypatch.setattr(profiles, "evaluate_profile", count)
    text = shipped("kdv").path.read_text(encoding="utf-8")
    spec = read_spec_text(text.replace("size = 256", "size = 100000"), "kdv.toml")
    assert prove(spec).require().claims
    assert looked == [0]
