"""Another target: a folder of code, one of templates and a line, in a copy of the source tree."""

import re
import shutil
import subprocess
import sys

import pytest

from tests.kernels import COMPILER
from tests.specs import RIGID_BODY
from tests.trees_of_files import ROOT

#: What turns the folder of plain Python into that of a language of its own.
RENAMED = (
    (r"kernel_python", "kernel_mirror"),
    (r"targets\.python\b", "targets.mirror"),
    (r'"python/', '"mirror/'),
    (r'{"python":', '{"mirror":'),
    (r'\("python",\)', '("mirror",)'),
    (r"plain_assignment", "mirror_assignment"),
)
SCRIPT = """
import sys
from pathlib import Path
import coadjoint
from coadjoint import pipeline
from coadjoint.render.write import SYSTEM_FILES
from coadjoint.solve.folders import load_texts
from coadjoint.spec import read_spec
from coadjoint.spec.core.names import refusal

assert coadjoint.__file__.startswith(sys.argv[1]), coadjoint.__file__
rendered = pipeline.render(read_spec(Path(sys.argv[2])))
assert "kernel_mirror.py" in rendered.texts and "kernel_mirror.py" in SYSTEM_FILES
report = pipeline.verify(rendered)
print(report.passed, *report.targets, min(each["mirror"] for each in report.equal.values()) > 100)
with load_texts(rendered.texts) as system:
    print(system.rhs([1.0, 2.0, 3.0], [1.0, 2.0, 4.0], target="mirror").tolist())
    print('"mirror"' in system.rhs.__doc__)
print(refusal("mirrored")[0])
"""


@pytest.mark.skipif(not COMPILER, reason="no C compiler on this machine")
def test_two_folders_and_a_line_make_a_target(tmp_path):
    """It is rendered, read back, loaded, cross-checked and called, and its words are reserved."""
    source = tmp_path / "src"
    shutil.copytree(ROOT / "src", source, ignore=shutil.ignore_patterns("*.egg-info"))
    shutil.copytree(ROOT / "templates", tmp_path / "templates")
    targets = source / "coadjoint" / "render" / "targets"
    for folder in (targets, tmp_path / "templates"):
        bytecode = shutil.ignore_patterns("__pycache__")
        shutil.copytree(folder / "python", folder / "mirror", ignore=bytecode)
        for path in (folder / "mirror").iterdir():
            text = path.read_text()
            for old, new in RENAMED:
                text = re.sub(old, new, text)
            path.unlink()
            (path.parent / path.name.replace("python", "mirror")).write_text(text)
    (targets / "mirror" / "reserved.txt").write_text("# a word of mirrors\nmirrored\n")
    registry = targets / "__init__.py"
    line = 'FOLDERS: Final = ("numpy", "c", "python")'
    assert line in registry.read_text()
    registry.write_text(registry.read_text().replace(line, line[:-1] + ', "mirror")'))
    spec = tmp_path / "sample.toml"
    spec.write_text(RIGID_BODY)
    done = subprocess.run(
        [sys.executable, "-P", "-c", SCRIPT, str(source), str(spec)],
        env={"PYTHONPATH": str(source), "PATH": "/usr/bin:/bin", "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    # dPi1/dt = (1/I3 - 1/I2) Pi2 Pi3 and cyclic
    assert done.stdout.splitlines() == [
        "True numpy c c-fast python mirror True",
        "[-1.5, 2.25, -1.0]",
        "True",
        "'mirrored' is a word of mirrors",
    ]
