"""`coadjoint simulate --members`: many trajectories from a file or at random, and how they end."""

from __future__ import annotations

import csv
import json
from importlib import import_module

import numpy as np
import pytest

from coadjoint.cli.members import MOST, Members, find_members
from coadjoint.solve.checkpoints import Checkpoint
from coadjoint.systems import heavy_top, rigid_body
from tests.driven_specs import POINT
from tests.kernels import COMPILER
from tests.rolling import FOLLOWED_SLEIGH, built
from tests.solve.domains import SUSLOV

simulate = import_module("coadjoint.cli.simulate")
pytestmark = pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")


def record_of(result):
    """What a command printed as JSON."""
    assert result.stdout, result.stderr
    return json.loads(result.stdout)


def test_random_members_lie_around_the_start(run):
    """Within a tenth of the largest component of each vector, uniformly, and not all alike."""
    words = ("simulate", "heavy_top", "--time", "0.1", "--samples", "1", "--json")
    one = record_of(run(*words))["initial"]
    record = record_of(run(*words, "--members", "400"))
    assert record["members"] == 400
    assert record["origin"] == "random states within 10 % around the start, seed 0"
    for name in ("Pi", "Gamma"):
        components = [f"{name}{n}" for n in (1, 2, 3)]
        largest = max(abs(one[each]) for each in components)
        for each in components:
            off = (np.array(record["initial"][each]) - one[each]) / (0.1 * largest)
            assert 0.95 < np.abs(off).max() <= 1
            # of 400 uniform numbers: the mean is 0 and the square 1/3, to four deviations
            assert abs(off.mean()) < 4 * np.sqrt(1 / 3 / 400)
            assert abs((off**2).mean() - 1 / 3) < 4 * np.sqrt(4 / 45 / 400)
    again = record_of(run(*words, "--members", "400", "--threads", "1"))
    assert again == record
    other = record_of(run(*words, "--members", "400", "--seed", "1"))
    assert other["initial"] != record["initial"]
    assert other["origin"].endswith("seed 1")


def test_members_run_as_the_same_states_do_in_python(run):
    """Statuses, steps, times and final states are those of `System.simulate`, to the last digit."""
    words = ("--members", "9", "--method", "dop853", "--time", "3", "--set", "m=2", "--json")
    record = record_of(run("simulate", "heavy_top", *words))
    state = np.array([record["initial"][name] for name in heavy_top.STATE.components])
    found = heavy_top.simulate(state, (0, 3), {"m": 2}, method="dop853", samples=101)
    assert record["status"] == found.status.tolist() == ["OK"] * 9
    assert record["steps"] == found.steps.tolist()
    assert record["final"] == {name: values.tolist() for name, values in found.final.items()}
    assert record["drift"] == {name: values.tolist() for name, values in found.drift.items()}
    assert record["parameters"]["m"] == 2


