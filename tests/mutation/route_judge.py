"""The judge of routes: whether certificates refute a derivation with one change in its text.

Each line of standard input is a JSON object: a file, a piece of its text, what takes its place, the
systems whose certificates judge it, and source tests that judge what these let pass. The answer is
one line: what refuted it, or nothing. No tree is copied: the change is made while Python imports
the file, in a forked child of a process that has the libraries loaded. That takes a second.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
import traceback
from importlib.machinery import SourceFileLoader
from pathlib import Path

PRELOADED = ("hypothesis", "mpmath", "numpy", "pydantic", "pytest", "sympy")


def change_on_import(file: str, old: str, new: str) -> None:
    """Let one file be imported with a piece of its text replaced."""
    plain = SourceFileLoader.get_code

    def get_code(loader: SourceFileLoader, name: str) -> object:
        path = loader.get_filename(name)
        if not path.endswith(file):
            return plain(loader, name)
        text = loader.get_data(path).decode()
        assert text.count(old) == 1, f"{old!r} is {text.count(old)} times in {path}"
        return compile(text.replace(old, new), path, "exec")

    SourceFileLoader.get_code = get_code  # type: ignore[method-assign]


def refutation(systems: list[str], tests: list[str]) -> str:
    """What is wrong with the engine as it was imported; empty if nothing is."""
    from coadjoint.errors import CoadjointError
    from coadjoint.prove import prove
    from tests.specs import shipped

    for system in systems:
        try:
            refuted = prove(shipped(system)).refuted
        except (CoadjointError, AssertionError, ArithmeticError, LookupError, ValueError) as error:
            return f"{system}: {type(error).__name__}: {error}".splitlines()[0]
        if refuted:
            return f"{system}: {refuted[0].statement}"
    import pytest

    quiet = ["-x", "-q", "--assert=plain", "-p", "no:cacheprovider", "-p", "no:xdist"]
    return "a source test" if tests and pytest.main([*quiet, *tests]) == 1 else ""


def judge(request: dict[str, object], answer: int) -> None:
    """One request in this process; the answer goes to a descriptor."""
    sys.path.insert(0, str(Path(__file__).parents[2]))
    sys.dont_write_bytecode = True
    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, 1)
    change_on_import(request["file"], request["old"], request["new"])
    found = refutation(request["systems"], request["tests"])
    os.write(answer, (json.dumps(found) + "\n").encode())


def main() -> None:
    """Serve until standard input ends."""
    for name in PRELOADED:
        importlib.import_module(name)
    answer = os.dup(1)
    for line in sys.stdin:
        child = os.fork()
        if child == 0:
            status = 99
            try:
                judge(json.loads(line), answer)
                status = 0
            except BaseException:
                traceback.print_exc()
            finally:
                os._exit(status)
        if os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]):
            os.write(answer, b'"the judge itself failed"\n')


if __name__ == "__main__":
    main()
