"""What notebooks show of a spec, of equations, of proofs, of systems and of motions.

Comes in: an object of the package. Goes out: HTML with MathML, without a script or an address.
Modules of these objects import this one when a notebook asks. Read next:
`coadjoint.render.document`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from html import escape
from typing import TYPE_CHECKING, Any, Final

from coadjoint.chapter import proof_sections, section
from coadjoint.notation.written import Written, aligned

if TYPE_CHECKING:
    from coadjoint.algebra import LieAlgebra
    from coadjoint.derive.equations import Equations
    from coadjoint.derive.lines import Line
    from coadjoint.prove.certificate import Certificate
    from coadjoint.prove.examination import Examination
    from coadjoint.solve.quantities import Quantities
    from coadjoint.solve.solution import Solution
    from coadjoint.solve.system import System
    from coadjoint.spec import Spec

#: Dimension of an algebra from which on its brackets are not listed: they fill no page.
LARGEST: Final = 30
#: Dots for an inch of a small picture.
SMALL: Final = 60


def show_spec(spec: Spec) -> str:
    """A spec: its names with their meaning, and its energy."""
    from coadjoint.derive.document import symbol_rows, write_formulas
    from coadjoint.render.document import render_fragment

    about = section(spec.title, "about", law=spec.description)
    lines = [asdict(each) for each in write_formulas(spec)]
    energy = section("", "energy", lines=lines)
    symbols = section("", "symbols", rows=_as_records(symbol_rows(spec)))
    return render_fragment([about, *[energy] * bool(lines), symbols])


def _as_records(rows: Iterable[Sequence[Line | str]]) -> list[tuple[Any, ...]]:
    """Rows of a table, whose formulas are records of their formats."""
    return [tuple(c if isinstance(c, str) else asdict(c) for c in row) for row in rows]


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
    """Claims with their verdicts in sentences, why some fail, and a table of all of them."""
    from coadjoint.derive.document import symbol_rows
    from coadjoint.prove.certificate import failure_text
    from coadjoint.render.document import render_fragment
    from coadjoint.render.prose import list_names

    state = "holds" if certificate.holds else "does not hold"
    failures = [("", failure_text(each)) for each in certificate.failures]
    title = f"{certificate.system}: the certificate {state}"
    parts = [section(title, "failures", words=failures), *proof_sections(certificate.as_record())]
    rows = [] if certificate.spec is None else _as_records(symbol_rows(certificate.spec))
    return render_fragment(parts, list_names([section("", "symbols", rows=rows)]))


def show_examination(examination: Examination) -> str:
    """What was found out about an algebra."""
    from coadjoint.render.document import render_fragment

    return render_fragment(asdict(examination.document())["sections"])


def show_algebra(algebra: LieAlgebra) -> str:
    """The brackets of an algebra."""
    from coadjoint.derive.lines import whole_line
    from coadjoint.notation.names import name
    from coadjoint.prove.examination import take_field, write_brackets
    from coadjoint.render.document import render_fragment

    title = f"{algebra.name}, dimension {algebra.dimension}"
    if algebra.dimension <= LARGEST:
        brackets = asdict(write_brackets(*take_field(algebra)))
        return render_fragment([{**brackets, "title": title}])
    basis = [asdict(whole_line(name(each))) for each in algebra.basis]
    return render_fragment([section(title, "basis", lines=basis)])


def show_quantities(quantities: Quantities) -> str:
    """Quantities: symbol, name, shape, unit and default of each."""
    from coadjoint.notation.names import name, unit
    from coadjoint.render.document import render_fragment

    def write(written: Written) -> dict[str, str]:
        return _as_math(written.mathml)

    (heads, *rows), own = quantities.table(), quantities.values()
    shown = [
        (write(name(label, bold=bool(each.shape))), label, shape, write(unit(each.unit)), default)
        for each, (label, shape, _, default) in zip(own, rows, strict=True)
    ]
    return render_fragment([section("", "quantities", rows=[("symbol", *heads), *shown])])


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


def _show_drift(solution: Solution) -> str:
    """A table of what the motion conserves: its symbol, name, drift and unit."""
    from coadjoint.notation.names import name, unit
    from coadjoint.render.document import render_fragment
    from coadjoint.solve.drift import tell_drift

    rows = list[tuple[Any, ...]]()
    for label in solution.drift:
        number, _, is_absolute = tell_drift(solution, label).partition(" ")
        measured = _as_math(unit(solution.unit(label) or "1").mathml) if is_absolute else "relative"
        rows.append((_as_math(name(label).mathml), label, write_number(number), measured))
    for label, value in solution.attitude_drift.items():
        norm = f"<mrow><mo>|</mo>{name(label, bold=True).mathml}<mo>|</mo></mrow>"
        square = f"<msup>{norm}<mn>2</mn></msup>"
        length = _as_math(f"<mrow>{square}<mo>-</mo><mn>1</mn></mrow>")
        rows.append((length, label, write_number(f"{value:.1e}"), _as_math("<mn>1</mn>")))
    if not rows:
        return ""
    head = ("symbol", "conserved", "largest drift" if solution.batch else "drift", "unit")
    return render_fragment([section("", "quantities", rows=[head, *rows])])


def _as_math(mathml: str) -> dict[str, str]:
    """A cell of a table."""
    return {"mathml": f"<math>{mathml}</math>"}


def write_number(text: str) -> dict[str, str]:
    """A number with its power of ten raised, as a cell of a table.

    >>> write_number("1.5e-12")["mathml"]
    '<math><mrow><mn>1.5</mn><mo>×</mo><msup><mn>10</mn><mn>-12</mn></msup></mrow></math>'
    >>> write_number("0.0e+00")["mathml"]
    '<math><mn>0</mn></math>'
    """
    digits, _, power = text.partition("e")
    if float(text) == 0:
        return _as_math("<mn>0</mn>")
    if not power:  # infinite, or no number
        return _as_math(f"<mtext>{escape(digits)}</mtext>")
    raised = f"<msup><mn>10</mn><mn>{int(power)}</mn></msup>"
    return _as_math(f"<mrow><mn>{digits}</mn><mo>×</mo>{raised}</mrow>")


def show_solution(solution: Solution) -> str:
    """What a solution says, and a small picture where matplotlib is installed."""
    import base64
    import io

    first, *others = solution.describe()
    told = (escape(each).replace(" .. ", " … ") for each in (f"Solution of {first}", *others))
    text = "".join(f"<p>{each}</p>" for each in told)
    text += _show_drift(solution)
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
