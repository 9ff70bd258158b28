"""Changes of the routes that start from a Lie algebra, each judged by certificates of systems.

Read next: `tests.mutation.routes_over_coordinates`.
"""

from __future__ import annotations

from tests.mutation.route_mutants import of

#: Affine motion has little to reckon with; a top has advected quantities beside.
PLAIN = ("affine_line", "heavy_top_goryachev_chaplygin")
TOP = ("heavy_top",)
LAX = "tests/derive/test_lax.py"
BODIES = "tests/derive/test_bodies.py"
TOPS = "tests/sources/test_tops.py"
#: Momenta seen from space by matrices.
FROM_THE_RIGHT = ("tests/derive/test_group_routes.py", "-k", "last_row")
SEEN = ("tests/sources/test_principles.py", "-k", "7_1_3 or 4_2_2 or 2_1_1")
MANAKOV = ("tests/sources/test_lax.py", "-k", "2_4_2_three or 2_4_2_manakov or every_inertia")

REDUCED = (
    *of(
        "euler-poincare",
        "euler_poincare",
        PLAIN,
        ("[-sign * x for x in", "[sign * x for x in"),
        ("[m + t for", "[m - t for"),
        ("[sign * m for m in momentum]", "[-sign * m for m in momentum]"),
        ("torque = action.diamond(dl_da, a)", "torque = action.diamond(a, dl_da)"),
        ("[m + t for m, t in", "[m for m, t in"),
    ),
    *of(
        "matrix-euler-poincare",
        "matrix_euler_poincare",
        ("quadratic_potential_so3",),
        ("commutator(transpose(M), xi)", "commutator(M, xi)"),
        ("add(torque, push)", "subtract(torque, push)"),
        ("add(torque, push)", "torque"),
        ("add(moved, transpose(moved))", "moved"),
        ("scale(-2, product(a, b))", "scale(-1, product(a, b))"),
    ),
    *of(
        "matrix-euler-poincare",
        "matrix_euler_poincare",
        (),  # no shipped potential has terms beside the diagonal
        ("half * x for j, x", "x for j, x"),
        tests=(LAX, "-k", "move_advected"),
    ),
    *of(
        "lie-poisson",
        "structure",
        PLAIN,
        ("sign = -setting.sign", "sign = setting.sign", "the plus bracket for left invariance"),
    ),
    *of(
        "lie-poisson",
        "structure",
        ("quadratic_potential_so3",),  # symmetric matrices are not their own dual, vectors are
        ("action.dual()) for name", "action) for name"),
    ),
    *of(
        "lie-poisson",
        "legendre",
        ("quadratic_potential_so3", "affine_line"),
        ("return transform.energy, transform", "return -transform.energy, transform"),
        ("return setting.hamiltonian, ()", "return -setting.hamiltonian, ()"),
    ),
    *of(
        "hamilton-pontryagin",
        "hamilton_pontryagin",
        PLAIN,
        ("x - setting.sign * dx for", "x + setting.sign * dx for"),
        ("rate - setting.sign * turn / 2", "rate + setting.sign * turn / 2"),
        ("rate - setting.sign * turn / 2", "rate - setting.sign * turn"),
        ("force - field.sum(carried)", "force + field.sum(carried)"),
        ("force - field.sum(carried)", "force"),
        ("dict(rates) | dict.fromkeys(", "dict.fromkeys("),
        (
            "field.substitute(lagrangian, moved) + field.sum(mu * c for mu, c in pairing)",
            "field.substitute(lagrangian, moved)",
            "g^-1 dg/dt = xi put in before varying",
        ),
    ),
    *of(
        "hamilton-pontryagin",
        "reconstruction",
        ("rigid_body_attitude",),
        ("(q, q.conjugate) if", "(q.conjugate, q) if"),
    ),
    *of(
        "hamilton-pontryagin",
        "reconstruction",
        (),
        ("scale(-1, apply(turn", "scale(1, apply(turn"),
        tests=FROM_THE_RIGHT,
    ),
    *of(
        "hamilton-pontryagin",
        "reconstruction",
        (),
        ("return transpose(g)", "return g"),
        tests=SEEN,
    ),
    *of(
        "clebsch",
        "clebsch",
        PLAIN[:1] + TOP,
        ("(-slope for slope in field.gradient(action, p))", "field.gradient(action, p)"),
        (
            "zip(p, field.gradient(action, q)",
            "zip(p, (-s for s in field.gradient(action, q))",
        ),
        ("zip(p, field.gradient(action, q)", "zip(p, field.gradient(pairing, q)"),
        ("tuple(-slope for slope in", "tuple(slope for slope in"),
        ("return setting.sign * field.sum(total)", "return -setting.sign * field.sum(total)"),
        ("(name, field.substitute(x, image)) for", "(name, -field.substitute(x, image)) for"),
        (
            "action = lagrangian + pairing",
            "action = lagrangian",
            "dq/dt + rho(xi) q = 0 put in before varying",
        ),
    ),
    *of(
        "poincare",
        "poincare",
        PLAIN[:1] + TOP,
        ("found[s] += setting.sign * c", "found[s] -= setting.sign * c"),
        ("found[k] -= setting.sign * c", "found[k] += setting.sign * c"),
        ("field.zero) - setting.sign * entry", "field.zero) + setting.sign * entry"),
        ("c * eta[k] * slopes[i]", "c * eta[k] * slopes[k]"),
        ("momentum = [a + b for", "momentum = [a - b for"),
        ("momentum = [a + b for", "momentum = [a for"),
    ),
)

