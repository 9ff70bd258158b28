"""The checks themselves are tried: one sign or index flipped in the engine, and a test must fail.

Each mutant is a copy of the tree with one change, judged by the project's own tests: the book's
formulas first, then the laws of each step. Survivors are listed with the reason, or fail this test.
Structure constants, ad* and the choice of minus or plus are tried in every run, the whole list in
campaigns.
"""

import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.mutation.engine import MUTANTS
from tests.mutation.judge import OUTPUT
from tests.mutation.mutant import ROOT

SOURCES = "tests/sources/"
EQUATIONS = SOURCES + "test_equations.py"
#: The book's rates and brackets of a few small systems: for what is tried in every run.
BOOK = (
    EQUATIONS,
    "-k",
    "(rates_are_those or poisson_tensor_is)"
    " and (rigid_body- or heavy_top- or galilei- or se2_pendulum- or sl2_r2- or so4_body-"
    " or so5_body-)",
)
#: Kernels of systems with parameters and zero rows; the others are built the same way.
KERNELS = (SOURCES + "test_kernels.py", "-k", "heavy_top or bargmann")
GROUP_ROWS = tuple(
    f"{SOURCES}test_{row}.py"
    for row in ("actions", "semidirect_actions", "quaternions", "vector_fields", "galileo")
)
BODIES = (SOURCES + "test_tops.py", SOURCES + "test_complex.py")
WHERE = ("tests/prove/test_ideals.py", "tests/prove/test_integrals.py")
#: Tests that judge a mutant, by the beginning of its file, the more special first: those of its
#: step and the book's.
JUDGES = {
    "src/coadjoint/algebra": (EQUATIONS, SOURCES + "test_lie_algebras.py", "tests/algebra"),
    "src/coadjoint/groups": ("tests/groups", "tests/theory", *GROUP_ROWS),
    "src/coadjoint/theory": ("tests/theory", *GROUP_ROWS),
    "src/coadjoint/poisson/momentum_maps": (
        "tests/poisson/test_momentum_maps.py",
        SOURCES + "test_momentum_maps.py",
    ),
    "src/coadjoint/exact/ranks": ("tests/exact/test_ranks.py",),
    "src/coadjoint/exact/dense": ("tests/exact/test_dense.py",),
    "src/coadjoint/exact/linear": ("tests/exact/test_linear.py",),
    "src/coadjoint/exact/packed": ("tests/exact/test_packed.py",),
    "src/coadjoint/exact/ansatz": ("tests/exact/test_ansatz.py",),
    "src/coadjoint/poisson/casimirs": (
        "tests/poisson/test_casimirs.py",
        "tests/prove/test_completeness.py",
    ),
    "src/coadjoint/poisson": (EQUATIONS, SOURCES + "test_brackets.py", "tests/poisson"),
    "src/coadjoint/exact": ("tests/exact",),
    "src/coadjoint/prove/charts": ("tests/prove/test_charts.py",),
    "src/coadjoint/prove/functions": ("tests/prove/test_samples.py",),
    "src/coadjoint/prove/samples": ("tests/prove/test_samples.py",),
    "src/coadjoint/prove/candidates": ("tests/prove/test_candidates.py",),
    "src/coadjoint/prove/polynomial_families": ("tests/prove/test_candidates.py",),
    "src/coadjoint/prove/densities": ("tests/prove/test_measures.py",),
    "src/coadjoint/prove/ideals": WHERE,
    "src/coadjoint/prove/zero": WHERE,
    "src/coadjoint/prove/symmetries": (
        "tests/prove/test_symmetries.py",
        SOURCES + "test_momentum_maps.py",
    ),
    "src/coadjoint/prove/lax": ("tests/derive/test_lax.py", SOURCES + "test_lax.py"),
    "src/coadjoint/prove": ("tests/prove", "tests/derive", *BODIES),
    "src/coadjoint/spec/core/definitions": ("tests/spec/test_definitions.py",),
    "src/coadjoint/lower": ("tests/lower",),
    "src/coadjoint/render": KERNELS,
    "templates": KERNELS,
}
COPIED = ("src", "templates", "derivations", "examples", "tests", "pyproject.toml")
#: pytest's exit statuses for a failed test and for a tree that cannot even be imported.
KILLED = (1, 2, 4)


