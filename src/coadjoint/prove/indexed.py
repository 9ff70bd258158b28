"""Claims about every number of members, from proofs for two or three small numbers.

A statement of one member, or of some next to each other, reads a bounded number of members: it
holds for all as soon as it holds where that many are written out and keep apart. A total is a sum
over the members, and so is its rate:

* in a ring, F(N+1) - F(N) is a function of the 2 w + 1 members around the new one, the same for
  all N >= 2 w, if each term reads w + 1 members. It vanishes if F(2 w) and F(2 w + 1) do, and then
  every F(N) does. A shorter ring is a longer one that repeats itself;
* in an open chain, F(N+1) - F(N) is a function of the last w + 1 members: likewise from w on;
* where members stand alone at the ends of a chain, the new one is put in the middle: what reads an
  end does not change, and F(N+1) - F(N) is as in a ring;
* with pairs, the rate of a sum over members is a sum of terms of one member and of two. If it
  vanishes for 2 members and for 3, both sums vanish for every N;
* with pairs and neighbours, what two new members far from each other add together, and not each
  alone, is a function of them and the members near them, the same for every N. It vanishes if F
  does for three numbers that follow one another; then F does for every larger one.

The energy is kept since the bracket is antisymmetric. Comes in: the certificates of the windows.
Goes out: one certificate, in which each claim says for which N it holds.
Read next: `coadjoint.spec.windows`, which chooses the windows.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from time import perf_counter

from coadjoint.derive import derive
from coadjoint.exact.dense import commutator
from coadjoint.exact.text import WHILE
from coadjoint.prove.certificate import Certificate, Claim, Verdict
from coadjoint.prove.noise import tell_kept
from coadjoint.prove.zero import Decision, decide_zero, make_entry
from coadjoint.spec.core.components import component_names
from coadjoint.spec.core.faults import list_names
from coadjoint.spec.core.totals import has_sum
from coadjoint.spec.model import Lax, Spec, Windows
from coadjoint.spec.spatial import describe_gram, gram_name

_ORDER = (Verdict.REFUTED, Verdict.SUPPORTED, Verdict.PROVED)
#: What a statement says of a momentum map that is conserved.
_NOETHER = "by Noether's theorem"
#: The entries of a cocycle, which name members, and what is said of it in their place.
_COCYCLE = re.compile(r"the constant 2-cocycle .*")
_OF_ALL = "a constant 2-cocycle Sigma, the sum of those of all members"
_ALGEBRA = "the algebra of all members satisfies the Jacobi identity"


def list_windows(spec: Spec) -> list[Spec]:
    """What is proved as it stands: the two windows, and the loaded size for what they cannot."""
    family = spec.family
    assert family is not None, spec.name
    return [*family.windows, *([] if family.loaded is None else [family.loaded])]


def extend(spec: Spec, certificates: Sequence[Certificate]) -> Certificate:
    """The certificate of all numbers of members.

    Args:
        spec: With an index.
        certificates: Of what `list_windows` gives, in its order, without searches.
    """
    family = spec.family
    assert family is not None, spec.name
    general = zip(list_windows(spec), certificates, strict=True)
    kept = [_merge(_keep_general(family, *each)) for each in general]
    windows, rest = kept[: len(family.windows)], kept[len(family.windows) :]
    windows = _keep_common(windows)
    assert len({tuple(c.statement for c in each) for each in windows}) == 1, spec.name
    claims = [_join(family, same) for same in zip(*windows, strict=True)]
    claims += [_examine_lax(family)] if family.lax else []
    if family.loaded is not None:
        own = {f"{each.formula.in_one_line} is conserved" for each in family.loaded.conserved}
        scope = f", for N = {family.index.size} alone"
        loaded = [claim for each in rest for claim in each if claim.statement in own]
        claims += [replace(claim, statement=claim.statement + scope) for claim in loaded]
    return Certificate(spec.name, tuple(claims))


def _keep_common(windows: Sequence[list[Claim]]) -> list[list[Claim]]:
    """The claims of windows, without what is said of a symmetry in some of them alone.

    Of a momentum map that is not conserved a statement shows the rate, and names members in it.
    """
    common = set.intersection(*({claim.statement for claim in each} for each in windows))
    return [[c for c in each if c.kind != "symmetry" or c.statement in common] for each in windows]


def bind_size(spec: Spec, certificate: Certificate) -> Certificate:
    """A certificate of members that are all written out: each statement names their number."""
    if not spec.written:
        return certificate
    (index,) = spec.index

    def tell(statement: str) -> str:
        return f"{shorten_runs(statement)}, for {index.count or 'N'} = {index.size}"

    return replace(
        certificate,
        claims=tuple(replace(c, statement=tell(c.statement)) for c in certificate.claims),
        findings=tuple(replace(f, statement=tell(f.statement)) for f in certificate.findings),
    )


#: A name of a member, as it is or with a differential or a change of sign.
_OF_MEMBER = re.compile(r"\b(\w+_)(\d+)\b(?: -> -\1\2\b)?")
#: Members that are listed in a row.
_LISTED = 4


def shorten_runs(statement: str) -> str:
    """A statement with the first and the last of names that follow one another by their numbers.

    >>> shorten_runs("dq_0 dq_1 dq_2 dq_3 dq_4 dp_0, and p_0 -> -p_0, p_1 -> -p_1")
    'dq_0 ... dq_4 dp_0, and p_0 -> -p_0, p_1 -> -p_1'
    """
    runs = list[list[re.Match[str]]]()
    for found in _OF_MEMBER.finditer(statement):
        if runs and _follows(statement, runs[-1], found):
            runs[-1].append(found)
        else:
            runs.append([found])
    for run in reversed(runs):
        if len(run) > _LISTED:
            between = statement[run[0].end() : run[1].start()]
            statement = (
                f"{statement[: run[0].end()]}{between}...{between}{statement[run[-1].start() :]}"
            )
    return statement


def _follows(statement: str, run: Sequence[re.Match[str]], found: re.Match[str]) -> bool:
    """Whether a name is the next one of a run, with the same between them as before."""
    last, between = run[-1], statement[run[-1].end() : found.start()]
    alike = last[1] == found[1] and ("->" in last[0]) == ("->" in found[0])
    before = statement[run[0].end() : run[1].start()] if len(run) > 1 else between
    return alike and int(found[2]) == int(last[2]) + 1 and between == before in (", ", " ")


def _examine_lax(family: Windows) -> Claim:
    """The Lax equation of matrices with a row for each member.

    Each of its entries reads the members of at most three rows and those next to them. It vanishes
    for every number of members if it does as long as a row may be next to both ends.
    """
    start, counts, (_, pair) = perf_counter(), list[int](), family.lax[0]
    pair_of = f"dL/dt = [L, M], with L = {pair.L.in_one_line} and M = {pair.M.in_one_line}"
    statement = f"{pair_of}, {_tell_scope(family)}"
    for spec, matrices in family.lax:
        decision = _decide_lax(spec, matrices)
        counts.append(len(spec.state) // len(family.variables))
        if decision.verdict is not Verdict.PROVED:
            break
    reason = f", with {list_names(map(str, counts))} members; an entry reads three rows"
    if decision.verdict is not Verdict.PROVED:
        reason = f", with {counts[-1]} members"
    found = replace(decision, method=decision.method + reason, place=pair.L)
    claim = make_entry(statement, "lax", found, perf_counter() - start)
    assert isinstance(claim, Claim), claim
    return claim


def _decide_lax(spec: Spec, pair: Lax) -> Decision:
    """Whether ``dL/dt - [L, M]`` vanishes for the members that are written out."""
    equations = derive(spec)
    setting, field = equations.setting, equations.setting.field
    L, M = setting.value(pair.L), setting.value(pair.M)
    rates = [equations.close(rate) for rate in equations.exact.rates]
    state = equations.variables
    defects = [
        field.sum(a * b for a, b in zip(field.gradient(entry, state), rates, strict=True)) - turned
        for row, others in zip(L, commutator(L, M), strict=True)
        for entry, turned in zip(row, others, strict=True)
    ]
    return decide_zero(defects, field)


def _keep_general(family: Windows, window: Spec, certificate: Certificate) -> Iterator[Claim]:
    """The claims of a window that do not depend on its number of members, in general words."""
    casimirs = {f"{each.in_one_line} is a Casimir" for each in window.casimirs}
    words = _list_words(family, window)
    for claim in certificate.claims:
        if claim.kind == "algebra":
            yield replace(claim, statement=_ALGEBRA)
        elif claim.kind in ("conserved", "attitude", "noise"):
            if not (claim.kind == "noise" and " commute" in claim.statement):  # of some members
                yield replace(claim, statement=_say_of_member(claim.statement, words))
        elif claim.kind in ("jacobi", "equivalence") or claim.statement in casimirs:
            yield claim
        elif claim.kind == "symmetry" and not claim.statement.startswith("the flow of "):
            yield replace(claim, statement=_COCYCLE.sub(_OF_ALL, claim.statement))


def _list_words(family: Windows, window: Spec) -> dict[str, str]:
    """The names that texts have of what each member has, with those of member i for them."""
    words, i = dict[str, str](), family.index.name
    for each in window.variables:
        generic = each.name.rpartition("_")[0]
        own = component_names(generic, each.shape, each.form)
        named = [(each.name, generic), *zip(each.components, own, strict=True)]
        words |= {f"{d}{old}": f"{d}{new}[{i}]" for old, new in named for d in ("", "d")}
        if each.turning:
            words[gram_name(each)] = describe_gram(window, each).replace(
                each.name, f"{generic}[{i}]"
            )
    own = family.indexed_noise
    return words | {
        each.name: f"{generic}[{i}]"
        for each in window.noise
        if (generic := each.name.rpartition("_")[0]) in own and each.name not in family.shared_noise
    }


def _say_of_member(statement: str, words: Mapping[str, str]) -> str:
    """A statement about certain members, as one about each: ``... where R[i]*... = 1``."""
    text = re.sub(r"[A-Za-z]\w*", lambda found: words.get(found[0], found[0]), statement)
    claim, where, level = text.partition(" where ")
    same, *rest = claim.split(" = ", 1)  # the product that stays has no name of its own
    claim = rest[0] if rest and rest[0].startswith(f"{same} is") else claim
    parts = re.split(r", (?![^()]*\))", level)
    return f"{claim}{where}{', '.join(dict.fromkeys(parts))}"


def _merge(claims: Iterable[Claim]) -> list[Claim]:
    """Claims about one member each as one claim about every member: the weakest of them."""
    merged = dict[str, Claim]()
    for claim in claims:
        known = merged.setdefault(claim.statement, claim)
        worst = min(known, claim, key=lambda each: _ORDER.index(each.verdict))
        if claim is not known:
            worst = replace(worst, seconds=known.seconds + claim.seconds)
        merged[claim.statement] = worst
    return list(merged.values())


def _join(family: Windows, same: Sequence[Claim]) -> Claim:
    """One claim from the claims of all windows: the weakest verdict decides."""
    counts = [len(window.state) // len(family.variables) for window in family.windows]
    worst = min(same, key=lambda claim: _ORDER.index(claim.verdict))
    statement = f"{worst.statement}, {_tell_scope(family)}"
    if worst.verdict is not Verdict.PROVED:
        method = f"{worst.method}, with {counts[same.index(worst)]} members"
        return replace(worst, statement=statement, method=method)
    reason = _reason(family, worst)
    several = f"{', with '.join(map(str, counts[:-1]))} and with {counts[-1]}"
    method = f"{_generalise(worst.method)}, with {several} members; {reason}"
    return replace(
        worst, statement=statement, method=method, seconds=sum(claim.seconds for claim in same)
    )


def _tell_scope(family: Windows) -> str:
    """For which numbers of members a claim is made, and for which values of it in formulas."""
    index = family.index
    return f"for every N >= {family.least}" + f" and {index.count} > 0" * index.is_value


def _generalise(method: str) -> str:
    """How a claim of some members was decided, as it holds for those of every number of them."""
    head, jumps, _ = method.partition(WHILE)
    return f"{head}{WHILE}no function of any members jumps" if jumps else head


def _list_of_members(family: Windows) -> frozenset[str]:
    """Statements of what each member conserves, and keeps where there is noise."""
    casimirs = family.windows[0].casimirs if family.windows[0].noise else ()
    own = (each for each in casimirs if each.sums is not None and not has_sum(each.sums))
    return family.of_members.union(map(tell_kept, own))


def _reason(family: Windows, claim: Claim) -> str:
    """Why so many numbers of members are enough."""
    small = family.windows[0]
    if claim.statement.startswith("the energy") and not (small.is_forced or small.noise):
        if small.hamiltonian is None:
            return "the Lagrangian does not name the time"
        return "the bracket of each member is antisymmetric"
    is_total = claim.kind == "conserved" or _NOETHER in claim.statement
    if not is_total or claim.statement in _list_of_members(family):
        if family.pairs:
            if len(family.windows) > 2:
                return "each of its terms reads members next to each other, or those and a partner"
            return "each of its terms reads one member or two"
        return "it reads one member and those next to it"
    if len(family.windows) > 2:
        return "two more members far from each other add the same terms for every N"
    if family.pairs:
        return "the rate is a sum over members and pairs"
    return "one more member adds the same terms for every N"
