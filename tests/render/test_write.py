"""Writing: each file is old or new, whatever fails and whenever a run is killed."""

import errno
import fcntl
import json
import os
import re
import resource
import signal
from collections import Counter
from pathlib import Path

import pytest

from coadjoint.errors import OutputError
from coadjoint.render import write
from coadjoint.render.compare import compare_tree, is_intact
from coadjoint.render.write import (
    LOCK,
    MANIFEST,
    MARK,
    TEMPORARY,
    GeneratedSystem,
    lock,
    manifest_text,
    read_manifest,
    tree_texts,
    write_systems,
)

IDS = {"old": "0123456789abcdef", "new": "fedcba9876543210"}
CALLS = ("open", "write", "fsync", "replace", "unlink")


def systems(version, names=("heavy_top", "rigid_body")):
    """Two systems of two files each, all of whose bytes tell the version."""
    return {
        name: GeneratedSystem(
            {
                "kernel.py": f"{MARK.decode()} {name} {version}\n" * 50
                + f'ID = "{IDS[version]}"\n',
                "kernel.c": f"/* {name} {version} */\n" * 50,
            },
            spec_sha256="0",
            route="euler-poincare",
        )
        for name in names
    }


def tree(version):
    """What `write_systems` must leave of a version, text by path."""
    made = systems(version)
    entries = {name: system.record() for name, system in made.items()}
    return tree_texts(made, manifest_text(entries, {"c": version}))


def put(folder, version, **options):
    """Write a version."""
    write_systems(folder, systems(version), {"c": version}, **options)


def on_disk(folder):
    """Text by path, the lock file apart."""
    return {
        path.relative_to(folder).as_posix(): path.read_text()
        for path in folder.rglob("*")
        if path.is_file() and path.name != LOCK
    }


@pytest.fixture
def folder(tmp_path):
    """A tree with version "old" in it."""
    put(tmp_path, "old")
    return tmp_path


def test_what_is_written_is_what_was_given(folder):
    """Files, folders and manifest are the given ones and nothing else."""
    assert on_disk(folder) == tree("old")
    assert compare_tree(tree("old"), folder) == []
    put(folder, "new")
    assert on_disk(folder) == tree("new")


def test_manifest_is_sorted_and_free_of_time_and_place(folder):
    """The manifest is the same text for the same tree, whatever the order of the systems."""
    text = (folder / MANIFEST).read_text()
    content = json.loads(text)
    assert text == json.dumps(content, indent=2, sort_keys=True) + "\n"
    assert content["schema"] == 1
    assert sorted(content["systems"]["heavy_top"]) == [
        "files",
        "id",
        "route",
        "spec_sha256",
    ]
    turned = dict(reversed(systems("old").items()))
    write_systems(folder, turned, {"c": "old"})
    assert (folder / MANIFEST).read_text() == text
    assert str(folder) not in text


def test_other_systems_stay_in_a_partial_run(folder):
    """Writing one system leaves the other and its entry in the manifest alone."""
    write_systems(folder, systems("new", ["heavy_top"]), {"c": "new"})
    assert is_intact(folder, "heavy_top")
    assert is_intact(folder, "rigid_body")
    assert "old" in (folder / "rigid_body/kernel.py").read_text()
    entries = read_manifest(folder)["systems"]
    assert [entries[name]["id"] for name in ("heavy_top", "rigid_body")] == [IDS["new"], IDS["old"]]


def with_file(version, file):
    """The heavy top with one more file."""
    made = systems(version, ["heavy_top"])["heavy_top"]
    texts = {**made.texts, file: "! more\n"}
    return {"heavy_top": GeneratedSystem(texts, made.spec_sha256, made.route)}


