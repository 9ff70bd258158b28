"""Kernels and solvers of equal members under sanitizers of addresses, behaviour and threads.

Several numbers of members, with whole blocks and without, one trajectory and some. Two threads
share a batch, as in `simulate`. `tests.render.test_sanitizers` does the same for other systems.
"""

import re

import pytest

from coadjoint.resources import derivations_folder, systems_folder
from tests import specs
from tests.conftest import FAMILIES, FIELDS
from tests.families import MOVED, TOPS, render
from tests.kernels import COMPILER
from tests.render.test_sanitizers import SANITIZERS, compile_and_run

pytestmark = pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")

MAIN = """#include "kernel.h"
#include "solver.h"
#include <pthread.h>
#include <stdlib.h>
enum { COMPONENTS = %(components)d, SHARED = %(shared)d, INDEXED = %(indexed)d, SMALL = %(small)d };
enum { SAMPLES = 3, MAX_STEPS = 12 };
static double *fill(size_t size, double first)
{
    double *array = malloc((size + 1) * sizeof *array);
    for (size_t i = 0; i < size; ++i)
        array[i] = first + 0.01 * (double)(i %% 97);
    return array;
}
static void *advance(void *given)
{
    %(name)s_solver_ensemble *run = given;
    run->scratch = malloc(%(name)s_solver_work(run) * sizeof(double));
    while (%(name)s_solver_advance(run))
        continue;
    free(run->scratch);
    return 0;
}
static void evaluate(size_t size, size_t count)
{
    const size_t rows = COMPONENTS * size, values = SHARED + INDEXED * size;
    double *state = fill(2 * rows * count, 0.5), *parameters = fill(values * count, 1.0);
%(driving)s
    double sizes[1] = {(double)size};
    for (size_t separate = 0; separate < 2; ++separate) {
        const size_t stride = separate ? count : 0;
        double *out = fill(OUT * count, 0.0);
%(calls)s
        free(out);
    }
    free(state), free(parameters)%(freed)s;
}
static int simulate(size_t size, size_t members, double step)
{
    const size_t rows = COMPONENTS * size, values = SHARED + INDEXED * size;
    double *state = fill(rows * members, 0.5), *parameters = fill(values, 1.0);
%(signals)s
    double *time = calloc(members, 8), *first = calloc(members, 8);
    double *out = fill(rows * members * SAMPLES, 0.0), sizes[1] = {(double)size};
    double samples[SAMPLES] = {0.001, 0.01, 0.02};
    double *memory = calloc(rows * members, 8);
    size_t *sweeps = calloc(members, 8);
    size_t *next = calloc(members, 8), *steps = calloc(members, 8), *rejected = calloc(members, 8);
    int8_t *status = calloc(members, 1);
    %(name)s_solver_ensemble run = {
        .rates = %(name)s_rhs, %(projection)s .sizes = sizes, .rows = rows,
        .parameter_rows = values, .members = members, .last = members, .state = state, .time = time,
        .step = first, .next = next, .steps = steps, .rejected = rejected, .status = status,
        .memory = memory, .sweeps = sweeps,
        .parameters = parameters, .samples = samples, .sample_count = SAMPLES, .out = out,
        %(lines)s
        .rtol = 1e-6, .atol = 1e-6, .size = step, .max_steps = MAX_STEPS, .work = 3};
    %(name)s_solver_ensemble rest = run;
    rest.first = run.last = members / 2;
    pthread_t thread;
    if (pthread_create(&thread, 0, advance, &rest))
        return 2;
    advance(&run);
    pthread_join(thread, 0);
    int on = 0;
    for (size_t n = 0; n < members; ++n)
        on |= status[n] == 0 || steps[n] + rejected[n] == 0;
    free(state), free(parameters), free(time), free(first), free(out);
    free(memory), free(sweeps);
    free(next), free(steps), free(rejected), free(status)%(freed_signals)s;
    return on;
}
int main(void)
{
    const size_t sizes[] = {%(sizes)s};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; ++k)
        for (size_t count = 1; count < 13; count += 11) {
            evaluate(sizes[k], count);
            if (simulate(sizes[k], count, 0.005))
                return 1;
#if !defined(HEUN) && !defined(MIDPOINT) && !defined(ISOSPECTRAL_MIDPOINT) && !defined(SPLITTING)
            if (simulate(sizes[k], count, 0.0))
                return 1;
#endif
        }
    return 0;
}
"""
METHODS = {"rk4": "RK4", "dop853": "DOP853", "taylor": "ORDER=6"}
MEMBERS = tuple(METHODS.values())  # entries of matrices have one more
METHODS |= {"splitting": "SPLITTING", "isospectral_midpoint": "ISOSPECTRAL_MIDPOINT"}


def has_method(name, method):
    """Whether a shipped family has a method: of what is solved for first there are no series.

    Python leads the steps of a field in a plane.
    """
    solver = systems_folder() / name / "solver.py"
    if name != "tops" and not solver.exists():
        return False
    if method == "splitting":
        return name == "tops" or "defined(SPLITTING)" in solver.with_name("solver.c").read_text()
    if name == "tops" or method not in ("taylor", "isospectral_midpoint"):
        return method != "isospectral_midpoint"
    if method == "taylor":
        return "SOLVES" not in solver.read_text()
    return "\n[truncation]\n" in (derivations_folder() / f"{name}.toml").read_text()


