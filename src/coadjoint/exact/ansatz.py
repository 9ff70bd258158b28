r"""The ansatz search: functions of a finite family that satisfy linear conditions, proved.

.. math:: f = \sum_n c_n f_n, \qquad \sum_n a_{kn} c_n = 0

The numbers c_n are unknown and rational. The caller gives the family and the conditions: the
coefficients of what must vanish (`conditions_on`), or its values at points modulo a prime. The
search solves the conditions modulo a prime, where numbers stay small, and lifts a solution to the
rational numbers of which it is the image.

Scope. Conditions by coefficients are all conditions: `solve_exactly` proves that its basis is a
basis of all functions of the family. Values at points are necessary conditions: `solve` has at
least as many solutions as there are functions, so a count of them is a certain bound from above,
and the caller proves each lifted function by substitution. Searches for integrals, Casimirs,
measures and relations are of this kind.
Comes in: members, and rows of conditions. Goes out: numbers by member.
Read next: `coadjoint.exact.linear`; `coadjoint.poisson.search`, `coadjoint.prove.candidates` and
`coadjoint.prove.measures`, which search.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations_with_replacement
from typing import Generic, TypeVar

from coadjoint.exact.linear import echelon_modulo, nullspace, rational_vector
from coadjoint.exact.packed import PackedSpan

Member = TypeVar("Member", bound=Hashable)
Place = TypeVar("Place", bound=Hashable)
#: The exponents of a monomial, one for each of its symbols.
Exponents = tuple[int, ...]


@dataclass(frozen=True)
class Solution(Generic[Member]):
    """Numbers in front of the members of a family, modulo a prime.

    Attributes:
        numbers: Those that are not zero, by member.
        prime: The prime.
    """

    numbers: Mapping[Member, int]
    prime: int

    def lift(self) -> dict[Member, Fraction] | None:
        """The small rational numbers that these are the images of; None if there are none.

        >>> Solution({"x": 1, "y": 2**60}, 2**61 - 1).lift()
        {'x': Fraction(1, 1), 'y': Fraction(1, 2)}
        """
        result = rational_vector(dict(enumerate(self.numbers.values())), self.prime)
        return None if result is None else dict(zip(self.numbers, result.values(), strict=True))


def solve(
    members: Sequence[Member], conditions: Iterable[Sequence[int]], prime: int
) -> list[Solution[Member]]:
    """A basis of the solutions of ``sum of row[n] c_n = 0`` modulo a prime.

    Args:
        members: The family.
        conditions: Rows of residues, one for each member.
        prime: The prime.

    >>> [solution.lift() for solution in solve("xyz", [[1, 2, 0], [0, 0, 1]], 2**61 - 1)]
    [{'x': Fraction(1, 1), 'y': Fraction(-1, 2)}]
    """
    return [
        Solution({members[n]: value for n, value in sorted(vector.items())}, prime)
        for vector in PackedSpan(prime, len(members), conditions).nullspace()
    ]


def solve_with_right_side(
    members: Sequence[Member], conditions: Iterable[Sequence[int]], prime: int
) -> Solution[Member] | None:
    """Numbers with ``sum of row[n] c_n = row[-1]`` modulo a prime; None if there are none.

    >>> solve_with_right_side("xy", [[1, 1, 3], [1, -1, 1]], 7).numbers
    {'x': 2, 'y': 1}
    >>> solve_with_right_side("xy", [[1, 1, 3], [2, 2, 1]], 7)
    """
    last = len(members)
    solved = echelon_modulo((dict(enumerate(row)) for row in conditions), prime)
    if last in solved:
        return None
    numbers = {members[pivot]: solved[pivot].get(last, 0) for pivot in sorted(solved)}
    return Solution({member: value for member, value in numbers.items() if value}, prime)


def solve_exactly(
    members: Sequence[Member], conditions: Iterable[Mapping[int, Fraction | int]]
) -> list[dict[Member, Fraction]]:
    """A basis of the solutions of ``sum of row[n] c_n = 0``: the reduced echelon form, proved.

    >>> solve_exactly("xy", [{0: 2, 1: 4}])
    [{'x': Fraction(1, 1), 'y': Fraction(-1, 2)}]
    """
    return [
        {members[n]: value for n, value in vector.items()}
        for vector in nullspace(conditions, len(members))
    ]


def conditions_on(
    images: Iterable[Mapping[Place, Fraction | int]],
) -> list[dict[int, Fraction | int]]:
    """The conditions that a combination of images vanishes, from the coefficients of each image.

    >>> conditions_on([{"a": 1}, {"a": 2, "b": 1}])
    [{0: 1, 1: 2}, {1: 1}]
    """
    rows: dict[Place, dict[int, Fraction | int]] = {}
    for n, image in enumerate(images):
        for place, value in image.items():
            rows.setdefault(place, {})[n] = value
    return list(rows.values())


def monomials(size: int, degree: int, least: int = 0) -> Iterator[Exponents]:
    """The monomials in some symbols from one degree to another, those of low degree first.

    >>> list(monomials(2, 2, least=1))
    [(1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]
    """
    for total in range(least, degree + 1):
        for factors in combinations_with_replacement(range(size), total):
            exponents = [0] * size
            for n in factors:
                exponents[n] += 1
            yield tuple(exponents)
