"""Fixed cases: specs at which provers have failed, with what is true of them by hand.

Each says why it is true. The names of the areas are those of the engine's steps. Beside these
verdicts every certificate is judged as those of random specs are.
Read next: `tests.adversary.test_fixed`.
"""

from __future__ import annotations

from dataclasses import dataclass

from tests.adversary.specs import SLEIGH
from tests.constrained import APPELL, CYLINDER, ROUND

PROVED, REFUTED, SUPPORTED = "proved", "refuted", "numerically supported"


@dataclass(frozen=True)
class Fixed:
    """A spec with what must be said of it.

    Attributes:
        name: Of the case.
        text: The spec.
        verdicts: What is expected of claims by their statements.
        says: Pieces that a claim or finding must have.
        never: Pieces that none may have.
    """

    name: str
    text: str
    verdicts: dict
    says: tuple = ()
    never: tuple = ()


def so3(h, claims, parameters="", names="mu"):
    """A body on so(3)*."""
    return f"""title = "Body"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
{names} = {{ role = "momentum" }}
{parameters}
[hamiltonian]
h = "{h}"
{claims}
"""


def canonical(h, claims, size=2, more=""):
    """A canonical bracket of q and p."""
    shape = f", shape = [{size}]" if size else ""
    return f"""title = "Canonical"
routes = ["canonical"]
[poisson]
canonical = [["q", "p"]]
[variables]
q = {{ role = "coordinate"{shape} }}
p = {{ role = "coordinate"{shape} }}
{more}
[hamiltonian]
h = "{h}"
{claims}
"""


def free(constraint, energy, claims="", more="", count=2):
    """Coordinates q1, ... with velocities v1, ... under a constraint."""
    return f"""title = "Constrained"
routes = ["nonholonomic", "hamel"]
[variables]
q = {{ role = "coordinate", shape = [{count}] }}
v = {{ role = "velocity", of = "q" }}
{more}
[lagrangian]
l = "{energy}"
[constraints]
c = "{constraint}"
{claims}
"""


def conserved(integral, *where):
    """A table of one claim."""
    if not where:
        return f'[claims]\nconserved = ["{integral}"]'
    listed = ", ".join(f'"{each}"' for each in where)
    return f'[claims]\nconserved = [{{ integral = "{integral}", where = [{listed}] }}]'


POSITIVE_A = '[parameters]\na = { positive = true, default = "3/2" }'
#: d/dt (p1 q1 p2) = p1^2 p2 by free motion: not zero where q2 = 0 alone, and p2 q2 = 0 is left.
FREE = "dot(p, p)/2"
AXES = ("mu1^2/2 + mu2^2 + mu3^2", "mu1^2 + mu2^2/2 + mu3^2", "mu1^2 + mu2^2 + mu3^2/2")


def _axes():
    """mu_b where mu_a mu_b = 0: kept and true where mu_a = 0, false where mu_b = 0.

    With a the axis of revolution mu_a is conserved, and mu_b' = +-mu_a mu_c.
    """
    for a, h in enumerate(AXES, 1):
        for b in (1, 2, 3):
            if a != b:
                for one, two in ((a, b), (b, a)):
                    where = f"mu{one}*mu{two}"
                    statement = f"mu{b} is conserved where {where} = 0"
                    yield Fixed(
                        f"a product of momenta {a}{b} as {where}",
                        so3(h, conserved(f"mu{b}", where)),
                        {statement: REFUTED},
                    )


