"""`coadjoint regenerate` writes what passed, reports what failed, and checks for drift."""

from __future__ import annotations

import json

import pytest

from coadjoint.cli.regenerate import folders, spec_paths
from coadjoint.errors import SpecError
from coadjoint.resources import derivations_folder, systems_folder
from tests.specs import RIGID_BODY


@pytest.fixture
def project(folder):
    """A folder with one system of its own."""
    (folder / "derivations").mkdir()
    (folder / "derivations" / "body.toml").write_text(RIGID_BODY, encoding="utf-8")
    return folder


def test_folders_default_to_those_at_hand(project):
    """./derivations and ./generated are meant where they are, else the shipped folders."""
    source, target = folders(None, None)
    assert (source.resolve(), target.resolve()) == (
        project / "derivations",
        project / "generated",
    )


def test_folders_default_to_the_shipped_ones_elsewhere(folder):
    """In a folder without specs the shipped systems are regenerated in place."""
    assert folders(None, None) == (derivations_folder(), systems_folder())
    assert folders(folder / "mine", None)[1] == folder / "generated"
    assert folders(None, folder / "out")[1] == folder / "out"


def test_a_run_writes_a_table_and_files_and_a_second_finds_nothing_to_do(project, run):
    """A first run derives and writes; the next one says unchanged; --check agrees."""
    first = run("regenerate")
    assert first.exit_code == 0, first.stderr
    assert "body" in first.stdout
    assert (project / "generated" / "body" / "kernel.c").is_file()
    assert "unchanged" not in first.stdout
    second = run("regenerate")
    assert (second.exit_code, "unchanged" in second.stdout) == (0, True)
    checked = run("regenerate", "--check", "--json")
    assert checked.exit_code == 0
    (row,) = json.loads(checked.stdout)["systems"]
    assert (row["system"], row["dimension"]) == ("body", 3)
    assert row["proved"] == row["claims"] > 5
    kernel = project / "generated" / "body" / "kernel.py"
    kernel.write_text(kernel.read_text().replace("+", "-", 1))
    (project / "generated" / "body" / "stray.txt").write_text("stray")
    drifted = run("regenerate", "--check")
    assert drifted.exit_code == 1
    assert "changed: body/kernel.py" in drifted.stdout
    assert "extra: body/stray.txt" in drifted.stdout
    assert "body/kernel.py" in drifted.stderr


def test_failures_are_shown_after_the_table_and_nothing_is_written_for_them(
    project, false_claim, run
):
    """A false claim and a bad spec fail alone; the highest of their exit statuses counts."""
    false_claim.rename(project / "derivations" / "liar.toml")
    result = run("regenerate", "body", "liar")
    assert result.exit_code == 1
    assert "refuted" in result.stderr
    assert "Pi[1] + Pi[2]" in result.stderr
    assert not (project / "generated" / "liar").exists()
    (project / "derivations" / "broken.toml").write_text("title = 3\n")
    result = run("regenerate", "broken", "liar")
    assert result.exit_code == 2
    assert "broken.toml" in result.stderr


def test_unknown_names_and_empty_folders_are_refused(project):
    """A name without a spec is answered with the nearest, an empty folder with what is missing."""
    with pytest.raises(SpecError, match="Did you mean 'body'") as caught:
        spec_paths(project / "derivations", ["bodi"])
    assert caught.value.found == "bodi"
    with pytest.raises(SpecError, match="no spec is there") as caught:
        spec_paths(project)
    assert caught.value.path == str(project)
