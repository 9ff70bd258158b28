"""The main job: writes what passed, nothing of what did not, the same bytes everywhere."""

import fcntl
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from coadjoint.cli import main
from coadjoint.errors import ClaimError, DriftError, SpecError
from coadjoint.fingerprint import template_hashes
from coadjoint.regenerate import _guess_work, _Source, check, regenerate
from coadjoint.render.compare import is_intact
from coadjoint.render.families import FAMILY_FILES
from coadjoint.render.ownership import read_manifest
from coadjoint.render.write import SYSTEM_FILES
from tests.conftest import FAMILIES, FIELDS
from tests.prove.test_claims import check_claims
from tests.specs import RIGID_BODY
from tests.trees_of_files import ROOT, coadjoint, copy_source, environment, tree


@pytest.fixture(scope="session")
def made(shared_folder):
    """A source tree with one system, generated once for all processes and unchanged."""
    folder = shared_folder / "made"
    with (shared_folder / "made.lock").open("a+") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not lock.seek(0, os.SEEK_END):  # nobody has made it yet
            folder.mkdir()
            done = coadjoint(copy_source(folder, "rigid_body"), "regenerate")
            assert done.returncode == 0, done.stderr
            assert coadjoint(folder, "regenerate", "--check").returncode == 0
            lock.write("made")
    return folder


@pytest.fixture
def checkout(made, tmp_path):
    """A copy of it that a test may change."""
    shutil.copytree(made, tmp_path, dirs_exist_ok=True)
    return tmp_path


@pytest.fixture
def run(checkout, monkeypatch):
    """A command in this process, whose engine is that of the copy."""
    monkeypatch.chdir(checkout)
    monkeypatch.setenv("COADJOINT_CACHE", str(checkout / "cache"))

    def invoke(*words):
        result = CliRunner().invoke(main, words)
        assert result.exception is None or isinstance(result.exception, SystemExit)
        return result

    return invoke


@pytest.fixture
def cache(monkeypatch, shared_cache):
    """A cache of tests' own: of what is compiled, since each has a folder of its own."""
    monkeypatch.setenv("COADJOINT_CACHE", str(shared_cache))


def write_spec(folder, name, *changes):
    """A small spec in a folder."""
    text = RIGID_BODY
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / f"{name}.toml"
    path.write_text(text)
    return path


#: Where one addend is a product of so many factors that it carries more than the six roundings for
#: which k <= 4 holds: Kovalevskaya's integral of degree four, powers of the distance and of the
#: determinant in Jacobians. A k above the number of roundings, which is what the cross-check
#: allows, cannot be; these are the whole numbers above what was measured.
LONG = {
    "ellipsoidal_motion": 14,
    "heavy_top_kovalevskaya": 8,
    "monopole_kepler": 7,
    "n_particles": 5,
    "spd_motion": 5,
}


#: Systems whose kernels loop over members or points.
LOOPED = (*FAMILIES, *FIELDS)
#: Constraints, forces on a body, a field, equal members, of those that take little time. `.ci/run`
#: does the same for every system.
SAMPLE = ("chaplygin_sleigh", "heavy_top_damped", "sp2_strand", "toda_lattice")


def check_rows(specs, complete):
    """A fresh run gives the bytes of generated/; if not: `coadjoint regenerate`, then commit.

    Processes have random seeds for hashes, so the order of sets leaves no trace, and nor does what
    came before in a process.
    """
    outcome = check(specs, ROOT / "generated", jobs=2, complete=complete)
    assert len(outcome.rows) == len(specs) >= 4
    assert not outcome.failures
    for row in outcome.rows:
        assert row.proved == row.claims >= (6 if row.system in LOOPED else 7)
        # Against 50 digits, over every function, target and family of points.
        assert 0 < row.k <= LONG.get(row.system, 4), row
        assert row.targets == ("numpy", "c", "c-fast", "python")
    return {row.system for row in outcome.rows}


def test_a_sample_of_the_checked_in_tree_is_current():
    """Of each kind one; all systems as a campaign, and by `coadjoint regenerate --check`."""
    check_rows([ROOT / "derivations" / f"{name}.toml" for name in SAMPLE], complete=False)


