"""Nambu's discrete gradient: steps that keep the energy and all distinguished functions.

A motion by Nambu's bracket is the product of the gradients of its energy h and of n - 2
distinguished functions of n coordinates, ``x' = dc x dh`` of three. In a step each gradient is a
discrete one, ``g.(y - x) = F(y) - F(x)`` (`coadjoint.solve.methods.discrete_gradient`). Their
product is orthogonal to each of them, so that no function changes.
R. I. McLachlan, G. R. W. Quispel and N. Robidoux, Philosophical Transactions A 357 (1999) 1021.
Comes in: where members are. Goes out: the middle of a step by sweeps, and its chord.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from coadjoint.solve.methods.several_gradients import SeveralGradients

if TYPE_CHECKING:
    from collections.abc import Mapping

    from coadjoint.array_types import Array
    from coadjoint.solve.methods.lie_poisson import Arc


def make(functions: Mapping[str, Any], size: float, order: int) -> NambuGradient:
    """The method of an order, from functions of the kernel."""
    evaluate = functions["evaluate"]
    return NambuGradient(
        values=partial(evaluate, ("energy", "distinguished")),
        gradients=partial(evaluate, ("energy_gradient", "distinguished_gradient")),
        size=size,
        order=order,
    )


class NambuGradient(SeveralGradients):
    """The product of discrete gradients of the energy and of the distinguished functions."""

    def find_rates(self, arc: Arc, middle: Array, gradients: Array) -> Array:
        """As `SeveralGradients.find_rates`."""
        return multiply_gradients(gradients)


def multiply_gradients(gradients: Array) -> Array:
    """Nambu's product, ``dc x dh`` for dh above dc, by minors of the first rows.

    Args:
        gradients: ``(n - 1, n, N)``.

    >>> rows = np.array([[[1.0], [0.0], [0.0]], [[0.0], [1.0], [0.0]]])
    >>> multiply_gradients(rows).ravel().tolist()  # of (0, 1, 0) and (1, 0, 0)
    [-0.0, 0.0, -1.0]
    """
    _, n, members = gradients.shape
    minors = {0: np.ones(members)}
    for columns in range(1, (1 << n) - 1):
        row, place, total = columns.bit_count() - 1, 0, np.zeros(members)
        for i in range(n):
            if columns >> i & 1:
                term = gradients[row, i] * minors[columns ^ 1 << i]
                total = total - term if (row + place) % 2 else total + term
                place += 1
        minors[columns] = total
    cofactors = [minors[((1 << n) - 1) ^ 1 << i] for i in range(n)]
    return np.array([each if i % 2 else -each for i, each in enumerate(cofactors)])
