"""Regenerate: many systems through the pipeline in bounded children, and what passed written.

Comes in: spec files and an output folder. Goes out: rows of a table, and the generated folder,
replaced atomically with its manifest last. Nothing is written for a system that fails a rung, and
nothing at all if any fails; an unchanged system is not derived again. Read next:
`coadjoint.render.write`.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import asdict, dataclass, field, fields
from hashlib import sha256
from math import inf
from pathlib import Path
from time import perf_counter
from types import MappingProxyType
from typing import Any

from coadjoint import limits
from coadjoint.budget import allowed_seconds
from coadjoint.build.cache import cache_folder, replace_file
from coadjoint.build.compiler import compiler_version
from coadjoint.errors import CoadjointError, DriftError, OutputError, SpecError, system_error
from coadjoint.files import read_object, read_regular
from coadjoint.fingerprint import digest, engine_fingerprint, template_hashes
from coadjoint.render.compare import compare_tree, is_intact
from coadjoint.render.ownership import PACKAGE, list_leftovers, make_plan, read_manifest
from coadjoint.render.write import (
    SYSTEM_FILES,
    GeneratedSystem,
    manifest_text,
    tree_texts,
    write_systems,
)
from coadjoint.sandbox import Children, run_bounded
from coadjoint.sandbox_child import prepared_by, report_progress
from coadjoint.spec.core.faults import list_names
from coadjoint.spec.core.names import system_refusal
from coadjoint.spec.reader import read_file

#: Called with system, stage, number of stages done, number of stages.
Progress = Callable[[str, str, int, int], None]


@dataclass(frozen=True)
class Row:
    """One line of the final table.

    Attributes:
        system: Name of the system.
        dimension: Number of state components.
        routes: Routes followed, the emitted one first.
        proved: Claims proved.
        supported: Claims that are numerically supported and not proved, as the spec accepts.
        claims: Claims in all.
        operations: Floating-point operations of ``rhs`` for one member; of equal members without
            those of its pairs.
        k: Largest error against 50 digits, in units of 2^-53 times the envelope.
        targets: Targets that were checked.
        seconds: How long it took; 0 if nothing was to do.
        fresh: Whether the system was derived in this run.
        pair_operations: Of equal members, those of a pair for both of them; 0 without pairs.
    """

    system: str
    dimension: int
    routes: tuple[str, ...]
    proved: int
    supported: int
    claims: int
    operations: int
    k: float
    targets: tuple[str, ...]
    seconds: float
    fresh: bool
    pair_operations: int = 0


@dataclass(frozen=True)
class Outcome:
    """The result of one run.

    Attributes:
        rows: Systems that passed, in the order of the specs.
        failures: Errors of the others, by system.
    """

    rows: tuple[Row, ...]
    failures: Mapping[str, CoadjointError]


@dataclass(frozen=True)
class _Source:
    """One spec on its way: its file, its bytes' hash, and the fingerprint of what it yields."""

    path: Path
    sha256: str
    sizes: Mapping[str, int] = field(default_factory=dict)

    @property
    def name(self) -> str:
        return self.path.stem

    @property
    def fingerprint(self) -> str:
        """Hash of all that the verified output depends on, the compiler included.

        Raises:
            CompilerError: It does not work, which is said once, before any system is worked on.
        """
        compiler = compiler_version()
        engine = engine_fingerprint()
        spec = [self.name, self.sha256, *([dict(self.sizes)] if self.sizes else [])]
        return digest({"engine": engine, "compiler": compiler, "spec": spec})


