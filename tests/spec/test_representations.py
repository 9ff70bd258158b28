"""Representations: declared matrices act as the algebra does, or are refused at their place."""

import pytest

from coadjoint.algebra import algebra_by_name
from coadjoint.errors import AlgebraError
from tests.spec.texts import BY_BRACKETS, check_shown, refused
from tests.specs import RIGID_BODY, spec


@pytest.mark.parametrize(
    ("name", "count"),
    [
        *[("vector", 3), ("dual", 3), ("defining", 3), ("adjoint", 3), ("coadjoint", 3)],
        *[("symmetric", 6), ("columns", 9), ("trivial", 1)],
    ],
)
def test_every_representation_of_the_catalogue_has_its_name(name, count):
    """An advected quantity of so(3) has as many components as the space that is acted on."""
    line = f'a = {{ role = "advected", representation = "{name}" }}'
    (variable,) = spec(RIGID_BODY, ("[parameters]", f"{line}\n[parameters]")).having_role(
        "advected"
    )
    assert variable.shape == (() if count == 1 else (count,))
    assert variable.representation.algebra == algebra_by_name("so(3)")


def test_entries_may_be_polynomials_of_parameters():
    """The shear by k + 1 in place of 1 is a representation for every k."""
    text = BY_BRACKETS + "[parameters]\nk = {}\n"
    shear = spec(text, ("[[0, 1], [0, 0]]", "[[0, 'k + 1'], [0, 0]]")).variables[2].representation
    (entry,) = shear.matrices[0].values()
    assert entry - 1 != 0
    assert str(entry) == "k + 1"
    error = refused(("[[0, 1], [0, 0]]", "[[0, 'q + 1'], [0, 0]]"), text=text)
    assert (error.key, error.found) == ("representations.shift.matrices.e1[1][2]", "q")


@pytest.mark.parametrize(
    ("change", "key", "found", "said"),
    [
        (("e1 = [[0", "e7 = [[0"), "representations.shift.matrices.e7", "e7", "e1, e2, e3"),
        (("[0, 0]]", "[0]]"), "representations.shift.matrices.e1", "2, 1", "2 rows of 2"),
        (("[[0, 1], [0, 0]]", "[]"), "representations.shift.matrices.e1", "", "1 rows of 1"),
        (("s.shift]", "s.vector]"), "representations.vector", "vector", "every algebra has"),
    ],
)
def test_misfit_is_refused_at_its_place(change, key, found, said):
    """Unknown names, wrong sizes and keys out of place are shown with what would fit."""
    error = refused(change)
    check_shown(error, key, found, said)


@pytest.mark.parametrize(
    ("change", "text", "said"),
    [
        (("[[0, 1], [0, 0]]", "[[0, 1], [0, 0]], e3 = [[1, 0], [0, 0]]"), BY_BRACKETS, "commute"),
        (('n = "shift"', 'n = "vector"'), BY_BRACKETS, "no matrices"),
    ],
)
def test_what_makes_no_algebra_is_refused_with_its_line(change, text, said):
    """The error names the law that fails and points into the file."""
    error = refused(change, text=text, kind=AlgebraError)
    assert said in str(error)
    assert str(error).startswith(f"sample.toml:{error.line}:")
