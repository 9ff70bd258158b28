"""Noise: the table [noise], Hamiltonians of Wiener processes.

With ``dW1 = "h1"`` the motion is ``dx = {x, h} dt + {x, h1} o dW1``, in the sense of Stratonovich.
Comes in: Hamiltonians by the names of their processes. Goes out: `Noise` records.
Read next: `coadjoint.derive.mechanics.noise`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from coadjoint.errors import CoadjointError
from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table, name_each
from coadjoint.spec.core.shapes import words
from coadjoint.spec.sections.variables import VARIABLES, state_roles

#: Tables that speak of a motion without noise.
_WITHOUT = (
    "constraints",
    "reduction",
    "rolling",
    "reconstruction",
    "momenta",
    "symmetries",
    "transformations",
    "charts",
    "inputs",
)


@dataclass(frozen=True)
class Noise:
    """A Wiener process with a Hamiltonian of its own.

    Attributes:
        name: Of the process.
        formula: The Hamiltonian, a function of state and parameters.
    """

    name: str
    formula: Formula

    @property
    def components(self) -> tuple[str, ...]:
        """Its name."""
        return (self.name,)


def read_noise(reading: Reading, texts: Mapping[str, str]) -> tuple[Noise, ...]:
    """The Hamiltonians of the noise, in order.

    Raises:
        SpecError: One is no scalar of the state, a process has the name of something else, or
            there is a table that speaks of a motion without noise.
    """
    for table in _WITHOUT:
        if getattr(reading.file, table):
            raise reading.fault(
                ("noise",),
                f"there are [noise] and [{table}], which is for motions without noise",
                "noise",
                "one of the two",
                f"Remove [{table}], or declare it in a spec of its own, without [noise].",
            )
    scope = reading.scope("a Hamiltonian of noise", state_roles(reading), driven=())
    noises = []
    for name, text in texts.items():
        key: KeyPath = ("noise", name)
        _check_name(reading, key, name)
        formula = reading.formula(key, text, scope, any_shape=True)
        if formula.shape:
            raise _explain_field(reading, key, words(formula.shape), text)
        noises.append(Noise(name, formula))
    return tuple(noises)


def _check_name(reading: Reading, key: KeyPath, name: str) -> None:
    """Noise is not declared along a variable, as a force is."""
    if any(name in (each.name, *each.components) for each in VARIABLES.of(reading)):
        problem = f"{name!r} is a variable, and noise along one need not keep the bracket"
        raise reading.at_key(key, problem, name, "the name of a Wiener process", _HINT)


def _explain_field(reading: Reading, key: KeyPath, found: str, text: str) -> CoadjointError:
    """Why the components of a field are no noise."""
    problem = f"this is {found}: a field by its components need not keep the bracket"
    return reading.fault(key, problem, text, "a Hamiltonian, which is a scalar", _HINT)


_HINT = 'Write its Hamiltonian: with {q, p} = 1, dW1 = "-a*q" adds a o dW1 to dp.'

NOISE = Table[tuple[Noise, ...]](
    "noise",
    str,
    "noise by Hamiltonians, dW1 = 'h1' for dx = {x, h} dt + {x, h1} o dW1",
    read_noise,
    many=True,
    names=name_each,
    acts=True,
)
