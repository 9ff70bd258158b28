"""Each rung runs on kernels that were loaded from the very texts, compares something, or fails."""

from __future__ import annotations

import dataclasses
import stat

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.build import compiler
from coadjoint.build.compiler import CompilerWarning, find_compiler
from coadjoint.crosscheck import ladder
from coadjoint.crosscheck.compare import Agreement, Figures, against_oracle, exact_points
from coadjoint.crosscheck.ladder import crosscheck
from coadjoint.crosscheck.subject import UNTOUCHED, Subject
from coadjoint.errors import CompilerError, CrossCheckError, OutputError
from coadjoint.regenerate import regenerate
from coadjoint.render.kernels import render_system
from coadjoint.render.targets import BUILDS
from coadjoint.solve.folders import load_folder
from tests.kernels import COMPILER, ProgramReference, TextSystem
from tests.programs import PENDULUM, program
from tests.specs import RIGID_BODY, spec

TARGETS = tuple(BUILDS)
pytestmark = pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
#: Everything but the version is refused.
FAILS_ON_KERNELS = '[ "$1" = --version ] && exec {real} --version\nexit 1'
#: A macro that shortens every loop, behind the definitions of the template.
MACRO = "#define COADJOINT_INDEPENDENT\n#endif"
SHORTER = (
    "\n#undef COADJOINT_INDEPENDENT"
    "\n#define COADJOINT_INDEPENDENT if (count -= count > 1, _last -= _last > count, 1)"
)


@pytest.fixture(autouse=True)
def fresh(monkeypatch, tmp_path):
    """An empty cache, and a search for a compiler of its own."""
    monkeypatch.setenv("COADJOINT_CACHE", str(tmp_path / "cache"))
    compiler._find.cache_clear()
    yield
    compiler._find.cache_clear()


@pytest.fixture(scope="module")
def rendered():
    """The rigid body as text."""
    return pipeline.render(spec())


