"""The Certificate: claims with their verdicts, and findings with their scope.

A claim is asserted by the spec or by the engine, and is proved, refuted or numerically supported. A
finding is what a search, a rank or a count gave: it was not claimed, so that it decides nothing.
Comes in: what the proofs found. Goes out: a frozen record, as a table for people and as JSON for
programs; times are shown and never stored, since generated files are the same bytes everywhere.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from coadjoint.errors import ClaimError

if TYPE_CHECKING:
    from coadjoint.spec import Spec
    from coadjoint.spec.core.source import Place


class Verdict(StrEnum):
    """How a claim was decided.

    A proof is exact: a random point may be a witness in it, but luck plays no part. A refutation
    shows a point where the claim fails. Numerical support means that no proof was found, and no
    point where the claim fails.
    """

    PROVED = "proved"
    REFUTED = "refuted"
    SUPPORTED = "numerically supported"


class Shown(StrEnum):
    """What the number is that a counterexample shows."""

    DIFFERENCE = "the difference"
    RATE_OF_RELATION = "the rate of a relation"
    EIGENVALUE = "the smallest eigenvalue"
    VARIATION = "the variational derivative of the rate"


@dataclass(frozen=True)
class Claim:
    """One statement with its verdict.

    Attributes:
        statement: What is claimed, e.g. ``dot(Gamma, Gamma) is a Casimir``.
        kind: ``algebra``, ``jacobi``, ``legendre``, ``equivalence``, ``reduction``, ``casimir``,
            ``conserved``, ``constraint``, ``integrability``, ``momentum``, ``integrals``,
            ``measure``, ``rolling``, ``lax``, ``galilean``, ``symmetry``, ``bracket``,
            ``noise``, ``posed`` or ``transformation``.
        verdict: Proved, refuted or numerically supported.
        method: How it was decided.
        seconds: How long that took.
        counterexample: Point at which a refuted claim fails, exact values as text; else empty.
        defect: What should have been zero, or not negative, at that point; else empty.
        accepted: Whether the spec that makes this claim accepts numerical support; None for a
            claim of the engine, which never does.
        shown: What the defect is of: of a function on a set that the motion leaves, not the rate
            of the function but that of a relation of the set.
        place: Where the spec makes this claim, or what it is about; None of most claims of the
            engine, which stand nowhere in the spec.
    """

    statement: str
    kind: str
    verdict: Verdict
    method: str
    seconds: float = field(default=0.0, compare=False)
    counterexample: Mapping[str, str] = field(default_factory=dict)
    defect: str = ""
    accepted: bool | None = None
    shown: Shown = Shown.DIFFERENCE
    place: Place | None = field(default=None, compare=False, repr=False)

    @property
    def holds(self) -> bool:
        """Whether the claim is proved, or supported where the spec accepts that."""
        supported = self.verdict is Verdict.SUPPORTED and self.accepted is True
        return supported or self.verdict is Verdict.PROVED

    def as_record(self) -> dict[str, Any]:
        """The claim as JSON values, without the time."""
        record: dict[str, Any] = {
            "statement": self.statement,
            "kind": self.kind,
            "verdict": str(self.verdict),
            "method": f"{self.method}{LEAVES if self.shown is Shown.RATE_OF_RELATION else ''}",
        }
        if self.verdict is Verdict.REFUTED:
            record |= {"counterexample": dict(self.counterexample), "defect": self.defect}
        if self.verdict is Verdict.SUPPORTED:
            record |= {"accepted": self.accepted is True}
        return record


@dataclass(frozen=True)
class Finding:
    """What a rank, a search or a count gave.

    Attributes:
        statement: What was found, e.g. ``integrals of degree <= 2: a space of dimension 3``.
        kind: As of a claim.
        method: How it was found.
        scope: Where it holds, e.g. ``for almost all parameters``; empty for everywhere.
        error: How likely it is wrong, in words; empty where it is exact.
        seconds: How long the search took.
    """

    statement: str
    kind: str
    method: str
    scope: str = ""
    error: str = ""
    seconds: float = field(default=0.0, compare=False)

    def as_record(self) -> dict[str, Any]:
        """The finding as JSON values, without the time."""
        return {
            "statement": self.statement,
            "kind": self.kind,
            "method": self.method,
            "scope": self.scope,
            "error": self.error,
        }

    def __str__(self) -> str:
        parts = (self.method, self.scope, self.error and f"error: {self.error}")
        return f"{self.statement}  {'; '.join(filter(None, parts))}"


@dataclass(frozen=True)
class Certificate:
    """Everything that is claimed of one system, and what was found out about it.

    Attributes:
        system: Name of the system.
        claims: In the order in which they were examined.
        findings: Likewise.
        spec: That of the system, by which notebooks write its names; None of an algebra alone.
    """

    system: str
    claims: tuple[Claim, ...]
    findings: tuple[Finding, ...] = ()
    spec: Spec | None = field(default=None, compare=False, repr=False)

    def __repr__(self) -> str:
        counts = ", ".join(f"{self.count(v)} {v}" for v in Verdict if self.count(v))
        return f"<Certificate of {self.system}: {counts or 'no claims'}>"

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        from coadjoint.notebook import show_certificate

        return show_certificate(self)

    @property
    def refuted(self) -> tuple[Claim, ...]:
        """The claims that are false."""
        return tuple(claim for claim in self.claims if claim.verdict is Verdict.REFUTED)

    @property
    def failures(self) -> tuple[Claim, ...]:
        """The claims that are refuted, or supported where a proof is asked for."""
        return tuple(claim for claim in self.claims if not claim.holds)

    @property
    def holds(self) -> bool:
        """Whether every claim is proved, or supported where the spec accepts that."""
        return not self.failures

    def count(self, verdict: Verdict) -> int:
        """How many claims have a verdict."""
        return sum(claim.verdict is verdict for claim in self.claims)

    def require(self) -> Certificate:
        """This certificate, if it holds.

        Raises:
            ClaimError: With every claim that is refuted, and the point where it fails, and every
                claim that is only supported though a proof is asked for.
        """
        if not self.holds:
            raise ClaimError(
                "\n".join(self.explain_failures()),
                system=self.system,
                claims=[claim.as_record() for claim in self.failures],
            )
        return self

    def explain_failures(self) -> Iterator[str]:
        """Why claims do not hold, each with its place in the spec, or with the system's name."""
        spec = self.spec
        for claim in self.failures:
            text, place = failure_text(claim), claim.place
            yield place.locate(spec.path, text) if spec and place else f"{self.system}: {text}"

    def as_record(self) -> dict[str, Any]:
        """The certificate as JSON values, without times."""
        return {
            "system": self.system,
            "claims": [claim.as_record() for claim in self.claims],
            "findings": [finding.as_record() for finding in self.findings],
        }

    def __str__(self) -> str:
        width = max((len(claim.statement) for claim in self.claims), default=0)
        rows = [
            f"{claim.verdict:<21} {claim.statement:<{width}}  {claim.method} "
            f"({claim.seconds * 1e3:.1f} ms)"
            for claim in self.claims
        ]
        rows += [f"{'found':<21} {finding}" for finding in self.findings]
        return "\n".join([f"Certificate of {self.system}", *rows])


