"""Lowering, families checked: what was lowered is what was derived.

Comes in: a Family and its `Loops`. Goes out: nothing, or a `CrossCheckError`. Every part is turned
into a tree again and compared with the family's, or with SymPy's derivative of it: as polynomials
and quotients where it calls no function, else at points to 60 digits.
Read next: `coadjoint.lower.families`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Final

import sympy
from sympy.polys import lex
from sympy.polys.rings import PolyRing

from coadjoint.errors import CrossCheckError
from coadjoint.families import Family, Symbol, Tree
from coadjoint.lower.families import SUM, Loops, Part, Read
from coadjoint.lower.program import run

#: Digits of the comparison where functions are called, and how much of them has to agree.
_DIGITS: Final = 60
_CLOSE: Final = sympy.Float(10) ** -45
#: Points of it.
_POINTS: Final = 5


def check_loops(family: Family, functions: Mapping[str, Loops]) -> None:
    """Every part computes what the family says.

    Raises:
        CrossCheckError: One does not; the message names it.
    """
    symbols = _Symbols(family)
    for loops in functions.values():
        compared = 0
        for part, trees, sums in _list_parts(family, loops, symbols):
            compared += len(trees)
            _check_part(loops.name, part, trees, symbols, sums)
        assert compared, loops.name


class _Symbols:
    """What names of parts stand for."""

    def __init__(self, family: Family) -> None:
        self._family = family
        self.vector = {
            each: sympy.Symbol(f"h {each}")
            for each in (
                *family.states,
                *(s for (c, _), s in family.neighbours.items() if c in family.states),
                *(s for c, s in family.partners.items() if c in family.states),
            )
        }

    def find(self, read: Read, function: str) -> Symbol:
        """The symbol that stands in the row of a name."""
        family = self._family
        count = len(family.states)
        if function == "noise_vector" and read.blocks >= count:
            if read.shift is None:
                assert (read.array, read.blocks) == ("state", count), read
                return family.shared_noise[read.rows]
            assert (read.array, read.rows) == ("state", len(family.shared_noise)), read
            return self._place(family.indexed_noise[read.blocks - count], read)
        if read.array in ("time", "sizes"):
            return {"time": family.time, "sizes": family.count}[read.array][read.rows]
        if read.array != "state":
            inputs = family.shared_inputs, family.indexed_inputs
            found = {"inputs": inputs, "parameters": (family.shared, family.indexed)}
            shared, indexed = found[read.array]
            if read.shift is None and read.single is None:
                return shared[read.rows]
            assert read.rows == len(shared), read
            return self._place(indexed[read.blocks], read)
        assert read.rows == 0, read
        below, row = divmod(read.blocks, count)
        symbol = self._place(family.states[row], read)
        return self.vector[symbol] if below else symbol

    def _place(self, component: Symbol, read: Read) -> Symbol:
        """The symbol of a component of the member that a name belongs to."""
        if read.single is not None:
            return self._family.singles[component, read.single]
        if read.of_partner:
            return self._family.partners[component]
        return self._family.neighbours[component, read.shift] if read.shift else component

    def of_both(self, terms: Sequence[Tree]) -> list[Tree]:
        """Terms of member i, and then those of its partner."""
        pairs = dict(self._family.partners)
        pairs |= {
            self.vector[one]: self.vector[j] for one, j in pairs.items() if one in self.vector
        }
        others = pairs | {j: one for one, j in pairs.items()}
        return [*terms, *(term.xreplace(others) for term in terms)]

    def slope(self, tree: Tree, sums: Mapping[Symbol, Symbol]) -> Tree:
        """The derivative of a tree along the vector, between jumps.

        SymPy differentiates `sign` of real symbols alone, and gives it a derivative where it jumps.
        """
        moving = self.vector | dict(sums)
        polynomials = _find_polynomials([tree], moving.values())
        if polynomials and not {*moving} & polynomials.divisors:
            (whole,), ring = polynomials.values, polynomials.ring
            named = [(s, h) for s, h in moving.items() if s in ring.symbols]
            along = (whole.diff(ring(s)) * ring(h) for s, h in named)
            return sum(along, ring.zero).as_expr().xreplace(polynomials.inverses)
        real = {s: sympy.Dummy(s.name, real=True) for s in tree.free_symbols}
        back, whole = {dummy: s for s, dummy in real.items()}, tree.xreplace(real)
        slopes = (sympy.diff(whole, real[s]) * h for s, h in moving.items() if s in real)
        along = sympy.Add(*slopes).replace(sympy.DiracDelta, lambda *_: sympy.Integer(0))
        return along.xreplace(back)


def _list_parts(
    family: Family, loops: Loops, symbols: _Symbols
) -> Iterator[tuple[Part, Sequence[Tree], Sequence[Symbol]]]:
    """Parts with what they are to compute, and what their sums stand for by number."""
    if loops.member is None:
        every = loops.name == "observables"
        totals = [each for each in family.totals if every or each.name == "energy"]
        known = [each for total in totals for each in total.sums]
        ordered = list[Any]()
        for group in loops.totals:
            edges = [(group.over, group.before, group.after)]
            if family.index.periodic:
                chosen = [each for each in known if each.over == group.over]
            else:
                chosen = [each for each in known if (each.over, each.before, each.after) in edges]
            yield group.part, [each.term for each in chosen], ()
            ordered += [each.symbol for each in chosen]
        assert loops.finish is not None, loops.name
        assert len(ordered) == len(known), loops.name
        yield loops.finish, [total.formula for total in totals], ordered
        return
    if loops.name in ("constraint_residual", "projection"):
        yield loops.member, family.turned if loops.name == "projection" else family.residuals, ()
        return
    if loops.name == "noise_vector":
        yield loops.member, family.noise, ()
        yield from ((part, family.noise_ends[member], ()) for member, part in loops.ends)
        assert len(loops.ends) == len(family.noise_ends), loops.name
        return
    sums = [each.symbol for each in family.pair_sums]
    terms = [each.term for each in family.pair_sums]
    places = [(loops.member, family.rates)]
    places += [(part, family.ends[member]) for member, part in loops.ends]
    assert len(places) == 1 + len(family.ends), loops.name
    if loops.name == "rhs":
        if loops.partners is not None:
            yield loops.partners, symbols.of_both(terms), ()
        for part, rates in places:
            yield part, rates, sums
        return
    slopes = {each: sympy.Symbol(f"h {each}") for each in sums}
    along = [symbols.slope(term, {}) for term in terms]
    keeps = loops.partners is not None and loops.pair_sums > len(terms)
    if loops.partners is not None:
        yield loops.partners, symbols.of_both([*terms, *along] if keeps else along), ()
    read = [*sums, *slopes.values()] if keeps else list(slopes.values())
    for part, rates in places:
        yield part, [symbols.slope(rate, slopes) for rate in rates], read


def _check_part(
    name: str, part: Part, trees: Sequence[Tree], symbols: _Symbols, sums: Sequence[Symbol]
) -> None:
    """A part computes trees."""
    values = {read.name: symbols.find(read, name) for read in part.reads}
    for each in part.program.state[len(part.reads) :]:
        values[each] = sums[int(each.removeprefix(SUM))]
    computed = run(part.program, values, _number, _call)
    if len(computed) != len(trees):
        raise _fail(name, f"{len(computed)} results in the place of {len(trees)}")
    for found, wanted in zip(computed, trees, strict=True):
        if not _are_equal(sympy.sympify(found), wanted):
            raise _fail(name, f"{found} in the place of {wanted}")


def _number(value: Fraction) -> Any:
    return sympy.Rational(value.numerator, value.denominator)


def _call(function: str, *arguments: Any) -> Any:
    own = {"abs": sympy.Abs}.get(function) or getattr(sympy, function)
    return own(*arguments)


@dataclass(frozen=True)
class _Polynomials:
    """Trees as polynomials with rational coefficients.

    They take a tenth of the time of trees that SymPy expands or differentiates.

    Attributes:
        values: The polynomials.
        ring: Theirs.
        inverses: What stands for a divisor, which is a symbol there, by its inverse.
    """

    values: list[Any]
    ring: PolyRing
    inverses: Mapping[Symbol, Tree]

    @property
    def divisors(self) -> set[Symbol]:
        """Symbols in divisors."""
        return {s for inverse in self.inverses.values() for s in inverse.free_symbols}


def _find_polynomials(trees: Sequence[Tree], others: Iterable[Symbol] = ()) -> _Polynomials | None:
    """Trees as polynomials in all their symbols and in inverses; None where they call functions."""
    inverses = dict[Tree, Symbol]()

    def invert(power: Tree) -> Tree:
        symbol = inverses.setdefault(power.base, sympy.Dummy())
        return symbol**-power.exp

    plain = [
        tree.replace(lambda e: e.is_Pow and e.exp.is_Integer and e.exp < 0, invert)
        for tree in trees
    ]
    symbols = {*others}.union(*(tree.free_symbols for tree in plain))
    if not symbols:
        return None
    ring = PolyRing(sorted(symbols, key=str), sympy.QQ, lex)
    try:
        values = [ring.from_expr(tree) for tree in plain]
    except ValueError:
        return None
    return _Polynomials(values, ring, {own: 1 / base for base, own in inverses.items()})


def _are_equal(found: Tree, wanted: Tree) -> bool:
    """Whether two trees have one value."""
    polynomials = _find_polynomials([found, wanted])
    if polynomials and polynomials.values[0] == polynomials.values[1]:
        return True
    difference = found - wanted
    if not difference.has(sympy.Function) and not difference.atoms(sympy.NumberSymbol):
        return difference.expand() == 0 or bool(sympy.cancel(sympy.together(difference)) == 0)
    names = sorted(difference.free_symbols, key=str)
    for n in range(1, _POINTS + 1):
        at = {s: sympy.Rational(7 * n + 3 * k + 1, 5 * n + k + 2) for k, s in enumerate(names)}
        one, other = (each.xreplace(at).evalf(_DIGITS) for each in (found, wanted))
        if not abs(one - other) <= _CLOSE * (1 + abs(other)):
            return False
    return True


def _fail(name: str, problem: str) -> CrossCheckError:
    """The failure of rung 2."""
    return CrossCheckError(
        f"rung 2: {name}: {problem[:400]}. This is a fault of coadjoint, please report it.",
        rung=2,
        function=name,
    )
