"""The target Python, printing: expressions and statements of numbers.

Read next: `coadjoint.render.printers`, which does the work.
"""

from __future__ import annotations

from typing import Final

from coadjoint.render.printers import Printer

PYTHON: Final = Printer("")
FILTERS: Final = {"plain_assignment": PYTHON.assignment}
