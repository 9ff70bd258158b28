"""The page in headless Chromium: what is on its canvas and in it, hands, keys, accessibility."""

import json
import os
import re
from pathlib import Path

import numpy as np
import pytest

from coadjoint.explore.page import render_page
from coadjoint.notation.names import name as symbol
from coadjoint.pipeline import render
from coadjoint.resources import derivations_folder
from coadjoint.solve.folders import load_texts
from coadjoint.spec import read_spec
from tests.explore.browser import CHROMIUM, browser

pytestmark = [
    pytest.mark.campaign,
    pytest.mark.skipif(
        not CHROMIUM, reason="no Chromium on this machine: apt-get install chromium"
    ),
]

SHOWN = (
    "rigid_body",
    "heavy_top",
    "heavy_top_kovalevskaya",
    "kirchhoff",
    "chaplygin_ball",
    "euler_disk",
    "rattleback",
    "snakeboard",
    "kepler",
    "monopole_kepler",
    "quadrotor",
    "spin_chain",
    "kdv",
    "double_spherical_pendulum",
    "point_vortices",
    "sphere_vortices",
    "n_body",
    "peakons",
    "toda_lattice",
    "heisenberg_lattice",
    "stochastic_rigid_body",
    "euler_2d",
    "zeitlin_su_n",
    "zeitlin_torus",
)
#: Colours on the canvas of the scene, where something is drawn, in steps of 16.
COLOURS = """(() => {
  const canvas = document.getElementById("scene");
  explorer.paint();
  const copy = document.createElement("canvas");
  Object.assign(copy, { width: 160, height: 120 });
  const pen = copy.getContext("2d");
  pen.drawImage(canvas, 0, 0, 160, 120);
  const data = pen.getImageData(0, 0, 160, 120).data, colours = new Set();
  let sum = 0;
  for (let k = 0; k < data.length; k += 4) {
    const [r, g, b, a] = data.subarray(k, k + 4);
    if (a > 200) colours.add((r >> 4) * 256 + (g >> 4) * 16 + (b >> 4));
    sum = (sum * 31 + data[k] + 7 * data[k + 1] + 13 * data[k + 2]) % 4294967291;
  }
  return [colours.size, sum];
})()"""


