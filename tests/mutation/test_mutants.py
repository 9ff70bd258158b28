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

from tests.mutation.mutants import MUTANTS

ROOT = Path(__file__).parents[2]
#: What judges a mutant, in the order in which mutants die.
JUDGES = (
    "tests/sources/test_equations.py",
    "tests/sources/test_kernels.py",
    "tests/algebra",
    "tests/exact",
    "tests/lower",
    "tests/prove",
    "tests/derive",
)
COPIED = ("src", "templates", "derivations", "tests", "pyproject.toml")


def copy_tree(folder):
    """What the judges need, and nothing compiled."""
    for name in COPIED:
        source, target = ROOT / name, folder / name
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, target)


def judge(folder):
    """Run the judges on a tree until the first failure; exit status and output."""
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(folder / "src"), str(folder)]),
        "COADJOINT_CACHE": str(folder / "cache"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-x",
        "-q",
        "-p",
        "no:cacheprovider",
        "-p",
        "no:xdist",
    ]
    found = subprocess.run(
        [*command, *JUDGES], cwd=folder, env=environment, capture_output=True, text=True
    )
    return found.returncode, found.stdout + found.stderr


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.name)
def test_a_mutant_is_killed(mutant, tmp_path, record_property):
    """A test fails on the changed tree, or none can and the reason is given."""
    copy_tree(tmp_path)
    path = tmp_path / mutant.file
    text = path.read_text()
    assert text.count(mutant.old) == 1, f"{mutant.old!r} is not once in {mutant.file}: update it"
    path.write_text(text.replace(mutant.old, mutant.new))
    status, output = judge(tmp_path)
    killed = status == 1 and " failed" in output or status in (1, 2, 4) and "error" in output
    record_property("killed", killed)
    assert killed != bool(mutant.equivalent), output[-2000:]


@pytest.mark.campaign
def test_the_unchanged_tree_survives(tmp_path):
    """The judges pass without a mutation: what kills is the change."""
    copy_tree(tmp_path)
    status, output = judge(tmp_path)
    assert status == 0, output[-2000:]


def test_there_are_enough_mutants():
    """At least thirty, all different, few of them equivalent."""
    assert len({(m.file, m.old, m.new) for m in MUTANTS}) == len(MUTANTS) >= 30
    assert sum(bool(m.equivalent) for m in MUTANTS) <= 3
