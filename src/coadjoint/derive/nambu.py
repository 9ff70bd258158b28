r"""The Nambu route: from a Hamiltonian and n - 2 distinguished functions of n coordinates.

Theorem (Holm 2011, section 2.5.4, for n = 3; Nambu 1973): with

.. math::
    \{f, h\} = -\nabla c \cdot \nabla f \times \nabla h, \qquad
    \dot x = \nabla c \times \nabla h

the motion runs along the intersections of the level sets of :math:`c` and :math:`h`. In n
dimensions it is :math:`\dot x_i = -\det(e_i, \nabla h, \nabla c_1, \ldots, \nabla c_{n-2})`.
Comes in: a Setting with a Hamiltonian and such functions. Goes out: Equations whose rates are these
determinants, without the bracket; `coadjoint.derive.poisson` takes the other road.
"""

from __future__ import annotations

from coadjoint.derive.equations import Equations, Exact, Left, Step, partial, rate, symbol
from coadjoint.derive.interpret import determinant
from coadjoint.derive.observables import observables
from coadjoint.derive.setting import Setting, setting_of
from coadjoint.derive.structure import poisson_structure
from coadjoint.exact import Element
from coadjoint.spec import Spec


def derive(given: Spec | Setting) -> Equations:
    """Equations of motion by gradients alone.

    Raises:
        DerivationError: A formula divides by zero.
    """
    setting = setting_of(given)
    spec, field, names = setting.spec, setting.field, setting.state
    assert spec.poisson is not None, "the reader asks for distinguished functions on this route"
    assert spec.hamiltonian is not None, "the reader asks for a Hamiltonian on this route"
    h = setting.formula(spec.hamiltonian)
    functions = [setting.formula(c) for c in spec.poisson.functions]
    gradients = [field.gradient(function, names) for function in (*functions, h)]
    # h stands before the functions, as in the bracket: behind them, even n would change the sign
    rates = tuple(-rate for rate in generalised_cross_product([gradients[-1], *gradients[:-1]]))
    tensor = poisson_structure(setting).tensor
    exact = Exact((), rates, h, observables(setting, h), tensor)
    return Equations(setting, "nambu", exact, _steps(setting, [*functions, h], rates, gradients))


def generalised_cross_product(gradients: list[tuple[Element, ...]]) -> list[Element]:
    """Cofactors of the unit vectors above n - 1 vectors of R^n: ``a x b`` for n = 3."""
    n = len(gradients) + 1
    rest = [tuple(row[:i] + row[i + 1 :] for row in gradients) for i in range(n)]
    return [(-1) ** i * determinant(minor) for i, minor in enumerate(rest)]


def _steps(
    setting: Setting,
    functions: list[Element],
    rates: tuple[Element, ...],
    gradients: list[tuple[Element, ...]],
) -> tuple[Step, ...]:
    """The derivation as a person would write it down; h is the last function."""
    *functions, h = functions
    labels = ["c"] if len(functions) == 1 else [f"c{n + 1}" for n in range(len(functions))]
    named: list[tuple[Left, Element]] = list(zip(map(symbol, labels), functions, strict=True))
    slopes = [
        (partial(label, name), slope)
        for label, gradient in zip((*labels, "h"), gradients, strict=True)
        for name, slope in zip(setting.state, gradient, strict=True)
    ]
    factors, sign = ((*labels, "h"), "") if len(labels) == 1 else (("h", *labels), "-")
    wedge = sign + " x ".join(f"grad {label}" for label in factors)
    wedge_latex = sign + r" \times ".join(rf"\nabla {symbol(label).latex}" for label in factors)
    return (
        Step("Hamiltonian", "h(x)", "h(x)", ((symbol("h"), h),)),
        Step("Distinguished functions", "c(x)", "c(x)", tuple(named)),
        Step("Gradients", "grad c, grad h", r"\nabla c, \nabla h", tuple(slopes)),
        Step(
            "Nambu's equations",
            f"dx/dt = {wedge}",
            rf"\dot x = {wedge_latex}",
            tuple(zip(map(rate, setting.state), rates, strict=True)),
        ),
    )
