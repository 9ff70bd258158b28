"""`coadjoint algebra` shows an algebra in each format, and refuses what is none."""

from __future__ import annotations

import json
import re

import pytest

from coadjoint.cli.algebra import examination_record
from coadjoint.errors import LimitError
from coadjoint.limits import EXAMINED_GENERATORS
from coadjoint.render.document import render_document

TWISTED = """
title = "An algebra with a parameter"
routes = ["lie-poisson"]

[algebra]
basis = ["e1", "e2", "e3"]

[algebra.brackets]
"[e1, e2]" = "k*e3"
"[e2, e3]" = "e1"
"[e3, e1]" = "e2"

[variables]
mu = { role = "momentum" }

[parameters]
k = { default = 2 }

[hamiltonian]
h = "dot(mu, mu)/2"
"""


@pytest.fixture
def twisted(folder):
    """A spec whose brackets hold a parameter."""
    path = folder / "twisted.toml"
    path.write_text(TWISTED, encoding="utf-8")
    return path


def examined(word, form, degree=4, generators=EXAMINED_GENERATORS):
    """What the child of the command returns, here without the child."""
    request = {"algebra": word, "form": form, "degree": degree, "generators": generators}
    return json.loads(json.dumps(examination_record(request)))


def record(word, **options):
    """The record of an algebra."""
    return examined(word, "json", **options)


def text_of(word, **options):
    """The page of an algebra."""
    return render_document(examined(word, "text", **options))


def refused(run, *words):
    """The message of a command that ends with status 2 and prints nothing."""
    result = run("algebra", *words)
    assert (result.exit_code, result.stdout) == (2, "")
    return result.stderr


# -- what is shown --------------------------------------------------------------------------------


def test_text_shows_table_invariants_casimirs_and_verdicts(run):
    """Everything about se(3) is on one page: the rows of the table are its brackets."""
    result = run("algebra", "se(3)")
    assert result.exit_code == 0, result.stderr
    lines = result.stdout.splitlines()
    rows = {line.split("|")[0].strip(): line.split("|")[1].split() for line in lines if "|" in line}
    heads = rows.pop("")
    assert heads == ["J1", "J2", "J3", "P1", "P2", "P3"] == list(rows)
    assert rows["J1"] == [".", "J3", "-J2", ".", "P3", "-P2"]
    assert rows["P3"] == ["P2", "-P1", ".", ".", ".", "."]
    assert "rotation = J1, J2, J3; translation = P1, P2, P3" in result.stdout
    assert "0 positive, 3 negative, 3 zero" in result.stdout
    assert "so 2 independent Casimirs" in result.stdout
    assert "casimir1 = J1*P1 + J2*P2 + J3*P3" in result.stdout
    assert "se(3) satisfies the Jacobi identity (exact arithmetic" in result.stdout
    assert max(map(len, lines)) <= 100


@pytest.mark.parametrize("name", ["so(7)", "bargmann", "R^3", "gl(3)", "su(3)"])
def test_text_fits_a_terminal(name):
    """No line is longer than 100 columns, whatever the size of the algebra."""
    lines = text_of(name, degree=2).splitlines()
    assert len(lines) > 20
    assert max(map(len, lines)) <= 100


def test_large_tables_become_lists():
    """The 105 brackets of so(7) are each there once, several on a line."""
    text = text_of("so(7)", degree=2)
    pairs = re.findall(r"\[(E\d+), (E\d+)\] +=", text)
    assert len(pairs) == len(set(pairs)) == 105
    assert ("E12", "E13") in pairs
    assert text.count("\n") < 100


def test_latex_is_a_complete_file(run):
    """The LaTeX file has an array of brackets and Casimirs, and closes all it opens."""
    text = run("algebra", "sl(2,R)", "--format", "latex").stdout
    assert text.rstrip().endswith(r"\end{document}")
    assert r"H & \cdot & 2\,X & -2\,Y \\" in text
    assert r"\mathcal{C}_1 &= {H}^{2} + 4\,X\,Y" in text
    assert text.count("{") == text.count("}")
    began = re.findall(r"\\begin\{([a-z*]+)\}", text)
    assert "array" in began
    assert sorted(began) == sorted(re.findall(r"\\end\{([a-z*]+)\}", text))


