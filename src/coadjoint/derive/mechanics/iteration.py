r"""Newton: velocities of momenta where :math:`\mu = \partial l / \partial \xi` has no closed form.

The iteration begins at rest, :math:`n = 0`, and takes `STEPS` steps with the exact Hessian,

.. math::
    n \mapsto n + H(n)^{-1} (\mu_k - g(n)), \qquad g = \partial l / \partial \xi, \quad H = g'.

Its targets :math:`\mu_k` lie on the line from :math:`g(0)` to :math:`\mu`, farther by a fourth in
each of the first `APPROACH` steps, and are :math:`\mu` in all others. So it depends on its
arguments alone, every member takes as many steps, and it follows the branch that begins at rest.
Its end is a *guess*, a number whose derivative is taken to be 0. The velocities follow by one more
step, which is a linear equation like any other: ``H(n) xi = H(n) n + mu - g(n)``. Its first
derivatives at fixed n are those of the implicit function, and the error of n is squared in it.

Where the last step to the guess or what was left before it is not small, or H is not positive
definite there, the guess is not a number, and so is all that rests on it: see `Newton.find`. That
every pivot of H is positive is a bound of the domain.
Comes in: g and H at the guess, with ``mu``. Goes out: the guess in any arithmetic.
Read next: `coadjoint.derive.mechanics.legendre`, `coadjoint.derive.reference`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from itertools import pairwise
from operator import add, mul
from typing import Any

from coadjoint.exact import Element, Field

#: Steps of each iteration, and how many of them approach the momenta.
STEPS, APPROACH = 32, 24
#: By how much the line from rest to the momenta is shorter, one step earlier.
SHORTER = 0.8
#: What the squares of the last step and of the guess may have as a ratio, in the norm of H; and of
#: the last step and ``mu`` over H at rest, which is for velocities near 0.
SMALL, NOTHING = Fraction(1, 2**76), Fraction(1, 2**92)
#: What the squares of what is left before the last step and of the momenta may have as a ratio.
LEFT = Fraction(1, 2**40)
#: What arithmetics call to forget how a value came about: its slopes and its envelope, or, of what
#: the last step gives, its slopes alone. How rounding came into that one shows where it is near 0.
SETTLE, SETTLE_LAST = "settle", "settle last"

Call = Callable[..., Any]
Number = Callable[[Fraction], Any]
#: What `Newton.curved` is at values of the guess.
Exchange = Callable[[list[Any]], list[Any]]
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


def is_step(name: str) -> bool:
    """Whether a name is that of a step towards a guess, but the last."""
    step = name.partition("_x")[2].partition("_")[2]
    return is_guess(name) and step.isdigit() and int(step) < STEPS


def rate_name(place: int) -> str:
    """Name of the rate of a velocity that an iteration finds, as recurrences have it."""
    return f"_a{place + 1}"


def slope_name(place: int) -> str:
    """Name of the rate of a component of the inputs, counted from 0, as recurrences have it."""
    return f"_du{place + 1}"


def slope_place(name: str) -> int | None:
    """The component of the inputs whose rate has a name; None where it is no such name."""
    return int(name[3:]) - 1 if name.startswith("_du") else None


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
    def curved(self) -> list[Element]:
        """H on and below its diagonal, row by row, and g: what is evaluated in each step."""
        rows = (row[: i + 1] for i, row in enumerate(self.hessian))
        return [*(entry for row in rows for entry in row), *self.slopes]

    def split(self, values: Sequence[Any]) -> tuple[list[Any], list[list[Any]]]:
        """g, and the rows of H, of values of `curved`."""
        starts = [i * (i + 1) // 2 for i in range(len(self.block) + 1)]
        rows = [[*values[a:b]] for a, b in pairwise(starts)]
        return [*values[starts[-1] :]], rows

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
        exchange: Exchange | None = None,
    ) -> dict[str, Any]:
        """The guess by name; not a number where the iteration has not come to its end.

        Let d be the last step, ``r = H d`` what was left before it, h the diagonal of H at rest.
        Then ``SMALL n . H n + NOTHING mu . mu/h - d . r``, ``LEFT (mu . mu/h + g . g/h) - r . r/h``
        and the pivots of H are not negative. Roots of all these and 1 are added, and the sum over
        itself is 1 or not a number.

        Args:
            field: Where the elements live.
            known: Values of the names on which they rest.
            number: Takes a rational number into the arithmetic.
            call: Applies an elementary function.
            settle: Takes what a step gives.
            exchange: What `elements` are at other values of the guess than 0; by default they are
                evaluated.
        """
        values = [number(Fraction(0)) for _ in self.block]
        mu = [field.evaluate(each, known, number, call) for each in self.sought]
        rest, rows = self._evaluate(field, known, values, number, call)
        diagonal, g = [row[i] for i, row in enumerate(rows)], rest
        for count in range(1, STEPS + 1):
            if count > 1:
                g, rows = (
                    self._evaluate(field, known, values, number, call)
                    if exchange is None
                    else self.split(exchange(values))
                )
            part = _part(count)
            aims = (
                mu
                if part == 1
                else [z + number(part) * (m + -z) for m, z in zip(mu, rest, strict=True)]
            )
            left = [aim + -slope for aim, slope in zip(aims, g, strict=True)]
            step, pivots = _solve(rows, left)
            moved = (n + d for n, d in zip(values, step, strict=True))
            values = [settle(count, i, each) for i, each in enumerate(moved)]
        size = range(len(values))
        terms = (rows[max(i, j)][min(i, j)] * values[i] * values[j] for i in size for j in size)
        scale, reached, lacking = (_weigh(each, diagonal) for each in (mu, g, left))
        whole = number(SMALL) * _total(terms) + number(NOTHING) * scale
        whole = whole + -_total(map(mul, step, left))
        rest_of = number(LEFT) * (scale + reached) + -lacking
        root = number(Fraction(1)) + _total(
            call("sqrt", each) for each in (whole, rest_of, *pivots)
        )
        one = root / root
        return {name: value * one for name, value in zip(self.names, values, strict=True)}

    def _evaluate(
        self, field: Field, known: Mapping[str, Any], values: list[Any], number: Number, call: Call
    ) -> tuple[list[Any], list[list[Any]]]:
        """g, and H on and below its diagonal, at some values of the guess."""
        at, factors = {**known, **dict(zip(self.names, values, strict=True))}, dict[int, Any]()
        return self.split([field.evaluate(each, at, number, call, factors) for each in self.curved])


def _part(step: int) -> Fraction:
    """How far along the line from rest to the momenta the target of a step is; a double."""
    return Fraction(round(SHORTER ** max(APPROACH - step, 0) * 2**20), 2**20)


def _weigh(values: Sequence[Any], diagonal: Sequence[Any]) -> Any:
    """The sum of squares over entries of H."""
    return _total(x * x / h for x, h in zip(values, diagonal, strict=True))


def tell_iterations(iterations: Sequence[Newton]) -> str:
    """What follows a statement that velocities are solved for; "" without iterations."""
    names = [name for each in iterations for name in each.names]
    is_are = "are" if len(names) > 1 else "is"
    what = f"{', '.join(names)} {is_are} found by Newton's iteration of {STEPS} steps from rest"
    return f"; {what}, and here is the step after it" if names else ""


def _total(values: Any) -> Any:
    """A sum from left to right."""
    return reduce(add, values)


def _solve(rows: Sequence[Sequence[Any]], known: Sequence[Any]) -> tuple[list[Any], list[Any]]:
    """The x of ``A x = b`` and D, for a symmetric ``A = L D L^T``, given to its diagonal."""
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
    return x, pivots
