"""Rung 3: emitted text reads back as its Program, and a text that does not is caught."""

import re

import pytest

from coadjoint.crosscheck.parse_back import check_text
from coadjoint.errors import CrossCheckError
from coadjoint.render.kernels import render_system
from coadjoint.render.targets import TARGETS
from coadjoint.render.targets.c.reader import read_c
from coadjoint.render.targets.c.reader import read_expression as read_c_expression
from coadjoint.render.targets.numpy.reader import read_expression as read_python_expression
from tests.programs import HEAVY_TOP, PENDULUM, TOP_RHS
from tests.render.test_kernels import CROWD

TEXTS = render_system(HEAVY_TOP)


def check_python(program, text):
    """One function in a text of the target NumPy."""
    return check_text(program, TARGETS["numpy"], text, "heavy_top")


def check_c(program, text, system="heavy_top"):
    """One function in a text of the target C."""
    return check_text(program, TARGETS["c"], text, system)


def check_plain(program, text):
    """One function in a text of the target Python."""
    return check_text(program, TARGETS["python"], text, "heavy_top")


@pytest.mark.parametrize("context", [HEAVY_TOP, PENDULUM, CROWD], ids=lambda context: context.name)
def test_rendered_texts_read_back(context):
    """Every function of every language, in every branch, is its Program."""
    texts = render_system(context)
    assert context.programs
    for program in context.programs:
        for target in TARGETS.values():
            assert check_text(program, target, texts[target.kernel], context.name)


def test_both_branches_are_read():
    """Shared and separate parameters are two bodies, a function without parameters is one."""
    assert len(read_c(TEXTS["kernel.c"], "heavy_top_rhs")) == 2
    assert len(read_c(TEXTS["kernel.c"], "heavy_top_poisson_tensor")) == 1


SPOILED_PYTHON = [
    ("Omega3 * Pi2 - Omega2 * Pi3", "Omega3 * Pi2 + Omega2 * Pi3", "the line of 0"),
    ("Omega3 * Pi2 - Omega2 * Pi3", "Pi2 * Omega3 - Omega2 * Pi3", "the line of 0"),
    ("out[3] =", "out[4] =", "the line of"),
    ("    Omega1 = Pi1 / I1\n", "", "Omega"),
    ("Pi1, Pi2, Pi3, G", "Pi2, Pi1, Pi3, G", "inputs"),
    ("_p1 = m * g", "_p1 = np.float32(m * g)", "np.float32"),
    ("_p1 = m * g", "_p1 = np.sqrt(m * g)", "the line of _p1"),
    ("_p1 = m * g", "_p1 = m * g * 1", "'1'"),
    ("_p1 = m * g", "_p1 += m * g", "_p1 \\+= m"),
    ("_p1 = m * g", "_p1 = __import__('os')", "__import__"),
    ("_over_members(_rhs,", "_over_members(_energy,", "does not evaluate _rhs"),
    (
        "def energy(",
        "def rhs(state, parameters, out=None):\n    pass\n\n\ndef energy(",
        "out of place",
    ),
    ("import math\n", "import math\n_rhs = None\n", "_rhs = None"),
]


@pytest.mark.parametrize(("good", "bad", "found"), SPOILED_PYTHON)
def test_spoiled_python_is_caught(good, bad, found):
    """A sign, an order, a row, a name, a type, a constant or a call out of place is an error."""
    assert good in TEXTS["kernel.py"]
    spoiled = TEXTS["kernel.py"].replace(good, bad, 1)
    with pytest.raises(CrossCheckError, match=found) as caught:
        check_python(TOP_RHS, spoiled)
    assert (caught.value.rung, caught.value.function) == (3, "rhs")


