"""`coadjoint completion` prints the script of a shell."""

from __future__ import annotations

import shutil
import subprocess

import pytest


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_script_of_each_shell(run, shell):
    """The script names the program and the variable by which it is asked."""
    result = run("completion", shell)
    assert result.exit_code == 0
    assert "_COADJOINT_COMPLETE" in result.stdout
    if shutil.which(shell):  # the shell itself has no complaint
        checked = subprocess.run(
            [shell, "-n"], input=result.stdout, text=True, capture_output=True, check=False
        )
        assert (checked.returncode, checked.stderr) == (0, "")