@pytest.fixture(scope="module")
def page():
    """A page of a browser."""
    with browser() as opened:
        yield opened


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The page of a system as a file, made once."""
    folder, made = tmp_path_factory.mktemp("pages"), {}

    def make(name):
        if name not in made:
            spec = read_spec(derivations_folder() / f"{name}.toml")
            made[name] = folder / f"{name}.html"
            made[name].write_text(render_page(spec, render(spec)))
        return made[name]

    return make


def show(page, path, **preferences):
    """Load a page and wait for its first frames."""
    page.problems.clear()
    page.asked.clear()
    page.resize(preferences.pop("width", 1200), preferences.pop("height", 800), **preferences)
    page.open(path)
    page.wait("globalThis.explorer && explorer.frames() > 7")


@pytest.mark.parametrize("name", SHOWN)
def test_a_page_draws_what_moves_without_errors(page, pages, name):
    """No console error and no request; the canvas shows more than a floor, and changes."""
    show(page, pages(name))
    colours, first = page.run(COLOURS)
    clock, frames = page.run("[explorer.model.clock[0], explorer.frames()]")
    page.wait(f"explorer.model.clock[0] > {clock + 0.05} && explorer.frames() > {frames + 1}")
    _, later = page.run(COLOURS)
    assert colours > 8, name
    assert first != later, name
    assert page.run("explorer.model.x.every(Number.isFinite) && explorer.model.ended === ''")
    assert page.run("document.documentElement.scrollWidth <= innerWidth")
    assert page.problems == []
    assert [each for each in page.asked if not each.startswith("file:")] == []


@pytest.mark.parametrize("name", ["heavy_top", "quadrotor", "spin_chain"])
def test_nothing_is_wider_than_a_phone(page, pages, name):
    """On 390 columns nothing goes over the side, and nothing covers the button that runs it."""
    show(page, pages(name), width=390, height=844)
    assert page.run("document.documentElement.scrollWidth") <= 390
    assert page.run(
        "(() => { const b = document.getElementById('play').getBoundingClientRect();"
        "return document.elementFromPoint(b.x + b.width / 2, b.y + b.height / 2).id })()"
    ) == "play"  # fmt: skip


#: The scene's position of a point in space, in pixels of the window.
SPOT = """(p => { const s = explorer.view.drawing.project(p),
  b = document.getElementById('scene').getBoundingClientRect(); return [s.x + b.x, s.y + b.y] })"""

ANGLE = "explorer.model.read(explorer.view.knobs[0].angle)[0]"


@pytest.mark.parametrize(
    ("name", "point", "value"),
    [
        ("roller_racer", "explorer.view.knobs[0].at", ANGLE),
        ("snakeboard", "explorer.view.knobs[0].at", ANGLE),
        ("peakons", "explorer.view.handles()[1]", "explorer.model.x[1]"),
        ("heisenberg_lattice", "explorer.view.handles()[3]", "explorer.model.x[48]"),
        ("spin_chain", "explorer.view.tips[20]", "explorer.model.x[20]"),
        ("camassa_holm", "explorer.view.tips[40]", "explorer.model.x[40]"),
        (
            "double_spherical_pendulum",
            "explorer.view.positions()[1]",
            "explorer.model.x[3]",
        ),
        ("euler_2d", "[0.1, 0.1, 0]", "explorer.model.y[0]"),
        ("n_link_chain", "explorer.view.masses()[2]", "explorer.model.x[2]"),
    ],
)  # fmt: skip
def test_what_is_drawn_can_be_dragged(page, pages, name, point, value):
    """A hand on an angle, a member, a spin or the curve of a field moves state and start."""
    show(page, pages(name), calm=True)
    at, before = page.run(f"{SPOT}({point})"), page.run(value)
    page.mouse("mouseMoved", *at, pressed=False)
    assert page.run("document.getElementById('scene').classList.contains('held')")
    page.drag(at, [at[0] + 30, at[1] - 45])
    after = page.run(value)
    assert abs(after - before) > 1e-2
    assert page.run("explorer.model.x.every(Number.isFinite)")
    page.run("explorer.reset()")
    assert page.run(value) == pytest.approx(after, abs=1e-9)
    assert page.problems == []


def test_a_seed_is_a_path_of_a_body_whose_momentum_rests_in_space(page, pages):
    """The same seed leads to the same state, another one elsewhere; the address holds it."""
    show(page, pages("stochastic_rigid_body"), calm=True)
    space = "rotate(explorer.model.pose(), explorer.model.read(scene.spinning))"
    walk = (
        "explorer.reset(); for (let k = 0; k < 500; k++) explorer.model.step(explorer.model.h);"
        "[...explorer.model.x]"
    )
    at = page.run(space)
    first = page.run(walk)
    np.testing.assert_allclose(page.run(space), at, atol=1e-11)
    page.run("explorer.model.stepper.stretchOf = () => 1")  # as if the middle were on its chord
    assert page.run(walk) == first
    assert np.abs(np.subtract(page.run(space), at)).max() > 1e-6
    page.run("delete explorer.model.stepper.stretchOf")
    page.run("document.getElementById('other').click()")
    assert page.run("location.hash").endswith("&s=2")
    second = page.run(walk)
    assert np.abs(np.subtract(first, second)).max() > 0.1
    page.run("location.hash = location.hash.replace('&s=2', '&s=1')")
    page.wait("document.getElementById('seed').value === '1'")
    assert page.run(walk) == pytest.approx(first, abs=1e-7)  # the address has nine digits
    assert page.problems == []


def test_rods_are_a_linkage_by_their_energy(page, pages):
    """Lengths and masses that sliders choose are found again; rods that are none are directions."""
    show(page, pages("double_spherical_pendulum"), calm=True)
    names = page.run("scene.tables.parameters.map(each => each.name)")
    assert names == ["m1", "m2", "l1", "l2", "g"]
    page.run("explorer.model.p.set([5, 2, 0.6, 1.4, 9.81]); explorer.view.moving()")
    np.testing.assert_allclose(page.run("explorer.view.rods.lengths"), [0.3, 0.7], rtol=1e-9)
    small, large = page.run("explorer.view.rods.sizes")[::-1]
    assert small / large == pytest.approx((2 / 5) ** (1 / 3), rel=1e-9)
    first, second = np.array(page.run("explorer.view.positions()"))
    np.testing.assert_allclose(np.linalg.norm([first, second - first], axis=1), [0.3, 0.7])
    page.run("explorer.model.call = (name, x, out) => (out[0] = x[6] * x[9], out)")
    assert page.run("findRods(explorer.model)") is None  # no mass has such an energy


def test_links_of_a_pendulum_are_found_by_its_last_mass(page, pages):
    """A chain in the plane has the length of the slider; where x is no sum of sines it has none."""
    show(page, pages("n_link_chain"), calm=True)
    page.run("explorer.model.p[1] = 0.7; explorer.view.moving(); explorer.model.observe()")
    np.testing.assert_allclose(page.run("explorer.view.lengths"), [0.7] * 4, rtol=1e-12)
    x, _, z = page.run("explorer.view.masses()[3]")
    np.testing.assert_allclose([x, z], page.run("[...explorer.model.y].slice(1, 3)"), rtol=1e-12)
    page.run("""(() => {
      const { model } = explorer, call = model.call.bind(model);
      model.call = (name, x, out) => { call(name, x, out); out[1] += 0.1 * x[0] ** 2; return out; };
    })()""")
    assert page.run("findLinks(explorer.model)") is None


def test_a_portrait_shows_rows_that_move_or_all_vectors(page, pages):
    """Of su(4) the first three rows are conserved; of so(4) both vectors are drawn."""
    show(page, pages("zeitlin_su_4"), calm=True)
    rows = page.run("explorer.view.parts[0]")
    assert len(set(rows)) == 3
    assert not {0, 1, 2} & set(rows)
    start = page.run("[...explorer.model.x]")
    end = page.run(
        "for (let k = 0; k < 100; k++) explorer.model.step(explorer.model.h); [...explorer.model.x]"
    )
    moved = np.abs(np.subtract(end, start))
    assert moved[:3].max() < 1e-9
    assert moved[rows].min() > 0.1 * moved.max()
    show(page, pages("so4_body"), calm=True)
    assert page.run("explorer.view.parts") == [[0, 1, 2], [3, 4, 5]]
    assert page.run("explorer.view.tips") == ["M", "N"]


def test_a_page_is_as_high_as_its_window(page, pages):
    """Nothing is scrolled in a wide window, and the slider of speed says its value."""
    show(page, pages("rigid_body"), width=1280, height=900)
    assert page.run("document.documentElement.scrollHeight") == 900
    assert page.run("document.getElementById('pace').textContent.replace(/\\s/g, ' ')") == "× 1"
    page.run(
        "Object.assign(document.getElementById('speed'), { value: -1 })"
        ".dispatchEvent(new Event('input'))"
    )
    assert page.run("document.getElementById('pace').textContent.endsWith('0.1')")
    assert page.run("document.getElementById('clock').textContent.startsWith('t = ')")


def test_arrows_of_a_ball_stay_below_the_title(page, pages):
    """With room for their names; a camera that looks lower shows them over the title."""
    show(page, pages("chaplygin_ball"), width=1280, height=800, calm=True)
    highest = """(() => {
      const { view } = explorer;
      explorer.paint();
      return Math.min(...view.labels.map((each) => view.drawing.project(each.tip).y));
    })()"""
    page.wait("explorer.frames() > 30")  # the camera has come to where it follows
    title = page.run("document.querySelector('summary').getBoundingClientRect().bottom")
    assert page.run(highest) > title > 50
    named = "[...document.querySelectorAll('#scene-labels > :not([hidden])')].length"
    assert page.run(named) == 2
    page.run("explorer.view.follow = () => {}")
    page.run("explorer.view.camera.target[2] -= 0.8")
    assert page.run(highest) < title


def test_a_raised_picture_is_met_where_it_is_drawn(page, pages):
    """On a phone a ray through the place of a point on the canvas goes through that point."""
    show(page, pages("kepler"), width=390, height=844, calm=True)
    page.wait("explorer.view.drawing.raised > 0.02")
    away = page.run("""(() => {
      const { view } = explorer, pen = view.drawing, at = [0.3, -0.2, 0.4], s = pen.project(at);
      const d = pen.ray(s.x, s.y);
      return norm(cross(d, unit(minus(at, pen.eye))));
    })()""")
    assert away < 1e-9


@pytest.mark.parametrize("name", ["relativistic_particle", "ball_in_sphere", "kepler"])
def test_the_curve_of_a_velocity_is_that_of_the_velocity(page, pages, name):
    """Whether a velocity is of the state or follows from it, its curve has its rows and names."""
    show(page, pages(name), calm=True)
    shown, wanted = page.run("[explorer.panel.value(), explorer.model.read(scene.speeds[0])]")
    assert shown == wanted
    assert page.run("explorer.panel.names()") == page.run(
        "Object.values(scene.tables).flat().find(each => each.name === scene.speeds[0].name)"
        ".components"
    )


def test_a_top_that_slides_is_a_ball_whose_contact_slips(page, pages):
    """The surface of the tippe top is the sphere of radius r about a point e from its centre."""
    show(page, pages("tippe_top"), calm=True)
    assert page.run("scene.slipping.name") == "slip"
    points = np.array(
        page.run(
            "[[0, 0, 1], [0.6, 0, 0.8], [0, 1, 0], [0.48, 0.6, -0.64]]"
            ".map(up => explorer.model.arm(up))"
        )
    )
    # from the contact to the centre of mass: r Gamma - e e3, with r = 1 and e = 0.2
    ups = np.array([[0, 0, 1], [0.6, 0, 0.8], [0, 1, 0], [0.48, 0.6, -0.64]])
    np.testing.assert_allclose(points, ups - [0, 0, 0.2], atol=1e-12)
    before = page.run("explorer.view.contact()")
    page.run("for (let k = 0; k < 300; k++) explorer.model.step(explorer.model.h)")
    assert np.linalg.norm(np.subtract(page.run("explorer.view.contact()"), before)) > 1e-4


def test_carriages_have_the_lengths_of_their_specs(page, pages):
    """The racer's joint is d1 = 1 before its axle, its second axle d2 = 0.2 behind that."""
    show(page, pages("roller_racer"), calm=True)
    (link,) = page.run("explorer.view.findLinks()")
    assert link["joint"] == pytest.approx(1.0, rel=1e-12)
    assert link["length"] == pytest.approx(0.2, rel=1e-12)
    (wheel,) = page.run("explorer.view.wheels()")
    assert (wheel["at"], wheel["angle"]) == (0, 0)
    page.run("explorer.model.p[explorer.model.p.length - 2] = 1.5")  # d1
    assert page.run("explorer.view.findLinks()[0].joint") == pytest.approx(1.5, rel=1e-12)
    show(page, pages("appell_machine"), calm=True)  # its wheel is rho = 0.3 before the weight
    assert page.run("explorer.view.links") == []
    (wheel,) = page.run("explorer.view.wheels()")
    assert wheel["at"] == pytest.approx(0.3, rel=1e-12)


