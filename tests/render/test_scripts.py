"""JavaScript: read back as the Program, and compared with NumPy by an engine of JavaScript."""

import json

import numpy as np
import pytest

from coadjoint.crosscheck.parse_back import check_text
from coadjoint.elementary import ELEMENTARY
from coadjoint.errors import CrossCheckError, OutputError
from coadjoint.render.scripts import JS, list_scripted, render_family_script, render_script
from coadjoint.render.targets.js.printer import name_text
from coadjoint.render.targets.protocol import Call
from coadjoint.solve.folders import load_texts
from coadjoint.spec import read_spec
from tests import specs
from tests.specs import RIGID_BODY, render_claims

POINTS = 10_000
#: Functions of one argument on what they are compared at.
ARGUMENTS = {"log": (1e-6, 1e6), "asin": (-1, 1), "acos": (-1, 1), "exp": (-20, 20)}
ARGUMENTS |= {"atanh": (-1, 1)}
#: How many units in the last place an engine may differ from NumPy in one call. The C library and
#: NumPy state errors below 1 for these, fdlibm of V8 below 1, two for the hyperbolic ones.
ULPS = 4


def engine():
    """An engine of JavaScript, or a skip with the reason."""
    return pytest.importorskip("py_mini_racer", reason="mini-racer is not installed").MiniRacer()


def points(rng, rows, members=POINTS):
    """Numbers on both sides of 0, away from it."""
    return rng.uniform(0.2, 1.5, (rows, members)) * rng.choice([-1.0, 1.0], (rows, members))


def compare(system, kernel, functions, *, exact):
    """Each function in JavaScript and in NumPy at many points; how many numbers were the same."""
    rng, same = np.random.default_rng(7), 0
    for name in functions:
        sizes = system.sizes(name)
        members = POINTS if name == "rhs" else 501
        state = points(rng, sizes["state"], members)
        parameters = rng.uniform(0.5, 2.0, (sizes["parameters"], members))
        driving = {"inputs": points(rng, sizes["inputs"], members)} if "inputs" in sizes else {}
        wanted = system.evaluate(name, state, parameters, *driving.values(), target="numpy")
        found = np.empty_like(wanted)
        for piece in kernel.calls(name, Call(state, parameters, found, driving)):
            piece()
        finite = np.isfinite(wanted)
        assert finite.any(), name
        assert np.array_equal(np.isnan(found), np.isnan(wanted)), name
        if exact:
            np.testing.assert_array_equal(found, wanted, name)
        else:
            # a sum of terms of its largest row: each call adds at most ULPS roundings to a term
            scale = np.abs(wanted[..., :]).max(axis=tuple(range(wanted.ndim - 1)))
            assert (np.abs(found - wanted) <= 1e-12 * np.maximum(scale, 1.0)).all(), name
        same += int(np.count_nonzero(finite))
    return same


@pytest.mark.parametrize(
    ("name", "exact"),
    [("heavy_top", True), ("chaplygin_ball", True), ("quadrotor", True), ("snakeboard", False)],
)
def test_kernels_equal_those_of_numpy(name, exact):
    """Bits are those of NumPy where functions beyond sqrt are not called; else within a bound."""
    engine()
    rendered = specs.rendered(name)
    text = render_script(rendered.context)
    for program in list_scripted(rendered.context):
        assert check_text(program, JS, text, name) > 0
    with load_texts({**rendered.texts, "kernel.js": text}) as system:
        kernel = JS.load(system, "js", lambda: None)
        functions = [each for each in system.functions if each in rendered.programs]
        assert compare(system, kernel, functions, exact=exact) > POINTS
        assert (not system.elementary) == exact


