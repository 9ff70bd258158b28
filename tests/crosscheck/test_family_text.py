"""Texts of families: what is printed of a part reads back, and a wrong text is seen."""

import numpy as np
import pytest

from coadjoint.crosscheck import families as ladder
from coadjoint.crosscheck.families import crosscheck_family
from coadjoint.crosscheck.family_text import check_family_text
from coadjoint.errors import CrossCheckError
from coadjoint.solve.folders import load_texts
from tests.families import CHAIN, CLOSED, DRIVEN, RING, VORTICES, WALLS, render

TEXTS = {"ring": RING, "chain": CHAIN, "vortices": VORTICES, "driven": DRIVEN}
TEXTS |= {"walls": WALLS, "closed": CLOSED}
#: A text, what stands in it, and what spoils it.
SPOILED = [
    ("ring", "kernel.c", "before(_run.i, 1, _run.size)", "before(_run.i, 2, _run.size)"),
    ("ring", "kernel.c", "after(_run.i, 1, _run.size)", "before(_run.i, 1, _run.size)"),
    ("ring", "kernel.py", "(i - 1) % size", "(i + 1) % size"),
    ("ring", "kernel_python.py", "size + i]", "size + i + 1]"),
    ("ring", "kernel.c", "const double D = _indexed ?", "const double D = _shared ?"),
    ("ring", "kernel.c", "= _at_S1[_l];", "= _at_S2[_l];"),
    ("chain", "kernel.py", "state[i + 1]", "state[i + 2]"),
    ("chain", "kernel.c", "_run.state + (_run.i + 1)", "_run.parameters + (_run.i + 1)"),
    ("vortices", "kernel.c", "_sums[0][_l]", "_sums[1][_l]"),
    ("vortices", "kernel.c", "const double y_j = _batch ?", "const double y_j = _shared ?"),
    ("vortices", "kernel.py", "size + j]", "size + i]"),
    ("vortices", "kernel_python.py", "_t1 * ", "_t1 + "),
    ("walls", "kernel.py", "parameters[1 + size - 2]", "parameters[1 + size - 1]"),
    ("walls", "kernel.py", "q_last = state[size - 1]", "q_last = state[size - 2]"),
    ("walls", "kernel.c", "double k_last = _indexed ?", "double k_last = _shared ?"),
    ("walls", "kernel.c", "(_run.size - 1) * _run.stride", "(_run.size - 2) * _run.stride"),
    ("walls", "kernel_python.py", "q_first = state[0]", "q_first = state[1]"),
    ("closed", "kernel.py", "(i - 1) % size", "i - 1"),
    ("closed", "solver.py", "at.near(0, -1)", "at.near(0, 1)"),
    ("ring", "solver.c", "near(_at, 0, -1)", "near(_at, 0, 1)"),
    ("ring", "solver.py", "at.near(0, -1)", "at.near(1, -1)"),
    ("ring", "solver.c", "_slots + 1 * ORDER", "_slots + 0 * ORDER"),
    ("chain", "solver.c", "_orders[_m] * ", "_orders[_k] * "),
    ("chain", "solver.py", "_parts[_k] * ", ""),
    ("vortices", "solver.c", "partner(_at, 1)", "own(_at, 1)"),
    ("vortices", "solver.py", "_t2[_k - _m]", "_t2[_m]"),
    ("vortices", "solver.py", "for _m in range(1, _k)", "for _m in range(0, _k)"),
    ("vortices", "solver.c", "        return;", ""),
    ("vortices", "kernel.c", "_block->x[_l] = _at_x[", "_block->x[_l] = _at_y["),
    ("vortices", "kernel.c", "= _block->x[_s];", "= _block->x[_l];"),
    ("vortices", "kernel.c", "= _block->x[_s];", "= _block->y[_s];"),
    ("vortices", "kernel.c", "_term0[_l] = _out0[_l];", "_term0[_l] = _out1[_l];"),
    ("vortices", "kernel.c", "_out0[_l] = _term0[_l];", "_out0[_l] = _term1[_l];"),
    ("vortices", "kernel.c", "double x_j = _at_x_j[_l];", "double x_j = _one_x_j;"),
    ("vortices", "kernel.c", "_parts[0][_s][_l] += _value0", "_parts[0][_s][_l] += _value1"),
    ("vortices", "kernel.c", "_term0[_l] += _value2", "_term0[_l] += _value0"),
    ("vortices", "kernel.c", "_run.out + 1 * _run.size + _j", "_run.out + 0 * _run.size + _j"),
    ("driven", "kernel.c", "_run.time + _run.n * _run.timed", "_run.time + _run.n"),
    ("driven", "kernel.c", "double t = _run.timed ?", "double t = _shared ?"),
    (
        "driven",
        "kernel.c",
        "_run.time + _run.n * _run.timed",
        "_run.parameters + (0) * _run.row + _run.n * _run.own",
    ),
    ("driven", "kernel.py", "t = time[0]", "t = parameters[0]"),
    ("driven", "kernel_python.py", "t = time[0]", "t = state[0]"),
    ("vortices", "kernel.c", "(_turned ? _value2 : _value0)", "(_turned ? _value0 : _value2)"),
    ("chain", "kernel.py", "h_p = state[3 * size + i]", "h_p = state[2 * size + i]"),
]


