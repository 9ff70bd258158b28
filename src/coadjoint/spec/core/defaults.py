"""Defaults: one exact number for each component of a quantity.

Comes in: a number, or lists of numbers, as `coadjoint.spec.core.values` checked them. Goes out: one
fraction for each component, row by row. Read next: `coadjoint.spec.sections.parameters`.
"""

from __future__ import annotations

from fractions import Fraction

from coadjoint.errors import CoadjointError
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.faults import listed
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source


def read_default(
    source: Source, key: KeyPath, value: object, shape: Shape
) -> tuple[Fraction, ...] | None:
    """The declared default, one number for each component; None if there is none."""
    spread = None if value is None else _spread(value, shape)
    if spread is None and value is not None:
        raise source.fault(
            key,
            f"the default of {str(key[-2])!r} does not have its shape {list(shape)}",
            found=_shape_text(value),
            expected=f"one number for all components, or {_shape_words(shape)}",
        )
    return spread


def _spread(value: object, shape: Shape) -> tuple[Fraction, ...] | None:
    """One number for each component, row by row; None if the shape does not fit."""
    if not isinstance(value, list):
        assert isinstance(value, Fraction), value
        count = 1
        for length in shape:
            count *= length
        return (value,) * count
    if not shape or len(value) != shape[0]:
        return None
    if len(shape) == 1:
        return None if any(isinstance(entry, list) for entry in value) else tuple(value)
    rows = [_spread(row, shape[1:]) for row in value if isinstance(row, list)]
    whole = [row for row in rows if row is not None]
    return tuple(x for row in whole for x in row) if len(whole) == shape[0] else None


def _shape_words(shape: Shape) -> str:
    if not shape:
        return "a single number"
    counts = [f"{shape[0]} numbers"] if len(shape) == 1 else [f"{shape[0]} lists of {shape[1]}"]
    return f"a list of {counts[0]}"


def _shape_text(value: object) -> str:
    """The lengths of nested lists, for a message."""
    if not isinstance(value, list):
        return "a number"
    inner = {len(row) if isinstance(row, list) else 1 for row in value}
    return f"a list of {len(value)}" + (
        f" lists of {listed(map(str, inner))}" if inner != {1} else ""
    )


def misfit_form(source: Source, key: KeyPath, count: int, form: str) -> CoadjointError:
    """A number of components that no matrix of a form keeps."""
    counts = {"antisymmetric": "n(n - 1)/2", "symmetric": "n(n + 1)/2", "matrix": "n^2"}
    return source.fault(
        key,
        f"{count} components fill no matrix of the form {form!r}",
        found=count,
        expected=f"{counts[form]} components for an n by n matrix",
        hint="Remove form, or choose another block, representation or shape.",
    )
