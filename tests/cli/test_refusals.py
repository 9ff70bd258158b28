"""What a machine refuses is said as what it is, with status 2; and no spec speaks to a terminal."""

from __future__ import annotations

import errno
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from coadjoint.errors import CoadjointError, SpecError, plain, shorten, system_error
from coadjoint.limits import MESSAGE_ROWS
from coadjoint.resources import systems_folder
from tests.specs import RIGID_BODY

#: Without bytecode, which Python leaves torn where a limit of file sizes cuts it.
COMMAND = (sys.executable, "-B", "-P", "-m", "coadjoint.cli")
#: What a terminal would take for a command: a window title, a colour, a cursor, a turned text.
HOSTILE = "\x1b]0;owned\x07 \x1b[31m \x9b2J \u202e \r"
ESCAPED = r"\u001b]0;owned\u0007 \u001b[31m \u009b2J \u202e \r"


def obeyed(text):
    """Characters that a terminal would obey."""
    return {character for character in text if not character.isprintable() and character != "\n"}


@pytest.mark.parametrize("words", [("schema",), ("list",), ("--help",), ("list", "--help")])
def test_a_full_output_is_said(folder, words):
    """/dev/full takes no byte: status 2, one line, and nothing more at the end of the program."""
    with Path("/dev/full").open("w") as full:
        done = subprocess.run([*COMMAND, *words], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 2
    assert "standard output cannot be written: No space left on device" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_a_closed_output_is_said_before_any_work(folder):
    """Without a standard output the program ends at once, and no file takes its number."""
    shell = f"exec {' '.join(COMMAND)} list >&-"
    done = subprocess.run(["sh", "-c", shell], capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.startswith("error: standard output is closed")
    shell = f"exec {' '.join(COMMAND)} schema 2>&- <&-"
    done = subprocess.run(["sh", "-c", shell], capture_output=True, text=True)
    assert done.returncode == 0
    assert json.loads(done.stdout)


def test_an_output_without_the_letters_shows_escapes(folder):
    """An encoding of ASCII alone is no fault."""
    (folder / "body.toml").write_text(RIGID_BODY.replace("Free rigid", "Poincar\u00e9's"))
    environment = {**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"}
    words = ["show", "./body.toml"]
    done = subprocess.run([*COMMAND, *words], capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    assert r"Poincar\xe9's body" in done.stdout


def test_a_limit_of_file_sizes_is_said(folder):
    """Under `ulimit -f` the run names the limit, and no file is torn."""
    (folder / "derivations").mkdir()
    (folder / "derivations" / "body.toml").write_text(RIGID_BODY)

    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))

    done = subprocess.run(
        [*COMMAND, "regenerate"], capture_output=True, text=True, preexec_fn=limit
    )
    assert done.returncode == 2
    assert "File too large" in done.stderr
    assert "ulimit -f" in done.stderr
    assert "fault of coadjoint" not in done.stderr
    assert not list(folder.glob("generated/**/kernel.*"))


@pytest.mark.parametrize("words", [("regenerate",), ("prove", "derivations/body.toml"), ("list",)])
@pytest.mark.parametrize(
    ("kind", "most", "remedy"),
    [
        (resource.RLIMIT_FSIZE, 0, "ulimit -f"),
        (resource.RLIMIT_NOFILE, 8, "ulimit -n"),
        (resource.RLIMIT_NOFILE, 12, "ulimit -n"),
    ],
)
def test_a_limit_of_the_session_is_named_with_its_remedy(folder, words, kind, most, remedy):
    """Wherever it is met, in a library that loads and in a compiler that starts, too."""
    (folder / "derivations").mkdir()
    (folder / "derivations" / "body.toml").write_text(RIGID_BODY)

    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(kind, (most, most))

    done = subprocess.run([*COMMAND, *words], capture_output=True, text=True, preexec_fn=limit)
    assert done.returncode == 0 or (done.returncode == 2 and remedy in done.stderr), done.stderr
    assert kind == resource.RLIMIT_NOFILE or done.returncode == 2


def test_a_folder_that_is_gone_is_said(tmp_path):
    """The working folder was removed meanwhile."""
    gone = tmp_path / "gone"
    gone.mkdir()
    shell = f"rmdir {gone}; exec {' '.join(COMMAND)} regenerate"
    done = subprocess.run(["sh", "-c", shell], cwd=gone, capture_output=True, text=True)
    assert done.returncode == 2
    assert "the working folder no longer exists" in done.stderr


def test_faults_of_ours_stay_faults_of_ours():
    """An error that the machine did not make keeps status 70."""
    assert system_error(OSError(errno.ENOTDIR, "Not a directory", "x")) is None
    assert system_error(FileNotFoundError(errno.ENOENT, "No such file", "x")) is None
    refused = system_error(OSError(errno.ENOSPC, "No space left on device", "/a/file"))
    assert str(refused) == "/a/file: No space left on device. Free some space."
    assert refused.exit_status == 2
    assert system_error(ImportError("No module named 'numpi'")) is None
    unloaded = system_error(
        ImportError("x.so: cannot open shared object file: Too many open files")
    )
    assert str(unloaded).endswith("Too many open files. Raise the limit of open files (ulimit -n).")


# -- text of specs --------------------------------------------------------------------------------


def test_escapes_of_a_terminal_are_shown():
    """Every character that is obeyed is spelt out, lines stay lines."""
    assert plain("a\n" + HOSTILE) == ("a\n" + r"\x1b]0;owned\x07 \x1b[31m \x9b2J " + r"\u202e \r")
    assert plain("\u00e9 \u03a9\tb") == "\u00e9 \u03a9 b"
    assert not obeyed(str(SpecError(HOSTILE)))


@pytest.mark.parametrize("text", ["x" * 100_000, "x\n" * 5000, "long " * 400 + "\n" + "y\n" * 30])
def test_a_message_is_at_most_a_screen(text):
    """The beginning and the end stay: the place and the likely fix."""
    message = str(CoadjointError(f"top.toml:3:1: {text} Write it anew."))
    rows = sum(max(1, -(-len(line) // 80)) for line in message.split("\n"))
    assert rows <= MESSAGE_ROWS
    assert message.startswith("top.toml:3:1: ")
    assert message.endswith("Write it anew.")
    assert "[...]" in message
    assert shorten("short\nand good") == "short\nand good"


#: Places of a spec that take free text, or that a message repeats.
PLACES = {
    "title": ('title = "Free rigid body"', f'title = "{ESCAPED}"'),
    "source": ("[algebra]", f'source = "{ESCAPED}"\ndescription = "{ESCAPED}"\n[algebra]'),
    "key": ("[algebra]", f'"{ESCAPED}" = 1\n[algebra]'),
    "algebra": ('"so(3)"', f'"so(3{ESCAPED})"'),
    "route": ('"lie-poisson"', f'"lie-{ESCAPED}"'),
    "expression": ('"dot(Pi, Pi)"', f'"dot(Pi, {ESCAPED})"'),
    "name": ("Omega = {", f'"Om{ESCAPED}" = {{'),
    "unit": ('"momentum" }', f'"momentum", unit = "{ESCAPED}", doc = "{ESCAPED}" }}'),
    "default": ("[1, 2, 3]", f'[1, 2, "{ESCAPED}"]'),
}


@pytest.mark.parametrize("place", PLACES)
def test_no_command_hands_text_of_a_spec_to_a_terminal(folder, run, place):
    """Whatever a spec holds, neither output nor errors hold what a terminal would obey."""
    old, new = PLACES[place]
    assert old in RIGID_BODY
    (folder / "derivations").mkdir()
    path = folder / "derivations" / "body.toml"
    path.write_text(RIGID_BODY.replace(old, new), encoding="utf-8")
    commands = [("show", path), ("list",)] if place != "expression" else [("prove", path)]
    for words in commands:
        result = run(*words)
        assert result.exit_code in (0, 1, 2), result.stderr
        assert not obeyed(result.stdout), (words, result.stdout)
        assert not obeyed(result.stderr), (words, result.stderr)


def test_a_hostile_file_name_is_shown_as_escapes(folder, run):
    """A name is text of a stranger, too."""
    path = folder / "a\x1b[31mb.toml"
    path.write_text(RIGID_BODY)
    result = run("prove", path)
    assert result.exit_code == 2
    assert r"a\x1b[31mb.toml" in result.stderr
    assert not obeyed(result.stderr)


# -- damaged files --------------------------------------------------------------------------------


def spoil(path, damage):
    """Put something else in the place of a file."""
    path.unlink()
    if damage == "pipe":
        os.mkfifo(path)
    elif damage == "folder":
        path.mkdir()
    else:
        path.write_text(damage)


DAMAGES = [
    "pipe",
    "folder",
    "[" * 100_000,
    '{"claims": 3, "title": [], "docs": 5, "domain": [1], "constraints": {"a": 1}}',
    '{"claims": [{"verdict": ["proved"]}]}',
    '{"claims": [3]}',
]


def test_a_damaged_file_is_no_fault_of_ours_and_heals(folder, run):
    """Whatever stands there, each command ends in order, and the next run writes what was there."""
    (folder / "derivations").mkdir()
    (folder / "derivations" / "body.toml").write_text(RIGID_BODY)
    assert run("regenerate").exit_code == 0
    paths = [folder / "generated" / name for name in ("body/certificate.json", "manifest.json")]
    good = [path.read_bytes() for path in paths]
    for damages in (("pipe", "folder"), (DAMAGES[2], DAMAGES[2])):
        for path, damage in zip(paths, damages, strict=True):
            spoil(path, damage)
        (entry,) = json.loads(run("list", "--json").stdout)
        assert entry["state"] == "not generated"
        assert run("regenerate").exit_code == 0
        assert [path.read_bytes() for path in paths] == good
    for damage in DAMAGES[3:]:
        spoil(paths[0], damage)
        (entry,) = json.loads(run("list", "--json").stdout)
        assert (entry["state"], entry["proved"]) == ("files changed", 0)


@pytest.mark.parametrize("damage", DAMAGES, ids=range(len(DAMAGES)))
def test_a_system_with_a_damaged_certificate_still_works(folder, monkeypatch, run, damage):
    """What it lacks is its title, and no command ends with a fault of ours."""
    shutil.copytree(systems_folder() / "rigid_body", folder / "systems" / "rigid_body")
    shutil.copytree(systems_folder() / "suslov", folder / "systems" / "suslov")
    monkeypatch.setattr("coadjoint.cli.arguments.systems_folder", lambda: folder / "systems")
    for system in ("rigid_body", "suslov"):
        spoil(folder / "systems" / system / "certificate.json", damage)
        result = run("simulate", system, "--time", "0.1")
        assert result.exit_code in (0, 2), result.stderr
