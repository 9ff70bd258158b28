"""A book is one page of systems, with contents, a table of proofs, and no address outside."""

from __future__ import annotations

import re


def test_a_book_of_two_systems(run, folder):
    """Contents in the order of the book's chapters, links that go somewhere, marks of routes."""
    result = run("book", "heavy_top", "rigid_body", "--output", "book.html")
    assert (result.exit_code, result.stdout) == (0, "book.html: 2 systems\n")
    page = (folder / "book.html").read_text()
    assert page.index('href="#rigid_body"') < page.index('href="#heavy_top"')
    links, places = re.findall(r'href="#(\w+)"', page), re.findall(r' id="(\w+)"', page)
    assert set(links) <= set(places)
    assert len(places) == len(set(places))
    assert "8. Heavy-top equations" in page
    assert not re.search(r"https?://|<script", page)
    row = re.search(r'<tr><td><a href="#heavy_top">.*?</tr>', page)[0]
    assert (row.count("<td>1</td>"), row.count("<td>=</td>")) == (1, 7)
    assert page.count("<figure>") == 2
