"""Algebras: those declared in a spec, from brackets to products of products, are the books' own."""

from fractions import Fraction
from time import process_time

import pytest

from coadjoint.algebra import algebra_by_name, same_constants
from coadjoint.errors import AlgebraError, LimitError, SpecError
from tests.spec.texts import BY_BRACKETS, BY_MATRICES, check_shown, refused
from tests.specs import RIGID_BODY, spec

# -- by brackets and by matrices ------------------------------------------------------------------


def test_declared_brackets_are_the_constants():
    """Heisenberg: [e1, e2] = e3, and the other order has the other sign."""
    algebra = spec(BY_BRACKETS).algebra
    assert {pair: dict(row) for pair, row in algebra.constants.items()} == {(0, 1): {2: 1}}
    other = spec(BY_BRACKETS, ('"[e1, e2]" = "e3"', '"[e2, e1]" = "-2*e3/4"')).algebra
    assert other.constants[0, 1][2] == Fraction(1, 2)
    assert algebra.name == "sample"


def test_combinations_are_exact():
    """Sums, multiples and quotients of basis names, in any order."""
    change = ('"[e1, e2]" = "e3"', '"[e1, e2]" = "2*(e3 - e3/3) + e1*0 + 0"')
    assert dict(spec(BY_BRACKETS, change).algebra.constants[0, 1]) == {2: Fraction(4, 3)}
    assert not spec(BY_BRACKETS, ('"[e1, e2]" = "e3"', '"[e1, e2]" = "0"')).algebra.constants


def test_declared_matrices_give_the_algebra_of_the_catalogue():
    """The hat matrices typed by hand span so(3), and act on vectors as there."""
    declared, known = spec(BY_MATRICES), algebra_by_name("so(3)")
    assert declared.algebra.constants == known.constants
    assert declared.variables[1].shape == (3,)
    assert declared.variables[1].representation.matrices == known.matrices


@pytest.mark.parametrize(
    ("change", "key", "found", "said"),
    [
        (('"[e1, e2]"', '"[e1, e4]"'), "algebra.brackets.[e1, e4]", "e4", "[e1, e2]"),
        (('"[e1, e2]"', '"e1 e2"'), "algebra.brackets.e1 e2", "e1 e2", "[e1, e2]"),
        (('"e3" }', '"e1*e2" }'), "algebra.brackets.[e1, e2]", "", "not a linear combination"),
        (('"e3" }', '"e3 + 1" }'), "algebra.brackets.[e1, e2]", "", "not a linear combination"),
        (('"e3" }', '"e3^2" }'), "algebra.brackets.[e1, e2]", "", "not a linear combination"),
        (('"e3" }', '"2/e3" }'), "algebra.brackets.[e1, e2]", "", "not a linear combination"),
        (('"e3" }', '"e5" }'), "algebra.brackets.[e1, e2]", "e5", "'e5' is not declared"),
        (('["e1", "e2"]', '["e1", "e5"]'), "algebra.blocks.plane[2]", "e5", "e1, e2, e3"),
        (('"e1", "e2", "e3"', '"e1", "_e2", "e3"'), "algebra.basis[2]", "_e2", "not a name"),
    ],
)
def test_misfit_is_refused_at_its_place(change, key, found, said):
    """Unknown names, wrong sizes and keys out of place are shown with what would fit."""
    error = refused(change)
    check_shown(error, key, found, said)


@pytest.mark.parametrize(
    ("change", "text", "said"),
    [
        (('"e3" }', '"e3", "[e2, e1]" = "e3" }'), BY_BRACKETS, "declared twice"),
        (
            ('"[e1, e2]" = "e3"', '"[e1, e1]" = "e3"'),
            BY_BRACKETS,
            "'[e1, e1]' is 0 and needs no declaration",
        ),
        (('"e3" }', '"e3", "[e1, e3]" = "e1" }'), BY_BRACKETS, "Jacobi"),
        (("J3 = [[0, -1", "J3 = [[0, -2"), BY_MATRICES, "not in the span"),
        (
            ("[[0, 0, 1], [0, 0, 0], [-1, 0, 0]]", "[[0, 0, 0], [0, 0, 2], [0, -2, 0]]"),
            BY_MATRICES,
            "linearly dependent",
        ),
        (('name = "so(3)"', 'name = "so3"'), RIGID_BODY, "'so(3)'?"),
    ],
)
def test_what_makes_no_algebra_is_refused_with_its_line(change, text, said):
    """The error names the law that fails and points into the file."""
    error = refused(change, text=text, kind=AlgebraError)
    assert said in str(error)
    assert str(error).startswith(f"sample.toml:{error.line}:")


