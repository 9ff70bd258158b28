"""Drift: any byte, any missing and any extra file of the generated tree is seen."""

import pytest

from coadjoint.render.compare import compare_tree

FRESH = {
    "__init__.py": "package\n",
    "manifest.json": "{}\n",
    "heavy_top/kernel.py": "a = 1\nb = 2\n",
    "heavy_top/kernel.c": "c\n",
}


@pytest.fixture
def folder(tmp_path):
    """A tree equal to the fresh one, with files beside it that no run writes."""
    (tmp_path / "heavy_top/__pycache__").mkdir(parents=True)
    for name, text in FRESH.items():
        (tmp_path / name).write_text(text)
    for name in (".lock", "heavy_top/__pycache__/kernel.pyc"):
        (tmp_path / name).write_text("")
    return tmp_path


def found(folder):
    """Differences as path and kind."""
    return [(each.path, each.kind) for each in compare_tree(FRESH, folder)]


def test_equal_trees_have_no_difference(folder):
    """The lock and bytecode do not count."""
    assert found(folder) == []


def test_a_missing_file_is_a_difference(folder):
    """A file that a fresh run would write is missed."""
    (folder / "heavy_top/kernel.c").unlink()
    assert found(folder) == [("heavy_top/kernel.c", "missing")]


def test_an_extra_file_is_a_difference(folder):
    """A file that a fresh run would not write is found, at any depth."""
    (folder / "top").mkdir()
    (folder / "top/kernel.py").write_text("")
    (folder / "heavy_top/__init__.py").write_text("")
    assert found(folder) == [("heavy_top/__init__.py", "extra"), ("top/kernel.py", "extra")]


@pytest.mark.parametrize("path", FRESH)
def test_any_changed_byte_is_a_difference(folder, path):
    """One byte more in any file is seen, and shown."""
    (folder / path).write_text(FRESH[path] + " ")
    (difference,) = compare_tree(FRESH, folder)
    assert (difference.path, difference.kind) == (path, "changed")
    assert f"fresh: {path}" in difference.diff
    assert "\n- " in difference.diff


def test_line_ends_are_bytes_too(folder):
    """A file converted to other line ends is changed."""
    (folder / "heavy_top/kernel.c").write_bytes(b"c\r\n")
    assert found(folder) == [("heavy_top/kernel.c", "changed")]


def test_a_link_in_place_of_a_file_is_a_difference(folder, tmp_path_factory):
    """A symlink to the same text is not the file."""
    other = tmp_path_factory.mktemp("other") / "kernel.c"
    other.write_text(FRESH["heavy_top/kernel.c"])
    (folder / "heavy_top/kernel.c").unlink()
    (folder / "heavy_top/kernel.c").symlink_to(other)
    assert found(folder) == [("heavy_top/kernel.c", "changed")]


def test_a_missing_tree_is_all_missing(tmp_path):
    """Comparing with a folder that does not exist lists every file."""
    assert {kind for _, kind in found(tmp_path / "nowhere")} == {"missing"}
