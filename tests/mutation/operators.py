"""Operators: every small change of a function, read off its syntax tree.

A sum is seen as terms with signs and a product as factors with exponents, so that an operator acts
upon "the term with this name" wherever it stands. Comes in: the tree of a function. Go out: edits,
each with the names it acts upon and the places around it. Read next: `tests.mutation.addresses`.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

#: Operators that are tried at every place of a core function; the others change what is named.
GENERATED = ("flip", "drop", "omit", "swap", "transpose")
#: Operations whose last two arguments are of one kind and do not commute.
ORDERED = frozenset(
    {"add_multiple", "bracket", "commutator", "cross", "diamond", "product", "subtract"}
)
Function = ast.FunctionDef | ast.Module
Signed = list[tuple[int, ast.expr]]
#: What has a body of its own, with edits of its own.
SCOPES = (ast.FunctionDef, ast.ClassDef)


@dataclass(frozen=True, eq=False)
class Edit:
    """One change of a tree.

    Attributes:
        operator: What is done.
        acts_on: The part it acts upon.
        old: The node that is replaced, which may be larger: the sum of a term.
        new: What takes its place.
        places: What the part stands in: targets of its statement, operations called around it.
    """

    operator: str
    acts_on: ast.AST
    old: ast.AST
    new: ast.AST
    places: frozenset[str]

    @property
    def words(self) -> frozenset[str]:
        """The names and numbers that the part mentions."""
        return names_in(self.acts_on)

    @property
    def place(self) -> tuple[str, int, int]:
        """What distinguishes it from all other edits of its tree."""
        return self.operator, id(self.acts_on), id(self.old)

    @property
    def label(self) -> str:
        """The edit for a reader."""
        return f"{self.operator} {ast.unparse(self.acts_on)}"


def names_in(tree: ast.AST) -> frozenset[str]:
    """Names, attributes, keywords and constants below a node."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            found.add(node.id)
        elif isinstance(node, ast.Attribute):
            found.add(node.attr)
        elif isinstance(node, (ast.keyword, ast.arg)) and node.arg:
            found.add(node.arg)
        elif isinstance(node, ast.Constant):
            found.add(str(node.value))
    return frozenset(found)


def terms_of(node: ast.expr) -> Signed:
    """A sum as terms with signs."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Add, ast.Sub)):
        return [*terms_of(node.left), (-1 if isinstance(node.op, ast.Sub) else 1, node.right)]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return [(-1, node.operand)]
    return [(1, node)]


def factors_of(node: ast.expr) -> tuple[int, Signed]:
    """A product as a sign, and factors with the exponent 1 or -1."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Mult, ast.Div)):
        sign, factors = factors_of(node.left)
        turned, right = (-1, node.right.operand) if _is_minus(node.right) else (1, node.right)
        return sign * turned, [*factors, (-1 if isinstance(node.op, ast.Div) else 1, right)]
    if _is_minus(node):
        sign, factors = factors_of(node.operand)
        return -sign, factors
    return 1, [(1, node)]


def _is_minus(node: ast.AST) -> bool:
    """Whether a minus sign stands before it."""
    return isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub)


def minus(node: ast.expr) -> ast.expr:
    """Minus an expression."""
    return node.operand if _is_minus(node) else ast.UnaryOp(ast.USub(), node)


def sum_of(terms: Signed) -> ast.expr:
    """The tree of a sum."""
    sign, total = terms[0]
    total = total if sign > 0 else minus(total)
    for sign, term in terms[1:]:
        total = ast.BinOp(total, ast.Add() if sign > 0 else ast.Sub(), term)
    return total


def product_of(sign: int, factors: Signed) -> ast.expr:
    """The tree of a product."""
    exponent, total = factors[0]
    total = total if exponent > 0 else ast.BinOp(ast.Constant(1), ast.Div(), total)
    for exponent, factor in factors[1:]:
        total = ast.BinOp(total, ast.Mult() if exponent > 0 else ast.Div(), factor)
    return total if sign > 0 else minus(total)


def edits(function: Function) -> Iterator[Edit]:
    """Every edit of a function; functions inside it have their own."""
    for node, above in walk(function):
        places = places_of((*above, node))
        for operator, acts_on, new in _changes(node, above[-1] if above else None):
            yield Edit(operator, acts_on, node, new, places)


