"""Generated NumPy against sympy.lambdify and numba: rhs of a million members."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import numpy as np
import sympy
from figures import SYSTEMS, Figure, best_of, script

from coadjoint.derive import derive
from coadjoint.resources import derivations_folder, systems_folder
from coadjoint.solve.system import load_folder
from coadjoint.spec import read_spec

MEMBERS = 1_000_000


def contest(name: str, rounds: int = 5) -> dict[str, float]:
    """Seconds of one evaluation by each competitor.

    Raises:
        AssertionError: They do not compute the same.
    """
    system = load_folder(systems_folder() / name)
    equations = derive(read_spec(derivations_folder() / f"{name}.toml"))
    arguments = [*equations.state, *equations.parameters]
    plain = sympy.lambdify(arguments, list(equations.rates), modules="numpy", cse=True)
    state = np.random.default_rng(0).normal(size=(system.STATE.size, MEMBERS))
    parameters = [float(value) for value in system.pack(None)]
    out = np.empty_like(state)
    competitors: dict[str, Any] = {
        "generated": lambda: system.rhs(state, target="numpy", out=out),
        "lambdify": lambda: plain(*state, *parameters),
    }
    if find_spec("numba") is not None:
        import numba

        fast = numba.njit(plain)
        competitors["numba"] = lambda: fast(*state, *parameters)
    for function in competitors.values():
        reference = np.array(function())
        scale = np.abs(out).max()
        assert scale > 0
        assert np.abs(reference - out).max() <= 1e-13 * scale
    return best_of(competitors, rounds)


def measure() -> list[Figure]:
    """Speed of generated NumPy in units of the others."""
    figures = []
    for name in SYSTEMS:
        taken = contest(name)
        ratio = taken["lambdify"] / taken["generated"]
        measured = f"{ratio:.2f} ({taken['generated'] * 1e3:.0f} ms)"
        what = f"{name}: NumPy rhs, N = 1e6, speed against lambdify(cse=True)"
        figures.append(Figure(what, ">= 2.5", measured, ratio >= 2.5))
        peer = f"{name}: NumPy rhs, N = 1e6, speed against numba"
        against = (
            f"{taken['numba'] / taken['generated']:.2f}" if "numba" in taken else "not installed"
        )
        figures.append(Figure(peer, "none", against))
    return figures


if __name__ == "__main__":
    script(measure)
