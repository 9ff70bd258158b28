"""Accelerations and reactions, against small systems that are solved by hand.

Each expected value is what Newton's law and the constraint give on paper; every route is held
against it, and a sign or a term left out of it is seen.
"""

from dataclasses import replace

import numpy as np
import pytest

from coadjoint.derive.document import document
from coadjoint.errors import DerivationError, LimitError
from tests.constrained import BALL, PARTICLE, PENDULUM, SLEIGH, SUSLOV, derived, motion
from tests.specs import emitted

PRINCIPLE = "nonholonomic-hamilton-pontryagin"
ROUTES = ("nonholonomic", "hamel", PRINCIPLE)
BLADE = 'blade = "w == y*u"'
RIGHT = ('name = "so(3)"', 'name = "so(3)"\ninvariance = "right"')


def symbols(of, names):
    """Elements by name, in the order of a text."""
    return [of.field[name] for name in names.split()]


def check_values(of, expected):
    """Accelerations, reactions or functions of them have these values, in the state alone."""
    for name, value in expected.items():
        found = of.value(of.field[name])
        assert of.field.is_zero(found - value), (name, str(found))


@pytest.mark.parametrize("route", ROUTES)
def test_a_particle_whose_height_follows_its_way(route):
    """(1 + y^2) du/dt = -y u v and dv/dt = 0, from m du/dt = -y lambda, m dw/dt = lambda."""
    of = motion(PARTICLE, route=route)
    y, u, v = symbols(of, "y u v")
    check_values(of, {"du_dt": -y * u * v / (1 + y**2), "dv_dt": of.field.zero})
    with pytest.raises(AssertionError):  # the constraint put in before varying has -2 y u v
        check_values(of, {"du_dt": -2 * y * u * v / (1 + y**2)})


def test_the_force_of_the_particle():
    """Lambda = m dw/dt = m u v/(1 + y^2) upwards; written w = y u or 0 = w - y u or y u = w."""
    of = motion(PARTICLE)
    m, y, u, v = symbols(of, "m y u v")
    force = m * u * v / (1 + y**2)
    check_values(of, {"blade_reaction": force, "dw_dt": u * v / (1 + y**2)})
    for text, sign in (("y*u == w", -1), ("0 == w - y*u", -1), ("w - y*u == 0", 1)):
        other = motion(PARTICLE, (BLADE, f'blade = "{text}"'))
        m, y, u, v = symbols(other, "m y u v")
        on = {"w": y * u}
        value = other.value(other.field["blade_reaction"])
        kept = other.field.substitute(value, on) if other.distribution.kept else value
        assert other.field.is_zero(kept - sign * m * u * v / (1 + y**2)), text


@pytest.mark.parametrize("route", ROUTES)
def test_a_constraint_that_moves(route):
    """On w = y (u + k): du/dt = -y v (u + k)/(1 + y^2), and the energy changes by lambda k y."""
    of = motion(PARTICLE, (BLADE, 'blade = "w == y*u + k*y"'), route=route)
    y, u, v, k, m = symbols(of, "y u v k m")
    check_values(of, {"du_dt": -y * v * (u + k) / (1 + y**2), "dv_dt": of.field.zero})
    gain = of.rate(of.equations.exact.energy)
    force = m * v * (u + k) / (1 + y**2)
    assert of.field.is_zero(gain - force * k * y)
    assert not of.field.is_zero(gain)
    if route != "hamel":
        check_values(of, {"blade_reaction": force})


@pytest.mark.parametrize("route", ROUTES)
def test_a_mass_that_moves(route):
    """L = m (1 + y^2) u^2/2 + ... with w = 0: (1 + y^2) du/dt = -2 y u v, dv/dt = y u^2."""
    changes = (("u^2 + v^2 + w^2", "(1 + y^2)*u^2 + v^2 + w^2"), (BLADE, 'blade = "w == 0"'))
    of = motion(PARTICLE, *changes, route=route)
    y, u, v = symbols(of, "y u v")
    check_values(of, {"du_dt": -2 * y * u * v / (1 + y**2), "dv_dt": y * u**2})


