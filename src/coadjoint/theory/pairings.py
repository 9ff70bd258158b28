"""Trace pairings: covectors as matrices, by the pairing that a text states.

Comes in: an algebra of matrices, a trace form, and the space in which the matrices of covectors
live. Goes out: the way from components ``mu_i = <mu, e_i>`` to such a matrix and back. A form that
is degenerate on that space is refused. Read next: `coadjoint.theory.actions`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from fractions import Fraction
from typing import Any

from coadjoint.algebra import LieAlgebra
from coadjoint.algebra import matrices as sparse
from coadjoint.errors import AlgebraError
from coadjoint.exact.dense import Matrix, weighted_sum
from coadjoint.exact.linear import Span, nullspace

#: Whether the form transposes mu, and the number in front of the trace.
FORMS = {
    "tr(mu xi)": (False, Fraction(1)),
    "tr(mu^T xi)": (True, Fraction(1)),
    "tr(mu^T xi)/2": (True, Fraction(1, 2)),
}


@dataclass(frozen=True)
class TracePairing:
    """``<mu, xi>`` as a trace; make one by `trace_pairing`.

    Attributes:
        algebra: Where xi lives.
        form: A key of `FORMS`.
        dual_basis: Matrices ``d_i`` with ``<d_i, e_j> = delta_ij``.
    """

    algebra: LieAlgebra
    form: str
    dual_basis: tuple[sparse.SparseMatrix, ...]

    def matrix(self, mu: Sequence[Any]) -> Matrix:
        """The matrix of a covector, ``mu_i d_i``."""
        return weighted_sum(mu, self.dual_basis, sparse.size(self.algebra.matrices))

    def components(self, matrix: Matrix) -> tuple[Any, ...]:
        """``mu_i = <matrix, e_i>``."""
        transposed, factor = FORMS[self.form]
        return tuple(
            sum(
                (matrix[r][c] if transposed else matrix[c][r]) * value * factor
                for (r, c), value in basis_matrix.items()
            )
            for basis_matrix in self.algebra.matrices
        )


def trace_pairing(algebra: LieAlgebra, form: str, space: str = "algebra") -> TracePairing:
    """The pairing of an algebra with matrices of covectors.

    Args:
        algebra: An algebra with matrices.
        form: ``tr(mu xi)``, ``tr(mu^T xi)`` or ``tr(mu^T xi)/2``.
        space: ``algebra`` if the matrices of covectors are those of the algebra, ``transposed`` if
            they are the transposes, as in Holm (2011), section 4.3.3.

    Raises:
        AlgebraError: The form is unknown, or some vector of the algebra pairs to zero with every
            covector; the message names that vector.

    >>> from coadjoint.algebra import algebra_by_name
    >>> trace_pairing(algebra_by_name("so(3)"), "tr(mu^T xi)/2").matrix([1, 2, 3])[0][1]
    -3
    """
    _check_known(form, list(FORMS))
    _check_known(space, ["algebra", "transposed"])
    transposed, factor = FORMS[form]
    covectors = [sparse.transpose(m) if space == "transposed" else m for m in algebra.matrices]
    gram = [
        {
            i: factor * sparse.pair(d if transposed else sparse.transpose(d), e)
            for i, e in enumerate(algebra.matrices)
        }
        for d in covectors
    ]  # gram[j][i] = <d_j, e_i>
    span = Span(gram)
    if span.dependent:
        _refuse(algebra, form, space, gram)
    weights = [span.coordinates({i: 1}) or {} for i in range(algebra.dimension)]
    dual = [sparse.combination((w, covectors[j]) for j, w in row.items()) for row in weights]
    return TracePairing(algebra, form, tuple(dual))


def _check_known(word: str, known: Sequence[str]) -> None:
    """Refuse a word that is not one of those known."""
    if word in known:
        return
    near = get_close_matches(word, known, n=1)
    raise AlgebraError(
        f"{word!r} is not a trace pairing; expected one of {', '.join(known)}."
        + (f" Did you mean {near[0]!r}?" if near else ""),
        found=word,
    )


def _refuse(algebra: LieAlgebra, form: str, space: str, gram: Sequence[dict[int, Any]]) -> None:
    """Name a vector that pairs to zero with everything."""
    xi = nullspace(gram, algebra.dimension)[0]
    vector = " + ".join(
        algebra.basis[i] if value == 1 else f"({value}) {algebra.basis[i]}"
        for i, value in sorted(xi.items())
    )
    where = "mu in the algebra" if space == "algebra" else "mu in the transposed algebra"
    raise AlgebraError(
        f"{algebra.name}: the pairing {form} with {where} is degenerate: xi = {vector} gives 0 for "
        "every mu; expected a pairing in which only xi = 0 does. Pair by tr(mu^T xi), or take mu "
        "in the transposed algebra.",
        algebra=algebra.name,
        form=form,
        vector=vector,
    )
