"""Reading: the protocol of a table of a spec, and what has been read of one spec so far.

Comes in: a validated file and the list of all tables. Goes out: the record of each table, read
when it is first asked for, so that the order follows from what the tables need of each other. Each
name is declared once and is refused if it is taken.
Read next: `coadjoint.spec.sections.time`, a short table, then `coadjoint.spec.tables`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from typing import Annotated, Any, Generic, TypeVar

from pydantic import Field

from coadjoint import limits
from coadjoint.errors import CoadjointError
from coadjoint.spec.core.components import Shape
from coadjoint.spec.core.formulas import (
    DRIVING,
    Declared,
    Formula,
    HasComponents,
    Scope,
    make_scope,
    read_formula,
)
from coadjoint.spec.core.names import is_taken_in_c, refusal
from coadjoint.spec.core.parts import name_pattern
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.values import NAME_PATTERN

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


#: Tables of the numbers that generated steps read by their names.
_READ_IN_STEPS = ("variables", "parameters", "inputs", "time")


def name_each(key: str, records: Sequence[Any]) -> list[Naming]:
    """The names that the records of a table declare, each at its own key."""
    return [
        Naming(key=(key, each.name), name=each.name, components=each.components) for each in records
    ]


def name_none(key: str, record: Any) -> tuple[()]:
    """No names."""
    return ()


@dataclass(frozen=True)
class Table(Generic[Record]):
    """One table of a spec: its keys, its record and what it declares.

    Attributes:
        key: Its name in a spec.
        part: The model of its keys or, of a table of named entries, of one entry.
        description: What it is, for editors.
        read: The record, from all that has been read and the checked keys. It asks other tables for
            their records by `of`. A table that is left out has `absent` for a record.
        many: Whether it is a table of named entries.
        least: How many entries it has at least, if it is there.
        pattern: What the names of its entries look like.
        field: The annotation and the pydantic field of its key, where they are not the usual ones.
        absent: The record of a table that is left out; by default (), or None, of named entries
            and of others.
        always: Whether it is read even where it has no entries.
        attribute: The attribute of a `Spec` that is the record; by default the key. With None, the
            fields of the record are attributes themselves.
        quantities: Whether formulas of other tables may name the record, or the records in it; or
            what of it they may name.
        names: The names that the record declares, from the key and the record.
        routed: Whether it is there for routes alone, so that one of them must use it.
        acts: Whether it acts on the motion, so that every route must know it.
        example: A line of it, for messages; "" if messages show none.
    """

    key: str
    part: Any
    description: str
    read: Callable[[Reading, Any], Record]
    _: KW_ONLY
    many: bool = False
    least: int = 0
    pattern: str = NAME_PATTERN
    field: tuple[Any, Any] | None = None
    absent: Any = ...
    always: bool = False
    attribute: str | None = ""
    quantities: bool | Callable[[Record], Sequence[Declared]] = False
    names: Callable[[str, Record], Iterable[Naming]] = name_none
    routed: bool = False
    acts: bool = False
    example: str = ""

    def __post_init__(self) -> None:
        if self.absent is ...:
            object.__setattr__(self, "absent", () if self.many else None)

    def of(self, reading: Reading) -> Record:
        """The record of this table."""
        record: Record = reading.record(self)
        return record

    @property
    def place(self) -> str | None:
        """The attribute of a `Spec` that is the record, or None."""
        return self.key if self.attribute == "" else self.attribute

    @property
    def typed_field(self) -> tuple[Any, Any]:
        """The annotation of its key and its pydantic field."""
        if self.field is not None:
            return self.field
        if not self.many:
            return self.part | None, Field(None, description=self.description)
        kind: Any = dict[str, self.part]  # type: ignore[name-defined]
        about: dict[str, Any] = {
            "description": self.description,
            "json_schema_extra": name_pattern(self.pattern),
        }
        if self.least:
            return Annotated[kind, Field(min_length=self.least)] | None, Field(None, **about)
        return kind, Field({}, **about)

    def quantities_of(self, reading: Reading) -> tuple[Declared, ...]:
        """What formulas of other tables may name; tables without quantities are not read for it."""
        record: Any = self.of(reading) if self.quantities else ()
        if callable(self.quantities):
            record = tuple(self.quantities(record))
        return record if isinstance(record, tuple) else tuple(filter(None, (record,)))


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
        self.fault, self.at_key, self.unknown = source.fault, source.at_key, source.unknown
        self.owners: dict[str, Naming] = {}
        self._records: dict[str, Any] = {}
        self._open: list[str] = []

    def record(self, table: Table[Any]) -> Any:
        """The record of a table, read once."""
        if table.key not in self._records:
            assert table.key not in self._open, (*self._open, table.key)
            self._open.append(table.key)
            part = getattr(self.file, table.key)
            is_absent = part is None or (table.many and not part and not table.always)
            record = table.absent if is_absent else table.read(self, part)
            self._records[table.key] = record
            self._open.pop()
            for naming in table.names(table.key, record):
                self.declare(naming)
        return self._records[table.key]

    # -- names --------------------------------------------------------------------------

    def declare(self, naming: Naming) -> None:
        """Take a name and those that follow from it.

        Raises:
            SpecError: One is reserved or taken, with a suggestion.
        """
        for derived in dict.fromkeys((naming.name, *naming.components)):
            is_read = naming.key[0] in _READ_IN_STEPS and derived in naming.components
            refused = refusal(derived) if is_read or not is_taken_in_c(derived) else None
            if refused is not None and derived != naming.allowed:
                problem, expected, hint = refused
                if derived != naming.name:
                    problem = f"{problem}, and so would be a component of {naming.name!r}"
                    hint = "Choose another name."
                raise self.at_key(naming.key, problem, derived, expected, hint)
        every = dict.fromkeys((naming.name, *naming.components, *naming.rates))
        for derived in every:
            if derived in self.owners:
                raise self._explain_doubled(derived, naming, self.owners[derived])
        self.owners |= dict.fromkeys(every, naming)

    def _explain_doubled(self, derived: str, naming: Naming, owner: Naming) -> CoadjointError:
        """An error for a name that two things would have."""
        problem = f"{derived!r} is doubled: {owner.key[0]}.{owner.name} has that name too"
        usual = "Rename one of them; the components of I with shape [3] are I1, I2, I3."
        hint = naming.why or owner.why or usual
        return self.at_key(naming.key, problem, derived, "names and components that differ", hint)

    def free_name(self, name: str, of: str = "thing") -> str:
        """A free name, for a message: the wanted one, or one that tells what it is of."""
        names = (name, f"{name}_{of}", *(f"{name}_{of}_{n}" for n in range(2, 99)))
        return next(each for each in names if each not in self.owners and refusal(each) is None)

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

    def check_count(
        self, what: str, table: str, quantities: Iterable[HasComponents], limit: str
    ) -> None:
        """Refuse too many components.

        Raises:
            LimitError: There are.
        """
        count = sum(len(quantity.components) for quantity in quantities)
        if count > getattr(limits, limit):
            problem = f"the {what} have {count} components"
            raise self.source.too_many((table,), problem, count, limit)
