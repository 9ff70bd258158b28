"""Singular Lagrangians: that the motion makes the action stationary.

Lagrange's equations, or those of Euler and Poincare, are written down once more, from the declared
Lagrangian and the rates alone; nothing of the one-form, the constraints and their bracket is used.
Comes in: a motion in which all velocities follow. Goes out: a claim for the certificate.
Read next: `coadjoint.derive.mechanics.first_order`, `coadjoint.derive.mechanics.bound_momenta`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.configuration import mechanics
from coadjoint.derive.mechanics.external import external_forces
from coadjoint.derive.records import sign_text
from coadjoint.derive.structure import poisson_structure
from coadjoint.exact import Element
from coadjoint.prove.motion import Motion
from coadjoint.prove.zero import Examined


def about_stationarity(motion: Motion) -> Iterator[Examined]:
    """The laws of motion hold, and momenta are what they are declared to be."""
    forces = " + f" * bool(motion.spec.forces) + " - dR/dv" * bool(motion.spec.dissipation)
    if motion.spec.algebra is not None:
        forces = forces.replace("dv", "dxi")
        law = sign_text(motion.setting.sign, "ad*_xi dl/dxi + dl/da <> a")
        text = (
            f"d/dt dl/dxi = {law}{forces} along the motion, with mu = dl/dxi and da/dt as advected"
        )
        yield text, "legendre", partial(_defects_over_algebra, motion)
        return
    text = f"d/dt dl/dv = dl/dq{forces} along the motion"
    if motion.setting.momenta:
        text += ", with p = dl/dv of the declared momenta"
    yield text, "legendre", partial(_defects, motion)


def about_form(routes: Sequence[Equations]) -> Iterator[Examined]:
    """That the bracket of the one-form is the one that a spec declares."""
    for each in routes:
        if each.route == "first-order" and each.spec.poisson is not None:
            text = "the bracket (d theta)^-1 of the Lagrangian is that of [poisson]"
            yield text, "equivalence", partial(_bracket_defects, each)


def _bracket_defects(by_form: Equations) -> list[Element]:
    """The brackets of the state by the form, minus those that are declared."""
    found, declared = by_form.exact.poisson_tensor, poisson_structure(by_form.setting).tensor
    assert found is not None, "a form of first order has a bracket"
    return [
        by_form.close(a) - b
        for rows in zip(found, declared, strict=True)
        for a, b in zip(*rows, strict=True)
    ]


def _defects_over_algebra(motion: Motion) -> list[Element]:
    """``d/dt dl/dxi - ad*_xi dl/dxi - dl/da <> a``, ``mu - dl/dxi`` and ``da/dt + rho(xi) a``."""
    setting, sign = motion.setting, motion.setting.sign
    lagrangian, slope = setting.lagrangian, setting.field.gradient
    xi, algebra = setting.elements(setting.velocities), setting.algebra
    momenta = slope(lagrangian, setting.velocities)
    turned, advected = list(algebra.ad_star(xi, momenta)), list[tuple[Element, Element]]()
    for variable in setting.advected:
        a, action = setting.elements(variable.components), setting.actions[variable.name]
        torque = action.diamond(slope(lagrangian, variable.components), a)
        turned = [x + y for x, y in zip(turned, torque, strict=True)]
        advected += zip(a, action.act(xi, a), strict=True)
    forces = external_forces(setting, setting.velocities)
    close = motion.close
    rows = zip(setting.elements(setting.momenta), momenta, turned, forces, strict=True)
    return [
        *(
            defect
            for mu, p, turn, force in rows
            for defect in (
                close(mu) - close(p),
                motion.rate(close(p)) - close(sign * turn) - close(force),
            )
        ),
        *(motion.rate(close(a)) + sign * close(moved) for a, moved in advected),
    ]


def _defects(motion: Motion) -> list[Element]:
    """``d/dt dl/dv - dl/dq - f``, and ``p - dl/dv``, at the velocities of the motion."""
    setting, known = motion.setting, mechanics(motion.setting)
    momenta = [motion.close(each) for each in known.momenta]
    slopes = [motion.close(each) for each in known.slopes]
    forces = map(motion.close, external_forces(setting, setting.velocities))
    defects = [
        motion.rate(p) - slope - force
        for p, slope, force in zip(momenta, slopes, forces, strict=True)
    ]
    declared = dict(zip(setting.momenta, setting.weights, strict=True))
    for variable in motion.spec.having_role("momentum"):
        whole = motion.spec.partner("momentum", variable.of)
        position = next(q for q in motion.spec.having_role("coordinate") if q.name == variable.of)
        assert whole is variable, "each coordinate has one momentum"
        for p, q in zip(variable.components, position.components, strict=True):
            slope = momenta[setting.positions.index(q)]
            own = motion.close(setting.field[p])
            defects.append(own * (1 / declared[p]) - slope)
    return defects
