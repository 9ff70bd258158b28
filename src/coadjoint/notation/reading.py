"""Formulas as code writes them, read: ``dot(a, b)/2 = h``, by a grammar of sums and products.

Comes in: the tokens of a text, some of which may be words. Goes out: the sides of a relation as far
as tokens read as one, or `NoFormulaError`. Read next: `coadjoint.notation.written`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Final

from coadjoint.notation.functions import CALLS, RELATIONS, write_rate, write_sum
from coadjoint.notation.names import differential, member, name, partial, spell
from coadjoint.notation.written import (
    ATOM,
    CROSS,
    DOT,
    Written,
    add,
    attach,
    between,
    call,
    divide,
    enclose,
    literal,
    matrix,
    multiply,
    negate,
    number,
    operator,
    power,
    row,
)

#: An initial of a name, behind no letter or sign of a formula: R. Montgomery. Where the letter is
#: that of something, a sentence ends behind it: at the rate W. Its centre.
_INITIAL: Final = (
    r"(?<![-+*/^(=])(?<![-+*/^=<>] )(?<!\b[A-Za-z] )[A-Z]\.(?= (?:[A-Z]\. |[A-Z][a-z]))"
)
_TOKEN: Final = re.compile(
    r"(?P<word>[A-Za-z]\w*(?:-[A-Za-z]\w*)+|\d+-[A-Za-z]\w*|[A-Za-z]+'s\b)"  # Lie-Poisson, 2-form
    rf"|(?P<initial>{_INITIAL})"
    r"|(?P<higher>d\^(?P<order>[2-9])(?P<what>[A-Za-z]\w*)/d(?P<along>[A-Za-z]\w*)\^(?P=order))"
    r"|(?P<rate>d(?P<times>[2-9]?)(?P<of>(?:[A-Za-z]\w*)?)/d(?P<by>[A-Za-z]\w*))"
    r"|(?P<name>_?[A-Za-z]\w*)|(?P<number>\d+(?:\.\d+)?(?:e(?P<ten>[-+]?\d{1,3})\b)?)"
    r"|(?P<sign>(?<= )\(s\)(?= )|->|<=|>=|~=|==|!=|<>|\*\*|[-+*/^=<>(){}\[\]|,.])|(?P<other>\S)",
    re.ASCII,
)
#: Signs between the sides of a relation, in LaTeX, MathML and Typst.
SIGNS: Final = {**RELATIONS, "->": (r"\to", "→", "->")}
#: Brackets, and other things in which formulas stand, that are read within each other, and digits
#: of a whole number. What has more is left as it is: a description is free text.
DEEPEST: Final = 24
DIGITS: Final = 100
#: Signs with blanks around them.
_BETWEEN: Final = {
    ".": DOT,
    "x": CROSS,
    "o": ("o", r"\circ", "∘", "compose"),  # of Stratonovich's integral
    "<>": ("<>", r"\diamond", "⋄", "diamond"),
    "(s)": ("(s)", r"\ltimes", "⋉", "⋉"),
}
#: What closes a bracket.
CLOSING: Final = {"(": ")", "[": "]", "{": "}", "<": ">", "|": "|"}
#: Words that act on the symbol behind them without brackets.
_ACTING: Final = ("tr", "det", "div", "grad", "curl")
#: Letters of the alphabet, or what looks like a symbol, that are words of a sentence.
_WORDS: Final = ("a", "de", "do", "by", "By", "my", "My")
_NUMBER: Final = re.compile(r"\d+([./]\d+)?", re.ASCII)


class NoFormulaError(Exception):
    """What stands here does not go on as a formula."""


class Reading:
    """One reading of one text, token by token.

    Attributes:
        at: The token that is read next.
        deep: How many things are being read within each other.
    """

    def __init__(self, text: str, names: Mapping[str, Written]) -> None:
        self.text, self.names, self.at, self.deep = text, names, 0, 0
        self.tokens = list(self._read_tokens())

    def _read_tokens(self) -> Iterator[re.Match[str]]:
        """The tokens, in which no letter that is a name is an initial."""
        at = 0
        while found := _TOKEN.search(self.text, at):
            if found["initial"] and found[0][:-1] in self.names:
                letter = _TOKEN.match(self.text, found.start(), found.start() + 1)
                assert letter is not None, found
                found = letter
            yield found
            at = found.end()

    def _peek(self, ahead: int = 0) -> str:
        """A token that is to come, empty behind the last one."""
        at = self.at + ahead
        return self.tokens[at][0] if at < len(self.tokens) else ""

    def _is_spaced(self, ahead: int = 0) -> bool:
        """Whether a blank, or the end, stands before a token that is to come."""
        at = self.at + ahead
        if not 0 < at < len(self.tokens):
            return True
        return self.tokens[at].start() > self.tokens[at - 1].end()

    def _try(self, read: Callable[[], Written]) -> Written | None:
        """What is read, or None with nothing taken."""
        start = self.at
        try:
            return read()
        except NoFormulaError:
            self.at = start
            return None

    def sides(self) -> list[tuple[str, Written]]:
        """The sides of a relation, each with the sign before it; the first may have one too."""
        sides = list[tuple[str, Written]]()
        is_word = re.fullmatch("[a-z]{3,}", self._peek()) and not is_symbol(self._peek())
        if is_word and self._peek(1) in ("<=", ">="):
            raise NoFormulaError  # of degree <= 2
        if self._peek() not in ("=", "<=", ">="):
            sides.append(("", self._sum()))
        while self._peek() in SIGNS:
            start, sign = self.at, self._peek()
            self.at += 1
            side = self._try(self._sum)
            if side is None:
                self.at = start
                break
            sides.append((sign, side))
        return sides

    def _sum(self) -> Written:
        """Addends; a sign without blanks goes before a number alone, as in ``i-1``."""
        parts = [self._signed()]
        while self._peek() in ("+", "-"):
            start, minus = self.at, self._peek() == "-"
            loose = self._is_spaced() and self._is_spaced(1)
            if not loose and (self._is_spaced() or not self._peek(1).isdigit()):
                break
            self.at += 1
            part = self._try(self._signed)
            if part is None:
                self.at = start
                break
            parts.append(negate(part) if minus else part)
        return add(parts) if len(parts) > 1 else parts[0]

    def _signed(self) -> Written:
        """A product with the sign before it."""
        if self._peek() == "-" and not self._is_spaced(1):
            self.at += 1
            return negate(self._product())
        return self._product()

    def _product(self) -> Written:
        """Factors, with a sign between them or none."""
        made = self._power()
        while True:
            start, sign = self.at, self._peek()
            loose = self._is_spaced() and self._is_spaced(1) and self._peek(1) != ""
            if sign in ("*", "/") or (sign in _BETWEEN and loose):
                self.at += 1
            elif (self._is_spaced() or self._is_counted()) and self._stands_beside():
                sign = " "
            else:
                return made
            if sign in ("x", "o") and (_is_word(self._peek()) or _is_word(self._peek(-2))):
                self.at = start  # oscillators x and z
                return made
            factor = self._try(self._power)
            if factor is None:
                self.at = start
                return made
            made = _multiply(made, sign, factor)

    def _is_counted(self) -> bool:
        """Whether a number stands right before the next token, in brackets: ``sp(2n)``."""
        return self.deep > 0 and self.tokens[self.at - 1][0].isdigit()

    def _stands_beside(self) -> bool:
        """Whether the last token and the next are factors without a sign: ``2 K``, ``B^T M``."""
        if not 0 < self.at < len(self.tokens):
            return False
        before, token = self.tokens[self.at - 1], self.tokens[self.at]
        own = bool(token["rate"]) or token[0] == "["
        own = own or token[0] in _ACTING or token[0].startswith("sum_") or bool(token["higher"])
        own = own or bool(token["name"] and is_symbol(token[0]))
        closed = before[0] in (")", "]", "}", ">", "*")
        return own and (
            closed
            or bool(before["number"] or before["rate"])
            or bool(before["name"] and is_symbol(before[0]))
        )

    def _power(self) -> Written:
        """A factor with what stands above it."""
        base = self._atom()
        while True:
            if self._peek() in ("^", "**") and not self._is_spaced():
                self.at += 1
                base = self._raise(base)
            elif self._peek() == "*" and not self._is_spaced() and self._is_spaced(1):
                self.at += 1
                base = CALLS["conjugate"](base)
            else:
                return base

    def _raise(self, base: Written) -> Written:
        """The exponent behind its sign."""
        if self._peek() in ("*", "T"):
            self.at += 1
            return CALLS["conjugate" if self.tokens[self.at - 1][0] == "*" else "transpose"](base)
        if self._peek() == "-":
            self.at += 1
            return power(base, negate(self._atom()))
        ahead = [each[0] for each in self.tokens[self.at : self.at + 4]]
        if len(ahead) == 4 and (*ahead[:2], ahead[3]) == ("(", "-", ")"):  # needs no brackets there
            self.at += 2
            exponent = negate(self._atom())
            self.at += 1
            return power(base, exponent)
        return power(base, self._atom())

    def _atom(self) -> Written:
        """A number, a name, a function of arguments, a bracket."""
        if self.at >= len(self.tokens) or self.deep == DEEPEST:
            raise NoFormulaError
        self.deep += 1
        try:
            return self._plain_atom()
        finally:
            self.deep -= 1

    def _plain_atom(self) -> Written:
        token = self.tokens[self.at]
        self.at += 1
        if token["ten"]:
            mantissa, _, _ = token[0].partition("e")
            tens = power(number(10), number(int(token["ten"])))
            whole = literal(mantissa, mathml=f"<mn>{mantissa}</mn>")
            return tens if mantissa == "1" else between(whole, CROSS, tens)
        if token["number"]:
            if token[0].isdigit() and len(token[0]) < DIGITS:
                return number(int(token[0]))
            return literal(token[0], mathml=f"<mn>{token[0]}</mn>")
        if token["rate"]:
            return self._differentiate(token)
        if token["higher"]:
            return self._repeat("d", token["order"], token["what"], token["along"])
        if token["name"]:
            return self._named(token[0])
        if token[0] in CLOSING and not self._is_spaced():
            return self._enclosed(token[0])
        raise NoFormulaError

    def _named(self, text: str) -> Written:
        """A name, with its arguments, its places, or what it acts on."""
        if not self._is_spaced() and self._peek() == "(":
            self.at += 1
            if text == "rows" and (made := self._try(self._matrix)) is not None:
                return made
            inside = self._list(")")
            if text.endswith("_"):  # T_(m+n)
                own = self._symbol(text[:-1])
                return attach(replace(own, latex=f"{{{own.latex}}}"), below=inside)
            if text == "d" and self._peek() == "/" and self._peek(1) == "dt":
                self.at += 2
                return write_rate(*inside)
            return _apply(text, inside)
        if not self._is_spaced() and self._peek() == "[":
            self.at += 1
            return self._place(text)
        if text in _ACTING and self._is_spaced():
            of = self._power()
            return multiply([literal(text, rf"\operatorname{{{text}}}", "", f'op("{text}")'), of])
        if text.startswith("sum_") and self._is_spaced():
            return write_sum((text.removeprefix("sum_"),), [self._power()], "")
        return self._symbol(text)

    def _matrix(self) -> Written:
        """Vectors with commas between them, up to a bracket, as the rows of a matrix."""
        rows = list[list[Written]]()
        while True:
            if (self._peek(), self._peek(1)) != ("vector", "("):
                raise NoFormulaError
            self.at += 2
            rows.append(self._list(")"))
            self.at += 1
            if self.tokens[self.at - 1][0] == ")":
                return matrix(rows)

    def _place(self, text: str) -> Written:
        """A name with its places below, or with a commutator behind a line: ``J_[a, b]``."""
        places = self._list("]")
        if text.endswith("_"):
            own = self._symbol(text[:-1])
            own = replace(own, latex=f"{{{own.latex}}}")  # which may have something below itself
            return attach(own, below=[enclose(places)])
        place = places[0].text.replace(" ", "")
        if len(places) == 1 and re.fullmatch(r"\w+([+-]\d+)?", place):
            return member(text, place)
        return attach(enclose([self._symbol(text)], "()"), below=places)

    def _symbol(self, text: str) -> Written:
        """A name by itself; ``dmu`` is a d and a symbol."""
        if text in self.names:
            return self.names[text]
        if re.fullmatch(r"d\w+_dt", text):
            return name(text)
        if text[0] == "d" and text[1:] and is_symbol(text[1:]) and not _is_letter(text):
            return replace(differential(self._symbol(text[1:])), text=text)
        return name(text)

    def _differentiate(self, token: re.Match[str]) -> Written:
        """``dW/dt`` has a dot, ``dl/dxi`` is partial; ``d/dt`` acts on what stands behind it."""
        times, of, by = token["times"], token["of"], token["by"]
        if times:
            return self._repeat("∂", times, of, by.removesuffix(times))
        if of and by == "t":
            made = attach(self._symbol(of), dot=True) if of in self.names else name(of, dot=True)
            if self._peek() == "|" and not self._is_spaced() and self._peek(1).isalpha():
                self.at += 2  # dh/dt|explicit
                made = attach(enclose([made], "()"), below=[name(self.tokens[self.at - 1][0])])
            return made
        if of and by not in ("t", "s"):
            placed = self._peek() == "[" and not self._is_spaced()
            self.at += placed
            below = self._place(by) if placed else self._symbol(by)
            return partial(self._symbol(of), below)
        made = divide(
            self._symbol(f"d{of}") if of else literal("d"),
            literal(f"d{by}", f"d{name(by).latex}", row("<mi>d</mi>", name(by).mathml), f"d {by}"),
        )
        if of or not self._is_spaced():
            return made
        behind = self._try(self._power)
        return made if behind is None else multiply([made, behind])

    def _repeat(self, sign: str, times: str, of: str, by: str) -> Written:
        """A derivative of higher order, with the sign of it: that of one variable has a d."""
        top, bottom = self._symbol(of), self._symbol(by)
        latex, typst = (r"\partial", "partial") if sign == "∂" else ("d", "d")
        letter = operator(sign) if sign == "∂" else "<mi>d</mi>"
        raised = f"<msup>{letter}<mn>{times}</mn></msup>"
        below = f"<msup>{bottom.mathml}<mn>{times}</mn></msup>"
        return divide(
            literal(
                "",
                f"{latex}^{{{times}}} {top.latex}",
                row(raised, top.mathml),
                f"{typst}^{times} {top.typst}",
            ),
            literal(
                "",
                f"{latex} {{{bottom.latex}}}^{{{times}}}",
                row(letter, below),
                f"{typst} {bottom.typst}^{times}",
            ),
        )

    def _enclosed(self, opening: str) -> Written:
        """What stands in brackets."""
        parts = self._list(CLOSING[opening])
        if opening == "(" and len(parts) == 1:
            return parts[0] if parts[0].level < ATOM else enclose(parts, "()")
        return enclose(parts, opening + CLOSING[opening])

    def _list(self, closing: str) -> list[Written]:
        """Formulas with commas between them, up to a bracket."""
        parts = [self._sum()]
        while self._peek() == ",":
            self.at += 1
            parts.append(self._sum())
        if self._peek() != closing:
            raise NoFormulaError
        self.at += 1
        return parts


def is_symbol(text: str) -> bool:
    """Whether a name is a letter of some alphabet, with or without what stands below it."""
    return text not in _WORDS and (_is_letter(text) or (text[0] == "d" and _is_letter(text[1:])))


def _is_word(text: str) -> bool:
    """Whether a name can be nothing but a word of a sentence."""
    return bool(re.fullmatch("[a-z]{2,}", text)) and text not in _ACTING and not is_symbol(text)


def _is_letter(text: str) -> bool:
    return bool(text) and len(spell(text)[0]) == 1


def _apply(function: str, arguments: list[Written]) -> Written:
    """A function of arguments, as a book writes those that it has a sign for."""
    counts = {"dot": 2, "cross": 2, "outer": 2, "commutator": 2, "pow": 2}
    if function in CALLS and (function == "vector" or counts.get(function, 1) == len(arguments)):
        return CALLS[function](*arguments)
    if is_symbol(function):
        of = name(function)
        inside = enclose(arguments, "()")
        return literal(
            "", of.latex + inside.latex, row(of.mathml, inside.mathml), of.typst + inside.typst
        )
    return call(function, arguments)


def _multiply(left: Written, sign: str, right: Written) -> Written:
    """Two factors with a sign between them, which may be a blank."""
    if sign in _BETWEEN:
        return between(left, _BETWEEN[sign], right)
    if sign == "*" and _NUMBER.match(right.text) and _NUMBER.fullmatch(left.text):
        return between(left, CROSS, right)  # two numbers side by side would be one
    if sign != "/":
        return multiply([left, right])
    first, *others = left.factors or (left,)
    if others and first.text.partition("/")[2].isdigit():  # 1/2*m^2/r: the number stays before it
        return replace(multiply([first, divide(multiply(others), right)]), sign=left.sign)
    return divide(left, right)