@pytest.mark.parametrize("name", ["rigid_body", "kirchhoff", "snakeboard"])
def test_labels_stand_within_and_cover_nothing(page, pages, name):
    """Each label is as wide as its text, inside its box, and over no other one nor the title."""
    show(page, pages(name), width=390, height=844)
    page.wait("explorer.model.clock[0] > 0.3")
    page.run("explorer.run(false)")
    page.run("new Promise(requestAnimationFrame)")
    boxes = page.run(
        "[...document.querySelectorAll('.labels')].map(box => [box, ...box.children, "
        "...(box.id === 'scene-labels' ? document.querySelectorAll('h1') : [])]"
        ".filter(each => !each.hidden).map(each => { const b = each.getBoundingClientRect(); "
        "return [b.left, b.top, b.right, b.bottom] }))"
    )
    count = 0
    for frame, *labels in boxes:
        for k, one in enumerate(labels):
            assert one[0] >= frame[0]
            assert one[2] <= frame[2]
            for other in labels[:k]:
                count += 1
                apart = one[0] >= other[2] or other[0] >= one[2]
                assert apart or one[1] >= other[3] or other[1] >= one[3], (one, other)
    assert count >= 1


def test_a_free_body_rolls_on_its_plane_and_shows_components(page, pages):
    """Poinsot: the plane keeps its distance to the centre, and the body does not slip on it."""
    show(page, pages("rigid_body"), calm=True)
    assert page.run("explorer.view.rolls")
    found = page.run("""(() => {
      const { model, view } = explorer, deep = [], slip = [];
      for (let k = 0; k < 400; k++) {
        const at = view.contact(), q = multiply(view.flip, model.pose());
        deep.push(rotate(q, at)[2]);
        slip.push(norm(cross(model.read(scene.turning), at)));
        model.step(model.h); model.observe(); view.draw(THEMES.light);
      }
      return [Math.min(...deep), Math.max(...deep), Math.max(...slip)];
    })()""")
    assert found[0] == pytest.approx(found[1], rel=1e-12)
    assert found[0] < -0.1
    assert found[2] < 1e-12
    page.run("document.getElementById('cut').click(); explorer.run(true)")
    page.wait("explorer.panel.past.length > 20")
    assert "one closed level curve" in page.run(
        "document.getElementById('section-told').textContent"
    )
    show(page, pages("heavy_top"), calm=True)
    assert not page.run("explorer.view.rolls")


