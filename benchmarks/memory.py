"""Memory: a million heavy tops, the final state only, above the input."""

from __future__ import annotations

from figures import Figure, fresh_process, script

#: The highest resident memory during a run, above that before it: the state is there already.
RUN = """
import numpy as np
from coadjoint.systems import heavy_top

members = 1_000_000
heavy_top.simulate(np.ones((6, 8)), (0, 0.1), samples=1)  # compiled and loaded
state = np.random.default_rng(0).normal(size=(6, members))
with open("/proc/self/clear_refs", "w") as file:
    file.write("5")  # the highest so far is forgotten

def resident(name):
    lines = dict(line.split(":") for line in open("/proc/self/status"))
    return int(lines[name].split()[0]) * 1024

before = resident("VmRSS")
found = heavy_top.simulate(state, (0, 1), samples=1, progress=False)
used = resident("VmHWM") - before
assert (found.status == "OK").all() and found.state.shape == (6, members, 1)
print(used / 1e6)
"""


def measure() -> list[Figure]:
    """Megabytes of one run in a process of its own."""
    used = fresh_process(RUN, runs=1)
    what = "memory of 1e6 heavy tops, final state, above the input of 48 MB"
    return [Figure(what, "<= 200 MB", f"{used:.0f} MB", used <= 200)]


if __name__ == "__main__":
    script(measure)
