"""Where the independent variable is no time, it is called what the spec says it is."""

import io
import re

import numpy as np
import pytest

from coadjoint.errors import KernelArgumentError, SpecError
from coadjoint.explore.records import describe as describe_page
from coadjoint.pipeline import render
from coadjoint.solve.events import Event
from coadjoint.solve.illustrate import describe
from coadjoint.solve.plot import draw
from coadjoint.solve.solution import Solution
from coadjoint.solve.tables import write_table
from coadjoint.systems import kapitza_top, kirchhoff_rod
from tests.driven_specs import BOOST
from tests.specs import shipped, spec

pytest.importorskip("matplotlib", reason="the extra 'plot' is not installed")

LABELLED = ('name = "t"\n[hamiltonian]', 'name = "s"\nlabel = "arc length"\n[hamiltonian]')


@pytest.fixture(scope="module")
def rod():
    """A rod."""
    return kirchhoff_rod.simulate(None, (0, 4), samples=101, progress=False)


@pytest.fixture(scope="module")
def top():
    """What depends on the time."""
    return kapitza_top.simulate([0, 0, 0, 0.1, 0, 0.9], (0, 0.1), samples=11, progress=False)


def labels_of(solution):
    """The labels of all axes of a picture."""
    figure = draw(solution)
    return [text for each in figure.axes for text in (each.get_xlabel(), each.get_ylabel())]


def test_pictures_have_its_label(rod, top):
    """Both the axis of the drift and the bar of colours; of a time that is declared, the time."""
    assert labels_of(rod).count("arc length [m]") == 2
    assert not [each for each in labels_of(rod) if "time" in each]
    assert "time [s]" in labels_of(top)
    assert "Colour is arc length" in describe(rod)
    assert "over 4 m" in describe(rod)


def test_a_solution_knows_it_by_its_symbol(rod, top):
    """As by the names of the time, with its unit."""
    assert np.array_equal(rod["s"], rod.time)
    assert np.array_equal(rod["t"], rod.time)
    assert (rod.unit("s"), rod.unit("time"), rod.unit("m1")) == ("m", "m", "N m")
    assert "s = 0 .. 4" in repr(rod)
    assert "s" not in top
    with pytest.raises(KernelArgumentError, match="'s' is not in this solution"):
        top["s"]


def test_a_table_has_its_column(rod, top, tmp_path):
    """Under its symbol, and it is read back to the last bit."""
    for solution, name in ((rod, "s"), (top, "time")):
        file = io.StringIO()
        write_table(solution, file)
        head = next(x for x in file.getvalue().splitlines() if not x.startswith("#"))
        assert head.split(",")[0] == name
        solution.to_csv(tmp_path / "table.csv")
        back = Solution.from_csv(solution.system, tmp_path / "table.csv")
        assert np.array_equal(back.time, solution.time)
        assert np.array_equal(back.state, solution.state)
    spoiled = (tmp_path / "rod.csv").as_posix()
    rod.to_csv(spoiled)
    text = (tmp_path / "rod.csv").read_text().replace("\ns,m1", "\ntime,m1")
    (tmp_path / "rod.csv").write_text(text)
    with pytest.raises(KernelArgumentError, match="of s, none values"):
        Solution.from_csv(rod.system, spoiled)


def test_datasets_and_frames_name_it(rod):
    """The long name of a coordinate, which xarray writes on axes, and the index of pandas."""
    xarray = pytest.importorskip("xarray")
    dataset = rod.to_xarray()
    assert isinstance(dataset, xarray.Dataset)
    assert dataset["time"].attrs == {"long_name": "arc length", "units": "m"}
    assert rod.to_pandas().index.name == "s"


def test_messages_name_it(rod):
    """Where an event ended a run, where its events are, and where it cannot go on."""
    crossing = Event(f"m1 - {float(rod['m1'][50])!r}", terminal=True, name="crossing")
    for method in ("auto", "scipy:DOP853"):
        ended = kirchhoff_rod.simulate(None, (0, 4), method=method, events=crossing, progress=False)
        assert re.search(r"ended it at s = \d", ended.message)
        assert ", s = " in repr(ended.events["crossing"])
        short = kirchhoff_rod.simulate(None, (0, 4), method=method, max_steps=1, progress=False)
        assert "steps came only near s = " in short.message
    short = kapitza_top.simulate([0, 0, 0, 0.1, 0, 0.9], (0, 4), max_steps=1, progress=False)
    assert "steps came only near t = " in short.message


def test_an_explorer_names_it():
    """The symbol at the clock, and the name of the axis."""
    own = shipped("kirchhoff_rod")
    page = describe_page(own, render(own))
    assert page["clock"] == {"symbol": "s", "name": "arc length"}
    assert page["unitOfTime"] == "m"


def test_kernels_take_it_only_where_a_formula_names_it(tmp_path):
    """With a label no formula has to; without one the declaration is refused as vain."""
    vain = BOOST.replace('"t*P - m*r"', '"P"')
    labelled = spec(vain.replace('name = "t"', 'name = "s"\nlabel = "arc length"'))
    assert (labelled.time, labelled.clock.label, labelled.clock.name) == (None, "arc length", "s")
    named = BOOST.replace('name = "t"', 'name = "s"\nlabel = "arc length"').replace("t*P", "s*P")
    assert spec(named).time == spec(named).clock
    with pytest.raises(SpecError, match="'t' occurs in no formula"):
        spec(vain)
    assert spec(BOOST).clock.label == "time"
