"""Rods as lattices: against a chain that was written by hand, and against the rod itself."""

import re
from functools import cache
from pathlib import Path
from random import Random

import mpmath
import numpy as np
import pytest
import sympy
from click.testing import CliRunner
from scipy.integrate import quad, solve_ivp

import coadjoint
from coadjoint.bodies import write_lattice
from coadjoint.bodies.energy import read_strand
from coadjoint.cli import main
from coadjoint.derive import derive
from coadjoint.errors import SpecError
from coadjoint.resources import derivations_folder
from coadjoint.spec.reader import read_spec_text
from tests.bodies.lattices import FREE, compile_rates, family_of, lattice_of, rod
from tests.derive.test_lattice_limit import hat
from tests.specs import prove_claims, shipped

STIFF = "- dot(k, diag(K)*k)/2 - dot(d, diag(A)*d)/2"
PARAMETERS = {"I": (0.4, 0.7, 0.9), "M": (1.3,), "K": (5.0, 6.0, 7.0), "A": (20.0, 30.0, 50.0)}
NUMBERS = [value for values in PARAMETERS.values() for value in values]
a = 0.8
X, PI, P = (sympy.symbols(names) for names in ("X1:7", "Pi1:4", "P1:4"))
#: The strain and its derivatives, as the strand calls them.
STRAIN = [sympy.symbols(" ".join(f"{x}{end}" for x in X)) for end in ("", "_s", "_ss", "_sss")]


@cache
def rates_of_rod(*changes):
    """Rates of bodies of the rod inside, as a function of a ring of them."""
    return compile_rates(family_of(lattice_of(rod(*FREE, *changes), 4)))


def draw(count):
    """Rows of the state of bodies in general position: poses, angular momenta, momenta."""
    source = np.random.default_rng(count)
    R = np.array([np.linalg.qr(source.normal(size=(3, 3)))[0] for _ in range(count)])
    R *= np.linalg.det(R)[:, None, None]
    poses = np.concatenate([R, source.normal(size=(count, 3, 1))], axis=2)
    return np.vstack([poses.reshape(count, 12).T, source.normal(size=(6, count))])


# -- a chain that was written by hand -----------------------------------------------------


def turn_over(state):
    """The same bodies from the other end, with axes turned by half a turn about the first one.

    So the third axis still leads to the next body, and the chain is the same.
    """
    over = np.array([1.0, -1.0, -1.0])
    turned = np.array(state[:, ::-1])
    turned[:12].reshape(3, 4, -1)[:, :3] *= over[:, None]
    turned[12:].reshape(2, 3, -1)[:] *= over[:, None]
    return turned


@cache
def compile_chain():
    """Rates of pieces of `elastic_chain` inside."""
    return compile_rates(family_of(shipped("elastic_chain")))


def rates_of_chain(state):
    """Of `elastic_chain`, per length, where a piece has a times what a rod has per length."""
    given = {name: [a * x for x in PARAMETERS[old]] for name, old in (("m", "M"), ("I", "I"))}
    given |= {"a": [a], "C": PARAMETERS["A"], "K": PARAMETERS["K"]}
    values = [x for name in ("m", "I", "a", "C", "K") for x in given[name]]
    scale = np.array([1.0] * 12 + [a] * 6)[:, None]
    return compile_chain()(state * scale, values) / scale


def test_the_rod_is_the_elastic_chain_as_seen_from_both_ends():
    """Which sees each step from the body before it: half of it, and half of it turned over.

    From one end alone rates are other ones.
    """
    state = draw(7)
    found = rates_of_rod()(state, [*NUMBERS, a])
    forward, back = rates_of_chain(state), turn_over(rates_of_chain(turn_over(state)))
    np.testing.assert_allclose(found, (forward + back) / 2, rtol=1e-11, atol=1e-11)
    assert np.abs(found - forward)[12:].max() > 1


# -- the rod itself -----------------------------------------------------------------------


def curve(distance, order=4):
    """g(0)^-1 g(s) up to a power of s: derivatives of g' = g X by Leibniz' rule."""

    def matrix(x):
        return hat(x[:3]).row_join(sympy.Matrix(x[3:])).col_join(sympy.zeros(1, 4))

    slopes = [sympy.eye(4)]
    for n in range(order):
        parts = (sympy.binomial(n, k) * slopes[k] * matrix(STRAIN[n - k]) for k in range(n + 1))
        slopes.append(sum(parts, sympy.zeros(4)))
    terms = (u * distance**n / sympy.factorial(n) for n, u in enumerate(slopes))
    return sum(terms, sympy.zeros(4))[:3, :]


