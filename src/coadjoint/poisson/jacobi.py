"""The Jacobi identity of a Poisson tensor, as elements that must be zero.

Comes in: a tensor J and a way to take its derivatives. Goes out: the components of its Schouten
bracket ``J_am d_m J_bc + cyclic``. Only entries that are there are visited. A tensor that is affine
in the coordinates is not handled here: `coadjoint.poisson.structure` reads off its structure
constants and decides by their arithmetic.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import combinations

from coadjoint.exact import Element, Field

Tensor = Sequence[Sequence[Element]]
Triple = tuple[int, int, int]
#: The partial derivatives of an element that are not zero, each with the place of its coordinate.
Slopes = Callable[[Element], Iterable[tuple[int, Element]]]


def slopes_by(field: Field, names: Sequence[str]) -> Slopes:
    """Partial derivatives by symbols of a field."""

    def slopes(element: Element) -> list[tuple[int, Element]]:
        present = field.reach(element)
        result = ((m, field.derivative(element, x)) for m, x in enumerate(names) if x in present)
        return [(m, slope) for m, slope in result if slope]

    return slopes


def schouten_bracket(tensor: Tensor, slopes: Slopes) -> dict[Triple, Element]:
    """``J_am d_m J_bc + cyclic`` for every triple a < b < c to which something contributes.

    Args:
        tensor: An antisymmetric matrix of elements.
        slopes: Derivatives of an entry; undetermined functions bring their own chain rule.
    """
    size = len(tensor)
    acting = [[(a, tensor[a][m]) for a in range(size) if tensor[a][m]] for m in range(size)]
    parts: dict[Triple, Element] = {}
    for b, c in combinations(range(size), 2):
        for m, slope in slopes(tensor[b][c]) if tensor[b][c] else ():
            for a, factor in acting[m]:
                if a in (b, c):
                    continue  # a triple with two equal members satisfies the identity
                low, middle, high = sorted((a, b, c))
                term = factor * slope
                term = -term if a == middle else term  # the cycle has the pair as (c, b) then
                triple = (low, middle, high)
                parts[triple] = parts[triple] + term if triple in parts else term
    return dict(sorted(parts.items()))
