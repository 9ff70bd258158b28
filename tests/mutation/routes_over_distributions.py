"""Changes of the routes with constraints, and of the frames and distributions under them.

The routes share frames, distributions and kinematics, so that a change of these may turn both: then
systems that are solved by hand judge it.
Read next: `tests.mutation.shared_steps`.
"""

from __future__ import annotations

from tests.mutation.route_mutants import of, of_spec

BY_HAND = "tests/derive/test_nonholonomic.py"
FRAMES = ("tests/derive/test_frames.py",)
DISTRIBUTIONS = ("tests/derive/test_distribution.py", "-k", "annihilate or affine or sign")
SLEIGH, BALL = ("chaplygin_sleigh",), ("chaplygin_ball_centred",)
#: Systems that depend on time, with rates typed by hand.
DRIVEN = ("tests/derive/test_driving.py",)
PRINCIPLE = "nonholonomic-hamilton-pontryagin"
PARTICLE = (BY_HAND, "-k", "particle")
AFFINE = (BY_HAND, "-k", "constraint_that_moves")
MOVING_MASS = (BY_HAND, "-k", "mass_that_moves")
FORCED = (BY_HAND, "-k", "forces_and_dissipation")
REACTIONS = (BY_HAND, "-k", "force_of_the_particle or given or push")
ROOTS = ("tests/derive/test_kinematics.py", "-k", "quotient_rule")
PENDULUM = (BY_HAND, "-k", "pendulum")
PROJECTION = ("tests/derive/test_projection.py", "-k", "multiple")

PROJECTED = (
    *of(
        "nonholonomic",
        "nonholonomic",
        SLEIGH,
        ("value = inertial + slope", "value = -inertial + slope", "ad* of the other sign"),
        ("value = inertial + slope", "value = slope", "no ad* at all"),
    ),
    *of(
        "nonholonomic",
        "nonholonomic",
        BALL,
        (
            "field.sum(m * b for m, b in zip(row, column,",
            "field.sum(m for m, b in zip(row, column,",
        ),
        (
            "field.sum(b * x for b, x in zip(column, other, strict=True) if b)",
            "field.sum(x for b, x in zip(column, other, strict=True) if b)",
            "momenta that B does not project",
        ),
        ("- convected - motion.moved(p)", "- motion.moved(p)", "a constraint without ds/dt"),
        ("- convected - motion.moved(p)", "+ convected - motion.moved(p)"),
    ),
    *of(
        "nonholonomic",
        "nonholonomic",
        (),
        (
            "field.sum(b * f for b, f in zip(column, forces,",
            "field.sum(f for b, f in zip(column, forces,",
            "forces that B does not project",
        ),
        tests=PARTICLE,
    ),
    *of(
        "nonholonomic",
        "nonholonomic",
        ("chaplygin_ball",),
        ("+ slope + force", "- slope + force", "a torque of the other sign"),
    ),
    *of(
        "nonholonomic",
        "nonholonomic",
        (),
        ("- convected - motion.moved(p)", "- convected", "a moving mass that does not move"),
        tests=MOVING_MASS,
    ),
    *of(
        "nonholonomic",
        "nonholonomic",
        (),
        ("+ slope + force", "+ slope - force", "an external force of the other sign"),
        tests=FORCED,
    ),
)

CONSTRAINED_LAGRANGIAN = (
    *of(
        "hamel",
        "hamel",
        (),  # constraints that move
        ("[a + b for a, b in zip(frame", "[a - b for a, b in zip(frame"),
        ("carried += explicit_rate", "carried -= explicit_rate"),
        tests=(*DRIVEN, "tests/prove/test_driven.py"),
    ),
    *of(
        "hamel",
        "hamel",
        SLEIGH,
        ("+ gyroscopic + driven", "+ driven", "a constraint put in before varying"),
        ("+ gyroscopic + driven", "- gyroscopic + driven"),
    ),
    *of(
        "hamel",
        "hamel",
        BALL,
        ("zip(frame.bracket(found.xi, D), own", "zip(frame.structure(found.xi, D), own"),
        ("zip(frame.bracket(found.xi, D), own", "zip(frame.bracket(D, found.xi), own"),
        ("+ driven - carried", "+ driven"),
        ("+ driven - carried", "+ driven + carried"),
    ),
    *of(
        "hamel",
        "hamel",
        ("knife_edge_cvt",),
        ("frame.along(D, constrained) +", "-frame.along(D, constrained) +"),
    ),
    *of(
        "hamel",
        "hamel",
        (),
        ("+ driven - carried", "- driven - carried"),
        tests=FORCED,
    ),
)