SPOILED_PLAIN = [
    ("Omega3 * Pi2 - Omega2 * Pi3", "Omega3 * Pi2 + Omega2 * Pi3", "the line of 0"),
    ("out[3] =", "out[4] =", "the line of"),
    ("    out[3] =", "    out[5] = 0.0\n    out[3] =", "the line of"),
    ("    Omega1 = Pi1 / I1\n", "", "Omega"),
    ("Pi1, Pi2, Pi3, G", "Pi2, Pi1, Pi3, G", "inputs"),
    ("_p1 = m * g", "_p1 = sqrt(m * g)", "the line of _p1"),
    ("_p1 = m * g", "_p1 = np.sqrt(m * g)", "not a form"),
    ("_p1 = m * g", "_p1 = abs(m * g)", "not a form"),
    ("_p1 = m * g", "_p1 = m * g * 1", "'1'"),
    ("_p1 = m * g", "_p1 += m * g", "_p1 \\+= m"),
    ("out = [0.0] * 6", "out = [0.0] * 7", "not a form"),
    ("out = [0.0] * 6", "out = [1.0] * 6", "not a form"),
    ("return out\n", "return out[::-1]\n", "not what is returned, out"),
    ("(state, parameters)", "(parameters, state)", "takes parameters, state"),
    ("\nID =", "\nimport os\nID =", "out of place"),
    ("\nID =", "\nfrom math import cos as sqrt\nID =", "out of place"),
    ("\nID =", "\nfrom cmath import sqrt\nID =", "out of place"),
    ("def energy(", "def rhs(state, parameters):\n    pass\n\n\ndef energy(", "out of place"),
]


@pytest.mark.parametrize(("good", "bad", "found"), SPOILED_PLAIN)
def test_spoiled_plain_python_is_caught(good, bad, found):
    """The same in the target without NumPy; a row may be given once, and the list as it is."""
    text = TEXTS["kernel_python.py"]
    assert good in text
    with pytest.raises(CrossCheckError, match=found) as caught:
        check_plain(TOP_RHS, text.replace(good, bad, 1))
    assert (caught.value.rung, caught.value.function) == (3, "rhs")


@pytest.mark.parametrize(
    ("good", "bad"),
    [
        ("return _rows(out, 6)", "return _rows(out, 5)"),
        ("return _rows(out, 6)", "return out"),
        ("range(0, len(out), size)", "range(0, len(out), 6)"),
        ("def _rows(out, size)", "def _rows(size, out)"),
    ],
)
def test_spoiled_rows_of_a_matrix_are_caught(good, bad):
    """The helper that makes rows of a list is read, too."""
    tensor = next(each for each in HEAVY_TOP.programs if each.name == "poisson_tensor")
    text = TEXTS["kernel_python.py"]
    assert check_plain(tensor, text)
    assert good in text
    with pytest.raises(CrossCheckError, match=r"returned|_rows"):
        check_plain(tensor, text.replace(good, bad))


SPOILED_C = [
    ("Omega3 * Pi2 - Omega2 * Pi3", "Omega3 * Pi2 + Omega2 * Pi3", "the line of 0"),
    ("Omega3 * Pi2 - Omega2 * Pi3", "Pi2 * Omega3 - Omega2 * Pi3", "the line of 0"),
    ("out[3 * out_stride", "out[4 * out_stride", "the line of"),
    ("const double Omega1 = Pi1 / I1;", "", "Omega"),
    ("const double Omega1 = Pi1 / I1;", "const float Omega1 = Pi1 / I1;", "const float"),
    ("const double Omega1 = Pi1 / I1;", "const double Omega1 = (float)Pi1 / I1;", "not a form"),
    ("const double Omega1 = Pi1 / I1;", "const double Omega1 = 1 * Pi1 / I1;", "not a form"),
    ("const double Omega1 = Pi1 / I1;", "const double Omega1 = --Pi1 / I1;", "not a form"),
    ("const double Omega1 = Pi1 / I1;", "const double Omega1 = pow(Pi1, I1);", "not a form"),
    ("state[0 * state_stride", "state[1 * state_stride", "inputs"),
    ("_p1 = m * g;", "_p1 = m * g; abort();", "abort"),
]


