"""The ladder of solvers: good ones pass, and each kind of spoiled one is caught by its rung."""

import math
import re
from dataclasses import replace
from decimal import Decimal
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.crosscheck import solver_exact, solver_steps
from coadjoint.crosscheck import solvers as solver_checks
from coadjoint.crosscheck.ladder import crosscheck
from coadjoint.crosscheck.oracle import Bounded
from coadjoint.crosscheck.recurrences import check_recurrences, draw_points
from coadjoint.crosscheck.solver_exact import ExactStep, Solvers
from coadjoint.crosscheck.solver_objects import (
    NumpySolver,
    compile_solvers,
    list_compared,
    load_numpy,
    load_solver,
)
from coadjoint.crosscheck.solver_steps import (
    MEMBERS,
    check_bits,
    check_choice,
    check_steps,
    check_together,
)
from coadjoint.crosscheck.solver_text import SolverTexts, check_solver_texts
from coadjoint.crosscheck.solvers import _list_functions, check_solvers
from coadjoint.crosscheck.subject import Subject
from coadjoint.declared import Bound
from coadjoint.derive import derive
from coadjoint.derive.reference import Reference
from coadjoint.errors import CrossCheckError
from coadjoint.lower.kinks import hold_sides
from coadjoint.lower.lowering import lower
from coadjoint.lower.program import (
    Add,
    Call,
    Multiply,
    Negate,
    Symbol,
    children,
    with_children,
)
from coadjoint.prove.declaration import kernel_context
from coadjoint.render.kernels import render_system
from coadjoint.render.recurrences import Line
from coadjoint.render.solvers import arrange, select_programs
from coadjoint.solve.folders import load_texts
from coadjoint.solve.methods import (
    average_gradient,
    coadjoint_mean,
    gauss,
    metriplectic_gradient,
    nambu_gradient,
)
from coadjoint.solve.runge_kutta import DormandPrince8, RungeKutta4
from coadjoint.solve.steps import Taylor
from coadjoint.solver_kinds import SOLVER
from coadjoint.spec.reader import read_spec_text
from tests.kernels import COMPILER, ProgramReference
from tests.programs import BOUNDED, HEAVY_TOP, LOOPED, PENDULUM, program
from tests.specs import RIGID_BODY, lowered, spec

needs_compiler = pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
CONTEXTS = {"heavy_top": HEAVY_TOP, "pendulum": PENDULUM, "bounded": BOUNDED, "looped": LOOPED}
#: Rates with statements that are named as those of kinematics are.
NAMED = replace(
    PENDULUM,
    name="named",
    programs=(
        program(
            "rhs",
            "q p",
            "k",
            "_u1 = sin(q)*p; _s1 = q + p",
            "_u1*_s1*p; _u1*_s1*(q - p) - k*q*cos(q)",
            (2,),
        ),
        *PENDULUM.programs[1:],
    ),
)


#: A motion with the derivatives of its rates.
SLOPED = replace(
    PENDULUM,
    name="sloped",
    programs=(
        program("rhs", "q p", "k", "", "p*q; -k*q*q", (2,)),
        program("jacobian", "q p", "k", "_t1 = -2*k*q", "p; q; _t1; 0", (2, 2)),
        *PENDULUM.programs[2:],
    ),
)

#: Those that few tests look at, by name.
OTHERS = {"named": NAMED, "sloped": SLOPED}


@cache
def texts_by_name(name):
    """The files of a system."""
    return render_system((CONTEXTS | OTHERS)[name])


def rates_of(context):
    """The Program of its rates."""
    return next(each for each in context.programs if each.name == "rhs")


def recurrences_of(context):
    """Its recurrences."""
    return arrange(hold_sides(select_programs(context.programs)))


def subject(context):
    """A system with its Programs in the place of equations, and its NumPy kernel alone."""
    kernel = {}
    exec(texts_by_name(context.name)["kernel.py"], kernel)

    def function(name):
        return lambda state, parameters, target, out: kernel[name](state, parameters, out)

    system = SimpleNamespace(
        evaluate=lambda name, *given, **named: function(name)(*given, **named),
        name=context.name,
        PARAMETERS={each.name: each for each in context.parameters},
        DOMAIN=context.domain,
        **{each.name: function(each.name) for each in context.programs},
    )
    programs = {each.name: each for each in context.programs}
    return Subject(programs, ProgramReference(context.programs), system, ("numpy", "c"))


def texts_of(context, spoil=lambda texts: texts):
    """The solvers of a system as texts."""
    rendered = spoil(dict(texts_by_name(context.name)))
    programs = hold_sides(select_programs(context.programs))
    return SolverTexts(
        programs=programs,
        recurrences=arrange(programs),
        strict=tuple(bound.strict for bound in context.domain),
        files={file: rendered[file] for file in SOLVER.files},
        system=context.name,
    )


