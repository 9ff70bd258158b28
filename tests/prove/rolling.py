"""Constrained motions for tests: shipped specs, some pieces replaced, as rates along the motion."""

from functools import cache
from pathlib import Path

from coadjoint.derive import derive, make_setting
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.resources import derivations_folder
from tests.specs import spec, unitless


@cache
def motion(name, *changes):
    """The rates of a shipped system by its first route."""
    text = unitless((Path(derivations_folder()) / f"{name}.toml").read_text())
    declared = spec(text, *changes, name=name)
    return ConstrainedRates(derive(declared, declared.routes[0], setting=make_setting(declared)))
