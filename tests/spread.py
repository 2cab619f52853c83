"""A formula in Python syntax, multiplied out, with every sine and cosine as it was written: what a reader sees.

No trigonometry is known here but that cos is even and sin is odd, so two texts are equal only if the same waves stand
in them.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from fractions import Fraction


class Spread:
    """Terms: products of names and waves, each with its number."""

    def __init__(self, terms: Mapping[frozenset, Fraction]) -> None:
        self.terms = {monomial: number for monomial, number in terms.items() if number}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Spread) and self.terms == other.terms

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return " + ".join(
            f"{number}*" + "*".join(f"{atom}^{n}" for atom, n in sorted(monomial))
            for monomial, number in sorted(self.terms.items(), key=lambda item: str(sorted(item[0])))
        )

    def __add__(self, other: Spread) -> Spread:
        total = dict(self.terms)
        for monomial, number in other.terms.items():
            total[monomial] = total.get(monomial, Fraction(0)) + number
        return Spread(total)

    def __neg__(self) -> Spread:
        return Spread({monomial: -number for monomial, number in self.terms.items()})

    def __sub__(self, other: Spread) -> Spread:
        return self + -other

    def __mul__(self, other: Spread) -> Spread:
        total: dict[frozenset, Fraction] = {}
        for one, a in self.terms.items():
            for two, b in other.terms.items():
                exponents = Counter(dict(one))
                exponents.update(dict(two))
                key = frozenset(exponents.items())
                total[key] = total.get(key, Fraction(0)) + a * b
        return Spread(total)

    def __truediv__(self, other: Spread) -> Spread:
        return self * Spread({frozenset(): 1 / other.terms[frozenset()]})

    def __pow__(self, other: Spread) -> Spread:
        result = number(1)
        for _ in range(int(other.terms[frozenset()])):
            result = result * self
        return result


def number(value: int) -> Spread:
    return Spread({frozenset(): Fraction(value)})


def name(text: str) -> Spread:
    return Spread({frozenset({(text, 1)}): Fraction(1)})


def wave(function: str, angle: Spread) -> Spread:
    """The function of a sum of angles, the first by the alphabet with a plus."""
    multiples = sorted((next(iter(monomial))[0], n) for monomial, n in angle.terms.items())
    sign = 1 if multiples[0][1] > 0 else -1
    inside = " ".join(f"{sign * n}*{name}" for name, n in multiples)
    made = name(f"{function}({inside})")
    return -made if sign < 0 and function == "sin" else made


def spread(text: str, given: Mapping[str, Spread] | None = None) -> Spread:
    """Of a text, with some names standing for others' spreads."""

    class Names(dict):
        def __missing__(self, key: str) -> Spread:
            return name(key)

    names = Names(given or {})
    names |= {"sin": lambda x: wave("sin", x), "cos": lambda x: wave("cos", x), "number": number}
    return eval(re.sub(r"(?<![\w.])(\d+)", r"number(\1)", text), {"__builtins__": {}}, names)