@pytest.mark.parametrize("route", ROUTES)
def test_forces_and_dissipation(route):
    """A force 3 along w and drag k u along u: (1 + y^2) m du/dt = -m y u v + 3 y - k u."""
    more = ("[claims]", '[forces]\nw = "3"\n[dissipation]\nR = "k*u^2/2"\n[claims]')
    of = motion(PARTICLE, more, route=route)
    y, u, v, k, m = symbols(of, "y u v k m")
    acceleration = (-m * y * u * v + 3 * y - k * u) / (m * (1 + y**2))
    check_values(of, {"du_dt": acceleration})
    if route != "hamel":
        check_values(of, {"blade_reaction": m * (u * v + y * acceleration) - 3})
    gain = of.rate(of.equations.exact.energy)
    assert of.field.is_zero(gain - (3 * y * u - k * u**2))


@pytest.mark.parametrize("route", ROUTES)
def test_the_sleigh(route):
    """dv/dt = a omega^2, (I + m a^2) domega/dt = -m a v omega."""
    of = motion(SLEIGH, route=route)
    m, I_, a, v, omega = symbols(of, "m I a v omega")
    check_values(of, {"dv_dt": a * omega**2, "domega_dt": -m * a * v * omega / (I_ + m * a**2)})


def test_the_blade_pushes_the_sleigh_sideways():
    """The force is m I v omega/(I + m a^2): its moment about the centre of mass turns the body."""
    of = motion(SLEIGH)
    m, I_, a, v, omega = symbols(of, "m I a v omega")
    force = m * I_ * v * omega / (I_ + m * a**2)
    check_values(of, {"blade_reaction": force})
    turning = of.value(of.field["domega_dt"])
    assert of.field.is_zero(I_ * turning + a * force)


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize(("changes", "sign"), [((), 1), ((RIGHT,), -1)])
def test_suslovs_body_from_the_body_and_from_space(changes, sign, route):
    """I1 W1' = -b W1 W2 and I2 W2' = b W1^2; in the space frame both signs turn."""
    of = motion(SUSLOV, *changes, route=route)
    I1, I2, b, x, y = symbols(of, "I1 I2 b turn1 turn2")
    check_values(of, {"dturn1_dt": -sign * b * x * y / I1, "dturn2_dt": sign * b * x**2 / I2})
    if route != "hamel":  # Pi3' - sign (Pi1 W2 - Pi2 W1)
        check_values(of, {"wheel_reaction": -sign * b**2 * x * y / I1 - sign * (I1 - I2) * x * y})


@pytest.mark.parametrize("route", ROUTES)
def test_the_pendulum_by_a_constraint_that_is_kept(route):
    """M du/dt = x T, m dv/dt = y T - m g with T = m (g y - u^2 - v^2)/(x^2 + y^2)."""
    of = motion(PENDULUM, route=route)
    m, g, x, y, u, v = symbols(of, "m g x y u v")
    T = m * (g * y - u**2 - v**2) / (x**2 + y**2)
    check_values(of, {"du_dt": x * T / m, "dv_dt": y * T / m - g})
    if route != "hamel":
        check_values(of, {"rod_reaction": T})
        for text, factor in (("0 == x*u + y*v", -1), ("x*u/2 + y*v/2 == 0", 2)):
            other = motion(PENDULUM, ("x*u + y*v == 0", text))
            m, g, x, y, u, v = symbols(other, "m g x y u v")
            tension = m * (g * y - u**2 - v**2) / (x**2 + y**2)
            check_values(other, {"rod_reaction": factor * tension})


def test_a_block_on_an_incline():
    """Of the weight, m g sin(alpha) pulls it down and m g cos(alpha) is carried by the plane."""
    block = (
        ("m*(u^2 + v^2 + w^2)/2", "m*(u^2 + v^2 + w^2)/2 - m*k*(sin(alpha)*x + cos(alpha)*z)"),
        ("k = { default = 1 }", "k = { default = 1 }\nalpha = { default = 1 }"),
    )
    of = motion(PARTICLE, *block, (BLADE, 'plane = "w == 0"'))
    m, k = symbols(of, "m k")
    sin, cos = (of.field.call(name, of.field["alpha"]) for name in ("sin", "cos"))
    check_values(of, {"du_dt": -k * sin, "plane_reaction": m * k * cos})


