"""The ladder of solvers whose rates are loops: each kind of spoiled one is caught by its rung."""

from dataclasses import replace

import pytest

from coadjoint.crosscheck import solver_steps
from coadjoint.crosscheck.recurrences import check_recurrences
from coadjoint.crosscheck.solver_steps import check_bits
from coadjoint.crosscheck.solver_text import check_solver_texts
from coadjoint.errors import CrossCheckError
from coadjoint.lower.stars import find_stars
from coadjoint.render import solvers as solvers_of_render
from tests.crosscheck.test_solvers import (
    needs_compiler,
    points,
    recurrences_of,
    replaced,
    solvers,
    subject,
    texts_of,
)
from tests.programs import LOOPED


@pytest.mark.parametrize("part", ["left", "right", "rows", "terms"])
def test_a_wrong_star_is_caught(part, monkeypatch):
    """A component, a rate or a term of the looped recurrences that is another one."""
    found = find_stars(LOOPED.programs[0].table)
    first, *others = getattr(found, part)
    wrong = replace(found, **{part: ((first + 1) % 3, *others)})
    system = subject(LOOPED)
    monkeypatch.setattr(solvers_of_render, "find_stars", lambda table: wrong)
    with pytest.raises(CrossCheckError, match=r"rung 2.*recurrences"):
        check_recurrences(recurrences_of(LOOPED), system)


LOOPED_SPOILED = [
    ("solver.c", "TERMS = 7", "TERMS = 6"),
    ("solver.c", "scale_of(block, table_left[e]), right", "scale_of(block, table_right[e]), right"),
    ("solver.c", "block->fixed[FIXED - VALUES + value]", "block->fixed[value]"),
    ("solver.c", "sum = sum + table_coefficients[e] * values", "sum = sum + values"),
    ("solver.c", "state[table_scaled[i]]", "state[i]"),
    ("solver.c", "m = 1; m < k", "m = 0; m < k"),
    ("solver.c", "other[n][0] * one[0] +", "other[n][0] * one[0] -"),
    ("solver.c", "case 2:\n                add_star(2,", "case 2:\n                add_star(1,"),
    ("solver.c", "1.0 / (k + 1) * rates[i]", "1.0 / k * rates[i]"),
    ("solver.c", "_block->fixed[1] = _c1", "_block->fixed[1] = _p1"),
    ("solver.c", "const V _c2 = all(1.5)", "const V _c2 = all(2.5)"),
    ("solver.c", "rows[0] > 0.0", "rows[0] >= 0.0"),
    ("solver.py", "        _c1,\n        _c2,", "        _c2,\n        _c1,"),
    ("solver.py", "_c2 = 1.5", "_c2 = 2.5"),
    ("solver.py", "_p1 = p / q", "_p1 = q / p"),
    ("solver.py", "for m in range(1, k)", "for m in range(k)"),
    ("solver.py", "path[lefts, m] *", "path[rights, m] *"),
    ("solver.py", "np.diff(STAR_BOUNDS)", "np.diff(STAR_STARTS)"),
    ("solver.py", 'kind="stable"', 'kind="quick"'),
    ("solver.py", "MEMBERS = 64", "MEMBERS = 65"),
]


@pytest.mark.parametrize(("file", "good", "bad"), LOOPED_SPOILED)
def test_a_spoiled_loop_is_caught(file, good, bad):
    """Lines, scales and loops of a system whose rates are loops."""
    with pytest.raises(CrossCheckError, match="rung 3"):
        check_solver_texts(texts_of(LOOPED, replaced(file, good, bad)))


@pytest.mark.parametrize("file", ["solver.c", "solver.py"])
@pytest.mark.parametrize("table", recurrences_of(LOOPED).loops.numbers)
def test_a_spoiled_entry_of_a_table_is_caught(file, table):
    """The first number of each table is another one, or one is missing."""
    numbers = recurrences_of(LOOPED).loops.numbers[table]
    line = ", ".join(map(repr, numbers)) + ","
    for wrong in ([numbers[0] + 1, *numbers[1:]], numbers[:-1]):
        other = ", ".join(map(repr, wrong)) + ","

        def spoil(texts, other=other):
            begin = f"{table.upper()} = (" if file == "solver.py" else f"{table}[] = {{"
            tail = texts[file].partition(begin)[2]
            assert tail.lstrip().startswith(line), tail[:80]
            return {**texts, file: texts[file].replace(tail, tail.replace(line, other, 1))}

        with pytest.raises(CrossCheckError, match=f"rung 3.*{table}"):
            check_solver_texts(texts_of(LOOPED, spoil))


@needs_compiler
@pytest.mark.parametrize(
    ("method", "good", "bad"),
    [
        ("rk4", "V sum = all(-0.0)", "V sum = all(0x1p-56)"),
        ("taylor", "m < k; ++m", "m < k - 1; ++m"),
        ("taylor", "= *weight + table", "= table"),
    ],
)
def test_wrong_loops_in_c_are_caught_by_bits(method, good, bad, tmp_path, monkeypatch):
    """A sum that begins elsewhere, one that ends early, and a weight without its first entries."""
    made = solvers(LOOPED, (method,), tmp_path, replaced("solver.c", good, bad))
    runs = solver_steps._runs
    own = lambda batch, size: (each for each in runs(batch, size) if each[0] == method)  # noqa: E731
    monkeypatch.setattr(solver_steps, "_runs", own)
    with pytest.raises(CrossCheckError, match="rung 5"):
        check_bits(made, points(made), 0.125)
