"""Numbers of the page, in an engine of JavaScript, next to those of the library."""

import json
import math
from functools import cache

import numpy as np
import pytest

from coadjoint.explore.page import assemble
from coadjoint.explore.scene import describe_scene
from coadjoint.methods import Sphere
from coadjoint.render.scripts import render_family_script, render_script
from coadjoint.resources import derivations_folder
from coadjoint.solve.folders import load_texts
from coadjoint.solve.matrix_functions import show_on_sphere, show_on_torus
from coadjoint.solve.methods.spherical_midpoint import Scale
from coadjoint.solve.normals import draw_normals, normal_of
from coadjoint.spec import read_spec
from tests import specs

racers = pytest.importorskip("py_mini_racer", reason="mini-racer is not installed")


class Page:
    """What a page computes before it draws: the kernel of a system, and what is made of it."""

    def __init__(self, rendered, spec):
        self.scene, family = describe_scene(spec, rendered), rendered.family
        kernel = render_family_script(family.context) if family else render_script(rendered.context)
        text = assemble(self.scene, kernel).split("<script>")[1].split("const scene =")[0]
        self.engine = racers.MiniRacer()
        self.engine.eval(f"{text}\nconst scene = {json.dumps(self.scene)};")

    def run(self, body, **given):
        """What the body of a function returns, with names for values."""
        names = "".join(f"const {name} = {json.dumps(value)};" for name, value in given.items())
        return json.loads(
            self.engine.eval(
                f"(() => {{ {names} return JSON.stringify((() => {{ {body} }})()); }})()"
            )
        )


@cache
def open_page(name):
    """The page of a shipped system."""
    return Page(specs.rendered(name), specs.shipped(name))


@pytest.fixture(scope="module")
def noisy():
    """The page of a body with noise."""
    return open_page("stochastic_rigid_body")


def test_words_are_the_published_ones(noisy):
    """Philox4x32-10 of Salmon and others: counters and keys of zeros, of ones, and of pi."""
    known = [
        ([0] * 4, [0] * 2, "6627e8d5 e169c58d bc57ac4c 9b00dbd8"),
        ([0xFFFFFFFF] * 4, [0xFFFFFFFF] * 2, "408f276d 41c83b0e a20bc7c6 6d5451fd"),
        (
            [0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344],
            [0xA4093822, 0x299F31D0],
            "d16cfe09 94fdcceb 5001e420 24126ea1",
        ),
    ]
    for counter, key, words in known:
        found = noisy.run("return philox(counter, key, scene.noise);", counter=counter, key=key)
        assert " ".join(f"{word:08x}" for word in found) == words


def test_normal_numbers_have_the_bits_of_the_library(noisy):
    """By seeds of more than 32 bits, steps and processes; and far out, where logarithms enter."""
    for seed in (1, 2**40 + 7):
        steps = np.array([*range(700), 2**32 - 1, 2**32, 2**40 + 3], dtype=np.uint64)
        found = noisy.run(
            "return steps.map((n) => [0, 1, 2].map((k) => drawNormal(seed, n, k, scene.noise)));",
            steps=steps.tolist(),
            seed=seed,
        )
        wanted = [draw_normals(seed, np.zeros_like(steps), steps, k) for k in range(3)]
        np.testing.assert_array_equal(np.array(found).T, wanted)
        assert 0.9 < np.std(found) < 1.1
    given = np.array([2.0**-53, 1e-12, 1e-6, 0.01, 0.07, 0.0751, 0.3, 0.93, 0.999999, 1 - 2.0**-53])
    found = noisy.run("return given.map((p) => normalOf(p, scene.noise));", given=given.tolist())
    np.testing.assert_array_equal(found, normal_of(given))


WALK = """
  const x = Float64Array.from(start), p = Float64Array.from(parameters);
  const stepper = new NoisyMidpoint(x.length, (x, out) => kernel.rhs(x, p, out),
    (x, out) => kernel.noise(x, p, out), { ...scene.noise, ...change }, spheres);
  stepper.restart(seed);
  for (let n = 0; n < count; n++) if (!stepper.step(x, h)) return null;
  return [...x];
"""


