"""Headers of methods: compiled as C99 and as C++17, they have the bits of the library."""

import re
import shutil
import subprocess
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError, SpecError
from coadjoint.export import export_header, find_sample
from coadjoint.lower.mapped import lower_maps
from coadjoint.pipeline import Rendered
from coadjoint.prove import Certificate
from coadjoint.prove.declaration import kernel_context
from coadjoint.prove.methods import judge_methods
from coadjoint.render.header import find_method, find_obstacle, render_header
from coadjoint.solve.self_check import Runs
from coadjoint.systems import (
    heavy_top,
    quadrotor,
    rigid_body,
    so5_body,
    spacecraft_wheels,
    two_field_top,
)
from tests.kernels import COMPILER
from tests.programs import program
from tests.specs import emitted, lowered

CPP = shutil.which("c++") or shutil.which("g++") or shutil.which("clang++")
COMPILERS = [
    pytest.param(
        (COMPILER, "-std=c99"), marks=pytest.mark.skipif(not COMPILER, reason="no C compiler")
    ),
    pytest.param(
        (CPP, "-std=c++17", "-x", "c++"),
        marks=pytest.mark.skipif(not CPP, reason="no C++ compiler"),
    ),
]
STRICT = ("-O2", "-Wall", "-Wextra", "-Werror", "-pedantic", "-ffp-contract=off")
needs_compiler = pytest.mark.skipif(not COMPILER, reason="no C compiler")

#: Systems, where a run begins, and methods: one of each text of methods, and those of attitudes.
RUNS = {
    "rigid_body": (rigid_body, [0.4, 1.1, -0.7], ("exact_body", "kahan", "spherical_midpoint6")),
    "heavy_top": (
        heavy_top,
        [0.4, -0.3, 1.2, 0.6, 0.0, 0.8],
        ("rk4", "dop853", "splitting4", "spherical_midpoint", "coadjoint_mean4", "gauss6",
         "midpoint4", "discrete_gradient", "average_gradient"),
    ),
    "so5_body": (so5_body, np.linspace(-0.5, 0.4, 10), ("isospectral_midpoint4",)),
    "quadrotor": (quadrotor, None, ("rk4", "gauss4")),
    "spacecraft_wheels": (spacecraft_wheels, None, ("midpoint",)),
}  # fmt: skip
STEPS, STEP = 7, 0.0625


def export(name):
    """What headers of a shipped system are made from, without a certificate."""
    equations, programs = emitted(name), lowered(name)
    maps = lower_maps(equations, programs["rhs"])
    empty = Certificate(name, ())
    _, methods = judge_methods(equations, empty, programs, maps)
    return kernel_context(equations, programs, 0, maps, methods), methods


def header(name, method, sample=None):
    """The header of a method of a shipped system."""
    context, methods = export(name)
    assert not find_obstacle(context)
    return render_header(context, *find_method(method, name, methods), sample)


def start_of(system, given):
    """A state that a run may begin with, on constraints, and values of the inputs."""
    state = Runs(system.system).states[:, 0] if given is None else given
    return np.array(state, dtype=float), np.linspace(0.3, 0.9, system.system.INPUTS.size)


def write(values):
    """Numbers as C reads them back to the bit."""
    return ", ".join(float(x).hex() for x in values)


