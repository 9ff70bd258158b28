"""What notebooks show of a spec, of equations, of proofs, of systems and of motions.

Comes in: an object of the package. Goes out: HTML with MathML, without a script or an address.
Modules of these objects import this one when a notebook asks. Read next:
`coadjoint.render.document`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from html import escape
from typing import TYPE_CHECKING, Any

from coadjoint.notation.numbers import shorten_numbers
from coadjoint.notation.written import aligned

if TYPE_CHECKING:
    from coadjoint.algebra import LieAlgebra
    from coadjoint.derive.equations import Equations
    from coadjoint.prove.certificate import Certificate
    from coadjoint.prove.examination import Examination
    from coadjoint.solve.solution import Solution
    from coadjoint.solve.system import System
    from coadjoint.spec import Spec

#: Generators of an algebra beyond which a table of its brackets is no help.
LARGEST_TABLE = 10
#: Dots for an inch of a small picture.
SMALL = 60


def table(rows: Iterable[Sequence[str]], heads: Sequence[str]) -> str:
    """A table of texts, which are escaped; what is HTML already starts with ``<math``."""
    cells = [[each if each.startswith("<math") else escape(each) for each in row] for row in rows]
    body = "".join("<tr><td>" + "</td><td>".join(row) + "</td></tr>" for row in cells)
    head = "</th><th>".join(map(escape, heads))
    return f"<table><tr><th>{head}</th></tr>{body}</table>"


def show_spec(spec: Spec) -> str:
    """A spec: its names with their meaning, and its energy."""
    from coadjoint.derive.document import symbol_rows, write_formulas

    (heads, *rows), formulas = symbol_rows(spec), write_formulas(spec)
    shown = [[c if isinstance(c, str) else c.mathml for c in row] for row in rows]
    told = "".join(f"<p>{line.mathml}</p>" for line in formulas)
    lead = f"<p><b>{escape(spec.title)}</b><br>{escape(spec.description)}</p>"
    return f"{lead}{told}{table(shown, [str(head) for head in heads])}"


def show_equations(equations: Equations) -> str:
    """The equations of motion, by vectors as far as these were found."""
    from coadjoint.derive.motion import motion_sections
    from coadjoint.render.document import render_fragment

    return render_fragment([asdict(each) for each in motion_sections(equations)])


def write_equations(equations: Equations) -> str:
    """The same as LaTeX: by vectors where all of these were found, else in components."""
    from coadjoint.derive.motion import vector_lines

    lines = vector_lines(equations)
    shown = aligned(line.latex for line in lines) if lines else equations.latex()
    return f"$\\displaystyle {shown}$"


def show_certificate(certificate: Certificate) -> str:
    """Claims with their verdicts."""
    rows = [
        (each.statement, str(each.verdict), shorten_numbers(each.method))
        for each in certificate.claims
    ]
    state = "holds" if certificate.holds else "does not hold"
    lead = f"<p><b>{escape(certificate.system)}</b>: the certificate {state}.</p>"
    return lead + table(rows, ("claim", "verdict", "method"))


def show_examination(examination: Examination) -> str:
    """What was found out about an algebra."""
    from coadjoint.render.document import render_fragment

    return render_fragment(asdict(examination.document())["sections"])


def show_algebra(algebra: LieAlgebra) -> str:
    """The brackets of an algebra as a table."""
    lead = f"<p><b>{escape(algebra.name)}</b>, dimension {algebra.dimension}</p>"
    basis = algebra.basis
    if len(basis) > LARGEST_TABLE:
        return f"{lead}<p>{escape(', '.join(basis))}</p>"
    rows = [
        (name, *(_write_bracket(algebra, i, j) for j in range(len(basis))))
        for i, name in enumerate(basis)
    ]
    return lead + table(rows, ("[row, column]", *basis))


def _write_bracket(algebra: LieAlgebra, i: int, j: int) -> str:
    """A bracket of two basis vectors as text."""
    sign = 1 if i < j else -1
    row: Mapping[int, Any] = algebra.constants.get((min(i, j), max(i, j)), {})
    terms = []
    for k, constant in row.items():
        factor = {"1": "", "-1": "-"}.get(str(sign * constant), f"{sign * constant} ")
        terms.append(f"{factor}{algebra.basis[k]}")
    return " + ".join(terms).replace("+ -", "- ") or "0"


def show_system(system: System) -> str:
    """A system: its equations of motion, its state, its parameters and what it observes."""
    from coadjoint.render.document import render_fragment

    parts = [f"<p><b>{escape(system.title)}</b> ({escape(system.name)})</p>"]
    if motion := system.certificate.get("motion"):
        parts.append(render_fragment(motion))
    for label in ("STATE", "PARAMETERS", "INPUTS", "OBSERVABLES"):
        quantities = getattr(system, label)
        if quantities:
            parts.append(f"<p>{label.capitalize()}</p>{quantities._repr_html_()}")
    return "".join(parts)


def write_system(system: System) -> str | None:
    """The equations of motion as LaTeX, by vectors where these were found; None without any."""
    lines = [
        line["latex"]
        for part in system.certificate.get("motion", ())
        for line in (part["vectors"] or part["lines"])
    ]
    return f"$\\displaystyle {aligned(lines)}$" if lines else None


def show_solution(solution: Solution) -> str:
    """What a solution says, and a small picture where matplotlib is installed."""
    import base64
    import io

    text = f"<pre>{escape(repr(solution))}</pre>"
    if solution.batch or not len(solution):
        return text
    try:
        from coadjoint.solve.plot import draw

        place = io.BytesIO()
        draw(solution).savefig(place, format="png", dpi=SMALL)
    except Exception:
        return text
    data = base64.b64encode(place.getvalue()).decode("ascii")
    return f'{text}<img alt="the motion" src="data:image/png;base64,{data}">'
