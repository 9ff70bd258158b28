r"""Claims about fields: their bracket, what is conserved, and that all routes give one motion.

A bracket :math:`\{f, h\} = \oint \frac{\delta f}{\delta u} P \frac{\delta h}{\delta u}`
satisfies the Jacobi identity if and only if, for all covectors :math:`\xi, \eta, \zeta` along
space,

.. math:: \oint \xi \cdot P'[P \eta]\, \zeta + \text{cyclic} = 0,

with the derivative :math:`P'[v]` of P by the fields along v (Olver 1993, Applications of Lie Groups
to Differential Equations, 2nd ed., proposition 7.7). The integrand is a polynomial in the jets of
all, and its integral vanishes if and only if its variational derivative by :math:`\zeta` does. A
density f is conserved if its rate is a total derivative, :math:`\partial_t f + \partial_s F = 0`:
the variational derivative of the rate decides that, and the flux F is exhibited.
Comes in: Equations of fields by all routes. Goes out: statements, and what must be zero.
Read next: `coadjoint.prove.claims`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

from coadjoint.derive import Equations
from coadjoint.derive.fields.emission import read_density
from coadjoint.derive.fields.grid import make_grid
from coadjoint.derive.fields.jets import DEGREE, Jets, jets_of, list_rows
from coadjoint.derive.fields.operators import Operator, apply, order_of, skew_defects
from coadjoint.derive.fields.structure import cocycle, field_operator
from coadjoint.derive.fields.symbol import look_at_symbol
from coadjoint.derive.fields.torus import make_torus
from coadjoint.exact import Element, Field
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.fluxes import decide_density, decide_law
from coadjoint.prove.grids import about_grid
from coadjoint.prove.lax import lax_decision
from coadjoint.prove.strands import about_strand, decide_holonomy
from coadjoint.prove.torus import about_torus
from coadjoint.prove.zero import (
    Decision,
    Discovery,
    Examined,
    decide_zero,
    give,
    mark_claimed,
    mark_place,
)

_COVECTORS = ("_xi", "_eta", "_zeta")


def about_fields(routes: Sequence[Equations]) -> Iterator[Examined]:
    """All that is examined of fields, in the order of the certificate."""
    first = routes[0]
    yield from _about_bracket(first)
    yield from _about_posedness(first)
    yield from _about_equality(routes)
    yield from _about_casimirs(first)
    yield from _about_densities(first)
    for equations in routes:
        yield from _about_pair(first, routes, equations)
    yield from about_strand(first)
    if first.spec.in_plane:
        yield from about_torus(make_torus(first), partial(decide_density, first))
    else:
        yield from about_grid(make_grid(first))


# -- the bracket ------------------------------------------------------------------------------


def _about_bracket(first: Equations) -> Iterator[Examined]:
    """The bracket of the fields: antisymmetric, and a Poisson bracket."""
    setting, jets = first.setting, jets_of(first.setting).only(first.setting.state)
    operator = field_operator(setting)
    yield (
        "the bracket of the fields is antisymmetric: P + P^* = 0 by integration by parts",
        "jacobi",
        lambda: decide_skew(operator, jets),
    )
    yield (
        "the bracket of the fields satisfies the Jacobi identity",
        "jacobi",
        lambda: decide_jacobi(operator, jets),
    )


def decide_skew(operator: Operator, jets: Jets) -> Decision:
    """Whether an operator is minus its adjoint."""
    defects = skew_defects(operator, jets)
    names = [*jets.towers]
    decision = decide_zero([x for found in defects.values() for x in found], jets.field)
    if defects:
        i, j = next(iter(defects))
        decision = replace(decision, method=f"{decision.method} in {{{names[i]}, {names[j]}}}")
    return decision


def decide_jacobi(operator: Operator, jets: Jets) -> Decision:
    """Whether the bracket of an antisymmetric operator satisfies the Jacobi identity."""
    trivector = _Trivector(operator, jets)
    for place, name in enumerate(jets.towers):
        defect = trivector.defect(place)
        if trivector.field.is_zero(defect):
            continue
        decision = decide_zero([defect], trivector.field)
        a, b = trivector.find_pair(defect)
        method = f"{decision.method} for the triple ({a}, {b}, {name})"
        return replace(decision, method=method)
    method = "for all covectors along space, the variational derivative of the cyclic sum is 0"
    return Decision(verdict=Verdict.PROVED, method=method)


class _Trivector:
    """The cyclic sum of a bracket, in a field that has symbols for three covectors.

    Args:
        operator: The bracket.
        jets: Of the fields.
    """

    def __init__(self, operator: Operator, jets: Jets) -> None:
        self.names, size = [*jets.towers], len(operator)
        read = (
            jets.places[x][1:]
            for row in operator
            for entry in row
            for t in entry
            for x in (jets.field.reach(t.left) | jets.field.reach(t.right)) & jets.places.keys()
        )
        deeper = max(0, *map(sum, read), 1) - 1  # coefficients with derivatives reach further
        depth = 3 * (order_of(operator) + deeper) + 1
        coordinates = jets.coordinates
        rows = {name: list_rows(name, coordinates, depth) for name in self.names}
        self.covectors = [[f"{of}{n}" for n in range(1, size + 1)] for of in _COVECTORS]
        rows |= {
            name: list_rows(name, coordinates, 2 * depth)
            for names in self.covectors
            for name in names
        }
        symbols = [x for own in rows.values() for row in own for x in row]
        rest = [name for name in jets.field.names if name not in jets.places and name != DEGREE]
        self.field = Field([*symbols, *rest, DEGREE])
        self.jets, adopt = Jets(self.field, rows), self.field.adopt
        self.operator: Operator = tuple(
            tuple(
                tuple(replace(t, left=adopt(t.left), right=adopt(t.right)) for t in entry)
                for entry in row
            )
            for row in operator
        )
        self.density = self.field.sum(
            self._part(*(self.covectors[(n + k) % 3] for k in range(3))) for n in range(3)
        )

    def _part(self, xi: list[str], eta: list[str], zeta: list[str]) -> Element:
        """``xi . P'[P eta] zeta``."""
        field, jets = self.field, self.jets
        vectors = [[field[name] for name in names] for names in (xi, eta, zeta)]
        along = dict(zip(self.names, apply(self.operator, vectors[1], jets.total), strict=True))
        varied: Operator = tuple(
            tuple(
                tuple(
                    part
                    for t in entry
                    for part in (
                        replace(t, left=jets.rate(t.left, along)),
                        replace(t, right=jets.rate(t.right, along)),
                    )
                )
                for entry in row
            )
            for row in self.operator
        )
        moved = apply(varied, vectors[2], jets.total)
        return field.sum(a * b for a, b in zip(vectors[0], moved, strict=True))

    def defect(self, place: int) -> Element:
        """The variational derivative by a component of the last covector."""
        return self.jets.euler(self.density, self.covectors[2][place])

    def find_pair(self, defect: Element) -> tuple[str, str]:
        """The components of the other covectors in the first term of a defect."""
        reached = self.field.reach(self.field.terms(defect)[0])
        named = {self.jets.places[x][0] for x in reached & self.jets.places.keys()}
        first, second = (
            next(n for n, one in zip(self.names, own, strict=True) if one in named)
            for own in self.covectors[:2]
        )
        return first, second