BODY_ROUTES = (
    *of(
        "cayley-klein",
        "cayley_klein",
        ("rigid_body_attitude", "heavy_top"),
        ("total = [-mu * x for mu", "total = [mu * x for mu"),
        ("body.product(body.omega.conjugate, pi)", "body.product(body.omega, pi)"),
        ("return HALF * self.product(self.q", "return self.product(self.q"),
        ("product(self.q, self.omega)", "product(self.omega, self.q)"),
        ("HALF * (turning + slopes)", "HALF * turning"),
    ),
    *of(
        "cayley-klein",
        "cayley_klein",
        TOP,
        ("body.product(a, h) - body.product(h, a)", "body.product(h, a) - body.product(a, h)"),
        ("turned.product(q.conjugate, a, q)", "turned.product(q, a, q.conjugate)"),
    ),
    *of(
        "newton-euler",
        "newton_euler",
        TOP,
        ("subtract(torque, turning)", "add(torque, turning)"),
        ("subtract(torque, turning)", "torque"),
        ("setting.field, -_at_rest(", "setting.field, _at_rest("),
        ("half = trace(inertia) / 2", "half = trace(inertia)"),
        (
            "lambda x, y: cross(x, cross(omega, cross(omega, y)))",
            "lambda x, y: cross(x, cross(omega, cross(y, omega)))",
        ),
        ("subtract(scale(half, AXES), inertia)", "add(scale(half, AXES), inertia)"),
    ),
    *of(
        "newton-euler",
        "newton_euler",
        (),  # a body that moves about another origin than its centre of mass
        ("lambda x: cross(x, cross(omega, v))", "lambda x: cross(x, cross(v, omega))"),
        ("(mass[2][4], mass[0][5], mass[1][3])", "(mass[1][5], mass[2][3], mass[0][4])"),
        ("add(scale(points.mass, cross(omega, v)), inner)", "inner"),
        tests=(TOPS, "-k", "2_1_2"),
    ),
    *of(
        "kaluza-klein",
        "kaluza_klein",
        TOP,
        ("varied -= dot(", "varied += dot("),
        ("kinetic = lagrangian - dot(level, a)", "kinetic = lagrangian"),
        ("scale(-sign, setting", "scale(sign, setting"),
        ("algebra.bracket(xi, eta)", "algebra.bracket(eta, xi)"),
        ("field[name] - value", "field[name] + value"),
        (
            "field.substitute(slope, solved) for slope in field.gradient(whole, names)",
            "slope for slope in field.gradient(field.substitute(whole, solved), names)",
            "dq/dt = p - a put in before varying",
        ),
    ),
    *of(
        "kaluza-klein",
        "kaluza_klein",
        (),
        ("append(sign * varied)", "append(varied)"),
        tests=(BODIES, "-k", "kaluza_klein_follows and right"),
    ),
    *of(
        "complexification",
        "complexification",
        ("complex_rigid_body",),
        ("*(z.im for z in moved)", "*(-z.im for z in moved)"),
        ("setting.sign * part", "-setting.sign * part"),
        ("Complex(x, y) for x", "Complex(y, x) for x"),
        ("real.bracket(zeta, eta)", "real.bracket(eta, zeta)"),
        ("_continued(setting, slope, L) for slope", "Complex(slope, setting.field.zero) for slope"),
    ),
    *of(
        "complexification",
        "complexification",
        (),  # velocities are named beside the motion, which does not use them
        ("*(-z.im for z in zeta)", "*(z.im for z in zeta)"),
        tests=("tests/sources/test_complex.py", "-k", "complex_velocities"),
    ),
)

PAIRS = (
    *of(
        "lax",
        "pairs",
        ("bloch_iserles_3",),
        ("rows[n].right * value", "-rows[n].right * value"),
        ("rights.get(power, field.zero)", "rights.get(power + 1, field.zero)"),
        ("commutator(pair.L, pair.M)", "commutator(pair.M, pair.L)"),
        ("turned = commutator(pair.L, pair.M)", "turned = pair.L"),
    ),
    *of(
        "lax",
        "integrals",
        ("rigid_body",),
        ("field.sum(x * y for x, y in pairs if x and y)", "field.sum(x + y for x, y in pairs)"),
    ),
    *of(
        "lax",
        "integrals",
        ("manakov_so4",),
        ("yield ordered[place - len(known)]", "yield ordered[place - 1]"),
    ),
    *of(
        "manakov",
        "planes",
        ("rigid_body",),
        ("return a, tuple(x**2 for x in a)", "return a, a"),
        ("(turn * spectral, diagonal(a))", "(-turn * spectral, diagonal(a))"),
        ("entries | {(j, i): -value for", "entries | {(j, i): value for"),
    ),
    *of(
        "manakov",
        "planes",
        ("quadratic_potential_so3",),
        ("[(-share, body.field)", "[(share, body.field)", "the potential +S in the pair found"),
    ),
    *of(
        "manakov",
        "planes",
        (),  # another pair is found then, which is right, too, but not the book's
        ("- inertia[1, 2]) / 2", "+ inertia[1, 2]) / 2"),
        ("inertia[0, j] - first for j", "inertia[0, j] + first for j"),
        ("span.add({i: own, j: -other})", "span.add({i: own, j: other})"),
        ("inertia[0, j] * a[j] for j", "-inertia[0, j] * a[j] for j"),
        tests=MANAKOV,
    ),
)
