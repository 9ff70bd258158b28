"""`coadjoint simulate` integrates from the command line and shows what it kept."""

from __future__ import annotations

import csv
import json
import math
import sys
import tomllib
from dataclasses import replace
from fractions import Fraction
from importlib import import_module

import numpy as np
import pytest

from coadjoint.cli.arguments import load_system
from coadjoint.resources import derivations_folder
from coadjoint.solve.quantities import Quantities
from tests.conftest import SYSTEMS
from tests.driven_specs import POINT
from tests.rolling import FOLLOWED_SLEIGH
from tests.solve.domains import STONE, SUSLOV
from tests.specs import RIGID_BODY

simulate = import_module("coadjoint.cli.simulate")


def test_invariants_of_a_shipped_system_are_kept(run):
    """Energy and Casimirs of the heavy top drift by less than 1e-8 in ten seconds."""
    result = run("simulate", "heavy_top", "--json")
    assert result.exit_code == 0, result.stderr
    record = json.loads(result.stdout)
    assert record["status"] == "OK"
    assert record["time"] == 10.0
    assert set(record["drift"]) == {"energy", "casimir1", "casimir2"}
    assert all(drift < 1e-8 for drift in record["drift"].values())
    assert record["final"]["Pi1"] != record["initial"]["Pi1"]
    assert record["units"]["Pi1"] == "kg m^2/s"


def test_the_default_state_has_vectors_of_unit_length(run):
    """Without --state vectors have length 1, the first along (1, 2, 3), the next (2, 3, 1)."""
    initial = json.loads(run("simulate", "heavy_top", "--time", "0.1", "--json").stdout)["initial"]
    for name, direction in {"Pi": (1, 2, 3), "Gamma": (2, 3, 1)}.items():
        values = [initial[f"{name}{n}"] for n in (1, 2, 3)]
        assert values == [n / math.sqrt(14) for n in direction]


def test_fields_take_fourier_derivatives(run):
    """KdV's energy alone is claimed to be kept, and a body has no fields."""
    words = ("--derivatives", "fourier", "--time", "0.01", "--samples", "2", "--json")
    result = run("simulate", "kdv", *words)
    assert result.exit_code == 0, result.stderr
    record = json.loads(result.stdout)
    assert set(record["drift"]) == {"energy"}
    assert record["drift"]["energy"] < 1e-13
    assert run("simulate", "rigid_body", *words).exit_code == 2


def test_a_start_off_the_constraints_ends_with_status_2(run):
    """With the constraint, its residual and where to begin instead."""
    result = run("simulate", "veselova", "--state", "Omega=1,2,3")
    assert result.exit_code == 2
    assert "twistless, dot(Gamma, Omega) == 0, does not hold" in result.stderr
    assert "left minus right is 3; expected 0" in result.stderr
    assert "Omega3 = 0: begin there" in result.stderr
    assert run("simulate", "veselova", "--state", "Omega=1,2,0", "--time", "0.1").exit_code == 0


def test_a_start_that_nobody_gave_is_on_the_constraints(run, folder):
    """Without defaults (1, 2, 3)/|.| goes onto Omega1 + 2 Omega2 + 2 Omega3 = 0."""
    (folder / "suslov_0.toml").write_text(SUSLOV)
    result = run("simulate", "suslov_0.toml", "--time", "0.1", "--json")
    assert result.exit_code == 0, result.stderr
    first = json.loads(result.stdout)["initial"]
    assert abs(first["Omega1"] + 2 * first["Omega2"] + 2 * first["Omega3"]) < 1e-15
    assert first["Omega1"] != 0
    given = run("simulate", "suslov_0.toml", "--state", "Omega=1,2,3")
    assert given.exit_code == 2
    assert "left minus right is 11" in given.stderr


