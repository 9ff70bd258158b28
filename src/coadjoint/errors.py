"""Errors of every step: one base, and a few children named for what the user did.

A message is plain text of at most a screen, whatever a spec has put into it: characters that a
terminal would obey are shown as escapes (`plain`). The parts of a message stay on the exception as
keyword attributes, so that a caller or a test reads them without parsing text, and so that an error
raised in a child process arrives whole in the parent (`as_record` and `from_record`).
"""

from __future__ import annotations

import errno
import os
import re
import resource
from collections.abc import Mapping
from typing import Any, ClassVar, Final

from coadjoint.limits import MESSAGE_ROWS

#: Columns of the narrowest usual terminal.
_COLUMNS: Final = 80
#: Rows of the end of a message that are kept where its middle is left out: the likely fix.
_LAST_ROWS: Final = 6


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
        super().__init__(shorten(plain(message)))
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
    """A claim of a spec was refuted; the message shows the counterexample point."""

    exit_status = 1


class CrossCheckError(CoadjointError):
    """A rung of the ladder failed: two forms of one function disagree."""

    exit_status = 1

    @classmethod
    def on(cls, rung: int, system: str, message: str, **parts: Any) -> CrossCheckError:
        """The failure of a rung, on which nothing that a person writes may fail."""
        return cls(
            f"rung {rung}: {system}: {message}. This is a fault of coadjoint, please report it.",
            rung=rung,
            system=system,
            **parts,
        )


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
    """A bounded child process ran out of its time or memory, or was promised no proper amount."""


class InternalError(CoadjointError):
    """A fault of coadjoint itself, found in a child process; please report it."""

    exit_status = 70


def plain(text: str) -> str:
    r"""Text for a terminal: what it would obey is shown as an escape; line ends stay.

    >>> plain("a title \x1b]0;owned\x07")
    'a title \\x1b]0;owned\\x07'
    """
    if text.isascii() and text.replace("\n", "").isprintable():
        return text
    return "".join(
        c if c.isprintable() or c == "\n" else " " if c == "\t" else ascii(c)[1:-1] for c in text
    )


def make_printable(text: str) -> str:
    r"""Text without control characters, which a terminal would obey.

    >>> make_printable("a\x1b[2Jb\nc")
    'a [2Jb c'
    """
    return "".join(character if character.isprintable() else " " for character in text)


def shorten(text: str) -> str:
    """A message of at most a screen; of a longer one, the middle is left out."""
    rows = [
        row
        for line in text.split("\n")
        for row in _rows(line + "\n")  # each end of line stays with the last row of its line
    ]
    if len(rows) <= MESSAGE_ROWS:
        return text
    first = MESSAGE_ROWS - _LAST_ROWS - 1
    return "".join(rows[:first]).rstrip() + "\n[...]\n" + "".join(rows[-_LAST_ROWS:]).strip()


def _rows(line: str) -> list[str]:
    """A line, its end included, as rows of a terminal."""
    return [line[n : n + _COLUMNS] for n in range(0, max(1, len(line) - 1), _COLUMNS)]


#: What the operating system refuses for reasons outside coadjoint, and what helps.
_REFUSALS: Final = {
    errno.ENOSPC: "Free some space.",
    errno.EDQUOT: "Free some space of your quota.",
    errno.EFBIG: "Raise the limit of file sizes (ulimit -f).",
    errno.EROFS: "Choose a place that can be written.",
    errno.EACCES: "Check the permissions.",
    errno.EPERM: "Check the permissions.",
    errno.EIO: "Check the device.",
    errno.EMFILE: "Raise the limit of open files (ulimit -n).",
    errno.ENFILE: "Close some programs.",
    errno.ENOMEM: "Free some memory.",
    errno.EAGAIN: "Raise the limit of processes (ulimit -u), or close some programs.",
}
#: The words for them of linkers, of the loader of libraries, and of drivers of compilers, which
#: also name the signal that ended a program.
_WORDS: Final = {
    "out of file descriptors": errno.EMFILE,
    f"cannot open shared object file: Error {errno.EMFILE}": errno.EMFILE,
    "file too big": errno.EFBIG,
    "File size limit exceeded": errno.EFBIG,
    "memory exhausted": errno.ENOMEM,
    "out of memory": errno.ENOMEM,
    "Killed": errno.ENOMEM,
}


