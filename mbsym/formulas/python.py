"""Formulas in Python syntax with the declared names: ``m*l**2*theta_dot**2/2``, ``sin(theta)``, ``sqrt(a + b)``.

Exact: a rational coefficient is a quotient of integers, never a float.  Reading the text back gives the same value.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mbsym.algebra.ring import Generator, Polynomial, Ring
from mbsym.formulas.shape import Factor, Product, Sum, present

_SUFFIX = {"velocity": "_dot", "acceleration": "_ddot"}


def python_text(ring: Ring, polynomial: Polynomial) -> str:
    """The polynomial as one line of Python."""
    return _Printer(ring).sum(present(ring, polynomial))


def declared_name(generator: Generator) -> str:
    """``theta``, ``theta_dot``, ``theta_ddot``, ``Jx``."""
    return generator.name + _SUFFIX.get(generator.kind, "")


class _Printer:
    def __init__(self, ring: Ring) -> None:
        self.ring = ring
        self._atoms: dict[int, str] = {}

    def sum(self, shape: Sum) -> str:
        if not shape.terms:
            return "0"
        pieces: list[str] = []
        for term in shape.terms:
            negative = term.coefficient < 0
            sign = (" - " if negative else " + ") if pieces else ("-" if negative else "")
            pieces.append(sign + self.product(term))
        return "".join(pieces)

    def product(self, product: Product) -> str:
        """Without its sign."""
        top, bottom = abs(int(product.coefficient.p)), int(product.coefficient.q)
        over = [self.factor(f) for f in product.over]
        under = [self.factor(f) for f in product.under]
        if top != 1 or not over:
            over.insert(0, str(top))
        if bottom != 1:
            under.insert(0, str(bottom))
        return "*".join(over) + _divided_by(under)

    def factor(self, factor: Factor) -> str:
        base = self.atom(factor.base) if isinstance(factor.base, int) else f"({self.sum(factor.base)})"
        return base if factor.exponent == 1 else f"{base}**{factor.exponent}"

    def atom(self, index: int) -> str:
        if index not in self._atoms:
            self._atoms[index] = self._atom(self.ring.generators[index])
        return self._atoms[index]

    def _atom(self, g: Generator) -> str:
        argument = self._argument(g.argument) if g.argument is not None else g.name
        if g.kind in ("sine", "cosine"):
            whole = argument if g.denominator == 1 else f"{argument}/{g.denominator}"
            return f"{'sin' if g.kind == 'sine' else 'cos'}({whole})"
        if g.kind == "root":
            return f"sqrt({argument})"
        if g.kind == "function":
            return f"{g.name}({argument})"
        return declared_name(g)

    def _argument(self, argument: Any) -> str:
        return self.sum(present(self.ring, argument))


def _divided_by(under: Sequence[str]) -> str:
    if not under:
        return ""
    return "/" + (under[0] if len(under) == 1 else f"({'*'.join(under)})")
