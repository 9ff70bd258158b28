"""The site: every system has its place, text stays text, and no page asks the network."""

from __future__ import annotations

import re
import runpy
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from tests.conftest import FAMILIES, FIELDS, SYSTEMS

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
        parts=frozenset(["document.html", "picture.png"]),
    )
    page = site["write_system"](made)
    assert "documents/kepler.html" in page
    assert "explorers" not in page
    assert "explorers/kepler.html" in site["write_system"](
        replace(made, parts=made.parts | {"explorer.html"})
    )
    assert "Kepler &lt;b&gt;" in site["write_index"]([made])


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
