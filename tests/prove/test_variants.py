"""Every free system that is shipped, damped, driven and forced: read, derived, its power proved."""

import json
import re
import tomllib
from pathlib import Path

import pytest

from coadjoint.derive import derive, make_setting
from coadjoint.prove import Verdict
from coadjoint.prove.constrained import motion_of
from coadjoint.prove.integrals import about_energy
from coadjoint.prove.zero import decide_zero
from coadjoint.resources import derivations_folder
from coadjoint.spec import read_spec_text
from coadjoint.spec.routes import ROUTES
from tests.specs import prove_claims, unitless

FOLDER = Path(derivations_folder())
#: Tables that a changed motion need not satisfy, or that only routes without forces read.
DROPPED = (
    *("transformations", "charts", "newton", "lax", "clebsch"),
    *("forces", "dissipation"),
)
DRIVES = ("damped", "driven", "forced")


def free_systems():
    """Names of the shipped specs whose whole motion is written out, free and without noise.

    What acts on those of first order has to be linear: tests.derive.test_bound_momenta has it.
    """
    texts = {path.stem: path.read_text() for path in sorted(FOLDER.glob("*.toml"))}
    bound = ("[constraints]", "[reduction]", "[noise]", "[index]", "[space]", "[truncation]")
    bound = (*bound, '"first-order"')
    return [name for name, text in texts.items() if not any(each in text for each in bound)]


def written(value):
    """A value as TOML in one line."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(k)} = {written(x)}" for k, x in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(written, value)) + "]"
    return json.dumps(value)


def text_of(tables):
    """A spec as TOML: plain keys first."""
    plain = [f"{key} = {written(x)}" for key, x in tables.items() if not isinstance(x, dict)]
    for name, table in tables.items():
        if isinstance(table, dict):
            plain += [f"[{name}]", *(f"{json.dumps(k)} = {written(x)}" for k, x in table.items())]
    return "\n".join(plain) + "\n"


def variant(name, *drives):
    """A shipped free system with friction, with inputs and time, or with a force of its own."""
    tables = tomllib.loads(unitless((FOLDER / f"{name}.toml").read_text()))
    plain = read_spec_text((FOLDER / f"{name}.toml").read_text(), Path(f"{name}.toml"))
    tables = {key: table for key, table in tables.items() if key not in DROPPED}
    tables.get("claims", {}).pop("conserved", None)
    tables.get("claims", {}).pop("galilean", None)
    tables["routes"] = [r for r in plain.routes if "forces" in ROUTES[r].options]
    velocities = [v for v in plain.variables if v.role == "velocity"]
    if "lagrangian" not in tables:
        velocities = [v for v in velocities if plain.hamiltonian is None]
    forced = velocities or [v for v in plain.state if v.role in ("momentum", "coordinate")]
    tables["forces"], first = {}, forced[0]
    if "damped" in drives and velocities:
        squares = [f"{x}^2" for v in velocities for x in v.components]
        tables["dissipation"] = {"R": f"({' + '.join(squares)})/2"}
    elif "damped" in drives:
        tables["forces"] = {v.name: along(v, "-2*{1}") for v in forced}
    parts = []
    if "driven" in drives:
        size = {} if not first.shape else {"shape": [len(first.components)]}
        tables["inputs"] = {"u_in": {"default": 0, **size}}
        tables["time"] = {"name": "t"}
        parts.append("cos(t)*u_in")
    if "forced" in drives:
        parts.append(along(first, "{0}*{1}^2"))
    if parts:
        own = tables["forces"].get(first.name, "")
        tables["forces"][first.name] = " + ".join([*filter(None, [own]), *parts])
    drop_unread_inputs(tables)
    return read_spec_text(text_of(tables), Path(f"{name}.toml"))


def drop_unread_inputs(tables):
    """Inputs of forces that were dropped are named by no formula."""
    words = ("variables", "parameters", "inputs", "observables")  # with descriptions of their own
    formulas = {k: x for k, x in tables.items() if isinstance(x, dict) and k not in words}
    named = {*re.findall(r"\w+", text_of(formulas))}
    kept = {n: x for n, x in tables.pop("inputs", {}).items() if named & names_of(n, x)}
    tables |= {"inputs": kept} if kept else {}


def names_of(name, table):
    """How formulas may name an input: as a whole, or by components."""
    return {name, *(f"{name}{n}" for n in range(1, 1 + max(table.get("shape", [0]))))}


def along(variable, formula):
    """A formula of the place and the name of each component."""
    terms = [formula.format(n, x) for n, x in enumerate(variable.components, 2)]
    return f"vector({', '.join(terms)})" if variable.shape else terms[0]


def balance(declared):
    """The law of the energy and its verdict, by the first route."""
    along = motion_of(derive(declared, setting=make_setting(declared)))
    ((statement, _, examine),) = about_energy(along)
    found = examine()
    found = found if hasattr(found, "verdict") else decide_zero(found, along.field)
    return statement, found.verdict


@pytest.mark.parametrize("name", free_systems())
def test_all_that_may_act_on_a_free_system(name):
    """Friction, an input that swings with time and a force at once, without any constraint."""
    declared = variant(name, *DRIVES)
    assert not declared.constraints
    statement, verdict = balance(declared)
    assert verdict is Verdict.PROVED
    assert "the power of the forces" in statement
    assert ("R" in statement) == (declared.dissipation is not None)


FULL = [
    ("heavy_top", "damped"),
    ("kepler", "forced"),
    ("nambu_pendulum", "driven"),
    ("bargmann", "damped"),
]


@pytest.mark.parametrize(("name", "drive"), FULL)
def test_all_claims_about_a_variant(name, drive):
    """Every claim and every search of the whole certificate."""
    assert prove_claims(variant(name, drive)).holds


@pytest.mark.campaign
@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("name", free_systems())
def test_all_claims_about_every_variant(name, drive):
    """The same of every free system with each of these acting by itself."""
    certificate = prove_claims(variant(name, drive))
    assert certificate.holds, str(certificate)
