"""Lie algebras and their duals: Jacobi, equations, Casimirs; processor time after imports.

Each run is a process of its own, since a second run finds caches warm. The peer is the public
package ``poissongeometry`` (``pip install poissongeometry``), whose ``jacobiator`` expands the
Schouten bracket with SymPy.
"""

from __future__ import annotations

from importlib.util import find_spec

from figures import Figure, fresh_process, script

RUNS = 5

# The algebra by name, its tensor, the Jacobi identity, the equations of the free body with symbolic
# parameters a_i, and the proof that the quadratic Casimir is one.
BODY = """
import time
from fractions import Fraction
from itertools import combinations
import sympy
from coadjoint.algebra import algebra_by_name
from coadjoint.exact import Field
from coadjoint.poisson import lie_poisson
start = time.process_time()
algebra = algebra_by_name("so({n})")
field = Field([*algebra.basis, *("a%d" % (i + 1) for i in range({n}))])
structure = lie_poisson(algebra, field, algebra.basis)
structure.check_jacobi()
a = [field["a%d" % (i + 1)] for i in range({n})]
half, pairs = Fraction(1, 2), list(combinations(range({n}), 2))
M = dict(zip(pairs, (field[name] for name in algebra.basis)))
h = sum((M[i, j] ** 2 * half / (a[i] + a[j]) for i, j in pairs), field.zero)
rates = structure.hamiltonian_vector_field(h)
casimir = sum((m**2 for m in M.values()), field.zero)
holds = structure.is_casimir(casimir)
taken = time.process_time() - start
assert holds and not structure.is_casimir(casimir + M[0, 1] ** 2)
assert len(rates) == len(pairs) and all(rates)
print(taken)
"""

JACOBI = """
import time
from coadjoint.algebra import algebra_by_name
from coadjoint.exact import Field
from coadjoint.poisson import lie_poisson
start = time.process_time()
algebra = algebra_by_name("{name}")
lie_poisson(algebra, Field(algebra.basis), algebra.basis).check_jacobi()
print(time.process_time() - start)
"""

PEER = """
import time
from poisson.poisson import PoissonGeometry
from coadjoint.algebra import algebra_by_name
algebra = algebra_by_name("{name}")
bivector = {{
    (i + 1, j + 1): " + ".join("(%s)*x%d" % (-c, k + 1) for k, c in row.items())
    for (i, j), row in algebra.constants.items()
}}
geometry = PoissonGeometry(algebra.dimension)
start = time.process_time()
assert geometry.jacobiator(bivector) == {{}}
print(time.process_time() - start)
"""

CASIMIRS = """
import time
from coadjoint.algebra import algebra_by_name
from coadjoint.exact import Field
from coadjoint.poisson import lie_poisson
from coadjoint.poisson.casimirs import casimirs
start = time.process_time()
algebra = algebra_by_name("{name}")
structure = lie_poisson(algebra, Field(algebra.basis), algebra.basis)
found = casimirs(structure, 4)
taken = time.process_time() - start
assert all(structure.is_casimir(c) for c in found.generators)
print(taken)
"""

#: The algebras of at most eleven dimensions that the systems and the theory of the engine name.
SMALL = (
    *("so(3)", "se(2)", "h(1)", "sl(2,R)", "aff(1)", "so(2,1)", "quaternions", "coquaternions"),
    *("so(4)", "so(3,1)", "so(2,2)", "se(3)", "su(2)", "u(2)", "gl(2)", "h(2)"),
    *("su(3)", "sl(3,R)", "u(3)", "gl(3)", "so(5)", "sp(4)", "se(4)", "g(3)", "bargmann"),
)


def measure() -> list[Figure]:
    """The figures of the algebraic half."""
    figures = []
    for n, most in ((8, 0.05), (12, 0.25)):
        taken = fresh_process(BODY.format(n=n), RUNS, median=True)
        what = f"so({n})*: Jacobi, equations, quadratic Casimir"
        figures.append(Figure(what, f"<= {most} s", f"{taken:.3f} s", taken <= most))
    slowest = max(
        (fresh_process(CASIMIRS.format(name=name), 3, median=True), name) for name in SMALL
    )
    figures.append(
        Figure(
            f"Casimirs up to degree 4, slowest of {len(SMALL)} algebras ({slowest[1]})",
            "<= 2 s",
            f"{slowest[0]:.3f} s",
            slowest[0] <= 2,
        )
    )
    figures += [_against_peer(name) for name in ("se(3)", "so(4)", "so(5)")]
    return figures


def _against_peer(name: str) -> Figure:
    """The Jacobi identity of a dual, ours and the peer's."""
    ours = fresh_process(JACOBI.format(name=name), RUNS, median=True)
    what = f"Jacobi identity of {name}*, against poissongeometry's jacobiator"
    if find_spec("poisson") is None:
        return Figure(what, "none", f"{ours * 1e3:.1f} ms; poissongeometry is not installed")
    theirs = fresh_process(PEER.format(name=name), 1)
    measured = f"{ours * 1e3:.1f} ms against {theirs:.2f} s: {theirs / ours:.0f} times"
    return Figure(what, "none", measured)


if __name__ == "__main__":
    script(measure)
