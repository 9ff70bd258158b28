r"""Newton: velocities of momenta where :math:`\mu = \partial l / \partial \xi` has no closed form.

The iteration begins at rest and takes `STEPS` steps with the exact Hessian,

.. math::
    n \mapsto n + H(n)^{-1} (\mu - g(n)), \qquad g = \partial l / \partial \xi, \quad H = g'.

So it depends on its arguments alone, and every member takes as many steps. Its end is a *guess*,
a number whose derivative is taken to be 0. The velocities follow by one more step, which is a
linear equation like any other: ``H(n) xi = H(n) n + mu - g(n)``. Its first derivatives at fixed n
are those of the implicit function, and rounding errors of n are squared in it.

Where the last step to the guess is not small, the guess is not a number, and so is all that rests
on it: see `Newton.find`. The branch is the one on which the iteration ends, and where every pivot
of H has the sign that it has at rest, which is a bound of the domain.
Comes in: g and H at the guess, with ``mu``. Goes out: the guess in any arithmetic.
Read next: `coadjoint.derive.mechanics.legendre`, `coadjoint.derive.reference`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from operator import add, mul
from typing import Any

from coadjoint.exact import Element, Field

#: Steps of each iteration.
STEPS = 24
#: What the squares of the last step and of the guess may have as a ratio, in the norm of H; and of
#: the last step and ``mu`` over H at rest, which is for velocities near 0.
SMALL, NOTHING = Fraction(1, 2**52), Fraction(1, 2**92)

#: What arithmetics call to forget how a value came about: its slopes, or its envelope.
SETTLE = "settle"

Call = Callable[..., Any]
Number = Callable[[Fraction], Any]
#: Names a value, or forgets how it came about: given the step, the place and the value.
Settle = Callable[[int, int, Any], Any]


def guess_name(place: int) -> str:
    """Name of the guess of the velocity in a place, counted from 0."""
    return f"_x{place + 1}"


def iterate_name(place: int, step: int) -> str:
    """Name of what a step gives for it."""
    return f"_x{place + 1}_{step}"


def is_guess(name: str) -> bool:
    """Whether a name is that of a guess, or of a step towards one."""
    return name.startswith("_x") and name[2:3].isdigit()


def rate_name(place: int) -> str:
    """Name of the rate of a velocity that an iteration finds, in recurrences of its coefficients."""
    return f"_a{place + 1}"


@dataclass(frozen=True)
class Newton:
    """An iteration for one block of coupled velocities.

    Attributes:
        block: Their places.
        sought: ``mu``, as it pairs with velocities.
        slopes: g at the guess.
        hessian: H at the guess.
    """

    block: Sequence[int]
    sought: Sequence[Element]
    slopes: Sequence[Element]
    hessian: Sequence[Sequence[Element]]

    @property
    def names(self) -> list[str]:
        """The names of the guess."""
        return [guess_name(place) for place in self.block]

    @property
    def elements(self) -> list[Element]:
        """All that an iteration evaluates."""
        return [*self.sought, *self.slopes, *(entry for row in self.hessian for entry in row)]

    def find(
        self,
        field: Field,
        known: Mapping[str, Any],
        number: Number,
        call: Call,
        settle: Settle,
    ) -> dict[str, Any]:
        """The guess by name; not a number where the iteration has not come to its end.

        With ``d`` the last step, ``r = H d`` and ``c = SMALL n . H n + NOTHING mu . mu/H(0) - d . r``
        it is multiplied by ``(1 + sqrt(c))/(1 + sqrt(c))``, which is 1 or not a number.

        Args:
            field: Where the elements live.
            known: Values of the names on which they rest.
            number: Takes a rational number into the arithmetic.
            call: Applies an elementary function.
            settle: Takes what a step gives.
        """
        size, values = range(len(self.block)), [number(Fraction(0)) for _ in self.block]
        mu = [field.evaluate(each, known, number, call) for each in self.sought]
        scale, left, step = None, mu, values
        rows: list[list[Any]] = []
        for count in range(1, STEPS + 1):
            at = {**known, **dict(zip(self.names, values, strict=True))}
            factors = dict[int, Any]()
            g = [field.evaluate(each, at, number, call, factors) for each in self.slopes]
            rows = [
                [field.evaluate(self.hessian[i][j], at, number, call, factors) for j in size[: i + 1]]
                for i in size
            ]
            left = [m + -s for m, s in zip(mu, g, strict=True)]
            if scale is None:
                scale = _total(m * m / rows[i][i] for i, m in enumerate(mu))
            step = _solve(rows, left)
            values = [settle(count, i, n + d) for i, (n, d) in enumerate(zip(values, step, strict=True))]
        return self._guard(values, rows, _total(map(mul, step, left)), scale, number, call)

    def _guard(
        self,
        values: list[Any],
        rows: list[list[Any]],
        last: Any,
        scale: Any,
        number: Number,
        call: Call,
    ) -> dict[str, Any]:
        """The values, or what is not a number."""
        size = range(len(values))
        terms = (rows[max(i, j)][min(i, j)] * values[i] * values[j] for i in size for j in size)
        whole = number(SMALL) * _total(terms) + number(NOTHING) * scale + -last
        root = number(Fraction(1)) + call("sqrt", whole)
        one = root / root
        return {name: value * one for name, value in zip(self.names, values, strict=True)}


def _total(values: Any) -> Any:
    """A sum from left to right."""
    return reduce(add, values)


def _solve(rows: Sequence[Sequence[Any]], known: Sequence[Any]) -> list[Any]:
    """``A x = b`` for a symmetric A, given on and below the diagonal, by ``L D L^T``."""
    size = range(len(known))
    lower: dict[tuple[int, int], Any] = {}
    pivots, y = list[Any](), list[Any]()
    for i in size:
        own = list(rows[i])
        for j in size[:i]:
            for k in size[:j]:
                own[j] = own[j] + -(own[k] * lower[j, k])
        for j in size[:i]:  # own[j] is l_ij d_j
            lower[i, j] = own[j] / pivots[j]
            own[i] = own[i] + -(own[j] * lower[i, j])
        pivots.append(own[i])
        y.append(reduce(lambda b, j: b + -(lower[i, j] * y[j]), size[:i], known[i]))
    x = [b / d for b, d in zip(y, pivots, strict=True)]
    for i in reversed(size):
        for k in size[i + 1 :]:
            x[i] = x[i] + -(lower[k, i] * x[k])
    return x
