r"""Torus: a field at points of a plane that closes in both directions, by truncated Fourier series.

The waves up to :math:`K = \lfloor (N - 1)/3 \rfloor` along each coordinate move, so that products
of two fields have no false ones among them. SciPy transforms; between its transforms the generated
kernels compute what is to be computed at each point, in C or in NumPy, from derivatives that they
take as parameters. Python leads the steps.

A state has the values at points ``(N_x, N_y)``, those along the second coordinate next to each
other; a row is called ``w[3,5]``. Waves of a state beyond K do not move and are not seen.
Comes in: the declarations of a generated package. Goes out: a System.
Read next: `coadjoint.solve.plane_waves`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import product
from math import prod
from typing import TYPE_CHECKING, Any

from coadjoint.errors import KernelArgumentError
from coadjoint.families import LEAST_IN_PLANE
from coadjoint.sizes import MOVES, check_least
from coadjoint.solve.family import BY_WAVES, FamilySystem

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from coadjoint.declared import Quantity
    from coadjoint.families import Torus
    from coadjoint.solve.kernels import Kernels
    from coadjoint.solve.system import System


class TorusSystem(FamilySystem):
    """A field at points of a plane.

    Args:
        declared: What a `FamilySystem` takes, of points that do not see each other.
        torus: What is computed around them.
        given: What else a `FamilySystem` takes.

    Attributes:
        counts: How many points there are along both coordinates.
        around: What is computed around the points.
    """

    derivatives = "fourier"
    obstacle = "its derivatives are those of Fourier series, between which Python leads the steps"

    def __init__(self, *declared: Any, torus: Torus, **given: Any) -> None:
        self.torus, self.around = torus, torus
        self.counts = tuple(size or LEAST_IN_PLANE for size in torus.sizes)
        super().__init__(*declared, **given)
        self._points = FamilySystem(*declared, **(given | {"profiles": None}))
        self.PARAMETERS = self._declared[1]
        self.functions = {name: self.functions[name] for name in BY_WAVES}

    @property
    def counted_by(self) -> str:
        """The names of both coordinates."""
        return " and ".join(self.around.coordinates)

    @property
    def points(self) -> FamilySystem:
        """What generated kernels compute: each point, with the derivatives there as parameters."""
        return self._points

    def resize(self, sizes: Mapping[str, int]) -> TorusSystem:
        """The field at another number of points.

        Args:
            sizes: The numbers by the coordinates: ``{"x": 64, "y": 64}``.

        Raises:
            KernelArgumentError: Other coordinates, or too few points.
            ResourceError: So many points do not fit into memory.
        """
        names = self.around.coordinates
        own = dict(zip(names, self.around.sizes, strict=True)) | dict(sizes)
        if not {*sizes} <= {*names} or None in own.values():
            raise KernelArgumentError(
                f"sizes of {self.name} are {dict(sizes)!r}; expected a number of points for each "
                f"of {' and '.join(names)}. Choose them, sizes={dict.fromkeys(names, 64)!r}.",
                found=list(sizes),
                expected=list(names),
            )
        for name, size in own.items():
            check_least(self.name, name, size, LEAST_IN_PLANE, MOVES)
        old = self.around
        torus = type(old)(
            old.coordinates, old.lengths, tuple(own.values()), old.derivatives, old.solved
        )
        whole = prod(own[name] or 0 for name in names)
        return self._copy(replace(self.index, size=whole), torus=torus)

    def _repeat(self, quantity: Quantity, size: int) -> Quantity:
        """A quantity of a point as one of all points."""
        repeated = super()._repeat(quantity, size)
        places = [f"{i},{j}" for i in range(self.counts[0]) for j in range(self.counts[1])]
        components = tuple(f"{c}[{place}]" for c in quantity.components for place in places)
        return replace(repeated, shape=(*quantity.shape, *self.counts), components=components)

    def find_coordinates(self, parameters: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Where points stand along both coordinates, ``(Nx,)`` and ``(Ny,)``."""
        import numpy as np

        around, found = self.around, {}
        for name, length, size in zip(around.coordinates, around.lengths, self.counts, strict=True):
            lengths = np.unique(parameters[self.PARAMETERS.rows(length)])
            if len(lengths) != 1:
                return {}
            found[name] = np.arange(size) * float(lengths[0]) / size
        return found

    def _list_places(self, lengths: Sequence[float]) -> Iterator[tuple[float, ...]]:
        """The coordinates of all points, along the second coordinate first."""
        steps = [range(size) for size in self.counts]
        for place in product(*steps):
            parts = zip(place, lengths, self.counts, strict=True)
            yield tuple(n * length / size for n, length, size in parts)

    def with_derivatives(self, derivatives: str) -> TorusSystem:
        """Itself: a plane has Fourier derivatives alone.

        Raises:
            KernelArgumentError: The derivatives have another name than `System` knows.
        """
        if derivatives not in ("differences", "fourier"):
            raise KernelArgumentError(
                f"derivatives are {derivatives!r}; expected 'fourier', which a plane has alone.",
                found=str(derivatives),
                expected=["fourier"],
            )
        return self

    @cached_property
    def _kernels(self) -> Kernels:
        from coadjoint.solve.plane_waves import TorusKernels  # which reads formulas

        return TorusKernels(self)

    def __reduce__(self) -> tuple[Callable[..., System], tuple[Any, ...]]:
        """Pickled by reference, and its sizes."""
        resized, (find, given, _) = super().__reduce__()
        return resized, (find, given, dict(zip(self.around.coordinates, self.counts, strict=True)))

    def __repr__(self) -> str:
        state, parameters = (", ".join(each) for each in (self.STATE, self.PARAMETERS))
        points = " x ".join(map(str, self.counts))
        return f"<System {self.name}: {points} points; state {state}; parameters {parameters}>"
