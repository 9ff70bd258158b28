"""Rings: fields at a few points of a circle as ordinary systems, with which kernels are compared.

A ring has a matrix for the bracket and the gradient of its energy by all points, so that its motion
is derived in another way than that of the generic point.
Comes in: a `GenericPoint`. Goes out: Equations of so many points.
Read next: `coadjoint.derive.fields.grid`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property

from coadjoint.derive import assembly
from coadjoint.derive.equations import Equations
from coadjoint.derive.fields.ends import find_place, find_row, find_weight
from coadjoint.derive.fields.generic import GenericPoint
from coadjoint.derive.fields.lattice import Calculus, Lattice
from coadjoint.derive.fields.stencils import stencil
from coadjoint.derive.records import Exact, Kept
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element
from coadjoint.spec import Spec
from coadjoint.spec.core.members import member_name
from coadjoint.spec.model import Poisson, Variable, Windows


class Rings:
    """The making of rings.

    Args:
        point: The generic point.

    Attributes:
        velocities: Of each ring that was made, by its number of points, what is solved for in the
            momenta, by its name and point; empty without.
    """

    def __init__(self, point: GenericPoint) -> None:
        self.point = point
        self.spec, self.space = point.spec, point.space
        self.velocities = dict[int, dict[tuple[str, int], Element]]()

    def make(self, size: int, kept: Mapping[str, Kept]) -> Equations:
        """The ordinary system of so many points: a tensor, and the gradient of the energy."""
        variables = tuple(write_point(v, k) for v in self.spec.state for k in range(size))
        spec = replace(make_bare(self.spec, variables), family=self.declared)
        room = len(self.point.setting.field.adjoined) * size
        setting = assembly.make_setting(spec, (), room)
        field = setting.field
        inverse = self.point.find_inverse(field.number(size), field[self.space.length])
        calculus = self.point.calculus_in(field, inverse)
        names = {
            (c, k): own
            for v in self.spec.state
            for k in range(size)
            for c, own in zip(v.components, write_point(v, k).components, strict=True)
        }

        velocities = self.velocities[size] = self.point.solve(field, inverse, size, names)

        def value(name: str, i: int) -> Element:
            place = name, i % size
            return velocities[place] if place in velocities else field[names[place]]

        place = self.point.placer(calculus, value, self.point.converter(field))
        totals = {
            name: field.sum(place(density)(i) * self.weigh(i, size) for i in range(size)) / inverse
            for name, density in self.point.densities.items()
        }
        tensor = self._tensor(setting, calculus, place, names, size)
        slopes = field.gradient(totals["energy"], setting.state)
        rates = tuple(
            field.sum(p * slope for p, slope in zip(row, slopes, strict=True) if p and slope)
            for row in tensor
        )
        emitted = tuple(
            replace(
                each,
                values=tuple(totals[name] for name in each.components),
                kept=kept.get(each.name, Kept.UNKNOWN),
                form=None,
            )
            for each in self.point.equations.exact.emitted
        )
        exact = Exact(
            definitions=(),
            rates=rates,
            energy=totals["energy"],
            emitted=emitted,
            poisson_tensor=tensor,
        )
        return Equations(setting=setting, route=self.point.equations.route, exact=exact, steps=())

    def _tensor(
        self,
        setting: Setting,
        calculus: Calculus,
        place: Callable[[Element], Lattice],
        names: Mapping[tuple[str, int], str],
        size: int,
    ) -> tuple[tuple[Element, ...], ...]:
        """``{u_a(i), u_b(j)}``, with a matrix for each difference."""
        field = setting.field
        rows: dict[tuple[str, str], list[Element]] = {}
        for n, (a, entries) in enumerate(
            zip(self.point.setting.state, self.point.operator, strict=True)
        ):
            for b, entry in zip(self.point.setting.state, entries, strict=True):
                for term in entry:
                    left, right = place(term.left), place(term.right)
                    for i in range(size):
                        for j, weight in self.matrix_row(term.order, i, size, n):
                            scale = calculus.inverse ** (term.order + 1)
                            part = left(i) * right(j) * (weight / self.weigh(j, size)) * scale
                            rows.setdefault((names[a, i], names[b, j]), []).append(part)
        known = {pair: field.sum(parts) for pair, parts in rows.items()}
        return tuple(
            tuple(known.get((a, b), field.zero) for b in setting.state) for a in setting.state
        )

    def matrix_row(
        self, derivative: int, i: int, size: int, n: int
    ) -> Iterator[tuple[int, Fraction]]:
        """A row of the matrix of a difference, times the power of the spacing, for a field."""
        order = self.point.order
        row = stencil(derivative, order)
        if self.space.has_ends and derivative:
            row = find_row(order, find_place(order, i, size), meets=self.point.meets[n])
        for r, c in row.items():
            yield (i + r) % size, c

    def weigh(self, i: int, size: int) -> Fraction:
        """The weight of a point in sums."""
        order, has_ends = self.point.order, self.space.has_ends
        return find_weight(order, find_place(order, i, size)) if has_ends else Fraction(1)

    @cached_property
    def declared(self) -> Windows:
        """What is known of the points that no ring has."""
        return Windows(
            index=self.space.index,
            variables=tuple(v.name for v in self.spec.state),
            shared=tuple(p.name for p in self.spec.parameters),
            indexed=(),
            defaults={},
            repeating=(),
            reach=self.point.reach,
            alone=(0, 0),
            pairs=False,
            least=self.point.least,
            windows=(),
        )


def make_bare(spec: Spec, variables: tuple[Variable, ...]) -> Spec:
    """A spec with the variables of some points, and no formulas that lead anywhere."""
    return replace(
        spec,
        variables=variables,
        algebra=None,
        diffeomorphisms=None,
        space=None,
        profiles={},
        poisson=Poisson(kind="brackets"),
        lagrangian=None,
        hamiltonian=None,
        lax=None,
        casimirs=(),
        conserved=(),
        definitions=(),
    )


def write_point(of: Variable, place: int) -> Variable:
    """A field at one point, as a variable of its own."""
    return Variable(
        name=member_name(of.name, place),
        role="coordinate",
        shape=of.shape,
        unit=of.unit,
        doc=of.doc,
        form=of.form,
        default=of.default,
    )
