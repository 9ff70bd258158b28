r"""The directions that Hamiltonian vector fields and their commutators reach.

A function C commutes with all others if every field :math:`X_f = \{\cdot, f\}` leaves it
unchanged. Then the commutators of these fields do so too. By Frobenius' theorem there are, near
almost every point, as many independent Casimirs as the fields with all their commutators miss
directions. The Jacobi identity makes the commutators Hamiltonian, so that a Poisson bracket needs
none of them; an almost-Poisson bracket may have fewer Casimirs than its rank leaves room for.

The fields have components along (M, z), written in (eta, z), where a field X differentiates as
:math:`T^{-1} X` with :math:`T = \partial(M, z)/\partial(\eta, z)`.
Comes in: the bracket of a constrained motion. Goes out: fields that span these directions.
Read next: `coadjoint.prove.completeness`.
"""

from __future__ import annotations

from collections.abc import Sequence

from coadjoint.derive.mechanics.distribution import Row
from coadjoint.exact.dense import Matrix, apply, dot, inverse
from coadjoint.exact.ranks import independent_rows
from coadjoint.prove.almost_poisson import ReducedBracket
from coadjoint.prove.completeness import SparseRow, drop_zeros


def list_reached(bracket: ReducedBracket, known: int) -> list[SparseRow]:
    """Independent rows among the Hamiltonian fields and their iterated commutators.

    Args:
        bracket: In momenta and positions.
        known: How many independent Casimirs there are at least, which leave room for the others.
    """
    enough = len(bracket.names) - known
    back = inverse(bracket.turn)
    first = _select(bracket, bracket.tensor)
    whole = newest = first
    while newest and len(whole) < enough:
        turned = [_commute(bracket, back, X, Y) for X in first for Y in newest if X is not Y]
        newest = _select(bracket, [*whole, *turned])[len(whole) :]
        whole = [*whole, *newest]
    return list(map(drop_zeros, whole))


def _commute(bracket: ReducedBracket, back: Matrix, X: Row, Y: Row) -> Row:
    """``X(Y) - Y(X)``, component by component."""
    field, names = bracket.field, bracket.names
    along_X, along_Y = apply(back, X), apply(back, Y)
    return tuple(
        dot(along_X, field.gradient(y, names)) - dot(along_Y, field.gradient(x, names))
        for x, y in zip(X, Y, strict=True)
    )


def _select(bracket: ReducedBracket, fields: Sequence[Row]) -> list[Row]:
    """The fields that are independent of those before them at almost every point."""
    places = independent_rows(bracket.field, list(map(drop_zeros, fields)))
    return [fields[place] for place in places]
