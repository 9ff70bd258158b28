r"""The Nambu route: from a Hamiltonian and n - 2 distinguished functions of n coordinates.

Theorem (Holm 2011, section 2.5.4, for n = 3; Nambu 1973): with

.. math::
    \{f, h\} = -\nabla c \cdot \nabla f \times \nabla h, \qquad
    \dot x = \nabla c \times \nabla h

the motion runs along the intersections of the level sets of :math:`c` and :math:`h`. In n
dimensions it is :math:`\dot x_i = -\det(e_i, \nabla h, \nabla c_1, \ldots, \nabla c_{n-2})`.
On the dual of an algebra of three dimensions c is found. Its gradient is :math:`b_k =
-\epsilon_{ijk} \{x_i, x_j\}/2`, linear in x; where that is closed, which it is for unimodular
algebras, :math:`c = x \cdot b/2`. Elsewhere a Casimir C is searched for, and :math:`b = m \nabla C`
with a multiplier m.
Comes in: a Setting with a Hamiltonian and such functions, or with an algebra. Goes out: Equations
whose rates are these determinants, without the bracket; `coadjoint.derive.routes.poisson` uses the
bracket.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.emission import emit
from coadjoint.derive.mechanics.legendre import hamiltonian
from coadjoint.derive.records import Step, symbol, write_rates, write_slopes, write_step
from coadjoint.derive.refusals import refusal
from coadjoint.derive.setting import Setting
from coadjoint.derive.structure import momentum_algebra, poisson_structure
from coadjoint.errors import CoadjointError
from coadjoint.exact import Element
from coadjoint.exact.dense import dot, minor
from coadjoint.poisson.casimirs import casimirs


def derive(setting: Setting) -> Equations:
    """Equations of motion by gradients alone.

    Raises:
        DerivationError: A formula divides by zero, the dual of the algebra has not three
            dimensions, or no distinguished function of it was found.
    """
    spec, names = setting.spec, setting.state
    if spec.poisson is None:
        h, _ = hamiltonian(setting)
        distinguished = distinguished_function(setting)
        functions, multiplier = [distinguished.function], distinguished.multiplier
    else:
        h, multiplier = setting.hamiltonian, setting.field.one
        functions = [setting.formula(c) for c in spec.poisson.functions]
    gradients = [setting.field.gradient(function, names) for function in (*functions, h)]
    velocities = _velocities(setting)
    named = {momentum: setting.field[xi] for momentum, xi in velocities}
    dh = tuple(named.get(n, slope) for n, slope in zip(names, gradients[-1], strict=True))
    # h stands before the functions, as in the bracket: behind them, even n would change the sign
    product = generalised_cross_product([dh, *gradients[:-1]])
    rates = tuple(-multiplier * rate for rate in product)
    slopes = dict(zip(names, gradients[-1], strict=True))
    definitions = tuple((xi, slopes[momentum]) for momentum, xi in velocities)
    steps = _steps(setting, [*functions, h], rates, gradients, multiplier)
    return emit(setting, "nambu", rates, steps, h, definitions)


def _velocities(setting: Setting) -> list[tuple[str, str]]:
    """Momenta and the velocities ``dh/dmu`` that the spec names next to them."""
    given = setting.velocities if setting.momenta else ()
    return list(zip(setting.momenta, given, strict=bool(given)))


# -- three dimensions: c is found ----------------------------------------------------------------


@dataclass(frozen=True)
class Distinguished:
    """``{x_i, x_j} = -epsilon_ijk m dc/dx_k``: c is the function, m the multiplier."""

    function: Element
    multiplier: Element


def distinguished_function(setting: Setting) -> Distinguished:
    """The function c of a bracket that is linear on three coordinates.

    Raises:
        DerivationError: The dimension is not three, or no c was found.
    """
    structure, field = poisson_structure(setting), setting.field
    if structure.dimension != 3:
        raise refusal(
            setting,
            "nambu",
            f"the dual of {momentum_algebra(setting).name} has {structure.dimension} dimensions",
            str(structure.dimension),
            "three, for one distinguished function c in addition to h",
            "Declare the functions: [poisson] nambu = [...].",
        )
    x, tensor = setting.elements(structure.names), structure.tensor
    b = tuple(-tensor[i][j] for i, j in ((1, 2), (2, 0), (0, 1)))
    slopes = [field.gradient(entry, structure.names) for entry in b]
    if all(field.is_zero(slopes[i][j] - slopes[j][i]) for i, j in combinations(range(3), 2)):
        return Distinguished(dot(x, b) / 2, field.one)
    return _from_casimir(setting, b)


def _from_casimir(setting: Setting, b: Sequence[Element]) -> Distinguished:
    """A rational Casimir, and the multiplier that its gradient lacks."""
    algebra, field = momentum_algebra(setting), setting.field
    try:
        search = casimirs(algebra)
        reason = search.missing
    except CoadjointError as error:
        reason = str(error)
    if reason or not search.generators:
        raise refusal(
            setting,
            "nambu",
            f"{algebra.name} is not unimodular, so its bracket is not a gradient, and no Casimir "
            f"was found for a multiple of one ({reason})",
            algebra.name,
            "a unimodular algebra, or a rational Casimir",
        )
    names = dict(zip(algebra.basis, (*setting.momenta, *setting.advected_names), strict=True))
    c = field.adopt(search.generators[0], names)
    slopes = field.gradient(c, setting.state)
    place = next(n for n, slope in enumerate(slopes) if slope)
    return Distinguished(c, b[place] / slopes[place])


def generalised_cross_product(gradients: list[tuple[Element, ...]]) -> list[Element]:
    """Cofactors of the unit vectors above n - 1 vectors of R^n: ``a x b`` for n = 3."""
    n = len(gradients) + 1
    rest = [[j for j in range(n) if j != i] for i in range(n)]
    return [(-1) ** i * minor(gradients, range(n - 1), columns) for i, columns in enumerate(rest)]


def _steps(
    setting: Setting,
    functions: list[Element],
    rates: tuple[Element, ...],
    gradients: list[tuple[Element, ...]],
    multiplier: Element,
) -> tuple[Step, ...]:
    """The derivation as a person would write it down; h is the last function."""
    *functions, h = functions
    labels = ["c"] if len(functions) == 1 else [f"c{n + 1}" for n in range(len(functions))]
    named = dict(zip(labels, functions, strict=True))
    slopes = [
        line
        for label, gradient in zip((*labels, "h"), gradients, strict=True)
        for line in write_slopes(label, setting.state, gradient)
    ]
    factors, sign = ((*labels, "h"), "") if len(labels) == 1 else (("h", *labels), "-")
    if multiplier != 1:
        named["m"] = multiplier
        sign += "m "
    wedge = sign + " x ".join(f"grad {label}" for label in factors)
    wedge_latex = sign + r" \times ".join(rf"\nabla {symbol(label).latex}" for label in factors)
    return (
        write_step("Hamiltonian", "h(x)", lines={"h": h}, by="hamilton"),
        write_step("Distinguished functions", "c(x)", lines=named, by="nambu"),
        write_step("Gradients", "grad c, grad h", r"\nabla c, \nabla h", slopes, by="nambu"),
        write_step(
            "Nambu's equations",
            f"dx/dt = {wedge}",
            rf"\dot x = {wedge_latex}",
            write_rates(setting.state, rates),
            by="nambu",
        ),
    )
