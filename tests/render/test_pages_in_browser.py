"""Chapters of the book in headless Chromium: on a phone, in the dark, on paper."""

import base64
import json

import pytest

from coadjoint.cli.arguments import shipped_names
from coadjoint.cli.book import describe
from coadjoint.cli.show import make_chapter
from coadjoint.render.document import render_book
from tests.explore.browser import CHROMIUM, browser

pytestmark = [
    pytest.mark.campaign,
    pytest.mark.skipif(
        not CHROMIUM, reason="no Chromium on this machine: apt-get install chromium"
    ),
]

#: Elements that go over a side of the window, but for what is moved sideways within its own box;
#: and how many were looked at.
OVER_THE_SIDE = """(() => {
  document.querySelectorAll("details").forEach((each) => { each.open = true });
  const boxes = [...document.querySelectorAll("body *")];
  const isMoved = (each) => {
    for (let box = each.parentElement; box; box = box.parentElement)
      if (getComputedStyle(box).overflowX === "auto") return true;
    return false;
  };
  const isOver = (each) => {
    const box = each.getBoundingClientRect();
    return box.width > 0 && (box.left < -1 || box.right > 391) && !isMoved(each);
  };
  const over = boxes.filter(isOver);
  return [over.map((e) => e.outerHTML.slice(0, 200)), boxes.length];
})()"""


#: Boxes that cut off what reaches below them, and how many equations go over the side of theirs.
CUT_OFF = """(() => {
  const boxes = [...document.querySelectorAll(".law, .words dd, .display, .entries td")];
  const isCut = (box) => box.scrollHeight > box.clientHeight + 1;
  const isWide = (box) => box.scrollWidth > box.clientWidth + 1;
  const cut = boxes.filter((box) => box.clientHeight && isCut(box));
  const wide = [...document.querySelectorAll(".lead .display")].filter(isWide);
  return [cut.map((e) => e.outerHTML.slice(0, 200)), wide.map((e) => e.textContent.slice(0, 200))];
})()"""
#: Systems whose equations by vectors have a formula that no line of a phone holds at any size.
WIDE = frozenset({"guiding_centre_twisted"})


@pytest.fixture(scope="module")
def page():
    """A page of a browser."""
    with browser() as opened:
        yield opened


@pytest.mark.parametrize("name", shipped_names())
def test_a_chapter_fits_a_phone_and_says_nothing(page, name, tmp_path):
    """On 390 columns nothing goes over the side; no error, no address is asked for."""
    path = tmp_path / "book.html"
    path.write_text(render_book([describe(name, make_chapter(name, None, "html"))]))
    page.problems.clear()
    page.asked.clear()
    page.resize(390, 844)
    page.open(path)
    over, count = page.run(OVER_THE_SIDE)
    assert count > 100
    assert over == []
    cut, wide = page.run(CUT_OFF)
    assert cut == []
    assert bool(wide) == (name in WIDE), wide
    assert page.problems == []
    assert [each for each in page.asked if not each.startswith(("file:", "data:"))] == []
    colours = page.run("getComputedStyle(document.body).backgroundColor")
    page.resize(390, 844, dark=True)
    assert page.run("getComputedStyle(document.body).backgroundColor") != colours
    printed = base64.b64decode(page.call("Page.printToPDF")["data"])
    assert printed.startswith(b"%PDF")
    assert printed.count(b"/Type /Page\n") > 2


def test_the_check_sees_what_is_too_wide(page, tmp_path):
    """A definition that cannot be moved by itself goes over the side, and is found."""
    wide = "= " + "*".join(["Omega"] * 60)
    section = {"title": "Rates", "law": "", "kind": "definitions", "words": [("f(q)", wide)]}
    chapter = {"title": "A top", "about": "", "source": "", "description": "", "routes": []}
    chapter |= {"name": "top", "part": "1", "marks": {}, "proved": 0, "others": 0}
    text = render_book([{**chapter, "sections": [section]}])
    rule = "min-width: 0; overflow-x: auto; overflow-y: hidden; }"
    assert text.count(rule) == 1
    for spoiled in (False, True):
        path = tmp_path / "book.html"
        path.write_text(text.replace(rule, "}") if spoiled else text)
        page.resize(390, 844)
        page.open(path)
        over, _ = page.run(OVER_THE_SIDE)
        assert bool(over) == spoiled, json.dumps(over)
