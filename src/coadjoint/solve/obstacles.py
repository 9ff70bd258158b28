"""Obstacles: why generated methods do not apply to a run, as clauses by which they are refused.

Comes in: a System, and what is asked of it. Goes out: a reason by name; "" or nothing where a
method applies. Read next: `coadjoint.solve.request`, which chooses among the others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from coadjoint.errors import KernelArgumentError
from coadjoint.methods import BACKWARD, MAPPED, NOISY, STRUCTURED, list_backward
from coadjoint.render.targets.modules import KernelModule
from coadjoint.solve.choices import GENERATED
from coadjoint.solve.costs import choose_order
from coadjoint.solve.family import FamilySystem
from coadjoint.solve.family_steps import tell_series_obstacle
from coadjoint.solve.noisy import has_noise
from coadjoint.solve.reconstruct import is_asked
from coadjoint.solve.request import find_kind, is_auto, is_chosen_by_structure
from coadjoint.solve.stability import is_of_waves
from coadjoint.solver_kinds import SOLVER, list_kinds

if TYPE_CHECKING:
    from collections.abc import Iterable

    from coadjoint.solve.system import System
    from coadjoint.solver_kinds import SolverKind

#: Why methods are refused that have no rates to follow.
ALONE: Final = (
    "it moves the state alone, and what is reconstructed is asked for. An attitude that is "
    "declared in [variables] is a part of the state, which a step moves as a whole"
)


#: Why the method of Taylor is not taken where `has_roots_at_kinks`.
NO_SERIES: Final = "its rates have roots at kinks, and at a kink no series"


def find_obstacle(system: System, target: str, reconstruct: Any) -> str:
    """Why generated methods do not apply to a run, as a clause; "" where they do.

    Args:
        system: The System.
        target: As `System.simulate` takes it.
        reconstruct: Likewise.
    """
    if system.obstacle:
        return system.obstacle
    kinds = list_kinds(system.functions)
    wanted = kinds if is_asked(reconstruct) else kinds[:1]
    if not system.stepwise and not all(map(system._solvers.has_files, wanted)):
        return "its folder was generated without them: run `coadjoint regenerate`"
    if target == "python":
        return "they are written for the targets c, c-fast and numpy"
    return ""


def list_obstacles(
    system: System,
    method: Any,
    step: Any,
    reconstruct: Any,
    *,
    obstacle: str,
    stepwise: str,
    rtol: float,
    members: int,
) -> dict[str, str]:
    """Why generated methods do not apply to a motion without noise, by their names.

    Args:
        system: The System.
        method: As `System.simulate` takes it.
        step: Likewise.
        reconstruct: Likewise.
        obstacle: Why none of them applies, or "".
        stepwise: Why steps are made in Python, or "".
        rtol: As given, or the default.
        members: How many trajectories there are.
    """
    obstacles = dict.fromkeys((*GENERATED, *STRUCTURED, *MAPPED), obstacle) if obstacle else {}
    if is_chosen_by_structure(method, step) and not obstacle:
        obstacles |= find_structure_obstacles(system, find_kind(reconstruct))
        obstacles |= find_missing_maps(system, reconstruct)
    if stepwise and is_auto(method):
        reason = f"Python leads the steps: {stepwise}"
        obstacles |= dict.fromkeys((*STRUCTURED, *MAPPED), reason)
    if system.obstacle:  # whose methods are Python's, not generated ones
        for each in system.METHODS:
            obstacles.pop(each.name)
        reason = _explain_gradients(system)
        obstacles |= {name: reason for name in obstacles if "_gradient" in name}
    if obstacle:
        return obstacles
    if without := find_series_obstacle(system, stepwise, rtol, members, is_auto=is_auto(method)):
        obstacles["taylor"] = without
    return obstacles if is_auto(method) else obstacles | find_missing_maps(system, reconstruct)


def _explain_gradients(system: System) -> str:
    """Why discrete gradients are refused where Python leads the steps.

    Of a quadratic energy the mean of the gradient along a chord is that in its middle.
    """
    if any(each.name == "midpoint" and "energy" in each.exactly for each in system.METHODS):
        return (
            "its energy is quadratic, so that the mean of the gradient along a step is that in its "
            "middle: 'midpoint' is this method, and keeps the energy"
        )
    return (
        f"{system.obstacle} by rates as a whole, and a discrete gradient needs the bracket and the "
        "gradient of the energy apart"
    )


def find_missing_maps(system: System, reconstruct: Any) -> dict[str, str]:
    """Why methods that are a sequence of maps do not apply, as clauses, as far as they do not.

    Args:
        system: The System.
        reconstruct: As `System.simulate` takes it.
    """
    if is_asked(reconstruct):
        return dict.fromkeys(MAPPED, ALONE)
    if isinstance(system, FamilySystem):
        return _list_missing(system, MAPPED)
    return system._solvers.refusals


def _list_missing(system: FamilySystem, names: Iterable[str]) -> dict[str, str]:
    """Why methods do not apply to equal members, as far as they do not."""
    known = {each.name for each in system.METHODS}
    of = "points" if system.counted == "points" else "equal members"
    reason = f"it does not apply to its {of}: see `coadjoint show {system.name} --methods`"
    return dict.fromkeys((name for name in names if name not in known), reason)


def find_stepwise(system: System, inputs: Any, *, is_recorded: bool) -> str:
    """Why a generated method makes its steps in Python, as a clause; "" where it does not.

    Args:
        system: The System.
        inputs: As `System.simulate` takes them.
        is_recorded: Whether events or paths within steps are asked for.
    """
    if callable(inputs) and system.INPUTS:
        return "inputs are a function of Python, which tells their values alone"
    return system.stepwise if is_recorded else ""


def find_structure_obstacles(system: System, kind: SolverKind) -> dict[str, str]:
    """Why methods that keep structure do not apply to a system, by their names.

    Args:
        system: The System.
        kind: What is integrated.
    """
    if isinstance(system, FamilySystem):
        return _list_missing(system, STRUCTURED)
    if system.stepwise:
        return {}
    module = KernelModule(system, kind.files[2])
    known = module.value("STRUCTURED") if module.has("STRUCTURED") else ()
    if not module.has("STRUCTURED"):
        return dict.fromkeys(STRUCTURED, "its folder was generated without it")
    judged = {each.name for each in system.METHODS}
    backward = list_backward() - judged if judged else set()
    alone = set[str]()
    if kind != SOLVER:
        own = KernelModule(system, SOLVER.files[2])
        alone = set(own.value("STRUCTURED") if own.has("STRUCTURED") else ())
    return {
        name: BACKWARD
        if name in known
        else ALONE
        if name in alone
        else f"it expects {each.expects}"
        for name, each in STRUCTURED.items()
        if name not in known or name in backward
    }


def find_newton_obstacle(system: System, reconstruct: Any) -> str:
    """Why Newton's method does not solve the equations of steps, as a clause; "" where it does.

    Args:
        system: The System.
        reconstruct: As `System.simulate` takes it.
    """
    if has_noise(system):
        return "the equations of steps with noise are solved by sweeps alone"
    if isinstance(system, FamilySystem):
        has_it = system.series.has("NEWTON")
        return "" if has_it else "its folder was generated without it: run `coadjoint regenerate`"
    if "jacobian" not in system.functions:
        return f"{system.name} has no Jacobian in closed form"
    if not KernelModule(system, find_kind(reconstruct).files[2]).has("NEWTON"):
        return "its folder was generated without it: run `coadjoint regenerate`"
    return ""


def check_newton_applies(system: System, reconstruct: Any) -> None:
    """Newton's method solves the equations of steps.

    Raises:
        KernelArgumentError: It does not; with the reason.
    """
    if obstacle := find_newton_obstacle(system, reconstruct):
        raise KernelArgumentError(
            f"newton is True, and {obstacle}; expected newton=False.", found="True", reason=obstacle
        )


def find_noisy_obstacle(system: System, name: str) -> str:
    """Why a method does not follow the noise of a system, as a clause; "" where it does.

    Args:
        system: The System.
        name: One of `coadjoint.methods.NOISY`.
    """
    marks = {"spherical_midpoint": "SPHERES", "coadjoint_mean": "ORBITS"}
    if name not in marks:
        return ""
    has_it = KernelModule(system, SOLVER.files[2]).has(marks[name])
    return "" if has_it else f"it expects {NOISY[name].expects}"


def find_series_obstacle(
    system: System, stepwise: str, rtol: float, members: int, *, is_auto: bool
) -> str:
    """Why the method of Taylor does not apply, as a clause; "" where it does.

    Args:
        system: The System.
        stepwise: Why its steps are made in Python, or "".
        rtol: As given, or the default.
        members: How many trajectories there are.
        is_auto: Whether a method that is slower does not apply either.
    """
    if isinstance(system, FamilySystem):
        if stepwise and stepwise != system.stepwise:
            return f"it needs rates of all orders, and {stepwise}"
        if is_auto and has_roots_at_kinks(system):
            return NO_SERIES
        order = choose_order(rtol, of_waves=is_of_waves(system))
        return tell_series_obstacle(system, order, members, is_auto=is_auto)
    if stepwise:
        return f"it needs rates of all orders, and {stepwise}"
    return NO_SERIES if is_auto and has_roots_at_kinks(system) else ""


def has_roots_at_kinks(system: System) -> bool:
    """Whether rates have kinks and roots, as beads that touch after Hertz: these are 0 at once."""
    module = KernelModule(system, SOLVER.files[2])
    is_family = isinstance(system, FamilySystem)
    has_kinks = "kinks" in system.functions if is_family else module.has("KINKS")
    return has_kinks and bool(module.value("BRANCHES"))