@pytest.mark.campaign
def test_the_checked_in_tree_is_current():
    """Every system."""
    specs = sorted((ROOT / "derivations").glob("*.toml"))
    assert LONG.keys() <= check_rows(specs, complete=True)


def check_manifest(output, specs):
    """The hashes of specs, templates and files that a tree was written with are those of today."""
    manifest = read_manifest(output)
    assert manifest["templates"] == template_hashes(), "run `coadjoint regenerate`, and commit"
    hashes = {path.stem: hashlib.sha256(path.read_bytes()).hexdigest() for path in specs}
    written = {name: entry["spec_sha256"] for name, entry in manifest["systems"].items()}
    assert written == hashes, "run `coadjoint regenerate`, and commit"
    assert len(hashes) >= 89
    for name in hashes:
        assert is_intact(output, name), f"{name}: run `coadjoint regenerate`, and commit"


def test_the_checked_in_tree_was_written_from_these_specs_and_templates():
    """No spec, template or generated file has changed since the tree was written.

    What the engine makes of them today is asked by the test above.
    """
    check_manifest(ROOT / "generated", sorted((ROOT / "derivations").glob("*.toml")))


def test_the_manifest_check_sees_one_changed_byte(tmp_path):
    """The check above can fail: for a spec, and for a file that was written."""
    shutil.copytree(ROOT / "generated", tmp_path / "generated")
    specs = sorted((ROOT / "derivations").glob("*.toml"))
    kernel = tmp_path / "generated" / "heavy_top" / "kernel.c"
    kernel.write_text(kernel.read_text().replace("+", "-", 1))
    with pytest.raises(AssertionError, match=r"^heavy_top: run"):
        check_manifest(tmp_path / "generated", specs)
    changed = tmp_path / "heavy_top.toml"
    changed.write_text("# a remark")
    others = [path for path in specs if path.stem != "heavy_top"]
    with pytest.raises(AssertionError, match="regenerate"):
        check_manifest(ROOT / "generated", [*others, changed])


def test_every_claim_of_the_checked_in_tree_is_proved(system):
    """Every kind of claim that a system calls for; the test above makes the certificates afresh."""
    text = (ROOT / "generated" / system / "certificate.json").read_text(encoding="utf-8")
    claims = json.loads(text)["claims"]
    check_claims(system, [(each["kind"], each["statement"], each["verdict"]) for each in claims])


@pytest.mark.parametrize("name", FIELDS)
def test_every_claim_of_a_checked_in_field_is_proved(name):
    """Its bracket, its routes and what it keeps; no claim is supported by numbers alone."""
    text = (ROOT / "generated" / name / "certificate.json").read_text(encoding="utf-8")
    claims = json.loads(text)["claims"]
    assert {each["verdict"] for each in claims} == {"proved"}
    statements = " ".join(each["statement"] for each in claims)
    points = "N > 3 K points" if name == "euler_2d" else "is that of rings"
    for said in ("satisfies the Jacobi identity", "energy is conserved", points):
        assert said in statements, said


def test_an_unchanged_system_is_not_derived_again(tmp_path, cache):
    """The second run reads a stamp; a touched output, a changed spec and damage undo it."""
    path = write_spec(tmp_path, "body")
    output = tmp_path / "generated"
    (first,) = regenerate([path], output).rows
    before = tree(output)
    (second,) = regenerate([path], output).rows
    assert (first.fresh, second.fresh) == (True, False)
    kernel = output / "body" / "kernel.c"
    kernel.write_text(kernel.read_text() + "\n")
    (third,) = regenerate([path], output).rows
    assert third.fresh
    assert tree(output) == before
    path.write_text(path.read_text() + "# a remark\n")
    (fourth,) = regenerate([path], output).rows
    assert fourth.fresh


def test_a_false_claim_writes_nothing_and_shows_the_point(tmp_path, cache):
    """Beside it, a true system is written; the false one leaves what stood there."""
    true = write_spec(tmp_path, "true_body")
    false = write_spec(tmp_path, "false_body", ('"dot(Pi, Pi)"', '"dot(Pi, Pi) + Pi2"'))
    output = tmp_path / "generated"
    outcome = regenerate([true, false], output, jobs=2)
    assert [row.system for row in outcome.rows] == ["true_body"]
    error = outcome.failures["false_body"]
    assert isinstance(error, ClaimError)
    assert error.exit_status == 1
    assert "dot(Pi, Pi) + Pi2 is a Casimir. At " in str(error)
    assert "Pi1 = " in str(error) or "Pi3 = " in str(error)
    assert not (output / "false_body").exists()
    assert (output / "true_body" / "kernel.c").is_file()