@pytest.mark.parametrize("name", ["heavy_top", "euler_disk", "snakeboard"])
def test_a_frame_takes_less_than_a_sixtieth_of_a_second(page, pages, name):
    """Over five seconds or more, the script is done with a frame in the time of one.

    How many there are depends on the machine: without a graphics card some three in a second.
    """
    show(page, pages(name))
    page.run("explorer.costs.length = 0")
    began = page.run("performance.now()")
    page.wait(f"performance.now() - {began} > 5000 && explorer.costs.length > 20")
    costs = np.array(page.run("explorer.costs"))
    assert np.median(costs) < 16


def test_a_slider_moves_the_state_and_the_address(page, pages):
    """A component of the state follows its slider, and the fragment of the address has it."""
    show(page, pages("heavy_top"), calm=True)
    assert not page.run("explorer.isRunning()")  # who prefers less motion starts it
    page.run("document.getElementById('state').open = true")
    page.run(
        "(() => { const s = document.getElementById('state-Pi1'); s.value = 1.5;"
        "s.dispatchEvent(new Event('input')) })()"
    )
    assert page.run("explorer.model.x[0]") == pytest.approx(1.5, abs=0.1)
    shared = page.run("location.hash")
    state = re.search(r"x=([^&]*)", shared)[1].split(",")
    assert float(state[0]) == pytest.approx(page.run("explorer.model.x[0]"))
    page.run("(() => { explorer.model.x[0] = 0; location.hash = '' })()")
    page.run(f"location.hash = {json.dumps(shared)}")
    page.wait("Math.abs(explorer.model.x[0]) > 1")