#: What to do where a claim of a spec is not proved.
_ACCEPT = (
    "Write the formulas without functions that hide the identity. Or accept what the numbers show: "
    'write { claim = "...", accept = "numerical" } for a claim in [claims], and accept = '
    '"numerical" in the table of a symmetry or transformation, in [double_bracket] or '
    "[metriplectic]."
)
#: What to do where a claim of the engine is not proved.
_REWRITE = (
    "The engine never accepts numbers for this claim: write the Lagrangian, Hamiltonian or bracket "
    "without functions that hide the identity, or leave out the route."
)
#: What is likely wrong where a claim is refuted, in general and by kind.
_FIX = "Correct the claim, or the formulas of the spec that contradict it."
_FIXES = MappingProxyType(
    {
        "conserved": _FIX + " If it holds for some parameters or on a set alone, name what is 0 "
        'there: { claim = "...", where = ["I1 - I2"] }.',
    }
)


#: The same of claims of the engine.
_OWN_FIXES = MappingProxyType(
    {
        "rolling": "The body slips or leaves what it rolls on: correct the arm in [rolling], the "
        "profile of the body that it stands for, the surfaces, or the constraints.",
    }
)

#: What the method adds where not the claimed function but the relations of its set have a rate.
LEAVES = ": the motion leaves this set"


def failure_text(claim: Claim) -> str:
    """Why a claim does not hold, and what to do, for people."""
    if claim.verdict is Verdict.SUPPORTED:
        return (
            f"not proved: {claim.statement}. It is only {claim.verdict} ({claim.method}); expected "
            f"a proof. {_REWRITE if claim.accepted is None else _ACCEPT}"
        )
    point = ", ".join(f"{name} = {value}" for name, value in claim.counterexample.items())
    place = f"At {point}" if point else f"By {claim.method}"
    place += LEAVES[1:] + ":" if claim.shown is Shown.RATE_OF_RELATION else ""
    expected = "none below 0" if claim.shown is Shown.EIGENVALUE else "0"
    fixes = _OWN_FIXES if claim.accepted is None else _FIXES
    fix = _FIX if claim.shown is Shown.VARIATION else fixes.get(claim.kind, _FIX)
    return (
        f"refuted: {claim.statement}. {place} {claim.shown} is {claim.defect}; expected "
        f"{expected}. {fix}"
    )
