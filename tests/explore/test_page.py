"""The page of a system: its structure, its policy, what it shows, and what it refuses."""

import base64
import hashlib
import json
import re
from dataclasses import replace

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError
from coadjoint.explore.page import SCRIPTS, assemble, render_page
from coadjoint.explore.scene import describe_scene
from coadjoint.notation.names import name as symbol
from coadjoint.render.scripts import render_script
from coadjoint.resources import derivations_folder, templates_folder
from coadjoint.solve.folders import load_texts
from coadjoint.spec import read_spec
from tests import specs
from tests.specs import RIGID_BODY, render_claims

HOSTILE = '</script><img src=x onerror=alert(1)>\\"<!-- & {{ 7*7 }}'
#: What loads something, or makes code of text.
LOADS = re.compile(
    r"""\b(?:src|href|action)\s*=|url\(|@import|\bimport\b|fetch\(|XMLHttpRequest|WebSocket|
        EventSource|sendBeacon|\beval\(|new\sFunction|innerHTML|https?://""",
    re.VERBOSE,
)


def write(path, text):
    """A spec."""
    path.write_text(text)
    return path


def page_of(path):
    """The page of a spec, and what it is told."""
    spec = read_spec(path)
    rendered = render_claims(spec)
    return render_page(spec, rendered), describe_scene(spec, rendered)


def element(page, opening, closing):
    """The text of the one element that begins so."""
    parts = page.split(opening)
    assert len(parts) == 2, opening
    return parts[1].split(closing)[0]


@pytest.fixture(scope="module")
def top():
    """The page of the heavy top and its scene."""
    return page_of(derivations_folder() / "heavy_top.toml")


def test_a_page_runs_its_own_script_and_nothing_else(top):
    """The policy names the hashes of the one script and the one style, and lets nothing load."""
    page, _ = top
    policy = element(page, 'http-equiv="Content-Security-Policy" content="', '"')
    policy = policy.replace("&#39;", "'")
    assert policy.startswith("default-src 'none'; ")
    assert "unsafe" not in policy
    for kind, opening, closing in (
        ("script-src", "<script>", "</script>"),
        ("style-src", "<style>", "</style>"),
    ):
        digest = hashlib.sha256(element(page, opening, closing).encode()).digest()
        assert f"{kind} 'sha256-{base64.b64encode(digest).decode()}'" in policy
    assert page.count("<script") == 2
    assert page.count("</script>") == 2
    assert not re.search(r"<[^>]*\s(?:style|on\w+)=", page.split("<script>")[0])


def test_no_formula_brings_a_style_that_the_policy_refuses(top):
    """The larger dot of a rate, as this description has it, is an attribute of MathML."""
    _, scene = top
    strand = read_spec(derivations_folder() / "spin_chain.toml")
    told = {**scene, "description": " ".join(strand.description.split())}
    shown = assemble(told, "").split("<script>")[0]
    assert 'mathsize="1.3em"' in shown
    assert " style=" not in shown


def test_a_page_asks_for_nothing(top):
    """Nothing in it loads a file, and no address of the network stands in it."""
    page, _ = top
    assert not LOADS.search(page), LOADS.search(page)
    for word in ("<link", "<iframe", "<object", "<embed", "<base", "<img"):
        assert word not in page


def test_the_page_has_the_generated_functions_and_names_for_what_it_shows(top):
    """The kernel in it is that of the target, and controls have labels."""
    page, scene = top
    rendered = specs.rendered("heavy_top")
    assert render_script(rendered.context) in page
    assert scene["kind"] == "body"
    assert scene["methods"][0]["name"] == "splitting4"
    for each in ('lang="en"', 'role="status"', "aria-label", "<noscript>", "<h1>Heavy top</h1>"):
        assert each in page
    assert page.count('tabindex="0"') == page.count('role="application"') == 3


def test_explanations_of_sliders_have_their_formulas(top):
    """Each quantity with a slider has what its spec says of it, formulas set."""
    _, scene = top
    disk = {**scene["tables"]["state"][0], "name": "disk", "doc": "Gamma3 is m r^2/4"}
    told = assemble({**scene, "tables": {**scene["tables"], "inputs": [disk]}}, "")
    docs = element(told, '<template id="docs">', "</template>")
    names = re.findall('data-of="(.*?)"', docs)
    tables = scene["tables"]
    wanted = [q["name"] for t in ("state", "parameters") for q in tables[t] if q["doc"]]
    assert names == [*wanted, "disk"]
    assert "<msub><mi>Γ</mi><mn>3</mn></msub></math> is <math><mfrac>" in docs
    assert "Gamma3" not in docs


