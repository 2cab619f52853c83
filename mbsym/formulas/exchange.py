"""Formulas as SymPy expressions: for SymPy's users, and for tests that read our text back."""

from __future__ import annotations

from typing import Any

from mbsym.algebra.ring import Generator, Polynomial, Ring
from mbsym.expressions.table import Tabulated
from mbsym.formulas.python import declared_name
from mbsym.formulas.shape import present
from mbsym.formulas.tree import Product, Sum, Wave


def to_sympy(ring: Ring, polynomial: Polynomial) -> Any:
    """The polynomial over plain symbols named as declared: ``theta``, ``theta_dot``, ``Jx``."""
    return _Translation(ring).sum(present(ring, polynomial))


class _Translation:
    def __init__(self, ring: Ring) -> None:
        import sympy  # here and not above: it takes longer to import than most systems take to derive

        self.sympy = sympy
        self.ring = ring
        self._atoms: dict[int, Any] = {}

    def sum(self, shape: Sum) -> Any:
        return self.sympy.Add(*(self.product(term) for term in shape.terms))

    def product(self, product: Product) -> Any:
        coefficient = self.sympy.Rational(int(product.coefficient.p), int(product.coefficient.q))
        over = [self.base(f.base) ** f.exponent for f in product.over]
        under = [self.base(f.base) ** -f.exponent for f in product.under]
        return self.sympy.Mul(coefficient, *over, *under)

    def base(self, base: int | Wave | Sum) -> Any:
        if isinstance(base, Sum):
            return self.sum(base)
        if isinstance(base, Wave):
            angle = self.sympy.Add(
                *(self.sympy.Rational(n.numerator, n.denominator) * self.sympy.Symbol(name) for name, n in base.angle)
            )
            return self.sympy.sin(angle) if base.kind == "sine" else self.sympy.cos(angle)
        if base not in self._atoms:
            self._atoms[base] = self._atom(self.ring.generators[base])
        return self._atoms[base]

    def _atom(self, g: Generator) -> Any:
        sympy = self.sympy
        argument = sympy.Symbol(g.name) if g.argument is None else self.sum(present(self.ring, g.argument))
        match g.kind:
            case "sine":
                return sympy.sin(argument / g.denominator)
            case "cosine":
                return sympy.cos(argument / g.denominator)
            case "root":
                return sympy.sqrt(argument)
            case "function" if isinstance(g.name, Tabulated):
                function, order = sympy.Function(g.name.written), g.name.curve.order
                if not order:
                    return function(argument)
                own = sympy.Dummy("x")
                return sympy.Subs(sympy.Derivative(function(own), (own, order)), own, argument)
            case "function":
                return getattr(sympy, {"abs": "Abs"}.get(g.name, g.name))(argument)
        return sympy.pi if g.name == "pi" else sympy.Symbol(declared_name(g))
