"""Constraints: what is claimed of them, of the solve in the kernel, and of two routes.

Comes in: a constrained motion, or Equations by two routes with accelerations. Goes out: claims for
the certificate. Read next: `coadjoint.prove.claims`.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from coadjoint.derive import Equations
from coadjoint.derive.mechanics.configuration import LARGEST_BLOCK
from coadjoint.derive.mechanics.distribution import Distribution
from coadjoint.derive.mechanics.kinematics import rate_name
from coadjoint.derive.mechanics.solution_defects import solution_defects
from coadjoint.exact import Element, element_text
from coadjoint.exact.dense import determinant
from coadjoint.exact.ranks import generic_rank, source_of_ranks
from coadjoint.exact.witness import is_entire
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.constrained import ConstrainedRates, list_products
from coadjoint.prove.zero import Decision, Examined

#: Why a loop solves its equations.
LOOPS = (
    "L D L^T of any symmetric matrix whose leading minors are not zero, with both substitutions "
    "(Golub and Van Loan, Matrix Computations, 4th ed., sec. 4.1.2)"
)
#: Characters of a determinant that a statement shows.
SHORT = 60


def about_constraints(motion: ConstrainedRates) -> Iterator[Examined]:
    """The constraints, and the solve in the kernel."""
    distribution = motion.distribution
    if distribution.equations:
        count = len(distribution.equations)
        text = f"the {count} constraints are" if count > 1 else "the constraint is"
        rank, decision = _rank(distribution)
        yield f"{text} independent: {rank}", "constraint", lambda: decision
    matrix, factored = "B^T M B", "L D L^T"
    if not all(solve.symmetric for solve in motion.equations.exact.solves):
        matrix, factored = "[[B^T M B, A^T + C], [A, 0]], with forces k + C lambda", "W U"
    solved = f"the kernel solves for the accelerations: {factored} = {matrix}"
    yield from about_loops(motion.equations, solved, "constraint")
    solves = motion.equations.exact.solves
    if not solves or not all(solve.is_loop for solve in solves):
        yield solved, "constraint", lambda: _solve_defects(motion.equations)


def about_loops(equations: Equations, text: str, kind: str) -> Iterator[Examined]:
    """That loops of the kernel solve their equations, which they do for any matrix."""
    sizes = [len(each.block) for each in equations.exact.solves if each.is_loop]
    if sizes:
        rows = " and ".join(map(str, sizes))
        decision = Decision(verdict=Verdict.PROVED, method=LOOPS)
        yield f"{text}, by a loop over {rows} rows", kind, lambda: decision


def about_kept(motion: ConstrainedRates) -> Iterator[Examined]:
    """That constraints which give no velocity keep their values."""
    for equation, residual in motion.kept:
        yield (
            f"the motion keeps {equation.name}",
            "constraint",
            partial(_residual_rate, motion, residual),
        )


def _residual_rate(motion: ConstrainedRates, residual: Element) -> list[Element]:
    return [motion.rate(residual)]


def _rank(distribution: Distribution) -> tuple[str, Decision]:
    """The rank of A, which the derivation has refused to be less, where it is certain, and how."""
    field, rank = distribution.setting.field, f"rank {len(distribution.equations)}"
    rows = [{k: e for k, e in enumerate(row) if e != 0} for row in distribution.A]
    assert generic_rank(field, rows) == len(rows), "distribution refuses these"
    if not distribution.kept:
        minor = Decision(verdict=Verdict.PROVED, method="a minor of A that is 1 or -1")
        return f"{rank} everywhere, each gives a velocity", minor
    gram = _gram(distribution)
    text = "" if gram is None else element_text(field, gram)
    if gram is None or len(text) > SHORT:
        entire = is_entire(field, (entry for row in rows for entry in row.values()))
        where = "almost every point" + ("" if entire else " of a connected part of the domain")
        method = f"rank of A {source_of_ranks(field, (rows, len(rows)))}"
        return f"{rank} at {where}", Decision(verdict=Verdict.PROVED, method=method)
    where = "everywhere" if field.as_number(gram) is not None else f"wherever {text} is not 0"
    method = "det(A A^T) of the constraints that give no velocity"
    return f"{rank} {where}", Decision(verdict=Verdict.PROVED, method=method)


def _gram(distribution: Distribution) -> Element | None:
    """``det(A A^T)`` of the constraints that are kept, in the velocities of the state.

    Over the real numbers it is zero exactly where these depend on each other. None of more than
    three, whose determinant would fill a page.
    """
    products = list_products(distribution)
    if len(products) > LARGEST_BLOCK:
        return None
    return distribution.setting.field.normal(determinant(products))


def _solve_defects(first: Equations) -> list[Element]:
    """What vanishes if the definitions solve the linear equations."""
    definitions = dict(first.exact.definitions)
    return [
        defect
        for solve in first.exact.solves
        for defect in solution_defects(first.setting.field, solve, definitions)
    ]


def same_accelerations(first: Equations, other: Equations) -> list[Element]:
    """Accelerations that another route writes out, put into the linear equations of the first.

    The matrix of these equations is regular, so that they have no other solution.
    """
    field, state = first.setting.field, first.setting.state
    given = {rate_name(x): other.close(b) for x, b in zip(state, other.exact.rates, strict=True)}
    linear, defects = _linear_equations(first), dict[str, Element]()
    for (name, by), entry in linear.items():
        known = defects.get(name, field.zero)
        defects[name] = known + entry * given[by] if by else known - entry
    free = [
        first.close(a) - given[rate_name(x)]
        for x, a in zip(state, first.exact.rates, strict=True)
        if rate_name(x) not in defects
    ]
    return [*defects.values(), *free]


def same_solves(first: Equations, other: Equations) -> list[Element]:
    """Differences of the linear equations of two routes, of the rates and of the reactions.

    The equations are compared entry by entry, for any blocks that each route has found in them.
    Reactions, and rates of velocities that constraints give, rest on their solution; they are
    compared where both routes have them.
    """
    one, two = _linear_equations(first), _linear_equations(other)
    field = first.setting.field
    defects = [one.get(at, field.zero) - two.get(at, field.zero) for at in {**one, **two}]
    solved = {name for solve in first.exact.solves for name in solve.names}
    for x, a, b in zip(first.setting.state, first.exact.rates, other.exact.rates, strict=True):
        if rate_name(x) in solved:  # each is what its own equations are solved for
            defects += [a - field[rate_name(x)], b - field[rate_name(x)]]
        else:
            defects.append(first.close(a) - other.close(b))
    resting, others = (ConstrainedRates(each).resting for each in (first, other))
    return defects + [resting[name] - others[name] for name in resting if name in others]


def _linear_equations(equations: Equations) -> dict[tuple[str, str], Element]:
    """A and b of all solves in the state: entries by the names of row and column, "" for b."""
    slopes = dict[tuple[str, str], Element]()
    for solve in equations.exact.solves:
        for name, row, known in zip(solve.names, solve.matrix, solve.known, strict=True):
            entries = zip((*solve.names, ""), (*row, known), strict=True)
            slopes |= {(name, by): equations.close(entry) for by, entry in entries}
    return slopes
