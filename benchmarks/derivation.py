"""From a spec to proved equations by both routes, imports not counted."""

from __future__ import annotations

from figures import SYSTEMS, Figure, fresh_process, script

# In a fresh process, since a second derivation finds caches warm.
CODE = """
import time
from coadjoint.derive import derive
from coadjoint.prove import prove
from coadjoint.resources import derivations_folder
from coadjoint.spec import read_spec
path = derivations_folder() / "{system}.toml"
start = time.perf_counter()
certificate = prove(read_spec(path))
taken = time.perf_counter() - start
assert certificate.holds and len(certificate.claims) >= 4
print(taken)
"""


def measure() -> list[Figure]:
    """Seconds from the file to its certificate, both routes included."""
    figures = []
    for system in SYSTEMS:
        taken = fresh_process(CODE.format(system=system), runs=3)
        what = f"{system}: spec to proved equations"
        if system == "heavy_top":  # the target is the heavy top's; the others are for comparison
            figures.append(Figure(what, "<= 0.30 s", f"{taken:.3f} s", taken <= 0.3))
        else:
            figures.append(Figure(what, "none", f"{taken:.3f} s"))
    return figures


if __name__ == "__main__":
    script(measure)
