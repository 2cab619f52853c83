"""Formulas in Python syntax with the declared names: ``m*l**2*theta_dot**2/2``, ``sin(theta)``, ``sqrt(a + b)``.

Exact: a rational coefficient is a quotient of integers, never a float.  Reading the text back gives the same value.
"""

from __future__ import annotations

from collections.abc import Mapping
from weakref import WeakKeyDictionary

from mbsym.algebra.ring import Generator, Polynomial, Ring
from mbsym.expressions.rates import ENDINGS, derivative_of
from mbsym.expressions.table import Tabulated
from mbsym.formulas.letters import LetterRing, lettered
from mbsym.formulas.shape import present, printed
from mbsym.formulas.tree import Factor, Product, Sum, Wave, angles_or


def python_text(ring: Ring, polynomial: Polynomial) -> str:
    """The polynomial as one line of Python, in products of sines and cosines unless sums were asked for."""
    ring, polynomial = lettered(ring, polynomial)
    return printed(ring, polynomial, angles_or("products"), ("python",), lambda shape: _PythonPrinter(ring).sum(shape))


def declared_name(generator: Generator) -> str:
    """``theta``, ``theta_dot``, ``theta_ddot``, ``Jx``."""
    return generator.name + ENDINGS.get(generator.kind, "")


def readable_text(ring: Ring, polynomial: Polynomial) -> str:
    """The polynomial on one line as people write it: ``(m l^2 + J) theta'' + m g l sin(theta)``."""
    ring, polynomial = lettered(ring, polynomial)
    return _ReadablePrinter(ring).sum(present(ring, polynomial, angles_or("shorter")))


class InfixPrinter:
    """Sums, products and quotients on one line; languages differ in their signs and in how atoms look."""

    power = "**"
    times = "*"

    def __init__(self, ring: Ring) -> None:
        self.ring = ring
        self._atoms: dict[int, str] = {}

    def call(self, function: str, argument: str) -> str:
        """A function of one argument; ``function`` is Python's name."""
        raise NotImplementedError

    def symbol(self, generator: Generator) -> str:
        """A coordinate, velocity, acceleration, parameter, prescribed quantity or the time."""
        raise NotImplementedError

    def sum(self, shape: Sum) -> str:
        if not shape.terms:
            return "0"
        pieces: list[str] = []
        for term in shape.terms:
            negative = term.coefficient < 0
            pieces.append((" - " if negative else " + ") if pieces else ("-" if negative else ""))
            pieces.append(self.product(term))
        return "".join(pieces)

    def product(self, product: Product) -> str:
        """Without its sign."""
        top, bottom = product.magnitude
        over = [self.factor(f) for f in product.over]
        under = [self.factor(f) for f in product.under]
        if top != 1 or not over:
            over.insert(0, str(top))
        if bottom != 1:
            under.insert(0, str(bottom))
        quotient = "" if not under else "/" + (under[0] if len(under) == 1 else f"({self.times.join(under)})")
        return self.times.join(over) + quotient

    def factor(self, factor: Factor) -> str:
        if isinstance(factor.base, int):
            base = self.atom(factor.base)
        else:
            base = self.wave(factor.base) if isinstance(factor.base, Wave) else self.sum(factor.base)
            if isinstance(factor.base, Sum) and not base.isidentifier():
                base = f"({base})"
        return base if factor.exponent == 1 else f"{base}{self.power}{factor.exponent}"

    def atom(self, index: int) -> str:
        if index not in self._atoms:
            self._atoms[index] = self._atom(self.ring.generators[index])
        return self._atoms[index]

    def _atom(self, g: Generator) -> str:
        if g.kind not in FUNCTION_OF_KIND:
            return self.symbol(g)
        if g.argument is None:
            return self.call(FUNCTION_OF_KIND[g.kind], self._angle(g))
        argument = self.sum(present(self.ring, g.argument, angles_or("products")))
        return self.call(FUNCTION_OF_KIND[g.kind] or g.name, argument)

    def wave(self, wave: Wave) -> str:
        """``cos(q1 - 2*q2)``."""
        pieces: list[str] = []
        for name, n in wave.angle:
            pieces.append((" - " if n < 0 else " + ") if pieces else ("-" if n < 0 else ""))
            times = "" if abs(n.numerator) == 1 else f"{abs(n.numerator)}{self.times}"
            pieces.append(times + self._named(name) + ("" if n.denominator == 1 else f"/{n.denominator}"))
        return self.call(FUNCTION_OF_KIND[wave.kind], "".join(pieces))

    def _named(self, name: str) -> str:
        """A coordinate, prescribed quantity, parameter or the time as it stands under a sine."""
        kind = next(k for k in ("coordinate", "prescribed", "parameter", "time") if self.ring.has(k, name))
        return self.atom(self.ring.index(kind, name))

    def _angle(self, g: Generator) -> str:
        """What stands under the sine of a named angle."""
        angle = self._named(g.name)
        return angle if g.denominator == 1 else f"{angle}/{g.denominator}"


#: Python's function for each kind of generator that is one; functions go by their own names.
FUNCTION_OF_KIND = {"sine": "sin", "cosine": "cos", "root": "sqrt", "function": ""}


class _PythonPrinter(InfixPrinter):
    def call(self, function: str, argument: str) -> str:
        if isinstance(function, Tabulated):
            order = function.curve.order
            function = "derivative(" * order + function.written + ")" * order
        return f"{function}({argument})"

    def symbol(self, generator: Generator) -> str:
        return declared_name(generator)


class _ReadablePrinter(_PythonPrinter):
    power = "^"
    times = " "

    def symbol(self, generator: Generator) -> str:
        kind, name = derivative_of(generator.kind, generator.name)
        return readable_name(self.ring, name) + _PRIMES.get(kind, "")


_PRIMES = {"velocity": "'", "acceleration": "''"}
_NAMES: WeakKeyDictionary[Ring, Mapping[str, str]] = WeakKeyDictionary()


def write_as(ring: Ring, spellings: Mapping[str, str]) -> None:
    """From now on names of the ring are written for people as ``spellings``: ``sin(theta)`` for ``sin_theta``."""
    _NAMES[ring] = spellings


def readable_name(ring: Ring, name: str) -> str:
    """A name as people write it."""
    ring = ring.whole if isinstance(ring, LetterRing) else ring
    return _NAMES.get(ring, {}).get(name, name)
