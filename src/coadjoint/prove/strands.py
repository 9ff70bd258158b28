r"""Claims about strands: the holonomy of the strain, and what turns along the strand with it.

An advected quantity of a strand, :math:`a = \rho(g)^{-1} a_0`, moves by :math:`\partial_t a =
-\rho(\Omega) a`. Where :math:`a_0` is the same all along the strand it has a second equation,
:math:`\partial_s a = -\rho(\Xi) a`, and both must agree. They do: by zero curvature, and since rho
is a representation, what the second one misses by obeys

.. math:: E = \partial_s a + \rho(\Xi) a, \qquad \partial_t E = -\rho(\Omega) E,

a linear equation without a source, so that E stays 0 where it is 0 at the beginning. In a right
invariant motion all signs of rho are the other ones (Holm and Ivanov 2013, arXiv:1305.4010).
Comes in: Equations of a strand. Goes out: statements, and what must be zero.
Read next: `coadjoint.prove.fields`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

from coadjoint.algebra.matrices import SparseMatrix, product, size
from coadjoint.derive import Equations
from coadjoint.derive.fields.jets import jets_of
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element, element_text
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.zero import Decision, Examined, decide_zero
from coadjoint.spec.sections.state import Variable


def about_strand(first: Equations) -> Iterator[Examined]:
    """The holonomy of the strain of a strand, and the advected quantities along it."""
    setting, space, energy = first.setting, first.spec.space, first.exact.energy
    strains = [each for each in setting.advected if each.strain]
    if space is None or energy is None or not strains:
        return
    (strain,), s = strains, space.name
    is_left = first.spec.invariance == "left"
    if not space.has_ends:
        turned = tell_matrix(first, strain)
        side = f"psi {turned}" if is_left else f"{turned} psi"
        yield (
            f"the trace of the holonomy of dpsi/d{s} = {side} around the circle is conserved",
            "lax",
            partial(_decide_curvature, first, strain, energy),
        )
    for each in list_turning(first):
        yield (
            f"{tell_turn(first, each)} holds at all times if it does at the beginning",
            "lax",
            partial(_decide_propagation, first, strain, each, energy),
        )


def list_matrices(setting: Setting) -> list[SparseMatrix]:
    """Matrices of a basis whose bracket is the commutator, entries in the field; empty if unknown.

    Where the bracket is ``X N Y - Y N X`` the products N X have this one.
    """
    algebra = setting.algebra
    if algebra.middle:
        return [product(algebra.middle, each) for each in algebra.elements]
    return [] if algebra.elements else [*algebra.matrices]


def tell_matrix(first: Equations, strain: Variable) -> str:
    """By what a strain moves psi: its matrix, N times that, or its adjoint action."""
    setting, algebra = first.setting, first.setting.algebra
    if not list_matrices(setting):
        return f"ad({strain.name})"
    if not algebra.middle:
        return strain.name
    field, places = setting.field, range(size(algebra.elements))
    entries = [[algebra.middle.get((i, j), 0) + field.zero for j in places] for i in places]
    rows = tuple(map(tuple, entries))
    named = (each.name for each in first.spec.parameters if setting.values[each.name] == rows)
    texts = (", ".join(element_text(field, x) for x in row) for row in rows)
    middle = next(named, f"[[{'], ['.join(texts)}]]")
    return f"{middle} {strain.name}"


def list_turning(first: Equations) -> tuple[Variable, ...]:
    """The advected quantities that may turn along a strand; none without a strain."""
    advected = first.setting.advected
    is_strand = any(each.strain for each in advected)
    return tuple(each for each in advected if is_strand and not each.strain)


def tell_turn(first: Equations, each: Variable) -> str:
    """How an advected quantity turns along a strand: ``da/ds = -Xi a``."""
    (strain,), space = (x for x in first.setting.advected if x.strain), first.spec.space
    assert space is not None, first.spec.name
    sign = "-" if first.spec.invariance == "left" else ""
    return f"d{each.name}/d{space.name} = {sign}{strain.name} {each.name}"


def turn_along(first: Equations) -> Callable[[Element], Element]:
    """What puts ``-rho(Xi) a`` in the place of ``da/ds``, and so of all derivatives of a."""
    setting, jets = first.setting, jets_of(first.setting)
    field, turning = setting.field, list_turning(first)
    (strain,) = (x for x in setting.advected if x.strain)
    slopes = dict[str, Element]()
    for each in turning:
        act, a = setting.actions[each.name].act, setting.elements(each.components)
        turned = act(setting.elements(strain.components), a)
        slopes |= {name: -setting.sign * x for name, x in zip(each.components, turned, strict=True)}

    def turn(element: Element) -> Element:
        named = (jets.orders[x] for x in field.reach(element) & jets.orders.keys())
        top = max((order for name, order in named if name in slopes), default=0)
        for order in range(top, 0, -1):  # what a higher one gives has lower ones
            values = {
                jets.towers[name][order]: jets.total(slope, order - 1)
                for name, slope in slopes.items()
                if jets.towers[name][order] in field.reach(element)
            }
            element = field.substitute(element, values)
        return element

    return turn


def _decide_curvature(first: Equations, strain: Variable, energy: Element) -> Decision:
    """Zero curvature, ``dXi/dt - dOmega/ds = [Xi, Omega]`` with Omega = dh/dmu; on the right minus.

    The bracket is that of the structure constants, and knows nothing of how the strain is advected.
    """
    setting, jets = first.setting, jets_of(first.setting)
    field, strains = setting.field, strain.components
    omega = [jets.euler(energy, mu) for mu in setting.momenta]
    rates = dict(zip(setting.state, first.exact.rates, strict=True))
    turned = {n: list[Element]() for n in range(len(strains))}
    for (a, b), row in setting.algebra.constants.items():
        for c, value in row.items():
            part = field[strains[a]] * omega[b] - field[strains[b]] * omega[a]
            turned[c].append(part * value)
    defects = [
        rates[name] - jets.total(omega[n]) - field.sum(turned[n]) * setting.sign
        for n, name in enumerate(strains)
    ]
    return decide_holonomy(decide_zero(defects, field), "the velocity")


def decide_holonomy(decision: Decision, by: str) -> Decision:
    """What zero curvature says of the holonomy.

    Args:
        decision: Whether the curvature is zero.
        by: What turns the holonomy at the first point.
    """
    if decision.verdict is not Verdict.PROVED:
        return decision
    method = (
        f"{decision.method}: zero curvature, so that the rate of the holonomy is its commutator "
        f"with {by} at the first point"
    )
    return replace(decision, method=method)


def _decide_propagation(
    first: Equations, strain: Variable, advected: Variable, energy: Element
) -> Decision:
    """``dE/dt = -rho(Omega) E`` of ``E = da/ds + rho(Xi) a``, Omega = dh/dmu; on the right plus.

    E is differentiated along the emitted rates of a and Xi, whatever route they are from.
    """
    setting, jets = first.setting, jets_of(first.setting)
    field, action, a, sign = setting.field, setting.actions, advected, setting.sign
    act = action[a.name].act
    omega = [jets.euler(energy, mu) for mu in setting.momenta]
    turned = act(setting.elements(strain.components), setting.elements(a.components))
    misses = [
        jets.total(field[name]) + sign * x for name, x in zip(a.components, turned, strict=True)
    ]
    rates = dict(zip(setting.state, first.exact.rates, strict=True))
    moved = zip(misses, act(omega, misses), strict=True)
    decision = decide_zero([jets.rate(E, rates) + sign * x for E, x in moved], field)
    if decision.verdict is not Verdict.PROVED:
        return decision
    plus, minus = ("+", "-") if sign == 1 else ("-", "")
    s = jets.coordinates[0]
    method = (
        f"{decision.method}: what it misses by, E = d{a.name}/d{s} {plus} {strain.name} {a.name}, "
        f"obeys dE/dt = {minus}(dh/dmu) E, which is linear in E and has no source"
    )
    return replace(decision, method=method)
