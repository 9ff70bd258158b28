"""Operations of the rates of one member: ours, and those of sympy.cse and symengine.cse.

The peers get what our emitter gets: the rates with the definitions that they rest on, each a
formula in names, and for Chaplygin's ball the linear system for its velocities with the steps that
solve it on such names. Where there is no such system they get the rates written out, too, and the
better counts. What depends on parameters alone is left out for all.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.util import find_spec
from typing import Any

import sympy
from c_kernels import SYSTEMS
from figures import Figure, script

from coadjoint.derive import derive
from coadjoint.derive.formulas import rhs
from coadjoint.lower.lowering import lower
from coadjoint.resources import derivations_folder
from coadjoint.spec import read_spec

#: Names with formulas, in an order in which they can be computed.
Lines = list[tuple[Any, Any]]
#: From formulas to shared ones by name, and the formulas over these.
Cse = Callable[[Sequence[Any]], tuple[Lines, Sequence[Any]]]


def cse_of_symengine(formulas: Sequence[Any]) -> tuple[Lines, Sequence[Any]]:
    """What symengine shares, as SymPy's formulas."""
    import symengine

    shared, reduced = symengine.cse([symengine.sympify(each) for each in formulas])
    pairs = [(sympy.sympify(name), sympy.sympify(value)) for name, value in shared]
    return pairs, [sympy.sympify(value) for value in reduced]


def forms_of(equations: Any) -> list[Lines]:
    """The rates over their definitions; and written out, where nothing is solved for."""
    field, rows = equations.setting.field, rhs(equations)
    definitions = equations.definitions_of(rows.elements)
    over = [
        (sympy.Symbol(name), use_names(field.to_sympy(value)))
        for name, value in (*definitions, *rows.lines)
    ]
    if equations.kept:
        return [over]
    labels = [sympy.Symbol(label) for label, _ in rows.lines]
    return [over, list(zip(labels, map(use_names, equations.rates), strict=True))]


def use_names(formula: Any) -> Any:
    """A formula in symbols that have a name and nothing else."""
    return formula.xreplace({each: sympy.Symbol(each.name) for each in formula.free_symbols})


def count(lines: Lines, state: set[Any], cse: Cse) -> int:
    """Operations of what depends on the state, after sharing; each name is computed once.

    Raises:
        AssertionError: A formula rests on what is not there.
    """
    names, formulas = zip(*lines, strict=True)
    shared, reduced = cse(formulas)
    waiting = [*shared, *zip(names, reduced, strict=True)]
    moving, total = set(state), 0
    while waiting:  # definitions first that others rest on
        unknown = {name for name, _ in waiting}
        known = [(name, value) for name, value in waiting if not value.free_symbols & unknown]
        assert known, waiting
        for name, value in known:
            if value.free_symbols & moving:
                moving.add(name)
                total += int(sympy.count_ops(value))
        waiting = [each for each in waiting if each not in known]
    return total


def measure() -> list[Figure]:
    """Operations of the peers in units of ours."""
    peers: dict[str, Cse] = {"sympy.cse": sympy.cse}
    if find_spec("symengine") is not None:
        peers["symengine.cse"] = cse_of_symengine
    figures = []
    for name in SYSTEMS:
        equations = derive(read_spec(derivations_folder() / f"{name}.toml"))
        ours = sum(lower(equations)["rhs"].operation_counts().values())
        figures.append(Figure(f"{name}: operations of rhs", "none", str(ours)))
        state = set(map(use_names, equations.state))
        for who in ("sympy.cse", "symengine.cse"):
            what = f"{name}: operations by {who}"
            if who not in peers:
                figures.append(Figure(what, "none", "symengine is not installed"))
                continue
            theirs = min(count(lines, state, peers[who]) for lines in forms_of(equations))
            figures.append(Figure(what, "none", f"{theirs}, {theirs / ours:.2f} times ours"))
    return figures


if __name__ == "__main__":
    script(measure)
