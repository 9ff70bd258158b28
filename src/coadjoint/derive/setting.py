"""The setting of a Spec: its exact field and its formulas as elements, shared by all routes.

Comes in: a Spec. Goes out: a `Setting` that ties the declared quantities to the positions of the
Lie algebra and of the advected spaces. Routes share this and the algebra, never each other's
results. Read next: `coadjoint.derive.assembly`, which makes Settings.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from dataclasses import field as attribute
from fractions import Fraction
from functools import cached_property, wraps
from types import MappingProxyType
from typing import Any, Protocol, TypeVar, cast

from coadjoint.algebra import LieAlgebra, Representation
from coadjoint.algebra.matrices import SparseMatrix, size
from coadjoint.derive.interpret import Value, entries, find_clamped, interpret
from coadjoint.errors import DerivationError
from coadjoint.exact import Element, Field, dense
from coadjoint.exact.text import element_text
from coadjoint.spec import Formula, Spec
from coadjoint.spec.core.components import FORMS
from coadjoint.spec.model import Input, Jet, Parameter, Shape, Time, Variable, unpack
from coadjoint.spec.sections.domain import Condition as Inequality
from coadjoint.spec.sections.poisson import pairing_weights

Built = TypeVar("Built")
#: What has a name in formulas.
Declared = Variable | Parameter | Input | Time
#: The same, and derivatives of fields along space.
Named = Declared | Jet
#: The time that a flow takes, a symbol of the fields in which flows are derived. The flow is one of
#: the member: `coadjoint.derive.flows`.
STEP = "_h"


def vector_names(count: int) -> tuple[str, ...]:
    """What components of a vector are called that stands below a state."""
    return tuple(f"_h{n + 1}" for n in range(count))


@dataclass(frozen=True)
class Setting:
    """A Spec with its exact field.

    Attributes:
        spec: What was declared.
        field: Rational functions of state, velocities, parameters, inputs and time, with the
            elementary functions that the spec's formulas call.
        values: Every declared name, whole quantity or component, as field elements.
        built: What functions under `once` have built of this Setting.
    """

    spec: Spec
    field: Field
    values: Mapping[str, Value]
    built: dict[Any, object] = attribute(
        default_factory=dict, init=False, repr=False, compare=False
    )

    # -- names, in the order of the algebra ---------------------------------------------

    @cached_property
    def state(self) -> tuple[str, ...]:
        """Component names of the state, in declared order."""
        return list_components(self.spec.state)

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        """Component names of the parameters."""
        return list_components(self.spec.parameters)

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """Component names of the inputs."""
        return list_components(self.spec.inputs)

    @cached_property
    def time(self) -> tuple[str, ...]:
        """The name of the time; empty where no formula names it."""
        return () if self.spec.time is None else self.spec.time.components

    @cached_property
    def own_rates(self) -> Mapping[str, Element]:
        """The time derivatives of what moves by itself: of time, and of inputs with known rates."""
        rates = dict.fromkeys(self.time, self.field.one)
        inputs = {each.name: each for each in self.spec.inputs}
        for each in self.spec.inputs:
            if each.rate:
                named = self.elements(inputs[each.rate].components)
                rates |= zip(each.components, named, strict=True)
        return rates

    @property
    def driving(self) -> tuple[str, ...]:
        """What moves by itself: the inputs and the time."""
        return (*self.inputs, *self.time)

    @cached_property
    def velocities(self) -> tuple[str, ...]:
        """Name of the velocity along each basis vector, or of each position; empty without any."""
        return self._along_basis("velocity")

    @property
    def has_energy(self) -> bool:
        """Whether a Hamiltonian or a Lagrangian is declared."""
        return self.spec.hamiltonian is not None or self.spec.lagrangian is not None

    @cached_property
    def momenta(self) -> tuple[str, ...]:
        """Name of the momentum along each basis vector, or of each position; empty without any."""
        return self._along_basis("momentum")

    @cached_property
    def weights(self) -> tuple[Fraction, ...]:
        """What ``{q, p}`` is for each momentum: 1, or 1/2 off the diagonal of symmetric ones."""
        coordinates = self.spec.having_role("coordinate") if self.spec.algebra is None else ()
        partners = [self.spec.partner("momentum", variable.name) for variable in coordinates]
        weights = [w for p in partners if p for w in pairing_weights(len(p.components), p.form)]
        return tuple(weights) or (Fraction(1),) * len(self.momenta)

    @cached_property
    def conjugates(self) -> tuple[tuple[str, str, Fraction], ...]:
        """Momenta with the velocities that they are of, where these are named: v, p, ``{q, p}``.

        Those along an algebra come first, and then those of coordinates next to it.
        """
        pairs = zip(self.velocities, self.momenta, self.weights, strict=False)
        named, spec = list(pairs) if self.momenta else [], self.spec
        for q in spec.having_role("coordinate") if spec.algebra is not None else ():
            v, p = (spec.partner(role, q.name) for role in ("velocity", "momentum"))
            if v is not None and p is not None:
                weights = pairing_weights(len(p.components), p.form)
                named += zip(v.components, p.components, weights, strict=True)
        return tuple(named)

    @cached_property
    def advected(self) -> tuple[Variable, ...]:
        """The advected quantities."""
        return self.spec.having_role("advected")

    @cached_property
    def algebra(self) -> LieAlgebra:
        """The Lie algebra of the velocities, its constants in this field.

        Only routes that start from an algebra ask; the reader gives those no other spec.
        """
        algebra = self.spec.algebra
        assert algebra is not None, f"{self.spec.name} has a declared bracket and no algebra"
        return algebra.over(self.take_constant)

    @cached_property
    def actions(self) -> Mapping[str, Representation]:
        """How the algebra acts on each advected quantity, in this field."""
        return {
            variable.name: self._action(variable.representation)
            for variable in self.advected
            if variable.representation is not None
        }

    def _action(self, declared: Representation) -> Representation:
        """A declared action, its entries in this field."""
        return declared.over(self.take_constant, self.algebra)

    def take_constant(self, constant: Fraction | int | Element) -> Fraction | int | Element:
        """A constant of the algebra as it can be reckoned with here."""
        return self.field.adopt(constant) if isinstance(constant, Element) else constant

    @property
    def sign(self) -> int:
        """+1 if left invariant, -1 if right: the motion runs the other way (Holm 2011, 9.1)."""
        return 1 if self.spec.invariance == "left" else -1

    @cached_property
    def positions(self) -> tuple[str, ...]:
        """Component names of the coordinates; empty over an algebra."""
        return list_components(self.spec.having_role("coordinate"))

    @cached_property
    def advected_names(self) -> tuple[str, ...]:
        """Component names of all that is advected."""
        return list_components(self.advected)

    def _along_basis(self, role: str) -> tuple[str, ...]:
        if self.spec.algebra is None:
            coordinates = self.spec.having_role("coordinate")
            partners = (self.spec.partner(role, variable.name) for variable in coordinates)
            return list_components(filter(None, partners))
        places = {
            place: name
            for variable in self.spec.having_role(role)
            if not variable.of  # of coordinates next to the algebra
            for place, name in zip(variable.block, variable.components, strict=True)
        }
        return tuple(places[place] for place in sorted(places))

    @cached_property
    def reactions(self) -> Mapping[str, Value]:
        """The multipliers of constraints, whole and by component, as symbols."""
        values: dict[str, Value] = {}
        for each in self.spec.constraints:
            parts = self.elements(each.reactions)
            values |= zip(each.reactions, parts, strict=True)
            values[each.reaction] = shape(parts, each.shape)
        return values

    def excess(
        self, condition: Inequality, others: Mapping[str, Value] = MappingProxyType({})
    ) -> Element:
        """What a condition of the domain asks to be positive: the larger side minus the other."""
        left, right = (self.formula(side, others) for side in (condition.left, condition.right))
        return left - right if condition.sign.startswith(">") else right - left

    # -- elements -----------------------------------------------------------------------

    @cached_property
    def lagrangian(self) -> Element:
        """The declared Lagrangian, where the reader asks for one."""
        assert self.spec.lagrangian is not None, "the reader asks for a Lagrangian on this route"
        return self._read_energy(self.spec.lagrangian)

    @cached_property
    def hamiltonian(self) -> Element:
        """The declared Hamiltonian, where the reader asks for one."""
        assert self.spec.hamiltonian is not None, "the reader asks for a Hamiltonian on this route"
        return self._read_energy(self.spec.hamiltonian)

    def _read_energy(self, formula: Formula) -> Element:
        """The value of a formula whose slopes are asked for.

        Raises:
            DerivationError: It has the root of ``max(x, 0)``, which is 0 where x is negative: its
                slope has no value there.
        """
        field, value = self.field, self.formula(formula)
        for name in sorted(field.functions_in(value)):
            known = field.adjoined[name]
            if known.function != "sqrt" or field.is_zero(known.argument):
                continue
            clamped = find_clamped(known.argument, field)
            if clamped is not None and clamped.is_cut:
                inside = element_text(field, clamped.inside)
                problem = (
                    f"sqrt(max(x, 0)) has no slope where x = {inside} is 0 or "
                    "less, and the equations of motion need it; expected a power. Write "
                    "max(x, 0)^(5/2) in the place of max(x, 0)^2*sqrt(max(x, 0))."
                )
                raise fault(self, formula, problem, formula.text)
        return value

    def elements(self, names: Sequence[str]) -> tuple[Element, ...]:
        """The symbols of several names."""
        return tuple(self.field[name] for name in names)

    def formula(
        self, formula: Formula, observables: Mapping[str, Value] = MappingProxyType({})
    ) -> Element:
        """The value of a declared scalar formula; arguments as in `value`."""
        value: Element = self.value(formula, observables)
        return value

    def components(
        self, formula: Formula, observables: Mapping[str, Value] = MappingProxyType({})
    ) -> tuple[Element, ...]:
        """The components of a formula of any shape, row by row; arguments as in `value`."""
        return entries(self.value(formula, observables))

    def value(
        self, formula: Formula, observables: Mapping[str, Value] = MappingProxyType({})
    ) -> Value:
        """The value of a declared formula: an element, a vector or a matrix.

        Args:
            formula: Parsed and shape-checked.
            observables: Values of the names that only claims may use.

        Raises:
            DerivationError: Division by zero or a singular inverse inside it.
        """
        try:
            return interpret(formula.tree, {**self.values, **observables}, self.field)
        except DerivationError as error:
            raise fault(self, formula, str(error), formula.text) from error

    def in_state_order(
        self,
        momentum: Sequence[Element],
        advected: Mapping[str, Sequence[Element]],
        others: Mapping[str, Element] = MappingProxyType({}),
    ) -> tuple[Element, ...]:
        """Values along the algebra's basis and per advected quantity, in the order of the state.

        Args:
            momentum: Along the basis.
            advected: By the names of advected quantities.
            others: By component: coordinates next to the algebra, and their momenta.
        """
        by_name = dict(zip(self.momenta, momentum, strict=True)) | dict(others)
        for variable in self.advected:
            by_name |= dict(zip(variable.components, advected[variable.name], strict=True))
        return self.field.vector(by_name[name] for name in self.state)


def fault(
    setting: Setting, formula: Formula, message: str, found: str, **parts: str
) -> DerivationError:
    """An error that points at a formula."""
    return DerivationError(
        formula.locate(setting.spec.path, message),
        path=str(setting.spec.path),
        line=formula.line,
        key=formula.key,
        found=found,
        **parts,
    )


def lagrangian_fault(setting: Setting, message: str, found: str = "") -> DerivationError:
    """An error that points at the Lagrangian; without ``found``, of all its text."""
    formula = setting.spec.lagrangian
    assert formula is not None, "the reader asks for a Lagrangian"
    return fault(setting, formula, message, found or formula.text)


def list_components(quantities: Iterable[Named]) -> tuple[str, ...]:
    """Names of the components of some quantities, in order."""
    return tuple(name for each in quantities for name in each.components)


class Owner(Protocol):
    """What remembers values that functions have built of it."""

    @property
    def built(self) -> dict[Any, object]:
        """The values, by the functions."""


Shared = TypeVar("Shared", bound=Owner)


def once(build: Callable[[Shared], Built]) -> Callable[[Shared], Built]:
    """Let a function of a Setting alone build its value once; all routes of the Setting share it.

    So it is with a function of anything else that remembers what was built, as a motion does.

    >>> from coadjoint.derive.assembly import make_setting
    >>> from coadjoint.spec import read_spec
    >>> from coadjoint.resources import derivations_folder
    >>> setting = make_setting(read_spec(derivations_folder() / "rigid_body.toml"))
    >>> names = once(lambda setting: list(setting.state))
    >>> names(setting) is names(setting)
    True
    """

    @wraps(build)
    def look_up(owner: Shared) -> Built:
        if build not in owner.built:
            owner.built[build] = build(owner)
        return cast(Built, owner.built[build])

    return look_up


def assemble(quantity: Named, values: Mapping[str, Value]) -> Value:
    """The components of a quantity as an element, a vector or a matrix."""
    parts = tuple(values[name] for name in quantity.components)
    if isinstance(quantity, Variable) and quantity.elements:
        return weigh(parts, quantity.elements)
    form = "" if isinstance(quantity, Time) else quantity.form
    return unpack(parts, form) if form in FORMS else shape(parts, quantity.shape)


def weigh(parts: Sequence[Element], matrices: Sequence[SparseMatrix]) -> Value:
    """``sum x_i e_i`` for matrices e_i."""
    return dense.weighted_sum(parts, matrices, size(matrices), 0 * parts[0])


def shape(parts: Sequence[Element], shape: Shape) -> Value:
    """Components, row by row, as an element, a vector or a matrix."""
    parts = tuple(parts)
    match shape:
        case ():
            return parts[0]
        case (_,):
            return parts
        case (rows, columns):
            return tuple(parts[i * columns : (i + 1) * columns] for i in range(rows))
    raise AssertionError(shape)
