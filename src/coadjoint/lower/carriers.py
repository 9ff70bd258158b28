"""Carriers: which sphere's element moves what is reconstructed, and how, decided by Programs.

A step of the spherical midpoint turns each vector by Cayley's transform of an element ``h s xi``, s
the quotient of lengths of its sphere. On rows g with rates ``L(m) g``, the state held at m, the
same turn is that of ``(1 - b L/2)^-1 (1 + b L/2)``. With the speed w of the turn, rows of vectors
and of matrices have ``L^3 = -w^2 L`` and ``b = h s``. Rows of unit quaternions turn by half the
angle, ``L^2 = -w^2/4``, and ``b = 2 h s/(1 + sqrt(1 + t^2))`` with ``t = h s w/2``, by the tangent
of half an angle.
Comes in: the functions of a solver with what is reconstructed. Goes out: a `Carrier` for each group
of rows that move together.
Read next: `coadjoint.solve.methods.spherical_midpoint`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction

from coadjoint.exact.residues import Residue, call_modulo, vanish
from coadjoint.lower.evaluation import run
from coadjoint.lower.program import Program, list_names
from coadjoint.methods import Carrier, Sphere


def find_carriers(
    programs: Mapping[str, Program], spheres: Sequence[Sphere], scales: Sequence[Fraction]
) -> tuple[Carrier, ...]:
    """A carrier for each group of rows below the state; none where some rows have none.

    Args:
        programs: The functions of the solver by name, ``rates`` with the rows below those of the
            state, in which these are linear.
        spheres: Those of the motion.
        scales: By what multiple of the cross product each of them has its bracket.
    """
    rates, slopes = programs["rates"], programs["energy_gradient"]
    found = list[Carrier]()
    for rows in _list_groups(rates, len(slopes.state)):
        for place, (sphere, scale) in enumerate(zip(spheres, scales, strict=True)):
            square = float(scale * scale)
            carriers = (Carrier(place, rows, is_half, square) for is_half in (False, True))
            fit = next(
                (each for each in carriers if _is_turned(rates, slopes, each, sphere, scale)), None
            )
            if fit is not None:
                found.append(fit)
                break
        else:
            return ()
    return tuple(found)


def _list_groups(rates: Program, known: int) -> list[tuple[int, ...]]:
    """Rows below the first ones, together where the rate of one reads another."""
    below = rates.state[known:]
    reads: dict[str, set[str]] = {name: {name} for name in below}
    for statement in rates.statements:
        reads[statement.name] = _list_reads(statement.value, reads)
    groups = list[set[str]]()
    for name, output in zip(below, rates.outputs[known:], strict=True):
        whole = {name} | _list_reads(output.value, reads)
        apart = [each for each in groups if not each & whole]
        groups = [*apart, whole.union(*(each for each in groups if each & whole))]
    places = {name: known + place for place, name in enumerate(below)}
    return sorted(tuple(sorted(places[name] for name in each)) for each in groups)


def _list_reads(value: object, reads: Mapping[str, set[str]]) -> set[str]:
    """What of some names a value reads, by what statements before it read."""
    names = list_names(value)  # type: ignore[arg-type]
    return set[str]().union(*(reads.get(name, set()) for name in names))


def _is_turned(
    rates: Program, slopes: Program, carrier: Carrier, sphere: Sphere, scale: Fraction
) -> bool:
    """Whether rows move as vectors or quaternions do that the element of a sphere turns."""
    names = [rates.state[row] for row in carrier.rows]

    def find(at: dict[str, Residue], number: Callable[..., Residue]) -> Iterator[Residue]:
        zero, xi = number(0), run(slopes, at, number, call_modulo)
        speed = sum((xi[k] * xi[k] for k in sphere.turning), zero) * number(scale * scale)
        still = at | dict.fromkeys(rates.state[len(slopes.state) :], zero)
        columns = [
            [run(rates, still | {name: number(1)}, number, call_modulo)[k] for k in carrier.rows]
            for name in names
        ]
        matrix = [*map(list, zip(*columns, strict=True))]
        power = _multiply(matrix, matrix, zero)
        if not carrier.is_half:
            power = _multiply(power, matrix, zero)
        for i, row in enumerate(power):
            for j, entry in enumerate(row):
                own = speed * (
                    number(Fraction(int(i == j), 4)) if carrier.is_half else matrix[i][j]
                )
                yield entry + own

    return vanish(find, {*rates.names, *slopes.names})


def _multiply(
    one: Sequence[Sequence[Residue]], other: Sequence[Sequence[Residue]], zero: Residue
) -> list[list[Residue]]:
    """A product of matrices."""
    columns = [*zip(*other, strict=True)]
    return [
        [sum((a * b for a, b in zip(row, column, strict=True)), zero) for column in columns]
        for row in one
    ]
