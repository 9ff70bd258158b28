"""Names: which ones a spec may declare, and what to call a thing instead.

Comes in: declared names. Goes out: nothing, or why a name is refused and which one to use. A name
keeps its spelling in every target, because generated code is read next to the book; so a name that
any target reserves is refused here, and a test holds the lists against the compilers. Names that
begin with an underscore belong to generated code and cannot be declared at all.
Read next: `coadjoint.spec.reader`.
"""

from __future__ import annotations

import keyword
import re
import sys
from collections.abc import Iterable, Iterator
from types import MappingProxyType

from coadjoint.kernel_functions import KERNEL_FUNCTIONS
from coadjoint.limits import NAME_CHARACTERS
from coadjoint.resources import reserved_words
from coadjoint.spec.core.shapes import FUNCTIONS

NAME = re.compile(r"[A-Za-z][A-Za-z0-9]*(?:_[A-Za-z0-9]+)*")
SYSTEM_NAME = re.compile(r"[a-z][a-z0-9_]{0,30}")


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


#: What each word is to a target that reserves it.
_TARGETS = reserved_words()
# Arguments of all targets and of Systems, functions, and labels of results.
_OURS = _words("state parameters inputs out target time t drift") | set(KERNEL_FUNCTIONS)
_OURS_PATTERN = re.compile(r"(casimir|integral)\d+(_\d+)?|COADJOINT(_.*)?")

_BETTER = MappingProxyType({"lambda": "lam", "t": "tau", "norm": "length", "np": "n_p", "pi": "p"})
_MODULES = sys.stdlib_module_names | _words(
    "numpy scipy sympy mpmath jinja2 pydantic click rich coadjoint"
)


def refusal(name: str) -> tuple[str, str, str] | None:
    """Why a spec may not declare a name: problem, what is expected, hint; None if it may.

    >>> refusal("Omega")
    >>> refusal("lambda")
    ("'lambda' is a keyword of Python", 'a free name', "Call it 'lam'.")
    """
    if not NAME.fullmatch(name):
        expected = "a letter, then letters and digits, with single underscores inside"
        return f"{name!a} is not a name", expected, _tidy(name)
    if len(name) > NAME_CHARACTERS:
        problem = f"{name!r} has {len(name)} characters"
        return problem, f"at most {NAME_CHARACTERS} (NAME_CHARACTERS)", ""
    kind = "a function of the expression language" if name in FUNCTIONS else _TARGETS.get(name)
    kind = "a number of the expression language" if name == "pi" else kind
    if kind is None and (name in _OURS or _OURS_PATTERN.fullmatch(name)):
        kind = "a name that generated code or results use"
    if kind is not None:
        return f"{name!r} is {kind}", "a free name", f"Call it {suggest_name(name)!r}."
    return None


def is_taken_in_c(name: str) -> bool:
    """Whether only a number that steps read cannot be told from what generated C calls so.

    A matrix V has the entries V11, V12 and so on, and of observables steps know nothing.

    >>> is_taken_in_c("V"), is_taken_in_c("double")
    (True, False)
    """
    return _TARGETS.get(name) == "a type or a macro of generated C"


def suggest_name(name: str) -> str:
    """A free name close to a reserved one.

    >>> suggest_name("state")
    'state_0'
    """
    return _BETTER.get(name, f"my_{name}" if _OURS_PATTERN.fullmatch(name) else f"{name}_0")


def _tidy(name: str) -> str:
    """A hint for a string that is not a name."""
    near = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
    fits = NAME.fullmatch(near) and len(near) <= NAME_CHARACTERS and refusal(near) is None
    return f"Call it {near!r}." if fits else ""


def system_refusal(name: str) -> tuple[str, str, str] | None:
    """Why a file may not have this stem, which names the system; None if it may.

    >>> system_refusal("heavy_top")
    >>> system_refusal("random")[0]
    "'random' is a module or keyword of Python"
    """
    if not SYSTEM_NAME.fullmatch(name):
        near = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")[:31]
        hint = f"Rename the file to {near}.toml." if SYSTEM_NAME.fullmatch(near) else ""
        expected = "a lower-case letter, then lower-case letters, digits and _, at most 31"
        return f"the system's name, {name!a}, is not usable", expected, hint
    if name in _MODULES or keyword.iskeyword(name) or keyword.issoftkeyword(name):
        hint = f"Rename the file to my_{name}.toml."
        return f"{name!r} is a module or keyword of Python", "a free name", hint
    return None


def derived_names(components: Iterable[str]) -> Iterator[str]:
    """Names that follow from the components of the state: their rates."""
    return (f"d{component}_dt" for component in components)