def test_stale_outputs_are_removed(folder):
    """Files that only the old manifest lists go, and in a complete run systems that are gone."""
    write_systems(folder, with_file("new", "kernel.f90"), {"c": "new"})
    (folder / "rigid_body/__pycache__").mkdir()
    (folder / "rigid_body/__pycache__/kernel.cpython-312.pyc").write_text("bytecode")
    (folder / "mine").mkdir()
    (folder / "mine/notes.txt").write_text("not generated")
    assert (folder / "heavy_top/kernel.f90").exists()
    write_systems(folder, systems("new", ["heavy_top"]), {"c": "new"}, keep=["heavy_top"])
    assert not (folder / "heavy_top/kernel.f90").exists()
    assert not (folder / "rigid_body").exists()
    assert (folder / "mine/notes.txt").read_text() == "not generated"
    assert list(read_manifest(folder)["systems"]) == ["heavy_top"]


def everything(folder):
    """Every path below a folder with its bytes, the lock apart."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() if path.is_file() else None
        for path in folder.rglob("*")
        if path.name != LOCK
    }


FOREIGN = {
    "a file in a system's folder": "heavy_top/notes.txt",
    "a folder in a system's folder": "heavy_top/mine/notes.txt",
    "a folder in the place of a file": "heavy_top/kernel.h/notes.txt",
    "a file in a system that is to go": "rigid_body/notes.txt",
    "bytecode of others in a system that is to go": "rigid_body/__pycache__/mine.cpython-312.pyc",
}


@pytest.mark.parametrize("path", FOREIGN.values(), ids=FOREIGN.keys())
def test_what_no_run_wrote_is_refused_by_name_before_the_first_write(folder, path):
    """The path is named, and not a byte of the tree has changed."""
    (folder / path).parent.mkdir(exist_ok=True)
    (folder / path).write_text("somebody's")
    before = everything(folder)
    made = with_file("new", "kernel.h")
    named = "heavy_top/mine" if "mine/" in path else path
    with pytest.raises(OutputError, match=re.escape(named)) as caught:
        write_systems(folder, made, {"c": "new"}, keep=["heavy_top"])
    assert caught.value.found == [named]
    assert everything(folder) == before


def test_a_system_that_is_to_go_and_is_a_link_stays(folder, tmp_path_factory):
    """The files behind the link are neither followed nor removed."""
    elsewhere = tmp_path_factory.mktemp("elsewhere") / "rigid_body"
    (folder / "rigid_body").rename(elsewhere)
    (folder / "rigid_body").symlink_to(elsewhere)
    with pytest.raises(OutputError, match="rigid_body"):
        write_systems(folder, systems("new", ["heavy_top"]), {"c": "new"}, keep=["heavy_top"])
    assert "old" in (elsewhere / "kernel.c").read_text()


@pytest.mark.parametrize(
    "path", ["__init__.py", "manifest.json", "heavy_top/__init__.py", "heavy_top/kernel.py"]
)
def test_a_folder_of_somebody_is_refused(tmp_path, path):
    """A package, a manifest of another program, a folder that has the name of a system."""
    (tmp_path / path).parent.mkdir(exist_ok=True)
    (tmp_path / path).write_text('{"name": "somebody\'s"}')
    with pytest.raises(OutputError, match=re.escape(path)):
        put(tmp_path, "new")
    assert on_disk(tmp_path) == {path: '{"name": "somebody\'s"}'}


def test_files_beside_the_systems_stay(tmp_path):
    """What is not in the way is left alone: a tree may be written into a folder of one's own."""
    (tmp_path / "README.txt").write_text("mine")
    put(tmp_path, "new")
    assert on_disk(tmp_path) == tree("new") | {"README.txt": "mine"}


@pytest.mark.parametrize("name", ["../victim", "..", "/tmp/victim", "a/b"])
@pytest.mark.parametrize("where", ["system", "file"])
def test_a_manifest_that_leads_elsewhere_is_none(folder, where, name):
    """A hostile manifest lists files of others: it counts as damaged, and nothing of them goes."""
    victim = folder.parent / "victim"
    victim.write_text("precious")
    manifest = json.loads((folder / MANIFEST).read_text())
    entry = manifest["systems"].pop("rigid_body")
    if where == "file":
        entry["files"][name] = "0"
    manifest["systems"]["rigid_body" if where == "file" else name] = entry
    (folder / MANIFEST).write_text(json.dumps(manifest))
    assert read_manifest(folder)["systems"] == {}
    write_systems(folder, systems("new", ["heavy_top"]), {"c": "new"}, keep=["heavy_top"])
    assert victim.read_text() == "precious"
    assert list(read_manifest(folder)["systems"]) == ["heavy_top"]


