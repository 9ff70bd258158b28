"""`coadjoint doctor` tells what works, what is missing, and what is broken."""

from __future__ import annotations

import json
import re
import resource
import shutil
from importlib.metadata import PackageNotFoundError

import pytest

from coadjoint.cli import doctor


def findings(run):
    """Findings by what was looked at, and the exit status."""
    result = run("doctor", "--json")
    return {entry["what"]: entry for entry in json.loads(result.stdout)}, result.exit_code


def test_everything_works_here(run):
    """Compiler, C kernels, cache and packages are found on a machine that runs these tests."""
    found, status = findings(run)
    assert status == 0
    working = ("limits", "temporary files", "bounded children", "generated")
    for what in ("python", "sympy", "numpy", "compiler", "C kernels", "cache", *working):
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
    assert "returned 41" in found["C kernels"]["found"]


def test_a_cache_that_others_may_write_is_a_failure(run, folder, monkeypatch):
    """A cache open to others is refused with its path."""
    folder.chmod(0o777)
    monkeypatch.setenv("COADJOINT_CACHE", str(folder))
    found, status = findings(run)
    assert status == 1
    assert "other users may write to it (mode 777)" in found["cache"]["found"]
    assert list(doctor._cache_state()) == []  # nothing promises that it heals


def test_a_setting_that_is_none_is_a_failure(monkeypatch):
    """The number of seconds in the environment is looked at."""
    monkeypatch.setenv("COADJOINT_SECONDS", "soon")
    finding = doctor._attempt("limits", doctor._limits)
    assert finding.status == "failed"
    assert "COADJOINT_SECONDS is 'soon'" in finding.found


def test_a_low_limit_of_the_session_is_a_failure(monkeypatch):
    """A limit of file sizes is named with the command that raises it."""
    real = resource.getrlimit

    def getrlimit(kind):
        return (1000, 1000) if kind == resource.RLIMIT_FSIZE else real(kind)

    monkeypatch.setattr(doctor.resource, "getrlimit", getrlimit)
    finding = doctor._attempt("limits", doctor._limits)
    assert finding.status == "failed"
    assert "(ulimit -f) allows 1000 bytes" in finding.found


def test_a_disk_without_space_is_a_failure(tmp_path, monkeypatch):
    """Too little that is free, and a folder that cannot be written, are named."""
    full = shutil.disk_usage(tmp_path)._replace(free=2**20)
    monkeypatch.setattr(doctor.shutil, "disk_usage", lambda _: full)
    finding = doctor._attempt("temporary files", lambda: doctor._room(tmp_path))
    assert (finding.status, "1 MiB left" in finding.found) == ("failed", True)
    finding = doctor._attempt("temporary files", lambda: doctor._room(tmp_path / "missing"))
    assert (finding.status, str(tmp_path / "missing") in finding.found) == ("failed", True)


def test_no_home_is_a_finding(monkeypatch):
    """Without a home folder and a setting, there is no place for the cache."""

    def home():
        raise RuntimeError("Could not determine home directory.")

    for name in ("COADJOINT_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("coadjoint.build.cache.Path.home", home)
    finding = doctor._attempt("cache", doctor._cache)
    assert (finding.status, "no home folder is set" in finding.found) == ("failed", True)
    assert list(doctor._cache_state()) == []


def test_damage_in_the_cache_heals(tmp_path, monkeypatch):
    """Damaged objects, and systems of one's own that a killed run left, are remarks."""
    monkeypatch.setenv("COADJOINT_CACHE", str(tmp_path))
    (tmp_path / "kernels").mkdir()
    (tmp_path / "kernels" / f"{'0' * 64}.so").write_text("damaged")
    (tmp_path / "systems" / f"{123:016x}").mkdir(parents=True)
    tmp_path.chmod(0o700)
    found = list(doctor._cache_state())
    assert {finding.status for finding in found} == {"heals"}
    assert any("is damaged" in finding.found for finding in found)
    assert any("manifest.json is missing" in finding.found for finding in found)


def test_damage_of_the_project_at_hand_is_a_failure(folder):
    """The generated folder beside ./derivations is looked at."""
    (folder / "derivations").mkdir()
    (finding,) = doctor._tree_state()
    assert (finding.status, finding.found) == ("failed", "generated is not there")


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


@pytest.mark.parametrize("columns", [40, 60, 100])
def test_the_report_is_as_wide_as_the_terminal(columns, capsys, monkeypatch):
    """Long paths and remedies go on below, and nothing of them is lost."""
    path = "/" + "/".join(f"folder{k}" for k in range(12))
    findings = [
        doctor.Finding("compiler", "failed", f"cc in {path}", "install one: apt-get install gcc"),
        doctor.Finding("cache", "ok", path),
    ]
    monkeypatch.setattr(doctor, "examine", lambda: iter(findings))
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", str(columns))
    assert doctor.command.callback(as_json=False) == 1
    printed = capsys.readouterr().out
    assert max(map(len, printed.splitlines())) <= columns
    letters = re.sub(r"[^\w/]", "", printed)
    for each in findings:
        for word in (each.what, each.status, *each.remedy.split()):
            assert re.sub(r"[^\w/]", "", word) in letters
    assert letters.count("folder11") >= 1
