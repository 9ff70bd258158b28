"""The tippe top against Newton and Euler's equations typed apart, and its published behaviour.

Or (1994), SIAM J. Appl. Math. 54, 597; Bou-Rabee, Marsden and Romero (2004), SIAM J. Appl. Dyn.
Syst. 3, 352. Twins with one wrong term are refuted by the same checks.
"""

import numpy as np
import pytest

from coadjoint.derive import derive
from coadjoint.derive.mechanics.external import external_forces
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.resources import derivations_folder
from coadjoint.systems import tippe_top
from tests.sources.components import cross, dot, plus, times
from tests.sources.sliding import TippeTop
from tests.sources.sliding import tippe_top as typed
from tests.sources.test_equations import emitted, points, same, solved, values
from tests.specs import spec, unitless

TEXT = unitless((derivations_folder() / "tippe_top.toml").read_text(encoding="utf-8"))
START = {"Omega": [0.0, 0.0, 20.0], "Y": [0.0, 0.0, 0.0], "Gamma": [0.0, 40 / 401, 399 / 401]}


def changed(*changes):
    """The motion of the shipped text, changed."""
    return ConstrainedRates(derive(spec(TEXT, *changes, name="tippe_top")))


class TorqueOfTheOtherSign(TippeTop):
    """``I dOmega/dt = I Omega x Omega + s x F``."""

    def accelerations(self, N):
        """With twice the torque taken back."""
        turned, moved = super().accelerations(N)
        torque = cross(self.s, times(N, plus(self.Gamma, self.friction)))
        return plus(turned, [2 * t / i for t, i in zip(torque, self.inertia, strict=True)]), moved


class PressedByItsWeight(TippeTop):
    """``N = m g``, the approximation of many papers."""

    @property
    def N(self):
        """Its weight."""
        return self.m * self.g


class WithoutTheMotionOfTheArm(TippeTop):
    """``d(Gamma . v)/dt`` where ds/dt is forgotten."""

    def lift(self, N):
        """With its part taken back."""
        carried = cross(self.Omega, times(self.r, cross(self.Gamma, self.Omega)))
        return super().lift(N) + dot(self.Gamma, carried)


class DrivenByFriction(TippeTop):
    """Friction along the slip velocity."""

    @property
    def friction(self):
        """Of the other sign."""
        return times(-1, super().friction)


@pytest.mark.parametrize(
    ("kind", "right"),
    [
        (TippeTop, True),
        (TorqueOfTheOtherSign, False),
        (PressedByItsWeight, False),
        (WithoutTheMotionOfTheArm, False),
        (DrivenByFriction, False),
    ],
)
def test_it_moves_by_newton_and_euler_and_a_wrong_term_is_seen(kind, right):
    """At an exact point, to 40 digits; not with a wrong torque, N, moving arm or friction."""
    found = emitted("tippe_top")
    ((point, x, p),) = points("tippe_top", 1)
    top = kind(**vars(typed(x, p)))
    turned, moved = top.accelerations(top.N)
    expected = [*turned, *moved, *cross(top.Gamma, top.Omega)]
    assert same(values(found.rates, solved(found, point)), expected) == right


# -- the laws --------------------------------------------------------------------------------------

TORQUE = 'Omega = "-cross(s, F)"'


@pytest.mark.parametrize("torque", ["-cross(s, F)", "cross(s, F)"])
def test_the_energy_changes_by_the_work_at_the_contact(torque):
    """dE/dt = F . v; with the torque of the other sign Jellett's is kept and this is not.

    The balance that the certificate states is that of the declared forces, and holds of the twins.
    """
    right = torque == "-cross(s, F)"
    motion = changed((TORQUE, f'Omega = "{torque}"'))
    setting, seen = motion.equations.setting, dict(motion.equations.exact.observables)
    F, v = ([seen[f"{name}{n}"] for n in (1, 2, 3)] for name in ("friction", "slip"))
    power = setting.field.sum(f * x for f, x in zip(F, v, strict=True))
    energy = motion.equations.exact.energy
    assert motion.where.contains(motion.rate(energy) - motion.value(power)) == right
    assert motion.where.contains(motion.energy_balance())
    assert motion.where.contains(motion.rate(seen["jellett"]))


def test_friction_is_no_gain_of_jellett():
    """A torque along the axis changes it, that of friction above has no part along the arm."""
    motion = changed((TORQUE, 'Omega = "-cross(s, F) - vector(0, 0, N)"'), (', "jellett"]', "]"))
    jellett = dict(motion.equations.exact.observables)["jellett"]
    assert not motion.where.contains(motion.rate(jellett))


def test_forces_are_the_reactions_of_the_text():
    """Along Y the friction -N drag v, linear in the reaction, with the parts by their names."""
    setting = emitted("tippe_top").setting
    along = external_forces(setting, [f"Y{n}" for n in (1, 2, 3)])
    drag, v = setting.field["_a7"], [setting.field[f"_a{n}"] for n in (4, 5, 6)]
    N = setting.field["plane_reaction"] + setting.field["m"] * setting.field["g"]
    assert all(f == -N * drag * x for f, x in zip(along, v, strict=True))


# -- motions ---------------------------------------------------------------------------------------


LAWS = ({"viscous": 0.1, "coulomb": 0.0}, {"viscous": 0.0, "coulomb": 0.1})


@pytest.mark.parametrize("law", LAWS, ids=["viscous", "Coulomb"])
def test_it_turns_upside_down(law):
    """Gamma3 goes to -1, and the last spin follows from Jellett's integral: -w s3(0)/(r + e).

    Meanwhile the energy falls, the plane presses and Jellett's integral stays; without friction it
    does not turn over.
    """
    run = tippe_top.simulate(START, (0, 60), parameters=law, samples=301, rtol=1e-8, atol=1e-9)
    assert run.drift["jellett"] < 1e-6
    assert run["normal_force"].min() > 5
    assert np.diff(run["energy"]).max() < 1e-6
    assert run["Gamma"][2][-1] < -0.999
    assert run["Omega"][2][-1] == pytest.approx(-20 * (399 / 401 - 0.2) / 1.2, rel=2e-3)
    smooth = tippe_top.simulate(START, (0, 10), parameters=dict.fromkeys(law, 0.0))
    assert smooth["Gamma"][2].min() > 0.9
    assert np.ptp(smooth["energy"]) < 1e-5


@pytest.mark.parametrize("upside", [1, -1])
def test_fast_spin_is_stable_on_the_published_side(upside):
    """Upright stable if I1/I3 < 1 - e/r, upside down stable if I1/I3 < 1 + e/r (Or 1994).

    The thresholds hold for large spin, so that they are tried 10 % off.
    """
    threshold = 1 - 0.2 * upside
    for factor in (0.9, 1.1):
        parameters = {"I1": 0.42 * threshold * factor, "I3": 0.42, "viscous": 0.3, "coulomb": 0.0}
        state = [0, 0, 200.0, 0, 0, 0, 0, 0, upside]
        slopes = tippe_top.jacobian(np.array(state), parameters)
        growth = np.linalg.eigvals(slopes).real.max()
        assert (growth > 1e-4) == (factor > 1)


def test_a_run_that_leaves_the_plane_ends_there():
    """With a fast spin the centre of mass rises so fast that the normal force comes to zero."""
    start = START | {"Omega": [0.0, 0.0, 30.0]}
    run = tippe_top.simulate(start, (0, 20), parameters={"viscous": 0.3, "coulomb": 0.0})
    assert run.status == "DOMAIN"
    assert run["normal_force"][-1] == pytest.approx(0, abs=1e-6)