def script(folder, body):
    """A compiler that is a shell script."""
    path = folder / "compiler"
    path.write_text("#!/bin/sh\n" + body.format(real=find_compiler().command[0]) + "\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    compiler._find.cache_clear()
    return str(path)


def spoiled(rendered, file, good, bad):
    """The system with a piece of one text replaced."""
    assert good in rendered.texts[file]
    texts = {**rendered.texts, file: rendered.texts[file].replace(good, bad)}
    return dataclasses.replace(rendered, texts=texts)


def test_the_rigid_body_passes_every_rung(rendered, optimized):
    """All targets, every rung passed, and a count for each of them."""
    report = pipeline.verify(rendered)
    assert report.passed
    assert report.targets == TARGETS
    assert report.points == sum(f.points for t in report.figures.values() for f in t.values()) > 500
    assert min(report.lines.values()) > 2
    assert min(equal["c"] for equal in report.equal.values()) > 40_000
    assert min(equal["python"] for equal in report.equal.values()) > 500
    record = report.as_record()
    assert record["lines"] == report.lines
    assert record["together"] == report.together


def test_a_compiler_that_fails_on_every_kernel_fails_regenerate(monkeypatch, tmp_path):
    """NumPy does not replace C here: nothing is written, and the error names the compiler."""
    monkeypatch.setenv("CC", script(tmp_path, FAILS_ON_KERNELS))
    path = tmp_path / "sample.toml"
    path.write_text(RIGID_BODY)
    outcome = regenerate([path], tmp_path / "out")
    assert not outcome.rows
    assert isinstance(outcome.failures["sample"], CompilerError)
    assert "failed on kernel.c with status 1" in str(outcome.failures["sample"])
    assert not (tmp_path / "out" / "sample").exists()


def test_users_fall_back_to_numpy(monkeypatch, tmp_path, rendered):
    """With the same compiler a user's call falls back to NumPy and says so."""
    monkeypatch.setenv("CC", script(tmp_path, FAILS_ON_KERNELS))
    for name, text in rendered.texts.items():
        (tmp_path / name).write_text(text)
    system = load_folder(tmp_path)
    with pytest.warns(CompilerWarning, match="NumPy kernels are used"):
        found = system.rhs([1.0, 2.0, 3.0], [1.0, 2.0, 4.0])
    # dPi1/dt = (1/I3 - 1/I2) Pi2 Pi3 and cyclic
    assert found.tolist() == [-1.5, 2.25, -1.0]


def test_a_missing_include_fails(rendered):
    """The compiler's message is the failure."""
    bad = spoiled(rendered, "kernel.c", "#include <math.h>", "#include <no_such_file.h>")
    with pytest.raises(CompilerError, match=r"no_such_file\.h"):
        pipeline.verify(bad)


@pytest.mark.parametrize(
    ("file", "good", "bad", "message"),
    [
        ("kernel.c", "_n < _last;", "_n + 1 < _last;", "rung 3.*no loop over the members"),
        (
            "kernel.c",
            MACRO,
            MACRO + SHORTER,
            "wrong kernel was compiled|rung [45]",
        ),
        ("kernel.py", "members, CHUNK)", "members - 1, CHUNK)", "rung [45]|wrong kernel"),
        ("kernel.py", "out = np.empty(shape + batch)", "out = missing", "kernel.py does not run"),
    ],
    ids=["C loop", "C macro", "Python loop", "Python name"],
)
def test_incomplete_templates_fail(rendered, file, good, bad, message):
    """A template that skips the last member fails, in each language, also through a macro."""
    with pytest.raises((CrossCheckError, OutputError), match=message):
        pipeline.verify(spoiled(rendered, file, good, bad))


def test_a_member_lost_between_the_parts_of_a_loop_is_noticed(rendered):
    """Where results are aligned to vectors, the member between the two parts is computed."""
    good, bad = "_first = _last, _last", "_first = _last + (_last > 0 && _last < count), _last"
    with pytest.raises(CrossCheckError, match=r"wrong kernel was compiled|rung [45]"):
        pipeline.verify(spoiled(rendered, "kernel.c", good, bad))


@pytest.mark.parametrize("file", ["kernel.c", "kernel.py", "kernel_python.py"])
def test_kernels_of_other_texts_are_refused(rendered, tmp_path, file):
    """Rung 3 fails if the loaded kernel does not belong to the checked text."""
    other = spoiled(rendered, file, "Generated by", "Written by")
    for name, text in other.texts.items():
        (tmp_path / name).write_text(text)
    reference = pipeline.Reference(rendered.equations)
    with pytest.raises(CrossCheckError, match=rf"rung 3: .*not loaded from this {file}"):
        crosscheck(rendered.programs, rendered.texts, reference, load_folder(tmp_path))


def test_a_python_kernel_that_cannot_be_loaded_is_named(rendered):
    """The message names the kernel, not the compiler."""
    with pytest.raises(CrossCheckError, match=r"rung 3: kernel\.py is not Python"):
        pipeline.verify(spoiled(rendered, "kernel.py", "import math\n", "import math (\n"))
    with pytest.raises(OutputError, match=r"kernel\.py cannot be loaded: .*no_such_module"):
        pipeline.verify(spoiled(rendered, "kernel.py", "import math\n", "import no_such_module\n"))
    with pytest.raises(OutputError, match=r"__init__\.py cannot be loaded: SyntaxError"):
        pipeline.verify(spoiled(rendered, "__init__.py", "simulate =", "simulate ="[:-1]))


def compared_nothing(**changes):
    """A report in which one count is zero."""
    figures = {"rhs": {"numpy": Figures(1.0, 1.0, 10), "c": Figures(1.0, 1.0, 10)}}
    rungs = {3: "passed", 4: "passed", 5: "passed"}
    parts = {"lines": {"rhs": 3}, "figures": figures}
    parts |= {"equal": {"rhs": {"c": 9}}, "together": {"rhs": {"c": 10}}}
    return ladder.Report("sample", rungs, 4.0, solvers=None, **{**parts, **changes})


def subject_of(*, exactly):
    """A subject of two targets whose function calls a sine or not."""
    each = program("rhs", "q", "", "", "q" if exactly else "sin(q)", ())
    return Subject({"rhs": each}, None, None, ("numpy", "c"))


def test_counts_are_checked():
    """A report whose counts are all positive passes."""
    for exactly in (True, False):
        ladder._check_counts(compared_nothing(), "rhs", subject_of(exactly=exactly))


@pytest.mark.parametrize(
    ("rung", "exactly", "changes"),
    [
        (3, True, {"lines": {"rhs": 0}}),
        (4, True, {"figures": {"rhs": {"numpy": Figures(0.0, 0.0, 10), "c": Figures(0, 0, 0)}}}),
        (4, True, {"figures": {"rhs": {}}}),
        (5, True, {"equal": {"rhs": {"c": 0}}}),
        (5, True, {"equal": {"rhs": {}}}),
        (5, False, {"together": {"rhs": {"c": 0}}}),
    ],
)
def test_comparing_nothing_fails(rung, exactly, changes):
    """Zero comparisons of any rung are a failure that names the rung and the function."""
    with pytest.raises(CrossCheckError, match=f"rung {rung}: sample: nothing of rhs") as caught:
        ladder._check_counts(compared_nothing(**changes), "rhs", subject_of(exactly=exactly))
    assert caught.value.rung == rung


def test_no_function_and_no_target_fail(rendered, tmp_path):
    """A ladder without programs or targets does not pass."""
    for name, text in rendered.texts.items():
        (tmp_path / name).write_text(text)
    system, reference = load_folder(tmp_path), pipeline.Reference(rendered.equations)
    with pytest.raises(CrossCheckError, match="no function, or no target"):
        crosscheck({}, rendered.texts, reference, system, TARGETS)
    with pytest.raises(CrossCheckError, match="no function, or no target"):
        crosscheck(rendered.programs, rendered.texts, reference, system, ())


def test_a_rung_that_compares_nothing_stops_the_ladder(monkeypatch, rendered):
    """The ladder checks the counts after all rungs."""
    for name, nothing in (
        ("check_text", lambda *_: 0),
        (
            "against_oracle",
            lambda subject, _: Agreement(dict.fromkeys(TARGETS, Figures(0, 0, 0)), {}),
        ),
        ("equal_bits", lambda subject, _: {each: {"c": 0} for each in subject.programs}),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(ladder, name, nothing)
            with pytest.raises(CrossCheckError, match="nothing of rhs was compared"):
                pipeline.verify(rendered)


def test_rung_4_detects_an_unwritten_member(tmp_path):
    """Result arrays are filled beforehand, so that values of another kernel cannot pass."""
    texts = render_system(PENDULUM)
    system = TextSystem(PENDULUM, texts, tmp_path)
    seen = []
    whole = system._call

    def all_but_the_last(function, state, parameters, target, out):
        kept = out[..., -1].copy()
        whole(function, state, parameters, target, out)
        out[..., -1] = kept
        seen.append(kept)
        return out

    system._call = all_but_the_last
    programs = {each.name: each for each in PENDULUM.programs}
    reference = ProgramReference(PENDULUM.programs)
    with pytest.raises(CrossCheckError, match="rung 4"):
        crosscheck(programs, texts, reference, system, TARGETS, 100, 100)
    assert np.all(np.concatenate([np.ravel(each) for each in seen]) == UNTOUCHED)


def test_points_lie_where_the_equations_have_values(tmp_path):
    """An observable log(Pi1 - 3) has a value at one point in six, and is compared at most of them.

    Points are found by the equations, not by the kernel: one that returns NaN there is caught.
    """
    observable = '[observables]\nfar = "log(Pi[1] - 3)"\n\n[claims]'
    found = pipeline.render(spec(RIGID_BODY, ("[claims]", observable)))
    for name, content in found.texts.items():
        (tmp_path / name).write_text(content)
    reference = pipeline.Reference(found.equations)

    def report(system):
        maps, targets = found.maps, ("numpy",)
        return crosscheck(found.programs, found.texts, reference, system, targets, 600, maps=maps)

    figures = report(load_folder(tmp_path)).figures["observables"]["numpy"]
    assert figures.points > 60
    text = found.texts["kernel.py"].replace("Pi1 - 3.0", "1.0 - 3.0")
    assert text != found.texts["kernel.py"]
    found.texts["kernel.py"] = text
    (tmp_path / "kernel.py").write_text(text)
    with pytest.raises(CrossCheckError, match="rung 3"):
        report(load_folder(tmp_path))
    subject = Subject(found.programs, reference, load_folder(tmp_path), ("numpy",))
    with pytest.raises(CrossCheckError, match=r"rung 4.*nan"):
        against_oracle(subject, exact_points(subject, "observables", 60))
