"""Changes of the routes with constraints, and of the frames and distributions under them.

The routes share frames, distributions and kinematics, so that a change of these may turn both: then
systems that are solved by hand judge it.
Read next: `tests.mutation.shared_steps`.
"""

from __future__ import annotations

from tests.mutation.mutant import of, of_spec

BY_HAND = "tests/derive/test_nonholonomic.py"
FRAMES = ("tests/derive/test_frames.py",)
#: A body that rolls on a surface which turns: points of contact move, and by themselves, too.
TURNTABLE = ("tests/prove/test_contact.py -k work_of_a_turntable",)
DISTRIBUTIONS = ("tests/derive/test_distribution.py -k 'annihilate or affine or sign'",)
SLEIGH, BALL = ("chaplygin_sleigh",), ("chaplygin_ball_centred",)
#: Systems that depend on time, with rates typed by hand.
DRIVEN = ("tests/derive/test_driving.py",)
PRINCIPLE = "nonholonomic-hamilton-pontryagin"
PARTICLE = (f"{BY_HAND} -k particle",)
AFFINE = (f"{BY_HAND} -k constraint_that_moves",)
MOVING_MASS = (f"{BY_HAND} -k mass_that_moves",)
FORCED = (f"{BY_HAND} -k forces_and_dissipation",)
FRICTION = ("tests/derive/test_friction.py -k rod_of_painleve",)
REACTIONS = (f"{BY_HAND} -k 'force_of_the_particle or given or push'",)
ROOTS = ("tests/derive/test_kinematics.py -k quotient_rule",)
PENDULUM = (f"{BY_HAND} -k pendulum",)
PROJECTION = ("tests/derive/test_projection.py -k multiple",)

PROJECTED = ()

CONSTRAINED_LAGRANGIAN = (
    *of(
        "hamel",
        "hamel",
        BALL,
        "_right_side: use structure for bracket",
    ),
)

#: The principle with momenta and multipliers.
VARIED = (
    *of(
        PRINCIPLE,
        "nonholonomic_hamilton_pontryagin",
        BALL,
        ("_momentum_equations: flip force", "F of the other sign"),
        ("_momentum_equations: flip reaction", "reactions of the other sign"),
        (
            "_eliminate: rewrite _1(left[name], multipliers)"
            " -> _1(left[name], dict.fromkeys(multipliers, field.zero))",
            "reactions that turn nothing",
        ),
        (
            "_vary: rewrite _1.momenta[:own] -> _1.momenta[:3] + (setting.field.zero,) * 3",
            "momenta of given velocities put in before varying",
        ),
        "_rate: flip slope",
    ),
    *of(
        PRINCIPLE,
        "nonholonomic_hamilton_pontryagin",
        ("suslov",),
        "_kept_reactions: flip multiplier_name",
    ),
    *of(
        PRINCIPLE,
        "nonholonomic_hamilton_pontryagin",
        (),
        "_momentum_equations: flip outer",
        tests=FORCED,
    ),
)

#: What both routes share.
DISTRIBUTED = (
    *of(
        "projection",
        "projection",
        (),
        "nearest_state: use one for zero in Solve",
        ("_residuals: leave b in sum", "a projection that forgets what is affine"),
        tests=PROJECTION,
    ),
    *of(
        "projection",
        "projection",
        ("suslov",),
        "nearest_state: flip changes",
    ),
    *of(
        "frames",
        "frames",
        (),
        "rates_apart: rewrite _1 - setting.sign * _2 -> setting.sign * _2",
        tests=FRAMES,
    ),
    *of(
        "distribution",
        "distribution",
        (),
        "solved: flip derivative",
        "_equations: rewrite a - b -> b - a",
        tests=DISTRIBUTIONS,
    ),
    *of(
        "constrained",
        "kinematics",
        (),
        ("_convected: negate beta rate", "a moving constraint of the other sign"),
        tests=AFFINE,
    ),
    *of(
        "constrained",
        "kinematics",
        (),
        "differentiate: flip field in outer",
        ("differentiate: drop outer in slopes", "a root that moves twice"),
        ("_rates_of_roots: omit 2", "the slope of a root without its half"),
        tests=ROOTS,
    ),
    *of(
        "constrained",
        "constrained",
        (),
        "of_kept: flip carried",
        "reactions: flip multiplier_name",
        "solves: rewrite (*row, *none) -> (*(-a for a in row), *none)",
        tests=PENDULUM,
    ),
    *of(
        "constrained",
        "constrained",
        (),
        "reactions: flip forces",
        "reactions: flip others",
        "reactions: drop known",
        tests=REACTIONS,
    ),
)

#: Slips that are easy to write, each of which gives the motion of another body or of none.
SLIPS = (
    *of_spec(
        "chaplygin_ball",
        ("constraints.rolling: swap cross", "s x Omega in the place of Omega x s"),
    ),
)
