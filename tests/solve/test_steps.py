"""Parts of the methods of integration: logarithms, powers, tables; and C under sanitizers."""

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import DOP853

from coadjoint.lower.tableau import END, FIFTH, STAGES, THIRD, dop853, load_dop853
from coadjoint.render.kernels import render_system
from coadjoint.solve.steps import rough_log2, rough_power
from coadjoint.systems import heavy_top, heisenberg_lattice
from tests.kernels import COMPILER, STRICT
from tests.programs import BOUNDED, HEAVY_TOP, PENDULUM
from tests.solve.systems import EMPTYING


def test_rough_logarithms_are_within_a_hundredth():
    """Over all magnitudes of normal numbers, and over all mantissas."""
    numbers = np.ldexp(np.linspace(1, 2, 1001)[:, np.newaxis], np.arange(-1000, 1000, 37))
    error = np.abs(rough_log2(numbers) - np.log2(numbers))
    assert error.max() < 0.01
    assert error.max() > 0.005  # it is rough


def test_rough_logarithms_of_what_is_no_number():
    """Zero is very small; infinity and what is not a number are very large."""
    zero, infinite, none = rough_log2(np.array([0.0, np.inf, np.nan]))
    assert zero < -1000
    assert infinite >= 1000
    assert none >= 1000


def test_rough_powers_are_within_one_part_in_5000():
    """Positive and negative; whole ones are exact."""
    octaves = np.linspace(-1000, 1000, 80001)
    error = np.abs(rough_power(octaves) / np.exp2(octaves) - 1)
    assert error.max() < 2e-4
    assert error.max() > 5e-5  # it is rough
    assert rough_power(np.array([1.0, 0.0, -2.0])).tolist() == [2.0, 1.0, 0.25]


def weights(row):
    """A row of the table in full."""
    full = np.zeros(16)
    for weight, column in dop853().row(row):
        full[column] = weight
    return full


@pytest.mark.parametrize("is_there", [True, False])
def test_the_table_is_that_of_scipy(monkeypatch, is_there):
    """Read from its file, or by its package where there is no such file."""
    if not is_there:
        monkeypatch.setattr(Path, "is_file", lambda path: False)
    found = load_dop853.__wrapped__()
    assert (found is DOP853) != is_there
    for name in ("A", "B", "C", "D", "E3", "E5", "A_EXTRA", "C_EXTRA"):
        assert np.array_equal(getattr(found, name), getattr(DOP853, name)), name


def test_the_table_meets_order_conditions():
    """Rows add up to their nodes, and quadrature has order 8 (Hairer, Norsett and Wanner, II.1)."""
    nodes = np.array(dop853().nodes)
    assert nodes[0] == 0
    assert nodes[END] == 1
    for stage in range(STAGES):
        assert weights(stage).sum() == pytest.approx(nodes[stage], abs=1e-14)
    b, c = weights(END)[:STAGES], nodes[:STAGES]
    for power in range(8):
        assert (b * c**power).sum() == pytest.approx(1 / (power + 1), abs=1e-14)
    a = np.array([weights(stage)[:STAGES] for stage in range(STAGES)])
    for power in range(1, 7):  # trees of height two
        assert b @ a @ c**power == pytest.approx(1 / ((power + 1) * (power + 2)), abs=1e-14)


def test_estimates_of_the_error_see_orders_five_and_three():
    """What is subtracted from the step is another quadrature of that order."""
    c = np.append(np.array(dop853().nodes)[:STAGES], 0)
    for row, order in ((FIFTH, 5), (THIRD, 3)):
        defects = [abs((weights(row)[: STAGES + 1] * c**power).sum()) for power in range(order + 1)]
        assert max(defects[:order]) < 1e-13
        assert defects[order] > 1e-4


