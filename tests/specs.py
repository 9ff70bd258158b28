"""Small specs for tests, as text, and the shipped ones by name."""

from __future__ import annotations

from pathlib import Path

from coadjoint.resources import derivations_folder
from coadjoint.spec import Spec, read_spec, read_spec_text

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


def shipped(name: str) -> Spec:
    """A spec of the shipped folder."""
    return read_spec(Path(derivations_folder()) / f"{name}.toml")


def spec(text: str = RIGID_BODY, *changes: tuple[str, str], name: str = "sample") -> Spec:
    """A spec from text, with some pieces replaced; a piece that is not there is an error."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return read_spec_text(text, Path(f"{name}.toml"))
