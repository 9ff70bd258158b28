"""Formulas that paper cannot hold are set smaller on it, and no others."""

from __future__ import annotations

import pytest

from coadjoint.notation.trees import write_tree
from coadjoint.render.document import render_document
from coadjoint.render.sums import _split_sum, fit_paper, split_sides
from coadjoint.render.widths import PAPER, SMALLEST
from coadjoint.spec.core.expressions import read_expression

X, PLUS = "<mi>x</mi>", "<mo>+</mo>"


def whole(inner):
    """A formula."""
    return f"<math><mrow>{inner}</mrow></math>"


def test_the_width_of_a_fraction_and_of_rows_is_that_of_the_wider_part():
    """Both are twice as wide as paper, as is a plain sum; two of them side by side are more."""
    long = X * 120
    plain = fit_paper(whole(long))
    assert SMALLEST < plain < 1
    assert fit_paper(whole(f"<mfrac><mrow>{long}</mrow>{X}</mfrac>")) == plain
    rows = f"<mtr><mtd>{long}</mtd></mtr>" * 3
    assert fit_paper(whole(f"<mtable>{rows}</mtable>")) == plain
    assert fit_paper(whole(long + X * 20)) < plain
    assert fit_paper(whole(long * 9)) == SMALLEST


@pytest.mark.parametrize("count", [1, 10, 19])
def test_what_fits_stays_as_it_is(count):
    """Up to the width of a line."""
    inner = (X + PLUS) * count
    assert count * 1.8 < PAPER
    assert fit_paper(whole(inner)) == 1


def test_a_sum_breaks_at_its_signs_and_nowhere_else():
    """Whatever is in brackets or in a fraction stays whole, and nothing is lost or added."""
    inner = whole(f"<mfrac><mrow>{X}{PLUS}{X}</mrow>{X}</mfrac>").removeprefix("<math>")[:-7]
    addends = [X * 9, inner, f"<mrow><mo>(</mo><mrow>{X}{PLUS}{X}</mrow><mo>)</mo></mrow>"]
    minus = "<mo>\u2212</mo>"
    rows = f"<mtr><mtd><mrow>{minus}{addends[0]}</mrow></mtd></mtr>"
    second = f"<mrow>{addends[1]}{minus}{addends[2]}</mrow>"
    rows += f"<mtr><mtd><mrow>{PLUS}{second}</mrow></mtd></mtr>"
    plain = f'<mi>a</mi><mo>=</mo><mtable displaystyle="true">{rows}</mtable>'
    left, right = split_sides(whole(plain))
    assert left == '<math displaystyle="true"><mi>a</mi></math>'
    assert right.count("<math ") == 3
    assert right.count("<mi>") == plain.count("<mi>") - 1
    assert right.count('<mo form="infix">') == 2
    assert split_sides(whole(f"<mi>a</mi><mo>=</mo>{X}{PLUS}{X}"))[1].count("<math ") == 1


def test_a_page_has_the_size_of_its_widest_line_on_paper():
    """On each box of formulas, and on none that fits."""
    line = {"text": "a = x", "latex": "a &= x", "typst": "a &= x", "mathml": whole(X)}
    wide = {**line, "mathml": whole(X * 120)}
    section = {"title": "Rates", "law": "", "kind": "step"}
    page = {"title": "T", "about": "", "source": "", "description": ""}
    sections = [{**section, "lines": [line]}, {**section, "lines": [line, wide]}]
    shown = render_document({**page, "sections": sections}, "html")
    assert shown.count('style="--fit: 0.5"') == shown.count('style="--fit') == 1
    assert "var(--fit, 1)" in shown[shown.index("@media print") :]


def test_what_is_split_keeps_functions_printable():
    """A character that is not printable would be shown by its number on the page."""
    shapes = {"a": (3,), "b": (3,)}
    wide = " + ".join(["diag(a)*b"] * 9)
    pieces = list(_split_sum(write_tree(read_expression(wide), shapes).mathml))
    assert len(pieces) > 1
    assert "".join(pieces).count("&#x2061;") == 9
    assert all(piece.isprintable() for piece in pieces)
