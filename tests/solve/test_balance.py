"""Discrete gradients with forces, inputs and dissipation: each step's balance of the energy."""

import numpy as np
import pytest

from coadjoint import pipeline
from coadjoint.derive.times_vector import TERMS, find_product
from coadjoint.errors import KernelArgumentError
from coadjoint.methods import list_backward
from coadjoint.solve.folders import load_texts
from coadjoint.spec.reader import read_spec_text
from coadjoint.systems import (
    double_bracket_body,
    heavy_top_damped,
    landau_lifshitz_gilbert,
    quadrotor,
    rigid_body,
    spacecraft_wheels,
)
from tests.specs import RIGID_BODY, emitted

#: Roundings of the energy over a step, relative to the energy.
ROUNDED = 2e-14
HAMILTONIAN = RIGID_BODY.replace(
    'routes = ["euler-poincare", "lie-poisson"]', 'routes = ["lie-poisson"]'
)
HAMILTONIAN = HAMILTONIAN.replace('Omega = { role = "velocity" }\n', "")
ENERGY = 'h = "Pi[1]^2/2 + Pi[2]^2/4 + Pi[3]^2/6{more}"'
HAMILTONIAN = HAMILTONIAN.replace(
    '[lagrangian]\nl = "dot(Omega, diag(I)*Omega)/2"', "[hamiltonian]\n" + ENERGY
)
QUARTIC = HAMILTONIAN.replace("{more}", " + Pi[1]^4/4").replace(
    "[claims]", '[double_bracket]\nG = "1/5"\n[claims]'
)
#: P. J. Morrison, Physica D 18 (1986) 410, section 4.
METRIPLECTIC = (
    HAMILTONIAN.replace("{more}", "")
    .replace(
        "[claims]",
        """[definitions]
w = "vector(Pi1, Pi2/2, Pi3/3)"
[metriplectic]
S = "dot(Pi, Pi)/2"
G = "dot(w, w)*hat(w)^0 - outer(w, w)"
[claims]""",
    )
    .replace('casimirs = ["dot(Pi, Pi)"]', "")
)


def balance(run, energy, power):
    """The largest gap between what the energy gains in a step and h times the power."""
    steps, x, y = np.diff(run.time), run.state[:, :-1], run.state[:, 1:]
    gained, given = energy(y) - energy(x), steps * power(x, y)
    assert np.abs(gained).max() > 1e-6  # something acts
    return np.abs(gained - given).max() / max(1.0, np.abs(energy(x)).max())


TOP = {"I": [1.0, 1.3, 2.0], "m": 1.0, "g": 9.81, "chi": [0.02, 0.0, 0.1]}
TOP |= {"d": [0.05, 0.02, 0.04], "tau": [0.1, 0.0, 0.5]}


def top_energy(x):
    """Of a top."""
    return (x[:3].T ** 2 / TOP["I"]).sum(1) / 2 + 9.81 * np.array(TOP["chi"]) @ x[3:]


def top_power(x, y):
    """Of friction and the motor, at the middle of a step."""
    Omega = (x[:3] + y[:3]).T / 2 / TOP["I"]
    return (Omega * (TOP["tau"] - TOP["d"] * Omega)).sum(1)


TORQUE = np.array([0.02, -0.01, 0.03])
BODY, WHEEL = np.array([1.0, 2.0, 3.0]), np.array([0.1, 0.1, 0.1])


def craft_energy(x):
    """Of a body with wheels."""
    Pi, L = x[4:7], x[7:]
    return ((Pi - L).T ** 2 / BODY).sum(1) / 2 + (L.T**2 / WHEEL).sum(1) / 2


def craft_power(x, y):
    """Of torques on the wheels, by their rates."""
    m = (x + y) / 2
    w = m[7:].T / WHEEL - (m[4:7] - m[7:]).T / BODY
    return w @ TORQUE


THRUST, TURN = 45.0, np.array([0.01, 0.02, -0.01])
INERTIA, MASS = np.array([0.082, 0.0845, 0.1377]), 4.34


def flight_energy(x):
    """Of a body in a field."""
    kinetic = (x[:3].T ** 2 / INERTIA).sum(1) / 2 + (x[3:6] ** 2).sum(0) / (2 * MASS)
    return kinetic - MASS * 9.81 * x[9]


def flight_power(x, y):
    """Of rotors."""
    m = (x + y) / 2
    return (m[:3].T / INERTIA) @ TURN - m[5] / MASS * THRUST


CASES = {
    "friction and a motor": (heavy_top_damped, TOP, {}, top_energy, top_power),
    "wheels": (spacecraft_wheels, None, {"u": TORQUE}, craft_energy, craft_power),
    "rotors": (quadrotor, None, {"f": THRUST, "M": TURN}, flight_energy, flight_power),
}
STARTS = {
    "friction and a motor": [0.4, -0.3, 1.2, 0.6, 0.0, 0.8],
    "wheels": [1.0, 0, 0, 0, 0.5, 0.2, -0.4, 0.01, 0.02, -0.01],
    "rotors": [0.02, 0.01, 0.03, 0.5, 0.1, -0.2, 0.0, 0.6, 0.8, 1.0],
}


@pytest.mark.parametrize("target", ["numpy", "c"])
@pytest.mark.parametrize("case", CASES)
def test_the_energy_gains_the_power_of_forces_and_inputs(case, target):
    """``H1 - H0 = h g.f`` to rounding, f by hand; by RK4 the gap is that of its order."""
    system, parameters, inputs, energy, power = CASES[case]
    given = {"step": 0.0625, "samples": 33, "target": target}
    given |= {"inputs": inputs} if inputs else {}

    def run(method):
        found = system.simulate(STARTS[case], (0, 2), parameters, method=method, **given)
        assert found.status == "OK"
        return found

    found = run("discrete_gradient")
    assert balance(found, energy, power) < ROUNDED
    assert found.drift.get("casimir1", 0.0) < 1e-13  # a unit vector, of degree 2
    assert balance(run("rk4"), energy, power) > 1e-10


