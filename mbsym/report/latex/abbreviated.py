r"""Long radicands, denominators and numerators under letters of their own: nothing in them can be broken by TeX.

What is wider than ``WIDEST`` becomes  \Delta_k  in every formula, and a formula before the first one that needs it says
what it is.  The letter is one that the document does not use.
"""

from __future__ import annotations

import re

from mbsym.report.latex.displays import closing_brace, long_formulas, loosened
from mbsym.report.latex.formulas import width

#: In ems: half a line of a page.
WIDEST = 20.0
LETTERS = ("\\Delta", "\\Xi", "\\Upsilon", "\\Pi", "\\Sigma", "\\Theta")

_HEAD = re.compile(r"\\(sqrt|frac)\{")
_BRACKET = re.compile(r"[()\[\]{}]|(?<=[^ {(\[]) (?=[+-] )")
#: Brackets of more letters may be broken.
LONG_BRACKET = 120


def abbreviated(text: str) -> str:
    r"""The text with long parts of its ``\longformula`` told before they are used."""
    letter = next((one for one in LETTERS if not re.search(re.escape(one) + r"(?![A-Za-z])", text)), None)
    if letter is None:
        return text
    parts = _Parts(letter)
    pieces, last = [], 0
    for start, label, formula, end in long_formulas(text):
        told = parts.told(formula)
        if told != formula:
            named = f"[{label}]" if label else ""
            pieces += [text[last:start], *parts.taken(), f"\\longformula{named}{{{loosened(told)}}}"]
            last = end
    return "".join([*pieces, text[last:]])


class _Parts:
    """Letters by what they stand for, in the order in which they were needed."""

    def __init__(self, letter: str) -> None:
        self._letter = letter
        self._letters: dict[str, str] = {}
        self._new: list[tuple[str, str]] = []

    def taken(self) -> list[str]:
        """The formulas that tell what is new since the last call."""
        found = [f"\\longformula{{{letter} = {_breakable(part)}}}\n" for letter, part in self._new]
        self._new = []
        return found

    def told(self, formula: str) -> str:
        """The formula with its long radicands, numerators and denominators as letters, inner ones first."""
        pieces, place = [], 0
        while (match := _HEAD.search(formula, place)) is not None:
            end = closing_brace(formula, match.end() - 1)
            inner = [self.told(formula[match.end() : end])]
            if match[1] == "frac":
                start = end + 1
                end = closing_brace(formula, start)
                inner.append(self.told(formula[start + 1 : end]))
            pieces += [formula[place : match.start()], f"\\{match[1]}"]
            pieces += [f"{{{self._letter_of(part) if width(part) > WIDEST else part}}}" for part in inner]
            place = end + 1
        return "".join([*pieces, formula[place:]])

    def _letter_of(self, part: str) -> str:
        if part not in self._letters:
            self._letters[part] = f"{self._letter}_{{{len(self._letters) + 1}}}"
            self._new.append((self._letters[part], part))
        return self._letters[part]


def _breakable(part: str) -> str:
    """With places at which a line may end: at signs, and within brackets only where these are long."""
    pieces, place, opened = [], 0, []
    ends = {match.start(): _partner(part, match.start()) for match in _BRACKET.finditer(part) if match[0] in "([{"}
    for match in _BRACKET.finditer(part):
        if match[0] in "([{":
            opened.append(ends[match.start()] - match.start())
        elif match[0] in ")]}":
            if opened:
                opened.pop()
        elif all(length > LONG_BRACKET for length in opened):
            pieces += [part[place : match.start()], f"\\penalty{120 if opened else 60} "]
            place = match.start()
    return "".join([*pieces, part[place:]])


def _partner(text: str, start: int) -> int:
    """Where a bracket closes, or the text ends."""
    depth = 0
    for match in _BRACKET.finditer(text, start):
        depth += 1 if match[0] in "([{" else -1 if match[0] in ")]}" else 0
        if depth == 0:
            return match.start()
    return len(text)