# -- the motion -------------------------------------------------------------------------------


def _about_posedness(first: Equations) -> Iterator[Examined]:
    """The roots of the principal symbol; what has others is refused where it is derived."""
    seen = look_at_symbol(first.setting, jets_of(first.setting), first.exact.rates)
    assert seen.growth is None, first.spec.name
    if not seen.points:
        return
    kind = "real" if seen.order % 2 else "imaginary"
    decision = Decision(
        verdict=Verdict.PROVED, method=f"roots counted exactly, about {seen.points} fields"
    )
    diagonal = " and is diagonalizable" * seen.is_diagonalizable
    yield (
        f"the principal symbol, of order {seen.order}, has {kind} eigenvalues{diagonal}, at the "
        "defaults of the parameters and about some fields of rational values",
        "posed",
        lambda: decision,
    )
    if not seen.is_diagonalizable:
        method = (
            "a Jordan block of the principal symbol; about fields that are the same all along no "
            "wave grows like exp(k*t)"
        )
        scope = "about some of these fields"
        yield (
            "short waves may grow faster the shorter they are, by terms of lower order",
            "posed",
            partial(give, Discovery(method, scope)),
        )


def _about_equality(routes: Sequence[Equations]) -> Iterator[Examined]:
    """All routes give the same rates, as differential polynomials."""
    first = routes[0]
    for other in routes[1:]:
        pairs = zip(first.exact.rates, other.exact.rates, strict=True)
        defects = [a - b for a, b in pairs]
        if first.exact.energy is not None and other.exact.energy is not None:
            defects.append(first.exact.energy - other.exact.energy)
        yield (
            f"the route {other.route} gives the same motion and energy as {first.route}",
            "equivalence",
            partial(list, defects),
        )


