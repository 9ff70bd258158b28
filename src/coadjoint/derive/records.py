"""Records: the parts of Equations, and how the left sides of their lines are written.

Comes in: exact elements from a route. Goes out: frozen records: the steps of a derivation, the
equations as field elements, and charts. Read next: `coadjoint.derive.equations`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

from coadjoint.derive.interpret import Value
from coadjoint.derive.mechanics.solver import Solve
from coadjoint.derive.setting import shape
from coadjoint.derive.theorems import Theorem, find_theorem
from coadjoint.exact import Element
from coadjoint.notation import names
from coadjoint.notation.tex import to_mathml
from coadjoint.notation.written import Written, enclose
from coadjoint.spec.model import Shape

#: The left side of a line of a derivation, in every format.
Left = Written
#: How kernels call a time derivative.
_RATE = re.compile(r"d(?P<of>.+)_dt")


def is_of_kernel(name: str) -> bool:
    """Whether a name is one that kernels give: of an intermediate, or of a rate."""
    return name.startswith("_") or _RATE.fullmatch(name) is not None


def symbol(name: str) -> Left:
    """The symbol itself: ``Pi1``; names of kernels as a book would write them."""
    return names.name(name)


def sign_text(sign: int, text: str) -> str:
    """A law, or minus it, a sum in brackets.

    >>> sign_text(1, "a + b"), sign_text(-1, "a + b"), sign_text(-1, "a")
    ('a + b', '-(a + b)', '-a')
    """
    if sign == 1:
        return text
    return f"-({text})" if " + " in text else f"-{text}"


def rate(name: str) -> Left:
    """Its time derivative: ``dPi1/dt``."""
    return names.name(name, dot=True)


def member(of: str, place: str, *, dot: bool = False) -> Left:
    r"""What a member has, by its place: ``q[i+1]``.

    >>> member("q", "i+1").text, member("r2", "i", dot=True).latex
    ('q[i+1]', '\\dot{r}_{i,2}')
    """
    return names.member(of, place, dot=dot)


def partial(function: str, name: str) -> Left:
    """A partial derivative: ``dl/dOmega1``."""
    return names.partial(symbol(function), symbol(name))


def component(text: str, latex: str, typst: str, n: int) -> Left:
    """A component of a vector that is written out: ``(M eta')_1``."""
    maths = to_mathml(latex)
    assert maths is not None, latex
    inner = maths.removeprefix("<math>").removesuffix("</math>")
    vector = enclose([Written(text=text, latex=latex, mathml=inner, typst=typst)], "()")
    return Written(
        text=f"{vector.text}_{n}",
        latex=f"{vector.latex}_{{{n}}}",
        mathml=f"<msub>{vector.mathml}<mn>{n}</mn></msub>",
        typst=f"{vector.typst}_{n}",
    )


def bracket(a: str, b: str) -> Left:
    """A Poisson bracket: ``{Pi1, Pi2}``."""
    return enclose([symbol(a), symbol(b)], "{}")


def algebra_bracket(a: str, b: str) -> Left:
    """A bracket of a Lie algebra: ``[J1, J2]``."""
    return enclose([symbol(a), symbol(b)])


@dataclass(frozen=True)
class Step:
    """One step of a derivation, for the document.

    Attributes:
        title: What is done.
        text: The general law as plain text, from the theorem and not from the spec.
        latex: The same law as LaTeX.
        theorem: What it rests on.
        lines: Left and right sides of what it gives for this system.
    """

    title: str
    text: str
    latex: str
    theorem: Theorem
    lines: tuple[tuple[Left, Element], ...] = ()


#: Right sides by left sides, or by the names whose symbols are these.
Lines = Mapping[str, Element] | Iterable[tuple[str | Left, Element]]


def write_step(title: str, text: str, latex: str = "", lines: Lines = (), *, by: str) -> Step:
    """A step with its lines; the law in LaTeX is the plain text unless it is given.

    ``by`` is the key of the theorem that the step rests on, in `coadjoint.derive.theorems`.

    Raises:
        LookupError: No theorem has this key.
    """
    pairs = lines.items() if isinstance(lines, Mapping) else lines
    written = ((symbol(a) if isinstance(a, str) else a, value) for a, value in pairs)
    return Step(
        title=title,
        text=text,
        latex=latex or text,
        theorem=find_theorem(by),
        lines=tuple(written),
    )


def write_rates(names: Sequence[str], values: Iterable[Element]) -> Iterator[tuple[Left, Element]]:
    """Lines for time derivatives."""
    return zip(map(rate, names), values, strict=True)


def write_slopes(
    function: str, names: Sequence[str], values: Iterable[Element]
) -> Iterator[tuple[Left, Element]]:
    """Lines for the derivatives of a function by some names."""
    return zip((partial(function, name) for name in names), values, strict=True)


def write_entries(name: str, matrix: Sequence[Sequence[Element]]) -> Iterator[tuple[str, Element]]:
    """Lines for the entries of a symmetric matrix on and above the diagonal, without zeros."""
    for i, row in enumerate(matrix, 1):
        yield from ((f"{name}_{i}{j}", entry) for j, entry in enumerate(row, 1) if j >= i and entry)


class Kept(Enum):
    """When the motion conserves a quantity, as far as the spec and its kind tell."""

    UNKNOWN = "unknown"
    ALWAYS = "always"
    AS_ENERGY = "where nothing acts that changes the energy"
    UNLESS_WORKED_ON = "where the forces do not change it"


@dataclass(frozen=True)
class Emitted:
    """A quantity that is emitted in addition to the dynamics.

    Attributes:
        name: As kernels and claims call it.
        shape: ``()``, ``(n,)`` or ``(n, m)``.
        components: Names of the components, row by row.
        unit: Unit text, "" where the declared units do not tell.
        values: The components.
        kept: When it is conserved.
        form: What it is in formulas, where that is not an array of its components.
    """

    name: str
    shape: Shape
    components: tuple[str, ...]
    unit: str
    values: tuple[Element, ...]
    kept: Kept = Kept.UNKNOWN
    form: Value | None = None

    @property
    def whole(self) -> Value:
        """What its name stands for in formulas."""
        return shape(self.values, self.shape) if self.form is None else self.form


@dataclass(frozen=True)
class Exact:
    """The equations as field elements.

    Attributes:
        definitions: Velocities by name, each in terms of the state; rates and observables may use
            these names. In the order in which they can be computed. Names with a leading underscore
            are intermediates of a solve in the kernel (`coadjoint.derive.mechanics.solver`).
        rates: Time derivative of each state component.
        energy: The Hamiltonian, in terms of the state; None for forces without a potential.
        emitted: What is emitted in addition to the rates, energy included.
        poisson_tensor: ``{x_i, x_j}`` for the state x; None where the route gives no bracket.
        solves: Linear equations that definitions solve in the kernel, in that order.
        residuals: What vanishes on the constraints, by the names of these.
        forces: What external forces add to each rate; empty where none act, and with constraints.
    """

    definitions: tuple[tuple[str, Element], ...]
    rates: tuple[Element, ...]
    energy: Element | None
    emitted: tuple[Emitted, ...]
    poisson_tensor: tuple[tuple[Element, ...], ...] | None
    solves: tuple[Solve, ...] = ()
    residuals: tuple[tuple[str, Element], ...] = ()
    forces: tuple[Element, ...] = ()

    @property
    def observables(self) -> tuple[tuple[str, Element], ...]:
        """Name and value of each scalar that is emitted."""
        return tuple(
            pair for each in self.emitted for pair in zip(each.components, each.values, strict=True)
        )


@dataclass(frozen=True)
class Relation:
    """A function that vanishes where variables live, such as ``chi . r`` or ``q . q - 1``.

    Attributes:
        text: The relation for people: ``dot(chi, r) = 0``.
        element: What vanishes.
    """

    text: str
    element: Element


@dataclass(frozen=True)
class Chart:
    """The variables in which a route moves, where they are not the declared state.

    Attributes:
        variables: Their names, in the order of the route's rates.
        state: Each component of the declared state as a function of them.
        through: The map in words for certificates: ``Pi = P x Q``.
        relations: What vanishes where the variables live; the motion must keep it so.
        name: As a spec declares it; "" of a route.
    """

    variables: tuple[str, ...]
    state: tuple[Element, ...]
    through: str
    relations: tuple[Relation, ...] = ()
    name: str = ""
