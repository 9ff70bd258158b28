"""A derivation is readable in three formats, and free text is text in each of them."""

from __future__ import annotations

import re
from dataclasses import asdict
from html.parser import HTMLParser
from importlib import import_module
from xml.etree import ElementTree as ET

import pytest
from markupsafe import escape

from coadjoint.derive import derive
from coadjoint.derive.document import document
from coadjoint.derive.lines import formula, formula_line
from coadjoint.derive.records import symbol
from coadjoint.exact import Field
from coadjoint.files import read_certificate
from coadjoint.methods import list_fitting, list_kept, list_unfit
from coadjoint.notation import written
from coadjoint.render.document import (
    INDENT,
    WIDTH,
    align,
    leave_out_repeated,
    list_rows,
    render_document,
    split_sides,
)
from coadjoint.render.prose import escape_latex, escape_typst, set_accents, set_prose
from coadjoint.resources import systems_folder
from tests.constrained import PARTICLE
from tests.prove.test_declared_charts import PLANE, RATES
from tests.specs import RIGID_BODY, emitted, spec

ESCAPED = {
    "text": str,
    "latex": escape_latex,
    "html": lambda text: escape(set_accents(text)),
    "typst": escape_typst,
}
FORMATS = tuple(ESCAPED)
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
    return asdict(document(emitted("heavy_top", request.param)))


def hostile(text):
    """A document whose every free text is hostile."""
    line = {
        "text": "a = 1",
        "latex": "a &= 1",
        "mathml": "<math><mi>a</mi></math>",
        "typst": "a &= 1",
    }
    section = {"title": "Momenta", "law": "mu = p", "law_latex": r"\mu = p", "lines": [line]}
    section |= {"words": [(text, text)], "table": [[line, line], [line, line]]}
    free = dict.fromkeys(("title", "about", "source", "description"), text)
    return {"sections": [section], **free}


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
        words, *formula = re.split(r"(?= so\(3\))", section["title"])
        assert ESCAPED[form](words) in text
        assert not formula or form == "text" or ESCAPED[form](formula[0]) not in text
    lines = [line for section in derivation["sections"] for line in section["lines"]]
    assert len(lines) > 10
    if form != "text":
        written = {"latex": latex_of, "html": sides_of, "typst": typst_of}[form]
        assert all(part in text for line in lines for part in written(line))


def latex_of(line):
    """The LaTeX of a line."""
    return (line["latex"],)


def typst_of(line):
    """The Typst of a line."""
    return (line["typst"],)


def sides_of(line):
    """The MathML of both sides of a line."""
    return split_sides(line["mathml"])


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
    assert len(formulas) >= 2 * sum(len(section["lines"]) for section in derivation["sections"])
    for element in formulas:
        assert ET.fromstring(element).tag == "math"


def without_formulas(page, form):
    """A page without the formulas that were found in its words, which hold letters and signs."""
    pattern = {"html": r"<math>.*?</math>", "latex": r"(?<!\\)\$.*?(?<!\\)\$"}[form]
    for found in re.findall(pattern, page):
        if form == "html":
            tags = {each.tag for each in ET.fromstring(found).iter()}
            assert tags <= {"math", "mrow", "mi", "mn", "mo", "mspace"}, found
        else:
            safe = r"\$([\w ,()+={}-]|\\(,|(left|right|operatorname|mathrm|times|[lr]angle)\b))*\$"
            assert re.fullmatch(safe, found), found
    return re.sub(pattern, "", page)


@pytest.mark.parametrize("text", HOSTILE)
def test_free_text_adds_no_element_to_the_page(text):
    """Hostile free text leaves the elements and attributes of the page as they are."""
    plain, spoiled = (
        Tags(without_formulas(render_document(hostile(each), "html"), "html"))
        for each in ("plain", text)
    )
    assert (spoiled.names, spoiled.attributes) == (plain.names, plain.attributes)
    assert "script" not in plain.names


@pytest.mark.parametrize("text", HOSTILE)
def test_free_text_adds_no_command_to_the_latex_file(text):
    r"""Hostile free text brings no command but the escapes themselves, no comment, no math."""
    allowed = {"textbackslash", "textasciicircum", "textless", "textgreater", "textasciitilde"}

    def commands(page):
        return set(re.findall(r"\\([A-Za-z]+)", page.replace(r"\\", "")))

    plain, spoiled = (
        without_formulas(render_document(hostile(each), "latex"), "latex")
        for each in ("plain", text)
    )
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


