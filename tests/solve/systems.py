"""Small systems written by hand, rendered into folders: what the shipped ones do not show."""

from __future__ import annotations

from pathlib import Path

from coadjoint.declared import KernelContext, Quantity
from coadjoint.lower.program import Program
from coadjoint.render.kernels import render_system
from coadjoint.solve.folders import load_folder
from coadjoint.solve.system import System
from tests.programs import PENDULUM, program


def one_variable(name: str, rate: str, slope: str) -> KernelContext:
    """The equation ``dy/dt = rate``."""

    def function(name: str, text: str, shape: tuple[int, ...]) -> Program:
        return program(name, "y", "", "", text, shape)

    return KernelContext(
        name=name,
        spec=f"derivations/{name}.toml",
        license="",
        routes=("Typed by hand.",),
        equations=(f"dy/dt = {rate}",),
        state=(Quantity("y", (), "1", ("y",)),),
        parameters=(),
        observables=(Quantity("size", (), "1", ("size",)),),
        programs=(
            function("rhs", rate, (1,)),
            function("jacobian", slope, (1, 1)),
            function("energy", "y", ()),
            function("observables", "sqrt(y*y)", (1,)),
        ),
    )


#: Reaches infinity at t = 1/y(0).
POLE = one_variable("pole", "y*y", "2*y")
#: Reaches y = 0 at t = 2 sqrt(y(0)), where the rates stop being real.
EMPTYING = one_variable("emptying", "-sqrt(y)", "-(1/2)/sqrt(y)")
#: Relaxes in 1e-6 s: explicit methods need many steps.
STIFF = one_variable("stiff", "1 - 1000000*y", "-1000000")


def two_variables(name: str, state: str, rates: str, jacobian: str) -> KernelContext:
    """Two equations of first order in two scalars and one parameter, g."""

    def function(name: str, text: str, shape: tuple[int, ...]) -> Program:
        return program(name, state, "g", "", text, shape)

    first, second = state.split()
    pairs = zip((first, second), rates.split("; "), strict=True)
    return KernelContext(
        name=name,
        spec=f"derivations/{name}.toml",
        license="",
        routes=("Typed by hand.",),
        equations=tuple(f"d{name}/dt = {rate}" for name, rate in pairs),
        state=tuple(Quantity(each, (), "1", (each,)) for each in (first, second)),
        parameters=(Quantity("g", (), "1", ("g",), (1.0,)),),
        observables=(
            Quantity("energy", (), "1", ("energy",), conserved=True),
            Quantity("square", (), "1", ("square",)),
        ),
        programs=(
            function("rhs", rates, (2,)),
            function("jacobian", jacobian, (2, 2)),
            function("energy", f"{second}*{second}/2", ()),
            function("observables", f"{second}*{second}/2; {first}*{first}", (2,)),
        ),
    )


#: A fall from rest: y = y0 - g t^2/2.
FALL = two_variables("fall", "y v", "v; -g", "0; 1; 0; 0")
#: x = sin(t) from (0, 1).
OSCILLATOR = two_variables("oscillator", "x v", "v; -g*x", "0; 1; -g; 0")
#: The angle of a pendulum.
SWING = two_variables("swing", "q p", "p; -g*sin(q)", "0; 1; -g*cos(q); 0")


def build(context: KernelContext, folder: Path) -> System:
    """A System in a folder of its own."""
    place = folder / context.name
    place.mkdir()
    for file, text in render_system(context).items():
        (place / file).write_text(text)
    return load_folder(place)


def pendulum(folder: Path) -> System:
    """A pendulum with friction, in sin, cos and exp."""
    return build(PENDULUM, folder)