@pytest.mark.parametrize("method", ["midpoint", "auto"])
def test_a_path_with_noise_has_the_bits_of_the_library(noisy, method):
    """Step by step that of `simulate`; a table that is spoiled in its last digit is seen."""
    start, h, count, seed = [0.3, 2.0, -0.5], 1 / 64, 200, 5
    spheres = noisy.scene["spheres"] if method == "auto" else []
    with load_texts(specs.rendered("stochastic_rigid_body").texts) as system:
        given = {"parameters": system.pack().tolist(), "h": h, "start": start, "change": {}}
        run = system.simulate(
            start, (0.0, h * count), method=method, step=h, seed=seed, samples=count + 1,
            target="numpy", progress=False,
        )  # fmt: skip
    given |= {"spheres": spheres}
    assert noisy.scene["methods"][0]["name"] == "spherical_midpoint"
    path = [noisy.run(WALK, count=n, seed=seed, **given) for n in (1, 2, 50, count)]
    np.testing.assert_array_equal(path, run.state[:, [1, 2, 50, count]].T)
    np.testing.assert_allclose((np.array(path) ** 2).sum(axis=1), 4.34, rtol=1e-13)
    assert noisy.run(WALK, count=count, seed=seed + 1, **given) != path[-1]
    middle = [list(each) for each in noisy.scene["noise"]["middle"]]
    middle[0][0] = math.nextafter(middle[0][0], 4.0)
    spoiled = {**given, "change": {"middle": middle}}
    assert noisy.run(WALK, count=count, seed=seed, **spoiled) != path[-1]


SCALES = """
  const scale = new Scale(x, [[3, 4, 5], [0, 1, 2]], scene.noise), next = new Float64Array(6);
  for (let n = 0; n < count; n++) {
    next.set(x.map((v, i) => v + rise[i]));
    scale.apply(x, rise, next);
  }
  return [...next, scale.scale, scale.slope, scale.isRoot() ? 1 : 0];
"""


def test_quotients_of_dual_lengths_have_the_bits_of_the_library(noisy):
    """Of a heavy top's Gamma with its momentum: two sweeps are no solution, seven are."""
    generator = np.random.default_rng(3)
    x, rise = generator.normal(size=6), 0.05 * generator.normal(size=6)
    for count in (1, 2, 7):
        scale = Scale(x[:, None], 0 * x[:, None], Sphere((3, 4, 5), (0, 1, 2)))
        for _ in range(count):
            following = (x + rise)[:, None]
            scale.apply(x[:, None], rise[:, None], following)
        wanted = [*following[:, 0], *scale.scale, *scale.slope, *scale.is_root()]
        given = {"x": x.tolist(), "rise": rise.tolist(), "count": count}
        assert noisy.run(SCALES, **given) == [float(each) for each in wanted]
        assert bool(wanted[-1]) is (count > 2)
    length = np.linalg.norm(following[3:6, 0])
    np.testing.assert_allclose(length, np.linalg.norm(x[3:6]), rtol=1e-15)


def test_an_equation_of_a_step_without_a_solution_ends_the_path(noisy):
    """What two sweeps have not solved is no step."""
    with load_texts(specs.rendered("stochastic_rigid_body").texts) as system:
        given = {"start": [1, 2, 3], "parameters": system.pack().tolist(), "seed": 1, "h": 0.1}
    given |= {"spheres": []}
    assert noisy.run(WALK, count=1, change={"sweeps": 2}, **given) is None
    assert noisy.run(WALK, count=1, change={}, **given) is not None


CIRCLE = """
  const re = new Float64Array(2 + 3 * n), im = re.slice(), at = (k) => 2 + 3 * k;
  a.forEach((v, k) => { re[at(k)] = v; im[at(k)] = b[k]; });
  new Circle(n).transform(re, im, 2, 3, sign);
  return [re, im].map((each) => a.map((_, k) => each[at(k)]));
"""