def test_incomplete_matrices_are_refused():
    """A declared basis needs a matrix for each of its names."""
    error = refused(
        ("[algebra.matrices]", '[algebra]\nbasis = ["J1", "J2", "J3", "J4"]\n[algebra.matrices]'),
        text=BY_MATRICES,
    )
    assert (error.key, error.found) == ("algebra.matrices", "J4")


def test_large_algebras_are_refused_with_their_limit():
    """A long basis and many matrices are refused before they are worked on."""
    names = ", ".join(f'"e{n}"' for n in range(257))
    error = refused(('"e1", "e2", "e3"', names), kind=LimitError)
    assert error.limit == "STATE_COMPONENTS"
    rows = "[" + ", ".join(["[" + "0, " * 64 + "1]"] * 65) + "]"
    error = refused(("J1 = ", f"J0 = {rows}\nJ1 = "), text=BY_MATRICES, kind=LimitError)
    assert error.limit == "MATRIX_ENTRIES"


# -- products -------------------------------------------------------------------------------------


def declared(algebra, parameters=""):
    """The algebra of a spec with one momentum over all of it."""
    return spec(_text(algebra, parameters)).algebra


def _text(algebra, parameters=""):
    return (
        'title = "x"\nroutes = ["lie-poisson"]\n[variables]\nmu = { role = "momentum" }\n'
        f'[hamiltonian]\nh = "0"\n[parameters]\n{parameters}\n[algebra]\n{algebra}\n'
    )


def test_direct_sum_has_the_brackets_of_its_parts():
    """so(3) + aff(1): five dimensions, and the parts commute."""
    algebra = declared('direct_sum = ["so(3)", "aff(1)"]')
    assert algebra.basis == ("J1", "J2", "J3", "e1", "e2")
    assert {pair: dict(row) for pair, row in algebra.constants.items()} == {
        (0, 1): {2: 1},
        (0, 2): {1: -1},
        (1, 2): {0: 1},
        (3, 4): {4: 1},
    }


def test_direct_sum_may_hold_declared_parts():
    """An operand is a name in quotes or a table of the same kind."""
    algebra = declared(
        'direct_sum = ["R^1", { basis = ["u", "v"], brackets = { "[u, v]" = "v" } }]\n'
        'blocks = { line = ["P1"] }'
    )
    assert algebra.basis == ("P1", "u", "v")
    assert dict(algebra.constants[1, 2]) == {2: 1}
    assert algebra.blocks["line"] == (0,)


def test_semidirect_product_with_a_representation():
    """sl(2,R) (s) R^2: [H, p1] = p1, [X, p2] = p1, [Y, p1] = p2 (Holm 2011, section 6.5)."""
    algebra = declared('semidirect = { algebra = "sl(2,R)", representations = { p = "vector" } }')
    assert algebra.basis == ("H", "X", "Y", "p1", "p2")
    assert algebra.blocks["p"] == (3, 4)
    assert dict(algebra.constants[0, 3]) == {3: 1}
    assert dict(algebra.constants[1, 4]) == {3: 1}
    assert dict(algebra.constants[2, 3]) == {4: 1}


#: R^4 as space and time, on which boosts act by ``nu tau`` (Holm 2011, section 6.7).
ITERATED = """
[algebra.semidirect.algebra.semidirect]
algebra = "so(3)"
representations = { K = "vector" }
[algebra.semidirect.representations.P.matrices]
J1 = [[0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 0]]
J2 = [[0, 0, 1, 0], [0, 0, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 0]]
J3 = [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]
K1 = [[0, 0, 0, 1], [0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]
K2 = [[0, 0, 0, 0], [0, 0, 0, 1], [0, 0, 0, 0], [0, 0, 0, 0]]
K3 = [[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1], [0, 0, 0, 0]]
"""