#: The principle with momenta and multipliers.
VARIED = (
    *of(
        PRINCIPLE,
        "nonholonomic_hamilton_pontryagin",
        BALL,
        ("moved) - force - outer", "moved) + force - outer", "F of the other sign"),
        ("outer - reaction", "outer + reaction", "reactions of the other sign"),
        (
            "field.substitute(left[name], multipliers)",
            "field.substitute(left[name], dict.fromkeys(multipliers, field.zero))",
            "reactions that turn nothing",
        ),
        (
            "known.momenta[:own])",
            "known.momenta[:3] + (setting.field.zero,) * 3)",
            "momenta of given velocities put in before varying",
        ),
        ("own + field.sum(slope * x", "own - field.sum(slope * x"),
    ),
    *of(
        PRINCIPLE,
        "nonholonomic_hamilton_pontryagin",
        ("suslov",),
        ("-field[multiplier_name(n)]", "field[multiplier_name(n)]"),
    ),
    *of(
        PRINCIPLE,
        "nonholonomic_hamilton_pontryagin",
        (),
        ("force - outer - reaction", "force + outer - reaction"),
        tests=FORCED,
    ),
)

#: What both routes share.
DISTRIBUTED = (
    *of(
        "projection",
        "projection",
        (),
        ("-residual for n", "residual for n", "a projection away from the constraints"),
        ("sides.get(name, field.zero)", "sides.get(name, field.one)"),
        (", motion.named(b)]", "]", "a projection that forgets what is affine"),
        tests=PROJECTION,
    ),
    *of(
        "projection",
        "projection",
        ("suslov",),
        ("+ changes.get(name, field.zero)", "- changes.get(name, field.zero)"),
    ),
    *of(
        "frames",
        "frames",
        (),
        ("setting.field.zero - setting.sign * x", "setting.sign * x"),
        ("self.along(a, y) - self.along(b, x) + c", "self.along(a, y) + self.along(b, x) + c"),
        ("self.along(a, y) - self.along(b, x) + c", "-self.along(b, x) + c"),
        ("self.along(a, y) - self.along(b, x) + c", "self.along(a, y) - self.along(b, x)"),
        (
            "found = setting.algebra.bracket(a[: self._own], b[: self._own])",
            "found = setting.algebra.bracket(b[: self._own], a[: self._own])",
        ),
        (
            "found = setting.algebra.ad_star(vector[: self._own], momenta[: self._own])\n"
            "        return (*(setting.field.zero + setting.sign * x",
            "found = setting.algebra.ad_star(vector[: self._own], momenta[: self._own])\n"
            "        return (*(setting.field.zero + x",
            "a right invariant body with the forces of a left invariant one",
        ),
        tests=FRAMES,
    ),
    *of(
        "distribution",
        "distribution",
        (),
        (
            "field[name] - residual / field.derivative(residual, name)",
            "field[name] + residual / field.derivative(residual, name)",
        ),
        ("Equation(name, reaction, a - b, solves)", "Equation(name, reaction, b - a, solves)"),
        tests=DISTRIBUTIONS,
    ),
    *of(
        "constrained",
        "kinematics",
        (),
        ("self.rate(beta)])", "-self.rate(beta)])", "a moving constraint of the other sign"),
        tests=AFFINE,
    ),
    *of(
        "constrained",
        "kinematics",
        (),
        ("(rest - field[name]) / field[root]", "(rest + field[name]) / field[root]"),
        ("slopes[z] - outer * slope", "slopes[z]", "a root that moves twice"),
        ("/ (2 * field[root])", "/ field[root]", "the slope of a root without its half"),
        tests=ROOTS,
    ),
    *of(
        "constrained",
        "constrained",
        (),
        ("known.append(-field.sum([*carried,", "known.append(field.sum([*carried,"),
        ("equation.reaction: -field[multiplier", "equation.reaction: field[multiplier"),
        ("*((*row, *none) for row in rows)", "*((*(-a for a in row), *none) for row in rows)"),
        tests=PENDULUM,
    ),
    *of(
        "constrained",
        "constrained",
        (),
        ("(inertia - forces[place] - others)", "(inertia + forces[place] - others)"),
        ("(inertia - forces[place] - others)", "(inertia - forces[place] + others)"),
        ("turned[n] + self.c[n])", "turned[n])"),
        tests=REACTIONS,
    ),
)

#: Slips that are easy to write, each of which gives the motion of another body or of none.
SLIPS = (
    *of_spec(
        "chaplygin_ball",
        (
            'rolling = "Y == cross(Omega, s)"',
            'rolling = "Y == cross(s, Omega)"',
            "s x Omega in the place of Omega x s",
        ),
    ),
)
