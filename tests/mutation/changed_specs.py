"""Changes of shipped specs: mistakes that are printed in books, and claims of the wrong sign.

Read next: `tests.mutation.routes`, where all changes come together.
"""

from __future__ import annotations

from tests.mutation.route_mutants import of_spec

MAGNETIC = '''"{v1, v2}" = "lam*r3/norm(r)^3"
"{v2, v3}" = "lam*r1/norm(r)^3"
"{v3, v1}" = "lam*r2/norm(r)^3"'''
#: The book's slips, and one sign of each kind of declaration.
SPECS = (
    *of_spec(
        "quadratic_potential_so3",
        ('"-S + lambda*M', '"S + lambda*M', "the potential +S in the Lax pair"),
        ('"Omega + lambda*diag(a)"', '"Omega - lambda*diag(a)"', "a wrong sign in M of a Lax pair"),
        ("- trace(S*diag(a))/2", "+ trace(S*diag(a))/2", "the potential -tr(SA)/2 beside the pair"),
    ),
    *of_spec(
        "bloch_iserles_3",
        ("lambda*N^2", "lambda^2*N^2", "lambda^2 N^2 in the place of lambda N^2"),
        ('"N*X + X*N +', '"N*X - X*N +', "a wrong sign in M of the pair with N"),
        ("N12^2*X33 - 2", "N12^2*X33 + 2", "one sign of a quadratic Casimir"),
    ),
    *of_spec(
        "monopole_kepler",
        (MAGNETIC, MAGNETIC.replace('"lam*', '"-lam*'), "a magnetic field of the other sign"),
        ('"{v1, v2}" = "lam*', '"{v1, v2}" = "-lam*', "a magnetic field that is not closed"),
        ('map        = "dot(u, xi)"', 'map        = "-dot(u, xi)"', "minus a momentum map"),
        ("cross(r, v) - lam*r", "cross(r, v) + lam*r", "a momentum map with the other spin"),
    ),
    *of_spec(
        "c3_oscillators",
        (
            '"{L, L}"    = "-hat(L)"',
            '"{L, L}"    = "hat(L)"',
            "a claimed bracket of the other sign",
        ),
    ),
    *of_spec(
        "spd_motion",
        ("A*S + S*transpose(A)", "A*S + S*A", "an action that leaves symmetric matrices"),
    ),
    *of_spec(
        "sp2_momentum",
        ("X1*X2 - X3^2", "X1*X2 + X3^2", "a claimed Casimir of the wrong sign"),
        ('"{X2, X3}" = "-2*X2"', '"{X2, X3}" = "2*X2"', "a bracket without Jacobi's identity"),
    ),
    *of_spec(
        "kirchhoff",
        ("(diag(M)*Pi - diag(D)*P)", "(diag(M)*Pi + diag(D)*P)", "h that is not of this l"),
    ),
    *of_spec(
        "heavy_top",
        ("/2 + m*g*dot(Gamma, chi)", "/2 - m*g*dot(Gamma, chi)", "gravity upwards in h alone"),
    ),
    *of_spec(
        "heavy_top_kovalevskaya",
        ("+ (2*Omega1*Omega2", "- (2*Omega1*Omega2", "a claimed integral of the wrong sign"),
    ),
    *of_spec(
        "kepler",
        ("dot(v, v)/2 - mu", "dot(v, v)/2 + mu", "a force that repels in one formula"),
    ),
)