def walk(
    function: ast.AST, above: tuple[ast.AST, ...] = ()
) -> Iterator[tuple[ast.AST, tuple[ast.AST, ...]]]:
    """The nodes of a function with what is above each, annotations and docstrings left out."""
    for name, value in ast.iter_fields(function):
        if name in ("annotation", "returns", "decorator_list", "type_comment"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if not isinstance(child, ast.AST) or isinstance(child, (ast.JoinedStr, *SCOPES)):
                continue
            if isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant):
                continue
            inner = (*above, function)
            yield child, inner
            yield from walk(child, inner)


def places_of(above: Sequence[ast.AST]) -> frozenset[str]:
    """Targets of the statement around a node, and the operations called around it."""
    found: set[str] = set()
    for node, inner in zip(above, [*above[1:], None], strict=True):
        if isinstance(node, ast.Call) and inner:
            found.add(head(node.func))
        elif isinstance(node, ast.Subscript) and inner is node.slice:
            found.add("[]")
        elif isinstance(node, (ast.Assign, ast.AugAssign, ast.AnnAssign)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            found.update(*map(names_in, targets))
        elif isinstance(node, (ast.Return, ast.Yield, ast.Raise)):
            found.add(type(node).__name__.lower())
    return frozenset(found)


def head(node: ast.AST) -> str:
    """The last name of what is called or indexed."""
    if isinstance(node, ast.Attribute):
        return node.attr
    if isinstance(node, (ast.Subscript, ast.Call)):
        return head(node.value if isinstance(node, ast.Subscript) else node.func)
    return node.id if isinstance(node, ast.Name) else ""


Changes = Iterator[tuple[str, ast.AST, ast.AST]]


def _changes(node: ast.AST, above: ast.AST | None) -> Changes:
    """What can be done at a node: the operator, what it acts upon, what takes the node's place."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Add, ast.Sub)):
        if not (isinstance(above, ast.BinOp) and _is_sum(above) and node is above.left):
            yield from _of_a_sum(node)
    elif isinstance(node, ast.expr) and _is_product(node):
        if not isinstance(above, ast.expr) or not (_is_product(above) and _continues(node, above)):
            yield from _of_a_product(node, above)
    elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
        yield "base", node, node.left
    elif isinstance(node, ast.arguments) and len(node.args) > 1:
        *others, a, b = node.args
        changed = copy.copy(node)
        changed.args = [*others, b, a]
        yield "turn", node, changed
    elif isinstance(node, ast.AugAssign) and isinstance(node.op, (ast.Add, ast.Sub)):
        other = ast.Sub() if isinstance(node.op, ast.Add) else ast.Add()
        yield "flip", node, ast.AugAssign(node.target, other, node.value)
    elif isinstance(node, ast.Call):
        yield from _of_a_call(node)
    elif isinstance(node, ast.Subscript):
        yield from _of_an_index(node)
    elif isinstance(node, ast.IfExp):
        yield "then", node, node.body
        yield "else", node, node.orelse
    elif isinstance(node, (ast.Tuple, ast.List)):
        yield "reverse", node, type(node)(node.elts[::-1], ast.Load())
        yield "rotate", node, type(node)([*node.elts[1:], *node.elts[:1]], ast.Load())
        for place, each in enumerate(node.elts):
            yield (
                "leave",
                each,
                type(node)([*node.elts[:place], *node.elts[place + 1 :]], ast.Load()),
            )
    elif isinstance(node, ast.Compare) and len(node.ops) == 1:
        for operator in (ast.Eq, ast.NotEq, ast.Lt, ast.LtE, ast.Gt, ast.GtE):
            yield f"compare-{operator.__name__}", node, _compared(node, operator())
    if isinstance(node, (ast.Assign, ast.AugAssign, ast.Expr, ast.Raise)):
        yield "skip", node, ast.Pass()
    if isinstance(node, ast.expr) and not isinstance(node, (ast.Slice, ast.Starred)):
        if _is_condition(node, above):
            yield "always", node, ast.Constant(True)
            yield "never", node, ast.Constant(False)
            yield "deny", node, ast.UnaryOp(ast.Not(), node)
        elif not isinstance(node, ast.BinOp):
            yield "negate", node, minus(node)


def _is_sum(node: ast.AST) -> bool:
    return isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Add, ast.Sub))


def _is_product(node: ast.AST) -> bool:
    quotient = isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Mult, ast.Div))
    return quotient or _is_minus(node)


def _continues(node: ast.AST, above: ast.AST) -> bool:
    """Whether a product is part of the one above it."""
    return not isinstance(above, ast.BinOp) or node is above.left or _is_minus(node)


def _is_condition(node: ast.AST, above: ast.AST | None) -> bool:
    if isinstance(above, (ast.If, ast.IfExp, ast.While)):
        return node is above.test
    return isinstance(above, ast.comprehension) and node in above.ifs


def _compared(node: ast.Compare, operator: ast.cmpop) -> ast.Compare:
    return ast.Compare(node.left, [operator], node.comparators)


def _of_a_sum(node: ast.BinOp) -> Changes:
    """Each term with the other sign, and left out."""
    terms = terms_of(node)
    for place, (sign, term) in enumerate(terms):
        before, after = terms[:place], terms[place + 1 :]
        yield "flip", term, sum_of([*before, (-sign, term), *after])
        yield "drop", term, sum_of([*before, *after])


def _of_a_product(node: ast.expr, above: ast.AST | None) -> Changes:
    """The product with the other sign, and each factor left out or on the other side."""
    sign, factors = factors_of(node)
    if not (above and (_is_sum(above) or isinstance(above, ast.AugAssign))):  # flipped there
        yield "flip", node, product_of(-sign, factors)
    for place, (exponent, factor) in enumerate(factors):
        before, after = factors[:place], factors[place + 1 :]
        one = isinstance(factor, ast.Constant) and factor.value == 1
        if (before or after) and not one:
            yield "omit", factor, product_of(sign, [*before, *after])
            yield "invert", factor, product_of(sign, [*before, (-exponent, factor), *after])


def _of_a_call(node: ast.Call) -> Changes:
    """Arguments in another order, and the call left out."""
    arguments = node.args

    def calling(*others: ast.expr) -> ast.Call:
        return ast.Call(node.func, list(others), node.keywords)

    if len(arguments) > 1:
        kind = "swap" if head(node.func) in ORDERED else "exchange"
        yield kind, node, calling(*arguments[:-2], arguments[-1], arguments[-2])
    if len(arguments) > 2:
        yield "mirror", node, calling(*arguments[::-1])
    if arguments:
        yield "unwrap", node, arguments[0]
    if isinstance(node.func, ast.Attribute):
        yield "bare", node, node.func.value


def _of_an_index(node: ast.Subscript) -> Changes:
    """``a[j][i]`` or ``a[j, i]`` for ``a[i][j]`` or ``a[i, j]``."""
    inner, index = node.value, node.slice
    if isinstance(inner, ast.Subscript) and not isinstance(index, ast.Slice):
        if not isinstance(inner.slice, ast.Slice) and ast.dump(inner.slice) != ast.dump(index):
            new = ast.Subscript(inner.value, index, ast.Load())
            yield "transpose", node, ast.Subscript(new, inner.slice, node.ctx)
    elif isinstance(index, ast.Tuple) and len(index.elts) == 2:
        turned = ast.Tuple(index.elts[::-1], ast.Load())
        yield "transpose", node, ast.Subscript(inner, turned, node.ctx)


#: Where numbers count places, and are no quantities.
COUNTING = frozenset(["[]", "range", "len", "enumerate", "islice", "combinations"])


def core(function: Function) -> Iterator[Edit]:
    """The edits of the quantities that a function computes: signs, terms, factors, arguments.

    Words for a reader are left out, and what only refuses: functions that return steps of a
    derivation, text or nothing, messages. So are zeros, which have no sign.
    """
    returned = ast.unparse(function.returns) if getattr(function, "returns", None) else ""
    if "Step" in returned or "str" in returned or returned == "None":
        return
    for each in edits(function):
        text = any(isinstance(node, ast.JoinedStr) for node in ast.walk(each.old))
        zero = each.operator in ("flip", "drop") and _is_zero(each.acts_on)
        counts = each.places & {*COUNTING, "raise"} or _counts(each.old)
        if each.operator in GENERATED and not (text or zero or counts):
            yield each


def _counts(node: ast.AST) -> bool:
    """Whether it is a place as ``n + 1`` or a length is."""
    return "len" in names_in(node) or (
        _is_sum(node)
        and any(
            isinstance(term, ast.Constant) and isinstance(term.value, int)
            for _, term in terms_of(node)
        )
    )


def _is_zero(node: ast.AST) -> bool:
    """Whether it is ``field.zero``, or what a table holds where it has no entry."""
    return head(node) == "zero" or (
        isinstance(node, ast.Call) and bool(node.args) and head(node.args[-1]) == "zero"
    )
