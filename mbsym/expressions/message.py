"""Messages: what a result says in words, as a value that is English text and can be said in another language.

A message is found by its English ``text``, in which ``[[name]]`` are gaps; what stands there are names, numbers and
formulas, the same in every language, or messages.  It is a ``str``, its English, wherever nobody asks for more: in
JSON, in exceptions, on the terminal.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Self

GAP = re.compile(r"\[\[(\w+)\]\]")


class Message(str):
    """``Message("terms of order [[order]] decide", order=3)``: the English with its gaps filled.

    A gap is said in another language where it is a ``Message`` itself; any other text, a name above all, stays.
    Raises ValueError unless each gap of the text has its value and each value its gap.
    """

    text: str
    gaps: Mapping[str, str]

    def __new__(cls, text: str, /, **gaps: object) -> Self:
        kept = {name: value if isinstance(value, str) else str(value) for name, value in gaps.items()}
        if kept.keys() != set(GAP.findall(text)):
            raise ValueError(f"{sorted(kept)} are not the gaps of {text!r}")
        self = super().__new__(cls, filled(text, kept.__getitem__))
        self.text, self.gaps = text, kept
        return self

    def __getnewargs_ex__(self) -> tuple[tuple[str], dict[str, Any]]:
        return (self.text,), dict(self.gaps)


class Counted(Message):
    """A number of things: ``Counted(3, "region")`` is "3 regions"; ``many`` where the plural is another than with an s.

    Other languages have as many forms as their catalogues say.
    """

    number: int
    one: str

    def __new__(cls, number: int, one: str, many: str = "") -> Self:
        self = super().__new__(
            cls, "[[number]] [[form]]", number=number, form=one if number == 1 else many or one + "s"
        )
        self.number, self.one = number, one
        return self

    def __getnewargs_ex__(self) -> tuple[Any, dict[str, Any]]:
        return (self.number, self.one, self.gaps["form"]), {}


def worded(text: str) -> Message:
    """Words of ours as a message, if they are none yet."""
    return (
        text if isinstance(text, Message) else Message("[[words]]", words=text) if GAP.search(text) else Message(text)
    )


def filled(text: str, value: Callable[[str], str]) -> str:
    """The text with what ``value`` says of each gap in its place."""
    return GAP.sub(lambda match: value(match[1]), text)


def joined(parts: Iterable[str], between: str = " ") -> Message:
    """Messages or names one after another, in the same order and with the same signs between them in every language."""
    found = {str(k): part for k, part in enumerate(parts)}
    return Message(between.join(f"[[{k}]]" for k in found), **found)


def enumerated(parts: Sequence[str]) -> str:
    """``a``, ``a and b``, ``a, b and c``."""
    *first, last = parts
    return Message("[[first]] and [[last]]", first=joined(first, ", "), last=last) if first else last
