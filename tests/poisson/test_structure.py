"""Poisson structures: bracket, motion, Jacobi identity, Casimirs, rank and sums."""

from itertools import combinations

import pytest

from coadjoint.algebra import algebra_by_name, from_brackets
from coadjoint.errors import AlgebraError
from coadjoint.exact import Field
from coadjoint.poisson import (
    PoissonStructure,
    canonical,
    declare_bracket,
    lie_poisson,
    nambu,
)
from coadjoint.poisson.structure import antisymmetric, compatible_sum
from coadjoint.theory import freeze_bracket

NAMES = ["so(3)", "se(3)", "so(4)", "sp(4)", "g(3)", "bargmann", "su(3)", "so(2,1)", "h(2)"]


def dual(name, sign=-1):
    """The Lie-Poisson structure of a named algebra."""
    algebra = algebra_by_name(name)
    return lie_poisson(algebra, Field(algebra.basis), algebra.basis, sign)


def check_axioms(structure, f, g, h):
    """Skew, Leibniz and Jacobi for three functions that do not commute."""
    bracket = structure.bracket
    assert bracket(f, g) != 0, "functions that commute satisfy every axiom"
    assert bracket(f, g) == -bracket(g, f)
    assert bracket(f * g, h) == f * bracket(g, h) + g * bracket(f, h)
    cyclic = [bracket(f, bracket(g, h)), bracket(g, bracket(h, f)), bracket(h, bracket(f, g))]
    assert sum(cyclic, structure.field.zero) == 0


def quadratics(structure):
    """Three functions with mixed terms."""
    x = [structure.field[name] for name in structure.names]
    return x[0] * x[-1] + x[1], x[1] ** 2 + x[2], sum(x, structure.field.zero) ** 2


@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize("name", NAMES)
def test_lie_poisson_brackets_satisfy_the_axioms(name, sign):
    """Minus and plus brackets are skew derivations that satisfy Jacobi (Holm 2011, 2.5.1)."""
    structure = dual(name, sign)
    structure.check_jacobi()
    if name != "h(2)":
        check_axioms(structure, *quadratics(structure))


def test_axioms_check_sees_a_tensor_that_is_not_poisson():
    """The check above can fail: with {x, y} = x^2 z the cyclic sum is not zero."""
    field = Field(["x", "y", "z"])
    x, y, z = (field[name] for name in field.names)
    tensor = antisymmetric(field, 3, {(0, 1): x**2 * z, (1, 2): x, (0, 2): -y})
    structure = PoissonStructure(field, field.names, tensor)
    with pytest.raises(AssertionError):
        check_axioms(structure, *quadratics(structure))


@pytest.mark.parametrize("name", NAMES)
def test_the_jacobi_identity_of_a_linear_bracket_sees_one_wrong_sign(name):
    """Flipping one entry of a Lie-Poisson tensor is refused, but for degenerate algebras."""
    structure = dual(name)
    refused = 0
    for i, j in combinations(range(structure.dimension), 2):
        if structure.tensor[i][j] != 0:
            entries = {
                (a, b): structure.tensor[a][b] * (-1 if (a, b) == (i, j) else 1)
                for a, b in combinations(range(structure.dimension), 2)
            }
            tensor = antisymmetric(structure.field, structure.dimension, entries)
            spoiled = PoissonStructure(structure.field, structure.names, tensor)
            refused += bool(spoiled.jacobi_defects())
    # so(3) becomes so(2,1), another algebra; in h(n) any constants do.
    assert (refused > 0) == (name not in ("so(3)", "so(2,1)", "h(2)"))


def test_a_violation_names_the_triple_and_what_is_left():
    """{x, y} = z, {y, z} = x^2 + y, {z, x} = y + x leaves a defect, shown in the message."""
    field = Field(["x", "y", "z"])
    x, y, z = (field[name] for name in field.names)
    with pytest.raises(
        AlgebraError, match=r"\{x, \{y, z\}\} \+ cyclic = x\^2 \+ y \+ z;"
    ) as caught:
        declare_bracket(field, field.names, {(0, 1): z, (1, 2): x**2 + y, (2, 0): y + z}, "mine")
    assert caught.value.triple == ["x", "y", "z"]
    assert "mine" in str(caught.value)
    assert caught.value.defect in str(caught.value)


def test_the_defect_is_the_cyclic_sum():
    """What the proof shows of a linear tensor that fails is {a, {b, c}} + cyclic, sign included."""
    field = Field(["a", "b", "c"])
    a, b, c = (field[name] for name in field.names)
    tensor = antisymmetric(field, 3, {(0, 1): a, (0, 2): b})
    structure = PoissonStructure(field, field.names, tensor)
    ((triple, defect),) = structure.jacobi_defects().items()
    bracket = structure.bracket
    cyclic = bracket(a, bracket(b, c)) + bracket(b, bracket(c, a)) + bracket(c, bracket(a, b))
    assert triple == (0, 1, 2)
    assert defect == cyclic == -b