def regenerate(
    paths: Sequence[Path],
    output: Path,
    *,
    jobs: int = 1,
    complete: bool = False,
    seconds: float | None = None,
    sizes: Mapping[str, int] = MappingProxyType({}),
    loads: bool = False,
    progress: Progress = lambda *_: None,
    on_wait: Callable[[], None] = lambda: None,
) -> Outcome:
    """Derive, prove, check and write systems that have changed.

    Args:
        paths: Spec files; the stem is the system's name.
        output: The generated folder.
        jobs: How many systems are worked on at a time.
        complete: Whether these are all the systems of the folder; others are then removed.
        seconds: Processor time for each system; see `coadjoint.budget.allowed_seconds`.
        sizes: How many members an index counts, by its name, where all are written out.
        loads: Whether the systems are loaded next: kernels are compiled as users run them.
        progress: Told of every stage of every system.
        on_wait: Called if another run holds the lock of the folder.

    Returns:
        A row for each system that passed and the errors of the others, of which nothing is written.

    Raises:
        SpecError: A file cannot be read.
        OutputError: The folder cannot be written; what stood there is untouched.
    """
    sources, allowed = _sources(paths, sizes), allowed_seconds(seconds)
    rows = {source.name: row for source in sources if (row := _unchanged_row(source, output))}
    pending = [source for source in sources if source.name not in rows]
    keep = {source.name for source in sources} if complete else None
    _refuse_early(output, pending, keep)
    records, failures = _build_all(pending, output, jobs, allowed, progress, loads=loads)
    if records or not _is_current(output, keep):
        systems = {name: _generated_system(record) for name, record in records.items()}
        write_systems(output, systems, template_hashes(), keep, on_wait)
    for source in pending:
        if source.name in records:
            rows[source.name] = _row(records[source.name]["row"])
            _remember(source, records[source.name])
    return Outcome(tuple(rows[s.name] for s in sources if s.name in rows), failures)


def check(
    paths: Sequence[Path],
    output: Path,
    *,
    jobs: int = 1,
    complete: bool = False,
    seconds: float | None = None,
    progress: Progress = lambda *_: None,
) -> Outcome:
    """Derive everything afresh and compare with what is checked in; nothing is written.

    Arguments are those of `regenerate`; where these are all the systems, others are extra.

    Raises:
        DriftError: Files are missing, extra or changed; its ``differences`` list them.
    """
    sources = _sources(paths)
    records, failures = _build_all(sources, output, jobs, allowed_seconds(seconds), progress)
    systems = {name: _generated_system(record) for name, record in records.items()}
    entries = {name: system.record() for name, system in systems.items()}
    if not complete:
        entries = read_manifest(output)["systems"] | entries
    fresh = tree_texts(systems, manifest_text(entries, template_hashes()))
    differences = [
        difference
        for difference in compare_tree(fresh, output)
        if complete or _is_concerned(difference.path, records)
    ]
    if differences:
        extra = any(each.kind == "extra" for each in differences)
        raise DriftError(
            f"{output}: {len(differences)} of the generated files differ from a fresh run: "
            + list_names((f"{each.path} ({each.kind})" for each in differences), 8)
            + ". Run `coadjoint regenerate` and commit what it writes"
            + ("; it leaves extra files that no run wrote." if extra else "."),
            path=str(output),
            differences=[asdict(each) for each in differences],
        )
    return Outcome(
        tuple(_row(records[s.name]["row"]) for s in sources if s.name in records), failures
    )


def _row(record: Mapping[str, Any]) -> Row:
    """A row from JSON values, which know no tuples."""
    return Row(**{**record, "routes": tuple(record["routes"]), "targets": tuple(record["targets"])})


def _is_row(record: Any) -> bool:
    """Whether JSON values make a row, of which the table is printed."""
    if not isinstance(record, dict) or record.keys() != {each.name for each in fields(Row)}:
        return False
    texts = all(
        isinstance(record[key], list) and all(isinstance(each, str) for each in record[key])
        for key in ("routes", "targets")
    )
    counts = record.keys() - {"system", "routes", "targets"}
    numbers = all(isinstance(record[key], int | float) for key in counts)
    return texts and numbers and isinstance(record["system"], str)


def _is_concerned(path: str, records: Mapping[str, Any]) -> bool:
    """Whether a path belongs to the systems at hand or to the tree as a whole."""
    return "/" not in path or path.split("/")[0] in records