def test_a_casimir_has_the_letter_that_documents_have(top):
    """The records and the formulas of documents come from one source."""
    _, scene = top
    (casimir, _) = [each for each in scene["tables"]["observables"] if "casimir" in each["name"]]
    assert casimir["written"] == ("𝒞", "1")
    assert symbol("casimir1").mathml == "<msub><mi>𝒞</mi><mn>1</mn></msub>"


def test_what_a_spec_says_is_text_and_nothing_else(tmp_path):
    """A title, a description and a unit that look like markup are shown as they stand."""
    text = RIGID_BODY.replace('title = "Sample body"', "", 1)
    lines = [
        line for line in text.splitlines() if not re.match(r"(title|source|description)\b", line)
    ]
    head = "\n".join(f'{key} = "{HOSTILE}"' for key in ("title", "source", "description"))
    page, scene = page_of(write(tmp_path / "sample.toml", head + "\n" + "\n".join(lines)))
    assert "onerror" in scene["title"]
    assert "<img" not in page
    assert page.count("</script>") == 2
    assert page.count("<script") == 2
    assert "49" not in element(page, "<h1>", "</h1>")
    data = element(page, 'id="scene-data">', "</script>")
    assert "<" not in data
    assert json.loads(data)["title"] == scene["title"]


@pytest.mark.parametrize(
    ("name", "kind", "known"),
    [
        ("rigid_body", "body", {"turning": "observables", "vertical": None}),
        ("kirchhoff", "body", {"moving": "observables", "vertical": None}),
        ("euler_disk", "rolling", {"turning": "state", "vertical": "state"}),
        ("tippe_top", "rolling", {"moving": "state", "vertical": "state"}),
        ("quadrotor", "body", {"vertical": "state", "stick": "M"}),
        ("spacecraft_wheels", "body", {"attitude": "state", "moving": None, "stick": ""}),
        ("three_wave", "portrait", {}),
        ("snakeboard", "planar", {}),
        ("roller_racer", "carriage", {}),
        ("appell_machine", "carriage", {}),
        ("monopole_kepler", "particles", {}),
        ("spin_chain", "strand", {}),
        ("kdv", "profile", {}),
        ("point_vortices", "members", {"shape": "plane"}),
        ("sphere_vortices", "members", {"shape": "globe"}),
        ("peakons", "members", {"shape": "stems"}),
        ("toda_lattice", "members", {"shape": "stems"}),
        ("heisenberg_lattice", "members", {"shape": "arrows"}),
        ("spin_chain_lattice", "members", {"shape": "frames"}),
        ("n_body", "members", {"shape": "space"}),
        ("euler_2d", "surface", {"surface": "plane"}),
        ("zeitlin_su_n", "surface", {"surface": "sphere", "matrix": 17}),
        ("zeitlin_torus", "surface", {"surface": "torus", "towers": []}),
    ],
)
def test_what_is_drawn_follows_from_the_records(tmp_path, name, kind, known):
    """Roles, blocks of the algebra and attitudes choose it: under another name it is the same."""
    text = (derivations_folder() / f"{name}.toml").read_text()
    path = write(
        tmp_path / "renamed.toml",
        re.sub(r"^title\s*=.*$", 'title = "Other"', text, count=1, flags=re.M),
    )
    spec = read_spec(path)
    rendered = render_claims(spec)
    scene = describe_scene(spec, rendered)
    assert scene["kind"] == kind
    for key, table in known.items():
        found = scene[key]
        assert (found["table"] if isinstance(found, dict) else found) == table, key


def test_members_begin_at_the_defaults_of_the_spec_and_at_none_of_another_number():
    """Blocks of components, member after member; of another number there are no defaults."""
    spec = read_spec(derivations_folder() / "point_vortices.toml")
    scene = describe_scene(spec, render_claims(spec))
    x, y = (each["default"] for each in scene["tables"]["state"])
    np.testing.assert_allclose(np.array(x) ** 2 + np.array(y) ** 2, 1.0)
    assert scene["members"] == len(x) == 6
    (strength,) = scene["tables"]["parameters"]
    assert strength["components"] == [f"Gamma_{k}" for k in range(6)]
    assert strength["default"] == [1.0] * 6
    rendered = render_claims(spec)
    context = rendered.family.context
    larger = replace(context, index=replace(context.index, size=7))
    other = describe_scene(spec, replace(rendered, family=replace(rendered.family, context=larger)))
    assert other["tables"]["state"][0]["default"] is None
    many = replace(context, index=replace(context.index, size=5000))
    with pytest.raises(KernelArgumentError, match="10000 rows of its state are too many"):
        describe_scene(spec, replace(rendered, family=replace(rendered.family, context=many)))


