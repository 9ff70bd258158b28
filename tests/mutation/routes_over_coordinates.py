"""Changes of the routes on coordinates: brackets, Lagrange, Hamilton, Newton, Nambu.

Read next: `tests.mutation.shared_steps`, what these routes and those over algebras share.
"""

from __future__ import annotations

from tests.mutation.mutant import of

SOURCES = "tests/sources/test_configuration.py"
PAIRED_TWICE = ("tests/derive/test_configuration.py -k paired_twice",)
GYROSCOPIC = (f"{SOURCES} -k gyroscopic",)
CHRISTOFFEL = (
    f"{SOURCES} -k 'christoffel_symbols_of_the_sphere or christoffel_symbols_of_the_hyp'",
)
MASSES = ("tests/derive/test_configuration.py -k row_has_its_mass",)
FOUND = ("tests/sources/test_tops.py -k 2_5_4",)
#: Systems that depend on time, with rates typed by hand.
DRIVEN = ("tests/derive/test_driving.py",)

BRACKETS = (
    *of(
        "poisson",
        "poisson",
        ("nambu_body", "sp2_momentum"),
        "hamiltonian_equations: compare-Eq entry",
    ),
    *of(
        "poisson",
        "structure",
        ("kepler",),
        "_declared_structure: reverse names in pairs",
    ),
    *of(
        "poisson",
        "structure",
        ("monopole_kepler",),
        ("_declared_structure: reverse names in fields", "the magnetic bracket of the other sign"),
    ),
    *of(
        "nambu",
        "nambu",
        ("nambu_body",),
        "derive: reverse gradients",
    ),
    *of(
        "nambu",
        "nambu",
        ("rigid_body",),
        "distinguished_function: reverse 0 2",
    ),
    *of(
        "nambu",
        "nambu",
        (),  # algebras that are not unimodular
        "_from_casimir: rewrite _1 / _2 -> _2 / _1",
        tests=FOUND,
    ),
)

#: Singular Lagrangians, with rates by hand.
SINGULAR = (
    "tests/derive/test_first_order.py "
    "-k 'vortices_turn or gives_the_rest or declared_to_follow or moves_with_time'",
)

FIRST_ORDER = (
    *of(
        "first-order",
        "mechanics/bound",
        (),
        (
            "Form.two_form: rewrite slopes[j][i] - slopes[i][j] -> slopes[i][j] - slopes[j][i]",
            "omega of the other sign",
        ),
        tests=SINGULAR,
    ),
    *of(
        "first-order",
        "mechanics/bound",
        (),
        "Form.put: rewrite named[x] + own * slope -> named[x]",
        tests=("tests/derive/test_first_order.py -k give_momenta_and_multipliers",),
    ),
    *of(
        "first-order",
        "mechanics/first_order",
        (),
        "_whole_form: rewrite p - slope -> p + slope",
        tests=SINGULAR,
    ),
    *of(
        "first-order",
        "routes/first_order",
        (),
        "_rates_by_bracket: rewrite explicit(_1, _2) + _3 -> explicit(_1, _2)",
        tests=SINGULAR,
    ),
    *of(
        "first-order",
        "mechanics/bound",
        (),
        "bind: rewrite x - field.substitute(f, still) -> x + field.substitute(f, still)",
        tests=("tests/derive/test_bound_momenta.py -k constraints_of_constraints",),
    ),
    *of(
        "first-order",
        "mechanics/singular",
        (),
        "laws: rewrite a + b + f -> a + b",
        tests=("tests/derive/test_bound_momenta.py -k friction_on_momenta",),
    ),
    *of(
        "first-order",
        "mechanics/bound_momenta",
        (),
        "BoundMomenta.push: rewrite force - part -> force",
        tests=("tests/derive/test_bound_momenta.py -k everything",),
    ),
)

LAGRANGE = (
    *of(
        "euler-lagrange",
        "euler_lagrange",
        ("rocking_disk",),
        "_in_velocities: use mass for inverse_mass",
        "_in_velocities: rewrite v + moved -> moved + v",
    ),
    *of(
        "euler-lagrange",
        "euler_lagrange",
        (),
        "christoffel_first: rewrite _1 - slope[a][b][c] -> _1 + slope[a][b][c]",
        tests=CHRISTOFFEL,
    ),
    *of(
        "euler-lagrange",
        "structure",
        (),
        "_of_configuration: rewrite A[j][i] - A[i][j] -> A[i][j] - A[j][i]",
        "_of_configuration: flip w",
        tests=GYROSCOPIC,
    ),
    *of(
        "euler-lagrange",
        "configuration",
        ("rocking_disk",),
        "energy: flip lagrangian",
    ),
    *of(
        "euler-lagrange",
        "configuration",
        (),
        "conjugates: flip substitute",
        tests=GYROSCOPIC,
    ),
)

HAMILTON = (
    *of(
        "canonical",
        "canonical",
        ("kepler",),
        "_hamilton: flip slopes in p",
    ),
    *of(
        "canonical",
        "canonical",
        ("monopole_kepler",),
        "_hamilton: drop turning",
    ),
    *of(
        "canonical",
        "canonical",
        ("spd_motion",),
        "_hamilton: omit weight in q",
        "_hamilton: omit weight in p",
    ),
)

NEWTON = (
    *of(
        "newton",
        "newton",
        ("kepler",),
        "derive: rewrite accelerations(setting) -> velocities",
        "derive: rewrite zip(_1.positions, _2, strict=True)"
        " -> zip(_1.positions, _2[::-1], strict=True)",
    ),
    *of(
        "newton",
        "forces",
        (),
        "_acceleration: use mass for inverse in apply",
        "_acceleration: rewrite (_1 for row in _2 for k in _3) -> (_1 for k in _3 for row in _2)",
        tests=MASSES,
    ),
    *of(
        "alignment",
        "alignment",
        ("kepler", "monopole_kepler"),  # a central force, then one across r and with v in it
        "derive: bare Quaternion",
        "derive: rewrite dot(chi, r) -> dot(chi, r) - 1",
    ),
    *of(
        "alignment",
        "alignment",
        ("monopole_kepler",),
        "derive: unwrap substitute",
    ),
)
