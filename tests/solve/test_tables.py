"""Tables: CSV files and frames hold every bit of a solution, with names and units."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError, OutputError
from coadjoint.solve.solution import Solution
from coadjoint.systems import rigid_body
from tests.solve.runs import RUNS, check_same, follow_sleigh, made, turn_densely


@pytest.mark.parametrize("kind", RUNS)
def test_a_table_reads_back_to_the_last_bit(kind, tmp_path):
    """All arrays, the status and the settings, also of NaN and infinity."""
    solution, path = RUNS[kind](), tmp_path / "run.csv"
    solution.to_csv(path)
    check_same(Solution.from_csv(solution.system, path), solution)
    assert list(tmp_path.iterdir()) == [path]


def test_the_comparison_sees_one_bit():
    """The check above can fail."""
    solution = made()
    other = made(state=np.nextafter(solution.state, 1), parameters=solution.parameters)
    with pytest.raises(AssertionError):
        check_same(other, solution)


def test_a_table_states_units_and_has_one_row_per_time(tmp_path):
    """Below the lines of ``#`` a plain table, which `csv` and pandas read."""
    solution, path = follow_sleigh(), tmp_path / "run.csv"
    solution.to_csv(path)
    lines = path.read_text().splitlines()
    said = dict(line[2:].split(": ", 1) for line in lines if line.startswith("#"))
    units = json.loads(said["units"])
    assert (units["time"], units["x"], units["theta"]) == ("s", "m", "1")
    assert json.loads(said["parameters"]).keys() == set(solution.system.PARAMETERS.components)
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    assert [float(row["time"]) for row in rows] == solution.time.tolist()
    assert [float(row["x"]) for row in rows] == solution["x"].tolist()
    assert list(rows[0]) == list(units)


def test_a_table_of_members_has_one_row_for_each_and_time(tmp_path):
    """Members come first, one column for each axis of the batch."""
    made((3, 2)).to_csv(tmp_path / "run.csv")
    lines = (tmp_path / "run.csv").read_text().splitlines()
    head, *rows = csv.reader(line for line in lines if not line.startswith("#"))
    assert head[:3] == ["member_0", "member_1", "time"]
    assert len(rows) == 3 * 2 * 4
    assert [row[:2] for row in rows[::4]] == [[str(a), str(b)] for a in range(3) for b in range(2)]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("rigid_body", "heavy_top", "is of the system heavy_top"),
        ("# status:", "# other:", "does not say its status"),
        ("# samples: 4", "# samples: 5", "4 values were found in place of"),
        ("time,Pi1", "time,Pj1", "of Pi1, none values were found"),
        ("3.141592653589793,", "three,", "could not convert string to float: 'three'"),
        ("3.141592653589793,", "", "inhomogeneous"),
        ("# batch: []", "# batch: [", "Expecting value"),
        ("# course: {}", '# course: {"start": {}}', "its course is damaged"),
        ("# course: {", "# other: {", "does not say its course"),
    ],
)
def test_a_spoiled_table_is_refused(old, new, message, tmp_path):
    """Another system, a line or row that is missing, and what is no number."""
    path = tmp_path / "run.csv"
    made(message="").to_csv(path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(KernelArgumentError, match=message) as caught:
        Solution.from_csv(rigid_body.system, path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("method", "old", "new", "message"),
    [
        ("taylor", '"begun": [0.0, ', '"begun": [', "begin, and are long, in arrays of one length"),
        ("taylor", '"member": [0, ', '"member": [', "not as many steps as begin"),
        ("taylor", '"coefficients": [[', '"others": [[', "its steps are damaged: 'coefficients'"),
        ("scipy:RK45", '"class": "RkDenseOutput"', '"class": "system"', "its steps are damaged"),
    ],
)
def test_spoiled_steps_are_refused(method, old, new, message, tmp_path):
    """Numbers that are missing, and interpolants of no class of SciPy."""
    path = tmp_path / "run.csv"
    turn_densely(method).to_csv(path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(KernelArgumentError, match=message):
        Solution.from_csv(rigid_body.system, path)


def test_a_table_that_is_not_there_is_named(tmp_path):
    """A missing file, an empty one, and a folder that does not exist."""
    with pytest.raises(KernelArgumentError, match=r"none\.csv cannot be read: No such file"):
        Solution.from_csv(rigid_body.system, tmp_path / "none.csv")
    (tmp_path / "empty.csv").write_text("")
    with pytest.raises(KernelArgumentError, match=r"empty\.csv cannot be read"):
        Solution.from_csv(rigid_body.system, tmp_path / "empty.csv")
    with pytest.raises(OutputError, match=r"missing is not a folder\. Create it"):
        made().to_csv(tmp_path / "missing" / "run.csv")


def test_a_failed_write_leaves_the_old_table(tmp_path, monkeypatch):
    """The file is replaced at the end; what stopped on the way leaves nothing."""
    path = tmp_path / "run.csv"
    path.write_text("old")
    monkeypatch.setattr(json, "dumps", lambda _value, default: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        made().to_csv(path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_frame_has_one_row_per_time():
    """One column per component; a batch has one row per member and time."""
    pytest.importorskip("pandas", reason="the extra 'data' is not installed")
    solution = follow_sleigh()
    frame = solution.to_pandas()
    assert len(frame) == len(solution)
    assert frame.index.name == "time"
    assert frame["x"].to_numpy().tolist() == solution["x"].tolist()
    assert frame.attrs["units"]["x"] == "m"
    many = made((3, 2))
    frame = many.to_pandas()
    assert frame.index.names == ["member_0", "member_1", "time"]
    last = frame.loc[(2, 1), "Pi1"].to_numpy()
    np.testing.assert_array_equal(last, many.state[0, 2, 1])


def test_pandas_is_asked_for_by_name_where_it_is_missing(monkeypatch):
    """The message has the pip command."""
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(KernelArgumentError, match=r"pip install 'coadjoint\[data\]'"):
        made().to_pandas()