def test_keys_run_pause_and_move(page, pages):
    """Space runs and pauses, arrows move the point of the sphere, R goes back to the start."""
    show(page, pages("rigid_body"), calm=True)
    page.run("document.getElementById('sphere').focus()")
    page.key(" ", "Space", " ")
    page.wait("explorer.model.clock[0] > 0.05")
    page.key(" ", "Space", " ")
    assert not page.run("explorer.isRunning()")
    assert "Paused" in page.run("document.getElementById('status').textContent")
    before = page.run("[...explorer.model.x]")
    page.key("ArrowRight", "ArrowRight")
    after = page.run("[...explorer.model.x]")
    assert np.linalg.norm(after) == pytest.approx(np.linalg.norm(before))
    assert np.linalg.norm(np.subtract(after, before)) > 0.1
    page.key("r", "KeyR", "r")
    assert page.run("explorer.model.clock[0]") == 0


def test_a_hand_turns_the_body_and_moves_a_particle(page, pages):
    """What is dragged is the thing: the vertical turns with the body, the place with the ball."""
    show(page, pages("chaplygin_ball"), calm=True)
    before = page.run("[...explorer.model.x]")
    middle = page.run("(p => [p.x, p.y])(explorer.view.drawing.project(explorer.view.centre))")
    page.drag(middle, [middle[0] + 60, middle[1] + 30])
    after = page.run("[...explorer.model.x]")
    assert after[:3] == before[:3]
    assert np.linalg.norm(after[3:]) == pytest.approx(1)
    assert np.linalg.norm(np.subtract(after[3:], before[3:])) > 0.05
    show(page, pages("point_vortices"), calm=True)
    place = "(p => [p.x, p.y])(explorer.view.drawing.project(explorer.view.places()[2]))"
    at, before = page.run(place), page.run("[...explorer.model.x]")
    page.drag(at, [at[0] - 30, at[1] + 20])
    after = page.run("[...explorer.model.x]")
    assert page.run(place) == pytest.approx([at[0] - 30, at[1] + 20], abs=2)
    assert [k for k in range(12) if after[k] != before[k]] == [2, 8]
    show(page, pages("kepler"), calm=True)
    at = page.run("(p => [p.x, p.y])(explorer.view.drawing.project(explorer.view.positions()[0]))")
    page.drag(at, [at[0] + 40, at[1] - 25])
    found = page.run(
        "(p => [p.x, p.y])(explorer.view.drawing.project(explorer.view.positions()[0]))"
    )
    assert found == pytest.approx([at[0] + 40, at[1] - 25], abs=2)
    page.run("explorer.paint()")
    tip = "(p => [p.x, p.y])(explorer.view.drawing.project(explorer.view.tip(0)))"
    at, before = page.run(tip), page.run("[...explorer.model.x]")
    page.drag(at, [at[0] + 25, at[1] - 20])
    after = page.run("[...explorer.model.x]")
    assert page.run(tip) == pytest.approx([at[0] + 25, at[1] - 20], abs=2)
    assert sum(a != b for a, b in zip(after, before, strict=True)) == 3  # the velocity alone


