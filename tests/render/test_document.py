"""A derivation is readable in three formats, and free text is text in each of them."""

from __future__ import annotations

import re
from dataclasses import asdict
from html.parser import HTMLParser
from xml.etree import ElementTree as ET

import pytest
from markupsafe import escape

from coadjoint.derive import derive
from coadjoint.derive.document import document
from coadjoint.render.document import FORMATS, latex_escaped, render_document
from tests.specs import shipped

ESCAPED = {"text": str, "latex": latex_escaped, "html": escape}
HOSTILE = (
    "<script>alert(1)</script>",
    "</title><img src=x onerror=alert(1)>",
    "]]> --> {{ 7*7 }} {% for %} << 7*7 >>",
    r"\immediate\write18{touch owned} ^^5cinput % # $ & _",
    "red \x1b[31m bell \x07 line\nbreak",
)


@pytest.fixture(scope="module", params=["euler-poincare", "lie-poisson"])
def derivation(request):
    """The heavy top's derivation by each route, as JSON values."""
    return asdict(document(derive(shipped("heavy_top"), request.param)))


def hostile(text):
    """A document whose every free text is hostile."""
    line = {"text": "a = 1", "latex": "a &= 1", "mathml": "<math><mi>a</mi></math>"}
    section = {"title": "Momenta", "law": "mu = p", "law_latex": r"\mu = p", "lines": [line]}
    free = dict.fromkeys(("title", "source", "description"), text)
    return {"name": "top", "route": "euler-poincare", "sections": [section], **free}


class Tags(HTMLParser):
    """The elements of a page."""

    def __init__(self, page):
        super().__init__()
        self.names, self.attributes = [], []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        """Note the element and its attributes."""
        self.names.append(tag)
        self.attributes += [name for name, _ in attrs]


@pytest.mark.parametrize("form", FORMATS)
def test_every_step_and_line_is_there(form, derivation):
    """Each format shows the title and every step of the derivation."""
    text = render_document(derivation, form)
    assert "Heavy top" in text
    assert len(derivation["sections"]) >= 4
    for section in derivation["sections"]:
        assert ESCAPED[form](section["title"]) in text
    lines = [line for section in derivation["sections"] for line in section["lines"]]
    assert len(lines) > 10
    if form != "text":
        key = {"latex": "latex", "html": "mathml"}[form]
        assert all(line[key] in text for line in lines)


def test_text_is_aligned_and_fits(derivation):
    """In the text format the equals signs of a step stand in one column, and lines are short."""
    text = render_document(derivation)
    assert max(map(len, text.splitlines())) <= 100
    rates = [line for line in text.splitlines() if re.match(r" +d(Pi|Gamma)\d/dt", line)]
    assert len(rates) == 6
    assert len({line.index("=") for line in rates}) == 1


def test_latex_is_a_complete_file(derivation):
    """The LaTeX file has a preamble, and each environment that begins also ends."""
    text = render_document(derivation, "latex")
    assert r"\documentclass" in text
    began = re.findall(r"\\begin\{([a-z*]+)\}", text)
    assert sorted(began) == sorted(re.findall(r"\\end\{([a-z*]+)\}", text))
    assert text.count("{") == text.count("}")


def test_every_formula_of_the_page_is_mathml(derivation):
    """The MathML of each line is well-formed, so it cannot leave its place in the page."""
    formulas = re.findall(r"<math.*?</math>", render_document(derivation, "html"), re.DOTALL)
    assert len(formulas) == sum(len(section["lines"]) for section in derivation["sections"])
    for formula in formulas:
        assert ET.fromstring(formula).tag == "math"


@pytest.mark.parametrize("text", HOSTILE)
def test_free_text_adds_no_element_to_the_page(text):
    """Hostile free text leaves the elements and attributes of the page as they are."""
    plain = Tags(render_document(hostile("plain"), "html"))
    spoiled = Tags(render_document(hostile(text), "html"))
    assert (spoiled.names, spoiled.attributes) == (plain.names, plain.attributes)
    assert "script" not in plain.names


@pytest.mark.parametrize("text", HOSTILE)
def test_free_text_adds_no_command_to_the_latex_file(text):
    r"""Hostile free text brings no command but the escapes themselves, no comment, no math."""
    allowed = {"textbackslash", "textasciicircum", "textless", "textgreater", "textasciitilde"}

    def commands(page):
        return set(re.findall(r"\\([A-Za-z]+)", page.replace(r"\\", "")))

    plain = render_document(hostile("plain"), "latex")
    spoiled = render_document(hostile(text), "latex")
    assert commands(spoiled) <= commands(plain) | allowed
    for mark in "%$#&_^":
        bare = re.compile(r"(?<!\\)" + re.escape(mark))
        assert len(bare.findall(spoiled)) == len(bare.findall(plain)), mark


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("text", HOSTILE)
def test_no_control_character_gets_through(form, text):
    """No format lets a control character of a title reach a terminal."""
    assert not re.search(r"[\x00-\x09\x0b-\x1f\x7f]", render_document(hostile(text), form))
    assert "49" not in render_document(hostile(text), form)
