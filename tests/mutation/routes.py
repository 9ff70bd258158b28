"""Single changes to the routes that must be refuted: a sign flipped, a term dropped.

Each names a route, the module that derives it, a piece of text that occurs exactly once there, what
takes its place, and the shipped systems whose certificates judge it.
"""

from __future__ import annotations

from dataclasses import dataclass

DERIVE = "src/coadjoint/derive/"


@dataclass(frozen=True)
class RouteMutant:
    """One change of a derivation.

    Attributes:
        route: As specs name it.
        module: The file's stem in ``derive/``.
        old: What is there, once.
        new: What takes its place.
        systems: Whose certificates judge it.
        tests: Source tests that judge what those let pass.
    """

    route: str
    module: str
    old: str
    new: str
    systems: tuple[str, ...]
    tests: tuple[str, ...] = ()

    @property
    def file(self) -> str:
        """Path below the root of the repository."""
        return f"{DERIVE}{self.module}.py"

    @property
    def name(self) -> str:
        """Short name for reports."""
        return f"{self.route}: {self.old.strip()} -> {self.new.strip()}"


def _of(
    route: str, module: str, systems: tuple[str, ...], *changes: tuple[str, str]
) -> tuple[RouteMutant, ...]:
    """Several changes of one module."""
    return tuple(RouteMutant(route, module, old, new, systems) for old, new in changes)


#: Tests of configuration spaces: of states with momenta, geodesics and velocity brackets.
CONFIGURATION = ("tests/sources/test_configuration.py", "tests/derive/test_configuration.py")