def test_a_click_cuts_and_crossings_become_dots(page, pages):
    """The section button, a click on the sphere, and a motion leave dots, all on one side."""
    show(page, pages("heavy_top"), calm=True)
    page.run("document.getElementById('cut').click()")
    box = page.run(
        "(b => [b.x + b.width / 2, b.y + b.height / 2])"
        "(document.getElementById('sphere').getBoundingClientRect())"
    )
    page.mouse("mousePressed", *box)
    page.mouse("mouseReleased", *box)
    assert page.run("explorer.panel.plane !== null")
    page.run("explorer.run(true)")
    page.wait("explorer.panel.dots.length > 3")
    assert page.run("explorer.panel.dots.every(d => Math.abs(d[0]) <= 1 && Number.isFinite(d[1]))")
    assert "crossings" in page.run("document.getElementById('section-told').textContent")


@pytest.mark.parametrize("name", ["heavy_top", "chaplygin_ball", "snakeboard"])
def test_kernels_in_the_browser_equal_those_of_numpy(page, pages, name):
    """At 10 000 points: bit for bit without functions beyond sqrt, else within the bound."""
    show(page, pages(name), calm=True)
    rng = np.random.default_rng(3)
    rendered = render(read_spec(derivations_folder() / f"{name}.toml"))
    with load_texts(rendered.texts) as system:
        parameters = rng.uniform(0.5, 2.0, system.PARAMETERS.size)
        state = rng.uniform(0.2, 1.5, (system.STATE.size, 10_000))
        wanted = system.rhs(state, parameters, target="numpy").T
        found = page.run(
            f"(() => {{ const p = Float64Array.from({parameters.tolist()});"
            f"return {json.dumps(state.T.tolist())}.map(x => [...kernel.rhs(Float64Array.from(x), "
            f"p, new Float64Array({system.STATE.size}))]) }})()"
        )
        found = np.array(found, dtype=float)
        if not system.elementary:
            np.testing.assert_array_equal(found, wanted)
        assert (
            np.abs(found - wanted) <= 1e-12 * np.maximum(np.abs(wanted).max(axis=1), 1)[:, None]
        ).all()


