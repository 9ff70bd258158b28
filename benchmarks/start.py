"""How long one waits before anything begins: importing a system, and the help of the program."""

from __future__ import annotations

from figures import Figure, fresh_process, script

IMPORT = """
import sys, time
import coadjoint.systems.heavy_top
assert "sympy" not in sys.modules and "numpy" not in sys.modules
print(time.process_time())
"""
HELP = """
import contextlib, io, sys, time
from coadjoint.cli import main
with contextlib.redirect_stdout(io.StringIO()) as text:
    main(["--help"], standalone_mode=False)
assert "regenerate" in text.getvalue() and "sympy" not in sys.modules
print(time.process_time())
"""


def measure() -> list[Figure]:
    """Processor time of a fresh process, Python's own start included."""
    system, program = fresh_process(IMPORT), fresh_process(HELP)
    return [
        Figure(
            "import coadjoint.systems.heavy_top", "<= 0.15 s", f"{system:.3f} s", system <= 0.15
        ),
        Figure("coadjoint --help", "<= 0.20 s", f"{program:.3f} s", program <= 0.2),
    ]


if __name__ == "__main__":
    script(measure)
