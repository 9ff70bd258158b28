"""The site: every system has its place, text stays text, and no page asks the network."""

from __future__ import annotations

import re
import runpy
import subprocess
import sys
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from coadjoint.derive.document import document
from coadjoint.render.document import render_document
from tests.conftest import FAMILIES, FIELDS, SYSTEMS
from tests.specs import emitted
from tests.test_notebook import Tags

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def site():
    """The names of the script that builds it."""
    return runpy.run_path(str(ROOT / "site" / "build.py"))


def test_every_system_has_a_place_in_the_gallery(site):
    """Each of them once."""
    groups = site["list_groups"]((*SYSTEMS, *FAMILIES, *FIELDS))
    names = [name for _, own in groups for name in own]
    assert sorted(names) == sorted((*SYSTEMS, *FAMILIES, *FIELDS))


def test_a_page_shows_what_could_be_made(site):
    """Without an explorer there is no link to one; titles are text."""
    made = site["Made"](
        name="kepler",
        title="Kepler <b>",
        about="",
        source="a book",
        routes=("canonical",),
        folder=ROOT,
        has_explorer=False,
        caption="Colour is time.",
        equations={"Equations of motion": "<p>by vectors</p>"},
    )
    page = site["write_system"](made)
    assert "documents/kepler.html" in page
    assert "explorers" not in page
    assert "explorers/kepler.html" in site["write_system"](replace(made, has_explorer=True))
    equations = page.index("<p>by vectors</p>")
    assert page.index("## Equations of motion") < equations < page.index("## Declaration")
    assert "## Equations" not in site["write_system"](replace(made, equations={}))
    assert "Kepler &lt;b&gt;" in site["write_index"]([made])


@pytest.mark.parametrize(
    ("name", "titles", "mark"),
    [
        ("rigid_body", ["Equations of motion"], "<mi>𝜫</mi><mo>&#xD7;</mo><mi>𝜴</mi>"),
        ("toda_lattice", ["Equations of motion", "Ends"], "<mi>q</mi>"),
    ],
)
def test_a_page_shows_the_equations_of_its_document(site, name, titles, mark):
    """By vectors as MathML: the lines of the motion alone, in one block of HTML that is whole."""
    page = render_document(asdict(document(emitted(name))), "html")
    equations = site["find_equations"](page)
    assert list(equations) == titles
    body = equations["Equations of motion"]
    assert mark in body
    assert "\n\n" not in body, "an empty line would end the block"
    for text in equations.values():
        assert Tags(text).open == []
        assert "<section" not in text
    spoiled = page.replace('<section class="motion', '<section class="step')
    assert "Equations of motion" not in site["find_equations"](spoiled)


def test_equations_have_the_style_of_documents(site):
    """The style is laid out as it stands: there is nothing in it to fill in."""
    style = site["FORMULAS"].read_text(encoding="utf-8")
    assert ".lines { display: grid" in style
    assert not re.search(r"\{[{%#]", style)
    assert style.splitlines()[0] in render_document(asdict(document(emitted("rigid_body"))), "html")


def list_ascii(page):
    """Lines of a page that show a formula as code: indented, outside of fences and of lists."""
    text = re.sub(r"^```.*?^```", "", page, flags=re.DOTALL | re.MULTILINE)
    return re.findall(r"^(?![-*\d ]|    ).*\n\n    (\S.*=.*)$", text, re.MULTILINE)


def test_pages_set_their_formulas():
    """A formula on a line of its own is between dollars, and not code."""
    pages = [path for path in (ROOT / "docs").rglob("*.md") if not path.name.endswith(".in.md")]
    assert len(pages) > 20
    assert {path.name: found for path in pages if (found := list_ascii(path.read_text()))} == {}
    assert list_ascii("The law is\n\n    dp/dt = F.\n") == ["dp/dt = F."]
    assert list_ascii("The law is\n\n$$\n\\dot p = F\n$$\n") == []


def test_an_example_has_the_picture_of_its_system(site):
    """Of the first one that it imports; without any, that of the system of the tutorial."""
    choose = site["_choose_thumbnail"]
    script = "import numpy\n\nfrom coadjoint.systems import rattleback\n"
    assert "'_static/pictures/rattleback.png'" in choose(script, {"rattleback"})
    for other, drawn in ((script, {"kepler"}), ("import numpy\n", {"rattleback"})):
        (place,) = re.findall("'(.*)'", choose(other, drawn))
        assert (ROOT / place).is_file()


def test_the_picture_of_a_page_is_that_of_its_document(site):
    """With its caption, as HTML; a document without one is told."""
    figure = (
        '<figure><img src="data:image/png;base64,{}" alt="">\n<figcaption>x &lt; 1</figcaption>'
    )
    page = figure.format("iVBORw0=")
    assert site["find_picture"](page) == b"\x89PNG\r"
    assert site["find_caption"](page) == "x &lt; 1"
    with pytest.raises(AssertionError):
        site["find_picture"]("<p>without</p>")


def test_a_page_of_parts_has_one_title(site):
    """Headings move down by one below the first part, and comments in code stay."""
    page = "# A\n\ntext\n\n## B\n\n```toml\n# a comment\n```\n\n# C\n\n## D\n"
    moved = site["_below_one_title"](page)
    assert re.findall(r"^#.*", moved, re.MULTILINE) == [
        "# A",
        "### B",
        "# a comment",
        "## C",
        "### D",
    ]


@pytest.mark.campaign  # Sphinx and the examples: half a minute
def test_the_site_is_built_without_a_warning_and_without_a_network(tmp_path):
    """Links and anchors lead somewhere, and pages load nothing but what stands beside them."""
    pytest.importorskip("sphinx", reason="no Sphinx: pip install '.[site]'")
    build = [sys.executable, "-P", "site/build.py", "--systems", "heavy_top,kdv"]
    run = subprocess.run(
        [*build, "--output", str(tmp_path)], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    pages = sorted(tmp_path.rglob("*.html"))
    assert len(pages) > 80
    loaded = re.compile(r"<(?:script|link|img|iframe)[^>]+(?:src|href)=\"(?:https?:)?//[^\"]*\"")
    for page in pages:
        found = loaded.findall(page.read_text(encoding="utf-8"))
        assert not [tag for tag in found if 'rel="canonical"' not in tag], page
