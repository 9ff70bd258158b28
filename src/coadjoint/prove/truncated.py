r"""Claims about matrices on a surface of any number of rows N.

For a few N the motion is written out on the dual of u(N), and all claims are proved as of every
other system; there it is decided as well that the rates by structure constants are the commutator
:math:`\dot W = [W, V]`, which loops compute. What follows from this form holds for every N:

* the Jacobi identity, and that the N traces of powers of W are Casimirs, and all there are
  (`coadjoint.prove.unitary`);
* the energy :math:`h = -\tfrac12 \mathrm{tr}(W V)` has the rate :math:`-\mathrm{tr}(V [W, V]) = 0`,
  since L, of which V is the inverse times W, has a symmetric matrix on each diagonal.

On the torus it is decided as well that the rates are those by the sine bracket of waves
(`coadjoint.derive.sine_bracket`), for the least N, and that waves have this bracket, for every N.

Comes in: the certificates of a few N. Goes out: one certificate, in which each claim says for which
N it holds. Read next: `coadjoint.derive.truncated`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter

from coadjoint.derive import derive
from coadjoint.derive.sine_bracket import multiply_waves
from coadjoint.derive.truncated import derive_truncated, multiply_out
from coadjoint.prove.certificate import Certificate, Claim, Verdict
from coadjoint.prove.unitary import claim_sine_bracket, list_claims
from coadjoint.prove.zero import decide_zero, make_entry
from coadjoint.spec.model import Spec

_ALGEBRA = "the algebra u(N) satisfies the Jacobi identity"
#: What is said of all Casimirs of a few N; each of these N has other ones.
_COMPLETE = "every Casimir is a function of the "


def extend_truncated(spec: Spec, certificates: Sequence[Certificate]) -> Certificate:
    """The certificate of all numbers of rows.

    Args:
        spec: With a table [truncation].
        certificates: Of the few that are written out, in their order, without searches.

    Raises:
        DerivationError: The inertia is no multiple of that of degree 1, which is written out.
    """
    derive_truncated(derive(spec))
    family = spec.family
    assert family is not None, spec.name
    few = _list_few(spec, family.windows)
    own = [[c for c in each.claims if c.kind != "casimir"] for each in certificates]
    assert len({tuple(c.kind for c in each) for each in own}) == 1, spec.name
    claims = [_join(same, few) for same in zip(*own, strict=True)]
    claims.append(_join_complete(spec, certificates))
    claims.append(_compare_products(spec, few))
    if family.index.surface == "torus":
        claims.append(_compare_waves(spec))
    if all(claim.verdict is Verdict.PROVED for claim in claims):
        claims = [claim for claim in claims if claim.kind != "conserved"] + _follow(spec, few)
    return Certificate(spec.name, tuple(claims))


def _list_few(spec: Spec, windows: Sequence[Spec]) -> str:
    """The numbers of rows of some that are written out: ``N = 3 and 4``."""
    family = spec.family
    assert family is not None, spec.name
    sizes = [str(family.index.find_size(len(each.state))) for each in windows]
    return f"{family.index.name} = {' and '.join(sizes)}"


def _join(same: Sequence[Claim], few: str) -> Claim:
    """One claim from those of the few, of which the weakest decides."""
    order = (Verdict.REFUTED, Verdict.SUPPORTED, Verdict.PROVED)
    worst = min(same, key=lambda claim: order.index(claim.verdict))
    statement = _ALGEBRA if worst.kind == "algebra" else worst.statement
    seconds = sum(claim.seconds for claim in same)
    return replace(worst, statement=f"{statement}, for {few}", seconds=seconds)


def _join_complete(spec: Spec, certificates: Sequence[Certificate]) -> Claim:
    """That all Casimirs are known, where those of all degrees are found: degree 5 is not."""
    family = spec.family
    assert family is not None, spec.name
    found, windows = list[Claim](), list[Spec]()
    for window, certificate in zip(family.windows, certificates, strict=True):
        told = [c for c in certificate.claims if c.statement.startswith(_COMPLETE)]
        count = family.index.find_size(len(window.state))
        known = f"{_COMPLETE}{count} known, near almost every point"
        assert [c.statement for c in told] in ([], [known]), told
        found += told
        windows += [window] * len(told)
    assert found, spec.name
    statement = f"{_COMPLETE}{family.index.name} known, near almost every point"
    same = [replace(each, statement=statement) for each in found]
    return _join(same, _list_few(spec, windows))


def _compare_products(spec: Spec, few: str) -> Claim:
    """Structure constants and products of matrices give one motion."""
    assert spec.family is not None, spec.name
    start = perf_counter()
    for window in spec.family.windows:
        equations = derive(window, spec.routes[0])
        rates = map(equations.close, equations.exact.rates)
        pairs = zip(rates, multiply_out(equations), strict=True)
        decision = decide_zero([a - b for a, b in pairs], equations.setting.field)
        if decision.verdict is not Verdict.PROVED:
            break
    statement = f"the rates are the commutator [W, V] of matrices, V = dh/dW, for {few}"
    claim = make_entry(statement, "equivalence", decision, perf_counter() - start)
    assert isinstance(claim, Claim), claim
    return claim


def _compare_waves(spec: Spec) -> Claim:
    """Structure constants of matrices and the sine bracket of waves give one motion."""
    family = spec.family
    assert family is not None, spec.name
    start, window = perf_counter(), family.windows[0]
    equations = derive(window, spec.routes[0])
    rates = map(equations.close, equations.exact.rates)
    waves = multiply_waves(equations, family.truncation, family.index.name)
    pairs = zip(rates, waves, strict=True)
    decision = decide_zero([a - b for a, b in pairs], equations.setting.field)
    statement = (
        "the rates are those by the sine bracket, where dw_k/dt is the sum of "
        f"2 sin(2 pi*(m x n)/N) w_m v_n over m + n = k, for {_list_few(spec, [window])}"
    )
    claim = make_entry(statement, "equivalence", decision, perf_counter() - start)
    assert isinstance(claim, Claim), claim
    return claim


def _follow(spec: Spec, few: str) -> list[Claim]:
    """What follows for every number of rows from the form of the motion."""
    assert spec.family is not None, spec.name
    rows, least = spec.family.index.name, spec.family.least
    odd = "odd " * (not spec.family.index.allows(least + 1))
    scope = f"for every {odd}{rows} >= {least}"
    found = list_claims(spec.family.windows[0].invariance, scope, rows)
    if spec.family.index.surface == "torus":
        found.append(claim_sine_bracket(scope, rows))
    return [
        *found,
        Claim(
            statement=f"the energy is conserved, {scope}",
            kind="conserved",
            verdict=Verdict.PROVED,
            method="V = dh/dW as L is symmetric on each diagonal, and tr(V [W, V]) = 0; its rate "
            f"vanishes by normal forms, for {few}",
        ),
    ]
