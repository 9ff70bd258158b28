"""Few coordinates that generate all others under a Poisson bracket.

Comes in: the brackets of two coordinates that are a multiple of a third. Goes out: coordinates from
which all others follow. Only these need be asked whether they commute with a Casimir C: by the
Jacobi identity ``{x_i, C} = {x_j, C} = 0`` gives ``{{x_i, x_j}, C} = 0``.
"""

from __future__ import annotations

from collections.abc import Mapping


def generating(products: Mapping[tuple[int, int], int], size: int) -> list[int]:
    """The coordinates, in order, that the brackets of those before do not give.

    Args:
        products: ``{(i, j): k}`` where ``{x_i, x_j}`` is a nonzero multiple of x_k.
        size: Number of coordinates.

    >>> generating({(0, 1): 2, (1, 2): 0, (0, 2): 1}, 4)
    [0, 1, 3]
    """
    partners: list[list[tuple[int, int]]] = [[] for _ in range(size)]
    for (i, j), k in products.items():
        partners[i].append((j, k))
        partners[j].append((i, k))
    reached: set[int] = set()
    kept = []
    for i in range(size):
        if i in reached:
            continue
        kept.append(i)
        waiting = [i]
        while waiting:
            new = waiting.pop()
            if new not in reached:
                reached.add(new)
                waiting += [k for j, k in partners[new] if j in reached]
    return kept
