"""Command ``new``: a commented spec to start from.

Comes in: a name, and a strand whose lattice of bodies it is to be. Goes out: a file that loads,
proves and runs as it stands, for its owner to edit.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

import click

from coadjoint.cli.arguments import complete_system, seconds_option, spec_path
from coadjoint.cli.output import say
from coadjoint.errors import OutputError, SpecError

STARTER: Final = """\
# A free rigid body, to edit into a system of your own. Try it as it stands:
#     coadjoint prove {name}.toml
#     coadjoint simulate {name}.toml --plot {name}.png
# An editor completes and checks this file after `coadjoint schema > spec.schema.json`, with the
# first line  #:schema spec.schema.json

title = "My system"
source = "book or paper with the equations"
routes = ["euler-poincare", "lie-poisson"] # the first is emitted, the others are proved equal

[algebra]
name = "so(3)"      # or se(3); others are declared by brackets or matrices
invariance = "left" # body frame; "right" is the space frame

[variables]
Omega = {{ role = "velocity", unit = "1/s", doc = "body angular velocity" }}
Pi = {{ role = "momentum", unit = "kg m^2/s", doc = "body angular momentum" }}
# Gamma = {{ role = "advected", representation = "vector", doc = "the vertical" }}

[parameters]
I = {{ shape = [3], positive = true, default = [1, 2, 3], unit = "kg m^2", doc = "inertia" }}

# [definitions] # short names for expressions, with arguments or without
# "potential(z)" = "9.81*z"

[lagrangian] # quadratic in the velocities
l = "dot(Omega, diag(I)*Omega)/2"

[observables] # further quantities to compute
spin = {{ expression = "norm(Omega)", unit = "1/s" }}

[claims] # proved at every regeneration, or refuted with a counterexample
casimirs = ["dot(Pi, Pi)"]
conserved = ["energy"]
"""


@click.command("new")
@click.argument("name")
@click.option(
    "--lattice-of",
    "strand",
    metavar="SYSTEM|SPEC",
    shell_complete=complete_system,
    help="A strand on so(3) or se(3), whose lattice of rigid bodies is written.",
)
@click.option("--bodies", type=click.IntRange(1), help="How many. Default: 16.")
@seconds_option
def command(name: str, strand: str | None, bodies: int | None, seconds: int | None) -> None:
    """Write NAME.toml, a commented spec to start from.

    With --lattice-of it is the spec of the lattice of rigid bodies whose limit a strand is.
    """
    from coadjoint.spec.core.names import system_refusal

    name = name.removesuffix(".toml")
    refusal = system_refusal(name)
    if refusal is not None:
        problem, expected, hint = refusal
        raise SpecError(f"{problem}; expected {expected}. {hint}".rstrip(), found=name)
    if strand is None and bodies is not None:
        raise click.UsageError("--bodies is of a lattice; expected --lattice-of with it.")
    path = Path(f"{name}.toml")
    text = STARTER.format(name=name)
    if strand is not None and not path.exists():
        from coadjoint.bounded import lattice_bounded

        text = lattice_bounded(spec_path(strand), bodies or 16, seconds=seconds)
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        message = f"{path}: the file already exists and was not changed. Choose another name."
        raise SpecError(message, path=str(path), found=name) from None
    except OSError as error:
        raise OutputError(
            f"{path}: cannot be written: {error.strerror}. "
            "Change to a folder that you can write to.",
            path=str(path),
        ) from error
    say(f"{path} written. Next: `coadjoint prove {path}`")