def differences(rates, of):
    """Rates of the generic body less those of a strand, at two distances, by component."""
    equations, random = derive(of, "lie-poisson"), Random(3)
    with mpmath.workdps(40):
        names = [x for row in [*STRAIN, PI, P] for x in row]
        values = {x: mpmath.mpf(random.randint(-9, 9)) / 7 for x in names}
        given = {str(x): mpmath.mpf(n + 2) for n, x in enumerate(equations.setting.parameters)}
        function = sympy.lambdify([*values, *given], equations.rates[:6], modules="mpmath")
        known = function(*values.values(), *given.values())
        given.pop("L")
        errors, s = [], sympy.Symbol("s")
        poses = sympy.lambdify([s, *values], [*curve(s)], modules="mpmath")
        for distance in (mpmath.mpf(1) / 1000, mpmath.mpf(1) / 2000):
            state = np.zeros((18, 3), dtype=object)
            state[12:] = np.array([[values[x]] for x in (*PI, *P)])
            for n in (-1, 0, 1):
                state[:12, n + 1] = poses(n * distance, *values.values())
            found = rates(state, [*given.values(), distance])[12:, 1]
            errors.append([float(one - other) for one, other in zip(found, known, strict=True)])
    return list(zip(*errors, strict=True))


MORE = {
    "quadratic": STIFF,
    "mixed": "- k[3]*e[3]/2 - k[1]*k[2]*e[1]/3 - k[1]",
}


@pytest.mark.parametrize("kind", MORE)
def test_rates_tend_to_those_of_the_rod(kind):
    """Of momenta at a strain with its slopes, to 40 digits: with order 2.

    Against a rod with another term the difference does not become less.
    """
    right = rod(*FREE, (STIFF, MORE[kind]))
    wrong = rod(*FREE, (STIFF, f"{MORE[kind]} + k[1]*e[3]/9"))
    rates = compile_rates(family_of(lattice_of(right, 4)), modules="mpmath")
    assert all(3.9 < one / other < 4.1 for one, other in differences(rates, right))
    assert any(0.9 < one / other < 1.1 for one, other in differences(rates, wrong))


def test_a_step_as_one_body_sees_it_tends_to_the_strain_with_order_one():
    """Without the half as seen by the other body."""
    declared, old = rod(*FREE), "(stretch(transpose(Q)*w) + stretch(transpose(T)*w))/2"
    text = write_lattice(declared, 4)
    assert old in text
    lattice = read_spec_text(text.replace(old, "stretch(transpose(Q)*w)"), Path("lattice.toml"))
    rates = compile_rates(family_of(lattice), modules="mpmath")
    ratios = [one / other for one, other in differences(rates, declared)]
    assert all(1.9 < ratio < 2.1 for ratio in ratios)


# -- totals -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "lost"),
    [
        ("", "", set()),
        ("stretch(transpose(T)*w)", "stretch(T*w)", {"J"}),
    ],
)
def test_the_certificate_proves_both_total_momenta(old, new, lost):
    """For every number of bodies; where a step is not seen in body axes the angular one is lost."""
    light = rod(*FREE, (STIFF, "- dot(k, k)/2 - dot(d, diag(A)*d)/2"))
    text = write_lattice(light, 4)
    assert old in text
    certificate = prove_claims(read_spec_text(text.replace(old, new), Path("lattice.toml")))
    verdicts = {each.statement: each.verdict for each in certificate.claims}
    jacobi = "the Poisson bracket satisfies the Jacobi identity, for every N >= 2"
    assert verdicts[jacobi] == "proved"
    kept = {s[0]: verdict for s, verdict in verdicts.items() if re.match("[LJ] is conserved", s)}
    assert kept.keys() == {"L", "J"}
    assert {name for name, verdict in kept.items() if verdict != "proved"} == lost


