"""Single changes that must not survive: a sign or an index flipped in the engine.

Each names a file, a piece of text that occurs exactly once in it, and what takes its place. A
piece that is no longer there fails the campaign, so the list cannot rot. Derivations have a list of
their own: `tests.mutation.routes`.
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
        tests: What judges it, as arguments of pytest; by default the tests of its step.
    """

    file: str
    old: str
    new: str
    equivalent: str = ""
    always: bool = False
    tests: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Short name for reports."""
        return f"{self.file.rsplit('/', 1)[-1]}: {self.old.strip()} -> {self.new.strip()}"


ALGEBRA = "src/coadjoint/algebra/"
FAMILIES = ALGEBRA + "families.py"
GROUPS = "src/coadjoint/groups/"
THEORY = "src/coadjoint/theory/"
POISSON = "src/coadjoint/poisson/"
EXACT = "src/coadjoint/exact/"
PROVE = "src/coadjoint/prove/"
DEFINITIONS = "src/coadjoint/spec/core/definitions.py"
LOWER = "src/coadjoint/lower/"
RENDER = "src/coadjoint/render/"
TARGETS = RENDER + "targets/"

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
        "result[j] + multiply_constant(xi[i] * mu[k], c)",
        "result[j] - multiply_constant(xi[i] * mu[k], c)",
    ),
    Mutant(
        POISSON + "brackets.py",
        "mu[k] if sign * c == 1 else opposite[k]",
        "opposite[k] if sign * c == 1 else mu[k]",
    ),
)
#: Checks that compare less than they say, or nothing, and lowering that multiplies everything
#: out: tried in every run, by the few tests that see them.
CHECKS = (
    Mutant(
        PROVE + "equivalence.py",
        "for a, b in zip(first.exact.rates, second.exact.rates, strict=True)",
        "for a, b in zip(first.exact.rates[:1], second.exact.rates, strict=False)",
        tests=("tests/prove/test_equivalence.py", "-k", "velocities"),
    ),
    Mutant(
        PROVE + "constrained.py",
        "defects += [a - field[rate_name(x)], b - field[rate_name(x)]]",
        "defects += []",
        tests=("tests/prove/test_equivalence.py", "-k", "solves"),
    ),
    Mutant(
        LOWER + "check.py",
        "if not field.is_zero(a - b):",
        "if False:",
        tests=("tests/lower/test_lowering.py", "-k", "one_changed_node"),
    ),
    Mutant(
        LOWER + "check.py",
        "enumerate(zip(program.outputs, found, expected, strict=True)):\n        if not",
        "list(enumerate(zip(program.outputs, found, expected, strict=True)))[:1]:\n        if not",
        tests=("tests/lower/test_lowering.py", "-k", "one_changed_node"),
    ),
    Mutant(
        LOWER + "check.py",
        "            if a != b:",
        "            if False:",
        tests=("tests/derive/test_projection.py", "-k", "undone"),
    ),
    Mutant(
        LOWER + "lowering.py",
        "return closed if terms(closed) < terms(element) and not moving else element",
        "return closed",
        tests=("tests/lower/test_lowering.py", "-k", "careful_hand and kirchhoff"),
    ),
    Mutant(
        PROVE + "measures.py",
        "    if _is_certain(motion, measure, samples, found, rank):",
        "    if found:",
        tests=("tests/prove/test_measures.py", "-k", "larger_rank"),
    ),
    Mutant(
        "src/coadjoint/regenerate.py",
        "    if differences:\n        extra =",
        "    if False:\n        extra =",
        tests=("tests/test_regenerate.py", "-k", "check_says_what_to_do"),
    ),
)
#: Proofs about motions that depend on time or inputs, and kernels that lose these.
DRIVEN = (
    *(
        Mutant(PROVE + file, old, new, tests=("tests/prove/test_driven.py",))
        for file, old, new in (
            ("identities.py", "[carried + own_rate(", "[carried - own_rate("),
            ("constrained.py", "return own + self.field.sum(", "return self.field.sum("),
            (
                "driven.py",
                "return -equations.closed(explicit(",
                "return equations.closed(explicit(",
            ),
            ("driven.py", 'if needed else ""', 'if not needed else ""'),
            ("symmetries.py", "part + explicit(setting, own)", "part - explicit(setting, own)"),
            ("symmetries.py", "{t: -setting.field[t] for t", "{t: setting.field[t] for t"),
            ("almost_poisson.py", "explicit(setting, a) * x for", "-explicit(setting, a) * x for"),
        )
    ),
    *(
        Mutant(TARGETS + file, old, new, tests=("tests/crosscheck/test_driven.py",))
        for file, old, new in (
            ("numpy/kernel.py.j2", "else {{ array }}[:, chunk]", "else {{ array }}[:, :1]"),
            ("c/kernel.c.j2", "_n * _{{ array }}_member]", "_n * 0]"),
            ("c/kernel.c.j2", "_member = {{ array }}_stride != 0", "_member = 0"),
        )
    ),
)
MUTANTS = (
    *DRIVEN,
    *(replace(mutant, always=True) for mutant in CHECKS),
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
    Mutant(
        ALGEBRA + "lie_algebra.py",
        "multiply_constant(xi[i] * mu[k], c)",
        "multiply_constant(xi[j] * mu[k], c)",
    ),
    Mutant(
        ALGEBRA + "lie_algebra.py",
        "result[k] + multiply_constant(xi[i] * eta[j], c)",
        "result[k] - multiply_constant(xi[i] * eta[j], c)",
    ),
    Mutant(
        ALGEBRA + "lie_algebra.py",
        "multiply_constant(mu[k], sign * c)",
        "multiply_constant(mu[k], -sign * c)",
    ),
    Mutant(ALGEBRA + "lie_algebra.py", "sign: int = -1", "sign: int = 1"),
    Mutant(
        ALGEBRA + "lie_algebra.py",
        "matrix[k][j] + multiply_constant(xi[i], c)",
        "matrix[k][j] - multiply_constant(xi[i], c)",
    ),
    # representations, products, extensions
    Mutant(
        ALGEBRA + "representation.py",
        "result[row] + multiply_constant(",
        "result[row] - multiply_constant(",
    ),
    Mutant(
        ALGEBRA + "representation.py",
        "result[i] - multiply_constant(",
        "result[i] + multiply_constant(",
    ),
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
        "return self.one - self[known.partner] ** 2",
        "return self.one + self[known.partner] ** 2",
    ),
    Mutant(EXACT + "element.py", "Quotient(-q.numer, q.powers)", "Quotient(q.numer, q.powers)"),
    # groups
    Mutant(EXACT + "dense.py", "a3 * b1 - a1 * b3", "a1 * b3 - a3 * b1"),
    Mutant(
        THEORY + "group.py",
        "product(g, self.matrix(eta), self.inverse(g))",
        "product(self.inverse(g), self.matrix(eta), g)",
    ),
    Mutant(
        THEORY + "group.py",
        "zip(mu, column, strict=True))\n            for column in transpose(self.Ad_matrix(g))",
        "zip(mu, column, strict=True))\n            for column in self.Ad_matrix(g)",
    ),
    Mutant(THEORY + "group.py", "self.algebra.ad_star(xi, mu)", "self.algebra.ad_star(mu, xi)"),
    Mutant(THEORY + "actions.py", "inverse, xi = group.inverse(g)", "inverse, xi = g"),
    Mutant(
        THEORY + "actions.py",
        "left_translation(group.matrix(xi))",
        "right_translation(group.matrix(xi))",
    ),
    Mutant(
        THEORY + "maps.py", "-HALF * trace(product(mu, xi)).re", "HALF * trace(product(mu, xi)).re"
    ),
    Mutant(THEORY + "maps.py", "HALF * (mu[k][j] - mu[j][k])", "HALF * (mu[j][k] - mu[k][j])"),
    Mutant(EXACT + "dense.py", "((zero, -a3, a2), (a3", "((zero, a3, a2), (a3"),
    Mutant(GROUPS + "quaternions.py", "a * x + b * w - s * (", "a * x + b * w + s * ("),
    Mutant(GROUPS + "quaternions.py", "- self.square * planes", "+ self.square * planes"),
    Mutant(THEORY + "rotations.py", "return mu * xi - xi * mu", "return xi * mu - mu * xi"),
    Mutant(THEORY + "hopf.py", "scale(-4, cross(n, dH_dn))", "scale(4, cross(n, dH_dn))"),
    Mutant(THEORY + "charts.py", "(zeta.norm - 1) / below", "(1 - zeta.norm) / below"),
    Mutant(
        THEORY + "vector_fields.py",
        "return -lie_derivative(u, curl(u))",
        "return lie_derivative(u, curl(u))",
    ),
    Mutant(
        THEORY + "vector_fields.py",
        "*scale(-1, field.gradient(energy, positions))",
        "*field.gradient(energy, positions)",
    ),
    Mutant(THEORY + "central_forces.py", "scale(-lam / d**3,", "scale(lam / d**3,"),
    Mutant(GROUPS + "complex_numbers.py", "(-z.im for z in row)", "(z.im for z in row)"),
    # Poisson brackets
    Mutant(
        POISSON + "brackets.py",
        "density * value * (-1) ** (i + j)",
        "density * value * (-1) ** (i + j + 1)",
    ),
    Mutant(EXACT + "dense.py", "(-1) ** j * x * determinant", "x * determinant"),
    Mutant(EXACT + "dense.py", "(-1) ** (i + j) * determinant", "determinant"),
    Mutant(EXACT + "dense.py", "_join(operator.sub, a, b)", "_join(operator.add, a, b)"),
    Mutant(EXACT + "linear.py", "prime, equations, lambda", "prime, equations[1:], lambda"),
    Mutant(EXACT + "ansatz.py", "if last in solved:", "if last not in solved:"),
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
        THEORY + "nambu.py",
        "(x1**2 + x2**2 + x3**2) / 2 - i3 * h",
        "(x1**2 + x2**2 + x3**2) / 2 + i3 * h",
    ),
    # proofs
    Mutant(PROVE + "identities.py", "tensor[i][j] + tensor[j][i]", "tensor[i][j] - tensor[j][i]"),
    Mutant(PROVE + "identities.py", "rate - dot(in_vel", "rate + dot(in_vel"),
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
    Mutant(
        POISSON + "casimirs.py",
        "independent_rows(structure.field, slopes)",
        "range(len(slopes))",
    ),
    Mutant(POISSON + "casimirs.py", "if len(given) >= expected:", "if given:"),
    Mutant(POISSON + "summands.py", "(i, j, *reached[id(entry)])", "(i, j)"),
    Mutant(POISSON + "summands.py", "c if a < b else -c", "c"),
    Mutant(PROVE + "claims.py", "if decide().verdict is Verdict.PROVED:", "if decide():"),
    Mutant(PROVE + "measures.py", "- len(samples.unit):", "- len(samples.unit) or found:"),
    Mutant(PROVE + "measures.py", "rates, -point.value(self", "rates, point.value(self"),
    Mutant(PROVE + "invariant_factors.py", "return rate != 0 and", "return rate == 0 or"),
    Mutant(PROVE + "reversibility.py", "if name and motion.distribution.kept", "if not name"),
    Mutant(PROVE + "almost_poisson.py", "plain or total > 0 or total < 0", "True"),
    Mutant(
        PROVE + "completeness.py",
        "expected = structure.dimension - structure",
        "expected = structure.dimension + 0 * structure",
    ),
    # routes in variables of their own, ideals, zero where relations hold
    Mutant(
        PROVE + "charts.py",
        "own - self.pull_back(self.first.closed(rate))",
        "own - own",
    ),
    Mutant(
        PROVE + "charts.py",
        "yield whole - self.other.closed(self.field[name])",
        "yield whole - whole",
    ),
    Mutant(
        PROVE + "charts.py",
        "self.other.closed(self.carried(relation.element)) for",
        "self.field.zero for",
    ),
    Mutant(PROVE + "charts.py", "self._ranks[1] - self._ranks[0]", "self._ranks[1]"),
    Mutant(PROVE + "charts.py", "[*slopes, row]) > len(slopes)", "[*slopes, row]) >= len(slopes)"),
    Mutant(PROVE + "charts.py", "met = len(relations) == missing", "met = bool(relations)"),
    # ranks, points of constrained motions, integrals that are counted
    Mutant(
        "src/coadjoint/exact/ranks.py",
        "for column, value in row.items() if value.sign}",
        "for column, value in row.items()}",
    ),
    Mutant(
        "src/coadjoint/exact/ranks.py",
        "islice(primes(), TRIES)",
        "[2**61 - 1] * TRIES",
    ),
    Mutant(PROVE + "functions.py", "None if moves else self._turn(group)", "None"),
    Mutant(PROVE + "functions.py", "turn if multiple > 0 else _inverse(turn)", "turn"),
    Mutant(PROVE + "functions.py", "self._functions.proper.add(name)", "pass"),
    Mutant(PROVE + "samples.py", "if self.functions.proper == self.functions.roots:", "if True:"),
    Mutant(PROVE + "candidates.py", "if not unproved:", "if True:"),
    Mutant(PROVE + "candidates.py", "if bounded and certain ==", "if certain =="),
    Mutant(
        PROVE + "candidates.py",
        "if moved.keys() <= place.keys():",
        "if moved.keys() & place.keys():",
    ),
    Mutant(PROVE + "ideals.py", "inner.rem(self._basis).terms()", "inner.terms()"),
    Mutant(PROVE + "ideals.py", "others = -rest / slope", "others = rest / slope"),
    Mutant(
        PROVE + "points.py",
        "free[name] + by for",
        "free[name] - by for",
        tests=("tests/prove/test_points.py",),
    ),
    Mutant(PROVE + "ideals.py", "if len(polynomials) < 2:", "if len(polynomials) < 3:"),
    Mutant(
        PROVE + "ideals.py",
        "self.field.normal(self._on(branch, each)) for each",
        "self.field.normal(each) for each",
    ),
    Mutant(PROVE + "zero.py", "if not rest.contains(value)]", "if rest.contains(value)]"),
    Mutant(
        PROVE + "zero.py",
        "[ring.substitute(each, branch.solved) for each in (*elements, *named)]",
        "[*elements, *named]",
    ),
    Mutant(
        PROVE + "zero.py",
        "abs(value) <= ON_BRANCH * max(1, size)",
        "abs(value) >= ON_BRANCH * max(1, size)",
    ),
    Mutant(PROVE + "zero.py", "if not min(counts):", "if min(counts):"),
    # symmetries and Lax pairs
    Mutant(PROVE + "symmetries.py", "if rate == 0 and setting", "if rate != 0 and setting"),
    Mutant(PROVE + "symmetries.py", "lie_derivative(motion, X)", "lie_derivative(X, X)"),
    Mutant(
        PROVE + "symmetries.py",
        "structure.bracket(a, b) for a in",
        "structure.bracket(b, a) for a in",
    ),
    Mutant(PROVE + "symmetries.py", "sign = -1 if transformation", "sign = 1 if transformation"),
    Mutant(PROVE + "lax.py", "settled(left - equation.right)", "settled(left - left)"),
    Mutant(PROVE + "lax.py", "if own == together == before", "if own == before"),
    Mutant(PROVE + "lax.py", "[same.value - value]", "[value - value]"),
    Mutant(PROVE + "lax.py", "x * tensor[i][j] * y for", "x * tensor[i][i] * y for"),
    # momentum maps
    Mutant(POISSON + "momentum_maps.py", "[n] + moved)", "[n] - moved)"),
    Mutant(POISSON + "momentum_maps.py", "- moved[a][b] + moved", "+ moved[a][b] + moved"),
    Mutant(
        POISSON + "momentum_maps.py",
        "[a - b for a, b in zip(motion",
        "[a + b for a, b in zip(motion",
    ),
    Mutant(POISSON + "momentum_maps.py", "- self._along(i, j)", "+ self._along(i, j)"),
    Mutant(
        POISSON + "momentum_maps.py",
        "flip = self.sign if i < j else -self.sign",
        "flip = self.sign",
    ),
    Mutant(POISSON + "momentum_maps.py", "value if a < b else -value", "value"),
    Mutant(POISSON + "momentum_maps.py", "= -value * weight", "= value * weight"),
    Mutant(POISSON + "momentum_maps.py", "/ (_degree(field, term, names) + 1)", "/ 1"),
    # definitions
    Mutant(DEFINITIONS, "argument[1] + isinstance(part, Index)", "1"),
    Mutant(DEFINITIONS, "in taken or argument in arguments[:place]", "in taken or argument in []"),
    Mutant(DEFINITIONS, "return replace(node, name=whole.name)", "return whole"),
    Mutant(DEFINITIONS, "if len(given) != len(definition.arguments)", "if not given"),
    Mutant(
        DEFINITIONS,
        "expand(read_expression(expression, functions(known)), known,",
        "expand(read_expression(expression, functions(known)), {},",
    ),
    # Noether with moving time; zeros of solves
    Mutant(
        "src/coadjoint/derive/symmetries.py",
        "resting = equations.closed(_value(setting, symmetry, element))",
        "resting = values[len(generators)]",
        tests=("tests/prove/test_symmetries.py", "-k", "moving_time"),
    ),
    Mutant(
        "src/coadjoint/derive/symmetries.py",
        "X = X - motion.like(scale(equations.closed(energy), turned))",
        "X = X + motion.like(scale(equations.closed(energy), turned))",
        tests=("tests/prove/test_symmetries.py", "-k", "by_the_place"),
    ),
    Mutant(
        "src/coadjoint/derive/mechanics/decided.py",
        "        if closed is None or self.field.reach(closed) & self._first:\n",
        "        if closed is None:\n            return self.field.zero\n        if False:\n",
        tests=("tests/derive/test_decided.py",),
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
        TARGETS + "c/kernel.c.j2",
        "state[{{ row.index }} * state_stride + _n]",
        "state[{{ row.index }} * state_stride - _n]",
    ),
    Mutant(
        TARGETS + "c/kernel.c.j2",
        '"out[%d * out_stride + _n]" | format(row)',
        '"out[%d * out_stride + _n]" | format(function.outputs[-loop.index][0])',
    ),
    Mutant(
        TARGETS + "c/kernel.c.j2",
        '" * parameters_stride + _n") }}',
        '" * parameters_stride - _n") }}',
    ),
    Mutant(
        TARGETS + "c/kernel.c.j2",
        '{{ statement.value | c_assignment(to="const double " ~ '
        "statement.name, column=indent | length) }}\n{% endfor %}\n{% endif %}\n"
        "{{ indent }}/* results */",
        '{{ statement.value | c_assignment(to="const double " ~ statement.name ~ " = -", '
        "column=indent | length) }}\n{% endfor %}\n{% endif %}\n{{ indent }}/* results */",
    ),
    Mutant(
        TARGETS + "numpy/kernel.py.j2",
        '"out[%d]" | format(row)',
        '"out[%d]" | format(function.outputs[-loop.index][0])',
    ),
    Mutant(
        TARGETS + "numpy/kernel.py.j2",
        "numpy_assignment(to=statement.name, column=4) }}\n"
        "{% endfor %}\n{% endif %}\n    # results",
        "numpy_assignment(to=statement.name ~ ' = -', column=4) }}\n"
        "{% endfor %}\n{% endif %}\n    # results",
    ),
    Mutant(
        TARGETS + "python/kernel_python.py.j2",
        '"out[%d]" | format(row)',
        '"out[%d]" | format(function.outputs[-loop.index][0])',
    ),
    Mutant(TARGETS + "python/kernel_python.py.j2", "range(0, len(out), size)", "range(len(out))"),
    Mutant(
        PROVE + "reductions.py",
        "decide_zero(drifts, field, Ideal(field, functions, where, state))",
        "decide_zero([], field, Ideal(field, functions, where, state))",
    ),
    Mutant(PROVE + "reductions.py", "- rates[name]", "+ rates[name]"),
    Mutant(
        PROVE + "reductions.py",
        "restriction.setting.field.substitute(restriction(function), restriction.section)",
        "restriction.setting.field.zero",
    ),
)