@pytest.fixture(scope="module")
def rendered():
    """Each system up to its texts."""
    return {name: render(text, name) for name, text in TEXTS.items()}


@pytest.mark.parametrize("name", TEXTS)
def test_every_part_reads_back(rendered, name):
    """All parts of all functions, in all texts."""
    own, texts = rendered[name].family, rendered[name].texts
    lines = check_family_text(own.context, texts, own.printed)
    assert min(lines.values()) > 0
    acting = [] if own.family.action is None else ["energy_gradient", "bracket_vector"]
    flows = ["flow1", "flow2", "flow3"] if name == "ring" else []
    assert list(lines) == ["rhs", "jacobian_vector", "energy", "observables", *flows, *acting]


@pytest.mark.parametrize(("name", "file", "old", "new"), SPOILED)
def test_a_wrong_text_is_seen(rendered, name, file, old, new):
    """Also where the template itself prints it: parts are read, not compared with templates."""
    texts = dict(rendered[name].texts)
    assert old in texts[file]
    texts[file] = texts[file].replace(old, new)
    with pytest.raises(CrossCheckError):
        check_family_text(rendered[name].family.context, texts, texts)


def test_a_text_beyond_the_parts_is_that_of_the_template(rendered):
    """The loops around the parts are compared letter by letter."""
    own, texts = rendered["ring"].family, dict(rendered["ring"].texts)
    texts["kernel.c"] = texts["kernel.c"].replace("_run.i < _run.size", "_run.i <= _run.size")
    with pytest.raises(CrossCheckError, match="another text"):
        check_family_text(own.context, texts, own.printed)


#: Loops over partners: how a line of them is spoiled, and the rung that sees it.
WRONG_LOOPS = [
    ("kernel.py", "np.delete(i, one)", "np.roll(i, one)[1:]", 4),
    ("kernel.py", "i[:whole] % LANES != place", "i[:whole] % LANES > place", 4),
    ("kernel.py", "in np.add.accumulate(lanes, axis=0)[-1]:", "in lanes[-1]:", 4),
    ("kernel.py", "in np.add.accumulate(lanes, axis=0)[-1]:", "in lanes.sum(axis=1):", 5),
    ("kernel.py", "row[last:whole] += other", "row[last:whole] -= other", 4),
    ("kernel.py", "in range(whole, size):", "in range(whole, min(size, FEWEST)):", 4),
    ("kernel_python.py", "_add(parts, j % LANES,", "_add(parts, (j + s) % LANES,", 5),
    ("kernel_python.py", "if size < FEWEST", "if size < LANES", 5),
]