def replaced(file, good, bad):
    """A spoiler that replaces text once in one file."""

    def spoil(texts):
        assert good in texts[file], (good, file)
        return {**texts, file: texts[file].replace(good, bad, 1)}

    return spoil


# -- rung 2 ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("context", [*CONTEXTS.values(), NAMED], ids=[*CONTEXTS, "named"])
def test_recurrences_are_the_power_series(context):
    """Seven coefficients of each component are compared at two points."""
    rates = rates_of(context)
    assert check_recurrences(recurrences_of(context), subject(context)) == 2 * 7 * len(rates.state)


def changed(text, change):
    """Recurrences with one line of one stage changed."""
    stages = list(text.stages)
    for place, stage in enumerate(stages):
        for part in ("starts", "terms", "lines"):
            lines = list(getattr(stage, part))
            for row, line in enumerate(lines):
                other = change(part, line)
                if other is not None:
                    lines[row] = other
                    stages[place] = replace(stage, **{part: tuple(lines)})
                    return replace(text, stages=tuple(stages))
    raise AssertionError("nothing was changed")


def renamed(node, old, new):
    """A node with another array of coefficients."""
    if isinstance(node, Symbol):
        return Symbol(node.name.replace(f"{old}[_k", f"{new}[_k"))
    return with_children(node, [renamed(each, old, new) for each in children(node)])


def flip_term(part, line):
    """A sign within a sum."""
    if part == "terms":
        return Line(line.name, Add(line.value.left, Negate(line.value.right)))
    return None


def drop_end(part, line):
    """A sum without its last term."""
    if part == "lines" and isinstance(line.value, Add):
        return Line(line.name, line.value.left)
    return None


def take_other_order(part, line):
    """A coefficient of the order before."""
    if part == "lines" and isinstance(line.value, Add):
        left, right = line.value.right.left, line.value.right.right
        before = Symbol(left.name.replace("[_k]", "[0]"))
        return Line(line.name, Add(line.value.left, Multiply(before, right)))
    return None


@pytest.mark.parametrize("change", [flip_term, drop_end, take_other_order])
def test_a_wrong_recurrence_is_caught(change):
    """By the power series of the equations."""
    spoiled = changed(recurrences_of(HEAVY_TOP), change)
    with pytest.raises(CrossCheckError, match=r"rung 2.*recurrences") as caught:
        check_recurrences(spoiled, subject(HEAVY_TOP))
    assert caught.value.rung == 2


def test_a_wrong_partner_is_caught():
    """A sine whose slope is a sine."""
    text = recurrences_of(PENDULUM)
    sines = [line for line in text.first if isinstance(line.value, Call)]
    names = {line.value.function: line.name.removesuffix("[0]") for line in sines}

    def swap(part, line):
        if part == "terms" and f"{names['cos']}[_k - _m]" in repr(line.value):
            return Line(line.name, renamed(line.value, names["cos"], names["sin"]))
        return None

    with pytest.raises(CrossCheckError, match="rung 2"):
        check_recurrences(changed(text, swap), subject(PENDULUM))


# -- rung 3 ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("context", CONTEXTS.values(), ids=CONTEXTS)
def test_texts_read_back(context):
    """All lines and tables of the solvers are compared."""
    assert check_solver_texts(texts_of(context)) > 300


SPOILED = [
    ("solver.c", "_m < _k;", "_m <= _k;"),
    ("solver.c", "_m < _k;", "_m < _k - 1;"),
    ("solver.c", "_q8 * _j1 +", "-_q8 * _j1 +"),
    ("solver.c", "Pi2[_m] * Pi3[_k - _m]", "Pi2[_m] * Pi3[_k + _m]"),
    ("solver.c", "Pi2[_m] * Pi3[_k - _m]", "Pi2[_m] * Pi2[_k - _m]"),
    ("solver.c", "_block->fixed[1] = _p2", "_block->fixed[1] = _p3"),
    ("solver.c", "m = _block->parameters[3]", "m = _block->parameters[4]"),
    ("solver.c", "Pi2 = _path[1]", "Pi2 = _path[2]"),
    ("solver.c", "Pi2[0] = _block->state[1]", "Pi2[0] = _block->state[2]"),
    ("solver.c", "1.0 / 3,", "1.0 / 4,"),
    ("solver.c", "_rows[0] = ", "_rows[0] = -"),
    ("solver.c", "_rows[1]", "_rows[2]"),
    ("solver.c", "0.05260015195876773", "0.05260015195876774"),
    (
        "solver.c",
        "static const unsigned char starts[] = {\n    0, 0,",
        "static const unsigned char starts[] = {\n    0, 1,",
    ),
    ("solver.c", "sum = sum + weights[q]", "sum = sum - weights[q]"),
    (
        "solver.c",
        "block->time = choose(accepted, time,",
        "block->time = choose(accepted, block->time,",
    ),
    ("solver.c", "part * part < rest", "part * part < 2.0 * rest"),
    ("solver.c", "two) - 0.7", "two) - 0.9"),
    ("solver.c", "half = h * 0.5", "half = h * 0.25"),
    ("solver.h", "rtol, atol, size", "atol, rtol, size"),
    ("solver.py", "range(1, _k)", "range(1, _k - 1)"),
    ("solver.py", "for _k in range(1, order)", "for _k in range(1, order - 1)"),
    ("solver.py", "Pi2[_m] * Pi3[_k - _m]", "Pi2[_m] * Pi3[_m]"),
    ("solver.py", "m = parameters[3]", "m = parameters[4]"),
    ("solver.py", "Pi2 = path[1]", "Pi2 = path[2]"),
    ("solver.py", "1.0 / max(k, 1)", "1.0 / max(k, 2)"),
    ("solver.py", "path[:, 0] = state", "path[:, 1] = state"),
    ("solver.py", "import numpy as np", "import math as np"),
]


