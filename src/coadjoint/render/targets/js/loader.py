"""The target JavaScript, loading: ``kernel.js`` in an engine inside this process, if there is one.

Comes in: a System, and checked arrays. Goes out: results in place. Numbers cross as the bytes of
doubles, since JSON has neither NaN nor the sign of zero.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, Final

import numpy as np

from coadjoint.errors import OutputError, system_error
from coadjoint.render.targets.protocol import Call, Generated, Kernel

#: Evaluates a function for all members: arrays come and go as hexadecimal digits.
DRIVER: Final = """
function _decode(text) {
  const bytes = new Uint8Array(text.length / 2);
  for (let n = 0; n < bytes.length; n++) bytes[n] = parseInt(text.substr(2 * n, 2), 16);
  return new Float64Array(bytes.buffer);
}
function _evaluate(called, texts, shared, members, rows) {
  const arrays = texts.map(_decode), out = new Float64Array(rows);
  const all = new Float64Array(rows * members);
  for (let m = 0; m < members; m++) {
    const given = arrays.map((each, k) =>
      shared[k] ? each : each.subarray(m * each.length / members, (m + 1) * each.length / members));
    called(...given, out.fill(0));
    all.set(out, m * rows);
  }
  return Array.from(new Uint8Array(all.buffer), (b) => b.toString(16).padStart(2, "0")).join("");
}
"""


def load(system: Generated, build: str, reference: Callable[[], Any]) -> ScriptKernel:
    """The kernel of a System in JavaScript.

    Raises:
        OutputError: The file cannot be read, or there is no engine.
    """
    return ScriptKernel(system)


class ScriptKernel(Kernel):
    """The kernel of a System in JavaScript, in an engine of its own.

    Args:
        system: Whose folder holds ``kernel.js``.
    """

    def __init__(self, system: Generated) -> None:
        path = system.folder / "kernel.js"
        try:
            from py_mini_racer import MiniRacer
        except ImportError as error:
            raise OutputError(
                "no engine of JavaScript can be imported; expected that of the package mini-racer. "
                "Install it: pip install mini-racer",
                found="py_mini_racer",
            ) from error
        try:
            content = path.read_bytes()
        except OSError as error:
            raise system_error(error) or OutputError(
                f"{path} cannot be read: {error}. `coadjoint explore` writes it into its page; "
                "this target reads it from the folder of the system.",
                path=str(path),
            ) from error
        self.source = hashlib.sha256(content).hexdigest()
        self._engine = MiniRacer()
        self._engine.eval(content.decode() + DRIVER)

    def calls(self, function: str, call: Call) -> Iterator[Callable[[], Any]]:
        """One call for all members."""
        yield partial(self._evaluate, function, call)

    def _evaluate(self, function: str, call: Call) -> None:
        """Evaluate all members."""
        given = [np.ascontiguousarray(each.T, "<f8") for each in call.given.values()]
        shared = [each.ndim == 1 for each in given]
        rows = int(np.prod(call.block.shape[:-1], dtype=int))
        arguments = json.dumps([[each.tobytes().hex() for each in given], shared])
        text = self._engine.eval(f"_evaluate({function}, ...{arguments}, {call.members}, {rows})")
        found = np.frombuffer(bytes.fromhex(str(text)), "<f8").reshape(call.members, rows)
        call.block[...] = found.T.reshape(call.block.shape)
