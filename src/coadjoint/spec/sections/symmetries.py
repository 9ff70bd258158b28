"""Symmetries: declared actions, maps that keep the motion, and brackets that are claimed.

Comes in: the tables [symmetries], [transformations] and [claims.brackets]. Goes out: records of
`coadjoint.spec.model`, whose formulas have been found to fit the variables that they move and to be
linear in the element of the algebra. Whether what they say is true is proved later.
Read next: `coadjoint.derive.symmetries`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations

from coadjoint.algebra.lie_algebra import LieAlgebra
from coadjoint.algebra.matrices import size
from coadjoint.errors import CoadjointError
from coadjoint.spec.core.coefficients import Scalars
from coadjoint.spec.core.faults import ExpressionError, did_you_mean, fault_at, listed
from coadjoint.spec.core.formulas import DRIVING, Quantity, make_scope, read_formula
from coadjoint.spec.core.names import NAME
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.shapes import words
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.tree import (
    Binary,
    Call,
    Index,
    Name,
    Negate,
    Node,
    Number,
    Power,
    children,
    walk_up,
)
from coadjoint.spec.model import (
    ClaimedBracket,
    Formula,
    Observable,
    Section,
    Shape,
    Symmetry,
    Transformation,
    Variable,
    matrix_size,
)
from coadjoint.spec.schema import ClaimPart, SymmetryPart, TransformationPart
from coadjoint.spec.sections.algebras import read_algebra

#: Functions that are linear in each argument, so that degrees add up.
_MULTILINEAR = ("dot", "cross", "outer", "commutator")
#: Functions that are linear in all arguments together.
_LINEAR = ("trace", "transpose", "hat", "diag", "rows", "vector")


def emitted_shapes(entries: Iterable[Observable | Symmetry | Section]) -> dict[str, Shape]:
    """Shapes of the energy, of observables and momentum maps, and of their components."""
    named: dict[str, Shape] = {"energy": ()}
    for entry in entries:
        shape = entry.value_shape if isinstance(entry, Symmetry) else entry.shape
        named |= {**dict.fromkeys(entry.components, ()), entry.name: shape}
    return named


class SymmetryReader:
    """The reading of what a spec says about symmetries.

    Args:
        source: The text of the spec.
        state: The variables that make the state.
        quantities: Variables, parameters and definitions.
        observables: What claims may use beside the energy.
    """

    def __init__(
        self,
        source: Source,
        state: Sequence[Variable],
        quantities: Sequence[Quantity],
        observables: Sequence[Observable],
    ) -> None:
        self.source, self.quantities = source, quantities
        self.named = emitted_shapes(observables)
        self.state = {variable.name: variable for variable in state}
        self.roles = tuple(dict.fromkeys(variable.role for variable in state))

    # -- [symmetries] -------------------------------------------------------------------

    def symmetries(
        self, parts: Mapping[str, SymmetryPart], system: str, scalars: Scalars
    ) -> tuple[Symmetry, ...]:
        """The declared actions, in order.

        Raises:
            SpecError: A formula does not fit, or is not linear in the element.
            AlgebraError: The algebra is none.
        """
        found = []
        for name, part in parts.items():
            key: KeyPath = ("symmetries", name)
            inner = (*key, "algebra")
            algebra = read_algebra(self.source, part.algebra, system, scalars, inner)
            found.append(self._symmetry(name, part, key, algebra))
        self.named |= emitted_shapes(found)
        return tuple(found)

    def _symmetry(
        self, name: str, part: SymmetryPart, key: KeyPath, algebra: LieAlgebra
    ) -> Symmetry:
        form = part.form or ""
        if form and matrix_size(algebra.dimension, form) is None:
            raise self.source.fault(
                (*key, "form"),
                f"{algebra.dimension} components fill no matrix of the form {form!r}",
                found=algebra.dimension,
                expected="as many entries as the algebra has dimensions",
                hint="Remove form.",
            )
        element = part.vector or part.matrix or ""
        shapes = self._element(part, key, algebra) if element else {}
        if part.linear is not None:
            self._check_linear(key, part.linear, algebra)
        generators = {
            variable: self._moves(key, variable, text, shapes)
            for variable, text in (part.generators or {}).items()
        }
        scalar = {
            table: self._scalar((*key, table), getattr(part, table), shapes)
            for table in ("time", "map")
            if getattr(part, table) is not None
        }
        return Symmetry(
            name,
            algebra,
            element,
            part.matrix is not None,
            generators,
            tuple(part.linear or ()),
            scalar.get("time"),
            scalar.get("map"),
            part.side,
            form,
            part.unit,
            part.doc,
        )

    def _element(self, part: SymmetryPart, key: KeyPath, algebra: LieAlgebra) -> dict[str, Shape]:
        """The name of the generic element and those of its blocks, with their shapes."""
        way = "vector" if part.vector is not None else "matrix"
        name = getattr(part, way)
        taken = {x for q in self.quantities for x in (q.name, *getattr(q, "components", ()))}
        names = {name, *(f"{name}_{block}" for block in algebra.blocks)}
        if not NAME.fullmatch(name) or names & (taken | self.named.keys()):
            raise self.source.fault(
                (*key, way),
                f"{name!a} cannot name an element of {algebra.name}",
                found=name,
                expected="a name that nothing else has, such as 'xi'",
            )
        if way == "vector":
            parts = {f"{name}_{block}": len(run) for block, run in algebra.blocks.items()}
            counts = {name: algebra.dimension, **parts}
            return {each: (count,) if count > 1 else () for each, count in counts.items()}
        self._check_matrices((*key, way), algebra)
        return {name: (size(algebra.matrices),) * 2}

    def _check_matrices(self, key: KeyPath, algebra: LieAlgebra) -> None:
        if not algebra.matrices:
            raise self.source.fault(
                key,
                f"{algebra.name} has no matrices",
                found=algebra.name,
                expected="an algebra that is declared by matrices, or by name",
                hint="Write vector in the place of matrix.",
            )

    def _check_linear(self, key: KeyPath, names: Sequence[str], algebra: LieAlgebra) -> None:
        """The matrices fit the stacked components."""
        for place, name in enumerate(names):
            self._variable((*key, "linear", place), name)
        self._check_matrices((*key, "linear"), algebra)
        count = sum(len(self.state[name].components) for name in names)
        rows = size(algebra.matrices)
        if count != rows:
            raise self.source.fault(
                (*key, "linear"),
                f"{listed(names)} have {count} components, and the matrices of {algebra.name} "
                f"have {rows} rows",
                found=count,
                expected=f"variables with {rows} components together",
            )

    def _variable(self, key: KeyPath, name: str) -> Variable:
        if name not in self.state:
            raise self.source.fault(
                key,
                f"{name!a} is no variable of the state",
                found=name,
                expected=f"one of {listed(self.state)}",
                hint=did_you_mean(name, self.state),
            )
        return self.state[name]

    def _moves(self, key: KeyPath, name: str, text: str, shapes: Mapping[str, Shape]) -> Formula:
        """How a variable moves under the element."""
        key = (*key, "generators", name)
        formula = self._fitting(key, name, text, "a generator", shapes)
        return self._linear(key, formula, shapes)

    def _fitting(
        self, key: KeyPath, name: str, text: str, kind: str, others: Mapping[str, Shape]
    ) -> Formula:
        """A formula of the shape of a variable of the state."""
        shape = self._variable(key, name).value_shape
        scope = make_scope(kind, self.roles, self.quantities, others, driven=("time",))
        formula = read_formula(self.source, key, text, scope, any_shape=True)
        if formula.shape != shape:
            raise self._misfit(key, formula, f"{words(shape)}, as {name} is")
        return formula

    def _misfit(self, key: KeyPath, formula: Formula, expected: str) -> CoadjointError:
        found = words(formula.shape)
        return self.source.fault(key, f"the value is {found}", found=found, expected=expected)

    def _scalar(self, key: KeyPath, text: str, shapes: Mapping[str, Shape]) -> Formula:
        kind = f"a {key[-1]} of a symmetry"
        scope = make_scope(kind, self.roles, self.quantities, shapes, driven=("time",))
        return self._linear(key, read_formula(self.source, key, text, scope), shapes)

    def _linear(self, key: KeyPath, formula: Formula, names: Iterable[str]) -> Formula:
        """The formula, if it is linear in the element."""
        element, *_ = names
        try:
            degree = degree_in(formula.tree, tuple(names))
            if degree not in (1, None):
                raise ExpressionError(
                    f"the value is of degree {degree} in {element!r}",
                    0,
                    len(formula.text),
                    found=element,
                    expected=f"a formula that is linear in {element}",
                )
        except ExpressionError as error:
            raise self.source.expression_fault(key, error) from None
        return formula

    # -- [transformations] --------------------------------------------------------------

    def transformations(
        self, parts: Mapping[str, TransformationPart]
    ) -> tuple[Transformation, ...]:
        """The declared maps, in order; to be read after the symmetries.

        Raises:
            SpecError: A formula does not fit what it stands for.
        """
        return tuple(
            Transformation(
                name,
                {
                    variable: self._fitting(
                        ("transformations", name, "map", variable), variable, text, "a map", {}
                    )
                    for variable, text in part.map.items()
                },
                part.reverses_time,
                {
                    observable: self._exchange(
                        ("transformations", name, "exchanges", observable), observable, each.claim
                    )
                    for observable, each in part.exchanges.items()
                },
            )
            for name, part in parts.items()
        )

    def _exchange(self, key: KeyPath, name: str, text: str) -> Formula:
        if name not in self.named:
            raise self.source.fault(
                key,
                f"{name!a} is no observable and no momentum map",
                found=name,
                expected=f"one of {listed(self.named)}",
                hint=did_you_mean(name, self.named),
                at=self.source.positions.key(key),
            )
        key = self.source.claim_key(key)
        formula = self._any_shape(key, text, "an observable")
        if formula.shape != self.named[name]:
            raise self._misfit(key, formula, f"{words(self.named[name])}, as {name} is")
        return formula

    def _any_shape(self, key: KeyPath, text: str, kind: str) -> Formula:
        scope = make_scope(kind, self.roles, self.quantities, self.named, driven=DRIVING)
        return read_formula(self.source, key, text, scope, any_shape=True)

    # -- [claims.brackets] --------------------------------------------------------------

    def brackets(self, parts: Mapping[str, ClaimPart]) -> tuple[ClaimedBracket, ...]:
        """The claimed brackets, in order; to be read after the symmetries.

        Raises:
            SpecError: A key is no bracket, or the value does not have its shape.
        """
        return tuple(self._bracket(text, part.claim) for text, part in parts.items())

    def _bracket(self, text: str, value: str) -> ClaimedBracket:
        key: KeyPath = ("claims", "brackets", text)
        left, right = (self._side(key, text, side) for side in self._sides(key, text))
        key = self.source.claim_key(key)
        formula = self._any_shape(key, value, "a bracket")
        shape = left.shape + right.shape
        if formula.shape != shape:
            raise self._misfit(key, formula, f"{words(shape)}, as {text} is")
        return ClaimedBracket(left, right, formula)

    def _sides(self, key: KeyPath, text: str) -> tuple[str, str]:
        """The two expressions of a key ``{f, g}``: it is cut at the comma outside parentheses."""
        inner = text.strip()
        if inner.startswith("{") and inner.endswith("}"):
            inner, depth = inner[1:-1], 0
            for place, letter in enumerate(inner):
                depth += (letter in "([") - (letter in ")]")
                if letter == "," and depth == 0:
                    return inner[:place].strip(), inner[place + 1 :].strip()
        raise self.source.fault(
            key,
            f"{text!a} is no bracket",
            found=text,
            expected="a key such as '{L, A}'",
            at=self.source.positions.key(key),
        )

    def _side(self, key: KeyPath, text: str, side: str) -> Formula:
        """One side of a bracket; faults point at the key, in which it stands."""
        at = self.source.positions.key(key)
        try:
            formula = self._any_shape(key, side, "a side of a bracket")
        except CoadjointError as error:
            problem = str(error).splitlines()[0].partition(f"{text}: ")[2] or str(error)
            raise self.source.fault(
                key, f"{side!a}: {problem}".rstrip("."), found=error.parts.get("found"), at=at
            ) from None
        if len(formula.shape) > 1:
            raise self.source.fault(
                key,
                f"{side!a} is {words(formula.shape)}",
                found=side,
                expected="scalars and vectors in a bracket",
                hint="Take a row or a component of it, as A[1] or A[1, 2].",
                at=at,
            )
        return formula


def degree_in(tree: Node, names: Sequence[str]) -> int | None:
    """The degree of an expression in some names, if all its terms have the same; None of 0.

    Raises:
        ExpressionError: They do not, or a name stands in a divisor or a function.

    >>> from coadjoint.spec.core.expressions import read_expression
    >>> degree_in(read_expression("cross(xi, r) + 2*xi"), ["xi"])
    1
    >>> degree_in(read_expression("vector(0, xi)"), ["xi"])
    1
    """
    degrees: dict[int, int | None] = {}
    for node in walk_up(tree):
        below = [degrees[id(child)] for child in children(node)]
        degrees[id(node)] = _degree(node, below, names)
    return degrees[id(tree)]


def _degree(node: Node, below: Sequence[int | None], names: Sequence[str]) -> int | None:
    """The degree of a node by the degrees of its parts."""
    known = [degree for degree in below if degree is not None]
    match node:
        case Number(value=value):
            return 0 if value else None
        case Name(name=found) | Index(name=found):
            return int(found in names)
        case Binary(operator="*"):
            return sum(known) if len(known) == len(below) else None
        case Call(function=function) if function in _MULTILINEAR:
            return sum(known) if len(known) == len(below) else None
        case Power(exponent=exponent) if exponent > 0:
            return known[0] * exponent if known else None
    same = all(a == b for a, b in combinations(known, 2))
    plain = isinstance(node, (Negate, Binary)) or getattr(node, "function", "") in _LINEAR
    divided = isinstance(node, Binary) and node.operator == "/"
    if divided and not below[1]:
        return below[0]
    if any(known) and (not same or divided or (isinstance(node, (Power, Call)) and not plain)):
        raise fault_at(
            node,
            f"this is not linear in {names[0]!r}",
            found=names[0],
            expected=f"sums of terms that are linear in {names[0]}",
        )
    return known[0] if known else None if plain else 0
