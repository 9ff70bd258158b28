"""What notebooks show is HTML without a script, and text representations fit a screen."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from coadjoint.algebra import algebra_by_name
from coadjoint.derive import derive
from coadjoint.derive.motion import motion_sections
from coadjoint.derive.vectors import vector_form
from coadjoint.files import read_certificate
from coadjoint.loading import _tell, load
from coadjoint.prove import prove
from coadjoint.prove.certificate import Certificate, Claim, Verdict
from coadjoint.prove.examination import examine
from coadjoint.prove.record import motion_record
from coadjoint.spec import read_spec
from coadjoint.systems import chaplygin_sleigh, heavy_top, rigid_body, spin_chain
from tests.specs import emitted, shipped


@pytest.fixture(scope="module")
def shown():
    """One object of each kind."""
    spec = shipped("rigid_body")
    equations = derive(spec)
    algebra = algebra_by_name("so(3)")
    motion = rigid_body.simulate([1.0, 0.3, -0.8], (0, 2), samples=20, progress=False)
    return {
        "spec": spec,
        "equations": equations,
        "certificate": prove(spec),
        "algebra": algebra,
        "examination": examine(algebra, 2),
        "system": rigid_body.system,
        "solution": motion,
    }


class Tags(HTMLParser):
    """The elements of some HTML, and those that are not closed."""

    def __init__(self, text):
        super().__init__()
        self.open, self.names = [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        """Note it."""
        self.names.append(tag)
        if tag not in ("br", "img"):
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        """It is closed at once."""
        self.names.append(tag)

    def handle_endtag(self, tag):
        """It closes the last one."""
        assert self.open.pop() == tag


def test_each_has_html_that_is_whole(shown):
    """Elements nest, there is no script, and something of the object is in it."""
    marks = {
        "spec": "<math>",
        "equations": "𝜫",
        "certificate": "proved",
        "algebra": "<msub><mi>J</mi><mn>3</mn></msub>",
        "examination": "Killing",
        "system": '<mi mathvariant="normal">kg</mi>',
        "solution": ">relative<",
    }
    for name, value in shown.items():
        page = value._repr_html_()
        tags = Tags(page)
        assert (tags.open, "script" in tags.names) == ([], False), name
        assert marks[name] in page, name


def test_a_solution_writes_its_drifts_as_mathematics(shown):
    """Symbols, powers of ten and units; none of it in letters of a typewriter."""
    text = shown["solution"]._repr_html_()
    assert "<pre>" not in text
    assert "e-1" not in re.sub(r'src="[^"]*"', "", text)
    assert "<msub><mi>𝒞</mi><mn>1</mn></msub>" in text
    assert re.search(r"<mn>10</mn><mn>-1\d</mn>|<mn>0</mn>", text)
    assert text.count("relative") == len(shown["solution"].drift) > 0


def test_a_drift_of_what_begins_at_zero_has_its_unit():
    """It is absolute; and that of an attitude is that of its length."""
    start = [0.0] * len(chaplygin_sleigh.system.STATE.components)
    motion = chaplygin_sleigh.simulate(start, (0, 1), samples=5, progress=False)
    motion.__dict__["drift"] = {"energy": 3.5e-9}
    motion.change = lambda name: np.array([0.0, 3.5e-9])
    text = re.sub(r'src="[^"]*"', "", motion._repr_html_())
    assert "relative" not in text
    assert "<mn>3.5</mn><mo>×</mo><msup><mn>10</mn><mn>-9</mn></msup>" in text
    assert '<mi mathvariant="normal">kg</mi>' in text


def test_claims_are_written_as_formulas(shown):
    """A Casimir is a product of bold vectors, as in documents; without a spec letters are plain."""
    own = shown["certificate"]
    momentum = "<mi>\N{MATHEMATICAL BOLD ITALIC CAPITAL PI}</mi>"
    assert momentum in own._repr_html_()
    assert momentum not in replace(own, spec=None)._repr_html_()
    for name in ("certificate", "examination", "algebra", "system"):
        words = re.sub(r"<(math|style).*?</\1>", "", shown[name]._repr_html_(), flags=re.DOTALL)
        assert not re.search(r"dot\(|\^|\*|<=|->|J1", words), name


def test_a_claim_that_fails_says_why():
    """Where it fails, and what to do, stand first."""
    claim = Claim(
        statement="dot(Pi, Pi) is conserved",
        kind="conserved",
        verdict=Verdict.REFUTED,
        method="a point",
        counterexample={"Pi1": "2"},
        defect="3",
    )
    page = Certificate("top", (claim,))._repr_html_()
    assert "top: the certificate does not hold" in page
    assert page.index("Correct the claim") < page.index("What was proved")
    assert "<mn>2</mn>" in page
    told = Certificate("top", (replace(claim, verdict=Verdict.PROVED),))._repr_html_()
    assert "Correct the claim" not in told


def test_text_representations_fit_a_screen(shown):
    """A few lines each, none of a record of all that is inside."""
    for name, value in shown.items():
        lines = repr(value).splitlines()
        assert len(lines) < 24, name
        assert all(len(line) < 200 for line in lines), name


def test_equations_have_latex_with_dots_over_letters(shown):
    """A dot over the letter alone."""
    assert r"\dot{\Pi}_1 &=" in shown["equations"].latex()
    assert r"\dot{\Pi_" not in shown["equations"].latex()


def test_a_heavy_top_is_shown_by_its_vectors():
    """Holm II (2011), 8.1.4: dPi/dt = Pi x Omega + m g Gamma x chi, dGamma/dt = Gamma x Omega."""
    shown = emitted("heavy_top")._repr_latex_()
    momentum, vertical = r"\boldsymbol{\Pi}", r"\boldsymbol{\Gamma}"
    turn, centre = r"\boldsymbol{\Omega}", r"\boldsymbol{\chi}"
    torque = rf"m\,g\,{vertical} \times {centre}"
    assert rf"\dot{{{momentum}}} &= {momentum} \times {turn} + {torque} \\" in shown
    assert rf"\dot{{{vertical}}} &= {vertical} \times {turn} \\" in shown
    assert r"\dot{\Pi}_1" not in shown, "components stand below, in HTML alone"


def test_without_all_vectors_components_are_shown(shown, monkeypatch):
    """An equation that is missing is not left out: all of them stand in components."""
    equations = shown["equations"]
    form = vector_form(equations)
    assert len(form.lines) > 1
    assert form.missing == ()
    partial = replace(form, lines=form.lines[1:], missing=("Pi",))
    monkeypatch.setattr("coadjoint.derive.motion.vector_form", lambda _: partial)
    assert equations._repr_latex_() == f"$\\displaystyle {equations.latex()}$"


def test_a_system_shows_its_motion_as_its_equations_do():
    """Of the package alone: by vectors, as LaTeX and as a page; by components without vectors."""
    assert heavy_top.system._repr_latex_() == emitted("heavy_top")._repr_latex_()
    page = heavy_top.system._repr_html_()
    assert page.count('<div class="lead">') == 1
    assert page.index("Equations of motion") < page.index("State")
    shown = chaplygin_sleigh.system._repr_latex_()
    assert r"\left(m\,{a}^{2} + I\right)\,\dot{\omega} &= -m\,a\,v\,\omega \\" in shown


def test_long_sums_of_a_motion_are_shown(tmp_path):
    """Those in several lines, whose cells have a style, are MathML that a certificate may hold."""
    (part,) = map(motion_record, motion_sections(emitted("so5_body")))
    assert any("<mtable" in line["mathml"] for line in part["lines"])
    path = tmp_path / "certificate.json"
    path.write_text(json.dumps({"motion": [part]}))
    assert read_certificate(path)["motion"] == [part]


def test_a_system_is_shown_without_the_engine():
    """No SymPy, no pydantic, and no NumPy beyond what the package loads itself."""
    script = (
        "import sys\nfrom coadjoint.systems import heavy_top\nbefore = set(sys.modules)\n"
        "assert '<math' in heavy_top.system._repr_html_()\n"
        "assert heavy_top.system._repr_latex_()\n"
        "print({'sympy', 'pydantic'} & set(sys.modules), 'numpy' in set(sys.modules) - before)"
    )
    run = subprocess.run(
        [sys.executable, "-P", "-c", script], capture_output=True, text=True, check=True
    )
    assert run.stdout == "set() False\n"


@pytest.mark.parametrize(
    "spoiled",
    [
        {"mathml": "<math><script>f()</script></math>"},
        {"mathml": '<math><mi onclick="f()">x</mi></math>'},
        {"mathml": "<math><mi>x</mi></math><img src=x>"},
        {"mathml": '<math><mi href="x">x</mi></math>'},
        {"mathml": '<math><mi style="background: url(x)">x</mi></math>'},
        {"latex": 3},
        {"text": None},
    ],
)
def test_a_motion_that_is_no_formula_is_not_shown(tmp_path, spoiled):
    """What a damaged certificate holds in the place of MathML does not reach a page."""
    path, line = tmp_path / "c.json", {"text": "x", "latex": "x", "mathml": "<math></math>"}
    for own, count in ((line, 1), (line | spoiled, 0)):
        part = {"title": "Motion", "law": "", "vectors": [], "lines": [own]}
        path.write_text(json.dumps({"motion": [part]}))
        assert len(read_certificate(path).get("motion", ())) == count


def test_equations_stand_below_each_other_by_a_style_of_their_own(shown):
    """Rules for a grid of sides, inside a class that nothing else of a notebook has."""
    page = shown["equations"]._repr_html_()
    assert page.count("<style>") == 1
    rules, body = page.split("</style>")
    assert re.search(r"\.formulas \{.*\.lines \{ display: grid", rules, re.DOTALL)
    assert body.strip().startswith('<div class="formulas">')


def test_styles_of_a_fragment_are_rules_of_its_class(shown):
    """Each opens and ends within the one class: tables of others in a notebook keep theirs."""
    for each in ("spec", "certificate", "system", "solution"):
        for rules in re.findall("<style>(.*?)</style>", shown[each]._repr_html_(), re.DOTALL):
            assert rules.strip().startswith(".formulas {")
            depth = 0
            for n, sign in enumerate(rules.strip()):
                depth += {"{": 1, "}": -1}.get(sign, 0)
                assert depth > 0 or n < len(".formulas {") or n == len(rules.strip()) - 1
            assert "&.formulas :is(td, th) { text-align: left" in rules


def test_a_field_is_shown_by_its_first_values():
    """Of 256 points some are listed, in HTML and as text; of a vector all."""
    text = repr(spin_chain.system.STATE)
    assert max(map(len, text.splitlines())) < 130
    assert spin_chain.system.STATE._repr_html_().count("0.999") == 1
    assert "1, 2, 3" in repr(heavy_top.system.PARAMETERS)


def test_loading_in_a_notebook_tells_its_stages_where_results_stand(monkeypatch, capsys):
    """What is written to the stream of errors is red there; without a notebook nothing is told."""
    with _tell(None) as tell:
        tell("sample", "prove", 2, 5)
    assert capsys.readouterr() == ("", "")
    monkeypatch.setitem(sys.modules, "ipykernel", sys)
    with _tell(None) as tell:
        tell("sample", "prove", 2, 5)
    out, err = capsys.readouterr()
    assert out.startswith("\rsample: prove (2 of 5)")
    assert err == ""


@pytest.mark.parametrize(
    ("function", "value", "advice"),
    [
        (derive, "heavy_top", "what coadjoint.read_spec returns"),
        (prove, "heavy_top", "what coadjoint.read_spec returns"),
        (examine, "so(3)", r'coadjoint.algebra_by_name\("so\(3\)"\)'),
        (read_spec, 3, "the path of a spec"),
        (load, None, "the path of a spec"),
    ],
)
def test_an_argument_of_another_type_is_told_what_to_pass(function, value, advice):
    """The function, what was found, and what makes one."""
    with pytest.raises(TypeError, match=f"was given {re.escape(repr(value))}, a .*{advice}"):
        function(value)
