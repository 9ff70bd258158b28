r"""The energy of a strand, split into momenta and strains, and with links in the place of these.

A link that turns by t about the unit vector c is
:math:`U = \cos t + \sin t\,\hat c + (1 - \cos t)\, c c^T` (Rodrigues). So two expressions that are
linear in its entries tend to the strain :math:`\Xi = c\,t/a` and to its products,

.. math:: x = \operatorname{axial}(U)/a = c \sin(t)/a, \qquad
    S = (U + U^T + (1 - \operatorname{tr} U))/a^2 = 2 c c^T (1 - \cos t)/a^2,

both up to the order a^2. V is a polynomial: of each of its monomials pairs of components become
entries of S, and a component that is left over one of x. So :math:`\Xi \cdot K \Xi/2` becomes
:math:`c \cdot K c\,(1 - \cos t)/a^2`, which grows up to half a turn, and a term of degree 4 is of
degree 2 in the entries of U. How components are paired does not matter for rotations, since S has
rank 1 there: a rotation of body axes that leaves V as it is leaves its lattice, too.

Of a right invariant strand the strain is :math:`(\partial_s R) R^T`, and :math:`U = R' R^T`.

A rod has places x as well, and its strain a second part e, with :math:`R^T (x' - x)/a` in its
place. As a body sees it that is e in the middle of the link, turned by half of it, and tends to e
with the order a alone. The next body sees it turned back by the other half. So the energy of a
link is half the sum of V as seen by both, which tends to V with the order a^2, and is the same of
the rod from its other end.

Comes in: the Spec of a strand. Goes out: T as an element, and V by its monomials.
Read next: `coadjoint.bodies.text`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from typing import Final

from coadjoint.algebra.catalogue import algebra_by_name, representation_by_name
from coadjoint.derive import Equations, derive
from coadjoint.errors import SpecError
from coadjoint.exact import Element, Field
from coadjoint.spec import Spec
from coadjoint.spec.model import Variable

#: What momenta may be of, by the name of the algebra.
BLOCKS: Final[Mapping[str, Sequence[AbstractSet[tuple[int, ...]]]]] = {
    "so(3)": [{(0, 1, 2)}],
    "se(3)": [{(0, 1, 2), (3, 4, 5)}, {(0, 1, 2, 3, 4, 5)}],
}


@dataclass(frozen=True)
class Strand:
    """A strand on so(3) or se(3) and its energy.

    Attributes:
        spec: Its declaration.
        equations: By one of its routes.
        momenta: Its angular momentum per length, and the momentum of a rod, in one variable or two.
        strain: What its attitude turns by along it, and the steps along a rod.
        advected: Vectors that turn with the bodies.
        own: The part of the energy per length without strains, of momenta and advected vectors.
        potential: The other part: the factor of each monomial of strains, by their exponents. Where
            there are strains, what depends on parameters alone is part of it.
    """

    spec: Spec
    equations: Equations
    momenta: tuple[Variable, ...]
    strain: Variable
    advected: tuple[Variable, ...]
    own: Element
    potential: dict[tuple[int, ...], Element]

    @property
    def field(self) -> Field:
        """The exact field of its equations."""
        return self.equations.setting.field

    @property
    def side(self) -> str:
        """Whether it is left or right invariant."""
        return self.spec.invariance

    @property
    def is_rod(self) -> bool:
        """Whether bodies have places."""
        return self.strain.shape == (6,)


def refuse(spec: Spec, problem: str, expected: str, hint: str = "") -> SpecError:
    """Why a spec has no lattice here."""
    message = f"{spec.path}: no lattice of bodies is written of this: {problem}; expected "
    return SpecError(
        f"{message}{expected}. {hint}".rstrip(),
        path=str(spec.path),
        found=problem,
        expected=expected,
        hint=hint,
    )


def read_strand(spec: Spec) -> Strand:
    """A strand with its energy.

    Raises:
        SpecError: It has no lattice of bodies, with the reason.
        DerivationError: Its energy cannot be derived.
    """
    _check_strand(spec)
    momenta = spec.having_role("momentum")
    (strain,) = (each for each in spec.variables if each.strain)
    route = "lie-poisson" if "lie-poisson" in spec.routes else spec.routes[0]
    equations = derive(spec, route)
    field = equations.setting.field
    assert equations.exact.energy is not None, "a strand has an energy"
    energy = equations.close(equations.exact.energy)
    advected = tuple(each for each in spec.having_role("advected") if not each.strain)
    moved = {name for each in (*momenta, *advected) for name in each.components}
    _check_names(spec, field, energy, (*moved, *strain.components))
    monomials = dict(_list_monomials(spec, field, energy, strain.components))
    still = (0,) * len(strain.components)
    own = monomials.pop(still, field.zero)
    together = {n for factor in monomials.values() for n in field.reach(factor) & moved}
    if together:
        is_of_momenta = together & {name for each in momenta for name in each.components}
        kind = "momenta" if is_of_momenta else "advected quantities"
        problem = f"its energy has a term of {kind} and strains together"
        hint = f"{kind.capitalize()} are those of bodies, and strains stand between them."
        raise refuse(spec, problem, f"a function of {kind} and one of strains, added", hint)
    if monomials and (constant := _find_constant(spec, field, own, sorted(moved))):
        monomials[still] = constant
        own -= constant
    return Strand(
        spec=spec,
        equations=equations,
        momenta=tuple(momenta),
        strain=strain,
        advected=advected,
        own=own,
        potential=monomials,
    )


def _check_strand(spec: Spec) -> None:
    """What can be seen before anything is derived.

    Raises:
        SpecError: It is no strand on so(3) or se(3) of momenta, a strain and advected vectors.
    """
    strains = [each for each in spec.variables if each.strain]
    by_hand = "Declare such bodies by [index], as"
    if spec.space is None or spec.algebra is None or not strains:
        problem = "it has no strain"
        raise refuse(spec, problem, 'a strand: [space], and a variable with role = "strain"')
    if spec.algebra not in map(algebra_by_name, BLOCKS):
        hint = f"{by_hand} elastic_chain does on se(3)."
        problem = f"it is a strand on {spec.algebra.name}"
        raise refuse(spec, problem, "one on so(3) or se(3)", hint)
    if spec.invariance == "right" and spec.algebra.name == "se(3)":
        problem = "it is right invariant, and so its strains are not seen in body axes"
        hint = "The inverse of g is a left one: write minus its velocities and strains for these."
        raise refuse(spec, problem, 'invariance = "left"', hint)
    vector = representation_by_name(spec.algebra, "vector")
    for each in spec.having_role("advected"):
        own = each.representation
        if not each.strain and (own is None or own.matrices != vector.matrices or each.form):
            hint = f"{by_hand} spin_chain_lattice does, and give each an advected quantity."
            problem = f"{each.name!r} is advected, and no vector"
            raise refuse(spec, problem, 'representation = "vector"', hint)
    blocks = {each.block for each in spec.having_role("momentum")}
    if blocks not in BLOCKS[spec.algebra.name]:
        problem = "its momenta are not those of the whole algebra"
        raise refuse(spec, problem, "one momentum without a block, or one of each block")


def _find_constant(spec: Spec, field: Field, own: Element, moved: Sequence[str]) -> Element:
    """What an energy without strains has of parameters alone, where it is a polynomial."""
    try:
        powers = dict(_list_monomials(spec, field, own, moved))
    except SpecError:
        return field.zero
    return powers.get((0,) * len(moved), field.zero)


def _check_names(spec: Spec, field: Field, energy: Element, own: Sequence[str]) -> None:
    """The energy names momenta, strains and parameters other than the length.

    Raises:
        SpecError: It names a derivative or the length.
    """
    assert spec.space is not None, spec.name
    known = {*own, *(n for each in spec.parameters for n in each.components)}
    foreign = sorted(field.reach(energy) - known - field.adjoined.keys())
    if foreign:
        problem = f"its energy names {foreign[0]}"
        raise refuse(spec, problem, "an energy of momenta and strains, without derivatives")
    if spec.space.length in field.reach(energy):
        problem = f"its energy names the length {spec.space.length}"
        raise refuse(spec, problem, "an energy per length that does not depend on it")


def _list_monomials(
    spec: Spec, field: Field, potential: Element, strains: Sequence[str]
) -> Iterator[tuple[tuple[int, ...], Element]]:
    """The factor of each monomial of strains, by their exponents.

    Raises:
        SpecError: The potential is no polynomial in them.
    """
    if not strains:
        yield (), potential
        return
    first, *others = strains
    expected = "a polynomial of strains, such as dot(Xi, Xi)^2"
    try:
        powers = field.coefficients(potential, first)
    except ValueError as error:
        problem = f"its energy is no polynomial in the strains: {error}"
        hint = "Write the first terms of its series."
        raise refuse(spec, problem, expected, hint) from error
    if min(powers, default=0) < 0:
        problem = f"its energy is no polynomial in the strains: {first} stands in a denominator"
        raise refuse(spec, problem, expected)
    for power, factor in powers.items():
        for exponents, value in _list_monomials(spec, field, factor, others):
            yield (power, *exponents), value


def pair_components(exponents: Sequence[int]) -> tuple[list[int], list[tuple[int, int]]]:
    """The components of x and the entries of S that a monomial of turns becomes.

    >>> pair_components([3, 1, 0])
    ([], [(0, 0), (0, 1)])
    >>> pair_components([0, 0, 3])
    ([2], [(2, 2)])
    """
    listed = [place for place, exponent in enumerate(exponents) for _ in range(exponent)]
    left = listed[-1:] if len(listed) % 2 else []
    paired = listed[: len(listed) - len(left)]
    return left, list(zip(paired[::2], paired[1::2], strict=True))
