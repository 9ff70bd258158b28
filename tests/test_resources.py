"""Folders that travel with the package are found beside the code that runs."""

from pathlib import Path

import coadjoint
from coadjoint import resources


def test_a_checkout_uses_its_own_folders():
    """Templates, specs and systems are those of the tree that this package was imported from."""
    package = Path(coadjoint.__file__).parent
    for found in (
        resources.templates_folder(),
        resources.derivations_folder(),
        resources.systems_folder(),
    ):
        assert found.is_dir()
        assert package in found.parents or package.parents[1] == found.parent


def test_an_installed_package_uses_the_folders_inside_it(tmp_path, monkeypatch):
    """Where the folders stand inside the package, as a wheel has them, those are taken."""
    (tmp_path / "templates").mkdir()
    monkeypatch.setattr(resources, "__file__", str(tmp_path / "resources.py"))
    assert resources.templates_folder() == tmp_path / "templates"
