"""Bounded children: results, errors, limits, and what happens when they are lost."""

import errno
import json
import multiprocessing
import os
import resource
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from coadjoint import sandbox
from coadjoint.errors import AlgebraError, InternalError, OutputError, ResourceError
from coadjoint.sandbox import run_bounded
from tests.processes import wait_until_gone

GENEROUS = {"seconds": 60, "memory": 2**31}


@pytest.fixture
def helper(monkeypatch, tmp_path):
    """A module of test functions that children can import as part of the package."""
    package = tmp_path / "coadjoint_helpers"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "tasks.py").write_text(
        textwrap.dedent(
            """
            import os, time
            from coadjoint.sandbox_child import prepared_by, report_progress

            def spin(_):
                while True:
                    pass

            def staged_spin(_):
                report_progress("prove", 1, 2)
                spin(_)

            def raise_limit(seconds):
                import resource
                _, most = resource.getrlimit(resource.RLIMIT_CPU)
                resource.setrlimit(resource.RLIMIT_CPU, (seconds, most))
                return resource.getrlimit(resource.RLIMIT_CPU)[0]

            def full(_):
                import errno
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "/some/where")

            def sleep(seconds):
                time.sleep(seconds)

            def hoard(size):
                return len(bytearray(size))

            def crash(_):
                os.abort()

            def chatter(_):
                print("this must not reach the protocol", flush=True)
                os.system("echo nor this")
                for n in range(3):
                    report_progress("step", n, 3)
                return os.getpid()

            def half(_):
                from coadjoint import sandbox_child
                sandbox_child._channel.write('{"result": [1, 2')
                sandbox_child._channel.flush()
                os.kill(os.getpid(), 9)

            def endless(_):
                os.spawnlp(os.P_NOWAIT, "sleep", "sleep", "1000")
                report_progress("started", os.getpid(), 0)
                time.sleep(1000)

            def compiling(_):
                import subprocess
                started = subprocess.Popen(["sleep", "1000"], start_new_session=True)
                report_progress("compile", os.getpid(), started.pid)
                time.sleep(1000)

            def compute(seconds):
                while time.process_time() < seconds:
                    pass
                return os.getpid()

            def who(_):
                return [os.getpid(), os.getppid()]

            def complain(text):
                print(text, flush=True)
                os._exit(3)

            def look(variable):
                return [os.getcwd(), os.environ.get(variable), os.getppid()]

            made = []

            def prepare():
                made.append(os.getpid())

            @prepared_by("coadjoint.tasks:prepare")
            def prepared(_):
                return made[0]

            def fail():
                raise RuntimeError("no preparation")

            @prepared_by("coadjoint.tasks:fail")
            def unprepared(_):
                fail()

            def bug(_):
                raise RuntimeError("a bug of ours")
            """
        )
    )
    # The child accepts functions of this package alone; for the test, these are such.
    boot = (
        "import sys; sys.path.insert(0, sys.argv[1]); import coadjoint; "
        f"coadjoint.__path__.append({str(package)!r}); "
        "from coadjoint import sandbox_child; sandbox_child.serve()"
    )
    monkeypatch.setattr(sandbox, "_BOOT", boot)
    return "coadjoint.tasks:"


def test_a_result_comes_back_as_json():
    """A function of the package, its argument and its result."""
    found = run_bounded("coadjoint.fingerprint:digest", {"a": 1}, **GENEROUS)
    from coadjoint.fingerprint import digest

    assert found == digest({"a": 1})


def test_an_error_arrives_as_its_own_class_with_its_parts():
    """What the child raises, the parent raises."""
    with pytest.raises(AlgebraError, match="'so3'") as caught:
        run_bounded("coadjoint.algebra:algebra_by_name", "so3", **GENEROUS)
    assert caught.value.found == "so3"


def test_functions_of_other_packages_are_refused():
    """A request can name nothing but this package's functions."""
    with pytest.raises(InternalError, match="AssertionError"):
        run_bounded("os:getcwd", None, **GENEROUS)