def test_state_and_parameters_come_from_the_command_line(run):
    """A quantity, a component and a parameter that are given are those of the run."""
    words = ["--state", "Pi=1,0,0", "--state", "Gamma3=0.5"]
    words += ["--set", "chi=0,0,2", "--set", "m=3", "--set", "I2=5"]
    record = json.loads(run("simulate", "heavy_top", *words, "--json").stdout)
    assert [record["initial"][f"Pi{n}"] for n in (1, 2, 3)] == [1, 0, 0]
    assert record["initial"]["Gamma3"] == 0.5
    assert [record["parameters"][name] for name in ("chi3", "m", "I2")] == [2, 3, 5]
    whole = json.loads(run("simulate", "rigid_body", "--state", "1,-2,3", "--json").stdout)
    assert whole["initial"]["Pi2"] == -2


@pytest.mark.parametrize(
    ("words", "offending"),
    [
        (["--set", "J=1"], "'J'"),
        (["--set", "I=1,2"], "I"),
        (["--set", "I=1,-2,3"], "-2"),
        (["--state", "Pj=1,2,3"], "'Pj'"),
        (["--state", "Pi=1,2"], "[1.0, 2.0]"),
        (["--state", "Pi=1,2,nan"], "nan"),
        (["--method", "euler"], "'euler'"),
        (["--time", "-1"], "-1"),
    ],
)
def test_wrong_values_are_named(run, words, offending):
    """A wrong name, length, sign or method ends with status 2 and names itself."""
    result = run("simulate", "rigid_body", *words)
    assert result.exit_code == 2
    assert offending in result.stderr


def test_tables_show_state_units_and_drift(run):
    """The tables have a line for each component, with its unit, and the drift of invariants."""
    result = run("simulate", "rigid_body")
    assert "Free rigid body" in result.stdout
    (line,) = [line for line in result.stdout.splitlines() if line.strip().startswith("Pi1")]
    assert "kg m^2/s" in line
    (line,) = [line for line in result.stdout.splitlines() if "energy" in line]
    assert float(line.split()[-1]) < 1e-8
    assert "status: OK" in result.stdout


def test_each_component_of_a_conserved_vector_has_its_drift(run):
    """Of the spatial momentum all three, and of a velocity none."""
    lines = [line.split() for line in run("simulate", "rigid_body_attitude").stdout.splitlines()]
    rows = {words[0]: words for words in lines if words}
    drifts = [float(rows[f"Pi_spatial{n}"][-1]) for n in (1, 2, 3)]
    assert all(0 < drift < 1e-8 for drift in drifts)
    assert rows["Omega1"][-1] == "1/s"


def table_of(path):
    """The lines of a table, without those that stand above it."""
    return [line for line in path.read_text().splitlines() if not line.startswith("#")]


def test_csv_reads_back_to_the_trajectory(run, folder):
    """The rows of the table are the samples, and the rates belong to the states."""
    run("simulate", "rigid_body", "--csv", "body.csv", "--samples", "11", "--time", "1")
    rows = list(csv.DictReader(table_of(folder / "body.csv")))
    assert [float(row["time"]) for row in rows] == np.linspace(0, 1, 11).tolist()
    state = [float(rows[-1][name]) for name in ("Pi1", "Pi2", "Pi3")]
    assert float(rows[-1]["energy"]) == load_system("rigid_body").energy(state)


def test_plot_writes_a_picture(run, folder):
    """--plot writes a PNG of reasonable size."""
    pytest.importorskip("matplotlib")
    assert run("simulate", "heavy_top", "--plot", "top.png").exit_code == 0
    picture = (folder / "top.png").read_bytes()
    assert picture.startswith(b"\x89PNG")
    assert len(picture) > 20_000


def test_a_spec_of_ones_own_runs(run, rigid_body):
    """A spec given by path is derived, proved and compiled, and then simulated."""
    record = json.loads(run("simulate", rigid_body, "--json").stdout)
    assert (record["system"], record["status"]) == ("body", "OK")
    assert record["drift"]["energy"] < 1e-8


def test_a_false_claim_is_not_simulated(run, false_claim):
    """A spec whose claim is false ends with status 1 and the claim."""
    result = run("simulate", false_claim)
    assert result.exit_code == 1
    assert "Pi[1] + Pi[2]" in result.stderr


