r"""Configuration spaces: what the routes on coordinates q and velocities v share.

A Lagrangian l(q, v) has momenta :math:`p = \partial l / \partial v`, a mass matrix
:math:`M = \partial^2 l / \partial v^2` and the energy :math:`E = p \cdot v - l`.
Comes in: a Setting without an algebra. Goes out: these pieces, and inverses block by block. No
route's result is used here.
Read next: `coadjoint.derive.routes.euler_lagrange`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from coadjoint.derive.mechanics.legendre import LARGEST_BLOCK, Matrix, coupled_blocks
from coadjoint.derive.setting import Setting
from coadjoint.errors import DerivationError
from coadjoint.exact import Element, Field
from coadjoint.exact.dense import apply, determinant, dot, inverse
from coadjoint.exact.regular import witness_regular
from coadjoint.spec import Formula

#: What cannot be inverted and which places it concerns, as an error to raise.
Refuse = Callable[[str, Sequence[int]], DerivationError]


@dataclass(frozen=True)
class Mechanics:
    """A Lagrangian on coordinates with its derivatives.

    Attributes:
        setting: The spec and its field.
        formula: What was declared, for messages.
        lagrangian: l(q, v).
    """

    setting: Setting
    formula: Formula
    lagrangian: Element

    @cached_property
    def momenta(self) -> tuple[Element, ...]:
        """``dl/dv_i``."""
        return self.setting.field.gradient(self.lagrangian, self.setting.velocities)

    @cached_property
    def mass(self) -> Matrix:
        """``M_ij = d2l/dv_i dv_j``."""
        field, names = self.setting.field, self.setting.velocities
        return tuple(field.gradient(momentum, names) for momentum in self.momenta)

    @cached_property
    def mixed(self) -> Matrix:
        """``d2l/dv_i dq_j``."""
        field, names = self.setting.field, self.setting.positions
        return tuple(field.gradient(momentum, names) for momentum in self.momenta)

    @cached_property
    def slopes(self) -> tuple[Element, ...]:
        """``dl/dq_i``."""
        return self.setting.field.gradient(self.lagrangian, self.setting.positions)

    @cached_property
    def energy(self) -> Element:
        """``E = v . dl/dv - l``."""
        velocities = self.setting.elements(self.setting.velocities)
        return dot(self.momenta, velocities) - self.lagrangian

    @cached_property
    def inverse_mass(self) -> Matrix:
        """``M^-1``.

        Raises:
            DerivationError: M is singular, or couples too many velocities to be written out.
        """
        return inverse_in_blocks(self.setting.field, self.mass, self.refusal)

    def refusal(self, problem: str, places: Sequence[int]) -> DerivationError:
        """Why velocities cannot be solved for."""
        names = [self.setting.velocities[i] for i in places]
        if problem == SINGULAR:
            problem += "; expected every velocity in the kinetic energy"
            remedy = f"Add the missing kinetic term of {' and '.join(names)}."
        elif problem == UNKNOWN:
            remedy = "Write the kinetic energy in simpler functions, or its domain in [domain]."
        else:
            remedy = "Declare momenta: the kernel then solves for the velocities."
        message = f"the mass matrix d2l/d({', '.join(names)})2 {problem}. {remedy}"
        return fault(self.setting, self.formula, message, names[0])


SINGULAR = "has determinant 0"
UNKNOWN = "has a determinant that may be 0 everywhere: no point was found where it is certainly not"


def mechanics(setting: Setting) -> Mechanics:
    """The declared Lagrangian with its derivatives."""
    formula = setting.spec.lagrangian
    assert formula is not None, "the reader asks for a Lagrangian"
    return Mechanics(setting, formula, setting.formula(formula))


def declared_energy(setting: Setting) -> Element | None:
    """The energy of coordinates and velocities that the spec knows; None if it knows none."""
    if setting.spec.hamiltonian is not None:
        return setting.formula(setting.spec.hamiltonian)
    return mechanics(setting).energy if setting.spec.lagrangian is not None else None


def in_state_order(setting: Setting, rates: Mapping[str, Element]) -> tuple[Element, ...]:
    """Rates by name, in the order of the state."""
    return tuple(rates[name] for name in setting.state)


# -- solving --------------------------------------------------------------------------------------


def inverse_in_blocks(field: Field, matrix: Matrix, refuse: Refuse) -> Matrix:
    """The inverse of a matrix whose blocks of coupled places are small.

    Args:
        field: Where the entries live.
        matrix: Square.
        refuse: Makes the error to raise of what is wrong and the places that it concerns.
    """
    found = [[field.zero] * len(matrix) for _ in matrix]
    for block in coupled_blocks(matrix):
        own = tuple(tuple(matrix[i][j] for j in block) for i in block)
        if len(block) > LARGEST_BLOCK:
            raise refuse(
                f"couples {len(block)} of them; expected at most {LARGEST_BLOCK}, whose inverse "
                "can be written out",
                block,
            )
        if witness_regular(field, own) is None:
            zero = field.is_zero(determinant(own))
            raise refuse(SINGULAR if zero else UNKNOWN, block)
        for i, row in zip(block, inverse(own), strict=True):
            for j, entry in zip(block, row, strict=True):
                found[i][j] = entry
    return tuple(map(tuple, found))


def conjugates(
    field: Field, function: Element, names: Sequence[str], values: Sequence[Element], refuse: Refuse
) -> tuple[Element, ...]:
    """``x(y)`` from ``y = df/dx`` for an f quadratic in x: one half of a Legendre transform.

    The other half is the same: ``g(y) = x . y - f`` has ``x = dg/dy``, and gives f back.

    Args:
        field: Where everything lives.
        function: f.
        names: x, symbols.
        values: y.
        refuse: Makes the error to raise.

    >>> field = Field(["v", "m", "a", "p"])
    >>> v, m, a, p = (field[name] for name in "vmap")
    >>> conjugates(field, m * v**2 / 2 + a * v, ["v"], [p], lambda text, _: DerivationError(text))
    ((-a + p)/m,)
    """
    slopes = field.gradient(function, names)
    hessian = tuple(field.gradient(slope, names) for slope in slopes)
    for place, row in enumerate(hessian):
        found = sorted(set(names).intersection(*[set().union(*map(field.reach, row))]))
        if found:
            raise refuse(
                f"depends on {', '.join(found)}: momenta and velocities are not linear in each "
                "other; expected a function quadratic in them, which alone is solved exactly",
                (place,),
            )
    rest = dict.fromkeys(names, field.zero)
    known = [y - field.substitute(slope, rest) for y, slope in zip(values, slopes, strict=True)]
    return apply(inverse_in_blocks(field, hessian, refuse), known)


def fault(setting: Setting, formula: Formula, message: str, found: str) -> DerivationError:
    """An error that points at a formula."""
    return DerivationError(
        f"{setting.spec.path}:{formula.line}: {formula.key}: {message}",
        path=str(setting.spec.path),
        line=formula.line,
        key=formula.key,
        found=found,
    )
