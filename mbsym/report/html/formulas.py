"""Formulas, vectors and matrices as HTML: MathML in lines that break between terms, long ones folded away."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from markupsafe import Markup, escape

from mbsym.formulas.formula import Column, Formula, Matrix
from mbsym.formulas.mathml import (
    TIMES,
    MathPrinter,
    mathml_pieces,
    mathml_symbol,
    mathml_text,
    mi,
    mn,
    mo,
    power,
    row,
    shape_of,
    sign,
    table,
)
from mbsym.formulas.tree import Factor, leaves

#: Formulas with more symbols than this are folded away behind their length.
FOLDED = 120
#: A vector or matrix is written as one as long as a line of it has at most so many symbols.
WIDEST = 36
#: A formula with more terms than this is counted only: nobody reads it, and a page has limits.
LONGEST = 6000
#: Conditions with more symbols than this are counted instead of written: results.json has them.
LONGEST_CONDITION = 450

RELATIONS = {"!=": "\u2260", ">=": "\u2265", "<=": "\u2264", "+-": "\u00b1", "-": "\u2212"}


#: Of longer formulas exports have what other programs read.
LONGEST_SPELLED = 1500


def spellings(value: Formula | Matrix, copyable: bool) -> str:
    """The attributes data-latex, data-wolfram and data-python, which an editor copies; a report goes without.

    Where a line says ``name = value`` it is the value that they spell.  "" also of what is too long.
    """
    if not copyable or value.terms > LONGEST_SPELLED:
        return ""
    wolfram = value.wolfram() if isinstance(value, Formula) else _nested(value)
    written = {"latex": value.latex(), "wolfram": wolfram, "python": str(value)}
    return "".join(f' data-{name}="{escape(text)}"' for name, text in written.items())


def _nested(value: Matrix) -> str:
    return "{" + ", ".join("{" + ", ".join(x.wolfram() for x in line) + "}" for line in value) + "}"


def math(*parts: str) -> Markup:
    """One formula in the text, of finished MathML."""
    return Markup(f"<math>{''.join(parts)}</math>")


def symbol(name: str, lower: str = "", upper: str = "", dots: str = "") -> Markup:
    """A letter of our own (omega, M) with indices below and above, ``dots`` over it."""
    plain = mathml_symbol(name)
    letter = plain.dotted(dots).stem if dots else plain.stem
    below, above = (f"<mrow>{_indices(text)}</mrow>" for text in (lower, upper))
    if lower and upper:
        return Markup(f"<msubsup>{letter}{below}{above}</msubsup>")
    if lower or upper:
        return Markup(f"<msub>{letter}{below}</msub>" if lower else f"<msup>{letter}{above}</msup>")
    return Markup(letter)


def _indices(text: str) -> str:
    """12, O1, ``1,12``, (1): letters, digits, commas, brackets."""
    return "".join(
        mn(piece)
        if piece.isdigit()
        else '<mo separator="true">,</mo>'
        if piece == ","
        else mi(piece)
        if piece.isalpha()
        else mo(piece)
        for piece in re.findall(r"\d+|[,()]|[A-Za-z]", text)
    )


def indexed(base: str, lower: object) -> Markup:
    """(finished MathML) with an index."""
    return Markup(f"<msub><mrow>{base}</mrow><mrow>{_indices(str(lower))}</mrow></msub>")


def _joined(*parts: str) -> str:
    """Finished pieces one after the other: markup plus text would escape the text."""
    return "".join(parts)


# --- lines ------------------------------------------------------------------------------------------------------------


def line(left: str, value: Formula, right: str, sign: str, size: str, spelled: bool = False) -> Markup:
    """``left = value right`` as a line of its own; folded away behind its ``size`` where it is long."""
    first, *rest = pieces(value)
    written = whole([_joined(left, mo(sign) if left else "", first), *rest], right, spellings(value, spelled))
    if extent(value) <= FOLDED:
        return written
    head = math(left, mo(sign), "<mo>\u2026</mo>") if left else ""
    return Markup(f"<details><summary>{head} <small>{escape(size)}</small></summary>{written}</details>")


def whole(pieces: Sequence[str], right: str = "", attributes: str = "") -> Markup:
    """Pieces as a line that may break between them."""
    ended = [*pieces[:-1], _joined(pieces[-1], right)]
    return Markup(f'<div class="formula"{attributes}>{" ".join(f"<math>{piece}</math>" for piece in ended)}</div>')


def text_line(*parts: str) -> Markup:
    return whole(["".join(parts)])


def zero(values: Column) -> bool:
    return all(x.is_zero for x in values)


# --- vectors and matrices ---------------------------------------------------------------------------------------------


def extent(value: Formula) -> int:
    """How many letters and numbers it has."""
    return leaves(shape_of(value.shown.ring, value.shown.polynomial))


def pieces(value: Formula) -> list[str]:
    """Finished MathML between which a line may end."""
    return mathml_pieces(value.ring, value.polynomial)


def inline(value: Formula, spelled: bool = False) -> Markup:
    """Finished MathML of a formula in one piece."""
    written, attributes = mathml_text(value.ring, value.polynomial), spellings(value, spelled)
    return Markup(f"<mrow{attributes}>{written}</mrow>" if attributes else written)


def components(values: Column, long: frozenset[int] = frozenset(), spelled: bool = False) -> Markup:
    """(a, b, c), or nothing if that would be too wide or holds one of the ``long`` formulas."""
    if any(id(x) in long or x.terms > 30 for x in values) or sum(map(extent, values)) > WIDEST:
        return Markup("")
    return Markup(row([inline(x, spelled) for x in values]))


def matrix(value: Matrix, long: frozenset[int] = frozenset(), spelled: bool = False) -> Markup:
    """A matrix in brackets, or nothing if that would be too wide or holds one of the ``long`` formulas."""
    if any(id(x) in long or x.terms > 60 for line in value for x in line):
        return Markup("")
    attributes = spellings(value, spelled)
    number, rest = value.number_and_rest
    if sum(max(map(extent, column)) for column in zip(*rest, strict=True)) > WIDEST:
        return Markup("")
    written = table([[mathml_text(x.ring, x.polynomial) for x in line] for line in rest])
    if number != 1:
        written = mn(number) + TIMES + written
    return Markup(f"<mrow{attributes}>{written}</mrow>" if attributes else written)


# --- polynomials ------------------------------------------------------------------------------------------------------


def polynomial_pieces(coefficients: Sequence[Formula], variable: str, length: Callable[[Formula], str]) -> list[str]:
    """sum of coefficient*variable^k, highest power first, in pieces, between which a line may break.

    Instead of a coefficient that nobody would read there is its ``length``.
    """
    all_pieces: list[str] = []
    for degree, coefficient in reversed(list(enumerate(coefficients))):
        if coefficient.is_zero:
            continue
        raised = "" if degree == 0 else mi(variable) if degree == 1 else power(mi(variable), mn(degree))
        coefficient = coefficient.shown
        shape = shape_of(coefficient.ring, coefficient.polynomial)
        if not is_readable(coefficient):
            pieces, negative = [length(coefficient)], False
        elif raised and len(shape.terms) > 1:
            pieces, negative = MathPrinter(coefficient.ring).factor_pieces(Factor(shape)), False
        else:
            negative = shape.terms[0].coefficient < 0
            pieces = mathml_pieces(coefficient.ring, coefficient.polynomial)
            if negative:
                pieces[0] = pieces[0].removeprefix(sign("\u2212"))
        if raised:
            pieces = [raised] if pieces == [mn(1)] else [*pieces[:-1], pieces[-1] + TIMES + raised]
        if all_pieces:
            shown = "\u2212" if negative else "+"
            pieces[0] = mo(shown, first=True) + pieces[0]
        elif negative:
            pieces[0] = sign("\u2212") + pieces[0]
        all_pieces += pieces
    return all_pieces or [mn(0)]


def is_readable(value: Formula) -> bool:
    """Whether anybody would read the polynomial."""
    return value.terms <= LONGEST and extent(value) < LONGEST_CONDITION
