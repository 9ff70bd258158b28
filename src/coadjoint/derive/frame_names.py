"""Names of the components of definitions that turn something by an attitude or a pose.

Comes in: a Spec. Goes out: names such as ``_y1`` for ``y = transpose(R)*x``, for which the field
has symbols. Read next: `coadjoint.lower.shared_frames`, which uses them where they save operations.
"""

from __future__ import annotations

from collections.abc import Iterator

from coadjoint.spec import Spec
from coadjoint.spec.core.components import component_names
from coadjoint.spec.core.definitions import Definition
from coadjoint.spec.core.tree import Index, Name, walk


def frame_components(spec: Spec) -> Iterator[tuple[Definition, tuple[str, ...]]]:
    """Each definition of a scalar or vector that names an attitude or a pose of the state."""
    turning = {each.name for each in spec.turning}
    for each in spec.definitions:
        if each.arguments or each.shape is None or len(each.shape) > 1:
            continue
        if any(n.name in turning for n in walk(each.tree) if isinstance(n, Name | Index)):
            yield each, component_names(f"_{each.name}", each.shape)


def symbols(spec: Spec) -> tuple[str, ...]:
    """All of these names."""
    return tuple(name for _, names in frame_components(spec) for name in names)
