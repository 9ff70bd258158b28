r"""Names as a book writes them: ``Pi1`` is :math:`\Pi_1`, ``dPi1_dt`` is :math:`\dot\Pi_1`.

Comes in: a name of a spec or of a kernel. Goes out: a `Written`. Names of whole vectors are bold.
Intermediates of a kernel, which begin with an underscore, have a tilde, and Casimirs are
calligraphic: no name of a spec is printed as one of these.
Read next: `coadjoint.notation.trees`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from html import unescape
from typing import Final

from markupsafe import escape

from coadjoint.notation.functions import write_rate
from coadjoint.notation.written import (
    DOT_ABOVE,
    SUM,
    Written,
    add,
    attach,
    divide,
    literal,
    number,
    operator,
    row,
)

GREEK: Final = {
    name: (rf"\{name}", letter)
    for name, letter in (
        pair.split(":")
        for pair in [
            "alpha:α",
            "beta:β",
            "gamma:γ",
            "delta:δ",
            "epsilon:ε",
            "zeta:ζ",
            "eta:η",
            "theta:θ",
            "iota:ι",
            "kappa:κ",
            "lambda:λ",
            "mu:μ",
            "nu:ν",
            "xi:ξ",
            "pi:π",
            "rho:ρ",
            "sigma:σ",
            "tau:τ",
            "upsilon:υ",
            "phi:φ",
            "chi:χ",
            "psi:ψ",
            "omega:ω",
            "Gamma:Γ",
            "Delta:Δ",
            "Theta:Θ",
            "Lambda:Λ",
            "Xi:Ξ",
            "Pi:Π",
            "Sigma:Σ",
            "Upsilon:Υ",
            "Phi:Φ",
            "Psi:Ψ",
            "Omega:Ω",
            "hbar:ℏ",
        ]
    )
}
_SHORT: Final = {"eps": "epsilon", "lam": "lambda"}
#: Letters that no spec can name, as LaTeX, Unicode and Typst have them.
_OWN: Final = {"casimir": (r"\mathcal{C}", "\U0001d49e", "cal(C)")}
_RATE = re.compile(r"d(?P<of>.+)_dt")
#: A name and the numbers of a member, a row or a component behind it.
_PARTS = re.compile(r"(?P<base>.*?[A-Za-z])(?P<numbers>[0-9]+(?:_[0-9]+)*|(?:_[0-9]+)+)?")
#: A symbol with an index above and others below, as Christoffel's of the second kind.
_MIXED = re.compile(r"(?P<of>[A-Za-z]+)\^(?P<above>[0-9]+)_(?P<below>[0-9]+)")
_ALONG = re.compile(r"(?P<of>.+)_(?P<s>s+)")
_TYPST_GREEK: Final = {"phi": "phi.alt", "epsilon": "epsilon.alt", "hbar": "planck.reduce"}


@cache
def name(text: str, *, bold: bool = False, dot: bool = False) -> Written:
    r"""A name, with a dot if its rate is meant.

    >>> name("Pi1", dot=True).latex, name("Gamma", bold=True).latex
    ('\\dot{\\Pi}_1', '\\boldsymbol{\\Gamma}')
    >>> name("Gamma^1_11").latex
    '\\Gamma_{11}^{1}'
    >>> name("M_1_10").latex, name("rolling_reaction2").latex, name("M_vpsi").latex
    ('M_{1,10}', '\\lambda_{\\mathrm{rolling},2}', 'M_{v_{\\psi}}')
    >>> name("_k1").latex
    '\\tilde{k}_1'
    >>> name("phidot").latex, name("phidot", dot=True).latex, name("M_phidot1").latex
    ('\\dot{\\phi}', '\\ddot{\\phi}', 'M_{\\dot{\\phi},1}')
    """
    shown = f"d{text}/dt" if dot else text
    if text.startswith("_"):
        symbol, below = _split_name(text.removeprefix("_"), bold=bold)
        return _attach(_mark_intermediate(symbol), below, shown, dot=dot)
    rate = _RATE.fullmatch(text)
    if rate:
        return replace(name(rate["of"], bold=bold, dot=True), text=shown)
    mixed = _MIXED.fullmatch(text)
    if mixed:
        made = name(f"{mixed['of']}_{mixed['below']}", bold=bold)
        return replace(attach(made, above=number(int(mixed["above"]))), text=shown)
    along = _find_along(text)
    if along:
        of = name(along["of"], bold=bold)
        return replace(differentiate_along(of, len(along["s"])), text=shown)
    if text[:1] == "d" and _is_symbol(text[1:]) and not _is_symbol(text):
        return replace(differential(name(text[1:], bold=bold)), text=shown)
    symbol, below = _split_name(text, bold=bold)
    return _attach(symbol, below, shown, dot=dot)


def _attach(symbol: Written, below: Sequence[Written], text: str, *, dot: bool) -> Written:
    """A symbol with what stands below it, and its dot; the rate of a word has d/dt before it."""
    is_word = "mathvariant" in symbol.mathml
    made = attach(symbol, below=below, dot=dot and not is_word)
    return replace(write_rate(made) if dot and is_word else made, text=text)


def _mark_intermediate(symbol: Written) -> Written:
    """The letter or word of an intermediate: another quantity than that without the mark."""
    tilde = "tilde" if symbol.mathml.startswith("<mi>") else "widetilde"
    return literal(
        symbol.text,
        rf"\{tilde}{{{symbol.latex}}}",
        f'<mover accent="true">{symbol.mathml}<mo>~</mo></mover>',
        f"tilde({symbol.typst})",
    )


def differential(of: Written) -> Written:
    r"""The differential of a symbol.

    >>> differential(name("W1")).latex == name("dW1").latex == "dW_1"
    True
    """
    return literal(f"d{of.text}", f"d{of.latex}", row("<mi>d</mi>", of.mathml), f"d {of.typst}")


def spell(text: str) -> tuple[str, str]:
    """The letter or word of a name, and what stands below it, as plain text.

    >>> spell("normal_force")
    ('normal force', '')
    >>> spell("Pi1"), spell("Pi_spatial"), spell("M_1_10"), spell("casimir1")
    (('Π', '1'), ('Π', 'spatial'), ('M', '1,10'), ('𝒞', '1'))
    """
    symbol, below = _split_name(text.removeprefix("_"), bold=False)
    shown = [each.mathml.replace(DOT_ABOVE, "\u0307") for each in (symbol, *below)]
    plain = [unescape(re.sub("<[^>]+>", "", each)) for each in shown]
    return plain[0].replace("\xa0", " "), ",".join(plain[1:]).replace("\xa0", " ")


def member(of: str, place: str, *, dot: bool = False, bold: bool = False) -> Written:
    """What a member has: ``r2`` of the member ``i+1`` is a letter with the subscripts i+1 and 2."""
    index, shift = re.fullmatch(r"(\w*?)([+-]\d+)?", place).groups()  # type: ignore[union-attr]
    own = literal(index, mathml=f"<mn>{index}</mn>") if index.isdigit() else literal(index)
    if shift:
        own = add([own, number(int(shift))])
    shown = f"{of}[{place}]"
    along = _find_along(of)
    symbol, below = _split_name(along["of"] if along else of, bold=bold)
    made = _attach(symbol, [own, *below], f"d{shown}/dt" if dot else shown, dot=dot)
    return replace(differentiate_along(made, len(along["s"])), text=made.text) if along else made


def _split_name(text: str, *, bold: bool) -> tuple[Written, list[Written]]:
    """The letter or word of a name, and what stands below it."""
    parts = _PARTS.fullmatch(text)
    if parts is None:
        return _word(text, bold=bold), []
    below = [number(int(each)) for each in (parts["numbers"] or "").split("_") if each]
    constraint = parts["base"].removesuffix("_reaction")
    if constraint != parts["base"]:  # a multiplier
        return _letter("lambda", bold=bold) or _word(text, bold=bold), [
            _word(constraint, bold=False),
            *below,
        ]
    base, words = _split_word(parts["base"])
    inner = _PARTS.fullmatch(base)
    if words and inner is not None and inner["numbers"]:  # p1_pairs
        base = inner["base"]
        below = [*(number(int(each)) for each in inner["numbers"].split("_") if each), *below]
    symbol = _letter(base, bold=bold)
    if symbol is None:
        return _word(parts["base"], bold=bold), below
    if words:
        below = [*map(_write_below, words), *below]
    return symbol, below


def differentiate_along(of: Written, times: int = 1, by: str = "s") -> Written:
    """The derivative along space."""
    again = f"^{times}" if times > 1 else ""
    sign = operator("&#x2202;")
    below = f"<msub>{sign}<mi>{by}</mi></msub>"
    if times > 1:
        below = f"<msubsup>{sign}<mi>{by}</mi><mn>{times}</mn></msubsup>"
    return Written(
        text=f"d{again}_{by} {of.text}" if not times > 1 else f"d_{by}^{times} {of.text}",
        latex=rf"\partial_{by}{again} {of.latex}",
        mathml=row(below, of.mathml),
        typst=f"partial_{by}{again} {of.typst}",
        level=max(of.level - 1, SUM + 1),
    )


def _find_along(text: str) -> re.Match[str] | None:
    """The parts of a name that is a derivative along space: ``u_ss``, ``Xi1_s``."""
    found = _ALONG.fullmatch(text)
    return found if found and (found["of"][-1].isdigit() or _is_symbol(found["of"])) else None


def _is_symbol(text: str) -> bool:
    """Whether a name is one letter of some alphabet, with or without numbers."""
    return _letter(text.rstrip("0123456789_"), bold=False) is not None


def _split_word(base: str) -> tuple[str, list[str]]:
    """A letter and the words below it: ``p_phi``, ``Omega_momentum``, ``I_s``.

    Rates and momenta of angles, and what is along an axis, need no line between: ``vphi``,
    ``ptheta``, ``kx``.
    """
    head, _, rest = base.partition("_")
    below = [rest] if rest else []
    if (head[:1] in ("v", "p") and head[1:] in GREEK) or re.fullmatch("[A-Za-z][xyz]", head):
        return head[0], [head[1:], *below]
    plain = head.rstrip("0123456789")
    return (head, below) if rest and _letter(plain, bold=False) is not None else (base, [])


def _write_below(words: str) -> Written:
    """What a word below a letter is, which may be a velocity or momentum of an angle itself.

    Letters alone, as of a second derivative by x, stand next to each other.
    """
    if re.fullmatch("[A-Za-z](_[A-Za-z])+", words):
        letters = words.split("_")
        shown = row(*(f"<mi>{each}</mi>" for each in letters))
        return literal(words, "".join(letters), shown, " ".join(letters))
    base, own = _split_word(words)
    symbol = _letter(base, bold=False)
    if symbol is None:
        return _word(words, bold=False)
    return attach(symbol, below=list(map(_write_below, own)))


def _letter(base: str, *, bold: bool) -> Written | None:
    """A letter, Latin or Greek, which may have a dot, as ``phidot``; None for a word."""
    base = _SHORT.get(base, base)
    if base.endswith("dot"):
        of = _letter(base.removesuffix("dot"), bold=bold)
        return None if of is None else replace(attach(of, dot=True), text=base)
    typst = _TYPST_GREEK.get(base, base)
    if base in _OWN:
        latex, letter, typst = _OWN[base]
    elif base in GREEK:
        latex, letter = GREEK[base]
    elif len(base) == 1:
        latex = letter = base
    else:
        return None
    if not bold:
        return literal(base, latex, f"<mi>{letter}</mi>", typst)
    return literal(
        base,
        rf"\boldsymbol{{{latex}}}",
        f"<mi>{_bold(letter)}</mi>",
        f"bold({typst})",
    )


def _bold(letter: str) -> str:
    """A letter of the mathematical alphabet that is bold and italic, which needs no attribute."""
    starts = {"A": 0x1D468, "a": 0x1D482, "Α": 0x1D71C, "α": 0x1D736}
    for first, start in starts.items():
        last = {"A": "Z", "a": "z", "Α": "Ω", "α": "ω"}[first]
        if first <= letter <= last:
            # the capitals of the mathematical alphabet have a theta symbol where Greek has a gap
            return chr(start + ord(letter) - ord(first))
    return letter


def _word(base: str, *, bold: bool) -> Written:
    """A word, upright."""
    spaced = base.replace("_", " ").strip() or base
    latex = spaced.replace(" ", r"\ ")
    style = "mathbf" if bold else "mathrm"
    weight = "bold" if bold else "normal"
    return literal(
        base,
        rf"\{style}{{{latex}}}",
        # at a blank a line of a narrow column would end, and the rest of the word be lost
        f'<mi mathvariant="{weight}">{str(escape(spaced)).replace(" ", "&#xA0;")}</mi>',
        f'bold("{spaced}")' if bold else f'"{spaced}"',
    )


def partial(function: Written, by: Written) -> Written:
    """A partial derivative."""
    d = operator("&#x2202;")
    made = divide(
        Written(
            text="",
            latex=rf"\partial {function.latex}",
            mathml=row(d, function.mathml),
            typst=f"partial {function.typst}",
        ),
        Written(
            text="",
            latex=rf"\partial {by.latex}",
            mathml=row(d, by.mathml),
            typst=f"partial {by.typst}",
        ),
    )
    return replace(made, text=f"d{function.text}/d{by.text}")


def unit(text: str) -> Written:
    r"""A unit, upright, with its exponents raised.

    >>> unit("kg m^2/s").latex
    '\\mathrm{kg\\,m^{2}/s}'
    >>> unit("1/s^(1/2)").latex
    '\\mathrm{1/s^{1/2}}'
    """
    # the stroke of an exponent is another sign than that between units, until it is printed
    spaced = re.sub(r"\^\((-?\d+)/(\d+)\)", "^\\1\u2044\\2", text.replace("*", " "))
    raised = re.compile(r"\^(-?\d+(?:\u2044\d+)?)")
    latex = raised.sub(r"^{\1}", spaced).replace(" ", r"\,").replace("\u2044", "/")
    pieces = list[str]()
    for label, exponent, sign in re.findall(
        r"([^\s/^]+)(?:\^(-?\d+(?:\u2044\d+)?))?([\s/]*)", spaced
    ):
        shown = f'<mi mathvariant="normal">{escape(label)}</mi>'
        if exponent:
            minus = operator("−") if exponent.startswith("-") else ""
            size = exponent.removeprefix("-").replace("\u2044", "/")
            shown = f"<msup>{shown}{row(minus, f'<mn>{size}</mn>')}</msup>"
        pieces.append(shown)
        if sign:
            pieces.append(operator("/") if "/" in sign else '<mspace width="0.2em"/>')
    typst = re.sub(r"([A-Za-z]+)", r'"\1"', raised.sub(r"^(\1)", spaced).replace("\u2044", "/"))
    return literal(text, rf"\mathrm{{{latex}}}", row(*pieces) if pieces else "<mrow></mrow>", typst)