def test_processor_time_is_what_counts(helper):
    """A child that computes is stopped at its limit; the message says all that helps."""
    with pytest.raises(ResourceError) as caught:
        run_bounded(helper + "staged_spin", 60, seconds=1, memory=2**31, subject="top.toml")
    message = str(caught.value)
    assert "top.toml: stopped in the stage 'prove' after 1 s of processor time" in message
    assert "--seconds 10" in message
    assert "seconds=10" in message
    assert "COADJOINT_SECONDS" in message
    assert (caught.value.limit, caught.value.stage) == (1, "prove")
    assert 0.5 < caught.value.used < 10  # what the system counts differs where it is busy


def test_time_by_the_clock_does_not_count(helper):
    """A child that waits longer than its processor time is not stopped: the machine may be busy."""
    assert run_bounded(helper + "sleep", 1.6, seconds=1, memory=2**31) is None


def test_a_child_that_waits_for_ever_is_stopped(helper):
    """The generous limit on wall time ends it and says that it has not computed."""
    with pytest.raises(ResourceError, match=r"sleep: stopped after 2 s of wall time") as caught:
        run_bounded(helper + "sleep", 600, seconds=1, memory=2**31, wall=2)
    assert "of which it computed for" in str(caught.value)
    assert (caught.value.limit, caught.value.used < 2) == (2, True)


def test_a_compiler_is_not_bounded_by_the_limit_of_a_child(helper):
    """What a child starts may be given more processor time than the child has itself."""
    assert run_bounded(helper + "raise_limit", 40, seconds=2, memory=2**31) == 40


