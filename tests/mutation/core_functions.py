"""Functions that carry the mechanics of a route: each of their signs, terms and factors is tried.

No line names these changes; operators make them from what the functions hold. Those that change
nothing are listed with the reason.
Read next: `tests.mutation.routes_over_algebras`, changes that operators do not make.
"""

from __future__ import annotations

from tests.mutation import routes_over_algebras as algebras
from tests.mutation import routes_over_coordinates as coordinates
from tests.mutation import routes_over_distributions as distributions
from tests.mutation import shared_steps as shared
from tests.mutation.mutant import core_of

#: Right-invariant motions; all that ship are left-invariant.
RIGHT = ("tests/derive/test_routes.py -k 'routes_agree and right'",)
ON_BOTH_SIDES = ("tests/sources/test_principles.py -k '9_1_9_2 and right and so and vector'",)
TURNED_RIGHT = ("tests/derive/test_group_routes.py -k 'quaternions_turn and right'",)
ADVECTED = ("affine_line", "heavy_top")

CORE = (
    *core_of("euler-poincare", "euler_poincare", "_rates", systems=ADVECTED, tests=RIGHT),
    *core_of(
        "matrix-euler-poincare",
        "matrix_euler_poincare",
        "_rates _symmetric _slope_matrix",
        systems=("quadratic_potential_so3",),
        tests=(f"{algebras.LAX} -k move_advected",),
    ),
    *core_of(
        "hamilton-pontryagin",
        "hamilton_pontryagin",
        "action_near _turn _at_the_motion momentum_equation advection",
        systems=ADVECTED,
        tests=ON_BOTH_SIDES,
        fallacies={"action_near: drop pairing": "g^-1 dg/dt = xi put in before varying"},
        equivalent=dict.fromkeys(
            (
                "_turn: flip x",
                "_turn: drop x",
                "action_near: flip given",
                "action_near: drop given",
            ),
            "the momentum equation takes no slope of <mu, deps/dt - xi> but those that hold eps",
        ),
    ),
    *core_of(
        "clebsch",
        "clebsch",
        "derive _pairing",
        systems=ADVECTED,
        tests=ON_BOTH_SIDES,
        fallacies={"derive: drop pairing": "dq/dt + rho(xi) q = 0 put in before varying"},
    ),
    *core_of(
        "poincare",
        "poincare",
        "_vector_fields _inertial derive",
        systems=ADVECTED,
        tests=ON_BOTH_SIDES,
    ),
    *core_of(
        "cayley-klein",
        "cayley_klein",
        "q_rate _momentum_rate _slopes _body",
        systems=("rigid_body_attitude", "heavy_top"),
        tests=TURNED_RIGHT,
    ),
    *core_of(
        "newton-euler",
        "newton_euler",
        "_rates _forces weigh weigh_squares mass_points",
        systems=("heavy_top",),
        tests=(f"{algebras.TOPS} -k 2_1_2",),
        equivalent={
            "mass_points: transpose mass": "the mass matrix is symmetric",
            "weigh_squares: transpose second": "the matrix of second moments is symmetric",
        },
    ),
    *core_of(
        "kaluza-klein",
        "kaluza_klein",
        "_rates",
        systems=("heavy_top",),
        tests=(f"{algebras.BODIES} -k 'kaluza_klein_follows and right'",),
    ),
    *core_of(
        "complexification",
        "complexification",
        "_momenta _pair _continue",
        systems=("complex_rigid_body",),
        tests=("tests/sources/test_complex.py -k complex_velocities",),
    ),
    *core_of("lax", "pairs", "rates_of", systems=("bloch_iserles_3", "quadratic_potential_so3")),
    *core_of(
        "manakov",
        "planes",
        "_by_sums _antisymmetric",
        systems=("rigid_body",),
        tests=algebras.MANAKOV,
        equivalent=dict.fromkeys(
            (f"_by_sums: {operator} in half" for operator in ("flip", "omit", "transpose")),
            "a body in the plane turns uniformly, and any pair says so",
        ),
    ),
    *core_of(
        "poisson",
        "poisson",
        "hamiltonian_equations",
        systems=("nambu_body", "sp2_momentum", "kepler", "heavy_top"),
        tests=(*coordinates.PAIRED_TWICE, "tests/derive/test_products.py -k paired_by_the_trace"),
        equivalent={
            "hamiltonian_equations: swap bracket": "the step that shows the bracket",
            "hamiltonian_equations: transpose tensor": "the step that shows the bracket",
        },
    ),
    *core_of(
        "nambu",
        "nambu",
        "derive generalised_cross_product _from_casimir distinguished_function",
        systems=("nambu_body", "rigid_body"),
        tests=coordinates.FOUND,
    ),
    *core_of(
        "euler-lagrange",
        "euler_lagrange",
        "_in_velocities _in_momenta",
        systems=("rocking_disk",),
        tests=(*coordinates.DRIVEN, *coordinates.PAIRED_TWICE),
    ),
    *core_of(
        "canonical",
        "canonical",
        "_hamilton _magnetic _in_own_momenta",
        systems=("kepler", "monopole_kepler", "rocking_disk", "spd_motion"),
        tests=("tests/derive/test_external.py",),
        fallacies={"_magnetic: flip value": "a magnetic bracket that is not antisymmetric"},
    ),
    *core_of(
        "newton",
        "forces",
        "_acceleration",
        systems=("kepler",),
        tests=("tests/derive/test_configuration.py -k 'row_has_its_mass or law_without_energy'",),
    ),
    *core_of("alignment", "alignment", "derive", systems=("kepler", "monopole_kepler")),
    *core_of(
        "nonholonomic",
        "nonholonomic",
        "_forces _project_mass _project_forces",
        systems=("chaplygin_sleigh", "chaplygin_ball_centred"),
        tests=(
            *distributions.PARTICLE,
            *distributions.MOVING_MASS,
            *distributions.FORCED,
            *distributions.FRICTION,
        ),
        fallacies={
            "_forces: flip inertial": "ad* of the other sign",
            "_forces: drop inertial": "no ad* at all",
            "_forces: drop convected": "a constraint without ds/dt",
            "_forces: flip slope": "a torque of the other sign",
            "_forces: drop known": "a moving mass that does not move",
            "_forces: flip force in value": "an external force of the other sign",
            "_project_mass: omit b in return": "momenta that B does not project",
            "_project_forces: omit b": "forces that B does not project",
        },
    ),
    *core_of(
        "hamel",
        "hamel",
        "_right_side",
        systems=("chaplygin_sleigh", "chaplygin_ball_centred", "knife_edge_cvt"),
        tests=(
            *distributions.FORCED,
            *distributions.DRIVEN,
            "tests/prove/test_driven.py -k 'constraints_that_move_with or kept_constraint'",
            *distributions.TURNTABLE,
        ),
        fallacies={"_right_side: drop gyroscopic": "a constraint put in before varying"},
    ),
    *core_of(
        "projection",
        "projection",
        "nearest_state _residuals",
        systems=("suslov",),
        tests=distributions.PROJECTION,
        fallacies={
            "nearest_state: flip residual in sides": "a projection away from the constraints"
        },
    ),
    *core_of(
        "frames",
        "frames",
        "along bracket _extend rates_apart",
        systems=(),
        tests=(*distributions.FRAMES, *distributions.TURNTABLE),
        fallacies={
            "_extend: omit sign in return": "forces of a left-invariant body on a right one"
        },
    ),
    *core_of(
        "solver",
        "solver",
        "_eliminate _rest definitions",
        systems=(),
        tests=shared.SOLVER,
        equivalent={"_rest: transpose matrix": "the matrix of a solve is symmetric"},
    ),
)
