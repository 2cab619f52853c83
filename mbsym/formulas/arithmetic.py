"""Arithmetic of formulas of one system: exact, in the system's ring."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from numbers import Rational
from typing import TYPE_CHECKING, Any

from mbsym.algebra.base import Lowering
from mbsym.algebra.ring import Generator, ParameterRing, Polynomial, Ring
from mbsym.expressions.guessing import guess
from mbsym.expressions.parser import DERIVED, parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.rates import ENDINGS
from mbsym.expressions.table import Tabulated
from mbsym.expressions.tree import Expression, Number, names, number
from mbsym.formulas.python import declared_name
from mbsym.formulas.shape import present
from mbsym.formulas.tree import Product, Sum, Wave

if TYPE_CHECKING:
    from mbsym.formulas.formula import Formula


_NAMED = ("coordinate", "velocity", "acceleration", "prescribed", "time", "parameter")


def whole(formula: Formula) -> tuple[Ring, Polynomial]:
    """A formula in the ring of its system; conditions of stability live in the ring of the parameters alone."""
    ring = formula.ring
    return (
        (ring.whole, ring.lift(formula.polynomial)) if isinstance(ring, ParameterRing) else (ring, formula.polynomial)
    )


def together(formula: Formula, other: object) -> tuple[Ring, Polynomial, Polynomial] | None:
    """Both in one ring; None for what is no exact number and no formula.

    Raises ValueError for a formula of another system, TypeError for a float.
    """
    ring, x = whole(formula)
    if isinstance(other, float):
        raise TypeError(f"formulas are exact: write Fraction('{other}') for {other}")
    if isinstance(other, Rational):
        return ring, x, ring.number(Fraction(int(other.numerator), int(other.denominator)))
    if type(other) is not type(formula):
        return None
    second, y = whole(other)
    if second is not ring:
        raise ValueError("these formulas belong to different systems")
    return ring, x, y


def power(formula: Formula, exponent: object) -> tuple[Ring, Polynomial]:
    """Whole and half exponents.  Raises ValueError for others."""
    ring, x = whole(formula)
    if not isinstance(exponent, Rational) or int(exponent.denominator) not in (1, 2):
        raise ValueError(f"an exponent is a whole or a half number, not {exponent}")
    base = x if int(exponent.denominator) == 1 else ring.square_root(x)
    return ring, ring.reduce(ring.power(base, int(exponent.numerator)))


def environment(ring: Ring) -> dict[str, Polynomial]:
    """Every name of the system and its generator."""
    indices = {g.name + ENDINGS.get(g.kind, ""): k for k, g in enumerate(ring.generators) if g.kind in _NAMED}
    return {name: ring.context.gen(k) for name, k in indices.items()}


def substituted(formula: Formula, values: Mapping[str, Any]) -> tuple[Ring, Polynomial]:
    """Names replaced, all at once; sines and cosines of them are formed anew.

    Raises ValueError for a name that the system does not have and for what is no expression, TypeError for a float,
    SingularPoint where the formula divides by zero there, NoClosedForm for an angle that the ring cannot hold.
    """
    ring, x = whole(formula)
    known = environment(ring)
    lower = Lowering(ring, known)
    indices = {g.name + ENDINGS.get(g.kind, ""): k for k, g in enumerate(ring.generators) if g.kind in _NAMED}
    images: dict[int, Polynomial] = {}
    for name, value in values.items():
        if name not in known or name == "pi":
            raise ValueError(
                f"unknown name '{name}'{guess(name, [known_name for known_name in known if known_name != 'pi'])}"
            )
        tree = _expression(name, value)
        for unknown in sorted(names(tree) - known.keys()):
            raise ValueError(f"unknown name '{unknown}'{guess(unknown, known)}")
        images[indices[name]] = lower(tree)
        if name in ring.angles and ring.has("sine", name):
            angle = tree if ring.angles[name] == 1 else _divided(tree, ring.angles[name])
            sine, cosine = lower.angle(angle)
            images[ring.index("sine", name)], images[ring.index("cosine", name)] = sine, cosine
    return ring, ring.reduce(ring.substitute(x, images))


def _divided(tree: Expression, by: int) -> Expression:
    from mbsym.expressions.tree import Operation

    return Operation("/", tree, number(by))


def _expression(name: str, value: Any) -> Expression:
    if isinstance(value, float):
        raise TypeError(f"formulas are exact: write '{value}' or Fraction('{value}') for {name}")
    if isinstance(value, Rational):
        exact = Fraction(int(value.numerator), int(value.denominator))
        return Number(exact)
    complaints = Complaints()
    tree = parse_expression(str(value), complaints, lambda start, end: Span(1, start + 1, end - start), bounds=DERIVED)
    if tree is None:
        raise ValueError(f"{name}: " + "; ".join(item.message for item in complaints.items))
    return tree


# Formulas as SymPy expressions: for SymPy's users, and for tests that read our text back.


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
