"""Galilean relativity: the group law of transformations, messages, roots in a force law."""

import pytest

from coadjoint.errors import ClaimError
from coadjoint.exact.dense import add, apply, dot, product, scale
from coadjoint.groups.galilean import Galilean, particles, subgroups
from coadjoint.theory.relativity import check_galilean, pair_forces


def composed(g, h):
    """(R1, v1, r1, t1)(R2, v2, r2, t2) of section 1.2."""
    return Galilean(
        product(g.rotation, h.rotation),
        add(apply(g.rotation, h.boost), g.boost),
        add(add(apply(g.rotation, h.translation), scale(h.time_shift, g.boost)), g.translation),
        g.time_shift + h.time_shift,
    )


def test_transformations_of_states_compose_as_the_group():
    """Acting with h and then with g is acting with g h, and not with h g."""
    system = particles(2)
    field = system.field
    g = subgroups(system)["boost"]
    h = subgroups(system)["time shift"]

    def after(first, second):
        image = first.state(system)
        return {
            name: field.substitute(value, image) for name, value in second.state(system).items()
        }

    assert after(h, g) == composed(g, h).state(system)
    assert after(h, g) != composed(h, g).state(system)
    r = subgroups(system)["rotation"]
    assert after(g, r) == composed(r, g).state(system)
    assert after(g, r) != composed(g, r).state(system)


def test_a_force_with_a_root_of_the_absolute_distance_is_refused():
    """A pull whose strength depends on |r1| from the origin fails under a translation."""
    system = particles(2, ["k"], functions=1)
    distance = system.field.call("sqrt", dot(system.position(1), system.position(1)))
    forces = pair_forces(system, lambda r, v: scale(system.field["k"] * distance, r))
    with pytest.raises(ClaimError) as caught:
        check_galilean(system, forces)
    assert caught.value.transformation == "translation"
    assert caught.value.component == "F1_1"
    assert caught.value.defect in str(caught.value)


def test_pair_forces_sum_over_the_others():
    """Three particles on springs: F_1 = -k (2 r_1 - r_2 - r_3)."""
    system = particles(3, ["k"])
    k = system.field["k"]
    forces = pair_forces(system, lambda r, v: scale(-k, r))
    r1, r2, r3 = map(system.position, system.numbers)
    assert forces[0] == tuple(-k * (2 * a - b - c) for a, b, c in zip(r1, r2, r3, strict=True))
    assert forces[0] != forces[1]
    assert add(add(*forces[:2]), forces[2]) == (0, 0, 0)