def test_the_command_for_a_false_claim_exits_with_one(checkout, run):
    """The counterexample stands on standard error, the generated tree as it was."""
    before = tree(checkout / "generated")
    spec = checkout / "derivations" / "rigid_body.toml"
    spec.write_text(spec.read_text().replace('"dot(Pi, Pi)"', '"dot(Pi, Pi)", "Pi1"'))
    done = run("regenerate")
    assert done.exit_code == 1
    assert "Pi1 is a Casimir" in done.stderr
    assert tree(checkout / "generated") == before


@pytest.mark.parametrize(
    "victim",
    [
        "generated/rigid_body/kernel.c",
        "generated/manifest.json",
        "templates/c/kernel.c.j2",
        "derivations/rigid_body.toml",
        pytest.param("generated/rigid_body/kernel.py", marks=pytest.mark.campaign),
        pytest.param("generated/rigid_body/certificate.json", marks=pytest.mark.campaign),
        pytest.param("generated/__init__.py", marks=pytest.mark.campaign),
        pytest.param("templates/package/__init__.py.j2", marks=pytest.mark.campaign),
    ],
)
def test_check_notices_one_changed_byte(checkout, run, victim):
    """Generated files, templates and specs: even a change that alters no kernel."""
    path = checkout / victim
    comment = {".j2": "{# remark #}", ".toml": "# remark"}.get(path.suffix, " ")
    path.write_text(path.read_text() + comment)
    if victim.startswith("templates"):  # of this engine, which is not that of the copy any more
        done = coadjoint(checkout, "regenerate", "--check")
        assert done.returncode == 1
    else:
        done = run("regenerate", "--check")
        assert done.exit_code == 1
    assert "differ from a fresh run" in done.stderr


def test_check_notices_missing_and_extra_files(checkout, run):
    """Both are named; nothing is written by a check."""
    (checkout / "generated/rigid_body/kernel.h").unlink()
    (checkout / "generated/rigid_body/stray.c").write_text("int x;\n")
    before = tree(checkout / "generated")
    done = run("regenerate", "--check")
    assert done.exit_code == 1
    assert "rigid_body/kernel.h (missing)" in done.stderr
    assert "rigid_body/stray.c (extra)" in done.stderr
    assert tree(checkout / "generated") == before


def test_a_system_without_spec_is_removed(checkout, run):
    """A full run leaves the systems of the folder of specs; others go, the manifest with them."""
    (checkout / "derivations" / "rigid_body.toml").rename(checkout / "derivations" / "body.toml")
    assert run("regenerate", "--check").exit_code == 1
    assert run("regenerate").exit_code == 0
    assert not (checkout / "generated" / "rigid_body").exists()
    assert "rigid_body" not in (checkout / "generated" / "manifest.json").read_text()


def test_an_output_that_cannot_be_written_is_named_and_exits_with_two(run, tmp_path):
    """A file in place of the folder: a clear error, and the file is untouched."""
    (tmp_path / "plain").write_text("mine")
    done = run("regenerate", "--output", str(tmp_path / "plain"))
    assert done.exit_code == 2
    assert "plain" in done.stderr
    assert (tmp_path / "plain").read_text() == "mine"


def test_killed_runs_leave_whole_files_and_the_next_run_heals(checkout):
    """Kill -9 at several moments of a run that changes every file."""
    output = checkout / "generated"
    good = tree(output)
    command = [sys.executable, "-m", "coadjoint.cli", "regenerate"]
    spec = checkout / "derivations" / "rigid_body.toml"
    old = spec.read_text()
    spec.write_text(old.replace("default  = [1, 2, 3]", "default  = [2, 3, 4]"))
    for delay in (0.3, 1.0, 1.8, 2.4):
        with subprocess.Popen(
            command, cwd=checkout, env=environment(checkout), stdout=subprocess.DEVNULL
        ) as run:
            time.sleep(delay)
            run.send_signal(signal.SIGKILL)
        for name, content in tree(output).items():
            if not name.endswith(".tmp"):
                assert content.endswith(b"\n"), name
                assert len(content) >= len(good[name]) - 200, name
    spec.write_text(old)
    assert coadjoint(checkout, "regenerate").returncode == 0
    assert tree(output) == good