def test_a_body_is_turned_below_its_momenta_and_a_link_holds_how(page, pages):
    """Momenta rest in space while a hand turns the body; links and Start over keep that."""
    show(page, pages("kirchhoff"), calm=True)
    seen = (
        "[scene.spinning, scene.pushing].flatMap((each) => "
        "rotate(explorer.model.pose(), explorer.model.read(each)))"
    )
    momenta, before = page.run(seen), page.run("explorer.model.pose()")
    at = page.run(f"{SPOT}(explorer.view.centre)")
    page.drag(at, [at[0] + 60, at[1] + 30])
    attitude = page.run("explorer.model.pose()")
    assert np.abs(np.subtract(attitude, before)).max() > 0.05
    np.testing.assert_allclose(page.run(seen), momenta, atol=1e-12)
    page.run("for (let k = 0; k < 50; k++) explorer.model.step(explorer.model.h); explorer.reset()")
    np.testing.assert_allclose(page.run("explorer.model.pose()"), attitude, atol=1e-12)
    state, link = page.run("[...explorer.model.x]"), page.run("location.hash")
    page.call("Page.navigate", url="about:blank")
    page.call("Page.navigate", url=pages("kirchhoff").as_uri() + link)
    page.wait("globalThis.explorer && explorer.frames() > 1")
    np.testing.assert_allclose(page.run("explorer.model.pose()"), attitude, atol=1e-7)
    np.testing.assert_allclose(page.run("[...explorer.model.x]"), state, atol=1e-7)


def test_a_link_holds_a_field_that_was_pulled(page, pages):
    """All numbers of a field are in the address, to five digits."""
    show(page, pages("spin_chain"), calm=True)
    at = page.run(f"{SPOT}(explorer.view.tips[20])")
    page.drag(at, [at[0] + 30, at[1] - 45])
    state, link = page.run("[...explorer.model.x]"), page.run("location.hash")
    page.call("Page.navigate", url="about:blank")
    page.call("Page.navigate", url=pages("spin_chain").as_uri() + link)
    page.wait("globalThis.explorer && explorer.frames() > 1")
    np.testing.assert_allclose(page.run("[...explorer.model.x]"), state, atol=1e-4)


def test_a_disk_that_is_dragged_keeps_its_energy(page, pages):
    """Where it falls nearly flat its steps become shorter; with those of the start it gains."""
    show(page, pages("euler_disk"), calm=True)
    walk = """(coarse => {
      const { model } = explorer;
      model.x.set([-3.39, 1.147, 0.2618, -0.08933, 0.4202, 0.903]);
      model.settle();
      model.coarse = coarse;
      while (model.clock[0] < 5 && model.step(model.h));
      model.observe();
      return [model.ended, model.drift(model.integrals[0])];
    })"""
    ended, drift = page.run(f"{walk}(explorer.model.coarse)")
    assert (ended, drift < 3e-4) == ("", True), drift
    assert page.run(f"{walk}(0)")[1] > 1e-3


def test_a_camera_is_where_a_motion_begins(page, pages):
    """A new motion is looked at in its first picture; otherwise the camera comes by and by."""
    show(page, pages("chaplygin_ball"), calm=True)
    away = "norm(minus(explorer.view.camera.target, explorer.view.centre))"
    lost = "explorer.view.camera.target = [9, 9, 0]; explorer.paint();"
    assert page.run(f"{lost} {away}") > 1
    x, y = page.run(f"{lost} explorer.reset(); explorer.paint(); {SPOT}(explorer.view.centre)")
    assert page.run(away) < 0.4  # arrows above the ball have room
    assert abs(x - 430) < 5
    assert 200 < y < 600


