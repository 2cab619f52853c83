r"""From what the templates write to what stands in anyone's document: no macro, nothing wider than a narrow column.

The templates write ``\longformula[label]{...}``.  ``report.tex`` defines it; in an appendix and in fragments, which
define nothing, it is written out here: a paragraph of inline mathematics with a number, which TeX breaks at the places
that the formula allows, however wide the column is.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

_OPENING = r"{\par\raggedright\binoppenalty=10000 \relpenalty=10000 \lineskiplimit=1pt \lineskip=2pt"
_NUMBER = (
    r"\nobreak\hfill\penalty50\hskip1em\hbox{}\nobreak\hfill\hbox{(\theequation)}"
    r"\parfillskip=0pt\par}"
)

#: Words in a formula that are longer than this may be broken: they stand outside of it.
_SHORT_WORDS = 12


def written_out(text: str) -> str:
    r"""The text with every ``\longformula`` as plain LaTeX; its other mathematics may be broken after commas."""
    pieces = []
    last = 0
    for start, label, formula, end in long_formulas(text):
        pieces += [_loosened(text[last:start]), display(formula, label)]
        last = end
    return "".join([*pieces, _loosened(text[last:])])


def display(formula: str, label: str = "") -> str:
    """One numbered formula as a paragraph."""
    named = f"\\label{{{label}}}" if label else ""
    return (
        f"{_OPENING}\n\\hangindent=2em \\hangafter=1 \\noindent\\refstepcounter{{equation}}{named}%\n"
        f"$\\displaystyle {_words_outside(loosened(formula))}$%\n{_NUMBER}"
    )


def long_formulas(text: str) -> Iterator[tuple[int, str, str, int]]:
    """(start, label, formula, end) of each."""
    place = 0
    while (start := text.find("\\longformula", place)) >= 0:
        place = start + len("\\longformula")
        label = ""
        if text[place] == "[":
            closing = text.index("]", place)
            label, place = text[place + 1 : closing], closing + 1
        end = closing_brace(text, place)
        yield start, label, text[place + 1 : end], end + 1
        place = end + 1


def closing_brace(text: str, start: int) -> int:
    """Where the brace that opens at ``start`` closes.  Raises ValueError where it does not."""
    depth, place = 0, start
    while place < len(text):
        match text[place]:
            case "\\":
                place += 1
            case "{":
                depth += 1
            case "}":
                depth -= 1
                if depth == 0:
                    return place
        place += 1
    raise ValueError("a brace is never closed")


#: Where a narrow column may break a formula if nothing better is left: at signs in short brackets, between factors.
_PLACES = re.compile(r"\\[{}]|[{}]|(?<=[^ ]) (?=[+-] )|(?<=[^ ]) (?=\\(?:sin|cos|exp|ln)\b|\\[bB]igl|\()")
_PENALTY = re.compile(r"\\penalty[0-9]+ ?\Z")
_AT_SIGNS, _BETWEEN_FACTORS = 5000, 9000


def loosened(formula: str) -> str:
    """The formula with places at which it is broken rather than standing out into the margin."""
    pieces, place, depth = [], 0, 0
    for match in _PLACES.finditer(formula):
        if match[0] in "{}":
            depth += 1 if match[0] == "{" else -1
        elif match[0] == " " and depth == 0 and not _PENALTY.search(formula, max(0, match.start() - 16), match.end()):
            sign = formula[match.end()] in "+-"
            pieces += [formula[place : match.start()], f"\\penalty{_AT_SIGNS if sign else _BETWEEN_FACTORS} "]
            place = match.start() + (0 if sign else 1)
    return "".join([*pieces, formula[place:]])


def _words_outside(formula: str) -> str:
    r"""Long ``\text{...}`` between the mathematics instead of in it, so that lines may end there."""
    pieces, place, depth = [], 0, 0
    for match in re.finditer(r"\\text\{|\\[{}]|[{}]", formula):
        if match.start() < place:
            continue
        if match[0] == "\\text{" and depth == 0:
            end = closing_brace(formula, match.end() - 1)
            words = formula[match.end() : end]
            if len(words) > _SHORT_WORDS:
                pieces += [formula[place : match.start()], f"$ {words} $\\displaystyle "]
                place = end + 1
                continue
        if match[0] in ("{", "\\text{"):
            depth += 1
        elif match[0] == "}":
            depth -= 1
    return "".join([*pieces, formula[place:]])


def _loosened(text: str) -> str:
    """Inline lists of formulas may be broken after their commas."""
    return text.replace(",\\; ", ",\\;\\allowbreak ").replace(",\\, ", ",\\,\\allowbreak ")
