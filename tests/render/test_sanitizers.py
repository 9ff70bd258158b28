"""Kernels of shipped systems under the address, undefined-behaviour and thread sanitizers.

Two threads evaluate the halves of one batch, as users of kernels do. Solvers run under the same
sanitizers in `tests.solve.test_steps`, systems of equal members in
`tests.render.test_sanitized_families`.
"""

import math
import os
import pkgutil
import re
import shutil
import subprocess
from importlib import import_module

import pytest

from coadjoint import systems
from coadjoint.kernel_functions import KERNEL_FUNCTIONS
from tests.conftest import FAMILIES, FIELDS
from tests.kernels import COMPILER, STRICT

pytestmark = pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
SANITIZERS = ("address,undefined", "thread")
NAMES = sorted(
    {each.name for each in pkgutil.iter_modules(systems.__path__)} - {*FAMILIES, *FIELDS}
)
#: What every `make test` looks at: constraints, observables and a reconstruction.
ALWAYS = "chaplygin_sleigh"

MAIN = """#include "kernel.h"
#include <pthread.h>
#include <stdlib.h>
enum {{ STATE = {state}, PARAMETERS = {parameters}, INPUTS = {inputs}, OUT = {out} }};
typedef struct {{
    size_t first, last, members, separate;
    const double *state, *both, *parameters, *inputs, *time;
    double *out;
}} Part;
static void *evaluate(void *given)
{{
    const Part *p = given;
    const size_t count = p->last - p->first, members = p->members;
    const size_t stride = p->separate ? members : 0, own = p->separate ? p->first : 0;
    (void)own;
{calls}
    return 0;
}}
static double *fill(size_t size)
{{
    double *array = malloc(size * sizeof *array);
    for (size_t i = 0; i < size; ++i)
        array[i] = 0.5 + 0.001 * (double)(i % 97);
    return array;
}}
int main(void)
{{
    for (size_t members = 0; members < 24; members += 3)
        for (size_t separate = 0; separate < 2; ++separate) {{
            const size_t many = separate ? members : 1;
            double *state = fill(STATE * members), *both = fill(2 * STATE * members);
            double *parameters = fill(PARAMETERS * many);
            double *inputs = fill(INPUTS * many), *time = fill(many), *out = fill(OUT * members);
            Part one = {{0, members / 2, members, separate, state, both, parameters, inputs, time,
                        out}};
            Part other = one;
            other.first = members / 2, other.last = members;
            pthread_t thread;
            if (pthread_create(&thread, 0, evaluate, &other))
                return 2;
            evaluate(&one);
            pthread_join(thread, 0);
            free(state), free(both), free(parameters), free(inputs), free(time), free(out);
        }}
    return 0;
}}
"""
#: How a call gives each array that a function may take.
GIVEN = {
    "state": "p->state + p->first, members",
    "both": "p->both + p->first, members",  # the state with a vector below it
    "parameters": "p->parameters + own, stride",
    "inputs": "p->inputs + own, stride",
    "time": "p->time + own, stride",
    "out": "p->out + p->first, members",
}


def write_driver(system):
    """A program that calls every function of a kernel."""
    header = (system.folder / "kernel.h").read_text()
    calls = []
    for name in system.functions:
        (listed,) = re.findall(rf"void {system.name}_{name}\(\s*size_t count,([^)]*)\);", header)
        first, *arrays = re.findall(r"double \*(\w+)", listed)
        assert first == "state"
        first = "both" if KERNEL_FUNCTIONS[name].below == "vector" else first
        given = ", ".join(GIVEN[array] for array in (first, *arrays))
        calls.append(f"    {system.name}_{name}(count, {given});")
    return MAIN.format(
        state=system.STATE.size + system.RECONSTRUCTED.size,
        parameters=system.PARAMETERS.size,
        inputs=system.INPUTS.size,
        out=max(math.prod(shape) for shape in system.functions.values()),
        calls="\n".join(calls),
    )


def run_under(sanitizers, system, main, folder):
    """The exit status of a driver, and what the sanitizers say."""
    files = {file: (system.folder / file).read_text() for file in ("kernel.c", "kernel.h")}
    return compile_and_run(sanitizers, files | {"main.c": main}, folder)


def compile_and_run(sanitizers, files, folder, *options):
    """The exit status of a program of some files, and what the sanitizers say.

    Nothing is optimised: that takes a seventh of the time, and leaves every access to be watched.
    """
    for file, text in files.items():
        (folder / file).write_text(text)
    flags = ["-g", "-O0", f"-fsanitize={sanitizers}", "-fno-sanitize-recover=all", "-pthread"]
    sources = [file for file in files if file.endswith(".c")]
    command = [shutil.which("gcc") or COMPILER, *STRICT, *flags, *options, *sources]
    subprocess.run([*command, "-o", "main", "-lm"], cwd=folder, check=True, capture_output=True)
    environment = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0"}  # leaks need ptrace
    done = subprocess.run([str(folder / "main")], check=False, env=environment, capture_output=True)
    return done.returncode, done.stderr.decode()


def load(name):
    """A shipped system."""
    return import_module(f"coadjoint.systems.{name}").system


@pytest.mark.parametrize("sanitizers", SANITIZERS)
@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.campaign] * (name != ALWAYS)) for name in NAMES],
)
def test_the_sanitizers_find_nothing(name, sanitizers, tmp_path):
    """Every function of a kernel, shared parameters and separate ones, batches of odd sizes."""
    system = load(name)
    assert run_under(sanitizers, system, write_driver(system), tmp_path) == (0, "")


@pytest.mark.parametrize(
    ("sanitizers", "good", "bad"),
    [
        ("address,undefined", "*out = fill(OUT * members)", "*out = fill(OUT * members - 1)"),
        ("thread", "other.first = members / 2", "other.first = 0"),
    ],
    ids=SANITIZERS,
)
def test_the_sanitizers_see_what_is_wrong(sanitizers, good, bad, tmp_path):
    """Results with room for a number too few, and two threads with the same members."""
    system = load(ALWAYS)
    main = write_driver(system)
    assert good in main
    status, said = run_under(sanitizers, system, main.replace(good, bad), tmp_path)
    assert status != 0
    assert "Sanitizer" in said