def test_html_goes_to_a_file(run, folder):
    """--output writes the page and prints nothing; a place that is not there is named."""
    result = run("algebra", "so(3)", "--format", "html", "--output", "so3.html")
    assert (result.exit_code, result.stdout) == (0, "")
    page = (folder / "so3.html").read_text()
    assert page.startswith("<!DOCTYPE html>")
    assert page.count("<tr>") == 4
    assert page.count("<td>") == 9
    assert "missing/so3.txt" in refused(run, "so(3)", "--output", "missing/so3.txt")


def test_json_has_the_documented_keys(run):
    """The record has the keys of the help, in its order, and their values are those of h(1)."""
    found = json.loads(run("algebra", "h(1)", "--format", "json").stdout)
    epilog = run("algebra", "--help").stdout.partition("Keys of --format json:")[2]
    documented = re.findall(r"^ {4}(\S.*?) {2,}", epilog, re.MULTILINE)
    assert list(found) == ", ".join(documented).split(", ")
    assert found["brackets"] == [{"pair": ["A1", "B1"], "value": "C"}]
    assert found["killing_signature"] == [0, 0, 3]
    assert found["properties"] == ["nilpotent", "solvable", "unimodular"]
    assert found["center"] == ["C"]
    assert found["derived_series"] == [3, 1, 0]
    assert found["rank"] == 2
    assert found["casimirs"] == {"expected": 1, "found": ["C"], "missing": ""}
    assert {claim["verdict"] for claim in found["claims"]} == {"proved"}
    assert all(claim["method"] for claim in found["claims"])


def test_json_to_a_file_is_the_same_text(run, folder):
    """--output and standard output agree."""
    run("algebra", "aff(1)", "--format", "json", "--output", "aff.json")
    printed = run("algebra", "aff(1)", "--format", "json").stdout
    assert (folder / "aff.json").read_text() == printed


def test_degree_bounds_the_search():
    """To degree 1 the Casimirs of se(3) are not found, and the record says why."""
    found = record("se(3)", degree=1)["casimirs"]
    assert (found["expected"], found["found"]) == (2, [])
    assert found["missing"] == "2 not found among all polynomials of degree <= 1"
    assert len(record("se(3)", degree=2)["casimirs"]["found"]) == 2


def test_search_that_would_be_too_large_goes_as_far_as_it_can():
    """se(7) has 35959 monomials to degree 4: to degree 3 the square of P is found, and all told."""
    found = record("se(7)")
    assert found["rank"] == 24
    assert len(found["casimirs"]["found"]) == 1
    assert "35959 monomials" in found["casimirs"]["missing"]
    assert "all polynomials of degree <= 3" in found["findings"][0]["statement"]


# -- specs ----------------------------------------------------------------------------------------


def test_algebra_of_a_system_has_its_advected_quantities():
    """The heavy top lives on the dual of se(3), made of so(3) and the dual of its vertical."""
    found, named = record("heavy_top"), record("se(3)")
    for key in ("dimension", "killing_signature", "rank", "properties", "derived_series"):
        assert found[key] == named[key], key
    assert found["blocks"]["Gamma"] == ["Gamma1", "Gamma2", "Gamma3"]
    assert "Gamma1^2 + Gamma2^2 + Gamma3^2" in found["casimirs"]["found"]


def test_algebra_with_parameters_is_proved_for_all_their_values(run, twisted):
    """Jacobi is decided with the parameter in it; what depends on its value is told."""
    found = record("./twisted.toml")
    assert found["brackets"][0] == {"pair": ["e1", "e2"], "value": "e3*k"}
    assert found["killing_signature"] is None
    assert found["casimirs"]["expected"] == 1
    assert found["casimirs"]["found"] == ["e1^2 + e2^2 + e3^2*k"]
    text = run("algebra", twisted).stdout
    assert "not counted, since the constants contain parameters" in text
    assert "semisimple, unimodular, for almost all values of the parameters" in text


