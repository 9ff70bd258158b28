"""Command ``algebra``: what a Lie algebra is, and a proof of it.

Comes in: the name of an algebra, or a spec that declares one. Goes out: bracket table, Killing
signature, rank, Casimirs and the verdict on each claim, as text, as a LaTeX file, as a web page or
as JSON. Read next: `coadjoint.prove.examination`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from math import comb
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from coadjoint import limits
from coadjoint.budget import allowed_seconds
from coadjoint.cli.arguments import (
    complete_algebra,
    format_option,
    is_path,
    output_option,
    seconds_option,
    shipped_names,
    spec_path,
)
from coadjoint.cli.output import find_width, plural, show_text
from coadjoint.sandbox_child import prepared_by, report_progress

if TYPE_CHECKING:
    from coadjoint.algebra import LieAlgebra
    from coadjoint.errors import CoadjointError

#: What --help says beyond the options; \b keeps the lines as they are.
KEYS = """\b
Keys of --format json:
  name, dimension, basis    the names of the basis are those of the coordinates
  blocks                    names for parts of the basis
  brackets                  [{pair: [e_i, e_j], value}] for i < j, those not zero
  killing_signature         [positive, negative, zero]; null with parameters
  properties                abelian, nilpotent, solvable, semisimple, unimodular
  center                    its basis
  derived_series            dimensions of g, [g, g], ... until they repeat
  rank                      of the Lie-Poisson tensor, generic
  casimirs                  {expected, found, missing}; missing says what was
                            searched, or ""
  claims                    [{statement, kind, verdict, method}]
  findings                  [{statement, kind, method, scope, error}]: what was
                            found without a proof; error says how likely it is wrong
"""


@click.command("algebra", epilog=KEYS)
@click.argument("algebra", metavar="NAME|SPEC", shell_complete=complete_algebra)
@format_option("text", "latex", "html", "json")
@click.option(
    "--degree",
    type=click.IntRange(1, 12),
    default=4,
    show_default=True,
    help="Highest degree of the polynomial Casimirs to search, as far as the limits allow.",
)
@click.option(
    "--generators",
    type=click.IntRange(1, limits.GENERATORS),
    default=limits.EXAMINED_GENERATORS,
    show_default=True,
    help="Largest number of generators to accept.",
)
@output_option
@seconds_option
def command(
    algebra: str, form: str, degree: int, generators: int, output: Path | None, seconds: int | None
) -> None:
    """Show and prove invariants and Casimirs of a Lie algebra.

    NAME is an algebra such as so(4), se(3) or "sl(2,R)". SPEC is a shipped system or the path of a
    spec; its advected quantities are included.
    """
    from coadjoint.errors import ResourceError
    from coadjoint.sandbox import run_bounded

    request = {"algebra": algebra, "form": form, "degree": degree, "generators": generators}
    allowed = allowed_seconds(seconds)
    try:
        record = run_bounded(
            "coadjoint.cli.algebra:examination_record",
            request,
            seconds=allowed,
            memory=limits.WORKER_BYTES,
            subject=algebra,
        )
    except ResourceError as error:
        raise ResourceError(
            f"{error} Or use fewer generators, or a lower --degree.",
            **{"found": algebra, **error.parts},
        ) from error
    show_text(_render(record, form, output), output)


def _render(record: Mapping[str, Any], form: str, output: Path | None) -> str:
    """The text of a format."""
    if form == "json":
        import json

        return json.dumps(record, indent=2) + "\n"
    from coadjoint.render.document import WIDTH, render_document

    return render_document(record, form, find_width(output, WIDTH))


@prepared_by("coadjoint.prove.examination")
def examination_record(request: Mapping[str, Any]) -> dict[str, Any]:
    """The examination of an algebra as plain JSON values; runs in a bounded child."""
    from coadjoint.prove.examination import examine

    word, most, degree = request["algebra"], request["generators"], request["degree"]
    report_progress("examine", 0, 1)
    examination = examine(_algebra(word, most, degree), degree)
    return examination.as_record() if request["form"] == "json" else asdict(examination.document())


def _algebra(word: str, most: int, degree: int) -> LieAlgebra:
    """The algebra that a word means: names of algebras go before those of systems."""
    from coadjoint.algebra import algebra_by_name
    from coadjoint.errors import AlgebraError, LimitError

    if is_path(word):
        return _algebra_of_spec(word, most, degree)
    try:
        return algebra_by_name(word, most=most)
    except LimitError as error:
        raise _too_large(word, error.found, most, degree) from None
    except AlgebraError as error:
        if word in shipped_names():
            return _algebra_of_spec(word, most, degree)
        raise _unknown(error, word) from None


def _algebra_of_spec(word: str, most: int, degree: int) -> LieAlgebra:
    """The algebra of a spec, its advected quantities included."""
    from coadjoint.derive import make_setting
    from coadjoint.derive.structure import exact_momentum_algebra
    from coadjoint.errors import AlgebraError
    from coadjoint.spec import read_spec

    spec = read_spec(spec_path(word))
    if spec.algebra is None:
        raise AlgebraError(
            f"{spec.path}: the system declares a bracket and no algebra; expected a table "
            f"[algebra]. `coadjoint prove {word}` examines the bracket.",
            found=word,
        )
    setting = make_setting(spec)
    advected = sum(action.dimension for action in setting.actions.values())
    dimension = setting.algebra.dimension + advected
    if dimension > most:
        raise _too_large(str(spec.path), dimension, most, degree)
    return exact_momentum_algebra(setting)


def _too_large(name: str, dimension: int, most: int, degree: int) -> CoadjointError:
    """The refusal of an algebra, with what it would cost and how to examine it anyway."""
    from coadjoint.errors import LimitError

    pairs, monomials = comb(dimension, 2), comb(dimension + degree, degree) - 1
    way = f"To allow it, use --generators {dimension}"
    if dimension > limits.GENERATORS:
        way = f"At most {limits.GENERATORS} (GENERATORS) can be built; choose a smaller algebra"
    return LimitError(
        f"{name} has {plural(dimension, 'generator')}, {plural(pairs, 'bracket')} between them and "
        f"{plural(monomials, 'monomial')} up to degree {degree}; expected at most {most} "
        f"generators (EXAMINED_GENERATORS is {limits.EXAMINED_GENERATORS}). {way}.",
        found=dimension,
        limit=most,
        brackets=pairs,
        monomials=monomials,
    )


def _unknown(error: CoadjointError, word: str) -> CoadjointError:
    """The refusal of a name, which might have meant a system."""
    from difflib import get_close_matches

    near = [n for n in get_close_matches(word, shipped_names(), n=1) if n not in str(error)]
    hint = f" Or did you mean the system {near[0]!r}?" if near else ""
    return type(error)(f"{error}{hint}", **error.parts)
