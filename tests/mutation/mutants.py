"""Single changes that must not survive: a sign or an index flipped in the engine.

Each names a file, a piece of text that occurs exactly once in it, and what takes its place. A
piece that is no longer there fails the campaign, so the list cannot rot.
"""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Mutant:
    """One change.

    Attributes:
        file: Path below the root of the repository.
        old: What is there, once.
        new: What takes its place.
        equivalent: Why no check can see it, if so; else empty.
        always: Whether it is tried in every run of the tests, not only in campaigns.
    """

    file: str
    old: str
    new: str
    equivalent: str = ""
    always: bool = False

    @property
    def name(self) -> str:
        """Short name for reports."""
        return f"{self.file.rsplit('/', 1)[-1]}: {self.old.strip()} -> {self.new.strip()}"


ALGEBRA = "src/coadjoint/algebra/"
FAMILIES = ALGEBRA + "families.py"
GROUPS = "src/coadjoint/groups/"
POISSON = "src/coadjoint/poisson/"
EXACT = "src/coadjoint/exact/"
DERIVE = "src/coadjoint/derive/"
PROVE = "src/coadjoint/prove/"
LOWER = "src/coadjoint/lower/"
RENDER = "src/coadjoint/render/"

#: Structure constants, ad* and the choice of minus or plus: tried in every run.
SIGNS = (
    Mutant(FAMILIES, "return {(k, j): 1, (j, k): -1}", "return {(k, j): -1, (j, k): 1}"),
    Mutant(FAMILIES, "{(i, j): 1, (j, i): -1}) for", "{(i, j): -1, (j, i): 1}) for"),
    Mutant(FAMILIES, '[("J", {(0, 1): -1, (1, 0): 1})]', '[("J", {(0, 1): 1, (1, 0): -1})]'),
    Mutant(FAMILIES, '("E", unit(3, 4))', '("E", unit(3, 4, -1))'),
    Mutant(
        ALGEBRA + "matrices.py",
        "product(a, b)\n    add_multiple(result, -1, product(b, a))",
        "product(b, a)\n    add_multiple(result, -1, product(a, b))",
    ),
    Mutant(ALGEBRA + "lie_algebra.py", "if i < j else ((j, i), -1)", "if i < j else ((j, i), 1)"),
    Mutant(ALGEBRA + "invariants.py", "yield j, i, k, -c", "yield j, i, k, c"),
    Mutant(
        ALGEBRA + "lie_algebra.py",
        "result[j] + scaled(xi[i] * mu[k], c)",
        "result[j] - scaled(xi[i] * mu[k], c)",
    ),
    Mutant(
        POISSON + "brackets.py",
        "mu[k] if sign * c == 1 else opposite[k]",
        "opposite[k] if sign * c == 1 else mu[k]",
    ),
    Mutant(
        DERIVE + "euler_poincare.py",
        "[sign * m for m in momentum]",
        "[-sign * m for m in momentum]",
    ),
    Mutant(DERIVE + "structure.py", "sign = -setting.sign", "sign = setting.sign"),
    Mutant(
        DERIVE + "setting.py",
        'return 1 if self.spec.invariance == "left" else -1',
        'return -1 if self.spec.invariance == "left" else 1',
    ),
)
MUTANTS = (
    *(replace(mutant, always=True) for mutant in SIGNS),
    # structure constants
    Mutant(FAMILIES, "return {(k, j): 1, (j, k): -1}", "return {(k, j): 1, (j, k): 1}"),
    Mutant(FAMILIES, "unit(i, column)) for i", "unit(i, column, -1)) for i"),
    Mutant(FAMILIES, "= (axis + 1) % 3, (axis + 2) % 3", "= (axis + 2) % 3, (axis + 1) % 3"),
    Mutant(FAMILIES, "{(i, j): 1, (j, i): -1 if", "{(i, j): 1, (j, i): 1 if"),
    Mutant(FAMILIES, "{(i, 3): 1, (4, i): 1}", "{(i, 3): 1, (4, i): -1}"),
    Mutant(FAMILIES, "(n + j, n + i): -1}", "(n + j, n + i): 1}"),
    Mutant(FAMILIES, "{(0, 1): -half, (1, 0): half}, {})", "{(0, 1): half, (1, 0): -half}, {})"),
    Mutant(FAMILIES, "i: Matrix = {(0, 1): -1, (1, 0): 1}", "i: Matrix = {(0, 1): 1, (1, 0): -1}"),
    Mutant(
        ALGEBRA + "matrices.py",
        "add_multiple(result, -1, product(b, a))",
        "add_multiple(result, 1, product(b, a))",
    ),
    Mutant(ALGEBRA + "lie_algebra.py", "term = (b, a, c, n), -inner", "term = (b, a, c, n), inner"),
    # ad*, brackets, tensors
    Mutant(ALGEBRA + "lie_algebra.py", "scaled(xi[i] * mu[k], c)", "scaled(xi[j] * mu[k], c)"),
    Mutant(
        ALGEBRA + "lie_algebra.py",
        "result[k] + scaled(xi[i] * eta[j], c)",
        "result[k] - scaled(xi[i] * eta[j], c)",
    ),
    Mutant(ALGEBRA + "lie_algebra.py", "scaled(mu[k], sign * c)", "scaled(mu[k], -sign * c)"),
    Mutant(ALGEBRA + "lie_algebra.py", "sign: int = -1", "sign: int = 1"),
    Mutant(
        ALGEBRA + "lie_algebra.py",
        "matrix[k][j] + scaled(xi[i], c)",
        "matrix[k][j] - scaled(xi[i], c)",
    ),
    # representations, products, extensions
    Mutant(ALGEBRA + "representation.py", "result[row] + scaled(", "result[row] - scaled("),
    Mutant(ALGEBRA + "representation.py", "result[i] - scaled(", "result[i] + scaled("),
    Mutant(ALGEBRA + "representation.py", "{(c, r): -v for", "{(c, r): v for"),
    Mutant(ALGEBRA + "representation.py", "{(c, r): -v for", "{(r, c): -v for"),
    Mutant(
        ALGEBRA + "products.py",
        "[start + row] = value\n    extra",
        "[start + row] = -value\n    extra",
    ),
    Mutant(
        ALGEBRA + "products.py",
        "[start + row] = value\n    title",
        "[start + row] = -value\n    title",
    ),
    Mutant(ALGEBRA + "extensions.py", "[k] = -c", "[k] = c"),
    Mutant(ALGEBRA + "extensions.py", "value if i < j else -value", "value"),
    Mutant(ALGEBRA + "extensions.py", "[(a + b) * d + k] = c", "[(a + b) * d + k] = -c"),
    # derivation
    Mutant(DERIVE + "euler_poincare.py", "[-sign * x for x in", "[sign * x for x in"),
    Mutant(DERIVE + "euler_poincare.py", "[m + t for", "[m - t for"),
    Mutant(DERIVE + "poisson.py", "sum(entry * slope for", "sum(-entry * slope for"),
    Mutant(DERIVE + "nambu.py", "-multiplier * rate for", "multiplier * rate for"),
    Mutant(
        DERIVE + "nambu.py",
        "[dh, *gradients[:-1]]",
        "[*gradients[:-1], dh]",
    ),
    Mutant(DERIVE + "nambu.py", "(-1) ** i * determinant(minor)", "determinant(minor)"),
    Mutant(
        DERIVE + "structure.py",
        "[(names[i], names[j]) for i, j in bracket.pairs]",
        "[(names[j], names[i]) for i, j in bracket.pairs]",
    ),
    Mutant(
        DERIVE + "structure.py",
        "{(names[i], names[j]): value for",
        "{(names[j], names[i]): value for",
    ),
    Mutant(DERIVE + "structure.py", "action.dual()) for name", "action) for name"),
    Mutant(
        DERIVE + "setting.py",
        "{place: self.taken(value) for",
        "{place: -self.taken(value) for",
    ),
    Mutant(DERIVE + "setting.py", 'return 1 if self.spec.invariance == "left" else -1', "return 1"),
    Mutant(
        DERIVE + "legendre.py",
        "(1 / w) - field.substitute",
        "(1 / w) + field.substitute",
    ),
    Mutant(
        DERIVE + "legendre.py",
        "for mu, xi, w in pairs), -lagrangian)",
        "for mu, xi, w in pairs), lagrangian)",
    ),
    Mutant(DERIVE + "interpret.py", "(-1) ** (i + j) * determinant", "determinant"),
    Mutant(DERIVE + "interpret.py", "(-1) ** j * x * determinant", "x * determinant"),
    Mutant(DERIVE + "interpret.py", "_scale(-field.one,", "_scale(field.one,"),
    Mutant(DERIVE + "interpret.py", "    return a - b\n", "    return a + b\n"),
    # exact calculus
    Mutant(
        EXACT + "element.py",
        "numer * slope * -exponent",
        "numer * slope * exponent",
    ),
    Mutant(
        EXACT + "field.py",
        "return -inner * self[known.partner]",
        "return inner * self[known.partner]",
    ),
    Mutant(
        EXACT + "field.py",
        "self.one - self[known.partner] ** 2",
        "self.one + self[known.partner] ** 2",
    ),
    Mutant(EXACT + "element.py", "Quotient(-q.numer, q.powers)", "Quotient(q.numer, q.powers)"),
    # groups
    Mutant(GROUPS + "vectors.py", "a3 * b1 - a1 * b3", "a1 * b3 - a3 * b1"),
    Mutant(
        GROUPS + "group.py",
        "product(g, self.matrix(eta), self.inverse(g))",
        "product(self.inverse(g), self.matrix(eta), g)",
    ),
    Mutant(
        GROUPS + "group.py",
        "zip(mu, column, strict=True))\n            for column in transpose(self.Ad_matrix(g))",
        "zip(mu, column, strict=True))\n            for column in self.Ad_matrix(g)",
    ),
    Mutant(GROUPS + "group.py", "self.algebra.ad_star(xi, mu)", "self.algebra.ad_star(mu, xi)"),
    Mutant(GROUPS + "actions.py", "inverse, xi = group.inverse(g)", "inverse, xi = g"),
    Mutant(
        GROUPS + "actions.py",
        "left_translation(group.matrix(xi))",
        "right_translation(group.matrix(xi))",
    ),
    Mutant(
        GROUPS + "maps.py", "-HALF * trace(matmul(mu, xi)).re", "HALF * trace(matmul(mu, xi)).re"
    ),
    Mutant(GROUPS + "maps.py", "HALF * (mu[k][j] - mu[j][k])", "HALF * (mu[j][k] - mu[k][j])"),
    Mutant(GROUPS + "maps.py", "((zero, -a3, a2), (a3", "((zero, a3, a2), (a3"),
    Mutant(GROUPS + "quaternions.py", "a * x + b * w - s * (", "a * x + b * w + s * ("),
    Mutant(GROUPS + "quaternions.py", "- self.square * planes", "+ self.square * planes"),
    Mutant(GROUPS + "rotations.py", "return mu * xi - xi * mu", "return xi * mu - mu * xi"),
    Mutant(GROUPS + "hopf.py", "scale(-4, cross(n, dH_dn))", "scale(4, cross(n, dH_dn))"),
    Mutant(GROUPS + "charts.py", "(zeta.norm - 1) / below", "(1 - zeta.norm) / below"),
    Mutant(
        GROUPS + "vector_fields.py",
        "return -lie_derivative(u, curl(u))",
        "return lie_derivative(u, curl(u))",
    ),
    Mutant(
        GROUPS + "vector_fields.py",
        "*scale(-1, field.gradient(energy, positions))",
        "*field.gradient(energy, positions)",
    ),
    Mutant(GROUPS + "central_forces.py", "scale(-lam / d**3,", "scale(lam / d**3,"),
    Mutant(GROUPS + "complex_numbers.py", "(-z.im for z in row)", "(z.im for z in row)"),
    # Poisson brackets
    Mutant(
        POISSON + "brackets.py",
        "density * minor * (-1) ** (i + j)",
        "density * minor * (-1) ** (i + j + 1)",
    ),
    Mutant(POISSON + "brackets.py", "(-1) ** place * rows[0][k]", "rows[0][k]"),
    Mutant(POISSON + "brackets.py", "(a, n + a): scale[a] for", "(a, n + a): -scale[a] for"),
    Mutant(
        POISSON + "brackets.py", "entries[n + a, n + b] = value", "entries[n + a, n + b] = -value"
    ),
    Mutant(
        POISSON + "structure.py",
        "rows[j][i] = entry, opposite[id(entry)]",
        "rows[j][i] = opposite[id(entry)], entry",
    ),
    Mutant(POISSON + "structure.py", "rest = rest - slope *", "rest = rest + slope *"),
    Mutant(POISSON + "jacobi.py", "-term if a == middle else term", "term"),
    Mutant(POISSON + "polynomial_bracket.py", "+ factor * value\n", "+ value\n"),
    Mutant(
        POISSON + "polynomial_bracket.py",
        "+ factor * value\n",
        "- 2 * factor * value\n",
        equivalent="the sum is only compared with zero, and every term of it has the same factor",
    ),
    Mutant(POISSON + "polynomial_bracket.py", "+ value * power", "+ value"),
    Mutant(
        POISSON + "nambu_theory.py",
        "(x1**2 + x2**2 + x3**2) / 2 - i3 * h",
        "(x1**2 + x2**2 + x3**2) / 2 + i3 * h",
    ),
    # proofs
    Mutant(PROVE + "identities.py", "tensor[i][j] + tensor[j][i]", "tensor[i][j] - tensor[j][i]"),
    Mutant(PROVE + "identities.py", "rate - _dot(field, in_vel", "rate + _dot(field, in_vel"),
    Mutant(
        PROVE + "claims.py",
        "first.closed(a) - other.closed(b)",
        "first.closed(a) + other.closed(b)",
    ),
    Mutant(PROVE + "equivalence.py", "- self.pull_back(second, b)", "+ self.pull_back(second, b)"),
    Mutant(PROVE + "equivalence.py", "* w - field[xi]", "* w + field[xi]"),
    Mutant(
        PROVE + "equivalence.py",
        "equations.exact.energy) - energy]",
        "equations.exact.energy) + energy]",
    ),
    Mutant(PROVE + "completeness.py", "== len(slopes) + 1", ">= len(slopes)"),
    Mutant(
        PROVE + "completeness.py", "(*setting.momenta, *advected)", "(*advected, *setting.momenta)"
    ),
    Mutant(
        PROVE + "completeness.py",
        "expected = structure.dimension - structure",
        "expected = structure.dimension + 0 * structure",
    ),
    # lowering
    Mutant(
        LOWER + "lowering.py",
        "value, sign = -coefficient, -1",
        "value, sign = -coefficient, 1",
    ),
    Mutant(
        LOWER + "lowering.py",
        "return node if sign > 0 else self.graph.negate(node)",
        "return node if sign < 0 else self.graph.negate(node)",
    ),
    Mutant(
        LOWER + "graph.py",
        "return self.negate(self.multiply(a, self.operands[b][0]))",
        "return self.multiply(a, self.operands[b][0])",
    ),
    Mutant(
        LOWER + "graph.py",
        "return self.add(self.multiply(da, b), self.multiply(a, db))",
        "return self.add(self.multiply(da, b), self.negate(self.multiply(a, db)))",
    ),
    Mutant(LOWER + "graph.py", "self.negate(self.multiply(node, db))", "self.multiply(node, db)"),
    Mutant(
        LOWER + "graph.py",
        'return self.negate(self.call("sin", argument))',
        'return self.call("sin", argument)',
    ),
    Mutant(LOWER + "program.py", "return -evaluate(operand", "return evaluate(operand"),
    # printers and templates
    Mutant(RENDER + "printers.py", 'return "-", operand', 'return "+", operand'),
    Mutant(
        RENDER + "printers.py",
        'return "-" + self._operand(operand, ATOM)',
        "return self._operand(operand, ATOM)",
    ),
    Mutant(RENDER + "printers.py", 'return "/", node.right', 'return "*", node.right'),
    Mutant(
        "templates/c/kernel.c.j2",
        "state[{{ row.index }} * state_stride + _n]",
        "state[{{ row.index }} * state_stride - _n]",
    ),
    Mutant(
        "templates/c/kernel.c.j2",
        '"out[%d * out_stride + _n]" | format(row)',
        '"out[%d * out_stride + _n]" | format(function.outputs[-loop.index][0])',
    ),
    Mutant(
        "templates/c/kernel.c.j2",
        '" * parameters_stride + _n") }}',
        '" * parameters_stride - _n") }}',
    ),
    Mutant(
        "templates/c/kernel.c.j2",
        '{{ statement.value | c_assignment(to="const double " ~ '
        "statement.name, column=indent | length) }}\n{% endfor %}\n{% endif %}\n"
        "{{ indent }}/* results */",
        '{{ statement.value | c_assignment(to="const double " ~ statement.name ~ " = -", '
        "column=indent | length) }}\n{% endfor %}\n{% endif %}\n{{ indent }}/* results */",
    ),
    Mutant(
        "templates/numpy/kernel.py.j2",
        '"out[%d]" | format(row)',
        '"out[%d]" | format(function.outputs[-loop.index][0])',
    ),
    Mutant(
        "templates/numpy/kernel.py.j2",
        "python_assignment(to=statement.name, column=4) }}\n"
        "{% endfor %}\n{% endif %}\n    # results",
        "python_assignment(to=statement.name ~ ' = -', column=4) }}\n"
        "{% endfor %}\n{% endif %}\n    # results",
    ),
    # mass points, cyclic coordinates, found functions, complex momenta, sections
    Mutant(DERIVE + "newton_euler.py", "subtract(torque, turning)", "add(torque, turning)"),
    Mutant(DERIVE + "newton_euler.py", "setting.field, -_at_rest(", "setting.field, _at_rest("),
    Mutant(DERIVE + "newton_euler.py", "half = trace(inertia) / 2", "half = trace(inertia)"),
    Mutant(
        DERIVE + "newton_euler.py",
        "lambda x, y: cross(x, cross(omega, cross(omega, y)))",
        "lambda x, y: cross(x, cross(omega, cross(y, omega)))",
    ),
    Mutant(
        DERIVE + "newton_euler.py",
        "lambda x: cross(x, cross(omega, v))",
        "lambda x: cross(x, cross(v, omega))",
    ),
    Mutant(
        DERIVE + "newton_euler.py",
        "(mass[2][4], mass[0][5], mass[1][3])",
        "(mass[1][5], mass[2][3], mass[0][4])",
    ),
    Mutant(DERIVE + "kaluza_klein.py", "varied -= dot(", "varied += dot("),
    Mutant(
        DERIVE + "kaluza_klein.py", "kinetic = lagrangian - dot(level, a)", "kinetic = lagrangian"
    ),
    Mutant(DERIVE + "kaluza_klein.py", "append(sign * varied)", "append(varied)"),
    Mutant(DERIVE + "kaluza_klein.py", "scale(-sign, setting", "scale(sign, setting"),
    Mutant(DERIVE + "kaluza_klein.py", "algebra.bracket(xi, eta)", "algebra.bracket(eta, xi)"),
    Mutant(DERIVE + "kaluza_klein.py", "field[name] - value", "field[name] + value"),
    Mutant(DERIVE + "nambu.py", "b = tuple(-tensor[i][j]", "b = tuple(tensor[i][j]"),
    Mutant(DERIVE + "nambu.py", "dot(x, b) / 2", "dot(x, b)"),
    Mutant(DERIVE + "nambu.py", "(1, 2), (2, 0), (0, 1)", "(1, 2), (0, 2), (0, 1)"),
    Mutant(DERIVE + "nambu.py", "b[place] / slopes[place]", "slopes[place] / b[place]"),
    Mutant(DERIVE + "nambu.py", "slopes[i][j] - slopes[j][i]", "slopes[i][j] + slopes[j][i]"),
    Mutant(DERIVE + "complexification.py", "*(z.im for z in moved)", "*(-z.im for z in moved)"),
    Mutant(DERIVE + "complexification.py", "*(-z.im for z in zeta)", "*(z.im for z in zeta)"),
    Mutant(DERIVE + "complexification.py", "setting.sign * part", "-setting.sign * part"),
    Mutant(DERIVE + "complexification.py", "Complex(x, y) for x", "Complex(y, x) for x"),
    Mutant(DERIVE + "complexification.py", "real.bracket(zeta, eta)", "real.bracket(eta, zeta)"),
    Mutant(
        DERIVE + "complexification.py",
        "_continued(setting, slope, L) for slope",
        "Complex(slope, setting.field.zero) for slope",
    ),
    Mutant(
        PROVE + "reductions.py",
        "decide_zero(drifts, field, Ideal(field, functions, where, state))",
        "decide_zero([], field, Ideal(field, functions, where, state))",
    ),
    Mutant(PROVE + "reductions.py", "- rates[name]", "+ rates[name]"),
    Mutant(
        PROVE + "reductions.py",
        "[field.substitute(restriction(f), restriction.section) for f in functions]",
        "[field.substitute(f - f, restriction.section) for f in map(restriction, functions)]",
    ),
)
