r"""The Clebsch route: the constraint is advection, and a canonical pair moves.

Theorem (Holm 2011, sections 2.5.5, 8.4 and 9.3): for a left-invariant Lagrangian, the principle

.. math::
    \delta \int l(\xi, q) + \langle p, \dot q + \rho(\xi) q \rangle \, dt = 0

gives by :math:`\delta p` the advection :math:`\dot q = -\rho(\xi) q`, by :math:`\delta q` the
conjugate equation :math:`\dot p = \partial l/\partial q + \rho(\xi)^T p`, and by :math:`\delta\xi`
the momentum map

.. math::
    \frac{\partial l}{\partial\xi} = p \diamond q, \qquad
    \langle p \diamond q, \xi \rangle = -\langle p, \rho(\xi) q \rangle.

A right-invariant system is advected with the opposite sign. The pairs are those of the advected
quantities, and one more of the representation that the spec names in ``[clebsch]``; where there is
neither, q is an element of the algebra. The momenta are those that the map reaches:
:math:`\Pi \cdot \Gamma = 0` for the heavy top.
Comes in: a Setting with a Lagrangian. Goes out: Equations in the Chart (q, p), all of them
derivatives of one function. Read next: `coadjoint.prove.charts`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import islice

from coadjoint.algebra import Representation, algebra_by_name
from coadjoint.algebra.representation import adjoint
from coadjoint.derive.charts import in_chart
from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.legendre import legendre
from coadjoint.derive.records import Step, rate, symbol, write_rates, write_slopes, write_step
from coadjoint.derive.setting import Setting
from coadjoint.derive.symbols import choose_names
from coadjoint.exact import Element
from coadjoint.notation.written import add, enclose, negate
from coadjoint.spec import Spec
from coadjoint.spec.model import component_names

#: Names of q and of its momenta, with the action on q.
_Pair = tuple[tuple[str, ...], tuple[str, ...], Representation]


def symbols(spec: Spec) -> tuple[str, ...]:
    """Names of the momenta, ``p_Gamma1``, and of a pair of its own, ``Q1`` and ``P1``."""
    advected = [name for each in spec.having_role("advected") for name in each.components]
    own = _find_own_action(spec)
    pair = () if own is None else _pair_names(spec, (own.dimension,))
    return (*choose_names(spec, [f"p_{name}" for name in advected]), *pair)


def _pair_names(spec: Spec, shape: tuple[int]) -> tuple[str, ...]:
    """``Q1 .. P1 ..``, in small letters where these are taken."""
    large, small = (
        [name for letter in letters for name in component_names(letter, shape)]
        for letters in ("QP", "qp")
    )
    return tuple(large) if choose_names(spec, large) == tuple(large) else choose_names(spec, small)


def _find_own_action(spec: Spec) -> Representation | None:
    """The representation of the pair next to the advected quantities, if there is one."""
    assert spec.algebra is not None, "the reader asks for an algebra on this route"
    if spec.clebsch is None and not spec.having_role("advected"):
        return adjoint(spec.algebra)
    return spec.clebsch


def _pairs(setting: Setting) -> list[_Pair]:
    """The canonical pairs: every advected quantity with its momenta, then one of its own."""
    names, pairs = iter(symbols(setting.spec)), list[_Pair]()
    for variable in setting.advected:
        q = variable.components
        pairs.append((q, tuple(islice(names, len(q))), setting.actions[variable.name]))
    own = _find_own_action(setting.spec)
    if own is not None:
        q, p = (tuple(islice(names, own.dimension)) for _ in "QP")
        pairs.append((q, p, own.over(setting.take_constant, setting.algebra)))
    return pairs


def derive(setting: Setting) -> Equations:
    """Equations of motion of a canonical pair by Clebsch's principle.

    Raises:
        DerivationError: The Lagrangian has no invertible Legendre transform.
    """
    field, lagrangian, pairs = setting.field, setting.lagrangian, _pairs(setting)
    q = tuple(name for each, _, _ in pairs for name in each)
    p = tuple(name for _, each, _ in pairs for name in each)
    pairing = _pairing(setting, pairs)
    action = lagrangian + pairing  # what is added to <p, dq/dt>
    rates = dict(zip(q, (-slope for slope in field.gradient(action, p)), strict=True))
    rates |= zip(p, field.gradient(action, q), strict=True)
    momentum = tuple(-slope for slope in field.gradient(pairing, setting.velocities))
    image = dict(zip(setting.momenta, momentum, strict=True))
    transform = legendre(setting)
    velocities = tuple((name, field.substitute(x, image)) for name, x in transform.definitions)
    through = _through(setting, pairs)
    motion = in_chart(setting, "clebsch", rates, image, through, definitions=velocities)
    return replace(motion, steps=_steps(motion, action, image))


def _pairing(setting: Setting, pairs: list[_Pair]) -> Element:
    """``<p, rho(xi) q>``, the sign turned for a right-invariant system."""
    field, xi = setting.field, setting.elements(setting.velocities)
    total = [
        field[name] * moved
        for q, p, action in pairs
        for name, moved in zip(p, action.act(xi, setting.elements(q)), strict=True)
    ]
    return setting.sign * field.sum(total)


def _through(setting: Setting, pairs: list[_Pair]) -> str:
    """The map in words: ``Pi = p_Gamma x Gamma``, or with a diamond."""
    momenta = [variable.name for variable in setting.spec.having_role("momentum")]
    mu = momenta[0] if len(momenta) == 1 else f"({', '.join(momenta)})"
    crossed = all(_turns_vectors(setting, action) for _, _, action in pairs)
    sign = "" if setting.sign == 1 else "-"
    terms = []
    for q, p, _ in pairs:
        q_name, p_name = (_find_stem(names) for names in (q, p))
        if crossed:
            terms.append(" x ".join((p_name, q_name) if setting.sign == 1 else (q_name, p_name)))
        else:
            terms.append(f"{sign}{p_name} <> {q_name}")
    return f"{mu} = {' + '.join(terms)}"


def _find_stem(names: tuple[str, ...]) -> str:
    """The name of a quantity from those of its components."""
    first = names[0]
    stem = first.rstrip("0123456789_")
    return stem if len(names) > 1 else first


def _turns_vectors(setting: Setting, action: Representation) -> bool:
    """Whether ``rho(xi) a = xi x a``, so that the diamond is a cross product."""
    rotations = adjoint(algebra_by_name("so(3)")).matrices
    plain = len(setting.spec.having_role("momentum")) == 1
    return plain and tuple(map(dict, action.matrices)) == tuple(map(dict, rotations))


def _steps(motion: Equations, action: Element, image: Mapping[str, Element]) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    setting, exact, n = motion.setting, motion.exact, len(motion.variables) // 2
    sign = "+" if setting.sign == 1 else "-"
    turn, back = ("", "-") if setting.sign == 1 else ("-", "")
    lines = tuple(write_rates(motion.variables, exact.rates))
    return (
        write_step(
            "Clebsch action",
            f"L = <p, dq/dt> + l(xi, q) {sign} <p, rho(xi) q>",
            rf"L = \langle p, \dot q \rangle + l(\xi, q) {sign} \langle p, \rho(\xi) q \rangle",
            [(add([symbol("L"), negate(enclose([symbol("p"), rate("q")], "<>"))]), action)],
            by="clebsch",
        ),
        write_step(
            "Variation of xi: the momentum map",
            f"dl/dxi = {turn}p <> q,  <p <> q, xi> = -<p, rho(xi) q>",
            rf"\partial l / \partial \xi = {turn}p \diamond q",
            write_slopes("l", setting.velocities, (image[mu] for mu in setting.momenta)),
            by="momentum-map",
        ),
        write_step(
            "Velocities",
            "xi solved from mu = dl/dxi",
            r"\xi = \xi(\mu, q)",
            exact.definitions,
            by="legendre",
        ),
        write_step(
            "Variation of p: advection",
            f"dq/dt = {back}rho(xi) q",
            rf"\dot q = {back}\rho(\xi) q",
            lines[:n],
            by="clebsch",
        ),
        write_step(
            "Variation of q: the conjugate momentum",
            f"dp/dt = dl/dq {sign} rho(xi)^T p",
            rf"\dot p = \partial l / \partial q {sign} \rho(\xi)^T p",
            lines[n:],
            by="clebsch",
        ),
    )
