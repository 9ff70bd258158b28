r"""Time reversal: whether the motion runs backwards when signs of the state change.

The map :math:`(\eta, z) \mapsto (-\eta, z)` of velocities or momenta takes a motion to its reverse
if and only if their rates are even and rates of positions odd in them, and constraints that are
kept hold on both sides. With constraints the kernel solves :math:`\mathcal{M}\,\dot\eta = k`, so
that it is enough that k and :math:`\mathcal{M}` are even. Dissipation, forces linear in
velocities and moving constraints break it. Time and the rates of inputs turn their signs as well.

Where that map does not reverse a free motion, another change of signs S may: :math:`f(Sx) = -S
f(x)`. Its signs :math:`(-1)^{s_k}` solve linear equations modulo 2, one for each monomial
:math:`x^e` of each rate :math:`f_i`, namely :math:`\sum_k e_k s_k = s_i + 1`; where these
contradict each other and rates are polynomials, there is none.
Comes in: a motion. Goes out: a finding for the certificate.
Read next: `coadjoint.prove.constrained`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from coadjoint.derive.mechanics.driving import list_time_reversed
from coadjoint.derive.mechanics.kinematics import rate_name
from coadjoint.derive.setting import once
from coadjoint.exact import Element
from coadjoint.prove.certificate import Verdict
from coadjoint.prove.constrained import ConstrainedRates
from coadjoint.prove.findings import finding, first_nonzero, for_parameters, nonzero_at_a_point
from coadjoint.prove.motion import Motion
from coadjoint.prove.zero import Decision, Examined, decide_zero

#: An equation modulo 2: the places of the unknowns, and the right side.
Parity = tuple[frozenset[str], int]


def about_reversal(motion: Motion) -> Iterator[Examined]:
    """Whether the motion is time reversible."""
    if not _turning_entries(motion):
        values = reversal_defects(motion)
        name, decision = first_nonzero(values, motion.field, motion.where)
        if name and motion.kept:  # a force along a constraint is lost in its reaction
            values = rate_defects(motion)
            name, decision = first_nonzero(values, motion.field, motion.where)
    else:  # normal forms of accelerations with such a matrix take minutes
        values = rate_defects(motion)
        name, decision = nonzero_at_a_point(values, motion.field, motion.where)
    if name and motion.is_explicit and not isinstance(motion, ConstrainedRates):
        examined = _other_signs(motion)
        if examined is not None:
            yield examined
            return
    scope = for_parameters(motion.setting, [values.get(name, motion.field.zero)])
    yield finding(
        "transformation",
        decision,
        f"the motion is time reversible under {_map_text(motion, motion.fibre)}",
        f"the motion is not time reversible under {_map_text(motion, motion.fibre)}{scope}: {name}",
    )


def _map_text(motion: Motion, names: Sequence[str]) -> str:
    """The map in words: ``Pi -> -Pi, t -> -t``."""
    shown = list[str]()
    for each in motion.spec.state:
        turned = [name for name in each.components if name in names]
        shown += [each.name] if len(turned) == len(each.components) else turned
    shown += list_time_reversed(motion.setting)
    text = ", ".join(f"{name} -> -{name}" for name in shown)
    return text + " and inputs run backwards" * bool(motion.setting.inputs)


@once
def rate_defects(motion: Motion) -> dict[str, Element]:
    """What is zero if and only if the motion is reversible: of accelerations, not of forces."""
    field, back = motion.field, _back(motion)
    values = {}
    for name, rate in motion.decidable_rates.items():
        turned = field.substitute(rate, back)
        parity = "even" if name in motion.fibre else "odd"
        defect = rate - turned if name in motion.fibre else rate + turned
        values[f"{rate_name(name)} is not {parity} in them"] = defect
    for name in motion.fibre if motion.solved_velocities else ():
        momentum = motion.in_state(field[name])
        values[f"{name} is not odd in velocities"] = momentum + field.substitute(momentum, back)
    return values | _kept_defects(motion)


@once
def reversal_defects(motion: Motion) -> dict[str, Element]:
    """What is zero if the motion is reversible, by what it is."""
    if not isinstance(motion, ConstrainedRates):
        return rate_defects(motion)
    field, back = motion.field, _back(motion)
    values = {}
    for solve in motion.equations.exact.solves:
        for name, known, row in zip(solve.names, solve.known, solve.matrix, strict=True):
            shares = {f"the force of {name}": known} | {
                f"what {unknown} adds to the equation of {name}": entry
                for unknown, entry in zip(solve.names, row, strict=True)
            }
            for which, part in shares.items():
                value = motion.equations.close(part)
                defect = value - field.substitute(value, back)
                if part is known or defect != 0:
                    values[f"{which} is not even in them"] = defect
    for name, rate in motion.rates.items():
        if name not in motion.fibre:
            values[f"{rate_name(name)} is not odd in them"] = rate + field.substitute(rate, back)
    return values | _kept_defects(motion)


def _turning_entries(motion: Motion) -> bool:
    """Whether a matrix that the kernel solves with depends on what changes its sign.

    It does where a force is proportional to a reaction, and where the Lagrangian is not quadratic
    in the velocities. Then the matrix and the force need not be even if the accelerations are.
    """
    turning = {*_back(motion)}
    rows = (row for solve in motion.equations.exact.solves for row in solve.matrix)
    closed = (motion.equations.close(entry) for row in rows for entry in row)
    return any(motion.field.reach(entry) & turning for entry in closed)


def _kept_defects(motion: Motion) -> dict[str, Element]:
    """What is zero if kept constraints hold on both sides."""
    field, back = motion.field, _back(motion)
    return {
        f"{equation.name} is not odd in them": residual + field.substitute(residual, back)
        for equation, residual in motion.kept
    }


def _back(motion: Motion) -> dict[str, Element]:
    """The map: the signs of velocities or momenta change, and that of time."""
    names = (*motion.fibre, *motion.solved_velocities, *list_time_reversed(motion.setting))
    return {name: -motion.field[name] for name in names}


# -- other signs ----------------------------------------------------------------------------------


def _other_signs(motion: Motion) -> Examined | None:
    """Another change of signs that reverses a free motion; or that none does; else None."""
    field, time = motion.field, {*list_time_reversed(motion.setting)}
    parities, is_complete = _parities(motion, time)
    signs = _solve_parities(parities, motion.setting.state)
    if signs is None:
        if not is_complete:
            return None
        scope = for_parameters(motion.setting, motion.rates.values())
        text = f"no change of signs of the state takes the motion to its reverse{scope}"
        proof = Decision(
            verdict=Verdict.PROVED, method="parities of the monomials of the rates, modulo 2"
        )
        return text, "transformation", lambda: proof
    back = {name: -field[name] for name in (*signs, *time)}
    defects = [
        (-rate if name in signs else rate) + field.substitute(rate, back)
        for name, rate in motion.rates.items()
    ]
    decision = decide_zero(defects, field)
    if decision.verdict is not Verdict.PROVED:
        return None
    text = f"the motion is time reversible under {_map_text(motion, signs)}"
    return text, "transformation", lambda: decision


def _parities(motion: Motion, time: set[str]) -> tuple[list[Parity], bool]:
    """The equations of the signs, and whether every solution must satisfy them.

    Arguments of functions, and denominators, may keep their sign or turn it; only what keeps it is
    searched for, so that a contradiction says nothing where there are such.
    """
    field, state = motion.field, {*motion.setting.state}
    parities, is_complete = list[Parity](), True
    for name, rate in motion.rates.items():
        if rate == 0:
            continue
        (written,) = field.quotients(field.normal(rate).combine())
        inside = [d for d, _ in written.divisors if field.reach(d) & (state | time)]
        called = [u for g in field.functions_in(rate) for u in field.adjoined[g].arguments]
        inside += [argument for argument in called if field.reach(argument) & (state | time)]
        is_complete &= not inside
        for powers in (dict(each.powers) for each in written.monomials):
            odd = frozenset(n for n, e in powers.items() if e % 2)
            right = (1 + len(odd & time)) % 2
            parities.append(((odd & state) ^ {name}, right))
        for element in inside:
            for quotient in field.quotients(field.normal(element).combine()):
                for powers in (dict(each.powers) for each in quotient.monomials):
                    odd = frozenset(n for n, e in powers.items() if e % 2)
                    parities.append((odd & state, len(odd & time) % 2))
    return parities, is_complete


def _solve_parities(parities: Sequence[Parity], state: Sequence[str]) -> list[str] | None:
    """Names whose signs turn, by elimination modulo 2; None where there are none.

    >>> _solve_parities([(frozenset("ab"), 1), (frozenset("a"), 0)], "ab")
    ['b']
    >>> _solve_parities([(frozenset("a"), 1), (frozenset("a"), 0)], "a") is None
    True
    """
    pivots: dict[str, Parity] = {}
    for names, right in parities:
        for pivot, (others, value) in pivots.items():
            if pivot in names:
                names, right = names ^ others, right ^ value
        if not names and right:
            return None
        if names:
            new = min(names, key=list(state).index)
            pivots = {
                pivot: (rest ^ names, value ^ right) if new in rest else (rest, value)
                for pivot, (rest, value) in pivots.items()
            }
            pivots[new] = (names, right)
    return [name for name in state if name in pivots and pivots[name][1]]