def test_iterated_semidirect_products_make_the_galilei_algebra():
    """g(3) = (so(3) (s) R^3) (s) R^4, constant by constant."""
    assert same_constants(declared(ITERATED), algebra_by_name("g(3)"))
    spoiled = ITERATED.replace("[0, 0, 0, 1]", "[0, 0, 0, 2]")
    assert not same_constants(declared(spoiled), algebra_by_name("g(3)"))


def test_semidirect_sum_with_an_ideal():
    """so(3) acts on itself by its adjoint action: [J1, J2'] = J3' beside [J1', J2'] = J3'."""
    algebra = declared('semidirect = { algebra = "so(3)", ideal = "so(3)", action = "adjoint" }')
    assert algebra.dimension == 6
    assert dict(algebra.constants[0, 4]) == {5: 1}
    assert dict(algebra.constants[3, 4]) == {5: 1}


def test_central_extension_by_a_cocycle():
    """g(3) with [K_i, P_j] = delta_ij M is the Bargmann algebra."""
    algebra = declared(
        'extension = { algebra = "g(3)", center = "M", cocycle = '
        '{ "[K1, P1]" = 1, "[P2, K2]" = "-1", "[K3, P3]" = "1" } }'
    )
    assert same_constants(algebra, algebra_by_name("bargmann"))
    assert algebra.basis[-1] == "M"


def test_leibniz_extension_of_rotations_is_se3():
    """so(3) with coefficients a + b eps, eps^2 = 0."""
    algebra = declared('leibniz = { algebra = "so(3)", order = 2 }')
    assert same_constants(algebra, algebra_by_name("se(3)"))


def test_complexification_of_rotations_is_the_lorentz_algebra():
    """Boosts are i times rotations: [iJ1, iJ2] = -J3."""
    algebra = declared('complexification = "so(3)"')
    assert algebra.killing_signature() == (3, 3, 0)
    assert dict(algebra.constants[3, 4]) == {2: -1}


def test_subalgebra_by_a_sub_basis():
    """(E12 + E34)/2 and so on span one of the two so(3) in so(4)."""
    algebra = declared(
        'subalgebra = { algebra = "so(4)", basis = { X1 = "E12/2 + E34/2", '
        'X2 = "(E13 - E24)/2", X3 = "0.5*E14 + 0.5*E23" } }'
    )
    assert algebra.basis == ("X1", "X2", "X3")
    assert {abs(c) for row in algebra.constants.values() for c in row.values()} == {1}
    assert algebra.killing_signature() == (0, 3, 0)


def test_operands_may_nest():
    """The Bargmann algebra of a sum, doubled: tables in tables."""
    algebra = declared('complexification = { leibniz = { algebra = "h(1)", order = 2 } }')
    assert algebra.dimension == 12


# -- parameters -----------------------------------------------------------------------------------

DEFORMED = 'basis = ["e1", "e2", "e3"]\n[algebra.brackets]\n' + (
    '"[e1, e2]" = "C[3]*e3"\n"[e2, e3]" = "C1*e1"\n"[e3, e1]" = "(C2 + a^2 - a*a)*e2"'
)
PARAMETERS = "C = { shape = [3], positive = true }\na = {}"


def test_constants_may_be_polynomials_of_parameters():
    """[e_i, e_j] = C_k e_k is an algebra for all C, decided once: so(3), so(2,1), e(2), ..."""
    algebra = declared(DEFORMED, PARAMETERS)
    (constant,) = algebra.constants[0, 2].values()
    assert str(-constant) == "C2"
    assert str(algebra.constants[0, 1][2]) == "C3"


def test_jacobi_identity_is_decided_for_all_values_of_the_parameters():
    """With [e1, e2] = C3 e3 + a e1 it fails unless a = 0; the defect is shown."""
    text = _text(DEFORMED.replace("C[3]*e3", "C[3]*e3 + a*e1"), PARAMETERS)
    error = refused(text=text, kind=AlgebraError)
    assert "Jacobi" in str(error)
    assert "a" in str(error.defect)
    assert error.key == "algebra.brackets"


