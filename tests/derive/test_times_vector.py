"""Tests of the energy's gradient and of the bracket with a vector, the two factors of a motion."""

from __future__ import annotations

import math
import random

import pytest

from coadjoint.derive.formulas import rows_of
from coadjoint.derive.reference import Reference
from coadjoint.lower.evaluation import run
from coadjoint.lower.program import Program
from tests.specs import emitted, lowered

#: Systems over algebras of many kinds, with declared brackets, canonical ones, inputs and time,
#: relaxation, and over distributions.
SYSTEMS = (
    "affine_line",
    "bargmann",
    "bloch_iserles_3",
    "body_of_revolution",
    "chaplygin_ball",
    "chaplygin_sleigh",
    "complex_rigid_body",
    "coupled_bodies",
    "double_bracket_body",
    "euler_disk",
    "gravity_gradient_satellite",
    "heavy_top",
    "heisenberg_lattice",
    "guiding_centre",
    "kapitza_top",
    "kepler",
    "kirchhoff",
    "landau_lifshitz_gilbert",
    "magnetic_bottle",
    "manakov_so6",
    "maxwell_bloch",
    "metriplectic_body",
    "monopole_kepler",
    "point_vortices",
    "rattleback",
    "relativistic_particle",
    "rigid_body_attitude",
    "rocking_disk",
    "roller_racer",
    "se2_pendulum",
    "so5_body",
    "spd_motion_3",
    "sphere_vortices",
    "three_wave",
    "toda_lattice",
    "two_field_top",
    "underwater_vehicle",
)
ROUNDINGS = 1e-11


def call(function, *arguments):
    """An elementary function of numbers."""
    return getattr(math, function)(*arguments)


def draw(program: Program, seed: int) -> dict[str, float]:
    """A point at which the functions of all systems are defined."""
    source = random.Random(seed)
    return {name: source.uniform(0.5, 1.5) for name in program.names}


def find_gaps(system, spoil=None):
    """The rates minus the bracket with the energy's gradient, relative to the rates.

    Of a metriplectic motion G times the gradient of the entropy belongs to them.
    """
    equations, programs = emitted(system), lowered(system)
    reference = Reference(equations)
    gaps = []
    for seed in range(3):
        point = draw(programs["rhs"], seed)
        rates = reference.evaluate("rhs", point, float, call)
        slopes = run(programs["energy_gradient"], point, float, call)
        if spoil is not None:
            slopes[spoil] *= 1.0001
        state = programs["rhs"].state
        vector = dict(zip(programs["bracket_vector"].state[len(state) :], slopes, strict=True))
        found = run(programs["bracket_vector"], point | vector, float, call)
        if "metric_vector" in programs:
            slopes = run(programs["entropy_gradient"], point, float, call)
            vector = dict(zip(programs["metric_vector"].state[len(state) :], slopes, strict=True))
            relaxed = run(programs["metric_vector"], point | vector, float, call)
            found = [a + b for a, b in zip(found, relaxed, strict=True)]
        size = max(map(abs, (*rates, *found)))
        gaps += [abs(a - b) / size for a, b in zip(rates, found, strict=True)]
    return gaps


@pytest.mark.parametrize("system", SYSTEMS)
def test_a_motion_is_the_bracket_with_the_energy(system):
    """Rates by the route are the tensor times the gradient, in every component."""
    gaps = find_gaps(system)
    assert len(gaps) == 3 * len(lowered(system)["rhs"].state) >= 6
    assert max(gaps) < ROUNDINGS


@pytest.mark.parametrize("system", ["heavy_top", "so5_body", "kepler", "metriplectic_body"])
def test_a_spoiled_gradient_is_caught(system):
    """One component that is wrong by one part in 1e4 shows."""
    assert max(find_gaps(system, spoil=1)) > 1e3 * ROUNDINGS


def test_forces_are_not_in_the_bracket():
    """With friction the rates have more than the bracket."""
    assert max(find_gaps("heavy_top_damped")) > 1e-3


@pytest.mark.parametrize(
    "system",
    ["suslov", "tippe_top", "veselova_so4"],
)
def test_other_motions_have_neither(system):
    """Motions with constraints that are kept, or with too long a tensor."""
    equations = emitted(system)
    assert rows_of(equations, "energy_gradient") is None
    assert rows_of(equations, "bracket_vector") is None


@pytest.mark.parametrize("system", ["euler_disk", "chaplygin_ball", "roller_racer"])
def test_tensors_over_distributions_are_antisymmetric(system):
    """``v.J v = 0`` for any v: energy is kept by whatever gradient stands in its place."""
    program = lowered(system)["bracket_vector"]
    count, largest = len(program.state) // 2, 0.0
    for seed in range(3):
        point = draw(program, seed)
        vector = [point[name] for name in program.state[count:]]
        rows = run(program, point, float, call)
        assert abs(sum(a * b for a, b in zip(vector, rows, strict=True))) < 1e-12
        largest = max(largest, *map(abs, rows))
    assert largest > 0.1