#: Hidden identities; x and y are any real numbers, a and b are positive.
IDENTITIES = {
    "an odd sine": "sin(-q1) + sin(q1)",
    "an even cosine": "cos(-q1) - cos(q1)",
    "a product of roots of numbers": "sqrt(2)*sqrt(3) - sqrt(6)",
    "a root of a number with a square": "sqrt(8) - 2*sqrt(2)",
    "a product of powers": "exp(q1)*exp(q2) - exp(q1 + q2)",
    "a square of a power": "exp(2*q1) - exp(q1)^2",
    "an inverse power": "exp(-q1)*exp(q1) - 1",
    "a doubled sine": "sin(2*q1) - 2*sin(q1)*cos(q1)",
    "a doubled cosine": "cos(2*q1) - cos(q1)^2 + sin(q1)^2",
    "a halved sine": "sin(q1) - 2*sin(q1/2)*cos(q1/2)",
    "a sine of a sum": "sin(q1 + q2) - sin(q1)*cos(q2) - cos(q1)*sin(q2)",
    "a cosine of a difference": "cos(q1 - q2) - cos(q1)*cos(q2) - sin(q1)*sin(q2)",
    "a product of roots": "sqrt(a)*sqrt(b) - sqrt(a*b)",
    "a square under a root": "sqrt((a + b)^2) - a - b",
    "an expanded square under a root": "sqrt(a^2 + 2*a*b + b^2) - a - b",
}
NEAR = {
    "an even sine": "sin(-q1) - sin(q1)",
    "a wrong product of roots": "sqrt(2)*sqrt(3) - sqrt(5)",
    "a root of a square of either sign": "sqrt(q1^2) - q1",
    "a wrong double": "sin(2*q1) - sin(q1)*cos(q1)",
    "a wrong sum": "sin(q1 + q2) - sin(q1)*cos(q2) + cos(q1)*sin(q2)",
}
TWO = "[parameters]\na = { positive = true, default = 1 }\nb = { positive = true, default = 2 }"


def _identities():
    for table, verdict in ((IDENTITIES, PROVED), (NEAR, REFUTED)):
        for name, text in table.items():
            statement = f"({text})*q1 is conserved"
            yield Fixed(
                name, canonical(FREE, conserved(f"({text})*q1"), more=TWO), {statement: verdict}
            )


BELT = """title = "Two wheels and a belt"
routes = ["nonholonomic", "hamel"]
[variables]
x = { role = "coordinate" }
y = { role = "coordinate" }
w1 = { role = "velocity", of = "x" }
w2 = { role = "velocity", of = "y" }
[parameters]
R = { positive = true, default = 2 }
k = { positive = true, default = 1 }
[lagrangian]
l = "w1^2/2 + w2^2 - k*x"
[constraints]
belt = "R*w1 == R*w2"
[claims]
conserved = ["w1", "w1 - w2", "3*w1^2/2 + k*x"]
"""
#: 3 w' = -k with w = w1 = w2: the energy 3 w^2/2 + k x is conserved, w is not.
BELT_VERDICTS = {
    "w1 is conserved": REFUTED,
    "w1 - w2 is conserved": PROVED,
    "3*w1^2/2 + k*x is conserved": PROVED,
}
MIRROR = """
[transformations.mirror]
map = { q = "-q", p = "-p" }
[transformations.shift]
map = { q = "q + 1" }
"""
#: q' = v, no force: q moves by the first, time by the second; J = (v, -v^2/2).
MOVING_TIME = """title = "Translation and time shift"
routes = ["euler-lagrange"]
[variables]
q = { role = "coordinate" }
v = { role = "velocity", of = "q" }
[lagrangian]
l = "v^2/2"
[symmetries.J]
algebra = "R^2"
vector = "xi"
generators = { q = "xi[1]" }
time = "xi[2]"
[claims]
conserved = ["J"]
"""
#: Rotations of the plane with velocities as state.
TURNED = """title = "Rotation and time shift"
routes = ["euler-lagrange"]
[variables]
q = { role = "coordinate", shape = [2] }
v = { role = "velocity", of = "q" }
[lagrangian]
l = "(1 + dot(q, q))*dot(v, v)/2 - dot(q, q)/2"
[symmetries.J]
algebra = "R^2"
vector = "xi"
generators = { q = "xi[1]*vector(-q2, q1)" }
time = "xi[1] + xi[2]"
[claims]
conserved = ["J"]
"""
DEGENERATE = """title = "No Legendre transform"
routes = ["euler-lagrange"]
[variables]
q = { role = "coordinate" }
r = { role = "coordinate" }
v1 = { role = "velocity", of = "q" }
v2 = { role = "velocity", of = "r" }
[lagrangian]
l = "(exp(2*q)*v1^2 + 2*exp(q)*v1*v2 + v2^2)/2"
"""
SE3 = """title = "Body in a fluid"
routes = ["lie-poisson"]
[algebra]
name = "se(3)"
[variables]
Pi = { role = "momentum", block = "rotation" }
P = { role = "momentum", block = "translation" }
[hamiltonian]
h = "dot(Pi, Pi)/2 + P1^2 + P2^2/2"
[claims]
casimirs = ["dot(Pi, Pi)"]
"""


