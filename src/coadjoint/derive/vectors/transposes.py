r"""Transposes and traces of matrices as trees, for gradients of formulas by matrices.

Below :math:`\mathrm{tr}(AB)` stand :math:`B^T` at A and :math:`A^T` at B. Comes in: trees. Goes
out: trees. Read next: `coadjoint.derive.vectors.gradients`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from coadjoint.spec.core import tree
from coadjoint.spec.core.components import Shape


def is_symmetric(node: tree.Node) -> bool:
    """Whether a matrix is diagonal, made of diagonal ones."""
    match node:
        case tree.Call(function="diag"):
            return True
        case tree.Call(function="inverse", arguments=(a,)) | tree.Power(base=a):
            return is_symmetric(a)
        case tree.Binary(left=a, right=b):
            return all(is_symmetric(x) or isinstance(x, tree.Number) for x in (a, b))
    return False


def turn(node: tree.Node) -> tree.Node:
    """The transpose of a matrix."""
    match node:
        case tree.Call(function="transpose", arguments=(a,)):
            return a
        case tree.Call(function="outer", arguments=(a, b)):
            return tree.Call(function="outer", arguments=(b, a))
    return node if is_symmetric(node) else tree.Call(function="transpose", arguments=(node,))


def multiply(*matrices: tree.Node) -> tree.Node:
    """A product of matrices, or of a matrix and a vector behind it."""
    whole = matrices[0]
    for each in matrices[1:]:
        whole = tree.Binary(operator="*", left=whole, right=each)
    return whole


def list_factors(node: tree.Node, known: Mapping[int, Shape]) -> list[tree.Node]:
    """The factors of a product of matrices, a power being as many of them."""
    match node:
        case tree.Binary(operator="*", left=a, right=b) if known[id(a)] and known[id(b)]:
            return [*list_factors(a, known), *list_factors(b, known)]
        case tree.Power(base=base, exponent=n) if n > 0 and known[id(base)]:
            return list_factors(base, known) * n
        case tree.Call(function="transpose", arguments=(tree.Binary(operator="*") as a,)):
            return [turn(each) for each in reversed(list_factors(a, known))]
    return [node]


def turn_products(node: tree.Node, known: Mapping[int, Shape]) -> tree.Node:
    """A formula in which no product of matrices stands below a transpose."""
    match node:
        case tree.Call(
            function="transpose", arguments=(tree.Binary(operator="*", left=a, right=b) as product,)
        ) if known[id(a)] and known[id(b)]:
            factors = (turn_products(each, known) for each in list_factors(product, known))
            return multiply(*(turn(each) for each in reversed(list(factors))))
    below = tree.children(node)
    return tree.rebuild(node, [turn_products(each, known) for each in below]) if below else node


def pull_trace(
    node: tree.Node, known: Mapping[int, Shape]
) -> Iterator[tuple[tree.Node, tree.Node]]:
    """Each factor of a product of matrices, with what stands at it below the product's trace."""
    factors = list_factors(node, known)
    for n, factor in enumerate(factors):
        others = [*factors[n + 1 :], *factors[:n]]
        if others:
            yield factor, multiply(*(turn(each) for each in reversed(others)))


def drop_transposes(node: tree.Node, symmetric: Collection[str]) -> tree.Node:
    """A tree in which matrices that are symmetric by their names stand without a transpose."""
    below = [drop_transposes(each, symmetric) for each in tree.children(node)]
    match node:
        case tree.Call(function="transpose", arguments=(tree.Name(name=name),)):
            if name in symmetric:
                return below[0]
    return tree.rebuild(node, below)
