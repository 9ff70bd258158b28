"""Random specs with random claims, the same for the same seed.

Goes out: the text of a spec of one of the `FAMILIES`. Claims are true by construction (functions of
known integrals, hidden identities added), false by construction (a moving quantity or a near miss
of an identity added), on sets that fall into branches, and near the edges of domains. What is true
is not handed on: the judge finds it out by itself. Read next: `tests.adversary.judge`.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field

#: Chaplygin's sleigh, without claims.
SLEIGH = """title = "Sleigh"
routes = ["nonholonomic", "hamel"]
[algebra]
name = "se(2)"
[variables]
v = { role = "velocity", block = ["P1"] }
u = { role = "velocity", block = ["P2"] }
omega = { role = "velocity", block = "rotation" }
[parameters]
m = { positive = true, default = 1 }
I = { positive = true, default = 1 }
a = { positive = true, default = "1/2" }
[lagrangian]
l = "m*(v^2 + (u + a*omega)^2)/2 + I*omega^2/2"
[constraints]
blade = "u == 0"
"""

#: Zero for all real x and y.
HIDDEN_ZEROS = (
    "sin(-({x})) + sin({x})",
    "cos(-({x})) - cos({x})",
    "tan({x})*cos({x}) - sin({x})",
    "sin({x})^2 + cos({x})^2 - 1",
    "exp({x})*exp({y}) - exp({x} + {y})",
    "exp(2*({x})) - exp({x})^2",
    "exp({x})*exp(-({x})) - 1",
    "exp({x} - {y})*exp({y}) - exp({x})",
    "sin(2*({x})) - 2*sin({x})*cos({x})",
    "cos(2*({x})) - 1 + 2*sin({x})^2",
    "sin({x}) - 2*sin(({x})/2)*cos(({x})/2)",
    "sin({x} + {y}) - sin({x})*cos({y}) - cos({x})*sin({y})",
    "cos({x} - {y}) - cos({x})*cos({y}) - sin({x})*sin({y})",
    "sqrt(2)*sqrt(3) - sqrt(6)",
    "sqrt(8) - 2*sqrt(2)",
    "sqrt(1/3) - sqrt(3)/3",
    "1/(sqrt(3) - sqrt(2)) - sqrt(3) - sqrt(2)",
    "log(6) - log(2) - log(3)",
    "({x} + {y})^2 - ({x})^2 - 2*({x})*({y}) - ({y})^2",
    "sqrt(({x})^4 + 2*({x})^2 + 1) - ({x})^2 - 1",
    "log(({x})^2 + 1) + log(1/(({x})^2 + 1))",
)
#: Zero for positive a and b.
POSITIVE_ZEROS = (
    "log({a}^2) - 2*log({a})",
    "sqrt({a}^2) - {a}",
    "sqrt({a})*sqrt({b}) - sqrt({a}*{b})",
    "sqrt({a}^2 + 2*{a}*{b} + {b}^2) - {a} - {b}",
    "exp(log({a})) - {a}",
    "log({a}*{b}) - log({a}) - log({b})",
    "sqrt({a}^3) - {a}*sqrt({a})",
    "sqrt({a}/{b}) - sqrt({a})/sqrt({b})",
    "1/sqrt({a}) - sqrt({a})/{a}",
    "exp(2*log({a})) - {a}^2",
)
#: Zero as well, by roots inside roots, which provers rarely see: some claims end as supported.
DEEP_ZEROS = (
    "sqrt(({x})^2 + 2 + 2*sqrt(({x})^2 + 1)) - sqrt(({x})^2 + 1) - 1",
    "sqrt(2*({x})^2 + 3 + 2*sqrt((({x})^2 + 1)*(({x})^2 + 2))) - sqrt(({x})^2 + 1)"
    " - sqrt(({x})^2 + 2)",
    "sqrt(exp({x}) + 1 + 2*exp(({x})/2)) - exp(({x})/2) - 1",
)
#: Not zero, and close to one that is.
NEAR_MISSES = (
    "sin(-({x})) - sin({x})",
    "cos(-({x})) + cos({x})",
    "sin(2*({x})) - 2*sin({x})",
    "exp(({x})*({y})) - exp({x})*exp({y})",
    "exp({x})*exp({y}) - exp({x} - {y})",
    "sin({x} + {y}) - sin({x}) - sin({y})",
    "sqrt(2)*sqrt(3) - sqrt(5)",
    "sqrt(2) + sqrt(3) - 3146264/1000000",
    "sqrt(({x})^2 + ({y})^2) - ({x}) - ({y})",
    "cos(2*({x})) - 1 + 2*cos({x})^2",
    "log(({x})^2 + 1) - 2*log(({x})^2 + 2)",
)
#: The same where a and b are positive.
POSITIVE_MISSES = (
    "log({a}^2) - log({a})",
    "sqrt({a}^2) + {a}",
    "sqrt({a}) + sqrt({b}) - sqrt({a} + {b})",
    "sqrt({a}^2 + {a}*{b} + {b}^2) - {a} - {b}",
    "log({a} + {b}) - log({a}) - log({b})",
)


@dataclass
class Draft:
    """A spec without claims.

    Attributes:
        head: Text up to the claims.
        integrals: Functions that the motion conserves.
        moving: Names that move.
        real: Names that may have either sign.
        positive: Names that are positive by declaration or by [domain].
        casimirs: Functions that are Casimirs; None where the bracket has none by construction.
        false_casimirs: Functions that are not.
        brackets: Pairs and what they are.
        maps: Text of tables [transformations.NAME].
    """

    head: str
    integrals: list
    moving: list
    real: list
    positive: list = field(default_factory=list)
    casimirs: list | None = None
    false_casimirs: list = field(default_factory=list)
    brackets: dict = field(default_factory=dict)
    maps: str = ""


class Author:
    """Writes claims about a draft.

    Args:
        source: A seeded generator.
        draft: The spec.
    """

    def __init__(self, source, draft):
        self.source, self.draft = source, draft

    def one(self, choices):
        """One of several."""
        return self.source.choice(list(choices))

    def _filled(self, template):
        positive = self.draft.positive
        a, b = (self.source.sample(positive, 2) if len(positive) > 1 else positive * 2) or (
            "1",
            "2",
        )
        reals = [*self.draft.real, *positive]
        x, y = self.source.sample(reals, 2) if len(reals) > 1 else ("3", reals[0])
        return template.format(a=a, b=b, x=x, y=y)

    def zero(self):
        """A formula that is zero, which does not show."""
        choices = [*HIDDEN_ZEROS, *(POSITIVE_ZEROS * 2 if self.draft.positive else ())]
        return self._filled(self.one(choices))

    def deep_integral(self):
        """What is conserved, hidden in roots inside roots."""
        zero = self._filled(self.one(DEEP_ZEROS))
        return f"{self.one(self.draft.integrals)} + ({zero})*{self.one(self.draft.moving)}"

    def miss(self):
        """A formula that is not zero, which does not show either."""
        choices = [*NEAR_MISSES, *(POSITIVE_MISSES if self.draft.positive else ())]
        return self._filled(self.one(choices))

    def function_of(self, functions):
        """A function of given ones."""
        f, g = self.one(functions), self.one(functions)
        c = self.one(("2", "-3/7", "sqrt(2)", "1/5"))
        template = self.one(
            (
                "{f}",
                "{c}*({f}) + ({g})^2",
                "({f})*({g})",
                "sin({f})",
                "({f})/(({g})^2 + 1)",
                "sqrt(({f})^2 + 1)",
                "{c} - ({f})*({f})",
            )
        )
        return template.format(f=f, g=g, c=c)

    def true_integral(self):
        """What is conserved, often hidden."""
        whole = self.function_of(self.draft.integrals)
        return (
            f"{whole} + ({self.zero()})*{self.one(self.draft.moving)}" if self._often() else whole
        )

    def false_integral(self):
        """What moves."""
        whole, x = self.function_of(self.draft.integrals), self.one(self.draft.moving)
        return self.one((f"{whole} + ({self.miss()})*{x}", f"{whole} - {x}/1000", f"({whole})*{x}"))

    def _often(self):
        return self.source.random() < 0.6

    def on_set(self):
        """A claim where a function of integrals vanishes, with branches."""
        f, g = self.level(), self.level()
        x, a = self.one(self.draft.moving), self.one(self.draft.positive or ["2"])
        integral, where = self.one(
            (
                (f"{x}*({f})", [f"{f}"]),
                (f"{x}*({f} + 1)", [f"{f}"]),
                (f"{x}*({f})", [f"({f})*({g} - 1/3)"]),
                (f"{x}*({f})*({g} - 1/3)", [f"({f})*({g} - 1/3)"]),
                (f"{x}*({g} - 1/3)", [f"({f})*({g} - 1/3)"]),
                (f"{x}*({f})", [f"{a}*({f} + 1) - {a}"]),
                (f"{x}*({f})", [f"({f})^2"]),
                (f"{x}", [f"{x}*({f})"]),
                (f"{x}*({f}) + ({self.zero()})", [f"{f}"]),
                (f"{x}*({f})", [f"({a} + 1)*({f})*({g})"]),
            )
        )
        return integral, where

    def level(self):
        """An integral that vanishes somewhere: a sum of squares less a number."""
        f = self.one(self.draft.integrals)
        return f if f.isalnum() and f != "energy" else f"{f} - {self.one(('3', '5', '9/2'))}"

    def claims(self, count, deep):
        """The table [claims], with about so many claims; one hidden deeply if wanted."""
        conserved = [_quoted(self.deep_integral())] if deep else []
        for _ in range(count):
            kind = self.source.random()
            if kind < 0.4:
                conserved.append(_quoted(self.true_integral()))
            elif kind < 0.7:
                conserved.append(_quoted(self.false_integral()))
            else:
                integral, where = self.on_set()
                listed = ", ".join(map(_quoted, where))
                conserved.append(f"{{ integral = {_quoted(integral)}, where = [{listed}] }}")
        lines = [
            "[claims]",
            f"conserved = [\n  {(',' + chr(10) + '  ').join(dict.fromkeys(conserved))},\n]",
        ]
        if self.draft.casimirs is not None:
            casimirs = list(self.draft.casimirs) if self.source.random() < 0.6 else []
            if casimirs and self._often():
                casimirs.append(self.function_of(self.draft.casimirs))
            if self._often() and self.draft.false_casimirs:
                casimirs.append(self.one(self.draft.false_casimirs))
            listed = ", ".join(map(_quoted, dict.fromkeys(casimirs)))
            lines.append(f"casimirs = [{listed}]")
        if self.draft.brackets:
            pairs = self.source.sample(sorted(self.draft.brackets.items()), 1)
            pairs = [(pair, self._bracket(text)) for pair, text in pairs]
            listed = ", ".join(f"{_quoted(pair)} = {_quoted(text)}" for pair, text in pairs)
            lines.append(f"brackets = {{ {listed} }}")
        return "\n".join(lines) + "\n"

    def _bracket(self, text):
        kind = self.source.random()
        if kind < 0.4:
            return text
        added = self.zero() if kind < 0.75 else self.miss()
        return f"{text} + {added}"


def _quoted(text):
    return f'"{text}"'


def _parameters(source, count):
    """Parameters, about half of them positive: text, names of either sign, positive names."""
    names = source.sample(["a", "b", "k", "alpha", "R"], count)
    positive = [name for name in names if source.random() < 0.6]
    lines = [
        f"{name} = {{ {'positive = true, ' if name in positive else ''}"
        f'default = "{source.randint(1, 9)}/{source.randint(2, 7)}" }}'
        for name in names
    ]
    return (
        "[parameters]\n" + "\n".join(lines) + "\n",
        [n for n in names if n not in positive],
        positive,
    )


def _coefficient(source, names):
    """A number, a parameter or a function of one."""
    choices = ["2", "1/3", "sqrt(3)", "sqrt(2)", "5/2"]
    if names:
        a = source.choice(names)
        choices += [a, f"sin({a})", f"exp({a})", f"({a}^2 + 1)", f"cos(2*{a})"]
    return source.choice(choices)


# -- families: each a function from a generator to a draft ----------------------------------------


def rigid_body(source):
    """so(3)*: diagonal inertia, sometimes a body of revolution."""
    text, real, positive = _parameters(source, 2)
    c1, c2, c3 = (_coefficient(source, real + positive) for _ in range(3))
    round_body = source.random() < 0.5
    c2 = c1 if round_body else c2
    h = f"({c1})*mu1^2 + ({c2})*mu2^2 + ({c3})*mu3^2"
    head = f"""title = "Rigid body"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
