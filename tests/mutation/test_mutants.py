"""The checks themselves are tried: one sign or index flipped in the engine, and a test must fail.

Each mutant is a copy of the tree with one change, judged by the project's own tests: the book's
formulas first, then the laws of each step. Survivors are listed with the reason, or fail this test.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.mutation.judge import OUTPUT
from tests.mutation.mutants import MUTANTS

ROOT = Path(__file__).parents[2]
EQUATIONS, KERNELS = "tests/sources/test_equations.py", "tests/sources/test_kernels.py"
#: Tests that judge a mutant, by the beginning of its file: those of its step and the book's.
JUDGES = {
    "src/coadjoint/algebra": ("tests/algebra", EQUATIONS),
    "src/coadjoint/derive": (EQUATIONS, "tests/derive"),
    "src/coadjoint/exact": ("tests/exact",),
    "src/coadjoint/lower": ("tests/lower",),
    "src/coadjoint/render": (KERNELS,),
    "templates": (KERNELS,),
}
COPIED = ("src", "templates", "derivations", "tests", "pyproject.toml")
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
        server.stdin.write(f"{folder} {' '.join(tests)}\n")
        server.stdin.flush()
        return int(server.stdout.readline())

    with server:
        yield ask
        server.stdin.close()


def copy_tree(folder):
    """What the judge needs, and nothing compiled."""
    for name in COPIED:
        source, target = ROOT / name, folder / name
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, target)


def mutate(folder, mutant):
    """The tree with one change."""
    copy_tree(folder)
    path = folder / mutant.file
    text = path.read_text()
    assert text.count(mutant.old) == 1, f"{mutant.old!r} is not once in {mutant.file}: update it"
    path.write_text(text.replace(mutant.old, mutant.new))


def judges_of(mutant):
    """The tests that judge a mutant."""
    (tests,) = [tests for start, tests in JUDGES.items() if mutant.file.startswith(start)]
    return tests


def names(mutants):
    """Arguments of a parametrised test."""
    return {"argvalues": mutants, "ids": [mutant.name for mutant in mutants]}


@pytest.mark.parametrize("mutant", **names([m for m in MUTANTS if not m.equivalent]))
def test_a_mutant_is_killed(mutant, judge, tmp_path):
    """A test fails on the changed tree."""
    mutate(tmp_path, mutant)
    status = judge(tmp_path, judges_of(mutant))
    assert status in KILLED, (status, (tmp_path / OUTPUT).read_text()[-2000:])


@pytest.mark.campaign
@pytest.mark.parametrize("mutant", **names([m for m in MUTANTS if m.equivalent]))
def test_an_equivalent_mutant_survives(mutant, judge, tmp_path):
    """No test fails, as the reason beside it says; one that does is no longer equivalent."""
    mutate(tmp_path, mutant)
    assert judge(tmp_path, judges_of(mutant)) == 0, (tmp_path / OUTPUT).read_text()[-2000:]


def test_the_unchanged_tree_survives(judge, tmp_path):
    """The judge passes without a mutation: what kills is the change."""
    copy_tree(tmp_path)
    tests = dict.fromkeys(test for tests in JUDGES.values() for test in tests)
    assert judge(tmp_path, tests) == 0, (tmp_path / OUTPUT).read_text()[-2000:]


def test_there_are_enough_mutants():
    """At least thirty, all different, few of them equivalent."""
    assert len({(m.file, m.old, m.new) for m in MUTANTS}) == len(MUTANTS) >= 30
    assert sum(bool(m.equivalent) for m in MUTANTS) <= 3
