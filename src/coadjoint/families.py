"""Families: the equations of the generic member of an indexed system, as records.

A system with an index has N equal members: spins of a lattice, masses of a chain, vortices. Its
equations are written once, for member i, with the members next to it as further symbols; kernels
loop over i. Comes in: nothing. Goes out: the records that `coadjoint.derive` makes and
`coadjoint.lower` reads.

State in memory: component after component, and within each the member fastest. With the members'
components ``S1, S2, S3`` a state has shape ``(3*N, *batch)`` and its rows are ``S1`` of members 0
to N-1, then ``S2`` of them, then ``S3``: ``state.reshape(3, N, *batch)[c, i]`` is component c of
member i. Indexed parameters and inputs lie likewise, after all shared ones; a row is called
``S1[0]``. In
formulas members are counted from 0, as in the names of rows.
Read next: `coadjoint.derive.indexed`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import isqrt
from types import MappingProxyType
from typing import Any, Final

#: Parts of a sum over members, and members that are computed together where there are sums.
LANES: Final = 8
#: The fewest points of a circle on which a wave moves, and the fewest along each coordinate of a
#: plane of which a wave is kept.
LEAST_AROUND, LEAST_IN_PLANE = 3, 4
#: A SymPy symbol, and a SymPy expression; SymPy itself is not loaded here.
Symbol = Any
Tree = Any


@dataclass(frozen=True)
class Index:
    """An index and the number of members that it counts.

    Attributes:
        name: As in the spec, e.g. ``i``.
        size: N, or None if it is chosen when the system is loaded.
        periodic: Whether member N-1 is followed by member 0; an open chain has two ends.
        first: The number of the first member in formulas, and in names where all are written out.
        count: What formulas call N; "" for nothing.
        from_zero: Whether names count from 0 all the same, as where members are looped over.
        is_value: Whether N is a value in formulas by that name, as a parameter is.
        surface: Of an index that counts the rows of square matrices, whose entries are the members,
            on what these stand for functions: ``sphere`` or ``torus``; else "".
    """

    name: str
    size: int | None = None
    periodic: bool = False
    first: int = 0
    count: str = ""
    from_zero: bool = False
    is_value: bool = False
    surface: str = ""

    @property
    def of_rows(self) -> bool:
        """Whether it counts the rows of square matrices, whose entries are the members."""
        return bool(self.surface)

    @property
    def first_name(self) -> int:
        """The number of the first member in names."""
        return 0 if self.from_zero else self.first

    @property
    def member(self) -> str:
        """What stands for a member in brackets behind the name of what it has."""
        return "i, j" if self.of_rows else self.name

    def allows(self, size: int) -> bool:
        """Whether it may count up to a size: matrices on the torus have odd numbers of rows."""
        return self.surface != "torus" or size % 2 == 1

    def count_members(self, size: int) -> int:
        """How many members there are where the index counts up to a size."""
        return size * size if self.of_rows else size

    def find_size(self, members: int) -> int:
        """Up to what the index counts where there are so many members."""
        size = isqrt(members) if self.of_rows else members
        assert self.count_members(size) == members, members
        return size


class Connection:
    """A connection without curvature along a circle or line, of which there are transports.

    Args:
        name: The strain of a strand; of a Lax pair L and a number in the place of its spectral
            parameter, as ``L(1/2)``.
        side: ``left``: it is psi^-1 dpsi/ds; ``right``: it is (dpsi/ds) psi^-1.
        length: The parameter that is the length of the circle.
        size: Rows of its matrix.
        entries: Those that are not 0, by row and column: texts in fields and parameters.
        has_ends: Whether it goes from one end of a line to the other, and not around a circle.
        velocity: Of a strand likewise the entries of psi^-1 dpsi/dt, or of (dpsi/dt) psi^-1.
    """

    def __init__(
        self,
        name: str,
        side: str,
        length: str,
        size: int,
        entries: Mapping[tuple[int, int], str],
        has_ends: bool = False,
        velocity: Mapping[tuple[int, int], str] = MappingProxyType({}),
    ) -> None:
        self.name, self.side, self.length = name, side, length
        self.size, self.entries, self.has_ends = size, entries, has_ends
        self.velocity = velocity


class PrincipalSymbol:
    """The principal symbol of fields: by what the highest derivatives move them.

    Args:
        length: The parameter that is the length of the circle.
        order: The highest derivative n in the rates.
        largest: The most by which its difference times the n-th power of the spacing multiplies a
            wave.
        matrix: Of the rate of a field, its derivatives by the n-th derivatives of fields, as texts
            by their names, zeros left out.
    """

    def __init__(
        self, length: str, order: int, largest: float, matrix: Mapping[str, Mapping[str, str]]
    ) -> None:
        self.length, self.order, self.largest, self.matrix = length, order, largest, matrix


class Spectral:
    """What fields compute at each time where derivatives are those of Fourier series.

    Args:
        length: The parameter that is the length of the circle.
        derivatives: By its symbol, the field or product that is differentiated, and how often.
        products: By their names texts in fields, parameters, derivatives and earlier products'
            derivatives, in the order in which they are computed.
        rates: Texts by component.
        densities: Of the totals, the energy and the observables, texts by their names.
        solved: Of a velocity that follows from m = A u, its name, m, and the factors of derivatives
            in A as texts by their order; A takes constants to 0 without that of order 0.
        slopes: Of rates and products by their names, how they change with fields and derivatives
            about constant fields, texts by the names of these; zeros are left out.
    """

    def __init__(
        self,
        length: str,
        derivatives: Mapping[str, tuple[str, int]],
        products: Mapping[str, str],
        rates: Mapping[str, str],
        densities: Mapping[str, str],
        solved: Mapping[str, tuple[str, Mapping[int, str]]],
        slopes: Mapping[str, Mapping[str, str]] = MappingProxyType({}),
    ) -> None:
        self.length, self.derivatives, self.products = length, derivatives, products
        self.rates, self.densities, self.solved = rates, densities, solved
        self.slopes = slopes


class Torus:
    """A field at points of a plane that closes in both directions, between transforms.

    Args:
        coordinates: Their names.
        lengths: The parameters that are the lengths of both circles.
        sizes: How many points there are along both; None if that is chosen when it is loaded.
        derivatives: Of what is computed at each point by its name: the field that is
            differentiated, and how often along both coordinates.
        solved: Of a stream function that follows from w = A psi, its name, w, and the factors of
            derivatives in A as texts by their orders along both; A takes constants to 0 without
            that of order (0, 0).
    """

    def __init__(
        self,
        coordinates: tuple[str, ...],
        lengths: tuple[str, ...],
        sizes: tuple[int | None, ...],
        derivatives: Mapping[str, tuple[str, int, int]],
        solved: Mapping[str, tuple[str, Mapping[tuple[int, int], str]]],
    ) -> None:
        self.coordinates, self.lengths, self.sizes = coordinates, lengths, sizes
        self.derivatives, self.solved = derivatives, solved


class Profiles:
    """Where fields begin, as functions of the place.

    Args:
        lengths: The parameters that are the lengths of the coordinates.
        formulas: By the name of a field its components, in all coordinates, then in all parameters
            that points share.
    """

    def __init__(
        self, lengths: tuple[str, ...], formulas: Mapping[str, Callable[..., tuple[float, ...]]]
    ) -> None:
        self.lengths, self.formulas = lengths, formulas


@dataclass(frozen=True)
class WrittenProfiles:
    """The same as texts of Python.

    Attributes:
        lengths: As above.
        arguments: The names of coordinates and parameters, in order.
        texts: By the name of a field one text for each component.
        called: What the texts name of Python's ``math``.
    """

    lengths: tuple[str, ...]
    arguments: tuple[str, ...]
    texts: Mapping[str, tuple[str, ...]]
    called: tuple[str, ...]


@dataclass(frozen=True)
class Sum:
    """A sum over the members, or over the pairs of them.

    Attributes:
        symbol: What stands for the sum in formulas.
        term: Of member i and its neighbours; in a sum over pairs, of member i and a partner j.
        over: ``members``: over i. ``pairs``: over i < j, and the term is the same if i and j change
            places. ``partners``: over all j but i, for a given i.
        before: How many members the term reads before member i; an open chain sums from this i on.
        after: How many it reads after it; an open chain sums up to N-1-after.
    """

    symbol: Symbol
    term: Tree
    over: str = "members"
    before: int = 0
    after: int = 0


@dataclass(frozen=True)
class Total:
    """One number of the whole system: the energy, a component of an observable.

    Attributes:
        name: ``energy``; ``M1`` for the first component of ``M``.
        formula: In the symbols of its sums, of members at the ends and of shared parameters.
        sums: The sums, each over members or over pairs.
    """

    name: str
    formula: Tree
    sums: tuple[Sum, ...]


@dataclass(frozen=True)
class Solved:
    """A component that follows from another one by a linear equation around a ring.

    ``sum_r a_|r| u[i+r] = m[i]``, with the same factors for every member; the matrix is symmetric
    and positive. A level component has the mean 0: the matrix is then this one times that of ``2
    u[i] - u[i-1] - u[i+1]``, which takes constants to 0, and m is taken without its mean.

    Attributes:
        symbol: What is solved for, of member i.
        of: The component on the right side.
        factors: ``a_0, a_1, ...``, in symbols of shared parameters and of N.
        level: Whether it is level.
    """

    symbol: Symbol
    of: Symbol
    factors: tuple[Tree, ...]
    level: bool = False


@dataclass(frozen=True)
class MatrixMotion:
    r"""A motion ``W' = [W, V]`` of skew-Hermitian matrices on a surface, whose entries are members.

    Member ``i*n + j`` is the real number ``W_ij`` that stands for the matrix :math:`(W - W^T)/2 +
    \mathrm{i} (W + W^T)/2`, and so is ``V_ij``. V follows from W by ``scale L V = W`` on each
    diagonal, on the sphere with

    .. math:: (L V)_{ij} = 2 (s (s + 1) - z_i z_j) V_{ij} - c_i c_j V_{i+1, j+1}
        - c_{i-1} c_{j-1} V_{i-1, j-1},

    :math:`s = (n - 1)/2`, :math:`z_i = s - i` and :math:`c_i^2 = (i + 1)(n - 1 - i)`. On the torus
    L multiplies the matrices of waves by :math:`k_1^2 + k_2^2` (`coadjoint.algebra.waves`). V has
    the trace 0, and W is taken without its trace.

    Attributes:
        state: The entry of W that a member is.
        velocity: That of V.
        product: That of the product of matrices which a function reads: ``[W, V]``, or V W V.
        scale: The factor of L, in symbols of shared parameters and of the number of members.
    """

    state: Symbol
    velocity: Symbol
    product: Symbol
    scale: Tree


@dataclass(frozen=True)
class Action:
    """A motion as a bracket with its energy, in two functions, where this is not quadratic.

    Attributes:
        gradient: Derivatives of the energy by the components of member i, in symbols of the family
            and those of ``pair_sums``.
        gradient_ends: Of an open chain, the same of members at the ends, by their numbers.
        pair_sums: Sums over the partners j of member i, which the gradient names.
        bracket: The tensor times a vector, for each component of member i.
        bracket_ends: Where it is another one at the ends, that of members there, likewise.
        vector: Symbols of the vector, by those of the state of member i and of its neighbours.
    """

    gradient: tuple[Tree, ...]
    gradient_ends: Mapping[int, tuple[Tree, ...]]
    pair_sums: tuple[Sum, ...]
    bracket: tuple[Tree, ...]
    bracket_ends: Mapping[int, tuple[Tree, ...]]
    vector: Mapping[Symbol, Symbol]


@dataclass(frozen=True)
class Rises:
    """What a flow adds to a member in a time.

    Attributes:
        definitions: Symbols of half an angle, its tangent and the sine of the angle, with what they
            are, in the symbols of rates, of the time and of earlier ones.
        trees: What is added to each component, in these symbols.
    """

    definitions: tuple[tuple[Symbol, Tree], ...]
    trees: tuple[Tree, ...]


@dataclass(frozen=True)
class PartFlow:
    """The flow of a part of the energy.

    Attributes:
        member: What it adds to member i.
        ends: The same of members that lack a neighbour, as in `Family.ends`.
    """

    member: Rises
    ends: Mapping[int, Rises]


@dataclass(frozen=True)
class Family:
    """The equations of the generic member of an indexed system.

    Attributes:
        index: The index, its size and whether neighbours close to a ring.
        states: Symbols of the components of member i, in the order of the state.
        shifts: Which neighbours the rates read, in order and without 0, e.g. ``(-1, 1)``.
        neighbours: By component symbol and shift, the symbol of that component of member i+shift,
            of states, indexed parameters and inputs; for every shift that any rate or total reads.
        shared: Symbols of the parameters that all members share.
        indexed: Symbols of the parameters of member i.
        partners: By component symbol, that of member j of a pair; of all that it has.
        rates: Rate of each component of member i, in these symbols and those of pair sums.
        pair_sums: Sums over the partners j of member i, which the rates name; empty without pairs.
        ends: Of an open chain, the rates of the members that lack a neighbour, or that stand alone
            in the energy, by member: 0, 1, ... from the start and -1, -2, ... from the end; empty
            for a ring.
        totals: The energy and the observables.
        small: The least N for which ``rates``, ``ends`` and ``totals`` hold: both ends together, 1
            for a ring, in which members may be each other's neighbours more than once.
        turned: The state of member i with its attitudes moved back to rotations; empty without any.
        residuals: What is zero where they are rotations.
        time: The symbol of the time, which all members share, if the equations name it.
        singles: By component symbol and number, counted as in ``ends``, the symbol of that
            component of a member at an end, as far as totals name it.
        wraps: Whether places of neighbours go on round: in a ring, and in a chain of which members
            at one end push those at the other.
        shared_inputs: Symbols of the inputs that all members share.
        indexed_inputs: Symbols of the inputs of member i, which have neighbours and partners as
            parameters have.
        noise: What increments of Wiener processes do to each component of member i, linear in these
            increments; empty without noise.
        noise_ends: The same of members that lack a neighbour, as in ``ends``.
        shared_noise: Symbols of the increments of processes that move all members.
        indexed_noise: Symbols of those of member i; its neighbours have others.
        sides: Symbols of given signs at the kinks of member i, where the rates are those of given
            signs; its neighbours have others.
        count: The symbol of N, if the equations name it.
        solved: Components that rates and totals read next to those of the state, with neighbours as
            these have.
        matrices: What the members are where they are entries of matrices, else None.
        action: The bracket and the gradient of the energy; None where nothing asks for them, or
            they are no loops.
        flows: The flows of the parts of the energy, in the order of a symmetric product.
        step: The symbol of the time over which these flow, if there are any.
    """

    index: Index
    states: tuple[Symbol, ...]
    shifts: tuple[int, ...]
    neighbours: Mapping[tuple[Symbol, int], Symbol]
    shared: tuple[Symbol, ...]
    indexed: tuple[Symbol, ...]
    partners: Mapping[Symbol, Symbol]
    rates: tuple[Tree, ...]
    pair_sums: tuple[Sum, ...]
    ends: Mapping[int, tuple[Tree, ...]]
    totals: tuple[Total, ...]
    small: int
    turned: tuple[Tree, ...] = ()
    residuals: tuple[Tree, ...] = ()
    time: tuple[Symbol, ...] = ()
    singles: Mapping[tuple[Symbol, int], Symbol] = field(default_factory=dict)
    wraps: bool = False
    shared_inputs: tuple[Symbol, ...] = ()
    indexed_inputs: tuple[Symbol, ...] = ()
    noise: tuple[Tree, ...] = ()
    noise_ends: Mapping[int, tuple[Tree, ...]] = field(default_factory=dict)
    shared_noise: tuple[Symbol, ...] = ()
    indexed_noise: tuple[Symbol, ...] = ()
    sides: tuple[Symbol, ...] = ()
    count: tuple[Symbol, ...] = ()
    solved: tuple[Solved, ...] = ()
    matrices: MatrixMotion | None = None
    action: Action | None = None
    flows: tuple[PartFlow, ...] = ()
    step: tuple[Symbol, ...] = ()

    @property
    def completed(self) -> tuple[Symbol, ...]:
        """Symbols of what stands below the state of member i before a function begins."""
        if self.matrices is not None:
            return self.matrices.velocity, self.matrices.product
        return tuple(each.symbol for each in self.solved)

    @property
    def own(self) -> tuple[Symbol, ...]:
        """Symbols of all that member i has: its state, parameters and inputs."""
        return (*self.states, *self.indexed, *self.indexed_inputs)
