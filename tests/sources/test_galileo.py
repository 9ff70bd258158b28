"""Galilean relativity, sections 1.1 and 1.2.1: admissible laws and what they conserve.

Laws are typed from Holm (2011), Geometric Mechanics II; beside each stands one that must fail.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from coadjoint.errors import ClaimError
from coadjoint.exact.dense import add, cross, dot, scale, subtract
from coadjoint.groups.galilean import Galilean, particles, subgroups, transformation_defects
from coadjoint.groups.quaternions import Quaternion, euler_rodrigues
from coadjoint.theory.relativity import (
    check_galilean,
    classify,
    conserved_quantities,
    drifts,
    pair_forces,
)

EVERY_SYMMETRY = {"rotation", "boost", "translation", "time shift"}
EVERY_QUANTITY = {"E", "P", "J", "K"}


def gravity(system, power=3):
    """Attraction with ``|F| = k m_i m_j / r^2`` (equal strengths here) and its potential."""
    field, pairs = system.field, []
    for i in system.numbers:
        pairs += [subtract(system.position(i), system.position(j)) for j in range(1, i)]

    def law(r, v):
        return scale(-field["k"] / field.call("sqrt", dot(r, r)) ** power, r)

    potential = sum((-field["k"] / field.call("sqrt", dot(r, r)) for r in pairs), field.zero)
    return pair_forces(system, law), potential


@pytest.mark.parametrize("count", [2, 3])
def test_1_1_gravity_is_galilean(count):
    """``r''`` = F maps to itself under r -> R r + v t + r0, t -> t + tau, also all at once."""
    system = particles(count, ["k"], functions=count * (count - 1) // 2)
    forces, _ = gravity(system)
    check_galilean(system, forces)
    field = system.field
    names = [tuple(f"{word}{n}" for n in "123") for word in ("turn", "boost", "to")]
    turn, boost, shift = (tuple(field[name] for name in row) for row in names)
    rotation = euler_rodrigues(Quaternion(field.one, *turn))
    everything = Galilean(rotation, boost, shift, field["delay"])
    defects = transformation_defects(system, forces, everything)
    assert len(defects) == 3 * count
    assert not any(defects)


def forbidden(system):
    """Laws that break relativity, with the transformation that shows it."""
    field, k = system.field, system.field["k"]
    r, v = subtract(system.position(1), system.position(2)), system.velocity(1)
    return {
        "absolute place": (system.position(1), "translation"),
        "absolute velocity": (scale(k, v), "boost"),
        "explicit time": (scale(field["t"], r), "time shift"),
        "preferred axis": ((k * r[0], field.zero, field.zero), "rotation"),
        "constant wind": (field.vector((0, 0, 1)), "rotation"),
    }


FORBIDDEN = ["absolute place", "absolute velocity", "explicit time", "preferred axis"]


@pytest.mark.parametrize("name", [*FORBIDDEN, "constant wind"])
def test_1_1_forbidden_laws_are_named(name):
    """A law in absolute r, absolute v, t or a fixed direction fails, its transformation named."""
    system = particles(2, ["k"])
    force, transformation = forbidden(system)[name]
    with pytest.raises(ClaimError) as caught:
        check_galilean(system, (force, scale(-1, force)))
    assert caught.value.transformation == transformation
    assert f"a {transformation} changes it by {caught.value.defect}" in str(caught.value)
    assert caught.value.component in str(caught.value)


def test_1_1_the_defects_are_those_of_the_transformation():
    """Under a translation, F = r1 changes by r0 exactly; under the others it does not."""
    system = particles(2)
    field = system.field
    forces = (system.position(1), system.field.vector((0, 0, 0)))
    found = {
        name: transformation_defects(system, forces, g) for name, g in subgroups(system).items()
    }
    shift, boost = ([field[f"{word}{n}"] for n in "123"] for word in ("to", "boost"))
    assert found["translation"] == (*shift, 0, 0, 0)
    assert found["boost"] == (*scale(field["t"], boost), 0, 0, 0)
    assert not any(found["rotation"])
    assert not any(found["time shift"])


@pytest.mark.parametrize("count", [2, 3])
def test_1_2_1_pair_forces_conserve_all_ten(count):
    """m_i r_i'' = sum f(r_ij) conserves E, P, J and K = t P - sum m r, four drifts exactly zero."""
    system = particles(count, ["k"], functions=count * (count - 1) // 2)
    forces, potential = gravity(system)
    verdict = classify(system, forces, potential)
    assert verdict.symmetries == EVERY_SYMMETRY
    assert verdict.conserved == EVERY_QUANTITY
    assert verdict.is_galilean
    found = drifts(system, forces, potential)
    assert {name: len(values) for name, values in found.items()} == {"E": 1, "P": 3, "J": 3, "K": 3}


def test_1_2_1_a_force_of_another_potential_loses_the_energy():
    """With a force of the wrong power, E drifts and P, J and K do not."""
    system = particles(2, ["k"], functions=1)
    forces, potential = gravity(system, power=5)
    assert classify(system, forces, potential).conserved == EVERY_QUANTITY - {"E"}


def test_1_2_1_centre_of_mass_integral():
    """K = t P - sum m r by hand; without the factor t it drifts by -P."""
    system = particles(2, ["k"], functions=1)
    forces, _ = gravity(system)
    m1, m2 = system.mass(1), system.mass(2)
    P = add(scale(m1, system.velocity(1)), scale(m2, system.velocity(2)))
    moment = add(scale(m1, system.position(1)), scale(m2, system.position(2)))
    K = subtract(scale(system.field["t"], P), moment)
    assert conserved_quantities(system)["K"] == K
    motion = system.motion(forces)
    assert motion.rates(K) == (0, 0, 0)
    assert motion.rates(moment) == P


def isotropic(system, along_r, along_v, across):
    """``f = a r + b v + c r x v``, the general isotropic law; a, b, c may be any symbols."""

    def law(r, v):
        return add(add(scale(along_r, r), scale(along_v, v)), scale(across, cross(r, v)))

    return pair_forces(system, law)


def test_1_2_1_isotropic_laws_of_differences():
    """Any a r + b v is admissible and conserves P and K; J needs b = 0, and r x v breaks P.

    The coefficients stand for arbitrary functions of r.r, r.v and v.v, which are invariant.
    """
    system = particles(2, ["a", "b", "c"])
    a, b, c, zero = (*(system.field[name] for name in "abc"), system.field.zero)
    central = classify(system, isotropic(system, a, zero, zero))
    assert central.is_galilean
    assert central.conserved == {"P", "J", "K"}
    drag = classify(system, isotropic(system, a, b, zero))
    assert drag.is_galilean
    assert drag.conserved == {"P", "K"}
    twisted = classify(system, isotropic(system, a, b, c))
    assert twisted.is_galilean
    assert twisted.conserved == set()


def test_1_2_1_negative_controls():
    """Force laws in absolute r or t lose their symmetry and the quantity that goes with it."""
    system = particles(2, ["k"])
    k, t = system.field["k"], system.field["t"]
    tied = [scale(-k, system.position(n)) for n in system.numbers]
    verdict = classify(system, tied)
    assert verdict.symmetries == EVERY_SYMMETRY - {"boost", "translation"}
    assert verdict.conserved == {"J"}
    driven = pair_forces(system, lambda r, v: scale(-k * t, r))
    r = subtract(system.position(1), system.position(2))
    verdict = classify(system, driven, k * t * dot(r, r) / 2)
    assert verdict.symmetries == EVERY_SYMMETRY - {"time shift"}
    assert verdict.conserved == EVERY_QUANTITY - {"E"}


def flow_defect(anchor):
    """|transform(flow) - flow(transform)| for three bodies; an anchor ties them to the origin."""
    source = np.random.default_rng(3)
    start, span = source.normal(size=(2, 3, 3)), 0.8
    R = np.array(euler_rodrigues(Quaternion(0.6, 0.0, 0.48, 0.64)))
    boost, shift = source.normal(size=(2, 3))

    def rate(t, y):
        r, v = y.reshape(2, 3, 3)
        apart = r[:, None] - r[None]
        pull = -apart / (0.1 + (apart**2).sum(-1, keepdims=True)) ** 1.5
        return np.concatenate([v, pull.sum(1) - anchor * r]).ravel()

    def run(state, first):
        end = (first, first + span)
        done = solve_ivp(rate, end, state.ravel(), method="DOP853", rtol=1e-12, atol=1e-12)
        return done.y[:, -1].reshape(2, 3, 3)

    def transform(state, t):
        r, v = state
        return np.array([r @ R.T + boost * t + shift, v @ R.T + boost])

    there = transform(run(start, 0.0), span)
    back = run(transform(start, 0.0), 0.0)
    return np.abs(there - back).max()


def test_1_1_transforming_commutes_with_the_flow():
    """transform(flow) = flow(transform) for free pair forces, and not when tied to the origin."""
    # DOP853 at 1e-12 over less than one close passage keeps nine digits.
    assert flow_defect(anchor=0.0) < 1e-9
    assert flow_defect(anchor=1.0) > 1e-2
