"""How long a written number may be."""

from __future__ import annotations

from math import log2

from mbsym.algebra.failures import Limit, NoClosedForm

#: Python reads and writes integers of at most so many digits unless it is told otherwise, and so do its users.
MOST_DIGITS = 4300


def writable(*numbers: int) -> None:
    """Raises NoClosedForm if one of the integers has more digits than can be read again."""
    if any(number.bit_length() > MOST_DIGITS * log2(10) for number in numbers):
        raise NoClosedForm(f"a number in it has more than {MOST_DIGITS} digits", limit=Limit.DIGITS)