def test_spins_repeat():
    """Eight declared spins are those of a thousand members, component after component."""
    spec = read_spec(derivations_folder() / "heisenberg_lattice.toml")
    (spins,) = describe_scene(spec, render_claims(spec))["tables"]["state"]
    found = np.array(spins["default"]).reshape(3, 1000)
    np.testing.assert_allclose((found**2).sum(axis=0), 1.0)
    np.testing.assert_array_equal(found[:, 3], found[:, 803])
    assert np.abs(found[:, 3] - found[:, 4]).max() > 0.1


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"indexed_noise": ("dW",)}, "something drives it from outside"),
        ({"torus": "sizes"}, "nobody has said how many points its plane has"),
    ],
)
def test_what_a_page_does_not_show_is_refused_with_a_way_on(change, problem):
    """The message names the system, the reason and another command."""
    spec = read_spec(derivations_folder() / "euler_2d.toml")
    rendered = specs.rendered("euler_2d")
    context = rendered.family.context
    if "torus" in change:
        torus = context.torus
        change = {
            "torus": type(torus)(
                torus.coordinates, torus.lengths, (None, 32), torus.derivatives, torus.solved
            )
        }
    other = replace(rendered.family, context=replace(context, **change))
    with pytest.raises(KernelArgumentError) as caught:
        describe_scene(spec, replace(rendered, family=other))
    message = str(caught.value)
    assert f"euler_2d has no page to explore: {problem}" in message
    assert "coadjoint simulate euler_2d" in message


def steps(engine, name, scene, method, start, h, count):
    """Where steps of the page lead, in an engine of JavaScript."""
    given = json.dumps([start.tolist(), scene["spheres"], method])
    return np.array(json.loads(engine.eval(
        f"""(() => {{
          const [start, spheres, method] = {given}, x = Float64Array.from(start);
          const p = Float64Array.from(PARAMETERS);
          const stepper = new Stepper(x.length, (x, out) => kernel.rhs(x, p, out), method, spheres,
            (flow, x, out) => kernel[flow](x, p, out));
          for (let n = 0; n < {count}; n++) stepper.step(x, {h});
          return JSON.stringify([...x]);
        }})()"""
    )))  # fmt: skip


def test_steps_of_the_page_are_those_of_the_library(top):
    """Every method of the page ends where that of `System.simulate` ends, to rounding."""
    racer = pytest.importorskip("py_mini_racer", reason="mini-racer is not installed").MiniRacer()
    _, scene = top
    rendered = specs.rendered("heavy_top")
    page = assemble(scene, render_script(rendered.context))
    code = element(page, "<script>", "const scene =")  # the kernel, numerics and drawing
    start, h, count = np.array([0.3, -0.2, 5.0, 0.3, 0.0, 0.9]), 0.01, 200
    with load_texts(rendered.texts) as system:
        racer.eval(f"{code}\nconst PARAMETERS = {json.dumps(system.pack().tolist())};")
        names = ["splitting4", "spherical_midpoint", "midpoint", "gauss4", "rk4"]
        for name in names:
            known = [each for each in scene["methods"] if each["name"] == name]
            method = known[0] if known else {"name": name, "schedule": []}
            found = steps(racer, "heavy_top", scene, method, start, h, count)
            run = system.simulate(
                start, (0.0, h * count), method=name, step=h, samples=1, target="numpy",
                progress=False,
            )  # fmt: skip
            np.testing.assert_allclose(found, run.state[:, -1], rtol=1e-11, atol=1e-11)
            other = steps(racer, "heavy_top", scene, method, start, 1.01 * h, count)
            assert abs(other - found).max() > 1e-3, name  # a wrong step would be seen


def test_the_parts_of_the_page_are_files_that_are_installed():
    """The list of scripts is the scripts that stand in the folder."""
    folder = templates_folder() / "explorer"
    assert {path.name for path in folder.glob("*.js")} == set(SCRIPTS)
    assert (folder / "page.css").is_file()
