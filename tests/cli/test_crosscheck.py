"""`coadjoint crosscheck` holds the generated files themselves against 50 digits and each other."""

from __future__ import annotations

import json
import shutil

from coadjoint.build.compiler import find_compiler
from coadjoint.resources import systems_folder


def test_figures_of_a_shipped_system(run):
    """All rungs pass, k stays below 4, and NumPy, C and Python have the same bits everywhere."""
    find_compiler()
    record = json.loads(run("crosscheck", "rigid_body", "--points", "1001", "--json").stdout)
    assert record["rungs"] == {"3": "passed", "4": "passed", "5": "passed"}
    assert set(record["figures"]) == {
        *("rhs", "jacobian", "parameter_jacobian", "energy", "observables", "poisson_tensor"),
        *("energy_gradient", "bracket_vector"),
    }
    assert set(record["figures"]["rhs"]) == {"numpy", "c", "c-fast", "python"}
    assert 0 < max(figures["k"] for figures in record["figures"]["rhs"].values()) <= 4
    assert min(equal["c"] for equal in record["equal"].values()) >= 1001
    assert min(equal["python"] for equal in record["equal"].values()) > 100


def test_the_table_names_functions_targets_and_rungs(run):
    """The table has a line for each function and target."""
    result = run("crosscheck", "rigid_body", "--points", "17")
    assert result.exit_code == 0, result.stderr
    assert result.stdout.count("c-fast") == 9  # eight functions, and the Taylor method
    assert "rung 5: passed" in result.stdout
    assert result.stdout.count("same bits at") == 16  # C and Python, each with NumPy


def test_figures_of_fields(run):
    """Kernels of many points are compared for some numbers of these."""
    result = run("crosscheck", "hunter_saxton", "--json")
    assert result.exit_code == 0, result.stderr
    report = json.loads(result.stdout)
    assert set(report["figures"]) == {"rhs", "jacobian_vector", "energy", "observables"}
    assert report["equal"]["rhs"]["c"] > 100


def test_a_spoiled_kernel_is_caught(run, folder, monkeypatch):
    """A sign turned in a copy of the generated kernel ends with status 1 and names the function."""
    shutil.copytree(systems_folder(), folder / "generated")
    kernel = folder / "generated" / "rigid_body" / "kernel.py"
    lines = kernel.read_text().splitlines()
    (place,) = [n for n, line in enumerate(lines) if line.endswith("# dPi1/dt")]
    lines[place] = lines[place].replace(" = ", " = -", 1)
    kernel.write_text("\n".join(lines) + "\n")
    monkeypatch.setattr("coadjoint.cli.arguments.systems_folder", lambda: folder / "generated")
    result = run("crosscheck", "rigid_body", "--points", "17")
    assert result.exit_code == 1
    assert "rhs" in result.stderr
    assert result.stdout == ""


def test_a_kernel_that_is_missing_is_named(run, folder, monkeypatch):
    """A folder without the kernel of one target is refused, with the command that writes it."""
    shutil.copytree(systems_folder() / "rigid_body", folder / "generated" / "rigid_body")
    (folder / "generated" / "rigid_body" / "kernel_python.py").unlink(missing_ok=True)
    monkeypatch.setattr("coadjoint.cli.arguments.systems_folder", lambda: folder / "generated")
    result = run("crosscheck", "rigid_body", "--points", "17")
    assert result.exit_code != 0
    assert "kernel_python.py cannot be read" in result.stderr
    assert "coadjoint regenerate" in result.stderr
