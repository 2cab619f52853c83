r"""The common part of TeX in MathML: letters and numbers, indices, exponents, accents, fractions, words, signs.

    T = \frac12 \sum M_{ij}\, \dot q_i \dot q_j

What is not listed here raises ValueError: notation is ours, and a test reads all of it.
"""

from __future__ import annotations

import re
from functools import cache

from mbsym.formulas.mathml import fraction, letter, mi, mn, mo, mtext, sign
from mbsym.formulas.names import greek

_SIGNS = {
    "cdot": "\u00b7", "times": "\u00d7", "circ": "\u2218", "partial": "\u2202", "sum": "\u2211", "pm": "\u00b1",
    "neq": "\u2260", "leq": "\u2264", "geq": "\u2265", "{": "{", "}": "}", "-": "\u2212",
}  # fmt: skip
_ACCENTS = {"dot": "\u02d9", "ddot": "\u00a8", "bar": "\u00af"}
_VARIANTS = {"varphi": "phi", "varepsilon": "epsilon"}
_SPACES = {",": "0.167em", ";": "0.278em", " ": "0.25em", "quad": "1em"}
_FUNCTIONS = ("cos", "sin", "exp", "ln", "det")
#: Where a line may end, and how tall a bracket is: screens see to that.
_LEFT_TO_SCREENS = ("penalty", "allowbreak", "bigl", "bigr", "Bigl", "Bigr")
#: Behind these a minus belongs to what follows.
_BEFORE_SIGNS = (mo("="), mo("("), mo("["))
_TOKEN = re.compile(r"\\[A-Za-z]+ ?|\\.|\d+(?:\.\d+)?|\S")


@cache
def notation(tex: str) -> str:
    """Finished elements.  Raises ValueError for what they cannot be made of."""
    return "".join(_Reader(tex).row())


class _Reader:
    def __init__(self, tex: str) -> None:
        self.tex, self.place = re.sub(r"\\penalty\d+", "", tex), 0

    def row(self, closing: str = "") -> list[str]:
        """What stands up to the end, or to the ``closing`` brace."""
        found: list[str] = []
        while token := self._next():
            if token == closing:
                return found
            if token == "}":
                raise ValueError(f"a brace was never opened: {self.tex}")
            if token in ("_", "^"):
                if not found:
                    raise ValueError(f"nothing has this index: {self.tex}")
                found.append(self._scripts(found.pop(), token))
            elif token == "-" and (not found or found[-1] in _BEFORE_SIGNS):
                found.append(sign(_SIGNS[token]))
            elif token.strip("\\") not in _LEFT_TO_SCREENS:
                found.append(self._element(token))
        if closing:
            raise ValueError(f"a brace is never closed: {self.tex}")
        return found

    def _next(self) -> str:
        match = _TOKEN.search(self.tex, self.place)
        self.place = len(self.tex) if match is None else match.end()
        return "" if match is None else match[0] if match[0] == "\\ " else match[0].rstrip()

    def _scripts(self, base: str, token: str) -> str:
        """The base with what stands below and above it, in either order."""
        places = {token: self._argument()}
        before, other = self.place, self._next()
        if other in ("_", "^") and other not in places:
            places[other] = self._argument()
        else:
            self.place = before
        match places:
            case {"_": low, "^": high}:
                return f"<msubsup>{base}{low}{high}</msubsup>"
            case {"_": low}:
                return f"<msub>{base}{low}</msub>"
        return f"<msup>{base}{places['^']}</msup>"

    def _argument(self) -> str:
        """A group, a command, one letter or one digit."""
        token = self._next()
        if not token or token == "}":
            raise ValueError(f"an argument is missing: {self.tex}")
        if token.isdigit() and len(token) > 1:
            self.place -= len(token) - 1
            token = token[0]
        return self._element(token)

    def _words(self) -> str:
        """What stands in the braces that follow, as it is."""
        match = re.compile(r" *\{([^{}]*)\}").match(self.tex, self.place)
        if match is None:
            raise ValueError(f"no braces: {self.tex}")
        self.place = match.end()
        return match[1]

    def _element(self, token: str) -> str:
        if token == "{":
            inside = self.row("}")
            return inside[0] if len(inside) == 1 else f"<mrow>{''.join(inside)}</mrow>"
        if token[:1].isdigit():
            return mn(token)
        name = token.removeprefix("\\")
        if not token.startswith("\\"):
            return mi(token) if token.isalpha() or "\ue000" <= token <= "\uf8ff" else mo(_SIGNS.get(token, token))
        if name in _ACCENTS:
            return f'<mover accent="true">{self._argument()}<mo stretchy="false">{_ACCENTS[name]}</mo></mover>'
        if name in ("frac", "tfrac"):
            return fraction(self._argument(), self._argument())
        if name in ("mathrm", "operatorname"):
            return mi(self._words())
        if name == "text":
            return mtext(self._words())
        if name in _FUNCTIONS:
            return mi(name) + "<mo>\u2061</mo>"
        if name in _SPACES:
            return f'<mspace width="{_SPACES[name]}"/>'
        if name in _SIGNS:
            return mo(_SIGNS[name])
        known = _VARIANTS.get(name, name)
        if greek(known) == known:
            return mi(letter(known))
        raise ValueError(f"not in our part of TeX: {token} in {self.tex}")