@pytest.mark.parametrize("route", ROUTES)
def test_a_rotor_beside_an_algebra(route):
    """A motor turns a wheel on the sleigh with k: J (domega/dt + dq/dt) = k, and backwards."""
    rotor = (
        ("[parameters]", 'phi = { role = "coordinate" }\nq = { role = "velocity", of = "phi" }\n'
         "[parameters]\nJ = { positive = true, default = 1 }"),
        ("I*omega^2/2", "I*omega^2/2 + J*(omega + q)^2/2"),
        ("[constraints]", '[forces]\nq = "k"\n[constraints]'),
    )  # fmt: skip
    of = motion(SLEIGH, *rotor, route=route)
    m, I_, a, v, omega, k, J = symbols(of, "m I a v omega k J")
    turning = (-m * a * v * omega - k) / (I_ + m * a**2)
    check_values(of, {"domega_dt": turning, "dq_dt": k / J - turning, "dv_dt": a * omega**2})
    assert of.rates["phi"] == of.field["q"]


def test_multipliers_of_velocities_given_through_each_other():
    """U = k w and w = y v: m du/dt = lambda1, m dw/dt = lambda2 - k lambda1, by Newton."""
    of = motion(PARTICLE, (BLADE, 'c = "u == k*w"\nd = "w == y*v"'))
    m, k = symbols(of, "m k")
    forces = [of.value(of.field[name]) for name in ("c_reaction", "d_reaction")]
    pushed = [of.value(of.field[name]) for name in ("du_dt", "dv_dt", "dw_dt")]
    y, v = symbols(of, "y v")
    assert of.field.is_zero(m * pushed[0] - forces[0])
    assert of.field.is_zero(m * pushed[2] - (forces[1] - k * forces[0]))
    assert of.field.is_zero(m * pushed[1] - (-y * forces[1]))
    assert of.field.is_zero(pushed[2] - (v**2 + y * pushed[1]))
    assert not of.field.is_zero(forces[0])


def test_a_given_and_a_kept_constraint_push_together():
    """U = k w beside v + y w = 0: forces (l1, l2, -k l1 + y l2) along u, v and w."""
    of = motion(PARTICLE, (BLADE, 'c = "u == k*w"\nd = "v + y*w == 0"'))
    m, k, y, v, w = symbols(of, "m k y v w")
    l1, l2 = (of.value(of.field[name]) for name in ("c_reaction", "d_reaction"))
    pushed = [of.value(of.field[name]) for name in ("du_dt", "dv_dt", "dw_dt")]
    for acceleration, force in zip(pushed, (l1, l2, y * l2 - k * l1), strict=True):
        assert of.field.is_zero(m * acceleration - force)
    assert of.field.is_zero(pushed[1] + y * pushed[2] + v * w)  # the constraint is kept
    assert not of.field.is_zero(l2)


def test_observables_may_name_reactions():
    """The power of the blade, reaction times speed, is emitted like any other observable."""
    of = motion(PARTICLE, ("[claims]", '[observables]\npower = "blade_reaction*w"\n[claims]'))
    m, y, u, v = symbols(of, "m y u v")
    power = dict(of.equations.exact.observables)["power"]
    assert of.field.is_zero(of.value(power) - m * u**2 * v * y / (1 + y**2))


def test_residuals_are_left_minus_right():
    """They vanish at what the kernel defines where a velocity is given, and are kept else."""
    equations = derived(PARTICLE)["nonholonomic"]
    ((name, residual),) = equations.exact.residuals
    f = equations.setting.field
    assert (name, residual) == ("blade", f["w"] - f["y"] * f["u"])
    assert f.is_zero(equations.close(residual))
    of = motion(PENDULUM)
    ((_, residual),) = of.equations.exact.residuals
    assert not of.field.is_zero(of.equations.close(residual))
    assert of.field.is_zero(of.rate(residual))


def test_momenta_of_sections():
    """<dl/dxi, B sigma> along u by 1 and v by x: m (u + y w) + m x v."""
    more = ("[claims]", '[momenta.J]\nsection = { u = "1", v = "x" }\n[claims]')
    of = motion(PARTICLE, more)
    m, x, y, u, v = symbols(of, "m x y u v")
    J = of.equations.close(dict(of.equations.exact.observables)["J"])
    assert of.field.is_zero(J - m * (u + y * y * u + x * v))


@pytest.mark.parametrize(
    ("text", "changes", "found", "said"),
    [
        (
            PARTICLE,
            [("u^2 + v^2 + w^2", "u^2 + w^2")],
            "dv_dt",
            "the reduced mass matrix is singular: nothing gives dv_dt",
        ),
        (PARTICLE, [("u^2 + v^2 + w^2", "v^2")], "du_dt", "Add the missing kinetic term"),
        (
            BALL,
            [("dot(Omega, diag(I)*Omega)/2 + m*dot(Y, Y)/2", "m*dot(Y, Y)/2")],
            "dOmega3_dt",
            "singular",
        ),
    ],
)
def test_what_gives_no_acceleration_is_refused(text, changes, found, said):
    """A massless velocity; a ball that is a point mass."""
    with pytest.raises(DerivationError) as caught:
        motion(text, *changes)
    message = str(caught.value)
    assert "lagrangian.l: " in message
    assert message.startswith("sample.toml:")
    assert said in message
    assert "expected a kinetic energy" in message
    assert found in caught.value.found


