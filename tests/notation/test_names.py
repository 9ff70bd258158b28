"""Names, units and laws are written as books write them, in four formats."""

from __future__ import annotations

import re
from fractions import Fraction
from xml.etree import ElementTree as ET

import pytest
import sympy

from coadjoint.derive.lines import equal
from coadjoint.exact import Field
from coadjoint.notation.elements import write_element, write_sympy
from coadjoint.notation.functions import CALLS
from coadjoint.notation.names import member, name, unit
from coadjoint.notation.tex import is_formula, to_mathml
from coadjoint.notation.trees import write_tree
from coadjoint.notation.written import (
    add,
    divide,
    literal,
    multiply,
    negate,
    number,
    power,
    stack_latex,
)
from coadjoint.render.sums import split_sides
from coadjoint.spec.core.expressions import read_expression


@pytest.mark.parametrize(
    ("text", "latex"),
    [
        ("Pi1", r"\Pi_1"),
        ("dPi1_dt", r"\dot{\Pi}_1"),
        ("vphi", r"v_{\phi}"),
        ("ptheta", r"p_{\theta}"),
        ("psi", r"\psi"),
        ("M_vpsi", r"M_{v_{\psi}}"),
        ("dW1", "dW_1"),
        ("kx", "k_x"),
        ("Jx2", "J_{x,2}"),
        ("vxi_momentum", r"v_{\xi,\mathrm{momentum}}"),
        ("M_vx", "M_{v_x}"),
        ("casimir2", r"\mathcal{C}_2"),
        ("_k1", r"\tilde{k}_1"),
        ("_w2_1", r"\tilde{w}_{2,1}"),
        ("_sol1", r"\widetilde{\mathrm{sol}}_1"),
        ("M12", "M_{12}"),
        ("M_1_10", "M_{1,10}"),
        ("r_0_1", "r_{0,1}"),
        ("u_ss", r"\partial_s^2 u"),
        ("Xi1_s", r"\partial_s \Xi_1"),
        ("p_phi", r"p_{\phi}"),
        ("psi_x_x", r"\psi_{xx}"),
        ("w_x_y", "w_{xy}"),
        ("Omega_momentum2", r"\Omega_{\mathrm{momentum},2}"),
        ("eps1", r"\epsilon_1"),
        ("energy", r"\mathrm{energy}"),
    ],
)
def test_names_in_latex(text, latex):
    """Numbers below, dots over the letter alone, Greek by its names."""
    assert name(text).latex == latex
    assert name(text).text in (text, "dPi1/dt")
    ET.fromstring(f"<math>{name(text).mathml}</math>")


def test_the_rate_of_a_word_has_no_dot():
    """Above the middle of a word a dot is lost, or taken for one of its letters."""
    assert name("dmass_dt").latex == r"\frac{d}{dt} \mathrm{mass}"
    assert name("vn2", dot=True).latex == r"\frac{d}{dt} \mathrm{vn}_2"
    assert name("vn2", dot=True).text == "dvn2/dt"
    assert name("dm_dt").latex == r"\dot{m}"
    for each in (name("dlength_dt"), member("angle", "i", dot=True)):
        assert "<mover>" not in each.mathml
        assert "dot" not in each.latex + each.typst
    assert "<mover>" in name("dPi1_dt").mathml


def test_members_have_their_place_below():
    """The place comes first, then the component; the text is that of formulas."""
    assert member("r2", "i+1", dot=True).latex == r"\dot{r}_{i + 1,2}"
    assert member("r2", "i+1").text == "r2[i+1]"


@pytest.mark.parametrize(
    ("of", "latex"),
    [
        ("q_pairs", r"q_{i,\mathrm{pairs}}"),  # two subscripts of one letter do not compile
        ("p2_pairs", r"p_{i,\mathrm{pairs},2}"),
        ("rolling_reaction2", r"\lambda_{i,\mathrm{rolling},2}"),
        ("u_ss", r"\partial_s^2 u_i"),
    ],
)
def test_members_with_words_have_one_list_below(of, latex):
    """In no format does a symbol that has a subscript get another one."""
    written = member(of, "i")
    assert written.latex == latex
    assert written.typst.count("_(") <= 1
    assert written.mathml.count("<msub>") == 1


def test_fractions_with_long_numerators_are_sums_of_fractions():
    """Each of them fits on a line of a page, nothing is lost, and minus reaches all of them."""
    parts = [literal(f"x{n}") for n in range(60)]
    whole = negate(divide(add(parts), literal("d")))
    lines = stack_latex(add([whole])).split("\\\\\n")
    assert len(lines) > 2
    assert all(line.count(r"\frac") == 1 for line in lines)
    assert all(line.removeprefix(r"&\quad ").startswith("-") for line in lines)
    assert sum(line.count("x") for line in lines) == len(parts)


