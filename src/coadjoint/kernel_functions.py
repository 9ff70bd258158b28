"""Kernel functions: the one table of what a kernel may compute.

Comes in: nothing. Goes out: an entry for each function. Names that a spec may not use, lowering,
the reference, the checks, the templates, the methods of a System and the documents read it, in this
order. For another function add an entry here, and in `coadjoint.derive.formulas` the function of
the same name, which says what it computes.
Read next: `coadjoint.derive.formulas`.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

from coadjoint.declared import KernelFunction

_ENTRIES: Final = (
    KernelFunction(name="rhs", summary="Time derivative of the state", shape="(n, *batch)"),
    KernelFunction(
        name="jacobian",
        summary="Derivative of rhs by the state, one row for each rate",
        shape="(n, n, *batch)",
        by="state",
        doc="Systems whose rates are loops, or that solve for more than 12 velocities that are all "
        "coupled, have `jacobian_vector` in its place.",
        looped="never",
    ),
    KernelFunction(
        name="jacobian_vector",
        summary="Derivative of rhs along a vector, the Jacobian times it",
        shape="(n, *batch)",
        doc="""Only systems have it whose Jacobian is too large: rates are loops over a table of
coefficients, as of a free body on so(9) and above, or over equal members, or the kernel solves for
more than 12 velocities that are all coupled. Its second argument is the vector, in the forms of
the state; `evaluate` and `bind` take one array, ``(2*n, *batch)``, with the vector below the state.
""",
        by="state",
        below="vector",
        looped="only",
    ),
    KernelFunction(
        name="input_jacobian",
        summary="Derivative of rhs by the inputs, one row for each rate",
        shape="(n, m, *batch)",
        doc="Only systems with inputs have it.",
        by="inputs",
        looped="never",
    ),
    KernelFunction(
        name="parameter_jacobian",
        summary="Derivative of rhs by the parameters, one row for each rate",
        shape="(n, k, *batch)",
        doc="Only systems with parameters have it.",
        by="parameters",
        looped="never",
    ),
    KernelFunction(name="energy", summary="Energy", shape="batch"),
    KernelFunction(
        name="observables",
        summary="Observables, one row for each component",
        shape="(o, *batch)",
        doc="Rows are the components of ``OBSERVABLES``.",
    ),
    KernelFunction(
        name="poisson_tensor",
        summary="Poisson tensor, brackets of the components of the state",
        constrained="Almost-Poisson tensor, velocities standing for their momenta",
        shape="(n, n, *batch)",
        doc="""Of a constrained motion the velocities stand for their momenta,
``Omega_momentum``: with those and the positions as coordinates, the motion is this matrix times
the gradient of the energy, which is the velocities and minus the slopes of the constrained
Lagrangian. It is antisymmetric, so energy is kept; the Jacobi identity it need not satisfy.
Systems whose rates are loops over a table have no such matrix.""",
        looped="never",
    ),
    KernelFunction(
        name="energy_gradient",
        summary="Derivative of the energy by the state",
        shape="(n, *batch)",
        doc="""Only systems with an energy and a tensor in closed form have it: with
`bracket_vector` the motion is ``rhs = bracket_vector(state, energy_gradient)`` plus forces, and
plus ``metric_vector(state, entropy_gradient)`` where it is metriplectic. Equal members, and fields
by differences, have both where the energy is not quadratic.""",
        looped="never",
    ),
    KernelFunction(
        name="bracket_vector",
        summary="Poisson tensor at a state times a vector",
        shape="(n, *batch)",
        doc="""Only systems with an energy and a tensor in closed form have it. On the dual of a Lie
algebra it is the coadjoint action of the vector on the state; of a constrained motion the tensor
is the almost-Poisson one, taken from momenta to the velocities of the state, where it is
antisymmetric as well. With a double bracket it is ``P + P G P``, by which no energy grows. Its
second argument is the vector, in the forms of the state; `evaluate` and `bind` take one array,
``(2*n, *batch)``, with the vector below the state.
""",
        below="vector",
        looped="never",
    ),
    KernelFunction(
        name="entropy",
        summary="Entropy of a metriplectic motion, a number for each member",
        shape="batch",
        doc="""Only systems with [metriplectic] have it whose tensor and G are in closed form.""",
        looped="never",
    ),
    KernelFunction(
        name="entropy_gradient",
        summary="Derivative of the entropy by the state",
        shape="(n, *batch)",
        doc="""Only systems that have `entropy` have it.""",
        looped="never",
    ),
    KernelFunction(
        name="metric_vector",
        summary="Symmetric matrix G of a metriplectic motion at a state times a vector",
        shape="(n, *batch)",
        doc="""Only systems that have `entropy` have it. Arguments are as of `bracket_vector`.""",
        below="vector",
        looped="never",
    ),
    KernelFunction(
        name="distinguished",
        summary="Distinguished functions of Nambu's bracket",
        shape="(n - 2, *batch)",
        doc="""Only systems with [poisson] nambu, and an energy, have it.""",
        looped="never",
    ),
    KernelFunction(
        name="distinguished_gradient",
        summary="Derivatives of the distinguished functions by the state, row by row",
        shape="(n - 2, n, *batch)",
        doc="""Only systems that have `distinguished` have it: the motion is the product of these
