"""The System of a family of equal members, for any number of them.

Comes in: the declarations of a member in a generated ``__init__.py``. Goes out: a System of N
members, which calls the same kernels for every N: they take N as an argument.
Read next: `coadjoint.solve.system`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from itertools import count
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Self

from coadjoint.declared import CLOCK, Quantity
from coadjoint.errors import KernelArgumentError
from coadjoint.families import Connection, Index, PrincipalSymbol, Profiles, Spectral, Torus
from coadjoint.kernel_functions import KERNEL_FUNCTIONS
from coadjoint.sizes import HOLD, check_least, check_memory
from coadjoint.solve.quantities import Quantities
from coadjoint.solve.system import System

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from coadjoint.methods import JudgedMethod
    from coadjoint.render.targets.modules import KernelModule
    from coadjoint.render.targets.protocol import Kernel
    from coadjoint.solve.choices import Choice
    from coadjoint.solve.family_steps import FamilyTwin

#: Functions that fields by Fourier derivatives have.
BY_WAVES: Final = ("rhs", "energy", "observables")
#: Members with which fresh objects are compared: some blocks, and some behind the last.
PROBED: Final = 51


class FamilySystem(System):
    """A system of equal members, of which there are N.

    Where these are the entries of square matrices, row by row, the index counts the rows.

    Rows of the state are the first component of members 0 to N-1, then the second one of them, and
    so on: ``state.reshape(components, N, *batch)``. A row is called ``S1[0]``. Parameters are those
    that all members share, then those of each member in the same order, and so are inputs.

    Attributes:
        index: The index, with N as its size.
        small: The fewest members for which the equations hold.
        NOISE: The Wiener processes, those that move all members before those of each.
        steppers: Who makes its steps, by method and target, as far as that was asked for.
        spheres: Components of a member that are a vector on a sphere, by the name of the square of
            its radius, if a member has nothing else.
        positions: Those that are positions, where the energy is ``T(p) + V(q)``.
        kinks: What is zero at the kinks of member i, and of members at the ends by their places.
        pair_kinks: What is zero at the kinks of the terms of pairs, where no step ends.
        connections: What has transports and a holonomy, if the members are points of a circle.
        wave: Of a field that is carried by itself, the speed of waves and the name of the length.
        spectral: Of fields, what is computed where derivatives are those of Fourier series.
        symbol: Of fields, their principal symbol.
        profiles: Where fields begin.
        called_by_flows: What flows of parts of the energy call beyond what `elementary` has.
        own_state: Components of a member.
        torus: Of a field in a plane, what is computed around its points.
    """

    torus: Torus | None = None
    stepwise = "steps of many equal members are recorded by their twin"

    def __init__(
        self,
        name: str,
        file: str,
        index: tuple[Index, int],
        state: Quantities,
        shared: Quantities,
        indexed: Quantities,
        observables: Quantities,
        functions: Mapping[str, tuple[int, ...] | int | None],
        elementary: Sequence[str],
        identity: str,
        unit_of_time: str = "s",
        clock: tuple[str, str] = CLOCK,
        defaults: Mapping[str, tuple[float, ...]] = MappingProxyType({}),
        repeating: Sequence[str] = (),
        time: Quantities | None = None,
        shared_inputs: Quantities | None = None,
        indexed_inputs: Quantities | None = None,
        shared_noise: Quantities | None = None,
        indexed_noise: Quantities | None = None,
        methods: Sequence[JudgedMethod] = (),
        spheres: Mapping[str, tuple[int, ...]] = MappingProxyType({}),
        positions: tuple[int, ...] = (),
        kinks: Mapping[int | None, tuple[str, ...]] = MappingProxyType({}),
        pair_kinks: tuple[str, ...] = (),
        connections: tuple[Connection, ...] = (),
        wave: tuple[str, ...] = (),
        spectral: Spectral | None = None,
        symbol: PrincipalSymbol | None = None,
        profiles: Profiles | None = None,
        called_by_flows: Sequence[str] = (),
    ) -> None:
        self.index, self.small = index
        self.spheres, self.positions = spheres, positions
        self.kinks, self.pair_kinks, self.wave = kinks, pair_kinks, wave
        self.connections, self.spectral, self.symbol = connections, spectral, symbol
        self.own_state = [name for each in state.values() for name in each.components]
        self.profiles, self.called_by_flows = profiles, called_by_flows
        self._declared = (state, shared, indexed, observables, functions, elementary)
        alike, own = (each or Quantities() for each in (shared_inputs, indexed_inputs))
        noise, own_noise = (each or Quantities() for each in (shared_noise, indexed_noise))
        self._driving = {"shared_inputs": alike, "indexed_inputs": own}
        self._driving |= {"shared_noise": noise, "indexed_noise": own_noise}
        self._defaults, self._repeating = defaults, repeating
        self.steppers: dict[tuple[Choice, str], FamilyTwin] = {}
        size = self.size
        counted = state.size + indexed.size + own.size + own_noise.size
        check_memory(name, self.counted_by, size * counted)
        self.members = size
        self.NOISE = Quantities(
            *noise.values(), *(self._repeat(each, size) for each in own_noise.values())
        )
        super().__init__(
            name,
            file,
            Quantities(*(self._begin_with(each, size) for each in state.values())),
            Quantities(*shared.values(), *(self._repeat(each, size) for each in indexed.values())),
            observables,
            {
                function: shape
                if isinstance(shape, tuple)
                else ((state.size if shape is None else shape) * size,)
                for function, shape in functions.items()
            },
            elementary,
            identity,
            inputs=Quantities(
                *alike.values(), *(self._repeat(each, size) for each in own.values())
            ),
            time=time,
            unit_of_time=unit_of_time,
            clock=clock,
            methods=methods,
        )

    def rows(self, function: str) -> Quantities:
        """What the rows of the first argument of a function are."""
        if KERNEL_FUNCTIONS[function].below == "noise":
            return Quantities(*self.STATE.values(), *self.NOISE.values())
        if KERNEL_FUNCTIONS[function].below == "step":
            step = Quantity(name="step", shape=(), unit=self.unit_of_time, components=("step",))
            return Quantities(*self.STATE.values(), step)
        if KERNEL_FUNCTIONS[function].below == "sides":
            count = len(self.kinks.get(None, ()))
            names = [f"side{n}" for n in range(1, count + 1)]
            signs = [Quantity(name=n, shape=(), unit="1", components=(n,)) for n in names]
            sides = [self._repeat(each, self.size) for each in signs]
            return Quantities(*self.STATE.values(), *sides)
        return super().rows(function)

    def list_called(self, function: str) -> tuple[str, ...]:
        """As of other systems; flows may call more."""
        further = self.called_by_flows if function.startswith("flow") else ()
        return (*self.elementary, *further)

    @cached_property
    def kink_names(self) -> tuple[str, ...]:
        """What is zero at each kink of all members, in the rows of the function ``kinks``."""
        i, size = re.escape(self.index.name), self.size
        places = {place % size: own for place, own in self.kinks.items() if place is not None}

        def number(found: re.Match[str], member: int) -> str:
            first = {self.index.name: member, "N": size}.get(found[1], 0)
            return f"[{(first + int(found[2] or 0)) % size}]"

        own = self.kinks.get(None, ())
        return tuple(
            re.sub(rf"\[({i}|N|)([+-]?\d+)?\]", partial(number, member=n), rows[row])
            for row in range(len(own))
            for n in range(size)
            for rows in [places.get(n, own)]
        )

    @property
    def size(self) -> int:
        """The number of members: N, or its square where members are entries of matrices."""
        return self.index.count_members(self.index.size or self.small)

    @property
    def points(self) -> FamilySystem:
        """What generated kernels compute: itself, but for a field in a plane."""
        return self

    @cached_property
    def fixed(self) -> Mapping[str, NDArray[np.float64]]:
        """N, as kernels take it."""
        import numpy as np

        return MappingProxyType({"sizes": np.array([float(self.size)])})

    @cached_property
    def series(self) -> KernelModule:
        """The recurrences of its series in NumPy, and what they keep.

        Raises:
            OutputError: The file cannot be loaded.
        """
        from coadjoint.render.targets.modules import KernelModule

        return KernelModule(self, "solver.py")

    @property
    def probed(self) -> FamilySystem:
        """Itself with few members, with which fresh objects are compared: texts know no number.

        Pairs of thousands of members would take NumPy minutes.
        """
        sizes = (n for n in count(self.small) if self.index.allows(n))
        few = next(n for n in sizes if self.index.count_members(n) >= PROBED)
        if self.size <= self.index.count_members(few):
            return self
        return self.resize({self.index.name: few})

    @property
    def stretched(self) -> dict[int, float]:
        """Lengths of fields by their rows, which are as many times longer as there are points.

        Between points that are close to each other differences are large: where A u = m they lose
        more digits than two builds may differ by.
        """
        rows = [*self.PARAMETERS.components]
        return {rows.index(name): float(self.size) for name in self.lengths.values()}

    def find_kernel(self, target: str) -> Kernel:
        """The kernel of a target itself.

        Raises:
            CompilerError: It cannot be compiled.
            CrossCheckError: It differs from the NumPy kernel.
        """
        return self._kernels.find_kernel(target)

    def count_series(self, order: int, trajectories: int) -> tuple[int, int]:
        """Bytes of the series of members and of those of pairs, as solvers keep them.

        Args:
            order: Of the method of Taylor.
            trajectories: How many there are, of which some are computed together.
        """
        module = self.series
        lanes = 8 * min(trajectories, int(module.value("TOGETHER"))) * (order + 1)
        own, pairs = int(module.value("MEMBER")), int(module.value("PAIR"))
        return lanes * own * self.size, lanes * pairs * self.size**2

    def rows_of(self, components: Sequence[int]) -> list[slice]:
        """The rows of components of all members in a state."""
        return [slice(n * self.size, (n + 1) * self.size) for n in components]

    def find_radii(self, states: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """The squares of the radii of all members, by their name, ``(N, *batch)``."""
        return {
            name: states[self.rows_of(components)[0]] ** 2
            + sum(states[rows] ** 2 for rows in self.rows_of(components)[1:])
            for name, components in self.spheres.items()
        }

    def resize(self, sizes: Mapping[str, int]) -> FamilySystem:
        """The system with another number of members.

        Args:
            sizes: The number by the name of the index: ``{"i": 1000}``.

        Raises:
            KernelArgumentError: No such index, or too few members.
            ResourceError: So many members do not fit into memory.
        """
        size = check_sizes(self.name, self.index, self.small, sizes, self.counted)
        return self._copy(replace(self.index, size=size))

    @property
    def counted_by(self) -> str:
        """The name of its index."""
        return self.index.name

    @property
    def counted(self) -> str:
        """What its index counts: ``members``, ``rows`` of matrices, or ``points`` of fields."""
        if self.index.of_rows:
            return "rows"
        is_field = (self.symbol, self.spectral, self.profiles) != (None, None, None)
        is_field |= self.torus is not None
        return "points" if is_field else "members"

    @property
    def lengths(self) -> dict[str, str]:
        """Of fields along a circle or a line, its length by the name of the coordinate."""
        if self.torus is not None:
            return dict(zip(self.torus.coordinates, self.torus.lengths, strict=True))
        known = (
            *(self.profiles.lengths if self.profiles else ()),
            *(each.length for each in (self.spectral, self.symbol, *self.connections) if each),
        )
        return {self.index.name: known[0]} if known else {}

    def find_coordinates(self, parameters: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Where the points of fields stand, in units of the lengths, by the coordinates' names.

        Args:
            parameters: Packed, ``(k,)`` or ``(k, *batch)``.

        Returns:
            Places along each, ``(N,)``; none of what is no field, or where trajectories differ.
        """
        import numpy as np

        found = {}
        for name, length in self.lengths.items():
            lengths = np.unique(parameters[self.PARAMETERS.rows(length)])
            if len(lengths) != 1:
                return {}
            found[name] = np.array([p for (p,) in self._list_places([float(lengths[0])])])
        return found

    def _copy(self, index: Index, **changed: Any) -> Self:
        """The same for another index, and what else is changed."""
        given: dict[str, Any] = {
            "unit_of_time": self.unit_of_time,
            "clock": self.clock,
            "defaults": self._defaults,
            "repeating": self._repeating,
            "time": self.TIME,
            **self._driving,
            "methods": self.METHODS,
            "spheres": self.spheres,
            "positions": self.positions,
            "kinks": self.kinks,
            "pair_kinks": self.pair_kinks,
            "connections": self.connections,
            "wave": self.wave,
            "spectral": self.spectral,
            "symbol": self.symbol,
            "profiles": self.profiles,
            "called_by_flows": self.called_by_flows,
        }
        file, first = str(self.folder / "__init__.py"), (index, self.small)
        made = type(self)(self.name, file, first, *self._declared, self.id, **given | changed)
        made.levels = self.levels
        return made

    def _repeat(self, quantity: Quantity, size: int) -> Quantity:
        """A quantity of a member as one of all members, component after component.

        Where its default differs from member to member, there is none for another number of them,
        unless those of some members repeat or a formula has them.
        """
        components = tuple(f"{name}[{i}]" for name in quantity.components for i in range(size))
        default = quantity.default and tuple(v for v in quantity.default for _ in range(size))
        own = self._defaults.get(quantity.name)
        if own is not None:
            some = len(own) // len(quantity.components)
            fits = size % some == 0 if quantity.name in self._repeating else size == some
            starts = range(0, len(own), some)
            default = (
                tuple(own[k + i % some] for k in starts for i in range(size)) if fits else None
            )
        if self.profiles is not None and quantity.name in self.profiles.formulas:
            default = self._begin(quantity.name)
        shape = (*quantity.shape, size)
        return replace(quantity, shape=shape, components=components, default=default)

    def _begin_with(self, quantity: Quantity, size: int) -> Quantity:
        """The same of the state: a field begins at 0 where nothing else is said."""
        repeated = self._repeat(quantity, size)
        known = self._defaults.keys() | (self.profiles.formulas.keys() if self.profiles else ())
        if self.counted != "points" or repeated.default is not None or quantity.name in known:
            return repeated
        return replace(repeated, default=(0.0,) * len(repeated.components))

    def _begin(self, field: str) -> tuple[float, ...] | None:
        """A field at the beginning, component after component.

        None where nobody has said how many points there are, or a formula has no value at one.
        """
        profiles, shared = self.profiles, self._declared[1]
        assert profiles is not None, self.name
        if self.index.size is None:
            return None
        formula, given = profiles.formulas[field], [shared.defaults[c] for c in shared.components]
        places = self._list_places([shared.defaults[name] for name in profiles.lengths])
        try:
            values = [formula(*place, *given) for place in places]
        except (ArithmeticError, ValueError):
            return None
        return tuple(float(x) for component in zip(*values, strict=True) for x in component)

    def _list_places(self, lengths: Sequence[float]) -> Iterator[tuple[float, ...]]:
        """The coordinates of all points: around a circle, or from end to end of a line."""
        (length,) = lengths
        steps = self.size - (not self.index.periodic)
        return ((n * length / steps,) for n in range(self.size))

    def __reduce__(self) -> tuple[Callable[..., System], tuple[Any, ...]]:
        """Pickled by reference, and its size."""
        find, given = super().__reduce__()
        return _find_resized, (find, given, {self.index.name: self.index.find_size(self.size)})

    def __repr__(self) -> str:
        state, parameters = (", ".join(each) for each in (self.STATE, self.PARAMETERS))
        size, index = self.size, self.index
        members = {
            "members": f"{size} members {index.name}",
            "rows": f"{size} entries of {index.find_size(size)} rows",
            "points": f"{size} points along {index.name}",
        }[self.counted]
        told = f"{members}; state {state}; parameters {parameters or 'none'}"
        driving = {"inputs": self.INPUTS, "noise": self.NOISE, "time": self.TIME}
        told += "".join(f"; {name} {', '.join(each)}" for name, each in driving.items() if each)
        return f"<System {self.name}: {told}>"


