"""Health: every state in which a run can find a tree is named, and a good tree is silent."""

import fcntl
import os
import re

import pytest

from coadjoint.render.health import tree_problems
from coadjoint.render.write import LOCK, MANIFEST, MARK, GeneratedSystem, write_systems

CERTIFICATE = '{"claims": [{"statement": "s", "verdict": "proved", "method": "m"}]}\n'
TEXTS = {
    "kernel.py": MARK.decode() + ' body\nID = "0123456789abcdef"\n',
    "kernel.c": "/* body */\n",
    "certificate.json": CERTIFICATE,
}


@pytest.fixture
def tree(tmp_path):
    """A tree of one system, as a run leaves it."""
    folder = tmp_path / "generated"
    write_systems(folder, {"body": GeneratedSystem(TEXTS, "0", "lie-poisson")}, {"c": "0"})
    return folder


def problems(folder):
    """What is found, each with whether it heals."""
    return [(each.found, each.heals) for each in tree_problems(folder)]


def test_a_tree_as_a_run_leaves_it_has_no_problem(tree):
    """Nor have bytecode and files of somebody's beside the systems."""
    (tree / "body" / "__pycache__").mkdir()
    (tree / "body" / "__pycache__" / "kernel.cpython-312.pyc").write_text("")
    (tree / "README.txt").write_text("mine")
    assert problems(tree) == []


def put(path, text=""):
    """Write a file, making its folder."""
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)


def pipe(path):
    """A named pipe in the place of a file."""
    path.unlink(missing_ok=True)
    os.mkfifo(path)


#: What happens to a tree, and what is said.
STATES = {
    "no manifest": (lambda t: (t / MANIFEST).unlink(), r"manifest\.json is missing"),
    "a damaged manifest": (lambda t: put(t / MANIFEST, "["), r"manifest\.json is damaged"),
    "a pipe as manifest": (lambda t: pipe(t / MANIFEST), r"manifest\.json is damaged"),
    "a changed file": (lambda t: put(t / "body/kernel.c"), "files of body are missing or changed"),
    "a missing file": (
        lambda t: (t / "body/kernel.c").unlink(),
        "files of body are missing or changed",
    ),
    "a damaged certificate": (
        lambda t: put(t / "body/certificate.json", "{"),
        r"certificate\.json is missing or damaged",
    ),
    "a pipe as certificate": (
        lambda t: pipe(t / "body/certificate.json"),
        r"certificate\.json is missing or damaged",
    ),
    "a foreign file": (lambda t: put(t / "body/mine.txt"), r"body/mine\.txt: no run wrote this"),
    "a foreign package": (lambda t: put(t / "__init__.py"), r"__init__\.py is missing or was"),
    "a lock that is none": (lambda t: pipe(t / LOCK), r"\.lock is not a file"),
    "a system of no manifest": (
        lambda t: put(t / "other" / "kernel.py", TEXTS["kernel.py"]),
        r"other contains a system that manifest\.json does not list",
    ),
}


@pytest.mark.parametrize("state", STATES)
def test_damage_is_named(tree, state):
    """The message has the path, and asks for something to be done."""
    spoil, message = STATES[state]
    spoil(tree)
    found = problems(tree)
    assert any(re.search(message, text) for text, _ in found), found
    assert not any(heals for _, heals in found)


def test_leftovers_and_a_lock_in_use_heal(tree):
    """What killed runs leave goes in the next run; another run ends by itself."""
    (tree / "body" / ".coadjoint-0123456789abcdef.tmp").write_text("torn")
    with (tree / LOCK).open("rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        found = problems(tree)
    assert any("left behind by a killed run" in text and heals for text, heals in found)
    assert any("is held" in text and heals for text, heals in found)


def test_a_missing_tree_is_one_problem(tmp_path):
    """Where nothing was generated, that is all there is to say."""
    assert problems(tmp_path / "nowhere") == [(f"{tmp_path / 'nowhere'} is not there", False)]
