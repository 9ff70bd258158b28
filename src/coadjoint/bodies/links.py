"""The energy of the links of a lattice, as definitions and terms of a formula.

Comes in: a Strand, and names for what it has not. Goes out: text of the tables [definitions] and
[hamiltonian].
Read next: `coadjoint.bodies.text`, which writes the other tables.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product

from coadjoint.bodies.energy import Strand, pair_components
from coadjoint.exact import Element

Monomials = dict[tuple[int, ...], Element]


@dataclass(frozen=True)
class Links:
    """Links between the bodies of a lattice.

    Attributes:
        strand: With the energy of strains.
        names: Of what the strand has not, by use.
        write: An element as a formula.
    """

    strand: Strand
    names: Mapping[str, str]
    write: Callable[[Element], str]

    # -- bodies ---------------------------------------------------------------------------

    def turn_of(self, member: str) -> str:
        """The matrix from the axes of a body to those of space."""
        return self.turn_in(f"{self.names['attitude']}[{member}]")

    def turn_in(self, body: str) -> str:
        """The matrix from the axes of what has this name to those of space."""
        return f"rotation({body})" if self.strand.is_rod else body

    def place_of(self, member: str) -> str:
        """Where a body of a rod is."""
        return f"translation({self.names['attitude']}[{member}])"

    def turn_over(self, vector: str) -> str:
        """A vector in body axes as one in space; of a right invariant strand the reverse."""
        turn = self.turn_of(self.names["index"])
        return f"{turn}*{vector}" if self.strand.side == "left" else f"transpose({turn})*{vector}"

    def _link(self, here: str, after: str) -> str:
        """The turn from one attitude to the next."""
        left = self.strand.side == "left"
        return f"transpose({here})*{after}" if left else f"{after}*transpose({here})"

    # -- the energy -----------------------------------------------------------------------

    @cached_property
    def _parts(self) -> tuple[Monomials, Monomials]:
        """The energy of turns alone, and that of steps."""
        known = self.strand.potential
        steps = {each: factor for each, factor in known.items() if any(each[3:])}
        turns = {each: factor for each, factor in known.items() if each not in steps}
        if steps and not any(map(any, turns)):  # a constant alone
            return {}, known
        return turns, steps

    @property
    def has_any(self) -> bool:
        """Whether the energy depends on links."""
        return any(map(any, self.strand.potential))

    def definitions(self) -> Iterator[str]:
        """What a link is turned into, and the energy of these."""
        names, (turns, steps) = self.names, self._parts
        U, a = names["link"], names["distance"]
        first, second = map(any, zip(*map(_uses, (turns, steps)), strict=True))
        if first:
            yield "# tends to the strain"
            parts = f"{U}[3, 2] - {U}[2, 3], {U}[1, 3] - {U}[3, 1], {U}[2, 1] - {U}[1, 2]"
            yield f'"{names["turn"]}({U})" = "vector({parts})/(2*{a})"'
        if second:
            yield "# tends to the products of components of the strain"
            one = f"(1 - trace({U}))*diag(vector(1, 1, 1))"
            yield f'"{names["squares"]}({U})" = "({U} + transpose({U}) + {one})/{a}^2"'
        if turns:
            arguments = ", ".join(argument for _, argument in self._arguments(turns))
            yield f'"{names["potential"]}({arguments})" = "{self._write(turns)}"'
        if steps:
            e, here, after, step = (names[use] for use in ("third", "here", "next", "step"))
            arguments = ", ".join([*(argument for _, argument in self._arguments(steps)), e])
            yield f'"{names["stretch"]}({arguments})" = "{self._write(steps)}"'
            link = f"transpose({here})*{after}"
            seen = (f"transpose({turn})*{step}" for turn in (here, after))
            halves = " + ".join(self._call("stretch", steps, link, each) for each in seen)
            own = f"{self._call('potential', turns, link)} + " if turns else ""
            yield "# of two attitudes and a step: half of the energy of the step as seen by each"
            yield f'"{names["bond"]}({here}, {after}, {step})" = "{own}({halves})/2"'

    def terms(self, *, rises: bool, has_walls: bool) -> Iterator[str]:
        """The energies of links: of all between bodies, and of those to walls.

        Args:
            rises: Whether places are counted from equal steps along the third axis.
            has_walls: Whether walls stand in front of the first body and behind the last one.
        """
        i, a, wall, last = (self.names[use] for use in ("index", "distance", "wall", "count"))
        here, after, end = map(self.turn_of, (i, f"{i}+1", f"{last}-1"))
        turns, steps = self._parts
        if not steps:
            yield f"sum({i}, {self._call('potential', turns, self._link(here, after))})"
            if has_walls:  # the first one has the attitude 1
                yield self._call("potential", turns, self.turn_of("0"))
                link = self._link(end, self.turn_in(wall))
                yield self._call("potential", turns, link)
            return
        bond = self.names["bond"]
        step = f"({self.place_of(f'{i}+1')} - {self.place_of(i)})/{a}"
        step += f" + vector(0, 0, {self.names['rise']})" if rises else ""
        yield f"sum({i}, {bond}({here}, {after}, {step}))"
        if has_walls:  # the first one has the attitude 1 and the place 0
            yield f"{bond}(diag(vector(1, 1, 1)), {self.turn_of('0')}, {self.place_of('0')}/{a})"
            step = f"(translation({wall}) - {self.place_of(f'{last}-1')})/{a}"
            yield f"{bond}({end}, {self.turn_in(wall)}, {step})"

    def _arguments(self, monomials: Monomials) -> Iterator[tuple[str, str]]:
        """What an energy takes of a link: the name of the function, and of the argument."""
        either = (("turn", "first"), ("squares", "second"))
        for used, (function, argument) in zip(_uses(monomials), either, strict=True):
            if used:
                yield self.names[function], self.names[argument]

    def _call(self, use: str, monomials: Monomials, link: str, seen: str = "") -> str:
        """The energy of a link, and of a step as a body sees it."""
        values = [f"{function}({link})" for function, _ in self._arguments(monomials)]
        values += [seen] if seen else []
        return f"{self.names[use]}({', '.join(values)})"

    # -- polynomials ----------------------------------------------------------------------

    def _write(self, monomials: Monomials) -> str:
        """A polynomial of strains as a formula in x, S and e."""
        left, terms = dict(monomials), list[str]()
        if self.strand.is_rod:
            terms += self._take_forms(left)
        # by degrees, and the first components first
        for exponents in sorted(left, key=lambda each: (sum(each), [-n for n in each])):
            named = [*self._name(exponents)]
            factor = self.write(left[exponents])
            factor = f"({factor})" if named and " " in factor else factor
            terms.append("*".join([factor, *named]))
        return " + ".join(terms).replace("+ -", "- ")

    def _name(self, exponents: tuple[int, ...]) -> Iterator[str]:
        """The factors that a monomial becomes."""
        left, pairs = pair_components(exponents[:3])
        yield from (f"{self.names['first']}[{n + 1}]" for n in left)
        yield from (f"{self.names['second']}[{m + 1}, {n + 1}]" for m, n in pairs)
        for n, power in enumerate(exponents[3:], 1):
            if power:
                yield f"{self.names['third']}[{n}]" + (f"^{power}" if power > 1 else "")

    def _take_forms(self, left: Monomials) -> Iterator[str]:
        """Forms of degree 1 and 2 as one product each, taken out: links are named few times."""
        x, S, e = (self.names[use] for use in ("first", "second", "third"))

        def take(*places: int) -> str:
            factor = left.pop(tuple(map(places.count, range(6))), None)
            return "0" if factor is None else self.write(factor)

        for first, vector in ((0, x), (3, e)):
            row = [take(first + n) for n in range(3)]
            if {*row} != {"0"}:
                yield f"dot({_vector(row)}, {vector})"
        forms = ((0, 0, "trace(", f"*{S})"), (3, 3, f"dot({e}, ", f"*{e})"))
        for first, second, before, after in (*forms, (0, 3, f"dot({x}, ", f"*{e})")):
            places = product(range(first, first + 3), range(second, second + 3))
            entries = [take(m, n) if m <= n else "0" for m, n in places]
            if {*entries} == {"0"}:
                continue
            diagonal, rows = entries[::4], [entries[n : n + 3] for n in (0, 3, 6)]
            is_diagonal = len(entries) - entries.count("0") == 3 - diagonal.count("0")
            whole = f"rows({', '.join(map(_vector, rows))})"
            yield before + (f"diag({_vector(diagonal)})" if is_diagonal else whole) + after


def _vector(entries: Iterable[str]) -> str:
    return f"vector({', '.join(entries)})"


def _uses(monomials: Monomials) -> tuple[bool, bool]:
    """Whether a polynomial has entries of x, and of S."""
    pairs = [pair_components(exponents[:3]) for exponents in monomials]
    return any(left for left, _ in pairs), any(paired for _, paired in pairs)
