r"""Reconstruction: the momentum as seen from space, where the state has the attitude.

Theorem (Holm 2011, proposition 4.2.2): along a left-invariant motion :math:`\dot g = g \xi`

.. math::
    \frac{d}{dt} \mathrm{Ad}^*_{g^{-1}} \mu
        = \mathrm{Ad}^*_{g^{-1}} (\dot\mu - \mathrm{ad}^*_\xi \mu),

so that :math:`\mathrm{Ad}^*_{g^{-1}} \mu` is conserved where no torque acts; along a
right-invariant one :math:`\mathrm{Ad}^*_g \mu` is. Its components are
:math:`\langle \mu, g^{-1} e_i g \rangle`: products of matrices or of quaternions.
Comes in: a Setting with an attitude among its advected quantities. Goes out: these components.
Read next: `coadjoint.derive.emitted`.
"""

from __future__ import annotations

from collections.abc import Sequence

from coadjoint.algebra import LieAlgebra
from coadjoint.algebra.attitudes import has_fixed_row, turning_places
from coadjoint.algebra.catalogue import inverse_by
from coadjoint.algebra.matrices import size
from coadjoint.derive.records import Relation
from coadjoint.derive.setting import Setting, once
from coadjoint.exact import Element
from coadjoint.exact.dense import Matrix, apply, inverse, product, scale, transpose
from coadjoint.exact.linear import Span
from coadjoint.groups.quaternions import Quaternion


@once
def spatial_momentum(setting: Setting) -> tuple[Element, ...]:
    """``Ad*_{g^-1} mu`` along the basis; ``Ad*_g mu`` if the motion is right-invariant."""
    attitude = setting.spec.attitude
    assert attitude is not None, "asked for only where there is an attitude"
    g = setting.elements(attitude.components)
    mu = setting.elements(setting.momenta)
    if attitude.form == "quaternion":
        places = turning_places(setting.algebra)
        assert places is not None, "quaternions turn along the rotations"
        turned = _turn(setting, Quaternion(*g), [mu[place] for place in places])
        along = dict(zip(places, turned, strict=True))
        return tuple(along.get(place, m) for place, m in enumerate(mu))
    matrix = _complete(setting, g)
    outer, inner = inverse_of(setting.algebra, matrix), matrix
    if setting.sign == -1:
        outer, inner = inner, outer
    coordinates = _coordinates(setting.algebra)
    components = []
    for X in setting.algebra.matrices:
        dense = tuple(
            tuple(setting.field.zero + X.get((i, j), 0) for j in range(len(matrix)))
            for i in range(len(matrix))
        )
        seen = product(product(outer, dense), inner)
        parts = [
            m * w * seen[i][j] for m, row in zip(mu, coordinates, strict=True) for i, j, w in row
        ]
        components.append(setting.field.sum(parts))
    return tuple(components)


def _turn(setting: Setting, q: Quaternion, mu: Sequence[Element]) -> tuple[Element, ...]:
    """``q mu q*``, or ``q* mu q``, which differ from the inverse by the length of q alone."""
    outer, inner = (q, q.conjugate) if setting.sign == 1 else (q.conjugate, q)
    return setting.field.vector((outer * Quaternion.pure(mu) * inner).vector)


def _complete(setting: Setting, entries: Sequence[Element]) -> Matrix:
    """The attitude as a square matrix, its last row (0, ..., 0, 1) where that is fixed."""
    algebra, field = setting.algebra, setting.field
    n = size(algebra.matrices)
    rows = [tuple(entries[i : i + n]) for i in range(0, len(entries), n)]
    if has_fixed_row(algebra):
        rows = [*rows[: n - 1], (*(field.zero for _ in range(n - 1)), field.one)]
    return tuple(rows)


def fixed_row(setting: Setting) -> tuple[Relation, ...]:
    """What vanishes where the last row is (0, ..., 0, 1), if the state holds that row."""
    attitude = setting.spec.attitude
    assert attitude is not None, "asked for only where there is an attitude"
    if attitude.form == "quaternion" or setting.sign == 1 or not has_fixed_row(setting.algebra):
        return ()
    last = attitude.components[-size(setting.algebra.matrices) :]
    zeros = [Relation(f"{name} = 0", setting.field[name]) for name in last[:-1]]
    return (*zeros, Relation(f"{last[-1]} = 1", setting.field[last[-1]] - 1))


def inverse_of(algebra: LieAlgebra, g: Matrix) -> Matrix:
    """The inverse of an attitude: ``R^T``, ``[R^T | -R^T x]``, or by cofactors."""
    match inverse_by(algebra):
        case "transpose":
            return transpose(g)
        case "motion":
            turn = transpose(tuple(row[:-1] for row in g[:-1]))
            shift = scale(-1, apply(turn, tuple(row[-1] for row in g[:-1])))
            return (*((*row, x) for row, x in zip(turn, shift, strict=True)), g[-1])
    return inverse(g)


def _coordinates(algebra: LieAlgebra) -> list[list[tuple[int, int, object]]]:
    """For each basis vector, entries of a matrix and weights that give its coefficient."""
    by_place: dict[tuple[int, int], dict[int, object]] = {}
    for k, X in enumerate(algebra.matrices):
        for place, value in X.items():
            by_place.setdefault(place, {})[k] = value
    places = sorted(by_place)
    span = Span(by_place[place] for place in places)
    rows = []
    for k in range(algebra.dimension):
        weights = span.coordinates({k: 1})
        assert weights is not None, "the matrices are a basis"
        rows.append([(*places[n], weight) for n, weight in weights.items()])
    return rows
