"""Noise: the table [noise], Hamiltonians of Wiener processes.

With ``dW1 = "h1"`` the motion is ``dx = {x, h} dt + {x, h1} o dW1``, in the sense of Stratonovich.
Comes in: Hamiltonians by the names of their processes. Goes out: `Noise` records.
Read next: `coadjoint.derive.mechanics.noise`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from coadjoint.errors import CoadjointError
from coadjoint.spec.core.formulas import Formula
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.reading import Reading, Table, name_each
from coadjoint.spec.core.shapes import words
from coadjoint.spec.core.source import Source
from coadjoint.spec.sections.variables import VARIABLES, state_roles

#: Tables that speak of a motion without noise, and why.
_BOUND = (
    "{x, h_k} may move positions otherwise than the constraints allow, and what reactions leave of "
    "it is given by no bracket that satisfies the Jacobi identity"
)
_WITHOUT = {
    "constraints": _BOUND,
    "rolling": _BOUND,
    "reduction": "a path leaves the section unless each {x, h_k} keeps it, which is not examined",
    "reconstruction": "what follows from the motion is moved by rates, and noise has none",
    **dict.fromkeys(
        ("momenta", "symmetries", "transformations", "charts"),
        "what it claims is claimed of motions without noise",
    ),
}


@dataclass(frozen=True)
class Noise:
    """A Wiener process with a Hamiltonian of its own.

    Attributes:
        name: Of the process.
        formula: The Hamiltonian, a function of state, parameters, inputs and time.
    """

    name: str
    formula: Formula

    @property
    def components(self) -> tuple[str, ...]:
        """Its name."""
        return (self.name,)


def check_noise(source: Source, file: Any) -> None:
    """What speaks of motions without noise is not declared with it.

    Raises:
        SpecError: It is; with the reason.
    """
    for table, reason in _WITHOUT.items():
        if file.noise and getattr(file, table):
            raise source.fault(
                ("noise",),
                f"there are [noise] and [{table}]: {reason}",
                "noise",
                "one of the two",
                f"Remove [{table}], or declare it in a spec of its own, without [noise].",
            )


def read_noise(reading: Reading, texts: Mapping[str, str]) -> tuple[Noise, ...]:
    """The Hamiltonians of the noise, in order.

    Raises:
        SpecError: One is no scalar of the state, or a process has the name of something else.
    """
    scope = reading.scope("a Hamiltonian of noise", state_roles(reading))
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
    """Noise is not declared along a variable, as a force is: neither for x nor for dx."""
    taken = {name for each in VARIABLES.of(reading) for name in (each.name, *each.components)}
    if name in taken or name.removeprefix("d") in taken:
        what = "is a variable" if name in taken else "reads as the change of a variable"
        problem = f"{name!r} {what}, and noise along one need not keep the bracket"
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