def test_a_section_says_what_its_frame_means(page, pages):
    """Both axes have their quantity, their ends and the unit of the rate."""
    show(page, pages("heavy_top"), calm=True)
    found = page.run("""(() => {
      const written = [], { panel } = explorer, own = CanvasRenderingContext2D.prototype;
      const before = own.fillText;
      panel.cut([1, 0, 0]);
      panel.dots = [[0.5, -2, 0], [0.9, 1.5, 0]];
      own.fillText = function (text, ...at) { written.push(text); before.call(this, text, ...at); };
      document.getElementById("section-box").hidden = false;
      drawSection(document.getElementById("section"), panel, THEMES.light);
      own.fillText = before;
      return written.map((text) => text.replace(/\\s/g, " "));
    })()""")  # fmt: skip
    assert found[:2] == ["Γ₃/|Γ|", "rate of Γ₃/|Γ|"]
    assert found[2:] == ["0.94", "0.46", "−2.2 s⁻¹", "2.2 s⁻¹"]


def test_an_orbit_is_drawn_by_its_steps_and_not_by_frames(page, pages):
    """Many steps between two frames leave as many points on the curve."""
    show(page, pages("kepler"), calm=True)
    page.run("explorer.reset(); explorer.paint()")
    page.run(
        "for (let k = 0; k < 200; k++) { explorer.model.step(explorer.model.h); view.sample(); }"
    )
    assert page.run("explorer.view.trail(0).points.length") > 100


def test_a_row_that_grows_stays_in_the_picture(page, pages):
    """The open lattice of Toda drifts apart: its scale follows, as that of the start does not."""
    show(page, pages("toda_lattice"), calm=True)
    tallest = "Math.max(...explorer.view.places().map(p => Math.abs(p[2])))"
    high, before = page.run(f"[explorer.view.high, {tallest}]")
    page.run(
        "for (let k = 0; k < 3000 && explorer.model.clock[0] < 6; k++) "
        "{ explorer.model.step(explorer.model.h); explorer.view.sample(); }"
    )
    assert page.run(tallest) <= 0.45
    page.run(f"explorer.view.high = {high}")
    assert page.run(tallest) > 1.5 * before


def test_components_of_a_motion_with_noise_are_no_closed_curve(page, pages):
    """Noise crosses the levels of the energy: only a motion without it is closed."""
    show(page, pages("stochastic_rigid_body"), calm=True)
    page.run("document.getElementById('cut').click()")
    told = page.run("document.getElementById('section-told').textContent")
    assert "no more rows" in told
    assert "closed" not in told


def test_casimirs_have_the_letter_of_documents(page, pages):
    """In the list of what is conserved, and in what the page says of its method."""
    show(page, pages("heavy_top"), calm=True)
    names = page.run("[...document.querySelectorAll('#drift .name')].map(each => each.innerHTML)")
    assert names == ["energy", "𝒞<sub>1</sub>", "𝒞<sub>2</sub>"]
    assert "<mi>𝒞</mi><mn>1</mn>" in symbol("casimir1").mathml
    assert "keeps 𝒞₁, 𝒞₂" in page.run("document.getElementById('method').textContent")
    style = "getComputedStyle(document.querySelectorAll('#drift .name')[1]).fontStyle"
    assert page.run(style) == "normal"


def test_a_browser_without_webgl_is_told(pages):
    """The page says what it needs, where it says at other times what a hand does."""
    with browser() as plain:
        plain.call(
            "Page.addScriptToEvaluateOnNewDocument",
            source="HTMLCanvasElement.prototype.getContext = () => null",
        )
        plain.open(pages("rigid_body"))
        assert "WebGL 2" in plain.run("document.getElementById('hint').textContent")


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("name", ["heavy_top", "quadrotor", "snakeboard", "spin_chain"])
def test_axe_finds_no_violation(page, pages, name, dark):
    """axe-core, from AXE_CORE or node_modules, has nothing to say of the page in either scheme."""
    place = Path(os.environ.get("AXE_CORE", "node_modules/axe-core/axe.min.js"))
    if not place.is_file():
        pytest.skip(
            "axe-core is not here: npm install --no-save axe-core, or set AXE_CORE to axe.min.js"
        )
    show(page, pages(name), dark=dark, calm=True)
    page.run("document.querySelectorAll('details').forEach(each => { each.open = true })")
    page.run(place.read_text() + ";0")
    found = page.run(
        "axe.run().then(r => [r.violations.map(v => [v.id, v.nodes[0].html]), r.passes.length])"
    )
    assert found[0] == []
    assert found[1] > 10