#: Momenta seen from space by matrices.
FROM_THE_RIGHT = ("tests/derive/test_group_routes.py", "-k", "last_row")
SEEN = ("tests/sources/test_principles.py", "-k", "7_1_3 or 4_2_2 or 2_1_1")
MANAKOV = ("tests/sources/test_lax.py", "-k", "2_4_2 or 2_5_6 or every_inertia")
ROUTE_MUTANTS = (
    *_of(
        "euler-poincare",
        "euler_poincare",
        ("heavy_top", "affine_line"),
        ("[-sign * x for x in", "[sign * x for x in"),
        ("[m + t for", "[m - t for"),
        ("[sign * m for m in momentum]", "[-sign * m for m in momentum]"),
        ("torque = action.diamond(dl_da, a)", "torque = action.diamond(a, dl_da)"),
        ("[m + t for m, t in", "[m for m, t in"),
    ),
    *_of(
        "matrix-euler-poincare",
        "matrix_euler_poincare",
        ("quadratic_potential_so3",),
        ("bracket(field, _turned(M), xi)", "bracket(field, M, xi)"),
        ("(field.one, torque), (field.one, push)", "(field.one, torque), (-field.one, push)"),
        ("(field.one, torque), (field.one, push)", "(field.one, torque)"),
        ("(-field.one, moved), (-field.one, _turned(moved))", "(-field.one, moved)"),
        ("field.number(-2)", "field.number(-1)"),
    ),
    RouteMutant(
        "matrix-euler-poincare",
        "matrix_euler_poincare",
        "half * x for j, x",
        "x for j, x",
        (),  # no shipped potential has terms beside the diagonal
        ("tests/derive/test_lax.py", "-k", "move_advected"),
    ),
    *_of(
        "lax",
        "pairs",
        ("bloch_iserles_3", "quadratic_potential_so3"),
        ("tuple(x - y for x, y", "tuple(x + y for x, y"),
        ("rows[n].right * value", "-rows[n].right * value"),
        ("rights.get(power, field.zero)", "rights.get(power + 1, field.zero)"),
        ("turned = bracket(field, pair.L, pair.M)", "turned = bracket(field, pair.M, pair.L)"),
        ("turned = bracket(field, pair.L, pair.M)", "turned = multiplied(field, pair.L, pair.M)"),
    ),
    *_of(
        "manakov",
        "manakov",
        ("rigid_body", "quadratic_potential_so3"),
        ("return a, tuple(x**2 for x in a)", "return a, a"),
        ("[(-share, body.field)", "[(share, body.field)"),
        ("(turn * spectral, diagonal(field, a))", "(-turn * spectral, diagonal(field, a))"),
        ("entries | {(j, i): -value for", "entries | {(j, i): value for"),
    ),
    *(
        # another pair is found then, which is right, too, but not the book's
        RouteMutant("manakov", "manakov", old, new, (), MANAKOV)
        for old, new in (
            ("- inertia[1, 2]) / 2", "+ inertia[1, 2]) / 2"),
            ("inertia[0, j] - first for j", "inertia[0, j] + first for j"),
        )
    ),
    *(
        RouteMutant("manakov", "manakov", old, new, (), MANAKOV)
        for old, new in (
            ("span.add({i: own, j: -other})", "span.add({i: own, j: other})"),
            ("inertia[0, j] * a[j] for j", "-inertia[0, j] * a[j] for j"),
        )
    ),
    *_of(
        "lie-poisson",
        "structure",
        ("heavy_top", "affine_line"),
        ("sign = -setting.sign", "sign = setting.sign"),
        ("action.dual()) for name", "action) for name"),
    ),
    *_of(
        "poisson",
        "poisson",
        ("nambu_body", "sp2_momentum"),
        ("sum(entry * slope for", "sum(-entry * slope for"),
        ("if entry != 0)", "if entry == 0)"),
    ),
    *_of(
        "euler-lagrange",
        "euler_lagrange",
        ("rocking_disk",),
        ("[slope - c for slope, c", "[slope + c for slope, c"),
        ("[slope - c for slope, c", "[slope for slope, c"),
        ("moved = applied(field, known.inverse_mass,", "moved = applied(field, known.mass,"),
        ("zip(setting.positions + setting.velocities, v + moved", "zip(setting.state, moved + v"),
    ),
    *(
        RouteMutant("euler-lagrange", module, old, new, (), CONFIGURATION)
        for module, old, new in (
            ("euler_lagrange", "{p: slope * weight for", "{p: -slope * weight for"),
            ("euler_lagrange", "{p: slope * weight for", "{p: slope for"),
            ("euler_lagrange", "slope[c][b][a] - slope[a]", "slope[c][b][a] + slope[a]"),
            ("structure", "A[j][i] - A[i][j]", "A[i][j] - A[j][i]"),
            ("structure", "(*(-w for w in", "(*(w for w in"),
        )
    ),
    *_of(
        "canonical",
        "canonical",
        ("kepler", "monopole_kepler", "rocking_disk", "spd_motion"),
        ("rates[p] = turning - slopes[q]", "rates[p] = turning + slopes[q]"),
        ("rates[p] = turning - slopes[q]", "rates[p] = -slopes[q]"),
        ("(names[j], names[i]): -value", "(names[j], names[i]): value"),
        ("h = field.sum(products) - field", "h = field.sum(products) + field"),
        ("else slopes[p] * weight", "else slopes[p]"),
        ("- slopes[q] * weight", "- slopes[q]"),
    ),
    *_of(
        "newton",
        "newton",
        ("kepler",),
        ("zip(setting.velocities, accelerations(setting),", "zip(setting.velocities, velocities,"),
        ("zip(setting.positions, velocities,", "zip(setting.positions, velocities[::-1],"),
    ),
    *_of(
        "newton",
        "forces",
        ("kepler", "n_particles"),
        ("inverse[0][0] * component", "-inverse[0][0] * component"),
        ("applied(field, inverse, force", "applied(field, mass, force"),
        (
            "for row in range(len(mass)) for k in range(columns)",
            "for k in range(columns) for row in range(len(mass))",
        ),
    ),
    *_of(
        "alignment",
        "alignment",
        ("monopole_kepler",),
        ("(source - q * q)", "(source + q * q)"),
        ("(source - q * q)", "source"),
        ("scale(alpha, r), cross(chi, r)", "scale(alpha, r), cross(r, chi)"),
        ("*cross(r, force))", "*cross(force, r))"),
        (".scaled(1 / dot(r, r))", ""),
        ("= tuple(field.substitute(f, moved) for f in", "= tuple(f for f in"),
        ('"chi . r = 0", dot(chi, r)', '"chi . r = 0", dot(chi, r) - 1'),
    ),
    *_of(
        "nambu",
        "nambu",
        ("nambu_body", "nambu_pendulum"),
        ("-rate for rate in", "rate for rate in"),
        ("(-1) ** i * determinant(minor)", "determinant(minor)"),
    ),
    *_of(
        "hamilton-pontryagin",
        "hamilton_pontryagin",
        ("heavy_top", "kirchhoff"),
        ("x - setting.sign * dx for", "x + setting.sign * dx for"),
        ("rate - setting.sign * turn / 2", "rate + setting.sign * turn / 2"),
        ("rate - setting.sign * turn / 2", "rate - setting.sign * turn"),
        ("force - field.sum(carried)", "force + field.sum(carried)"),
        ("force - field.sum(carried)", "force"),
        ("dict(rates) | dict.fromkeys(", "dict.fromkeys("),
    ),
    *_of(
        "clebsch",
        "clebsch",
        ("heavy_top", "kirchhoff"),
        ("*(-slope for slope in field.gradient(action, p))", "*field.gradient(action, p)"),
        (
            "        *field.gradient(action, q),",
            "        *(-s for s in field.gradient(action, q)),",
        ),
        ("        *field.gradient(action, q),", "        *field.gradient(pairing, q),"),
        ("tuple(-slope for slope in", "tuple(slope for slope in"),
        ("return setting.sign * field.sum(total)", "return -setting.sign * field.sum(total)"),
        ("(name, field.substitute(x, image)) for", "(name, -field.substitute(x, image)) for"),
    ),
    *_of(
        "poincare",
        "poincare",
        ("heavy_top", "kirchhoff"),
        ("found[s] += setting.sign * c", "found[s] -= setting.sign * c"),
        ("found[k] -= setting.sign * c", "found[k] += setting.sign * c"),
        ("field.zero) - setting.sign * entry", "field.zero) + setting.sign * entry"),
        ("c * eta[k] * slopes[i]", "c * eta[k] * slopes[k]"),
        ("momentum = [a + b for", "momentum = [a - b for"),
        ("momentum = [a + b for", "momentum = [a for"),
    ),
    *_of(
        "cayley-klein",
        "cayley_klein",
        ("rigid_body_attitude", "heavy_top"),
        ("total = [-mu * x for mu", "total = [mu * x for mu"),
        ("body.product(a, h) - body.product(h, a)", "body.product(h, a) - body.product(a, h)"),
        ("body.product(body.omega.conjugate, pi)", "body.product(body.omega, pi)"),
        ("turned.product(q.conjugate, a, q)", "turned.product(q, a, q.conjugate)"),
        ("return HALF * self.product(self.q", "return self.product(self.q"),
        ("product(self.q, self.omega)", "product(self.omega, self.q)"),
        ("HALF * (turning + slopes)", "HALF * turning"),
    ),
    *(
        RouteMutant("hamilton-pontryagin", module, old, new, ("rigid_body_attitude",), tests)
        for module, old, new, tests in (
            ("reconstruction", "(q, q.conjugate) if", "(q.conjugate, q) if", ()),
            ("reconstruction", "scale(-1, apply(turn", "scale(1, apply(turn", FROM_THE_RIGHT),
            ("reconstruction", "return transpose(g)", "return g", SEEN),
        )
    ),
)
