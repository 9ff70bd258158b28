"""Proof: every claim about Equations, proved or refuted, in a Certificate.

Comes in: a Spec or its Equations. Goes out: a `Certificate`. Read next: `coadjoint.prove.claims`.
"""

from coadjoint.callable_module import make_callable
from coadjoint.prove.certificate import Certificate, Claim, Finding, Verdict
from coadjoint.prove.claims import prove

__all__ = ["Certificate", "Claim", "Finding", "Verdict", "prove"]

make_callable(__name__, "prove")
