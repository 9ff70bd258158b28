"""Abbreviations in long formulas: parts that occur more than once have names of their own.

Comes in: SymPy expressions. Goes out: definitions by name, in the order in which they can be read,
and the expressions with these names in the place of their parts. Read next:
`coadjoint.derive.generic`, whose members have long rates.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

import sympy

#: Operations in a formula up to which nothing is abbreviated: it is read as it stands.
LONGEST = 60
#: Operations in a part up to which it is as short as a name for it.
SHORTEST = 2
#: Letters for abbreviations, of which the first that begins no other name is taken.
LETTERS = ("w", "u", "z", "y", "abbreviation")

Definitions = tuple[tuple[sympy.Symbol, sympy.Expr], ...]


def abbreviate(
    values: Sequence[sympy.Expr], names: Iterator[sympy.Symbol]
) -> tuple[Definitions, tuple[sympy.Expr, ...]]:
    """Formulas with names for parts that occur more than once, if one of them is long.

    Args:
        values: The formulas.
        names: Names for parts, in order; `number_names` makes them.

    >>> a, b, c = sympy.symbols("a b c")
    >>> long = sum((a + b * c**2) ** n for n in range(1, 20))
    >>> abbreviate([long], number_names(["a", "b", "c"]))[0]
    ((w1, a + b*c**2),)
    """
    if max((value.count_ops() for value in values), default=0) <= LONGEST:
        return (), tuple(values)
    replaced, short = sympy.cse(values, symbols=sympy.numbered_symbols("_part", start=1))
    known = dict[sympy.Symbol, sympy.Expr]()
    kept = list[tuple[sympy.Symbol, sympy.Expr]]()
    for part, value in replaced:
        full = value.xreplace(known)
        if full.count_ops() <= SHORTEST:
            known[part] = full
            continue
        known[part] = next(names)
        kept.append((known[part], full))
    return tuple(kept), tuple(value.xreplace(known) for value in short)


def number_names(taken: Collection[str]) -> Iterator[sympy.Symbol]:
    """Names ``w1``, ``w2``, ... with the first letter that no name begins with."""
    free = [each for each in LETTERS if not any(name.startswith(each) for name in taken)]
    assert free, sorted(taken)
    yield from sympy.numbered_symbols(free[0], start=1)
