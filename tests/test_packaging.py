"""The wheel: built, installed in an empty environment, used from another directory."""

import shutil
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path
from zipfile import ZipFile

import pytest

from tests.trees_of_files import ROOT

PARTS = (
    "src",
    "templates",
    "derivations",
    "generated",
    "setup.py",
    "pyproject.toml",
    "README.md",
    "LICENSE",
)


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """A wheel built from a copy of the tree."""
    folder = tmp_path_factory.mktemp("source")
    for name in PARTS:
        if (ROOT / name).is_dir():
            ignore = shutil.ignore_patterns("__pycache__", "*.egg-info", ".lock")
            shutil.copytree(ROOT / name, folder / name, ignore=ignore)
        else:
            shutil.copy(ROOT / name, folder)
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps"]
    command += ["--no-build-isolation", "--wheel-dir", str(folder / "dist"), str(folder)]
    subprocess.run(command, check=True, capture_output=True)
    (built,) = (folder / "dist").glob("*.whl")
    return built


def environment(folder):
    """An empty environment; its python."""
    venv.create(folder)
    return folder / "bin" / "python"


def install(python, *arguments, cwd):
    """Install by this environment's pip into another one, which needs none of its own."""
    pip = ("-m", "pip", "--python", str(python), "install", "--quiet", "--no-compile")
    run(sys.executable, *pip, *arguments, cwd=cwd)


def run(python, *arguments, cwd):
    """A command in an environment, isolated from this one."""
    done = subprocess.run(
        [str(python), *arguments], cwd=cwd, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


USE = (
    "import sys, coadjoint\n"
    "from coadjoint.systems import heavy_top\n"
    "assert sys.prefix in coadjoint.__file__, coadjoint.__file__\n"
    "assert sys.prefix in heavy_top.__file__, heavy_top.__file__\n"
    "print(heavy_top.rhs([1, 2, 3, 0, 0, 1.0]).tolist())\n"
    "assert coadjoint.prove(coadjoint.read_spec(sys.argv[1])).holds\n"
)


def test_the_wheel_carries_specs_templates_and_systems(wheel):
    """Every file that the tree has, under the package."""
    names = set(ZipFile(wheel).namelist())
    for folder, inside in (
        ("templates", "coadjoint/templates"),
        ("derivations", "coadjoint/derivations"),
        ("generated", "coadjoint/systems"),
        ("src/coadjoint/render/targets", "coadjoint/render/targets"),
    ):
        files = [
            path.relative_to(ROOT / folder).as_posix()
            for path in (ROOT / folder).rglob("*")
            if path.is_file() and path.name != ".lock" and "__pycache__" not in path.parts
        ]
        assert len(files) >= 5
        assert {f"{inside}/{name}" for name in files} <= names
    assert "coadjoint/py.typed" in names


def test_the_wheel_works_from_another_directory(wheel, tmp_path):
    """Import, evaluate, prove, and check the shipped systems; dependencies are borrowed."""
    python = environment(tmp_path / "env")
    install(python, "--no-deps", str(wheel), cwd=tmp_path)
    # The dependencies of this environment, without the hooks of its editable installs.
    site = next(Path(tmp_path / "env" / "lib").glob("python*/site-packages"))
    (site / "borrowed.pth").write_text(sysconfig.get_paths()["purelib"] + "\n")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    spec = ROOT / "derivations" / "rigid_body.toml"
    assert "[-1.0, 2.0, -1.0" in run(python, "-c", USE, str(spec), cwd=elsewhere)
    command = tmp_path / "env" / "bin" / "coadjoint"
    assert "heavy_top" in run(command, "list", cwd=elsewhere)
    run(command, "regenerate", "rigid_body", "--check", cwd=elsewhere)
    assert not list(elsewhere.iterdir())


@pytest.mark.campaign
def test_the_wheel_works_in_an_empty_environment(wheel, tmp_path):
    """The same with its own dependencies, fetched from the package index."""
    python = environment(tmp_path / "env")
    install(python, str(wheel), cwd=tmp_path)
    spec = ROOT / "derivations" / "rigid_body.toml"
    assert "[-1.0, 2.0, -1.0" in run(python, "-c", USE, str(spec), cwd=tmp_path)