def write_program(name, system, state, inputs, headers):
    """A program that prints the bits of states after some steps, method by method."""
    lines = [f'#include "{name}_{method}.h"' for method in headers]
    lines += ["#include <stdio.h>", "int main(void)", "{"]
    parameters = [x for each in system.PARAMETERS.values() for x in each.default]
    lines.append(f"    const {name}_parameters p = {{{write(parameters)}}};")
    if inputs.size:
        lines.append(f"    const {name}_inputs u = {{{write(inputs)}}};")
    for method, text in headers.items():
        own = f"{name}_{method}"
        keeps = f"{own}_memory" in text
        given = ["&x", *(["&memory"] if keeps else []), "&p", *(["&u", "0"] if inputs.size else [])]
        lines += ["    {", f"        {name}_state x = {{{write(state)}}};"]
        lines += [f"        {own}_memory memory = {{{{0.0}}}};"] * keeps
        lines += [
            f"        for (int n = 0; n < {STEPS}; ++n)",
            f"            if ({own}_step({', '.join([*given, STEP.hex()])}) != {own.upper()}_DONE)",
            "                return 1;",
            *(f'        printf("%a ", x.{each});' for each in system.system.STATE.components),
            '        printf("\\n");',
            "    }",
        ]
    return "\n".join([*lines, "    return 0;", "}", ""])


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A folder with all headers of these runs, and their texts by system and method."""
    place, texts = tmp_path_factory.mktemp("headers"), {}
    for name, (_, _, methods) in RUNS.items():
        texts[name] = {method: header(name, method) for method in methods}
        for method, text in texts[name].items():
            (place / f"{name}_{method}.h").write_text(text)
    return place, texts


def compile_program(folder, compiler, source, *flags):
    """The program of a source, warnings as errors."""
    target = folder / "program"
    command = [*compiler, *STRICT, *flags, str(source), "-o", str(target), "-lm"]
    subprocess.run(command, check=True, cwd=folder, capture_output=True, text=True)
    return target


@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("name", RUNS)
def test_headers_have_the_bits_of_the_library(made, compiler, name):
    """Several in one program, each after seven steps where `simulate` ends, the first one in C."""
    (folder, texts), (system, given, methods) = made, RUNS[name]
    state, inputs = start_of(system, given)
    source = folder / f"{name}.c"
    source.write_text(write_program(name, system, state, inputs, texts[name]))
    program = compile_program(folder, compiler, source)
    printed = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    found = [[float.fromhex(x) for x in line.split()] for line in printed.splitlines()]
    assert len(found) == len(methods)
    driven = {"inputs": inputs} if inputs.size else {}
    for method, end in zip(methods, found, strict=True):
        driven["target"] = "c" if method == methods[0] else "numpy"  # which are twins
        span = (0.0, STEPS * STEP)
        run = system.simulate(state, span, method=method, step=STEP, samples=1, **driven)
        assert run.status == "OK"
        assert end == run.state[:, -1].tolist(), method
        assert not np.array_equal(end, state), method


# -- the test that a header brings ----------------------------------------------------------------


@pytest.fixture(scope="module")
def tested(tmp_path_factory):
    """Headers with their tests, in a folder."""
    place = tmp_path_factory.mktemp("tested")
    for method in ("midpoint", "rk4"):
        sample = find_sample(rigid_body.system, method)
        (place / f"{method}.h").write_text(header("rigid_body", method, sample))
    return place


def run_test(folder, text, compiler, method="midpoint"):
    """The exit status of the test of a header, and what it prints."""
    (folder / "own.h").write_text(text)
    (folder / "own.c").write_text('#include "own.h"\n')
    program = compile_program(folder, compiler, "own.c", f"-DRIGID_BODY_{method.upper()}_SELF_TEST")
    done = subprocess.run([program], check=False, capture_output=True, text=True)
    return done.returncode, done.stdout


@pytest.mark.parametrize("compiler", COMPILERS)
def test_a_header_tests_itself(tested, compiler):
    """Its run ends with the bits of the library's, and what the method keeps is kept."""
    status, printed = run_test(tested, (tested / "midpoint.h").read_text(), compiler)
    assert status == 0
    assert "48 steps end within 0.0e+00 of those of the library" in printed
    assert re.findall(r"^(\w+) changes by", printed, re.MULTILINE) == ["energy", "casimir1"]


@needs_compiler
@pytest.mark.parametrize(
    ("method", "old", "new"),
    [
        ("midpoint", "half = 0.5 * arc", "half = 0.499999999999 * arc"),
        ("midpoint", "parameters[2] = parameters->I3", "parameters[2] = parameters->I2"),
        ("rk4", "_rows[0] = _p3 * Pi2 * Pi3", "_rows[0] = _p3 * (Pi2 * Pi3)"),
    ],
)
def test_a_spoiled_header_fails_its_test(tested, method, old, new):
    """A coefficient, a parameter, and an order of operations: each changes some bits."""
    text = (tested / f"{method}.h").read_text()
    assert old in text
    assert run_test(tested, text.replace(old, new, 1), (COMPILER, "-std=c99"), method)[0] == 1


def test_the_run_of_a_self_test_begins_at_a_rotation(monkeypatch):
    """As runs of the library do, which move the start there; the steps of a header do not."""
    system = two_field_top.system
    runs, rows = Runs(system), system.STATE.rows("R")
    near = runs.states.copy()
    near[rows] *= 1 + 1e-9
    moved = SimpleNamespace(states=near, step=runs.step)
    monkeypatch.setattr("coadjoint.export.Runs", lambda _: moved)
    sample = find_sample(system, "gauss4")
    start = np.array([float.fromhex(x) for x in sample.state])
    for state, is_rotation in ((near[:, 0], False), (start, True)):
        turned = state[rows].reshape(3, 3)
        assert (abs(turned @ turned.T - np.eye(3)).max() < 4e-16) == is_rotation


