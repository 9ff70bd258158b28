"""The target NumPy, printing: expressions and statements over arrays.

Read next: `coadjoint.render.printers`, which does the work.
"""

from __future__ import annotations

from typing import Final

from coadjoint.render.printers import Printer

NUMPY: Final = Printer("np.")
FILTERS: Final = {"numpy_assignment": NUMPY.assignment}
