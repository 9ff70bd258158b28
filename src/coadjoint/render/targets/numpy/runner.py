"""The target NumPy, running: a function of ``kernel.py`` in three parts on arrays.

Comes in: a function as `coadjoint.render.targets.numpy.arrange` has it, and checked arrays. Goes
out: results in place. What members share is computed once for the same parameters.
Read next: `coadjoint.render.targets.numpy.loader`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextvars import Context
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from coadjoint.render.targets.protocol import FEW

if TYPE_CHECKING:
    from coadjoint.render.targets.numpy.arrange import Arranged
    from coadjoint.render.targets.protocol import Array, Buffer, Evaluate

#: Where NumPy says nothing of NaN and infinities, which are results here as in C. To run in a copy
#: of it takes a tenth of the time of `numpy.errstate`.
_QUIET: Final = Context()
_QUIET.run(np.seterr, all="ignore")


class _Shared(NamedTuple):
    """What members share: the bits that it follows from, as numbers, and as arrays without axes."""

    bits: bytes
    numbers: list[float]
    arrays: list[Any]


class Runner:
    """A function, what members share and rows to write to, as they were at the last call.

    Args:
        arranged: The function.
        chunk: So many members are evaluated at a time.
    """

    def __init__(self, arranged: Arranged, chunk: int) -> None:
        self._arranged, self._chunk = arranged, chunk
        # Both are replaced as a whole, so that threads may call at a time.
        self._known = _Shared(b"?", [], [])
        self._spare: dict[int, list[Array]] = {}

    def run(self, state: Array, *given: Array, out: Array) -> None:
        """Evaluate members, given ``(n, N)``, shared arrays ``(k,)`` and a result ``(rows, N)``."""
        if state.shape[1] == 1:
            self._run_single(state, self._share(given), out)
        else:
            _QUIET.copy().run(self._run_many, state, self._share(given).arrays, out)

    def evaluate_with(self, known: Array, driving: Sequence[Array]) -> Evaluate:
        """A function of members, state, parameters or None for known ones, and result.

        Parameters that are the same object as at the last call are the same numbers.
        """
        last: tuple[Buffer | None, _Shared] = (None, self._share((known, *driving)))

        def evaluate(members: int, state: Array, parameters: Buffer | None, out: Array) -> None:
            nonlocal last
            seen, shared = last
            if parameters is not seen:
                shared = self._share((known if parameters is None else parameters, *driving))
                last = parameters, shared
            if members == 1:
                self._run_single(state, shared, out)
            else:
                rows = out if out.ndim == 2 else out.reshape(-1, members)
                _QUIET.copy().run(self._run_many, state, shared.arrays, rows)

        return evaluate

    def _run_single(self, state: Array, shared: _Shared, out: Array) -> None:
        """Evaluate a member, over numbers of Python, which have no quotient by zero."""
        numbers, results = state.ravel().tolist(), out.reshape(-1)
        try:
            _QUIET.copy().run(self._arranged.single, numbers, shared.numbers, results)
        except (ZeroDivisionError, ValueError):
            of_one = state.reshape(-1, 1), shared.arrays, out.reshape(-1, 1)
            _QUIET.copy().run(self._run_many, *of_one)

    def _run_many(self, state: Array, shared: Sequence[Any], out: Array) -> None:
        """Evaluate as many members at a time as stay in the cache."""
        members, evaluate = state.shape[1], self._arranged.many
        if members <= FEW:
            rows = self._spare.pop(members, None)
            if rows is None:
                rows = self._make_rows(members)
            evaluate(state, shared, out, rows)
            self._spare = {members: rows}
            return
        rows = self._make_rows(min(members, self._chunk))
        for first in range(0, members, self._chunk):
            chunk = slice(first, first + self._chunk)
            if members - first < self._chunk:
                rows = [row[: members - first] for row in rows]
            evaluate(state[:, chunk], shared, out[:, chunk], rows)

    def _make_rows(self, members: int) -> list[Array]:
        """Rows to write to."""
        return list(np.empty((self._arranged.rows, members)))

    def _share(self, given: Sequence[Array | Buffer]) -> _Shared:
        """What members share."""
        bits = b"".join([each.tobytes() for each in given])
        known = self._known
        if known.bits != bits:
            numbers = _QUIET.copy().run(_evaluate_shared, self._arranged.share, given)
            known = self._known = _Shared(bits, numbers, list(map(np.array, numbers)))
        return known


def _evaluate_shared(
    share: Callable[..., list[float]], given: Sequence[Array | Buffer]
) -> list[float]:
    """What members share."""
    try:
        values = share(*(each.tolist() for each in given))
    except ZeroDivisionError:  # NumPy's numbers have a quotient by zero
        values = share(*(np.array(each) for each in given))
    return list(map(float, values))