def test_a_run_that_was_killed_before_its_first_manifest_is_healed(tmp_path):
    """A folder that no manifest lists is ours if its kernel says so."""
    put(tmp_path, "old")
    (tmp_path / MANIFEST).unlink()
    (tmp_path / "__init__.py").unlink()
    put(tmp_path, "new")
    assert on_disk(tmp_path) == tree("new")


def test_removing_is_safe_against_a_kill(folder):
    """A stale file goes before the manifest that no longer lists it comes."""
    write_systems(folder, with_file("old", "kernel.f90"), {"c": "old"})

    def act():
        real = os.replace

        def replace(source, target, **options):
            if target == MANIFEST:
                os.kill(os.getpid(), signal.SIGKILL)
            real(source, target, **options)

        os.replace = replace
        put(folder, "new")

    assert in_child(act) == -signal.SIGKILL
    put(folder, "new")
    assert on_disk(folder) == tree("new")


def test_the_folder_of_an_installed_package_is_refused(tmp_path):
    """Site-packages and the package itself belong to the installer."""
    inside = tmp_path / "lib" / "site-packages" / "thing"
    for place in (inside, Path(write.__file__).parents[1] / "systems"):
        with pytest.raises(OutputError, match="installed package"):
            put(place, "new")
        assert not place.exists()


def test_leftovers_of_killed_runs_are_removed(folder):
    """Temporary files of another process disappear in the next run."""
    for place in (folder, folder / "heavy_top"):
        (place / ".coadjoint-0123456789abcdef.tmp").write_text("torn")
    put(folder, "new")
    assert on_disk(folder) == tree("new")


DEEP = "[" * 100_000
HOSTILE = [
    "",
    "{",
    "[]",
    "null",
    DEEP,
    '{"a":' * 100_000,
    "\xff",
    '{"schema": 99}',
    '{"schema": 1}',
    '{"schema": 1, "systems": [], "templates": {}}',
    '{"schema": 1, "systems": {}, "templates": 3}',
    '{"schema": 1, "systems": {"heavy_top": 3}, "templates": {}}',
    '{"schema": 1, "systems": {"heavy_top": {"files": null}}, "templates": {}}',
    '{"schema": 1, "systems": {"heavy_top": {"files": {"kernel.py": 3}, "id": "", "route": "",'
    ' "spec_sha256": ""}}, "templates": {}}',
]


@pytest.mark.parametrize("damage", HOSTILE, ids=range(len(HOSTILE)))
def test_a_damaged_manifest_counts_as_none(folder, damage):
    """A manifest that cannot be read is never trusted, and the next run writes it anew."""
    (folder / MANIFEST).write_text(damage, encoding="latin-1")
    assert read_manifest(folder)["systems"] == {}
    assert not is_intact(folder, "heavy_top")
    put(folder, "new")
    assert on_disk(folder) == tree("new")


@pytest.mark.parametrize("path", [MANIFEST, "heavy_top/kernel.py", "heavy_top/kernel.c"])
@pytest.mark.parametrize("kind", ["pipe", "folder", "link"])
def test_what_is_no_file_in_the_place_of_one_is_replaced(folder, path, kind):
    """A pipe is never waited for, an empty folder makes room, a link is not followed."""
    place = folder / path
    place.unlink()
    if kind == "pipe":
        os.mkfifo(place)
    elif kind == "folder":
        place.mkdir()
    else:
        place.symlink_to("/dev/zero")
    assert not is_intact(folder, "heavy_top")
    assert path in {each.path for each in compare_tree(tree("old"), folder)}
    put(folder, "new")
    assert on_disk(folder) == tree("new")


