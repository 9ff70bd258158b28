r"""Duality: the Legendre transform of the Hamiltonian is the Lagrangian again.

Comes in: Equations by the route canonical of a spec with a Lagrangian. Goes out: what must be zero.
With :math:`p = \partial l / \partial v` the transform of l is :math:`h = p \cdot v - l`. Here it is
taken back from h alone: :math:`v = \partial h / \partial p` is solved for p, and :math:`p \cdot v -
h` must be the declared l.
Read next: `coadjoint.derive.mechanics.configuration`.

Source:
    Holm (2011), Geometric Mechanics II, definition 2.5.1.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import partial

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.configuration import conjugates
from coadjoint.errors import DerivationError
from coadjoint.exact import Element

Examined = tuple[str, str, Callable[[], Sequence[Element]]]


def about_duality(equations: Equations) -> Iterator[Examined]:
    """That h of the route canonical gives l back; nothing where h is not quadratic in momenta."""
    spec = equations.spec
    if (
        equations.route != "canonical"
        or spec.lagrangian is None
        or equations.kept
        or spec.variational
    ):
        return
    if spec.poisson is not None and spec.poisson.entries:
        return  # with magnetic terms velocities are not derivatives of l by definition
    with suppress(DerivationError):
        momenta = _momenta(equations)
        examine = partial(_defects, equations, momenta)
        yield "p . v - h(p), at v = dh/dp, is l on the route canonical", "legendre", examine


def _momenta(equations: Equations) -> tuple[Element, ...]:
    """``p(v)`` from ``v = w dh/dp``."""
    setting, (names, weights) = equations.setting, _names(equations)
    assert equations.exact.energy is not None, "the route canonical has a Hamiltonian"
    h = equations.close(equations.exact.energy)
    velocities = setting.elements(setting.velocities)
    values = [v * (1 / w) for v, w in zip(velocities, weights, strict=True)]
    return conjugates(setting.field, h, names, values, lambda text, _: DerivationError(text))


def _names(equations: Equations) -> tuple[Sequence[str], Sequence[Fraction]]:
    """The symbols of the momenta: the route's own, the declared ones, or velocities of mass one."""
    setting, count = equations.setting, len(equations.setting.positions)
    if equations.chart is not None:
        return equations.chart.variables[count:], (Fraction(1),) * count
    if setting.momenta:
        return setting.momenta, setting.weights
    return setting.velocities, (Fraction(1),) * count


def _defects(equations: Equations, momenta: Sequence[Element]) -> list[Element]:
    """``p . v - h - l`` with ``p = p(v)``."""
    setting, (names, weights) = equations.setting, _names(equations)
    field, formula = setting.field, setting.spec.lagrangian
    assert formula is not None, equations.route
    assert equations.exact.energy is not None, equations.route
    velocities = setting.elements(setting.velocities)
    triples = zip(momenta, velocities, weights, strict=True)
    paired = field.sum(p * v * (1 / w) for p, v, w in triples)
    solved = dict(zip(names, momenta, strict=True))
    h = field.substitute(equations.close(equations.exact.energy), solved)
    return [paired - h - setting.formula(formula)]