gradients and `energy_gradient`, ``dc x dh`` of three coordinates.""",
        looped="never",
    ),
    KernelFunction(
        name="sandwich",
        summary="Product B W B of the matrices of a state W and of a vector B",
        shape="(n, *batch)",
        doc="""Only free systems have it whose state is a momentum of an algebra of matrices that
has all these products, as so(n) and sp(2n). On su(n) and sl(n) it is the product
``B (W + c Z) B`` in the middle of a step of u(n) or gl(n). Arguments are as of `bracket_vector`,
whose rows are those of the commutator of the two; the isospectral midpoint calls both.""",
        below="vector",
        looped="never",
    ),
    KernelFunction(
        name="noise",
        summary="What each Wiener process does to the state, one row for each component",
        shape="(n, w, *batch)",
        doc="""Only systems with [noise] have it. The motion is
``dx = rhs dt + noise o dW``, in the sense of Stratonovich.""",
    ),
    KernelFunction(
        name="noise_gradient",
        summary="Derivatives of the Hamiltonians of noise by the state, one row for each component",
        shape="(n, w, *batch)",
        doc="""Only systems with [noise] and `bracket_vector` have it: the product of the bracket
with a column is that column of `noise`. The coadjoint mean calls it.""",
        looped="never",
    ),
    KernelFunction(
        name="noise_vector",
        summary="What the noise does to the state, for a number of each Wiener process",
        shape="(n, *batch)",
        doc="""Only systems of equal members with [noise] have it, in the place of `noise`: this is
``noise`` times a vector. Its first argument is the state with these numbers below it, those of
processes that move all members, then those of members, process by process.""",
        below="noise",
        looped="only",
    ),
    *(
        KernelFunction(
            name=f"flow{n}",
            summary=f"What the flow of part {n} of the energy adds to the state in a time",
            shape="(n, *batch)",
            doc="""Only systems of equal members have it whose energy is a sum of parts with flows
in closed form, other than those of momenta and of coordinates. Its first argument is the state with
the time below it. Splittings are products of these flows.""",
            below="step",
            looped="only",
        )
        for n in range(1, 7)
    ),
    KernelFunction(
        name="sided_rhs",
        summary="Time derivative of the state with given signs at the kinks",
        shape="(n, *batch)",
        doc="""Only systems of equal members have it whose rates have
[kinks](simulation.md#kinks). Its
first argument is the state with these signs below it, one for each row of `kinks`. With the signs
of `kinks` this is `rhs`; solvers keep them for a step.""",
        below="sides",
        looped="only",
    ),
    KernelFunction(
        name="kinks",
        summary="What is zero at the kinks of the rates, rows of each member",
        shape="(m, *batch)",
        doc="""Only systems that have `sided_rhs` have it. A member that has no such kink, as at an
end of an open chain, has 1 in its row.""",
        looped="only",
    ),
    KernelFunction(
        name="constraint_residual",
        summary="Left minus right sides of the constraints",
        turning="How far attitudes are from rotations, products and determinants minus 1",
        turning_bound="Left minus right sides of the constraints, then how far attitudes are from "
        "rotations",
        shape="(c, *batch)",
        doc="""Rows follow the declared constraints. What a constraint gives a velocity is put in,
so that its rows are 0; those of other constraints stay at the level of rounding along a
trajectory that `simulate` follows. Of attitudes the rows are then those of
``R*transpose(R) - 1`` on and above the diagonal and ``det(R) - 1``, or ``dot(q, q) - 1``.""",
    ),
    KernelFunction(
        name="projection",
        summary="State moved onto the constraints by the least change of velocities",
        turning="State with attitudes moved back to rotations by one step of Newton",
        turning_bound="State with attitudes moved back to rotations, then moved onto the "
        "constraints",
        shape="(n, *batch)",
        doc="""Attitudes are moved first, by ``R -> (3 - R R^T) R/2`` and
``q -> (3 - |q|^2) q/2``. Other positions stay. Then velocities change by the d of least kinetic
energy ``d . M d / 2`` with which all constraints hold to rounding. Only systems have it that have
attitudes in the state or keep a constraint, one that gives no velocity outright.""",
    ),
    KernelFunction(
        name="reconstruction",
        summary="Rates of what is reconstructed; state holds the state, then its rows",
        shape="(r, *batch)",
        doc="""Rows are the components of ``RECONSTRUCTED``. In the first argument these follow the
state: ``(n + r, *batch)``, or a mapping that names them all.""",
        below="reconstructed",
    ),
    KernelFunction(
        name="reconstructed_observables",
        summary="Observables of what is reconstructed; state holds the state, then its rows",
        shape="(o, *batch)",
        doc="""Rows are the components of ``RECONSTRUCTED_OBSERVABLES``. The first argument is the
same as that of ``reconstruction``.""",
        below="reconstructed",
    ),
    KernelFunction(
        name="domain",
        summary="What is positive where the system is defined, one row for each entry of DOMAIN",
        shape="(d, *batch)",
        doc="""Of a declared condition, a row is the side that is to be larger minus the other; of a
constrained motion there are also the pivots of the solve for its accelerations. A row that is not
``strict`` may be zero. Where one is violated, the other functions give what arithmetic gives,
infinities and NaN among it; `simulate` stops there.""",
    ),
)

_TABLE: Final = {each.name: each for each in _ENTRIES}
#: Every function that a kernel may have, by name, in the order in which kernels hold them.
KERNEL_FUNCTIONS: Final = MappingProxyType(_TABLE)
