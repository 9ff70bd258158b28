"""Changes of what routes share: setting, Legendre transform, formulas, solves, momentum maps.

Where all routes go wrong together, no equality of routes sees it: then claims do, or the book.
Read next: `tests.mutation.changed_specs`.
"""

from __future__ import annotations

from tests.mutation.route_mutants import of

SETTING = "tests/derive/test_setting.py"
SOLVER = ("tests/derive/test_solver.py", "-k", "definitions_solve")
TIME = ("tests/sources/test_momentum_maps.py", "-k", "2_3_1")
PT = ("tests/sources/test_complex.py", "-k", "pt_symmetric")
TOP = ("heavy_top_goryachev_chaplygin",)

SHARED = (
    *of(
        "setting",
        "setting",
        TOP,
        (
            'return 1 if self.spec.invariance == "left" else -1',
            'return -1 if self.spec.invariance == "left" else 1',
        ),
        ("{place: self.taken(value) for", "{place: -self.taken(value) for"),
    ),
    *of(
        "setting",
        "setting",
        (),
        ('return 1 if self.spec.invariance == "left" else -1', "return 1"),
        tests=(SETTING, "-k", "sign_is_that"),
    ),
    *of(
        "legendre",
        "legendre",
        TOP,
        ("for mu, xi, w in pairs), -of.lagrangian)", "for mu, xi, w in pairs), of.lagrangian)"),
        ("for row in inverse(matrix))", "for row in matrix)"),
    ),
    *of(
        "legendre",
        "legendre",
        (),
        ("(1 / w) - field.substitute(slope", "(1 / w) + field.substitute(slope"),
        tests=("tests/derive/test_routes.py",),
    ),
    *of(
        "forces",
        "external",
        ("heavy_top_damped",),
        ("found[name] - s for name", "found[name] + s for name", "a friction that drives"),
        ("x + f for x, f in zip(free", "x - f for x, f in zip(free"),
    ),
    *of(
        "forces",
        "external",
        (),
        (".inverse_mass, along)", ".mass, along)"),
        ("+ force * weight", "+ force", "a symmetric matrix that is pulled twice"),
        tests=("tests/derive/test_external.py", "-k", "mass_matrix or symmetric"),
    ),
    *of(
        "formulas",
        "interpret",
        TOP,
        ('    "-": subtract,\n', '    "-": add,\n'),
        ("scale(1 / below[1], below[0])", "scale(below[1], below[0])"),
    ),
    *of(
        "formulas",
        "interpret",
        ("kepler",),
        ("scale(-field.one,", "scale(field.one,"),
    ),
    *of(
        "solver",
        "solver",
        (),
        ("self.solve.known[j] - taken", "self.solve.known[j] + taken"),
        ("[i][j] - self.field.sum(shared)", "[i][j] + self.field.sum(shared)"),
        ("self._z.get(i, self.field.zero) - after", "self._z.get(i, self.field.zero) + after"),
        ("self._w[i, k] * self._u[k, j] for", "self._u[k, j] for"),
        ("self._entry(name, value * share)", "self._entry(name, value)"),
        ("share = 1 / pivot", "share = pivot"),
        tests=SOLVER,
    ),
    *of(
        "momentum-maps",
        "symmetries",
        ("spd_motion",),
        ("covector[q] * moved for", "-covector[q] * moved for"),
        ("{q: field[p] / weight for", "{q: field[p] for"),
        (
            'sign = 1 if symmetry.side == "left" else -1',
            'sign = -1 if symmetry.side == "left" else 1',
        ),
    ),
    *of(
        "momentum-maps",
        "symmetries",
        ("c3_oscillators",),
        ("a * x for a, x in zip(row", "-a * x for a, x in zip(row"),
    ),
    *of(
        "momentum-maps",
        "symmetries",
        (),
        ("value = value - energy *", "value = value + energy *"),
        ("X = X - motion.like(scale(tau", "X = X + motion.like(scale(tau"),
        tests=TIME,
    ),
    *of(
        "reductions",
        "reductions",
        (),
        ("kept = tuple(rates[name] for", "kept = tuple(-rates[name] for"),
        tests=PT,
    ),
)