@pytest.mark.parametrize(("file", "good", "bad"), SPOILED)
def test_a_spoiled_text_is_caught(file, good, bad):
    """Each change of a line, a table, a loop or of what all systems share."""
    with pytest.raises(CrossCheckError, match="rung 3"):
        check_solver_texts(texts_of(HEAVY_TOP, replaced(file, good, bad)))


@pytest.mark.parametrize(
    ("good", "bad"),
    [
        ("_p1 + p - q", "_p1 - p + q"),
        ("_p1 = r / 2.0", "_p1 = r / 4.0"),
        ("rows[0] > 0.0", "rows[0] >= 0.0"),
        ("rows[1] < INFINITY", "rows[0] < INFINITY"),
        ("_t1 * q;", "_t1 * p;"),
        ("choose(finite, rows[i], state[i])", "choose(finite, state[i], rows[i])"),
        ("    const V p = _state[1];", "    const V p = _state[0];"),
        ("find_domain(block, after, state", "find_domain(block, block->time, state"),
        ("n < 40", "n < 20"),
        ("(*inside + outside) * 0.5", "(*inside + outside) * 0.25"),
    ],
)
def test_a_spoiled_limit_is_caught(good, bad):
    """Rows of the domain and of the projection, how they are compared, and where it ends."""
    with pytest.raises(CrossCheckError, match="rung 3"):
        check_solver_texts(texts_of(BOUNDED, replaced("solver.c", good, bad)))


def test_a_function_without_its_suffix_is_caught():
    """A sine of a vector is no sine of a number."""
    with pytest.raises(CrossCheckError, match="rung 3"):
        check_solver_texts(texts_of(PENDULUM, replaced("solver.c", "= sin_of(", "= sin(")))


# -- rungs 4 and 5 --------------------------------------------------------------------------------


def solvers(context, methods, folder=None, spoil=lambda texts: texts, build="exact"):
    """Solvers of some methods, in NumPy and perhaps in C."""
    system, files = subject(context), texts_of(context, spoil).files
    kernel = load_numpy(texts_by_name(context.name)["kernel.py"])
    functions = _list_functions(system, kernel, SOLVER)
    strict = tuple(bound.strict for bound in context.domain)
    numpy = NumpySolver(load_numpy(files["solver.py"]), functions, strict)
    advance = {method: {"numpy": numpy.advance(method)} for method in methods}
    path = compile_solvers(files, folder, context.name, methods, build) if folder else None
    for method in methods if path else ():
        advance[method]["c"] = load_solver(path, context.name, method)
    return Solvers(subject=system, text=recurrences_of(context), advance=advance)


def points(system):
    """A dozen members."""
    return draw_points(system.subject, 60).take(slice(MEMBERS))


@pytest.mark.parametrize("context", CONTEXTS.values(), ids=CONTEXTS)
def test_steps_of_numpy_are_exact_within_the_bound(context):
    """One step of each method; errors are below one unit and not all zero."""
    made = solvers(context, ("taylor", "dop853", "rk4"))
    for figures in check_steps(made, points(made), 0.03125).values():
        assert figures["numpy"].points == 3
        assert 0 < figures["numpy"].k < 4
    assert check_choice(made, points(made)) == 3


def test_series_and_steps_of_the_equations_are_found_once(monkeypatch):
    """Targets share them, and so do both rungs."""
    made = solvers(PENDULUM, ["taylor"])
    begun = points(made)
    check_steps(made, begun, 0.125)
    for known in (made.series, made.steps):
        assert len(known) == 3
    monkeypatch.setattr(solver_exact, "solve", None)
    assert check_choice(made, begun) == 3
    assert check_steps(made, begun, 0.125)["taylor"]["numpy"].points == 3