NOISY = {"heun": "HEUN", "midpoint": "MIDPOINT"}
#: What a family has in addition that inputs, the time and noise move; else nothing.
DRIVEN = {
    "driving": """    const size_t input_rows = 1 + size;
    double *inputs = fill(input_rows * count, 0.1), *time = fill(count, 0.2);""",
    "freed": ", free(inputs), free(time)",
    "signals": """    const size_t input_rows = 1 + size;
    double *inputs = fill(2 * input_rows, 0.1), *slopes = fill(2 * input_rows, 0.2);
    const double knots[2] = {0.0, 0.007};""",
    "freed_signals": ", free(inputs), free(slopes)",
    "lines": """.noise_vector = moved_noise_vector, .driving_rows = input_rows + 1, .knots = knots,
        .inputs = inputs, .input_slopes = slopes, .pieces = 2, .processes = 1 + 2 * size, .seed = 1,
        .bound = 2.0,""",
}


def write(rendered, change=lambda main: main):
    """The files of a family with a program that calls all of it."""
    family, texts = rendered.family.family, rendered.texts
    name = rendered.equations.spec.name
    functions = re.findall(rf"void {name}_(\w+)\(\s*size_t count", texts["kernel.h"])
    driven = DRIVEN if family.noise else dict.fromkeys(DRIVEN, "")
    driving = "inputs, stride, time, separate, " if family.noise else ""
    given = f"count, state, count, parameters, stride, {driving}sizes, 0, out, count"
    calls = "\n".join(f"        {name}_{each}({given});" for each in functions)
    totals = max(10 * len(family.states), len(family.totals), len(family.residuals))
    main = {
        **driven,
        "name": name,
        "components": len(family.states),
        "shared": len(family.shared),
        "indexed": len(family.indexed),
        "small": family.small,
        "calls": calls,
        "projection": " ".join(
            f".{each} = {name}_{each},"
            for each in functions
            if each.startswith("flow") or (each == "projection" and family.turned)
        ),
        "sizes": "SMALL, SMALL + 1, 7, 17, 43",
    }
    if family.matrices is not None:
        own = ("energy_gradient", "bracket_vector", "sandwich")
        rows = [n for n in (2, 3, 4, 5, 7) if n >= family.small and family.index.allows(n)]
        main["sizes"] = ", ".join(str(n * n) for n in rows)
        main["projection"] = " ".join(f".{each} = {name}_{each}," for each in own)
    main = MAIN % main
    files = {n: texts[n] for n in ("kernel.c", "kernel.h", "solver.c", "solver.h")}
    return files | {"main.c": change(main.replace("OUT", f"({totals} * size)"))}


@pytest.fixture(scope="module")
def tops():
    """Tops in a row: ends, attitudes, parameters of members."""
    return render(TOPS, "tops")


@pytest.fixture(scope="module")
def moved():
    """Spins that inputs, the time and noise move."""
    return render(MOVED, "moved")


@pytest.mark.campaign
@pytest.mark.parametrize("sanitizers", SANITIZERS)
@pytest.mark.parametrize("define", [*MEMBERS, *NOISY.values()])
def test_the_sanitizers_find_nothing_in_what_drives_members(moved, define, sanitizers, tmp_path):
    """Lines of inputs that end within the run, times of their own, increments of the noise."""
    done = compile_and_run(sanitizers, write(moved), tmp_path, f"-D{define}")
    assert done == (0, "")


CASES = [
    pytest.param(name, method, each, marks=[pytest.mark.campaign] * (name != "tops" or slow))
    for name in ("tops", *FAMILIES, *FIELDS)
    for method in METHODS
    if has_method(name, method)
    for each in SANITIZERS
    for slow in ((method, each) != ("rk4", "address,undefined"),)
]


@pytest.mark.parametrize(("name", "method", "sanitizers"), CASES)
def test_the_sanitizers_find_nothing(tops, name, method, sanitizers, tmp_path):
    """Every function and method, shared parameters and separate ones, odd numbers of members."""
    rendered = tops if name == "tops" else specs.rendered(name)
    define = f"-D{METHODS[method]}"
    done = compile_and_run(sanitizers, write(rendered), tmp_path, define)
    assert done == (0, "")


@pytest.mark.campaign
@pytest.mark.parametrize(
    ("sanitizers", "good", "bad"),
    [
        ("address,undefined", "work(run) * sizeof(double)", "work(run)"),
        ("thread", "rest.first = run.last = members / 2", "run.last = members / 2"),
    ],
    ids=SANITIZERS,
)
def test_the_sanitizers_see_what_is_wrong(tops, sanitizers, good, bad, tmp_path):
    """Scratch with too little room, and two threads with the same trajectories."""
    assert good in MAIN
    files = write(tops, lambda main: main.replace(good, bad))
    status, said = compile_and_run(sanitizers, files, tmp_path, "-DDOP853")
    assert status != 0
    assert "Sanitizer" in said
