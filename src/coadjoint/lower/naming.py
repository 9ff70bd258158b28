"""From a graph to statements: what is used more than once gets a name, the rest stays inline.

Comes in: a graph, named definitions and outputs. Goes out: a `Program`. Values that depend on
parameters alone become statements of their own, so that members which share their parameters
compute them once. Temporaries are numbered in the order of first use; nothing that no output needs
is kept.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from coadjoint.exact.factored import rows_of
from coadjoint.lower.graph import Graph
from coadjoint.lower.program import (
    OPERATIONS,
    Call,
    Factors,
    Item,
    Negate,
    Node,
    Number,
    Output,
    Program,
    Solution,
    Statement,
    Symbol,
)

#: Nodes of several numbers, which have a name of their own wherever they are used.
SEVERAL = ("factors", "solution")


class Naming:
    """One Program in the making.

    Args:
        graph: Where the values are.
        definitions: Spec names with their nodes, in an order in which they can be computed.
        outputs: Labels with their nodes.
        parameters: Names of the parameters.
    """

    def __init__(
        self,
        graph: Graph,
        definitions: Sequence[tuple[str, int]],
        outputs: Sequence[tuple[str, int]],
        parameters: Sequence[str],
    ) -> None:
        self.graph = graph
        self.definitions = dict(definitions)
        self.outputs = outputs
        self._fixed: dict[str, bool] = dict.fromkeys(parameters, True)
        for name, node in definitions:
            self._fixed[name] = self._is_fixed(node)
        self._uses = self._count_uses()
        self._names: dict[int, str] = {}
        self._counters: Counter[str] = Counter()
        self.statements: list[Statement] = []

    def program(self, name: str, shape: tuple[int, ...], **arrays: tuple[str, ...]) -> Program:
        """The finished Program; ``arrays`` are the names of its rows, as a Program has them."""
        for definition, node in self.definitions.items():
            if self._uses[self.graph.symbol(definition)]:
                self._define(definition, node)
        outputs = tuple(
            Output(label, self._inline(node, fixed=False)) for label, node in self.outputs
        )
        rows: dict[str, Any] = dict(arrays)
        order = sorted(self.statements, key=lambda statement: statement.level == "member")
        return Program(name=name, statements=tuple(order), outputs=outputs, shape=shape, **rows)

    # -- what depends on what -----------------------------------------------------------

    def _is_fixed(self, node: int) -> bool:
        """Whether a node depends on parameters alone; what a loop gives is of each member."""
        if self.graph.kinds[node] in SEVERAL:
            return False
        if self.graph.kinds[node] == "symbol":
            return self._fixed.get(str(self.graph.payload[node]), False)
        return all(map(self._is_fixed, self.graph.operands[node]))

    def _count_uses(self) -> Counter[int]:
        """How many operations and outputs read each node; a sign passes a use on."""
        uses: Counter[int] = Counter()
        seen: set[int] = set()
        pending = [node for _, node in self.outputs]
        while pending:
            node = self._strip_sign(pending.pop())
            uses[node] += 1
            if node in seen:
                continue
            seen.add(node)
            pending.extend(self.graph.operands[node])
            if self.graph.kinds[node] == "symbol":
                definition = self.definitions.get(str(self.graph.payload[node]))
                pending.extend([] if definition is None else [definition])
        return uses

    def _strip_sign(self, node: int) -> int:
        """The node below a sign."""
        negated = self.graph.kinds[node] == "negate"
        return self.graph.operands[node][0] if negated else node

    # -- statements ---------------------------------------------------------------------

    def _define(self, name: str, node: int) -> None:
        """State a definition, by whose name later operations read its value."""
        tree = Symbol(self._names[node]) if node in self._names else self._tree(node)
        self._state(name, tree, self._fixed[name])
        if self.graph.kinds[node] not in ("number", "symbol", "negate", "item"):
            self._names.setdefault(node, name)

    def _state(self, name: str, value: Node, fixed: bool) -> None:
        self.statements.append(Statement(name, value, "parameters" if fixed else "member"))

    def _inline(self, node: int, fixed: bool) -> Node:
        """A node as an operand: a leaf, a name, or a tree of its own.

        Args:
            node: The node.
            fixed: Whether the operation that reads it depends on parameters alone.
        """
        kind = self.graph.kinds[node]
        if kind in ("number", "symbol", "item"):
            return self._tree(node)
        if kind == "negate":
            return Negate(self._inline(self.graph.operands[node][0], fixed))
        if node in self._names:
            return Symbol(self._names[node])
        own, several = self._is_fixed(node), kind in SEVERAL
        if not several and ((self._uses[node] < 2 and own == fixed) or self._is_constant(node)):
            return self._tree(node)
        tree = self._tree(node)
        prefix = "_p" if own else "_t"
        self._counters[prefix] += 1
        self._names[node] = f"{prefix}{self._counters[prefix]}"
        self._state(self._names[node], tree, own)
        return Symbol(self._names[node])

    def _is_constant(self, node: int) -> bool:
        """Whether no name occurs in a node."""
        if self.graph.kinds[node] == "symbol":
            return False
        return all(map(self._is_constant, self.graph.operands[node]))

    def _tree(self, node: int) -> Node:
        """The operation of a node on its operands."""
        kind, payload = self.graph.kinds[node], self.graph.payload[node]
        if kind == "number":
            assert isinstance(payload, Fraction), payload
            return Number(payload)
        if kind == "symbol":
            return Symbol(str(payload))
        fixed = self._is_fixed(node)
        operands = [self._inline(operand, fixed) for operand in self.graph.operands[node]]
        match kind:
            case "call":
                return Call(str(payload), *operands)
            case "factors":
                return Factors(rows_of(len(operands)), tuple(operands))
            case "solution":
                return Solution(operands[0], tuple(operands[1:]))
            case "item":
                return Item(operands[0], int(payload))
        return OPERATIONS[kind](*operands)
