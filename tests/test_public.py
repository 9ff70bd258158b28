"""The public names: what the README promises works, lazily, under its documented name."""

import doctest
import importlib
import pkgutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import coadjoint
from coadjoint.errors import (
    ClaimError,
    CoadjointError,
    DerivationError,
    ResourceError,
    SpecError,
    from_record,
)
from coadjoint.resources import derivations_folder
from tests.specs import RIGID_BODY

BODY = derivations_folder() / "rigid_body.toml"


@pytest.fixture
def own(tmp_path, monkeypatch, shared_cache):
    """A spec in a folder of its own, so that the cache has nothing that was derived from it."""
    monkeypatch.setenv("COADJOINT_CACHE", str(shared_cache))
    path = tmp_path / "my_body.toml"
    path.write_text(RIGID_BODY)
    return path


def test_public_names_are_there_and_documented():
    """Every name of __all__ can be had, and has a docstring."""
    for name in coadjoint.__all__:
        assert getattr(coadjoint, name).__doc__, name
    assert set(coadjoint.__all__) <= set(dir(coadjoint))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = coadjoint.nothing


def test_derive_and_prove_are_functions_whatever_was_imported_before():
    """Importing the submodules of the same name does not hide the functions."""
    script = (
        "import coadjoint, sys\n"
        "spec = coadjoint.read_spec(sys.argv[1])\n"
        "for _ in range(2):\n"
        "    assert coadjoint.prove(spec).holds\n"
        "    assert coadjoint.derive(spec, route='lie-poisson').route == 'lie-poisson'\n"
        "    import coadjoint.derive, coadjoint.prove\n"
        "from coadjoint import derive, prove\n"
        "assert derive(spec).rates and prove(spec).claims\n"
    )
    subprocess.run([sys.executable, "-c", script, str(BODY)], check=True)


def test_load_gives_the_same_kind_of_object_as_a_shipped_system(own):
    """Functions, names, simulation; every stage of making it is told, by system."""
    told = []
    mine = coadjoint.load(own, progress=lambda *step: told.append(step))
    assert [step[1] for step in told][:2] == ["derive", "lower"]
    assert {step[0] for step in told} == {"my_body"}
    shipped = importlib.import_module("coadjoint.systems.rigid_body")
    state = np.array([[0.1, 1.0], [0.2, 2.0], [0.3, 3.0]])
    assert isinstance(mine, coadjoint.System)
    for function in ("rhs", "jacobian", "energy", "poisson_tensor"):
        expected = getattr(shipped, function)(state)
        assert np.array_equal(getattr(mine, function)(state), expected)
    assert mine.simulate([0.1, 0.2, 0.3], (0, 1)).drift["energy"] < 1e-9
    assert mine.title == "Free rigid body"


def test_loading_again_needs_no_sympy(own, capsys, monkeypatch):
    """An unchanged spec comes from the cache; a changed one is derived anew.

    Stages stand on one line of a terminal, which is empty at the end; a pipe is told nothing.
    """
    script = (
        "import sys, coadjoint\nprint(coadjoint.load(sys.argv[1]).id, 'sympy' in sys.modules)\n"
    )

    def run():
        found = subprocess.run(
            [sys.executable, "-c", script, str(own)], capture_output=True, text=True, check=True
        )
        assert found.stderr == ""
        return found.stdout.split()

    first, second = run(), run()
    assert first == second
    assert second[1] == "False"
    own.write_text(own.read_text().replace("[1, 2, 3]", "[2, 3, 4]"))
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    assert coadjoint.load(own).id != first[0]
    told = capsys.readouterr()
    assert told.out == ""
    assert "\n" not in told.err
    *stages, empty, end = told.err.split("\r")[1:]
    assert stages
    assert all(each.startswith("my_body: ") for each in stages)
    assert max(map(len, stages)) <= len(empty)
    assert (empty.strip(), end) == ("", "")


def test_one_setting_raises_the_limit_of_time(own, monkeypatch):
    """The environment bounds a derivation, the message says how to raise it, an argument does."""
    monkeypatch.setenv("COADJOINT_SECONDS", "1")
    large = derivations_folder() / "heavy_top.toml"  # takes several seconds
    own.write_text(large.read_text())
    with pytest.raises(ResourceError, match=r"my_body\.toml: stopped .*1 s of processor") as caught:
        coadjoint.load(own)
    assert "COADJOINT_SECONDS" in str(caught.value)
    assert coadjoint.load(own, seconds=300).title == "Heavy top"


@pytest.mark.parametrize(
    ("old", "new", "kind", "message"),
    [
        ("Omega, diag", "Omgea, diag", SpecError, "'Omgea'"),
        ('["dot(Pi, Pi)"]', '["Pi1"]', ClaimError, "Pi1 is a Casimir"),
        ("dot(Omega, diag(I)*Omega)", "Omega1^2 + Omega2^2", DerivationError, "Omega3"),
    ],
)
def test_loading_raises_what_is_wrong(own, old, new, kind, message):
    """The error of the step, from the child as from here."""
    own.write_text(RIGID_BODY.replace(old, new))
    with pytest.raises(kind, match=message):
        coadjoint.load(own)


def test_errors_survive_as_records():
    """Class, message and parts."""
    error = ClaimError("false", system="body")
    again = from_record(error.as_record())
    assert type(again) is ClaimError
    assert (str(again), again.parts, again.system) == ("false", {"system": "body"}, "body")
    assert type(from_record({"kind": "Unknown", "message": "?", "parts": {}})) is CoadjointError
    with pytest.raises(AttributeError):
        _ = error.missing


def modules():
    """Every module of the package, found by walking it."""
    found = pkgutil.walk_packages(coadjoint.__path__, "coadjoint.")
    return [info.name for info in found if not info.name.endswith("__main__")]


def test_every_doctest_runs():
    """Examples in docstrings are true; they are found by walking the package."""
    attempted = 0
    for name in modules():
        module = importlib.import_module(name)
        if ">>>" not in Path(module.__file__).read_text(encoding="utf-8"):
            continue  # a search for examples takes longer than most of them
        result = doctest.testmod(module)
        assert result.failed == 0, name
        attempted += result.attempted
    assert attempted >= 20


def test_every_module_says_what_it_is():
    """A docstring in each, and the walk reaches every folder."""
    names = modules()
    assert len(names) > 50
    for name in names:
        assert importlib.import_module(name).__doc__, name