def test_members_come_from_a_file(run, folder):
    """Columns of state and parameters; the rest is as for one; comments and spaces do no harm."""
    (folder / "many.csv").write_text(
        "\ufeff# two bodies\n Pi1 , I2\n1, 2\n\n# the last one\n-0.5,2.5e0\n", encoding="utf-8"
    )
    words = ("--members", "many.csv", "--set", "I=1,5,3", "--state", "Pi=9,1,1", "--time", "2")
    result = run("simulate", "rigid_body", *words, "--json", "--csv", "out.csv")
    assert result.exit_code == 0, result.stderr
    record = record_of(result)
    assert record["origin"] == "rows of many.csv"
    assert record["initial"]["Pi1"] == [1, -0.5]
    assert record["initial"]["Pi2"] == record["initial"]["Pi3"] == [1, 1]
    names = ("I1", "I2", "I3")
    assert [record["parameters"][each] for each in names] == [[1, 1], [2, 2.5], [3, 3]]
    one = rigid_body.simulate([-0.5, 1, 1], (0, 2), {"I": [1, 2.5, 3]}, samples=1)
    assert [record["final"][f"Pi{n}"][1] for n in (1, 2, 3)] == one.state[:, 0].tolist()
    table = (folder / "out.csv").read_text().splitlines()
    lines = [line for line in table if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    assert [row["member"] for row in rows] == ["0"] * 101 + ["1"] * 101


def test_inputs_of_members_come_from_a_file(run, folder):
    """A force of each moves 2 kg from rest by f m in 2 s."""
    (folder / "pushed.toml").write_text(POINT)
    (folder / "forces.csv").write_text("f\n4\n1\n")
    words = ("--state", "0,0", "--time", "2", "--members", "forces.csv", "--json")
    record = record_of(run("simulate", "pushed.toml", *words))
    np.testing.assert_allclose(record["final"]["x"], [4, 1], atol=1e-9)


def test_members_that_fail_are_shown_and_give_status_1(run, folder):
    """The table has how each ended; those that failed come into it, however many there are."""
    rows = [["1"]] * 60
    rows[57] = ["1e200"]
    (folder / "many.csv").write_text("\n".join(["Pi1", *(row[0] for row in rows)]))
    result = run("simulate", "rigid_body", "--members", "many.csv", "--time", "1")
    assert result.exit_code == 1
    (line,) = [line for line in result.stdout.splitlines() if line.split()[:1] == ["57"]]
    assert line.split()[1] in ("NONFINITE", "STEP_UNDERFLOW")
    assert "1 of 60 trajectories did not reach the end" in result.stdout
    assert "and 10 more; --json has them all" in result.stdout
    shown = [line.split() for line in result.stdout.splitlines() if line.split()[1:2] == ["OK"]]
    assert [int(words[0]) for words in shown] == list(range(49))
    fine = run("simulate", "rigid_body", "--members", "2", "--time", "1")
    assert fine.exit_code == 0
    assert "status: OK: 2 members reached the end" in fine.stdout
    one = run("simulate", "rigid_body", "--max-steps", "3")
    assert one.exit_code == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "has 0 members below the columns none"),
        ("Pi1,I2\n", "has 0 members below the columns Pi1, I2"),
        ("Pi1,Pi1\n1,2\n", "expected columns with different names"),
        ("Pi1,J\n1,2\n", "the column 'J' is none of Pi1, Pi2, Pi3, I1, I2, I3"),
        ("# head\nPi1,I2\n1,2\n3\n", "line 4: 1 value; expected 2"),
        ("Pi1,I2\n1,2\n3,x\n", "line 3: could not convert string to float: 'x'"),
        ("Pi1\n1\nnan\n", "the initial Pi1 of member 1 is nan"),
        ("I1\n1\n-2\n", "parameter I1 of member 1 of rigid_body is -2; expected a positive value"),
        ("I1\n1\ninf\n", "I1 of member 1 of the parameters is inf; expected a finite number"),
    ],
)
def test_a_wrong_file_is_named(run, folder, monkeypatch, text, message):
    """With its line or column, before anything is computed."""
    (folder / "many.csv").write_text(text)
    monkeypatch.setattr("coadjoint.solve.generated.march", None)
    result = run("simulate", "rigid_body", "--members", "many.csv")
    assert result.exit_code == 2
    assert message in result.stderr


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--members", "none.csv"], "none.csv cannot be read: No such file or directory"),
        (["--members", "."], "cannot be read: Is a directory"),
        (["--members", "0"], f"0 members; expected 1 to {MOST}"),
        (["--members", "9" * 30], "expected 1 to"),
        (["--members", "-3"], "-3 cannot be read"),
        (
            ["--members", "3", "--plot", "a.png"],
            "--plot, --animate and --trace are of one trajectory",
        ),
        (
            ["--members", "3", "--animate", "a.gif"],
            "--plot, --animate and --trace are of one trajectory",
        ),
        (["--members", "3", "--method", "scipy:Radau"], "follows one trajectory"),
        (["--threads", "0"], "'--threads': 0 is not in the range"),
        (["--step", "-1"], "step is -1.0; expected a positive number"),
        (["--step", "0.1", "--atol", "1e-9"], "expected one or the other"),
        (["--method", "rk4"], "expected step="),
        (["--checkpoint", "missing/a.npz"], "missing is not a folder"),
        (["--checkpoint", "a.npz", "--method", "scipy:BDF"], "of SciPy keeps none"),
        (["--members", "1000000", "--samples", "10000000"], "samples=1 keeps the end alone"),
    ],
)
def test_what_cannot_be_is_refused_first(run, folder, monkeypatch, words, message):
    """Status 2, and nothing is computed or written."""
    pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")
    monkeypatch.setattr("coadjoint.solve.generated.march", None)
    result = run("simulate", "rigid_body", *words)
    assert result.exit_code == 2
    assert message in result.stderr
    assert not list(folder.iterdir())


