"""The target NumPy, printing: expressions and statements over arrays.

Read next: `coadjoint.render.printers`, which does the work.
"""

from __future__ import annotations

from typing import Final

from coadjoint.elementary import ELEMENTARY
from coadjoint.render.printers import Printer

NUMPY: Final = Printer(
    "np.", names={name: entry.numpy_name for name, entry in ELEMENTARY.items() if entry.numpy}
)
FILTERS: Final = {"numpy_assignment": NUMPY.assignment}
