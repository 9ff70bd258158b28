"""Errors of every step: one base, and a few children named for what the user did.

The parts of a message stay on the exception as keyword attributes, so that a caller or a test reads
them without parsing text, and so that an error raised in a child process arrives whole in the
parent (`as_record` and `from_record`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar


class CoadjointError(Exception):
    """Something this package refuses or found wrong; ``str(error)`` is the whole message.

    Args:
        message: What was found, what was expected, and the likely fix.
        parts: The pieces of the message by name, plain JSON values only.
    """

    #: Exit status of a command that ends with this error: 2 for wrong input, 1 for a failed check,
    #: 70 for a fault of our own.
    exit_status: ClassVar[int] = 2

    def __init__(self, message: str, **parts: Any) -> None:
        super().__init__(message)
        self.parts = parts

    def __getattr__(self, name: str) -> Any:
        try:
            return self.__dict__["parts"][name]
        except KeyError:
            raise AttributeError(name) from None

    def as_record(self) -> dict[str, Any]:
        """The error as plain JSON values, for the way from a child process to its parent."""
        return {"kind": type(self).__name__, "message": str(self), "parts": self.parts}


class SpecError(CoadjointError):
    """A spec is not what a spec may be: unreadable, unknown key, wrong type, bad expression."""


class LimitError(SpecError):
    """A spec asks for more than the stated limits allow (docs/limits.md)."""


class AlgebraError(CoadjointError):
    """Declared brackets or matrices do not make a Lie algebra or a representation."""


class DerivationError(CoadjointError):
    """A spec is well formed, but its equations cannot be derived by the route asked for."""


class ClaimError(CoadjointError):
    """A claim of a spec was refuted; the message shows the counter-example point."""

    exit_status = 1


class CrossCheckError(CoadjointError):
    """A rung of the ladder failed: two forms of one function disagree."""

    exit_status = 1


class DriftError(CoadjointError):
    """The checked-in generated tree differs from a fresh one."""

    exit_status = 1


class OutputError(CoadjointError):
    """A result could not be written; what stood there before is untouched."""


class CompilerError(CoadjointError):
    """A compiler is missing, refused, failed, or made a kernel that computes something else."""


class KernelArgumentError(CoadjointError, ValueError):
    """An array or parameter handed to a kernel has the wrong shape, order, name or aliasing."""


class KernelTypeError(CoadjointError, TypeError):
    """An array or parameter handed to a kernel has a type that cannot be converted without loss."""


class ResourceError(CoadjointError):
    """A bounded child process ran out of its time or memory."""


class InternalError(CoadjointError):
    """A fault of coadjoint itself, found in a child process; please report it."""

    exit_status = 70


def from_record(record: Mapping[str, Any]) -> CoadjointError:
    """The error that `CoadjointError.as_record` described; unknown kinds become the base."""
    kinds = {kind.__name__: kind for kind in _family(CoadjointError)}
    kind = kinds.get(record["kind"], CoadjointError)
    return kind(record["message"], **record["parts"])


def _family(kind: type[CoadjointError]) -> list[type[CoadjointError]]:
    """A class and all its descendants."""
    return [kind, *(member for child in kind.__subclasses__() for member in _family(child))]
