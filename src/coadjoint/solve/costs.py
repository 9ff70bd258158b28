"""What a step costs: the order of the method of Taylor, and the method that is faster.

Comes in: a tolerance, and operations of the rates as they were counted when solvers were generated.
Goes out: an order, or whether ``dop853`` is the faster method. docs/decisions/solver-speed.md has
the measurements. Read next: `coadjoint.solve.request`, which chooses.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from coadjoint.render.targets.modules import KernelModule

#: The least and the greatest order of the method of Taylor.
ORDERS: Final = (4, 40)
#: The tolerances of ``dop853``, as a part of those of the method of Taylor, for the same errors.
SHARE: Final = 2.0**-12
#: Tolerances between which the methods are compared. At looser ones both change alike; at tighter
#: ones that part of them is below the roundings.
LOOSEST, TIGHTEST = 1e-6, 1e-11
#: The least relative tolerance that is taken for another one: at less, steps are all roundings.
LEAST: Final = TIGHTEST * SHARE
#: Rates in a step of ``dop853``, and operations for each component besides them.
RATES, SUMS = 12, 70


def choose_order(rtol: float, *, of_waves: bool = False) -> int:
    """The order of the method of Taylor that a relative tolerance asks for.

    The even number that is three to five more than that of Jorba and Zou, who count operations of
    sums alone: measured best, see docs/decisions/solver-speed.md.

    Orders that are 2 more than a multiple of 4 make all waves grow, however short steps are; see
    `coadjoint.solve.stability`. Of fields the next one is taken.

    >>> choose_order(1e-10), choose_order(2e-16), choose_order(1e-2)
    (16, 24, 8)
    >>> choose_order(1e-6), choose_order(1e-6, of_waves=True)
    (12, 12)
    >>> choose_order(1e-5), choose_order(1e-5, of_waves=True)
    (10, 12)
    """
    order = min(max(ORDERS[0], 2 * math.ceil(2.0 - math.log(rtol) / 4.0)), ORDERS[1])
    return order + 2 if of_waves and order % 4 == 2 else order


@dataclass(frozen=True)
class Costs:
    """What steps of a system cost.

    Attributes:
        rows: Components of the state.
        products: Sums of each order in a step of the method of Taylor.
        operations: Of the rates.
        branches: Whether the rates have branch points, which the method of Taylor looks for.
    """

    rows: int
    products: int
    operations: int
    branches: bool

    def is_dop853_faster(self, rtol: float) -> bool:
        """Whether ``dop853`` is faster than the method of Taylor for the same errors.

        A step of Taylor adds up p (p + 1) / 2 numbers for each product. Its length hardly depends
        on the tolerance; that of ``dop853`` follows its eighth root.

        >>> Costs(28, 168, 398, False).is_dop853_faster(1e-10)  # a free body on so(8)
        True
        >>> Costs(6, 9, 30, False).is_dop853_faster(1e-6)  # a heavy top
        False
        """
        if self.branches or rtol < TIGHTEST:
            return False
        tolerance = min(rtol, LOOSEST)
        order = choose_order(tolerance)
        taylor = self.products * order * (order + 1) / 2
        other = RATES * self.operations + SUMS * self.rows
        length = math.sqrt(math.sqrt(math.sqrt(tolerance / LOOSEST)))
        return taylor * length > other


def read_costs(module: KernelModule, rows: int) -> Costs:
    """The costs that ``solver.py`` tells.

    Args:
        module: It.
        rows: Components of the state.

    Raises:
        OutputError: It does not tell them.
    """
    return Costs(
        rows=rows,
        products=int(module.value("PRODUCTS")),
        operations=int(module.value("OPERATIONS")),
        branches=bool(module.value("BRANCHES")),
    )
