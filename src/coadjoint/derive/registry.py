"""Registry: the module of a route, and the Setting in which all routes of a spec live.

Comes in: the name of a route, or a Spec. Goes out: a module with the function `derive`, loaded when
it is asked for, and a Setting with the symbols of all routes that a spec lists.
Read next: `coadjoint.spec.routes`, where routes are registered; `coadjoint.derive.setting`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from typing import cast

from coadjoint.derive import assembly, charts, frame_names, pairs, times_vector
from coadjoint.derive.equations import Equations
from coadjoint.derive.fields import circle, jets
from coadjoint.derive.mechanics import external, kinematics, legendre
from coadjoint.derive.mechanics.iteration import is_guess
from coadjoint.derive.setting import Setting
from coadjoint.spec import Spec
from coadjoint.spec.routes import ROUTES

#: What names symbols whatever the routes are, after these.
_ALWAYS = (
    external.symbols,
    legendre.symbols,
    charts.symbols,
    pairs.symbols,
    frame_names.symbols,
    times_vector.symbols,
    jets.symbols,
    circle.symbols,
)
#: Functions beyond those of the formulas that the inverse of a curved Legendre map may call.
INVERTED = 4
_FOLDER = "coadjoint.derive.routes"


def load_route(name: str) -> Callable[[Setting], Equations]:
    """The function that follows a route.

    >>> load_route("lie-poisson").__module__
    'coadjoint.derive.routes.lie_poisson'
    """
    module = import_module(f"{_FOLDER}.{ROUTES[name].module}")
    return cast(Callable[[Setting], Equations], module.derive)


def make_setting(spec: Spec, symbols: Sequence[str] = (), room: int = 0) -> Setting:
    """The Setting of a Spec, with the symbols of all its routes: they live in one field.

    Args:
        spec: What was declared.
        symbols: Names beyond those.
        room: How many functions are to be called beyond those of the formulas.
    """
    modules = [import_module(f"{_FOLDER}.{ROUTES[name].module}") for name in spec.routes]
    # routes that share their variables share the function that names them, too
    makers = dict.fromkeys(module.symbols for module in modules if hasattr(module, "symbols"))
    names = [name for make in (kinematics.symbols, *makers, *_ALWAYS) for name in make(spec)]
    room += INVERTED * sum(map(is_guess, dict.fromkeys(names)))
    return assembly.make_setting(spec, tuple(dict.fromkeys([*names, *symbols])), room)
