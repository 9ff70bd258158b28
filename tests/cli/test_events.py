"""`coadjoint simulate --events`: what is found, printed and written."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from scipy.special import ellipk

BODY = ("simulate", "rigid_body", "--state", "Pi=0.5,0,1", "--set", "I=1,2,3", "--time", "30")
#: Half a period of a free body with these momenta: the time from one zero of Pi2 to the next.
HALF = 2 * ellipk((0.25 * 3 + 1 - 1.25) / (1.25 - 0.25 - 1 / 3)) / np.sqrt(2 / 3 / 6)


def test_events_are_shown_in_a_table(run):
    """With the time, the direction and the state; the trajectory goes on to its end."""
    result = run(*BODY, "--events", "Pi2 = 0", "--events", "Pi1 == 2")
    assert result.exit_code == 0, result.stderr
    rows = [line.split() for line in result.stdout.splitlines() if line.strip().startswith("Pi2 =")]
    times = [float(row[3]) for row in rows]
    assert np.abs(np.array(times) - HALF * np.arange(1, len(times) + 1)).max() < 1e-7
    assert [row[4] for row in rows] == ["falls", "rises"]
    assert "no event 'Pi1 == 2'" in result.stdout
    assert "status: OK" in result.stdout


def test_the_table_shows_what_events_name(run):
    """The place of a sleigh is reconstructed, and the table of its state has it where x is 1."""
    result = run("simulate", "chaplygin_sleigh", "--events", "x = 0.2", "--time", "5")
    head, row = (
        next(line.split() for line in result.stdout.splitlines() if word in line.split())
        for word in ("event", "rises")
    )
    assert head[-3:] == ["v", "omega", "x"]
    assert float(row[-1]) == 0.2


def test_an_event_ends_the_run(run):
    """With status 0; without any event the status is 1, and the output says so."""
    result = run(*BODY, "--events", "Pi2 = 0", "--until-event", "--json")
    assert result.exit_code == 0, result.stderr
    record = json.loads(result.stdout)
    assert record["status"] == "EVENT"
    assert record["time"] == pytest.approx(HALF, abs=1e-8)
    events = record["events"]["Pi2 = 0"]
    assert events["count"] == 1
    assert events["time"] == [record["time"]]
    assert events["state"]["Pi1"] == [record["final"]["Pi1"]]
    assert "warning" not in result.stderr
    never = run(*BODY, "--events", "Pi1 == 2", "--until-event")
    assert never.exit_code == 1
    assert "no event 'Pi1 == 2'" in never.stdout
    warning = "warning: the run came to the end without an event 'Pi1 == 2'"
    assert never.stderr.splitlines() == [warning]


def test_members_that_meet_no_event_are_counted(run, folder):
    """A body turns about its first axis for ever; about the third one Pi1 changes its sign."""
    (folder / "two.csv").write_text("Pi1,Pi2,Pi3\n1,0,0\n0.5,0,1\n")
    words = ("--members", "two.csv", "--time", "30", "--events", "Pi1 = -0.3", "--until-event")
    result = run("simulate", "rigid_body", *words, "--set", "I=1,2,3", "--json")
    assert result.exit_code == 1
    assert json.loads(result.stdout)["status"][0] == "OK"
    (line,) = result.stderr.splitlines()
    assert line.startswith("warning: 1 of 2 members came to the end without an event")


def test_a_table_and_a_picture_of_events_are_written(run, folder):
    """All events, also those beyond the rows on screen."""
    pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")
    words = ("--events", "sin(9*t*Omega3) = 0", "--events-csv", "e.csv", "--section", "s.png")
    turning = [word.replace("0.5,0,1", "0,0,3") for word in BODY]  # Omega3 = 1 throughout
    result = run(*turning, *words, "--section-axes", "Pi1,Omega2")
    assert result.exit_code == 0, result.stderr
    with (folder / "e.csv").open() as file:
        rows = list(csv.DictReader(file))
    times = np.array([float(row["time"]) for row in rows])
    assert np.abs(times - np.pi / 9 * np.arange(1, len(rows) + 1)).max() < 1e-12
    assert len(rows) == int(30 * 9 / np.pi) == 85
    assert {"event", "direction", "Pi1", "energy"} <= rows[0].keys()
    assert "65 more events; --events-csv FILE writes all 85." in result.stdout
    assert (folder / "s.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_events_of_members_are_counted_for_each(run):
    """A faster body has more of them."""
    result = run(*BODY, "--members", "3", "--events", "Pi2 = 0", "--json")
    assert result.exit_code == 0, result.stderr
    events = json.loads(result.stdout)["events"]["Pi2 = 0"]
    assert set(events["member"]) == {0, 1, 2}
    assert len(events["time"]) == events["count"] >= 6


@pytest.mark.parametrize(
    ("words", "offending"),
    [
        (("--until-event",), "--until-event needs --events"),
        (("--events-csv", "e.csv"), "--events-csv needs --events"),
        (("--section-axes", "Pi1,Pi2"), "--section-axes needs --section"),
        (("--events", "Pj = 0"), "'Pj' is not declared"),
        (("--events", "Pi1 < 0"), "two sides are equal"),
        (("--events", "energy = 1"), "the motion conserves energy"),
        (("--events", "Pi1", "--events-csv", "no/e.csv"), "no"),
        (("--events", "Pi1", "--section", "e.xyz"), ".xyz"),
        (
            ("--events", "Pi1", "--section", "e.png", "--section-axes", "Pi1,Pj"),
            "'Pj' is not known",
        ),
        (("--events", "Pi1", "--section", "e.png", "--section-axes", "Pi1,Pi"), "3 components"),
        (("--events", "Pi1", "--section", "e.png", "--section-axes", "Pi1"), "names of two"),
    ],
)
def test_wrong_options_of_events_are_refused(run, words, offending):
    """With status 2, before anything is computed."""
    if "--section" in words:
        pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")
    result = run(*BODY, *words)
    assert result.exit_code == 2
    assert offending in result.stderr