def test_too_many_coupled_accelerations_with_friction_are_refused(monkeypatch):
    """A matrix that is not symmetric is written out, up to the cost of that."""
    monkeypatch.setattr("coadjoint.derive.mechanics.constrained.OPERATIONS", 3000)
    text = """
title = "Many"
routes = ["nonholonomic"]
[variables]
x = { role = "coordinate", shape = [16] }
v = { role = "velocity", of = "x" }
[parameters]
a = { shape = [16], default = 1 }
[lagrangian]
l = "dot(v, v)/2"
[constraints]
plane = "dot(a, v) == 0"
[forces]
v = "-plane_reaction*v"
"""
    with pytest.raises(
        LimitError, match=r"couple 17 .*about 3275 operations; expected at most 3000 \(OPERATIONS\)"
    ) as caught:
        motion(text)
    assert caught.value.found == 3275
    assert "Write constraints as Y == ..." in str(caught.value)
    motion(text.replace("16", "2"))


def test_a_derivation_reads_like_a_book():
    """Rates have dots, intermediates no underscores, and a step without lines is left out."""
    steps = derived(BALL)["nonholonomic"].steps
    titles = [step.title for step in steps]
    assert titles[1:3] == ["Constraints, imposed after the variation", "Distribution"]
    assert "Kinematics" in titles
    assert "Kinematics" not in [s.title for s in derived(SLEIGH)["nonholonomic"].steps]
    whole = document(derived(BALL)["nonholonomic"])
    latex = " ".join(line.latex for section in whole.sections for line in section.lines)
    html = " ".join(line.mathml for section in whole.sections for line in section.lines)
    assert r"\dot{\Gamma}_1 &=" in latex
    assert r"\tilde{b}_1\,\dot{\Omega}_2" in latex
    assert r"(B^\top M B \dot\eta)_{1} &=" in latex
    assert "_b1" not in latex + html
    assert "dt}" not in latex
    assert "dOmega" not in html
    assert "<mfrac>" in html


#: A body in four dimensions that turns only in planes of the fourth axis.
PLANES = """
title = "Suslov in four dimensions"
routes = ["nonholonomic", "hamel", "nonholonomic-hamilton-pontryagin"]
[algebra]
name = "so(4)"
[variables]
Omega = { role = "velocity", form = "antisymmetric" }
[parameters]
K = { shape = [3], default = [1, 2, 3] }
k = { shape = [3], default = ["0.3", "-0.2", "0.4"] }
j = { default = 2 }
[definitions]
J = "rows(vector(K1, 0, 0, k1), vector(0, K2, 0, k2), vector(0, 0, K3, k3), vector(k1, k2, k3, j))"
[lagrangian]
l = "trace(transpose(Omega)*J*Omega)/2"
[constraints]
a = "Omega12 == 0"
b = "0 == Omega13"
c = "Omega23 == 0"
"""


def turning(of):
    """(K_i + j) dw_i/dt = (k.w) w_i - (w.w) k_i with w_i = Omega_i4, of the body in PLANES."""
    w = symbols(of, "Omega14 Omega24 Omega34")
    K, k, (j,) = (symbols(of, names) for names in ("K1 K2 K3", "k1 k2 k3", "j"))
    kw, ww = (sum(x * y for x, y in zip(w, each, strict=True)) for each in (k, w))
    return {f"dOmega{n + 1}4_dt": (kw * w[n] - ww * k[n]) / (K[n] + j) for n in range(3)}


@pytest.mark.parametrize("route", ROUTES)
def test_velocities_given_by_component(route):
    """The state has the components that no constraint gives, and they move by the closed form."""
    of = motion(PLANES, route=route)
    assert of.setting.state == ("Omega14", "Omega24", "Omega34")
    check_values(of, turning(of))
    with pytest.raises(AssertionError):  # with the other sign of k it is another body
        check_values(of, {name: -rate for name, rate in turning(of).items()})


