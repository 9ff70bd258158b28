"""The target C, one trajectory: text over vectors of lanes becomes text over numbers.

Comes in: what the templates of methods print, for all methods of a system. Goes out: the same for
one method, in the C that C99 and C++17 have in common. A vector becomes a number, and a mask a
number of which the lowest bit counts, so that ``~``, ``&`` and ``|`` mean what they mean of masks.
Read next: ``templates/c/header.h.j2``.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from typing import Final

#: Words of the solvers, by what they are here.
_WORDS: Final = {
    "V": "double",
    "I": "int",
    "INLINE": "static inline",
    "APART": "static inline",
    "restrict": "",
    "all": "",
}
#: What a text defines for itself at its top level: functions, tables, records and constants.
_DEFINED: Final = (
    re.compile(r"^(?:INLINE|APART) \w+ \*?(\w+)\(", re.MULTILINE),
    re.compile(r"^static const [\w ]+ (\w+)\[", re.MULTILINE),
    re.compile(r"^\} (\w+);", re.MULTILINE),
)
_CONSTANTS: Final = re.compile(r"^enum \{([^}]*)\};", re.MULTILINE)
#: Comments, which stay, and names, those of members left out.
_TOKEN: Final = re.compile(r"(/\*.*?\*/)|((?<![\w.>])[A-Za-z_]\w*)( ?)", re.DOTALL)


def in_numbers(text: str, prefix: str, chosen: Collection[str], known: Collection[str] = ()) -> str:
    """A text of vectors as one of numbers.

    Args:
        text: With one lane: arrays over blocks have one entry. It has no names of a spec.
        prefix: What names begin with that the text defines, so that nothing else has them.
        chosen: Macros that choose a method, which are defined.
        known: Names that begin so and are defined elsewhere.

    >>> text = "INLINE V turn(V *restrict a)" + chr(10) + "{" + chr(10) + "    I off = (I){0};"
    >>> print(in_numbers(text, "top_", ()))
    static inline double top_turn(double *a)
    {
        int off = 0;
    """
    kept = "\n".join(_choose(text.splitlines(), {*chosen}))
    own = {*known} | {name for form in _DEFINED for name in form.findall(kept)}
    listed = (re.split(r"[,=]", each) for each in _CONSTANTS.findall(kept))
    own |= {part.strip() for parts in listed for part in parts if part.strip().isidentifier()}

    def replace(found: re.Match[str]) -> str:
        comment, name, blank = found.groups()
        if comment is not None:
            return found[0]
        if name in _WORDS:
            return _WORDS[name] + blank if _WORDS[name] else ""
        before = prefix.upper() if name.isupper() else prefix
        return (before + name if name in own else name) + blank

    numbers = _TOKEN.sub(replace, kept).replace("(int){0}", "0")  # C++ has no such literals
    return re.sub(r"\n{3,}", "\n\n", numbers).strip("\n") + "\n" * text.endswith("\n")


def _choose(lines: list[str], defined: set[str]) -> Iterator[str]:
    """The lines that a preprocessor keeps where some macros are defined, without its own."""
    taken = [True]
    for line in lines:
        word, _, rest = line.partition(" ")
        if word in ("#if", "#ifdef"):
            names = re.findall(r"[A-Z]\w*", rest)
            taken.append(any(name in defined for name in names))
        elif word == "#else":
            taken[-1] = not taken[-1]
        elif word == "#endif":
            taken.pop()
        elif word == "#define" and re.fullmatch(r"[A-Z_]+", rest):
            defined |= {rest} if all(taken) else set()
        elif all(taken):
            yield line
    assert taken == [True], taken
