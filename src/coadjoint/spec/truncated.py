r"""Truncated: a fluid on a surface by matrices of N rows, written out for a few small N.

Comes in: a checked file with a table [truncation]. Goes out: the Spec of few rows, as any other
spec has on the algebra u(N), with all that is known of other numbers in its attribute ``family``.
The momentum is a skew-Hermitian matrix :math:`(W - W^T)/2 + \mathrm{i} (W + W^T)/2` of real
entries ``W_0, W_1, ...``, row by row, and its velocity V solves ``inertia(L) V = W``, L being the
Laplacian with a change of sign (`coadjoint.families.MatrixMotion`): the energy is half the sum of
``W_ij V_ij``.
Read next: `coadjoint.derive.truncated`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Any, Final

from coadjoint import limits
from coadjoint.algebra.families import label
from coadjoint.families import Index
from coadjoint.spec.copies import Places
from coadjoint.spec.core.members import member_name
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.values import read_default
from coadjoint.spec.model import Spec, Windows
from coadjoint.spec.sections.algebra_keys import AlgebraPart
from coadjoint.spec.sections.energies import HamiltonianPart
from coadjoint.spec.surfaces import SURFACES

#: Tables of a spec with [truncation].
TABLES: Final = ("truncation", "variables", "parameters", "claims")
#: What the numbers of modes are.
_NUMBERS: Final = {"sphere": "degree of harmonics", "torus": "number of a wave"}
_HEAD: Final = ("title", "source", "description", "license", "routes")


def read_truncated(
    source: Source, file: Any, read: Callable[[Source, Any], Spec], sizes: Mapping[str, int]
) -> Spec:
    """A spec with a table [truncation].

    Args:
        source: The text of the spec.
        file: Its checked tables.
        read: How a file without such a table becomes a Spec.
        sizes: The number of rows, by its name.

    Raises:
        SpecError: There are other tables, or variables other than one momentum; or a size is
            chosen for another name.
        LimitError: There are too many rows.
    """
    _check_tables(source, file)
    (variable,) = file.variables
    _check_names(source, file)
    index = _choose(source, file, sizes)
    surface = SURFACES[index.surface]
    counts = surface.written
    windows = tuple(read(*_write_out(source, file, index.name, variable, n)) for n in counts)
    family = Windows(
        index=index,
        variables=(variable,),
        shared=tuple(file.parameters),
        indexed=(),
        defaults=_find_defaults(source, file, index, variable),
        repeating=(),
        reach=0,
        alone=(0, 0),
        pairs=False,
        least=surface.least,
        windows=windows,
        truncation=file.truncation[index.name].inertia,
    )
    return replace(windows[0], family=family, index=(index,))


def _check_tables(source: Source, file: Any) -> None:
    """Nothing is declared that matrices of N rows do not have."""
    for table in type(file).model_fields:
        nothing = type(file).model_fields[table].get_default(call_default_factory=True)
        if table not in (*TABLES, *_HEAD) and getattr(file, table) != nothing:
            problem, expected = f"there are tables [truncation] and [{table}]", "one of them"
            raise source.fault((table,), problem, table, expected, f"Remove [{table}].")
    if len(file.truncation) > 1:
        problem, second = f"there are {len(file.truncation)} truncations", list(file.truncation)[1]
        raise source.at_key(("truncation", second), problem, second, "one", f"Remove {second}.")
    if file.routes != ["lie-poisson"]:
        problem, expected = f"the routes are {', '.join(file.routes)}", "lie-poisson alone"
        raise source.fault(("routes",), problem, file.routes, expected, 'Write ["lie-poisson"].')
    roles = [part.role for part in file.variables.values()]
    if roles != ["momentum"]:
        problem, expected = f"the variables are {', '.join(roles)}", "one momentum"
        hint = 'Write [variables] and below it W = { role = "momentum" }.'
        raise source.fault(("variables",), problem, roles, expected, hint)
    for name, part in file.variables.items():
        for key in ("index", "block", "form", "shape", "of", "representation", "follows"):
            if getattr(part, key) is not None:
                problem, expected = f"{name!r} has the key {key!r}", "entries of a matrix"
                raise source.fault(("variables", name, key), problem, key, expected, "Remove it.")
    for key in ("casimirs", "brackets"):
        if getattr(file.claims, key):
            problem, expected = f"there are claims about {key}", "the energy alone"
            raise source.fault(("claims", key), problem, key, expected, f"Remove {key}.")
    for place, claim in enumerate(file.claims.conserved):
        if claim.claim != "energy" or claim.where:
            problem, expected = f"{claim.claim!a} is claimed to be conserved", "the energy alone"
            path = ("claims", "conserved", place)
            raise source.fault(path, problem, claim.claim, expected, "Remove it.")
    for name, part in file.parameters.items():
        if part.index is not None:
            problem, expected = f"{name!r} has an index", "a parameter of all entries"
            raise source.fault(("parameters", name, "index"), problem, name, expected, "Remove it.")


def _check_names(source: Source, file: Any) -> None:
    """The number of rows, the degree and what is declared have names that differ."""
    ((rows, part),) = file.truncation.items()
    modes = SURFACES[part.surface].modes
    taken = {name: table for table in ("variables", "parameters") for name in getattr(file, table)}
    for name in (rows, *modes):
        if name in taken or (name in modes and name == rows):
            what = "number of rows" if name == rows else _NUMBERS[part.surface]
            key = (taken.get(name, "truncation"), name)
            problem, hint = f"{name!r} is the {what}, too", "Rename one of them."
            raise source.at_key(key, problem, name, "names that differ", hint)


def put_numbers(text: str, numbers: Mapping[str, int]) -> str:
    """A formula with numbers in the place of names."""
    shown = {name: str(n) if n >= 0 else f"({n})" for name, n in numbers.items()}
    return re.sub(r"[A-Za-z]\w*", lambda found: shown.get(found[0], found[0]), text)


def _choose(source: Source, file: Any, sizes: Mapping[str, int]) -> Index:
    """The number of rows that is chosen.

    Raises:
        SpecError: It is chosen for another name, or is none.
        LimitError: It is too large.
    """
    ((name, part),) = file.truncation.items()
    key, least = ("truncation", name), SURFACES[part.surface].least
    odd = SURFACES[part.surface].is_odd
    for other, size in sizes.items():
        if other != name:
            problem = f"a size is chosen for {other!a}, which counts no rows"
            raise source.at_key(key, problem, other, f"the number of rows {name!r}")
        if isinstance(size, bool) or not isinstance(size, int) or size < least:
            problem = f"the size {size!r} is chosen for {name!r}"
            raise source.at_key(key, problem, str(size), f"an integer of {least} or more")
    size = sizes.get(name, part.size)
    index = Index(name=name, size=size, surface=part.surface, from_zero=True)
    if size is not None and (size < least or not index.allows(size)):
        problem, kind = f"{name} = {size} on the {part.surface}", "odd number" if odd else "number"
        raise source.at_key(key, problem, str(size), f"an {kind} of {least} or more")
    if size is not None and size * size > limits.FAMILY_MEMBERS:
        problem = f"{name} = {size} makes {size * size} entries"
        raise source.too_many(key, problem, size * size, "FAMILY_MEMBERS")
    return index


def _find_defaults(
    source: Source, file: Any, index: Index, variable: str
) -> dict[str, tuple[tuple[Fraction, ...], ...]]:
    """The entries at the beginning, from parts of spherical harmonics; none without a size.

    Raises:
        SpecError: It is no list, or there are more parts than harmonics.
    """
    given = file.variables[variable].default
    if given is None or index.size is None:
        return {}
    count = len(given) if isinstance(given, list) else 0
    key = ("variables", variable, "default")
    if count >= index.size**2 and index.size != file.truncation[index.name].size:
        return {}  # so few rows have none of the last harmonics
    if not 0 < count < index.size**2:
        problem = f"the default has {count} parts" if count else "the default is no list"
        expected = f"1 to {index.size**2 - 1} parts of {SURFACES[index.surface].parts}"
        raise source.fault(key, problem, count, expected)
    parts = [float(x) for x in read_default(source, key, given, (count,)) or ()]
    rows = SURFACES[index.surface].find_entries(index.size, parts)
    return {variable: (tuple(Fraction(x) for row in rows for x in row),)}


def _write_out(source: Source, file: Any, count: str, variable: str, n: int) -> tuple[Source, Any]:
    """The file of n rows: a momentum for each entry, and the energy."""
    part, places = file.truncation[count], Places(source.positions)
    own = file.variables[variable].model_copy(update={"default": None})
    entries = dict[str, Any]()
    for k in range(n * n):
        name = member_name(variable, k)
        entries[name] = own.model_copy(update={"block": [label("X", k // n, k % n)]})
        places.repeat(("variables", variable), ("variables", name))
    surface = SURFACES[part.surface]
    scale = put_numbers(part.inertia, {count: n, **surface.modes})
    terms = " + ".join(surface.list_terms(n, [*entries]))
    update = {
        "truncation": {},
        "algebra": AlgebraPart.model_validate({"name": f"entries({n})"}),
        "variables": entries,
        "hamiltonian": HamiltonianPart(h=f"({terms})/({scale})"),
    }
    inertia = ("truncation", count, "inertia")
    for key in (("algebra",), ("algebra", "name"), ("hamiltonian",), ("hamiltonian", "h")):
        places.repeat(inertia, key)
        places.forget_characters(key)
    return replace(source, positions=places.all), file.model_copy(update=update)
