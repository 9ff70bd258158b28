"""Lowering, families: the equations of the generic member become loops over members.

Comes in: a `coadjoint.families.Family`. Goes out: a `Loops` for each function, whose parts are
Programs of one member, of a pair of members, or of sums, with a note where each name is read. Texts
have one loop for any number of members.

Sums have a stated order, the same in every target (docs/decisions/family-kernels.md). The sum over
the partners of a member goes through them from 0 on. A sum over members, or over pairs by their
first member, has `LANES` parts: part l adds up the members l, l + LANES, l + 2 LANES and so on, and
then the parts are added up in order. All begin with 0.0.
Read next: `coadjoint.render.families`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Final

import sympy

from coadjoint.elementary import ELEMENTARY
from coadjoint.families import Family, Sum, Symbol, Total, Tree
from coadjoint.lower.graph import Graph
from coadjoint.lower.naming import Naming
from coadjoint.lower.program import Program

#: Parts of a sum over members, and members that are computed together where there are sums.
LANES: Final = 8
#: What the names of sums begin with; their number follows.
SUM: Final = "_sum"
#: Operations of a tree beyond which it is left as it is: to collect its terms takes seconds.
COLLECTED: Final = 60
#: Digits of constants that are no rational numbers, such as pi.
_DIGITS: Final = 60


@dataclass(frozen=True)
class Read:
    """Where a name of a part is read.

    The row is ``rows + blocks * N``, and of indexed arrays the member's number is added to it.

    Attributes:
        name: In texts.
        array: ``state`` or ``parameters``.
        rows: Rows before it that do not depend on N.
        blocks: Rows before it for each member.
        shift: How far behind member i the member is that it belongs to; None if all members share
            it.
        of_partner: Whether it belongs to member j of a pair.
    """

    name: str
    array: str
    rows: int
    blocks: int
    shift: int | None = 0
    of_partner: bool = False


@dataclass(frozen=True)
class Part:
    """What is computed of one member or pair.

    Attributes:
        program: Its statements and outputs; its first argument is all that it reads, in which sums
            follow what is in ``reads``.
        reads: Where the others are.
    """

    program: Program
    reads: tuple[Read, ...]

    @property
    def reach(self) -> int:
        """How far the members are apart that it reads, at the most."""
        return max((abs(read.shift or 0) for read in self.reads), default=0)


@dataclass(frozen=True)
class Totals:
    """Terms of sums over members or pairs that are added up in one loop.

    Attributes:
        part: The terms of member i, or of a pair i < j.
        over: ``members`` or ``pairs``.
        before: The first i.
        after: How many members from the end the last i is.
    """

    part: Part
    over: str
    before: int
    after: int


@dataclass(frozen=True)
class Loops:
    """One function of a family.

    Attributes:
        name: One of `coadjoint.kernel_functions`.
        is_periodic: Whether member N-1 is followed by member 0.
        blocks: Rows of its first argument for each member.
        shape: Of a result that does not depend on N, else None.
        partners: Terms of the sums over partners, if there are any.
        member: The rates of member i.
        ends: Of an open chain, those of members 0, 1, ... and -1, -2, ... in this order.
        totals: What is added up, of a function of sums.
        finish: What follows from the sums, of such a function.
    """

    name: str
    is_periodic: bool
    blocks: int
    shape: tuple[int, ...] | None
    partners: Part | None = None
    member: Part | None = None
    ends: tuple[tuple[int, Part], ...] = ()
    totals: tuple[Totals, ...] = ()
    finish: Part | None = None

    @property
    def parts(self) -> tuple[Part, ...]:
        """All parts, in order."""
        listed = [self.partners, self.member, *(part for _, part in self.ends)]
        listed += [*(each.part for each in self.totals), self.finish]
        return tuple(part for part in listed if part is not None)

    @property
    def first_ends(self) -> tuple[Part, ...]:
        """The parts of members 0, 1 and so on."""
        return tuple(part for member, part in self.ends if member >= 0)

    @property
    def last_ends(self) -> tuple[Part, ...]:
        """The parts of the last members, in the order of the members."""
        return tuple(part for member, part in sorted(self.ends, key=_by_member) if member < 0)


def _by_member(end: tuple[int, Part]) -> int:
    return end[0]


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
    return {each.name: each for each in functions}


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
        #: Symbols of member i, and not of its partner or of all.
        self._own = frozenset((*rows, *family.neighbours.values()))
        naming = _Names()
        self._reads: dict[Symbol, Read] = {}
        for symbol, row in rows.items():
            self._reads[symbol] = replace(row, name=naming.find(symbol.name))
        for n, symbol in enumerate(family.shared):
            name = naming.find(symbol.name)
            self._reads[symbol] = Read(name=name, array="parameters", rows=n, blocks=0, shift=None)
        for (component, shift), symbol in family.neighbours.items():
            name = naming.find(f"{component.name}_{'p' if shift > 0 else 'm'}{abs(shift)}")
            self._reads[symbol] = replace(rows[component], name=name, shift=shift)
        for component, symbol in family.partners.items():
            name = naming.find(f"{component.name}_j")
            self._reads[symbol] = replace(rows[component], name=name, of_partner=True)
        #: The vector of a derivative, which stands below the state.
        self._vector = [
            replace(
                read, name=naming.find(f"h_{read.name}"), blocks=read.blocks + len(family.states)
            )
            for read in self._reads.values()
            if read.array == "state"
        ]

    # -- functions ----------------------------------------------------------------------

    def rates(self, name: str) -> Loops:
        """The rates, or their derivative along a vector."""
        family, along = self.family, name == "jacobian_vector"
        sums = [each.symbol for each in family.pair_sums]
        first = len(sums) if along else 0
        loops = self._rates(name, sums, first)
        values = {f"{SUM}{n}" for n in range(first)}
        used = {each for part in loops.parts[1:] for each in part.program.state}
        return loops if used & values or not first else self._rates(name, sums, 0)

    def _rates(self, name: str, sums: Sequence[Symbol], first: int) -> Loops:
        """The same, given the number of the first sum of derivatives; 0 if no others are needed."""
        family, along = self.family, name == "jacobian_vector"
        names = {symbol: f"{SUM}{n}" for n, symbol in enumerate(sums)}
        slopes = {symbol: f"{SUM}{first + n}" for n, symbol in enumerate(sums)} if along else {}
        if along and not first:
            names = {symbol: f"{SUM}{len(sums) + n}" for n, symbol in enumerate(sums)}

        def lower(trees: Sequence[Tree], *, keeps: bool = False) -> Part:
            return self._part(name, trees, names, slopes if along else None, keeps=keeps)

        terms = [each.term for each in family.pair_sums]
        return Loops(
            name=name,
            is_periodic=family.index.periodic,
            blocks=len(family.states) * (2 if along else 1),
            shape=None,
            partners=lower(terms, keeps=first > 0) if terms else None,
            member=lower(family.rates),
            ends=tuple((member, lower(trees)) for member, trees in family.ends.items()),
        )

    def of_members(self, name: str, trees: Sequence[Tree]) -> Loops:
        """A function of each member alone."""
        return Loops(
            name=name,
            is_periodic=self.family.index.periodic,
            blocks=len(self.family.states),
            shape=None,
            member=self._part(name, trees, {}),
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
            is_periodic=self.family.index.periodic,
            blocks=len(self.family.states),
            shape=shape,
            totals=tuple(
                Totals(self._part(name, [each.term for each in sums], {}), *place)
                for place, sums in groups.items()
            ),
            finish=self._part(name, [total.formula for total in totals], names),
        )

    # -- parts --------------------------------------------------------------------------

    def _part(
        self,
        name: str,
        trees: Sequence[Tree],
        sums: Mapping[Symbol, str],
        slopes: Mapping[Symbol, str] | None = None,
        *,
        keeps: bool = False,
    ) -> Part:
        """Trees as a Program, in the form that takes the fewest operations.

        Args:
            name: Of the function.
            trees: What is computed.
            sums: Names of the sums that they read.
            slopes: Names of the derivatives of these along the vector, if derivatives are meant.
            keeps: Whether the trees are wanted, too: their derivatives follow them.
        """
        own, shared = self.family.states, self.family.shared
        is_long = any(sympy.count_ops(tree) > COLLECTED for tree in trees)
        ways = (_leave,) if is_long else (_factor_whole, _factor, _leave)
        forms = ([form(tree, own, shared) for tree in trees] for form in ways)
        parts = [self._lower(name, form, sums, slopes, keeps=keeps) for form in forms]
        return min(parts, key=lambda part: sum(part.program.operation_counts().values()))

    def _lower(
        self,
        name: str,
        trees: Sequence[Tree],
        sums: Mapping[Symbol, str],
        slopes: Mapping[Symbol, str] | None,
        *,
        keeps: bool,
    ) -> Part:
        """Trees as a Program, in the form that they have."""
        graph = Graph()
        names = {symbol: read.name for symbol, read in self._reads.items()} | dict(sums)
        values = list(_Inserting(graph, names, self._own, trees).nodes())
        if slopes is not None:
            along = self._differentiate(graph, values, {sums[each]: slopes[each] for each in sums})
            values = [*values, *along] if keeps else along
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
        moving = [read.name for read in self._reads.values() if read.array == "state"]
        for name, read in zip(moving, self._vector, strict=True):
            known[graph.symbol(name)] = {"": graph.symbol(read.name)}
        for name, slope in sums.items():
            known[graph.symbol(name)] = {"": graph.symbol(slope)}
        zero = graph.number(0)
        return [graph.derivative(value, known).get("", zero) for value in values]


class _Inserting:
    """SymPy's trees as nodes of a graph.

    A denominator that several quotients share becomes one reciprocal.
    """

    def __init__(
        self,
        graph: Graph,
        names: Mapping[Symbol, str],
        own: frozenset[Symbol],
        trees: Sequence[Tree],
    ) -> None:
        self.graph, self._names, self._own, self._trees = graph, names, own, trees
        self._quotients: dict[Tree, set[Tree]] = {}
        for tree in trees:
            for each in sympy.preorder_traversal(tree):
                _, _, below = _split(each)
                if below:
                    self._quotients.setdefault(below, set()).add(each)

    def nodes(self) -> Iterable[int]:
        """The node of each tree."""
        return map(self.node, self._trees)

    def node(self, tree: Tree) -> int:
        """The node of a tree."""
        graph = self.graph
        if tree in self._names:
            return graph.symbol(self._names[tree])
        if tree.is_Rational:
            return graph.number(_as_fraction(tree))
        if tree.is_NumberSymbol:
            return graph.number(_as_fraction(tree))
        if tree.is_Add:
            return graph.sum(map(self.node, tree.as_ordered_terms()))
        if tree.is_Mul or tree.is_Pow:
            return self._quotient(tree)
        name = {"Abs": "abs", "Min": "min", "Max": "max"}.get(type(tree).__name__, str(tree.func))
        assert name in ELEMENTARY, tree
        return graph.call(name, *map(self.node, tree.args))

    def _quotient(self, tree: Tree) -> int:
        """A product, perhaps over another one."""
        graph, (number, above, below) = self.graph, _split(tree)
        # what all lanes share comes first: it is computed once for them
        ordered = sorted(above, key=lambda factor: bool(factor.free_symbols & self._own))
        node = graph.product([graph.number(abs(number)), *map(self._power, ordered)])
        if below:
            divisor = graph.product(map(self._power, below))
            if len(self._quotients[below]) > 1:
                node = graph.multiply(node, graph.divide(graph.number(1), divisor))
            else:
                node = graph.divide(node, divisor)
        return graph.negate(node) if number < 0 else node

    def _power(self, factor: Tree) -> int:
        """A factor, of which the exponent is positive and a multiple of 1/2."""
        base, exponent = (factor, sympy.S.One) if factor.is_Function else factor.as_base_exp()
        if exponent == 1:
            return self.node(factor)
        assert (2 * exponent).is_Integer, factor
        whole, half = divmod(int(2 * exponent), 2)
        node = self.node(base)
        return self.graph.product([node] * whole + [self.graph.call("sqrt", node)] * half)


def _as_fraction(number: Tree) -> Fraction:
    """A rational number as it is, another one to many digits."""
    if number.is_Rational:
        return Fraction(int(number.p), int(number.q))
    return Fraction(str(number.evalf(_DIGITS)))


def _split(tree: Tree) -> tuple[Fraction, tuple[Tree, ...], tuple[Tree, ...]]:
    """The number, the factors and the divisors of a product; a sum or function is one factor."""
    if not (tree.is_Mul or tree.is_Pow):
        return Fraction(1), (tree,), ()
    number = Fraction(1)
    above, below = list[Tree](), list[Tree]()
    for factor in sympy.Mul.make_args(tree):
        base, exponent = (factor, sympy.S.One) if factor.is_Function else factor.as_base_exp()
        if base.is_Rational or base.is_NumberSymbol:
            assert exponent.is_Integer, factor
            number *= _as_fraction(base) ** int(exponent)
        elif exponent.is_negative:
            below.append(base**-exponent)
        else:
            above.append(factor)
    return number, tuple(above), tuple(below)


def _factor(tree: Tree, own: Sequence[Symbol], shared: Sequence[Symbol]) -> Tree:
    """A sum over the components of a member, and sums within it over the parameters."""
    if tree.is_Add and len(tree.args) > 2:
        tree = sympy.collect(tree, own)
    return tree.replace(
        lambda part: part.is_Add and len(part.args) > 1, lambda part: sympy.collect(part, shared)
    )


def _factor_whole(tree: Tree, own: Sequence[Symbol], shared: Sequence[Symbol]) -> Tree:
    """The same with what all terms share before the sum."""
    return sympy.factor_terms(_factor(tree, own, shared))


def _leave(tree: Tree, own: Sequence[Symbol], shared: Sequence[Symbol]) -> Tree:
    """The same as it is written."""
    return tree
