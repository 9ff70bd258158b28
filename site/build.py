"""Build the site: lay out docs, a page for each system and the reference; then run Sphinx.

    python site/build.py [--systems heavy_top,kepler] [--output build/site]       (or `make site`)

What a page of a system shows is what commands of coadjoint print; its picture is that of its
document. It is made once for each state of the engine and of the spec, and kept in build/site-made.
Any warning is an error: a link without an end, an anchor that is not there, an example that fails.
"""

from __future__ import annotations

import base64
import html
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import click
from click.testing import CliRunner

import coadjoint
import coadjoint.cli
from coadjoint.cli.arguments import shipped_names, spec_path
from coadjoint.fingerprint import digest, engine_fingerprint
from coadjoint.render.prose import set_text
from coadjoint.resources import templates_folder
from coadjoint.spec import read_spec

ROOT = Path(__file__).resolve().parents[1]
MADE = ROOT / "build" / "site-made"
SOURCE = ROOT / "build" / "site-source"

#: The style of equations in documents, which has nothing to fill in.
FORMULAS = templates_folder() / "document" / "formulas.css.j2"

#: What is made of each system: the file, the command that writes it, and how else it may end: 2,
#: where there is no such page of it.
PARTS = {
    "document.html": (["show", "{name}", "--format", "html", "--output", "{path}"], 0),
    "explorer.html": (["explore", "{name}", "--output", "{path}"], 2),
}


@dataclass(frozen=True)
class Made:
    """What was made of a system.

    Attributes:
        name: Of the system.
        title: Of its spec.
        about: What its spec says of it.
        source: Where it comes from.
        routes: That derive it.
        folder: Where the parts are.
        has_explorer: Whether there is one of it.
        caption: What its picture shows: HTML.
        equations: Of its motion, as its document shows them: titles with HTML.
    """

    name: str
    title: str
    about: str
    source: str
    routes: Sequence[str]
    folder: Path
    has_explorer: bool
    caption: str
    equations: Mapping[str, str]


def make_parts(name: str) -> Made:
    """Run the commands of a system, unless nothing has changed since."""
    path = spec_path(name)
    spec = read_spec(path)
    key = digest({"engine": engine_fingerprint(), "spec": path.read_text(encoding="utf-8")})
    folder = MADE / name / key[:16]
    if not (folder / "done").is_file():
        shutil.rmtree(MADE / name, ignore_errors=True)
        folder.mkdir(parents=True)
        for part, (words, other) in PARTS.items():
            given = [word.format(name=name, path=folder / part) for word in words]
            run = CliRunner().invoke(coadjoint.cli.main, given, catch_exceptions=False)
            if run.exit_code not in (0, other):
                raise click.ClickException(f"{' '.join(given)}: {run.stderr}")
            if run.exit_code:
                (folder / f"{part}.txt").write_text(run.stderr, encoding="utf-8")
        picture = find_picture((folder / "document.html").read_text(encoding="utf-8"))
        (folder / "picture.png").write_bytes(picture)
        (folder / "done").touch()
    about = " ".join(spec.description.split())
    document = (folder / "document.html").read_text(encoding="utf-8")
    return Made(
        name=name,
        title=spec.title,
        about=about,
        source=spec.source,
        routes=spec.routes,
        folder=folder,
        has_explorer=(folder / "explorer.html").is_file(),
        caption=find_caption(document),
        equations=find_equations(document),
    )


def find_picture(document: str) -> bytes:
    """The picture of a document."""
    data = re.search(r'<figure><img src="data:image/png;base64,([^"]*)"', document)
    assert data, "without matplotlib a document has no picture"
    return base64.b64decode(data[1])


def find_caption(document: str) -> str:
    """What stands below the picture of a document: HTML."""
    return "".join(re.findall(r"<figcaption>(.*?)</figcaption>", document, re.DOTALL)[:1])


def find_equations(document: str) -> dict[str, str]:
    """What a document shows of the motion, by titles: HTML without empty lines, which end it."""
    found = re.findall(
        r'<section class="(?:motion|members)[^"]*">\n<h2>(.*?)</h2>\n(.*?)</section>',
        document,
        re.DOTALL,
    )
    return {
        html.unescape(title): "\n".join(line for line in body.splitlines() if line.strip())
        for title, body in found
    }


