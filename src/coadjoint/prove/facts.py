"""Facts: what of a system decides which methods of integration keep its structure.

Comes in: Equations, proved, and the functions of a kernel. Goes out: `Facts`, each decided by exact
arithmetic. What is not decided counts as not so: then a method is said to keep less than it does.
Read next: `coadjoint.prove.methods`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

from coadjoint.algebra import LieAlgebra
from coadjoint.derive import Equations
from coadjoint.derive.mechanics.turning import turning_residuals
from coadjoint.derive.records import Emitted
from coadjoint.errors import AlgebraError
from coadjoint.exact import BudgetSpent, Element
from coadjoint.exact.residues import Residue, call_modulo, vanish
from coadjoint.limits import SEARCH_WORK
from coadjoint.lower.evaluation import run
from coadjoint.lower.kinks import hold_sides
from coadjoint.lower.orbits import (
    find_spheres,
    is_bracket,
    is_noisy_action,
    is_product,
    stays_on_orbits,
)
from coadjoint.lower.program import Program
from coadjoint.methods import Sphere
from coadjoint.poisson.structure import PoissonStructure
from coadjoint.prove.certificate import Certificate, Verdict
from coadjoint.prove.completeness import completeness, describe
from coadjoint.prove.constrained import motion_of
from coadjoint.prove.driven import while_constant
from coadjoint.prove.identities import noise_rates
from coadjoint.prove.integrals import is_conserved
from coadjoint.prove.measures import volume_statement
from coadjoint.prove.motion import Motion
from coadjoint.prove.noise import tell_commuting
from coadjoint.prove.turned import are_linear_symmetries
from coadjoint.prove.zero import Decision, UndecidedError

#: The degrees that are told apart: of polynomials in the state, at most 2.
DEGREES = ("constant", "linear", "quadratic")
#: How the statement begins that names a reversal of time.
_REVERSIBLE = "the motion is time reversible under "


@dataclass(frozen=True)
class Kept:
    """An integral of the motion, by the name that kernels give it.

    Attributes:
        name: As of an observable.
        values: Its components, in the state.
        degree: 0, 1 or 2 in the state; None of what is no such polynomial, or not seen to be one.
        is_casimir: Whether its bracket with everything vanishes.
        is_kept_within_steps: Whether its rate is zero wherever a method of Runge and Kutta asks for
            rates: everywhere, or on linear constraints, which such methods keep.
    """

    name: str
    values: tuple[Element, ...]
    degree: int | None
    is_casimir: bool
    is_kept_within_steps: bool


class Facts:
    """Facts of one system.

    Args:
        equations: The emitted route.
        programs: The functions of its kernel.
        certificate: What is proved of it.
    """

    def __init__(
        self, equations: Equations, programs: Mapping[str, Program], certificate: Certificate
    ) -> None:
        self.equations, self.spec = equations, equations.spec
        self.field, self.state = equations.setting.field, equations.setting.state
        self.programs, self._certificate = programs, certificate
        self.motion: Motion = motion_of(equations)
        self._kept_by_action = dict[tuple[Element, ...], bool]()

    # -- what acts ------------------------------------------------------------------------

    @property
    def is_noisy(self) -> bool:
        """Whether Wiener processes move the state."""
        return bool(self.spec.noise)

    @cached_property
    def has_kinks(self) -> bool:
        """Whether rates have corners or jumps."""
        return "kinks" in hold_sides({"rates": self.programs["rhs"]})

    @property
    def is_constrained(self) -> bool:
        """Whether velocities along a frame are the state, which constraints bind."""
        return self.equations.distribution is not None and bool(self.spec.constraints)

    @property
    def is_driven(self) -> bool:
        """Whether inputs or the time move the state."""
        return bool(self.equations.setting.driving)

    @property
    def is_nambu(self) -> bool:
        """Whether the bracket is that of distinguished functions of three coordinates."""
        return self.spec.poisson is not None and self.spec.poisson.kind == "nambu"

    @property
    def is_hamiltonian(self) -> bool:
        """Whether the motion is the bracket with the energy alone."""
        return self.is_bracket_alone and not self.is_noisy

    @property
    def is_bracket_alone(self) -> bool:
        """The same of the drift, where there is noise, which always is a bracket."""
        acted_on = self.spec.is_driven or self.equations.distribution is not None
        return self.structure is not None and self.energy is not None and not acted_on

    @cached_property
    def strong_order(self) -> float:
        """By what power of the step paths converge by methods that take increments alone.

        It is 1 where all processes are proved to commute, else 1/2 (P. E. Kloeden and E. Platen,
        Numerical Solution of Stochastic Differential Equations (1992)).
        """
        names = [each.name for each in self.spec.noise]
        pairs = (tell_commuting(*pair) for pair in combinations(names, 2))
        return 1 if all(each in self._proved for each in pairs) else 0.5

    # -- energy and bracket ---------------------------------------------------------------

    @cached_property
    def energy(self) -> Element | None:
        """The energy in the state; None where there is none."""
        value = self.equations.exact.energy
        return None if value is None else self.equations.close(value)

    @cached_property
    def energy_degree(self) -> int | None:
        """Of the energy, as of `find_degree`."""
        return None if self.energy is None else self.find_degree([self.energy])

    @cached_property
    def is_energy_homogeneous(self) -> bool:
        """Whether the energy is quadratic without linear terms."""
        if self.energy is None or self.energy_degree != 2:
            return False
        rest = dict.fromkeys(self.state, self.field.zero)
        slopes = self.field.gradient(self.energy, self.state)
        return all(self.field.is_zero(self.field.substitute(slope, rest)) for slope in slopes)

    @cached_property
    def structure(self) -> PoissonStructure | None:
        """The bracket of the components of the state; None without one in closed form."""
        tensor = self.equations.exact.poisson_tensor
        if tensor is None or self.equations.distribution is not None:
            return None
        closed = tuple(tuple(map(self.equations.close, row)) for row in tensor)
        named = {*self.state, *self.equations.setting.parameters}
        entries = [entry for row in closed for entry in row]
        if any(self.field.reach(entry) - named for entry in entries):
            return None
        return PoissonStructure(self.field, self.state, closed)

    @cached_property
    def tensor(self) -> str:
        """The Poisson tensor: ``constant``, ``linear``, ``affine``, ``not affine``; "" for none."""
        structure, algebra = self.structure, self.algebra
        if structure is None:
            return ""
        if algebra is None:
            return "not affine"
        if "1" not in algebra.basis:
            return "linear"
        own = range(len(self.state))
        rows = algebra.constants.values()
        return "affine" if any(n in row for row in rows for n in own) else "constant"

    @cached_property
    def algebra(self) -> LieAlgebra | None:
        """The algebra of an affine tensor; None of another."""
        if self.structure is None:
            return None
        try:
            return self.structure.lie_algebra
        except AlgebraError:  # affine, and no bracket: the certificate says so
            return None

    @cached_property
    def is_canonical(self) -> bool:
        """Whether the state is pairs of coordinates and momenta."""
        structure = self.structure
        if structure is None or self.tensor != "constant":
            return False
        rows = [[self.field.as_number(x) for x in row if x] for row in structure.tensor]
        return all(len(row) == 1 and row[0] in (1, -1) for row in rows)

    @cached_property
    def is_separable(self) -> bool:
        """Whether the energy is ``T`` of momenta plus ``V`` of the rest, which commutes."""
        fibre, rest, structure = self.motion.fibre, self.motion.positions, self.structure
        if self.energy is None or structure is None or not rest or not self._is_seen(self.energy):
            return False
        places = [self.state.index(name) for name in rest]
        if any(structure.tensor[i][j] for i in places for j in places):
            return False
        slopes = self.field.gradient(self.energy, fibre)
        mixed = (x for slope in slopes for x in self.field.gradient(slope, rest))
        return all(map(self.field.is_zero, mixed))

    @cached_property
    def spheres(self) -> tuple[Sphere, ...]:
        """Factors so(3) and se(3), where the algebra is a product of these and of R."""
        on_orbits = is_noisy_action if self.is_noisy else stays_on_orbits
        return find_spheres(self.programs) if on_orbits(self.programs) else ()

    @property
    def has_products(self) -> bool:
        """Whether the algebra is one of matrices with all products B A B, up to those of 1 or i.

        Kernels have these products then, as far as they are not too long.
        """
        return "sandwich" in self.programs

    # -- of the motion as a whole ---------------------------------------------------------

    @cached_property
    def _proved(self) -> list[str]:
        """Statements of the certificate that are proved."""
        own = self._certificate
        said = [each.statement for each in own.claims if each.verdict is Verdict.PROVED]
        return said + [each.statement for each in own.findings]

    @cached_property
    def reversal(self) -> str:
        """What change of signs reverses the motion: ``Pi -> -Pi, t -> -t``; "" for none found."""
        said = (each for each in self._proved if each.startswith(_REVERSIBLE))
        return next(said, "").removeprefix(_REVERSIBLE)

    # -- integrals ------------------------------------------------------------------------

    @cached_property
    def integrals(self) -> tuple[Kept, ...]:
        """What the motion conserves of all that kernels emit."""
        emitted = self.equations.exact.emitted
        return tuple(self._describe(x) for x in emitted if is_conserved(self.equations, x))

    @cached_property
    def held(self) -> frozenset[str]:
        """Names of those that it conserves only while the inputs are constant."""
        parts = ((each.name, each.values) for each in self.integrals)
        return frozenset(name for name, values in parts if while_constant(self.equations, values))

    @property
    def is_energy_steady(self) -> bool:
        """Whether neither the time nor inputs change the energy at a state that stays."""
        driving = self.equations.setting.driving
        return self.energy is not None and not self.field.reach(self.energy) & {*driving}

    def _describe(self, each: Emitted) -> Kept:
        """An integral with its facts."""
        values = tuple(map(self.equations.close, each.values))
        degree = self.find_degree(values)
        return Kept(
            name=each.name,
            values=values,
            degree=degree,
            is_casimir=self._is_casimir(values),
            is_kept_within_steps=degree is not None
            and not self.is_moved
            and all(map(self._is_still, each.values)),
        )

    def find_degree(self, values: Iterable[Element], most: int = 2) -> int | None:
        """The degree of polynomials in the state, 2 at most; None of others, or where it is unseen.

        It is read from the normal form: what cancels there alone that is not seen to be the same,
        as values of functions, may have a lower degree.
        """
        degrees = [self._read_degree(value) for value in values]
        known = [degree for degree in degrees if degree is not None and degree <= most]
        return max(known, default=0) if len(known) == len(degrees) else None

    def _read_degree(self, value: Element) -> int | None:
        """The same of one function."""
        field, state = self.field, frozenset(self.state)
        normal = field.normal(value)
        called = (field[name] for name in field.functions_in(normal))
        if not self._is_seen(normal) or any(field.reach(each) & state for each in called):
            return None
        degree = 0
        for quotient in field.quotients(normal):
            if any(field.reach(divisor) & state for divisor, _ in quotient.divisors):
                return None
            degrees = (sum(e for n, e in each.powers if n in state) for each in quotient.monomials)
            degree = max(degree, *degrees)
        return degree

    def _is_seen(self, value: Element) -> bool:
        """Whether a function is written in state, parameters and inputs, which a run holds."""
        setting = self.equations.setting
        named = {*self.state, *setting.parameters, *setting.inputs}
        return not self.field.reach(value) - named

    def _is_casimir(self, values: Iterable[Element]) -> bool:
        """Whether the bracket of functions with everything is zero."""
        structure, seen = self.structure, list(values)
        if structure is None or not all(map(self._is_seen, seen)):
            return False
        return all(map(structure.is_casimir, seen))

    def _is_still(self, value: Element) -> bool:
        """Whether the rate of a function is zero everywhere, or on linear constraints.

        With noise, that of each process is, too.
        """
        rate = self.motion.rate(value)
        is_still = self.field.is_zero(rate) or (
            bool(self.motion.kept) and self.motion.where.contains(rate)
        )
        return is_still and all(map(self.field.is_zero, noise_rates(self.equations, value)))

    @cached_property
    def is_moved(self) -> bool:
        """Whether solvers move a state after a step by more than rounding.

        They do onto constraints that are not linear, and onto rotations, unless the columns of an
        attitude keep their products along every motion of its rates, as quadratic integrals.
        """
        bound = (residual for _, residual in self.motion.kept)
        if any(self.find_degree([each]) not in (0, 1) for each in bound):
            return True
        return not all(map(self._is_still, self._turning))

    @cached_property
    def _turning(self) -> list[Element]:
        """Of attitudes the products of columns, where these decide whether they are rotations."""
        products = [x for _, x in turning_residuals(self.equations.setting)]
        return [x for x in products if self.find_degree([x]) == 2] or products

    # -- what the tensor of the motion keeps, whatever vector it is multiplied by ------------------

    @cached_property
    def is_bracket(self) -> bool:
        """Whether the motion is an antisymmetric tensor times the gradient of its energy."""
        return is_bracket(self.programs)

    @cached_property
    def relaxes(self) -> bool:
        """Whether the motion is ``P + P G P`` times the gradient of its energy, G semidefinite.

        That no energy grows by it is what the certificate has proved.
        """
        relaxation = self.spec.relaxation
        is_double = relaxation is not None and relaxation.S is None
        return is_double and self.is_semidefinite and is_product(self.programs)

    @cached_property
    def open_casimirs(self) -> str:
        """Why not all Casimirs are known to have degree 2 at the most, as a clause; "" if they do.

        Those count as well that are found and not claimed, and those that are not found.
        """
        claimed = [each.name for each in self.integrals if each.degree is None]
        if claimed:
            return f"{claimed[0]} is of higher degree"
        if self.equations.exact.poisson_tensor is None:
            return "its Casimirs are not counted"
        try:
            with self.field.budget(SEARCH_WORK):
                known = completeness(self.equations, reach=self.motion.reach)
                higher = [x for x in known.found if self.find_degree([x]) is None]
                if higher:
                    found = describe(self.field, higher[0])
                    return f"a Casimir that is found and not claimed is of higher degree, {found}"
                if known.known < known.expected or not isinstance(known.decision, Decision):
                    number = f"{known.known} of {known.expected} independent Casimirs"
                    return f"{number} are known"
        except (BudgetSpent, UndecidedError, OverflowError):
            return "the search for Casimirs ended before all were known"
        return ""

    @cached_property
    def is_semidefinite(self) -> bool:
        """Whether G of a symmetric bracket is proved positive semidefinite."""
        return "G is positive semidefinite" in self._proved

    @property
    def has_entropy(self) -> bool:
        """Whether a metriplectic bracket is declared."""
        return self.spec.relaxation is not None and self.spec.relaxation.S is not None

    @cached_property
    def is_dissipative(self) -> bool:
        """Whether energy is taken: by friction, a symmetric bracket or forces that change volumes.

        Friction that is written as a force shrinks volumes, and a force by coordinates or an input
        alone leaves them. Where forces are not told apart from the rates, these are asked.
        """
        if self.spec.dissipation is not None or self.spec.relaxation is not None:
            return True
        if not self.spec.forces:
            return False
        close, field, forces = self.equations.close, self.field, self.equations.exact.forces
        if not forces:
            return volume_statement(self.motion) not in self._proved
        pairs = zip(forces, self.state, strict=True)
        return not field.is_zero(field.sum(field.derivative(close(f), x) for f, x in pairs if f))

    @property
    def has_balance(self) -> bool:
        """Whether friction and forces change the energy, whose balance is what a step may keep."""
        return self.is_dissipative and self.spec.relaxation is None and self.energy is not None

    @cached_property
    def grows(self) -> bool:
        """Whether a metriplectic motion has an entropy of degree 2 at the most."""
        relaxation = self.spec.relaxation
        if relaxation is None or relaxation.S is None:
            return False
        value = self.equations.close(self.equations.setting.formula(relaxation.S))
        return self.is_semidefinite and self.find_degree([value]) is not None

    @cached_property
    def is_turned_by_tensor(self) -> bool:
        """Whether attitudes stay rotations where the tensor at the middle of a step moves them."""
        quadratic = all(self.find_degree([x]) == 2 for x in self._turning)
        return quadratic and self.is_kept_by_tensor(self._turning)

    def is_kept_by_action(self, values: Sequence[Element]) -> bool:
        """Whether functions stay in a step by ``exp(h A(xi))``, xi the gradient at its mean.

        They stay along the tensor times any xi that is zero where the energy does not change, as by
        attitudes that no force asks for; or they are momenta of linear symmetries of the energy.
        """
        asked = tuple(values)  # the same by each composition of a method
        if asked not in self._kept_by_action:
            self._kept_by_action[asked] = self._find_kept_by_action(asked)
        return self._kept_by_action[asked]

    def _find_kept_by_action(self, values: Sequence[Element]) -> bool:
        if self.energy is None or not values:
            return False
        slopes = self.field.gradient(self.energy, self.state)
        still = [row for row, slope in enumerate(slopes) if self.field.is_zero(slope)]
        return self.is_kept_by_tensor(values, still) or are_linear_symmetries(self, values)

    def is_kept_by_tensor(self, values: Sequence[Element], still: Sequence[int] = ()) -> bool:
        """Whether the gradients of functions are orthogonal to the tensor times any vector.

        It is asked at points modulo primes.

        Args:
            values: The functions.
            still: Components of the vector that are zero.
        """
        bracket, field = self.programs.get("bracket_vector"), self.field
        named = {*self.state, *self.equations.setting.parameters}
        if bracket is None or any(field.reach(value) - named for value in values):
            return False
        slopes = [field.gradient(value, self.state) for value in values]
        zeros = [bracket.state[len(self.state) + row] for row in still]

        def find(at: dict[str, Residue], number: Callable[..., Residue]) -> Iterator[Residue]:
            at = at | dict.fromkeys(zeros, number(0))
            turned = run(bracket, at, number, call_modulo)
            for row in slopes:
                along = (field.evaluate(slope, dict(at), number, call_modulo) for slope in row)
                yield sum((a * b for a, b in zip(along, turned, strict=True)), number(0))

        return vanish(find, {*bracket.names, *named})

    # -- in words -------------------------------------------------------------------------

    def as_record(self) -> dict[str, object]:
        """The facts as JSON values, those alone that hold."""
        algebra = self.algebra if self.tensor == "linear" else None
        degree = self.energy_degree
        acts = {
            "constraints": self.is_constrained,
            "forces or friction": self.spec.is_driven,
            "noise": self.is_noisy,
            "kinks": self.has_kinks,
            "inputs or time": self.is_driven,
        }
        found: dict[str, object] = {
            "energy": "" if self.energy is None else _name_degree(degree),
            "poisson_tensor": self.tensor,
            "canonical": self.is_canonical,
            "separable": self.is_separable,
            "nambu": self.is_nambu,
            "spheres": [[list(each.rows), list(each.tangent)] for each in self.spheres],
            "matrix_products": self.has_products,
            "unimodular": algebra is not None and algebra.is_unimodular,
            "compact": algebra is not None and _is_compact(algebra),
            "reversed_by": self.reversal,
            "divergence_free": volume_statement(self.motion) in self._proved,
            "acts": [name for name, is_so in acts.items() if is_so],
            "integrals": {each.name: _name_degree(each.degree) for each in self.integrals},
            "casimirs": [each.name for each in self.integrals if each.is_casimir],
        }
        return {name: value for name, value in found.items() if value}


def _name_degree(degree: int | None) -> str:
    """A degree in words."""
    return "of higher degree" if degree is None else DEGREES[degree]


def _is_compact(algebra: LieAlgebra) -> bool:
    """Whether the Killing form is negative definite, as of compact semisimple groups."""
    try:
        return algebra.killing_signature()[1] == algebra.dimension
    except AlgebraError:  # its entries name parameters without signs
        return False