@pytest.mark.parametrize(
    ("name", "size"),
    [
        ("spin_chain", 41),
        ("n_body", 43),
        ("camassa_holm", 33),
        ("zeitlin_su_n", 7),
        ("zeitlin_torus", 7),
    ],
)
def test_kernels_of_equal_members_equal_those_of_numpy(name, size):
    """So do loops over members, in blocks and without, with sums over pairs and solutions."""
    js = engine()
    rendered = specs.rendered(name)
    js.eval(render_family_script(rendered.family.context))
    rng = np.random.default_rng(8)
    with load_texts(rendered.texts) as loaded:
        system = loaded.resize({loaded.index.name: size})
        parameters = rng.uniform(0.5, 2.0, system.PARAMETERS.size)
        for function in ("rhs", "energy"):
            state = points(rng, system.STATE.size, 1)[:, 0]
            wanted = system.evaluate(function, state, parameters, target="numpy")
            given = json.dumps([state.tolist(), parameters.tolist()])
            call = (
                f"Array.from({function}(...{given}.map(a => Float64Array.from(a)), {system.size}, "
            )
            out = f"new Float64Array({max(np.size(wanted), 1)})))"
            found = np.array(json.loads(js.eval(f"JSON.stringify({call}{out})")))
            if not system.elementary:
                np.testing.assert_array_equal(found, np.ravel(wanted), function)
            np.testing.assert_allclose(found, np.ravel(wanted), rtol=1e-11, atol=1e-11)


def test_functions_of_the_engine_are_within_the_bound():
    """What differs from NumPy in one call is a few units in the last place, for every function."""
    js, rng = engine(), np.random.default_rng(9)
    for name, entry in ELEMENTARY.items():
        low, high = ARGUMENTS.get(name, (-8, 8))
        if name == "sqrt":
            low = 0
        given = rng.uniform(low, high, (entry.arity, POINTS))
        wanted = getattr(np, entry.numpy_name)(*given)
        text = f"JSON.stringify({json.dumps(given.T.tolist())}.map(each => Math.{name}(...each)))"
        found = np.array(json.loads(js.eval(text)), dtype=float)
        apart = np.abs(found - wanted) / np.spacing(np.abs(wanted))
        assert apart.max() <= (0 if entry.is_exact else ULPS), (name, apart.max())


def test_words_of_the_language_are_names_of_a_spec(tmp_path):
    """A parameter may be called ``new``: the name is printed with a sign and read back without."""
    path = tmp_path / "sample.toml"
    path.write_text(
        RIGID_BODY.replace("[parameters", "[parameters.new]\ndefault = 1\n\n[parameters", 1)
        .replace('"dot(Omega, diag(I)*Omega)/2"', '"new*dot(Omega, diag(I)*Omega)/2"')
        .replace('"dot(Pi, inverse(diag(I))*Pi)/2"', '"dot(Pi, inverse(diag(I))*Pi)/(2*new)"')
    )
    rendered = render_claims(read_spec(path))
    text = render_script(rendered.context)
    assert "const new$ = parameters[" in text
    assert check_text(rendered.programs["rhs"], JS, text, "sample") > 0
    assert name_text("Omega") == "Omega"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("Pi2 * Pi3", "Pi3 * Pi2"),
        ("state[1]", "state[2]"),
        ("  return out;", "  alert(1);\n  return out;"),
    ],
)
def test_another_text_is_noticed(tmp_path, old, new):
    """Operands that change places, another row and a further statement fail rung 3."""
    path = tmp_path / "sample.toml"
    path.write_text(RIGID_BODY)
    rendered = render_claims(read_spec(path))
    text = render_script(rendered.context)
    assert old in text
    with pytest.raises(CrossCheckError, match=r"kernel\.js"):
        check_text(rendered.programs["rhs"], JS, text.replace(old, new, 1), "sample")


def test_a_folder_without_the_file_says_what_to_do(tmp_path):
    """The error names the file."""
    engine()
    path = tmp_path / "sample.toml"
    path.write_text(RIGID_BODY)
    with (
        load_texts(render_claims(read_spec(path)).texts) as system,
        pytest.raises(OutputError, match=r"kernel\.js"),
    ):
        JS.load(system, "js", lambda: None)
