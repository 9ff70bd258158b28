"""Gauss: the implicit methods of Runge and Kutta of order 4, 6 and 8, in NumPy.

They keep linear and quadratic integrals, carry a constant symplectic form along, and are their own
adjoints: E. Hairer, C. Lubich and G. Wanner, Geometric Numerical Integration (2006), IV.2, V.2 and
VI.4. Rounded tables would lose that, by an error of one sign in each step. So stages are written as
M. Antonana, J. Makazaga and A. Murua have them, Numerical Algorithms 76 (2017) 861: with
``L_j = h b_j f(Y_j)``, ``Y_i = x + sum_j m_ij L_j`` and ``m_ij = a_ij/b_j``, all that quadratic
integrals need is ``m_ij + m_ji = 1``, which holds here without rounding. Of the lengths ``h b_j``
the innermost ones are what the others leave of the step.
Comes in: rates, and where members are. Goes out: where a step of each leads.
Read next: `coadjoint.solve.methods.lie_poisson`, whose search and sums it shares.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from decimal import Decimal, localcontext
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import numpy as np

from coadjoint.solve.methods.lie_poisson import (
    Arc,
    LiePoisson,
    Sweep,
    continue_offset,
    keep_offset,
    split_memory,
)
from coadjoint.solve.steps import add_low

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array, Mask
    from coadjoint.solve.steps import Lanes

_DIGITS: Final = 60


@dataclass(frozen=True)
class Tableau:
    """A method of Gauss.

    Attributes:
        nodes: Times of its stages, in parts of the step.
        lengths: The weights of the first stages; those of the last are the same, backwards.
        shares: ``m_ij``, how much of the rise of stage j there is in stage i.
    """

    nodes: tuple[float, ...]
    lengths: tuple[float, ...]
    shares: tuple[tuple[float, ...], ...]


def _find_nodes(stages: int) -> list[Decimal]:
    """The zeros of Legendre's polynomials between 0 and 1, as surds."""
    one = Decimal(1)
    if stages == 2:
        outer = [(one / 3).sqrt()]
    elif stages == 3:
        outer = [(3 * one / 5).sqrt()]
    else:
        root = 2 * one / 7 * (6 * one / 5).sqrt()
        outer = [(3 * one / 7 + root).sqrt(), (3 * one / 7 - root).sqrt()]
    middle = [Decimal(0)] if stages % 2 else []
    return [(1 + z) / 2 for z in (*(-z for z in outer), *middle, *reversed(outer))]


def _integrate(nodes: list[Decimal], place: int, end: Decimal) -> Decimal:
    """The integral from 0 to an end of the polynomial that is 1 at one node and 0 at the others."""
    powers = [Decimal(1)]
    for other in nodes[:place] + nodes[place + 1 :]:
        gap = nodes[place] - other
        raised = [Decimal(0), *powers]
        powers = [(a - other * b) / gap for a, b in zip(raised, [*powers, Decimal(0)], strict=True)]
    return sum((c * end ** (k + 1) / (k + 1) for k, c in enumerate(powers)), Decimal(0))


