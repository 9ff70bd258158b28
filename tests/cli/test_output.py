"""Tables are whole in a pipe, obey no markup, and files that cannot be written are named."""

from __future__ import annotations

import json

import pytest

from coadjoint.cli.output import print_json, print_table, progress_bars, write_text
from coadjoint.errors import OutputError


def test_cells_are_never_cut_in_a_pipe(capsys):
    """A cell wider than any terminal is printed whole, on one line."""
    cell = "x" * 500
    print_table(("a", ">b"), [(cell, "1"), ("y", "22")], title="Title")
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "Title"
    assert any(cell in line for line in lines)
    assert [line for line in lines if line != line.rstrip()] == []


def test_cells_are_text_and_not_markup(capsys):
    """Square brackets and control characters of a spec's title do nothing."""
    print_table(("title",), [("[bold]a[/bold] \x1b[31m :smile:",)])
    printed = capsys.readouterr().out
    assert "[bold]a[/bold]" in printed
    assert ":smile:" in printed
    assert "\x1b" not in printed


def test_a_table_on_a_terminal_holds_no_commands_of_its_own(capsys, monkeypatch):
    """Text alone: what a terminal would obey is neither written nor shown as an escape."""
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "40")
    print_table(("a", "b"), [("x" * 30, "y" * 30)])
    lines = capsys.readouterr().out.splitlines()
    assert all(line.isprintable() and "\\x1b" not in line for line in lines)
    assert max(map(len, lines)) <= 40


def test_json_has_no_infinity(capsys):
    """What is not finite is null, since JSON has no word for it."""
    print_json({"a": [1.5, float("inf")], "b": (float("nan"), "x")})
    assert json.loads(capsys.readouterr().out) == {"a": [1.5, None], "b": [None, "x"]}


def test_progress_is_silent_in_a_pipe(capsys):
    """Without a terminal no bar is drawn."""
    with progress_bars() as progress:
        progress("heavy_top", "derive", 0, 6)
    assert capsys.readouterr() == ("", "")


def test_progress_is_drawn_in_a_terminal(capsys, monkeypatch):
    """With a terminal the bar of a system names its stage, on standard error."""
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    monkeypatch.setenv("FORCE_COLOR", "1")
    with progress_bars() as progress:
        progress("heavy_top", "derive", 0, 6)
        progress("heavy_top", "prove", 1, 6)
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "heavy_top" in printed.err
    assert "prove" in printed.err


def test_file_that_cannot_be_written_is_named(tmp_path):
    """The error of a file in a folder that is not there carries its path."""
    with pytest.raises(OutputError, match="cannot be written") as caught:
        write_text(tmp_path / "missing" / "a.csv", "")
    assert caught.value.path == str(tmp_path / "missing" / "a.csv")


def test_words_stay_whole_on_a_narrow_terminal(capsys, monkeypatch):
    """Options of a compiler at 80 columns: in a table where they fit, else in lines."""
    options = "cc (-std=c11 -fno-math-errno -fno-tree-loop-distribution -fno-tree-slp-vectorize)"
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    for columns in (120, 80, 50):
        monkeypatch.setenv("COLUMNS", str(columns))
        rows = [
            ("compiler", "ok", options, "set CC or take numpy-kernels-only"),
            ("b", "ok", "", ""),
        ]
        print_table(("", "status", "found", "what to do"), rows)
        shown = capsys.readouterr().out
        assert [word for word in options.split() if word not in shown] == []
        assert max(map(len, shown.splitlines())) <= columns
