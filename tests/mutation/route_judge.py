"""The judge of routes: whether certificates refute a derivation or a spec with one change.

Each line of standard input is a JSON object: a route, a file, a piece of its text, what takes its
place, the systems whose certificates judge it, and source tests that judge what these let pass. The
answer is one line: what refuted it, or nothing. No tree is copied: the change is made while Python
imports the file, or while a spec is read, in a forked child of a process that has the libraries
loaded. That takes half a second.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
import traceback
from dataclasses import replace
from importlib.machinery import SourceFileLoader
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from coadjoint.spec import Spec

#: The last two are what no change touches.
PRELOADED = ("mpmath", "pydantic", "pytest", "sympy", "coadjoint.poisson", "coadjoint.spec")
ROOT = Path(__file__).parents[2]


def changed(text: str, old: str, new: str, path: object) -> str:
    """A text with its only such piece replaced."""
    assert text.count(old) == 1, f"{old!r} is {text.count(old)} times in {path}"
    return text.replace(old, new)


def change_on_import(file: str, old: str, new: str) -> None:
    """Let one file be imported with a piece of its text replaced."""
    plain = SourceFileLoader.get_code

    def get_code(loader: SourceFileLoader, name: str) -> object:
        path = loader.get_filename(name)
        if not path.endswith(file):
            return plain(loader, name)
        return compile(changed(loader.get_data(path).decode(), old, new, path), path, "exec")

    SourceFileLoader.get_code = get_code  # type: ignore[method-assign]


def judged(system: str, request: dict[str, str]) -> Spec:
    """A spec, changed if it is what is to be changed; of many routes the first and the named one.

    A change of one route shows in its equality with the first, and the others cost time.
    """
    from coadjoint.spec import read_spec_text

    path = ROOT / "derivations" / f"{system}.toml"
    text = path.read_text(encoding="utf-8")
    if ROOT / request["file"] == path:
        text = changed(text, request["old"], request["new"], path)
    spec = read_spec_text(text, path)
    kept = tuple(route for route in spec.routes if route in (spec.routes[0], request["route"]))
    return replace(spec, routes=kept) if len(kept) == 2 else spec


def refutation(specs: list[Spec], tests: list[str]) -> str:
    """What is wrong with the engine as it was imported; empty if nothing is."""
    from coadjoint.derive.registry import load_route
    from coadjoint.errors import CoadjointError
    from coadjoint.prove import prove
    from coadjoint.spec.routes import ROUTES

    for route in ROUTES:  # here, so that a change that cannot be made is no refutation
        load_route(route)
    for spec in specs:
        try:
            refuted = prove(spec).refuted
        except (CoadjointError, AssertionError, ArithmeticError, LookupError, ValueError) as error:
            return f"{spec.name}: {type(error).__name__}: {error}".splitlines()[0]
        if refuted:
            return f"{spec.name}: {refuted[0].statement}"
    import pytest

    quiet = ["-x", "-q", "--assert=plain", "-p", "no:cacheprovider", "-p", "no:xdist"]
    status = pytest.main([*quiet, *tests]) if tests else pytest.ExitCode.OK
    failed = status == pytest.ExitCode.TESTS_FAILED
    assert failed or status == pytest.ExitCode.OK, f"{tests} have not run: {status}"
    return "a source test" if failed else ""


def judge(request: dict[str, object], answer: int) -> None:
    """One request in this process; the answer goes to a descriptor."""
    sys.path.insert(0, str(ROOT))
    sys.dont_write_bytecode = True
    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, 1)
    if request["file"].endswith(".py"):
        change_on_import(request["file"], request["old"], request["new"])
    specs = [judged(system, request) for system in request["systems"]]
    found = refutation(specs, request["tests"])
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
