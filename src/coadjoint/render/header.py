"""Render, header: one step of one method as a C header that needs nothing of this package.

Comes in: what the generated files of a system say, a method, and a run to compare it with. Goes
out: the text of the header. Its numbers are those of the solvers: the same Programs, and the same
texts of methods.
Read next: ``templates/c/header.h.j2`` and `coadjoint.render.targets.c.numbers`.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

from coadjoint.declared import KernelContext
from coadjoint.errors import KernelArgumentError, SpecError
from coadjoint.lower.mapped import list_maps
from coadjoint.methods import EXACT, MAPPED, STRUCTURED, JudgedMethod, StructuredMethod
from coadjoint.render.environment import names_read, render_templates
from coadjoint.render.kernels import (
    describe_solver,
    elementary_functions,
    rows_of,
    tell_licence,
    wrap,
)
from coadjoint.render.recurrences import Line, list_reads
from coadjoint.render.solvers import FunctionText, arrange_function, list_sharing
from coadjoint.solver_kinds import SOLVER

TEMPLATE: Final = "c/header.h.j2"

#: Methods that keep no structure, in the form of those that do.
PLAIN: Final = {
    name: StructuredMethod(
        name=name, file=name, order=order, needs=(), keeps="linear integrals", theorem=theorem
    )
    for name, order, theorem in (
        (
            "rk4",
            4,
            "the classical method of W. Kutta, Zeitschrift fuer Mathematik und Physik 46 (1901) "
            "435",
        ),
        (
            "dop853",
            8,
            "the explicit method of order 8 by E. Hairer, S. P. Norsett and G. Wanner, Solving "
            "Ordinary Differential Equations I (1993), II.5, with a fixed step",
        ),
    )
}

#: Words of C++ that are names in C; those that C or Python reserves, specs cannot use.
_CPP_WORDS: Final = """
and_eq bitand bitor catch char16_t char32_t char8_t co_await co_return co_yield compl concept
const_cast consteval constinit decltype delete dynamic_cast explicit export friend mutable namespace
new noexcept not_eq operator or_eq private protected public reinterpret_cast requires static_cast
template this throw typeid typename using virtual xor xor_eq
"""


@dataclass(frozen=True)
class Sample:
    """A run that a header is compared with.

    Attributes:
        state: Where it begins, as text of C, component by component; likewise the next three.
        parameters: What it has.
        inputs: What it has.
        end: Where it ends.
        step: The length of its steps.
        count: How many it has.
        tolerance: How far an end may be where the system calls functions beyond sqrt.
        size: Of integrals, to which their roundings are compared.
    """

    state: Sequence[str]
    parameters: Sequence[str]
    inputs: Sequence[str]
    end: Sequence[str]
    step: str
    count: int
    tolerance: str
    size: str


def find_method(
    name: str, system: str, judged: Iterable[JudgedMethod], obstacle: str = ""
) -> tuple[StructuredMethod, JudgedMethod]:
    """A method that has a step for a system, with what is known of it.

    Args:
        name: Of the method; ``"auto"`` for the first in rank.
        system: Name of the system.
        judged: Its methods that keep structure.
        obstacle: Why no method has one, as a clause.

    Raises:
        KernelArgumentError: It does not apply, or there is none of this name.
    """
    known = {each.name: each for each in judged}
    fit = [*PLAIN, *(each.name for each in known.values() if each.applies)]
    ranked = [each for each in known.values() if each.rank == 1]
    if obstacle:
        who = (
            f"no method of {system} has a"
            if name == "auto"
            else f"method {name!r} of {system} has no"
        )
        raise KernelArgumentError(f"{who} header: {obstacle}.", found=name, expected=[])
    if name == "auto":
        name = ranked[0].name if ranked else "rk4"
    if name not in fit:
        own = known.get(name)
        reason = own.decides if own else "there is no such method with a fixed step"
        raise KernelArgumentError(
            f"method {name!r} of {system} has no header: {reason}. Expected one of "
            f"{', '.join(fit)}.",
            found=name,
            expected=fit,
        )
    method = {**PLAIN, **STRUCTURED, **MAPPED}[name]
    return method, known.get(name) or JudgedMethod(name=name, order=method.order)


def find_obstacle(context: KernelContext) -> str:
    """Why no method of a system has a header, as a clause; "" where they have."""
    names = {program.name for program in context.programs}
    rates = next(program for program in context.programs if program.name == "rhs")
    if "noise" in names:
        return "its motion has noise, and the header would need random numbers"
    if rates.table is not None:
        return "its rates are loops over a table"
    if describe_solver(context, SOLVER)["sides"]:
        return "its rates have kinks, at which the solvers of the library end their steps"
    return ""


def render_header(
    context: KernelContext, method: StructuredMethod, judged: JudgedMethod, sample: Sample | None
) -> str:
    """The header of one method.

    Args:
        context: What generated files say of the system.
        method: It applies: `find_method`.
        judged: What is proved of it.
        sample: What its test compares with; None for no test.

    Raises:
        SpecError: A name of the spec is a word of C++.
    """
    _check_names(context)
    solver = describe_solver(context, SOLVER)
    used = _select(solver, method)
    reads = frozenset[str]().union(*(each.reads for each in used.values()))
    fixed, shared = solver["solver"].fixed, solver["solver"].shared
    held = _keep_needed((*fixed, *shared), reads)
    programs = {program.name: program for program in context.programs}
    structured = _restrict(solver["structured"], method)
    observed = _list_observed(context, judged)
    values: dict[str, Any] = {
        **solver,
        "name": context.name,
        "prefix": f"{context.name}_{method.name}_",
        "spec": context.spec,
        "licence": tell_licence(context.license),
        "method": method,
        "routes": wrap(context.routes),
        "equations": wrap(context.equations),
        "about": _tell(method, judged),
        "state": rows_of(context.state),
        "parameters": rows_of(context.parameters),
        "driving": {
            array: rows_of(quantities)
            for array, quantities in (("inputs", context.inputs), ("time", context.time))
            if quantities
        },
        "solver": replace(
            solver["solver"],
            fixed=held,
            shared=(),
            fixed_reads=list_reads(held),
            shared_reads=frozenset(),
        ),
        "solved": used,
        "found": [f"find_{each}" for each in used],
        "sharing": ["rates", *list_sharing(used)],
        "structured": structured,
        "schedules": {k: v for k, v in solver["schedules"].items() if k == method.name},
        "is_structured": method.name in STRUCTURED,
        "parts": 0 if method.name in PLAIN else method.parts,
        "exact": not elementary_functions(programs.values()),
        "sample": sample,
        "observed": observed,
        "observables": arrange_function("observables", programs["observables"])
        if observed
        else FunctionText((), frozenset()),
        "listed": [name for each in context.observables for name in each.components],
    }
    values = {key: value for key, value in values.items() if key in names_read(TEMPLATE)}
    return render_templates((TEMPLATE,), values)[TEMPLATE]


def _check_names(context: KernelContext) -> None:
    """Names of a spec stay as they are in C++, too."""
    tables = (context.state, context.parameters, context.inputs, context.time)
    for quantity in (each for table in tables for each in table):
        for name in quantity.components:
            if name in _CPP_WORDS.split():
                raise SpecError(
                    f"{name!r} of {context.name} is a word of C++, and headers are C++ as well; "
                    "expected another name. Rename it in the spec.",
                    found=name,
                )


def _select(solver: Mapping[str, Any], method: StructuredMethod) -> dict[str, FunctionText]:
    """The functions that a step calls, maps first where they are what it is made of."""
    solved: dict[str, FunctionText] = solver["solved"]
    called = {"projection", "domain"}
    if method.name in solver["schedules"]:
        called |= {name for name, _ in solver["schedules"][method.name]}
        called |= {"rates"} if solver["solver"].branches else set()
    else:
        called |= {"rates", *(name for name in method.needs if not list_maps([name]))}
    return {name: each for name, each in solved.items() if name in called}


def _keep_needed(lines: Sequence[Line], reads: frozenset[str]) -> tuple[Line, ...]:
    """The lines of parameters that functions read, and those that these read."""
    wanted, kept = {*reads}, list[Line]()
    for line in reversed(lines):
        if line.name in wanted:
            kept.append(line)
            wanted |= list_reads([line])
    return tuple(kept[::-1])


def _restrict(structured: Mapping[str, Any], method: StructuredMethod) -> dict[str, Any]:
    """What the texts of methods read, for one of them."""
    names, macro = structured["names"], method.macro
    return {
        **structured,
        "names": {key: value for key, value in names.items() if key == macro},
        "stages": {
            order: stages
            for order, stages in structured["stages"].items()
            if macro in names and order == method.order
        },
        "tableaus": {key: value for key, value in structured["tableaus"].items() if key == macro},
        "has_bracket": structured["has_bracket"] and "bracket_vector" in method.needs,
        "has_newton": False,
    }


def _list_observed(context: KernelContext, judged: JudgedMethod) -> list[tuple[str, int]]:
    """Components of observables that a method keeps, with their rows."""
    rows = [(name, each.name) for each in context.observables for name in each.components]
    return [(name, n) for n, (name, whole) in enumerate(rows) if whole in judged.exactly]


def _tell(method: StructuredMethod, judged: JudgedMethod) -> list[str]:
    """What the head says of a method: its theorem, and what it keeps of this system."""
    tensor = ["the Poisson tensor"] if judged.is_poisson else []
    exactly = [*judged.exactly, *tensor, *judged.laws]
    lines = [
        f"The method is {method.theorem}; "
        + ("it is exact." if method.name == EXACT else f"its order is {method.order}."),
        f"Keeps to the rounding of each step: {', '.join(exactly) or 'nothing that is proved'}.",
    ]
    if judged.decides:
        lines.append(f"Because {judged.decides}.")
    if judged.nearly:
        size = f"O(h^{method.order})"
        lines.append(f"Keeps up to an error of {size}: {', '.join(judged.nearly)}.")
    return [piece for line in lines for piece in textwrap.wrap(line, 94, subsequent_indent="    ")]
