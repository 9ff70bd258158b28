"""Generated NumPy against sympy.lambdify and numba: rhs of one, a thousand and a million members.

Of a million, parameters are arguments of all competitors. Of fewer, those of lambdify are numbers
in its code, none of them zero, so that it leaves out no term, and its result is one array.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import numpy as np
import sympy
from figures import SYSTEMS, Figure, Spread, script, take_turns
from results import Table, write

from coadjoint.derive import derive
from coadjoint.resources import derivations_folder, systems_folder
from coadjoint.solve.folders import load_folder
from coadjoint.spec import read_spec

MEMBERS = 1_000_000
#: Systems of which one and a thousand members are evaluated.
FEW_SYSTEMS = (*SYSTEMS, "so4_body", "so6_body")


def contest(name: str, rounds: int = 7) -> dict[str, Spread]:
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
    return take_turns(competitors, rounds)


def contest_of_few(name: str, members: int) -> dict[str, Spread]:
    """Seconds of one evaluation of a few members, parameters as numbers.

    Raises:
        AssertionError: They do not compute the same.
    """
    system = load_folder(systems_folder() / name)
    equations = derive(read_spec(derivations_folder() / f"{name}.toml"))
    parameters = system.pack(None) + 0.1 * np.arange(1, system.PARAMETERS.size + 1)
    values = dict(zip(equations.parameters, map(sympy.Float, parameters.tolist()), strict=True))
    rates = [rate.subs(values) for rate in equations.rates]
    folded = sympy.lambdify(equations.state, rates, modules="numpy", cse=True)
    state = np.random.default_rng(0).normal(size=(system.STATE.size, members))
    competitors: dict[str, Any] = {
        "generated": lambda: system.rhs(state, parameters, target="numpy"),
        "lambdify": lambda: np.array(folded(*state)),
    }
    reference, found = (function() for function in competitors.values())
    assert np.abs(found).max() > 0
    assert np.abs(reference - found).max() <= 1e-12 * np.abs(found).max()
    return take_turns(competitors, rounds=61, calls=max(50, 500 // members))


def measure() -> list[Figure]:
    """Speed of generated NumPy in units of the others."""
    figures, rows = [], []
    for name in FEW_SYSTEMS:
        for members in (1, 1000):
            taken = contest_of_few(name, members)
            rows.append([f"{name}, N = {members}", *_cells(taken, 1e-6, "us")])
            ratio = taken["lambdify"].median / taken["generated"].median
            measured = f"{ratio:.2f} ({taken['generated'].median * 1e6:.1f} us)"
            what = f"{name}: NumPy rhs, N = {members}, speed against lambdify(cse) with numbers"
            figures.append(Figure(what, ">= 1", measured, ratio >= 1.0))
    for name in SYSTEMS:
        taken = contest(name)
        rows.append([f"{name}, N = 1e6", *_cells(taken, 1e-3, "ms")])
        ours = taken["generated"].median
        ratio = taken["lambdify"].median / ours
        what = f"{name}: NumPy rhs, N = 1e6, speed against lambdify(cse=True)"
        figures.append(Figure(what, ">= 2.5", f"{ratio:.2f} ({ours * 1e3:.0f} ms)", ratio >= 2.5))
        peer = f"{name}: NumPy rhs, N = 1e6, speed against numba"
        against = f"{taken['numba'].median / ours:.2f}" if "numba" in taken else "not installed"
        figures.append(Figure(peer, "none", against))
    columns = ["", "generated", "lambdify", "numba"]
    table = Table("Time of a call: median, fastest and slowest round", columns, rows)
    write("numpy_kernels", {"what": "rates by NumPy kernels"}, (), figures, [table])
    return figures


def _cells(taken: dict[str, Spread], unit: float, name: str) -> list[str]:
    """Times by competitor, in a unit of so many seconds."""
    competitors = ("generated", "lambdify", "numba")
    return [taken[who].text(unit, name) if who in taken else "" for who in competitors]


if __name__ == "__main__":
    script(measure)
