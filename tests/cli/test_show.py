"""`coadjoint show` prints or writes a derivation by any route in any format."""

from __future__ import annotations

import json
import re

import pytest


@pytest.mark.parametrize(
    ("form", "mark"), [("text", "====="), ("latex", r"\documentclass"), ("html", "<math")]
)
def test_each_format_is_shown(run, form, mark):
    """The derivation of the rigid body is there in each format."""
    result = run("show", "rigid_body", "--format", form)
    assert result.exit_code == 0, result.stderr
    assert mark in result.stdout
    assert "Free rigid body" in result.stdout


def test_the_other_route_is_shown_on_request(run):
    """--route chooses among the declared ones; an undeclared one is refused by name."""
    assert "Lie-Poisson bracket on the dual" not in run("show", "rigid_body").stdout
    assert "{Pi1, Pi2} = -Pi3" in run("show", "rigid_body", "--route", "lie-poisson").stdout
    refused = run("show", "rigid_body", "--route", "kaluza-klein")
    assert refused.exit_code == 2
    assert "'kaluza-klein'" in refused.stderr


def test_output_goes_to_a_file(run, folder):
    """--output writes the file and prints nothing; a place that is not there is named."""
    result = run("show", "rigid_body", "--format", "html", "--output", "body.html")
    assert (result.exit_code, result.stdout) == (0, "")
    assert (folder / "body.html").read_text().startswith("<!DOCTYPE html>")
    refused = run("show", "rigid_body", "--output", "missing/body.txt")
    assert refused.exit_code == 2
    assert "missing/body.txt" in refused.stderr


def test_title_of_a_spec_is_escaped(run, rigid_body):
    """Markup in the title of a spec is text in the page."""
    rigid_body.write_text(
        rigid_body.read_text().replace("Free rigid body", "<script>alert(1)</script> top")
    )
    page = run("show", rigid_body, "--format", "html").stdout
    assert "&lt;script&gt;" in page
    assert "<script" not in page
    assert page.count("data:image/png;base64,") == 1  # a motion of a spec of one's own


def test_nambu_bracket_is_shown(run):
    """A system without an algebra has its derivation, too: the pair and the motion."""
    shown = run("show", "nambu_body")
    assert shown.exit_code == 0, shown.stderr
    assert "dx1/dt" in shown.stdout
    assert max(map(len, shown.stdout.splitlines())) <= 100


def test_many_short_lines_stand_side_by_side(run):
    """The 9 brackets of se(3) stand below each other, the 30 of so(5) in columns."""
    few = run("show", "kirchhoff", "--route", "lie-poisson").stdout
    many = run("show", "so5_body").stdout
    assert not [line for line in few.splitlines() if line.count("} =") > 1]
    assert [line for line in many.splitlines() if line.count("} =") > 1]


def test_methods_are_listed_with_what_decides(run):
    """The default first, the reasons of those that do not apply together, and JSON of the same."""
    shown = run("show", "rigid_body", "--methods").stdout
    first = next(line for line in shown.splitlines() if "Poisson tensor" in line)
    assert first.split()[0] == "spherical_midpoint"
    assert "energy, casimir1, Poisson tensor" in first
    assert '"auto" with step= takes spherical_midpoint.' in shown
    record = json.loads(run("show", "heavy_top", "--methods", "--json").stdout)
    by_name = {each["name"]: each for each in record["methods"]}
    assert by_name["splitting4"]["rank"] == 1
    assert by_name["gauss4"]["exactly"] == ["energy", "casimir1", "casimir2"]
    assert record["structure"]["poisson_tensor"] == "linear"
    refused = "exact_body does not apply: it is no free motion of three components in closed form."
    assert refused in run("show", "heavy_top", "--methods").stdout


@pytest.mark.parametrize(
    ("system", "said"),
    [
        ("stochastic_rigid_body", '"auto" with step= takes spherical_midpoint.'),
        (
            "stochastic_rigid_body",
            "in the sense of Stratonovich, what is kept is kept on each path",
        ),
        ("stochastic_rigid_body", "do not apply: motions with noise have methods of their own"),
        (
            "toda_lattice",
            "do not apply: this system is solved by loops over equal members, which",
        ),
        (
            "kdv",
            "do not apply: this system is solved by loops over points, which this method lacks.",
        ),
        ("tippe_top", '"auto" with step= takes dop853.'),
    ],
)
def test_methods_that_do_not_apply_say_why(run, system, said):
    """Of noise, of equal members, and where nothing is kept."""
    assert said in run("show", system, "--methods").stdout


def test_a_derivation_is_printed_as_json(run):
    """The fields of the document."""
    record = json.loads(run("show", "rigid_body", "--json").stdout)
    assert record["title"] == "Free rigid body"


def find_sizes(page):
    """The numbers of links of which the claims of a chapter are."""
    return set(re.findall(r"for n =\s+(\d+)", page))


def test_the_claims_of_another_size_are_of_that_size(run):
    """What is proved of four links stands in no chapter of two, nor does the cost of their code."""
    four, two = (
        run("show", "n_link_chain").stdout,
        run("show", "n_link_chain", "--size", "i=2").stdout,
    )
    assert find_sizes(four) == {"4"}  # in the chapter of two it was this, too
    assert find_sizes(two) == {"2"}
    assert "Cost of the kernel" in four
    assert "Cost of the kernel" not in two
    assert "theta_3" not in two


def test_claims_for_every_size_stand_in_each_chapter(run):
    """Of equal members the kernels are the same for all sizes, and so is what is proved."""
    shown = run("show", "heisenberg_lattice", "--size", "i=8").stdout
    assert "M is conserved, for every N >= 1" in " ".join(shown.split())
    assert "Cost of the kernel" in shown