def test_motion_that_leaves_the_finite_numbers_has_status_1(run, rigid_body):
    """A state too large for its rates is reported as such."""
    result = run("simulate", rigid_body, "--state", "Pi=1e200,2e200,3e200")
    assert result.exit_code == 1
    assert "NONFINITE" in result.stdout
    record = json.loads(run("simulate", rigid_body, "--state", "1e200,1, 1", "--json").stdout)
    assert record["status"] == "NONFINITE"  # the second coefficients of the series overflow
    assert "rates, or what a step makes of them, are not finite near t = 0" in record["message"]
    assert record["time"] == 0
    assert record["drift"]["energy"] is None


def test_leaving_the_domain_has_status_1_and_beginning_outside_2(folder, run):
    """A stone reaches the ground: table and reason; below it nothing is simulated."""
    (folder / "stone.toml").write_text(STONE)
    words = ("stone.toml", "--time", "3", "--csv", "stone.csv")
    result = run("simulate", *words)
    assert result.exit_code == 1
    assert "status: DOMAIN: the condition above, h > 0, does not hold" in result.stdout
    *_, last = (folder / "stone.csv").read_text().splitlines()
    assert abs(float(last.partition(",")[0]) - 2) < 1e-9
    refused = run("simulate", "stone.toml", "--state", "h=-3")
    assert refused.exit_code == 2
    assert "above, h > 0, does not hold at the given state" in refused.stderr
    assert "h = -3" in refused.stderr
    heavy = run("simulate", "stone.toml", "--set", "g=2")
    assert heavy.exit_code == 2
    assert "m = 1, g = 2: change one of them" in heavy.stderr


def test_a_system_begins_where_its_spec_says(folder, run):
    """A default of a quantity is taken; what is given on the command line is stronger."""
    text = RIGID_BODY.replace(
        'Pi = { role = "momentum"', 'Pi = { role = "momentum", default = [3, 0, "0.5"]'
    )
    assert text != RIGID_BODY
    (folder / "body.toml").write_text(text)
    initial = json.loads(run("simulate", "body.toml", "--json").stdout)["initial"]
    assert [initial[f"Pi{n}"] for n in (1, 2, 3)] == [3, 0, 0.5]
    given = json.loads(run("simulate", "body.toml", "--state", "Pi2=1", "--json").stdout)["initial"]
    assert [given[f"Pi{n}"] for n in (1, 2, 3)] == [3, 1, 0.5]


def test_what_is_reconstructed_is_shown_written_and_drawn(folder, run):
    """A sleigh's place: in the tables, in the CSV with the first row at its start, in a picture."""
    pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")
    (folder / "sleigh.toml").write_text(FOLLOWED_SLEIGH)
    words = ["--time", "2", "--samples", "3", "--csv", "way.csv", "--trace", "way.png"]
    result = run("simulate", "sleigh.toml", *words)
    assert result.exit_code == 0, result.stderr
    assert "reconstructed" in result.stdout
    head, first, *_ = csv.reader(table_of(folder / "way.csv"))
    row = dict(zip(head, map(float, first), strict=True))
    assert {name: row[name] for name in ("theta", "x", "y")} == {"theta": 0, "x": 0, "y": 3}
    assert (folder / "way.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_without_a_path_on_a_plane_there_is_no_trace(folder, run):
    """A rigid body has no x and y: status 2, nothing is computed or written."""
    result = run("simulate", "rigid_body", "--trace", "way.png")
    assert result.exit_code == 2
    assert "rigid_body leaves no trace: no x and no y among Pi" in result.stderr
    assert not result.stdout
    assert not list(folder.iterdir())


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--csv", "missing/a.csv"], "missing is not a folder"),
        (["--plot", "missing/a.png"], "missing is not a folder"),
        (["--plot", "a.unknown"], "its ending is '.unknown'"),
        (["--trace", "a"], "its ending is ''"),
        (["--csv", "."], "it is a folder"),
    ],
)
def test_outputs_are_checked_before_anything_is_computed(run, folder, monkeypatch, words, message):
    """A missing folder, an unknown ending and a folder: nothing is loaded, status 2."""
    monkeypatch.setattr(simulate, "load_system", None)
    result = run("simulate", "heavy_top", *words)
    assert result.exit_code == 2
    assert message in result.stderr
    assert not list(folder.iterdir())


