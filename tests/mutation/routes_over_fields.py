"""Functions that carry the mechanics of fields: each of their signs, terms and factors is tried.

Routes judge one another, and a test compares them with the equations of books.
Read next: `tests.mutation.core_functions`.
"""

from __future__ import annotations

from tests.mutation.mutant import core_of

STRANDS = ("spin_chain",)
#: Signs that all routes share, and what books print.
BOOKS = ("tests/derive/test_fields.py -k 'book or korteweg or landau or simo'",)
#: The sign of a rate, which a certificate alone does not tell, shows in a flux.
FLUX = ("tests/prove/test_fields.py -k 'fluxes'",)

FIELDS = (
    *core_of(
        "lie-poisson", "fields/structure", "field_operator", systems=("kdv", *STRANDS), tests=BOOKS
    ),
    *core_of("euler-poincare", "fields/circle", "euler_poincare", systems=("kdv",), tests=BOOKS),
    *core_of(
        "hamilton-pontryagin",
        "hamilton_pontryagin",
        "_derive_fields _mixed_derivatives",
        systems=STRANDS,
        tests=BOOKS,
    ),
    *core_of(
        "lie-poisson",
        "fields/jets",
        "euler rate _homotopy",
        systems=("kdv",),
        tests=(*BOOKS, *FLUX),
    ),
)
