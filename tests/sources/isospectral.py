"""Bodies with a Lax pair and the Bloch-Iserles system, typed by hand from Holm (2011).

Manakov's body is that of section 2.4.2, the quadratic potential ``+tr(SA)/2`` that of 2.5.6, the
flow on symmetric matrices that of appendix C.4. Coefficients of ``tr L^k`` are found by multiplying
out the powers of the spectral parameter one by one; the numbers before them are typed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import combinations, combinations_with_replacement
from typing import Any

from tests.sources.bodies import so_n_velocity
from tests.sources.components import Vector, antisymmetric, commutator, pfaffian, product

Rows = list[list[Any]]


def diagonal(values: Sequence[Any]) -> Rows:
    """The diagonal matrix of some values."""
    return [[x if i == j else 0 for j in range(len(values))] for i, x in enumerate(values)]


def total(*terms: tuple[Any, Rows]) -> Rows:
    """A sum of multiples of matrices."""
    size = range(len(terms[0][1]))
    return [[sum(c * m[i][j] for c, m in terms) for j in size] for i in size]


def trace(a: Rows) -> Any:
    """``tr a``."""
    return sum(a[i][i] for i in range(len(a)))


def symmetric(values: Vector, size: int) -> Rows:
    """The matrix of the entries ``S_ij``, i <= j, row by row."""
    entries = dict(zip(combinations_with_replacement(range(size), 2), values, strict=True))
    return [[entries[min(i, j), max(i, j)] for j in range(size)] for i in range(size)]


def upper(a: Rows) -> list[Any]:
    """Entries above the diagonal, row by row."""
    return [a[i][j] for i, j in combinations(range(len(a)), 2)]


def kept(a: Rows) -> list[Any]:
    """Entries on and above the diagonal, row by row."""
    return [a[i][j] for i, j in combinations_with_replacement(range(len(a)), 2)]


def coefficient(L: dict[int, Rows], k: int, power: int) -> Any:
    """The coefficient of ``lambda^power`` in ``tr L^k`` for ``L = sum lambda^p L_p``."""
    size = len(L[0])
    raised = {0: diagonal([1] * size)}
    for _ in range(k):
        longer: dict[int, Rows] = {}
        for p, a in raised.items():
            for q, b in L.items():
                if p + q <= power:
                    term = product(a, b)
                    before = longer.get(p + q)
                    longer[p + q] = term if before is None else total((1, before), (1, term))
        raised = longer
    return trace(raised[power])


# -- Manakov's body: sections 2.4.2 to 2.4.5 -------------------------------------------------------

#: (k, power, number) of the coefficients of tr L^k that are emitted beside Casimirs and energy. The
#: energy is a combination of a Casimir and the n - 2 others quadratic in M, which leaves n - 3.
MANAKOV = {
    4: ((3, 1, Fraction(-1, 3)),),
    6: (
        *((3, 1, Fraction(-1, 3)), (4, 2, Fraction(-1, 4)), (5, 3, Fraction(-1, 5))),
        *((5, 1, Fraction(1, 5)), (6, 2, Fraction(1, 3))),
    ),
}


def manakov_observables(state: Vector, a: Vector) -> dict[str, Any]:
    """``-tr(M Omega)/4``, Casimirs, the Pfaffian last, Omega, integrals of ``M + lambda A^2``."""
    size, velocity = len(a), so_n_velocity(state, a)
    M = antisymmetric(state, size)
    squares = sum(m**2 for m in state)
    fourth = trace(product(product(M, M), product(M, M)))
    four = state[0] * state[5] - state[1] * state[4] + state[2] * state[3]
    casimirs = [squares, four] if size == 4 else [squares, fourth, pfaffian(M)]
    pair = {0: M, 1: diagonal([x**2 for x in a])}
    return {
        "energy": -trace(product(M, antisymmetric(velocity, size))) / 4,
        **{f"casimir{n}": value for n, value in enumerate(casimirs, 1)},
        **named("Omega", velocity, size),
        **integrals(pair, MANAKOV[size]),
    }


def named(name: str, values: Sequence[Any], size: int, least: int = 1) -> dict[str, Any]:
    """Entries of a matrix by their names; ``least`` is 0 with the diagonal."""
    places = combinations(range(1, size + 1), 2) if least else None
    chosen = places or combinations_with_replacement(range(1, size + 1), 2)
    return {f"{name}{i}{j}": x for (i, j), x in zip(chosen, values, strict=True)}


def integrals(pair: dict[int, Rows], table: Sequence[tuple[int, int, Any]]) -> dict[str, Any]:
    """``integral1``, ... by the powers of L and of lambda."""
    values = (number * coefficient(pair, k, power) for k, power, number in table)
    return {f"integral{n}": value for n, value in enumerate(values, 1)}


# -- body in a quadratic potential: section 2.5.6 --------------------------------------------------

#: As above: the energy is a combination of the coefficients (k, 2 k - 2).
QUADRATIC = {
    3: ((2, 2, Fraction(-1, 2)), (3, 2, Fraction(1, 3))),
    4: (
        *((2, 2, Fraction(-1, 2)), (3, 4, Fraction(-1, 3)), (3, 2, Fraction(1, 3))),
        *((4, 4, Fraction(1, 2)), (4, 2, Fraction(-1, 4))),
    ),
}


def quadratic_parts(state: Vector, a: Vector) -> tuple[Rows, Rows, Rows, Rows]:
    """M, S, Omega and A as matrices."""
    size = len(a)
    planes = size * (size - 1) // 2
    M, S = antisymmetric(state[:planes], size), symmetric(state[planes:], size)
    return M, S, antisymmetric(so_n_velocity(state[:planes], a), size), diagonal(list(a))


def quadratic_rates(state: Vector, parameters: Vector) -> list[Any]:
    """``dM/dt = [M, Omega] + [A, S]``, ``dS/dt = [S, Omega]``."""
    M, S, Omega, A = quadratic_parts(state, parameters)
    turned = total((1, commutator(M, Omega)), (1, commutator(A, S)))
    return upper(turned) + kept(commutator(S, Omega))


def quadratic_ad_star(size: int) -> Callable[[Vector, Vector], list[Any]]:
    """``([M, Omega] + [Y, S], [S, Omega])`` for (Omega, Y) in so(n) (s) Sym(n).

    With ``Y = dh/dS``, whose entries beside the diagonal are halved since S has them twice.
    """
    planes = size * (size - 1) // 2

    def ad_star(velocity: Vector, state: Vector) -> list[Any]:
        slopes = symmetric(velocity[planes:], size)
        Y = [
            [x if i == j else x * Fraction(1, 2) for j, x in enumerate(row)]
            for i, row in enumerate(slopes)
        ]
        Omega = antisymmetric(velocity[:planes], size)
        M, S = antisymmetric(state[:planes], size), symmetric(state[planes:], size)
        # V = tr(SA)/2 gives [A, S], so tr(SY) twice that
        turned = total((1, commutator(M, Omega)), (2, commutator(Y, S)))
        return upper(turned) + kept(commutator(S, Omega))

    return ad_star


def quadratic_observables(state: Vector, parameters: Vector) -> dict[str, Any]:
    """``-tr(M Omega)/4 + tr(SA)/2``, traces of powers of S, Omega, coefficients of the pair."""
    M, S, Omega, A = quadratic_parts(state, parameters)
    size = len(parameters)
    powers = [S]
    while len(powers) < size:
        powers.append(product(powers[-1], S))
    pair = {0: total((-1, S)), 1: M, 2: product(A, A)}
    return {
        "energy": -trace(product(M, Omega)) / 4 + trace(product(S, A)) / 2,
        **{f"casimir{n}": trace(power) for n, power in enumerate(powers, 1)},
        **named("Omega", upper(Omega), size),
        **integrals(pair, QUADRATIC[size]),
    }


# -- Bloch-Iserles: appendix C.4 -------------------------------------------------------------------


def bloch_iserles_ad_star(size: int, N: Vector) -> Callable[[Vector, Vector], list[Any]]:
    """``X Y N - N Y X`` for symmetric X, by ``tr(X [Y, Z])`` with ``[Y, Z] = Y N Z - Z N Y``."""
    fixed = antisymmetric(N, size)

    def ad_star(velocity: Vector, state: Vector) -> list[Any]:
        X = symmetric(state, size)
        # xi_12 e_12 has the entries xi_12/2: it is dual to the entry X_12
        Y = [
            [x if i == j else x * Fraction(1, 2) for j, x in enumerate(row)]
            for i, row in enumerate(symmetric(velocity, size))
        ]
        right = product(product(X, Y), fixed)
        left = product(product(fixed, Y), X)
        return kept(total((1, right), (-1, left)))

    return ad_star


def bloch_iserles_rates(size: int) -> Callable[[Vector, Vector], list[Any]]:
    """``dX/dt = X^2 N - N X^2``."""

    def rates(state: Vector, N: Vector) -> list[Any]:
        X, fixed = symmetric(state, size), antisymmetric(N, size)
        square = product(X, X)
        return kept(total((1, product(square, fixed)), (-1, product(fixed, square))))

    return rates


def bloch_iserles_observables(size: int) -> Callable[[Vector, Vector], dict[str, Any]]:
    """``tr X^2/2``, det X, ``v . X v`` with ``N v = 0``, the velocity, ``tr X``."""

    def observables(state: Vector, N: Vector) -> dict[str, Any]:
        X = symmetric(state, size)
        square = trace(product(X, X))
        # the components of the velocity V = sum xi_ij e_ij, which is X as a matrix
        places = combinations_with_replacement(range(size), 2)
        velocity = [X[i][j] if i == j else 2 * X[i][j] for i, j in places]
        if size == 2:
            return {
                "energy": square / 2,
                "casimir1": X[0][0] * X[1][1] - X[0][1] ** 2,
                **named("V", velocity, 2, 0),
            }
        a, b, c = N[2], -N[1], N[0]
        v = [a, b, c]
        minors = (
            X[1][1] * X[2][2] - X[1][2] ** 2,
            X[0][1] * X[2][2] - X[0][2] * X[1][2],
            X[0][1] * X[1][2] - X[0][2] * X[1][1],
        )
        return {
            "energy": square / 2,
            "casimir1": X[0][0] * minors[0] - X[0][1] * minors[1] + X[0][2] * minors[2],
            "casimir2": sum(v[i] * X[i][j] * v[j] for i in range(3) for j in range(3)),
            **named("V", velocity, 3, 0),
            "integral1": trace(X),
        }

    return observables


LAX_BODIES = {"manakov_so4": 4, "manakov_so6": 6}
QUADRATIC_BODIES = {"quadratic_potential_so3": 3, "quadratic_potential_so4": 4}
BLOCH_ISERLES = {"bloch_iserles_2": 2, "bloch_iserles_3": 3}
