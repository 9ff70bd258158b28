r"""Galilean relativity of a declared law: whether all observers in uniform motion share it.

Comes in: Equations whose spec claims it of the forces in [newton]. Goes out: a claim for each of
the four subgroups, whose transformations make the whole group

.. math:: r \mapsto R r + v t + r_0,\quad t \mapsto t + \tau.

A law that names a point or a direction of space, or a velocity by itself, is refuted by the
transformation that shows it, at a point. Read next: `coadjoint.groups.galilean`.

Source:
    Holm (2011), Geometric Mechanics II, sections 1.1 and 1.2.1.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

from coadjoint.derive import Equations, Setting
from coadjoint.derive.interpret import Value
from coadjoint.derive.mechanics.forces import accelerations
from coadjoint.derive.setting import Declared, assemble
from coadjoint.exact import Element
from coadjoint.groups.galilean import (
    Galilean,
    Particles,
    particles,
    subgroups,
    transformation_defects,
)
from coadjoint.prove.motion import Motion
from coadjoint.prove.zero import Decision, Examined, decide_zero, mark_claimed

#: The subgroup that moves time.
SHIFT = "time shift"


def about_galilean(motion: Motion) -> Iterator[Examined]:
    """One claim for each subgroup, if the spec claims Galilean relativity."""
    place = motion.spec.galilean
    if place is not None:
        examined = _about_subgroups(motion.equations)
        yield from mark_claimed(motion.spec, place.path, place, examined, motion.field)


def _about_subgroups(first: Equations) -> Iterator[Examined]:
    """The claims of all subgroups."""
    system, names = _particles(first.setting)
    moved = accelerations(_with_names(first.setting, system, names))
    laws = [moved[n : n + 3] for n in range(0, len(moved), 3)]
    driven = _changes(first.setting, system, laws, names)
    for name, g in subgroups(system).items():
        yield (
            f"Newton's law is the same after a {name} of space and time",
            "galilean",
            partial(_decision, system, laws, g, names, driven if name == SHIFT else ()),
        )


def _decision(
    system: Particles,
    laws: Sequence[Sequence[Element]],
    g: Galilean,
    names: Mapping[str, str],
    changes: Sequence[Element],
) -> Decision:
    """Whether accelerations are carried along; a counterexample has the names of the spec."""
    decision = decide_zero([*transformation_defects(system, laws, g), *changes], system.field)
    spoken = {inner: name for name, inner in names.items()}
    return replace(decision, point={spoken.get(n, n): value for n, value in decision.point.items()})


def _changes(
    setting: Setting, system: Particles, laws: Sequence[Sequence[Element]], names: Mapping[str, str]
) -> list[Element]:
    """How laws depend on time and on inputs, which are not the same after a shift of time."""
    moving = [names[each] for each in setting.driving]
    return [x for law in laws for part in law for x in system.field.gradient(part, moving)]


def _particles(setting: Setting) -> tuple[Particles, dict[str, str]]:
    """Particles for the rows of all coordinates, and what the names of the spec are there."""
    positions, velocities = setting.positions, setting.velocities
    constants = (*setting.parameters, *setting.driving)
    inner = {name: f"{name} of the spec" for name in constants}
    system = particles(len(positions) // 3, tuple(inner.values()), len(setting.field.adjoined))
    for letter, given in (("r", positions), ("v", velocities)):
        inner |= {name: f"{letter}{n // 3 + 1}_{n % 3 + 1}" for n, name in enumerate(given)}
    return system, inner


def _with_names(setting: Setting, system: Particles, names: Mapping[str, str]) -> Setting:
    """The Setting with the symbols of the particles in the place of its own."""
    values: dict[str, Value] = {name: system.field[inner] for name, inner in names.items()}
    spec = setting.spec
    quantities: list[Declared] = [*spec.state, *spec.parameters, *spec.driving]
    for quantity in quantities:
        values[quantity.name] = assemble(quantity, values)
    return Setting(setting.spec, system.field, values)
