"""A system of one's own: a rotor on the middle axis keeps a rigid body from tumbling.

Without the rotor, rotation about the middle axis is unstable. With a rotor of momentum L on that
axis it is stable once (|Pi| - L) / I2 < |Pi| / I3. `gyrostat.toml` declares the system; coadjoint
derives, proves, compiles and keeps it.
"""

from __future__ import annotations

from pathlib import Path

import coadjoint


def main() -> dict[float, float]:
    """How far the momentum leaves the middle axis, for several momenta of the rotor."""
    here = Path(main.__code__.co_filename)  # a gallery runs this without a name of the file
    gyrostat = coadjoint.load(here.with_name("gyrostat.toml"))
    strayed = {}
    for L in (0.0, 0.2, 0.4, 0.6):
        motion = gyrostat.simulate({"Pi": [0.01, 1.0, 0.01], "L": L}, (0.0, 100.0))
        strayed[L] = float(1.0 - motion["Pi2"].min())
        print(f"L = {L}: Pi2 falls by {strayed[L]:.4f}; drift {motion.drift['casimir1']:.0e}")
    return strayed


if __name__ == "__main__":
    main()