def make_all(names: Sequence[str]) -> Iterator[Made]:
    """The same of many systems, as many at a time as there are processors, with progress."""
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        made = pool.map(make_parts, names)
        with click.progressbar(made, length=len(names), label="systems", file=sys.stderr) as shown:
            yield from shown


def make_book(names: Sequence[str]) -> Path:
    """All systems in one document, where the site has all of them."""
    key = digest({"engine": engine_fingerprint(), "systems": list(names)})
    book = MADE / f"book-{key[:16]}.html"
    if not book.is_file():
        for old in MADE.glob("book-*.html"):
            old.unlink()
        MADE.mkdir(parents=True, exist_ok=True)
        click.echo("book", err=True)
        words = [sys.executable, "-P", "-m", "coadjoint.cli", "book", "--output", str(book)]
        subprocess.run(words, check=True)
    return book


# -- pages ----------------------------------------------------------------------------------


def write_system(made: Made) -> str:
    """The page of a system."""
    lines = [f"# {made.title}", ""]
    if made.about:
        lines += [f"<p>{set_text(made.about)}</p>", ""]
    lines += [f"![A motion of {made.title}](../_static/pictures/{made.name}.png)", ""]
    lines += [f'<p class="caption">{made.caption}</p>', ""]
    links = [f'<a href="../documents/{made.name}.html">Derivation and proofs</a>']
    if made.has_explorer:
        links.append(f'<a href="../explorers/{made.name}.html">Explorer</a>')
    lines += ["<p>" + " &middot; ".join(links) + "</p>", ""]
    for title, body in made.equations.items():
        lines += [f"## {title}", "", '<div class="formulas">', body, "</div>", ""]
    lines += [
        "## Declaration",
        "",
        f"Source: {made.source}. Routes: {', '.join(f'`{each}`' for each in made.routes)}.",
        "",
        "```python",
        f"from coadjoint.systems import {made.name}",
        "```",
        "",
        "```toml",
        spec_path(made.name).read_text(encoding="utf-8").strip(),
        "```",
        "",
    ]
    return "\n".join(lines)


def list_groups(names: Iterable[str]) -> list[tuple[str, list[str]]]:
    """Groups of docs/systems.md, with the systems among some names."""
    chosen, groups = set(names), []
    for line in (ROOT / "docs" / "systems.md").read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("| ") and len(cells) == 2 and "`" in cells[1]:
            own = [each.strip(" `") for each in cells[1].split(",")]
            if found := [each for each in own if each in chosen]:
                groups.append((cells[0], found))
    return groups


def write_index(systems: Sequence[Made], *, has_book: bool = False) -> str:
    """The gallery: a picture of each system that leads to its page."""
    known = {made.name: made for made in systems}
    lines = ["# Systems", "", "Each picture leads to its declaration, derivation and explorer.", ""]
    if has_book:
        lines += ['<p><a href="../book.html">All of them in one document</a></p>', ""]
    for title, names in list_groups(known):
        lines += [f"## {title[0].upper()}{title[1:]}", "", '<div class="systems">']
        for name in names:
            image = f'<img src="../_static/pictures/{name}.png" alt="" loading="lazy">'
            label = html.escape(known[name].title)
            lines.append(f'<a href="{name}.html">{image}<span>{label}</span></a>')
        lines += ["</div>", ""]
    listed = "\n".join(sorted(known))
    lines += ["```{toctree}", ":hidden:", "", listed, "```", ""]
    return "\n".join(lines)


def write_reference() -> str:
    """The page of the public names."""
    lines = ["# Python", "", "The public names of `coadjoint`, with their signatures.", ""]
    for name in coadjoint.__all__:
        value = getattr(coadjoint, name)
        kind = "autoclass" if isinstance(value, type) else "autofunction"
        lines += ["```{eval-rst}", f".. {kind}:: coadjoint.{name}", "```", ""]
    lines += ["## Solutions", "", "```{eval-rst}"]
    lines += [".. autoclass:: coadjoint.solve.solution.Solution", "```", ""]
    return "\n".join(lines)