@pytest.mark.parametrize("n", [1, 2, 3, 4, 6, 8, 17, 30, 32, 64])
def test_sums_over_a_circle_are_fourier_transforms(noisy, n):
    """In both directions, of numbers that stand apart, for powers of two and primes."""
    rng = np.random.default_rng(n)
    z = rng.normal(size=n) + 1j * rng.normal(size=n)
    found = noisy.run(CIRCLE, a=z.real.tolist(), b=z.imag.tolist(), n=n, sign=-1)
    np.testing.assert_allclose(found[0] + 1j * np.array(found[1]), np.fft.fft(z), atol=1e-13 * n)
    back, _ = noisy.run(CIRCLE, a=found[0], b=found[1], n=n, sign=1)
    np.testing.assert_allclose(np.array(back) / n, z.real, atol=1e-13 * n)


RING = """
  const x = Float64Array.from(start), p = Float64Array.from(parameters), points = scene.members;
  const call = (name, x, out) => kernel[name](x, p, points, out);
  const along = (x, v, out) => call("jacobian_vector", Float64Array.from([...x, ...v]), out);
  const rates = (x, out) => call("rhs", x, out);
  const stepper = new RingMidpoint(points, x.length / points, rates, along);
  const sweeps = [];
  for (let n = 0; n < count; n++) sweeps.push(stepper.step(x, h));
  return [[...x], sweeps];
"""


@pytest.mark.parametrize(("name", "h"), [("kdv", 0.005), ("landau_lifshitz", 0.01)])
def test_steps_of_a_field_around_a_circle_are_midpoints(name, h):
    """The state solves the equation of a step, at lengths at which plain sweeps part."""
    page = open_page(name)
    with load_texts(specs.rendered(name).texts) as system:
        start = np.concatenate([np.ravel(v) for v in page_start(page)])
        given = {"start": start.tolist(), "parameters": system.pack().tolist(), "h": h}
        found, sweeps = page.run(RING, count=1, **given)
        middle, step = (start + found) / 2, np.subtract(found, start)
        wanted = h * np.ravel(system.rhs(middle, target="numpy"))
        wave = np.resize([1.0, 1.0, -1.0, -1.0], len(start))
        stiff = h * np.abs(system.jacobian_vector(middle, wave)).max()
    assert stiff > 2.0  # sweeps by the rates alone would part
    np.testing.assert_allclose(step, wanted, atol=1e-10 * np.abs(step).max())
    assert 0 < sweeps[0] < 30
    if name == "kdv":  # in which waves steepen
        _, sweeps = page.run(RING, count=1, **{**given, "h": 100 * h})
        assert sweeps == [0]


def page_start(page):
    """Where fields of a page begin: as declared."""
    return [each["default"] for each in page.scene["tables"]["state"]]


def test_complex_matrices_are_inverted(noisy):
    """Of three rows, the first pivot of which is zero."""
    matrix = np.array([[0, 2, 1j], [1 - 1j, 0.5, 3], [2, 1j, -1]])
    rows = [[part for z in row for part in (z.real, z.imag)] for row in matrix]
    found = np.array(noisy.run("return invert(rows, 3);", rows=rows))
    np.testing.assert_allclose(found[:, ::2] + 1j * found[:, 1::2], np.linalg.inv(matrix))


PLANE = """
  const plane = new PlaneField(scene.plane);
  const x = Float64Array.from(state), p = Float64Array.from(parameters);
  plane.trim(x);
  const of = (name, size) => [...plane.call(name, x, p, new Float64Array(size))];
  return [[...x], of("rhs", x.length), of("energy", 1), of("observables", 3)];
"""


def test_a_field_in_a_plane_moves_as_by_the_library():
    """Of random waves in a plane that is longer than wide, with other numbers of points."""
    spec = read_spec(derivations_folder() / "euler_2d.toml", {"x": 12, "y": 20})
    page = Page(specs.render_claims(spec), spec)
    rng, parameters = np.random.default_rng(2), [5.0, 7.5]
    given = rng.normal(size=240)
    state, rates, energy, kept = page.run(PLANE, state=given.tolist(), parameters=parameters)
    waves = np.fft.fft2(np.reshape(given, (12, 20)))
    x, y = np.fft.fftfreq(12, 1 / 12)[:, None], np.fft.fftfreq(20, 1 / 20)
    waves[(np.abs(x) > 3) | (np.abs(y) > 6) | ((x == 0) & (y == 0))] = 0  # 3 K < N
    np.testing.assert_allclose(state, np.fft.ifft2(waves).real.ravel(), atol=1e-13)
    with load_texts(specs.rendered("euler_2d").texts) as system:
        resized = system.resize({"x": 12, "y": 20})
        for name, found in (("rhs", rates), ("energy", energy), ("observables", kept)):
            wanted = getattr(resized, name)(np.array(state), parameters)
            np.testing.assert_allclose(found, np.ravel(wanted), rtol=1e-11, atol=1e-12)
    turned, *_ = page.run(PLANE, state=given[::-1].tolist(), parameters=parameters)
    assert np.abs(np.array(turned) - state).max() > 0.1


