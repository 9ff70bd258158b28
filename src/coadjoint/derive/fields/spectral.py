r"""Fourier derivatives: the rates of fields by derivatives along a whole circle, as texts.

Of N points the derivative :math:`\partial_s^k` is that of the trigonometric polynomial through
them: a matrix that is antisymmetric for odd k and symmetric for even k, as differences are. So the
motion is :math:`\dot u = P_D\, \delta H / \delta u` with these in the place of differences, and the
energy is kept in continuous time. What is no field itself but a product of some is computed at the
points before it is differentiated.

How rates change about constant fields is written as well, from the same texts: by each field, and
by each derivative of a field or product. From this the linear part of the motion follows wave by
wave, by which implicit methods solve what is stiff in it.
Comes in: a `GenericPoint`, whose differences are replaced. Goes out: a `Spectral`, what a run has
to compute one after the other. Read next: `coadjoint.solve.spectral`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from typing import Any

import sympy

from coadjoint.derive.fields import circle
from coadjoint.derive.fields.generic import GenericPoint, rational
from coadjoint.derive.fields.jets import solved
from coadjoint.derive.fields.lattice import Calculus, Lattice
from coadjoint.derive.symbols import choose_names
from coadjoint.exact import Element, element_text
from coadjoint.families import Spectral
from coadjoint.spec.sections.space import jet_name


def write_spectral(point: GenericPoint) -> Spectral:
    """What a run with Fourier derivatives computes at each time."""
    field, (product,) = point.setting.field, choose_names(point.spec, ["product"])
    calculus = _Transforms(
        order=point.order,
        inverse=sympy.Integer(1),
        number=rational,
        fields=point.components,
        coordinate=point.space.name,
        product=product,
    )

    def convert(element: Element, values: Mapping[str, Any]) -> Any:
        new = {sympy.Symbol(name): value for name, value in values.items()}
        return field.to_sympy(element).xreplace(new)

    place = point.placer(calculus, lambda name, _: sympy.Symbol(name), convert)
    rates = [rate(0) for rate in point.motion(calculus, place)]
    densities = {name: place(value)(0) for name, value in point.densities.items()}
    products = {name: x for x, name in calculus.products.items()}
    of_rates = dict(zip(point.setting.state, rates, strict=True))
    operator = {n: element_text(field, x) for n, x in circle.inertia_along(point.setting).items()}
    return Spectral(
        length=point.space.length,
        derivatives=calculus.derivatives,
        products={name: sympy.sstr(x) for name, x in products.items()},
        rates={name: sympy.sstr(x) for name, x in of_rates.items()},
        densities={name: sympy.sstr(x) for name, x in densities.items()},
        solved={
            u: (m, operator) for u, m in zip(solved(point.spec), point.setting.state, strict=False)
        },
        slopes=_write_slopes(products | of_rates, point.components, calculus.derivatives),
    )


def _write_slopes(
    values: Mapping[str, Any], fields: tuple[str, ...], derivatives: Mapping[str, Any]
) -> dict[str, dict[str, str]]:
    """How values change with fields and derivatives about constant fields, zeros left out.

    What has no value there, as the slope of a root of derivatives, is left out too: nothing but the
    number of sweeps rests on it.
    """
    constant = {sympy.Symbol(name): sympy.Integer(0) for name in derivatives}
    without = (sympy.nan, sympy.zoo, sympy.oo, sympy.Derivative)
    found = dict[str, dict[str, str]]()
    for name, value in values.items():
        slopes = {
            x: value.diff(sympy.Symbol(x)).xreplace(constant) for x in (*fields, *derivatives)
        }
        kept = {x: sympy.sstr(y) for x, y in slopes.items() if y != 0 and not y.has(*without)}
        found |= {name: kept} if kept else {}
    return found


@dataclass(frozen=True)
class _Transforms(Calculus):
    """Derivatives as symbols, and the products of fields that they are those of.

    Attributes:
        fields: What has a value at each point.
        coordinate: The name of the coordinate.
        product: What products are called, before their number.
        derivatives: By its symbol, the field or product, and how often it is differentiated.
        products: The name of each, by its expression; those before it have lower numbers.
    """

    fields: tuple[str, ...] = ()
    coordinate: str = ""
    product: str = ""
    derivatives: dict[str, tuple[str, int]] = dataclass_field(default_factory=dict)
    products: dict[Any, str] = dataclass_field(default_factory=dict)

    def differentiate(self, f: Lattice, derivative: int) -> Lattice:
        """``D_k f``, at the one point that there is."""
        return (lambda _: self._differentiate(f(0), derivative)) if derivative else f

    def _differentiate(self, value: Any, order: int) -> Any:
        """The derivative of an expression, term by term where factors of fields are constant."""
        value = sympy.expand(value)
        own = [u for u in map(sympy.Symbol, self.fields) if value.has(u)]
        slopes = {u: value.coeff(u) for u in own}
        rest = sympy.expand(value - sympy.Add(*(u * x for u, x in slopes.items())))
        named = rest.free_symbols.union(*(x.free_symbols for x in slopes.values()))
        if not {s.name for s in named} & {*self.fields, *self.derivatives}:
            return sympy.Add(*(x * self._take(u.name, order) for u, x in slopes.items()))
        name = self.products.setdefault(value, f"{self.product}{len(self.products) + 1}")
        return self._take(name, order)

    def _take(self, name: str, order: int) -> Any:
        """The symbol of a derivative."""
        symbol = jet_name(name, self.coordinate, order)
        self.derivatives[symbol] = name, order
        return sympy.Symbol(symbol)
