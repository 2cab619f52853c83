"""Messages: what is said in words, as a value that can be said in another language.

A sentence is found by its English ``text``, in which ``$...$`` is notation in the common part of TeX and ``[[name]]`` a
gap; what stands there are names, numbers and formulas, the same in every language, or sentences.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from enum import Enum, StrEnum
from functools import partial
from math import ceil, floor, inf, log10
from numbers import Number
from typing import Any, Self

GAP = re.compile(r"\[\[(\w+)\]\]")


class Said:
    """A sentence and what stands in its gaps, outside of notation or inside."""

    def __init__(self, text: str, gaps: Mapping[str, Any] = {}) -> None:
        self.text, self.gaps = text, gaps


class Message(str, Said):
    """``Message("terms of order [[order]] decide", order=3)``: a sentence that is its English, with its gaps filled.

    So it is a ``str`` wherever nobody asks for more: in JSON, in exceptions, on the terminal.  Raises ValueError unless
    each gap of the text has its value and each value its gap.
    """

    def __new__(cls, text: str, /, **gaps: object) -> Self:
        if gaps.keys() != set(GAP.findall(text)):
            raise ValueError(f"{sorted(gaps)} are not the gaps of {text!r}")
        return super().__new__(cls, filled(text, lambda name: str(gaps[name])))

    def __init__(self, text: str, /, **gaps: object) -> None:
        Said.__init__(self, text, {name: str(x) if isinstance(x, Number) else x for name, x in gaps.items()})

    def __reduce__(self) -> tuple[Callable[..., Self], tuple[()]]:
        """With formulas as their text: they belong to the rings of one process."""
        gaps = {name: x if isinstance(x, str) else str(x) for name, x in self.gaps.items()}
        return partial(type(self), self.text, **gaps), ()


class Counted(Message):
    """A number of things: ``Counted(3, "region")`` is "3 regions"; ``many`` where the plural is another than with an s.

    Other languages have as many forms as their catalogues say.
    """

    def __new__(cls, number: int, one: str, many: str = "") -> Self:
        form = one if number == 1 else many or one + "s"
        return super().__new__(cls, "[[number]] [[form]]", number=number, form=form)

    def __init__(self, number: int, one: str, many: str = "") -> None:
        form = one if number == 1 else many or one + "s"
        super().__init__("[[number]] [[form]]", number=number, form=form)
        self.number, self.one = number, one

    def __reduce__(self) -> tuple[Callable[..., Self], tuple[()]]:
        return partial(type(self), self.number, self.one, str(self.gaps["form"])), ()


class Told(StrEnum):
    """A word of files and, where that is another text, what people are ``told``: ``NAME = "word", "what is told"``."""

    told: Message

    def __new__(cls, word: str, told: str = "") -> Self:
        member = str.__new__(cls, word)
        member._value_, member.told = word, Message(told or word)
        return member


class Code(Enum):
    """A code has its sentence for a value, with gaps ``[[1]]``, ... for data, or what makes it of them."""

    def __reduce_ex__(self, protocol: Any) -> tuple[Any, ...]:
        return getattr, (type(self), self.name)  # not all of its values are known to pickle

    def text(self, *data: object) -> str:
        """Its sentence with its gaps."""
        return self.value if isinstance(self.value, str) else self.value(*data)

    def said(self, *data: object, told: Callable[[Any], object] = lambda datum: datum) -> Message:
        """Its sentence of the data, each in its gap as it is ``told``."""
        text = self.text(*data)
        if isinstance(text, Message):
            return text
        return Message(text, **{str(k): told(x) for k, x in enumerate(data, start=1) if f"[[{k}]]" in text})


def worded(text: str) -> Message:
    """Words of ours as a message, if they are none yet."""
    return (
        text if isinstance(text, Message) else Message("[[words]]", words=text) if GAP.search(text) else Message(text)
    )


def filled(text: str, value: Callable[[str], str]) -> str:
    """The text as plain text, with what ``value`` says of each gap in its place."""
    plain = "".join(plain_notation(part) if inside else part for inside, part in pieces(text))
    return GAP.sub(lambda match: value(match[1]), plain)


def joined(parts: Iterable[object], between: str = " ") -> Message:
    """Messages, names, formulas one after another: in one order and with the same signs between in every language."""
    gaps = {str(k): part for k, part in enumerate(parts)}
    return Message(between.join(f"[[{k}]]" for k in gaps), **gaps)


def enumerated(parts: Sequence[str]) -> str:
    """``a``, ``a and b``, ``a, b and c``."""
    *first, last = parts
    return Message("[[first]] and [[last]]", first=joined(first, ", "), last=last) if first else last


def pieces(text: str) -> Iterable[tuple[bool, str]]:
    """The parts of a text: (whether it is notation, the part)."""
    return ((k % 2 == 1, piece) for k, piece in enumerate(text.split("$")) if piece)


_ACCENTS = {"ddot": "''", "dot": "'", "bar": "bar"}
#: What is read in notation, and what stands for it, one after the other.
_NOTATION = (
    (r"\\varphi", r"\\phi"),
    (r"\\([{}])", lambda m: "\x01" if m[1] == "{" else "\x02"),
    (r" ?\\cdot ?", "."),
    (r" ?\\times ?", "\u00d7"),
    (r"\\geq\b", ">="),
    (r"\\(?:[,;!] ?|quad|penalty\d+)", " "),
    (r"\\(?:mathrm|text) ?(?:\{(\w+)\})?", lambda m: m[1] or ""),
    (r"\\(ddot|dot|bar) ?(?:\{\\?(\w+)\}|\\?(\w+))", lambda m: (m[2] or m[3]) + _ACCENTS[m[1]]),
    (r"\\partial ?", "d"),
    (r"\\frac(\d)(\d)", r"\1/\2"),
    (r"\\frac ?\{([^{}]*)\}\{([^{}]*)\}", r"\1/\2"),
    (r"(?<![A-Za-z][A-Za-z])_\{?(?=\d)", ""),
    (r"\\([A-Za-z]+)", r"\1"),
    (r"[{}]", ""),
    (r" {2,}", " "),
)  # fmt: skip


def plain_notation(tex: str, power: str = "^") -> str:
    """Notation without the signs that only TeX reads."""
    tex = re.sub(r"\^\{?(\d+)\}?", lambda m: power + m[1], tex)
    for pattern, plain in _NOTATION:
        tex = re.sub(pattern, plain, tex)
    return tex.replace("\x01", "{").replace("\x02", "}")


# Numbers of things, and times, in words.


def counted(n: int, one: str, many: str = "") -> str:
    """``1 term``, ``4 terms``; ``many`` where the plural is another than ``one`` with an s."""
    return f"{n} {one if n == 1 else many or one + 's'}"


def at_most(value: float) -> str:
    """``3.2e-11``, rounded up: a bound stays one."""
    if not 0 < value < inf:
        return f"{value:.1e}"
    power = floor(log10(value)) - 1
    return f"{ceil(value / 10.0**power * (1 - 1e-15)) * 10.0**power:.1e}"


def plainly(value: float) -> str:
    """A number that was asked for with the digits that it was asked with: ``1.5e-09``, ``1e-06``."""
    return f"{value:.15g}"


def duration(seconds: float) -> Message:
    """``91 µs``, ``40 s``, ``3 h``, ``2.1e+03 days``."""
    if seconds < 1e-3:
        return Message("[[count]] µs", count=f"{seconds * 1e6:.3g}")
    if seconds < 1:
        return Message("[[count]] ms", count=f"{seconds * 1e3:.3g}")
    if seconds < 120:
        return Message("[[seconds]] s", seconds=f"{seconds:.3g}")
    if seconds < 7200:
        return Message("[[count]] min", count=f"{seconds / 60:.2g}")
    if seconds < 172800:
        return Message("[[count]] h", count=f"{seconds / 3600:.2g}")
    return Message("[[count]] days", count=f"{seconds / 86400:.2g}")
