"""Tableaus: explicit methods of Runge and Kutta as data.

Comes in: nothing. Goes out: the rows of a table, sparse, which templates print and NumPy reads: the
same numbers in the same order, so that two targets add them up alike.
Read next: `coadjoint.render.solvers`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from types import SimpleNamespace
from typing import Any


@dataclass(frozen=True)
class Tableau:
    """Rows of weights of rates, one upon the other, without their zeros.

    Attributes:
        nodes: The part of the step after which each rate is taken.
        starts: Where each row begins among the weights, and where the last one ends.
        columns: The rate of each weight.
        weights: The weights.
    """

    nodes: tuple[float, ...]
    starts: tuple[int, ...]
    columns: tuple[int, ...]
    weights: tuple[float, ...]

    def row(self, row: int) -> Iterable[tuple[float, int]]:
        """The weights of a row, each with its rate."""
        part = slice(self.starts[row], self.starts[row + 1])
        return zip(self.weights[part], self.columns[part], strict=True)


#: Rows of the table of `dop853`: 12 stages, the end of the step, two estimates of its error, three
#: more stages, and the last four coefficients of the path.
STAGES, END, FIFTH, THIRD, EXTRA, PATH = 12, 12, 13, 14, 15, 18


@cache
def load_dop853() -> Any:
    """The arrays of `scipy.integrate.DOP853`, by their names.

    They are read from their file: to import all of `scipy.integrate` takes as long as to derive a
    small system. Where the file is not where it was, that is done.
    """
    place = find_spec("scipy")
    assert place is not None, "SciPy is a dependency"
    for folder in place.submodule_search_locations or ():
        path = Path(folder, "integrate", "_ivp", "dop853_coefficients.py")
        found = spec_from_file_location("dop853_coefficients", path)
        if path.is_file() and found is not None and found.loader is not None:
            module = module_from_spec(found)
            found.loader.exec_module(module)
            arrays = {name: getattr(module, name) for name in ("B", "E3", "E5", "D")}
            extra = slice(STAGES + 1, None)
            arrays |= {"A_EXTRA": module.A[extra], "C_EXTRA": module.C[extra]}
            return SimpleNamespace(A=module.A[:STAGES, :STAGES], C=module.C[:STAGES], **arrays)
    from scipy.integrate import DOP853

    return DOP853


@cache
def dop853() -> Tableau:
    """The method of order 8 with estimates of order 5 and 3 and a path of order 7.

    E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I (1993), II.5
    and II.6; the numbers are those of `scipy.integrate.DOP853`.
    """
    DOP853 = load_dop853()
    rows = [list(DOP853.A[s][:s]) for s in range(STAGES)]
    rows += [list(row) for row in (DOP853.B, DOP853.E5, DOP853.E3)]
    rows += [list(row) for row in (*DOP853.A_EXTRA, *DOP853.D)]
    sparse = [[(column, float(w)) for column, w in enumerate(row) if w] for row in rows]
    starts = [0]
    for row in sparse:
        starts.append(starts[-1] + len(row))
    return Tableau(
        nodes=tuple(map(float, (*DOP853.C[:STAGES], 1.0, *DOP853.C_EXTRA))),
        starts=tuple(starts),
        columns=tuple(column for row in sparse for column, _ in row),
        weights=tuple(weight for row in sparse for _, weight in row),
    )
