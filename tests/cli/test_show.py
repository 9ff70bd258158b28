"""`coadjoint show` prints or writes a derivation by any route in any format."""

from __future__ import annotations

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
    assert "Poisson bracket" not in run("show", "rigid_body").stdout
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
