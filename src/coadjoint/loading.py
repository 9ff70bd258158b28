"""Load: a user's spec becomes a System, derived, proved, compiled and kept in the cache.

Comes in: the path of a spec. Goes out: the same kind of object as a shipped system. The work is
that of `coadjoint regenerate`, into a private folder of the cache; an unchanged spec loads at once
and without SymPy.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from types import MappingProxyType

from coadjoint.bounded import lattice_bounded
from coadjoint.build.cache import cache_folder, note_use, replace_file
from coadjoint.errors import check_type
from coadjoint.fingerprint import digest
from coadjoint.regenerate import Progress, is_written_out, regenerate
from coadjoint.solve.family import lacks_size
from coadjoint.solve.folders import load_folder
from coadjoint.solve.system import System


def load(
    path: str | PathLike[str],
    *,
    sizes: Mapping[str, int] = MappingProxyType({}),
    derivatives: str = "differences",
    seconds: float | None = None,
    progress: Progress | None = None,
) -> System:
    """Derive, prove, compile and load the system of a spec file.

    Deriving runs in a child whose processor time and memory are bounded, so that a spec of a
    stranger can be loaded; nothing of the spec's text is ever run as it stands.

    Args:
        path: A spec in TOML.
        sizes: How many members an index counts, by its name: ``{"i": 1000}``. Where kernels loop
            over the members they are the same for all sizes; else each size is derived.
        derivatives: Those of fields along space: ``"differences"``, of the order that the spec
            says, or ``"fourier"``, as in `System.with_derivatives`. With ``"lattice"`` a strand on
            so(3) or se(3) becomes the lattice of as many bodies as it has points, with attitudes
            and places instead of strains: the system of the spec that `coadjoint.write_lattice`
            writes.
        seconds: Processor time that deriving may take; by default the environment variable
            ``COADJOINT_SECONDS``, else ``WORKER_SECONDS`` of docs/limits.md.
        progress: Told of every stage: system, stage, stages done, stages in all. By default they
            are shown on standard error where that is a terminal or a notebook.

    Raises:
        SpecError: The file is not a spec.
        DerivationError: Its equations cannot be derived.
        ClaimError: One of its claims is false.
        CrossCheckError: Two forms of one function disagree.
        ResourceError: Deriving took more time or memory than it may, or so many members take more
            memory than there is.
        KernelArgumentError: A size is none of a spec's index, or too small.
    """
    check_type("load", path, (str, PathLike), 'the path of a spec, "my.toml"')
    source = Path(path)
    if derivatives == "lattice":
        source = _keep_lattice(source, sizes, seconds)
        sizes, derivatives = MappingProxyType({}), "differences"
    # One folder for each place of a spec, so that equal names of different people do not collide.
    place = str(source.resolve())
    if sizes and is_written_out(source, sizes, seconds):
        folder = cache_folder() / "systems" / digest([place, dict(sizes)])[:16]
        own = sizes
    else:
        folder, own = cache_folder() / "systems" / digest(place)[:16], MappingProxyType({})
    with _tell(progress) as told:
        outcome = regenerate(
            [source], folder, seconds=seconds, sizes=own, loads=True, progress=told
        )
    for error in outcome.failures.values():
        raise error
    note_use(folder)
    system = load_folder(folder / source.stem)
    chosen = {} if own else sizes
    system = system.with_derivatives(derivatives)  # which may need fewer points
    return system.resize(chosen) if chosen or lacks_size(system) else system


def _keep_lattice(strand: Path, sizes: Mapping[str, int], seconds: float | None) -> Path:
    """The spec of the lattice of a strand, in the cache.

    Raises:
        CoadjointError: What `coadjoint.write_lattice` raises.
    """
    text = lattice_bounded(strand, sizes=sizes, seconds=seconds)
    folder = cache_folder() / f"lattice-{digest([str(strand.resolve()), dict(sizes)])[:16]}"
    path = folder / f"{strand.stem[:23]}_lattice.toml"  # a name has at most 31 letters
    replace_file(path, text.encode("utf-8"))
    return path


@contextmanager
def _tell(progress: Progress | None) -> Iterator[Progress]:
    """Who is told of stages: whom the caller names, else a terminal or a notebook, else nobody."""
    if progress is not None:
        yield progress
        return
    notebook = "ipykernel" in sys.modules  # which shows what is written to stderr as a failure
    stream = sys.stdout if notebook else sys.stderr
    shown = stream is not None and (notebook or stream.isatty())

    def tell(system: str, stage: str, done: int, total: int) -> None:
        stream.write(f"\r{system}: {stage} ({done} of {total})".ljust(60))
        stream.flush()

    try:
        yield tell if shown else lambda *_: None
    finally:
        if shown:
            stream.write("\r" + " " * 60 + "\r")
