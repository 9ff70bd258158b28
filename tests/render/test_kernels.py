"""Rendered files: formatted, compiled without warnings, read back, identified by their bytes."""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from coadjoint.declared import KernelContext, Quantity
from coadjoint.lower.program import Program
from coadjoint.render.kernels import NO_LICENSE, fingerprint, render_system
from tests.kernels import COMPILER, EXACT, STRICT, TextSystem, compile_text
from tests.programs import HEAVY_TOP, PENDULUM, program
from tests.render.test_printers import check_formatted

needs_compiler = pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
LONG_NAMES = " ".join(f"momentum_of_body_{i}" for i in range(12))
#: No parameters, more names than a line holds, one of them unread, constants and a long sum.
CROWD = KernelContext(
    name="crowd",
    spec="derivations/crowd.toml",
    license="MIT",
    routes=("Typed by hand.",),
    equations=("x" * 60 + " + " + "y" * 60,),
    state=(Quantity("momentum", (12,), "1", tuple(LONG_NAMES.split())),),
    parameters=(),
    observables=(),
    programs=(
        program(
            "rhs",
            LONG_NAMES,
            "",
            "_t1 = 1/3 - 0.5",
            "; ".join(
                ["+".join(f"_t1*{name}" for name in LONG_NAMES.split()[:-1])] * 11 + ["-2.5"]
            ),
            (12,),
        ),
    ),
)
#: Names whose lengths put the last declaration on one line, and on a line for each argument.
SHORT = replace(PENDULUM, name="p")
LONG = replace(PENDULUM, name="p" * 31)
CONTEXTS = [HEAVY_TOP, PENDULUM, CROWD, SHORT, LONG]


@pytest.fixture(params=CONTEXTS, ids=lambda context: context.name)
def context(request):
    """Each system in turn."""
    return request.param


def test_python_files_pass_our_formatter_and_linter(context, tmp_path):
    """`ruff format` leaves each file as it is and `ruff check` finds nothing."""
    texts = render_system(context)
    for name in ("kernel.py", "__init__.py", "kernel_python.py"):
        check_formatted(texts[name], tmp_path)
        # E741: I and l are what books call inertia and length.
        rules = ["--select=E,F,W,I", "--ignore=E741", "--line-length=100"]
        command = [sys.executable, "-m", "ruff", "check", "--isolated", *rules, "text.py"]
        found = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        assert found.returncode == 0, found.stdout


@needs_compiler
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_c_files_compile_with_warnings_as_errors(context, compiler, tmp_path, monkeypatch):
    """Exact, strict and sanitized builds are silent, with each compiler there is."""
    if not shutil.which(compiler):
        pytest.skip(f"{compiler} is not on this machine")
    monkeypatch.setattr("tests.kernels.COMPILER", compiler)
    texts = render_system(context)
    compile_text(texts, tmp_path, EXACT)
    compile_text(texts, tmp_path, ["-O1", "-fsanitize=address,undefined", "-fPIC", "-shared"])


@needs_compiler
def test_the_header_suits_c_plus_plus(context, tmp_path):
    """A C++ program can include the header."""
    (tmp_path / "kernel.h").write_text(render_system(context)["kernel.h"])
    (tmp_path / "main.cpp").write_text('#include "kernel.h"\nint main() { return 0; }\n')
    if not shutil.which("g++"):
        pytest.skip("g++ is not on this machine")
    subprocess.run(["g++", "-Wall", "-Werror", "-c", "main.cpp"], cwd=tmp_path, check=True)


@needs_compiler
def test_every_loop_is_vectorised(context, tmp_path):
    """The compiler vectorises the loop of each branch of each function of + - * / sqrt."""
    if not shutil.which("gcc"):
        pytest.skip("the report is gcc's")
    texts = render_system(context)
    (tmp_path / "kernel.h").write_text(texts["kernel.h"])
    (tmp_path / "kernel.c").write_text(texts["kernel.c"])
    command = ["gcc", *STRICT, *EXACT, "-fopt-info-vec", "kernel.c", "-o", "kernel.so"]
    report = subprocess.run(
        command, cwd=tmp_path, check=True, capture_output=True, text=True
    ).stderr
    loops = {
        number
        for number, line in enumerate(texts["kernel.c"].splitlines(), 1)
        if line.strip() == "for (size_t _n = _first; _n < _last; ++_n) {"
    }
    found = {int(line) for line in re.findall(r"kernel\.c:(\d+):\d+: optimized: loop", report)}
    called = [
        n
        for n, line in enumerate(texts["kernel.c"].splitlines(), 1)
        if re.search(r"\b(sin|cos|exp|log)\(", line)
    ]
    scalar = {max(loop for loop in loops if loop < n) for n in called if n > min(loops)}
    assert loops
    assert found >= loops - scalar


