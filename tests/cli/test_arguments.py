"""A word of the command line means a shipped system or a file, and nothing in between."""

from __future__ import annotations

import pytest
from click.shell_completion import ShellComplete

from coadjoint.cli import main
from coadjoint.cli.arguments import load_system, spec_path
from coadjoint.errors import SpecError
from coadjoint.resources import derivations_folder


def test_a_name_is_a_shipped_system_wherever_one_stands(folder):
    """A file in the working folder does not shadow a shipped system of its name."""
    (folder / "derivations").mkdir()
    (folder / "derivations" / "heavy_top.toml").write_text("planted")
    (folder / "heavy_top").mkdir()
    assert spec_path("heavy_top") == derivations_folder() / "heavy_top.toml"


def test_a_system_that_was_not_generated_is_named(folder, monkeypatch):
    """Where the generated folder is missing, the message says which command makes it."""
    monkeypatch.setattr("coadjoint.cli.arguments.systems_folder", lambda: folder)
    with pytest.raises(SpecError, match="coadjoint regenerate heavy_top") as caught:
        load_system("heavy_top")
    assert caught.value.found == "heavy_top"


def test_shell_completes_systems_and_files(folder):
    """Completion offers shipped systems, and specs of the folder that is typed."""
    (folder / "own").mkdir()
    (folder / "own" / "robot.toml").touch()
    complete = ShellComplete(main, {}, "coadjoint", "_COADJOINT_COMPLETE")
    words = [item.value for item in complete.get_completions(["show"], "hea")]
    assert words == [path.stem for path in sorted(derivations_folder().glob("hea*.toml"))]
    assert "heavy_top" in words
    files = [item.value for item in complete.get_completions(["show"], "own/r")]
    assert files == ["own/robot.toml"]
    assert "crosscheck" in [item.value for item in complete.get_completions([], "cr")]


def test_a_near_name_is_offered_first_and_few_are_shown(tmp_path, monkeypatch):
    """The nearest systems and specs of this folder; not a hundred names in front of them."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mytop.toml").touch()
    with pytest.raises(SpecError, match=r"Did you mean '\./mytop\.toml'") as caught:
        spec_path("mytopp")
    assert len(str(caught.value)) < 200
    with pytest.raises(SpecError, match=r"here\. Did you mean 'heavy_top'.*`coadjoint list`"):
        spec_path("heavytop")