@pytest.mark.parametrize(
    ("system", "statement"),
    [
        ("nambu_body", "every Casimir is a function of the one known"),
        ("heisenberg", "every Casimir is a function of the one known"),
        ("affine_line", "there are no Casimirs but constants"),
    ],
)
def test_prove_counts_the_casimirs_of_every_bracket(run, system, statement):
    """`prove` says whether all are known, of declared brackets as of algebras."""
    proved = json.loads(run("prove", system, "--json").stdout)
    statements = [claim["statement"] for claim in proved["claims"]]
    assert f"{statement}, near almost every point" in statements
    assert proved["holds"]


def test_names_of_algebras_go_before_those_of_systems():
    """`bargmann` is the algebra, though a system is called so, too."""
    assert record("bargmann", degree=2)["name"] == "bargmann"


# -- what is refused ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("word", "fixes"),
    [
        ("so(x)", ["'so(x)'", "so(n)", "Did you mean 'so("]),
        ("bargman", ["'bargman'", "Did you mean 'bargmann'?"]),
        ("heavytop", ["'heavytop'", "did you mean the system 'heavy_top'?"]),
        ("so(1)", ["'so(1)'", "n >= 2"]),
        ("sp(3)", ["'sp(3)'", "even"]),
        ("nowhere.toml", ["nowhere.toml", "no such file"]),
        ("nambu_body", ["nambu_body.toml", "[algebra]", "`coadjoint prove nambu_body`"]),
    ],
)
def test_unknown_words_are_refused_with_the_way_out(run, word, fixes):
    """The message repeats the word and says what would have been accepted."""
    message = refused(run, word)
    assert message.count("\n") == 1
    for fix in fixes:
        assert fix in message, message


def test_large_algebra_is_refused_before_it_is_built(run):
    """The refusal has generators, brackets, monomials, the limit and the option that lifts it."""
    message = refused(run, "so(12)")
    for part in ("so(12)", "66 generators", "2145 brackets", "916894 monomials"):
        assert part in message
    assert f"at most {EXAMINED_GENERATORS} generators (EXAMINED_GENERATORS" in message
    assert "--generators 66" in message


def test_algebra_beyond_the_limit_of_the_engine_is_not_promised(run):
    """No option lifts the bound of all algebras."""
    message = refused(run, "so(200)")
    assert "19900 generators" in message
    assert "5000 (GENERATORS)" in message
    assert "--generators 19900" not in message


def test_bound_holds_for_specs_and_counts_advected_quantities(run):
    """so(3) has three generators, and the heavy top's algebra six."""
    assert "6 generators" in refused(run, "heavy_top", "--generators", "5")
    assert run("algebra", "heavy_top", "--generators", "6").exit_code == 0


def test_refusal_keeps_its_parts():
    """A program reads the figures without parsing the text."""
    with pytest.raises(LimitError) as caught:
        record("so(12)", degree=2, generators=36)
    error = caught.value
    assert (error.found, error.limit, error.brackets, error.monomials) == (66, 36, 2145, 2277)


@pytest.mark.parametrize("bad", [("--degree", "0"), ("--generators", "5001"), ("--format", "pdf")])
def test_bad_options_are_refused(run, bad):
    """Each option names its range."""
    result = run("algebra", "so(3)", *bad)
    assert result.exit_code == 2
    assert f"'{bad[1]}'" in result.stderr or f"{bad[1]} is not in the range" in result.stderr


def test_spoiled_algebra_is_refused_with_triple_and_defect(run, twisted):
    """One bracket changed: file, key, the three generators and what their sum is."""
    twisted.write_text(TWISTED.replace('"e1"\n', '"e1 + e2"\n'))
    message = refused(run, twisted)
    assert "algebra.brackets" in message
    assert re.search(r"\[e1, \[e2, e3\]\] \+ cyclic = \(k\) e3; expected 0", message)


def test_examination_that_takes_too_long_says_what_to_lower(run):
    """A child that is stopped names the algebra, its stage, and the options that bound the work."""
    message = refused(run, "so(9)", "--degree", "6", "--seconds", "2")
    assert "so(9): stopped in the stage 'examine' after 2 s of processor time" in message
    assert "--seconds 20" in message
    assert "--degree" in message
