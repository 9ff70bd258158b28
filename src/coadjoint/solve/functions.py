"""The functions of a System: one method for each that a kernel may have, all with one signature.

Comes in: arguments of a person. Goes out: results, by what `System` makes of the arguments.
Read next: `coadjoint.solve.system`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import wraps
from typing import TYPE_CHECKING, Any, Literal, ParamSpec, TypeVar

from coadjoint.errors import KernelArgumentError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[Any]
    #: One array, or arrays by name.
    Values = ArrayLike | Mapping[str, ArrayLike]

Target = Literal["c", "numpy", "c-fast"]
_Given = ParamSpec("_Given")
_Result = TypeVar("_Result")


def by_name(method: Callable[_Given, _Result]) -> Callable[_Given, _Result]:
    """Refuse what is passed by position and goes by name, with the spelling that works."""
    most = method.__code__.co_argcount
    names = ", ".join(method.__code__.co_varnames[1:most])

    @wraps(method)
    def called(*given: _Given.args, **named: _Given.kwargs) -> _Result:
        if len(given) > most:
            raise KernelArgumentError(
                f"{method.__name__} takes {names} by position, and found {len(given) - most} more; "
                "expected the others by name. "
                f'Write {method.__name__}({names}, target="c", out=out).',
                found=len(given) - 1,
                expected=most - 1,
            )
        return method(*given, **named)

    return called


class Functions:
    """What kernels compute; a System has those of its ``functions``."""

    def _evaluate(self, function: str, target: Target, *given: Any) -> Array:
        """A function at state, parameters, inputs and time, into a result."""
        raise NotImplementedError

    @by_name
    def rhs(
        self,
        state: Values,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *,
        time: ArrayLike | None = None,
        target: Target = "c",
        out: Array | None = None,
    ) -> Array:
        """Time derivative of the state, shape ``(n, *batch)``.

        Args:
            state: ``(n,)`` or ``(n, *batch)``, or a mapping by name: ``{"Pi": [...], ...}``.
            parameters: Packed, ``(k,)`` for all members or ``(k, *batch)``; or a mapping by name,
                ``{"I": [1, 2, 3], "m": masses}``, that overrides defaults; None for the defaults.
            inputs: Of a system that has ``INPUTS``, in the same forms: ``(m,)``, ``(m, *batch)``,
                a mapping, or None for the defaults.
            time: Of a system that depends on it: a number, or one for each member, ``batch``.
            target: ``"c"``, ``"numpy"``, or ``"c-fast"`` (fused operations: not the same bits).
            out: Where to write the result: float64, C-contiguous, apart from the inputs.

        Returns:
            ``out``, or a new array.

        Raises:
            KernelArgumentError: A shape, name, sign or aliasing that cannot be right.
            KernelTypeError: A type that cannot become float64 without loss.
        """
        return self._evaluate("rhs", target, state, parameters, inputs, time, out)

    @by_name
    def jacobian(
        self,
        state: Values,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *,
        time: ArrayLike | None = None,
        target: Target = "c",
        out: Array | None = None,
    ) -> Array:
        """Derivative of `rhs` by the state, shape ``(n, n, *batch)``; arguments as in `rhs`."""
        return self._evaluate("jacobian", target, state, parameters, inputs, time, out)

    @by_name
    def input_jacobian(
        self,
        state: Values,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *,
        time: ArrayLike | None = None,
        target: Target = "c",
        out: Array | None = None,
    ) -> Array:
        """Derivative of `rhs` by the inputs, shape ``(n, m, *batch)``; arguments as in `rhs`.

        Only systems with inputs have it.
        """
        return self._evaluate("input_jacobian", target, state, parameters, inputs, time, out)

    @by_name
    def parameter_jacobian(
        self,
        state: Values,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *,
        time: ArrayLike | None = None,
        target: Target = "c",
        out: Array | None = None,
    ) -> Array:
        """Derivative of `rhs` by the parameters, ``(n, k, *batch)``; arguments as in `rhs`.

        Only systems with parameters have it.
        """
        return self._evaluate("parameter_jacobian", target, state, parameters, inputs, time, out)

    @by_name
    def energy(
        self,
        state: Values,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *,
        time: ArrayLike | None = None,
        target: Target = "c",
        out: Array | None = None,
    ) -> Array:
        """Energy, shape ``batch``; arguments as in `rhs`."""
        return self._evaluate("energy", target, state, parameters, inputs, time, out)

    @by_name
    def observables(
        self,
        state: Values,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *,
        time: ArrayLike | None = None,
        target: Target = "c",
        out: Array | None = None,
    ) -> Array:
        """All observables, one row for each component of ``OBSERVABLES``; arguments as in `rhs`."""
        return self._evaluate("observables", target, state, parameters, inputs, time, out)

    @by_name
    def poisson_tensor(
        self,
        state: Values,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *,
        time: ArrayLike | None = None,
        target: Target = "c",
        out: Array | None = None,
    ) -> Array:
        """Brackets ``{x_i, x_j}`` of the state, shape ``(n, n, *batch)``; arguments as in `rhs`.

        Of a constrained motion the velocities stand for their momenta, ``Omega_momentum``: with
        those and the positions as coordinates, the motion is this matrix times the gradient of the
        energy, which is the velocities and minus the slopes of the constrained Lagrangian. It is
        antisymmetric, so energy is kept; the Jacobi identity it need not satisfy.
        """
        return self._evaluate("poisson_tensor", target, state, parameters, inputs, time, out)

    @by_name
    def constraint_residual(
        self,
        state: Values,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *,
        time: ArrayLike | None = None,
        target: Target = "c",
        out: Array | None = None,
    ) -> Array:
        """Left minus right sides of the constraints, ``(c, *batch)``; arguments as in `rhs`.

        Rows follow the declared constraints. What a constraint gives a velocity is put in, so
        that its rows are 0; those of other constraints stay at the level of rounding along a
        trajectory that `simulate` follows.
        """
        return self._evaluate("constraint_residual", target, state, parameters, inputs, time, out)

    @by_name
    def projection(
        self,
        state: Values,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *,
        time: ArrayLike | None = None,
        target: Target = "c",
        out: Array | None = None,
    ) -> Array:
        """The nearest state on the constraints, shape ``(n, *batch)``; arguments as in `rhs`.

        Positions stay. Velocities change by the d of least kinetic energy ``d . M d / 2`` with
        which all constraints hold to rounding. Only systems have it that keep a constraint,
        one that gives no velocity outright.
        """
        return self._evaluate("projection", target, state, parameters, inputs, time, out)

    @by_name
    def domain(
        self,
        state: Values,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *,
        time: ArrayLike | None = None,
        target: Target = "c",
        out: Array | None = None,
    ) -> Array:
        """What is positive where the system is defined, ``(d, *batch)``; arguments as in `rhs`.

        Rows are those of ``DOMAIN``: of a declared condition the side that is to be larger minus
        the other; of a constrained motion also the pivots of the solve for its accelerations. A row
        that is not ``strict`` may be zero. Where one is violated, the other functions give what
        arithmetic gives, infinities and NaN among it; `simulate` stops there.
        """
        return self._evaluate("domain", target, state, parameters, inputs, time, out)

    @by_name
    def reconstruction(
        self,
        state: Values,
        parameters: Values | None = None,
        inputs: Values | None = None,
        *,
        time: ArrayLike | None = None,
        target: Target = "c",
        out: Array | None = None,
    ) -> Array:
        """Rates of what is reconstructed, one row for each component of ``RECONSTRUCTED``.

        Arguments as in `rhs`, but that the state is followed by the rows of ``RECONSTRUCTED``:
        ``(n + k, *batch)``, or a mapping that names them all.
        """
        return self._evaluate("reconstruction", target, state, parameters, inputs, time, out)