def lay_out(systems: Sequence[Made], book: Path | None = None) -> None:
    """The sources of Sphinx: the repository's own pages where they are, and those made here."""
    shutil.rmtree(SOURCE, ignore_errors=True)
    leave_out = shutil.ignore_patterns("*.in.md", "make.py", "__pycache__")
    shutil.copytree(ROOT / "docs", SOURCE / "docs", ignore=leave_out)
    shutil.copytree(ROOT / "examples", SOURCE / "examples", ignore=leave_out)
    specs = SOURCE / "docs" / "specs.md"
    specs.write_text(_below_one_title(specs.read_text(encoding="utf-8")), encoding="utf-8")
    drawn = {made.name for made in systems}
    for path in (SOURCE / "examples").glob("*.py"):
        script = _with_title(path.read_text(encoding="utf-8"))
        path.write_text(script + _choose_thumbnail(script, drawn), encoding="utf-8")
    for folder in ("docs/howto", "docs/decisions"):  # what their first pages list as tables
        with (SOURCE / folder / "README.md").open("a", encoding="utf-8") as page:
            page.write("\n```{toctree}\n:hidden:\n:glob:\n\n*\n```\n")
    for name in ("README.md", "CHANGELOG.md", "LICENSE", "CITATION.cff"):
        shutil.copy(ROOT / name, SOURCE / name)
    for name in ("index.md", "conf.py"):
        shutil.copy(ROOT / "site" / name, SOURCE / name)
    shutil.copy(ROOT / "site" / "examples.rst", SOURCE / "examples" / "GALLERY_HEADER.rst")
    (SOURCE / "_static" / "pictures").mkdir(parents=True)
    shutil.copy(ROOT / "site" / "site.css", SOURCE / "_static" / "site.css")
    shutil.copy(FORMULAS, SOURCE / "_static" / "formulas.css")
    for folder in ("_made/documents", "_made/explorers", "systems", "reference"):
        (SOURCE / folder).mkdir(parents=True)
    for made in systems:
        for part, place in (
            ("picture.png", f"_static/pictures/{made.name}.png"),
            ("document.html", f"_made/documents/{made.name}.html"),
            ("explorer.html", f"_made/explorers/{made.name}.html"),
        ):
            if (made.folder / part).is_file():
                shutil.copy(made.folder / part, SOURCE / place)
        _write(f"systems/{made.name}.md", write_system(made))
    if book is not None:
        shutil.copy(book, SOURCE / "_made" / "book.html")
    _write("systems/index.md", write_index(systems, has_book=book is not None))
    _write("reference/api.md", write_reference())


def _below_one_title(page: str) -> str:
    """A page of several parts as parts of the first: a contents then lists it once."""
    first, rest = page.split("\n## ", 1)
    parts = re.split(r"(^```.*?^```)", f"\n## {rest}", flags=re.DOTALL | re.MULTILINE)
    parts[::2] = [re.sub(r"^#", "##", part, flags=re.MULTILINE) for part in parts[::2]]
    return first + "".join(parts)


def _with_title(script: str) -> str:
    """A script whose first line is the title of its page in the gallery."""
    prose, code = script.removeprefix('"""').split('"""', 1)
    first, rest = prose.replace("|", r"\|").split("\n", 1)
    return f'r"""{first.rstrip(".")}\n{"=" * len(first)}\n{rest}"""{code}'


def _choose_thumbnail(script: str, drawn: Collection[str]) -> str:
    """The comment that names the picture of an example: that of the first system it imports."""
    found = re.search(r"^from coadjoint\.systems import (\w+)", script, re.MULTILINE)
    own = found[1] if found and found[1] in drawn else ""
    place = f"_static/pictures/{own}.png" if own else "docs/pictures/gyrostat.png"
    return f"\n# sphinx_gallery_thumbnail_path = '{place}'\n"


def _write(name: str, text: str) -> None:
    (SOURCE / name).write_text(text, encoding="utf-8")


@click.command()
@click.option("--systems", default="", help="Some systems, with commas; all without it.")
@click.option("--output", type=click.Path(path_type=Path), default=ROOT / "build" / "site")
def main(systems: str, output: Path) -> None:
    """Build the site."""
    names = systems.split(",") if systems else list(shipped_names())
    lay_out(list(make_all(names)), None if systems else make_book(names))
    words = ["-m", "sphinx", "--fail-on-warning", "--keep-going", "-q", "-j", "auto"]
    run = subprocess.run([sys.executable, *words, str(SOURCE), str(output)], check=False)
    if run.returncode:
        raise click.ClickException("the site has warnings, which are errors: see above")
    click.echo(f"open {output / 'index.html'}")


if __name__ == "__main__":
    main()
