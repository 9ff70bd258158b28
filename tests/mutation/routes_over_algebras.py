"""Changes of the routes that start from a Lie algebra, each judged by certificates of systems.

Read next: `tests.mutation.routes_over_coordinates`.
"""

from __future__ import annotations

from tests.mutation.mutant import of

#: Affine motion has little to reckon with; a top has advected quantities beside.
PLAIN = ("affine_line", "heavy_top_goryachev_chaplygin")
TOP = ("heavy_top",)
LAX = "tests/derive/test_lax.py"
BODIES = "tests/derive/test_bodies.py"
TOPS = "tests/sources/test_tops.py"
#: Momenta seen from space by matrices.
FROM_THE_RIGHT = ("tests/derive/test_group_routes.py -k last_row",)
SEEN = ("tests/sources/test_principles.py -k '7_1_3 or 4_2_2 or 2_1_1'",)
MANAKOV = ("tests/sources/test_lax.py -k '2_4_2_three or 2_4_2_manakov or every_inertia'",)

REDUCED = (
    *of(
        "matrix-euler-poincare",
        "matrix_euler_poincare",
        ("quadratic_potential_so3",),
        "_rates: unwrap transpose",
        "_rates: rewrite add(torque, push) -> add(torque, scale(-1, push))",
        "_rates: unwrap add",
        "_symmetric: unwrap add",
        "_symmetric: use 1 for 2",
    ),
    *of(
        "lie-poisson",
        "structure",
        PLAIN,
        ("lie_poisson_structure: flip setting", "the plus bracket for left invariance"),
    ),
    *of(
        "lie-poisson",
        "structure",
        ("quadratic_potential_so3",),  # symmetric matrices are not their own dual, vectors are
        "exact_momentum_algebra: bare action",
    ),
    *of(
        "lie-poisson",
        "legendre",
        ("quadratic_potential_so3", "affine_line"),
        "hamiltonian: negate transform energy",
        "hamiltonian: negate hamiltonian in return",
    ),
    *of(
        "hamilton-pontryagin",
        "hamilton_pontryagin",
        PLAIN,
        "_at_the_motion: rewrite _1 | _2 -> _2",
    ),
    *of(
        "hamilton-pontryagin",
        "reconstruction",
        ("rigid_body_attitude",),
        "_turn: rewrite (q, q.conjugate) -> (q.conjugate, q)",
    ),
    *of(
        "hamilton-pontryagin",
        "reconstruction",
        (),
        "inverse_of: rewrite scale(-1, apply(turn, _1)) -> scale(1, apply(turn, _1))",
        tests=FROM_THE_RIGHT,
    ),
    *of(
        "hamilton-pontryagin",
        "reconstruction",
        (),
        "inverse_of: unwrap transpose in return",
        tests=SEEN,
    ),
    *of(
        "clebsch",
        "clebsch",
        PLAIN[:1] + TOP,
        "derive: rewrite zip(p, _1, strict=True) -> zip(p, (-s for s in _1), strict=True)",
        "derive: use pairing for action in q",
        "derive: negate substitute image",
    ),
    *of(
        "poincare",
        "poincare",
        PLAIN[:1] + TOP,
        "_inertial: rewrite _1 * eta[k] * slopes[i] -> _1 * eta[k] * slopes[k]",
    ),
)

BODY_ROUTES = (
    *of(
        "cayley-klein",
        "cayley_klein",
        ("rigid_body_attitude", "heavy_top"),
        "_momentum_rate: rewrite body.omega.conjugate -> body.omega",
    ),
    *of(
        "cayley-klein",
        "cayley_klein",
        TOP,
        "_slopes: rewrite _1(_2, _3) - _1(_3, _2) -> _1(_3, _2) - _1(_2, _3)",
        "_body: mirror conjugate",
    ),
    *of(
        "newton-euler",
        "newton_euler",
        TOP,
        "_rates: use add for subtract in torque",
        "_rates: unwrap turning",
        "mass_points: use add for subtract in second",
    ),
    *of(
        "newton-euler",
        "newton_euler",
        (),  # a body that moves about another origin than its centre of mass
        "mass_points: rewrite (mass[2][4], _1, _2) -> (mass[1][5], mass[2][3], mass[0][4])",
        "_rates: rewrite add(_1, inner) -> inner",
        tests=(f"{TOPS} -k 2_1_2",),
    ),
    *of(
        "kaluza-klein",
        "kaluza_klein",
        TOP,
        "_rates: flip forces",
        "derive: drop level",
        "derive: flip value",
        (
            "derive: let forces = field.gradient(field.substitute(whole, solved), names)",
            "dq/dt = p - a put in before varying",
        ),
    ),
    *of(
        "complexification",
        "complexification",
        ("complex_rigid_body",),
        "derive: negate im in parts",
        "derive: flip setting in in_state_order",
        "_momenta: exchange Complex",
        "derive: swap bracket",
        "derive: rewrite _continue(setting, slope, L) -> Complex(slope, setting.field.zero)",
    ),
    *of(
        "complexification",
        "complexification",
        (),  # velocities are named beside the motion, which does not use them
        "derive: flip im",
        tests=("tests/sources/test_complex.py -k complex_velocities",),
    ),
)

PAIRS = (
    *of(
        "lax",
        "pairs",
        ("bloch_iserles_3",),
        "lax_equations: rewrite rights.get(power, _1) -> rights.get(power + 1, _1)",
        "lax_equations: swap commutator",
        "lax_equations: unwrap commutator",
    ),
    *of(
        "lax",
        "integrals",
        ("rigid_body",),
        "traces: rewrite (x * y for x, y in pairs if x and y) -> (x + y for x, y in pairs)",
    ),
    *of(
        "lax",
        "integrals",
        ("manakov_so4",),
        "_choose_independent: rewrite ordered[place - len(known)] -> ordered[place - 1]",
    ),
    *of(
        "manakov",
        "planes",
        ("rigid_body",),
        "_by_sums: rewrite (a, _1) -> (a, a)",
        "find_pair: flip turn",
    ),
    *of(
        "manakov",
        "planes",
        ("quadratic_potential_so3",),
        ("find_pair: flip share", "the potential +S in the pair found"),
    ),
    *of(
        "manakov",
        "planes",
        (),  # another pair is found then, which is right, too, but not the book's
        "_by_differences: flip other",
        "_by_differences: flip inertia in return",
        tests=MANAKOV,
    ),
)