MAIN = """#include "solver.h"
#include <stdio.h>
#include <pthread.h>
#include <stdlib.h>
enum { WIDTH = 5 + %(state)d * (%(degree)d + 1), ROOM = 35 };
/* Where the square of a component is 1.1, by COMPONENT, MULTIPLY, SHIFT, SIZE and SOUGHT. */
static const %(name)s_term terms[] = {
    {.kind = 1}, {.kind = 7}, {.kind = 9, .left = 1, .value = -1.1}, {.kind = 12, .left = 1},
    {.kind = 13, .left = 2, .right = 3, .value = -1.0}};
/* Advance members in short calls, which record their steps, or those near an event. */
static void *advance(void *given)
{
    %(name)s_run *run = given;
    if (run->members %% 2)
        run->terms = terms, run->term_count = 5;
    run->record = calloc(WIDTH * ROOM, 8), run->record_room = ROOM;
    do
        run->recorded = 0;
    while (%(name)s_advance(run));
    free(run->record);
    return 0;
}
int main(void)
{
    enum { STATE = %(state)d, PARAMETERS = %(parameters)d, SAMPLES = 5 };
    for (size_t members = 1; members < 20; members += 3) {
        double *state = calloc(STATE * members, 8), *time = calloc(members, 8);
        double *late = calloc(members, 8), *step = calloc(members, 8);
        double *out = calloc(STATE * members * SAMPLES, 8);
        size_t *next = calloc(members, 8), *steps = calloc(members, 8);
        size_t *rejected = calloc(members, 8);
        int8_t *status = calloc(members, 1);
        double parameters[PARAMETERS + 1], knot[1] = {0.0};
        double samples[SAMPLES] = {0.1, 0.11, 0.5, 0.7, 1.0};
        for (size_t i = 0; i < STATE * members; ++i)
            state[i] = 0.5 + 0.01 * (double)i;
        for (int i = 0; i < PARAMETERS; ++i)
            parameters[i] = 1.0 + 0.1 * i;
        %(name)s_run run = {
            .members = members, .last = members, .state = state, .time = time, .late = late,
            .step = step, .next = next, .steps = steps, .rejected = rejected, .status = status,
            .parameters = parameters, .knots = knot, .inputs = knot, .slopes = knot, .pieces = 1,
            .samples = samples, .sample_count = SAMPLES, .out = out, .rtol = 1e-8, .atol = 1e-8,
            .size = %(size)s, .max_steps = 1000, .work = 3};
        %(name)s_run rest = run;
        rest.first = run.last = members / 2;
        pthread_t thread;
        if (pthread_create(&thread, 0, advance, &rest))
            return 2;
        advance(&run);
        pthread_join(thread, 0);
        for (size_t n = 0; n < members; ++n)
            if (status[n] != %(status)d || (status[n] == 1) != (next[n] == SAMPLES))
                return 1;
        free(state), free(time), free(late), free(step), free(out), free(next);
        free(steps), free(rejected), free(status);
    }
    return 0;
}
"""
#: System, method, degree of its polynomials, fixed step, and the status of all members.
RUNS = {
    "taylor": (HEAVY_TOP, "ORDER=9", 9, "0.0", 1),
    "dop853": (PENDULUM, "DOP853", 7, "0.0", 1),
    "rk4": (HEAVY_TOP, "RK4", 3, "0.03", 1),
    "limits": (BOUNDED, "ORDER=6", 6, "0.0", 5),
    "branches": (EMPTYING, "ORDER=6", 6, "0.0", 1),
}


SANITIZERS = ("address,undefined", "thread")


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
@pytest.mark.parametrize(
    ("name", "sanitizers"),
    [
        pytest.param(name, each, marks=[pytest.mark.campaign] * (name != "limits"))
        for name in RUNS
        for each in SANITIZERS
    ],
)
def test_the_sanitizers_find_nothing(name, sanitizers, tmp_path):
    """Solvers run in two threads under sanitizers with odd numbers of members, and record steps."""
    assert run_under(sanitizers, name, MAIN, tmp_path) == 0


@pytest.mark.campaign
@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
@pytest.mark.parametrize(
    ("sanitizers", "good", "bad"),
    [
        ("address,undefined", "calloc(WIDTH * ROOM, 8)", "calloc(WIDTH * 2, 8)"),
        ("thread", "rest.first = run.last", "rest.last = run.last"),
    ],
)
def test_the_sanitizers_see_what_is_wrong(sanitizers, good, bad, tmp_path):
    """A record with room for a number too few, and two threads with the same members."""
    assert good in MAIN
    assert run_under(sanitizers, "limits", MAIN.replace(good, bad), tmp_path) != 0


def run_under(sanitizers, name, main, folder):
    """The exit status of a driver of some solver that is compiled with sanitizers."""
    context, define, degree, size, status = RUNS[name]
    texts = render_system(context)
    rhs = next(each for each in context.programs if each.name == "rhs")
    sizes = {"state": len(rhs.state), "parameters": len(rhs.parameters)}
    sizes |= {"degree": degree, "status": status}
    texts |= {"main.c": main % {**sizes, "name": context.name, "size": size}}
    for file in ("main.c", "solver.c", "solver.h"):
        (folder / file).write_text(texts[file])
    flags = ["-g", "-O1", f"-fsanitize={sanitizers}", "-fno-sanitize-recover=all", "-pthread"]
    command = [shutil.which("gcc") or COMPILER, *STRICT, *flags, f"-D{define}"]
    command += ["main.c", "solver.c", "-o", "main", "-lm"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    environment = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0"}  # leaks need ptrace
    done = subprocess.run([str(folder / "main")], check=False, env=environment, capture_output=True)
    return done.returncode


@pytest.mark.parametrize("target", ["c", "numpy"])
@pytest.mark.parametrize("method", ["rk4", "midpoint", "splitting4"])
def test_steps_of_one_length_are_all_equal(method, target):
    """0.15 and 3*0.05 are different doubles, and three steps lead to both; 1e-12 more is a part."""
    start, ends = [0.4, 0.9, 1.2, 0.6, 0.0, 0.8], (0.15, 3 * 0.05, 0.15 * (1 + 1e-12))
    one, same, other = (
        heavy_top.simulate(start, (0, end), method=method, step=0.05, samples=2, target=target)
        for end in ends
    )
    assert one.time[-1] != same.time[-1]
    assert (one.state[:, -1] == same.state[:, -1]).all()
    assert (one.state[:, -1] != other.state[:, -1]).any()


@pytest.mark.parametrize("target", ["c", "numpy"])
def test_steps_of_equal_members_are_all_equal(target):
    """The same of a family."""
    spins = {"S": np.random.default_rng(0).normal(size=(3, 1000))}
    given = {"method": "midpoint", "step": 0.05, "samples": 2, "target": target}
    lattice = heisenberg_lattice.system.resize({"i": 1000})
    one, same, other = (
        lattice.simulate(spins, (0, end), **given).state[:, -1]
        for end in (0.15, 3 * 0.05, 0.15 * (1 + 1e-12))
    )
    assert (one == same).all()
    assert (one != other).any()
