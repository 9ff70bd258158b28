r"""Group elements along a strand: what its strains turn into, and the holonomy.

A strain is :math:`\Xi = g^{-1} \partial_s g`, or :math:`(\partial_s g) g^{-1}` where the motion is
right invariant. So :math:`\psi(s) = g(0)^{-1} g(s)` solves :math:`\partial_s \psi = \psi\, \Xi`, or
:math:`\psi(s) = g(s) g(0)^{-1}` solves :math:`\partial_s \psi = \Xi\, \psi`, both from 1. After the
length L this is the holonomy M. Zero curvature makes :math:`\partial_t M = [M, \Omega(0)]`, so that
the trace of each power of M is an integral: exactly of the fields, and of N points up to the order
of their differences.

The first point itself moves by :math:`g^{-1} \partial_t g = \Omega`, or by
:math:`(\partial_t g) g^{-1}`, from 1 at the first sample on: by the same steps over time, with the
polynomial through the six nearest samples, so that its error falls with the sixth power of their
distance. Then :math:`g(s, t) = g(0, t) \psi(s, t)`, or :math:`\psi(s, t)\, g(0, t)`.

Between two points of a circle the field is that of its Fourier series, and on a line with ends the
polynomial through the six nearest points. The step is Magnus's of order 6 at three points of Gauss.
For the matrices of a group it is in the group but for rounding. Between ends M turns with both,
:math:`\partial_t M = M\,\Omega(L) - \Omega(0)\,M`, and stands still where they are clamped.
The same holds of L of a Lax pair of fields for each number in the place of its spectral parameter.
Comes in: a Solution of fields along a line, or matrices at points. Goes out: transports, traces.
Read next: `coadjoint.solve.solution`.

Source:
    Blanes, Casas, Oteo and Ros, Physics Reports 470 (2009) 151, section 5.4.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, cast

import numpy as np

from coadjoint.errors import KernelArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from coadjoint.array_types import Array
    from coadjoint.families import Connection
    from coadjoint.solve.family import FamilySystem
    from coadjoint.solve.solution import Solution

#: Points of the polynomial that stands for a field between ends.
NEAREST: Final = 6
#: Samples between which the first point of a strand is followed, at the least.
FEWEST: Final = 2
#: Gauss's points in a step of length 1.
NODES: Final = (0.5 - 15**0.5 / 10, 0.5, 0.5 + 15**0.5 / 10)


def find_frames(solution: Solution, *, moving: bool = False) -> Array:
    """The group elements at all points of a strand by that at its first point.

    Args:
        solution: Of a strand.
        moving: Whether the first point moves from 1 at the first sample on, and with it the others.

    Returns:
        ``(n, n, N + 1, *batch, T)``: at s = 0, L/N, ..., L of a circle, and
        ``(n, n, N, *batch, T)`` at the N points between ends. The last one is the holonomy.

    Raises:
        KernelArgumentError: The system is no strand, or has no matrices.
    """
    system = solution.system
    strands = [each for each in system.connections if each.name in system.STATE]
    if not strands:
        raise KernelArgumentError(
            f"{system.name} has no strain along an algebra of matrices of numbers; expected a "
            "strand, whose strain is turned into group elements. Declare the strain with [space], "
            'role = "strain", on an algebra by name or by matrices.',
            found=system.name,
            expected="a strand",
        )
    (strand,) = strands
    along = _find_transports(solution, strand)
    return move(find_first(solution, strand), along, strand.side) if moving else along


def find_first(solution: Solution, strand: Connection) -> Array:
    """The group element at the first point of a strand, from 1 at the first sample on.

    Args:
        solution: Of a strand.
        strand: Its strain.

    Returns:
        ``(n, n, *batch, T)``.

    Raises:
        KernelArgumentError: Its velocity does not follow from the state, or there is one sample.
    """
    system = solution.system
    if not strand.velocity:
        raise KernelArgumentError(
            f"velocities of {system.name} are no functions of its momenta and strains; expected "
            "moving=False.",
            found=True,
            expected=False,
        )
    if len(solution) < FEWEST:
        raise KernelArgumentError(
            f"the solution has the number of samples {len(solution)}; expected at least {FEWEST}, "
            "between which the first point is followed. Ask simulate for more samples.",
            found=len(solution),
            expected=FEWEST,
        )
    velocity = _evaluate(solution, strand, strand.velocity)[:, :, 0]
    first = _follow(np.moveaxis(velocity, -1, 2), solution.time, strand.side)
    return np.moveaxis(first, 2, -1)


def move(first: Array, along: Array, side: str) -> Array:
    """All points of a strand as the first one has moved, which `find_first` finds."""
    factors = (first[:, :, np.newaxis], along)
    product: Array = np.einsum("ij...,jk...->ik...", *factors[:: 1 if side == "left" else -1])
    return product


def find_traces(solution: Solution) -> dict[str, Array]:
    """The traces of the holonomies of all connections, ``(*batch, T)`` each, by their names.

    Raises:
        KernelArgumentError: The system has none around a circle.
    """
    system = solution.system
    if any(each.has_ends for each in system.connections):
        raise KernelArgumentError(
            f"{system.name} has ends, between which the trace of the holonomy is not conserved; "
            "expected fields around a circle. The holonomy itself is solution.frames()[:, :, -1].",
            found=system.name,
            expected="fields around a circle",
        )
    if not system.connections:
        raise KernelArgumentError(
            f"{system.name} has no connection around a circle; expected a strand, or a Lax pair of "
            "fields with values of its spectral parameter. Declare a strain on an algebra of "
            "matrices, or write values = [0.5] in [lax].",
            found=system.name,
            expected="a connection",
        )
    return {
        each.name: np.trace(_find_transports(solution, each)[:, :, -1])
        for each in system.connections
    }


def _find_transports(solution: Solution, connection: Connection) -> Array:
    """The transports of a connection, by the texts of its entries."""
    matrix = _evaluate(solution, connection, connection.entries)
    length = _name_parameters(solution)[connection.length]
    return transport(matrix, length, connection.side, has_ends=connection.has_ends)


def _name_parameters(solution: Solution) -> dict[str, Any]:
    """The components of parameters, with an axis for samples where there are several members."""
    rows = [solution.parameters[n] for n in range(solution.system.PARAMETERS.size)]
    if solution.batch:
        rows = [row[..., np.newaxis] if np.ndim(row) else row for row in rows]
    return dict(zip(solution.system.PARAMETERS.components, rows, strict=True))


def _evaluate(
    solution: Solution, connection: Connection, entries: Mapping[tuple[int, int], str]
) -> Array:
    """A matrix at all points and samples, ``(n, n, N, *batch, T)``, by the texts of its entries."""
    from coadjoint.solve.formulas import Formula  # it reads specs, which few runs need

    system, shape = cast("FamilySystem", solution.system), (*solution.batch, len(solution))
    known, own = _name_parameters(solution), system.size
    known |= zip(system.own_state, solution.state.reshape(-1, own, *shape), strict=True)
    matrix = np.zeros((connection.size, connection.size, own, *shape))
    for place, text in entries.items():
        formula = Formula(text, dict.fromkeys(known, ()), "an entry of a connection")
        flat = {x: np.broadcast_to(known[x], (own, *shape)).reshape(-1) for x in formula.names}
        value, _ = formula.evaluate(flat)
        matrix[place] = np.broadcast_to(value, (matrix[place].size,)).reshape(own, *shape)
    return matrix


def transport(
    connection: Array, length: Any, side: str = "left", *, has_ends: bool = False
) -> Array:
    """The solution of ``dpsi/ds = psi X``, or of ``X psi`` on the right, from 1 along a line.

    Args:
        connection: X at N equally spaced points of the circle, ``(n, n, N, ...)``.
        length: Of the circle; a number, or an array over the last axes.
        side: ``left`` or ``right``: on which side psi stands.
        has_ends: Whether the first and the last point are ends of a line of this length.

    Returns:
        ``(n, n, N + 1, ...)``, or ``(n, n, N, ...)`` between ends.

    >>> turning = np.zeros((2, 2, 8))
    >>> turning[0, 1], turning[1, 0] = -1, 1
    >>> bool(np.allclose(transport(turning, 2 * np.pi)[..., -1], np.eye(2)))
    True
    """
    points = np.moveaxis(connection, (0, 1, 2), (-2, -1, 0))  # (N, ..., n, n)
    count = len(points) - has_ends
    h = np.asarray(length)[..., np.newaxis, np.newaxis] / count
    places = np.arange(len(points), dtype=float)
    nodes = [_interpolate(points, places, x) if has_ends else _shift(points, x) for x in NODES]
    return _multiply([h * node for node in nodes], side)


def _follow(velocity: Array, times: Array, side: str) -> Array:
    """The solution of ``dg/dt = g Omega``, or of ``Omega g`` on the right, from 1 at times.

    Args:
        velocity: Omega at these times, ``(n, n, T, ...)``.
        times: T of them, which grow.
        side: As of `transport`.
    """
    points = np.moveaxis(velocity, (0, 1, 2), (-2, -1, 0))
    h = np.diff(times).reshape(-1, *[1] * (points.ndim - 1))
    return _multiply([h * _interpolate(points, times, node) for node in NODES], side)


def _multiply(nodes: list[Array], side: str) -> Array:
    """Products of steps from 1 on, ``(n, n, steps + 1, ...)``, of what `find_steps` takes."""
    if side == "left":
        nodes = [np.swapaxes(x, -1, -2) for x in nodes]  # the transpose of psi is on the right
    steps = find_steps(nodes)
    frames = np.empty((len(steps) + 1, *steps.shape[1:]))
    frames[0] = np.eye(steps.shape[-1])
    for n, step in enumerate(steps):
        frames[n + 1] = step @ frames[n]
    if side == "left":
        frames = np.swapaxes(frames, -1, -2)
    return np.moveaxis(frames, (-2, -1, 0), (0, 1, 2))


def find_steps(nodes: list[Array]) -> Array:
    """Solutions of ``dpsi/ds = X psi`` over steps from 1, by Magnus's expansion of order 6.

    Args:
        nodes: X at each of `NODES`, times the length of the step, ``(..., n, n)`` each.
    """
    return _exponentiate(_magnus(nodes))


def _shift(points: Array, part: float) -> Array:
    """A field on a circle, a part of a step further on, by its Fourier series."""
    from scipy import fft

    count = len(points)
    waves = np.exp(2j * np.pi * part * np.arange(count // 2 + 1) / count)
    waves = waves.reshape(-1, *[1] * (points.ndim - 1))
    shifted: Array = fft.irfft(fft.rfft(points, axis=0) * waves, n=count, axis=0)
    return shifted


def _interpolate(points: Array, places: Array, part: float) -> Array:
    """What has values at places, a part of a step behind each but the last, by polynomials."""
    steps, width = len(points) - 1, min(NEAREST, len(points))
    first = np.clip(np.arange(steps) - width // 2 + 1, 0, len(points) - width)
    place = places[:-1] + part * np.diff(places)
    found = np.zeros((steps, *points.shape[1:]))
    for k in range(width):
        own, others = places[first + k], [places[first + m] for m in range(width) if m != k]
        weight = np.prod([(place - x) / (own - x) for x in others], axis=0)
        found += np.reshape(weight, (-1, *[1] * (points.ndim - 1))) * points[first + k]
    return found


def _magnus(nodes: list[Array]) -> Array:
    """The exponent of a step of order 6, of the matrices at Gauss's points times its length."""
    first, middle, last = nodes
    a, b = middle, 15**0.5 / 3 * (last - first)
    c = 10 / 3 * (last - 2 * middle + first)
    one = _commute(a, b)
    two = _commute(a, 2 * c + one) / -60
    return a + c / 12 + _commute(-20 * a - c + one, b + two) / 240


def _commute(a: Array, b: Array) -> Array:
    return a @ b - b @ a


def _exponentiate(exponents: Array) -> Array:
    from scipy.linalg import expm

    found: Array = expm(exponents)
    return found