@pytest.mark.parametrize(("file", "old", "new", "rung"), WRONG_LOOPS)
def test_the_ladder_sees_wrong_loops(rendered, monkeypatch, file, old, new, rung):
    """Loops that leave a partner out are wrong for few members or for many, or have other bits."""
    own = rendered["vortices"].family
    texts = dict(rendered["vortices"].texts)
    assert old in texts[file]
    texts[file] = texts[file].replace(old, new)
    monkeypatch.setattr(ladder, "POINTS", 2)
    with load_texts(texts) as system, pytest.raises(CrossCheckError, match=f"rung {rung}"):
        crosscheck_family(own, texts, system, ("numpy", "python"), texts)


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("ring", "row[k + 1, place.i] = _parts[k + 1]", "row[k + 1, place.i] = _parts[k]"),
        ("chain", "place.fill(k)", "place.fill(0)"),
        ("vortices", "(slice(0, j), slice(j + 1, size))", "(slice(0, j), slice(j + 2, size))"),
    ],
)
def test_the_ladder_sees_wrong_series(rendered, name, old, new):
    """Loops around recurrences that are right give other coefficients than the equations have."""
    own, texts = rendered[name].family, dict(rendered[name].texts)
    assert old in texts["solver.py"]
    texts["solver.py"] = texts["solver.py"].replace(old, new)
    with load_texts(texts) as system, pytest.raises(CrossCheckError, match="power series"):
        crosscheck_family(own, texts, system, ("numpy",), texts)


#: Loops of C: how a line of them is spoiled.
WRONG_C = [
    ("_j = _run.i + LANES; _j < _whole", "_j = _run.i + 2 * LANES; _j < _whole"),
    ("_sums[_k][_s] += _parts[_k][_s][_l]", "_sums[_k][_s] += _parts[_k][_s][LANES - 1 - _l]"),
    ("_run, _last + _l, _whole", "_run, _last + LANES - 1 - _l, _whole"),
    ("_other.i = 0; _other.i < _first", "_other.i = 1; _other.i < _first"),
]


@pytest.mark.parametrize(("old", "new"), WRONG_C)
def test_the_ladder_sees_wrong_tiles(rendered, old, new):
    """In C: their pairs, the order of their parts, and that of one member of a batch."""
    texts = dict(rendered["vortices"].texts)
    assert old in texts["kernel.c"]
    texts["kernel.c"] = texts["kernel.c"].replace(old, new)
    with load_texts(texts) as system, pytest.raises(CrossCheckError, match="rung 5"):
        ladder._compare_targets(system, "rhs", 2, ("numpy", "c"), calls=False)


def test_where_a_language_stops_the_other_rows_are_not_compared():
    """Python gives no row of a trajectory of which one has no value; all others have equal bits."""
    one = np.array([[1.0, 2.0], [np.nan, 3.0]])

    def differ(other, *, stops=True):
        return ladder.find_differences(one, np.array(other), exact=True, stops=stops).any()

    stopped = [[np.nan, 2.0], [np.nan, 3.0]]
    assert not differ(stopped)
    assert not differ(one)
    assert differ(stopped, stops=False)
    assert differ([[np.nan, np.nextafter(2.0, 3.0)], [np.nan, 3.0]])
    assert differ([[np.nan, np.nan], [np.nan, np.nan]])  # the second one has all its values
    assert differ([[np.nextafter(1.0, 2.0), 2.0], [np.nan, 3.0]])


def test_the_ladder_sees_other_bits(rendered):
    """Sums in another order are right to 50 digits, and have other bits."""
    own = rendered["ring"].family
    texts = dict(rendered["ring"].texts)
    texts["kernel_python.py"] = texts["kernel_python.py"].replace(
        "LANES, FEWEST = 8, ", "LANES, FEWEST = 2, "
    )
    with load_texts(texts) as system, pytest.raises(CrossCheckError, match="rung 5"):
        crosscheck_family(own, texts, system, ("numpy", "python"), texts)


def test_the_ladder_passes_without_a_compiler(rendered):
    """Two targets that need none: 50 digits for both windows, bits for other numbers of members."""
    own, texts = rendered["ring"].family, rendered["ring"].texts
    with load_texts(texts) as system:
        report = crosscheck_family(own, texts, system, ("numpy", "python"))
    assert report.k < 4
    assert report.points > 300
    flows = {f"flow{n}" for n in (1, 2, 3)}  # which call sine and cosine
    for name in own.context.loops:
        counts = report.together if name in flows else report.equal
        assert counts[name]["python"] > 0, name
