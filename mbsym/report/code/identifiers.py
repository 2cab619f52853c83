"""Names and numbers in generated code: a system's name as an identifier (the prefix of its C functions, the name of its
FMU, of its Modelica model), constants that read back exactly.
"""

from __future__ import annotations

import hashlib
import re
import unicodedata
from collections.abc import Callable, Collection
from fractions import Fraction

from mbsym.algebra.failures import Limit, NoClosedForm

#: Prefixes longer than this lose their small words, and those longer than LONGEST their end.
LONG, LONGEST = 24, 40

_SMALL = frozenset(["a", "an", "the", "of", "with", "and", "in", "on", "by", "for", "to", "its", "from", "at", "as"])


def prefix_of(name: str) -> str:
    """Lower-case letters, digits and underscores: ``Double pendulum`` is ``double_pendulum``.

    Different names that would look alike (letters that ASCII lacks, the end of a long name) differ in six digits of a
    hash at the end.
    """
    plain = unicodedata.normalize("NFKD", name)
    words = [word for word in re.split(r"[^0-9A-Za-z]+", plain.encode("ascii", "ignore").decode()) if word]
    short = "_".join(words).lower()
    if len(short) > LONG:
        short = "_".join(word for word in words if word.lower() not in _SMALL).lower() or short
    lost = any(character.isalnum() and not character.isascii() for character in name)
    if len(short) > LONGEST or lost or not short:
        digits = hashlib.sha256(name.encode("utf-8", "surrogatepass")).hexdigest()[:6]
        short = f"{short[: LONGEST - 7].strip('_') or 'model'}_{digits}"
    return short if short[0].isalpha() else f"model_{short}"


def camel(prefix: str) -> str:
    """``DoublePendulum``, as types and modules are called."""
    return "".join(word.capitalize() for word in prefix.split("_"))


def spelled(name: str, reserved: Collection[str], unfit: Callable[[str], bool] = lambda plain: False) -> str:
    """A declared name in ASCII letters, digits and underscores, a ``v`` in front of a digit and of what is ``unfit``.

    What is ``reserved`` gets an underscore at its end.
    """
    plain = "".join(letter if letter.isascii() and (letter.isalnum() or letter == "_") else "_" for letter in name)
    plain = "v" + plain if plain[:1].isdigit() or unfit(plain) else plain
    return plain + "_" if plain in reserved else plain


# Constants of generated code.


def number(value: Fraction) -> str:
    """A correctly rounded constant: decimals where they are exact, else a quotient of exact numbers if it is short.

    Raises NoClosedForm beyond the range of double.
    """
    try:
        shown = repr(float(value))
    except OverflowError:
        raise NoClosedForm("a number in it is beyond 1.8e308, where double ends", limit=Limit.DIGITS) from None
    if Fraction(shown) == value or max(abs(value.numerator), value.denominator) > 10**6:
        return shown
    return f"{value.numerator}.0/{value.denominator}.0"