def test_matplotlib_is_missed_before_anything_is_computed(run, folder, monkeypatch):
    """The message has the pip command."""
    monkeypatch.setattr(simulate, "load_system", None)
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    for option in ("--plot", "--trace"):
        result = run("simulate", "heavy_top", option, "a.png")
        assert result.exit_code == 2
        assert "pip install 'coadjoint[plot]'" in result.stderr
    assert not list(folder.iterdir())


@pytest.mark.parametrize("name", SYSTEMS)
def test_defaults_run_to_the_end(name):
    """From the defaults of its spec every shipped system runs 10 s and ends with OK."""
    loaded = load_system(name)
    loaded.STATE = with_defaults(loaded.STATE, derivations_folder() / f"{name}.toml")
    options = {"rtol": 1e-6, "target": "python"}
    if "noise" in loaded.functions:
        options = {"step": 0.1, "seed": 0, "target": "numpy"}
    found = loaded.simulate(simulate.find_start(loaded, ()), (0, 10), samples=2, **options)
    assert (found.status, found.message, found.time_reached) == ("OK", "", 10)


def test_wheels_that_come_to_stand_across_the_board_do_not_run_to_the_end():
    """The check above can fail: from phi = 1 at a rate of 0.1 a snakeboard ends at pi/2."""
    loaded = load_system("snakeboard")
    start = loaded.projection([1, 0, 0, 1, 1, 2, 0.1])
    found = loaded.simulate(start, (0, 10), samples=2, rtol=1e-6, target="python")
    assert found.status == "DOMAIN"
    assert abs(found.time_reached - (math.pi / 2 - 1) / 0.1) < 1e-6


def with_defaults(state, path):
    """The quantities of a state with the defaults that a spec gives them."""
    variables = tomllib.loads(path.read_text())["variables"]

    def default(name):
        given = np.ravel(variables.get(name, {}).get("default", []))
        return tuple(float(Fraction(str(number))) for number in given) or None

    return Quantities(*(replace(each, default=default(each.name)) for each in state.values()))


PUSHED = """
title = "A mass that is pushed"
routes = ["euler-lagrange"]
[variables]
x = { role = "coordinate" }
v = { role = "velocity", of = "x" }
[inputs]
f = {}
[lagrangian]
l = "v^2/2"
[forces]
v = "f"
"""


def test_an_input_without_a_value_is_asked_for(run, folder):
    """In words of the command line, and what they say works."""
    (folder / "pushed.toml").write_text(PUSHED)
    short = ("simulate", "pushed.toml", "--samples", "2", "--method", "scipy:RK45")
    refused = run(*short)
    assert refused.exit_code == 2
    assert "no default for the input f; expected a value. Write --input f=0," in refused.stderr
    assert run(*short, "--input", "f=0").exit_code == 0


def test_constant_inputs_come_from_the_command_line(run, folder):
    """A force of 4 N moves 2 kg from rest by 4 m in 2 s; the default, 3 N, by 3 m."""
    (folder / "pushed.toml").write_text(POINT)
    words = ["simulate", "pushed.toml", "--state", "0,0", "--time", "2", "--json"]
    for given, force in (([], 3), (["--input", "f=4"], 4)):
        record = json.loads(run(*words, *given).stdout)
        assert record["inputs"] == {"f": force, "k1": 0, "k2": 1}
        assert abs(record["final"]["x"] - force) < 1e-9
    assert "'w' is not one of f, k" in run(*words, "--input", "w=1").stderr
    assert "has no inputs" in run("simulate", "rigid_body", "--input", "w=1").stderr