#: On Omega3 = 0 with p3 = k' Omega1: I1 dOmega1/dt = -k' Omega1 Omega2 and
#: I2 dOmega2/dt = k' Omega1^2, so that div X = -k' Omega2/I1, which is d ln|Omega1|/dt as well.
SUSLOV = """title = "Suslov"
routes = ["nonholonomic", "hamel"]
[algebra]
name = "so(3)"
[variables]
Omega = { role = "velocity" }
[parameters]
I = { shape = [3], positive = true, default = [1, 2, 3] }
k = { positive = true, default = "1/4" }
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 + k*Omega1*Omega3/(1 + k)"
[constraints]
c = "2*Omega3 == 0"
"""


def _inclined(count, dimension):
    """A particle on an inclined line of the plane, or in an inclined plane of space.

    With u along the line and w = cos(alpha) q1 - sin(alpha) q2 the integrals of degree (2, 2) are
    u^a w^c in the plane of q1 and q2: 3*3 = 9. In space they are u^a v3^b w^c L^d with
    L = q3 u - s v3, a + b + d <= 2 and c + d <= 2: 6*3 + 3*2 + 1 = 25.
    """
    energy = " + ".join(f"v{n}^2" for n in range(1, count + 1))
    integral = "cos(alpha)*q1 - sin(alpha)*q2"
    rule = "cos(alpha)*v1 - sin(alpha)*v2 == 0"
    return Fixed(
        f"an inclined constraint in {count} dimensions",
        free(rule, f"m*({energy})/2", conserved(integral), TRIG_PARAMETERS, count),
        {f"{integral} is conserved": PROVED},
        (f"a space of dimension {dimension} with constants",),
    )


def _constrained_motions():
    """Kept constraints where free motion has no acceleration, and where it has blocks."""
    claims = "[claims]\nconserved = [{}]"
    yield _inclined(2, 9)
    yield _inclined(3, 25)
    yield Fixed(
        "a ball in an upright cylinder",  # s3 = -R u/r, and the wall turns no ball about its axis
        CYLINDER + claims.format('"energy", "s3", "w"'),
        {"s3 is conserved": PROVED, "w is conserved": REFUTED},
    )
    yield Fixed(
        "Appell's machine",  # z - b phi is constant by the thread
        APPELL + claims.format('"energy", "z - b*phi", "z - phi"'),
        {"z - b*phi is conserved": PROVED, "z - phi is conserved": REFUTED},
    )
    yield Fixed(
        "a body of unit inertia with a gear",
        ROUND + claims.format('"w1", "w3", "w2 - w1"'),
        {"w1 is conserved": PROVED, "w3 is conserved": PROVED, "w2 - w1 is conserved": PROVED},
    )
    yield Fixed(
        "a driven particle with translation and time shift",
        MOVING_TIME.replace('"v^2/2"', '"v^2/2 - q^2/2"'),
        {"J is conserved": REFUTED},
    )
    yield Fixed(
        "a driven plane with rotation and time shift",
        TURNED.replace('dot(q, q)/2"', 'dot(q, q)/2 + q1/3"'),
        {"J is conserved": REFUTED},
    )


def spins(count):
    """A chain of spins, each with a Casimir of its own."""
    parts = ", ".join(['"so(3)"'] * count)
    h = " + ".join(f"mu{3 * n + 1}*mu{3 * n + 4}" for n in range(count - 1))
    return f"""title = "Spins"
routes = ["lie-poisson"]
[algebra]
direct_sum = [{parts}]
[variables]
mu = {{ role = "momentum" }}
[hamiltonian]
h = "{h}"
"""


