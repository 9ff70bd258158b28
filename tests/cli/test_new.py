"""`coadjoint new` writes a spec that loads, proves and runs as it stands."""

from __future__ import annotations

import json

import pytest


def test_the_starter_proves_and_runs(run, folder):
    """What is written proves all its claims, and simulates."""
    assert run("new", "my_body").exit_code == 0
    proved = json.loads(run("prove", "my_body.toml", "--json").stdout)
    assert proved["holds"]
    assert len(proved["claims"]) > 8
    record = json.loads(run("simulate", "my_body.toml", "--json").stdout)
    assert record["status"] == "OK"
    assert record["final"]["spin"] > 0


def test_nothing_is_overwritten(run, folder):
    """A file that is there stays as it is."""
    (folder / "mine.toml").write_text("precious")
    result = run("new", "mine")
    assert result.exit_code == 2
    assert "mine.toml" in result.stderr
    assert (folder / "mine.toml").read_text() == "precious"


@pytest.mark.parametrize("name", ["My-Body", "9lives", "random", "../evil", "a" * 40, "numpy"])
def test_unusable_names_are_refused(run, folder, name):
    """A name that no system may have is refused before anything is written."""
    result = run("new", name)
    assert result.exit_code == 2
    assert name in result.stderr
    assert list(folder.iterdir()) == []
