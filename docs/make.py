"""Draw docs/pictures, write docs/specs.md, and the schema and all derivations to build/docs.

    python docs/make.py        (or `make docs`)

It runs commands of coadjoint that a reader can type as well.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

import click

from coadjoint.cli import main
from coadjoint.cli.arguments import shipped_names, spec_path
from coadjoint.cli.output import write_text
from coadjoint.spec import read_spec
from coadjoint.spec.page import write_page
from coadjoint.spec.schema import json_schema

ROOT = Path(__file__).resolve().parents[1]
PICTURES = {
    "heavy_top.png": "simulate heavy_top --set I=1,1,0.6 --set m=0.3 "
    "--state Pi=0,0,3 --state Gamma=0.6,0,0.8 --time 20 --plot",
    "gyrostat.png": "simulate examples/gyrostat.toml --state Pi=0.01,1,0.01 --state L=0.2 "
    "--time 60 --plot",
    "chaplygin_ball.png": "simulate chaplygin_ball --time 20 --trace",
    "spin_chain.png": "simulate spin_chain --time 20 --plot",
    "spin_chain_chiral.png": "simulate spin_chain_chiral --time 20 --plot",
    "landau_lifshitz.png": "simulate landau_lifshitz --time 4 --plot",
    "kdv.png": "simulate kdv --time 1.2 --plot",
    "euler_2d.png": "simulate euler_2d --time 20 --plot",
    "zeitlin_su_n.png": "simulate zeitlin_su_n --time 40 --plot",
    "zeitlin_torus.png": "simulate zeitlin_torus --time 20 --plot",
}


def run(words: list[str]) -> None:
    """One command of coadjoint, shown and run."""
    click.echo("coadjoint " + " ".join(words))
    try:
        main(words)
    except SystemExit as end:
        if end.code:
            raise


def draw() -> None:
    """The pictures of the README."""
    for name, words in PICTURES.items():
        run([*words.split(), f"docs/pictures/{name}"])


def write_specs() -> None:
    """The page of all keys of a spec, from its prose and what the readers say."""
    prose = Path("docs/specs.in.md").read_text(encoding="utf-8")
    write_text(Path("docs/specs.md"), write_page(prose))


def write_derivations(folder: Path) -> None:
    """Each derivation of each shipped system as a page and as a LaTeX file."""
    folder.mkdir(parents=True, exist_ok=True)
    for system in shipped_names():
        for route in read_spec(spec_path(system)).routes:
            for form, suffix in (("html", "html"), ("latex", "tex")):
                output = folder / f"{system}-{route}.{suffix}"
                words = ["show", system, "--route", route, "--format", form]
                run([*words, "--output", str(output)])


if __name__ == "__main__":
    os.chdir(ROOT)
    write_specs()
    draw()
    write_derivations(Path("build/docs"))
    write_text(Path("build/docs/spec.schema.json"), json.dumps(json_schema(), indent=2) + "\n")