def test_a_fraction_of_one_negative_addend_takes_the_sign_before_it():
    """A numerator that fills its line alone is no ``+ frac(-x, d)``."""
    long, other = literal("x" * 70), literal("y" * 70)
    made = divide(add([long, negate(other)]), literal("d"))
    assert made.latex == rf"\frac{{{long.text}}}{{d}} - \frac{{{other.text}}}{{d}}"


def test_sums_within_sums_are_broken_as_one():
    """A sum that needs no brackets is no unbreakable addend."""
    parts = [literal(f"long_name_{n}") for n in range(20)]
    nested = stack_latex(add([add(parts[:-1]), parts[-1]]))
    assert nested == stack_latex(add(parts))
    assert nested.count("\n") >= 2


def test_matrices_are_written_as_matrices():
    """Rows of numbers are no function of vectors."""
    written = write_tree(read_expression("rows(vector(a, -b), vector(0, 1))"), {})
    assert written.latex == r"\begin{pmatrix}a & -b \\ 0 & 1\end{pmatrix}"
    assert written.typst == "mat(a, -b; 0, 1)"
    assert ET.fromstring(f"<math>{written.mathml}</math>").findall(".//mtr")
    assert written.text == "rows((a, -b), (0, 1))"


def test_units_are_upright_with_raised_exponents():
    """In text they stay as they were typed."""
    assert unit("kg m^2/s").latex == r"\mathrm{kg\,m^{2}/s}"
    assert unit("m^-1").mathml.count("<mo>−</mo>") == 1
    assert unit("kg m^2/s").text == "kg m^2/s"


def test_signs_and_brackets_stand_where_they_are_needed():
    """A sum in a product is in brackets, a negative addend takes the sign of the sum."""
    a, b, c = map(literal, "abc")
    assert add([a, negate(b)]).text == "a - b"
    assert multiply([add([a, b]), c]).text == "(a + b) c"
    assert add([a, negate(add([b, negate(c)]))]).text == "a - (b - c)"
    assert divide(add([a, b]), multiply([b, c])).text == "(a + b)/(b c)"
    assert power(negate(a), 2).text == "(-a)^2"
    assert add([number(-1), a]).text == "-1 + a"


@pytest.mark.parametrize(
    ("formula", "typst"),
    [
        ("cross(a, b)", "bold(a) times bold(b)"),
        ("norm(a)", "abs(bold(a))"),
        ("sqrt(m)", "sqrt(m)"),
        ("m/2", "frac(m, 2)"),
        ("outer(a, b)", "bold(a) ⊗ bold(b)"),
    ],
)
def test_trees_in_typst(formula, typst):
    """Vectors bold, products by their signs."""
    shapes = {"a": (3,), "b": (3,), "m": ()}
    assert write_tree(read_expression(formula), shapes).typst == typst


def test_laws_become_mathml():
    """What laws use is read; a command that is not known gives None, and words stay words."""
    maths = to_mathml(r"\dot\mu = \mathrm{ad}^*_\xi \mu + \frac{\partial l}{\partial a} \diamond a")
    ET.fromstring(maths)
    assert "<msubsup>" in maths
    assert "⋄" in maths
    assert to_mathml(r"\write18{rm}") is None
    assert is_formula(r"\mu = p", "mu = p")
    assert not is_formula("imposed after the variation", "imposed after the variation")


@pytest.mark.parametrize(
    ("formula", "text"),
    [
        ("K[2] + K[3] - K[1]", "K2 + K3 - K1"),
        ("A[1, 2]", "A12"),
        ("B[1, 10]", "B_1_10"),
        ("r1[2]", "r1_2"),
        ("cross(K, r1)[3]", "(K x r1)_3"),
    ],
)
def test_components_keep_their_numbers_in_text(formula, text):
    """As in the other formats, by the names that components have where they are written out."""
    shapes = {"K": (3,), "A": (2, 2), "B": (10, 10), "r1": (3,)}
    assert write_tree(read_expression(formula), shapes).text == text


def test_a_name_of_several_words_is_not_cut():
    """At a plain blank within one element a narrow column of a table ends, and loses the rest."""
    shown = re.sub("<[^>]*>", "", name("normal_force").mathml)
    assert " " not in shown
    assert "force" in shown
    ET.fromstring(f"<math>{name('<p> & q').mathml}</math>")


@pytest.mark.parametrize(
    ("text", "latex"),
    [
        ("3*x/20", r"\frac{3}{20}\,x"),
        ("4*x*y/2", r"2\,x\,y"),
        ("-3*x/20", r"-\frac{3}{20}\,x"),
        ("x*y/2", r"\frac{1}{2}\,x\,y"),
        ("(3*x)*(y*z/2)", r"\frac{3}{2}\,x\,y\,z"),
        ("x*(2*y)*z/2", r"x\,y\,z"),
        ("x/(4*(4*atan(1)))", r"\frac{x}{4\,\pi}"),
    ],
)
def test_numbers_of_a_product_are_one(text, latex):
    """No two numbers stand side by side."""
    assert add([write_tree(read_expression(text), {})]).latex == latex