def test_a_lower_limit_of_the_session_is_named(helper):
    """Under `ulimit -t` the child ends by the signal that says why, and not by SIGKILL."""
    script = (
        "import resource, sys\n"
        f"sys.path.insert(0, {sandbox._ROOT!r})\n"
        "from coadjoint import sandbox\n"
        f"sandbox._BOOT = {sandbox._BOOT!r}\n"
        "resource.setrlimit(resource.RLIMIT_CPU, (4, 4))\n"
        f"sandbox.run_bounded({helper + 'spin'!r}, 0, seconds=60, memory=2**31)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert "spin: stopped after 3 s of processor time" in done.stderr


def test_a_child_that_wants_too_much_memory_is_refused(helper):
    """The limit of memory is named."""
    with pytest.raises(ResourceError, match="more than 512 MiB"):
        run_bounded(helper + "hoard", 2**30, seconds=60, memory=2**29)
    assert run_bounded(helper + "hoard", 2**20, seconds=60, memory=2**29) == 2**20


def test_a_crash_names_the_signal(helper):
    """An aborted child is an error, never a hang."""
    with pytest.raises(ResourceError, match=r"crash: lost \(SIGABRT") as caught:
        run_bounded(helper + "crash", None, **GENEROUS)
    assert caught.value.status == -signal.SIGABRT


def test_a_child_killed_in_the_middle_of_its_answer_is_lost(helper):
    """Half a message is no result."""
    with pytest.raises(ResourceError, match=r"half: lost \(SIGKILL"):
        run_bounded(helper + "half", None, **GENEROUS)


def test_ctrl_c_ends_the_child_and_what_it_started(helper):
    """KeyboardInterrupt passes through, and nothing is left running."""
    seen = []

    def interrupt(stage, process, _):
        seen.append((stage, process))
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_bounded(helper + "endless", None, **GENEROUS, on_progress=interrupt)
    ((stage, child),) = seen
    assert stage == "started"
    for process in [child, *_group(child)]:
        wait_until_gone(process)


def _group(leader):
    """Processes that run in the group of a leader."""
    found = []
    for path in Path("/proc").glob("[0-9]*"):
        try:
            fields = (path / "stat").read_text().rsplit(")", 1)[1].split()
        except (FileNotFoundError, ProcessLookupError):
            continue
        if int(fields[2]) == leader and fields[0] != "Z":
            found.append(int(path.name))
    return found


def test_a_bug_shows_its_message(helper):
    """An unexpected exception is a fault of ours, with its traceback for the report."""
    with pytest.raises(InternalError, match="RuntimeError: a bug of ours") as caught:
        run_bounded(helper + "bug", None, **GENEROUS)
    assert caught.value.exit_status == 70
    assert "Traceback" in caught.value.traceback


def test_a_refusal_of_the_system_is_no_fault_of_ours(helper):
    """A full disk in a child is said as what it is, and is wrong input and not exit status 70."""
    with pytest.raises(OutputError, match="/some/where: No space left on device") as caught:
        run_bounded(helper + "full", None, **GENEROUS)
    assert caught.value.exit_status == 2


def test_a_limit_of_file_sizes_tears_no_bytecode(helper, tmp_path):
    """Python caches a module that it loads in a file, whole or not; a child then caches none."""
    script = (
        "import resource, signal, coadjoint\n"
        "from coadjoint import sandbox\n"
        f"sandbox._BOOT = {sandbox._BOOT!r}\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))\n"
        f"print(sandbox.run_bounded({helper + 'sleep'!r}, 0, seconds=60, memory=2**31))\n"
    )
    done = subprocess.run([sys.executable, "-B", "-c", script], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert not list(tmp_path.rglob("*.pyc"))


def test_no_place_for_temporary_files_is_said(helper, monkeypatch):
    """Where not even the parent can write, the message says which variable helps."""

    def refuse(*_, **__):
        raise FileNotFoundError(errno.ENOENT, "No usable temporary directory found in ['/tmp']")

    monkeypatch.setattr(sandbox.tempfile, "TemporaryFile", refuse)
    with pytest.raises(OutputError, match="TMPDIR"):
        run_bounded(helper + "sleep", 0, **GENEROUS)


def test_stopping_all_children_ends_what_they_started(helper):
    """Children and compilers in sessions of their own; none that comes later survives."""
    children, seen = sandbox.Children(), []

    def stop(stage, child, grandchild):
        seen.extend([child, grandchild])
        children.stop()

    with pytest.raises(ResourceError, match="SIGKILL"):
        run_bounded(helper + "compiling", None, **GENEROUS, on_progress=stop, children=children)
    for process in seen:
        wait_until_gone(process)
    assert len(seen) == 2
    with pytest.raises(ResourceError, match="SIGKILL"):
        run_bounded(helper + "sleep", 600, **GENEROUS, children=children)


def test_a_nursery_serves_one_request_after_the_other(helper):
    """Each in a child of its own, with limits of its own, whatever became of the one before."""

    def ask(function, argument=None, seconds=60):
        return run_bounded(helper + function, argument, seconds=seconds, memory=2**29)

    first = ask("who")
    assert ask("compute", 1.6, 2) not in first  # which has two seconds for itself
    with pytest.raises(ResourceError, match="spin: stopped after 1 s") as caught:
        ask("spin", 0, 1)
    assert caught.value.used < 3
    with pytest.raises(InternalError, match="a bug of ours"):
        ask("bug")
    with pytest.raises(ResourceError, match="half: lost"):
        ask("half")
    second = ask("who")
    assert (first[1], first[0] != second[0]) == (second[1], True)
    os.kill(first[1], signal.SIGKILL)
    os.waitid(os.P_PID, first[1], os.WEXITED | os.WNOWAIT)
    assert ask("who")[1] != first[1]


def test_complaints_are_those_of_the_child(helper):
    """What an earlier child said is not told of the next one."""
    for text in ("first", "second"):
        with pytest.raises(ResourceError, match=text) as caught:
            run_bounded(helper + "complain", text, **GENEROUS)
    assert "first" not in str(caught.value)


def test_a_child_stands_where_its_parent_stands(helper, tmp_path, monkeypatch):
    """Folder and variables are those of the request, and not those of when the nursery began."""

    def look():
        return run_bounded(helper + "look", "COADJOINT_TRIAL", **GENEROUS)

    monkeypatch.delenv("COADJOINT_TRIAL", raising=False)
    before = look()
    monkeypatch.setenv("COADJOINT_TRIAL", "yes")
    monkeypatch.chdir(tmp_path)
    assert look() == [str(tmp_path), "yes", before[2]]
    monkeypatch.delenv("COADJOINT_TRIAL")
    assert look() == [str(tmp_path), None, before[2]]


def test_limits_of_the_system_are_those_of_now(helper):
    """A nursery that began under other limits is not asked."""
    before = run_bounded(helper + "who", None, **GENEROUS)
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft - 1, hard))
    try:
        assert run_bounded(helper + "who", None, **GENEROUS)[1] != before[1]
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def test_what_is_prepared_is_there_in_every_child(helper):
    """It is computed once, before any child; one that fails is left to the children."""
    prepared = {run_bounded(helper + "prepared", None, **GENEROUS) for _ in range(2)}
    assert len(prepared) == 1
    assert run_bounded(helper + "who", None, **GENEROUS)[1] in prepared
    with pytest.raises(InternalError, match="no preparation"):
        run_bounded(helper + "unprepared", None, **GENEROUS)


