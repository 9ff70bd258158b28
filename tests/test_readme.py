"""README and docs are true: their Python runs, their commands work, their specs are proved."""

from __future__ import annotations

import re
import shlex
import subprocess
from pathlib import Path

import pytest
from click.testing import CliRunner

import coadjoint
from coadjoint.build.compiler import find_compiler
from coadjoint.cli import main
from coadjoint.cli.program import COMMANDS
from coadjoint.limits import EXAMINED_GENERATORS
from coadjoint.spec.core.shapes import FUNCTIONS
from coadjoint.spec.schema import SpecFile
from tests.conftest import FAMILIES, FIELDS, SYSTEMS

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = {path.stem: path.read_text(encoding="utf-8") for path in (ROOT / "docs").glob("*.md")}
GUIDES = {
    path.stem: path.read_text(encoding="utf-8")
    for path in sorted((ROOT / "docs" / "howto").glob("*.md"))
    if path.stem != "README"
}
SPECS, DRIVEN = PAGES["specs"], PAGES["driven"]


def blocks(language, page=README):
    """The fenced blocks of one language on a page, in order."""
    return re.findall(rf"^```{language}\n(.*?)^```", page, re.DOTALL | re.MULTILINE)


def commands():
    """The command lines of the README and of the tutorial, their comments dropped."""
    shown = blocks("sh") + blocks("sh", PAGES["tutorial"])
    lines = [line for block in shown for line in block.splitlines()]
    return [words for line in lines if (words := shlex.split(line, comments=True))]


