"""Changes of the routes on coordinates: brackets, Lagrange, Hamilton, Newton, Nambu.

Read next: `tests.mutation.shared_steps`, what these routes and those over algebras share.
"""

from __future__ import annotations

from tests.mutation.route_mutants import of

SOURCES = "tests/sources/test_configuration.py"
PAIRED_TWICE = ("tests/derive/test_configuration.py", "-k", "paired_twice")
GYROSCOPIC = (SOURCES, "-k", "gyroscopic")
CHRISTOFFEL = (SOURCES, "-k", "christoffel_symbols_of_the_sphere or christoffel_symbols_of_the_hyp")
MASSES = ("tests/derive/test_configuration.py", "-k", "row_has_its_mass")
FOUND = ("tests/sources/test_tops.py", "-k", "2_5_4")
#: Systems that depend on time, with rates typed by hand.
DRIVEN = ("tests/derive/test_driving.py",)

BRACKETS = (
    *of(
        "poisson",
        "poisson",
        ("nambu_body", "sp2_momentum"),
        ("sum(entry * slope for", "sum(-entry * slope for"),
        ("if entry != 0)", "if entry == 0)"),
    ),
    *of(
        "poisson",
        "structure",
        ("kepler",),
        (
            "[(names[i], names[j]) for i, j in bracket.pairs]",
            "[(names[j], names[i]) for i, j in bracket.pairs]",
        ),
    ),
    *of(
        "poisson",
        "structure",
        ("monopole_kepler",),
        (
            "{(names[i], names[j]): value for",
            "{(names[j], names[i]): value for",
            "the magnetic bracket of the other sign",
        ),
    ),
    *of(
        "nambu",
        "nambu",
        ("nambu_body",),
        ("-multiplier * rate for", "multiplier * rate for"),
        ("[dh, *gradients[:-1]]", "[*gradients[:-1], dh]"),
        ("(-1) ** i * minor", "minor"),
    ),
    *of(
        "nambu",
        "nambu",
        ("rigid_body",),
        ("b = tuple(-tensor[i][j]", "b = tuple(tensor[i][j]"),
        ("dot(x, b) / 2", "dot(x, b)"),
        ("(1, 2), (2, 0), (0, 1)", "(1, 2), (0, 2), (0, 1)"),
    ),
    *of(
        "nambu",
        "nambu",
        (),  # algebras that are not unimodular
        ("b[place] / slopes[place]", "slopes[place] / b[place]"),
        ("slopes[i][j] - slopes[j][i]", "slopes[i][j] + slopes[j][i]"),
        tests=FOUND,
    ),
)

LAGRANGE = (
    *of(
        "euler-lagrange",
        "euler_lagrange",
        (),  # Lagrangians that depend on time
        ("[slope - c - e for slope", "[slope - c + e for slope"),
        ("[slope - c - e for slope", "[slope - c for slope"),
        tests=DRIVEN,
    ),
    *of(
        "euler-lagrange",
        "euler_lagrange",
        ("rocking_disk",),
        ("[slope - c - e for slope", "[slope + c - e for slope"),
        ("[slope - c - e for slope", "[slope - e for slope"),
        ("moved = apply(known.inverse_mass,", "moved = apply(known.mass,"),
        ("zip(setting.positions + setting.velocities, v + moved", "zip(setting.state, moved + v"),
    ),
    *of(
        "euler-lagrange",
        "euler_lagrange",
        (),
        ("{p: slope * weight for", "{p: -slope * weight for"),
        ("{p: slope * weight for", "{p: slope for"),
        tests=PAIRED_TWICE,
    ),
    *of(
        "euler-lagrange",
        "euler_lagrange",
        (),
        ("slope[c][b][a] - slope[a]", "slope[c][b][a] + slope[a]"),
        tests=CHRISTOFFEL,
    ),
    *of(
        "euler-lagrange",
        "structure",
        (),
        ("A[j][i] - A[i][j]", "A[i][j] - A[j][i]"),
        ("(*(-w for w in", "(*(w for w in"),
        tests=GYROSCOPIC,
    ),
    *of(
        "euler-lagrange",
        "configuration",
        ("rocking_disk",),
        ("velocities) - self.lagrangian", "velocities) + self.lagrangian"),
    ),
    *of(
        "euler-lagrange",
        "configuration",
        (),
        ("[y - field.substitute(slope", "[y + field.substitute(slope"),
        tests=GYROSCOPIC,
    ),
)

HAMILTON = (
    *of(
        "canonical",
        "canonical",
        ("kepler",),
        ("rates[p] = turning - slopes[q]", "rates[p] = turning + slopes[q]"),
    ),
    *of(
        "canonical",
        "canonical",
        ("monopole_kepler",),
        ("rates[p] = turning - slopes[q]", "rates[p] = -slopes[q]"),
        (
            "(names[j], names[i]): -value",
            "(names[j], names[i]): value",
            "a magnetic bracket that is not antisymmetric",
        ),
    ),
    *of(
        "canonical",
        "canonical",
        ("rocking_disk",),
        ("h = field.sum(products) - field", "h = field.sum(products) + field"),
    ),
    *of(
        "canonical",
        "canonical",
        ("spd_motion",),
        ("else slopes[p] * weight", "else slopes[p]"),
        ("- slopes[q] * weight", "- slopes[q]"),
    ),
)

NEWTON = (
    *of(
        "newton",
        "newton",
        ("kepler",),
        ("zip(setting.velocities, accelerations(setting),", "zip(setting.velocities, velocities,"),
        ("zip(setting.positions, velocities,", "zip(setting.positions, velocities[::-1],"),
    ),
    *of(
        "newton",
        "forces",
        ("kepler",),
        ("inverse[0][0] * component", "-inverse[0][0] * component"),
    ),
    *of(
        "newton",
        "forces",
        (),
        ("apply(inverse, force", "apply(mass, force"),
        (
            "for row in range(len(mass)) for k in range(columns)",
            "for k in range(columns) for row in range(len(mass))",
        ),
        tests=MASSES,
    ),
    *of(
        "alignment",
        "alignment",
        ("kepler", "monopole_kepler"),  # a central force, then one across r and with v in it
        ("(source - q * q)", "(source + q * q)"),
        ("(source - q * q)", "source"),
        ("scale(alpha, r), cross(chi, r)", "scale(alpha, r), cross(r, chi)"),
        (".scale(1 / dot(r, r))", ""),
        ('"chi . r = 0", dot(chi, r)', '"chi . r = 0", dot(chi, r) - 1'),
    ),
    *of(
        "alignment",
        "alignment",
        ("monopole_kepler",),
        ("*cross(r, force))", "*cross(force, r))"),
        ("= tuple(field.substitute(f, moved) for f in", "= tuple(f for f in"),
    ),
)