KINKED = """
title = "A ball that falls from both sides to a kink, and is rubbed"
routes = ["canonical"]
[variables]
q = { role = "coordinate", default = 1 }
p = { role = "momentum", of = "q" }
[parameters]
g = { positive = true, default = 1 }
[hamiltonian]
h = "p^2/2 + g*abs(q) + q^4/4"
[forces]
p = "-g*sign(p)/2"
"""
#: The same corner as a root, of which the solvers know nothing.
BRANCHED = KINKED.replace("abs(q)", "sqrt(q^2)").split("[forces]")[0]


def context_of(name, text):
    """What the kernels of a spec are rendered from."""
    equations = derive(spec(text))
    OTHERS[name] = replace(kernel_context(equations, lower(equations), 0), name=name)
    return OTHERS[name]


def test_the_choice_of_a_step_that_a_branch_point_rejects_is_compared(monkeypatch):
    """Some first steps go beyond it; what is left of them tells how long they were."""
    made = solvers(context_of("branched", BRANCHED), ("taylor",))
    assert check_choice(made, points(made)) == 3
    right = Taylor._choose
    monkeypatch.setattr(Taylor, "_choose", lambda self, path: right(self, path) * 0.97)
    with pytest.raises(CrossCheckError, match=r"rung 4.*takes the step"):
        check_choice(made, points(made))


def test_a_step_that_ends_at_a_kink_is_no_longer_than_the_chosen_one(monkeypatch):
    """Others are as long as that."""
    made = solvers(context_of("kinked", KINKED), ("taylor",))
    assert check_choice(made, points(made)) == 3
    right = Taylor._choose
    monkeypatch.setattr(Taylor, "_choose", lambda self, path: right(self, path) * 1.03)
    with pytest.raises(CrossCheckError, match=r"rung 4.*takes the step"):
        check_choice(made, points(made))


def test_recurrences_hold_the_sides_of_kinks():
    """Recurrences, their text and the steps are those of the equations between kinks."""
    context = context_of("kinked", KINKED)
    text = recurrences_of(context)
    assert [output.value for output in text.kinks.outputs] == [Symbol("q"), Symbol("p")]
    assert not text.branches
    assert check_recurrences(text, subject(context)) == 28
    assert check_solver_texts(texts_of(context)) > 300
    made = solvers(context, ("taylor", "dop853", "rk4"))
    for figures in check_steps(made, points(made), 0.03125).values():
        assert figures["numpy"].points == 3
        assert 0 < figures["numpy"].k < 4


@pytest.mark.parametrize(
    ("file", "good", "bad"),
    [
        ("solver.c", "_rows[0] = q;", "_rows[0] = p;"),
        (
            "solver.c",
            "_side1 = _block->parameters[1]",
            "_side1 = _block->parameters[2]",
        ),
        ("solver.c", "block->parameters[PARAMETERS + j]) |", "block->parameters[PARAMETERS]) |"),
        ("solver.c", "(row == 0.0)", "(row == 1.0)"),
        ("solver.c", "* 0.0625 / took", "* 0.0625 * took"),
        ("solver.py", "_rows[1] = p", "_rows[1] = q"),
        ("solver.py", "_side2 = parameters[2]", "_side2 = parameters[1]"),
        ("solver.py", '"p",\n', '"q",\n'),
        ("solver.h", "double *met;", "double *kept;"),
    ],
)
def test_a_wrong_side_in_a_text_is_caught(file, good, bad):
    """Functions of sides are read line by line, the rest letter by letter."""
    context = context_of("kinked", KINKED)
    with pytest.raises(CrossCheckError, match="rung 3"):
        check_solver_texts(texts_of(context, replaced(file, good, bad)))


@needs_compiler
@pytest.mark.parametrize(
    ("good", "bad"),
    [
        ("", ""),
        ("n < 64; ++n", "n < 40; ++n"),
        ("crossing = left;", "crossing = left & (outside < took * 0.5);"),
        ("block->kinks[w] += met[w] != 0;", ""),
        ("brief ? block->brief[w] + 1", "brief ? 1"),
        ("row[3] = time[w];", "row[3] = 0.5 * time[w];"),
        ("block->step = choose(far, took * 0.5, block->step);", ""),
    ],
)
def test_kinks_in_c_and_numpy_have_the_same_bits(tmp_path, good, bad):
    """Steps end at the same places; each change of the text of C is seen."""
    context = context_of("kinked", KINKED)
    spoil = replaced("solver.c", good, bad) if good else lambda texts: texts
    made = solvers(context, ("taylor", "dop853", "rk4"), tmp_path, spoil)
    batch = points(made)
    batch.state[:2, 0] = 0.0, 1e-12  # turns at once, and both kinks follow it
    if not good:
        assert min(check_bits(made, batch, 1.0).values()) > 100
        return
    with pytest.raises(CrossCheckError, match="rung 5"):
        check_bits(made, batch, 1.0)