@pytest.fixture(scope="module")
def judge():
    """A function from the folder of a tree to the exit status of its tests."""
    server = subprocess.Popen(
        [sys.executable, str(Path(__file__).with_name("judge.py"))],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
    )

    def ask(folder, tests):
        server.stdin.write("\t".join(map(str, (folder, *tests))) + "\n")
        server.stdin.flush()
        return int(server.stdout.readline())

    with server:
        yield ask
        server.stdin.close()


def copy_tree(folder):
    """What the judge needs; bytecode of files that are changed is not that of what stands there."""
    for name in COPIED:
        source, target = ROOT / name, folder / name
        if source.is_dir():
            shutil.copytree(source, target)
        else:
            shutil.copy(source, target)


def mutate(folder, mutant):
    """The tree with one change."""
    copy_tree(folder)
    (folder / mutant.file).write_text(mutant.text())


def judges_of(mutant):
    """The tests that judge a mutant: its own, else the book alone in every run."""
    if mutant.tests:
        return shlex.split(" ".join(mutant.tests))
    if mutant.always:
        return BOOK
    return next(tests for start, tests in JUDGES.items() if mutant.file.startswith(start))


def names(mutants):
    """Arguments of a parametrised test."""
    return {"argvalues": mutants, "ids": [mutant.name for mutant in mutants]}


def choose_regular():
    """The mutants of every run: of those with the judges of all signs the first of each file."""
    files, chosen = set(), []
    for mutant in MUTANTS:
        if mutant.always and (mutant.tests or mutant.file not in files):
            files |= set() if mutant.tests else {mutant.file}
            chosen.append(mutant)
    return chosen


def killable():
    """The mutants that a test must see, those that can wait marked."""
    regular = {mutant.name for mutant in choose_regular()}
    return [
        pytest.param(
            mutant, marks=[pytest.mark.campaign] * (mutant.name not in regular), id=mutant.name
        )
        for mutant in MUTANTS
        if not mutant.equivalent
    ]


@pytest.mark.parametrize("mutant", killable())
def test_a_mutant_is_killed(mutant, judge, tmp_path):
    """A test fails on the changed tree."""
    mutate(tmp_path, mutant)
    status = judge(tmp_path, judges_of(mutant))
    assert status in KILLED, (status, (tmp_path / OUTPUT).read_text()[-2000:])


@pytest.mark.campaign
@pytest.mark.parametrize("mutant", **names([m for m in MUTANTS if m.equivalent]))
def test_an_equivalent_mutant_survives(mutant, judge, tmp_path):
    """No test fails; if one does, the mutant is not equivalent and its reason is wrong."""
    mutate(tmp_path, mutant)
    assert judge(tmp_path, judges_of(mutant)) == 0, (tmp_path / OUTPUT).read_text()[-2000:]


def unchanged():
    """The judges of every run, and those of campaigns and of single mutants, marked."""
    own = {" ".join(mutant.tests) for mutant in MUTANTS if mutant.tests}
    judges = JUDGES | {tests: shlex.split(tests) for tests in sorted(own)}
    campaign = [
        pytest.param(tests, marks=pytest.mark.campaign, id=name) for name, tests in judges.items()
    ]
    return [pytest.param(BOOK, id="book"), *campaign]


@pytest.mark.parametrize("tests", unchanged())
def test_the_unchanged_tree_survives(tests, judge, tmp_path):
    """The unchanged tree passes, so it is the change that a test detects."""
    copy_tree(tmp_path)
    assert judge(tmp_path, tests) == 0, (tmp_path / OUTPUT).read_text()[-2000:]


def test_every_line_names_one_change():
    """A change of the engine that renames what a line names fails here, with what there is."""
    for mutant in MUTANTS:
        assert mutant.text()
        assert [*judges_of(mutant)].count("-k") <= 1, mutant.name  # of several the last one counts


def test_there_are_enough_mutants():
    """At least a hundred, all different, few of them equivalent; every step has some."""
    assert len({(m.file, m.text()) for m in MUTANTS}) == len(MUTANTS) >= 100
    assert sum(bool(m.equivalent) for m in MUTANTS) <= 3
    assert len(choose_regular()) >= 9
    assert {m.file for m in choose_regular()} == {m.file for m in MUTANTS if m.always}
    assert all(any(m.file.startswith(start) for m in MUTANTS) for start in JUDGES)
