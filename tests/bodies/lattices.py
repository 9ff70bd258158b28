"""Lattices of strands: specs of both, and numbers of their generic bodies."""

from functools import cache
from pathlib import Path

import numpy as np
import sympy

from coadjoint.bodies import write_lattice
from coadjoint.derive import derive
from coadjoint.derive.indexed import derive_family
from coadjoint.spec.reader import read_spec_text
from tests.specs import shipped

CHAIN = shipped("spin_chain").path.read_text(encoding="utf-8")
ROD = shipped("se3_strand").path.read_text(encoding="utf-8")
STIFF = "- dot(Xi, diag(K)*Xi)/2"


#: What makes the chain one of tops in a field that is given along it.
TOPS = (
    (
        "[parameters]\n",
        'Gamma = { role = "advected", representation = "vector" }\n\n[parameters]\n'
        "w = { default = 1 }\n",
    ),
    (STIFF, f"{STIFF} - w*Gamma[3]"),
    ('"energy", "P"', '"energy"'),
    ("[profiles]\n", '[profiles]\nGamma = "vector(sin(2*pi*s/L), 0, cos(2*pi*s/L))"\n'),
)


#: What makes the rod one between ends; its momentum along itself is then not claimed.
FREE = (("order = 4", 'order = 4, ends = "free"'), ('"energy", "p"', '"energy"'))


def rod(*changes):
    """The elastic rod with some pieces replaced, each of which is there."""
    return strand(*changes, name="rod", text=ROD)


def strand(*changes, name="chain", text=CHAIN):
    """The spin chain with some pieces replaced, each of which is there."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return read_spec_text(text, Path(f"{name}.toml"))


def lattice_of(declared, bodies=16):
    """The lattice of a strand, read."""
    return read_spec_text(write_lattice(declared, bodies), Path("lattice.toml"))


def family_of(declared):
    """The motion of the generic body of a spec."""
    return derive_family(derive(declared, "lie-poisson"))


@cache
def family_of_chain(*changes):
    """That of the lattice of the spin chain with some pieces replaced, made once in a process."""
    return family_of(lattice_of(strand(*changes)))


def compile_rates(family, modules="numpy"):
    """A function of states ``(n, N)`` of a ring and of parameters: rates of all bodies."""
    shifts = sorted({n for _, n in family.neighbours})
    near = [family.neighbours.get((x, n), sympy.Dummy()) for n in shifts for x in family.states]
    given = [*family.states, *near, *family.shared]
    function = sympy.lambdify(given, family.rates, modules=modules)

    def rates(state, parameters):
        around = [row for n in shifts for row in np.roll(state, -n, axis=1)]
        found = function(*state, *around, *parameters)
        return np.array([np.broadcast_to(row, state.shape[1:]) for row in found])

    return rates
