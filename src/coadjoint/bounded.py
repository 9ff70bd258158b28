"""Bounded forms: read, derive and prove an untrusted spec within limits of time and memory.

Comes in: the path of a spec. Goes out: plain JSON values, from a child process whose processor time
and memory are limited; `coadjoint.read_spec`, `coadjoint.derive` and `coadjoint.prove` do the same
work in the caller's process and take as long as they take. docs/limits.md says what is bounded.
Read next: `coadjoint.sandbox`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from os import PathLike, fspath
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from coadjoint.budget import allowed_seconds
from coadjoint.errors import CoadjointError, ResourceError, from_record
from coadjoint.limits import WORKER_BYTES
from coadjoint.sandbox import run_bounded
from coadjoint.sandbox_child import prepared_by, report_progress

if TYPE_CHECKING:
    from coadjoint.pipeline import Rendered
    from coadjoint.spec import Spec


def read_bounded(
    path: str | PathLike[str], *, seconds: float | None = None, memory: int = WORKER_BYTES
) -> dict[str, Any]:
    """What a spec declares, read in a bounded child.

    Args:
        path: A spec in TOML.
        seconds: Processor time; see `coadjoint.budget.allowed_seconds`.
        memory: Limit of address space, bytes.

    Returns:
        ``name``, ``title``, ``source``, ``description`` and ``license`` as they stand in the spec,
        ``routes``, the ``state`` and ``parameters`` by component, and ``sha256`` of its bytes.

    Raises:
        CoadjointError: What the same work in the caller's process raises.
        ResourceError: The child ran out of time or memory.
    """
    (record,) = read_all_bounded([fspath(path)], seconds=seconds, memory=memory)
    if isinstance(record, CoadjointError):
        raise record
    return record


def derive_bounded(
    path: str | PathLike[str],
    route: str | None = None,
    *,
    sizes: Mapping[str, int] = MappingProxyType({}),
    seconds: float | None = None,
    memory: int = WORKER_BYTES,
) -> dict[str, Any]:
    """The derivation of a spec, step by step, made in a bounded child.

    It follows one of the routes, by default the first; ``sizes`` says how many members an index
    counts. Other arguments and errors are those of `read_bounded`.

    Returns:
        The fields of a `coadjoint.derive.document.Document`, for
        `coadjoint.render.document.render_document`.
    """
    argument = {"path": fspath(path), "route": route, "sizes": dict(sizes)}
    return _run("coadjoint.bounded:document_record", argument, seconds, memory)


def prove_bounded(
    path: str | PathLike[str],
    *,
    sizes: Mapping[str, int] = MappingProxyType({}),
    seconds: float | None = None,
    memory: int = WORKER_BYTES,
) -> dict[str, Any]:
    """The certificate of a spec, made in a bounded child; what is refuted raises nothing.

    Arguments and errors are those of `derive_bounded`.

    Returns:
        What ``coadjoint prove --json`` prints: ``system``, ``holds``, and ``claims`` with
        statement, verdict and method of each.
    """
    argument = {"path": fspath(path), "sizes": dict(sizes)}
    return _run("coadjoint.bounded:certificate_record", argument, seconds, memory)


def methods_bounded(
    path: str | PathLike[str],
    *,
    sizes: Mapping[str, int] = MappingProxyType({}),
    seconds: float | None = None,
    memory: int = WORKER_BYTES,
) -> dict[str, Any]:
    """Which methods of integration keep what of a system, judged in a bounded child.

    Arguments and errors are those of `derive_bounded`.

    Returns:
        What ``coadjoint show --methods --json`` prints: ``system``, ``structure``, the facts that
        decide, and ``methods`` with the attributes of `coadjoint.methods.JudgedMethod`.
    """
    argument = {"path": fspath(path), "sizes": dict(sizes)}
    return _run("coadjoint.bounded:methods_record", argument, seconds, memory)


def export_bounded(
    path: str | PathLike[str],
    method: str = "auto",
    *,
    sizes: Mapping[str, int] = MappingProxyType({}),
    seconds: float | None = None,
    memory: int = WORKER_BYTES,
) -> str:
    """One step of a method as a header of C, made in a bounded child.

    Other arguments and errors are those of `derive_bounded`; ``method`` is a name, or ``"auto"``
    for the one that ``"auto"`` takes with a fixed step.

    Returns:
        The text of the header, which C99 and C++17 compile.

    Raises:
        KernelArgumentError: The method does not apply, with the reason.
    """
    argument = {"path": fspath(path), "method": method, "sizes": dict(sizes)}
    return str(_run("coadjoint.bounded:header_record", argument, seconds, memory)["text"])


def explore_bounded(
    path: str | PathLike[str],
    *,
    sizes: Mapping[str, int] = MappingProxyType({}),
    seconds: float | None = None,
    memory: int = WORKER_BYTES,
) -> str:
    """A web page that simulates a system with its generated code, made in a bounded child.

    Arguments and errors are those of `derive_bounded`.

    Returns:
        The text of an HTML file that needs no other file and no network.

    Raises:
        KernelArgumentError: The page shows no such system, with the reason.
    """
    argument = {"path": fspath(path), "sizes": dict(sizes)}
    return str(_run("coadjoint.bounded:page_record", argument, seconds, memory)["text"])


def lattice_bounded(
    path: str | PathLike[str],
    bodies: int | None = None,
    *,
    sizes: Mapping[str, int] = MappingProxyType({}),
    seconds: float | None = None,
    memory: int = WORKER_BYTES,
) -> str:
    """The spec of the lattice of a strand, made in a bounded child.

    Other arguments and errors are those of `derive_bounded`; ``bodies`` is how many there are, by
    default as many as the strand has points.

    Returns:
        The text of `coadjoint.write_lattice`.
    """
    argument = {"path": fspath(path), "bodies": bodies, "sizes": dict(sizes)}
    return str(_run("coadjoint.bounded:lattice_record", argument, seconds, memory)["text"])


def _run(
    target: str, argument: Mapping[str, Any], seconds: float | None, memory: int
) -> dict[str, Any]:
    """A function of one spec in a bounded child."""
    record: dict[str, Any] = run_bounded(
        target,
        argument,
        seconds=allowed_seconds(seconds),
        memory=memory,
        subject=str(argument["path"]),
    )
    return record


def read_all_bounded(
    paths: Sequence[str], *, seconds: float | None = None, memory: int = WORKER_BYTES
) -> list[dict[str, Any] | CoadjointError]:
    """What each of many specs declares, or the error of reading it, in the order of the paths.

    One child reads them all. Where it is lost, the spec that it was reading is the cause; those
    before are read again, and another child goes on behind it, so that one hostile spec keeps
    nobody from the others.

    Args:
        paths: Specs in TOML.
        seconds: Processor time for each child; see `coadjoint.budget.allowed_seconds`.
        memory: Limit of address space, bytes.
    """
    allowed, done = allowed_seconds(seconds), 0

    def note(_stage: str, number: int, _total: int) -> None:
        nonlocal done
        done = number

    try:
        records = run_bounded(
            "coadjoint.bounded:read_records",
            list(paths),
            seconds=allowed,
            memory=memory,
            on_progress=note,
            subject=paths[0] if len(paths) == 1 else f"{len(paths)} specs",
        )
    except ResourceError as error:
        if len(paths) == 1:
            return [error]
        parts = (paths[:done], paths[done : done + 1], paths[done + 1 :])
        again = [read_all_bounded(part, seconds=allowed, memory=memory) for part in parts if part]
        return [each for part in again for each in part]
    return [from_record(each["error"]) if "error" in each else each for each in records]


@prepared_by("coadjoint.spec")
def read_records(paths: Sequence[str]) -> list[dict[str, Any]]:
    """What specs declare, as plain JSON values; runs in a bounded child."""
    from coadjoint.spec import read_spec  # SymPy loads here, in the child, and never in the parent

    records: list[dict[str, Any]] = []
    for number, path in enumerate(paths):
        report_progress(f"read {path}", number, len(paths))
        try:
            records.append(describe_declared(read_spec(path)))
        except CoadjointError as error:
            records.append({"error": error.as_record()})
    return records


def describe_declared(spec: Spec) -> dict[str, Any]:
    """What a spec declares."""
    return {
        "name": spec.name,
        "title": spec.title,
        "source": spec.source,
        "description": spec.description,
        "license": spec.license,
        "routes": list(spec.routes),
        "state": [name for each in spec.state for name in each.components],
        "parameters": [name for each in spec.parameters for name in each.components],
        "sha256": spec.sha256,
    }


@prepared_by("coadjoint.derive.document")
def document_record(argument: Mapping[str, Any]) -> dict[str, Any]:
    """A derivation as plain JSON values; runs in a bounded child."""
    from coadjoint.derive import derive
    from coadjoint.derive.document import document
    from coadjoint.spec import read_spec

    report_progress("derive", 0, 1)
    spec = read_spec(Path(argument["path"]), argument.get("sizes", {}))
    equations = derive(spec, argument["route"])
    return asdict(document(equations))


@prepared_by("coadjoint.prove")
def certificate_record(argument: Mapping[str, Any]) -> dict[str, Any]:
    """The certificate of a spec as JSON values, times included; runs in a bounded child."""
    from coadjoint.prove import prove
    from coadjoint.spec import read_spec

    report_progress("prove", 0, 1)
    certificate = prove(read_spec(Path(argument["path"]), argument.get("sizes", {})))
    entries = {
        name: [entry.as_record() | {"seconds": entry.seconds} for entry in group]
        for name, group in (("claims", certificate.claims), ("findings", certificate.findings))
    }
    return {
        "system": certificate.system,
        "holds": certificate.holds,
        "failures": [*certificate.explain_failures()],
        **entries,
    }


def _render(argument: Mapping[str, Any]) -> tuple[Spec, Rendered]:
    """A spec and its files, the stages told."""
    from coadjoint.pipeline import render
    from coadjoint.spec import read_spec

    spec = read_spec(Path(argument["path"]), argument.get("sizes", {}))
    stages = ("derive", "lower", "prove", "render")
    rendered = render(spec, lambda stage: report_progress(stage, stages.index(stage), len(stages)))
    return spec, rendered


@prepared_by("coadjoint.pipeline:prepare")
def methods_record(argument: Mapping[str, Any]) -> dict[str, Any]:
    """Methods of integration, judged, as plain JSON values; runs in a bounded child."""
    spec, rendered = _render(argument)
    record = json.loads(rendered.texts["certificate.json"])
    judged = {key: record.get(key, empty) for key, empty in (("structure", {}), ("methods", []))}
    return {"system": spec.name, **judged}


@prepared_by("coadjoint.pipeline:prepare")
def header_record(argument: Mapping[str, Any]) -> dict[str, Any]:
    """A method as a header, as plain JSON values; runs in a bounded child."""
    from coadjoint.export import export_header

    _, rendered = _render(argument)
    return {"text": export_header(rendered, argument["method"])}


@prepared_by("coadjoint.pipeline:prepare")
def page_record(argument: Mapping[str, Any]) -> dict[str, Any]:
    """A page that simulates a system, as plain JSON values; runs in a bounded child."""
    from coadjoint.explore.page import render_page

    spec, rendered = _render(argument)
    return {"text": render_page(spec, rendered)}


@prepared_by("coadjoint.bodies")
def lattice_record(argument: Mapping[str, Any]) -> dict[str, Any]:
    """The lattice of a strand, as plain JSON values; runs in a bounded child."""
    from coadjoint.bodies import write_lattice
    from coadjoint.spec import read_spec

    report_progress("derive", 0, 1)
    spec = read_spec(Path(argument["path"]), argument["sizes"])
    return {"text": write_lattice(spec, argument["bodies"])}
