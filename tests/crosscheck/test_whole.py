"""The ladder of solvers of a larger state: good ones pass, and what is spoiled is caught."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import pytest

from coadjoint.crosscheck.solver_text import SolverTexts, check_solver_texts
from coadjoint.crosscheck.solvers import check_solvers, start_compiling
from coadjoint.crosscheck.subject import Subject
from coadjoint.errors import CrossCheckError
from coadjoint.render.kernels import render_system
from coadjoint.render.solvers import arrange, select_programs
from coadjoint.solver_kinds import KINDS, RECONSTRUCTION
from tests.kernels import COMPILER, ProgramReference
from tests.programs import BELOW, FOLLOWED, program


@cache
def rendered():
    """The files."""
    return render_system(FOLLOWED)


def subject(context=FOLLOWED):
    """The system, by the Programs of a context, with its own NumPy kernel."""
    module = {}
    exec(rendered()["kernel.py"], module)

    def function(name):
        return lambda state, parameters, target, out: module[name](state, parameters, out)

    system = SimpleNamespace(
        name="followed",
        PARAMETERS={each.name: each for each in context.parameters},
        DOMAIN=context.domain,
        **{each.name: function(each.name) for each in context.programs},
    )
    programs = {each.name: each for each in FOLLOWED.programs}
    return Subject(programs, ProgramReference(context.programs), system, ("numpy", "c"))


def changed(row):
    """The context with another rate of y."""
    *others, _ = FOLLOWED.programs
    other = program("reconstruction", "q p x y", "r", BELOW, f"_t1 - _t2; {row}", (2,))
    return replace(FOLLOWED, programs=(*others, other))


def test_a_system_that_reconstructs_has_two_kinds_of_solvers():
    """The first is what it is without; the files of the second have names of their own."""
    texts = rendered()
    assert {file for kind in KINDS for file in kind.files} <= set(texts)
    plain = render_system(replace(FOLLOWED, programs=FOLLOWED.programs[:-1], reconstructed=()))
    assert not set(RECONSTRUCTION.files) & set(plain)

    def cut(text):
        return [line for line in text.splitlines() if "id: " not in line and "_id[]" not in line]

    assert cut(plain["solver.c"]) == cut(texts["solver.c"])
    assert "size_t followed_reconstruction_advance(" in texts["reconstruction.h"]
    assert "enum { STATE = 4," in texts["reconstruction.c"]


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
def test_the_ladder_climbs_the_larger_state(tmp_path):
    """Orders of four components at two points; bits of C, on constraints and in a domain."""
    with ThreadPoolExecutor(2) as pool:
        made = start_compiling(pool, rendered(), tmp_path, "followed", ("c",), RECONSTRUCTION)
        figures = check_solvers(subject(), rendered(), made, RECONSTRUCTION)
    assert figures.coefficients == 2 * 7 * 4
    assert min(figures.equal.values()) > 100
    assert figures.steps["taylor"]["c"].points == 3


def test_wrong_equations_are_caught_by_the_power_series():
    """The recurrences are those of another path."""
    wrong = subject(changed("_t3 - r"))
    with pytest.raises(CrossCheckError, match="rung 2: followed: order 1 of y"):
        check_solvers(wrong, rendered(), {}, RECONSTRUCTION)


def test_a_wrong_kernel_is_caught_by_steps():
    """The methods in NumPy ask the function reconstruction of the kernel."""
    wrong = dict(render_system(changed("_t3 + 1.0000001*r")))
    texts = rendered() | {"kernel.py": wrong["kernel.py"]}
    with pytest.raises(CrossCheckError, match="rung 4: followed: a step of dop853, numpy: y is"):
        check_solvers(subject(), texts, {}, RECONSTRUCTION)


@pytest.mark.parametrize(
    ("file", "good", "bad"),
    [
        ("reconstruction.c", "_rows[3] = y", "_rows[3] = x"),  # of the projection
        ("reconstruction.c", "STATE = 4", "STATE = 2"),
        ("reconstruction.c", "followed_reconstruction_advance", "followed_advance"),
        ("reconstruction.c", "const V y = _state[3]", "const V y = _state[2]"),
        ("reconstruction.h", "} followed_reconstruction_run", "} followed_run"),
        ("reconstruction.py", "y[1] = ", "y[1] = -"),
        ("reconstruction.py", "x = path[2]", "x = path[3]"),
    ],
)
def test_wrong_texts_are_caught_by_reading_them_back(file, good, bad):
    """The message names the file."""
    texts, programs = rendered(), select_programs(FOLLOWED.programs, RECONSTRUCTION)
    assert good in texts[file]
    files = {each: texts[each] for each in RECONSTRUCTION.files}
    read = SolverTexts(
        programs=programs,
        recurrences=arrange(programs),
        strict=tuple(bound.strict for bound in FOLLOWED.domain),
        files=files | {file: texts[file].replace(good, bad)},
        system="followed",
        kind=RECONSTRUCTION,
    )
    assert check_solver_texts(replace(read, files=files)) > 100
    with pytest.raises(CrossCheckError, match=f"rung 3: {file}"):
        check_solver_texts(read)
