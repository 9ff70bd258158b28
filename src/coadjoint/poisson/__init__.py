"""Poisson structures: brackets of functions, their Jacobi identity and their Casimirs.

Comes in: a Lie algebra, canonical pairs, distinguished functions or a declared tensor, over an
exact field. Goes out: a `PoissonStructure`, proofs about it, and the Casimirs found.
Read next: `coadjoint.poisson.structure`, then `coadjoint.poisson.brackets` and
`coadjoint.poisson.casimirs`.
"""

from coadjoint.poisson.brackets import (
    canonical,
    declare_bracket,
    lie_poisson,
    magnetic,
    nambu,
)
from coadjoint.poisson.structure import PoissonStructure, compatible_sum

__all__ = [
    "PoissonStructure",
    "canonical",
    "compatible_sum",
    "declare_bracket",
    "lie_poisson",
    "magnetic",
    "nambu",
]
