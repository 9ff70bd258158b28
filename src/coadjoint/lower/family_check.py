"""Lowering, families checked: what was lowered is what was derived.

Comes in: a Family and its `Loops`. Goes out: nothing, or a `CrossCheckError`. Every part is turned
into a tree again and compared with the family's, or with SymPy's derivative of it.
Read next: `coadjoint.lower.equal_trees`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import sympy

from coadjoint.errors import CrossCheckError
from coadjoint.families import Action, Family, MatrixMotion, Rises, Symbol, Tree
from coadjoint.lower.equal_trees import are_equal, find_polynomials
from coadjoint.lower.evaluation import run
from coadjoint.lower.loops import GIVEN, PRODUCTS, SUM, Loops, Part, Read
from coadjoint.methods import ACTION


def check_loops(family: Family, functions: Mapping[str, Loops]) -> None:
    """Every part computes what the family says.

    Raises:
        CrossCheckError: One does not; the message names it.
    """
    symbols = _Symbols(family)
    for loops in functions.values():
        compared = 0
        if loops.name in ("sided_rhs", "kinks"):
            continue
        for part, trees, sums in _list_parts(family, loops, symbols):
            compared += len(trees)
            _check_part(loops.name, part, trees, symbols, sums)
        for solve, each in zip([loops.solve] * bool(family.solved), family.solved, strict=True):
            assert solve is not None, loops.name
            assert family.states[solve.of] == each.of, loops.name
            assert solve.level == each.level, loops.name
            _check_part(loops.name, solve.factors, each.factors, symbols, ())
        if family.matrices is not None:
            _check_products(family.matrices, family.index.surface, loops, symbols)
        assert compared, loops.name
    if "kinks" in functions:
        check_sides(family, functions["sided_rhs"], functions["kinks"])


def _check_products(matrices: MatrixMotion, surface: str, loops: Loops, symbols: _Symbols) -> None:
    """Before a function the right product is computed, of V by the right equation or as given."""
    products, wanted = loops.products, PRODUCTS.get(loops.name, "")
    assert products is not None, loops.name
    if products.product != wanted:
        raise _fail(loops.name, f"the product {products.product!r} in the place of {wanted!r}")
    if products.surface != surface:
        raise _fail(loops.name, f"a Laplacian on the {products.surface}, not the {surface}")
    if (products.scale is None) != (loops.name in GIVEN):
        raise _fail(loops.name, "V is given, and should be solved for, or the other way round")
    if products.scale is not None:
        _check_part(loops.name, products.scale, [matrices.scale], symbols, ())


def check_sides(family: Family, rates: Loops, kinks: Loops) -> None:
    """With the signs of ``kinks`` in their rows, ``sided_rhs`` is the rates.

    Arguments are those that the part of the generic member computes, or of the first end that
    computes one; where a sign is read, its own member has to compute it.

    Raises:
        CrossCheckError: It is something else.
    """
    sides = _Sides(family, kinks)
    places = {None: rates.member} | dict(rates.ends)
    for place, part in places.items():
        assert part is not None, rates.name
        wanted = family.rates if place is None else family.ends[place]
        trees = [sides.take_out(tree) for tree in wanted]
        _check_part(rates.name, part, trees, sides, [each.symbol for each in family.pair_sums])
    assert len(places) == 1 + len(family.ends), rates.name
    assert sides.read, rates.name
    sides.check_members(rates)
    terms = [each.term for each in family.pair_sums]
    for pairs in (rates.partners, kinks.partners):
        if pairs is not None:
            _check_part(rates.name, pairs, sides.of_both(terms), sides, ())


class _Symbols:
    """What names of parts stand for."""

    def __init__(self, family: Family) -> None:
        self._family = family
        self.components = (*family.states, *family.completed)
        self.vector = {
            each: sympy.Symbol(f"h {each}")
            for each in (
                *self.components,
                *(s for (c, _), s in family.neighbours.items() if c in self.components),
                *(s for c, s in family.partners.items() if c in family.states),
            )
        }
        self.vector |= {} if family.action is None else family.action.vector

    def find(self, read: Read, function: str) -> Symbol:
        """The symbol that stands in the row of a name."""
        family = self._family
        count = len(self.components)
        if function == "noise_vector" and read.blocks >= count:
            if read.shift is None:
                assert (read.array, read.blocks) == ("state", count), read
                return family.shared_noise[read.rows]
            assert (read.array, read.rows) == ("state", len(family.shared_noise)), read
            return self._place(family.indexed_noise[read.blocks - count], read)
        if function.startswith("flow") and read.blocks >= count:
            assert (read.array, read.rows, read.blocks) == ("state", 0, count), read
            assert read.shift is None, read
            return family.step[0]
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
        symbol = self._place(self.components[row], read)
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
        polynomials = find_polynomials([tree], moving.values())
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


class _Sides(_Symbols):
    """The same where given signs stand below the state."""

    def __init__(self, family: Family, kinks: Loops) -> None:
        super().__init__(family)
        sums = [each.symbol for each in family.pair_sums]
        places = {None: kinks.member} | dict(kinks.ends)
        #: What the parts of `kinks` compute.
        self.rows = {
            place: [sympy.sympify(tree) for tree in self._run(kinks, part, sums)]
            for place, part in places.items()
        }
        self._places = {each: (each, 0) for each in family.own}
        self._places |= {symbol: key for key, symbol in family.neighbours.items()}
        self._back = {key: symbol for symbol, key in self._places.items()}
        #: The argument of each sign, for the member that has it.
        self.arguments = [
            next((tree for tree in own if tree != 1), sympy.Integer(1))
            for own in zip(*self.rows.values(), strict=True)
        ]
        #: Which signs are read, row and shift: a symbol of each.
        self.read = dict[tuple[int, int], Symbol]()

    def _run(self, kinks: Loops, part: Part | None, sums: Sequence[Symbol]) -> Sequence[Any]:
        assert part is not None, kinks.name
        values = {read.name: self._find_any(read, kinks.name) for read in part.reads}
        for each in part.program.state[len(part.reads) :]:
            values[each] = sums[int(each.removeprefix(SUM))]
        return run(part.program, values, _number, _call)

    def _find_any(self, read: Read, name: str) -> Symbol:
        """The symbol of a name, of neighbours that no rate reads as well."""
        if read.shift and not read.of_partner:
            own = super().find(replace(read, shift=0), name)
            return self._family.neighbours.get(
                (own, read.shift), sympy.Symbol(f"{own} {read.shift}")
            )
        return super().find(read, name)

    def find(self, read: Read, function: str) -> Symbol:
        count = len(self._family.states)
        if read.array != "state" or read.blocks < count:
            return super().find(read, function)
        assert (read.rows, read.of_partner) == (0, False), read
        assert read.shift is not None, read
        return self._find_side(read.blocks - count, read.shift)

    def _find_side(self, row: int, shift: int) -> Symbol:
        return self.read.setdefault((row, shift), sympy.Symbol(f"side {row} {shift}"))

    def take_out(self, tree: Tree) -> Tree:
        """A tree in which each sign of an argument is the symbol of its row and shift."""
        given = dict[Tree, Tree]()
        for each in tree.atoms(sympy.sign, sympy.Abs):
            (inner,) = each.args
            found = self._look_up(inner)
            if found is not None:
                sign, row, shift = found
                side = sign * self._find_side(row, shift)
                given[each] = side * inner if isinstance(each, sympy.Abs) else side
        return tree.xreplace(given)

    def _look_up(self, inner: Tree) -> tuple[int, int, int] | None:
        """Of which row and neighbour an argument is, and with which sign."""
        shifts = {
            shift
            for s in inner.free_symbols & self._places.keys()
            for shift in [self._places[s][1]]
        }
        for shift in sorted({0, *shifts}):
            for row, argument in enumerate(self.arguments):
                moved = self._move(argument, shift)
                for sign in (1, -1):
                    if moved is not None and (moved - sign * inner).expand() == 0:
                        return sign, row, shift
        return None

    def _move(self, argument: Tree, shift: int) -> Tree | None:
        """An argument of a neighbour; None where it names what no rate does."""
        given = dict[Symbol, Symbol]()
        for symbol in argument.free_symbols:
            name, _, own = str(symbol).rpartition(" ")
            known = self._places.get(symbol)
            if known is None and name:
                known = next((c, int(own)) for c in self._family.own if str(c) == name)
            if known is not None:
                key = known[0], known[1] + shift
                if key not in self._back:
                    return None
                given[symbol] = self._back[key]
        return argument.xreplace(given)

    def check_members(self, rates: Loops) -> None:
        """Where a sign is read, its own member computes what it is the sign of."""
        count = len(self._family.states)
        before, after = len(rates.first_ends), len(rates.last_ends)
        places = {None: rates.member} | dict(rates.ends)
        for place, part in places.items():
            assert part is not None, rates.name
            for read in part.reads:
                if read.array != "state" or read.blocks < count:
                    continue
                row, shift = read.blocks - count, read.shift or 0
                for base, rows in self.rows.items():
                    if base is None:
                        is_read = place is None
                    elif place is not None:
                        is_read = (base >= 0) == (place >= 0) and base - shift == place
                    else:
                        is_read = base - shift >= before if base >= 0 else base - shift < -after
                    if is_read and rows[row] != self.arguments[row]:
                        raise _fail(
                            "kinks", f"{rows[row]} at {base} in the place of {self.arguments[row]}"
                        )


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
    if loops.name in ACTION and family.action is not None:
        yield from _list_action(family.action, loops, symbols)
        return
    if loops.name in (*ACTION, "sandwich"):
        assert family.matrices is not None, loops.name
        is_slope = loops.name == "energy_gradient"
        yield loops.member, [family.completed[not is_slope]], ()
        return
    if loops.name in ("constraint_residual", "projection"):
        yield loops.member, family.turned if loops.name == "projection" else family.residuals, ()
        return
    if loops.name.startswith("flow"):
        flow = family.flows[int(loops.name.removeprefix("flow")) - 1]
        yield loops.member, _write_out(flow.member), ()
        yield from ((part, _write_out(flow.ends[end]), ()) for end, part in loops.ends)
        assert len(loops.ends) == len(flow.ends) == len(family.ends), loops.name
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


def _list_action(
    action: Action, loops: Loops, symbols: _Symbols
) -> Iterator[tuple[Part, Sequence[Tree], Sequence[Symbol]]]:
    """The same of the bracket, or of the gradient of the energy."""
    assert loops.member is not None, loops.name
    is_bracket = loops.name == "bracket_vector"
    whole = action.bracket if is_bracket else action.gradient
    ends = action.bracket_ends if is_bracket else action.gradient_ends
    pairs = () if is_bracket else action.pair_sums
    sums = [each.symbol for each in pairs]
    assert (loops.partners is not None) == bool(pairs), loops.name
    if loops.partners is not None:
        yield loops.partners, symbols.of_both([each.term for each in pairs]), ()
    yield loops.member, whole, sums
    yield from ((part, ends[member], sums) for member, part in loops.ends)
    assert len(loops.ends) == len(ends), loops.name


def _write_out(rises: Rises) -> list[Tree]:
    """What a flow adds, without symbols of angles."""
    known = dict[Symbol, Tree]()
    for symbol, tree in rises.definitions:
        known[symbol] = tree.xreplace(known)
    return [tree.xreplace(known) for tree in rises.trees]


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
        if not are_equal(sympy.sympify(found), wanted):
            raise _fail(name, f"{found} in the place of {wanted}")


def _number(value: Fraction) -> Any:
    return sympy.Rational(value.numerator, value.denominator)


def _call(function: str, *arguments: Any) -> Any:
    own = {"abs": sympy.Abs}.get(function) or getattr(sympy, function)
    return own(*arguments)


def _fail(name: str, problem: str) -> CrossCheckError:
    """The failure of rung 2."""
    return CrossCheckError(
        f"rung 2: {name}: {problem[:400]}. This is a fault of coadjoint, please report it.",
        rung=2,
        function=name,
    )