def test_two_runs_at_once_end_well(checkout):
    """The lock lets one write at a time; the tree is that of either."""
    expected = tree(checkout / "generated")
    for path in (checkout / "generated" / "rigid_body").iterdir():
        path.unlink()
    command = [sys.executable, "-m", "coadjoint.cli", "regenerate"]
    runs = [
        subprocess.Popen(
            command, cwd=checkout, env=environment(checkout), stdout=subprocess.DEVNULL
        )
        for _ in range(2)
    ]
    assert [run.wait() for run in runs] == [0, 0]
    assert tree(checkout / "generated") == expected


@pytest.mark.campaign
@pytest.mark.parametrize("seed", ["0", "1", "2"])
def test_the_same_bytes_for_every_hash_seed(seed, tmp_path):
    """Sets and dictionaries of strings iterate differently; the texts do not.

    Here all systems in one process; `test_the_checked_in_tree_is_current` has several, whose seeds
    are drawn at random.
    """
    script = (
        "import sys\n"
        "from pathlib import Path\n"
        "from coadjoint import pipeline\n"
        "from coadjoint.spec import read_spec\n"
        "for path in map(Path, sys.argv[1:]):\n"
        "    for name, text in pipeline.render(read_spec(path)).texts.items():\n"
        "        sys.stdout.write(f'{path.stem}/{name}\\n{text}')\n"
    )
    specs = sorted((ROOT / "derivations").glob("*.toml"))
    done = subprocess.run(
        [sys.executable, "-c", script, *map(str, specs)],
        cwd=tmp_path,
        env={**os.environ, "PYTHONHASHSEED": seed},
        capture_output=True,
        text=True,
        check=True,
    )
    expected = "".join(
        f"{spec.stem}/{name}\n" + (ROOT / "generated" / spec.stem / name).read_text()
        for spec in specs
        for name in ((*FAMILY_FILES, "certificate.json") if spec.stem in LOOPED else SYSTEM_FILES)
    )
    assert done.stdout == expected


def test_the_same_bytes_from_two_working_directories(checkout, tmp_path):
    """Neither the folder of the run nor that of the output leaves a trace."""
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    done = subprocess.run(
        [
            sys.executable, "-m", "coadjoint.cli", "regenerate",
            "--derivations", str(checkout / "derivations"), "--output", str(elsewhere / "out"),
        ],
        cwd=elsewhere,
        env=environment(checkout),
        capture_output=True,
        text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert tree(elsewhere / "out") == tree(checkout / "generated")
    assert str(tmp_path).encode() not in b"".join(tree(elsewhere / "out").values())


def test_the_longest_work_comes_first(tmp_path):
    """Systems are worked on by the length of their kernels; one that has none yet is the first."""
    for name, length in (("short", 10), ("long", 99)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "kernel.c").write_text("x" * length)
    names = ("short", "new", "long")
    sources = [_Source(Path(f"{name}.toml"), "") for name in names]
    ordered = sorted(sources, key=lambda each: _guess_work(each, tmp_path))
    assert [each.name for each in ordered] == ["new", "long", "short"]


def test_two_specs_of_one_name_are_refused(tmp_path, cache):
    """The name is shown."""
    (tmp_path / "other").mkdir()
    paths = [write_spec(tmp_path, "body"), write_spec(tmp_path / "other", "body")]
    with pytest.raises(SpecError, match="two specs are called 'body'"):
        regenerate(paths, tmp_path / "generated")


def test_check_says_what_to_do(tmp_path, cache):
    """The error has the command and the differences as records."""
    path = write_spec(tmp_path, "body")
    regenerate([path], tmp_path / "generated")
    Path(tmp_path / "generated" / "body" / "kernel.h").write_text("")
    with pytest.raises(DriftError, match="coadjoint regenerate") as caught:
        check([path], tmp_path / "generated")
    assert [each["path"] for each in caught.value.differences] == ["body/kernel.h"]
