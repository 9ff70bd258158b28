r"""Lax pairs as matrices of elements: what :math:`\dot L = [L, M]` says, power by power.

Comes in: a Setting and a pair, declared or found. Goes out: one linear equation in the rates of the
state for each entry of each power of the spectral parameter, and the rates that solve them. An
equation too many is not used here; whether all of them hold is a claim of the certificate.
Read next: `coadjoint.derive.routes.lax` and `coadjoint.derive.routes.manakov`, the routes, and
`coadjoint.derive.integrals`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from coadjoint.derive.fields.jets import jets_of
from coadjoint.derive.interpret import Value, entries
from coadjoint.derive.refusals import refusal
from coadjoint.derive.setting import Setting, once
from coadjoint.derive.submanifold import put_on_section
from coadjoint.exact import Element
from coadjoint.exact.dense import Matrix, combine, commutator
from coadjoint.exact.linear import Span
from coadjoint.spec import Formula, Spec
from coadjoint.spec.core.faults import list_names


@dataclass(frozen=True)
class LaxPair:
    """Two square matrices with ``dL/dt = [L, M]`` for every value of the spectral parameter.

    Attributes:
        spectral: Name of the spectral parameter, a symbol of the field.
        L: Affine in the state.
        M: How L turns; it may name velocities.
        texts: L and M as people write them.
        declared: L as the spec declares it; None of a pair that was found.
    """

    spectral: str
    L: Matrix
    M: Matrix
    texts: tuple[str, str]
    declared: Formula | None = None


@dataclass(frozen=True)
class LaxEquation:
    """One entry of one power: ``sum of slopes[x] * dx/dt = right``.

    Attributes:
        entry: Row and column, from 1.
        power: Power of the spectral parameter.
        slopes: Coefficients of the rates, by component of the state.
        right: The entry of ``[L, M]`` at that power, and of ``dM/ds`` of fields.
    """

    entry: tuple[int, int]
    power: int
    slopes: dict[str, Element]
    right: Element


@once
def declared_pair(setting: Setting) -> LaxPair:
    """The pair of the table [lax].

    Raises:
        DerivationError: The spectral parameter occurs in a function, or in a sum that divides.
    """
    lax = setting.spec.lax
    assert lax is not None, "the reader asks for a table [lax] on this route"
    spectral = {lax.spectral: setting.field[lax.spectral]}
    L, M = (_read_matrix(setting, formula, spectral) for formula in (lax.L, lax.M))
    for entry in (*entries(L), *entries(M)):
        try:
            setting.field.coefficients(entry, lax.spectral)
        except ValueError as error:
            problem, expected = str(error), f"polynomials in {lax.spectral} and its inverse"
            hint = f"Choose another parameter than {lax.spectral}."
            raise refusal(setting, "lax", problem, lax.spectral, expected, hint) from None
    texts = lax.L.in_one_line, lax.M.in_one_line
    return LaxPair(spectral=lax.spectral, L=L, M=M, texts=texts, declared=lax.L)


def find_matrix_at(setting: Setting, value: Fraction) -> dict[tuple[int, int], Element]:
    """The entries of L that are not 0 with a number in the place of the spectral parameter.

    Raises:
        DerivationError: L has a pole there.
    """
    pair, field, found = declared_pair(setting), setting.field, dict[tuple[int, int], Element]()
    for i, row in enumerate(pair.L):
        for j, entry in enumerate(row):
            powers = field.coefficients(entry, pair.spectral)
            if value == 0 and min(powers, default=0) < 0:
                problem, expected = f"L has a pole at {pair.spectral} = 0", "a value without one"
                raise refusal(setting, "lax", problem, "0", expected, "Remove 0 from values.")
            terms = (x * value**power for power, x in powers.items())
            if whole := field.sum(terms):
                found[i, j] = whole
    return found


def symbols(spec: Spec) -> tuple[str, ...]:
    """The spectral parameter of a declared pair."""
    return (spec.lax.spectral,) if spec.lax is not None else ()


def _read_matrix(setting: Setting, formula: Formula, named: Mapping[str, Value]) -> Matrix:
    """A declared matrix, on the section of a restricted motion."""
    rows: Matrix = setting.value(formula, named)
    return tuple(tuple(put_on_section(setting, x) for x in row) for row in rows)


def lax_equations(setting: Setting, pair: LaxPair) -> Iterator[LaxEquation]:
    """Every equation that ``dL/dt = [L, M]`` stands for, the powers ascending in each entry.

    Of fields it is that of zero curvature, ``dL/dt - dM/ds = [L, M]``.
    """
    field = setting.field
    turned = commutator(pair.L, pair.M)
    if setting.spec.space is not None:  # of fields it is dL/dt - dM/ds = [L, M]
        jets = jets_of(setting)
        moved = tuple(tuple(map(jets.total, row)) for row in pair.M)
        turned = combine((1, turned), (1, moved))
    for i, row in enumerate(pair.L):
        for j, entry in enumerate(row):
            moving = [name for name in setting.state if name in field.reach(entry)]
            parts = {
                name: field.coefficients(field.derivative(entry, name), pair.spectral)
                for name in moving
            }
            rights = field.coefficients(turned[i][j], pair.spectral)
            for power in sorted(rights.keys() | {p for part in parts.values() for p in part}):
                slopes = {name: part[power] for name, part in parts.items() if power in part}
                right = rights.get(power, field.zero)
                yield LaxEquation((i + 1, j + 1), power, slopes, right)


def rates_of(setting: Setting, pair: LaxPair, route: str) -> tuple[Element, ...]:
    """The rates of the state by the equations that determine them, as few as there need be.

    Raises:
        DerivationError: L is not affine in the state, or does not determine some component.
    """
    field, rows = setting.field, list[LaxEquation]()
    span = Span()
    for equation in lax_equations(setting, pair):
        _check_affine(setting, equation, route)
        if equation.slopes:
            span.add(equation.slopes)
            rows.append(equation)  # the span numbers dependent equations, too
    rates: dict[str, Element] = {}
    for name in setting.state:
        combination = span.coordinates({name: field.one})
        if combination is not None:
            rates[name] = field.sum(rows[n].right * value for n, value in combination.items())
    missing = [name for name in setting.state if name not in rates]
    if missing:
        raise refusal(
            setting,
            route,
            f"L does not determine {list_names(missing)}",
            list_names(missing),
            "an L in which every component of the state occurs, independently of the others",
            "Put it into L.",
        )
    return tuple(rates[name] for name in setting.state)


def _check_affine(setting: Setting, equation: LaxEquation, route: str) -> None:
    """The derivatives of L by the state are constants of the motion: parameters alone."""
    for name, slope in equation.slopes.items():
        inside = setting.field.reach(slope) & set(setting.state)
        if inside:
            row, column = equation.entry
            raise refusal(
                setting,
                route,
                f"the entry ({row}, {column}) of L is not affine in the state: its derivative by "
                f"{name} depends on {list_names(sorted(inside))}",
                list_names(sorted(inside)),
                "an L that is affine in the state",
                "Choose the entries of L as variables.",
            )


def text_of_entry(entry: tuple[int, int], power: int, spectral: str) -> str:
    """``the entry (1, 2) at lambda^2``."""
    return f"the entry ({entry[0]}, {entry[1]}) at {spectral}^{power}"
