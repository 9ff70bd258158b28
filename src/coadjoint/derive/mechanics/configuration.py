r"""Mass matrix and momenta: what every route from a Lagrangian starts from, built once.

A Lagrangian l(z, v) in the velocities v of a frame and the positions z has momenta
:math:`p = \partial l / \partial v`, a mass matrix :math:`M = \partial^2 l / \partial v^2` and the
energy :math:`E = p \cdot v - l`. The velocities are those along an algebra, those of coordinates,
or both.
Comes in: a Setting with a Lagrangian. Goes out: these pieces, and inverses block by block. No
route's result is used here.
Read next: `coadjoint.derive.mechanics.legendre`, `coadjoint.derive.routes.euler_lagrange`.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

from coadjoint.derive.assembly import sampled_setting
from coadjoint.derive.interpret import entries
from coadjoint.derive.mechanics.frames import Frame, frame_of
from coadjoint.derive.mechanics.radial import radial_solution
from coadjoint.derive.setting import Setting, fault, lagrangian_fault, once
from coadjoint.elementary import ELEMENTARY
from coadjoint.errors import DerivationError
from coadjoint.exact import Element, Field, element_text
from coadjoint.exact.dense import apply, determinant, dot, inverse
from coadjoint.exact.ranks import witness_regular
from coadjoint.spec import Formula, Spec
from coadjoint.spec.core.components import kept_places, matrix_size, unpack

#: Largest set of coupled velocities solved symbolically; the cofactors of more would explode.
LARGEST_BLOCK = 3

Matrix = tuple[tuple[Element, ...], ...]
#: Places that are coupled.
Block = tuple[int, ...]
#: What cannot be inverted and which places it concerns, as an error to raise.
Refuse = Callable[[str, Sequence[int]], DerivationError]


@dataclass(frozen=True)
class Mechanics:
    """A Lagrangian with its derivatives.

    Attributes:
        setting: The spec and its field.
        lagrangian: l(z, v) in all velocities of the frame.
    """

    setting: Setting
    lagrangian: Element

    @property
    def frame(self) -> Frame:
        """The velocities and their fields."""
        return frame_of(self.setting)

    @cached_property
    def momenta(self) -> tuple[Element, ...]:
        """``dl/dv_i``."""
        return self.setting.field.gradient(self.lagrangian, self.frame.velocities)

    @cached_property
    def mass(self) -> Matrix:
        """``M_ij = d2l/dv_i dv_j``."""
        field, names = self.setting.field, self.frame.velocities
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
        velocities = self.setting.elements(self.frame.velocities)
        return dot(self.momenta, velocities) - self.lagrangian

    @cached_property
    def inverse_mass(self) -> Matrix:
        """``M^-1``, asked for where M is not long.

        Raises:
            DerivationError: M is singular.
        """
        return inverse_in_blocks(self.setting.field, self.mass, self.refusal)

    @cached_property
    def is_long(self) -> bool:
        """Whether M couples more velocities than are solved for by a written inverse."""
        return any(len(block) > LARGEST_BLOCK for block in coupled_blocks(self.mass))

    @cached_property
    def bending(self) -> dict[str, list[str]]:
        """The velocities on which rows of the mass matrix depend, by the velocity of the row.

        Empty exactly where l is quadratic in the velocities.
        """
        names = self.frame.velocities
        rows = zip(names, self.mass, strict=True)
        named = ((name, reached(self.setting.field, [row], names)) for name, row in rows)
        return {name: found for name, found in named if found}

    def check_smooth(self) -> None:
        """Momenta do not jump.

        Raises:
            DerivationError: The Lagrangian has a kink in a velocity.
        """
        field, names = self.setting.field, {*self.frame.velocities}
        for known in map(field.adjoined.__getitem__, sorted(field.functions_in(self.lagrangian))):
            turning = sorted(field.reach(field[known.generator]) & names)
            if ELEMENTARY[known.function].is_locally_constant and turning:
                message = (
                    f"the Lagrangian has a kink where {element_text(field, known.argument)} is 0; "
                    "expected one that is smooth in the velocities, so that momenta do not jump. "
                    "Write abs, sign, min and max of positions and parameters alone."
                )
                raise lagrangian_fault(self.setting, message, turning[0])

    def refusal(self, problem: str, places: Sequence[int]) -> DerivationError:
        """Why velocities cannot be solved for."""
        names = [self.frame.velocities[i] for i in places]
        if problem == SINGULAR:
            problem += "; expected every velocity in the kinetic energy"
            remedy = f"Add the missing kinetic term of {' and '.join(names)}."
        elif self.bending:
            remedy = "Take the route euler-lagrange alone, with velocities as the state."
        else:
            remedy = "Write the kinetic energy in simpler functions, or its domain in [domain]."
        message = f"the mass matrix d2l/d({', '.join(names)})2 {problem}. {remedy}"
        return lagrangian_fault(self.setting, message, names[0])


SINGULAR = "has determinant 0"
UNKNOWN = "has a determinant that may be 0 everywhere: no point was found where it is certainly not"


@once
def mechanics(setting: Setting) -> Mechanics:
    """The declared Lagrangian with its derivatives."""
    result = Mechanics(setting, setting.lagrangian)
    result.check_smooth()
    return result


def moves_along_frame(setting: Setting) -> bool:
    """Whether the kernel solves for the accelerations of coordinates that nothing binds.

    Their velocities are the state, and more of them are coupled than a written inverse is for.
    """
    spec = setting.spec
    free = spec.kind == "configuration" and spec.lagrangian is not None and not setting.momenta
    return free and mechanics(setting).is_long


def sampled_mechanics(spec: Spec) -> Mechanics:
    """The declared Lagrangian with random numbers for everything but the velocities.

    Which velocities are coupled shows there, before there is a field with the symbols that a solve
    needs; unused symbols would slow down every operation in it.

    Raises:
        DerivationError: The Lagrangian has no derivatives; the route will say so.
    """
    return mechanics(sampled_setting(spec, "velocity", random.Random(1)))  # noqa: S311 (no secret)


def declared_energy(setting: Setting) -> Element | None:
    """The energy of coordinates and velocities that the spec gives; None if it gives none."""
    if setting.spec.hamiltonian is not None:
        return setting.hamiltonian
    return mechanics(setting).energy if setting.spec.lagrangian is not None else None


def in_state_order(setting: Setting, rates: Mapping[str, Element]) -> tuple[Element, ...]:
    """Rates by name, in the order of the state."""
    return tuple(rates[name] for name in setting.state)


# -- solving --------------------------------------------------------------------------------------


def coupled_blocks(mass: Matrix) -> list[tuple[int, ...]]:
    """Positions that the mass matrix couples, as its connected blocks."""
    blocks: list[set[int]] = []
    for i, row in enumerate(mass):
        linked = {i} | {j for j, entry in enumerate(row) if entry != 0}
        meeting = [block for block in blocks if block & linked]
        blocks = [block for block in blocks if not block & linked]
        blocks.append(linked.union(*meeting))
    return sorted(tuple(sorted(block)) for block in blocks)


def inverse_in_blocks(field: Field, matrix: Matrix, refuse: Refuse) -> Matrix:
    """The inverse of a matrix whose blocks of coupled places are small.

    Args:
        field: Where the entries live.
        matrix: Square.
        refuse: Makes the error to raise of what is wrong and the places that it concerns.
    """
    whole = [[field.zero] * len(matrix) for _ in matrix]
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
                whole[i][j] = entry
    return tuple(map(tuple, whole))


def conjugates(
    field: Field, function: Element, names: Sequence[str], values: Sequence[Element], refuse: Refuse
) -> tuple[Element, ...]:
    """``x(y)`` from ``y = df/dx``: one half of a Legendre transform.

    The other half is the same: ``g(y) = x . y - f`` has ``x = dg/dy``, and gives f back. Each block
    of coupled x is solved where f is quadratic in them, or a function of one quadratic form as
    `coadjoint.derive.mechanics.radial` says.

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
    solution: dict[int, Element] = {}
    for block in coupled_blocks(hessian):

        def refuse_own(text: str, places: Sequence[int], of: Block = block) -> DerivationError:
            return refuse(text, [of[i] for i in places])

        own, y = [names[i] for i in block], [values[i] for i in block]
        curved = [slopes[i] for i in block]
        if named := reached(field, [hessian[i] for i in block], own):
            invert = partial(inverse_in_blocks, field, refuse=refuse_own)
            found = radial_solution(field, curved, own, y, invert)
            if found is None:
                raise refuse(
                    f"depends on {', '.join(named)}: momenta and velocities are not linear in each "
                    "other; expected a function quadratic in them, or of one quadratic form that "
                    "can be solved for in closed form",
                    block,
                )
        else:
            rest = dict.fromkeys(own, field.zero)
            known = [a - field.substitute(b, rest) for a, b in zip(y, curved, strict=True)]
            matrix = tuple(tuple(hessian[i][j] for j in block) for i in block)
            found = apply(inverse_in_blocks(field, matrix, refuse_own), known)
        solution |= zip(block, found, strict=True)
    return tuple(solution[i] for i in range(len(names)))


def reached(field: Field, matrix: Iterable[Iterable[Element]], names: Iterable[str]) -> list[str]:
    """The names among some on which a matrix depends, in alphabetical order."""
    return sorted({*names}.intersection({x for row in matrix for e in row for x in field.reach(e)}))


def kept_entries(
    setting: Setting, parts: Sequence[Element], form: str, formula: Formula
) -> tuple[Element, ...]:
    """The entries that a form keeps of a matrix, given row by row.

    Raises:
        DerivationError: The matrix is not of the form.
    """
    size = matrix_size(len(parts), "matrix")
    assert size is not None, len(parts)
    kept = [parts[i * size + j] for i, j in kept_places(size, form)]
    if any(x != y for x, y in zip(entries(unpack(kept, form)), parts, strict=True)):
        message = f"the value is not {form}. Correct the formula."
        raise fault(setting, formula, message, formula.text)
    return tuple(kept)
