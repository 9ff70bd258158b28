"""Formulas that paper cannot hold are set smaller on it, and no others."""

from __future__ import annotations

import pytest

from coadjoint.render.document import render_document
from coadjoint.render.widths import PAPER, SMALLEST, fit_paper

X, PLUS = "<mi>x</mi>", "<mo>+</mo>"


def whole(inner):
    """A formula."""
    return f"<math><mrow>{inner}</mrow></math>"


def test_the_width_of_a_fraction_and_of_rows_is_that_of_the_wider_part():
    """Both are twice as wide as paper, as is a plain sum; two of them side by side are more."""
    long = (X + PLUS) * 40
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


def test_a_page_has_the_size_of_its_widest_line_on_paper():
    """On each box of formulas, and on none that fits."""
    line = {"text": "a = x", "latex": "a &= x", "typst": "a &= x", "mathml": whole(X)}
    wide = {**line, "mathml": whole((X + PLUS) * 40)}
    section = {"title": "Rates", "law": "", "kind": "step"}
    page = {"title": "T", "about": "", "source": "", "description": ""}
    sections = [{**section, "lines": [line]}, {**section, "lines": [line, wide]}]
    shown = render_document({**page, "sections": sections}, "html")
    assert shown.count('style="--fit: 0.5"') == shown.count('style="--fit') == 1
    assert "var(--fit, 1)" in shown[shown.index("@media print") :]
