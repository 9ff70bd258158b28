"""Linkages: rods that hang on each other, found by the energy of the rates of their directions.

Mass a of a chain is at the sum of ``l_i gamma_i`` over the rods up to its own. Where the directions
gamma have the rates v, the energy has the products ``v_i . v_j`` with ``l_i l_j`` times the mass
from ``max(i, j)`` on, so that each pair gives ``l_i/l_j``: no name of a parameter is known. Rods
hang on each other in the order in which they are declared; two have such lengths in both orders.
A pendulum of links in the plane is found by the place of its last mass.
Comes in: a `Solution`, and which variables may be these. Goes out: parts of the whole length.
Read next: `coadjoint.solve.scenes`.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from itertools import permutations
from typing import TYPE_CHECKING, Final

import numpy as np

from coadjoint.errors import CoadjointError

if TYPE_CHECKING:
    from coadjoint.array_types import Array
    from coadjoint.solve.solution import Solution

#: Part of the largest coefficient by which others may be off: the generated functions round.
ROUNDED: Final = 1e-9


def find_lengths(solution: Solution, rates: Sequence[str]) -> Array | None:
    """The parts that rods have of the length of all; None where the energy is of no such chain.

    Args:
        solution: A motion.
        rates: Of the directions, variables of the state, from the fixed point on.
    """
    inertia = _find_inertia(solution, rates)
    if inertia is None:
        return None
    lengths = inertia[:, -1] / inertia[-1, -1]
    hanging = np.diag(inertia) / lengths**2  # the mass from each rod on
    later = np.maximum(*np.indices(inertia.shape))
    off = np.abs(inertia - np.outer(lengths, lengths) * hanging[later]).max()
    masses = -np.diff(hanging, append=0.0)
    if off > ROUNDED * np.abs(inertia).max() or (lengths <= 0).any() or (masses <= 0).any():
        return None
    return np.asarray(lengths / lengths.sum())


def _find_inertia(solution: Solution, rates: Sequence[str]) -> Array | None:
    """Coefficients of products of rates in the energy, ``(n, n)``, alike along all axes."""
    system, count = solution.system, len(rates)
    numbers = np.arange(len(solution.state))
    rows = np.concatenate([numbers[system.STATE.rows(name)] for name in rates])
    states = np.repeat(np.asarray(solution.state)[:, :1], 1 + len(rows) ** 2, axis=1)
    states[rows] = 0.0
    pairs = [(a, b) for a in range(len(rows)) for b in range(len(rows))]
    for n, (a, b) in enumerate(pairs, start=1):
        states[rows[a], n] += 1.0
        states[rows[b], n] += 1.0
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            found = system.observables(states, solution.parameters, target="numpy")
        energy = np.asarray(found)[list(system.OBSERVABLES).index("energy")]
    except (CoadjointError, TypeError, ValueError):
        return None
    both = (energy[1:] - energy[0]).reshape(len(rows), len(rows))  # of e_a + e_b
    single = np.diag(both) / 4  # of e_a, if it is quadratic
    whole = (both - single[:, None] - single).reshape(count, 3, count, 3)
    inertia: Array = whole[:, 0, :, 0]
    alike = np.einsum("ij,ab->iajb", inertia, np.eye(3))
    largest = float(np.abs(inertia).max())
    if not largest or not np.isfinite(whole).all() or inertia[-1, -1] <= 0:
        return None
    return inertia if np.abs(whole - alike).max() <= ROUNDED * largest else None


def find_pendulum(
    solution: Solution,
) -> tuple[tuple[str, ...], Array, tuple[str, str], str] | None:
    """Links of a pendulum in the plane: angles whose sines and cosines add up to observables.

    The last mass is at ``x = sum of a_i sin(theta_i)`` and ``y = -sum of a_i cos(theta_i)``, which
    samples of the motion decide by least squares.

    Returns:
        The names of the angles, the lengths of the links, the names of the axes, and their unit.
    """
    state, observables = solution.system.STATE, solution.system.OBSERVABLES
    angles = tuple(name for name, each in state.items() if each.unit == "rad" and not each.shape)
    if not angles or solution.batch or len(solution) < 2 * len(angles):
        return None
    turned = np.stack([np.asarray(solution[name]) for name in angles], axis=1)  # (T, links)
    flat = [name for name, each in observables.items() if not each.shape]
    for x, y in permutations(flat, 2):
        if observables[x].unit != observables[y].unit:
            continue
        lengths, _, rank, _ = np.linalg.lstsq(np.sin(turned), solution[x], rcond=1e-9)
        size = np.abs(lengths).sum()
        off = max(
            np.abs(np.sin(turned) @ lengths - solution[x]).max(),
            np.abs(np.cos(turned) @ lengths + solution[y]).max(),
        )
        if rank == len(angles) and lengths.min() > 0 and off <= ROUNDED * size:
            return angles, np.asarray(lengths, dtype=float), (x, y), observables[x].unit
    return None
