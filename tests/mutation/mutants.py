"""Single changes that must not survive: a sign or an index flipped in the engine.

Each names a file, a piece of text that occurs exactly once in it, and what takes its place. A
piece that is no longer there fails the campaign, so the list cannot rot.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Mutant:
    """One change.

    Attributes:
        file: Path below the root of the repository.
        old: What is there, once.
        new: What takes its place.
        equivalent: Why no check can see it, if so; else empty.
    """

    file: str
    old: str
    new: str
    equivalent: str = ""

    @property
    def name(self) -> str:
        """Short name for reports."""
        return f"{self.file.rsplit('/', 1)[-1]}: {self.old.strip()} -> {self.new.strip()}"


ALGEBRA = "src/coadjoint/algebra/"
FAMILIES = ALGEBRA + "families.py"
DERIVE = "src/coadjoint/derive/"
LOWER = "src/coadjoint/lower/"
RENDER = "src/coadjoint/render/"

MUTANTS = (
    # structure constants
    Mutant(FAMILIES, "return {(k, j): 1, (j, k): -1}", "return {(k, j): -1, (j, k): 1}"),
    Mutant(FAMILIES, "return {(k, j): 1, (j, k): -1}", "return {(k, j): 1, (j, k): 1}"),
    Mutant(FAMILIES, "unit(i, column)) for i", "unit(i, column, -1)) for i"),
    Mutant(FAMILIES, "= (axis + 1) % 3, (axis + 2) % 3", "= (axis + 2) % 3, (axis + 1) % 3"),
    Mutant(FAMILIES, "{(i, j): 1, (j, i): -1 if", "{(i, j): 1, (j, i): 1 if"),
    Mutant(FAMILIES, '[("J", {(0, 1): -1, (1, 0): 1})]', '[("J", {(0, 1): 1, (1, 0): -1})]'),
    Mutant(FAMILIES, '("E", unit(3, 4))', '("E", unit(3, 4, -1))'),
    Mutant(FAMILIES, "{(i, 3): 1, (4, i): 1}", "{(i, 3): 1, (4, i): -1}"),
    Mutant(FAMILIES, "(n + j, n + i): -1}", "(n + j, n + i): 1}"),
    Mutant(FAMILIES, "{(0, 1): -half, (1, 0): half}, {})", "{(0, 1): half, (1, 0): -half}, {})"),
    Mutant(FAMILIES, "i: Matrix = {(0, 1): -1, (1, 0): 1}", "i: Matrix = {(0, 1): 1, (1, 0): -1}"),
    Mutant(ALGEBRA + "invariants.py", "yield j, i, k, -c", "yield j, i, k, c"),
    Mutant(
        ALGEBRA + "matrices.py",
        "add_multiple(result, -1, product(b, a))",
        "add_multiple(result, 1, product(b, a))",
    ),
    Mutant(
        ALGEBRA + "matrices.py",
        "product(a, b)\n    add_multiple(result, -1, product(b, a))",
        "product(b, a)\n    add_multiple(result, -1, product(a, b))",
    ),
    Mutant(ALGEBRA + "lie_algebra.py", "if i < j else ((j, i), -1)", "if i < j else ((j, i), 1)"),
    Mutant(ALGEBRA + "lie_algebra.py", "term = (b, a, c, n), -inner", "term = (b, a, c, n), inner"),
    # ad*, brackets, tensors
    Mutant(
        ALGEBRA + "lie_algebra.py",
        "result[j] + scaled(xi[i] * mu[k], c)",
        "result[j] - scaled(xi[i] * mu[k], c)",
    ),
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
    Mutant(
        DERIVE + "euler_poincare.py",
        "[sign * m for m in momentum]",
        "[-sign * m for m in momentum]",
    ),
    Mutant(DERIVE + "euler_poincare.py", "[-sign * x for x in", "[sign * x for x in"),
    Mutant(DERIVE + "euler_poincare.py", "[m + t for", "[m - t for"),
    Mutant(DERIVE + "lie_poisson.py", "sum(entry * named[x]", "sum(-entry * named[x]"),
    Mutant(
        DERIVE + "lie_poisson.py",
        "tensor = poisson_tensor(setting)",
        "tensor = tuple(zip(*poisson_tensor(setting), strict=True))",
    ),
    Mutant(DERIVE + "structure.py", "setting.sign * tensor[i][j]", "-setting.sign * tensor[i][j]"),
    Mutant(
        DERIVE + "structure.py",
        "variable.representation.dual())",
        "variable.representation)",
        equivalent="rotations act on vectors and covectors alike; the tests of the coadjoint "
        "representation see it",
    ),
    Mutant(
        DERIVE + "setting.py",
        'return 1 if self.spec.invariance == "left" else -1',
        'return -1 if self.spec.invariance == "left" else 1',
    ),
    Mutant(DERIVE + "setting.py", 'return 1 if self.spec.invariance == "left" else -1', "return 1"),
    Mutant(DERIVE + "legendre.py", "field[mu] - field.substitute", "field[mu] + field.substitute"),
    Mutant(
        DERIVE + "legendre.py",
        "for mu, xi in pairs), -lagrangian)",
        "for mu, xi in pairs), lagrangian)",
    ),
    Mutant(DERIVE + "interpret.py", "(-1) ** (i + j) * determinant", "determinant"),
    Mutant(DERIVE + "interpret.py", "(-1) ** j * x * determinant", "x * determinant"),
    Mutant(DERIVE + "interpret.py", "_scale(-field.one,", "_scale(field.one,"),
    Mutant(DERIVE + "interpret.py", "    return a - b\n", "    return a + b\n"),
    # exact calculus
    Mutant(
        "src/coadjoint/exact/element.py",
        "numer * slope * -exponent",
        "numer * slope * exponent",
    ),
    Mutant(
        "src/coadjoint/exact/field.py",
        "return -inner * self[known.partner]",
        "return inner * self[known.partner]",
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
        '"out[%d * out_stride + _n]" | format(loop.index0)',
        '"out[%d * out_stride + _n]" | format(loop.revindex0)',
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
        '"out[%d]" | format(loop.index0)',
        '"out[%d]" | format(loop.revindex0)',
    ),
    Mutant(
        "templates/numpy/kernel.py.j2",
        "python_assignment(to=statement.name, column=4) }}\n"
        "{% endfor %}\n{% endif %}\n    # results",
        "python_assignment(to=statement.name ~ ' = -', column=4) }}\n"
        "{% endfor %}\n{% endif %}\n    # results",
    ),
)
