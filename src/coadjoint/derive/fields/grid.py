r"""Grids: fields at N points of the circle, by central differences, as a family of equal members.

With the spacing h = L/N the energy is :math:`H = h \sum_i e_i`, derivatives in the density e being
differences. The bracket is that of the fields with a difference :math:`D_k` for each
:math:`\partial_s^k`, so that

.. math:: \dot u_i = \Big(P_D \frac{\delta e}{\delta u}\Big)_i, \qquad
    \frac{\delta e}{\delta u} = \sum_k (-1)^k D_k \frac{\partial e}{\partial u_k}.

The second formula is the gradient of H over h, since :math:`D_k^T = (-1)^k D_k` on a circle, and
:math:`P_D` is antisymmetric if the terms of P are those of minus its adjoint: then H is kept
exactly by the motion in continuous time. Products of two derivatives with a constant factor are
summed by parts first, :math:`u_j v_k \to (-1)^j u v_{j+k}`, since one difference of order j + k
reads fewer points than two.

The motion is derived twice. That of the generic point, from which kernels are made, applies
differences to expressions. Rings of a few points have a matrix for the bracket and the gradient of
H by all points, and are the ordinary systems with which kernels are compared.
Comes in: Equations of fields. Goes out: a `Grid`.
Read next: `coadjoint.prove.grids`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from coadjoint.derive.equations import Equations
from coadjoint.derive.fields.generic import GenericPoint
from coadjoint.derive.fields.lattice import LatticeField
from coadjoint.derive.fields.profiles import check_profiles
from coadjoint.derive.fields.rings import Rings
from coadjoint.derive.fields.spectral import write_spectral
from coadjoint.derive.fields.sums import explain_change, find_bracket_defects, find_sum_defects
from coadjoint.derive.records import Kept
from coadjoint.derive.setting import once
from coadjoint.exact import Element
from coadjoint.families import Family, Spectral
from coadjoint.sizes import check_least
from coadjoint.spec.model import Windows


@dataclass(frozen=True)
class Grid:
    """Fields at the points of a grid.

    Attributes:
        equations: Of the fields.
        count: The name of N in formulas.
        family: The motion of the generic point.
        windows: Equations of two small rings of points.
        declared: What is known of the other points.
        rates: Rates of the generic point in a field that has symbols for its neighbours.
        lattice: That field, and the symbols.
        momenta: Where A u = m, the momentum at the generic point in the velocities around it, by
            its name; empty without.
        velocities: Likewise, of each ring by its number of points what is solved for in the
            momenta, by its name and point; empty without.
        ends: In that field, rates of points near ends by their numbers; empty on a circle.
        spectral: What is computed where derivatives are those of Fourier series; None with ends.
        defects: In the field of the lattice, what vanishes if the bracket is antisymmetric for all
            derivatives that sum by parts, those of Fourier series among them.
        sums: Likewise, of each conserved density by its name what vanishes if these derivatives
            keep its sum; nothing of one of which that is not asked.
        changes: Why a sum that the fields conserve is not said to be kept by differences, by name.
        brackets: In this field, of two fields and how many points further the second one is, the
            bracket of both times the spacing.
    """

    equations: Equations
    count: str
    family: Family
    windows: tuple[Equations, ...]
    declared: Windows
    rates: tuple[Element, ...]
    lattice: LatticeField
    brackets: Mapping[tuple[str, str, int], Element]
    momenta: Mapping[str, Element]
    velocities: Mapping[int, Mapping[tuple[str, int], Element]]
    ends: Mapping[int, tuple[Element, ...]]
    spectral: Spectral | None
    defects: tuple[Element, ...]
    sums: Mapping[str, Sequence[Element]]
    changes: Mapping[str, str]


@once
def make_grid(equations: Equations) -> Grid:
    """The motion of fields at the points of a grid.

    Raises:
        KernelArgumentError: The spec declares too few points for the differences.
        DerivationError: A profile has no value at the first point.
    """
    point, spec = GenericPoint(equations), equations.spec
    check_profiles(equations.setting)
    if point.space.size is not None:
        where = str(spec.path)
        check_least(spec.name, point.space.name, point.space.size, point.least, where=where)
    rings = Rings(point)
    kept = {each.name: each.kept for each in equations.exact.emitted}
    always = [name for name, value in kept.items() if value is Kept.ALWAYS]
    changes = {name: why for name in always if (why := explain_change(point, name))}
    kept |= dict.fromkeys(changes, Kept.UNKNOWN)
    # where A u = m the operator may be wider than the rates
    size = max(point.least, 0 if point.space.has_ends else 2 * point.reach + 1)
    windows = tuple(rings.make(n, kept) for n in (size, size + 1))
    rates, _ = point.exact_point
    return Grid(
        equations=equations,
        count=point.count,
        family=point.family,
        windows=windows,
        declared=rings.declared,
        rates=tuple(rates),
        lattice=point.lattice,
        brackets=point.brackets,
        momenta=point.momenta,
        velocities=rings.velocities,
        ends=point.exact_ends,
        spectral=None if point.space.has_ends else write_spectral(point),
        defects=tuple(find_bracket_defects(point)),
        sums={} if point.space.has_ends else _list_sums(point),
        changes=changes,
    )


def _list_sums(point: GenericPoint) -> dict[str, Sequence[Element]]:
    """As `Grid.sums`."""
    found = dict[str, Sequence[Element]]()
    for each in point.equations.exact.emitted:
        if each.kept is Kept.ALWAYS:
            defects = find_sum_defects(point, each.components)
            found |= {} if defects is None else {each.name: defects}
    return found