def test_factors_of_an_operator_are_evaluated(noisy):
    """Numbers, rows of parameters, operations of two parts, powers and functions."""
    tree = ["+", ["*", 2.0, ["^", {"row": 1}, -2]], ["-", 0.0, ["/", ["sqrt", {"row": 0}, 0.0], 3]]]
    found = noisy.run("return evaluate(tree, [9, 4]);", tree=tree)
    assert found == 2 / 16 - 1


@pytest.mark.parametrize("name", ["zeitlin_su_n", "zeitlin_torus"])
def test_matrices_are_shown_as_the_functions_that_they_stand_for(name):
    """On both surfaces by the functions of the library; weights have seven digits."""
    page, rows = open_page(name), 17
    entries = np.random.default_rng(rows).normal(size=(rows, rows))
    made = (
        "MatrixOnSphere(scene.matrix, scene.towers)"
        if name == "zeitlin_su_n"
        else "MatrixOnTorus(scene.matrix)"
    )
    found = page.run(
        f"const shown = new {made}; return [[...shown.show(entries)], shown.counts];",
        entries=entries.ravel().tolist(),
    )
    values = np.reshape(found[0], found[1])
    if name == "zeitlin_torus":
        np.testing.assert_allclose(values, show_on_torus(entries), atol=1e-12)
        return
    longitudes, latitudes = (np.pi * ((np.arange(k) + 0.5) / 64 - k / 128) for k in found[1])
    wanted = show_on_sphere(entries, np.sin(latitudes), longitudes)
    np.testing.assert_allclose(values.T, wanted, atol=1e-5 * np.abs(wanted).max())
    assert np.abs(wanted).max() > 1


TURNED = """
  const x = Float64Array.from(start), p = new Float64Array(0);
  const call = (name, x, out) => kernel[name](x, p, scene.members, out);
  const rates = (x, out) => call("rhs", x, out);
  const stepper = new Stepper(x.length, rates, { name: method, schedule: [] }, [], call);
  for (let n = 0; n < count; n++) stepper.step(x, h);
  return [...x];
"""


@pytest.mark.parametrize("name", ["zeitlin_su_n", "zeitlin_torus"])
def test_steps_of_matrices_keep_their_eigenvalues(name):
    """They end where those of `simulate` do; those of Runge and Kutta change eigenvalues."""
    page = open_page(name)
    assert page.scene["methods"][0]["name"] == "isospectral_midpoint"
    h, count = 0.2, 10
    (variable,) = page.scene["tables"]["state"]
    start = np.array(variable["default"])

    def spectrum(x):
        n = page.scene["matrix"]
        real = np.reshape(x, (n, n))
        return np.linalg.eigvalsh((real + real.T) / 2 - 1j * (real - real.T) / 2)

    found, other = (
        np.array(page.run(TURNED, start=start.tolist(), method=method, h=h, count=count))
        for method in ("isospectral_midpoint", "rk4")
    )
    with load_texts(specs.rendered(name).texts) as system:
        run = system.simulate(
            start, (0.0, h * count), method="isospectral_midpoint", step=h, samples=1,
            target="numpy", progress=False,
        )  # fmt: skip
    np.testing.assert_allclose(found, np.ravel(run.state[:, -1]), atol=1e-12)
    assert np.abs(spectrum(found) - spectrum(start)).max() < 1e-13
    assert np.abs(spectrum(other) - spectrum(start)).max() > 1e-11
    assert np.abs(found - start).max() > 0.01