def fails(made, rung, size=0.125):
    """Whether a step is refused by its rung."""
    with pytest.raises(CrossCheckError, match=f"rung {rung}"):
        check_steps(made, points(made), size)


@pytest.mark.parametrize(
    ("method", "changes"),
    [
        ("taylor", ("return path", "path[0, 7] *= 1.01; return path")),
        ("taylor", ("_parts = [1.0 / max(k, 1)", "_parts = [1.0 / max(k - 1, 1)")),
    ],
)
def test_a_wrong_coefficient_is_caught(method, changes):
    """An error of the last order alone, and a wrong order of all."""
    fails(solvers(HEAVY_TOP, (method,), spoil=replaced("solver.py", *changes)), 4)


def test_a_wrong_step_of_numpy_is_caught(monkeypatch):
    """A step of each method that is a billionth too long."""
    for kind, method in ((Taylor, "taylor"), (RungeKutta4, "rk4"), (DormandPrince8, "dop853")):
        right = kind.try_step

        def wrong(self, lanes, right=right):
            attempt = right(self, lanes)
            attempt.state = lanes.state + (attempt.state - lanes.state) * (1 + 1e-9)
            return attempt

        monkeypatch.setattr(kind, "try_step", wrong)
        fails(solvers(HEAVY_TOP, (method,)), 4)


def test_a_sample_at_another_place_is_caught(monkeypatch):
    """The state within a step is that of its time."""
    right = RungeKutta4.try_step

    def wrong(self, lanes):
        attempt = right(self, lanes)
        path = attempt.path
        attempt.path = lambda after: path(after * (1 + 1e-9))
        return attempt

    monkeypatch.setattr(RungeKutta4, "try_step", wrong)
    fails(solvers(HEAVY_TOP, ("rk4",)), 4)


def test_another_choice_of_the_step_is_caught(monkeypatch):
    """Steps of half an octave more are not those of the tolerance."""
    right = Taylor._choose
    monkeypatch.setattr(Taylor, "_choose", lambda self, path: right(self, path) * 1.5)
    made = solvers(HEAVY_TOP, ("taylor",))
    with pytest.raises(CrossCheckError, match=r"rung 4.*takes the step"):
        check_choice(made, points(made))


@needs_compiler
@pytest.mark.parametrize(("context", "least"), [(HEAVY_TOP, 500), (BOUNDED, 100), (LOOPED, 100)])
def test_c_and_numpy_have_the_same_bits(tmp_path, context, least):
    """Runs of each method, and the count of numbers."""
    made = solvers(context, ("taylor", "dop853", "rk4"), tmp_path)
    equal = check_bits(made, points(made), 0.125)
    assert min(equal.values()) > least


@needs_compiler
def test_methods_of_one_object_that_are_mistaken_for_each_other_are_caught(tmp_path):
    """An object has several methods, each under a name of its own."""
    made = solvers(HEAVY_TOP, ("dop853", "rk4"), tmp_path)
    one, other = made.advance["dop853"], made.advance["rk4"]
    one["c"], other["c"] = other["c"], one["c"]
    with pytest.raises(CrossCheckError, match="rung 5"):
        check_bits(made, points(made), 0.125)


WRONG_LIMITS_IN_C = [
    ("_p1 + p - q", "_p1 + p + q"),
    ("_rows[0] = _t1 * q", "_rows[0] = _t1 * q * 1.0000000000000002"),
    ("left |= accepted & ~are_inside(block, took, state)", "left |= accepted & block->active & 0"),
    ("*outside = choose(wanted & ~good, after, *outside);", ""),
    ("n < 40", "n < 20"),
]


@needs_compiler
@pytest.mark.parametrize(("good", "bad"), WRONG_LIMITS_IN_C)
def test_wrong_limits_in_c_are_caught_by_bits(good, bad, tmp_path, monkeypatch):
    """Where members leave the domain, and what keeps them on a circle."""
    made = solvers(BOUNDED, ("rk4",), tmp_path, replaced("solver.c", good, bad))
    runs = solver_steps._runs
    own = lambda batch, size: (each for each in runs(batch, size) if each[0] == "rk4")  # noqa: E731
    monkeypatch.setattr(solver_steps, "_runs", own)
    with pytest.raises(CrossCheckError, match="rung 5"):
        check_bits(made, points(made), 1.0)


WRONG_IN_C = [
    ("rk4", "h * 0.16666666666666666", "h * 0.16666666666666669"),
    (
        "rk4",
        "block->time = choose(accepted, time, block->time)",
        "block->time = time + took * 1e-9",
    ),
    ("rk4", "run->samples[s] - block->time[w]", "run->samples[s] - 0.5"),
    ("rk4", "block->steps + choose(accepted", "block->steps + choose(~accepted"),
    ("dop853", "sum = sum + weights[q]", "sum = weights[q] + sum * 1.0000000000000002"),
    ("dop853", "0.15200309344504997", "0.15200309344504999"),
    ("dop853", "part * part < rest", "part < rest"),
    (
        "rk4",
        "blocks[b].time = add_low(blocks[b].time, &blocks[b].late, h[b])",
        "blocks[b].time = add_low(blocks[b].time, &blocks[b].late, h[b] * 0.5)",
    ),
    ("dop853", "all(failed ? 0.0 : made)", "all(made + 1.0)"),
    ("taylor", "_m < _k;", "_m <= _k;"),
]


