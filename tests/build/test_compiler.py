"""Compilers: found, missing, failing, hanging, lying; CC is a program and nothing else."""

import ctypes
import platform
import shutil
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from coadjoint.build import compiler, processes
from coadjoint.build.cache import cache_folder
from coadjoint.build.compiler import (
    Compiler,
    CompilerWarning,
    compile_kernel,
    find_compiler,
)
from coadjoint.build.source import Source
from coadjoint.errors import CompilerError
from coadjoint.resources import systems_folder
from coadjoint.solve import kernels
from coadjoint.solve.folders import load_folder
from coadjoint.systems import heavy_top

SIMPLE = {
    "kernel.h": "double twice(double x);\n",
    "kernel.c": '#include "kernel.h"\ndouble twice(double x)\n{\n    return 2.0 * x;\n}\n',
}
FUSED = {
    "kernel.h": "double fused(double a, double b, double c);\n",
    "kernel.c": '#include "kernel.h"\ndouble fused(double a, double b, double c)\n'
    "{\n    return a * b + c;\n}\n",
}


@pytest.fixture(autouse=True)
def forget():
    """Each test searches for a compiler anew."""
    compiler._find.cache_clear()
    yield
    compiler._find.cache_clear()


@pytest.fixture
def fresh_top(monkeypatch, tmp_path):
    """The heavy top in a folder of its own, with an empty cache."""
    monkeypatch.setenv("COADJOINT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(kernels, "_said", set())
    folder = tmp_path / "heavy_top"
    shutil.copytree(heavy_top.system.folder, folder, ignore=shutil.ignore_patterns("__pycache__"))
    return load_folder(folder)


def script(folder, name, body):
    """An executable shell script."""
    path = folder / name
    path.write_text(f"#!/bin/sh\n{body}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


def sources(folder, **changes):
    """A folder with a kernel."""
    for name, text in {**SIMPLE, **changes}.items():
        (folder / name).write_text(text)
    return folder


def test_the_compiler_of_this_machine_is_found_and_works(tmp_path):
    """A version is known, and both builds make a shared object."""
    found = find_compiler()
    assert found.version
    for build in ("exact", "fast"):
        made = compile_kernel(found, sources(tmp_path), build)
        assert made.read_bytes()[:4] == b"\x7fELF"


def test_contraction_is_off_in_the_exact_build_alone():
    """Bits are promised without fused operations; fast maths is never on."""
    flags = find_compiler().flags("exact")
    assert "-ffp-contract=off" in flags
    assert "-ffp-contract=fast" in find_compiler().flags("fast")
    assert "-ffast-math" not in (*flags, *find_compiler().flags("fast"))
    assert {"-std=c11", "-O3", "-march=native", "-Wall", "-Wextra", "-Werror"} <= set(flags)


@pytest.mark.parametrize(("build", "level"), [("exact", 1), ("fast", 0), ("fast", 1), ("fast", 3)])
def test_products_and_sums_are_fused_from_the_first_level_on(tmp_path, build, level):
    """The fast objects of the cross-check round as those of users do, by fused operations."""
    found = find_compiler()
    if "__FP_FAST_FMA" not in _macros(found):
        pytest.skip("a processor without fused operations")
    source = Source("kernel", (), is_loops=False, level=level)
    folder = sources(tmp_path, **FUSED)
    made = ctypes.CDLL(str(compile_kernel(found, folder, build, source)))
    made.fused.restype, made.fused.argtypes = ctypes.c_double, [ctypes.c_double] * 3
    tiny = 2.0**-30
    left = made.fused(1.0 + tiny, 1.0 - tiny, -1.0)  # 1 - 2^-60, less 1; the product rounds to 1
    assert left == (-(2.0**-60) if build == "fast" and level else 0.0)


def _macros(found):
    """Macros of a compiler for this processor."""
    command = [*found.command, "-march=native", "-dM", "-E", "-x", "c", "/dev/null"]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def test_the_environment_lowers_how_much_is_optimised(monkeypatch):
    """Never more than a source asks for, and with another key of the cache."""
    found, source = find_compiler(), Source(level=2)
    most = found.flags("exact")
    monkeypatch.setenv("COADJOINT_OPTIMIZE", "1")
    assert "-O1" in found.flags("exact")
    assert found.flags("exact") != most
    assert "-fno-tree-loop-optimize" not in found.flags("fast")  # of what is run for some steps
    monkeypatch.setenv("COADJOINT_OPTIMIZE", "0")
    assert ("-O0" in found.flags("exact"), "-O1" in found.flags("fast")) == (True, True)
    monkeypatch.setenv("COADJOINT_OPTIMIZE", "3")
    assert (found.flags("exact"), "-O2" in found.flags("exact", source)) == (most, True)


@pytest.mark.parametrize("value", ["4", "-1", "fast", "1.0"])
def test_another_level_is_refused(monkeypatch, value):
    """The message says what may stand there, and what to do."""
    monkeypatch.setenv("COADJOINT_OPTIMIZE", value)
    with pytest.raises(CompilerError, match=r"expected 0, 1, 2 or 3\. Unset it"):
        find_compiler().flags("exact")
    monkeypatch.delenv("COADJOINT_OPTIMIZE")
    assert "-O3" in find_compiler().flags("exact")


@pytest.mark.parametrize(
    "value",
    ["gcc --version; touch x #", "gcc -O0", "-wrapper", "@options", "$(id)", "gcc\n", "a|b"],
)
def test_cc_with_anything_but_a_program_is_refused(monkeypatch, value, tmp_path):
    """No shell, no options: the message shows what CC was."""
    monkeypatch.setenv("CC", value)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(CompilerError, match="expected the name or path of one program") as caught:
        find_compiler()
    assert caught.value.found == value
    assert not list(tmp_path.iterdir())


def test_cc_that_is_not_there_is_refused(monkeypatch):
    """The message names it."""
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(CompilerError, match="'no-such-compiler', which is not found"):
        find_compiler()


def test_no_compiler_at_all_says_how_to_get_one(monkeypatch, tmp_path):
    """An empty PATH: the pip command is in the message."""
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(compiler, "find_spec", lambda name: None)
    with pytest.raises(CompilerError, match=r"pip install 'coadjoint\[c\]'"):
        find_compiler()


def test_an_error_of_the_compiler_is_shown(tmp_path):
    """The first lines of what it said stand in the message."""
    folder = sources(tmp_path, **{"kernel.c": "this is not C;\n"})
    with pytest.raises(CompilerError, match="error"):
        compile_kernel(find_compiler(), folder, "exact")


LINKER = (
    "ld: plugin framework: out of file descriptors. Try using fewer objects/archives\n"
    "collect2: error: ld returned 1 exit status"
)
#: What compilers and their linkers say under limits of the session, and what helps.
LIMITS = {
    LINKER: "ulimit -n",
    "x" * 2000 + "\nld: cannot open libm.so: Too many open files": "ulimit -n",
    "as: error while loading shared libraries: libbfd.so: cannot open shared object file: "
    "Error 24": "ulimit -n",
    "cc: fatal error: cannot open a file: Too many open files in system": "Close some programs",
    "ld: final link failed: file too big": "ulimit -f",
    "cc: fatal error: File size limit exceeded signal terminated program as": "ulimit -f",
    "ld: kernel.so: No space left on device\nld: Permission denied": "Free some space",
    "cc: fork: Resource temporarily unavailable": "ulimit -u",
    "cc1: out of memory allocating 65536 bytes": r"Free some memory\..* 2 GiB",
    "cc: fatal error: Killed signal terminated program cc1": "Free some memory",
}


@pytest.mark.parametrize(("said", "remedy"), LIMITS.items(), ids=range(len(LIMITS)))
def test_a_limit_that_a_compiler_met_is_named_with_its_remedy(tmp_path, said, remedy):
    """Wherever it stands in the output, and without a second attempt that blames an option."""
    (tmp_path / "said").write_text(said)
    fake = script(tmp_path, "poor", "echo run >> runs; cat said; exit 1")
    with pytest.raises(CompilerError, match=f"(?s)with status 1: .*{remedy}") as caught:
        compile_kernel(Compiler((str(fake),), "poor 1.0"), sources(tmp_path), "exact")
    assert "another compiler" not in str(caught.value)
    assert (tmp_path / "runs").read_text() == "run\n"


def test_a_limit_that_a_compiler_met_is_named_however_it_ended(monkeypatch, tmp_path):
    """By a signal and in silence, when asked for its version, and when it hangs."""
    poor = Compiler((str(script(tmp_path, "poor", "kill -KILL $$")),), "poor 1.0")
    with pytest.raises(CompilerError, match=r"with status 137: no output\. Free some memory"):
        compile_kernel(poor, sources(tmp_path), "exact")
    said = "echo Too many open files"
    monkeypatch.setenv("CC", str(script(tmp_path, "mute", f"{said}; exit 3")))
    with pytest.raises(CompilerError, match=r"expected a version\. .*ulimit -n"):
        find_compiler()
    slow = Compiler((str(script(tmp_path, "slow", f"{said}; sleep 61")),), "slow 1.0")
    monkeypatch.setattr(processes.run_program, "__defaults__", (60, 0.5))
    with pytest.raises(CompilerError, match=r"did not finish in 0\.5 s: .*ulimit -n"):
        compile_kernel(slow, sources(tmp_path), "exact")


@pytest.mark.parametrize(
    "said", ["error: unknown option", "kernel.c:3: error: expected a semicolon", ""]
)
def test_a_compiler_that_met_no_limit_is_to_be_replaced(tmp_path, said):
    """Its own errors lead to another compiler."""
    fake = script(tmp_path, "bad", f"echo '{said}'; exit 1" if said else "kill -SEGV $$")
    with pytest.raises(CompilerError, match=r"Set CC to another compiler\."):
        compile_kernel(Compiler((str(fake),), "bad 1.0"), sources(tmp_path), "exact")


def test_a_limit_of_processor_time_of_the_session_is_named(monkeypatch, tmp_path):
    """Where it is below ours, the message names it and how to raise it."""
    fake = script(tmp_path, "loop", "kill -XCPU $$")
    monkeypatch.setattr(processes.resource, "getrlimit", lambda kind: (1, 1))
    with pytest.raises(CompilerError, match=r"in 1 s of processor time: .*ulimit -t"):
        compile_kernel(Compiler((str(fake),), "loop 1.0"), sources(tmp_path), "exact")


def test_a_warning_is_an_error(tmp_path):
    """An unused variable stops the build."""
    unused = SIMPLE["kernel.c"].replace("return", "int y;\n    return")
    folder = sources(tmp_path, **{"kernel.c": unused})
    with pytest.raises(CompilerError, match="unused variable"):
        compile_kernel(find_compiler(), folder, "exact")


def test_what_an_optimiser_suspects_is_no_error(tmp_path):
    """GCC warns of rows that two loops fill and read, where it does not see that they fit."""
    header = f"{SIMPLE['kernel.h']}void choose(int *);\n"
    body = """#include "kernel.h"
double twice(double x)
{
    double y;
    int chosen = x > 0.0;
    if (chosen)
        y = 2.0 * x;
    choose(&chosen);
    return chosen ? y : 0.0;
}
void choose(int *chosen)
{
    *chosen = *chosen > 0;
}
"""
    found = find_compiler()
    folder = sources(tmp_path, **{"kernel.h": header, "kernel.c": body})
    assert compile_kernel(found, folder, "exact").is_file()
    for build in ("exact", "fast"):
        assert ("-Wno-maybe-uninitialized" in found.flags(build)) == found.is_gnu


def test_a_hanging_compiler_is_stopped(monkeypatch, tmp_path):
    """The limit is named, and nothing of it is left running."""
    fake = script(tmp_path, "slow", "sleep 61 & echo $! > started; wait")
    monkeypatch.setattr(processes.run_program, "__defaults__", (60, 0.5))
    with pytest.raises(CompilerError, match=r"the compiler did not finish in 0\.5 s: .*slow was"):
        compile_kernel(Compiler((str(fake),), "slow 1.0"), sources(tmp_path), "exact")
    wait_for_the_end(tmp_path / "started")


def wait_for_the_end(started):
    """Wait until the process whose number stands in a file is gone; a hang is the test's limit."""
    child = Path("/proc") / started.read_text().strip() / "cmdline"
    while child.exists() and child.read_bytes():  # gone, or a zombie
        time.sleep(0.05)


def test_a_compiler_that_never_ends_is_stopped_by_its_processor_time(monkeypatch, tmp_path):
    """A loop is told from a machine that is busy: the limit counts what the compiler used."""
    fake = script(tmp_path, "loop", "while :; do :; done")
    monkeypatch.setattr(processes.run_program, "__defaults__", (1, 120))
    told = r"in 1 s of processor time: .*loop was stopped while it compiled kernel\.c of \d+ KiB\."
    with pytest.raises(CompilerError, match=f"{told} Long texts take long"):
        compile_kernel(Compiler((str(fake),), "loop 1.0"), sources(tmp_path), "exact")


CALLER = """
import sys, warnings
from pathlib import Path
from coadjoint.solve.folders import load_folder
load_folder(Path(sys.argv[1])).prepare(("c", "c-fast"))
"""
#: Says its number and sleeps, in a child of its own as compilers have.
SLEEPER = (
    '[ "$1" = --version ] && echo sleeper 1.0 && exit\n'
    "sleep 1000 & echo $! > {folder}/started.$$.part\n"
    "mv {folder}/started.$$.part {folder}/started.$$\nwait"
)


def sleeping(monkeypatch, tmp_path):
    """A process that waits for two compilers, and the files in which their numbers stand."""
    monkeypatch.setenv("COADJOINT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("CC", str(script(tmp_path, "sleeper", SLEEPER.format(folder=tmp_path))))
    folder = tmp_path / "heavy_top"
    shutil.copytree(heavy_top.system.folder, folder, ignore=shutil.ignore_patterns("__pycache__"))
    caller = subprocess.Popen([sys.executable, "-c", CALLER, str(folder)], stderr=subprocess.PIPE)
    while len(started := sorted(tmp_path.glob("started.*[0-9]"))) < 2:
        assert caller.poll() is None
        time.sleep(0.05)
    return caller, started


def test_ctrl_c_ends_compilers_and_the_wait_for_them(monkeypatch, tmp_path):
    """KeyboardInterrupt in the caller, and nothing of two sleeping compilers is left."""
    caller, started = sleeping(monkeypatch, tmp_path)
    caller.send_signal(signal.SIGINT)
    _, said = caller.communicate()
    assert b"KeyboardInterrupt" in said
    for each in started:
        wait_for_the_end(each)
    assert not list((tmp_path / "cache" / "work").iterdir())


def test_compilers_end_when_their_caller_is_killed(monkeypatch, tmp_path):
    """A kill -9 leaves no compiler running; its folder is removed when the cache is used next."""
    caller, started = sleeping(monkeypatch, tmp_path)
    caller.kill()
    caller.communicate()
    for each in started:
        wait_for_the_end(each)
    work = tmp_path / "cache" / "work"
    assert len(list(work.iterdir())) == 2
    cache_folder()
    assert not list(work.iterdir())


def test_a_failed_version_is_remembered(monkeypatch, tmp_path):
    """A compiler that cannot tell its version is asked once, however often one is looked for."""
    log = tmp_path / "log"
    fake = script(tmp_path, "mute", f"echo asked >> {log}; exit 3")
    monkeypatch.setenv("CC", str(fake))
    messages = set()
    for _ in range(3):
        with pytest.raises(CompilerError, match="--version ended with status 3") as caught:
            find_compiler()
        messages.add(str(caught.value))
        assert caught.value.found == str(fake)
    assert len(messages) == 1
    assert log.read_text() == "asked\n"


def test_a_compiler_that_needs_too_much_memory_is_stopped(monkeypatch, tmp_path):
    """The limit holds for what the compiler starts, and its message is shown."""
    found = find_compiler()
    monkeypatch.setattr(processes, "COMPILE_BYTES", 2**20)
    with pytest.raises(CompilerError, match=r"failed on kernel\.c with status"):
        compile_kernel(found, sources(tmp_path), "exact")


def test_a_compiler_is_found_from_any_folder(monkeypatch, tmp_path):
    """A relative CC is that of the folder where it was looked up."""
    real = find_compiler().command[0]
    script(tmp_path, "mine", f'exec {real} "$@"')
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CC", "./mine")
    found = find_compiler()
    place = tmp_path / "elsewhere"
    place.mkdir()
    monkeypatch.chdir(place)
    assert compile_kernel(found, sources(place), "exact").is_file()


@pytest.mark.parametrize("body", ["exit 0", "echo garbage > kernel.so"])
def test_a_compiler_that_makes_nothing_is_noticed(tmp_path, body):
    """Exit status 0 without a shared object is not believed."""
    fake = script(tmp_path, "liar", body)
    with pytest.raises(CompilerError, match="produced no shared object"):
        compile_kernel(Compiler((str(fake),), "liar"), sources(tmp_path), "exact")


def test_a_compiler_that_cannot_tell_its_version_is_refused(monkeypatch, tmp_path):
    """Its answer is in the message."""
    monkeypatch.setenv("CC", str(script(tmp_path, "mute", "exit 3")))
    with pytest.raises(CompilerError, match="--version ended with status 3"):
        find_compiler()


def test_machines_without_march_native_still_compile(monkeypatch, tmp_path):
    """The option is dropped where the compiler refuses it, which is said."""
    real = find_compiler().command[0]
    fake = script(
        tmp_path,
        "picky",
        f'for a in "$@"; do [ "$a" = -march=native ] && exit 1; done; exec {real} "$@"',
    )
    with pytest.warns(CompilerWarning, match="picky refuses -march=native"):
        made = compile_kernel(Compiler((str(fake),), "picky"), sources(tmp_path), "exact")
    assert made.is_file()


def test_a_compiler_that_does_not_know_wide_vectors_keeps_the_rest(monkeypatch, tmp_path):
    """One unknown option costs that option alone, and the message names it."""
    monkeypatch.setattr(compiler, "MACHINES", (("-O3", "-mno-such-width=512"), ("-O3",), ()))
    real = find_compiler().command[0]
    log = tmp_path / "log"
    fake = script(tmp_path, "old", f'echo "$@" >> {log}; exec {real} "$@"')
    with pytest.warns(CompilerWarning, match=r"old refuses -mno-such-width=512; kernels"):
        made = compile_kernel(Compiler((str(fake),), "old"), sources(tmp_path), "exact")
    assert made.is_file()
    assert log.read_text().splitlines()[-1].split().count("-O3") == 2


@pytest.mark.skipif(platform.machine() != "x86_64", reason="an option of x86 alone")
def test_wide_vectors_are_asked_for_and_change_nothing_without_them(tmp_path):
    """Kernels ask for 512 bits; for a processor of 256 the compiler writes the same text."""
    found = find_compiler()
    assert "-mprefer-vector-width=512" in found.flags("exact")
    assert "-mprefer-vector-width=512" in found.flags("fast", Source("solver", ("-DRK4",)))
    if not found.is_gnu:
        pytest.skip("checked for GCC")
    text = (systems_folder() / "heavy_top" / "kernel.c").read_bytes()
    for place, options in (("a", []), ("b", ["-mprefer-vector-width=512"])):
        (tmp_path / place).mkdir()
        (tmp_path / place / "kernel.c").write_bytes(text)
        header = (systems_folder() / "heavy_top" / "kernel.h").read_bytes()
        (tmp_path / place / "kernel.h").write_bytes(header)
        command = [*found.command, "-O3", "-march=haswell", *options, "-S", "kernel.c"]
        subprocess.run(command, check=True, cwd=tmp_path / place)
    written = [(tmp_path / place / "kernel.s").read_text() for place in ("a", "b")]
    assert "ymm" in written[0]
    assert written[0] == written[1]


def test_without_a_compiler_numpy_stands_in_and_says_so_once(monkeypatch, fresh_top, tmp_path):
    """Results are right, the warning has the pip command and comes once."""
    monkeypatch.setenv("CC", "no-such-compiler")
    state = np.ones(6)
    with pytest.warns(CompilerWarning, match=r"NumPy kernels are used.*coadjoint\[c\]"):
        found = fresh_top.rhs(state)
    assert np.array_equal(found, fresh_top.rhs(state, target="numpy"))
    fresh_top.energy(state)  # a second warning would be an error


def test_a_wrong_kernel_is_noticed_before_it_is_cached(monkeypatch, fresh_top, tmp_path):
    """A compiler that changes a sign is caught by comparison with NumPy, and nothing is cached."""
    real = find_compiler().command[0]
    changed = "sed -i 's/ - / + /' kernel.c"
    monkeypatch.setenv("CC", str(script(tmp_path, "traitor", f'{changed}; exec {real} "$@"')))
    with pytest.warns(CompilerWarning, match="a wrong kernel was compiled"):
        fresh_top.rhs(np.ones(6))
    assert not list(Path(tmp_path / "cache").rglob("*.so"))
