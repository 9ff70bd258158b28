"""Derivation: a Spec becomes Equations by one of the routes, one module each.

Routes share the algebra and the Setting, never each other's results: their agreement, proved in
`coadjoint.prove.equivalence`, is evidence. Read next: `coadjoint.derive.setting`.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from coadjoint.callable_module import make_callable
from coadjoint.derive import reductions, setting
from coadjoint.derive.equations import Chart, Equations, Exact, Relation, Step
from coadjoint.derive.mechanics import external, kinematics, legendre
from coadjoint.derive.routes import (
    alignment,
    canonical,
    cayley_klein,
    clebsch,
    complexification,
    euler_lagrange,
    euler_poincare,
    hamel,
    hamilton_pontryagin,
    kaluza_klein,
    lax,
    lie_poisson,
    manakov,
    matrix_euler_poincare,
    nambu,
    newton,
    newton_euler,
    nonholonomic,
    poincare,
    poisson,
)
from coadjoint.derive.setting import Setting
from coadjoint.errors import DerivationError
from coadjoint.spec import Spec

__all__ = [
    "ROUTES",
    "Chart",
    "Equations",
    "Exact",
    "Relation",
    "Setting",
    "Step",
    "derive",
    "make_setting",
]

#: Every route by the name that specs use.
ROUTES: Mapping[str, Callable[[Spec | Setting], Equations]] = MappingProxyType(
    {
        "euler-poincare": euler_poincare.derive,
        "lie-poisson": lie_poisson.derive,
        "hamilton-pontryagin": hamilton_pontryagin.derive,
        "cayley-klein": cayley_klein.derive,
        "clebsch": clebsch.derive,
        "complexification": complexification.derive,
        "kaluza-klein": kaluza_klein.derive,
        "lax": lax.derive,
        "manakov": lax.derive_found,
        "matrix-euler-poincare": matrix_euler_poincare.derive,
        "nambu": nambu.derive,
        "poincare": poincare.derive,
        "newton-euler": newton_euler.derive,
        "poisson": poisson.derive,
        "euler-lagrange": euler_lagrange.derive,
        "canonical": canonical.derive,
        "newton": newton.derive,
        "alignment": alignment.derive,
        "nonholonomic": nonholonomic.derive,
        "hamel": hamel.derive,
    }
)

#: Names that a route needs beyond those of the spec, for its own variables.
SYMBOLS: Mapping[str, Callable[[Spec], tuple[str, ...]]] = MappingProxyType(
    {
        "alignment": alignment.symbols,
        "canonical": canonical.symbols,
        "cayley-klein": cayley_klein.symbols,
        "clebsch": clebsch.symbols,
        "hamel": kinematics.symbols,
        "hamilton-pontryagin": hamilton_pontryagin.symbols,
        "kaluza-klein": kaluza_klein.symbols,
        "lax": lax.symbols,
        "manakov": manakov.symbols,
        "nonholonomic": kinematics.symbols,
    }
)


def make_setting(spec: Spec) -> Setting:
    """The Setting of a Spec, with the symbols of all its routes: they live in one field."""
    names = [name for route in spec.routes if route in SYMBOLS for name in SYMBOLS[route](spec)]
    names += external.symbols(spec)
    return setting.make_setting(spec, tuple(dict.fromkeys((*names, *legendre.symbols(spec)))))


def derive(spec: Spec, route: str | None = None, *, setting: Setting | None = None) -> Equations:
    """Derive the equations of motion of a declared system.

    This takes as long as it takes; for a stranger's spec there is `coadjoint.derive_bounded`.

    Args:
        spec: What `coadjoint.read_spec` returned.
        route: One of the spec's routes; the first one, which is emitted, by default.
        setting: A Setting made before, so that several routes live in one field.

    Raises:
        DerivationError: The spec does not declare the route, or the route cannot be followed.
    """
    chosen = route or spec.routes[0]
    if chosen not in spec.routes:
        raise DerivationError(
            f"{spec.path}: the route {chosen!r} is not declared; expected one of "
            f"{', '.join(spec.routes)}. Add it to routes to have it proved too.",
            found=chosen,
        )
    given = setting or make_setting(spec)
    if spec.reduction is not None:
        return reductions.restricted(given, chosen, derive)
    return external.forced(ROUTES[chosen](given))


make_callable(__name__, "derive")