def test_intact_means_the_very_bytes(folder):
    """A changed byte, a missing file and an extra file are each noticed."""
    assert is_intact(folder, "heavy_top")
    assert not is_intact(folder, "no_such_system")
    kernel = folder / "heavy_top/kernel.c"
    text = kernel.read_text()
    kernel.write_text(text + " ")
    assert not is_intact(folder, "heavy_top")
    kernel.write_text(text)
    (folder / "heavy_top/extra.py").write_text("")
    assert not is_intact(folder, "heavy_top")
    (folder / "heavy_top/extra.py").unlink()
    kernel.unlink()
    assert not is_intact(folder, "heavy_top")


def test_a_symlink_at_an_output_is_replaced_and_not_followed(folder, tmp_path_factory):
    """The file that a planted link points to keeps its bytes."""
    victim = tmp_path_factory.mktemp("elsewhere") / "victim"
    victim.write_text("precious")
    (folder / "heavy_top/kernel.c").unlink()
    (folder / "heavy_top/kernel.c").symlink_to(victim)
    (folder / MANIFEST).unlink()
    (folder / MANIFEST).symlink_to(victim)
    put(folder, "new")
    assert victim.read_text() == "precious"
    assert not (folder / "heavy_top/kernel.c").is_symlink()
    assert on_disk(folder) == tree("new")


def test_a_symlink_at_a_folder_is_refused(folder, tmp_path_factory):
    """A system's folder that is a link leads nowhere."""
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    for name in ("heavy_top", "rigid_body"):
        (folder / name).rename(elsewhere / name)
        (folder / name).symlink_to(elsewhere / name)
    with pytest.raises(OutputError, match="heavy_top"):
        put(folder, "new")
    assert "old" in (elsewhere / "heavy_top/kernel.c").read_text()


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_read_only_folder_is_named(folder):
    """A folder without write permission is an error that names it; old files stay."""
    (folder / "heavy_top").chmod(0o500)
    with pytest.raises(OutputError, match="heavy_top"):
        put(folder, "new")
    (folder / "heavy_top").chmod(0o700)
    assert on_disk(folder) == tree("old")


class Spoiler:
    """Stands in for calls of the operating system; the chosen one does something else."""

    def __init__(self, monkeypatch, at, act):
        self.count, self.at, self.act = 0, at, act
        self.seen = Counter()
        for name in CALLS:
            monkeypatch.setattr(write.os, name, self.watched(name, getattr(os, name)))

    def watched(self, name, real):
        """A stand-in for one call."""

        def call(*args, **options):
            self.count += 1
            self.seen[name] += 1
            if self.count == self.at:
                self.act(name)
            return real(*args, **options)

        return call


def calls_of_a_run(folder):
    """How many calls a run makes, so that each can fail in turn."""
    with pytest.MonkeyPatch.context() as patch:
        spoiler = Spoiler(patch, at=0, act=lambda name: None)
        put(folder, "old")
    assert min(spoiler.seen[name] for name in ("open", "write", "fsync", "replace")) > 0
    return spoiler.count


def check_whole(folder):
    """Every file is all old or all new, and no temporary file is called a result."""
    found = {
        name: text
        for name, text in on_disk(folder).items()
        if not TEMPORARY.fullmatch(Path(name).name)
    }
    old, new = tree("old"), tree("new")
    assert found.keys() == old.keys()
    for name, text in found.items():
        assert text in (old[name], new[name]), name
    return found


