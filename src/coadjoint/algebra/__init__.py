"""Lie algebras: structure constants, representations, products, and the actions built on them.

Everything here is exact and free of SymPy: constants are rationals or elements of a field of
parameters, and the vectors that `bracket`,
`ad_star` and `diamond` take may hold any values that add and multiply (fractions, floats, elements
of a function field), so one implementation serves the reader, the derivation and the tests.
Read next: `coadjoint.algebra.lie_algebra`.
"""

from coadjoint.algebra.catalogue import CATALOGUE, algebra_by_name, representation_by_name
from coadjoint.algebra.extensions import (
    central_extension,
    complexification,
    leibniz_extension,
    subalgebra,
)
from coadjoint.algebra.lie_algebra import (
    LieAlgebra,
    from_bracket,
    from_brackets,
    from_matrices,
    same_constants,
)
from coadjoint.algebra.products import direct_sum, semidirect_product, semidirect_sum
from coadjoint.algebra.representation import Representation
from coadjoint.exact.linear import Span, nullspace

__all__ = [
    "CATALOGUE",
    "LieAlgebra",
    "Representation",
    "Span",
    "algebra_by_name",
    "central_extension",
    "complexification",
    "direct_sum",
    "from_bracket",
    "from_brackets",
    "from_matrices",
    "leibniz_extension",
    "nullspace",
    "representation_by_name",
    "same_constants",
    "semidirect_product",
    "semidirect_sum",
    "subalgebra",
]