@needs_compiler
@pytest.mark.parametrize(("method", "good", "bad"), WRONG_IN_C)
def test_wrong_c_is_caught_by_bits(method, good, bad, tmp_path, monkeypatch):
    """Weights, time, samples, counts and control; one method is run at a time."""
    made = solvers(HEAVY_TOP, (method,), tmp_path, replaced("solver.c", good, bad))
    runs = solver_steps._runs
    own = lambda batch, size: (each for each in runs(batch, size) if each[0] == method)  # noqa: E731
    monkeypatch.setattr(solver_steps, "_runs", own)
    with pytest.raises(CrossCheckError, match="rung 5"):
        check_bits(made, points(made), 0.125)


@needs_compiler
@pytest.mark.parametrize(
    ("good", "bad"),
    [
        ("STATE", "STATE"),
        ("(i == k ? 1.0 : 0.0) - matrix[i][k]", "(i == k ? 1.0 : 0.0) - 0.5 * matrix[i][k]"),
        ("half * rows[i * SLOPES + k]", "half * rows[k * SLOPES + i]"),
    ],
)
def test_newtons_method_is_compared(good, bad, tmp_path, monkeypatch):
    """Its steps are exact within the bound in NumPy, and have the same bits in C."""
    made = solvers(SLOPED, ("midpoint_newton",), tmp_path, replaced("solver.c", good, bad))
    runs = solver_steps._runs
    own = lambda batch, size: (  # noqa: E731
        each for each in runs(batch, size) if each[0] == "midpoint_newton"
    )
    monkeypatch.setattr(solver_steps, "_runs", own)
    batch = points(made)
    if good == bad:
        assert check_steps(made, batch, 0.125)["midpoint_newton"]["c"].k < 1
        assert min(check_bits(made, batch, 0.125).values()) > 350
    else:
        with pytest.raises(CrossCheckError, match="rung 5"):
            check_bits(made, batch, 0.125)


#: A body with a quartic energy, which shows all that a mean along a chord is made of.
QUARTIC = """
title = "A body"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Pi = { role = "momentum" }
[hamiltonian]
h = "Pi1^2/2 + Pi2^2/4 + Pi3^2/6 + Pi1^4/8 + Pi2*Pi3/7"
"""
#: Functions that are not quadratic, of three coordinates and of four.
PRODUCT = """
title = "A product of gradients"
routes = ["nambu"]
[poisson]
nambu = ["x1^4/4 + x2^2/2 + x3^2/2"]
[variables]
x = { role = "coordinate", shape = [3] }
[hamiltonian]
h = "x1^2/2 + x2^4/4 + x3"
"""
PRODUCT_OF_FOUR = PRODUCT.replace('/2"]', '/2 + x4", "x1*x4 + x3^4/4"]').replace("[3]", "[4]")
#: A body whose energy and entropy are of degree 4.
RELAXING = """
title = "A body"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Pi = { role = "momentum" }
[hamiltonian]
h = "Pi1^2/2 + Pi2^2/4 + Pi3^2/6 + Pi1^4/8"
[definitions]
w = "vector(Pi1 + Pi1^3/2, Pi2/2, Pi3/3)"
[metriplectic]
S = "dot(Pi, Pi)^2/4"
G = "(dot(w, w)*hat(w)^0 - outer(w, w))/5"
"""
SPECS = {
    "nambu_gradient_newton": PRODUCT,
    "metriplectic_gradient_newton": RELAXING,
}
#: Of each method, wrong slopes in C, and what NumPy is to have in the place of a table or function.
WRONG_SLOPES = {
    "gauss4_newton": ("stage_shares[s][j] * rows[i][k]", "stage_shares[s][j] * rows[k][i]"),
    "coadjoint_mean_newton": ("slopes[i][k] - half * turn[i]", "slopes[i][k] + half * turn[i]"),
    "discrete_gradient_newton": (
        "half * rows[i * SLOPES + k]",
        "half * rows[k * SLOPES + i]",
    ),
    "nambu_gradient_newton": ("half * rows[i * SLOPES + k]", "half * rows[k * SLOPES + i]"),
    "metriplectic_gradient_newton": ("half * rows[i * SLOPES + k]", "half * rows[k * SLOPES + i]"),
}
SHARES = tuple(each[::-1] for each in gauss.TABLEAUS[4].shares)
WRONG_STEPS = {
    "gauss4_newton": (gauss, "TABLEAUS", {4: replace(gauss.TABLEAUS[4], shares=SHARES)}),
    "coadjoint_mean_newton": (coadjoint_mean, "TERMS", 1),
    "discrete_gradient_newton": (average_gradient, "NODES", average_gradient.NODES[:1]),
    "nambu_gradient_newton": (average_gradient, "NODES", average_gradient.NODES[:1]),
    "metriplectic_gradient_newton": (
        metriplectic_gradient,
        "project",
        lambda vector, along: vector,
    ),
}
#: Wrong steps in C: minors with other signs, and G that is projected along the other gradient.
WRONG_GRADIENTS = {
    "nambu_gradient_newton": (
        "? minors[set] - term : minors[set] + term",
        "? minors[set] + term : minors[set] + term",
    ),
    "metriplectic_gradient_newton": ("project(rows, g, relaxed)", "project(rows, s, relaxed)"),
}


