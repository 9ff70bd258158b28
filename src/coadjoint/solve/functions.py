"""The functions of a System: one method for each of the table, all with one signature.

Comes in: arguments of a person. Goes out: results, by what `System` makes of the arguments.
Read next: `coadjoint.solve.system`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from inspect import signature
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, ParamSpec, Protocol, TypeVar

from coadjoint.declared import KernelFunction
from coadjoint.errors import KernelArgumentError
from coadjoint.kernel_functions import KERNEL_FUNCTIONS
from coadjoint.render.targets import TARGETS

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[Any]
    #: One array, or arrays by name.
    Values = ArrayLike | Mapping[str, ArrayLike]

#: The name of a target; `coadjoint.render.targets` has them.
Target = str
#: What is said of the arguments of every function.
_ARGUMENTS: Final = """Args:
    state: ``(n,)`` or ``(n, *batch)``, or a mapping by name: ``{"Pi": [...], ...}``.
    parameters: Packed, ``(k,)`` for all members or ``(k, *batch)``; or a mapping by name,
        ``{"I": [1, 2, 3], "m": masses}``, that overrides defaults; None for the defaults.
    inputs: Of a system that has ``INPUTS``, in the same forms: ``(m,)``, ``(m, *batch)``,
        a mapping, or None for the defaults.
    time: Of a system that depends on it: a number, or one for each member, ``batch``.
    target: {targets}.
    out: Where to write the result: float64, C-contiguous, apart from the inputs.

Returns:
    ``out``, or a new array.

Raises:
    KernelArgumentError: A shape, name, sign or aliasing that cannot be right.
    KernelTypeError: A type that cannot become float64 without loss.
"""

_VECTOR: Final = "    vector: In the forms of the state, and of its shape.\n"
_Given = ParamSpec("_Given")
_Result = TypeVar("_Result")


def by_name(method: Callable[_Given, _Result]) -> Callable[_Given, _Result]:
    """Refuse what is passed by position and goes by name, with the spelling that works."""
    most = method.__code__.co_argcount
    names = method.__code__.co_varnames[1:most]

    @wraps(method)
    def call(*given: _Given.args, **named: _Given.kwargs) -> _Result:
        if len(given) > most:
            raise _refusal(method.__name__, names, len(given) - most)
        return method(*given, **named)

    return call


def _refusal(method: str, names: Sequence[str], more: int) -> KernelArgumentError:
    """What to write where more was passed by position than a method takes so."""
    taken = ", ".join(names)
    return KernelArgumentError(
        f"{method} takes {taken} by position, and found {more} more; expected the others by name. "
        f'Write {method}({taken}, target="c", out=out).',
        found=len(names) + more,
        expected=len(names),
    )


class Method(Protocol):
    """How every function of a System is called."""

    def __call__(
        self,
        state: Values,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *,
        time: ArrayLike | None = None,
        target: Target = "c",
        out: Array | None = None,
    ) -> Array:
        """The function at a state."""
        ...


class Functions:
    """What kernels compute: a method for each of the kernel functions.

    A System has those of its ``functions``.

    Attributes:
        stepwise: Why generated methods make steps that are recorded in Python, as a clause; ""
            where they need not.
        derivatives: ``fourier`` where fields have these; "" for differences, and without fields.
        obstacle: Why generated methods do not apply at all, as a clause; "" where they may.
        members: How many equal members there are, whose rows follow one another component after
            component; what one is constrained to does not depend on the others.
    """

    stepwise: str = ""
    obstacle: str = ""
    derivatives: str = ""
    members: int = 1

    @property
    def fixed(self) -> Mapping[str, Array]:
        """Arrays that kernels take beyond those that a person passes, by name: N of a family."""
        return MappingProxyType({})

    if TYPE_CHECKING:  # the methods are made below, from the table

        def __getattr__(self, name: str) -> Method: ...

        #: A function by name and target at state, parameters, inputs and time, into a result.
        _evaluate: Callable[..., Array]


def make_method(function: KernelFunction) -> Callable[..., Array]:
    """The method of a System that evaluates a function of the table."""
    name = function.name

    def method(
        self: Functions,
        state: Values,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *more: Any,
        time: ArrayLike | None = None,
        target: Target = "c",
        out: Array | None = None,
    ) -> Array:
        if more:  # as `by_name`, which would take a third of the time of a call
            raise _refusal(name, ("state", "parameters", "inputs"), len(more))
        return self._evaluate(name, target, state, parameters, inputs, time, out)

    def along(
        self: Functions,
        state: Values,
        vector: Values,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *,
        time: ArrayLike | None = None,
        target: Target = "c",
        out: Array | None = None,
    ) -> Array:
        from coadjoint.solve.arrays import stack_vector

        stacked = stack_vector(self, name, state, vector)
        return self._evaluate(name, target, stacked, parameters, inputs, time, out)

    of_vector = function.below == "vector"
    made: Callable[..., Array] = along if of_vector else method
    like: Callable[..., Array] = along if of_vector else Method.__call__
    made.__name__, made.__qualname__ = name, f"Functions.{name}"
    made.__doc__ = _text(function)
    made.__signature__ = signature(like)  # type: ignore[attr-defined]
    return made


def _text(function: KernelFunction) -> str:
    """The docstring of a method."""
    targets = ", ".join(
        f'``"{build}"``' + (f" ({known})" if known else "")
        for target in TARGETS.values()
        for build, known in target.builds.items()
    )
    head = f"{function.summary}; shape ``{function.shape}``.\n\n"
    arguments = _ARGUMENTS.replace("{targets}", targets)
    if function.below == "vector":
        arguments = arguments.replace("    parameters:", f"{_VECTOR}    parameters:", 1)
    return head + (f"{function.doc}\n\n" if function.doc else "") + arguments


for each in KERNEL_FUNCTIONS.values():
    setattr(Functions, each.name, make_method(each))
