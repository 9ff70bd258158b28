"""Cross-check, loops in any arithmetic: what the parts of a family compute of all its members.

Comes in: `Loops`, a state and parameters of N members. Goes out: every row of the result, to 50
digits with its envelope, or in any other arithmetic. Envelopes are those of the form that kernels
compute: differences such as ``(q[i+1] - q[i])^2 - (q[i] - q[i-1])^2`` have larger ones than what is
left of them multiplied out.
Read next: `coadjoint.crosscheck.families`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import localcontext
from fractions import Fraction
from functools import reduce
from itertools import combinations
from math import isqrt, prod
from operator import add
from typing import Any

from coadjoint.crosscheck.oracle import (
    CONTEXT,
    Bounded,
    BoundedEquations,
    OutsideDomain,
    call,
    exact,
)
from coadjoint.lower.evaluation import run
from coadjoint.lower.loops import SUM, Loops, Part, Products, Solve


@dataclass(frozen=True)
class _Members:
    """The arrays of so many members, in an arithmetic.

    Attributes:
        arrays: Rows of ``state``, ``parameters``, ``inputs`` and ``time``.
        size: N.
        number: How the arithmetic makes numbers.
        call: How it calls functions.
    """

    arrays: Mapping[str, Sequence[Any]]
    size: int
    number: Callable[[Fraction], Any]
    call: Callable[..., Any]

    def evaluate(self, part: Part, i: int, j: int = 0, sums: Sequence[Any] = ()) -> list[Any]:
        """The outputs of a part for a member, or for a pair of them."""
        values: dict[str, Any] = {}
        for read in part.reads:
            row = read.rows + read.blocks * self.size
            if read.single is not None:
                row += read.single % self.size
            elif read.shift is not None:
                row += j if read.of_partner else (i + read.shift) % self.size
            values[read.name] = self.arrays[read.array][row]
        for name in part.program.state[len(part.reads) :]:
            values[name] = sums[int(name.removeprefix(SUM))]
        return run(part.program, values, self.number, self.call)

    def complete(self, solve: Solve) -> _Members:
        """The same with what is solved for, by elimination and not by doubled shifts.

        A level one solves the equation of the whole matrix, to which the first factor times the sum
        is added: that is 0.
        """
        factors, size = self.evaluate(solve.factors, 0), self.size
        every = [(r * s, a) for r, a in enumerate(factors) for s in ((1, -1) if r else (1,))]
        row = [factors[0] if solve.level else self.number(Fraction(0))] * size
        for place, a in every:
            for shift, weight in ((0, 2), (1, -1), (-1, -1)) if solve.level else ((0, 1),):
                row[(place + shift) % size] += a * self.number(Fraction(weight))
        lower = [row[i - j] for i in range(size) for j in range(i + 1)]
        equations, state, found = BoundedEquations(lower), self.arrays["state"], list[Any]()
        for first in range(0, len(state), solve.blocks * size):
            run_of = state[first : first + solve.blocks * size]
            right = run_of[solve.of * size :][:size]
            if solve.level:
                mean = reduce(add, right) / self.number(Fraction(size))
                right = [each + -mean for each in right]
            found += [*run_of, *equations.solve(right)]
        return replace(self, arrays={**self.arrays, "state": found})

    def multiply(self, products: Products) -> _Members:
        """The same with what is computed of matrices.

        On the sphere by dense elimination on each diagonal, on the torus from its Fourier series.
        """
        state, size, found = self.arrays["state"], self.size, list[Any]()
        if products.scale is None:
            pairs = [(list(state[:size]), list(state[size:]))]
        else:
            (scale,) = self.evaluate(products.scale, 0)
            runs = (list(state[k : k + size]) for k in range(0, len(state), size))
            find = self._find_on_sphere if products.surface == "sphere" else self._find_on_torus
            pairs = [(W, find(scale, W)) for W in runs]
        first, turns = pairs[0], products.product == "sandwich"
        for k, (W, V) in enumerate(pairs):
            found += [*W, *V]
            both = self._multiply_entries(first[0], V, turns=turns)
            if k:
                others = self._multiply_entries(W, first[1], turns=turns)
                both = [a + b for a, b in zip(both, others, strict=True)]
            found += both if products.product else []
        return replace(self, arrays={**self.arrays, "state": found})

    def _find_on_sphere(self, scale: Any, W: Sequence[Any]) -> list[Any]:
        """V with ``scale L V = W``; where L takes multiples of 1 to 0, the mean is added to it."""
        n, V = isqrt(self.size), dict[int, Any]()

        def number(value: int | Fraction) -> Any:
            return self.number(Fraction(value))

        mean = reduce(add, W[:: n + 1]) / number(n)
        for diagonal in range(1 - n, n):
            rows = [i for i in range(n) if 0 <= i + diagonal < n]
            lower = list[Any]()
            for a, i in enumerate(rows):
                z, w = (Fraction(n - 1 - 2 * k, 2) for k in (i, i + diagonal))
                own = [number(0 if diagonal else 1)] * (a + 1)
                own[a] = own[a] + number(2 * (Fraction(n * n - 1, 4) - z * w))
                if a:
                    ends = ((k + 1) * (n - 1 - k) for k in (i - 1, i - 1 + diagonal))
                    own[a - 1] = own[a - 1] + -self.call("sqrt", number(prod(ends)))
                lower += own
            right = [W[i * n + i + diagonal] for i in rows]
            right = right if diagonal else [each + -mean for each in right]
            known = [each / scale for each in right]
            solved = BoundedEquations(lower).solve(known)
            V |= {i * n + i + diagonal: x for i, x in zip(rows, solved, strict=True)}
        return [V[k] for k in range(self.size)]

    def _find_on_torus(self, scale: Any, W: Sequence[Any]) -> list[Any]:
        """V with ``scale L V = W``: waves of each diagonal, over the squares of their numbers."""
        n, V = isqrt(self.size), dict[int, Any]()

        def number(value: int | Fraction) -> Any:
            return self.number(Fraction(value))

        turn = self.call("atan", number(1)) * number(8)
        angles = [turn * number(Fraction(t, n)) for t in range(n)]
        cosines, sines = ([self.call(f, each) for each in angles] for f in ("cos", "sin"))
        for k2 in range(n):
            places = [(i, (i + k2) % n) for i in range(n)]
            own = {place: [number(0)] for place in places}
            for k1 in range(n):
                square = sum(min(k, n - k) ** 2 for k in (k1, k2))
                for table in (cosines, sines) if square else ():
                    parts = [table[k1 * (i + j) % n] for i, j in places]
                    terms = [W[i * n + j] * x for (i, j), x in zip(places, parts, strict=True)]
                    share = reduce(add, terms) / number(n * square)
                    for place, x in zip(places, parts, strict=True):
                        own[place].append(share * x)
            V |= {i * n + j: reduce(add, own[i, j]) / scale for i, j in places}
        return [V[k] for k in range(self.size)]

    def _multiply_entries(self, W: Sequence[Any], V: Sequence[Any], *, turns: bool) -> list[Any]:
        """[W, V], or V W V, of the matrices that real ones stand for."""
        n, half = isqrt(self.size), self.number(Fraction(1, 2))

        def split(X: Sequence[Any]) -> tuple[list[Any], list[Any]]:
            pairs = [(X[i * n + j], X[j * n + i]) for i in range(n) for j in range(n)]
            return [(a + -b) * half for a, b in pairs], [(a + b) * half for a, b in pairs]

        def multiply(X: Any, Y: Any) -> tuple[list[Any], list[Any]]:
            (a, b), (c, d) = X, Y
            places = [(i * n, j) for i in range(n) for j in range(n)]
            terms = [[(r + k, j + k * n) for k in range(n)] for r, j in places]
            real = [[a[x] * c[y] + -(b[x] * d[y]) for x, y in each] for each in terms]
            turned = [[a[x] * d[y] + b[x] * c[y] for x, y in each] for each in terms]
            return [reduce(add, each) for each in real], [reduce(add, each) for each in turned]

        w, v = split(W), split(V)
        if turns:
            real, turned = multiply(v, multiply(w, v))
        else:
            (a, b), (c, d) = multiply(w, v), multiply(v, w)
            real = [x + -y for x, y in zip(a, c, strict=True)]
            turned = [x + -y for x, y in zip(b, d, strict=True)]
        return [x + y for x, y in zip(real, turned, strict=True)]

    def add_up(self, terms: Iterable[list[Any]]) -> list[Any]:
        """Sums of terms, column by column."""
        return [reduce(add, column) for column in zip(*terms, strict=True)]

    def find_totals(self, loops: Loops) -> list[Any]:
        """Sums first, then what follows from them."""
        assert loops.finish is not None, loops.name
        sums = list[Any]()
        for each in loops.totals:
            run_of = range(each.before, self.size - each.after)
            places: Iterable[tuple[int, int]] = ((i, 0) for i in run_of)
            if each.over == "pairs":
                places = combinations(range(self.size), 2)
            nothing = [self.number(Fraction(0))] * len(each.part.program.outputs)
            sums += self.add_up([nothing, *(self.evaluate(each.part, *at) for at in places)])
        return self.evaluate(loops.finish, 0, sums=sums)

    def find_members(self, loops: Loops) -> Iterator[list[Any]]:
        """The rows of each member."""
        ends = {number % self.size: part for number, part in loops.ends}
        for i in range(self.size):
            sums = list[Any]()
            if loops.partners is not None:
                others = (j for j in range(self.size) if j != i)
                terms = [self.evaluate(loops.partners, i, j) for j in others]
                sums = self.add_up(terms)[: loops.pair_sums]
            part = ends.get(i, loops.member)
            assert part is not None, loops.name
            yield self.evaluate(part, i, sums=sums)


def evaluate_loops(
    loops: Loops, arrays: Mapping[str, Sequence[float]], size: int
) -> list[Bounded] | None:
    """Every row of a function, to 50 digits; None where it has no value.

    Args:
        loops: The function.
        arrays: Rows of ``state``, ``parameters``, ``inputs`` and ``time``; doubles, taken as exact.
        size: N.
    """
    with localcontext(CONTEXT):
        try:
            known = {name: [exact(value) for value in rows] for name, rows in arrays.items()}
            known["sizes"] = [exact(float(size))]
            members = _Members(known, size, exact, call)
            if loops.solve is not None:
                members = members.complete(loops.solve)
            if loops.products is not None:
                members = members.multiply(loops.products)
            if loops.member is None:
                return members.find_totals(loops)
            rows = zip(*members.find_members(loops), strict=True)
            return [value for row in rows for value in row]
        except (ArithmeticError, OutsideDomain):
            return None
