"""The free rigid body is a pendulum: its momentum runs over elliptic cylinders.

With c = x.x/2 and h the energy, the motion grad c x grad h is also that of the pair (c - I3 h, h).
The first of these is an elliptic cylinder about the third axis, and on it the angle theta obeys
theta'' = -A sin(2 theta). Here both are integrated, each by itself, and compared. With a file name
and matplotlib, a picture of the curve on its cylinder is drawn.
"""

from __future__ import annotations

import sys

import numpy as np
from scipy.integrate import solve_ivp

from coadjoint.systems import rigid_body

inertia = np.array([3.0, 2.0, 1.0])
start = np.array([1.0, 0.3, 0.5])
squares = 1 - inertia[2] / inertia[:2]  # k1, k2 of the ellipse (k1 x1^2 + k2 x2^2)/2
root = np.sqrt(squares.prod())


def angle(x: np.ndarray) -> np.ndarray:
    """Theta along a motion, without jumps."""
    scaled = np.sqrt(squares)[:, None] * x[:2]
    return np.unwrap(np.arctan2(scaled[1], scaled[0]))


def pendulum(time: np.ndarray) -> np.ndarray:
    """Theta by the pendulum's equation alone."""
    cylinder = (squares * start[:2] ** 2).sum() / 2
    amplitude = cylinder * (1 / inertia[1] - 1 / inertia[0]) / inertia[2]
    first = [angle(start[:, None])[0], -root * start[2] / inertia[2]]
    solved = solve_ivp(
        lambda _, y: [y[1], -amplitude * np.sin(2 * y[0])],
        (time[0], time[-1]),
        first,
        method="DOP853",
        t_eval=time,
        rtol=1e-12,
        atol=1e-12,
    )
    return solved.y[0]


def main(picture: str = "") -> tuple[float, float]:
    """The largest difference between the two angles, and how far the angle ran."""
    motion = rigid_body.simulate({"Pi": start}, (0.0, 60.0), {"I": inertia}, samples=1001)
    theta = angle(motion["Pi"])
    difference = float(np.abs(theta - pendulum(motion.time)).max())
    span = float(np.ptp(theta))
    print(f"theta runs over {span:.3f} rad; body and pendulum differ by {difference:.1e} rad")
    if picture:
        draw(motion["Pi"], picture)
    return difference, span


def draw(x: np.ndarray, picture: str) -> None:
    """The momentum on its cylinder."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    radius = np.sqrt((squares * start[:2] ** 2).sum() / squares)
    theta, height = np.meshgrid(np.linspace(0, 2 * np.pi, 60), np.linspace(-1.5, 1.5, 2))
    figure = plt.figure(figsize=(5, 5))
    axes = figure.add_subplot(projection="3d")
    axes.plot_surface(radius[0] * np.cos(theta), radius[1] * np.sin(theta), height, alpha=0.25)
    axes.plot(*x)
    axes.set(xlabel="Pi1", ylabel="Pi2", zlabel="Pi3", title="The rigid body as a pendulum")
    figure.savefig(picture)
    plt.close(figure)


if __name__ == "__main__":
    main(*sys.argv[1:])
