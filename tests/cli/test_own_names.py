"""A spec in the folder is found by its name, tables fit narrow terminals, words are completed."""

from __future__ import annotations

import shutil
import sys

import pytest
from click.shell_completion import ShellComplete

from coadjoint.cli import main
from coadjoint.cli.output import find_width, print_table
from coadjoint.errors import SpecError
from coadjoint.spec import read_spec


def test_a_new_spec_is_proved_by_its_name(run, folder):
    """`new my_body`, then `prove my_body`; without the file both spellings are named."""
    assert run("new", "my_body").exit_code == 0
    result = run("prove", "my_body")
    assert (result.exit_code, "my_body" in result.stdout) == (0, True)
    missing = run("prove", "your_body")
    assert missing.exit_code == 2
    assert "there is no your_body.toml here" in missing.stderr


def test_a_name_without_ending_is_told_what_it_means(folder):
    """A shipped system has an import, a file of that name has its ending."""
    with pytest.raises(SpecError, match=r"from coadjoint\.systems import heavy_top"):
        read_spec("heavy_top")
    (folder / "mine.toml").write_text("")
    with pytest.raises(SpecError, match=r"Did you mean '\./mine\.toml'\?"):
        read_spec("mine")


@pytest.mark.parametrize("width", [80, 40])
def test_names_are_never_cut(width, monkeypatch, capsys):
    """At any width each name stands whole on one line, and no line is too long."""
    name = "nonholonomic_hamilton_pontryagin_disk"
    size = shutil.os.terminal_size((width, 24))
    monkeypatch.setattr(shutil, "get_terminal_size", lambda: size)
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    rows = [(name, "12", "a route, " * 12, "words " * 20, "verified")]
    print_table(("system", ">dim", "routes", "title", "state"), rows)
    lines = capsys.readouterr().out.splitlines()
    assert any(name in line for line in lines)
    assert max(map(len, lines)) <= width
    assert any("verified" in line for line in lines)


def test_the_width_of_text_is_that_of_a_terminal(monkeypatch, tmp_path):
    """At least 40 and at most what is asked for; that in a pipe and in a file."""
    assert find_width(None, 100) == 100
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    for columns, expected in ((20, 40), (72, 72), (300, 100)):
        monkeypatch.setenv("COLUMNS", str(columns))
        assert find_width(None, 100) == expected
        assert find_width(tmp_path / "top.txt", 100) == 100


@pytest.mark.parametrize(
    ("before", "begun", "found"),
    [
        (["show", "heavy_top", "--route"], "lie", ["lie-poisson"]),
        (["simulate", "heavy_top", "--set"], "ch", ["chi="]),
        (["simulate", "heavy_top", "--state"], "Ga", ["Gamma="]),
        (["simulate", "heavy_top", "--method"], "ta", ["taylor"]),
        (["export", "heavy_top", "--method"], "rk", ["rk4"]),
        (["algebra"], "se(", ["se(2)", "se(3)", "se(4)"]),
    ],
)
def test_words_are_completed(before, begun, found):
    """Routes and names are those of the system before them."""
    complete = ShellComplete(main, {}, "coadjoint", "_COADJOINT_COMPLETE")
    assert [each.value for each in complete.get_completions(before, begun)] == found