@pytest.mark.parametrize("code", ["ENOSPC", "EROFS", "EACCES", "EIO"])
def test_any_call_may_fail(folder, code):
    """Whichever call fails: the error names a path, files are whole, the next run heals."""
    for at in range(1, calls_of_a_run(folder) + 1):
        put(folder, "old")

        def fail(name):
            raise OSError(getattr(errno, code), os.strerror(getattr(errno, code)))

        with pytest.MonkeyPatch.context() as patch:
            spoiler = Spoiler(patch, at, fail)
            with pytest.raises(OutputError, match=re.escape(str(folder))) as caught:
                put(folder, "new")
        assert os.strerror(getattr(errno, code)) in str(caught.value)
        assert caught.value.path.startswith(str(folder))
        found = check_whole(folder)
        assert not any(TEMPORARY.fullmatch(path.name) for path in folder.rglob("*"))
        if not spoiler.seen["replace"]:
            assert found == tree("old")
    put(folder, "new")
    assert on_disk(folder) == tree("new")


def test_a_folder_that_cannot_be_made_is_named(tmp_path):
    """A file where the generated folder should be is an error that names it."""
    (tmp_path / "generated").write_text("a file")
    with pytest.raises(OutputError, match="generated") as caught:
        put(tmp_path / "generated", "new")
    assert "File exists" in str(caught.value)


def in_child(act):
    """Run ``act`` in a forked child; its exit status, or minus the signal that ended it."""
    child = os.fork()
    if child == 0:
        try:
            act()
        finally:
            os._exit(7)
    _, status = os.waitpid(child, 0)
    return os.waitstatus_to_exitcode(status)


def test_a_run_may_be_killed_at_any_call(folder):
    """Kill -9 at each step: files are whole, a mixture is not called intact, the next run heals."""
    mixtures = 0
    for at in range(1, calls_of_a_run(folder) + 1):
        put(folder, "old")

        def act(at=at):
            Spoiler(pytest.MonkeyPatch(), at, lambda name: os.kill(os.getpid(), signal.SIGKILL))
            put(folder, "new")

        assert in_child(act) == -signal.SIGKILL
        found = check_whole(folder)
        for name in ("heavy_top", "rigid_body"):
            versions = {
                text == tree("new")[path] for path, text in found.items() if path.startswith(name)
            }
            if len(versions) == 2:
                mixtures += 1
                assert not is_intact(folder, name)
        put(folder, "new")
        assert on_disk(folder) == tree("new")
    assert mixtures > 0, "the kills fell between files too"


def test_a_full_disk_leaves_the_old_tree(folder):
    """A real limit on file size: nothing is replaced, nothing is left over."""

    def act():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
        try:
            put(folder, "new")
        except OutputError as error:
            os._exit(0 if "File too large" in str(error) and "heavy_top" in str(error) else 1)

    assert in_child(act) == 0
    assert on_disk(folder) == tree("old")


def test_two_runs_at_once_end_as_one_of_them(folder):
    """Writers race six times; the tree is always that of a single run."""
    for _ in range(6):
        children = []
        for version in ("old", "new"):
            child = os.fork()
            if child == 0:
                put(folder, version)
                os._exit(0)
            children.append(child)
        assert [os.waitpid(child, 0)[1] for child in children] == [0, 0]
        assert on_disk(folder) in (tree("old"), tree("new"))


def test_a_second_run_says_that_it_waits(folder):
    """While another holds the lock, a run calls back once and waits; else it does not."""
    waited = []
    put(folder, "old", on_wait=lambda: waited.append("early"))
    handle = os.open(folder / LOCK, os.O_RDWR)
    fcntl.flock(handle, fcntl.LOCK_EX)

    def release():
        waited.append("waiting")
        os.close(handle)

    with lock(folder, on_wait=release):
        assert waited == ["waiting"]


def test_data_reaches_the_disk_before_the_rename(folder, monkeypatch):
    """Every temporary file is synced before any takes its place, each folder after."""
    order = []
    for name in ("fsync", "replace"):
        real = getattr(os, name)
        monkeypatch.setattr(
            write.os,
            name,
            lambda *args, real=real, name=name, **options: (
                order.append(name),
                real(*args, **options),
            )[1],
        )
    put(folder, "new")
    expected = ["fsync"] * 6 + (["replace"] * 2 + ["fsync"]) * 3
    assert order == expected
