"""Formulas within sentences are found, and words stay words."""

import re
import time
from xml.etree import ElementTree as ET

import pytest

from coadjoint.chapter import complete
from coadjoint.notation.names import name
from coadjoint.notation.prose import Formula, read_counts, read_prose
from coadjoint.notation.tex import to_mathml
from coadjoint.notation.written import literal
from coadjoint.render.document import render_document
from coadjoint.render.prose import set_prose, set_text
from coadjoint.resources import derivations_folder
from coadjoint.spec import read_spec


def show(text, names=None):
    """The text with its formulas as LaTeX between dollar signs."""
    parts = read_prose(text, names)
    return "".join(each if isinstance(each, str) else f"${each.written.latex}$" for each in parts)


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("the energy is conserved, for N >= 2", r"the energy is conserved, for $N \ge 2$"),
        ("{K, P} = -M*diag(m)", r"$\{K, P\} = -M\,\operatorname{diag}\left(m\right)$"),
        ("dot(Pi, Gamma) is a Casimir", r"$\Pi \cdot \Gamma$ is a Casimir"),
        ("where |Gamma| = 1.", r"where $\lvert \Gamma\rvert = 1$."),
        ("of degree <= 2 in Pi", r"of degree $\le 2$ in $\Pi$"),
        ("keeps dh/dmu = xi", r"keeps $\frac{\partial h}{\partial \mu} = \xi$"),
        ("L D L^T = B^T M B: solved", r"$L\,D\,L^{\top} = B^{\top}\,M\,B$: solved"),
        ("J_[xi, eta]", r"${J}_{[\xi, \eta]}$"),
        ("dL/dt = [L, M] for every lambda", r"$\dot{L} = [L, M]$ for every $\lambda$"),
        ("p^* . v - h(p), at v", r"$p^{*} \cdot v - h(p)$, at $v$"),
        ("-<P dh, G P dh>", r"$-\langle P\,dh, G\,P\,dh\rangle$"),
        ("waves up to 2 K come", r"waves up to $2\,K$ come"),
        ("1/2*m^2/r", r"$\frac{1}{2}\,\frac{{m}^{2}}{r}$"),
        ("v -> -v", r"$v \to -v$"),
        ("so(3) (s) R^3", r"$\operatorname{so}\left(3\right) \ltimes {R}^{3}$"),
        ("through Pi = p_Gamma x Gamma", r"through $\Pi = p_{\Gamma} \times \Gamma$"),
        ("m = u - d^2u/ds^2", r"$m = u - \frac{d^{2} u}{d {s}^{2}}$"),
        ("d2h/dp2", r"$\frac{\partial^{2} h}{\partial {p}^{2}}$"),
        ("oscillators x and z", "oscillators $x$ and $z$"),
        ("by J. E. Marsden and R. Montgomery", "by J. E. Marsden and R. Montgomery"),
        ("W = A + i B. The first", r"$W = A + i\,B$. The first"),
        ("all in 2*M*E. Method: exact", r"all in $2\,M\,E$. Method: exact"),
        ("one of x alone, where x is", "one of $x$ alone, where $x$ is"),
        ("tr W^k and det Q", r"$\operatorname{tr}\,{W}^{k}$ and $\operatorname{det}\,Q$"),
        ("b . curl b", r"$b \cdot \left(\operatorname{curl}\,b\right)$"),
        ("over hbar", r"over $\hbar$"),
        ("is 1.1e-05 of it", r"is $1.1 \times {10}^{-5}$ of it"),
        ("less than 1e-12 at 24", "less than ${10}^{-12}$ at 24"),
        ("where x = -3.5e+3", r"where $x = -3.5 \times {10}^{3}$"),
        ("is 7*7 of 1/2*3", r"is $7 \times 7$ of $\left(\frac{1}{2}\right) \times 3$"),
        ("= sqrt(A^2 - 1)", r"$= \sqrt{{A}^{2} - 1}$"),
    ],
)
def test_a_formula_is_found_in_a_sentence(text, shown):
    """Its signs are those of a book, and the words around it stay."""
    assert show(text) == shown


@pytest.mark.parametrize(
    "text",
    [
        "euler-poincare and Lie-Poisson give a 2-form",
        "every point(s) of [poisson] (section 3)",
        "Newton's law is a law",
        "Korteweg and de Vries",
        "A body. A disk, and 418931385270818879 points",
        "so4_body",
        "energy, spin and a",
        "dop853",
    ],
)
def test_words_stay_words(text):
    """Names of routes, plurals, articles, numbers and names of code are no formulas."""
    assert read_prose(text) == [text]


