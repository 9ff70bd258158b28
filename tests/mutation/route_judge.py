"""The judge of routes: whether certificates refute a derivation or a spec with one change.

Each line of standard input is a JSON object: a route, a file, its changed text, the systems whose
certificates judge it, and source tests that judge what these let pass. The answer is one line: what
refuted it, or nothing. No tree is copied: the text takes the place of the file while Python imports
it, or while a spec is read, in a forked child of a process that has the libraries loaded. That
takes half a second.
"""

from __future__ import annotations

import importlib
import json
import os
import resource
import shlex
import signal
import sys
import traceback
from dataclasses import replace
from importlib.machinery import SourceFileLoader
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from coadjoint.prove import Certificate, Claim, Finding
    from coadjoint.spec import Spec

#: The last two are what no change touches.
PRELOADED = ("mpmath", "pydantic", "pytest", "sympy", "coadjoint.poisson", "coadjoint.spec")
ROOT = Path(__file__).parents[2]
#: Seconds of processor time and bytes for one judgement; what takes more is seen by that.
SECONDS, BYTES = 120, 4 << 30


def change_on_import(file: str, text: str) -> None:
    """Let one file be imported with another text."""
    plain = SourceFileLoader.get_code

    def get_code(loader: SourceFileLoader, name: str) -> object:
        path = loader.get_filename(name)
        return compile(text, path, "exec") if path.endswith(file) else plain(loader, name)

    SourceFileLoader.get_code = get_code  # type: ignore[method-assign]


def judged(system: str, request: dict[str, str]) -> Spec:
    """A spec, changed if it is what is to be changed; of many routes the first and the named one.

    A change of one route shows in its equality with the first, and the others cost time.
    """
    from coadjoint.spec import read_spec_text

    path = ROOT / "derivations" / f"{system}.toml"
    own = ROOT / request["file"] == path
    text = request["text"] if own else path.read_text(encoding="utf-8")
    spec = read_spec_text(text, path)
    kept = tuple(route for route in spec.routes if route in (spec.routes[0], request["route"]))
    if len(kept) < 2:
        return spec
    return replace(spec, routes=kept, lax=spec.lax if "lax" in kept else None)


class RefutedError(Exception):
    """A claim is refuted: the rest of the certificate need not be made."""


def prove_until_refuted() -> Callable[[Spec], Certificate]:
    """`prove` that stops at the first refuted claim, and searches for nothing."""
    from coadjoint.prove import Verdict, claims, prove

    make = claims.make_entry

    def make_entry(statement: str, *found: Any) -> Claim | Finding:
        entry = make(statement, *found)
        if getattr(entry, "verdict", None) is Verdict.REFUTED:
            raise RefutedError(statement)
        return entry

    claims.make_entry = make_entry
    claims.EXAMINATIONS = tuple(part for part in claims.EXAMINATIONS if not part.kind)
    return prove


def refutation(specs: list[Spec], tests: list[str]) -> str:
    """What is wrong with the engine as it was imported; empty if nothing is."""
    from coadjoint.derive.registry import load_route
    from coadjoint.spec.routes import ROUTES

    for route in ROUTES:  # here, so that a change that cannot be made is no refutation
        load_route(route)
    examine = prove_until_refuted() if specs else None
    for spec in specs:
        try:
            examine(spec)
        except NameError:  # the change cannot run at all
            raise
        except RefutedError as refuted:
            return f"{spec.name}: {refuted}"
        except Exception as error:  # there is no certificate, whatever went wrong
            return f"{spec.name}: {type(error).__name__}: {error}".splitlines()[0]
    import pytest

    quiet = ["-x", "-q", "--assert=plain", "-p", "no:cacheprovider", "-p", "no:xdist"]
    quiet += ["-m", "not campaign"]  # claims judge, which `tests.specs.prove_claims` decides alone
    for each in tests:
        status = pytest.main([*quiet, *shlex.split(each)])
        if status == pytest.ExitCode.TESTS_FAILED:
            return "a source test"
        assert status == pytest.ExitCode.OK, f"{each} has not run: {status}"
    return ""


def judge(request: dict[str, object], answer: int) -> None:
    """One request in this process; the answer goes to a descriptor."""
    sys.path.insert(0, str(ROOT))
    sys.dont_write_bytecode = True
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
    resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, 1)
    if request["file"].endswith(".py"):
        change_on_import(request["file"], request["text"])
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
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        if status == -signal.SIGXCPU:
            os.write(answer, b'"it does not end"\n')
        elif status:
            os.write(answer, b'"the judge itself failed"\n')


if __name__ == "__main__":
    main()
