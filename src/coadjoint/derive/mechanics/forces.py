"""Forces: the accelerations that a declared law of Newton gives.

Comes in: a Setting whose spec has [newton]. Goes out: ``M^-1 F`` by component, to be used by every
route that starts from forces. Read next: `coadjoint.derive.routes.newton`,
`coadjoint.derive.routes.alignment`.
"""

from __future__ import annotations

from collections.abc import Sequence

from coadjoint.derive.mechanics.configuration import inverse_in_blocks
from coadjoint.derive.setting import Setting, fault, once
from coadjoint.derive.symmetries import evaluate_components
from coadjoint.errors import DerivationError
from coadjoint.exact import Element
from coadjoint.exact.dense import apply
from coadjoint.spec.model import Force


@once
def accelerations(setting: Setting) -> tuple[Element, ...]:
    """``M^-1 F`` of every coordinate, in the order of the velocities.

    Raises:
        DerivationError: A mass is zero, or a matrix of masses cannot be inverted.
    """
    laws = {law.coordinate: law for law in setting.spec.newton}
    coordinates = setting.spec.having_role("coordinate")
    return tuple(a for q in coordinates for a in _acceleration(setting, laws[q.name]))


def _acceleration(setting: Setting, law: Force) -> tuple[Element, ...]:
    """The acceleration of one coordinate; of a matrix, its rows one after the other."""
    field = setting.field
    mass = setting.value(law.mass)
    force = tuple(evaluate_components(setting, {law.coordinate: law.force}).values())

    def refuse(problem: str, places: Sequence[int]) -> DerivationError:
        message = f"the mass {law.mass.in_one_line} {problem}; expected one of every component"
        return fault(setting, law.mass, message + f" of {law.coordinate}.", law.mass.text)

    rows = mass if isinstance(mass, tuple) else ((mass,),)
    inverse = inverse_in_blocks(field, rows, refuse)
    if not isinstance(mass, tuple):
        return tuple(inverse[0][0] * component for component in force)
    columns = len(force) // len(mass)  # 1, or those of a matrix with one row for each particle
    moved = [apply(inverse, force[k::columns]) for k in range(columns)]
    return tuple(moved[k][row] for row in range(len(mass)) for k in range(columns))