def test_constants_with_parameters_are_read_off():
    """[e1, e2] = a e3 and cyclic with parameters satisfies Jacobi for all values."""
    field = Field(["x", "y", "z", "a", "b"])
    x, y, z, a, b = (field[name] for name in field.names)
    structure = declare_bracket(
        field, ("x", "y", "z"), {(0, 1): a * z, (1, 2): b * x, (2, 0): y / a}
    )
    assert structure.lie_algebra.dimension == 3
    assert structure.generic_rank() == 2
    assert structure.is_casimir(b * x**2 + y**2 / a + a * z**2)
    assert not structure.is_casimir(b * x**2 + y**2 / a - a * z**2)


def test_constant_terms_stand_with_a_central_generator():
    """The affine bracket {q, p} = 1 + q is read as an algebra with one more generator."""
    field = Field(["q", "p"])
    structure = declare_bracket(field, field.names, {(0, 1): 1 + field["q"]})
    assert structure.lie_algebra.basis == ("q", "p", "1")


def test_a_tensor_that_is_not_antisymmetric_is_refused():
    """The message shows both entries."""
    field = Field(["x", "y"])
    tensor = ((field.zero, field["x"]), (field["x"], field.zero))
    with pytest.raises(AlgebraError, match=r"\{y, x\} = x and \{x, y\} = x"):
        PoissonStructure(field, ("x", "y"), tensor)


def test_a_tensor_of_the_wrong_size_is_refused():
    """The message shows the sizes found."""
    field = Field(["x", "y"])
    with pytest.raises(AlgebraError, match=r"rows of \[2\] entries"):
        PoissonStructure(field, ("x", "y"), ((field.zero, field.zero),))


def test_the_motion_is_the_bracket_with_the_hamiltonian():
    """dx_i/dt = {x_i, h}, and h is conserved."""
    structure = dual("se(3)")
    h = quadratics(structure)[0]
    motion = structure.hamiltonian_vector_field(h)
    expected = tuple(structure.bracket(structure.field[x], h) for x in structure.names)
    assert motion == expected
    assert any(motion)
    assert structure.bracket(h, h) == 0


def test_casimirs_are_told_from_other_functions():
    """J.P is a Casimir of se(3)*, J.J is not."""
    structure = dual("se(3)")
    J, P = ([structure.field[f"{v}{n}"] for n in (1, 2, 3)] for v in "JP")
    assert structure.is_casimir(sum((a * b for a, b in zip(J, P, strict=True)), 0 * J[0]))
    assert not structure.is_casimir(sum((a * a for a in J), 0 * J[0]))


@pytest.mark.parametrize(
    ("name", "rank"), [("so(3)", 2), ("se(3)", 4), ("so(4)", 4), ("g(3)", 8), ("bargmann", 8)]
)
def test_ranks_are_those_of_the_book(name, rank):
    """Generic ranks of the tensors, and the same by the algebra alone."""
    assert dual(name).generic_rank() == rank == algebra_by_name(name).generic_rank()


def test_a_compatible_sum_is_poisson():
    """Lie-Poisson and frozen-argument brackets add up, for every point and sign."""
    algebra = algebra_by_name("so(4)")
    parameters = [f"p{n}" for n in range(6)]
    field = Field([*algebra.basis, *parameters])
    for sign in (-1, 1):
        first = lie_poisson(algebra, field, algebra.basis, sign)
        point = [field[p] for p in parameters]
        total = first + freeze_bracket(algebra, field, algebra.basis, point, sign)
        assert (
            total.bracket(field["E12"], field["E13"])
            == first.bracket(field["E12"], field["E13"]) + sign * -field["p3"]
        )


def test_an_incompatible_sum_is_refused():
    """{x, y} = z and {y, z} = y are Poisson one by one, their sum is not."""
    field = Field(["x", "y", "z"])
    first = declare_bracket(field, field.names, {(0, 1): field["z"]})
    second = declare_bracket(field, field.names, {(1, 2): field["y"]}, "other")
    with pytest.raises(AlgebraError, match=r"other: the bracket violates .* cyclic = z;"):
        compatible_sum(first, second)


def test_sums_want_the_same_coordinates():
    """The message shows both lists of coordinates."""
    field = Field(["q", "p", "x", "y", "z"])
    body = nambu(field, ("x", "y", "z"), [field["x"] ** 2])
    with pytest.raises(AlgebraError, match=r"q, p and .* has x, y, z"):
        compatible_sum(canonical(field, [("q", "p")]), body)


def test_a_sum_with_a_number_is_no_sum():
    """Only structures add up."""
    field = Field(["q", "p"])
    with pytest.raises(TypeError):
        canonical(field, [("q", "p")]) + 1


def test_lie_poisson_reads_parameters_of_the_algebra():
    """Constants that are elements of the field become entries."""
    field = Field(["x", "y", "a"])
    algebra = from_brackets("mine", ("e1", "e2"), {(0, 1): {1: field["a"]}})
    structure = lie_poisson(algebra, field, ("x", "y"))
    assert structure.tensor[0][1] == -field["a"] * field["y"]