def context_for(method):
    """What the kernels of a system that has a method are rendered from."""
    return context_of(f"quartic_{method}", SPECS.get(method, QUARTIC))


@needs_compiler
@pytest.mark.parametrize("method", WRONG_SLOPES)
@pytest.mark.parametrize("is_wrong", [False, True])
def test_newtons_method_of_other_steps_is_compared(method, is_wrong, tmp_path, monkeypatch):
    """As that of the midpoint; the steps are those of 60 digits, and slopes have the same bits."""
    runs = solver_steps._runs
    own = lambda batch, size: (each for each in runs(batch, size) if each[0] == method)  # noqa: E731
    monkeypatch.setattr(solver_steps, "_runs", own)
    spoil = replaced("solver.c", *WRONG_SLOPES[method]) if is_wrong else lambda texts: texts
    made = solvers(context_for(method), (method,), tmp_path, spoil)
    batch = points(made)
    if is_wrong:
        with pytest.raises(CrossCheckError, match="rung 5"):
            check_bits(made, batch, 0.125)
        return
    assert 0 < check_steps(made, batch, 0.125)[method]["c"].k < 1
    assert check_bits(made, batch, 0.125) == {method: 3 * 6 * 5}  # rows, samples and members


@pytest.mark.parametrize("method", WRONG_STEPS)
def test_wrong_implicit_steps_are_caught(method, monkeypatch):
    """Exchanged shares, a short series, means with half of the nodes, and no projections."""
    made = solvers(context_for(method), (method,))
    monkeypatch.setattr(*WRONG_STEPS[method])
    with pytest.raises(CrossCheckError, match="rung 4"):
        check_steps(made, points(made), 0.125)


@needs_compiler
@pytest.mark.parametrize("method", WRONG_GRADIENTS)
def test_wrong_gradients_in_c_are_caught_by_60_digits(method, tmp_path):
    """Alone, without NumPy beside them."""
    spoil = replaced("solver.c", *WRONG_GRADIENTS[method])
    made = solvers(context_for(method), (method,), tmp_path, spoil)
    with pytest.raises(CrossCheckError, match=rf"rung 4.*a step of {method}, c:"):
        check_steps(made, points(made), 0.125)


def test_products_of_three_gradients_are_compared(monkeypatch):
    """Of four coordinates; with other signs of minors the step is another one."""
    made = solvers(context_of("four", PRODUCT_OF_FOUR), ("nambu_gradient_newton",))
    batch = points(made)
    assert check_steps(made, batch, 0.125)["nambu_gradient_newton"]["numpy"].points == 1
    product = nambu_gradient.multiply_gradients
    monkeypatch.setattr(nambu_gradient, "multiply_gradients", lambda rows: -product(rows))
    with pytest.raises(CrossCheckError, match="rung 4"):
        check_steps(made, batch, 0.125)


GRADIENTS = {
    "nambu_body": {"discrete_gradient", "nambu_gradient"},
    "metriplectic_body": {"metriplectic_gradient"},
    "double_bracket_body": {"discrete_gradient"},
}


@pytest.mark.parametrize("system", GRADIENTS)
def test_motions_have_the_gradients_that_are_theirs(system):
    """By facts that names of functions do not tell."""
    own = list_compared(hold_sides(select_programs(lowered(system).values())))
    assert {each.name for name, each in own.items() if "gradient" in name} == GRADIENTS[system]


@needs_compiler
def test_functions_beyond_sqrt_are_compared_within_the_bound(tmp_path, monkeypatch):
    """Steps of the pendulum agree within the bound; a rate that is a little off does not."""
    monkeypatch.setattr(solver_steps, "list_choices", lambda functions: {"rk4": 4})
    made = solvers(PENDULUM, ("rk4",), tmp_path)
    assert check_together(made, points(made), 0.125) == {"rk4": 3}
    (tmp_path / "wrong").mkdir()
    off = replaced("solver.c", "half = h * 0.5", "half = h * 0.50000001")
    made = solvers(PENDULUM, ("rk4",), tmp_path / "wrong", off)
    with pytest.raises(CrossCheckError, match="rung 5"):
        check_together(made, points(made), 0.125)


