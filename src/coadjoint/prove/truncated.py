r"""Claims about matrices on the sphere of any number of rows N.

For a few N the motion is written out on the dual of u(N), and all claims are proved as of every
other system; there it is decided as well that the rates by structure constants are the commutator
:math:`\dot W = [W, V]`, which loops compute. What follows from this form holds for every N:

* :math:`\frac{d}{dt} \mathrm{tr}\, W^k = k\, \mathrm{tr}(W^{k-1} [W, V]) = 0`, since the trace of a
  product does not change where factors go round;
* the energy :math:`h = -\tfrac12 \mathrm{tr}(W V)` has the rate :math:`-\mathrm{tr}(V [W, V]) = 0`,
  since L, of which V is the inverse times W, has a symmetric matrix on each diagonal.

Comes in: the certificates of a few N. Goes out: one certificate, in which each claim says for which
N it holds. Read next: `coadjoint.derive.truncated`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter

from coadjoint.derive import derive
from coadjoint.derive.truncated import derive_truncated, multiply_out
from coadjoint.prove.certificate import Certificate, Claim, Verdict
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
    few = _list_few(spec)
    own = [
        [c for c in each.claims if c.kind != "casimir" or c.statement.startswith(_COMPLETE)]
        for each in certificates
    ]
    assert len({tuple(c.kind for c in each) for each in own}) == 1, spec.name
    claims = [_join(spec, same, few) for same in zip(*own, strict=True)]
    claims.append(_compare_products(spec, few))
    if all(claim.verdict is Verdict.PROVED for claim in claims):
        claims = [claim for claim in claims if claim.kind != "conserved"] + _follow(spec, few)
    return Certificate(spec.name, tuple(claims))


def _list_few(spec: Spec) -> str:
    """The numbers of rows that are written out: ``N = 3 and 4``."""
    family = spec.family
    assert family is not None, spec.name
    sizes = [str(family.index.find_size(len(each.state))) for each in family.windows]
    return f"{family.index.name} = {' and '.join(sizes)}"


def _join(spec: Spec, same: Sequence[Claim], few: str) -> Claim:
    """One claim from those of the few, of which the weakest decides."""
    assert spec.family is not None, spec.name
    order = (Verdict.REFUTED, Verdict.SUPPORTED, Verdict.PROVED)
    worst = min(same, key=lambda claim: order.index(claim.verdict))
    statement = _ALGEBRA if worst.kind == "algebra" else worst.statement
    if worst.kind == "casimir":
        counts = [spec.family.index.find_size(len(w.state)) for w in spec.family.windows]
        told = [each.statement.removeprefix(_COMPLETE) for each in same]
        assert told == [f"{n} known, near almost every point" for n in counts], told
        statement = f"{_COMPLETE}{spec.family.index.name} known, near almost every point"
    seconds = sum(claim.seconds for claim in same)
    return replace(worst, statement=f"{statement}, for {few}", seconds=seconds)


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


def _follow(spec: Spec, few: str) -> list[Claim]:
    """What follows for every number of rows from the form of the motion."""
    assert spec.family is not None, spec.name
    rows, least = spec.family.index.name, spec.family.least
    scope = f"for every {rows} >= {least}"
    return [
        Claim(
            statement=f"tr W^k is conserved, k = 1 to {rows}, {scope}",
            kind="conserved",
            verdict=Verdict.PROVED,
            method="its rate is k tr(W^(k-1) [W, V]), in which factors go round",
            seconds=0.0,
        ),
        Claim(
            statement=f"the energy is conserved, {scope}",
            kind="conserved",
            verdict=Verdict.PROVED,
            method="V = dh/dW as L is symmetric on each diagonal, and tr(V [W, V]) = 0; its rate "
            f"vanishes by normal forms, for {few}",
            seconds=0.0,
        ),
    ]
