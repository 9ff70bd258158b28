"""`coadjoint export` writes one step of a method as a header, or says why there is none."""

from __future__ import annotations


def test_a_header_is_written_whole_or_printed(run, folder, rigid_body):
    """To a file, which is replaced and leaves no other; to standard output without --output."""
    place = folder / "body.h"
    place.write_text("before")
    result = run("export", rigid_body, "--output", place)
    assert (result.exit_code, result.stdout) == (0, ""), result.stderr
    assert "static inline int body_spherical_midpoint_step(" in place.read_text()
    assert sorted(path.name for path in folder.iterdir()) == ["body.h", "body.toml"]
    printed = run("export", rigid_body, "--method", "rk4", "--format", "c").stdout
    assert "#ifndef BODY_RK4_H" in printed
    assert "--method rk4 --format c` from body.toml." in printed


def test_a_header_names_the_file_it_was_made_from(run, folder, rigid_body):
    """Its name, wherever it lies; of a folder derivations this, too."""
    text = rigid_body.read_text()
    for place, named in (("derivations", "derivations/body.toml"), ("own", "body.toml")):
        (folder / place).mkdir()
        (folder / place / "body.toml").write_text(text)
        for given in (f"{place}/body.toml", folder / place / "body.toml"):
            printed = run("export", given, "--method", "rk4").stdout
            assert f"--format c` from {named}.\n" in printed


def test_what_cannot_be_exported_is_told(run, folder, rigid_body):
    """Exit status 2: a method with the reason, a system by its neighbour, a place, a format."""
    place = folder / "body.h"
    place.write_text("before")
    refused = run("export", rigid_body, "--method", "isospectral_midpoint", "--output", place)
    assert refused.exit_code == 2
    assert "it expects a motion that is the bracket" in refused.stderr
    assert "Expected one of rk4, dop853, midpoint" in refused.stderr
    assert place.read_text() == "before"
    unknown = run("export", "heavy_tip")
    assert (unknown.exit_code, "Did you mean 'heavy_top'" in unknown.stderr) == (2, True)
    missing = run("export", rigid_body, "--output", "missing/body.h")
    assert missing.exit_code == 2
    assert "missing/body.h: cannot be written" in missing.stderr
    other = run("export", rigid_body, "--format", "rust")
    assert (other.exit_code, "'rust' is not 'c'" in other.stderr) == (2, True)
