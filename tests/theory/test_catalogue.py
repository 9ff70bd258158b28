"""Groups by name: what is known, and what is refused."""

import pytest

from coadjoint.errors import AlgebraError, CoadjointError
from coadjoint.theory import matrix_group
from coadjoint.theory.catalogue import CATALOGUE


@pytest.mark.parametrize("example", [example for _, example, _ in CATALOGUE])
def test_each_example_is_a_group(example):
    """The names that messages show can be had, with one coordinate for each generator."""
    group = matrix_group(example, "g", ["xi"], ["t"])
    assert group.name == example
    assert len(group.symbols) == group.algebra.dimension == len(group.vector("xi"))
    assert group.field["t"] != 0


@pytest.mark.parametrize(
    ("name", "dimension"),
    [
        *(("SO(4)", 6), ("SO(3,1)", 6), ("SU(3)", 8), ("U(3)", 9), ("SL(3)", 8), ("GL(3,R)", 9)),
        *(("Sp(4,R)", 10), ("SE(4)", 10), ("H(2)", 5), ("G(3)", 10), ("Bargmann", 11)),
    ],
)
def test_dimensions(name, dimension):
    """Dimensions as books state them."""
    assert matrix_group(name).algebra.dimension == dimension


def test_spaces_do_not_matter():
    """Books write names with and without spaces."""
    assert matrix_group("SL(2, R) (s) R^2").algebra.dimension == 5


@pytest.mark.parametrize(
    ("name", "near"), [("S0(3)", "SO(3)"), ("Bargman", "Bargmann"), ("unit quaternion", "unit q")]
)
def test_an_unknown_group_is_refused_with_the_nearest(name, near):
    """The message has the name that was given and the nearest one."""
    with pytest.raises(AlgebraError) as refused:
        matrix_group(name)
    assert f"no group is called {name!r}" in str(refused.value)
    assert f"Did you mean '{near}" in str(refused.value)
    assert refused.value.found == name


def test_an_unknown_group_without_neighbours_is_refused():
    """Where no name is near, the message lists what there is."""
    with pytest.raises(AlgebraError, match=r"no group is called 'E8'; expected one like SO\(3\)"):
        matrix_group("E8")


@pytest.mark.parametrize("name", ["Sp(3)", "SO(1)", "SO(1,0)", "GL(0)", "SL(1)"])
def test_a_size_that_does_not_exist_is_refused(name):
    """The algebra's own refusal comes through, with its name."""
    with pytest.raises(AlgebraError, match=name.lower().split("(")[0]):
        matrix_group(name)


@pytest.mark.parametrize("name", ["SO(999999)", "SO(99999,99999)", "SU(99999)", "U(99999)"])
def test_an_exploding_size_is_refused_before_anything_is_built(name):
    """The bound on generators is checked first."""
    with pytest.raises(CoadjointError, match="generators"):
        matrix_group(name)
