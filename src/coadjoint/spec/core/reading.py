"""Reading: the protocol of a table of a spec, and what has been read of one spec so far.

Comes in: a validated file and the list of all tables. Goes out: the record of each table, read
when it is first asked for, so that the order follows from what the tables need of each other. Each
name is declared once and is refused if it is taken.
Read next: `coadjoint.spec.sections.time`, a short table, then `coadjoint.spec.tables`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Generic, TypeVar

from coadjoint.errors import CoadjointError, LimitError
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.faults import did_you_mean, listed
from coadjoint.spec.core.formulas import (
    DRIVING,
    Declared,
    Formula,
    Quantity,
    Scope,
    make_scope,
    read_formula,
)
from coadjoint.spec.core.names import refusal
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source

Record = TypeVar("Record")


@dataclass(frozen=True)
class Naming:
    """A name that a spec declares, with the names that follow from it.

    Attributes:
        key: Where it is declared.
        name: The name.
        components: Names of its components.
        rates: Names of their time derivatives, where it moves.
        why: What to say if one of these names is taken; "" for nothing special.
        allowed: A reserved name that it may have.
    """

    key: KeyPath
    name: str
    components: tuple[str, ...] = ()
    rates: tuple[str, ...] = ()
    why: str = ""
    allowed: str = ""


def names_in(table: str) -> Callable[[Sequence[Any]], list[Naming]]:
    """What names the records of a table declare, each at its own key."""
    return lambda records: [
        Naming((table, each.name), each.name, each.components) for each in records
    ]


def if_present(formula: Formula | None) -> tuple[Formula, ...]:
    """A formula, unless there is none."""
    return () if formula is None else (formula,)


def _nothing(record: Any) -> tuple[()]:
    return ()


@dataclass(frozen=True, kw_only=True)
class Table(Generic[Record]):
    """One table of a spec: its keys, its record, what it declares, and its formulas.

    Attributes:
        key: Its name in a spec.
        kind: What may stand there, as an annotation for pydantic.
        field: Its default and description, a pydantic field.
        read: The record, from all that has been read. It asks other tables by `of`.
        attribute: The attribute of a `Spec` that is the record; by default the key. With None, the
            fields of the record are attributes themselves.
        quantities: What formulas of other tables may name.
        names: The names that the record declares.
        formulas: Every formula of the record; with no attribute, of the `Spec`.
        routed: Whether it is there for routes alone, so that one of them must use it.
        acts: Whether it acts on the motion, so that every route must know it.
        example: A line of it, for messages; "" if messages show none.
    """

    key: str
    kind: Any
    field: Any
    read: Callable[[Reading], Record]
    attribute: str | None = ""
    quantities: Callable[[Record], Sequence[Declared]] | None = None
    names: Callable[[Record], Iterable[Naming]] = _nothing
    formulas: Callable[[Any], Iterable[Formula]] = _nothing
    routed: bool = False
    acts: bool = False
    example: str = ""

    def of(self, reading: Reading) -> Record:
        """The record of this table."""
        record: Record = reading.record(self)
        return record

    def quantities_of(self, reading: Reading) -> Sequence[Declared]:
        """What formulas of other tables may name; other tables are not read for it."""
        return () if self.quantities is None else self.quantities(self.of(reading))

    @property
    def place(self) -> str | None:
        """The attribute of a `Spec` that is the record, or None."""
        return self.key if self.attribute == "" else self.attribute

    def formulas_in(self, spec: Any) -> Iterable[Formula]:
        """Every formula that a `Spec` has from this table."""
        return self.formulas(self.in_spec(spec))

    def in_spec(self, spec: Any) -> Any:
        """The record of this table in a `Spec`."""
        if self.place is None:
            return spec
        return spec.records[self.key] if self.key in spec.records else getattr(spec, self.place)


class Reading:
    """The reading of one spec.

    Args:
        source: The text of the spec.
        file: The checked tables, one attribute for each.
        name: Name of the system.
        tables: All tables that a spec may have.
    """

    def __init__(self, source: Source, file: Any, name: str, tables: Sequence[Table[Any]]) -> None:
        self.source, self.file, self.name, self.tables = source, file, name, tables
        self.owners: dict[str, Naming] = {}
        self._records: dict[str, Any] = {}
        self._open: list[str] = []

    def record(self, table: Table[Any]) -> Any:
        """The record of a table, read once."""
        if table.key not in self._records:
            assert table.key not in self._open, (*self._open, table.key)
            self._open.append(table.key)
            record = table.read(self)
            self._records[table.key] = record
            self._open.pop()
            for naming in table.names(record):
                self.declare(naming)
        return self._records[table.key]

    # -- names --------------------------------------------------------------------------

    def declare(self, naming: Naming) -> None:
        """Take a name and those that follow from it.

        Raises:
            SpecError: One is reserved or taken, with a suggestion.
        """
        for derived in dict.fromkeys((naming.name, *naming.components)):
            refused = refusal(derived)
            if refused is not None and derived != naming.allowed:
                problem, expected, hint = refused
                if derived != naming.name:
                    problem = f"{problem}, and so would be a component of {naming.name!r}"
                    hint = "Choose another name."
                raise self.at_key(naming.key, problem, derived, expected, hint)
        every = dict.fromkeys((naming.name, *naming.components, *naming.rates))
        for derived in every:
            if derived in self.owners:
                raise self._doubled(derived, naming, self.owners[derived])
        self.owners |= dict.fromkeys(every, naming)

    def _doubled(self, derived: str, naming: Naming, owner: Naming) -> CoadjointError:
        """An error for a name that two things would have."""
        problem = f"{derived!r} is doubled: {owner.key[0]}.{owner.name} has that name too"
        usual = "Rename one of them; the components of I with shape [3] are I1, I2, I3."
        hint = naming.why or owner.why or usual
        return self.at_key(naming.key, problem, derived, "names and components that differ", hint)

    # -- formulas -----------------------------------------------------------------------

    @cached_property
    def quantities(self) -> tuple[Declared, ...]:
        """Everything declared that a formula may name, if it is in its scope."""
        return tuple(q for table in self.tables for q in table.quantities_of(self))

    def scope(
        self,
        kind: str,
        roles: tuple[str, ...],
        others: Mapping[str, Shape] | Iterable[str] = (),
        *,
        driven: Sequence[str] = DRIVING,
    ) -> Scope:
        """The scope of a kind of formula; see `make_scope`."""
        return make_scope(kind, roles, self.quantities, others, driven=driven)

    def formula(self, key: KeyPath, text: str, scope: Scope, *, any_shape: bool = False) -> Formula:
        """The formula at a key; see `read_formula`."""
        return read_formula(self.source, key, text, scope, any_shape=any_shape)

    # -- faults -------------------------------------------------------------------------

    def at_key(
        self, key: KeyPath, problem: str, found: Any, expected: str, hint: str = ""
    ) -> CoadjointError:
        """An error that points at a key and not at its value."""
        at = self.source.positions.key(key)
        return self.source.fault(key, problem, found=found, expected=expected, hint=hint, at=at)

    def unknown(
        self, key: KeyPath, what: str, name: str, known: Iterable[str], otherwise: str
    ) -> CoadjointError:
        """An error for a name at a key that nothing has."""
        names = list(known)
        return self.at_key(
            key,
            f"there is no {what} {name!a}",
            name,
            f"one of {listed(names)}" if names else otherwise,
            did_you_mean(name, names),
        )

    def check_count(
        self, what: str, table: str, quantities: Iterable[Quantity], limit: str, most: int
    ) -> None:
        """Refuse too many components.

        Raises:
            LimitError: There are.
        """
        count = sum(len(quantity.components) for quantity in quantities)
        if count > most:
            raise self.source.fault(
                (table,),
                f"the {what} have {count} components",
                found=count,
                expected=f"at most {most} ({limit})",
                kind=LimitError,
                limit=limit,
            )