def test_an_endless_rod_keeps_its_momenta_along_itself():
    """Momenta, and the angular one about the third axis, over a run; about others it changes."""
    declared = lattice_of(shipped("se3_strand"), 6)
    assert [each.formula.text for each in declared.conserved] == ["energy", "L", "J"]
    rates, state = compile_rates(family_of(declared)), draw(6)
    state[:12] = np.eye(3, 4).ravel()[:, None]
    state[3:12:4] += np.random.default_rng(1).normal(size=(3, 6)) / 5

    def totals(state):
        bodies = state.reshape(18, 6)
        poses = bodies[:12].reshape(3, 4, 6)
        R, x = poses[:, :3], poses[:, 3]
        p = np.einsum("ijn,jn->in", R, bodies[15:])
        spin = np.einsum("ijn,jn->in", R, bodies[12:15])
        return [*p.sum(axis=1), *(spin + np.cross(x, p, axis=0)).sum(axis=1)]

    def flow(_, state):
        return rates(state.reshape(18, 6), [*NUMBERS, a, 0.97]).ravel()

    run = solve_ivp(flow, (0, 0.3), state.ravel(), "DOP853", rtol=1e-11, atol=1e-11)
    before, after = totals(run.y[:, 0]), totals(run.y[:, -1])
    changes = np.abs(np.subtract(after, before))
    assert changes[[0, 1, 2, 5]].max() < 1e-8
    assert changes[[3, 4]].min() > 1e-3


def test_a_rod_between_walls_keeps_the_energy_alone():
    """Walls push it; their links are those of bodies, so that rates are those of a long rod."""
    ends = ('ends = "free"', 'ends = "clamped"')
    declared = lattice_of(rod(*FREE, ends), 6)
    assert [each.formula.text for each in declared.conserved] == ["energy"]
    equations = derive(declared.family.windows[0], "lie-poisson")
    count = len(equations.variables) // 18
    state = draw(count + 2)
    first, last = state[:12, 0].reshape(3, 4), state[:12, -1].reshape(3, 4)
    poses = state[:12].reshape(3, 4, -1)
    poses[:, 3] -= first[:, 3:]  # all seen from the first wall
    state[:12] = np.einsum("ji,jkn->ikn", np.array(first[:, :3]), np.array(poses)).reshape(12, -1)
    given = dict(zip("IMKA", PARAMETERS.values(), strict=True)) | {"a": (a,)}
    given["E"] = tuple(last.ravel())
    values = [x for each in declared.parameters for x in given[each.name]]
    names = [sympy.Symbol(str(x)) for x in (*equations.variables, *equations.setting.parameters)]
    function = sympy.lambdify(names, equations.rates, cse=True)
    own = state[:, 1:-1]
    by_kind = [own[:12], own[12:15], own[15:]]
    found = np.array(function(*(x for rows in by_kind for x in rows.T.ravel()), *values))
    known = rates_of_rod()(state, [*NUMBERS, a])[12:, 1:-1]
    forces = found[12 * count :].reshape(2, count, 3).transpose(0, 2, 1).reshape(6, count)
    np.testing.assert_allclose(forces, known, rtol=1e-9, atol=1e-9)
    assert np.abs(known).max() > 1


# -- where bodies begin -------------------------------------------------------------------


def poses_of(declared):
    """Attitudes ``(N, 3, 3)`` and places ``(N, 3)`` at the beginning."""
    rows = np.array(declared.family.defaults["g"], dtype=float).reshape(3, 4, -1)
    return rows[:, :3].transpose(2, 0, 1), rows[:, 3].T


def default_of(declared, name):
    """The default of a parameter."""
    (found,) = (each.default for each in declared.parameters if each.name == name)
    return np.array(found, dtype=float)


def test_a_bent_rod_begins_as_a_period_of_an_endless_one():
    """In a plane: its third axis is (0, -sin u, cos u), u being the integral of sin(2 pi s/L)/5.

    Along the line through ends of periods, by sums of sines and cosines over the length.
    """
    N = 8
    declared = lattice_of(shipped("se3_strand"), N)

    def u(s):
        return (1 - np.cos(2 * np.pi * s / 10)) / np.pi

    def place(s):
        return np.array(
            [0, -quad(lambda r: np.sin(u(r)), 0, s)[0], quad(lambda r: np.cos(u(r)), 0, s)[0]]
        )

    period = place(10)
    tilt = np.arctan2(period[1], period[2])
    c, s = np.cos(tilt), np.sin(tilt)
    turn = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    assert turn @ period == pytest.approx([0, 0, np.hypot(*period[1:])])
    D = default_of(declared, "D")
    assert pytest.approx(np.linalg.norm(period) / 10, abs=1e-10) == D
    R, x = poses_of(declared)
    places = [turn @ place(10 * n / N) - [0, 0, D[0] * 10 * n / N] for n in range(N)]
    np.testing.assert_allclose(x, places, atol=1e-9)
    angles = [u(10 * n / N) + tilt for n in range(N)]
    np.testing.assert_allclose(R[:, 2, 1], np.sin(angles), atol=1e-9)
    assert abs(tilt) > 0.1


