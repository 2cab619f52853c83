"""The text of a unit as a product of names with powers, ``kg*m^2/s^2``: read without computing anything of it."""

from __future__ import annotations

import re
from fractions import Fraction

from mbsym.expressions.message import Message

MAX_UNIT = 60
MAX_EXPONENT = 20

_FORM = "a unit is made of names, powers, * and /, such as kg*m^2/s^2"
_TOKEN = re.compile(r"\s*(?:([A-Za-z_][A-Za-z0-9_]*)|(\*\*|\^)|(\d{1,3}(?:\.\d{1,3})?)(?![\w.])|([*/().+-]))")
_MOST_NESTED = 20

#: The name of each unit and its exponent.
Powers = dict[str, Fraction]


class Wrong(ValueError):
    """Why a text is no product of units."""


def product(text: str) -> Powers:
    """The names of a product with their exponents; raises ``Wrong`` with the reason.

    A product is written with ``*``, ``.`` or a space, and ``1/s`` for what has no numerator.

    >>> {name: str(power) for name, power in product("kg m^2/s**(3/2)").items()}
    {'kg': '1', 'm': '2', 's': '-3/2'}
    """
    if len(text) > MAX_UNIT:
        raise Wrong(_FORM)
    return _Reader(text).whole()


class _Reader:
    """Recursive descent; every exponent is bounded as soon as it is formed."""

    def __init__(self, text: str) -> None:
        self.tokens: list[str] = []
        self.place = 0
        end = 0
        text = text.rstrip()
        while end < len(text):
            match = _TOKEN.match(text, end)
            if match is None:
                raise Wrong(_FORM)
            self.tokens.append("^" if match[2] else match[0].strip())
            end = match.end()

    def whole(self) -> Powers:
        found = self.product(0)
        if self.place < len(self.tokens):
            raise Wrong(_FORM)
        return {name: power for name, power in found.items() if power}

    def next(self) -> str:
        return self.tokens[self.place] if self.place < len(self.tokens) else ""

    def take(self, token: str) -> bool:
        taken = self.next() == token
        self.place += taken
        return taken

    def product(self, depth: int) -> Powers:
        if depth > _MOST_NESTED:
            raise Wrong(_FORM)
        found = self.factor(depth)
        while (token := self.next()) not in ("", ")"):
            if token in ("*", "/", "."):
                self.place += 1
            found = _times(found, self.factor(depth), -1 if token == "/" else 1)
        return found

    def factor(self, depth: int) -> Powers:
        token = self.next()
        self.place += 1
        if token == "(":
            found = self.product(depth + 1)
            if not self.take(")"):
                raise Wrong(_FORM)
        elif token == "1":
            found = {}
        elif re.match("[A-Za-z_]", token):
            found = {token: Fraction(1)}
        else:
            raise Wrong(_FORM)
        return _times({}, found, self.exponent()) if self.take("^") else found

    def exponent(self) -> Fraction:
        """``2``, ``-2``, ``0.5``, ``(1/2)``."""
        inside = self.take("(")
        sign = -1 if self.take("-") else 1
        value = sign * self.number()
        if inside:
            value = value / self.number() if self.take("/") else value
            if not self.take(")"):
                raise Wrong(_FORM)
        if self.next() == "^":
            raise Wrong(_FORM)
        return value

    def number(self) -> Fraction:
        token = self.next()
        self.place += 1
        if not token[:1].isdigit() or (self.tokens[self.place - 2] == "/" and not Fraction(token)):
            raise Wrong(_FORM)
        return Fraction(token)


def _times(one: Powers, other: Powers, power: Fraction | int) -> Powers:
    made = dict(one)
    for name, exponent in other.items():
        made[name] = made.get(name, Fraction(0)) + exponent * power
    if any(abs(exponent) > MAX_EXPONENT for exponent in made.values()):
        raise Wrong(Message("powers of units go to [[most]]", most=MAX_EXPONENT))
    return made
