"""[newton]: laws of coordinates, and every fault with its place and its fix."""

import pytest

from coadjoint.errors import SpecError
from tests.derive.test_configuration import LAW
from tests.specs import spec


def test_laws_are_read_in_the_order_of_the_coordinates():
    """A mass of 1 is the default; formulas know positions, velocities and parameters."""
    changed = LAW.replace('y = { force = "k*(x - y)" }\n', "")
    changed = changed.replace("[newton]\n", '[newton]\ny = { force = "-w - k*y" }\n')
    laws = spec(changed).newton
    assert [law.coordinate for law in laws] == ["x", "y"]
    assert [law.mass.text for law in laws] == ["m", "1"]
    assert laws[1].force.key == "newton.y.force"


@pytest.mark.parametrize(
    ("change", "key", "found", "said"),
    [
        (('y = { force = "k*(x - y)" }\n', ""), "newton", "y", "'y' has no law"),
        (("y = { force", "z = { force"), "newton.z", "z", "no coordinate 'z'"),
        (('"k*(x - y)"', '"k"'), "newton.y.force", "a scalar", "expected a 3-vector, as 'y' is"),
        (('"m"', '"x"'), "newton.x.mass", "a 3-vector", "diag"),
        (('"k*(x - y)"', '"k*x*t"'), "newton.y.force", "t", "'t'"),
        (
            ('w = { role = "velocity", of = "y" }', 'w = { role = "momentum", of = "y" }'),
            None,
            None,
            "momentum",
        ),
        (('conserved = ["P"]', 'conserved = ["energy"]'), None, "energy", "'energy'"),
        (('conserved = ["P"]', 'casimirs = ["x1"]'), "claims.casimirs", "casimirs", "[lagrangian]"),
        (
            ("galilean = true", 'galilean = true\n[claims.brackets]\n"{x, y}" = "0"'),
            "claims.brackets",
            "brackets",
            "without a bracket",
        ),
    ],
)
def test_faults_are_shown_at_their_place(change, key, found, said):
    """The key, what was found, and what was expected or would do."""
    with pytest.raises(SpecError) as caught:
        spec(LAW, change)
    message = str(caught.value)
    assert said in message
    assert key is None or f": {key}: " in message
    assert found is None or found in str(caught.value.parts["found"])


def test_velocities_that_follow_from_momenta_have_no_newton_law():
    """With momenta in the state the law would be one of momenta."""
    text = LAW.replace(
        "[parameters]",
        'p = { role = "momentum", of = "x" }\nq = { role = "momentum", of = "y" }\n[parameters]',
    )
    with pytest.raises(SpecError, match=r"no velocity of 'x' is part of the state") as caught:
        spec(text)
    assert caught.value.parts["found"] == "x"


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        (
            [
                ("shape = [3] }\ny", "shape = [2] }\ny"),
                ("k*(y - x)", "-k*x"),
                ("k*(x - y)", "-k*y"),
                ("m*u + w", "w"),
            ],
            "x",
        ),
    ],
)
def test_only_particles_in_space_have_galilean_laws(changes, found):
    """A coordinate in the plane is not a particle in space."""
    with pytest.raises(SpecError, match="not a particle in space") as caught:
        spec(LAW, *changes)
    assert caught.value.parts["found"] == found


def test_galilean_relativity_needs_a_law():
    """Of a bracket alone nothing can be tried."""
    text = """
title = "x"
routes = ["canonical"]
[variables]
q = { role = "coordinate", shape = [3] }
p = { role = "momentum", of = "q" }
[hamiltonian]
h = "dot(p, p)/2"
[claims]
galilean = true
"""
    with pytest.raises(SpecError, match=r"there is no \[newton\]") as caught:
        spec(text)
    assert caught.value.parts["found"] == "newton"
