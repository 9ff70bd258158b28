r"""Torus: a field at points of a plane that closes in both directions, by truncated series.

Of :math:`N_x \times N_y` points the waves :math:`|n_x| \le K_x`, :math:`|n_y| \le K_y` with
:math:`3 K < N` are kept (:math:`\Pi` leaves the others out), and

.. math:: w_t = \Pi \{\psi, w\}, \qquad w = A \psi .

Derivatives are those of the Fourier series. Products of two fields at the points have waves up to
2K, of which those beyond N - K > 2K come back as others: none comes back among those that are kept,
so that the motion is that of the truncated series and not one of the grid (Orszag 1971). What is
computed at each point from derivatives is a family of members that do not see each other, with
these derivatives as parameters.
Comes in: Equations of a field in a plane. Goes out: a `TorusGrid`.
Read next: `coadjoint.prove.torus`.

Source:
    Orszag, Journal of the Atmospheric Sciences 28 (1971) 1074.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import sympy

from coadjoint.derive import assembly
from coadjoint.derive.equations import Equations
from coadjoint.derive.fields import circle
from coadjoint.derive.fields.jets import Jets, jets_of, solved
from coadjoint.derive.fields.profiles import check_profiles
from coadjoint.derive.fields.rings import make_bare, write_point
from coadjoint.derive.records import Exact, Kept
from coadjoint.derive.setting import fault, once
from coadjoint.derive.symbols import choose_names
from coadjoint.exact import Element, element_text
from coadjoint.families import LEAST_IN_PLANE, Family, Index, Sum, Torus, Total
from coadjoint.sizes import MOVES, check_least
from coadjoint.spec.core.members import member_name
from coadjoint.spec.model import Parameter, Windows

#: How many points the ordinary systems have with which kernels are compared.
_SIZES = (2, 3)


@dataclass(frozen=True)
class TorusGrid:
    """A field at the points of a plane.

    Attributes:
        equations: Of the field.
        exact: Of a density that is conserved, whether truncated series keep its integral.
        family: What is computed at each point.
        windows: Equations of a few points.
        declared: What is known of the other points.
        torus: What is computed around the points.
    """

    equations: Equations
    exact: Mapping[str, bool]
    family: Family
    windows: tuple[Equations, ...]
    declared: Windows
    torus: Torus


@once
def make_torus(equations: Equations) -> TorusGrid:
    """A field at the points of a plane.

    Raises:
        DerivationError: The Lagrangian has no derivatives of the stream function, or a profile has
            no value at the first point.
        KernelArgumentError: The spec declares too few points.
    """
    made, spec = _Making(equations), equations.spec
    check_profiles(equations.setting)
    for each in made.both:
        if each.size is not None:
            where = str(spec.path)
            check_least(spec.name, each.name, each.size, LEAST_IN_PLANE, MOVES, where=where)
    return TorusGrid(
        equations=equations,
        exact=made.exact,
        family=made.family,
        windows=tuple(made.make_window(n) for n in _SIZES),
        declared=made.declared,
        torus=made.torus,
    )


class _Making:
    """The making of it."""

    def __init__(self, equations: Equations) -> None:
        self.equations, self.spec, self.setting = equations, equations.spec, equations.setting
        self.jets: Jets = jets_of(self.setting)
        formula = self.spec.lagrangian
        if formula is not None and not solved(self.spec):
            message = (
                "the Lagrangian of a plane has no derivatives of the stream function; expected a "
                "sum of squares of them, as (psi_x^2 + psi_y^2)/2 for Euler's equation."
            )
            raise fault(self.setting, formula, message, formula.text)
        assert self.spec.space is not None, self.spec.name
        assert self.spec.space.across is not None, self.spec.name
        self.both = (self.spec.space, self.spec.space.across)
        self.count, self.point = choose_names(self.spec, ["N", "point"])
        sizes = [each.size for each in self.both]
        whole = None if None in sizes else (sizes[0] or 0) * (sizes[1] or 0)
        self.index = Index(name=self.point, size=whole, periodic=True, from_zero=True)

    @cached_property
    def densities(self) -> dict[str, Element]:
        """The energy and the observables, by component."""
        return dict(self.equations.exact.observables)

    @cached_property
    def derivatives(self) -> dict[str, tuple[str, int, int]]:
        """What rates and densities read next to the field itself."""
        field, read = self.setting.field, [*self.equations.exact.rates, *self.densities.values()]
        reached = frozenset[str]().union(*(field.reach(x) for x in read)) - {*self.setting.state}
        return {symbol: place for symbol, place in self.jets.places.items() if symbol in reached}

    @cached_property
    def torus(self) -> Torus:
        """What is computed around the points."""
        (m,), (u,), field = self.setting.state, solved(self.spec), self.setting.field
        operator = {place: element_text(field, x) for place, x in self._operator.items()}
        return Torus(
            coordinates=self.spec.space.coordinates if self.spec.space else (),
            lengths=tuple(each.length for each in self.both),
            sizes=tuple(each.size for each in self.both),
            derivatives=self.derivatives,
            solved={u: (m, operator)},
        )

    @property
    def _operator(self) -> Mapping[tuple[int, int], Element]:
        return circle.inertia(self.setting)

    @cached_property
    def exact(self) -> dict[str, bool]:
        """Whether truncated series keep the integral: its variation is linear in the field.

        Then the variation has no waves that are left out, and what is summed over the points, the
        variation times the rate, is of the third degree.
        """
        emitted = self.equations.exact.emitted
        return {
            each.name: all(self._is_linear(value) for value in each.values)
            for each in emitted
            if each.name == "energy" or each.kept is Kept.ALWAYS
        }

    def _is_linear(self, density: Element) -> bool:
        """Whether the variation of a density is a constant times the field and its derivatives."""
        field, jets, (m,) = self.setting.field, self.jets, self.setting.state
        slope = circle.vary(self.setting, density, m)
        parts = {x: field.derivative(slope, x) for x in field.reach(slope) & jets.places.keys()}
        constant = not any(field.reach(x) & jets.places.keys() for x in parts.values())
        whole = field.sum(x * field[symbol] for symbol, x in parts.items())
        return constant and field.is_zero(slope - whole)

    # -- points -----------------------------------------------------------------------------

    @cached_property
    def family(self) -> Family:
        """What is computed at each point."""
        field = self.setting.field
        states = tuple(map(sympy.Symbol, self.setting.state))
        area = sympy.Mul(*(sympy.Symbol(each.length) for each in self.both))
        count = sympy.Symbol(self.count)
        totals = []
        for name, density in self.densities.items():
            whole = sympy.Symbol(f"{name}_sum")
            term = field.to_sympy(density)
            totals.append(Total(name, area * whole / count, (Sum(symbol=whole, term=term),)))
        return Family(
            index=self.index,
            states=states,
            shifts=(),
            neighbours={},
            shared=tuple(map(sympy.Symbol, self.setting.parameters)),
            indexed=tuple(map(sympy.Symbol, self.derivatives)),
            partners={},
            rates=tuple(map(field.to_sympy, self.equations.exact.rates)),
            pair_sums=(),
            ends={},
            totals=tuple(totals),
            small=1,
            count=(count,),
        )

    def make_window(self, size: int) -> Equations:
        """So many points as an ordinary system."""
        own = [
            Parameter(name=member_name(symbol, k), shape=(), unit="", doc="")
            for symbol in self.derivatives
            for k in range(size)
        ]
        variables = tuple(write_point(v, k) for v in self.spec.state for k in range(size))
        bare = make_bare(self.spec, variables)
        spec = replace(bare, parameters=(*self.spec.parameters, *own), family=self.declared)
        room = len(self.setting.field.adjoined) * size
        setting = assembly.make_setting(spec, (), room)
        field, source = setting.field, self.setting.field

        def place(element: Element, k: int) -> Element:
            values = {
                name: field[member_name(name, k) if name in self.jets.places else name]
                for name in source.reach(element)
            }
            return source.evaluate(element, values, field.number, field.call)

        cell = field[self.both[0].length] * field[self.both[1].length] / size
        totals = {
            name: cell * field.sum(place(density, k) for k in range(size))
            for name, density in self.densities.items()
        }
        emitted = tuple(
            replace(
                each,
                values=tuple(totals[name] for name in each.components),
                kept=Kept.ALWAYS if self.exact.get(each.name) else Kept.UNKNOWN,
                form=None,
            )
            for each in self.equations.exact.emitted
        )
        rates = tuple(place(x, k) for x in self.equations.exact.rates for k in range(size))
        exact = Exact(
            definitions=(),
            rates=rates,
            energy=totals.get("energy"),
            emitted=emitted,
            poisson_tensor=None,
        )
        return Equations(setting=setting, route=self.equations.route, exact=exact, steps=())

    @cached_property
    def declared(self) -> Windows:
        """What is known of the points that no window has."""
        return Windows(
            index=self.index,
            variables=tuple(v.name for v in self.spec.state),
            shared=tuple(p.name for p in self.spec.parameters),
            indexed=tuple(self.derivatives),
            defaults={},
            repeating=(),
            reach=0,
            alone=(0, 0),
            pairs=False,
            least=1,
            windows=(),
        )
