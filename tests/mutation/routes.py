"""Single changes to the routes that must be refuted: a sign flipped, a term dropped.

Each names a route or a step that routes share, a function or a key of a spec, what is changed in
it, and the systems whose certificates judge it.
"""

from __future__ import annotations

from tests.mutation import routes_over_algebras as algebras
from tests.mutation import routes_over_coordinates as coordinates
from tests.mutation import routes_over_distributions as distributions
from tests.mutation.changed_specs import SPECS
from tests.mutation.core_functions import CORE
from tests.mutation.routes_over_fields import FIELDS
from tests.mutation.shared_steps import SHARED

ROUTE_MUTANTS = (
    *CORE,
    *algebras.REDUCED,
    *algebras.BODY_ROUTES,
    *algebras.PAIRS,
    *coordinates.BRACKETS,
    *coordinates.FIRST_ORDER,
    *coordinates.LAGRANGE,
    *coordinates.HAMILTON,
    *coordinates.NEWTON,
    *distributions.PROJECTED,
    *distributions.CONSTRAINED_LAGRANGIAN,
    *distributions.VARIED,
    *distributions.DISTRIBUTED,
    *distributions.SLIPS,
    *FIELDS,
    *SHARED,
    *SPECS,
)
