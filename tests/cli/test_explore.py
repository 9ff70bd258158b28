"""`coadjoint explore` writes a page, or says why there is none."""

from __future__ import annotations

import re

from coadjoint.resources import derivations_folder


def test_a_page_is_written_whole(run, folder, rigid_body):
    """To a file that is named, or to one of the system's name; a file that stands there goes."""
    place = folder / "page.html"
    place.write_text("before")
    result = run("explore", rigid_body, "--output", place)
    assert (result.exit_code, result.stdout) == (0, ""), result.stderr
    assert f"{place}: open it in a browser." in result.stderr
    assert place.read_text().startswith("<!DOCTYPE html>")
    assert run("explore", rigid_body).exit_code == 0
    assert (folder / "body.html").read_text() == place.read_text()
    assert sorted(path.name for path in folder.iterdir()) == ["body.html", "body.toml", "page.html"]


def test_what_cannot_be_shown_is_told(run, folder):
    """Exit status 2: the reason with a command that works, a neighbour, a place."""
    refused = run("explore", "toda_lattice", "--size", "i=5000", "--output", "toda.html")
    assert refused.exit_code == 2
    assert "10000 rows of its state are too many; expected at most 4096" in refused.stderr
    advice = refused.stderr.partition("Simulate it: coadjoint ")[2].split(" says how")[0]
    assert run(*advice.split()).exit_code == 0
    assert not (folder / "toda.html").exists()
    assert run("explore", "toda_lattice", "--size", "i=5", "--output", "five.html").exit_code == 0
    assert '"members": 5' in (folder / "five.html").read_text()
    unknown = run("explore", "heavy_tip")
    assert (unknown.exit_code, "Did you mean 'heavy_top'" in unknown.stderr) == (2, True)
    missing = run("explore", "rigid_body", "--output", "missing/body.html")
    assert missing.exit_code == 2
    assert "missing/body.html: cannot be written" in missing.stderr


def test_advice_of_a_spec_of_ones_own_names_its_path(run, folder):
    """The command that a message gives runs from where the person stands."""
    path, text = (
        folder / "my_lattice.toml",
        (derivations_folder() / "toda_lattice.toml").read_text(),
    )
    path.write_text(re.sub(r"size = \d+", "size = 5000", text))
    refused = run("explore", path)
    assert refused.exit_code == 2
    assert f"coadjoint simulate {path}" in refused.stderr
