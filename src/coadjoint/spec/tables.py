"""Tables: the list of all tables of a spec, in the order of its schema.

A new table is a module of `coadjoint.spec.sections` and a line here: the schema, the reader, the
checks of names, of routes and of use, and the formulas of a `Spec` all walk this list.
Read next: `coadjoint.spec.schema`, then `coadjoint.spec.reader`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from types import MappingProxyType
from typing import Any

from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.algebra.representation import Representation
from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.reading import Table
from coadjoint.spec.sections.algebras import ALGEBRA
from coadjoint.spec.sections.charts import CHARTS
from coadjoint.spec.sections.claims import CLAIMS
from coadjoint.spec.sections.constraints import CONSTRAINTS
from coadjoint.spec.sections.definitions import DEFINITIONS
from coadjoint.spec.sections.diffeomorphisms import DIFFEOMORPHISMS
from coadjoint.spec.sections.domain import DOMAIN
from coadjoint.spec.sections.energies import HAMILTONIAN, LAGRANGIAN
from coadjoint.spec.sections.forces import DISSIPATION, FORCES
from coadjoint.spec.sections.indices import INDEX
from coadjoint.spec.sections.inputs import INPUTS
from coadjoint.spec.sections.lax import LAX
from coadjoint.spec.sections.momenta import MOMENTA
from coadjoint.spec.sections.newton import NEWTON
from coadjoint.spec.sections.noise import NOISE
from coadjoint.spec.sections.observables import OBSERVABLES
from coadjoint.spec.sections.parameters import PARAMETERS
from coadjoint.spec.sections.poisson import POISSON
from coadjoint.spec.sections.reconstruction import RECONSTRUCTION
from coadjoint.spec.sections.reduction import REDUCTION
from coadjoint.spec.sections.relaxation import DOUBLE_BRACKET, METRIPLECTIC
from coadjoint.spec.sections.representations import CLEBSCH, REPRESENTATIONS
from coadjoint.spec.sections.rolling import ROLLING
from coadjoint.spec.sections.space import PROFILES, SPACE
from coadjoint.spec.sections.symmetries import SYMMETRIES
from coadjoint.spec.sections.time import TIME
from coadjoint.spec.sections.transformations import TRANSFORMATIONS
from coadjoint.spec.sections.truncation import TRUNCATION
from coadjoint.spec.sections.variables import VARIABLES

TABLES: tuple[Table[Any], ...] = (
    INDEX,
    ALGEBRA,
    POISSON,
    TRUNCATION,
    SPACE,
    DIFFEOMORPHISMS,
    REPRESENTATIONS,
    VARIABLES,
    PARAMETERS,
    INPUTS,
    TIME,
    PROFILES,
    DEFINITIONS,
    LAGRANGIAN,
    HAMILTONIAN,
    CLEBSCH,
    LAX,
    NEWTON,
    REDUCTION,
    CONSTRAINTS,
    FORCES,
    DISSIPATION,
    DOUBLE_BRACKET,
    METRIPLECTIC,
    NOISE,
    DOMAIN,
    ROLLING,
    RECONSTRUCTION,
    MOMENTA,
    OBSERVABLES,
    SYMMETRIES,
    TRANSFORMATIONS,
    CHARTS,
    CLAIMS,
)
BY_KEY: Mapping[str, Table[Any]] = MappingProxyType({table.key: table for table in TABLES})


def list_formulas(record: Any) -> Iterator[Formula]:
    """Every formula of a `Spec`, or of a record or several in it, in the order of their fields."""
    if isinstance(record, Formula):
        yield record
    elif isinstance(record, Mapping | tuple):
        for each in record.values() if isinstance(record, Mapping) else record:
            yield from list_formulas(each)
    elif is_dataclass(record) and not isinstance(record, LieAlgebra | Representation):
        whole = getattr(record, "whole", None)  # another system, which a submanifold is of
        for each in fields(record):
            value = getattr(record, each.name)
            yield from () if value is whole else list_formulas(value)