def test_without_a_compiler_numpy_is_checked_alone():
    """Rungs 2 to 4 run; nothing is said of bits."""
    figures = check_solvers(subject(HEAVY_TOP), dict(render_system(HEAVY_TOP)), {})
    assert set(figures.steps) == {"taylor", "dop853", "rk4", "midpoint"}
    assert figures.choices == 3
    assert figures.equal == figures.together == {}
    assert figures.coefficients == 84


def test_no_step_beyond_the_largest_double_is_compared(monkeypatch):
    """Of two members the first one ends at 1e400, which no double holds."""
    one, huge = (Bounded(Decimal(x), Decimal(x)) for x in ("1", "1e400"))
    steps = iter(ExactStep([one], [end], 1) for end in (huge, one))
    monkeypatch.setattr(solver_exact, "_exact_step", lambda *_: next(steps))
    monkeypatch.setattr(solver_exact, "find_point", lambda *_: {})
    solvers = SimpleNamespace(subject=SimpleNamespace(programs={}), is_noisy=False, steps={})
    samples = np.array([solver_exact.START + 0.5, solver_exact.START + 1])
    found = solver_exact.list_exact_steps(solvers, "dop853", SimpleNamespace(size=2), samples)
    assert [member for member, _ in found] == [1]


@needs_compiler
def test_a_system_at_rest_compiles(tmp_path):
    """Rates that are all 0 have no quotients by orders: a body of equal moments of inertia."""
    text = RIGID_BODY.replace("default = [1, 2, 3]", "default = 1").replace("shape = [3], ", "")
    text = text.replace("dot(Omega, diag(I)*Omega)", "I*dot(Omega, Omega)")
    context = context_of("resting", text)
    assert "_parts" not in render_system(context)["solver.c"]
    made = solvers(context, ("taylor",), tmp_path)
    ensemble = made.begin(points(made), np.array([4.0]), size=0.0, steps=3)
    start = np.array(ensemble.state)
    made.advance["taylor"]["c"](ensemble, 3)
    assert np.array_equal(ensemble.state, start)


#: A turning body that is pulled by the size of a component of its quaternion.
PULLED = """
title = "P"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
q = { role = "quaternion" }
Pi = { role = "momentum", default = ["0.1", "0.2", "0.3"] }
[hamiltonian]
h = "dot(Pi, Pi)/2 + abs(q[1])"
"""


def test_steps_near_constraints_are_compared_where_rates_have_kinks(monkeypatch):
    """Far away a projection turns quaternions round, and a kink is met at once."""
    rendered = pipeline.render(read_spec_text(PULLED, "pulled.toml"))

    def verify():
        reference = Reference(rendered.equations)
        with load_texts(rendered.texts) as system:
            given = (rendered.programs, rendered.texts, reference, system, ("numpy",))
            return crosscheck(*given, bit_points=100)

    assert verify().solvers is not None
    with monkeypatch.context() as spoiled:
        spoiled.setattr(solver_checks, "_move_near_constraints", lambda *given: given[-1])
        with pytest.raises(CrossCheckError, match="rung 4"):
            verify()

    def shorten(subject, kernel, kind):
        found = _list_functions(subject, kernel, kind)
        own = found["projection"]
        return found | {"projection": lambda *given: own(*given) * (1 + 1e-12)}

    monkeypatch.setattr(solver_checks, "_list_functions", shorten)
    with pytest.raises(CrossCheckError, match="rung 4"):
        verify()


@pytest.mark.parametrize(
    ("name", "kind", "said"),
    [
        (
            "rolling_apart",
            "contact",
            "the body is too large .* Take a smaller body",
        ),
        ("inside", "condition", "is not above 0; .* Give defaults at which it is"),
    ],
)
def test_a_start_outside_of_the_domain_is_told(name, kind, said):
    """Where no step can be compared it is why; a start inside is no reason."""
    row, none = [-1.0], SimpleNamespace(values=list)
    bounds = (Bound("y", "condition", True, ()), Bound(name, kind, True, ()))
    own = SimpleNamespace(name="own", DOMAIN=bounds, STATE=none, PARAMETERS=none)
    outside = SimpleNamespace(
        programs={"domain": SimpleNamespace(state=())},
        system=own,
        points=SimpleNamespace(driving={}),
        evaluate=lambda *given: np.array([[1.0], row]),
    )
    assert re.search(said, solver_steps.explain_start(outside))
    for row[0] in (math.nan, 0.0):
        assert solver_steps.explain_start(outside)
    row[0] = 0.5
    assert not solver_steps.explain_start(outside)
