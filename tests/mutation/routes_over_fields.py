"""Functions that carry the mechanics of fields: each of their signs, terms and factors is tried.

Routes judge one another, and a test compares them with the equations of books.
Read next: `tests.mutation.core_functions`.
"""

from __future__ import annotations

from tests.mutation.mutant import core_of

STRANDS = ("spin_chain",)
CIRCLES = ("burgers", "hunter_saxton", "camassa_holm")
#: Signs that all routes share, and what books print.
BOOKS = ("tests/derive/test_fields.py -k 'book or korteweg or landau or simo'",)
#: Rates of exact waves, by differences and by Fourier derivatives, and what they keep.
WAVES = ("tests/derive/test_grid.py -k 'exact_waves and (camassa or hunter)'",)
RINGS = ("tests/derive/test_grid.py -k 'ring or level'",)
REFUSED = ("tests/derive/test_fields.py -k 'refused or mass'",)
#: The sign of a rate, which a certificate alone does not tell, shows in a flux.
FLUX = ("tests/prove/test_fields.py -k 'fluxes'",)
#: The curl of the fluid's equation, claims in a plane, and rates by sums over waves.
PLANE = ("tests/prove/test_torus.py", "tests/solve/test_torus.py -k 'waves or velocity'")
#: What loops compute of matrices of any number of rows, against what is written out for a few.
MATRICES = ("tests/derive/test_truncated.py",)

FIELDS = (
    *core_of(
        "lie-poisson",
        "fields/structure",
        "field_operator",
        systems=("kdv", "euler_2d", *STRANDS),
        tests=(*BOOKS, *PLANE),
    ),
    *core_of(
        "euler-poincare",
        "fields/circle",
        "euler_poincare",
        systems=("kdv", "euler_2d"),
        tests=(*BOOKS, *PLANE),
    ),
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
        "total rate _move integrate",
        systems=("kdv", "euler_2d"),
        tests=(*BOOKS, *FLUX, *PLANE),
    ),
    *core_of(
        "euler-poincare",
        "fields/circle",
        "inertia vary close velocity energy",
        systems=(*CIRCLES, "euler_2d"),
        tests=(*FLUX, *REFUSED, *WAVES, *PLANE),
    ),
    *core_of(
        "lie-poisson",
        "fields/torus",
        "_is_linear make_window family",
        systems=("euler_2d",),
        tests=PLANE,
    ),
    *core_of(
        "lie-poisson",
        "fields/solved",
        "find_factors _divide multiply_out solve_ring",
        systems=("hunter_saxton",),
        tests=(*RINGS, *WAVES),
    ),
    *core_of(
        "lie-poisson",
        "fields/generic",
        "find_slopes",
        systems=("hunter_saxton", "spin_chain"),
        tests=(*WAVES,),
    ),
    *core_of(
        "lie-poisson",
        "fields/sums",
        "find_bracket_defects",
        systems=("hunter_saxton", "spin_chain"),
        tests=(*WAVES,),
    ),
    *core_of(
        "lie-poisson",
        "truncated",
        "derive_truncated _find_scale multiply_out commute_entries _split _commute",
        systems=(),
        tests=MATRICES,
    ),
    *core_of(
        "lie-poisson",
        "sine_bracket",
        "_multiply _Circle.sine _Circle.turn",
        systems=(),
        tests=("tests/derive/test_truncated.py -k sine_bracket",),
    ),
    *core_of(
        "lie-poisson",
        "fields/spectral",
        "_differentiate",
        systems=(),
        tests=("tests/derive/test_spectral.py",),
    ),
    *core_of(
        "lie-poisson",
        "fields/ends",
        "find_row find_place find_weight",
        systems=(),
        tests=("tests/derive/test_ends.py -k 'parts or polynomials or largest or matrices'",),
    ),
)
