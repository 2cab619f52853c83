"""Reads our LaTeX formulas as people do, who do not know where a program meant an argument to end.

After ``\\cos`` without a bracket the argument is everything that stands beside it up to a sign, another function or a
bracket: ``\\cos q_2 s`` is cos(q2 s), ``\\cos 2 q \\sin p`` is cos(2 q) sin(p).  Independent of the printers.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

_TOKEN = re.compile(r"\\penalty-?\d+|\\[A-Za-z]+|\\.|\d+|[A-Za-z]|[-+^_{}()\[\],]|\s+")
_FUNCTIONS = {r"\sin": "sin", r"\cos": "cos", r"\exp": "exp", r"\ln": "log", r"\arctan": "atan"}
_OPENING, _CLOSING = ("(", "[", r"\{"), (")", "]", r"\}")
_SILENT = (r"\,", r"\bigl", r"\bigr", r"\Bigl", r"\Bigr", r"\;")
_ACCENTS = (r"\dot", r"\ddot", r"\hat")
_TEXT = (r"\mathrm", r"\mathit", r"\mathtt")


def tokens(latex: str) -> list[str]:
    found, place = [], 0
    while place < len(latex):
        match = _TOKEN.match(latex, place)
        assert match is not None, latex[place : place + 20]
        place = match.end()
        if not match[0].isspace() and match[0] not in _SILENT and not match[0].startswith(r"\penalty"):
            found.append(match[0])
    return found


class Reader:
    """``values``: of each symbol as it is written, without blanks; ``number`` makes a scalar of a whole number."""

    def __init__(self, latex: str, values: Mapping[str, Any], number: Callable[[int], Any]) -> None:
        self.tokens = [*tokens(latex), ""]
        self.place = 0
        self.values = values
        self.number = number

    @property
    def next(self) -> str:
        return self.tokens[self.place]

    def take(self, wanted: str = "") -> str:
        token = self.next
        assert not wanted or token == wanted, (token, wanted)
        self.place += 1
        return token

    def read(self) -> Any:
        total = self.sum()
        assert self.next == "", self.next
        return total

    def sum(self) -> Any:
        total = self.number(0)
        while True:
            sign = -1 if self.next == "-" else 1
            if self.next in ("+", "-"):
                self.take()
            total = total + self.number(sign) * self.product()
            if self.next not in ("+", "-"):
                return total

    def product(self, of_argument: bool = False) -> Any:
        total = self.number(1)
        while self.next not in ("", "+", "-", "}", *_CLOSING):
            if of_argument and (self.next in _FUNCTIONS or self.next in _OPENING):
                break
            total = total * self.factor()
        return total

    def factor(self) -> Any:
        token = self.next
        if token in _FUNCTIONS:
            self.take()
            exponent = self.exponent()
            argument = self.bracket() if self.next in _OPENING else self.product(of_argument=True)
            return getattr(argument, _FUNCTIONS[token])() ** exponent
        if token in _OPENING:
            value = self.bracket()
            return value ** self.exponent()
        if token == r"\frac":
            self.take()
            over, under = self.group(), self.group()
            return over / under
        if token == r"\sqrt":
            self.take()
            return self.group().sqrt() ** self.exponent()
        if token.isdigit():
            value = self.number(int(self.take()))
        else:
            value = self.values[self.symbol()]
        return value ** self.exponent()

    def bracket(self) -> Any:
        opening = self.take()
        value = self.sum()
        self.take(_CLOSING[_OPENING.index(opening)])
        return value

    def group(self) -> Any:
        self.take("{")
        value = self.sum()
        self.take("}")
        return value

    def exponent(self) -> int:
        if self.next != "^":
            return 1
        self.take()
        self.take("{")
        value = int(self.take())
        self.take("}")
        return value

    def symbol(self) -> str:
        """A letter or command with accent and index, as it is written."""
        written = self.take()
        if written in (*_ACCENTS, *_TEXT):
            written += self.raw()
        if self.next == "_":
            written += self.take() + self.raw()
        return written

    def raw(self) -> str:
        """A group as it stands."""
        written, depth = self.take("{"), 1
        while depth:
            depth += {"{": 1, "}": -1}.get(self.next, 0)
            written += self.take()
        return written


def read(latex: str, values: Mapping[str, Any], number: Callable[[int], Any]) -> Any:
    """The value of a formula, as people read it."""
    return Reader(latex, values, number).read()
