"""Changes of what routes share: setting, Legendre transform, formulas, solves, momentum maps.

Where all routes go wrong together, no equality of routes sees it: then claims do, or the book.
Read next: `tests.mutation.changed_specs`.
"""

from __future__ import annotations

from tests.mutation.mutant import of

SETTING = "tests/derive/test_setting.py"
SOLVER = ("tests/derive/test_solver.py -k definitions_solve",)
TIME = ("tests/sources/test_momentum_maps.py -k 2_3_1",)
PT = ("tests/sources/test_complex.py -k pt_symmetric",)
TOP = ("heavy_top_goryachev_chaplygin",)

SHARED = (
    *of(
        "setting",
        "setting",
        TOP,
        "sign: rewrite 1 if _1 else -1 -> -1 if _1 else 1",
    ),
    *of(
        "setting",
        "setting",
        (),
        "sign: then invariance",
        tests=(f"{SETTING} -k sign_is_that",),
    ),
    *of(
        "legendre",
        "legendre",
        TOP,
        "legendre_transform: flip lagrangian",
        "_invert_block: unwrap inverse",
    ),
    *of(
        "legendre",
        "legendre",
        (),
        "known_side: rewrite _1 - at_rest(_2, _3) -> _1 + at_rest(_2, _3)",
        tests=("tests/derive/test_routes.py",),
    ),
    *of(
        "forces",
        "external",
        ("heavy_top_damped",),
        ("external_forces: flip s", "a friction that drives"),
        "add_forces: flip f in rates",
    ),
    *of(
        "forces",
        "external",
        (),
        "added_rates: use mass for inverse_mass",
        ("added_rates: omit weight", "a symmetric matrix that is pulled twice"),
        tests=("tests/derive/test_external.py -k 'mass_matrix or symmetric'",),
    ),
    *of(
        "formulas",
        "interpret",
        TOP,
        "module: use add for subtract in _BINARY",
        "_value: invert below",
    ),
    *of(
        "formulas",
        "interpret",
        ("kepler",),
        "_value: flip field",
    ),
    *of(
        "solver",
        "solver",
        (),
        "_eliminate: flip taken",
        "_rest: rewrite self._w[i, k] * _1 -> self._l[i, k] * _1",
        "_eliminate: omit share in _entry",
        "_eliminate: invert pivot",
        tests=SOLVER,
    ),
    *of(
        "momentum-maps",
        "symmetries",
        ("spd_motion",),
        "_lift: flip covector",
        "_covector: omit weight",
        "momentum_map: rewrite 1 if _1 else -1 -> -1 if _1 else 1",
    ),
    *of(
        "momentum-maps",
        "symmetries",
        ("c3_oscillators",),
        "_moves: flip a",
    ),
    *of(
        "momentum-maps",
        "symmetries",
        (),
        "_values: flip symmetry",
        "momentum_map: flip components",
        tests=TIME,
    ),
    *of(
        "reductions",
        "reductions",
        (),
        "restrict: negate rates name",
        tests=PT,
    ),
)
