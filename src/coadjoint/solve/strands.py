r"""Group elements along a strand: what its strains turn into, and the holonomy of a circle.

A strain is :math:`\Xi = g^{-1} \partial_s g`, or :math:`(\partial_s g) g^{-1}` where the motion is
right invariant. So :math:`\psi(s) = g(0)^{-1} g(s)` solves :math:`\partial_s \psi = \psi\, \Xi`, or
:math:`\psi(s) = g(s) g(0)^{-1}` solves :math:`\partial_s \psi = \Xi\, \psi`, both from 1. After the
length L this is the holonomy M. Zero curvature makes :math:`\partial_t M = [M, \Omega(0)]`, so that
the trace of each power of M is an integral: exactly of the fields, and of N points up to the order
of their differences.

Between two points the field is that of its Fourier series, and the step is Magnus's of order 6 at
three points of Gauss. For the matrices of a group it is in the group but for rounding.
Comes in: a Solution of a strand, or matrices at points. Goes out: matrices of the group.
Read next: `coadjoint.solve.solution`.

Source:
    Blanes, Casas, Oteo and Ros, Physics Reports 470 (2009) 151, section 5.4.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from coadjoint.errors import KernelArgumentError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from coadjoint.solve.solution import Solution

    Array = NDArray[np.float64]

#: Gauss's points in a step of length 1.
NODES: Final = (0.5 - 15**0.5 / 10, 0.5, 0.5 + 15**0.5 / 10)


def find_frames(solution: Solution) -> Array:
    """The group elements at all points of a strand by that at its first point.

    Returns:
        ``(n, n, N + 1, *batch, T)``: at s = 0, L/N, ..., L; the last one is the holonomy.

    Raises:
        KernelArgumentError: The system is no strand, or has no matrices.
    """
    system = solution.system
    strand = system.strand
    if strand is None:
        raise KernelArgumentError(
            f"{system.name} has no strain along an algebra of matrices of numbers; expected a "
            "strand, whose strain is turned into group elements. Declare the strain with [space], "
            'role = "strain", on an algebra by name or by matrices.',
            found=system.name,
            expected="a strand",
        )
    strains = solution[strand.name]  # (k, N, *batch, T)
    place = list(system.PARAMETERS.components).index(strand.length)
    length = solution.parameters[place]
    if solution.batch and np.ndim(length):
        length = length[..., np.newaxis]
    generators = np.zeros((len(strand.matrices), strand.size, strand.size))
    for generator, entries in zip(generators, strand.matrices, strict=True):
        for row, column, value in entries:
            generator[row, column] = value
    return transport(np.tensordot(generators, strains, axes=(0, 0)), length, strand.side)


def transport(connection: Array, length: Any, side: str = "left") -> Array:
    """The solution of ``dpsi/ds = psi X``, or of ``X psi`` on the right, from 1 along a circle.

    Args:
        connection: X at N equally spaced points of the circle, ``(n, n, N, ...)``.
        length: Of the circle; a number, or an array over the last axes.
        side: ``left`` or ``right``: on which side psi stands.

    Returns:
        ``(n, n, N + 1, ...)``.

    >>> turning = np.zeros((2, 2, 8))
    >>> turning[0, 1], turning[1, 0] = -1, 1
    >>> bool(np.allclose(transport(turning, 2 * np.pi)[..., -1], np.eye(2)))
    True
    """
    count = connection.shape[2]
    points = np.moveaxis(connection, (0, 1, 2), (-2, -1, 0))  # (N, ..., n, n)
    if side == "left":
        points = np.swapaxes(points, -1, -2)  # the transpose of psi stands on the right
    h = np.asarray(length)[..., np.newaxis, np.newaxis] / count
    steps = _exponentiate(_magnus([h * _shift(points, node) for node in NODES]))
    frames = np.empty((count + 1, *points.shape[1:]))
    frames[0] = np.eye(points.shape[-1])
    for n, step in enumerate(steps):
        frames[n + 1] = step @ frames[n]
    if side == "left":
        frames = np.swapaxes(frames, -1, -2)
    return np.moveaxis(frames, (-2, -1, 0), (0, 1, 2))


def _shift(points: Array, part: float) -> Array:
    """A field on a circle, a part of a step further on, by its Fourier series."""
    from scipy import fft

    count = len(points)
    waves = np.exp(2j * np.pi * part * np.arange(count // 2 + 1) / count)
    waves = waves.reshape(-1, *[1] * (points.ndim - 1))
    shifted: Array = fft.irfft(fft.rfft(points, axis=0) * waves, n=count, axis=0)
    return shifted


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