def _make(stages: int) -> Tableau:
    """The table of so many stages; a share above a half is rounded, and its partner is the rest."""
    with localcontext() as context:
        context.prec = _DIGITS
        nodes = _find_nodes(stages)
        weights = [_integrate(nodes, j, Decimal(1)) for j in range(stages)]
        exact = [[_integrate(nodes, j, c) / weights[j] for j in range(stages)] for c in nodes]
        shares = tuple(
            tuple(
                0.5 if i == j
                else float(share) if 2 * share > 1
                else 1.0 - float(exact[j][i])
                for j, share in enumerate(row)
            )
            for i, row in enumerate(exact)
        )  # fmt: skip
        lengths = tuple(float(b) for b in weights[: (stages - 1) // 2])
        return Tableau(tuple(map(float, nodes)), lengths, shares)


#: The methods by their orders.
TABLEAUS: Final = MappingProxyType({2 * stages: _make(stages) for stages in (2, 3, 4)})


def make(functions: Mapping[str, Callable[..., Array]], size: float, order: int) -> Gauss:
    """The method of an order, from functions of the kernel."""
    return Gauss(rates=functions["rates"], size=size, order=order)


class Gauss(LiePoisson):
    """A method of Gauss; its equations are solved by sweeps over all stages at a time.

    Args:
        rates: Rates of lanes, at states some time later.
        size: The step.
        order: 4, 6 or 8.
    """

    def __init__(
        self, *, rates: Callable[[Lanes, Array, Array], Array], size: float, order: int
    ) -> None:
        self.rates, self.size, self.table = rates, size, TABLEAUS[order]
        self.stages = self.table.nodes

    def advance(
        self, lanes: Lanes, h: Array, state: Array, memory: Array
    ) -> tuple[Array, Array, Mask, NDArray[np.uint64]]:
        """As `LiePoisson.advance`; all stages are found by one search."""
        low, *offsets = split_memory(memory, len(state))
        arc = Arc(lanes=lanes, middle=0.5 * h, length=h, state=state, low=low)
        start = np.concatenate([state] * len(offsets))
        offset = np.concatenate([*map(continue_offset, offsets)])
        found = self.search(arc, start, offset, np.zeros(h.shape, bool))
        stages = np.split(found.middle, len(offsets))
        kept = [
            keep_offset(*each) for each in zip(offsets, (x - state for x in stages), strict=True)
        ]
        state, low = add_low(state, low, found.rise)
        return state, np.concatenate([low, *kept]), found.solved, found.made

    def prepare(self, arc: Arc, middle: Array) -> list[Array]:
        """As `LiePoisson.prepare`: the parts of the step that belong to its stages."""
        return self._split(arc.length)

    def sweep(self, arc: Arc, middle: Array, kept: list[Array]) -> Sweep:
        """Better stages, one below the other, and what the step adds with those before."""
        stages = np.split(middle, len(kept))
        rises = [
            length * self.rates(arc.lanes, node * arc.length, stage)
            for node, length, stage in zip(self.table.nodes, kept, stages, strict=True)
        ]
        better = []
        for row in self.table.shares:
            total = arc.low
            for share, rise in zip(row, rises, strict=True):
                total = total + share * rise
            better.append(arc.state + total)
        return Sweep(np.concatenate(better), _add_symmetric(rises))

    def linearise(self, arc: Arc, middle: Array, following: Array, kept: list[Array]) -> Array:
        """As `LiePoisson.linearise`, exact: of each stage by each."""
        size, columns = len(arc.state), []
        stages = np.split(middle, len(kept))
        shares = np.array(self.table.shares)
        for j, (node, length, stage) in enumerate(zip(self.table.nodes, kept, stages, strict=True)):
            rows = self.find_slopes(arc, node * arc.length, length, stage)
            own = shares[:, j, np.newaxis, np.newaxis, np.newaxis] * rows
            columns.append(own.reshape(len(kept) * size, size, -1))
        return np.concatenate(columns, axis=1)

    def _split(self, h: Array) -> list[Array]:
        """The parts of a step that belong to its stages."""
        stages, outer = len(self.table.nodes), [b * h for b in self.table.lengths]
        rest = h if stages % 2 else 0.5 * h
        for each in outer:
            rest = rest - (2.0 * each if stages % 2 else each)
        return [*outer, *([rest] if stages % 2 else [rest, rest]), *reversed(outer)]


def _add_symmetric(rises: list[Array]) -> Array:
    """A sum that is the same backwards: the first and the last, then those further inside."""
    pairs = zip(rises[: len(rises) // 2], reversed(rises), strict=False)
    total, *rest = [a + b for a, b in pairs]
    for each in rest:
        total = total + each
    return total + rises[len(rises) // 2] if len(rises) % 2 else total