def test_a_command_goes_on_from_its_checkpoint(run, folder, monkeypatch):
    """The second time nothing is left to be computed; the output is the same."""
    words = ("simulate", "heavy_top", "--members", "20", "--checkpoint", "run.npz")
    first = run(*words)
    assert first.exit_code == 0, first.stderr
    monkeypatch.setattr(Checkpoint, "write", None)
    assert run(*words).stdout == first.stdout
    other = run(*words, "--seed", "5")
    assert other.exit_code == 2
    assert "run.npz is the checkpoint of another run: its initial state has" in other.stderr


def test_random_members_are_on_the_constraints(folder):
    """A body whose twist is kept: 0 = Omega1 + 2 Omega2 + 2 Omega3, of every member."""
    from coadjoint import load

    (folder / "suslov_0.toml").write_text(SUSLOV)
    system = load(folder / "suslov_0.toml")
    start = simulate.find_start(system, ())
    many = find_members(
        system, "40", 0, Members(state=list(start), parameters={}, inputs=None, followed={})
    )
    off = many.state[0] + 2 * many.state[1] + 2 * many.state[2]
    assert np.abs(off).max() < 1e-15
    assert np.ptp(many.state, axis=1).min() > 0.01
    assert many.origin.endswith("seed 0, moved onto the constraints")


def test_places_begin_where_they_are_told_to(run, folder):
    """A sleigh that begins elsewhere, turned by a right angle, makes the same way from there."""
    words = ("simulate", "chaplygin_sleigh", "--time", "2", "--samples", "2", "--json")
    turn = np.pi / 2
    names = ("x", "y", "theta")
    (folder / "places.csv").write_text("x,y\n0,0\n3,-1\n")
    one = record_of(run(*words))
    moved = record_of(run(*words, "--state", "x=3", "--state", "y=-1", "--state", f"theta={turn}"))
    many = record_of(run(*words, "--members", "places.csv", "--state", f"theta={turn}"))
    assert [moved["initial"][name] for name in names] == [3, -1, turn]
    assert many["initial"]["theta"] == [turn, turn]
    x, y, theta = (one["final"][name] for name in names)
    np.testing.assert_allclose(
        [moved["final"][each] for each in names], [3 - y, x - 1, theta + turn]
    )
    np.testing.assert_allclose(many["final"]["x"], [-y, 3 - y])
    np.testing.assert_allclose(many["final"]["y"], [x, x - 1])
    for name in ("v", "omega"):  # the state knows nothing of its place
        assert moved["initial"][name] == one["initial"][name]
        assert abs(moved["final"][name] - one["final"][name]) < 1e-9


def test_names_of_places_are_told(run):
    """An unknown name is refused with all that there is, and a wrong number of values, too."""
    words = ("simulate", "chaplygin_sleigh", "--state")
    assert "'z' is not one of v, omega, theta, x, y" in run(*words, "z=1").stderr
    result = run(*words, "x=1,2")
    assert result.exit_code == 2
    assert "x has the shape (2,)" in result.stderr


@pytest.mark.parametrize("members", [[], ["--members", "3"]], ids=["one", "members"])
def test_places_and_events_are_kept_in_a_checkpoint(run, folder, monkeypatch, members):
    """One trajectory and many are reconstructed, by a generated solver; the same is shown again."""
    monkeypatch.setattr(simulate, "load_system", lambda *_: built(FOLLOWED_SLEIGH))
    words = ("simulate", "sleigh.toml", "--time", "2", "--samples", "5", "--json", *members)
    words += ("--events", "x = 0.5", "--checkpoint", "run.npz", "--csv", "run.csv")
    first = run(*words)
    assert first.exit_code == 0, first.stderr
    record = record_of(first)
    assert {"theta", "x", "y"} <= record["final"].keys() & record["initial"].keys()
    with (folder / "run.csv").open() as file:
        *_, last = csv.DictReader(line for line in file if not line.startswith("#"))
    final = np.ravel(record["final"]["x"])[-1]
    assert float(last["x"]) == final != np.ravel(record["initial"]["x"])[-1]
    monkeypatch.setattr(Checkpoint, "write", None)
    assert run(*words).stdout == first.stdout
    other = run(*words, "--events", "y = 3.1")
    assert other.exit_code == 2
    assert "its events is" in other.stderr