def test_numbers_of_an_element_are_one():
    """Three halves, and not a half and three, which a reader adds."""
    field = Field(["m", "x"])
    half = field.number(Fraction(3, 2))
    written = write_element(field, half * field["m"] * field["x"] ** 2)
    assert written.latex == r"\frac{3}{2}\,m\,{x}^{2}"
    assert written.text == "3/2*m*x^2"
    assert is_mixed(r"\frac{1}{2}\,3\,m\,{x}^{2}")  # as it was printed
    assert not is_mixed(written.latex)
    assert not any(map(is_mixed, (multiply([number(3), literal("x"), number(2)]).latex,)))


def is_mixed(latex: str) -> bool:
    """Whether two numbers stand side by side, with no sign between them."""
    return bool(re.search(r"(\d|\\frac\{\d+\}\{\d+\})\\,(\d|\\frac\{\d)", latex))


def test_a_long_left_side_stands_above_the_right_one():
    """Both in one column, which is as wide as the wider of them; a short one stays beside it."""
    products = [multiply([name(f"omega_{n}"), name("x")]) for n in range(1, 9)]
    long, short = equal(add(products), name("y")), equal(name("x"), name("y"))
    assert long.mathml.count("<mtr>") == 1 + len(add(products).groups) > 2
    assert split_sides(long.mathml) == ("", long.mathml)
    assert long.latex.count("\n&\\quad = y") == 1
    assert long.text.endswith(" = y")
    assert "<mtr>" not in short.mathml
    assert split_sides(short.mathml)[0]
    assert short.latex == "x &= y"


def test_the_root_of_a_square_is_a_size():
    """Symbols of a formula are real."""
    x, y = sympy.symbols("x y")
    assert write_sympy(sympy.sqrt((x - y) ** 2), name).latex == r"\lvert x - y\rvert"
    assert "sqrt" in write_sympy(sympy.sqrt(x - y), name).latex


def test_the_rate_of_what_is_a_rate_by_its_name_has_two_dots():
    """In every format; a word that ends like it, and no letter before, stays a word."""
    made, rate = name("phidot"), name("phidot", dot=True)
    assert (made.latex, rate.latex) == (r"\dot{\phi}", r"\ddot{\phi}")
    assert (made.typst, rate.typst) == ("dot(phi.alt)", "dot.double(phi.alt)")
    assert rate.mathml.count("..</mo>") == 1
    assert (made.text, rate.text) == ("phidot", "dphidot/dt")
    assert name("dot").latex == r"\mathrm{dot}"
    assert name("robotdot").latex == r"\mathrm{robotdot}"


def test_fractions_within_fractions_are_as_large_as_those_alone():
    """In LaTeX and on pages; a fraction by itself stays what it is."""
    a, b, c = map(name, "abc")
    inner = divide(a, b)
    outer = divide(add([inner, c]), c)
    assert inner.latex == r"\frac{a}{b}"
    assert outer.latex == r"\frac{\dfrac{a}{b} + c}{c}"
    assert "scriptlevel" in outer.mathml
    assert "scriptlevel" not in inner.mathml


def test_a_fraction_over_something_is_one_fraction():
    """With its sign, its number, and a text that says the same in one line."""
    a, b, c = map(name, "abc")
    made = divide(negate(divide(a, b)), c)
    assert (made.latex, made.sign, made.text) == (r"\frac{a}{b\,c}", -1, "a/b/c")
    assert divide(number(Fraction(1, 2)), a).latex == r"\frac{1}{2\,a}"


def test_a_hat_stands_over_a_symbol_and_a_wedge_behind_a_product():
    """No hat stretches over diag(I)^-1 Pi, and one over I alone would be read as another matrix."""
    pi, inertia = name("Pi", bold=True), name("I", bold=True)
    hat = CALLS["hat"]
    assert hat(pi).latex == rf"\widehat{{{pi.latex}}}"
    product = hat(multiply([inertia, pi]))
    assert product.text == "hat(I Pi)"
    assert product.latex == rf"\left({inertia.latex}\,{pi.latex}\right)^{{\wedge}}"
    assert product.mathml.endswith("<mo>∧</mo></msup>")
    assert "mover" not in product.mathml
    assert product.typst.endswith("^(and)")


def test_the_force_of_a_constraint_is_a_multiplier():
    """Also in components, with the name of the constraint below."""
    assert name("twistless_reaction").latex == r"\lambda_{\mathrm{twistless}}"
    assert name("rolling_reaction2").latex == r"\lambda_{\mathrm{rolling},2}"
    assert name("twistless_reaction").text == "twistless_reaction"
