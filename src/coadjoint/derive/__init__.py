"""Derivation: a Spec becomes Equations by one of the routes, one module each.

Routes share the algebra and the Setting, never each other's results: their agreement, proved in
`coadjoint.prove.equivalence`, is evidence. Read next: `coadjoint.derive.setting`.
"""

from coadjoint.callable_module import make_callable
from coadjoint.derive import reductions
from coadjoint.derive.equations import Equations
from coadjoint.derive.mechanics import external, noise, slipping
from coadjoint.derive.records import Chart, Exact, Relation, Step
from coadjoint.derive.registry import load_route, make_setting
from coadjoint.derive.setting import Setting
from coadjoint.errors import DerivationError, check_type
from coadjoint.spec import Spec

__all__ = [
    "Chart",
    "Equations",
    "Exact",
    "Relation",
    "Setting",
    "Step",
    "derive",
    "make_setting",
]


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
    check_type("derive", spec, Spec, "what coadjoint.read_spec returns")
    chosen = route or spec.routes[0]
    if chosen not in spec.routes:
        raise DerivationError(
            f"{spec.path}: the route {chosen!r} is not declared; expected one of "
            f"{', '.join(spec.routes)}. Add it to routes to have it proved too.",
            found=chosen,
        )
    given = setting or make_setting(spec)
    slipping.check_slipping(given)
    if spec.reduction is not None:
        return reductions.restrict(given, chosen)
    return noise.show_noise(external.add_forces(load_route(chosen)(given)))


make_callable(__name__, "derive")
