"""Coefficients: structure constants and matrix entries, numbers or polynomials of parameters.

Comes in: texts such as ``-2*e1 + a*e3/2`` of a bracket and ``a^2/2`` of a matrix. Goes out: exact
coefficients: fractions, and where a parameter occurs elements of the field of all parameters, which
decide the Jacobi identity for every value of them at once. SymPy is loaded then and not before.
Read next: `coadjoint.spec.sections.algebras`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property, partial, reduce
from itertools import product
from typing import TYPE_CHECKING, Any, Protocol

from coadjoint.elementary import ELEMENTARY, Arithmetic
from coadjoint.limits import PARAMETRIC_TERMS
from coadjoint.spec.core.components import Shape, unpack
from coadjoint.spec.core.expressions import read_expression
from coadjoint.spec.core.faults import ExpressionError, fault_at
from coadjoint.spec.core.formulas import ROLES, HasComponents
from coadjoint.spec.core.positions import KeyPath
from coadjoint.spec.core.shapes import shape_of
from coadjoint.spec.core.sizes import check_size
from coadjoint.spec.core.source import Source
from coadjoint.spec.core.tree import (
    Binary,
    Call,
    Component,
    Entry,
    Index,
    Member,
    Name,
    Negate,
    Node,
    Number,
    Power,
    Sum,
    fold,
    walk,
)

if TYPE_CHECKING:
    from coadjoint.exact import Field
    from coadjoint.exact.numbers import Numbers, Written

#: A fraction, or an element of the field of the parameters.
Coefficient = Any
_Linear = dict[int | None, Coefficient]  # of each basis vector; None for the part without one

#: Functions that take numbers.
KNOWN = {*ELEMENTARY, "tan", "pow"}
_COMBINATION = (
    "a linear combination of the basis",
    ("sums of basis names times numbers or polynomials of parameters, such as -2*e1 + e3/2, or 0"),
)
_POLYNOMIAL = "a polynomial of parameters", "numbers and parameters with + - * and powers"


class Constant(HasComponents, Protocol):
    """A parameter, as far as coefficients know it."""

    @property
    def positive(self) -> bool:
        """Whether every component is positive."""

    @property
    def form(self) -> str:
        """The matrix that its components fill, or ""."""


class Scalars:
    """The components of the parameters, as exact values from the first use on.

    Args:
        parameters: All of the spec, with names that differ.
        driving: Inputs and time, which no constant may name.
        texts: Finds all texts that may hold numbers such as ``sqrt(3)`` and pi: one field has all.
    """

    def __init__(
        self,
        parameters: Sequence[Constant] = (),
        driving: Sequence[HasComponents] = (),
        texts: Callable[[], Iterable[str]] = tuple,
    ) -> None:
        self._texts = texts
        self._driving = {
            name: each.role for each in driving for name in (each.name, *each.components)
        }
        self.shapes: dict[str, Shape] = {}
        self._components: dict[tuple[str, tuple[int, ...]], tuple[str, int]] = {}  # with signs
        self._positive: list[str] = []
        self._terms = 0  # in the coefficients read so far
        for parameter in parameters:
            self.shapes |= {parameter.name: parameter.value_shape}
            for name in parameter.components:
                self.shapes[name] = ()
                self._components[name, ()] = name, 1
            for indices, entry in _entries(parameter).items():
                self._components[parameter.name, indices] = entry
            self._positive += parameter.components if parameter.positive else ()

    def value(self, name: str, indices: tuple[int, ...] = ()) -> Coefficient | None:
        """The parameter of a name, as ``I1`` or ``I[1]``; None for other names."""
        component, sign = self._components.get((name, indices), ("", 0))
        if not sign:  # no scalar, or an entry on the diagonal of an antisymmetric matrix
            return Fraction(0) if component else None
        return sign * self._field[component]

    def constant(self, node: Call) -> Coefficient:
        """The number that a function of numbers is.

        Raises:
            ExpressionError: It is not real, or neither algebraic nor a rational multiple of pi.
        """
        from coadjoint.exact.numbers import PI, NumberError

        try:
            number, turns = self._numbers.index(self._places[node])
        except NumberError as error:
            raise ExpressionError(
                str(error),
                node.start,
                node.end,
                expected="a real algebraic number or a rational multiple of pi",
                hint=f'Name a parameter here, with the default "{error.number}": laws are '
                "proved for all values.",
            ) from None
        except OverflowError as error:
            problem = f"all numbers together are in a field of degree {error}"
            hint = "Name a parameter for one of them."
            raise ExpressionError(
                problem, node.start, node.end, str(error), hint=hint, limit="ALGEBRAIC_DEGREE"
            ) from None
        field = self._field
        return simplify(field.ground(number) + turns * field[PI])

    @cached_property
    def _calls(self) -> dict[Call, Written]:
        """Functions of numbers in the texts, as they are written first."""
        from coadjoint.exact.numbers import Written

        result: dict[Call, Written] = {}
        for text in self._texts():
            try:
                tree = read_expression(text)
            except ExpressionError:
                continue  # refused where it is read
            for node in walk(tree):
                if isinstance(node, Call) and is_constant_call(node):
                    start = node.start
                    while text.count("(", start, node.end) < text.count(")", start, node.end):
                        start = text.rindex("(", 0, start)  # of a base in parentheses
                    shown = text[start : node.end]
                    result.setdefault(node, Written(shown, partial(_evaluate, node)))
        return result

    @cached_property
    def _places(self) -> dict[Call, int]:
        return {node: place for place, node in enumerate(self._calls)}

    @cached_property
    def _numbers(self) -> Numbers:
        from coadjoint.exact.numbers import Numbers

        return Numbers(self._calls.values())

    def check_names(self, tree: Node) -> None:
        """Refuse inputs and the time, which are not constants.

        Raises:
            ExpressionError: An input or the time is named.
        """
        for node in walk(tree):
            if isinstance(node, Name | Index) and node.name in self._driving:
                problem = f"{node.name!r} is {ROLES[self._driving[node.name]]}"
                expected = "constants of the algebra in terms of numbers and parameters"
                hint = "Put a parameter in its place."
                raise fault_at(node, problem, node.name, expected, hint)

    def check_terms(self, tree: Node, terms: int) -> None:
        """Count the terms of a coefficient with parameters: elimination among many does not end.

        Raises:
            ExpressionError: There are too many in the spec.
        """
        if not any(isinstance(n, (Name, Index)) and n.name in self.shapes for n in walk(tree)):
            return
        self._terms += terms
        if self._terms > PARAMETRIC_TERMS:
            problem = (
                f"with this one, coefficients have {self._terms} terms that contain parameters"
            )
            hint = "Replace some of the parameters by numbers."
            raise ExpressionError(
                problem, tree.start, tree.end, str(self._terms), hint=hint, limit="PARAMETRIC_TERMS"
            )

    @cached_property
    def _field(self) -> Field:
        from coadjoint.exact import Field  # loads SymPy, which specs with plain numbers never need

        names = [name for name, indices in self._components if not indices]
        if not self._calls:
            return Field(names, positive=self._positive)
        from coadjoint.exact.numbers import PI

        return Field([*names, PI], positive=self._positive, numbers=self._numbers)


def is_constant_call(node: Node) -> bool:
    """Whether a node is an elementary function of numbers alone."""
    if not isinstance(node, Call):
        return False
    return all(
        not isinstance(part, Name | Index | Member | Entry | Component | Sum)
        and (not isinstance(part, Call) or part.function in KNOWN)
        for part in walk(node)
    )


def _evaluate(node: Node, own: Arithmetic) -> Any:
    """The value of a constant in any arithmetic."""

    def value(part: Node, below: list[Any]) -> Any:
        match part:
            case Number(value=number):
                return own.number(number)
            case Negate():
                return own.negate(below[0])
            case Call(function="tan"):
                return own.divide(own.call("sin", *below), own.call("cos", *below))
            case Call(function="pow"):
                base, exponent = below
                return own.call("exp", own.multiply(exponent, own.call("log", base)))
            case Call(function=function):
                return own.call(function, *below)
            case Power(exponent=exponent):
                result = reduce(own.multiply, below * abs(exponent), own.number(Fraction(1)))
                return result if exponent > 0 else own.divide(own.number(Fraction(1)), result)
            case Binary(operator="*"):
                return own.multiply(*below)
            case Binary(operator="/"):
                return own.divide(*below)
            case Binary(operator=sign):
                return own.add(below[0], below[1] if sign == "+" else own.negate(below[1]))
        raise AssertionError(part)

    return fold(node, value)


def _entries(parameter: Constant) -> dict[tuple[int, ...], tuple[str, int]]:
    """The component, and its sign, that each entry of a parameter is."""
    names, shape = parameter.components, parameter.value_shape
    places = list(product(*(range(1, length + 1) for length in shape)))
    kept: Sequence[int] = range(1, len(names) + 1)
    if parameter.form:
        kept = [entry for row in unpack(kept, parameter.form) for entry in row]
    return {
        place: (names[abs(n) - 1], (n > 0) - (n < 0)) for place, n in zip(places, kept, strict=True)
    }


def read_combination(
    source: Source, key: KeyPath, text: str, basis: Sequence[str], scalars: Scalars
) -> dict[int, Coefficient]:
    """A linear combination of basis names, such as ``-2*e1 + a*e3/2``, by place in the basis.

    Raises:
        SpecError: A syntax error, an unknown name, or no linear combination.
    """
    try:
        total = _Reading(basis, scalars, _COMBINATION).read(text)
    except ExpressionError as error:
        raise source.expression_fault(key, error) from None
    return {place: value for place, value in total.items() if place is not None}


def read_coefficient(
    source: Source, key: KeyPath, entry: Fraction | str, scalars: Scalars
) -> Coefficient:
    """A number as it is, or the value of a text such as ``a^2/2``.

    Raises:
        SpecError: A syntax error, an unknown name, or no polynomial of the parameters.
    """
    if isinstance(entry, Fraction):
        return entry
    try:
        return _Reading((), scalars, _POLYNOMIAL).read(entry).get(None, Fraction(0))
    except ExpressionError as error:
        raise source.expression_fault(key, error) from None


class _Reading:
    """The reading of one text as a combination of basis vectors, or as a coefficient."""

    def __init__(self, basis: Sequence[str], scalars: Scalars, wanted: tuple[str, str]) -> None:
        self._text = ""
        self.places = {name: place for place, name in enumerate(basis)}
        self.scalars, self.wanted = scalars, wanted

    def read(self, text: str) -> _Linear:
        """The coefficients of the vectors, or of 1 where the basis is empty."""
        tree, self._text = read_expression(text), text
        self.scalars.check_names(tree)
        scope: Mapping[str, Shape] = {**self.scalars.shapes, **dict.fromkeys(self.places, ())}
        shape_of(tree, scope)
        self.scalars.check_terms(tree, check_size(tree, scope))
        total = fold(tree, self._value)
        if self.places and None in total:
            raise self._refusal(tree)
        return total

    def _value(self, node: Node, below: list[_Linear]) -> _Linear:
        """The coefficients of a node that are not 0, by those of its children."""
        value = {place: simplify(each) for place, each in self._sum(node, below).items()}
        return {place: each for place, each in value.items() if each != 0}

    def _sum(self, node: Node, below: list[_Linear]) -> _Linear:
        match node:
            case Number(value=value):
                return {None: value}
            case Name(name=name) if name in self.places:
                return {self.places[self._single(node, name)]: Fraction(1)}
            case Name(name=name):
                return self._scalar(node, name)
            case Index(name=name, indices=indices):
                return self._scalar(node, name, indices)
            case Call() if is_constant_call(node):
                return {None: self.scalars.constant(node)}
            case Negate():
                return _multiply(below[0], Fraction(-1))
            case Power(exponent=exponent) if exponent >= 0:
                self._check_constant(node, below[0])
                return {None: below[0].get(None, Fraction(0)) ** exponent}
            case Binary(operator=operator):
                return self._join(node, operator, *below)
        raise self._refusal(node)

    def _single(self, node: Node, name: str) -> str:
        """The name of a basis vector that is not also that of a parameter."""
        if name in self.scalars.shapes:
            problem = f"{name!r} is both a parameter and in the basis"
            hint = "Rename the parameter."
            raise ExpressionError(problem, node.start, node.end, name, "names that differ", hint)
        return name

    def _scalar(self, node: Node, name: str, indices: tuple[int, ...] = ()) -> _Linear:
        value = self.scalars.value(name, indices)
        if value is None:
            raise self._refusal(node)
        return {None: value}

    def _join(self, node: Node, operator: str, a: _Linear, b: _Linear) -> _Linear:
        if operator in "+-":
            sign = 1 if operator == "+" else -1
            return {p: a.get(p, Fraction(0)) + sign * b.get(p, Fraction(0)) for p in a | b}
        if operator == "*" and not b.keys() <= {None}:
            a, b = b, a
        self._check_constant(node, b)
        factor = b.get(None, Fraction(0))
        if operator == "*":
            return _multiply(a, factor)
        if not is_known_number(factor) or factor == 0:
            raise self._refusal(node)  # a quotient of parameters, which may be 0
        return _multiply(a, 1 / factor)

    def _check_constant(self, node: Node, value: _Linear) -> None:
        if not value.keys() <= {None}:
            raise self._refusal(node)

    def _refusal(self, node: Node) -> ExpressionError:
        what, expected = self.wanted
        return ExpressionError(f"this is not {what}", node.start, node.end, expected=expected)


def is_known_number(value: Coefficient) -> bool:
    """Whether a coefficient is a number, which holds no parameter."""
    if isinstance(value, Fraction):
        return True
    from coadjoint.exact.numbers import is_number

    return is_number(value)


def simplify(value: Coefficient) -> Coefficient:
    """A coefficient, as a fraction where it is one."""
    if isinstance(value, Fraction):
        return value
    from coadjoint.exact.numbers import as_rational

    known = as_rational(value)
    return value if known is None else known


def _multiply(a: _Linear, factor: Coefficient) -> _Linear:
    return {place: value * factor for place, value in a.items()}
