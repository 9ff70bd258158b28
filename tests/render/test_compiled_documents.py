"""Documents compile as they are: LaTeX by pdflatex or tectonic, Typst by the package `typst`."""

from __future__ import annotations

import shutil
import subprocess
from importlib.util import find_spec

import pytest

from coadjoint.cli.arguments import shipped_names
from coadjoint.cli.show import make_chapter
from coadjoint.render.document import render_document

pytestmark = pytest.mark.campaign
LATEX = next(filter(None, map(shutil.which, ("pdflatex", "tectonic"))), None)
OPTIONS = ("-interaction=nonstopmode", "-halt-on-error")


def compile_latex(text, folder):
    """What a compiler says; it stops at the first error."""
    (folder / "document.tex").write_text(text)
    options = OPTIONS if LATEX.endswith("pdflatex") else ()
    command = [LATEX, *options, "document.tex"]
    return subprocess.run(command, cwd=folder, capture_output=True, timeout=300, check=False)


@pytest.mark.skipif(LATEX is None, reason="neither pdflatex nor tectonic is installed")
@pytest.mark.parametrize("system", shipped_names())
def test_latex_compiles(system, tmp_path):
    """The document of every system is a PDF, and one with a symbol of two subscripts is none."""
    text = render_document(make_chapter(system, None, "latex"), "latex")
    made = compile_latex(text, tmp_path)
    assert made.returncode == 0, made.stdout.decode(errors="replace")[-2000:]
    assert (tmp_path / "document.pdf").read_bytes().startswith(b"%PDF")
    spoiled = text.replace(r"\end{document}", r"$x_1_2$\end{document}")
    assert compile_latex(spoiled, tmp_path).returncode != 0


@pytest.mark.skipif(find_spec("typst") is None, reason="the package typst is not installed")
@pytest.mark.parametrize("system", shipped_names())
def test_typst_compiles(system):
    """The document of every system is a PDF, and one with an unknown name is none."""
    import typst

    text = render_document(make_chapter(system, None, "typst"), "typst")
    assert typst.compile(text.encode()).startswith(b"%PDF")
    if "image(" in text:  # a picture that is none is told
        with pytest.raises(typst.TypstError, match="failed to parse SVG"):
            typst.compile(text.replace("</svg>", "</sv>").encode())
    with pytest.raises(typst.TypstError, match="unknown variable"):
        typst.compile((text + "\n$ diff f $\n").encode())