def test_a_nursery_waits_for_some_time(helper, monkeypatch):
    """Then it ends; and so it does when the process has ended that it could serve."""
    monkeypatch.setattr(sandbox, "PATIENCE", 0.1)
    wait_until_gone(run_bounded(helper + "who", None, **GENEROUS)[1])
    script = (
        "from coadjoint import sandbox\n"
        f"sandbox._BOOT = {sandbox._BOOT!r}\n"
        f"print(sandbox.run_bounded({helper + 'who'!r}, None, seconds=60, memory=2**31)[1])\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.stderr == ""
    wait_until_gone(int(done.stdout))


def test_a_forked_process_has_a_nursery_of_its_own(helper):
    """Two processes that talk to one nursery would take each other's answers."""
    mine = run_bounded(helper + "who", None, **GENEROUS)[1]
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert pool.apply(run_bounded, (helper + "who", None), GENEROUS)[1] != mine
    assert run_bounded(helper + "who", None, **GENEROUS)[1] == mine


def test_prints_do_not_disturb_the_protocol(helper):
    """Progress is passed on in order, and the child is another process."""
    seen = []
    found = run_bounded(
        helper + "chatter", None, **GENEROUS, on_progress=lambda *step: seen.append(step)
    )
    assert seen == [("step", 0, 3), ("step", 1, 3), ("step", 2, 3)]
    assert found != os.getpid()


def test_a_child_dies_with_its_parent(helper, tmp_path):
    """Kill -9 of the parent ends the child, too."""
    script = tmp_path / "parent.py"
    script.write_text(
        "import sys, os\n"
        f"sys.path.insert(0, {sandbox._ROOT!r})\n"
        "from coadjoint import sandbox\n"
        f"sandbox._BOOT = {sandbox._BOOT!r}\n"
        "real = sandbox.subprocess.Popen\n"
        "def popen(*a, **k):\n"
        "    process = real(*a, **k)\n"
        "    print(process.pid, flush=True)\n"
        "    return process\n"
        "sandbox.subprocess.Popen = popen\n"
        f"sandbox.run_bounded({helper + 'sleep'!r}, 1000, seconds=1000, memory=2**31)\n"
    )
    with subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE) as parent:
        child = int(parent.stdout.readline())
        parent.kill()
        parent.wait()
    wait_until_gone(child)


def test_messages_are_plain_json():
    """An error's record survives the way through JSON."""
    error = ResourceError("too long", limit=3)
    record = json.loads(json.dumps(error.as_record()))
    assert record == {"kind": "ResourceError", "message": "too long", "parts": {"limit": 3}}
