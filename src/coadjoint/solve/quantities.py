"""Quantities: what the rows of state, parameters and observables are called.

Comes in: the declarations of a generated package. Goes out: an immutable mapping from names to
rows, light to import.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from coadjoint.declared import Quantity
from coadjoint.errors import KernelArgumentError

#: Most names, or values, that are listed for a person.
LISTED = 9


class Quantities(Mapping[str, Quantity]):
    """Quantities by name, in the order of their rows.

    Attributes:
        components: Names of all rows.
        size: Number of rows.
        positive: Rows whose values must be positive.
        defaults: The default of each component that has one.

    >>> pair, scalar = Quantity("Pi", (2,), "1", ("Pi1", "Pi2")), Quantity("s", (), "1", ("s",))
    >>> state = Quantities(pair, scalar)
    >>> state.components, state.size, state.rows("Pi"), state.rows("s")
    (('Pi1', 'Pi2', 's'), 3, slice(0, 2, None), 2)
    """

    def __init__(self, *quantities: Quantity) -> None:
        self._by_name = {quantity.name: quantity for quantity in quantities}
        self._rows: dict[str, slice | int] = {}
        self.components = tuple(name for quantity in quantities for name in quantity.components)
        self.size = len(self.components)
        row = 0
        positive: list[int] = []
        for quantity in quantities:
            for n, component in enumerate(quantity.components):
                self._rows[component] = row + n
            if quantity.shape:
                self._rows[quantity.name] = slice(row, row + len(quantity.components))
            after = row + len(quantity.components)
            positive += range(row, after) if quantity.positive else ()
            row = after
        self.positive = tuple(positive)
        #: The defaults as a read-only array, once somebody has asked for them.
        self.packed: Any = None
        self.defaults = {
            component: value
            for quantity in quantities
            if quantity.default is not None
            for component, value in zip(quantity.components, quantity.default, strict=True)
        }

    def __getitem__(self, name: str) -> Quantity:
        return self._by_name[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._by_name)

    def __len__(self) -> int:
        return len(self._by_name)

    def rows(self, name: str) -> slice | int:
        """The rows of a quantity, or the row of a component.

        Raises:
            KernelArgumentError: No such name; the nearest one is suggested.
        """
        if name in self._rows:
            return self._rows[name]
        from difflib import get_close_matches  # not when a kernel is called first

        near = get_close_matches(str(name), self._rows, n=1)
        hint = f" Did you mean {near[0]!r}?" if near else ""
        raise KernelArgumentError(
            f"{name!r} is not one of {', '.join(self)}.{hint}", found=name, expected=list(self)
        )

    def has(self, name: str) -> bool:
        """Whether a name is that of a quantity or of a component."""
        return name in self._rows

    def of_component(self, name: str) -> Quantity:
        """The quantity that a name belongs to, whole or component."""
        if name in self._by_name:
            return self._by_name[name]
        return next(q for q in self.values() if name in q.components)

    @property
    def listed(self) -> str:
        """The names of the rows for a message: of many the first ones and the last."""
        return _list(self.components)

    def __reduce__(self) -> tuple[type[Quantities], tuple[Quantity, ...]]:
        """Pickled as the quantities alone; the rest is made of them again."""
        return Quantities, tuple(self.values())

    def table(self) -> list[tuple[str, ...]]:
        """Name, shape, unit and default of each as text, below their heads."""
        rows: list[tuple[str, ...]] = [("name", "shape", "unit", "default")]
        for q in self.values():
            default = _list([f"{value:g}" for value in q.default or ()])
            rows.append((q.name, str(q.shape), q.unit, default))
        return rows

    def __repr__(self) -> str:
        widths = [max(map(len, column)) for column in zip(*self.table(), strict=True)]
        lines = [
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
            for row in self.table()
        ]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        from coadjoint.notebook import show_quantities

        return show_quantities(self)


def _list(texts: Sequence[str]) -> str:
    """Texts in order; of many the first ones and the last.

    >>> _list(["a", "b"]), len(_list(["0"] * 30000))
    ('a, b', 30)
    """
    if len(texts) > LISTED:
        texts = [*texts[: LISTED - 1], "...", texts[-1]]
    return ", ".join(texts)
