"""`coadjoint doctor` tells what works, what is missing, and what is broken."""

from __future__ import annotations

import json
from importlib.metadata import PackageNotFoundError

from coadjoint.cli import doctor


def findings(run):
    """Findings by what was looked at, and the exit status."""
    result = run("doctor", "--json")
    return {entry["what"]: entry for entry in json.loads(result.stdout)}, result.exit_code


def test_everything_works_here(run):
    """Compiler, C kernels, cache and packages are found on a machine that runs these tests."""
    found, status = findings(run)
    assert status == 0
    for what in ("python", "sympy", "numpy", "compiler", "C kernels", "cache"):
        assert found[what]["status"] == "ok", found[what]
    assert "-ffp-contract=off" in found["compiler"]["found"]
    assert "compiled, loaded and called" in run("doctor").stdout


def test_a_missing_compiler_is_a_remark(run, monkeypatch):
    """Without a compiler the status stays 0, and the remark says how to get one."""
    monkeypatch.setenv("PATH", "/nonexistent")
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr("coadjoint.build.compiler.find_spec", lambda name: None)
    found, status = findings(run)
    assert status == 0
    assert found["compiler"]["status"] == "missing"
    assert "pip install 'coadjoint[c]'" in found["compiler"]["found"]


def test_a_broken_compiler_is_a_failure(run, monkeypatch):
    """A CC that is no compiler is named, with status 1."""
    monkeypatch.setenv("CC", "no-such-compiler")
    found, status = findings(run)
    assert status == 1
    assert found["compiler"]["status"] == "failed"
    assert "no-such-compiler" in found["compiler"]["found"]


def test_a_compiler_that_lies_is_a_failure(run, monkeypatch):
    """A kernel that answers wrongly is noticed."""
    monkeypatch.setattr(doctor, "PROBE", doctor.PROBE.replace("42", "41"))
    found, status = findings(run)
    assert status == 1
    assert "answered 41" in found["C kernels"]["found"]


def test_a_cache_that_others_may_write_is_a_failure(run, folder, monkeypatch):
    """A cache open to others is refused with its path."""
    folder.chmod(0o777)
    monkeypatch.setenv("COADJOINT_CACHE", str(folder))
    found, status = findings(run)
    assert status == 1
    assert str(folder) in found["cache"]["found"]


def test_a_missing_extra_names_its_command(run, monkeypatch):
    """An extra that is not installed is a remark with the pip command."""

    def version(package):
        raise PackageNotFoundError(package)

    monkeypatch.setattr(doctor, "EXTRAS", {"data": ("surely_not_installed",)})
    found, status = findings(run)
    assert status == 0
    assert found["extra data"]["remedy"] == "pip install 'coadjoint[data]'"
    assert "surely_not_installed" in found["extra data"]["found"]
    monkeypatch.setattr(doctor, "version", version)
    found, status = findings(run)
    assert (status, found["numpy"]["remedy"]) == (1, "pip install numpy")