def test_cocycles_and_matrices_may_hold_parameters():
    """[K_i, P_j] = m delta_ij, and a matrix that stretches by c."""
    heavy = declared(
        'extension = { algebra = "h(1)", center = "Z", cocycle = { "[A1, C]" = "m/2" } }', "m = {}"
    )
    assert str(2 * heavy.constants[0, 2][3]) == "m"
    stretched = declared(
        "[algebra.matrices]\nX = [[0, 'c'], [0, 0]]\nY = [[0, 0], ['c', 0]]\n"
        "H = [['c^2', 0], [0, '-c^2']]",
        "c = { positive = true }",
    )
    assert dict(stretched.constants[0, 1]) == {2: 1}


# -- what is refused ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("algebra", "key", "found", "said"),
    [
        ('direct_sum = ["so(3)", "so3"]', "algebra.direct_sum[2]", "so3", "'so(3)'"),
        ('complexification = "sp(3)"', "algebra.complexification", "sp(3)", "even"),
        (
            'direct_sum = ["so(3)", { name = "so(1)" }]',
            "algebra.direct_sum[2].name",
            "so(1)",
            "n >= 2",
        ),
        (
            'semidirect = { algebra = "so(3)", representations = { p = "vectr" } }',
            "algebra.semidirect.representations.p",
            "vectr",
            "'vector'?",
        ),
        (
            'semidirect = { algebra = "so(3)", representations = { J = "vector" } }',
            "algebra.semidirect",
            "J1",
            "two vectors 'J1'",
        ),
        (
            'extension = { algebra = "h(1)", center = "A1", cocycle = { "[A1, C]" = 1 } }',
            "algebra.extension",
            "A1",
            "two vectors 'A1'",
        ),
        (
            'extension = { algebra = "h(1)", center = "2Z", cocycle = { "[A1, C]" = 1 } }',
            "algebra.extension.center",
            "2Z",
            "not a name",
        ),
        (
            'extension = { algebra = "h(1)", cocycle = { "[A1, D]" = 1 } }',
            "algebra.extension.cocycle.[A1, D]",
            "D",
            "not a bracket of these names",
        ),
        (
            'extension = { algebra = "h(1)", cocycle = { "[A1, C]" = "m" } }',
            "algebra.extension.cocycle.[A1, C]",
            "m",
            "not declared",
        ),
        (
            'extension = { algebra = "h(1)", cocycle = { "[A1, C]" = 1, "[C,A1]" = 1 } }',
            "algebra.extension.cocycle.[C,A1]",
            "[C,A1]",
            "declared twice",
        ),
        (
            'basis = ["u", "v"]\nbrackets = { "[u, v]" = "v", "[u,v]" = "u" }',
            "algebra.brackets.[u,v]",
            "[u,v]",
            "declared twice",
        ),
        (
            'subalgebra = { algebra = "so(4)", basis = { X = "E12 + E45" } }',
            "algebra.subalgebra.basis.X",
            "E45",
            "not declared",
        ),
        (
            'direct_sum = ["so(3)", "so(3)"]\nblocks = { left = ["J1"] }',
            "algebra.blocks.left[1]",
            "J1",
            "J1_1",
        ),
    ],
)
def test_misfit_in_a_product_is_refused_at_its_place(algebra, key, found, said):
    """Unknown names, doubled names and pairs, at any depth of tables."""
    error = refused(text=_text(algebra), kind=(SpecError, AlgebraError))
    assert (error.key, error.found) == (key, found)
    assert said in str(error)
    assert str(error).startswith(f"sample.toml:{error.line}:")