def test_a_letter_that_is_a_name_ends_a_sentence():
    """An initial is no name of the system; that of a person stays where it is."""
    text = "by R. Montgomery at the rate W. Its centre"
    assert show(text, {"W": name("W")}) == "by R. Montgomery at the rate $W$. Its centre"
    assert show(text, {"R": name("R")}) != text


def test_a_number_with_a_power_of_ten_is_no_product_with_e():
    """Read as a product it would have another value."""
    for text in ("1.1e-05", "1e-12", "2.4e-08"):
        assert "e" not in re.sub(r"\\\w+", "", show(f"is {text} of it").split("$")[1])
    assert "e" in show("is 1.1*e - 5 of it").split("$")[1]  # as these numbers were printed


def test_nothing_of_a_text_is_lost_and_every_piece_is_whole():
    """Words are those of the text in order, and each piece of a formula is one element."""
    text = "no (a + b*(c, in it: x - " + " + ".join(f"a{n}*b{n}^2" for n in range(40)) + " is 0"
    parts = read_prose(text)
    (formula,) = (each for each in parts if isinstance(each, Formula) and len(each.pieces) > 1)
    assert len(formula.pieces) == 41
    for piece in formula.pieces:
        ET.fromstring(piece.replace("&#x2212;", "-"))
    rest = text
    for words in (each for each in parts if isinstance(each, str)):
        _, found, rest = rest.partition(words)
        assert found


def test_names_are_written_as_they_are_given():
    """A vector is bold, also where it is varied."""
    bold = {"Pi": name("Pi", bold=True)}
    assert show("dot(Pi, Pi) dPi", bold).count(r"\boldsymbol{\Pi}") == 3


@pytest.mark.parametrize(
    "text", ["(" * 5000, "a + (" * 900, "tr " * 1900, "9" * 9000, "(a + " * 900, "a*" * 900]
)
def test_free_text_costs_little(text):
    """Whatever a description says, it is read to its end in a moment."""
    began = time.process_time()
    read_prose(text)
    assert time.process_time() - began < 2


@pytest.mark.parametrize("form", ["html", "latex", "typst"])
def test_proofs_and_costs_are_set(form, tmp_path):
    """No claim of a page has the signs of code; the text has them still."""
    (tmp_path / "kernel_python.py").write_text("def rhs(a, b):\n    return a * b - a / b\n")
    claim = {"statement": "{K, P} = -M*diag(m)^2", "kind": "bracket", "verdict": "proved"}
    record = {"title": "A top", "about": "", "source": "", "description": "", "sections": []}
    made = complete(record, {"claims": [{**claim, "method": "R^2 = 1"}]}, tmp_path)
    text, page = render_document(made), render_document(made, form)
    assert "1 *, 1 -, 1 /" in text
    assert text.count("-M*diag(m)^2") == 2  # told in a sentence, and in the table of verdicts
    assert not re.search(r"M\*|\d [*] *,|R\^2|R\\\^2|1 \*", page)
    product = {"html": ">×</mo>", "latex": r"$1\,{\times}$", "typst": "$1 space.thin times$"}
    assert page.count(product[form]) == 1
    assert [each.written.latex for each in read_counts("3 sqrt, 2 *")[1:]] == [r"2\,{\times}"]


def test_no_line_begins_with_the_comma_behind_a_formula():
    """On a page both are kept together; what follows them is not."""
    page = set_text("real where |x| >= 1, and singular elsewhere (at x^2).")
    assert re.findall(r'<span class="kept">.*?</math>([^<]*)</span>([^<]*)', page) == [
        (",", " and singular elsewhere (at "),
        (").", ""),
    ]
    assert page.count("<math>") == page.count("</math>") == 2
    assert 'class="kept"' not in set_text("a motion of x^2 is seen")


@pytest.mark.parametrize(
    ("text", "latex"),
    [
        (
            "L = rows(vector(x1, 2), vector(0, -x2))",
            r"L = \begin{pmatrix}x_1 & 2 \\ 0 & -x_2\end{pmatrix}",
        ),
        ("{h, h_k} o dW_k", r"\{h, h_k\} \circ dW_k"),
        ("T_(m + n)", "{T}_{m + n}"),
        ("sin(2 pi*(m x n)/N)", r"\sin\left(\frac{2\,\pi\,m \times n}{N}\right)"),
        ("trace(M^2)", r"\operatorname{tr}\left({M}^{2}\right)"),
    ],
)  # fmt: skip
def test_matrices_and_places_are_formulas(text, latex):
    """As a book has them."""
    (formula,) = read_prose(text)
    assert formula.written.latex == latex


