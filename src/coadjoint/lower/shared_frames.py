r"""Shared frames: rates in the names of definitions such as ``y = transpose(R)*x``.

Elements are polynomials, so that a potential of y is multiplied out in the entries of R and x: one
of second order in y has 36 terms in place of 6. Definitions of the spec that name an attitude or a
pose, and are polynomials of the state and parameters, get names of their own here. With a
Groebner basis of the relations :math:`y_i - p_i(R, x)`, in an order that eliminates the state
before y, the remainder of a polynomial that is one of y alone is that polynomial, whatever the
state: then, :math:`q(p(R, x)) - g` is in the ideal for one g in y alone, since the p_i are
independent. Other polynomials are left with fewer powers of the state, or as they were: a remainder
whose terms would cancel one another, multiplied out, loses digits that the polynomial does not.
Comes in: Equations. Goes out: the same with more definitions, and elements in their names.
Read next: `coadjoint.lower.lowering`, which keeps them where they save operations.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from math import prod
from typing import Any

from sympy import QQ
from sympy.polys.groebnertools import groebner
from sympy.polys.orderings import lex
from sympy.polys.rings import PolyRing

from coadjoint.derive import Equations
from coadjoint.derive.frame_names import frame_components
from coadjoint.derive.interpret import entries, interpret
from coadjoint.derive.setting import once
from coadjoint.exact import Element, Field

#: Components that get names, and terms of each: a basis for 21 variables takes 0.03 seconds.
COMPONENTS, TERMS = 9, 12


@dataclass(frozen=True)
class SharedFrames:
    """The relations of the named components.

    Attributes:
        names: Of the state, of parameters and of the components, in the order of elimination.
        ring: Polynomials of these.
        basis: A Groebner basis of the relations.
        sizes: Of the components, by their places in the ring, the polynomials that they are, with
            positive coefficients.
    """

    names: tuple[str, ...]
    ring: PolyRing
    basis: tuple[Any, ...]
    sizes: Mapping[int, Any]

    def rewrite(self, field: Field, element: Element) -> Element:
        """An element whose numerators are remainders; the same where that has not fewer terms."""
        written = field.quotients(element)
        whole = field.sum(self._rewrite_quotient(field, each) for each in written)
        shorter = len(field.terms(whole)) < len(field.terms(element))
        return whole if shorter else element

    def _rewrite_quotient(self, field: Field, written: Any) -> Element:
        """One quotient: the coefficients of all that the relations do not name, one by one."""
        places = {name: n for n, name in enumerate(self.names)}
        parts: dict[tuple[tuple[str, int], ...], dict[tuple[int, ...], Any]] = {}
        for monomial in written.monomials:
            outer = tuple((name, e) for name, e in monomial.powers if name not in places)
            inner = [0] * len(self.names)
            for name, e in monomial.powers:
                if name in places:
                    inner[places[name]] = e
            number = QQ(monomial.number.numerator, monomial.number.denominator)
            parts.setdefault(outer, {})[tuple(inner)] = number
        total = field.zero
        for outer, terms in parts.items():
            factor = prod((field[name] ** e for name, e in outer), start=field.one)
            whole = self.ring.from_dict(terms)
            rest = whole.rem(list(self.basis))
            total += factor * self._element(field, whole if self._cancels(rest, whole) else rest)
        return total / prod((d**e for d, e in written.divisors), start=field.one)

    def _cancels(self, rest: Any, whole: Any) -> bool:
        """Whether terms of a remainder, multiplied out, are larger than those of the polynomial."""
        total = self.ring.zero
        for powers, c in rest.terms():
            own = {n: e for n, e in enumerate(powers) if e and n in self.sizes}
            outer = tuple(0 if n in own else e for n, e in enumerate(powers))
            term = self.ring.from_dict({outer: abs(c)})
            total += prod((self.sizes[n] ** e for n, e in own.items()), start=term)
        return any(c > abs(whole.get(powers, 0)) for powers, c in total.terms())

    def _element(self, field: Field, polynomial: Any) -> Element:
        """A polynomial of the ring in the field."""
        return field.sum(
            prod(
                (field[name] ** e for name, e in zip(self.names, powers, strict=True) if e),
                start=field.number(Fraction(int(c.numerator), int(c.denominator))),
            )
            for powers, c in polynomial.terms()
        )


def name_frames(equations: Equations) -> Equations:
    """The same equations with definitions for the named components; unchanged without any."""
    values = _find_values(equations)
    if not values or equations.kept:
        return equations
    field, before, written = equations.setting.field, dict[str, Element](), dict[str, Element]()
    for name, value in values.items():
        known = _relate(equations, before)
        written[name] = value if known is None else known.rewrite(field, value)
        before[name] = value
    definitions = (*written.items(), *equations.exact.definitions)
    return replace(equations, exact=replace(equations.exact, definitions=definitions))


@once
def shared_frames(equations: Equations) -> SharedFrames | None:
    """The relations of what `name_frames` has named; None where it has not."""
    values = _find_values(equations)
    named = values.keys() <= {name for name, _ in equations.exact.definitions}
    return _relate(equations, values) if named else None


def _relate(equations: Equations, values: Mapping[str, Element]) -> SharedFrames | None:
    """The relations of some named components."""
    if not values:
        return None
    field = equations.setting.field
    reached = frozenset[str]().union(*map(field.reach, values.values()))
    own = (*equations.setting.state, *equations.setting.parameters)
    names = (*(name for name in own if name in reached), *reversed(tuple(values)))
    ring = PolyRing(names, QQ, lex)
    relations, sizes = [], {}
    for name, value in values.items():
        (written,) = field.quotients(value)
        terms = {}
        for monomial in written.monomials:
            powers = dict(monomial.powers)
            number = QQ(monomial.number.numerator, monomial.number.denominator)
            terms[tuple(powers.get(each, 0) for each in names)] = number
        place = names.index(name)
        relations.append(ring.from_dict(terms) - ring.gens[place])
        sizes[place] = ring.from_dict({powers: abs(c) for powers, c in terms.items()})
    return SharedFrames(names=names, ring=ring, basis=tuple(groebner(relations, ring)), sizes=sizes)


@once
def _find_values(equations: Equations) -> dict[str, Element]:
    """The polynomials that have names, without those of one term, as far as they are few."""
    setting, found = equations.setting, dict[str, Element]()
    field, known = setting.field, {*setting.state, *setting.parameters}
    for definition, names in frame_components(setting.spec):
        if not {variable.name for variable in setting.spec.state} <= setting.values.keys():
            break  # equations of a projection or a flow know components alone
        parts = entries(interpret(definition.tree, setting.values, field))
        regular = all(
            field.reach(part) <= known
            and len(field.quotients(part)) == 1
            and not field.quotients(part)[0].divisors
            and 1 < len(field.terms(part)) <= TERMS
            for part in parts
        )
        few = len(found) + len(parts) <= COMPONENTS
        if regular and few and not {*parts} & {*found.values()}:
            found |= zip(names, parts, strict=True)
    return found
