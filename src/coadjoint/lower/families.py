"""Lowering, families: the equations of the generic member become loops over members.

Comes in: a `coadjoint.families.Family`. Goes out: a `Loops` for each function, whose parts are
Programs of one member, of a pair of members, or of sums, with a note where each name is read. Texts
have one loop for any number of members.

Sums have the order that `coadjoint.lower.loops` states.
Read next: `coadjoint.render.families`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import sympy

from coadjoint.families import Action, Family, PartFlow, Rises, Sum, Symbol, Total, Tree
from coadjoint.lower.family_kinks import HeldFamily, hold_family
from coadjoint.lower.family_trees import Inserting, factor, factor_whole, leave
from coadjoint.lower.graph import Graph
from coadjoint.lower.loops import (
    GIVEN,
    PRODUCTS,
    SUM,
    Loops,
    Part,
    Products,
    Read,
    Solve,
    Totals,
)
from coadjoint.lower.naming import Naming

#: Operations of a tree beyond which it is left as it is: to collect its terms takes seconds.
COLLECTED: Final = 60


def lower_family(family: Family) -> dict[str, Loops]:
    """The functions of a family by name: rates, their derivative along a vector, and totals."""
    lowering = _Lowering(family)
    functions = [lowering.rates("rhs"), lowering.rates("jacobian_vector")]
    energies = [total for total in family.totals if total.name == "energy"]
    if energies:
        functions.append(lowering.totals("energy", energies, ()))
    if family.totals:
        functions.append(lowering.totals("observables", family.totals, (len(family.totals),)))
    if family.turned:
        functions.append(lowering.of_members("constraint_residual", family.residuals))
        functions.append(lowering.of_members("projection", family.turned))
    if family.noise:
        functions.append(lowering.noise())
    functions += [lowering.flow(f"flow{n}", each) for n, each in enumerate(family.flows, 1)]
    held = hold_family(family)
    if held is not None:
        functions.append(_Lowering(held.family).rates("sided_rhs"))
        functions.append(_Lowering(held.family).kinks(held))
    if family.matrices is not None:
        slopes, product = (family.matrices.velocity,), (family.matrices.product,)
        functions.append(lowering.of_members("energy_gradient", slopes))
        functions.append(lowering.of_members("bracket_vector", product, blocks=2))
        functions.append(lowering.of_members("sandwich", product, blocks=2))
    if family.action is not None and held is None:
        functions += [lowering.gradient(family.action), lowering.bracket(family.action)]
    return {each.name: lowering.complete(each) for each in functions}


class _Names:
    """Names of which none is given twice."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def find(self, name: str) -> str:
        """A name like the one that is wanted."""
        while name in self._taken:
            name += "_"
        self._taken.add(name)
        return name


