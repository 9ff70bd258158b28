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
    """In a folder without specs the shipped systems are meant."""
    assert folders(None, None) == (derivations_folder(), systems_folder())
    assert folders(folder / "mine", None)[1] == folder / "generated"
    assert folders(None, folder / "out")[1] == folder / "out"


def test_outside_a_project_nothing_is_regenerated(folder, run, monkeypatch):
    """Without a folder of specs at hand the run explains itself, before any work."""
    monkeypatch.setattr("coadjoint.regenerate.run_bounded", None)
    result = run("regenerate", "rigid_body")
    assert result.exit_code == 2
    assert f"{folder}: there is no folder `derivations` here" in result.stderr
    assert "--derivations FOLDER" in result.stderr
    assert list(folder.iterdir()) == []


def test_an_installed_package_is_never_written_to(folder, run, monkeypatch):
    """In the folder of the package itself, and with any name for it, the run is refused."""
    installed = folder / "lib" / "site-packages" / "coadjoint"
    (installed / "derivations").mkdir(parents=True)
    (installed / "derivations" / "body.toml").write_text(RIGID_BODY)
    monkeypatch.setattr("coadjoint.regenerate.run_bounded", None)
    monkeypatch.chdir(installed)
    for words in ((), ("--derivations", "derivations"), ("--output", installed / "systems")):
        result = run("regenerate", *words)
        assert result.exit_code == 2
        assert "installed package, which is never written to" in result.stderr
    assert sorted(path.name for path in installed.iterdir()) == ["derivations"]


def test_files_of_others_are_refused_before_any_work(project, run, monkeypatch):
    """A package of somebody's in the place of the generated folder is named and stays."""
    (project / "generated").mkdir()
    (project / "generated" / "__init__.py").write_text("precious = 1\n")
    monkeypatch.setattr("coadjoint.regenerate.run_bounded", None)
    result = run("regenerate")
    assert result.exit_code == 2
    assert "__init__.py" in result.stderr
    assert (project / "generated" / "__init__.py").read_text() == "precious = 1\n"
    assert len(list((project / "generated").iterdir())) == 1


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
    refused = run("regenerate")
    assert refused.exit_code == 2
    assert "body/stray.txt" in refused.stderr
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
    with pytest.raises(SpecError, match="no specs found") as caught:
        spec_paths(project)
    assert caught.value.path == str(project)
