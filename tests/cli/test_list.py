"""`coadjoint list` tells the state of each system from its files, and runs none of them."""

from __future__ import annotations

import json
import shutil

import pytest

from coadjoint.resources import derivations_folder, systems_folder


@pytest.fixture
def copied(folder):
    """The shipped specs and generated files, to be spoiled."""
    shutil.copytree(derivations_folder(), folder / "derivations")
    shutil.copytree(systems_folder(), folder / "generated")
    return folder


def states(run):
    """State of each system in the list."""
    result = run("list", "--json")
    assert result.exit_code == 0, result.stderr
    return {entry["system"]: entry["state"] for entry in json.loads(result.stdout)}


def test_the_list_has_every_shipped_system(run):
    """Dimension, routes and claims of the heavy top stand in its line."""
    result = run("list")
    assert result.exit_code == 0
    (line,) = [line for line in result.stdout.splitlines() if "heavy_top " in line]
    assert " 6 " in line
    assert "euler-poincare, lie-poisson" in line
    assert line.rstrip().endswith("verified")
    assert "Heavy top" in line
    count = len(list(derivations_folder().glob("*.toml")))
    assert len(json.loads(run("list", "--json").stdout)) == count > 2


def test_the_list_sees_what_was_spoiled(copied, run):
    """A changed spec, a changed file, a missing folder and a broken spec are told apart."""
    assert set(states(run).values()) == {"verified"}
    spec = copied / "derivations" / "heavy_top.toml"
    spec.write_text(spec.read_text() + "# another byte\n")
    kernel = copied / "generated" / "kirchhoff" / "kernel.c"
    kernel.write_text(kernel.read_text() + "\n")
    (copied / "derivations" / "rigid_body.toml").write_text("title = ")
    (copied / "derivations" / "newcomer.toml").write_text(
        (copied / "derivations" / "kirchhoff.toml").read_text()
    )
    assert {name: state for name, state in states(run).items() if state != "verified"} == {
        "heavy_top": "spec changed",
        "kirchhoff": "files changed",
        "newcomer": "not generated",
        "rigid_body": "spec unreadable",
    }


def test_generated_code_is_not_run(copied, run):
    """Code planted in a generated package of the working folder stays unexecuted."""
    package = copied / "generated" / "heavy_top" / "__init__.py"
    package.write_text(f"open({str(copied / 'owned')!r}, 'w')\n" + package.read_text())
    assert states(run)["heavy_top"] == "files changed"
    assert not (copied / "owned").exists()