def is_written_out(path: Path, sizes: Mapping[str, int], seconds: float | None = None) -> bool:
    """Whether all members of a spec are written out, so that each size has kernels of its own.

    What a spec says of that is read in a bounded child, and remembered.

    Raises:
        CoadjointError: The spec is not in order, or has no such size.
    """
    (source,) = _sources([path], sizes)
    stamp = cache_folder() / "members" / f"{source.fingerprint}.json"
    written = read_object(stamp).get("written")
    if not isinstance(written, bool):
        record = run_bounded(
            "coadjoint.regenerate:tell_written",
            {"path": str(path), "sizes": dict(sizes)},
            seconds=allowed_seconds(seconds),
            memory=limits.WORKER_BYTES,
            subject=str(path),
        )
        written = bool(record["written"])
        with suppress(OSError):
            replace_file(stamp, json.dumps({"written": written}).encode("ascii"))
    return written


@prepared_by("coadjoint.spec")
def tell_written(argument: Mapping[str, Any]) -> dict[str, Any]:
    """Whether all members of a spec are written out; runs in a bounded child."""
    from coadjoint.spec import read_spec

    report_progress("read", 0, 1)
    return {"written": bool(read_spec(argument["path"], argument["sizes"]).written)}


def _sources(
    paths: Sequence[Path], sizes: Mapping[str, int] = MappingProxyType({})
) -> list[_Source]:
    """Spec files with their hashes.

    Raises:
        SpecError: A file cannot be read, or two have one name.
    """
    sources = [_Source(path, sha256(read_file(str(path))).hexdigest(), sizes) for path in paths]
    names = [source.name for source in sources]
    doubled = sorted({name for name in names if names.count(name) > 1})
    if doubled:
        raise SpecError(
            f"two specs are called {doubled[0]!r}; expected one file for each name. Rename one.",
            found=doubled[0],
        )
    return sources


# -- what need not be done again -----------------------------------------------------


def _refuse_early(output: Path, pending: Sequence[_Source], keep: set[str] | None) -> None:
    """Refuse, before any work, a folder in which what is to be written may not stand.

    Raises:
        OutputError: Something that no run wrote is in the way, or the folder cannot be read.
    """
    names = [source.name for source in pending if system_refusal(source.name) is None]
    try:
        make_plan(output, dict.fromkeys(names, SYSTEM_FILES), keep)
    except OSError as error:
        raise system_error(error) or OutputError(
            f"{output}: cannot be read: {error.strerror or error}. Check permissions, or choose "
            "another folder with --output.",
            path=str(output),
            found=error.strerror or str(error),
        ) from error


def _is_current(output: Path, names: set[str] | None) -> bool:
    """Whether the manifest lists these systems and the present templates."""
    manifest = read_manifest(output)
    if any(not _has_text(output / file, text) for file, text in PACKAGE.items()):
        return False
    if any(list_leftovers(output)):
        return False
    same = names is None or manifest["systems"].keys() == names
    return bool(same and manifest["templates"] == template_hashes())


def _has_text(path: Path, text: str) -> bool:
    """Whether a file has exactly this text."""
    with suppress(OSError):
        return read_regular(path) == text.encode()
    return False


def _unchanged_row(source: _Source, output: Path) -> Row | None:
    """The row of a system whose files are those of an earlier, verified run; else None.

    What was verified is remembered in the private cache of this machine, by fingerprint.
    """
    kept = read_object(_stamp(source))
    entry = read_manifest(output)["systems"].get(source.name)
    row: Any = kept.get("row")
    if not _is_row(row) or entry is None or kept.get("entry") != entry:
        return None  # nor does a damaged stamp count
    if not is_intact(output, source.name):
        return None
    return _row({**row, "seconds": 0.0, "fresh": False})


