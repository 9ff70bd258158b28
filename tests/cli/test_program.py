"""The program as a whole: help, exit status, streams, and what is not imported."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import pytest
from click.testing import CliRunner

from coadjoint.cli import program
from tests.processes import wait_for_work

# Within the process, so that the start of Python itself is not counted against the help.
HELP = """
import sys
from coadjoint.cli import main
try:
    main(["--help"])
finally:
    heavy = {"sympy", "numpy", "scipy", "pydantic", "rich", "jinja2"} & set(sys.modules)
    print("heavy:", sorted(heavy), file=sys.stderr)
"""


def test_help_lists_every_command_and_imports_nothing_heavy(folder):
    """`coadjoint --help` shows all commands without SymPy, NumPy, pydantic or rich."""
    command = [sys.executable, "-P", "-c", HELP]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    for name in program.COMMANDS:
        assert f"\n  {name} " in result.stdout
    assert result.stderr.strip() == "heavy: []"


@pytest.mark.parametrize("name", program.COMMANDS)
def test_every_command_explains_itself(name, run):
    """Each command has a help whose first line fits the list of commands."""
    result = run(name, "--help")
    assert result.exit_code == 0
    assert "Usage:" in result.output
    short = program.main.get_command(None, name).get_short_help_str(65)
    assert short.endswith("."), short
    assert not short.endswith("..."), short


def test_unknown_command_is_answered_with_the_nearest(run):
    """A misspelt command exits with 2 and is answered with the one that was meant."""
    result = run("regenrate")
    assert result.exit_code == 2
    assert "'regenrate'" in result.stderr
    assert "Did you mean 'regenerate'?" in result.stderr
    assert result.stdout == ""


@pytest.mark.parametrize(
    ("words", "offending"),
    [
        (["show", "heavy_top", "--format", "pdf"], "pdf"),
        (["crosscheck", "heavy_top", "--points", "0"], "0"),
        (["simulate", "heavy_top", "--set", "I=1,x,3"], "I=1,x,3"),
        (["show", "heavy_tpo"], "'heavy_tpo'"),
        (["prove", "./nowhere.toml"], "nowhere.toml"),
        (["simulate", "my.toml"], "my.toml"),
        (["completion", "tcsh"], "tcsh"),
    ],
)
def test_wrong_input_exits_with_2_and_names_itself(run, words, offending):
    """Wrong words of the command line are shown on standard error; nothing goes to the output."""
    result = run(*words)
    assert result.exit_code == 2
    assert offending in result.stderr
    assert "Traceback" not in result.stderr
    assert result.stdout == ""


def test_unknown_system_suggests_the_nearest(run):
    """The message names what there is."""
    assert "Did you mean 'heavy_top'" in run("show", "heavy_tpo").stderr


def test_streams_are_kept_apart(process):
    """In a real process an error is on standard error alone, in one line, with status 2."""
    result = process("prove", "no_such_system")
    assert (result.returncode, result.stdout) == (2, "")
    assert len(result.stderr.splitlines()) == 1


def test_traceback_only_for_debug(process):
    """The traceback of an error is shown with --debug and not without."""
    assert "Traceback" not in process("prove", "no_such_system").stderr
    debugged = process("--debug", "prove", "no_such_system")
    assert debugged.returncode == 2
    assert "Traceback" in debugged.stderr


def _failing(error):
    @program.click.command("list")
    def command():
        raise error

    return command


def test_fault_of_ours_is_one_line_with_status_70(monkeypatch):
    """An unexpected exception is one line that asks for a report, status 70 and no other."""
    failing = _failing(ZeroDivisionError("division by zero"))
    monkeypatch.setattr(program.main, "get_command", lambda _, name: failing)
    result = CliRunner().invoke(program.main, ["list"])
    assert result.exit_code == program.INTERNAL_FAULT == 70
    assert len(result.stderr.splitlines()) == 1
    assert "ZeroDivisionError: division by zero" in result.stderr
    assert "coadjoint --debug list" in result.stderr


def test_interrupt_exits_with_130(monkeypatch):
    """Ctrl-C ends a command with 130 and without a traceback."""
    monkeypatch.setattr(program.main, "get_command", lambda _, name: _failing(KeyboardInterrupt()))
    result = CliRunner().invoke(program.main, ["list"])
    assert result.exit_code == program.INTERRUPTED
    assert "Traceback" not in result.stderr


def test_interrupt_of_a_real_run_leaves_no_traceback(folder):
    """A process that is interrupted while it simulates ends with 130."""
    words = ["simulate", "rigid_body", "--time", "1e9", "--max-steps", "1000000000", "--json"]
    command = [sys.executable, "-P", "-m", "coadjoint.cli", *words]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as child:
        wait_for_work(child.pid, 3)  # long enough to be integrating, which takes minutes
        assert child.poll() is None
        child.send_signal(signal.SIGINT)
        output, error = child.communicate()
    assert child.returncode == program.INTERRUPTED
    assert (output, error.strip()) == ("", "interrupted")


def test_reader_who_leaves_is_no_traceback(folder):
    """`coadjoint schema | head -1` is quiet."""
    command = [sys.executable, "-P", "-m", "coadjoint.cli", "schema"]
    reading, writing = os.pipe()
    os.close(reading)
    result = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writing)
    assert result.returncode == 1
    assert result.stderr == ""
