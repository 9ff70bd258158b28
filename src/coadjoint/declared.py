"""Declared: the small records that derive, render and solve share.

Comes in: nothing. Goes out: records of names and numbers, which a generated package declares in
its own text and which are as light to import as that package.
Read next: `coadjoint.kernel_functions`, the table of all functions of the kernels.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

if TYPE_CHECKING:
    from coadjoint.lower.program import Program
    from coadjoint.methods import JudgedMethod

#: Symbol and name of the independent variable, where no spec tells another.
CLOCK: Final = ("t", "time")


@dataclass(frozen=True)
class Quantity:
    """A named block of rows: of state, parameters, inputs, observables or what is reconstructed.

    Attributes:
        name: As in the spec, e.g. ``Pi``.
        shape: ``()``, ``(n,)`` or ``(n, m)``.
        unit: Unit text, ``"1"`` if dimensionless, ``""`` if not stated; of components with units
            of their own those of all, as ``"1, 1, m"``.
        components: Name of each row, row by row.
        default: One value for each row, or None.
        positive: Whether every value must be positive.
        conserved: Whether the motion conserves it.
        while_constant: Whether it does so only while the inputs are constant.
        upright: Of an attitude, the vector of the state that it turns upright at the start, or "".
    """

    name: str
    shape: tuple[int, ...]
    unit: str
    components: tuple[str, ...]
    default: tuple[float, ...] | None = None
    positive: bool = False
    conserved: bool = False
    while_constant: bool = False
    upright: str = ""

    @property
    def is_quaternion(self) -> bool:
        """Whether it is a quaternion, whose components are counted from the real part."""
        return self.shape == (4,) and self.components[0] == f"{self.name}0"

    @property
    def center(self) -> tuple[float, ...]:
        """Around which runs are tried: the default; without one an attitude's identity, or ones.

        >>> Quantity("R", (2, 2), "1", ("R11", "R12", "R21", "R22")).center
        (1.0, 0.0, 0.0, 1.0)
        >>> Quantity("Pi", (2,), "1", ("Pi1", "Pi2")).center
        (1.0, 1.0)
        """
        if self.default:
            return self.default
        count = len(self.components)
        width = self.shape[-1] if self.shape else 0
        if self.shape == (width, width):
            return tuple(float(not n % (width + 1)) for n in range(count))
        return (1.0,) * count

    def unit_of(self, name: str) -> str:
        """The unit of a component; by the name of the whole, that of the whole.

        >>> a = Quantity("a", (2,), "1, m", ("a1", "a2"))
        >>> a.unit_of("a2"), a.unit_of("a")
        ('m', '1, m')
        """
        return dict(zip(self.components, component_units(self), strict=True)).get(name, self.unit)


def component_units(quantity: Any) -> list[str]:
    """The unit of each component of anything with a unit and components."""
    units = [part.strip() for part in quantity.unit.split(",")]
    count = len(quantity.components)
    return units if len(units) == count else [quantity.unit] * count


@dataclass(frozen=True)
class Bound:
    """What a row of the function ``domain`` is: positive where a system is defined.

    Attributes:
        name: Of the condition, or of what keeps surfaces apart; of the acceleration, or of the
            reaction, whose pivot it is; of the velocity that a Legendre transform gives.
        kind: ``condition``, ``contact``, ``acceleration``, ``reaction``, ``transform`` of a root,
            ``range`` of a momentum, or ``iteration``.
        strict: Whether it may not be zero.
        inputs: Components of state, parameters, inputs and time that it depends on.
    """

    name: str
    kind: str
    strict: bool
    inputs: tuple[str, ...]

    @property
    def label(self) -> str:
        """What the row is, for comments and messages."""
        if self.kind == "transform":
            return f"argument of a root in {self.name}"
        if self.kind == "range":
            return f"condition on the momentum of {self.name}"
        if self.kind == "iteration":
            return f"pivot of {self.name} in d2l/dxi2"
        return self.name if self.kind in ("condition", "contact") else f"pivot of {self.name}"


@dataclass(frozen=True)
class KernelFunction:
    """A function that a kernel may have.

    What it computes, says a function in `coadjoint.derive.formulas`, of the same name but for a
    number at its end.

    Attributes:
        name: The same in every target.
        summary: What it is, for the heads of generated files: one clause without its shape.
        shape: The shape of its result, for documents: ``(n, n, *batch)``.
        doc: What a reader of a System is told beyond that.
        constrained: The summary of a system with constraints, where it is another one.
        turning: The summary of a system whose attitudes are moved back, where it is another one.
        turning_bound: The summary of such a system with constraints, where it is another one.
        by: What it is a derivative of the rates by: the name of an array, or "".
        below: What follows the rows of the state in its first argument: what is reconstructed,
            a vector with a row for each of them, one with a row for each Wiener process, one with
            a sign for each kink, or the length of a step.
        looped: Whether only systems whose rates are loops over a table have it, or only others.
    """

    name: str
    summary: str
    shape: str
    doc: str = ""
    constrained: str = ""
    turning: str = ""
    turning_bound: str = ""
    by: Literal["", "state", "inputs", "parameters"] = ""
    below: Literal["", "reconstructed", "vector", "noise", "sides", "step"] = ""
    looped: Literal["", "only", "never"] = ""

    @property
    def formula(self) -> str:
        """The name of its function in `coadjoint.derive.formulas`: flows of all parts share one."""
        return self.name.rstrip("0123456789")


@dataclass(frozen=True)
class KernelContext:
    """All that the generated files of one system say.

    Attributes:
        name: Name of the system, the prefix of its C functions.
        spec: The file of the spec for readers: ``derivations/heavy_top.toml``, or its name alone
            where it lies in another folder.
        license: SPDX expression of the spec's licence, or "".
        routes: How the equations were derived, one line each.
        equations: The equations, one line each, in safe names and operators only.
        state: Quantities of the state, in order.
        parameters: Quantities of the parameters, in order.
        observables: Quantities that the function ``observables`` returns, in order.
        programs: The functions, in order.
        supported: How many claims are numerically supported and not proved, as the spec accepts.
        domain: What the rows of the function ``domain`` are; empty where there is none.
        reconstructed: What the function ``reconstruction`` returns the rates of, in order; empty
            where there is none.
        reconstructed_observables: What the function of this name returns, in order.
        inputs: Quantities of the inputs, in order; empty where there are none.
        time: The time, if the functions take it.
        unit_of_time: The unit of the time, also where they do not.
        clock: Symbol and name of the independent variable.
        turning: Names of the attitudes that the projection moves back to rotations.
        written: The index of members that are all written out, and their number; else None.
        is_bound: Whether there are constraints.
        maps: What explicit methods make a step of: `coadjoint.lower.mapped`.
        refusals: Methods without such maps, each with the reason.
        methods: Methods that keep structure and apply, with what each keeps.
    """

    name: str
    spec: str
    license: str
    routes: tuple[str, ...]
    equations: tuple[str, ...]
    state: tuple[Quantity, ...]
    parameters: tuple[Quantity, ...]
    observables: tuple[Quantity, ...]
    programs: tuple[Program, ...]
    supported: int = 0
    domain: tuple[Bound, ...] = ()
    reconstructed: tuple[Quantity, ...] = ()
    reconstructed_observables: tuple[Quantity, ...] = ()
    inputs: tuple[Quantity, ...] = ()
    time: tuple[Quantity, ...] = ()
    unit_of_time: str = "s"
    clock: tuple[str, str] = CLOCK
    written: tuple[str, int] | None = None
    turning: tuple[str, ...] = ()
    is_bound: bool = False
    maps: tuple[Program, ...] = ()
    refusals: tuple[tuple[str, str], ...] = ()
    methods: tuple[JudgedMethod, ...] = ()
