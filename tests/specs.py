"""Small specs for tests, as text, and the shipped ones by name, with what follows from them.

What follows from a shipped spec is made once in a process, for all tests that ask for it. A test
that changes the engine derives for itself.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from coadjoint import pipeline
from coadjoint.derive import Equations, Setting, derive, make_setting
from coadjoint.errors import CoadjointError, SpecError
from coadjoint.lower.lowering import lower
from coadjoint.lower.program import Program
from coadjoint.prove import Certificate, Verdict, claims, prove
from coadjoint.resources import derivations_folder
from coadjoint.spec import Spec, read_spec, read_spec_text

#: Whether `prove_claims` searches all the same: in campaigns, as `tests.conftest` sets it.
SEARCH_EVERYWHERE = False

RIGID_BODY = """
title = "Free rigid body"
routes = ["euler-poincare", "lie-poisson"]

[algebra]
name = "so(3)"

[variables]
Omega = { role = "velocity" }
Pi = { role = "momentum" }

[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }

[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2"

[claims]
casimirs = ["dot(Pi, Pi)"]
"""


@cache
def shipped(name: str) -> Spec:
    """A spec of the shipped folder."""
    return read_spec(Path(derivations_folder()) / f"{name}.toml")


@cache
def _setting(name: str) -> Setting:
    return make_setting(shipped(name))


@cache
def _equations(name: str, route: str) -> Equations:
    return derive(shipped(name), route, setting=_setting(name))


def emitted(name: str, route: str = "") -> Equations:
    """The equations of a shipped system by a route, the first unless one is named."""
    return _equations(name, route or shipped(name).routes[0])


def derived(name: str) -> dict[str, Equations]:
    """The equations of a shipped system by every route, the emitted one first, in one field."""
    return {route: emitted(name, route) for route in shipped(name).routes}


@cache
def lowered(name: str) -> dict[str, Program]:
    """The programs of a shipped system."""
    return lower(emitted(name))


@contextmanager
def without_searches() -> Iterator[None]:
    """Within it proofs look for no integrals and measures, which takes longer than all else.

    These searches have tests of their own, and `make test-all` searches everywhere.
    """
    with pytest.MonkeyPatch.context() as patch:
        if not SEARCH_EVERYWHERE:
            parts = claims.EXAMINATIONS
            kept = tuple(part for part in parts if part.kind not in ("integrals", "measure"))
            patch.setattr(claims, "EXAMINATIONS", kept)
        yield


def prove_claims(declared: Spec, routes: Sequence[Equations] = ()) -> Certificate:
    """The certificate of a spec, for tests that ask neither for integrals nor for measures."""
    with without_searches():
        return prove(declared, routes)


def verdicts_of(declared: Spec | str, *changes: tuple[str, str]) -> dict[str, Verdict]:
    """Verdicts of the certificate of a spec, or of a text with changes, by their statements."""
    own = declared if isinstance(declared, Spec) else spec(declared, *changes)
    return {claim.statement: claim.verdict for claim in prove_claims(own).claims}


def refused(
    *changes: tuple[str, str], text: str = RIGID_BODY, kind: type[CoadjointError] = SpecError
) -> Any:
    """The error that a changed spec gives when it is read."""
    with pytest.raises(kind) as caught:
        spec(text, *changes)
    return caught.value


def render_claims(declared: Spec) -> pipeline.Rendered:
    """The files of a spec, for tests that ask for its kernels."""
    with without_searches():
        return pipeline.render(declared)


@cache
def rendered(name: str) -> pipeline.Rendered:
    """The files of a shipped system, for tests that ask for its kernels."""
    return render_claims(shipped(name))


def spec(text: str = RIGID_BODY, *changes: tuple[str, str], name: str = "sample") -> Spec:
    """A spec from text, with some pieces replaced; a piece that is not there is an error."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return read_spec_text(text, Path(f"{name}.toml"))


def unitless(text: str) -> str:
    """A spec without its units, for changes of formulas whose units would not fit."""
    text = re.sub(r',\s*unit\s*= "[^"]*"', "", text)
    return re.sub(r'^unit\s*= "[^"]*"\n', "", text, flags=re.MULTILINE)
