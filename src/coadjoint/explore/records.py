"""What every page says of a system: its name and source, its quantities, and a refusal.

Comes in: a Spec and what was rendered of it. Goes out: plain values.
Read next: `coadjoint.explore.scene`.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from typing import Any

from coadjoint.declared import Quantity
from coadjoint.errors import KernelArgumentError
from coadjoint.notation.names import spell
from coadjoint.pipeline import Rendered
from coadjoint.resources import derivations_folder
from coadjoint.spec import Spec


def refuse(spec: Spec, problem: str, expected: str) -> KernelArgumentError:
    """The error for a system without a page."""
    known = spec.name if spec.path.parent == derivations_folder() else spec.path
    return KernelArgumentError(
        f"{spec.name} has no page to explore: {problem}; expected {expected}. "
        f"Simulate it: coadjoint simulate {known} --help says how.",
        found=spec.name,
        expected=expected,
    )


def describe(spec: Spec, rendered: Rendered) -> dict[str, Any]:
    """What the page says of a system."""
    record = json.loads(rendered.texts["certificate.json"])
    return {
        "name": spec.name,
        "title": spec.title or spec.name,
        "source": spec.source,
        "description": " ".join(spec.description.split()),
        "unitOfTime": spec.units.time,
        "clock": {"symbol": spec.clock.name, "name": spec.clock.label},
        "spheres": record.get("structure", {}).get("spheres", []),
    }


def drop_member(name: str) -> str:
    """The name of a variable of members, without the number of one.

    >>> drop_member("p_12")
    'p'
    """
    return re.sub(r"_[0-9]+$", "", name)


def list_quantities(quantities: Iterable[Quantity], spec: Spec) -> list[dict[str, Any]]:
    """Quantities with their units, explanations and defaults."""
    declared: list[Any] = [*spec.variables, *spec.parameters, *spec.observables, *spec.inputs]
    docs = {each.name: each.doc for each in [*declared, *spec.reconstruction]}
    docs = {drop_member(name): doc for name, doc in docs.items()} | docs
    return [
        {
            "name": each.name,
            "written": spell(each.name),
            "components": list(each.components),
            "letters": [spell(name) for name in each.components],
            "units": [each.unit_of(name) for name in each.components],
            "doc": docs.get(each.name, ""),
            "default": None if each.default is None else list(each.default),
            "positive": each.positive,
            "conserved": each.conserved,
            "upright": each.upright,
            "quaternion": each.is_quaternion,
        }
        for each in quantities
    ]
