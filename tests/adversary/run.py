"""Cases of the adversary: random specs proved by the engine and judged by the judge.

Goes out: how many claims had which verdict, and faults with the spec that shows them, shortened.
A crash and a hang are faults as well; time is that of the processor, so that a busy machine changes
nothing. Read next: `tests.adversary.judge`.
"""

from __future__ import annotations

import signal
from collections import Counter
from contextlib import contextmanager
from pathlib import Path

from coadjoint.errors import SpecError
from coadjoint.prove import prove
from coadjoint.prove.zero import UndecidedError
from coadjoint.spec import read_spec_text
from tests.adversary.judge import is_empty, judge, statements
from tests.adversary.motion import motion_of
from tests.adversary.specs import generate

#: Seconds of processor time for one certificate; the slowest here takes about two.
SECONDS = 60
#: Failing specs that are shortened in one run; to shorten one takes as long as ten cases.
SHORTENED = 2


class HangError(Exception):
    """A certificate that took too long."""


@contextmanager
def bounded(seconds=SECONDS):
    """Raise `HangError` after some seconds of processor time."""

    def stop(number, frame):
        raise HangError(f"no certificate after {seconds} s of processor time")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def record_of(text, name="sample"):
    """The certificate of a spec as JSON values."""
    with bounded():
        return prove(read_spec_text(text, Path(f"{name}.toml"))).as_record()


def faults_of(text):
    """What is wrong with the certificate of a spec, and the counts of its verdicts.

    A claim that is rightly undecided is left out, and the others are judged.
    """
    try:
        record = record_of(text)
    except SpecError as error:
        return [f"the spec is refused: {error}"], Counter()
    except UndecidedError as error:
        return _faults_beside(text, error)
    except Exception as error:
        return [f"{type(error).__name__}: {error}"], Counter()
    report = judge(text, record)
    return report.faults, report.verdicts + Counter(unjudged=len(report.unjudged))


def _faults_beside(text, error):
    """What is wrong beside a claim that was not decided: right only where it has no value."""
    rest = without(text, error.found)
    if rest is None:
        return [f"what no line claims is undecided: {error}"], Counter()
    if not is_empty(text, error.found):
        return [f"undecided, but there are points: {error}"], Counter()
    faults, counts = faults_of(rest)
    return faults, counts + Counter(undecided=1)


def without(text, statement):
    """The text without the line of a claim; None if there is none."""
    head, mark, claims = text.partition("[claims]\n")
    lines = claims.splitlines() if statement in statements(motion_of(text)) else []
    for place, line in enumerate(lines):
        rest = head + mark + "\n".join([*lines[:place], *lines[place + 1 :]]) + "\n"
        if line.startswith("  ") and statement not in statements(motion_of(rest)):
            return rest
    return None


def shorten(text, is_faulty):
    """The text without the lines of its claims that the fault does not need."""
    head, mark, claims = text.partition("[claims]\n")
    lines = claims.splitlines()
    for line in list(lines):
        if not line.startswith("  "):
            continue
        rest = [each for each in lines if each is not line]
        if is_faulty(head + mark + "\n".join(rest) + "\n"):
            lines = rest
    return head + mark + "\n".join(lines) + "\n"


def campaign(seeds, cases):
    """Judge random specs until so many cases are done.

    Args:
        seeds: Of the specs, one after the other.
        cases: A claim or a count of one spec is one case.

    Returns:
        Counts of the verdicts, and a text for each spec with faults.
    """
    counts, found = Counter(), []
    for seed in seeds:
        text = generate(seed)
        faults, verdicts = faults_of(text)
        counts += verdicts
        if faults:
            found.append(_told(seed, text, faults, shortened=len(found) < SHORTENED))
        if sum(counts.values()) >= cases:
            break
    return counts, found


def _told(seed, text, faults, shortened):
    """A failing case, with its spec."""

    def is_faulty(shorter):
        found = faults_of(shorter)[0]
        return bool(found) and not found[0].startswith("the spec is refused")

    text = shorten(text, is_faulty) if shortened else text
    return "\n".join([f"seed {seed}:", *faults, "the spec:", text])
