"""Central forces: degenerate cases of Kepler and the monopole."""

import pytest

from coadjoint.exact.dense import dot, scale
from coadjoint.theory.central_forces import (
    alignment,
    alignment_defect,
    hamilton_vector,
    kepler_energy,
    kepler_force,
    laplace_runge_lenz,
    monopole_energy,
    monopole_force,
    monopole_laplace_runge_lenz,
    poincare_vector,
    point_motion,
)


@pytest.fixture
def motion():
    """A point with strengths mu and lam."""
    return point_motion()


def test_without_a_monopole_the_problem_is_keplers(motion):
    """At lam = 0 force, E, P and A are those of Kepler; at lam = 1 they are not."""
    field = motion.field

    def at(lam, quantity):
        return [field.substitute(field.zero + x, {"lam": field.number(lam)}) for x in quantity]

    for monopole, kepler in (
        (monopole_force(motion), kepler_force(motion)),
        ([monopole_energy(motion)], [kepler_energy(motion)]),
        (poincare_vector(motion), motion.angular_momentum),
        (monopole_laplace_runge_lenz(motion), laplace_runge_lenz(motion)),
    ):
        assert at(0, monopole) == list(kepler)
        assert at(1, monopole) != list(kepler)


def test_the_monopole_keeps_to_a_cone(motion):
    """P . r = -lam |r|, and P.P = L.L + lam^2."""
    lam, field = motion.field["lam"], motion.field
    P, L = poincare_vector(motion), motion.angular_momentum
    assert field.is_zero(dot(P, motion.r) + lam * motion.distance)
    assert field.is_zero(dot(P, P) - dot(L, L) - lam**2)
    assert not field.is_zero(dot(P, motion.r) - lam * motion.distance)


def test_hamiltons_vector_is_undefined_on_a_straight_line(motion):
    """K divides by L^2: with v along r it has no value."""
    field = motion.field
    straight = dict(zip(("v1", "v2", "v3"), scale(2, motion.r), strict=True))
    assert field.is_zero(field.substitute(dot(*[motion.angular_momentum] * 2), straight))
    with pytest.raises(ZeroDivisionError):
        field.substitute(hamilton_vector(motion)[0], straight)


def test_alignment_holds_for_a_force_that_is_not_central(motion):
    """The Riccati equation has no defect for the monopole, and has one where r' is 2 v."""
    field, force = motion.field, motion.field.vector(monopole_force(motion))
    assert all(map(field.is_zero, alignment_defect(motion, force).components))
    q, X = alignment(motion.r, motion.v), motion.under(force)
    faster = X.like((*scale(2, motion.v), *force))
    for flow, holds in ((X, True), (faster, False)):
        riccati = flow.derivative(q.w) + q.w**2 - dot(q.vector, q.vector)
        assert field.is_zero(riccati - alignment(motion.r, force).w) is holds
