"""How long a written number may be."""

from __future__ import annotations

from math import floor, log2

from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.expressions.message import Message

#: Python reads and writes integers of at most so many digits unless it is told otherwise, and so do its users.
MOST_DIGITS = 4300


_MOST_BITS = floor(MOST_DIGITS * log2(10))


def writable(*numbers: int) -> None:
    """Raises NoClosedForm if one of the integers has more digits than can be read again."""
    if max(map(int.bit_length, numbers)) > _MOST_BITS:
        raise NoClosedForm(
            Message("a number in it has more than [[most]] digits", most=MOST_DIGITS), limit=Limit.DIGITS
        )