invariance = "{source.choice(("left", "right"))}"
[variables]
mu = {{ role = "momentum" }}
{text}[hamiltonian]
h = "{h}"
"""
    integrals = ["dot(mu, mu)", h] + (["mu3"] if round_body else [])
    return Draft(
        head,
        integrals,
        ["mu1", "mu2"],
        ["mu1", "mu2", "mu3", *real],
        positive,
        ["dot(mu, mu)"],
        ["mu1", "mu1^2 + mu2^2 - mu3^2", "mu1*mu2*mu3"],
    )


def body_by_lagrangian(source):
    """so(3) by a Lagrangian and two routes."""
    draft = rigid_body(source)
    masses = [source.choice(("2", "a", "3/2", "sqrt(2)")) for _ in range(3)]
    energy = " + ".join(f"({m})*Omega{n}^2/2" for n, m in enumerate(masses, 1))
    head = f"""title = "Rigid body by its Lagrangian"
routes = ["euler-poincare", "lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Omega = {{ role = "velocity" }}
mu = {{ role = "momentum" }}
[parameters]
a = {{ positive = true, default = 3 }}
b = {{ positive = true, default = 1 }}
[lagrangian]
l = "{energy}"
"""
    h = " + ".join(f"mu{n}^2/(2*({m}))" for n, m in enumerate(masses, 1))
    integrals = ["dot(mu, mu)", h, "energy"]
    return Draft(
        head,
        integrals,
        ["mu1", "mu2", "Omega3"],
        draft.real[:3],
        ["a", "b"],
        ["dot(mu, mu)"],
        ["mu2"],
    )


def heavy_top(source):
    """so(3) with an advected vector: Lagrange's top and others."""
    text, real, positive = _parameters(source, 2)
    c, w = (_coefficient(source, real + positive) for _ in range(2))
    lagrange = source.random() < 0.6
    h = f"(Pi1^2 + Pi2^2)/2 + ({c})*Pi3^2 + ({w})*Gamma3" + ("" if lagrange else " + Gamma1/2")
    head = f"""title = "Heavy top"
routes = ["lie-poisson"]
[algebra]
name = "so(3)"
[variables]
Pi = {{ role = "momentum" }}
Gamma = {{ role = "advected", representation = "vector" }}
{text}[hamiltonian]
h = "{h}"
"""
    integrals = ["dot(Gamma, Gamma)", "dot(Pi, Gamma)", h] + (["Pi3"] if lagrange else [])
    return Draft(
        head,
        integrals,
        ["Pi1", "Gamma2"],
        ["Pi1", "Gamma1", "Gamma3", *real],
        positive,
        ["dot(Gamma, Gamma)", "dot(Pi, Gamma)"],
        ["dot(Pi, Pi)", "Gamma1"],
    )


def euclidean(source):
    """se(3)* and se(2)*: Kirchhoff's equations and the plane."""
    text, real, positive = _parameters(source, 2)
    a, b = (_coefficient(source, real + positive) for _ in range(2))
    if source.random() < 0.5:
        h = f"dot(Pi, Pi)/2 + ({a})*(P1^2 + P2^2) + ({b})*P3^2"
        head = f"""title = "Body in a fluid"
routes = ["lie-poisson"]
[algebra]
name = "se(3)"
[variables]
Pi = {{ role = "momentum", block = "rotation" }}
P = {{ role = "momentum", block = "translation" }}
{text}[hamiltonian]
h = "{h}"
"""
        casimirs = ["dot(Pi, P)", "dot(P, P)"]
        return Draft(
            head,
            [*casimirs, h, "Pi3"],
            ["Pi1", "P2"],
            ["Pi2", "P1", *real],
            positive,
            casimirs,
            ["dot(Pi, Pi)", "P3"],
        )
    h = f"({a})*s^2 + ({b})*P1"
    head = f"""title = "Plane"
routes = ["lie-poisson"]
[algebra]
name = "se(2)"
invariance = "{source.choice(("left", "right"))}"
[variables]
s = {{ role = "momentum", block = "rotation" }}
P = {{ role = "momentum", block = "translation" }}
{text}[hamiltonian]
h = "{h}"
"""
    return Draft(
        head,
        ["dot(P, P)", h],
        ["s", "P1", "P2"],
        ["s", "P2", *real],
        positive,
        ["dot(P, P)"],
        ["s", "P1^2 - P2^2"],
    )


def direct_sum(source):
    """Sums of algebras, so(4) and declared tables: many Casimirs."""
    text, real, positive = _parameters(source, 1)
    kind = source.choice(("spins", "mixed", "so(4)", "table", "plane and spin"))
    if kind == "so(4)":
        algebra, size = 'name = "so(4)"', 6
        squares = [f"mu{i}^2" for i in range(1, 7)]
        casimirs = [" + ".join(squares), "mu1*mu6 - mu2*mu5 + mu3*mu4"]
        wrong = ["mu1*mu6 + mu2*mu5 + mu3*mu4"]
    elif kind == "spins":
        algebra, size = 'direct_sum = ["so(3)", "so(3)"]', 6
        casimirs = ["mu1^2 + mu2^2 + mu3^2", "mu4^2 + mu5^2 + mu6^2"]
        wrong = ["mu1*mu4 + mu2*mu5 + mu3*mu6"]
    elif kind == "plane and spin":
        algebra, size = 'direct_sum = ["se(2)", "so(3)"]', 6
        casimirs = ["mu2^2 + mu3^2", "mu4^2 + mu5^2 + mu6^2"]
        wrong = ["mu1^2"]
    elif kind == "mixed":
        algebra, size = 'direct_sum = ["so(3)", "h(1)"]', 6
        casimirs = ["mu1^2 + mu2^2 + mu3^2", "mu6"]
        wrong = ["mu4*mu5"]
    else:
        c = source.choice([*real, *positive])
        size, algebra = (
            3,
            (
                'basis = ["e1", "e2", "e3"]\n'
                f'brackets = {{ "[e1, e2]" = "{c}*e3", "[e2, e3]" = "{c}*e1", '
                f'"[e3, e1]" = "2*{c}*e2" }}'
            ),
        )
        casimirs, wrong = ["mu1^2 + 2*mu2^2 + mu3^2"], ["mu1^2 + mu2^2 + mu3^2"]
    names = [f"mu{n}" for n in range(1, size + 1)]
    first, second = source.sample(names, 2)
    h = f"{first}^2 + {second}^2/3 + {names[0]}*{names[-1]}"
    head = f"""title = "Algebra"
routes = ["lie-poisson"]
[algebra]
{algebra}
[variables]
mu = {{ role = "momentum" }}
{text}[hamiltonian]
h = "{h}"
"""
    return Draft(head, [*casimirs, h], names, names[:3] + real, positive, casimirs, wrong)


def surface(source):
    """Brackets of three coordinates by a function, as a table or Nambu's, with a domain."""
    text, real, positive = _parameters(source, 1)
    p = source.choice([*real, *positive])
    kind = source.choice(("sphere", "log", "sine", "root", "exp"))
    C, slopes, domain = {
        "sphere": ("(x1^2 + x2^2 + x3^2)/2", ("x1", "x2", "x3"), ""),
        "log": ("log(x1 - 2) + x2*x3", ("1/(x1 - 2)", "x3", "x2"), "x1 > 2"),
        "sine": (f"sin(x1) + {p}*x3^2/2 + x2", ("cos(x1)", "1", f"{p}*x3"), ""),
        "root": ("sqrt(x1)*x2 + x3^2", ("x2/(2*sqrt(x1))", "sqrt(x1)", "2*x3"), "x1 > 0"),
        "exp": (f"exp({p}*x1) - x2*x3", (f"{p}*exp({p}*x1)", "-x3", "-x2"), ""),
    }[kind]
    h = source.choice(("x1^2 + x2*x3", "x3^2/2 + x2", f"x1*x2 + {p}*x3"))
    if source.random() < 0.5:
        table = f'nambu = ["{C}"]'
        sign = 1
    else:
        sign = source.choice((1, -1))
        s = "-" if sign == 1 else ""
        table = (
            f'brackets = {{ "{{x1, x2}}" = "{s}({slopes[2]})", "{{x2, x3}}" = "{s}({slopes[0]})", '
            f'"{{x3, x1}}" = "{s}({slopes[1]})" }}'
        )
    condition = f'[domain]\ninside = "{domain}"\n' if domain else ""
    head = f"""title = "Surface"
routes = ["poisson"]
[poisson]
{table}
[variables]
x = {{ role = "coordinate", shape = [3] }}
{text}[hamiltonian]
h = "{h}"
{condition}"""
    return Draft(
        head,
        [C, h],
        ["x1", "x2", "x3"],
        ["x2", "x3", *real, *(() if domain else ("x1",))],
        positive + (["x1"] if domain else []),
        [C],
        ["x1 + x2", "x1^2 + x2^2 - 3*x3^2"],
        {"{x1, x2}": f"{'-' if sign == 1 else ''}({slopes[2]})"},
    )


def oscillators(source):
    """A canonical bracket: separable potentials, cyclic coordinates, parity, brackets."""
    text, real, positive = _parameters(source, 2)
    p = source.choice([*real, *positive])
    even = [f"{p}*q1^2", "cos(q1)", "-cos(2*q1)", "q1^4/4", "exp(q1) + exp(-q1)", "sqrt(q1^2 + 1)"]
    odd = ["q1^3/3", "sin(q1)", f"exp({p}*q1)", "q1"]
    edge = [
        ("log(q1 - 2)", "q1 > 2"),
        ("sqrt(q1)", "q1 > 0"),
        ("1/q1", "q1 > 0"),
        ("sqrt(q1^2)", "q1 > 0"),
    ]
    kind = source.choice(("even", "even", "odd", "edge"))
    V, domain = (
        source.choice(edge)
        if kind == "edge"
        else (source.choice({"even": even, "odd": odd}[kind]), "")
    )
    c = _coefficient(source, real + positive)
    inner = f"p1^2/2 + {V}"
    h = f"{inner} + ({c})*p2^2 + p2*p3/3"
    condition = f'[domain]\ninside = "{domain}"\n' if domain else ""
    maps = ""
    if kind != "edge":
        maps = (
            "[transformations.mirror]\n"
            'map = { q = "vector(-q1, q2, q3)", p = "vector(-p1, p2, p3)" }\n'
            '[transformations.back]\nmap = { p = "-p" }\nreverses_time = true\n'
        )
    head = f"""title = "Oscillators"
routes = ["canonical"]
[poisson]
canonical = [["q", "p"]]
[variables]
q = {{ role = "coordinate", shape = [3] }}
p = {{ role = "coordinate", shape = [3] }}
{text}[hamiltonian]
h = "{h}"
{condition}"""
    integrals = [inner, "p2", "p3", "energy"]
    return Draft(
        head,
        integrals,
        ["q1", "p1", "q2", "q3"],
        ["p1", "q2", "p2", *real, *(() if domain else ("q1",))],
        positive + (["q1"] if domain else []),
        None,
        [],
        {"{q1, p1}": "1", "{q2*p2, p2}": "p2", "{sin(q2), p2}": "cos(q2)", "{q1, p2^2}": "0"},
        maps,
    )


def lagrangian(source):
    """Euler and Lagrange on coordinates: velocities are the state, or momenta."""
    text, real, positive = _parameters(source, 1)
    p = source.choice([*real, *positive])
    mass, root = source.choice((("1", "1"), ("(1 + q2^2)", "(1 + q2^2)"), ("exp(q2)", "exp(q2)")))
    V = source.choice(("cos(q2)", f"{p}*q2^2", "q2^3/3", "exp(2*q2)"))
    head = f"""title = "Lagrangian"
routes = ["euler-lagrange"]
[variables]
q = {{ role = "coordinate", shape = [2] }}
v = {{ role = "velocity", of = "q" }}
{text}[lagrangian]
l = "{mass}*v1^2/2 + v2^2/2 - {V}"
"""
    integrals = [f"{root}*v1", f"{mass}*v1^2/2 + v2^2/2 + {V}", "energy"]
    return Draft(head, integrals, ["v2", "q1", "q2"], ["q1", "q2", "v1", *real], positive)


def newton(source):
    """Newton's law of one or two coordinates."""
    text, real, positive = _parameters(source, 1)
    p = source.choice([*real, *positive])
    force, V = source.choice(
        ((f"-{p}*y", f"{p}*y^2/2"), ("sin(y)", "cos(y)"), ("-3*y^2", "y^3"), ("-exp(y)", "exp(y)"))
    )
    head = f"""title = "Newton"
routes = ["newton"]
[variables]
x = {{ role = "coordinate" }}
y = {{ role = "coordinate" }}
u = {{ role = "velocity", of = "x" }}
w = {{ role = "velocity", of = "y" }}
{text}[newton]
x = {{ force = "0" }}
y = {{ mass = "2", force = "{force}" }}
"""
    return Draft(head, ["u", f"w^2 + {V}"], ["x", "y", "w"], ["x", "y", "u", *real], positive)


def constrained(source):
    """Constraints on velocities of coordinates: given, kept, integrable or not."""
    p = source.choice(("1", "a"))
    rule, integrals = source.choice(
        (
            ("v3 - q2*v1 == 0", ["v2", "energy"]),
            ("v3 - sin(q2)*v1 == 0", ["v2", "energy"]),
            ("a*v1 - b*v3 == 0", ["v2", "v1", "energy", "b*q3 - a*q1"]),
            ("cos(q2)*v3 - sin(q2)*v1 == 0", ["v2", "energy"]),
            ("cos(a)*v3 - sin(a)*v1 == 0", ["v2", "v1", "energy", "cos(a)*q3 - sin(a)*q1"]),
            ("v1 + v3 == 0", ["v2", "v1 - v3", "energy", "q1 + q3"]),
        )
    )
    V = source.choice(("", "", " - q2^2/2"))
    if V:
        integrals = [each for each in integrals if each != "v2"] + ["v2^2 + q2^2"]
    head = f"""title = "Constrained"
routes = ["nonholonomic", "hamel"]
[variables]
q = {{ role = "coordinate", shape = [3] }}
v = {{ role = "velocity", of = "q" }}
[parameters]
a = {{ positive = true, default = 2 }}
b = {{ positive = true, default = "3/2" }}
[lagrangian]
l = "({p}*v1^2 + {p}*v2^2 + {p}*v3^2)/2{V}"
[constraints]
c = "{rule}"
"""
    if V and p != "1":
        integrals = [f"{p}*v2^2 + q2^2" if each == "v2^2 + q2^2" else each for each in integrals]
    return Draft(head, integrals, ["q1", "q2"], ["q1", "q2", "v2"], ["a", "b"])


def turning(source):
    """Constraints on an algebra: Suslov's problem and Chaplygin's sleigh."""
    if source.random() < 0.5:
        axis, moving = source.choice((("Omega3", "Omega1"), ("Omega1 + Omega2", "Omega3")))
        head = f"""title = "Suslov"
routes = ["nonholonomic", "hamel"]
[algebra]
name = "so(3)"
[variables]
Omega = {{ role = "velocity" }}
[parameters]
I = {{ shape = [3], positive = true, default = [1, 2, 3] }}
k = {{ positive = true, default = "1/4" }}
[lagrangian]
l = "dot(Omega, diag(I)*Omega)/2 + k*Omega1*Omega3/(1 + k)"
[constraints]
c = "{axis} == 0"
"""
        return Draft(head, ["energy"], [moving], ["Omega2"], ["I1", "I2", "k"])
    return Draft(
        SLEIGH, ["energy", "m*v^2 + (I + m*a^2)*omega^2"], ["v", "omega"], ["v"], ["a", "m"]
    )


#: Families and how often each is drawn; constrained ones take the most time.
FAMILIES = {
    rigid_body: 4,
    body_by_lagrangian: 2,
    heavy_top: 3,
    euclidean: 3,
    direct_sum: 4,
    surface: 5,
    oscillators: 6,
    lagrangian: 4,
    newton: 2,
    constrained: 2,
    turning: 1,
}


def generate(seed, claims=8):
    """The text of a random spec.

    Args:
        seed: The same text for the same seed.
        claims: How many integrals are claimed.
    """
    source = random.Random(f"spec {seed}")
    family = source.choices(list(FAMILIES), list(FAMILIES.values()))[0]
    draft = family(source)
    return draft.head + draft.maps + Author(source, draft).claims(claims, deep=seed % 3 == 0)
