r"""Fourier derivatives: fields whose derivatives are those of the trigonometric polynomial.

With N points of a circle of length L and :math:`\kappa_n = 2 \pi n / L`,

.. math:: (D_k f)_j = \sum_n (i \kappa_n)^k \hat f_n e^{2 \pi i n j / N},

by `scipy.fft`. For even N the mode n = N/2 has no odd derivative, so that :math:`D_k` is real,
antisymmetric for odd k and symmetric for even k: the energy is kept in continuous time, as by
differences, and the error of a smooth field falls faster than any power of L/N.

Python leads the steps, SciPy transforms, and NumPy computes products and rates at all points by the
texts of the generated package. Every target names this computation, so that there is one result.
Comes in: a `FamilySystem` of fields. Goes out: the same system with other derivatives.
Read next: `coadjoint.solve.simulate`.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.errors import KernelArgumentError, PeriodicityWarning
from coadjoint.families import LEAST_AROUND
from coadjoint.render.targets.protocol import Call, Kernel
from coadjoint.sizes import MOVES, check_least
from coadjoint.solve.family import BY_WAVES, FamilySystem, check_sizes
from coadjoint.solve.formulas import Formula
from coadjoint.solve.kernels import Kernels
from coadjoint.solve.quantities import Quantities

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.array_types import Array
    from coadjoint.families import Spectral
    from coadjoint.methods import JudgedMethod
    from coadjoint.solve.request import Request
    from coadjoint.solve.solution import Solution
    from coadjoint.solve.system import System

#: How much larger than elsewhere a step across the ends is that is called a jump, and the least
#: part of a field that is looked at.
STEEP, SMALL = 10.0, 1e-6
#: The part of a field that its mean may be where it is 0 but for rounding.
MEAN: Final = 1e-9


class SpectralSystem(FamilySystem):
    """Fields at N points of a circle, by Fourier derivatives.

    Args:
        system: The same fields by differences.
    """

    derivatives = "fourier"
    obstacle = "its derivatives are those of Fourier series, between which Python leads the steps"

    def __init__(self, system: FamilySystem) -> None:
        assert system.spectral is not None, system.name
        self.__dict__.update(system.__dict__)
        for name in ("_kernels", "_solvers"):
            self.__dict__.pop(name, None)
        self.differences = system
        midpoints = [_judge(each) for each in system.METHODS if each.name == "midpoint"]
        self.METHODS = (
            *midpoints,  # what it keeps is quadratic, and Gauss's methods keep all that is
            *(
                replace(
                    each,
                    name=f"gauss{2 * stages}",
                    order=2 * stages,
                    cost=each.cost.replace("one midpoint", f"{stages} stages"),
                    rank=0,
                )
                for each in midpoints
                for stages in (2, 3, 4)
            ),
        )
        kept = (
            replace(each, conserved=each.name == "energy") for each in system.OBSERVABLES.values()
        )
        self.OBSERVABLES = Quantities(*kept)
        self.functions = {name: system.functions[name] for name in BY_WAVES}

    @property
    def own(self) -> Spectral:
        """What is computed with these derivatives."""
        assert self.spectral is not None, self.name
        return self.spectral

    def resize(self, sizes: Mapping[str, int]) -> SpectralSystem:
        """The fields at another number of points; a circle may have fewer than differences need."""
        old = self.differences
        size = check_sizes(self.name, self.index, LEAST_AROUND, sizes, self.counted, MOVES)
        return SpectralSystem(old._copy(replace(self.index, size=size)))

    @cached_property
    def _kernels(self) -> Kernels:
        return _SpectralKernels(self)

    def __reduce__(self) -> tuple[Callable[..., System], tuple[Any, ...]]:
        _, (find, given, sizes) = self.differences.__reduce__()
        return _find_resized, (find, given, sizes)

    def __repr__(self) -> str:
        return f"{super().__repr__()[:-1]}; Fourier derivatives>"


def _find_resized(
    find: Callable[..., Any], given: tuple[Any, ...], sizes: Mapping[str, int]
) -> System:
    """What `SpectralSystem.__reduce__` says."""
    return SpectralSystem(find(*given)).resize(sizes)


def _judge(method: JudgedMethod) -> JudgedMethod:
    """The midpoint by Fourier derivatives: of what it keeps, the energy alone is kept by these."""
    return replace(
        method,
        exactly=tuple(x for x in method.exactly if x == "energy"),
        nearly=(*method.nearly, *(x for x in method.exactly if x != "energy")),
        is_poisson=False,
    )


class _SpectralKernels(Kernels):
    """One kernel, whatever the target is."""

    def __init__(self, system: SpectralSystem) -> None:
        super().__init__(system)
        self._kernel_of_all = SpectralKernel(system)

    def _load(self, target: str) -> Kernel:
        return self._kernel_of_all


class SpectralKernel(Kernel):
    """Rates, energy and observables of fields by Fourier derivatives."""

    def __init__(self, system: FamilySystem) -> None:
        assert system.spectral is not None, system.name
        self.source, self._size, self._names = "", system.size, list(system.own_state)
        self._spectral: Spectral = system.spectral
        self._shared = list(system.PARAMETERS.components)
        own = self._spectral
        texts = [x for each in (own.products, own.rates, own.densities) for x in each.values()]
        texts += [x for _, factors in own.solved.values() for x in factors.values()]
        names = [*self._names, *self._shared, *own.solved, *own.derivatives, *own.products]
        scope = dict.fromkeys(names, ())
        self._formulas = {text: Formula(text, scope, "a text of fields") for text in texts}

    def calls(self, function: str, call: Call) -> Iterator[Callable[[], Any]]:
        """One call for all trajectories."""
        yield partial(self._evaluate, function, call)

    def _evaluate(self, function: str, call: Call) -> None:
        """A function of all trajectories at once, the points before the trajectories."""
        shape = (self._size, call.members)
        with np.errstate(all="ignore"):
            known = self._differentiate(call.state, call.parameters, shape)
            if function == "rhs":
                rates = [self._find(text, known, shape) for text in self._spectral.rates.values()]
                call.block[...] = np.reshape(rates, call.block.shape)
                return
            spacing = known[self._spectral.length] / self._size
            sums = [
                spacing * np.sum(self._find(text, known, shape), axis=0)
                for name, text in self._spectral.densities.items()
                if function == "observables" or name == "energy"
            ]
            call.block[...] = np.reshape(sums, call.block.shape)

    def find_densities(self, state: Array, parameters: Array) -> dict[str, Array]:
        """What is summed over the points for each total, ``(N, members)``, by its name.

        Args:
            state: ``(n, members)``.
            parameters: Packed, ``(k,)`` or ``(k, members)``.
        """
        shape = (self._size, state.shape[1])
        with np.errstate(all="ignore"):
            known = self._differentiate(state, parameters, shape)
            return {
                name: self._find(text, known, shape)
                for name, text in self._spectral.densities.items()
            }

    def _differentiate(
        self, state: Array, parameters: Array, shape: tuple[int, int]
    ) -> dict[str, Array]:
        """Parameters, fields, products and their derivatives by name."""
        fields = dict(zip(self._names, state.reshape(-1, *shape), strict=True))
        columns = parameters if parameters.ndim > 1 else parameters[:, np.newaxis]
        given = dict(zip(self._shared, columns, strict=True))
        known, waves = given | fields, Waves(self._size, given[self._spectral.length])
        for u, (m, factors) in self._spectral.solved.items():
            parts = {k: self._find(text, given, shape[1:]) for k, text in factors.items()}
            known[u] = waves.solve(fields[m], parts)
        waiting = dict(self._spectral.products)
        for name, (of, order) in self._order():
            if of in waiting:
                known[of] = self._find(waiting.pop(of), known, shape)
            known[name] = waves.differentiate(known[of], order)
        return known

    def _order(self) -> Iterator[tuple[str, tuple[str, int]]]:
        """Derivatives of fields, then those of products in the order of these."""
        places = {name: n for n, name in enumerate(self._spectral.products, 1)}
        own = self._spectral.derivatives.items()
        yield from sorted(own, key=lambda each: places.get(each[1][0], 0))

    def _find(self, text: str, known: Mapping[str, Array], shape: tuple[int, ...]) -> Array:
        """A text at all points of all trajectories."""
        size = int(np.prod(shape))
        named = self._formulas[text].names
        flat = {name: np.broadcast_to(known[name], shape).reshape(size) for name in named}
        value, _ = self._formulas[text].evaluate(flat)
        return np.broadcast_to(value, (size,)).reshape(shape)


class Waves:
    """The waves on a circle.

    Args:
        size: How many points it has.
        length: How long it is, a number for each trajectory or for all.
    """

    def __init__(self, size: int, length: Array) -> None:
        self.size = size
        self._numbers = 2 * np.pi * np.arange(size // 2 + 1)[:, np.newaxis] / length

    def differentiate(self, values: Array, order: int) -> Array:
        """The derivative of values ``(N, trajectories)``."""
        return self._multiply(values, self.find_symbol(order))

    def solve(self, right: Array, factors: Mapping[int, Array]) -> Array:
        """U with ``sum_k a_k D_k u = right``; with the mean 0 where constants are taken to 0."""
        return self._multiply(right, self.invert(factors))

    def invert(self, factors: Mapping[int, Array]) -> Array:
        """One over what ``sum_k a_k D_k`` multiplies each wave by; 0 where that takes it to 0."""
        symbol = sum((a * self.find_symbol(k) for k, a in factors.items()), np.zeros(1)).real
        if 0 not in factors:
            symbol[0] = np.inf
        inverse: Array = 1 / symbol
        return inverse

    def find_symbol(self, order: int) -> NDArray[np.complex128]:
        """What a derivative multiplies each wave by."""
        symbol: NDArray[np.complex128] = np.asarray((1j * self._numbers) ** order, dtype=complex)
        if order % 2 and self.size % 2 == 0:
            symbol[-1] = 0
        return symbol

    def _multiply(self, values: Array, symbol: NDArray[Any]) -> Array:
        from scipy import fft

        waves = fft.rfft(values, axis=0) * symbol
        found: Array = fft.irfft(waves, n=self.size, axis=0)
        return found


def find_densities(solution: Solution) -> dict[str, Array]:
    """The densities of the totals of fields along a line, ``(N, *batch, T)``, by their names.

    Derivatives in them are those of Fourier series on a circle; between ends they have none. Of
    what inputs or the time drive, and of fields in a plane, there are none.
    """
    system = solution.system
    if not isinstance(system, FamilySystem) or not system.lengths or system.torus is not None:
        return {}
    if system.spectral is None and (system.INPUTS or system.TIME):
        return {}
    state, parameters = solution.state, solution.parameters
    if parameters.ndim > 1:  # each trajectory has its own at all of its samples
        parameters = np.broadcast_to(
            parameters[..., np.newaxis], (*parameters.shape, state.shape[-1])
        ).reshape(len(parameters), -1)
    flat = state.reshape(len(state), -1)
    if system.spectral is not None:
        found = SpectralKernel(system).find_densities(flat, parameters)
    else:
        found = _find_between_ends(system, flat, parameters)
    return {name: value.reshape(-1, *state.shape[1:]) for name, value in found.items()}


def _find_between_ends(system: FamilySystem, state: Array, parameters: Array) -> dict[str, Array]:
    """Densities of fields alone: at a point, the total of what is the same everywhere, by length.

    Args:
        system: Of fields between ends.
        state: ``(n, members)``.
        parameters: ``(k,)`` or ``(k, members)``.
    """
    (length,), few = system.lengths.values(), system.resize({system.index.name: system.small})
    long = parameters[system.PARAMETERS.rows(length)]
    fields = state.reshape(-1, system.size, state.shape[1])  # (fields, N, members)
    totals = [
        few.observables(np.repeat(fields[:, i], few.size, axis=0), parameters, target="numpy")
        for i in range(system.size)
    ]
    rows = np.moveaxis(np.stack(totals) / long, 0, 1)  # (totals, N, members)
    return dict(zip(few.OBSERVABLES.components, rows, strict=True))


def solve_velocities(
    system: FamilySystem, parameters: Mapping[str, Array], fields: Mapping[str, Array]
) -> dict[str, Array]:
    """Velocities that follow from m = A u at points ``(N, ...)``; empty where there are none."""
    found: dict[str, Array] = {}
    own = system.spectral
    if own is None:
        return found
    for u, (m, factors) in own.solved.items():
        texts = (Formula(x, dict.fromkeys(parameters, ()), "a factor") for x in factors.values())
        values = fields[m].reshape(system.size, -1)
        shape = fields[m].shape[1:]

        def spread(value: Any, shape: tuple[int, ...] = shape) -> Array:
            return np.broadcast_to(value, shape).reshape(-1)

        given = {name: spread(value) for name, value in parameters.items()}
        parts = {k: text.evaluate(given)[0] for k, text in zip(factors, texts, strict=True)}
        waves = Waves(system.size, given[own.length])
        found[u] = waves.solve(values, parts).reshape(fields[m].shape)
    return found


def use_derivatives(system: System, derivatives: str) -> System:
    """The system with the derivatives that are asked for.

    Args:
        system: A System.
        derivatives: ``differences``, or ``fourier``.

    Raises:
        KernelArgumentError: Another name, or a system without fields.
    """
    if derivatives == "lattice":
        raise KernelArgumentError(
            f"{system.name} is asked for as a lattice of bodies, which is another system, with "
            "attitudes in its state; expected 'differences' or 'fourier'. Load its spec as one, "
            f"coadjoint.load(path, derivatives='lattice'), or write its spec, "
            f"coadjoint new NAME --lattice-of {system.name}.",
            found=derivatives,
            expected=["differences", "fourier"],
        )
    if derivatives not in ("differences", "fourier"):
        raise KernelArgumentError(
            f"derivatives are {derivatives!r}; expected 'differences' or 'fourier'.",
            found=str(derivatives),
            expected=["differences", "fourier"],
        )
    own = system.differences if isinstance(system, SpectralSystem) else system
    if derivatives == "differences":
        if isinstance(own, FamilySystem) and own is not system and own.index.size is not None:
            check_least(own.name, own.index.name, own.size, own.small)
        return own
    if not isinstance(own, FamilySystem) or own.spectral is None:
        raise KernelArgumentError(
            f"{system.name} has no fields along a circle, of which there are Fourier derivatives; "
            "expected derivatives='differences', or a spec with [space].",
            found=derivatives,
            expected=["differences"],
        )
    return SpectralSystem(own)


def check_means(system: FamilySystem, state: Array) -> None:
    """The mean of a momentum is 0 where it is A u with an A that takes constants to 0.

    Raises:
        KernelArgumentError: It is not.
    """
    for u, m in list_mean_zero(system):
        fields = state.reshape(len(system.own_state), system.size, -1)
        require_mean_zero(system, u, m, fields[system.own_state.index(m)])


def list_mean_zero(system: FamilySystem) -> list[tuple[str, str]]:
    """Fields u and momenta m = A u whose mean is 0, since A takes constants to 0."""
    solved = {} if system.spectral is None else system.spectral.solved
    return [(u, m) for u, (m, factors) in solved.items() if 0 not in factors]


def require_mean_zero(system: System, u: str, m: str, field: Array) -> None:
    """The mean of a momentum ``m = A u`` is 0, where A takes constants to 0.

    Args:
        system: Whose fields they are.
        u: The field that m is made of.
        m: The momentum.
        field: Its values, shape ``(N, members)``.

    Raises:
        KernelArgumentError: It is not.
    """
    means, sizes = np.mean(field, axis=0), np.max(np.abs(field), axis=0)
    if (np.abs(means) > MEAN * sizes).any():
        mean = float(means[np.argmax(np.abs(means) - MEAN * sizes)])
        raise KernelArgumentError(
            f"the mean of {m} of {system.name} is {mean:.6g} at the beginning; expected 0, "
            f"since {m} is made of derivatives of {u}. Subtract the mean.",
            found=mean,
            expected=0.0,
        )


def warn_of_jump(system: System, request: Request) -> None:
    """Say how far a field jumps at the ends of the circle, if it does at the beginning."""
    if not isinstance(system, SpectralSystem):
        return
    names, size = system.own_state, system.size
    fields = request.state.reshape(len(names), size, -1)
    for name, field in zip(names, fields, strict=True):
        jump = find_jump(field)
        if jump:
            warnings.warn(
                f"the field {name} of {system.name} jumps by {jump:.3g} from the last point to the "
                "first one: it is not periodic, and Fourier derivatives of it oscillate along the "
                "whole circle. Begin with periodic fields, or take derivatives='differences'.",
                PeriodicityWarning,
                stacklevel=4,
            )


def find_jump(field: Array) -> float:
    """By how much a field ``(N, trajectories)`` misses its first value, seen from its last points.

    Straight on from two points each value is foreseen; 0 where that is no worse at the ends than
    elsewhere.
    """
    misses = np.abs(field - 2 * np.roll(field, 1, axis=0) + np.roll(field, 2, axis=0))
    across, within = misses[:2].max(axis=0), misses[2:].max(axis=0)
    is_jump = (across > STEEP * within) & (across > SMALL * np.abs(field).max(axis=0))
    return float(np.max(np.where(is_jump, np.abs(field[0] - 2 * field[-1] + field[-2]), 0.0)))
