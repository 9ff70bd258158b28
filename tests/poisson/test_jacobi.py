"""The Schouten bracket of tensors that are not linear."""

from itertools import combinations

from coadjoint.exact import Field
from coadjoint.poisson.jacobi import schouten_bracket, slopes_by
from coadjoint.poisson.structure import antisymmetric


def quadratic(power=1):
    """{x_i, x_j} = a_ij x_i^power x_j with undetermined coefficients in four dimensions."""
    pairs = list(combinations(range(4), 2))
    names = [f"x{n}" for n in range(4)]
    field = Field([*names, *(f"a{i}{j}" for i, j in pairs)])
    entries = {
        (i, j): field[f"a{i}{j}"] * field[names[i]] ** power * field[names[j]] for i, j in pairs
    }
    return field, names, antisymmetric(field, 4, entries)


def test_quadratic_brackets_in_logarithms_are_poisson():
    """{x_i, x_j} = a_ij x_i x_j is canonical in the logarithms, for every antisymmetric a."""
    field, names, tensor = quadratic()
    defects = list(schouten_bracket(tensor, slopes_by(field, names)).values())
    assert len(defects) == 4
    assert all(defect == 0 for defect in defects)


def test_the_schouten_bracket_sees_another_power():
    """With x_i^2 x_j in place of x_i x_j every triple has a defect."""
    field, names, tensor = quadratic(power=2)
    defects = schouten_bracket(tensor, slopes_by(field, names)).values()
    assert all(defect != 0 for defect in defects)


def test_triples_to_which_nothing_contributes_are_not_listed():
    """A constant tensor has no triples at all."""
    field = Field(["q", "p", "z"])
    tensor = antisymmetric(field, 3, {(0, 1): field.one})
    assert schouten_bracket(tensor, slopes_by(field, field.names)) == {}
