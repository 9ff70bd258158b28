r"""Scales of the state: products of velocities in the place of products of momenta.

Comes in: Equations. Goes out: what each component of the state is multiplied by to be a velocity,
:math:`\partial^2 H/\partial x^2`, where that depends on parameters alone. Lowering tries the
rates in both forms. Of a body on so(n), :math:`M = A\Omega + \Omega A`, each rate has n - 2
coefficients in products of M, and one in products of velocities:
:math:`\dot M_{ij} = (a_i - a_j) (\Omega^2)_{ij}`.
Read next: `coadjoint.lower.lowering`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from coadjoint.derive import Equations
from coadjoint.exact import Element
from coadjoint.lower.products import Product
from coadjoint.lower.program import Program


def find_scales(equations: Equations) -> dict[str, Element]:
    """The scale of each component of the state that has one."""
    energy, field = equations.exact.energy, equations.setting.field
    scales: dict[str, Element] = {}
    if energy is None or equations.exact.solves:
        return scales
    try:
        closed = equations.close(energy)
    except OverflowError:  # functions of other arguments, for which the field has no room
        return scales
    for name in equations.setting.state:
        scale = field.derivative(field.derivative(closed, name), name)
        if scale != 0 and not field.reach(scale) & equations.moving:
            scales[name] = scale
    return scales


class Scales:
    """Products of the state rewritten over scaled components.

    Args:
        scales: By component of the state.
    """

    def __init__(self, scales: Mapping[str, Element]) -> None:
        self._scales = {f"{name}'": scale for name, scale in scales.items()}

    def __contains__(self, name: str) -> bool:
        return name in self._scales

    def take(self, name: str) -> tuple[Element, str]:
        """The scale and the component that the name of a scaled one stands for."""
        return self._scales[name], name[:-1]

    def rewrite(
        self, coefficients: dict[Product, Element], mark: Any
    ) -> dict[Product, Element] | None:
        """A sum of products over scaled components, if its coefficients are fewer then.

        Args:
            coefficients: By product.
            mark: Something hashable that tells values apart.
        """
        rewritten: dict[Product, Element] = {}
        for product, part in coefficients.items():
            names = tuple(f"{name}'" for name in product)
            if not names or not all(name in self for name in names):
                return None
            for name in names:
                part = part / self._scales[name]
            rewritten[names] = part
        before, after = (
            {frozenset((mark(each), mark(-each))) for each in of.values()}
            for of in (coefficients, rewritten)
        )
        return rewritten if len(after) < len(before) else None


def cost(program: Program) -> int:
    """Operations of a Program for each member."""
    return sum(program.operation_counts().values())