def check_profiles(system: System, given: Iterable[str]) -> None:
    """Each field that is not given has a value at each point at the beginning.

    Args:
        system: A System; one without profiles begins as others do.
        given: Names of fields, or of their components, that are given.

    Raises:
        KernelArgumentError: A profile has no value at some point.
    """
    if not isinstance(system, FamilySystem) or system.profiles is None or lacks_size(system):
        return
    known = {*given}
    for name, each in system.STATE.items():
        lacking = each.default is None and name in system.profiles.formulas
        if lacking and known.isdisjoint((name, *each.components)):
            raise KernelArgumentError(
                f"the profile of {name} of {system.name} has no value at some of its {system.size} "
                f"points; expected a state, or a number of points at which it has values.",
                found=name,
            )


def lacks_size(system: System) -> bool:
    """Whether nobody has said yet how many members it has."""
    return isinstance(system, FamilySystem) and system.index.size is None


def _find_resized(
    find: Callable[..., Any], given: tuple[Any, ...], sizes: Mapping[str, int]
) -> System:
    """What `FamilySystem.__reduce__` says."""
    system: System = find(*given).resize(sizes)
    return system


#: What an index counts: the table of specs that declares it, and its words before its name.
_TABLES: Final = {
    "members": ("index", "for the index"),
    "rows": ("truncation", "for the index"),
    "points": ("space", "along"),
}