class _Lowering:
    """Trees of one family on their way into Programs."""

    def __init__(self, family: Family) -> None:
        self.family = family
        rows = {
            symbol: Read(name="", array="state", rows=0, blocks=n)
            for n, symbol in enumerate(family.states)
        }
        rows |= {
            symbol: Read(name="", array="parameters", rows=len(family.shared), blocks=n)
            for n, symbol in enumerate(family.indexed)
        }
        solved = family.completed
        assert len(family.solved) <= 1, "one equation"
        assert not (solved and (family.noise or family.sides or family.pair_sums)), "no more"
        rows |= {
            symbol: Read(name="", array="state", rows=0, blocks=len(family.states) + n)
            for n, symbol in enumerate(solved)
        }
        before = len(family.shared_inputs)
        rows |= {
            symbol: Read(name="", array="inputs", rows=before, blocks=n)
            for n, symbol in enumerate(family.indexed_inputs)
        }
        alike, below = len(family.shared_noise), len(family.states) + len(solved)
        rows |= {
            symbol: Read(name="", array="state", rows=alike, blocks=below + n)
            for n, symbol in enumerate((*family.indexed_noise, *family.sides))
        }
        #: Symbols of member i, and not of its partner or of all.
        self._own = frozenset((*rows, *family.neighbours.values()))
        naming = _Names()
        self._reads: dict[Symbol, Read] = {}
        for symbol, row in rows.items():
            self._reads[symbol] = replace(row, name=naming.find(symbol.name))
        for n, symbol in enumerate(family.shared):
            name = naming.find(symbol.name)
            self._reads[symbol] = Read(name=name, array="parameters", rows=n, blocks=0, shift=None)
        for n, symbol in enumerate(family.shared_inputs):
            name = naming.find(symbol.name)
            self._reads[symbol] = Read(name=name, array="inputs", rows=n, blocks=0, shift=None)
        for n, symbol in enumerate(family.shared_noise):
            name = naming.find(symbol.name)
            read = Read(name=name, array="state", rows=n, blocks=below, shift=None)
            self._reads[symbol] = read
        for symbol in family.step:
            assert not solved, "no more"
            assert not family.noise, "no more"
            name = naming.find("step")
            read = Read(name=name, array="state", rows=0, blocks=below, shift=None)
            self._reads[symbol] = read
        for symbol in family.time:
            name = naming.find(symbol.name)
            self._reads[symbol] = Read(name=name, array="time", rows=0, blocks=0, shift=None)
        for symbol in family.count:
            name = naming.find(symbol.name)
            self._reads[symbol] = Read(name=name, array="sizes", rows=0, blocks=0, shift=None)
        for (component, shift), symbol in family.neighbours.items():
            name = naming.find(f"{component.name}_{'p' if shift > 0 else 'm'}{abs(shift)}")
            self._reads[symbol] = replace(rows[component], name=name, shift=shift)
        for component, symbol in family.partners.items():
            name = naming.find(f"{component.name}_j")
            self._reads[symbol] = replace(rows[component], name=name, of_partner=True)
        for (component, number), symbol in family.singles.items():
            end = f"first{number or ''}" if number >= 0 else f"last{-1 - number or ''}"
            name = naming.find(f"{component.name}_{end}")
            self._reads[symbol] = replace(rows[component], name=name, shift=None, single=number)
        #: The vector of a derivative, which stands below the state.
        self._moving = [
            read for read in self._reads.values() if read.array == "state" and read.blocks < below
        ]
        self._vector = [
            replace(read, name=naming.find(f"h_{read.name}"), blocks=read.blocks + below)
            for read in self._moving
        ]
        #: The names of the vector that a bracket is applied to.
        self._given: dict[Symbol, str] = {}
        if family.action is not None:
            below_of = {
                read.name: own.name for read, own in zip(self._moving, self._vector, strict=True)
            }
            of = family.action.vector.items()
            self._given = {own: below_of[self._reads[symbol].name] for symbol, own in of}
        #: The name of the other member of a pair, of each name that one of them has.
        self._others = self._pair_names()

    def _pair_names(self) -> dict[str, str]:
        """Names that change places with the members of a pair."""
        reads = (*self._reads.values(), *self._vector)
        reads = tuple(read for read in reads if read.shift is not None)
        places = {(r.array, r.blocks, r.of_partner): r.name for r in reads if r.shift == 0}
        return {
            name: places[array, blocks, not of_partner]
            for (array, blocks, of_partner), name in places.items()
            if (array, blocks, not of_partner) in places
        }

    # -- functions ----------------------------------------------------------------------

    def complete(self, function: Loops) -> Loops:
        """A function with what is computed before it begins."""
        family, name = self.family, f"{function.name}_factors"
        if family.matrices is not None:
            scale = (
                None if function.name in GIVEN else self._part(name, [family.matrices.scale], {})
            )
            product, surface = PRODUCTS.get(function.name, ""), family.index.surface
            return replace(function, products=Products(scale, product, surface))
        for each in family.solved:
            factors = self._part(name, each.factors, {})
            of = family.states.index(each.of)
            return replace(function, solve=Solve(factors, len(family.states), of, each.level))
        return function

    def rates(self, name: str) -> Loops:
        """The rates, or their derivative along a vector.

        A sum over partners is added to the rate of one component, so that derivatives of rates name
        those of sums, and not the sums.
        """
        family, along = self.family, name == "jacobian_vector"
        sums = [each.symbol for each in family.pair_sums]
        names = {symbol: f"{SUM}{n + len(sums) * along}" for n, symbol in enumerate(sums)}
        slopes = {symbol: f"{SUM}{n}" for n, symbol in enumerate(sums)} if along else None

        def lower(trees: Sequence[Tree], *, of_pair: bool = False) -> Part:
            return self._part(name, trees, names, slopes, of_pair=of_pair)

        terms = [each.term for each in family.pair_sums]
        found = Loops(
            name=name,
            wraps=family.wraps,
            blocks=len(family.states) * (2 if along else 1) + len(family.sides),
            shape=None,
            partners=lower(terms, of_pair=True) if terms else None,
            member=lower(family.rates),
            ends=tuple((member, lower(trees)) for member, trees in family.ends.items()),
        )
        used = {each for part in found.parts[1:] for each in part.program.state}
        assert not along or not used & set(names.values()), name
        assert found.pair_sums <= len(family.states), name
        return found

    def of_members(self, name: str, trees: Sequence[Tree], blocks: int = 0) -> Loops:
        """A function of each member alone, which is given so many rows of it, or its state."""
        return Loops(
            name=name,
            wraps=self.family.wraps,
            blocks=blocks or len(self.family.states),
            shape=None,
            member=self._part(name, trees, {}),
        )

    def gradient(self, action: Action) -> Loops:
        """The derivatives of the energy by the components of each member."""
        name = "energy_gradient"
        sums = {each.symbol: f"{SUM}{n}" for n, each in enumerate(action.pair_sums)}
        terms = [each.term for each in action.pair_sums]
        return Loops(
            name=name,
            wraps=self.family.wraps,
            blocks=len(self.family.states),
            shape=None,
            partners=self._part(name, terms, sums, of_pair=True) if terms else None,
            member=self._part(name, action.gradient, sums),
            ends=self._parts(name, action.gradient_ends, sums),
        )

    def bracket(self, action: Action) -> Loops:
        """The tensor times a vector, which stands below the state."""
        name = "bracket_vector"
        return Loops(
            name=name,
            wraps=self.family.wraps,
            blocks=2 * len(self.family.states),
            shape=None,
            member=self._part(name, action.bracket, {}),
            ends=self._parts(name, action.bracket_ends, {}),
        )

    def kinks(self, held: HeldFamily) -> Loops:
        """What is 0 at the kinks of each member, in the sums that rates read."""
        family = self.family
        sums = {each.symbol: f"{SUM}{n}" for n, each in enumerate(family.pair_sums)}
        terms = [each.term for each in family.pair_sums]
        if not sums.keys() & {s for tree in held.kinks for s in tree.free_symbols}:
            sums, terms = {}, []
        return Loops(
            name="kinks",
            wraps=family.wraps,
            blocks=len(family.states),
            shape=None,
            partners=self._part("kinks", terms, sums, of_pair=True) if terms else None,
            member=self._part("kinks", held.kinks, sums),
            ends=self._parts("kinks", held.ends, sums),
        )

    def noise(self) -> Loops:
        """What increments of Wiener processes do to each member; they stand below the state."""
        family = self.family
        assert all(symbol not in family.partners for symbol in family.indexed_noise), "no pairs"
        return Loops(
            name="noise_vector",
            wraps=family.wraps,
            blocks=len(family.states) + len(family.indexed_noise),
            shape=None,
            member=self._part("noise_vector", family.noise, {}),
            ends=self._parts("noise_vector", family.noise_ends, {}),
            rows=len(family.shared_noise),
        )

    def flow(self, name: str, flow: PartFlow) -> Loops:
        """What the flow of a part adds to each member in a time, which stands below the state."""

        def lower(rises: Rises) -> Part:
            return self._part(name, rises.trees, {}, definitions=rises.definitions)

        return Loops(
            name=name,
            wraps=self.family.wraps,
            blocks=len(self.family.states),
            shape=None,
            member=lower(flow.member),
            ends=tuple((end, lower(rises)) for end, rises in flow.ends.items()),
            rows=len(self.family.step),
        )

    def totals(self, name: str, totals: Sequence[Total], shape: tuple[int, ...]) -> Loops:
        """Numbers of the whole system: sums first, then what follows from them."""
        groups: dict[tuple[str, int, int], list[Sum]] = {}
        for total in totals:
            for each in total.sums:
                edges = (0, 0) if self.family.index.periodic else (each.before, each.after)
                groups.setdefault((each.over, *edges), []).append(each)
        names: dict[Symbol, str] = {}
        for sums in groups.values():
            names |= {each.symbol: f"{SUM}{len(names) + n}" for n, each in enumerate(sums)}
        return Loops(
            name=name,
            wraps=self.family.wraps,
            blocks=len(self.family.states),
            shape=shape,
            totals=tuple(
                Totals(self._part(name, [each.term for each in sums], {}), *place)
                for place, sums in groups.items()
            ),
            finish=self._part(name, [total.formula for total in totals], names),
        )

    # -- parts --------------------------------------------------------------------------

    def _parts(
        self, name: str, ends: Mapping[int, Sequence[Tree]], sums: Mapping[Symbol, str]
    ) -> tuple[tuple[int, Part], ...]:
        """Those of members at the ends."""
        return tuple((end, self._part(name, trees, sums)) for end, trees in ends.items())

    def _part(
        self,
        name: str,
        trees: Sequence[Tree],
        sums: Mapping[Symbol, str],
        slopes: Mapping[Symbol, str] | None = None,
        *,
        of_pair: bool = False,
        definitions: Sequence[tuple[Symbol, Tree]] = (),
    ) -> Part:
        """Trees as a Program, in the form that takes the fewest operations.

        Args:
            name: Of the function.
            trees: What is computed.
            sums: Names of the sums that they read.
            slopes: Names of the derivatives of these along the vector, if derivatives are meant.
            of_pair: Whether both members of a pair have them: those of member j follow.
            definitions: What symbols are that trees and later definitions read.
        """
        family = self.family
        shared = (*family.shared, *family.shared_inputs, *family.time, *family.count)
        own, symbols = family.states, [symbol for symbol, _ in definitions]
        trees = [*(tree for _, tree in definitions), *trees]
        is_long = any(sympy.count_ops(tree) > COLLECTED for tree in trees)
        ways = (leave,) if is_long else (factor_whole, factor, leave)
        forms = ([form(tree, own, shared) for tree in trees] for form in ways)
        parts = [self._lower(name, form, sums, slopes, symbols, of_pair=of_pair) for form in forms]
        return min(parts, key=lambda part: sum(part.program.operation_counts().values()))

    def _lower(
        self,
        name: str,
        trees: Sequence[Tree],
        sums: Mapping[Symbol, str],
        slopes: Mapping[Symbol, str] | None,
        symbols: Sequence[Symbol],
        *,
        of_pair: bool,
    ) -> Part:
        """Trees as a Program, in the form that they have; the first ones define symbols."""
        graph = Graph()
        names = {symbol: read.name for symbol, read in self._reads.items()}
        names |= {**self._given, **sums}
        others = self._others if of_pair else {}
        values = list(Inserting(graph, names, self._own, trees, others).nodes(symbols))
        if slopes is not None:
            named = {sums[each]: slopes[each] for each in sums}
            values = self._differentiate(graph, values, named)
        if of_pair:
            known: dict[int, int] = {}
            values += [graph.exchange(value, others, known) for value in values]
        outputs = [(str(n), node) for n, node in enumerate(values)]
        naming = Naming(graph, [], outputs, ())
        used = naming.program(name, (len(outputs),), state=(), parameters=()).names_used()
        reads = [each for each in (*self._reads.values(), *self._vector) if each.name in used]
        rest = [*sums.values(), *(slopes or {}).values()]
        state = (*(each.name for each in reads), *(each for each in rest if each in used))
        naming = Naming(graph, [], outputs, ())
        program = naming.program(name, (len(outputs),), state=state, parameters=())
        return Part(program, tuple(reads))

    def _differentiate(
        self, graph: Graph, values: Sequence[int], sums: Mapping[str, str]
    ) -> list[int]:
        """Derivatives along the vector; that of a sum is another sum."""
        known: dict[int, dict[str, int]] = {
            graph.symbol(read.name): {} for read in self._reads.values()
        }
        for one, read in zip(self._moving, self._vector, strict=True):
            known[graph.symbol(one.name)] = {"": graph.symbol(read.name)}
        for name, slope in sums.items():
            known[graph.symbol(name)] = {"": graph.symbol(slope)}
        zero = graph.number(0)
        return [graph.derivative(value, known).get("", zero) for value in values]