@pytest.mark.parametrize(
    ("algebra", "key", "said"),
    [
        (
            'extension = { algebra = "g(3)", cocycle = { "[K1, P1]" = 1, "[K2, P2]" = -1 } }',
            "algebra.extension.cocycle",
            ["not a 2-cocycle", "omega(J1, [K2, P3])", "-1"],
        ),
        (
            'subalgebra = { algebra = "so(3)", basis = { a = "J1", b = "J2 + J1" } }',
            "algebra.subalgebra.basis",
            ["[a, b]", "J3", "not in the span"],
        ),
        (
            'subalgebra = { algebra = "so(3)", basis = { a = "J1", b = "2*J1" } }',
            "algebra.subalgebra.basis",
            ["b depends"],
        ),
        (
            'semidirect = { algebra = "R^1", ideal = "so(3)", '
            "action = { matrices = { P1 = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] } } }",
            "algebra.semidirect.action",
            ["derivation", "J1", "J2"],
        ),
        (
            'semidirect = { algebra = "so(3)", ideal = "R^2", action = "vector" }',
            "algebra.semidirect.action",
            ["R^3", "R^2", "2 dimensions"],
        ),
        (
            'semidirect = { algebra = "so(3)", representations = '
            "{ p = { matrices = { J1 = [[0, -1], [1, 0]], J2 = [[1, 0], [0, 1]] } } } }",
            "algebra.semidirect.representations.p.matrices",
            ["do not commute", "J1", "J2"],
        ),
    ],
)
def test_product_that_is_none_is_refused_with_a_counter_example(algebra, key, said):
    """The law that fails and the vectors for which it does are in the message, at the key."""
    error = refused(text=_text(algebra), kind=AlgebraError)
    assert error.key == key
    assert all(piece in str(error) for piece in said)
    assert str(error).startswith(f"sample.toml:{error.line}:")


@pytest.mark.parametrize(
    ("algebra", "found"),
    [
        ('name = "so(1000)"', 499500),
        ('direct_sum = ["so(16)", "so(17)", "R^1", "so(200)"]', 257),
        ('leibniz = { algebra = "so(16)", order = 3 }', 360),
        ('complexification = "so(17)"', 272),
        ('semidirect = { algebra = "gl(12)", representations = { A = "columns" } }', 288),
        ('semidirect = { algebra = "gl(12)", ideal = "R^115", action = "columns" }', 259),
    ],
)
def test_explosion_is_refused_before_it_is_built(algebra, found):
    """The dimension that there would be is in the message."""
    start = process_time()
    error = refused(text=_text(algebra), kind=LimitError)
    assert error.found == found
    assert "256" in str(error)
    assert process_time() - start < 2


@pytest.mark.parametrize(
    ("algebra", "key", "said"),
    [
        ('name = "so(3)"\ncomplexification = "so(3)"', "algebra", "exactly one of name"),
        ('basis = ["a"]\ncomplexification = "R^1"', "algebra", "no basis with complexification"),
        ('direct_sum = ["so(3)"]', "algebra.direct_sum", "at least 2"),
        ('semidirect = { algebra = "so(3)" }', "algebra.semidirect", "either representations or"),
        (
            'semidirect = { algebra = "so(3)", ideal = "so(3)" }',
            "algebra.semidirect",
            "ideal and action together",
        ),
        ('leibniz = { algebra = "so(3)", order = 0 }', "algebra.leibniz.order", "greater than"),
        ('leibniz = { algebra = "so(3)", ordr = 2 }', "algebra.leibniz.ordr", "'order'?"),
        ("leibniz = { order = 2 }", "algebra.leibniz", "'algebra' is missing"),
        (
            'direct_sum = ["so(3)", { nam = "so(3)" }]',
            "algebra.direct_sum[2].nam",
            "'name'?",
        ),
        (
            'semidirect = { algebra = "so(3)", representations = { p = { matrces = {} } } }',
            "algebra.semidirect.representations.p.matrces",
            "'matrices'?",
        ),
        (
            'semidirect = { algebra = "so(3)", representations = { p = {} } }',
            "algebra.semidirect.representations.p",
            "the name of a representation, or matrices",
        ),
        ('complexification = { name = "so(3)", invariance = "left" }', None, "unknown key"),
    ],
)
def test_wrong_form_of_a_product_is_refused(algebra, key, said):
    """Keys are known at every depth, and the nearest known one is named."""
    error = refused(text=_text(algebra))
    assert key is None or error.key == key
    assert said in str(error)