def _remember(source: _Source, record: Mapping[str, Any]) -> None:
    """Keep what a run has verified; if that fails, the next run verifies again."""
    content = {"entry": _generated_system(record).record(), "row": record["row"]}
    with suppress(OSError):
        replace_file(_stamp(source), json.dumps(content).encode("ascii"))


def _stamp(source: _Source) -> Path:
    return cache_folder() / "verified" / f"{source.fingerprint}.json"


def _generated_system(record: Mapping[str, Any]) -> GeneratedSystem:
    """A record from a child as what the writer takes."""
    return GeneratedSystem(record["texts"], record["spec_sha256"], record["route"])


# -- building, in bounded children ---------------------------------------------------


def _build_all(
    sources: Sequence[_Source],
    output: Path,
    jobs: int,
    seconds: int,
    progress: Progress,
    *,
    loads: bool = False,
) -> tuple[dict[str, dict[str, Any]], dict[str, CoadjointError]]:
    """Records of the systems that passed, and errors of the others in the order of the specs."""
    records: dict[str, dict[str, Any]] = {}
    failures: dict[str, CoadjointError] = {}
    children = Children()
    compiler_version()  # one that hangs is found out here, not in every child

    def run(source: _Source) -> None:
        def report(stage: str, done: int, total: int) -> None:
            progress(source.name, stage, done, total)

        try:
            records[source.name] = run_bounded(
                "coadjoint.regenerate:build_record",
                {"path": str(source.path), "sizes": dict(source.sizes), "loads": loads},
                seconds=seconds,
                memory=limits.WORKER_BYTES,
                on_progress=report,
                children=children,
                subject=str(source.path),
            )
        except CoadjointError as error:
            failures[source.name] = error

    # Threads only wait for children; a lost child is an error of its system, never a hang.
    pool = ThreadPoolExecutor(max_workers=max(1, jobs))
    try:
        list(pool.map(run, sorted(sources, key=lambda source: _guess_work(source, output))))
    finally:  # Ctrl-C arrives here, in the main thread, while the others wait
        children.stop()
        pool.shutdown(cancel_futures=True)
    return records, {each.name: failures[each.name] for each in sources if each.name in failures}


def _guess_work(source: _Source, output: Path) -> float:
    """A key that puts the longest work first, so that no job waits for it at the end.

    The text of the kernel that stands in the folder tells how long it is; new systems come first.
    """
    with suppress(OSError):
        return -(output / source.name / "kernel.c").stat().st_size
    return -inf


@prepared_by("coadjoint.pipeline:prepare")
def build_record(argument: Mapping[str, Any]) -> dict[str, Any]:
    """One system through the pipeline, as plain JSON values; runs in a bounded child."""
    # SymPy loads here, in the child, and never in the parent.
    from coadjoint import pipeline
    from coadjoint.prove import Verdict
    from coadjoint.spec import read_spec

    start = perf_counter()
    spec = read_spec(Path(argument["path"]), argument.get("sizes", {}))
    total = len(pipeline.STAGES)

    def progress(stage: str) -> None:
        report_progress(stage, pipeline.STAGES.index(stage), total)

    rendered = pipeline.render(spec, progress)
    report = pipeline.verify(rendered, progress, loads=argument.get("loads", False))
    report_progress("done", total, total)
    row = Row(
        system=spec.name,
        dimension=len(rendered.programs["rhs"].state),
        routes=spec.routes,
        proved=rendered.certificate.count(Verdict.PROVED),
        supported=rendered.certificate.count(Verdict.SUPPORTED),
        claims=len(rendered.certificate.claims),
        operations=sum(rendered.programs["rhs"].operation_counts().values()),
        k=report.k,
        targets=report.targets,
        seconds=perf_counter() - start,
        fresh=True,
        pair_operations=rendered.pair_operations,
    )
    return {
        "row": asdict(row),
        "texts": rendered.texts,
        "spec_sha256": spec.sha256,
        "route": spec.routes[0],
    }
