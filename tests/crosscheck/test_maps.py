"""Maps on the ladder: texts of solvers that are spoilt are caught."""

from dataclasses import replace
from functools import cache

import pytest

from coadjoint import pipeline
from coadjoint.errors import CrossCheckError
from coadjoint.lower.compositions import schedule
from tests import specs
from tests.kernels import COMPILER

#: Of the second flow in a step of order 4, cut by its last digits.
LENGTH = str(schedule(3, 4)[1][1])[:12]

#: What the first flow adds to the second momentum, with a wrong sign.
TURN = tuple(f"_rows[1] = _flow1_t4 {sign} _flow1_t5 * _flow1_tan1;" for sign in "-+")


@cache
def rendered():
    """The free body."""
    return specs.rendered("rigid_body")


def spoil(file, good, bad):
    """A text with one piece changed."""
    texts = dict(rendered().texts)
    assert good in texts[file], good
    texts[file] = texts[file].replace(good, bad, 1)
    return replace(rendered(), texts=texts)


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
def test_every_method_is_compared():
    """Steps with 60 digits in NumPy, those with all maps in C as well, and bits."""
    figures = pipeline.verify(rendered()).solvers["solver"]
    for method in ("splitting", "splitting4", "splitting6", "kahan", "exact_body"):
        assert figures.steps[method]["numpy"].points == 3
    for method in ("splitting4", "kahan", "exact_body"):
        assert figures.steps[method]["c"].points == 3
        assert figures.equal[method] > 100


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
@pytest.mark.parametrize(
    ("file", "good", "bad"),
    [
        # a sign, a factor and a row of a flow, a name of another flow
        ("solver.c", *TURN),
        ("solver.c", "const V _flow2_p1 = 0.5 / I2;", "const V _flow2_p1 = 0.25 / I2;"),
        ("solver.py", "    _rows[0] = 0.0\n", "    _rows[0] = Pi2\n"),
        # rows that a flow moves, and a plain sum
        ("solver.py", '    "flow1": (1, 2, ),\n', '    "flow1": (1, ),\n'),
        ("solver.c", "add_low(ends[b][1], &steps[b].memory[1], rises[1])", "ends[b][1] + rises[1]"),
        ("solver.c", "find_flow2(blocks + b", "find_flow3(blocks + b"),
        # a coefficient, and a part left out
        ("solver.c", f"h[b] * {LENGTH}", f"h[b] * {LENGTH}1"),
        ("solver.py", '        ("flow2", 0.5),\n', ""),
        # a sign in the solve, and a wrong start of the elliptic functions
        ("solver.py", "_rows[2] = _kahan_d3", "_rows[2] = -_kahan_d3"),
        ("solver.c", "0.015625 * _h", "0.015626 * _h"),
    ],
)
def test_a_spoilt_text_is_caught(file, good, bad):
    """Before anything is written."""
    with pytest.raises(CrossCheckError):
        pipeline.verify(spoil(file, good, bad))