#: Bytes that Python writes into each folder when it looks for one for temporary files.
_TRIAL: Final = 4


def system_error(error: BaseException) -> OutputError | None:
    """A refusal of the operating system as an error that says what it is; None for other faults."""
    if not isinstance(error, OSError | ImportError):
        return None
    number, help_with = errno_of(error), remedy_for(error)
    reason = getattr(error, "strerror", None) or str(error)
    if number == errno.ENOENT and "temporary directory" in str(error):
        reason, help_with = str(error), "Set TMPDIR to a folder that you can write to."
        if 0 <= resource.getrlimit(resource.RLIMIT_FSIZE)[0] < _TRIAL:
            reason, help_with = os.strerror(errno.EFBIG), _REFUSALS[errno.EFBIG]
    if number == errno.ENOENT and not _has_working_folder():
        reason, help_with = "the working folder no longer exists", "Change to an existing folder."
    if not help_with:
        return None
    name = getattr(error, "filename", None)
    place = f"{os.fsdecode(name)}: " if isinstance(name, str | bytes) else ""
    return OutputError(f"{place}{reason}. {help_with}", path=place.removesuffix(": "), found=reason)


def remedy_for(refusal: OSError | ImportError | str) -> str:
    """What helps against a refusal of the operating system; "" for other faults.

    Args:
        refusal: The error, or the whole output of a program that ended with one.
    """
    return _REFUSALS.get(errno_of(refusal), "")


def errno_of(refusal: OSError | ImportError | str) -> int:
    """The errno of a refusal: the one that it carries, else the first one that its words name."""
    if isinstance(refusal, OSError) and refusal.errno:
        return refusal.errno
    words = {os.strerror(number): number for number in _REFUSALS} | _WORDS
    longest_first = sorted(words, key=len, reverse=True)  # one of them begins with another
    match = re.search("|".join(map(re.escape, longest_first)), str(refusal))
    return words[match[0]] if match else 0


def _has_working_folder() -> bool:
    """Whether the folder that this process works in is still there."""
    try:
        os.getcwd()  # noqa: PTH109 (Path.cwd is the same call)
    except OSError:
        return False
    return True


def from_record(record: Mapping[str, Any]) -> CoadjointError:
    """The error that `CoadjointError.as_record` described; unknown kinds become the base."""
    kinds = {kind.__name__: kind for kind in _family(CoadjointError)}
    kind = kinds.get(record["kind"], CoadjointError)
    return kind(record["message"], **record["parts"])


def _family(kind: type[CoadjointError]) -> list[type[CoadjointError]]:
    """A class and all its descendants."""
    return [kind, *(member for child in kind.__subclasses__() for member in _family(child))]


class KinkWarning(UserWarning):
    """Steps cross kinks or jumps of the rates at which they do not end, with an error.

    `warnings.simplefilter("error", coadjoint.KinkWarning)` refuses such runs.
    """


class StabilityWarning(UserWarning):
    """A fixed step is longer than the one up to which an explicit method is stable."""


class PeriodicityWarning(UserWarning):
    """A field that is differentiated by Fourier series jumps at the ends of its circle."""


class ShockWarning(UserWarning):
    """A run goes on beyond the time at which the waves of a field break.

    Attributes:
        after: How long after the beginning of the run they break.
    """

    def __init__(self, message: str, after: float) -> None:
        self.after = after
        super().__init__(message)


def check_type(function: str, value: object, kind: type | tuple[type, ...], expected: str) -> None:
    """Refuse an argument of another type, and say what to pass.

    Raises:
        TypeError: It is of another type.

    >>> check_type("derive", "heavy_top", int, "what coadjoint.read_spec returns")
    Traceback (most recent call last):
    TypeError: derive was given 'heavy_top', a str; expected what coadjoint.read_spec returns.
    """
    if not isinstance(value, kind):
        found = f"{shorten(repr(value))}, a {type(value).__name__}"
        raise TypeError(f"{function} was given {found}; expected {expected}.")