def _about_casimirs(first: Equations) -> Iterator[Examined]:
    """The bracket of the integral of a density with everything vanishes."""
    setting, jets = first.setting, jets_of(first.setting)
    operator = field_operator(setting)

    def decide(value: Element) -> list[Element]:
        slopes = [jets.euler(value, name) for name in setting.state]
        return list(apply(operator, slopes, jets.total))

    for place, formula in enumerate(setting.spec.casimirs):
        parts = setting.components(formula)
        defects = partial(lambda parts: [x for part in parts for x in decide(part)], parts)
        claimed = [(f"the integral of {formula.in_one_line} is a Casimir", "casimir", defects)]
        key = ("claims", "casimirs", place)
        yield from mark_claimed(setting.spec, key, formula, claimed, setting.field)


def _about_densities(first: Equations) -> Iterator[Examined]:
    """The energy, and what the spec claims to be conserved."""
    setting, spec = first.setting, first.spec
    emitted = {each.name: each.whole for each in first.exact.emitted}
    space = spec.space
    assert space is not None, spec.name
    if first.exact.energy is not None and space.has_ends:
        statement = f"the integral of the energy is conserved between {space.ends} ends"
        yield statement, "conserved", partial(_decide_between_ends, first)
    elif first.exact.energy is not None:
        decide = partial(decide_density, first, [first.exact.energy])
        yield "the integral of the energy is conserved", "conserved", decide
    for place, claim in enumerate(spec.conserved):
        if claim.everywhere != "energy":
            parts = read_density(setting, claim.formula, emitted)
            decision, where = decide_law(first, parts, claim.formula)
            statement = f"the integral of {claim.formula.in_one_line} is conserved{where}"
            claimed = [(statement, "conserved", partial(give, decision))]
            key = ("claims", "conserved", place)
            yield from mark_claimed(spec, key, claim.formula, claimed, setting.field)


def _decide_between_ends(equations: Equations) -> Decision:
    """The flux of the energy is ``-h_Pi . h_Xi``, in which one factor is 0 at the ends."""
    setting, jets = equations.setting, jets_of(equations.setting)
    field, energy = setting.field, equations.exact.energy
    assert energy is not None, equations.spec.name
    slopes = [field.derivative(energy, name) for name in setting.state]
    by_name = dict(zip(setting.state, slopes, strict=True))
    flux = -field.sum(by_name[mu] * by_name[strain] for mu, strain in cocycle(setting))
    rates = dict(zip(setting.state, equations.exact.rates, strict=True))
    decision = decide_zero([jets.rate(energy, rates) + jets.total(flux)], field)
    method = (
        f"{decision.method}: its rate + d/ds flux = 0, with the flux -dh/dmu . dh/dXi, in "
        "which the velocities or the stresses are 0 at the ends"
    )
    return replace(decision, method=method)


def _about_pair(
    first: Equations, routes: Sequence[Equations], equations: Equations
) -> Iterator[Examined]:
    """The equation of zero curvature of a declared pair."""
    if equations.pair is None:
        return
    pair, space = equations.pair, first.spec.space
    motion = next((each for each in routes if each.pair is None), first)
    statement = (
        f"dL/dt - dM/ds = [L, M] for every {pair.spectral}, with L = {pair.texts[0]} and M = "
        f"{pair.texts[1]}, on the route {equations.route}"
    )
    examined: list[Examined] = [(statement, "lax", lambda: lax_decision(motion, pair))]
    if space is not None and not space.has_ends:
        statement = (
            f"the trace of the holonomy of dpsi/d{space.name} = psi L around the circle is "
            f"conserved, for every {pair.spectral} for which L is finite"
        )
        examined.append(
            (statement, "lax", lambda: decide_holonomy(lax_decision(motion, pair), "M"))
        )
    yield from mark_place(pair.declared, examined, first.setting.field)