@pytest.mark.parametrize("target", ["numpy", "c"])
@pytest.mark.parametrize(
    ("system", "G", "slope"),
    [
        (double_bracket_body, 0.1, lambda x: (x.T / [1, 2, 3]).T),
        (
            landau_lifshitz_gilbert,
            0.1,
            lambda x: -np.array([0 * x[0], 0 * x[1], 1 + 0.2 * x[2]]) / 1.01,
        ),
    ],
    ids=["body", "spin"],
)
def test_a_double_bracket_takes_what_it_says_and_keeps_the_casimir(system, G, slope, target):
    """``H1 - H0 = -h G |m x g|^2`` with the gradient g at the middle m of a quadratic energy."""
    start = np.array([0.36, 0.48, 0.8])
    given = {"step": 0.25, "samples": 81, "target": target}
    run = system.simulate(start, (0, 20), method="discrete_gradient", **given)
    assert run.status == "OK"
    gains = np.diff(system.energy(run.state))

    def loss(x, y):
        m = (x + y) / 2
        return -G * (np.cross(m, slope(m), axis=0) ** 2).sum(0)

    assert balance(run, system.energy, loss) < 1e-15
    assert (gains < 0).all()
    squares = (run.state**2).sum(0)
    assert np.abs(squares - squares[0]).max() < 3e-15
    other = system.simulate(start, (0, 20), method="rk4", **given)
    assert np.ptp((other.state**2).sum(0)) > 1e-9
    assert {each.name: each.rank for each in system.METHODS}["discrete_gradient"] == 1


def test_energies_of_degree_four_lose_what_the_mean_gradient_says():
    """The mean of the gradient along the chord by hand; and the other gradient keeps it too."""
    with load_texts(pipeline.render(read_spec_text(QUARTIC, "quartic.toml")).texts) as system:
        for method in ("discrete_gradient", "average_gradient", "midpoint"):
            run = system.simulate(
                [0.9, 0.4, 0.5], (0, 10), method=method, step=0.25, samples=41, target="numpy"
            )

            def energy(x):
                return x[0] ** 2 / 2 + x[1] ** 2 / 4 + x[2] ** 2 / 6 + x[0] ** 4 / 4

            def loss(x, y):
                m = (x + y) / 2
                g = (m.T / [1, 2, 3]).T
                g[0] += (x[0] ** 3 + x[0] ** 2 * y[0] + x[0] * y[0] ** 2 + y[0] ** 3) / 4
                return -(np.cross(m, g, axis=0) ** 2).sum(0) / 5

            gap = balance(run, energy, loss)
            assert gap < 1e-15 if method != "midpoint" else gap > 1e-7


def test_a_metriplectic_midpoint_keeps_the_energy_and_gains_entropy():
    """``S1 - S0 = h dS.G dS`` at the middle, and quadratic energies: their gradient is discrete."""
    with load_texts(pipeline.render(read_spec_text(METRIPLECTIC, "body.toml")).texts) as system:
        methods = {each.name: each for each in system.METHODS}
        assert "energy" in methods["midpoint"].exactly
        assert "the entropy, of degree 2, grows" in methods["midpoint"].decides
        assert not {"midpoint4", "discrete_gradient"} & methods.keys()
        given = {"step": 0.25, "samples": 81, "target": "numpy"}
        run = system.simulate([0.9, 0.4, 0.5], (0, 20), method="midpoint", **given)

        def entropy(x):
            return (x**2).sum(0) / 2

        def grows(x, y):
            m = (x + y) / 2
            w = (m.T / [1, 2, 3]).T
            return (w**2).sum(0) * (m**2).sum(0) - (w * m).sum(0) ** 2

        assert balance(run, entropy, grows) < 1e-15
        assert (np.diff(entropy(run.state)) > 0).all()
        assert run.drift["energy"] < 1e-14
        other = system.simulate([0.9, 0.4, 0.5], (0, 20), method="rk4", **given)
        assert other.drift["energy"] > 1e-9


def test_steps_back_in_time_are_refused_where_energy_is_lost():
    """Compositions of order above 2 have some; those of Gauss and of a free body are taken."""
    start = [0.36, 0.48, 0.8]
    for name in ("midpoint4", "midpoint6", "discrete_gradient4"):
        assert name in list_backward()
        with pytest.raises(KernelArgumentError, match="go back in time"):
            double_bracket_body.simulate(start, (0, 1), method=name, step=0.1)
    assert double_bracket_body.simulate(start, (0, 1), method="gauss4", step=0.1).status == "OK"
    assert rigid_body.simulate(start, (0, 1), method="midpoint4", step=0.1).status == "OK"


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("knife_edge_cvt", "multipliers"),
        ("veselova", "multipliers"),
        ("n_link_chain", "velocities that are solved for"),
    ],
)
def test_what_has_no_tensor_says_why(name, reason):
    """Constraints that are kept, and velocities that are solved for."""
    found = find_product(emitted(name))
    assert isinstance(found, str)
    assert reason in found


def test_a_limit_on_cost_says_so(monkeypatch):
    """And is none where terms are few."""
    equations = emitted("chaplygin_sleigh")
    assert TERMS == 1000
    assert not isinstance(find_product(equations), str)
    monkeypatch.setattr("coadjoint.derive.times_vector.TERMS", -1)
    found = find_product.__wrapped__(equations)
    assert isinstance(found, str)
    assert "a limit on cost, not on the method" in found