def test_a_rod_that_closes_begins_as_a_ring():
    """Bent to a circle: places are on it, and all momenta in space are claimed."""
    bent = ('"vector(sin(2*pi*s/L)/5, 0, 0, 0, 0, 1)"', '"vector(0, 2*pi/L, 0, 0, 0, 1)"')
    declared = lattice_of(rod(bent), 8)
    assert "D" not in {each.name for each in declared.parameters}
    assert [each.formula.text for each in declared.conserved] == ["energy", "L", "J"]
    (J,) = (each for each in declared.observables if each.name == "J")
    assert J.formula.shape == (3,)
    angles, radius = np.arange(8) * np.pi / 4, 10 / (2 * np.pi)
    R, x = poses_of(declared)
    np.testing.assert_allclose(x[:, 0], radius * (1 - np.cos(angles)), atol=1e-9)
    np.testing.assert_allclose(x[:, 2], radius * np.sin(angles), atol=1e-9)
    np.testing.assert_allclose(R[:, 0, 2], np.sin(angles), atol=1e-9)


def test_a_rod_with_free_ends_begins_in_the_middle_of_pieces():
    """Straight: from the first one on, along its axis; between walls from the first of these."""
    straight = ("sin(2*pi*s/L)/5", "0")
    _, x = poses_of(lattice_of(rod(*FREE, straight), 4))
    np.testing.assert_allclose(x, np.outer(np.arange(4) * 2.5, [0, 0, 1]), atol=1e-12)
    held = lattice_of(rod(*FREE, straight, ('ends = "free"', 'ends = "clamped"')), 4)
    _, x = poses_of(held)
    np.testing.assert_allclose(x, np.outer(np.arange(1, 5) * 2, [0, 0, 1]), atol=1e-12)
    np.testing.assert_allclose(default_of(held, "E").reshape(3, 4)[:, 3], [0, 0, 10], atol=1e-12)


# -- what is declared ---------------------------------------------------------------------

ADVECTED = (
    ("X     =", 'G = { role = "advected", representation = "vector" }\nX     ='),
    (STIFF, f"{STIFF} - G[3]"),
)
WHOLE = (
    ('Omega = { role = "velocity", block = "rotation", doc', 'xi = { role = "velocity" }\n#'),
    ('v     = { role = "velocity", block = "translation", doc', "#"),
    ('Pi    = { role = "momentum", block = "rotation", doc', 'mu = { role = "momentum" }\n#'),
    ('P     = { role = "momentum", block = "translation", doc', "#"),
    (
        "[definitions]\n",
        '[definitions]\nOmega = "vector(xi[1], xi[2], xi[3])"\nv = "vector(xi[4], xi[5], xi[6])"\n',
    ),
    ("dot(Pi, k) + dot(P, e)", "dot(mu, X)"),
    ('Pi = "vector(0, 0, 0)"\nP  = "vector(0, 0, 0)"\n', 'mu = "vector(0, 0, 0, 0, 0, 0)"\n'),
)


def test_advected_vectors_turn_with_bodies_and_leave_the_momentum():
    """They turn bodies and push nothing: each stays in space, and the momentum is claimed."""
    declared = lattice_of(rod(*FREE, *ADVECTED), 4)
    assert [each.formula.text for each in declared.conserved] == ["energy", "L"]
    certificate = prove_claims(declared)
    assert certificate.holds, str(certificate)
    statements = {each.statement.partition(" is ")[0] for each in certificate.claims}
    assert "(rotation(g[i])*G[i])[3]" in statements


def test_one_momentum_of_the_whole_algebra_is_that_of_both_blocks():
    """The same rates, and the same totals."""
    state, given = draw(5), [*NUMBERS, a]
    np.testing.assert_allclose(
        rates_of_rod(*WHOLE)(state, given), rates_of_rod()(state, given), rtol=1e-12
    )
    declared = lattice_of(rod(*FREE, *WHOLE), 4)
    assert [each.formula.text for each in declared.conserved] == ["energy", "L", "J"]