def test_reasons_have_letters_of_their_own():
    """A method that does not apply tells of so(p, q), whose p and q are no state."""
    cells = {"latex": "P", "mathml": "<math><mi>P</mi></math>", "typst": "P"}
    symbols = {"title": "Symbols", "kind": "symbols", "law": "", "law_latex": "", "words": []}
    symbols["rows"] = [("symbol", "name", "meaning", "unit"), (cells, "p", "p", "1")]
    unfit = {**symbols, "title": "Unfit", "kind": "unfit"}
    unfit["rows"] = [("method", "reason"), ("kahan", "of so(p, q) alone")]
    made = set_prose({"description": "", "sections": [symbols, unfit]}, "html")["sections"]
    assert "<mi>P</mi>" in made[0]["rows"][1][2]
    assert "<mi>P</mi>" not in made[1]["rows"][1][1]


#: Signs of code that are left where a formula was not read as one.
CODE = re.compile(r"[\^*_=|<>{}`]|[A-Za-z]\.[A-Za-z]")


@pytest.mark.parametrize("form", ["html", "latex", "typst"])
def test_descriptions_are_set(form):
    """As what is said of proofs."""
    page = {"title": "A motion", "description": "With d^2u/ds^2 = 0.", "about": "", "source": ""}
    shown = render_document({**page, "sections": []}, form)
    assert "d^2u" not in shown
    assert ("<mfrac>" if form == "html" else "frac") in shown


def test_names_of_the_table_of_symbols_stand_by_themselves():
    """They and their components are formulas; words among them, and other names, are words."""
    names = {each: literal(each, "X") for each in ("casimir1", "vn", "spin", "g_gram")}
    found = read_prose("casimir1, g_gram, vn2 and dvxi_dt, not spin or other1", names)
    assert [each if isinstance(each, str) else each.written.latex for each in found] == [
        *("X", ", ", "X", ", ", r"\mathrm{vn}_2", " and ", r"\dot{v}_{\xi}"),
        ", not spin or other1",
    ]


def test_a_number_stands_before_a_letter_within_brackets_alone():
    """As in the name of an algebra; what is no letter is left."""
    assert [type(each) for each in read_prose("sp(2n)")] == [Formula]
    assert read_prose("sp(2nd)") == ["sp(2nd)"]


def test_descriptions_of_all_systems_are_read():
    """No sign of code is left in the words of what we ship."""
    specs = [read_spec(path) for path in sorted(derivations_folder().glob("*.toml"))]
    texts = [text for spec in specs for text in (spec.title, " ".join(spec.description.split()))]
    words = [part for text in texts for part in read_prose(text) if isinstance(part, str)]
    assert len(words) > 400
    assert [part for part in words if CODE.search(part)] == []
    formulas = [part for text in texts for part in read_prose(text) if isinstance(part, Formula)]
    assert len(formulas) > 300
    assert CODE.search("the matrix J_k")


@pytest.mark.parametrize(
    ("text", "stretches"),
    [("[W, V]", False), ("(a + 1)*b", False), ("f(x^2)", False), ("(a/b + 1)*c", True)],
)
def test_brackets_are_as_high_as_what_they_hold(text, stretches):
    """Browsers set brackets that stretch apart; laws in LaTeX say it by left and right."""
    (formula,) = read_prose(text)
    opening = re.search(r"<mo([^>]*)>[(\[]</mo>", formula.written.mathml)
    assert ("stretchy" not in opening[1]) == stretches
    left, right = (r"\left", r"\right") if stretches else ("", "")
    law = to_mathml(rf"{left}(x{right})")
    assert ('stretchy="false"' not in law) == stretches
    assert 'form="prefix"' in law


def test_formulas_of_sentences_ask_for_no_style():
    """Pages of explorers have descriptions, and refuse a style whose hash they do not know."""
    shown = set_text(
        "Xi turns by dXi/dt = Xi x Omega, with |Omega| >= 1 and L = rows(vector(1, 2))."
    )
    assert "<mover>" in shown
    assert "style" not in shown


def test_long_absolute_values_go_on_lines_below():
    """A measure's density of many terms, whose exponent has no brackets, has a place to end."""
    terms = " + ".join(f"a{n}*b{n}" for n in range(30))
    (formula,) = (part for part in read_prose(f"|{terms}|^(-1)") if not isinstance(part, str))
    assert formula.written.latex.startswith(r"\lvert a_0")
    assert formula.written.latex.endswith(r"\rvert^{-1}")
    assert formula.written.mathml.count("<mtr>") > 3
