"""The theorems that routes and their steps rest on: the one table of them.

Comes in: a key, from a step of a derivation or from the name of a route. Goes out: the name of a
theorem, proposition or principle with the place where it stands. Numbers are those of D. D. Holm,
*Geometric Mechanics, Part II*, 2nd edition (2011); what has no number there, or one that nobody
looked up, has its name alone or another source. Read next: `coadjoint.derive.records.write_step`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Final


@dataclass(frozen=True)
class Theorem:
    """A theorem, proposition, definition or principle.

    Attributes:
        name: What the field calls it.
        source: Where it stands; "" where no number is known.
    """

    name: str
    source: str = ""

    @property
    def text(self) -> str:
        """Name and source, for documents.

        >>> Theorem("Legendre transform", "Holm 2011, definition 2.5.1").text
        'Legendre transform (Holm 2011, definition 2.5.1)'
        """
        return f"{self.name} ({self.source})" if self.source else self.name


#: By route: the theorem as which the route follows it. The docstring of its module has the proof's
#: idea, and the same source.
_OF_ROUTES: Final = {
    "alignment": Theorem(
        "Riccati equation of quaternions", "Holm 2011, section 3.1.4, equation 3.1.33"
    ),
    "canonical": Theorem("Hamilton's canonical equations", "Holm 2011, sections 2.5 and 2.5.1"),
    "cayley-klein": Theorem("Cayley-Klein rigid body", "Holm 2011, sections 4.1 to 4.1.3"),
    "clebsch": Theorem("Clebsch-Euler-Poincare theorem", "Holm 2011, sections 2.5.5, 8.4 and 9.3"),
    "complexification": Theorem("complex rigid body", "Holm 2011, appendix C.1.2"),
    "euler-lagrange": Theorem("Euler-Lagrange equations", "Holm 2011, sections 2.2 and 2.2.1"),
    "euler-poincare": Theorem(
        "Euler-Poincare theorem",
        "Holm 2011, section 9.1 (9.1.4); Holm, Marsden and Ratiu 1998",
    ),
    "first-order": Theorem("reduction of Lagrangians of first order", "Faddeev and Jackiw 1988"),
    "hamel": Theorem("Hamel's equations", "Hamel 1904; Holm 2011, section 12.3.3"),
    "hamilton-pontryagin": Theorem(
        "Hamilton-Pontryagin principle", "Holm 2011, sections 2.4.1 and 9.2"
    ),
    "kaluza-klein": Theorem("Kaluza-Klein construction", "Holm 2011, section 8.5"),
    "lax": Theorem("isospectral problem of a Lax pair", "Lax 1968; Holm 2011, section 2.4.4"),
    "lie-poisson": Theorem(
        "Lie-Poisson form of the Euler-Poincare equations", "Holm 2011, sections 2.5.2 and 9.4"
    ),
    "manakov": Theorem("Manakov's Lax pair", "Holm 2011, sections 2.4.2 and 2.4.4"),
    "matrix-euler-poincare": Theorem("matrix Euler-Poincare equations", "Holm 2011, section 2.4.3"),
    "nambu": Theorem("Nambu bracket", "Holm 2011, section 2.5.4, for n = 3; Nambu 1973"),
    "newton": Theorem("Newton's law", "Holm 2011, sections 1.1 and 2.1"),
    "newton-euler": Theorem("Newton-Euler equations", "Holm 2011, sections 2.1.1 and 2.1.2"),
    "nonholonomic": Theorem(
        "nonholonomic Euler-Poincare theorem",
        "Holm 2011, sections 12.2 and 12.3.2; Schneider 2002",
    ),
    "nonholonomic-hamilton-pontryagin": Theorem(
        "nonholonomic Hamilton-Pontryagin principle", "Holm 2011, section 12.2"
    ),
    "poincare": Theorem(
        "Poincare's equations",
        "Holm 2011, appendix D; Poincare, C. R. Acad. Sci. 132, 1901, p. 369",
    ),
    "poisson": Theorem("motion in a Poisson bracket", "Holm 2011, section 2.5.1"),
}

#: What single steps rest on, where that is not the theorem of their route.
_OF_STEPS: Final = {
    "advection": Theorem("Euler-Poincare theorem with advection", "Holm 2011, section 9.1"),
    "almost-poisson": Theorem("almost-Poisson bracket", "van der Schaft and Maschke 1994"),
    "angular-velocity": Theorem("rigid rotation", "Holm 2011, section 2.1.1"),
    "chart": Theorem("change of charts", "Holm 2011, appendix A.1"),
    "constraints": Theorem("Lagrange and d'Alembert's principle", "Holm 2011, section 12.1.1"),
    "dirac": Theorem("Dirac's bracket", "Dirac 1950"),
    "double-bracket": Theorem(
        "double-bracket dissipation", "Bloch, Krishnaprasad, Marsden and Ratiu 1996"
    ),
    "energy": Theorem("energy of a Lagrangian", "Holm 2011, section 2.2"),
    "epdiff": Theorem("Euler-Poincare equation of diffeomorphisms, right-invariant"),
    "field-bracket": Theorem("Poisson bracket of fields"),
    "forces": Theorem("Lagrange and d'Alembert's principle with forces"),
    "geodesic": Theorem("geodesic equation", "Holm 2011, section 2.2 (2.2.4)"),
    "hamilton": Theorem("motion in Hamiltonian form", "Holm 2011, section 2.5.1"),
    "invariant-section": Theorem("restriction to an invariant submanifold"),
    "ito": Theorem("conversion of Stratonovich's to Ito's integral"),
    "legendre": Theorem("Legendre transform", "Holm 2011, definition 2.5.1"),
    "manakov-identity": Theorem("identity of Manakov's pair", "Holm 2011, section 2.4.4"),
    "manakov-inertia": Theorem("rigid body of SO(n)", "Holm 2011, section 2.4.2"),
    "metriplectic": Theorem("metriplectic relaxation", "Morrison 1986"),
    "momentum-map": Theorem("cotangent-lift momentum map", "Holm 2011, sections 9.3 and 9.4.1"),
    "noise": Theorem("noise by the bracket", "Arnaudon, De Castro and Holm 2018"),
    "normal-extremals": Theorem("vakonomic principle", "Holm 2011, section 12.1.1"),
    "quaternions": Theorem("Cayley-Klein parameters", "Holm 2011, section 3.2.1"),
    "reconstruction": Theorem("reduced variables of SE(3)", "Holm 2011, section 12.3.1"),
    "rotation": Theorem("motion of a rigid body with translation", "Holm 2011, section 2.1.2"),
    "stationary-action": Theorem("principle of stationary action", "Holm 2011, section 2.2.1"),
    "strand": Theorem(
        "Euler-Poincare equations of a strand",
        "Holm 2011, sections 10.1 and 10.2; Holm, Ivanov and Percival 2012",
    ),
    "symplectic": Theorem("inverse of a symplectic form"),
    "trace-integrals": Theorem("integrals of an isospectral motion", "Holm 2011, section 2.4.5"),
    "variational-derivative": Theorem("Euler operator of a density"),
    "zero-curvature": Theorem("zero curvature", "Zakharov and Mikhailov 1978"),
}

THEOREMS: Final[Mapping[str, Theorem]] = {**_OF_ROUTES, **_OF_STEPS}


def find_theorem(key: str) -> Theorem:
    """The theorem with a key.

    Raises:
        LookupError: The table has none.

    >>> find_theorem("lie-poisson").source
    'Holm 2011, sections 2.5.2 and 9.4'
    """
    if key in THEOREMS:
        return THEOREMS[key]
    near = get_close_matches(key, THEOREMS, 1)
    advice = f"Did you mean {near[0]!r}?" if near else "Add it there, with its source."
    raise LookupError(
        f"coadjoint.derive.theorems: a step rests on {key!r}; expected a key of THEOREMS. {advice}"
    )
