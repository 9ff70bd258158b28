"""Configuration of Sphinx: what `site/build.py` laid out becomes pages that need no server."""

from __future__ import annotations

from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata

from coadjoint import __version__

project = "coadjoint"
author = "the coadjoint developers"
project_copyright = author
release = version = __version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
]
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 4
exclude_patterns = ["examples/GALLERY_HEADER.rst"]
suppress_warnings = ["myst.header"]  # pages of the repository begin where they like

html_theme = "furo"
html_title = "coadjoint"
html_static_path: list[str] = ["_static"]
html_css_files = ["formulas.css", "site.css"]
html_show_sphinx = False
html_copy_source = False
html_extra_path = ["_made"]
html_theme_options = {"navigation_with_keys": True}
html_math_renderer = "mathml"
pygments_style = "friendly"
pygments_dark_style = "native"

autodoc_typehints = "signature"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True}
napoleon_google_docstring = True
napoleon_use_ivar = True

sphinx_gallery_conf = {
    "examples_dirs": ["examples"],
    "gallery_dirs": ["gallery"],
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "download_all_examples": False,
    "show_signature": False,
    "write_computation_times": False,
    "remove_config_comments": True,
    "abort_on_example_error": True,
}


def show_inline(writer: Any, node: nodes.math) -> None:
    """Mathematics within a line as MathML, which browsers read by themselves."""
    writer.body.append(convert(node.astext()))
    raise nodes.SkipNode


def show_displayed(writer: Any, node: nodes.math_block) -> None:
    """Mathematics on a line of its own."""
    writer.body.append(f'<div class="math">{convert(node.astext(), display="block")}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> ExtensionMetadata:
    """Mathematics without scripts and without a network."""
    app.add_html_math_renderer("mathml", (show_inline, None), (show_displayed, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
