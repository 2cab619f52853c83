"""Content as plain text, for the terminal and for comments: formulas in Python syntax."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import singledispatchmethod
from typing import Any

from mbsym.expressions.tree import text
from mbsym.formulas.formula import Formula
from mbsym.report import content
from mbsym.report.content import Inline, Said
from mbsym.report.language import Language

_DOTS = ("", "'", "''")


@dataclass(frozen=True)
class Writer:
    """Sentences in a language; ``readable`` formulas are as people write them, others as Python reads them."""

    language: Language = field(default_factory=Language)
    readable: bool = False

    def said(self, sentence: Said) -> str:
        """A sentence with its gaps filled."""
        parts = (_notation(x) if inside else x for inside, x in content.pieces(self.language.sentence(sentence.text)))
        return re.sub(r"\[\[(\w+)\]\]", lambda m: self._gap(sentence.gaps[m[1]]), "".join(parts))

    def _gap(self, value: Inline | Sequence[Inline]) -> str:
        if isinstance(value, Sequence) and not isinstance(value, str):
            return ", ".join(map(self.inline, value))
        return self.inline(value)

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
        return value.readable() if self.readable else str(value)

    @inline.register
    def _(self, value: Said) -> str:
        return self.said(value)

    @inline.register
    def _(self, value: content.Words) -> str:
        return self.language.say(value.text)

    @inline.register
    def _(self, value: content.Phrase) -> str:
        return "".join(map(self.inline, value.parts))

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
    def _(self, value: content.Phrase) -> str:
        return "".join(map(self.inline, value.parts))

    @inline.register
    def _(self, value: content.Name) -> str:
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
    def _(self, value: content.Listed) -> str:
        written = ", ".join(map(self.inline, value.items))
        return f"({written})" if value.brackets else f"{{{written}}}" if value.braces else written

    @inline.register
    def _(self, value: content.Relation) -> str:
        return " ".join(map(self.inline, value.parts))

    @inline.register
    def _(self, value: content.Polynomial) -> str:
        terms = [
            f"({x})" + (f"*{value.variable}" + (f"**{k}" if k > 1 else "") if k else "")
            for k, x in reversed(list(enumerate(value.coefficients)))
            if not x.is_zero
        ]
        written = " + ".join(terms) or "0"
        return written if value.power == 1 else f"({written})**{value.power}"


def _notation(tex: str) -> str:
    """Notation without the signs that only TeX reads."""
    plain = re.sub(r"\\(?:[,;!] ?|quad|penalty\d+)", " ", tex)
    plain = re.sub(r"\\ddot ?\{?(\w)\}?", r"\1''", plain)
    plain = re.sub(r"\\dot ?\{?(\w)\}?", r"\1'", plain)
    return re.sub(r" {2,}", " ", re.sub(r"\\([A-Za-z]+)", r"\1", plain)).replace("{", "").replace("}", "")
