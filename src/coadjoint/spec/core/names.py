"""Names: which ones a spec may declare, and what to call a thing instead.

Comes in: declared names. Goes out: nothing, or why a name is refused and what would do. A name
keeps its spelling in every target, because generated code is read beside the book; so a name that
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
from coadjoint.spec.core.shapes import FUNCTIONS

NAME = re.compile(r"[A-Za-z][A-Za-z0-9]*(?:_[A-Za-z0-9]+)*")
SYSTEM_NAME = re.compile(r"[a-z][a-z0-9_]{0,30}")


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


# Some are keywords of later Pythons only; a spec means the same everywhere.
_PYTHON = {*keyword.kwlist, *keyword.softkwlist, "match", "case", "type"}
_C = _words(
    """
    auto break case char const continue default do double else enum extern float for goto if inline
    int long register restrict return short signed sizeof static struct switch typedef union
    unsigned void volatile while alignas alignof asm bool constexpr false nullptr static_assert
    thread_local true typeof typeof_unqual
    """
)
# Of <math.h> and <stddef.h>, in ISO mode or out of it; a macro changes what a name means silently.
_C_HEADERS = _words(
    """
    NULL offsetof size_t ptrdiff_t wchar_t max_align_t nullptr_t unreachable float_t double_t
    HUGE HUGE_VAL HUGE_VALF HUGE_VALL INFINITY NAN MAXFLOAT SNAN SNANF SNANL
    FP_NAN FP_INFINITE FP_ZERO FP_SUBNORMAL FP_NORMAL FP_ILOGB0 FP_ILOGBNAN
    FP_FAST_FMA FP_FAST_FMAF FP_FAST_FMAL MATH_ERRNO MATH_ERREXCEPT math_errhandling
    fpclassify isfinite isinf isnan isnormal signbit iseqsig issignaling issubnormal iszero
    isgreater isgreaterequal isless islessequal islessgreater isunordered
    M_E M_LOG2E M_LOG10E M_LN2 M_LN10 M_PI M_PI_2 M_PI_4 M_1_PI M_2_PI M_2_SQRTPI M_SQRT2
    M_SQRT1_2 DOMAIN SING OVERFLOW UNDERFLOW TLOSS PLOSS errno linux unix i386
    """
)
# Arguments, modules and functions of generated code, and the labels of results.
_OURS = _words(
    """
    state parameters inputs out count state_stride parameters_stride inputs_stride time_stride
    out_stride np math numpy target time t drift
    """
) | set(KERNEL_FUNCTIONS)
_OURS_PATTERN = re.compile(r"(casimir|integral)\d+(_\d+)?|COADJOINT(_.*)?")

_BETTER = MappingProxyType({"lambda": "lam", "t": "tau", "norm": "length", "np": "n_p"})
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
        return f"{name!a} is not a name", expected, _tidied(name)
    if len(name) > NAME_CHARACTERS:
        problem = f"{name!r} has {len(name)} characters"
        return problem, f"at most {NAME_CHARACTERS} (NAME_CHARACTERS)", ""
    for reserved, of in (
        (FUNCTIONS, "a function of the expression language"),
        (_PYTHON, "a keyword of Python"),
        (_C, "a keyword of C"),
        (_C_HEADERS, "a name of the C headers"),
        (_OURS, "a name that generated code or results use"),
    ):
        if name in reserved:
            return f"{name!r} is {of}", "a free name", f"Call it {better(name)!r}."
    if _OURS_PATTERN.fullmatch(name):
        problem = f"{name!r} is a name that generated code or results use"
        return problem, "a free name", f"Call it {better(name)!r}."
    return None


def better(name: str) -> str:
    """A free name close to a reserved one.

    >>> better("state")
    'state_0'
    """
    return _BETTER.get(name, f"my_{name}" if _OURS_PATTERN.fullmatch(name) else f"{name}_0")


def _tidied(name: str) -> str:
    """A hint for a string that is no name."""
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