def test_the_energy_of_a_straight_rod_at_rest_is_zero():
    """What V has without strains stands at links, of which there is one less than bodies."""
    declared = rod(*FREE)
    assert read_strand(declared).own == read_strand(rod(*FREE, ("- dot(d, diag(A)*d)/2", ""))).own
    lattice = lattice_of(declared, 4)
    equations = derive(lattice.family.windows[0], "lie-poisson")
    count = len(equations.variables) // 18
    energy = equations.setting.field.to_sympy(equations.close(equations.exact.energy))
    for stretched, expected in ((1, 0), (2, 25.0 * (count - 1))):
        poses = [np.eye(3, 4) for _ in range(count)]
        for n, pose in enumerate(poses):
            pose[2, 3] = stretched * a * n
        state = [*(x for pose in poses for x in pose.ravel()), *[0] * 6 * count]
        names = map(sympy.Symbol, map(str, (*equations.variables, *equations.setting.parameters)))
        values = dict(zip(names, [*state, *NUMBERS, a], strict=True))
        assert float(energy.subs(values)) == pytest.approx(expected, abs=1e-9)


UNITS = {
    "Omega =": "1/s",
    "v     =": "m/s",
    "Pi    =": "kg m/s",
    "P     =": "kg/s",
    "X     =": "1/m, 1/m, 1/m, 1, 1, 1",
    "I =": "kg m",
    "M =": "kg/m",
    "K =": "kg m^3/s^2",
    "A =": "kg m/s^2",
    "L =": "m",
    "s =": "m",
}


def test_units_of_a_rod_are_those_of_its_lattice():
    """Places have that of the length; with another unit of a momentum the spec is refused."""
    straight = ("sin(2*pi*s/L)/5", "0")
    changes = [(f"\n{n} {{", f'\n{n} {{ unit = "{unit}",') for n, unit in UNITS.items()]
    text = write_lattice(rod(straight, *changes), 4)
    row = "1, 1, 1, m"
    assert f'"{row}, {row}, {row}"' in text
    old, new = 'unit = "kg/s", doc = "total', 'unit = "kg", doc = "total'
    assert old in text
    with pytest.raises(SpecError, match="kg"):
        read_spec_text(text.replace(old, new), Path("lattice.toml"))


def test_the_command_line_writes_the_lattice_of_a_rod(tmp_path, monkeypatch):
    """The text is that of `write_lattice`."""
    monkeypatch.chdir(tmp_path)
    words = ["new", "bodies", "--lattice-of", "se3_strand", "--bodies", "5"]
    result = CliRunner().invoke(main, words)
    assert result.exit_code == 0, result.output
    text = (tmp_path / "bodies.toml").read_text(encoding="utf-8")
    assert text == write_lattice(shipped("se3_strand"), 5)
    assert read_spec_text(text, Path("bodies.toml")).index[0].size == 5


@pytest.mark.campaign
def test_a_loaded_rod_keeps_what_is_claimed(tmp_path, monkeypatch):
    """An endless one that is bent at the beginning, and then free, by steps that keep momenta."""
    monkeypatch.setenv("COADJOINT_CACHE", str(tmp_path))
    path = derivations_folder() / "se3_strand.toml"
    system = coadjoint.load(path, sizes={"s": 16}, derivatives="lattice")
    assert list(system.STATE) == ["g", "Pi", "P"]
    momenta = {name: np.zeros((3, 16)) for name in ("Pi", "P")}
    momenta["Pi"][2], momenta["P"][0] = 0.01, np.sin(2 * np.pi * np.arange(16) / 16) / 10
    found = system.simulate(momenta, (0, 5), method="splitting4", step=0.02, samples=3)
    assert str(found.status) == "OK"
    assert np.abs(found.drift["L"]).max() < 1e-11
    assert np.abs(found.drift["J"]).max() < 1e-11
    assert np.abs(found.drift["energy"]).max() < 1e-3
    assert np.abs(found["Pi"][..., -1]).max() > 1e-3


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        ([("sin(2*pi*s/L)/5", "1/10")], 'turns the rod around the circle.*0.84.*ends = "free"'),
        ([('"left"', '"right"')], "right invariant.*inverse of g is a left one"),
        ([("dot(d, diag(A)*d)/2", "sqrt(dot(e, e))")], "no polynomial.*first terms"),
        ([(STIFF, f"{STIFF} - dot(v, e)")], "momenta and strains together"),
        ([(STIFF, f"{STIFF} - dot(k, k)^3*dot(e, e)^2")], "too many terms.*highest degree"),
    ],
)
def test_rods_without_a_lattice_are_refused(changes, found):
    """With what was found, what is expected, and what to do."""
    with pytest.raises(SpecError, match=r"rod\.toml: no lattice of bodies") as caught:
        write_lattice(rod(*changes), 8)
    assert re.search(found, str(caught.value)), str(caught.value)