@pytest.fixture
def folder(tmp_path, monkeypatch, shared_cache):
    """A working folder with the README's spec, and a cache of tests' own."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COADJOINT_CACHE", str(shared_cache))
    spec, *_ = blocks("toml")
    (tmp_path / "gyrostat.toml").write_text(spec, encoding="utf-8")
    return tmp_path


def test_python_of_the_readme_runs(folder):
    """The Python blocks run one after the other, as a reader would type them."""
    names = {}
    assert len(blocks("python")) == 3
    for block in blocks("python"):
        exec(compile(block, "README.md", "exec"), names)
    assert max(names["top"].drift.values()) < 1e-8
    assert names["motion"]["Pi2"].min() > 0.9


@pytest.mark.parametrize("guide", GUIDES)
def test_a_guide_does_what_it_says(guide, folder):
    """Its specs are files by the name that the text gives them, and its Python runs."""
    text, names = GUIDES[guide], {}
    for spec in blocks("toml", text):
        (name,) = set(re.findall(r"With this text in `(\w+\.toml)`", text))
        (folder / name).write_text(spec, encoding="utf-8")
    assert blocks("python", text)
    for block in blocks("python", text):
        exec(compile(block, f"{guide}.md", "exec"), names)


def test_the_guide_to_c_prints_what_python_prints(folder):
    """Its program is compiled with the options it names, and ends where the library does."""
    text = GUIDES["export"]
    (words,) = (shlex.split(line) for block in blocks("sh", text) for line in block.splitlines())
    assert CliRunner().invoke(main, words[1:]).exit_code == 0
    (program,) = blocks("c", text)
    (folder / "program.c").write_text(program, encoding="utf-8")
    options = re.search(r"`cc (.*?)`", text)[1]
    compiler = find_compiler().command
    subprocess.run([*compiler, *shlex.split(options), "-o", "program"], check=True)
    printed = subprocess.run([str(folder / "program")], check=True, capture_output=True, text=True)
    names = {}
    exec(compile(blocks("python", text)[0], "export.md", "exec"), names)
    assert [float(word) for word in printed.stdout.split()] == names["run"]["Pi"][:, -1].tolist()


def test_every_guide_is_listed():
    """The first page of the guides links each of them."""
    page = (ROOT / "docs" / "howto" / "README.md").read_text(encoding="utf-8")
    assert len(GUIDES) >= 5
    assert set(re.findall(r"\]\((\w+)\.md\)", page)) == set(GUIDES)


@pytest.mark.parametrize(
    "page", ["python", "simulation", "events", "algebras", "theory", "tutorial"]
)
def test_python_of_a_page_runs(page, folder):
    """The Python blocks of a page run one after the other, in the folder of the gyrostat."""
    names = {}
    assert blocks("python", PAGES[page])
    for block in blocks("python", PAGES[page]):
        exec(compile(block, f"{page}.md", "exec"), names)
    if page == "simulation":  # the belt carries the block until its spring pulls with f = 1/2
        held = names["held"]
        assert (held.status, names["freed"].status) == ("DOMAIN", "OK")
        carried = (0.5 - held["x"][0]) / 0.25
        assert held.time[-1] - held.time[0] == pytest.approx(carried, rel=1e-12)


def test_python_of_driven_systems_runs(folder):
    """The pendulum of docs/driven.md is proved, and its Python does what the text says."""
    (declared,) = blocks("toml", DRIVEN)
    (folder / "pendulum.toml").write_text(declared, encoding="utf-8")
    names = {"coadjoint": coadjoint}
    for block in blocks("python", DRIVEN):
        exec(compile(block, "driven.md", "exec"), names)
    assert names["slopes"].tolist() == [[0.0], [1.0]]
    assert names["by_parameters"].shape == (2, 5)
    assert [names[run].status for run in ("constant", "steps", "ramps", "waves")] == ["OK"] * 4
    assert names["steps"]["u"][750] == 1.0
    assert "energy" not in names["constant"].drift


def test_commands_of_the_readme_work(folder):
    """Every line of coadjoint ends with status 0; every target of make is there."""
    ran = 0
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for program, *words in commands():
        if program == "coadjoint":
            result = CliRunner().invoke(main, words)
            assert result.exit_code == 0, (words, result.stderr)
            ran += 1
        elif program == "make":
            assert all(f"\n{target}:" in makefile for target in words)
        else:
            assert [program, words[0]] == ["pip", "install"]
    assert ran >= 6
    assert (folder / "gyrostat.png").stat().st_size > 20_000


def test_the_example_of_a_spec_is_the_one_that_ships():
    """The README, the tutorial and `examples/gyrostat.toml` have one text."""
    spec, *_ = blocks("toml")
    (walked,) = blocks("toml", PAGES["tutorial"])
    assert walked == spec == (ROOT / "examples" / "gyrostat.toml").read_text(encoding="utf-8")


def test_what_a_command_prints_is_what_it_printed():
    """Each console block is a command with the output of today."""
    shown = [
        block.removeprefix("$ coadjoint ").split("\n", 1)
        for block in blocks("console", PAGES["algebras"])
    ]
    assert shown
    for command, output in shown:
        result = CliRunner().invoke(main, shlex.split(command))
        assert (result.exit_code, result.stdout) == (0, output), command


def test_specs_of_the_pages_are_proved(folder):
    """The shorter declarations are whole, and everything claimed of them holds."""
    pages = ("algebras", "nonholonomic")  # for those of specs.md see tests/spec/test_page.py
    others = [spec for page in pages for spec in blocks("toml", PAGES[page])]
    assert len(others) >= 3
    for number, spec in enumerate(others):
        path = folder / f"other{number}.toml"
        path.write_text(spec, encoding="utf-8")
        certificate = coadjoint.prove(coadjoint.read_spec(path))
        assert certificate.holds, str(certificate)


def test_the_bound_that_is_stated_is_the_bound():
    """The number of generators in the text is that of the limits."""
    assert f"more than {EXAMINED_GENERATORS}\ngenerators is refused" in PAGES["algebras"]


def test_every_decision_is_listed():
    """The page of decisions links each of them by its title."""
    folder = ROOT / "docs" / "decisions"
    listed = set(re.findall(r"- \[(.*)\]\((.*)\)", (folder / "README.md").read_text()))
    pages = [path for path in folder.glob("*.md") if path.name != "README.md"]
    titles = {(path.read_text().splitlines()[0].removeprefix("# "), path.name) for path in pages}
    assert len(pages) > 20
    assert listed == titles


def test_the_claim_that_is_said_to_fail_fails(folder):
    """`L*Pi[1]` is refuted, as the walk-through says."""
    assert '`"L*Pi[1]"`' in PAGES["tutorial"]
    spec = folder / "gyrostat.toml"
    spec.write_text(spec.read_text().replace('"L"]', '"L", "L*Pi[1]"]'))
    result = CliRunner().invoke(main, ["prove", str(spec)])
    assert result.exit_code == 1
    assert "L*Pi[1] is a Casimir" in result.stderr


def test_the_bracket_that_is_said_to_be_refused_is_refused(folder):
    """`[e1, e2] = e3 + e1` violates the Jacobi identity, and the message names the generators."""
    assert '`"[e1, e2]" = "e3 + e1"`' in PAGES["tutorial"]
    spec = folder / "gyrostat.toml"
    spec.write_text(spec.read_text().replace('"[e1, e2]" = "e3"', '"[e1, e2]" = "e3 + e1"'))
    with pytest.raises(coadjoint.CoadjointError, match=r"Jacobi identity: \[e1, \[e2, e3\]\]"):
        coadjoint.read_spec(spec)


def test_the_message_that_is_shown_is_the_one_that_comes(folder):
    """The mistake on the page of commands gives its message."""
    (message,) = blocks("text", PAGES["commands"])
    spec = folder / "gyrostat.toml"
    spec.write_text(
        spec.read_text().replace("dot(Omega, diag(I)*Omega)/2 +", "dot(Omega, diag(I)*Omga)/2 +")
    )
    result = CliRunner().invoke(main, ["prove", "gyrostat.toml"])
    assert result.exit_code == 2
    assert message.strip() in result.stderr


def test_tables_are_complete():
    """Every command, every function of expressions and every key of a spec is in a table."""
    for command in COMMANDS:
        assert f"| `coadjoint {command}" in PAGES["commands"]
    for function in FUNCTIONS:
        assert re.search(rf"`{function}\W", SPECS), function
    schema = SpecFile.model_json_schema()
    parts = [schema, *schema["$defs"].values()]
    keys = {key for part in parts for key in part.get("properties", {})}
    assert len(keys) > 25
    for key in keys:
        assert re.search(rf"[`\[. {{,]{key}\b", SPECS), key


def test_every_shipped_system_is_listed():
    """The table of systems names those that ship, and no others; the README counts them."""
    assert f"[{len((*SYSTEMS, *FAMILIES, *FIELDS))} of them](docs/systems.md)" in README
    lines = [
        line for line in PAGES["systems"].splitlines() if line.startswith("| ") and "_" in line
    ]
    named = {name for line in lines for name in re.findall(r"`([a-z0-9_]+)`", line)}
    assert named == {*SYSTEMS, *FAMILIES, *FIELDS}


def test_links_lead_somewhere():
    """Each relative link of README and docs names a file that is there."""
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    links = [
        (page, link)
        for page in pages
        for link in re.findall(r"\]\(([^)#]+)\)", page.read_text(encoding="utf-8"))
        if "://" not in link
    ]
    assert len(links) > 10
    for page, link in links:
        assert (page.parent / link).exists(), (page.name, link)
