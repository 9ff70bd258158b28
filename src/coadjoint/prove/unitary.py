r"""What holds of the dual of u(N), and of waves on the torus, for every number of rows N.

An element of u(N) is a real matrix X by its entries (`coadjoint.algebra.families.entries`).
Permutations of rows and columns permute the entries and are automorphisms, and a bracket of
entries has no other rows than these. So

* the coadjoint motion by any h is :math:`\dot W = [W, V]`, V = dh/dW, for every N if it is for 4
  rows, which two entries have at most;
* the bracket satisfies the Jacobi identity for every N if it does for 6 rows, which three have.

Every :math:`\mathrm{tr}\, W^k` is a Casimir then, as its rate by any V is
:math:`k\, \mathrm{tr}(W^{k-1} [W, V])`, in which factors go round. There are no others: at
:math:`W = \mathrm{i}\, \mathrm{diag}(w_1, \dots, w_N)` the entry (j, k) of the rates is a multiple
of :math:`w_j - w_k` by one entry of V, so that for different w the bracket has the rank
:math:`N^2 - N`; and gradients of the N traces are powers of w on the diagonal, independent by
Vandermonde's determinant. Both ranks are no less at almost every point.

Of waves :math:`T_k` (`coadjoint.algebra.waves`) the product is a wave by an identity of phases,

.. math:: T_m T_n = e^{-2 \pi \mathrm{i}\, m \times n/N}\, T_{m+n},

which is polynomial in the numbers of waves and of the row; N only divides it.

Comes in: what a spec calls the number of rows, and which ones it has. Goes out: claims.
Read next: `coadjoint.prove.truncated`.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from time import perf_counter

from coadjoint.algebra.catalogue import algebra_by_name
from coadjoint.derive.truncated import commute_entries
from coadjoint.exact import Element, Field
from coadjoint.prove.certificate import Claim, Verdict
from coadjoint.prove.zero import CONSTANTS, Decision, decide_zero, make_entry

#: Rows that two entries have at most, and that three have.
ROWS_OF_TWO, ROWS_OF_THREE = 4, 6


class Entries:
    """Matrices of as many rows as two entries have, W and V, by symbols for their entries.

    Args:
        invariance: On which side the motion is invariant.
    """

    def __init__(self, invariance: str) -> None:
        n = self.rows = ROWS_OF_TWO
        places = list(product(range(n), repeat=2))
        names = {letter: [f"{letter}{i}{j}" for i, j in places] for letter in "WV"}
        self.field = Field([*names["W"], *names["V"]])
        self.W, self.V = (tuple(self.field[x] for x in names[letter]) for letter in "WV")
        self.invariance = invariance

    def by_constants(self) -> tuple[Element, ...]:
        """The coadjoint motion by the structure constants."""
        rates = algebra_by_name(f"entries({self.rows})").ad_star(self.V, self.W)
        return tuple(rates) if self.invariance == "left" else tuple(-rate for rate in rates)

    def by_products(self) -> tuple[Element, ...]:
        """The entries of [W, V]."""
        return commute_entries(self.field, self.W, self.V)

    def at_diagonal(self) -> Iterator[Element]:
        """Rates at a diagonal W, less ``(w_k - w_j) V_kj``."""
        n, field = self.rows, self.field
        apart = {
            str(self.W[i * n + j]): field.zero for i, j in product(range(n), repeat=2) if i != j
        }
        rates = self.by_products()
        for j, k in product(range(n), repeat=2):
            gap = self.W[k * n + k] - self.W[j * n + j]
            yield field.substitute(rates[j * n + k], apart) - gap * self.V[k * n + j]


def list_claims(invariance: str, scope: str, rows: str) -> list[Claim]:
    """Of the bracket of u(N) and its Casimirs.

    Args:
        invariance: On which side the motion is invariant.
        scope: For which numbers of rows, in words.
        rows: What the spec calls their number.
    """
    matrices, start = Entries(invariance), perf_counter()
    pairs = zip(matrices.by_constants(), matrices.by_products(), strict=True)
    same = decide_zero([a - b for a, b in pairs], matrices.field)
    claims = [
        _enter(
            f"the motion by any h is the commutator [W, V] of matrices, V = dh/dW, {scope}",
            "equivalence",
            _add(same, f"for {ROWS_OF_TWO} rows, which two entries have at most"),
            start,
        )
    ]
    start = perf_counter()
    violation = algebra_by_name(f"entries({ROWS_OF_THREE})").jacobi_violation()
    verdict = Verdict.PROVED if violation is None else Verdict.REFUTED
    jacobi = Decision(verdict=verdict, method=CONSTANTS)
    claims.append(
        _enter(
            f"the bracket of u({rows}) satisfies the Jacobi identity, {scope}",
            "jacobi",
            _add(jacobi, f"for {ROWS_OF_THREE} rows, which three entries have at most"),
            start,
        )
    )
    if same.verdict is not Verdict.PROVED:
        return claims
    claims.append(
        Claim(
            statement=f"tr W^k is a Casimir, k = 1 to {rows}, {scope}",
            kind="casimir",
            verdict=Verdict.PROVED,
            method="its rate by any V is k tr(W^(k-1) [W, V]), in which factors go round",
        )
    )
    start = perf_counter()
    diagonal = decide_zero(list(matrices.at_diagonal()), matrices.field)
    claims.append(
        _enter(
            f"every Casimir is a function of these {rows}, near almost every point, {scope}",
            "casimir",
            _add(
                diagonal,
                f"at i diag(w) rates are w_j - w_k times entries of V, of the rank {rows}^2 - "
                f"{rows} for different w, where gradients of the traces are powers of w",
            ),
            start,
        )
    )
    return claims


def find_phases(sign: int = 1) -> tuple[Field, Element]:
    """How far the phase of ``T_m T_n`` is from that of ``T_(m+n)`` less ``m x n``, times a sign.

    In turns over N: the entry in row i of T_m is ``exp(2 pi i m1 (i + j)/N)`` for j = i + m2.
    """
    field = Field(["i", "m1", "m2", "n1", "n2"])
    i, m1, m2, n1, n2 = (field[name] for name in ("i", "m1", "m2", "n1", "n2"))
    j, ahead = i + m2, i + m2 + n2
    of_product = m1 * (i + j) + n1 * (j + ahead)
    return field, of_product - (m1 + n1) * (i + ahead) + sign * (m1 * n2 - m2 * n1)


def claim_sine_bracket(scope: str, rows: str) -> Claim:
    """The commutator of waves."""
    start = perf_counter()
    field, defect = find_phases()
    statement = f"[T_m, T_n] = -2 i sin(2 pi*(m x n)/{rows}) T_(m + n), {scope}"
    decision = decide_zero([defect], field)
    how = "T_m T_n and T_n T_m are T_(m + n) but for phases of minus and plus m x n turns over "
    return _enter(statement, "bracket", _add(decision, f"{how}{rows}"), start)


def _add(decision: Decision, reason: str) -> Decision:
    """A decision with what makes it one about every number of rows."""
    return Decision(
        verdict=decision.verdict,
        method=f"{decision.method}, {reason}",
        point=decision.point,
        defect=decision.defect,
    )


def _enter(statement: str, kind: str, decision: Decision, start: float) -> Claim:
    claim = make_entry(statement, kind, decision, perf_counter() - start)
    assert isinstance(claim, Claim), claim
    return claim
