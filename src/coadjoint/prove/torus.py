"""Claims about a field in a plane at points: what truncated Fourier series keep, and what not.

With the waves up to K of N > 3 K points along each coordinate, a sum over the points of a product
of three fields is its integral. The rate of an integral F is the integral of dF/dw times the rate
of w, from which the waves beyond K are left out. Where dF/dw has none of these, as of a quadratic
F, leaving them out changes nothing, and F is kept as it is by the field itself.
Comes in: a `TorusGrid`. Goes out: statements.
Read next: `coadjoint.prove.fields`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from coadjoint.derive.fields.torus import TorusGrid
from coadjoint.exact import Element
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.zero import Decision, Discovery, Examined

#: A wave: its numbers along both coordinates.
Wave = tuple[int, int]
#: Up to which K waves are counted.
COUNTED = 8
#: Where the numbers of points stand in statements.
_WHERE = "with the waves up to K along each coordinate of N > 3 K points"


def about_torus(
    grid: TorusGrid, decide: Callable[[Sequence[Element]], Decision]
) -> Iterator[Examined]:
    """What is proved of a field at the points of a plane.

    Args:
        grid: The field.
        decide: Whether the field itself conserves the integrals of densities.
    """
    densities = {each.name: each.values for each in grid.equations.exact.emitted}
    yield (
        "products of two fields at the points have the truncated series of these products, "
        f"{_WHERE}",
        "equivalence",
        _decide_aliases,
    )
    for name, exact in grid.exact.items():
        what = "the energy" if name == "energy" else name
        if exact:
            found = partial(_decide_projection, decide, densities[name])
            yield f"{what} is conserved, {_WHERE}", "conserved", found
            continue
        method = "its variation by the field is not linear, so that it has waves that are left out"
        statement = f"{name} may change by the waves that are left out, {_WHERE}"
        yield statement, "conserved", partial(Discovery, method, "of truncated series")
    waves = ((2, 0), (1, 1), (-2, 0))
    defect = find_defect(waves, most=2)
    assert defect, "a cyclic sum that is not zero"
    yield (
        f"the Jacobi identity of the bracket fails, {_WHERE}",
        "jacobi",
        lambda: Discovery(
            f"the cyclic sum of the waves {', '.join(map(str, waves))} with K = 2 is {defect} and "
            "not 0, since a wave beyond K is left out of it",
            "for K = 2",
        ),
    )


def _decide_aliases() -> Decision:
    """A wave n of a product, abs(n) <= 2 K, comes back as n - N or n + N, which is beyond K."""
    for K in range(1, COUNTED + 1):
        assert not find_aliases(3 * K + 1, K), K
        assert find_aliases(3 * K, K), K
    method = (
        "waves n with abs(n) <= 2 K come back as n - N or n + N, and N - 2 K > K; all were counted "
        f"for K up to {COUNTED} and N = 3 K + 1, and some come back with N = 3 K"
    )
    return Decision(verdict=Verdict.PROVED, method=method)


def find_aliases(N: int, K: int) -> list[int]:
    """The waves of products of two waves up to K that N points show as others up to K.

    >>> find_aliases(7, 2), find_aliases(6, 2)
    ([], [-4, 4])
    """
    waves = range(-2 * K, 2 * K + 1)
    return [n for n in waves for m in range(-K, K + 1) if n != m and (n - m) % N == 0]


def _decide_projection(
    decide: Callable[[Sequence[Element]], Decision], densities: Sequence[Element]
) -> Decision:
    """What `TorusGrid.exact` says, where the field itself keeps the integrals."""
    decision = decide(densities)
    if decision.verdict is not Verdict.PROVED:
        return decision
    method = (
        "its variation is linear in the field, so that it has no waves that are left out, and "
        "times the rate it is of the third degree, of which sums over N > 3 K points are "
        "integrals; these are 0 by the flux above"
    )
    return Decision(verdict=Verdict.PROVED, method=method)


def find_defect(waves: tuple[Wave, Wave, Wave], most: int) -> int:
    """The cyclic sum of ``{{w_k, w_q}, w_m}``, ``{w_k, w_q} = (k x q) w_(k + q)`` of waves up to K.

    >>> find_defect(((2, 0), (1, 1), (-2, 0)), most=2) != 0
    True
    >>> find_defect(((2, 0), (1, 1), (-2, 0)), most=3)
    0
    """
    total = 0
    for k, q, m in (waves[n:] + waves[:n] for n in range(3)):
        both = k[0] + q[0], k[1] + q[1]
        if max(map(abs, both)) <= most:
            total += _cross(k, q) * _cross(both, m)
    return total


def _cross(k: Wave, q: Wave) -> int:
    return k[0] * q[1] - k[1] * q[0]