@needs_compiler
def test_signatures_are_pinned(context, tmp_path):
    """Argument names and order are the same for every function, in both languages."""
    texts = render_system(context)
    arguments = (
        "size_t count, const double *state, size_t state_stride, const double *parameters, "
        "size_t parameters_stride, double *out, size_t out_stride"
    )
    functions = {
        item.name: item
        for item in ast.parse(texts["kernel.py"]).body
        if isinstance(item, ast.FunctionDef)
    }
    for each in context.programs:
        assert ast.unparse(functions[each.name].args) == "state, parameters, out=None"
        declared = re.search(rf"void {context.name}_{each.name}\(([^)]*)\);", texts["kernel.h"])[1]
        assert " ".join(declared.split()) == arguments
        defined = re.search(rf"void {context.name}_{each.name}\(([^)]*)\)\n", texts["kernel.c"])[1]
        assert " ".join(defined.split()).replace("*restrict ", "*") == arguments
    assert f'const char {context.name}_id[] = "' in texts["kernel.c"]


@needs_compiler
def test_twins_agree_on_a_handful_of_members(tmp_path):
    """NumPy and C give the same bits, one parameter set for all or one for each, N = 0 and 1."""
    system = TextSystem(HEAVY_TOP, render_system(HEAVY_TOP), tmp_path)
    generator = np.random.default_rng(1)
    for members in (0, 1, 5):
        state = generator.normal(size=(6, members))
        for parameters in (generator.normal(size=8), generator.normal(size=(8, members))):
            one = system.rhs(state, parameters, target="numpy")
            other = system.rhs(state, parameters, target="c")
            assert one.shape == other.shape == (6, members)
            assert one.tobytes() == other.tobytes()


def test_numpy_kernel_keeps_the_shape_of_the_batch(tmp_path):
    """A state of shape (n,) or (n, 2, 3) gives a result of that batch, across chunks too."""
    namespace = {}
    exec(render_system(HEAVY_TOP)["kernel.py"], namespace)
    state = np.random.default_rng(2).normal(size=(6, 2, 3))
    parameters = np.arange(1.0, 9.0)
    whole = namespace["poisson_tensor"](state, parameters)
    namespace["CHUNK"] = 4
    assert whole.shape == (6, 6, 2, 3)
    np.testing.assert_array_equal(namespace["poisson_tensor"](state, parameters), whole)
    np.testing.assert_array_equal(
        namespace["poisson_tensor"](state[:, 1, 2], parameters), whole[..., 1, 2]
    )
    assert namespace["energy"](state, parameters).shape == (2, 3)
    own = np.broadcast_to(parameters[:, None, None], (8, 2, 3))
    np.testing.assert_array_equal(namespace["rhs"](state, own), namespace["rhs"](state, parameters))


@pytest.mark.parametrize(
    ("state", "parameters", "out", "found"),
    [
        ((5, 3), (8,), None, r"\(5, 3\)"),
        ((6, 3), (7,), None, r"\(7,\)"),
        ((6, 3), (8, 2), None, r"\(8, 2\)"),
        ((6, 3), (8,), (6, 4), r"\(6, 4\)"),
    ],
)
def test_numpy_kernel_refuses_shapes(state, parameters, out, found):
    """The NumPy kernel names the shapes that do not fit."""
    namespace = {}
    exec(render_system(HEAVY_TOP)["kernel.py"], namespace)
    target = None if out is None else np.empty(out)
    with pytest.raises(ValueError, match=found):
        namespace["rhs"](np.ones(state), np.ones(parameters), target)


