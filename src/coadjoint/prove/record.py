"""Proving, record: the certificate as a generated file.

Comes in: a Spec and its Certificate. Goes out: the text of ``certificate.json``, the only generated
file that holds free text of the spec.
Read next: `coadjoint.files`, which reads it without trust.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from types import MappingProxyType
from typing import Any, Final

from coadjoint.derive.lines import Section
from coadjoint.derive.setting import Declared
from coadjoint.methods import JudgedMethod
from coadjoint.prove.certificate import Certificate
from coadjoint.spec import Spec
from coadjoint.spec.core.members import member_name
from coadjoint.spec.spatial import turning_rows

#: Longest components, in characters of MathML, that a notebook shows with the vectors.
LONGEST_MOTION: Final = 20_000


def certificate_json(
    spec: Spec,
    certificate: Certificate,
    facts: Mapping[str, object] = MappingProxyType({}),
    methods: Iterable[JudgedMethod] = (),
    motion: Iterable[Section] = (),
) -> str:
    """The certificate with the spec's free text, for programs and documents.

    Args:
        spec: What was declared.
        certificate: What is proved of it.
        facts: What decides which methods of integration apply, as JSON values.
        methods: Methods that keep structure, as they are judged.
        motion: The equations of motion, which notebooks show of a system.
    """
    quantities: Sequence[Declared] = (*spec.variables, *spec.parameters, *spec.driving)
    record: dict[str, Any] = {
        "title": spec.title,
        "source": spec.source,
        "description": spec.description,
        "docs": {quantity.name: quantity.doc for quantity in quantities if quantity.doc}
        | {entry.name: entry.doc for entry in spec.observables if entry.doc}
        | {entry.name: entry.doc for entry in spec.symmetries if entry.doc}
        | {entry.name: entry.doc for entry in spec.reconstruction if entry.doc},
        "casimirs": [formula.in_one_line for formula in spec.casimirs],
        "routes": list(spec.routes),
        "claims": certificate.as_record()["claims"],
        "findings": certificate.as_record()["findings"],
    }
    if facts:
        record["structure"] = dict(facts)
    if judged := list(methods):
        record["methods"] = [_tell_method(each) for each in judged]
    if spec.definitions:  # the texts of casimirs and claims may hold them
        record["definitions"] = {d.signature: d.in_one_line for d in spec.definitions}
    if spec.observables:  # claims name them
        record["observables"] = {each.name: each.formula.in_one_line for each in spec.observables}
    kept = {name: each.in_one_line for each in spec.constraints for name in each.components}
    if spec.rolling is not None and spec.rolling.contact is not None:
        kept |= spec.rolling.contact.texts
    kept |= _list_rotations(spec)
    if kept:  # in the order of the rows of the function constraint_residual
        record["constraints"] = kept
    if spec.domain:  # generated code names conditions; their text stands here
        record["domain"] = {condition.name: condition.in_one_line for condition in spec.domain}
    if sections := list(motion):
        record["motion"] = [motion_record(each) for each in sections]
    return json.dumps(record, indent=2, ensure_ascii=True) + "\n"


def motion_record(section: Section) -> dict[str, Any]:
    """A section of the motion without Typst; components too long for a notebook are left out."""
    vectors, lines = (
        [{"text": line.text, "latex": line.latex, "mathml": line.mathml} for line in part]
        for part in (section.vectors, section.lines)
    )
    law = section.law
    if vectors and sum(len(line["mathml"]) for line in lines) > LONGEST_MOTION:
        law, lines = f"{law}; components are left out, which fill pages", []
    return {"title": section.title, "law": law, "vectors": vectors, "lines": lines}


def _list_rotations(spec: Spec) -> dict[str, str]:
    """What makes attitudes rotations by name; of equal members once, with their index."""
    family = spec.family
    if family is None:
        return {n: text for each in spec.turning for n, text in turning_rows(spec, each).items()}
    generic = {member_name(name, 0): name for name in family.variables}
    return {
        name.replace(each.name, generic[each.name], 1): text.replace(
            each.name, f"{generic[each.name]}[{family.index.name}]"
        )
        for each in spec.turning
        if each.name in generic
        for name, text in turning_rows(spec, each).items()
    }


def _tell_method(judged: JudgedMethod) -> dict[str, object]:
    """A method as JSON values; laws of a step only where it has some."""
    return {name: value for name, value in asdict(judged).items() if value or name != "laws"}