@pytest.mark.parametrize("branch", [0, 1])
@pytest.mark.parametrize(("good", "bad", "found"), SPOILED_C)
def test_spoiled_c_is_caught_in_either_branch(good, bad, found, branch):
    """The same faults in C are errors, whichever of the two branches has them."""
    text = TEXTS["kernel.c"]
    places = [match.start() for match in re.finditer(re.escape(good), text)]
    at = places[branch]
    spoiled = text[:at] + bad + text[at + len(good) :]
    with pytest.raises(CrossCheckError, match=found):
        check_c(TOP_RHS, spoiled, "heavy_top")


@pytest.mark.parametrize(
    "bad",
    [
        "parameters[1 * parameters_stride + _n]",
        "parameters[0]",
        "parameters[0 * state_stride + _n]",
    ],
)
def test_separate_parameters_are_read_by_member(bad):
    """In the second branch a parameter of another row, or the first member's for all, is caught."""
    spoiled = TEXTS["kernel.c"].replace("parameters[0 * parameters_stride + _n]", bad, 1)
    with pytest.raises(CrossCheckError, match=r"inputs|not a form|not a line|no line"):
        check_c(TOP_RHS, spoiled, "heavy_top")


def test_a_missing_function_is_caught():
    """A function that neither file defines is named."""
    with pytest.raises(CrossCheckError, match="rhs"):
        check_python(TOP_RHS, "")
    with pytest.raises(CrossCheckError, match="heavy_top_rhs"):
        check_c(TOP_RHS, "", "heavy_top")
    with pytest.raises(CrossCheckError, match="no function 'rhs'"):
        check_plain(TOP_RHS, "")


@pytest.mark.parametrize("text", ["a + b", "-(a * b) / 2.5e-07", "np.sqrt(a) - 1.0"])
def test_a_changed_constant_is_detected(text):
    """The readers of both languages compare constants to the last bit."""
    assert read_python_expression(text, "f") == read_c_expression(text.replace("np.", ""), "f")
    assert read_python_expression("0.1", "f") != read_python_expression("0.10000000000000002", "f")
    assert read_c_expression("0.1", "f") != read_c_expression("0.10000000000000002", "f")


@pytest.mark.parametrize(
    "text", ["a +", "a b", "(a", "a)", "a ** b", "a, b", "f(a)", "a[0]", "", "1", "a % b", "+a"]
)
def test_other_forms_of_c_are_refused(text):
    """Forms that the printer never writes are refused."""
    with pytest.raises(CrossCheckError, match="not a form"):
        read_c_expression(text, "f")


def test_the_table_of_zeros_is_read():
    """A row that is missing, doubled or wrong in the table is caught, and so is another loop."""
    tensor = next(each for each in HEAVY_TOP.programs if each.name == "poisson_tensor")
    python, c = TEXTS["kernel.py"], TEXTS["kernel.c"]
    # {Gamma3, Gamma3}, the last of the 36 entries, is zero
    assert " 35,\n" in python.partition("_poisson_tensor(state")[2]
    for old, new in ((" 35,\n", "\n"), (" 35,\n", " 35, 35,\n"), (" 35,\n", " 35, 1,\n")):
        for check, text in ((check_python, python), (check_c, c)):
            head, mark, tail = text.rpartition("rows that are zero everywhere")
            spoiled = head + mark + tail.replace(old, new, 1)
            assert spoiled != text
            with pytest.raises(CrossCheckError) as caught:
                check(tensor, spoiled, *(["heavy_top"] if check is check_c else []))
            assert caught.value.function.endswith("poisson_tensor")
    for old, new in (("_z = 0;", "_z = 1;"), ("] = 0.0;", "] = 1.0;"), ("sizeof *_zeros;", "2;")):
        head, mark, tail = c.rpartition("static const unsigned short _zeros")
        spoiled = head + mark + tail.replace(old, new, 1)
        assert spoiled != c
        with pytest.raises(CrossCheckError):
            check_c(tensor, spoiled, "heavy_top")
    spoiled = python.replace("out[zeros,] = 0.0", "out[zeros,] = 1.0")
    assert spoiled != python
    with pytest.raises(CrossCheckError):
        check_python(tensor, spoiled)
