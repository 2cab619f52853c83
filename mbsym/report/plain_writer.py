"""Content as plain text, for the terminal and for comments: formulas in Python syntax."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import singledispatchmethod
from typing import Any

from mbsym.expressions.counting import counted
from mbsym.expressions.tree import text
from mbsym.formulas.formula import Formula
from mbsym.report import content
from mbsym.report.content import Inline, Said
from mbsym.report.language import Language
from mbsym.report.plain import LONGEST

_DOTS = ("", "'", "''")


@dataclass(frozen=True)
class Writer:
    """Sentences in a language; ``readable`` formulas are as people write them, others as Python reads them.

    Formulas with a text of more than ``longest`` letters are counted.  ``images``: what stands for names that formulas
    have for others.
    """

    language: Language = field(default_factory=Language)
    readable: bool = False
    longest: int = sys.maxsize
    images: Mapping[str, str] = field(default_factory=dict)

    def said(self, sentence: Said) -> str:
        """A sentence with its gaps filled."""
        return "".join(text for text, _ in self.pieces(sentence))

    def pieces(self, value: Inline) -> Iterator[tuple[str, Inline]]:
        """What stands one after the other, each with the value that it is of: a screen may show them differently."""
        if isinstance(value, content.Phrase):
            for part in value.parts:
                yield from self.pieces(part)
        elif isinstance(value, content.Link):
            yield from self.pieces(value.text)
        elif isinstance(value, Said):
            parts = (
                _notation(x) if inside else x.replace("---", "\u2014")
                for inside, x in content.pieces(self.language.sentence(value.text))
            )
            for k, text in enumerate(re.split(r"\[\[(\w+)\]\]", "".join(parts))):
                if k % 2 == 0:
                    yield text, text
                    continue
                filled = value.gaps[text]
                if isinstance(filled, Sequence) and not isinstance(filled, str):
                    filled = content.joined(filled, ", ")
                yield from self.pieces(filled)
        else:
            yield self.inline(value), value

    def line(self, block: content.Paragraph | content.Display) -> str:
        """A paragraph, or a displayed formula a little to the right."""
        if isinstance(block, content.Paragraph):
            return self.inline(content.Phrase(block.parts))
        value = block.value
        return "  " + self.inline(content.Phrase(value) if isinstance(value, tuple) else value)

    @singledispatchmethod
    def inline(self, value: Any) -> str:
        """What stands in a line."""
        return text(value)

    @inline.register
    def _(self, value: str) -> str:
        return value

    @inline.register
    def _(self, value: int) -> str:
        return str(value)

    @inline.register
    def _(self, value: Formula) -> str:
        written = value.readable() if self.readable else str(value)
        if len(written) > self.longest:
            return f"({counted(value.terms, 'term')}; see the reports)"
        return re.sub(r"\b[A-Za-z_]\w*", lambda m: self.images.get(m[0], m[0]), written) if self.images else written

    @inline.register
    def _(self, value: Said) -> str:
        return self.said(value)

    @inline.register
    def _(self, value: content.Text) -> str:
        return "".join(map(self.inline, value.parts))

    @inline.register
    def _(self, value: content.Readable) -> str:
        return self.inline(value.value)

    @inline.register
    def _(self, value: content.Phrase) -> str:
        return "".join(text for text, _ in self.pieces(value))

    @inline.register
    def _(self, value: content.Words) -> str:
        return self.language.say(value.text)

    @inline.register(content.Strong)
    @inline.register(content.Graded)
    @inline.register(content.Link)
    def _(self, value: content.Strong | content.Graded | content.Link) -> str:
        return self.inline(value.text)

    @inline.register(content.Emphasis)
    @inline.register(content.Verbatim)
    @inline.register(content.Citation)
    def _(self, value: content.Emphasis | content.Verbatim | content.Citation) -> str:
        return value.text

    @inline.register
    def _(self, value: content.Unit) -> str:
        return f"[{value.text}]"

    @inline.register
    def _(self, value: content.Name) -> str:
        if value.name in self.images:
            return "d/dt " * value.dots + self.images[value.name]
        return value.name + _DOTS[value.dots] + (f"({value.at})" if value.at else "")

    @inline.register
    def _(self, value: content.Symbol) -> str:
        return value.letter + (f"_{value.lower}" if value.lower else "") + _DOTS[value.dots]

    @inline.register
    def _(self, value: content.Entry) -> str:
        index = value.index if isinstance(value.index, str) else self.inline(value.index)
        return f"{self.inline(value.whole)}[{index}]"

    @inline.register
    def _(self, value: content.Notation) -> str:
        return _notation(value.tex)

    @inline.register
    def _(self, value: content.Power) -> str:
        return f"{self.inline(value.base)}{'^' if self.readable else '**'}{value.exponent}"

    @inline.register
    def _(self, value: content.Listed) -> str:
        written = ", ".join(map(self.inline, value.items))
        return f"({written})" if value.brackets else f"{{{written}}}" if value.braces else written

    @inline.register
    def _(self, value: content.Relation) -> str:
        return " ".join(map(self.inline, value.parts))

    @inline.register
    def _(self, value: content.Number) -> str:
        return value.text

    @inline.register
    def _(self, value: content.Rows) -> str:
        return f"[{', '.join(self.inline(content.Listed(row, brackets=True)) for row in value.rows)}]"

    @inline.register
    def _(self, value: content.Raised) -> str:
        return f"{self.inline(value.of)}({value.index})"

    @inline.register
    def _(self, value: content.Polynomial) -> str:
        written = in_powers(list(map(self.inline, value.coefficients)), value.variable)
        return written if value.power == 1 else f"({written})**{value.power}"


#: What the terminal shows: long formulas are left to the reports.
TERMINAL = Writer(longest=LONGEST)


def in_powers(coefficients: Sequence[str], variable: str) -> str:
    """``m*z**2 + (a - b)*z - c`` of ``-c, a - b, m``: no factor 1, and brackets about sums only."""
    parts: list[str] = []
    for k, one in reversed(list(enumerate(coefficients))):
        if one == "0":
            continue
        minus = one.startswith("-") and not (k and _is_sum(one[1:]))
        factor = one[1:].lstrip() if minus else one
        if k:
            power = variable if k == 1 else f"{variable}**{k}"
            factor = power if factor == "1" else f"({factor})*{power}" if _is_sum(factor) else f"{factor}*{power}"
        parts.append((" - " if minus else " + ") + factor)
    found = "".join(parts).lstrip()
    return found[2:] if found.startswith("+ ") else found.replace("- ", "-", 1) or "0"


def _is_sum(text: str) -> bool:
    """Whether a plus or minus stands outside of all brackets, the first sign included."""
    depth = 0
    for letter in text:
        depth += (letter in "([") - (letter in ")]")
        if depth == 0 and letter in "+-":
            return True
    return False


def _notation(tex: str) -> str:
    """Notation without the signs that only TeX reads."""
    plain = re.sub(r"\\(?:[,;!] ?|quad|penalty\d+)", " ", re.sub(r" ?\\cdot ?", ".", tex))
    plain = re.sub(r"\\(?:mathrm|text) ?", "", re.sub(r"\^\{?(\w+)\}?", r"**\1", plain))
    plain = re.sub(r"_\{?(?=\d)", "", plain)
    plain = re.sub(r"\\ddot ?\{?(\w)\}?", r"\1''", plain)
    plain = re.sub(r"\\dot ?\{?(\w)\}?", r"\1'", plain)
    return re.sub(r" {2,}", " ", re.sub(r"\\([A-Za-z]+)", r"\1", plain)).replace("{", "").replace("}", "")
