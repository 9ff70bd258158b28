"""The theory stands apart: the engine never imports it, and its old place names the new one."""

import re
from importlib import import_module
from pathlib import Path

import pytest

import coadjoint
from coadjoint import theory

SOURCE = Path(coadjoint.__file__).parent
IMPORT = re.compile(r"^\s*(?:from|import) coadjoint\.theory", re.MULTILINE)


def importers(text_of=Path.read_text):
    """Modules outside of the theory that import it."""
    outside = (p for p in SOURCE.rglob("*.py") if p.parent != SOURCE / "theory")
    return [path.name for path in outside if IMPORT.search(text_of(path))]


def test_the_engine_does_not_import_the_theory():
    """No module outside of it does; the search sees one that would."""
    assert importers() == []
    spoiled = {"quaternions.py": "from coadjoint.theory import hat\n"}
    assert importers(lambda path: spoiled.get(path.name, "")) == ["quaternions.py"]


def test_public_names_are_there_and_their_old_place_says_so():
    """Each name that `coadjoint.groups` had leads to `coadjoint.theory`; others are unknown."""
    groups = import_module("coadjoint.groups")
    for name in theory.__all__:
        assert getattr(theory, name) is not None
        with pytest.raises(ImportError, match=f"import {name} from coadjoint.theory"):
            getattr(groups, name)
    with pytest.raises(AttributeError, match="no attribute 'matrix_groups'"):
        groups.matrix_groups  # noqa: B018 (it raises)