@pytest.mark.parametrize("size", [1, 5, 12_001])
def test_numpy_kernel_divides_by_zero(size):
    """Shared parameters of zero give infinities and NaN, as those of each member do."""
    namespace = {}
    exec(render_system(HEAVY_TOP)["kernel.py"], namespace)
    parameters = np.array([0.0, 2.0, 3.0, 1.0, 9.0, 0.0, 0.0, 1.0])
    state = np.random.default_rng(0).normal(size=(6, size))
    for function in (namespace["rhs"], namespace["energy"]):
        own = function(state, np.repeat(parameters[:, None], size, axis=1))
        assert not np.isfinite(own).all()
        assert np.array_equal(function(state, parameters), own, equal_nan=True)
        if size == 1:
            assert np.array_equal(function(state[:, 0], parameters), own[..., 0], equal_nan=True)


def test_heads_say_where_a_file_comes_from(context):
    """Spec, template, command, licence, id, equations, arguments and costs stand in the head."""
    texts = render_system(context)
    identity = re.search(r"# id: ([0-9a-f]{16})", texts["kernel.py"])[1]
    licence = f"SPDX-License-Identifier: {context.license}" if context.license else NO_LICENSE
    for text in texts.values():
        assert "Generated by `coadjoint regenerate`" in text
        assert context.spec in text
        assert licence in text
        assert f"id: {identity}" in text
    for name in ("kernel.py", "kernel.c", "kernel_python.py"):
        assert "Operations per member:" in texts[name]
        for component in context.programs[0].state:
            assert re.search(rf"^ +\d+ +{component} +\S", texts[name], re.MULTILINE)
    assert f'ID = "{identity}"' in texts["kernel.py"]
    assert f'"{identity}"' in texts["__init__.py"]


def test_a_unit_that_ends_a_comment_is_refused():
    """No unit can carry code into a kernel."""
    spoiled = replace(
        HEAVY_TOP, state=(replace(HEAVY_TOP.state[0], unit="kg */"), HEAVY_TOP.state[1])
    )
    with pytest.raises(Exception, match=re.escape("'kg */'")):
        render_system(spoiled)


def identity(context):
    """The id of a rendering."""
    return re.search(r'ID = "(\w+)"', render_system(context)["kernel.py"])[1]


def test_the_id_changes_with_everything_that_is_rendered():
    """Units, licence, equations, functions, defaults: a change of any gives another id."""
    first, *others = HEAVY_TOP.parameters
    contexts = [
        HEAVY_TOP,
        replace(HEAVY_TOP, license=""),
        replace(HEAVY_TOP, equations=()),
        replace(HEAVY_TOP, programs=HEAVY_TOP.programs[:2]),
        replace(HEAVY_TOP, parameters=(replace(first, unit="g m^2"), *others)),
        replace(HEAVY_TOP, parameters=(replace(first, default=(1.0, 2.0, 4.0)), *others)),
    ]
    ids = [identity(context) for context in contexts]
    assert len(set(ids)) == len(ids) == 6


def test_fingerprints_tell_names_from_texts():
    """Moving a text from one file to another changes the fingerprint."""
    assert fingerprint({"a": "x", "b": "y"}) != fingerprint({"a": "y", "b": "x"})


def test_rendering_is_the_same_in_every_process():
    """Four hash seeds, of which this process has one, and one text."""
    script = (
        "import json; from tests.programs import HEAVY_TOP, PENDULUM;"
        "from coadjoint.render.kernels import render_system;"
        "print(json.dumps([render_system(context) for context in (HEAVY_TOP, PENDULUM)]))"
    )
    path = os.pathsep.join(sys.path)
    runs = {
        subprocess.run(
            [sys.executable, "-c", script],
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": path},
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        for seed in ("0", "1", "2")
    }
    assert runs == {json.dumps([render_system(each) for each in (HEAVY_TOP, PENDULUM)]) + "\n"}


def test_programs_keep_their_costs_in_sight():
    """Operation counts of the text are those of the Program."""
    rhs: Program = HEAVY_TOP.programs[0]
    counts = ", ".join(f"{count} {kind}" for kind, count in rhs.operation_counts().items())
    assert counts == "12 add, 18 multiply, 3 divide"
    assert f"Operations per member: {counts}." in render_system(HEAVY_TOP)["kernel.c"]
