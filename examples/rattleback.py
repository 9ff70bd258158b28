"""A rattleback: turned one way it rattles and turns round, turned the other way it goes on.

An ellipsoid rolls on a plane, its axes of inertia turned a little against those of its surface. The
trace is where it touches the plane; attitude and place follow from the motion and do not act on it.
"""

from __future__ import annotations

import sys

from coadjoint.systems import rattleback


def main(picture: str = "") -> dict[float, float]:
    """Spin both ways, draw the trace of the one that turns round, and return the last spins."""
    last = {}
    for spin in (-5.0, 5.0):
        start = {"Omega": [0.01, 0.01, spin], "Gamma": [0.0, 0.0, 1.0]}
        body = rattleback.simulate(start, (0.0, 8.0), samples=8001, reconstruct=True)
        last[spin] = float(body["Omega3"][-1])
        strayed = max(abs(body["x"]).max(), abs(body["y"]).max())
        print(f"spin {spin:+.1f} 1/s, after 8 s {last[spin]:+.3f} 1/s, off by {strayed:.3f} m")
        print("drift:", {name: f"{drift:.0e}" for name, drift in body.drift.items()})
        if picture and spin < 0:
            body.trace(picture)
    return last


if __name__ == "__main__":
    main(*sys.argv[1:2])