def check_sizes(
    name: str,
    index: Index,
    small: int,
    sizes: Mapping[str, int],
    counted: str = "members",
    why: str = HOLD,
) -> int:
    """The number of members that is asked for.

    Args:
        name: The system.
        index: Its index.
        small: The fewest that there may be.
        sizes: What is asked for.
        counted: What the index counts, as `FamilySystem.counted`.
        why: What is so from the fewest on.

    Raises:
        KernelArgumentError: No such index, or too few members.
    """
    if list(sizes) != [index.name]:
        table, before = _TABLES[counted]
        declared = f"{{ {'length = ..., ' * (counted == 'points')}size = 1000 }}"
        raise KernelArgumentError(
            f"sizes of {name} are {dict(sizes)!r}; expected a number of {counted} {before} "
            f"{index.name}. Choose it, sizes={{{index.name!r}: 1000}}, or declare it, [{table}] "
            f"{index.name} = {declared}.",
            found=list(sizes),
            expected=[index.name],
        )
    size = sizes[index.name]
    check_least(name, index.name, size, small, why)
    if not index.allows(size):
        raise KernelArgumentError(
            f"the size of {index.name} of {name} is {size}; expected an odd number, since matrices "
            f"of an even number of rows have no waves. Take {size - 1} or {size + 1}.",
            found=size,
            expected=(size - 1, size + 1),
        )
    return size