def test_a_component_that_is_given_and_one_that_is_kept_move_alike():
    """The same constraint, turned into one that gives nothing, leads to the same closed form."""
    kept = motion(PLANES, ("Omega12 == 0", "2*Omega12 == 0"))
    assert kept.setting.state == ("Omega12", "Omega14", "Omega24", "Omega34")
    for name, rate in turning(kept).items():
        found = kept.field.substitute(kept.value(kept.field[name]), {"Omega12": kept.field.zero})
        assert kept.field.is_zero(found - rate), name


def check_printed_solve(equations):
    """The lines of the solve are its linear equations, with the multipliers that it finds.

    ``M eta' - (k + A^T lambda)`` of each line, with ``lambda = -u``, is a row of the solve.
    """
    of, field, close = equations.distribution, equations.setting.field, equations.close
    step = next(s for s in equations.steps if "for the accelerations in the kernel" in s.title)
    entries = dict(next(s.lines for s in equations.steps if s.title == "Reduced mass matrix"))
    by_name = {left.text: value for left, value in entries.items()}
    rates = [field[f"d{name}_dt"] for name in of.independent]
    reactions = {e.reaction: -field[f"_u{n + 1}"] for n, (e, _) in enumerate(of.kept)}
    rows = dict[int, object]()
    for solve in equations.exact.solves:
        for place, row, side in zip(solve.block, solve.matrix, solve.known, strict=True):
            terms = zip(row, solve.names, strict=True)
            rows[place] = field.sum(a * field[name] for a, name in terms) - side
    for i, (_, value) in enumerate(step.lines):
        places = [f"M_{min(i, j) + 1}{max(i, j) + 1}" for j in range(len(rates))]
        inertia = field.sum(
            by_name[p] * x for p, x in zip(places, rates, strict=True) if p in by_name
        )
        printed = inertia - field.substitute(value, reactions)
        assert field.is_zero(close(printed - rows[i])), (i, str(printed))
    return len(reactions)


@pytest.mark.parametrize("route", ["nonholonomic", "hamel"])
@pytest.mark.parametrize(
    "system", ["knife_edge_cvt", "double_spherical_pendulum", "suslov", "snakeboard", "veselova"]
)
def test_printed_equations_have_the_multipliers(system, route):
    """Of constraints that are kept; without ``A^T lambda`` no line would be true."""
    equations = emitted(system, route)
    assert check_printed_solve(equations) > 0
    titles = [step.title for step in equations.steps]
    assert "Constraints, differentiated" in titles
    place = next(n for n, t in enumerate(titles) if "for the accelerations in the kernel" in t)
    step, of = equations.steps[place], equations.distribution
    none = dict.fromkeys((e.reaction for e, _ in of.kept), equations.setting.field.zero)
    bare = [(left, equations.setting.field.substitute(x, none)) for left, x in step.lines]
    steps = (*equations.steps[:place], replace(step, lines=tuple(bare)))
    with pytest.raises(AssertionError):
        check_printed_solve(replace(equations, steps=(*steps, *equations.steps[place + 1 :])))


def test_suslovs_equations_are_those_of_the_book():
    """I Omega' = I Omega x Omega + lambda a and a . Omega' = 0, solved here by hand."""
    equations = emitted("suslov")
    step = next(s for s in equations.steps if "for the accelerations in the kernel" in s.title)
    inertia = np.array([[3.0, 0.2, -0.4], [0.2, 2.0, 0.3], [-0.4, 0.3, 1.5]])
    axis, omega = np.array([0.6, -0.8, 0.5]), np.array([0.3, 0.7, 0.76])
    assert abs(axis @ omega) < 1e-12
    turning = np.cross(inertia @ omega, omega)
    whole = np.block([[inertia, -axis[:, None]], [axis[None], np.zeros((1, 1))]])
    *rate, force = np.linalg.solve(whole, [*turning, 0.0])
    known = {f"I{i + 1}{j + 1}": inertia[i, j] for i in range(3) for j in range(i, 3)}
    known |= {f"a{i + 1}": axis[i] for i in range(3)}
    known |= {f"Omega{i + 1}": omega[i] for i in range(3)} | {"wheels_reaction": force}
    to_sympy = equations.setting.field.to_sympy
    printed = [float(to_sympy(value).subs(known)) for _, value in step.lines]
    np.testing.assert_allclose(printed, inertia @ np.array(rate), rtol=1e-12)
    assert not np.allclose(printed, turning)  # as it was printed