def section_of(lines=(), words=(), table=()):
    """A document of one section."""
    section = {"title": "Lines", "law": "a = b", "law_latex": "a = b"}
    section |= {"lines": lines, "words": words, "table": table}
    free = {"title": "Lines", "about": "Some lines.", "source": "", "description": ""}
    return {**free, "sections": [section]}


def numbered(count, width=1):
    """Lines x1 = 0..., x2 = 0..., in every format."""
    return [
        {
            "text": f"x{n} = {'0' * width}",
            "latex": f"x_{{{n}}} &= 0",
            "mathml": f"<math><mi>x{n}</mi></math>",
            "typst": f"x_{n} &= 0",
        }
        for n in range(count)
    ]


@pytest.mark.parametrize(("count", "width", "abreast"), [(24, 1, 1), (25, 1, 4), (60, 40, 1)])
def test_only_many_short_lines_stand_side_by_side(count, width, abreast):
    """In every format each line is there once, in as many columns as fit."""
    page = section_of(numbered(count, width))
    text = render_document(page)
    rows = [line for line in text.splitlines() if " x" in line]
    assert len(rows) == -(-count // abreast)
    assert [int(n) for n in re.findall(r"x(\d+) ", text)[:1]] == [0]
    assert sorted(map(int, re.findall(r"x(\d+) +=", text))) == list(range(count))
    assert max(map(len, text.splitlines())) <= 100
    latex = render_document(page, "latex")
    assert latex.count("&=") == count
    assert latex.count(r" \\") == -(-count // abreast) - 1
    assert f"columns: {abreast}" in render_document(page, "html")


def test_a_table_has_its_heads_in_every_format():
    """First row and first column are heads; text is padded, LaTeX and HTML count the cells."""
    cells = [
        [{"text": t, "latex": t, "mathml": t, "typst": t} for t in row]
        for row in ("zHX", "Hab", "Xcd")
    ]
    page = section_of(table=cells)
    assert "       z | H X\n      ---+----\n       H | a b\n" in render_document(page)
    assert "\\begin{array}{r|rr}\nz & H & X \\\\ \\hline\nH & a & b \\\\\n" in render_document(
        page, "latex"
    )
    html = render_document(page, "html")
    assert (html.count("<th>"), html.count("<td>")) == (5, 4)
    assert "<th>H</th>\n<td>a</td>" in html


def test_words_wrap_under_themselves():
    """A long text goes on under its own beginning."""
    text = render_document(section_of(words=[("rank", "word " * 40), ("Killing form", "3 minus")]))
    rows = text.splitlines()[-4:]
    assert all(row.startswith(" " * 6) and len(row) <= 100 for row in rows)
    assert {row.index("word") for row in rows[:-1]} == {rows[-1].index("3 minus")}


def test_long_sums_are_continued_in_latex():
    """A sum of more terms than a line holds goes on under its right side, no term lost."""
    field = Field([f"x{n}" for n in range(20)])
    whole = field.sum(field[name] for name in field.names) - 2 * field["x3"]
    latex = formula(field, whole).latex
    lines = latex.split(r"&\quad")
    assert len(lines) == len(" + ".join(field.names)) // written.WIDTH + 1
    assert all(f"x_{n}" in latex or f"x_{{{n}}}" in latex for n in range(20))
    assert "- x_3" in latex
    assert formula_line(field, symbol("C"), field["x1"]).latex == "C &= x_1"


def test_paragraphs_of_the_text_fit_whatever_their_line_breaks():
    """A description with line breaks of its own is one paragraph; a long law goes on indented."""
    long = " ".join(["words"] * 40)
    section = {"title": "Step", "law": long, "law_latex": "", "lines": (), "words": (), "table": ()}
    top = {"title": "T", "about": "A.", "source": long, "description": "one\ntwo"}
    text = render_document({**top, "sections": [section]})
    assert "\none two\n" in text
    assert max(map(len, text.splitlines())) <= WIDTH
    assert text.count("words") == 80
    assert "\n      words" in text  # the law, under itself


def sections(text, *changes):
    """The sections of a document by their titles: lines as text, then words."""
    found = document(derive(spec(text, *changes))).sections
    return {each.title: ([line.text for line in each.lines], each.words) for each in found}


def test_observables_are_shown():
    """As they are declared, with their units; momentum maps and momenta by their values."""
    declared = (
        '[observables]\nspin = { expression = "Pi3", unit = "kg m^2/s" }\nt2 = "dot(Pi, Pi)"\n'
    )
    title = "Casimirs, observables and momentum maps"
    lines, words = sections(RIGID_BODY, ("[claims]", f"{declared}[claims]"))[title]
    assert lines == ["casimir1 = Pi . Pi", "spin = Pi3", "t2 = Pi . Pi"]
    assert words == ()
    lines, words = sections(PARTICLE + '[momenta]\nalong = { section = { u = "1" } }\n')[title]
    assert (lines, words) == (["along = y*w*m + u*m"], ())
    assert title not in sections(RIGID_BODY, ('casimirs = ["dot(Pi, Pi)"]', ""))


def test_declared_charts_are_shown():
    """The map, what is zero in the chart, and its motion, in every format."""
    shown = sections(PLANE, ("MOTION", f'where = ["r*L - L*r"]{RATES}'))
    lines, words = shown['Chart "polar"']
    assert lines == [
        "x1 = r*cos(phi)",
        "x2 = r*sin(phi)",
        "p1 = pr*cos(phi) - L*sin(phi)/r",
        "p2 = pr*sin(phi) + L*cos(phi)/r",
    ]
    assert words == (("r*L - L*r = 0", "throughout"),)
    assert shown["Motion in the chart"][0][:2] == ["dr/dt = pr/m", "dphi/dt = L/(m*r^2)"]
    spoiled = sections(PLANE, ("MOTION", RATES.replace("pr/m", "2*pr/m")))
    assert spoiled["Motion in the chart"][0][0] == "dr/dt = 2*pr/m"
    whole = asdict(document(derive(spec(PLANE, ("MOTION", RATES)))))
    for form in FORMATS:
        assert ESCAPED[form]('Chart "polar"') in render_document(whole, form)


def long_rates(vectors):
    """The lead and the last step of a page, with the same lines."""
    lines = [{"mathml": f"<math><mi>a{n}</mi></math>" + " " * 9000} for n in range(3)]
    other = {"mathml": "<math><mi>b</mi></math>"}
    lead = {"title": "Motion", "kind": "motion", "lines": lines, "vectors": vectors, "words": ()}
    step = {"title": "Law", "kind": "step", "lines": [*lines, other], "words": ()}
    return [lead, {**step, "title": "Before", "lines": [other]}, step]


def test_long_rates_stand_once_on_a_page():
    """In their step where the lead has vectors, else in the lead."""
    lead, before, step = leave_out_repeated(long_rates(["dPi/dt = Pi x Omega"]))
    assert (len(lead["lines"]), len(before["lines"]), len(step["lines"])) == (0, 1, 4)
    assert lead["words"] == [("in components", "see Law")]
    lead, before, step = leave_out_repeated(long_rates([]))
    assert (len(lead["lines"]), len(before["lines"]), len(step["lines"])) == (3, 1, 1)
    assert step["words"] == [("rates", "see Motion")]


def test_rates_that_differ_from_the_lead_stay():
    """A step with another right side is no repetition, and short ones stand twice."""
    sections = long_rates([])
    sections[2]["lines"] = [
        dict(line, mathml=line["mathml"] + "!") for line in sections[2]["lines"]
    ]
    assert leave_out_repeated(sections) == sections
    short = [{**each, "lines": [{"mathml": "<math/>"}]} for each in long_rates([])]
    assert leave_out_repeated(short) == short


#: What tells formulas and names of code from words, but for the article.
CODE = re.compile(r"[_^*=\[\]{}+]|\w\(|[A-Za-z]\d|\b(?!a\b)(?<!')[A-Za-z]\b")
#: What is set, in each format.
SET = {
    "html": re.compile(r"<(math|code)>.*?</\1>|</?span[^>]*>"),
    "latex": re.compile(r"\$[^$]*\$|\\texttt\{(?:[^{}]|\{\})*\}"),
    "typst": re.compile(r'\$[^$]*\$|#raw\("[^"]*"\)'),
}


def set_methods(certificate, form):
    """The cells of both tables of methods, as a format has them."""
    judged = certificate["methods"]
    fitting = [
        (m["name"], str(m["order"]), ", ".join(list_kept(m)) or "nothing", m["cost"])
        for m in list_fitting(judged)
    ]
    unfit = [(", ".join(names), why) for why, names in list_unfit(judged).items()]
    empty = {"words": (), "law": "", "law_latex": "", "title": ""}
    heads = {"methods": ("m", "o", "k", "c"), "unfit": ("m", "r")}
    sections = [
        {**empty, "kind": kind, "rows": [heads[kind], *rows]}
        for kind, rows in (("methods", fitting), ("unfit", unfit))
    ]
    state = [{"text": n, "latex": n, "mathml": n, "typst": n} for n in certificate["state"]]
    symbols = [(each, each["text"], "a variable", "1") for each in state]
    sections.append({**empty, "kind": "symbols", "rows": [("s", "n", "m", "u"), *symbols]})
    made = set_prose({"description": "", "sections": sections}, form)["sections"]
    return [str(cell) for part in made[:2] for row in part["rows"][1:] for cell in row]


def list_certificates():
    """Of every shipped system, with the names of its state."""
    for path in sorted(systems_folder().glob("*/certificate.json")):
        system = import_module(f"coadjoint.systems.{path.parent.name}").system
        yield {**read_certificate(path), "state": list(system.STATE)}


def test_tables_of_methods_have_no_sign_of_code():
    """Of every system, in every format: formulas are set, and names of methods are code."""
    systems, seen = [*list_certificates()], 0
    assert len(systems) > 100
    for form, pattern in SET.items():
        for certificate in systems:
            for cell in set_methods(certificate, form):
                left = pattern.sub("", cell)
                assert not CODE.search(left.replace("\\", "")), (form, cell)
                seen += bool(left != cell)
    assert seen > 5000


def test_a_formula_that_stays_plain_is_seen():
    """What the test above looks for, in what would be left."""
    for text in ("T(p)", "casimir1", "g_gram", "O(h^2)", "multiples of i alone", "a = 1", "x + 1"):
        assert CODE.search(text)
    assert not CODE.search("about a dozen sweeps of 2 stages, by Nambu's bracket")


def test_names_of_code_end_lines_behind_their_lines_alone():
    """On a page and in LaTeX a long name is broken there, and nowhere within a word."""
    empty = {"words": (), "law": "", "law_latex": "", "title": "", "kind": "unfit"}
    section = {**empty, "rows": [("method", "reason"), ("average_gradient, kahan", "it has noise")]}
    for form, shown in {
        "html": "<code>average_<wbr>gradient</code>, <code>kahan</code>",
        "latex": r"\texttt{average\_\allowbreak{}gradient}, \texttt{kahan}",
        "typst": '#raw("average_gradient"), #raw("kahan")',
    }.items():
        made = set_prose({"description": "", "sections": [section]}, form)
        assert made["sections"][0]["rows"][1][0] == shown


def test_sources_stand_once_on_a_page():
    """Among the references, where there are some, else at the end."""
    page = {"title": "T", "about": "A", "source": "Euler 1765", "description": ""}
    listed = {"title": "References", "law": "", "kind": "references"}
    listed["words"] = [("system", "Euler 1765")]
    for sections in ([], [listed]):
        assert render_document({**page, "sections": sections}, "html").count("Euler 1765") == 1


def test_kept_quantities_have_the_sign_of_the_chapter():
    """As the table of symbols writes them; words stay words, and letters are letters."""
    sign = {"text": "casimir1", "latex": "C_1", "mathml": "<math><mi>C</mi></math>", "typst": "C"}
    empty = {"words": (), "law": "", "law_latex": "", "title": ""}
    symbols = [("", "name", "meaning", "unit"), (sign, "casimir1", "Casimir", "1")]
    kept = "casimir1, a, spin, dot(S[i], S[i]), Poisson tensor"
    rows = [("method", "order", "keeps", "cost"), ("gauss4", "4", kept, "one map")]
    sections = [{**empty, "kind": "symbols", "rows": symbols}]
    sections.append({**empty, "kind": "methods", "rows": rows})
    made = set_prose({"description": "", "sections": sections}, "latex")["sections"][1]["rows"][1]
    assert made[0] == r"\texttt{gauss4}"
    assert made[2] == r"$C_1$, $a$, spin, $S_i \cdot S_i$, Poisson tensor"
    assert made[3] == "one map"


def test_a_long_left_side_moves_no_other_line():
    """What is equal to it stands below it; the signs of the other lines stay in their column."""
    long = " + ".join(f"a{n}*b{n}" for n in range(30))
    rows = align([{"text": "x = 1"}, {"text": f"{long} = {long}"}, {"text": "yy = 2"}])
    assert rows[0] == "x  = 1"
    assert rows[-1] == "yy = 2"
    assert max(map(len, rows)) <= WIDTH - INDENT
    assert len(rows) < 12
    (below,) = (row for row in rows[1:-1] if "=" in row)
    assert below.startswith("  = a0*b0")
    assert " ".join(" ".join(rows[1:-1]).split()) == f"{long} = {long}"


def test_components_that_steps_have_are_not_printed_twice():
    """Only on paper, and only if every line is there once more."""
    line = {
        "text": "x = y",
        "latex": "x &= y",
        "typst": "x = y",
        "mathml": "<math><mi>x</mi></math>",
    }
    other = {**line, "mathml": "<math><mi>z</mi></math>"}
    motion = {"title": "Motion", "law": "", "kind": "motion", "vectors": [line]}
    step = {"title": "Step", "law": "", "kind": "step", "lines": [line]}
    head = {"title": "T", "about": "", "source": "", "description": ""}

    def shown(lines):
        sections = [{**motion, "lines": lines}, step]
        return render_document({**head, "sections": sections}, "html")

    assert '<details class="told">' in shown([line])
    assert '<details class="told">' not in shown([line, other])


@pytest.mark.parametrize("width", [72, 80])
def test_text_fits_a_width(width):
    """Prose, formulas, tables and what is said of names; nothing is left out."""
    record = asdict(document(emitted("heavy_top")))
    text, whole = render_document(record, "text", width), render_document(record)
    bracket = [x for x in text.splitlines() if re.match(" +(Pi|Gamma|-|[|])[-+0-9]* *[|+]", x)]
    lines = [each for each in text.splitlines() if each not in bracket]
    assert max(map(len, lines)) <= width < max(map(len, whole.splitlines()))
    assert sorted(text.split()) == sorted(whole.split())


def test_words_of_narrow_tables_stay_whole():
    """The column that gives way is one whose words leave room."""
    rows = [("name", "meaning", "unit"), ("g", "acceleration of gravity", "kg m^2/s^2")]
    listed = list_rows(rows, 42)
    assert "acceleration" in " ".join(listed).split()
    assert max(map(len, listed)) <= 42 - INDENT


@pytest.mark.parametrize(("width", "heads"), [(40, False), (80, True), (100, True)])
def test_the_table_of_verdicts_is_printed(width, heads):
    """Every claim with its verdict and its method, in columns, or on a narrow page one by one."""
    claims = [("claim", "verdict", "method"), ("the energy is conserved", "proved", "normal form")]
    claims += [("no measure rho(x) dx is invariant", "numerically supported", "9 random points")]
    section = {"title": "Table of verdicts", "law": "", "kind": "verdicts", "rows": claims}
    page = {"title": "T", "about": "", "source": "", "description": "", "sections": [section]}
    text = render_document(page, "text", width)
    assert max(map(len, text.splitlines())) <= width
    words = [word for row in claims[1:] for cell in row for word in cell.split()]
    assert not [word for word in words if text.split().count(word) < words.count(word)]
    assert ("claim " in text) == heads
    assert (text.count("  verdict: "), text.count("  method: ")) == ((0, 0) if heads else (2, 2))


@pytest.mark.parametrize(
    ("width", "lines"),
    [
        (100, ["        |    Pi1    Pi2", "    Pi1 |      0 -x*Pi3"]),
        (24, ["        |    Pi1", "        |    Pi2"]),
        (18, ["Pi1, Pi2:\n", "Pi2, Pi1:\n"]),
    ],
)
def test_a_bracket_fits_the_terminal(width, lines):
    """In one table, in blocks of columns, or entry by entry."""
    rows = [("", "Pi1", "Pi2"), ("Pi1", "0", "-x*Pi3"), ("Pi2", "x*Pi3", "0")]
    page = section_of(table=[[{"text": each} for each in row] for row in rows])
    page["sections"][0]["law"] = ""
    text = render_document(page, "text", width)
    assert max(map(len, text.splitlines())) <= width
    assert all(line in text for line in lines)
    assert "-x*Pi3" in text


def test_long_products_break_behind_their_signs():
    """A formula that is longer than a line goes on below, and says the same."""
    product = "*".join(f"Omega{n}" for n in range(20))
    line = {"text": f"h = {product}/m", "mathml": ""}
    text = render_document(section_of(lines=[line]), "text", 40)
    assert max(map(len, text.splitlines())) <= 40
    assert f"h={product}/m" in "".join(text.split())


@pytest.mark.parametrize("form", FORMATS)
def test_names_have_their_accents_on_a_page(form):
    """Poincare is written as he was, but for a terminal and in what a person types."""
    page = section_of(words=[("theorem", "Poincare and Ito, route euler-poincare")])
    text = render_document({**page, "source": "Poincare (1901)"}, form)
    assert ("Poincaré (1901)" in text) == ("Itô" in text) == (form != "text")
    assert ESCAPED[form]("euler-poincare") in text
