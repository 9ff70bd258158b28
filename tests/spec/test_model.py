"""The model: packed components stand for the matrices that books write."""

from fractions import Fraction
from itertools import combinations

import pytest

from coadjoint.exact import Field
from coadjoint.spec.model import FORMS, Variable, component_names, matrix_size, unpack


@pytest.mark.parametrize("size", range(2, 13))
def test_sizes_are_those_of_the_counts(size):
    """n(n - 1)/2, n(n + 1)/2 and n^2 components make n by n matrices, and no other count does."""
    counts = {
        "antisymmetric": size * (size - 1) // 2,
        "symmetric": size * (size + 1) // 2,
        "matrix": size**2,
    }
    for form, count in counts.items():
        assert matrix_size(count, form) == size
    assert [matrix_size(n, "antisymmetric") for n in (0, 2, 4, 5, 7)] == [None] * 5
    assert [matrix_size(n, "symmetric") for n in (0, 2, 4, 5, 7)] == [None] * 5
    assert [matrix_size(n, "matrix") for n in (0, 2, 3, 5, 15)] == [None] * 5


def check_antisymmetric(rows):
    """M^T = -M, for a matrix that is not 0."""
    assert any(value != 0 for row in rows for value in row)
    for i, j in combinations(range(len(rows)), 2):
        assert rows[i][j] == -rows[j][i]
    assert all(row[i] == 0 for i, row in enumerate(rows))


def check_symmetric(rows):
    """S^T = S, for a matrix that is neither 0 nor diagonal."""
    pairs = list(combinations(range(len(rows)), 2))
    assert any(rows[i][j] != 0 for i, j in pairs)
    assert all(rows[i][j] == rows[j][i] for i, j in pairs)


@pytest.mark.parametrize("count", [1, 3, 6, 28])
def test_unpacked_matrices_have_the_form(count):
    """Above the diagonal, or with it, row by row; the components' names say the same places."""
    values = [Fraction(n + 1, 7) for n in range(count)]
    check_antisymmetric(unpack(values, "antisymmetric"))
    for form in ("antisymmetric", "symmetric"):
        rows = unpack(values, form)
        for name, value in zip(component_names("M", (count,), form), values, strict=True):
            assert rows[int(name[1]) - 1][int(name[2]) - 1] == value
    if count > 1:
        check_symmetric(unpack(values, "symmetric"))
    with pytest.raises(AssertionError):
        check_antisymmetric(unpack(values, "symmetric"))
    if count > 1:
        with pytest.raises(AssertionError):
            check_symmetric(unpack(values, "antisymmetric"))


def test_unpacking_takes_any_values():
    """Elements of a field, whose zero stands on the diagonal, and a matrix row by row."""
    field = Field(["a", "b", "c"])
    rows = unpack(field.vector([field["a"], field["b"], field["c"]]), "antisymmetric")
    check_antisymmetric(rows)
    assert rows[2][0] == -field["b"]
    assert rows[1][1] == field.zero
    assert unpack([1, 2, 3, 4], "matrix") == ((1, 2), (3, 4))


def test_names_of_packed_components():
    """M12, M13, ...; an underscore where indices have two digits or the name ends in one."""
    assert component_names("S", (3,), "symmetric") == ("S11", "S12", "S22")
    assert component_names("A", (4,), "matrix") == ("A11", "A12", "A21", "A22")
    assert component_names("M", (45,), "antisymmetric")[8] == "M_1_10"
    assert component_names("M1", (1,), "antisymmetric") == ("M1_12",)


@pytest.mark.parametrize("form", FORMS)
def test_variable_of_a_form_is_a_matrix_in_formulas(form):
    """Its stored shape stays flat."""
    variable = Variable("M", "momentum", (36,), tuple(range(36)), form=form)
    assert variable.shape == (36,)
    assert variable.value_shape == (variable.matrix_size,) * 2
    assert len(variable.components) == 36
    assert Variable("m", "momentum", ()).value_shape == ()
    assert Variable("m", "momentum", ()).matrix_size is None
