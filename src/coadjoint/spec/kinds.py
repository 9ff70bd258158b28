"""Kinds of spec: on an algebra, with a declared bracket, or on coordinates; with a frame or not.

Comes in: the tables of a spec. Goes out: what decides which routes it may list.
Read next: `coadjoint.spec.consistency`.
"""

from __future__ import annotations

from typing import Any

from coadjoint.spec.routes import ROUTES

#: The key of [constraints] that says so.
VARIATIONAL = "variational"


def is_in_frame(file: Any) -> bool:
    """Whether the state has velocities along a frame: what constraints bind, or their routes move.

    >>> from coadjoint.spec.schema import SpecFile
    >>> is_in_frame(SpecFile.model_construct(constraints=None, routes=["hamel"]))
    True
    """
    after = file.constraints is not None and not is_variational(file)
    return after or any(ROUTES[route].in_frame for route in file.routes)


def is_on_product(file: Any) -> bool:
    """Whether coordinates with momenta may stand next to an algebra, on routes that move both.

    >>> from coadjoint.spec.schema import SpecFile
    >>> is_on_product(SpecFile.model_construct(routes=["lie-poisson", "clebsch"]))
    False
    """
    return file.algebra is not None and {*file.routes} <= {"lie-poisson", "euler-poincare"}


def is_first_order(file: Any) -> bool:
    """Whether velocities of all coordinates follow from the state.

    >>> from coadjoint.spec.schema import SpecFile
    >>> is_first_order(SpecFile.model_construct(routes=["first-order"]))
    True
    """
    return any(ROUTES[route].is_first_order for route in file.routes)


def is_variational(file: Any) -> bool:
    """Whether constraints are imposed before the variation, on the motions that are compared.

    >>> from coadjoint.spec.schema import SpecFile
    >>> is_variational(SpecFile.model_construct(constraints={"c": "v == 0", VARIATIONAL: True}))
    True
    """
    return file.constraints is not None and file.constraints.get(VARIATIONAL) is True


def kinds_of(file: Any) -> tuple[str, ...]:
    """The kinds that a spec is of: ``algebra``, ``configuration``, or ``poisson`` and its way.

    >>> from coadjoint.spec.schema import SpecFile
    >>> kinds_of(SpecFile.model_construct(algebra=None, poisson=None, diffeomorphisms=None))
    ('configuration',)
    """
    if file.algebra is not None:
        return ("algebra",)
    if file.diffeomorphisms is not None:
        return ("diffeomorphisms",)
    if file.poisson is None:
        return ("configuration",)
    ways = ("nambu", "brackets", "canonical")
    return ("poisson", *(way for way in ways if getattr(file.poisson, way) is not None))
