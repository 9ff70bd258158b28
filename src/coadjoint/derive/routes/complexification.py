r"""The complexification route: a real Hamiltonian on g*, continued to complex momenta.

Theorem (Holm 2011, appendix C.1.2): if :math:`h(x)` generates :math:`\dot x =
\mathrm{ad}^*_{\partial h/\partial x} x` on the dual of a real Lie algebra, its analytic
continuation to :math:`L = x + i y` generates

.. math::
    \dot L = \mathrm{ad}^*_{\partial h(L)/\partial L} L,

whose real and imaginary parts are the motion of :math:`\mathrm{Re}\, h(x + i y)` on the dual of the
algebra taken as a real one of twice the dimension. The pairing is :math:`\mathrm{Re} \langle L,
\zeta \rangle = x \cdot \xi - y \cdot \eta` for :math:`\zeta = \xi + i \eta`, so the velocity that
belongs to y is :math:`-\eta`; since h has real coefficients, complex conjugation changes nothing.
Comes in: a Setting on the complexification of an algebra, with a Hamiltonian; only its values at
y = 0 and the constants of the real algebra are used. Goes out: Equations, worked out with complex
numbers over the field. Read next: `coadjoint.groups.complex_numbers`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from operator import add

from coadjoint.algebra import LieAlgebra, complexification, same_constants
from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics.emission import emit
from coadjoint.derive.records import Step, write_rates, write_slopes, write_step
from coadjoint.derive.refusals import refusal
from coadjoint.derive.setting import Setting
from coadjoint.exact import Element
from coadjoint.exact.dense import identity
from coadjoint.groups.complex_numbers import Complex

ROUTE = "complexification"


def derive(setting: Setting) -> Equations:
    """Equations of motion as real and imaginary parts of complex ones.

    Raises:
        DerivationError: The algebra is not a complexification, something is advected, or the
            Hamiltonian calls functions that complex numbers here do not have.
    """
    real = real_algebra(setting)
    h = _at_real(setting, setting.hamiltonian, real)
    L = _momenta(setting, real)
    slopes = setting.field.gradient(h, setting.momenta[: real.dimension])
    zeta = tuple(_continue(setting, slope, L) for slope in slopes)
    moved = tuple(_pair(L, real.bracket(zeta, eta)) for eta in identity(real.dimension))
    parts = (*(z.re for z in moved), *(z.im for z in moved))
    rates = setting.in_state_order([setting.sign * part for part in parts], {})
    energy = setting.field.zero + _continue(setting, h, L).re
    halves = (*(z.re for z in zeta), *(-z.im for z in zeta))
    pairs = zip(setting.velocities, setting.field.vector(halves), strict=bool(setting.velocities))
    return emit(setting, ROUTE, rates, _steps(setting, h, zeta, rates), energy, tuple(pairs))


def real_algebra(setting: Setting) -> LieAlgebra:
    """The algebra whose complexification a spec is on: the first half of its basis.

    Raises:
        DerivationError: There is none, or the algebra acts on something advected.
    """
    algebra = setting.algebra
    half = algebra.dimension // 2
    if setting.advected:
        name = setting.advected[0].name
        raise refusal(
            setting,
            ROUTE,
            f"{name} is advected",
            name,
            "momenta alone",
            "Put the advected quantity into the algebra: a semidirect product has a "
            "complexification, too.",
        )
    inner = {pair: row for pair, row in algebra.constants.items() if max(*pair, *row) < half}
    real = LieAlgebra(
        name=f"real part of {algebra.name}", basis=algebra.basis[:half], constants=inner
    )
    if not same_constants(complexification(real), algebra):
        raise refusal(
            setting,
            ROUTE,
            f"{algebra.name} is not the complexification of the span of its first {half} vectors",
            algebra.name,
            "an algebra such as so(3) (x) C",
            'Write [algebra] complexification = "so(3)".',
        )
    return real


def _at_real(setting: Setting, h: Element, real: LieAlgebra) -> Element:
    """The Hamiltonian of the real system: h at y = 0."""
    still = dict.fromkeys(setting.momenta[real.dimension :], setting.field.zero)
    real_part = setting.field.substitute(h, still)
    if not setting.field.is_function_free(real_part):
        raise refusal(
            setting,
            ROUTE,
            "the Hamiltonian calls an elementary function",
            str(setting.spec.hamiltonian and setting.spec.hamiltonian.text),
            "a rational function of the momenta",
        )
    return real_part


def _momenta(setting: Setting, real: LieAlgebra) -> tuple[Complex, ...]:
    """``L = x + i y`` along the basis of the real algebra."""
    values = setting.elements(setting.momenta)
    pairs = zip(values[: real.dimension], values[real.dimension :], strict=True)
    return tuple(Complex(x, y) for x, y in pairs)


def _continue(setting: Setting, function: Element, L: tuple[Complex, ...]) -> Complex:
    """A function of x at the complex momenta."""
    field = setting.field
    values = {name: Complex(field[name], field.zero) for name in field.names}
    values |= dict(zip(setting.momenta[: len(L)], L, strict=True))
    return field.evaluate(function, values, lambda number: Complex(field.number(number)), _no_call)


def _no_call(function: str, argument: Complex) -> Complex:
    raise AssertionError(f"{function}({argument}) in a rational Hamiltonian")


def _pair(L: Sequence[Complex], zeta: Sequence[Complex | int]) -> Complex:
    """``<L, zeta>``, linear over the complex numbers."""
    return reduce(add, (a * b for a, b in zip(L, zeta, strict=True)), Complex(0))


def _steps(
    setting: Setting, h: Element, zeta: Sequence[Complex], rates: tuple[Element, ...]
) -> tuple[Step, ...]:
    """The derivation as a person would write it down."""
    turn = "" if setting.sign == 1 else "-"
    names = setting.momenta[: len(zeta)]
    zero = setting.field.zero
    slopes = (
        *write_slopes("Re h", names, (zero + z.re for z in zeta)),
        *write_slopes("Im h", names, (zero + z.im for z in zeta)),
    )
    return (
        write_step("Hamiltonian of the real system", "h(x)", lines={"h": h}, by="hamilton"),
        write_step(
            "Velocity at complex momenta L = x + i y",
            "zeta = dh/dx at x + i y",
            r"\zeta = (\partial h / \partial x)(x + i y)",
            slopes,
            by="complexification",
        ),
        write_step(
            "Real and imaginary parts",
            f"dx/dt + i dy/dt = {turn}ad*_zeta (x + i y)",
            rf"\dot x + i \dot y = {turn}\mathrm{{ad}}^*_\zeta (x + i y)",
            write_rates(setting.state, rates),
            by="complexification",
        ),
    )