@needs_compiler
def test_fast_mathematics_is_refused(tested):
    """The compiler stops, and says which option is in the way."""
    (tested / "fast.c").write_text('#include "midpoint.h"\n')
    with pytest.raises(subprocess.CalledProcessError) as caught:
        compile_program(tested, (COMPILER, "-std=c99"), "fast.c", "-ffast-math", "-c")
    assert "leave it out" in caught.value.stderr


def test_the_head_says_what_is_proved(tested):
    """Theorem, source, what is kept, units, and the licence of the spec."""
    text = (tested / "midpoint.h").read_text()
    head = " ".join(text[: text.index("#ifndef")].split())
    assert "theorem IV.2.1); its order is 2." in head
    assert "Keeps to the rounding of each step: energy, casimir1." in head
    assert "SPDX-License-Identifier: BSD-3-Clause" in head
    assert "double Pi1; /* kg m^2/s */" in text
    mean = header("rigid_body", "coadjoint_mean")
    assert "casimir1, the Poisson tensor." in mean
    assert "Keeps up to an error of O(h^2): energy." in mean
    assert "nothing that is proved" in header("rigid_body", "rk4")


def test_nothing_is_left_of_vectors(tested):
    """No lanes and no words of C alone, so that C++ reads it, and no name without the prefix."""
    text = re.sub(r"/\*.*?\*/", "", (tested / "midpoint.h").read_text(), flags=re.DOTALL)
    assert not re.findall(r"\b(?:V|I|INLINE|APART|restrict|BLOCKS|STAGES|Block)\b|\(int\)\{", text)
    defined = re.findall(r"^static [\w ]*?(\w+)[\[(]", text, re.MULTILINE)
    assert len(defined) > 10
    assert all(each.startswith("rigid_body_midpoint_") for each in defined)


# -- what is refused ------------------------------------------------------------------------------


def test_methods_that_do_not_apply_are_refused_with_the_reason():
    """By the reason of the judgement, by noise, and by a name that is none."""
    _, methods = export("rigid_body")
    with pytest.raises(KernelArgumentError, match="that has all products B A B"):
        find_method("isospectral_midpoint", "rigid_body", methods)
    with pytest.raises(KernelArgumentError, match=r"'midpont' .* no such method") as caught:
        find_method("midpont", "rigid_body", methods)
    assert "midpoint" in caught.value.expected  # the advice, which works:
    assert find_method("midpoint", "rigid_body", methods)[0].order == 2
    assert find_method("auto", "rigid_body", methods)[0].name == "spherical_midpoint"
    noisy, judged = export("stochastic_rigid_body")
    with pytest.raises(KernelArgumentError, match="its motion has noise"):
        find_method("rk4", "stochastic_rigid_body", judged, find_obstacle(noisy))


def test_kinks_and_equal_members_are_refused():
    """Rates with corners; and a family, whose rendered form has no context of a single system."""
    context, _ = export("rigid_body")
    rhs = program("rhs", "Pi1 Pi2 Pi3", "I1 I2 I3", "", "Pi2*Pi3; -sign(Pi2); Pi1*Pi2", (3,))
    assert "rates have kinks" in find_obstacle(replace(context, programs=(rhs,)))
    family = Rendered(emitted("rigid_body"), Certificate("rigid_body", ()), {}, {})
    with pytest.raises(KernelArgumentError, match=r"'rk4' .* loops over equal members"):
        export_header(family, "rk4")
    field = Rendered(emitted("kdv"), Certificate("kdv", ()), {}, {})
    with pytest.raises(KernelArgumentError, match=r"no method of kdv has a header: .* over points"):
        export_header(field, "auto")


def test_words_of_cpp_are_refused_by_name():
    """A component that C++ cannot name: the message says which. No licence is invented."""
    context, _ = export("rigid_body")
    inertia = replace(context.parameters[0], components=("new", "I2", "I3"))
    with pytest.raises(SpecError, match=r"'new' of rigid_body is a word of C\+\+") as caught:
        render_header(
            replace(context, parameters=(inertia,)), *find_method("rk4", "rigid_body", ()), None
        )
    assert caught.value.found == "new"
    free = render_header(replace(context, license=""), *find_method("rk4", "rigid_body", ()), None)
    assert "The licence of this file is that of its spec; coadjoint claims none." in free
    assert "There is no test of that" in free
