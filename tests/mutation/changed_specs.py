"""Changes of shipped specs: mistakes that are printed in books, and claims of the wrong sign.

Read next: `tests.mutation.routes`, where all changes come together.
"""

from __future__ import annotations

from tests.mutation.mutant import of_spec

MAGNETIC = ("{v1, v2}", "{v2, v3}", "{v3, v1}")
#: The book's slips, and one sign of each kind of declaration.
SPECS = (
    *of_spec(
        "quadratic_potential_so3",
        ("lax.L: flip S", "the potential +S in the Lax pair"),
        ("lax.M: flip diag", "a wrong sign in M of a Lax pair"),
        ("lagrangian.l: flip S", "the potential -tr(SA)/2 beside the pair"),
    ),
    *of_spec(
        "bloch_iserles_3",
        (
            "lax.M: rewrite _1 + lambda*N^2 -> _1 + lambda^2*N^2",
            "lambda^2 N^2 in the place of lambda N^2",
        ),
        ("lax.M: rewrite N*X + X*N -> N*X - X*N", "a wrong sign in M of the pair with N"),
        ("claims.casimirs[2]: flip X33", "one sign of a quadratic Casimir"),
    ),
    *of_spec(
        "monopole_kepler",
        (
            "; ".join(f"poisson.magnetic.{pair}: flip lam" for pair in MAGNETIC),
            "a magnetic field of the other sign",
        ),
        ("poisson.magnetic.{v1, v2}: flip lam", "a magnetic field that is not closed"),
        ("symmetries.P.map: negate u xi", "minus a momentum map"),
        ("definitions.u: flip lam", "a momentum map with the other spin"),
    ),
    *of_spec(
        "c3_oscillators",
        ("claims.brackets.{L, L}: flip L", "a claimed bracket of the other sign"),
    ),
    *of_spec(
        "spd_motion",
        ("symmetries.J.generators.S: unwrap transpose", "an action that leaves symmetric matrices"),
    ),
    *of_spec(
        "sp2_momentum",
        ("claims.casimirs[1]: flip X3", "a claimed Casimir of the wrong sign"),
        ("poisson.brackets.{X2, X3}: flip X2", "a bracket without Jacobi's identity"),
    ),
    *of_spec(
        "kirchhoff",
        (
            "hamiltonian.h: rewrite diag(M)*Pi - diag(D)*P -> diag(M)*Pi + diag(D)*P",
            "h that is not of this l",
        ),
    ),
    *of_spec(
        "heavy_top",
        ("hamiltonian.h: flip Gamma", "gravity upwards in h alone"),
    ),
    *of_spec(
        "heavy_top_kovalevskaya",
        ("observables.K.expression: flip Omega1 Gamma2", "a claimed integral of the wrong sign"),
    ),
    *of_spec(
        "kepler",
        ("hamiltonian.h: flip mu", "a force that repels in one formula"),
    ),
)