def surface(slope, h, domain, more="", claims=""):
    """{x, y} = z, {y, z} = a slope by x, {z, x} = y: the Casimir is F(x) + y^2/2 + z^2/2."""
    inside = f'[domain]\ninside = "{domain}"' if domain else ""
    return f"""title = "Surface"
routes = ["poisson"]
[poisson]
brackets = {{ "{{x, y}}" = "z", "{{y, z}}" = "{slope}", "{{z, x}}" = "y" }}
[variables]
x = {{ role = "coordinate" }}
y = {{ role = "coordinate" }}
z = {{ role = "coordinate" }}
{more}
[hamiltonian]
h = "{h}"
{inside}
{claims}
"""


#: A number that is zero modulo a prime that programs like.
PRIME = 2**61 - 1
ONE_CASIMIR = ("every Casimir is a function of the one known",)
TRIG_PARAMETERS = (
    '[parameters]\nalpha = { default = "1/3" }\nm = { positive = true, default = "5/4" }'
)

CASES = (
    # sets that fall into branches
    Fixed(
        "a product of a momentum and a coordinate",
        canonical(FREE, conserved("p1*q1*p2", "p2*q2")),
        {"p1*q1*p2 is conserved where p2*q2 = 0": REFUTED},
    ),
    Fixed(
        "a product of integrals, true on one branch",
        canonical(FREE, conserved("q1", "p1*p2")),
        {"q1 is conserved where p1*p2 = 0": REFUTED},
    ),
    Fixed(
        "a product of integrals, true on both branches",
        canonical(FREE, conserved("q1*p2", "p1*p2")),
        {"q1*p2 is conserved where p1*p2 = 0": PROVED},
    ),
    Fixed(
        "a positive parameter as a factor of a set",
        so3(AXES[2], conserved("mu1*mu3", "a*mu3"), POSITIVE_A),
        {"mu1*mu3 is conserved where a*mu3 = 0": PROVED},
    ),
    Fixed(
        "a sum of positive parameters as a factor of a set",
        so3(AXES[2], conserved("mu1", "(a^2 + 1)*mu3 + a*mu3"), POSITIVE_A),
        {"mu1 is conserved where (a^2 + 1)*mu3 + a*mu3 = 0": PROVED},
    ),
    Fixed("a radius as a factor of a constraint", BELT, BELT_VERDICTS),
    *_axes(),
    # what is not identically zero, and what is
    *_identities(),
    Fixed(
        "the mirror of a pendulum",
        canonical("p^2/2 - cos(q)", MIRROR, size=0),
        {"mirror takes the motion to itself": PROVED, "shift takes the motion to itself": REFUTED},
    ),
    # powers of functions in remainders
    Fixed(
        "a sine in a set",
        canonical("p3^2/2", conserved("q3*(sin(q1) - q2)", "sin(q1) - q2"), size=3),
        {"q3*(sin(q1) - q2) is conserved where sin(q1) - q2 = 0": PROVED},
    ),
    Fixed(
        "a square of a sine in a set",
        canonical("p3^2/2", conserved("q3*(sin(q1)^2 - q2)", "sin(q1) - q2"), size=3),
        {"q3*(sin(q1)^2 - q2) is conserved where sin(q1) - q2 = 0": REFUTED},
    ),
    Fixed(
        "a logarithm and a root beside a set",
        canonical(
            "p3^2/2",
            conserved("q3*(log(q1) + sqrt(q1))*(q2 - 1)", "q2 - 2")
            + '\n[domain]\ninside = "q1 > 0"',
            size=3,
        ),
        {"q3*(log(q1) + sqrt(q1))*(q2 - 1) is conserved where q2 - 2 = 0": REFUTED},
    ),
    # domains
    Fixed(
        "a potential by a root of a square, on the side where it is linear",
        canonical(
            "p^2/2 + sqrt(q^2)", conserved("p^2/2 + q") + '\n[domain]\nright = "q > 0"', size=0
        ),
        {"p^2/2 + q is conserved": PROVED},
    ),
    Fixed(
        "the same on the other side",
        canonical(
            "p^2/2 + sqrt(q^2)", conserved("p^2/2 + q") + '\n[domain]\nleft = "q < 0"', size=0
        ),
        {"p^2/2 + q is conserved": REFUTED},
    ),
    Fixed(
        "a claim that is defined far away alone",
        canonical(FREE, conserved("q1*sqrt(q1 - 100)")),
        {"q1*sqrt(q1 - 100) is conserved": REFUTED},
    ),
    Fixed(
        "the same with a domain",
        canonical(FREE, conserved("q1*sqrt(q1 - 100)") + '\n[domain]\nfar = "q1 > 100"'),
        {"q1*sqrt(q1 - 100) is conserved": REFUTED},
    ),
    # Noether's theorem
    Fixed("translation and time shift", MOVING_TIME, {"J is conserved": PROVED}),
    Fixed("rotation with a time shift", TURNED, {"J is conserved": PROVED}),
    # ranks and counts
    Fixed(
        "Casimirs of se(3) beside a false one",
        SE3,
        {"dot(Pi, Pi) is a Casimir": REFUTED},
        ("every Casimir is a function of the 2 known",),
    ),
    Fixed(
        "five spins",
        spins(5),
        {},
        ("every Casimir is a function of the 5 known",),
        ("higher degree", "are not rational"),
    ),
    Fixed(
        "a bracket that is defined far away alone",
        surface(
            "1/(x - 2)", "y", "x > 3", claims='[claims]\ncasimirs = ["log(x - 2) + y^2/2 + z^2/2"]'
        ),
        {"log(x - 2) + y^2/2 + z^2/2 is a Casimir": PROVED},
        ONE_CASIMIR,
    ),
    Fixed(
        "a root of three in a bracket",
        surface("sqrt(3)*x", "y*x", "", claims='[claims]\ncasimirs = ["sqrt(3)*x^2 + y^2 + z^2"]'),
        {"sqrt(3)*x^2 + y^2 + z^2 is a Casimir": PROVED},
        ONE_CASIMIR,
    ),
    Fixed(
        "a prime in a denominator",
        surface(
            f"x/{PRIME}", "y*x", "", claims=f'[claims]\ncasimirs = ["x^2/{PRIME} + y^2 + z^2"]'
        ),
        {f"x^2/{PRIME} + y^2 + z^2 is a Casimir": PROVED},
        ONE_CASIMIR,
    ),
    Fixed(
        "a prime as a factor",
        canonical(
            f"p1^2/2 + {PRIME}*p2^2/2",
            f'[claims]\nconserved = ["q2*p1 - {PRIME}*q1*p2", "q2*p1"]',
        ),
        {f"q2*p1 - {PRIME}*q1*p2 is conserved": PROVED, "q2*p1 is conserved": REFUTED},
    ),
    Fixed(
        "a root of three in a constrained motion",
        free("v1 - sqrt(3)*v2 == 0", "v1^2/2 + v2^2/2", conserved("v2")),
        {"v2 is conserved": PROVED},
    ),
    # relations whose factors show in one form of sin^2 + cos^2 = 1 alone
    Fixed(
        "a level set of two parts within each other",
        so3(
            "mu1^2 + mu2^2 + sin(a)*mu3^2",
            """[[claims.conserved]]
claim = "mu2*(mu1^2 + mu2^2 + sin(a)*mu3^2 - 5)"
where = ["(mu1^2 + mu2^2 + sin(a)*mu3^2 - 3)*(mu1^2 + mu2^2 + sin(a)*mu3^2 - 5)"]
""",
            "[parameters]\na = { positive = true, default = 1 }",
        ),
        {
            "mu2*(mu1^2 + mu2^2 + sin(a)*mu3^2 - 5) is conserved where "
            "(mu1^2 + mu2^2 + sin(a)*mu3^2 - 3)*(mu1^2 + mu2^2 + sin(a)*mu3^2 - 5) = 0": REFUTED
        },
    ),
    # constrained motions without accelerations
    Fixed(
        "a constraint on a free particle",
        free("v1 + v2 == 0", "v1^2/2 + v2^2/2", conserved("v1")),
        {"v1 is conserved": PROVED},
    ),
    *_constrained_motions(),
    # negative statements with their scope
    Fixed(
        "Suslov's problem",
        SUSLOV,
        {},
        ("no measure rho dOmega on c = 0 with a constant rho", "|Omega1|^(-1) dOmega on c = 0"),
        ("no invariant measure rho",),
    ),
    Fixed(
        "a sleigh",
        SLEIGH + '[claims]\nconserved = ["energy"]\n',
        {},
        (),
        ("no invariant measure rho dv domega for almost",),
    ),
)
