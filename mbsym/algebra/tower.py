"""Exact numbers in parameters and square roots: Q(p_1, ..., p_m)[s_1, ..., s_k], s_i^2 given by what stands before it.

An element is a polynomial in the s_i and the parameters over a denominator in the parameters alone.  Square roots are
adjoined when they are asked for; nobody asks whether they lie in the field already: what is computed then holds for
either sign of each root.  An element has a reciprocal if the product of its conjugates, in which no root is left, is
not zero.  Products are reduced at once (s_i^2 is replaced), and common factors of polynomial and denominator cancelled.

Frequencies of normal forms live here: lambda^4 + a lambda^2 + b = 0 by three square roots.

The cosine of a parameter may be a parameter itself, by the name ``cos(x)`` or ``cos(x/2)``; its sine is a root then.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import Ordering, acb, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from mbsym.algebra import rationals
from mbsym.algebra.base import Algebra
from mbsym.algebra.factors import square_apart
from mbsym.algebra.failures import Limit, NoClosedForm, SingularPoint
from mbsym.algebra.rationals import value_at
from mbsym.expressions.angles import LinearForm

#: As many roots can be adjoined, and so many terms may an element have.
MOST_ROOTS, MOST_TERMS = 8, 4_000
#: The parameter that is this number: algebraic numbers and it are in no relation.
PI = "pi"
#: So many products of terms may be formed in all: some seconds.
MOST_WORK = 40_000_000


class Element:
    """top / bottom."""

    __slots__ = ("bottom", "top", "tower")

    def __init__(self, tower: Tower, top: fmpq_mpoly, bottom: fmpq_mpoly) -> None:
        self.tower, self.top, self.bottom = tower, top, bottom

    def __add__(self, other: Any) -> Element:
        other = self.tower.element(other)
        if self.bottom == other.bottom:
            return self.tower.made(self.top + other.top, self.bottom)
        common = self.bottom.gcd(other.bottom)
        own_cofactor, other_cofactor = divmod(self.bottom, common)[0], divmod(other.bottom, common)[0]
        return self.tower.made(self.top * other_cofactor + other.top * own_cofactor, self.bottom * other_cofactor)

    __radd__ = __add__

    def __neg__(self) -> Element:
        return Element(self.tower, -self.top, self.bottom)

    def __sub__(self, other: Any) -> Element:
        return self + (-self.tower.element(other))

    def __rsub__(self, other: Any) -> Element:
        return self.tower.element(other) - self

    def __mul__(self, other: Any) -> Element:
        other = self.tower.element(other)
        self.tower.spend(len(self.top) * len(other.top))
        return self.tower.made(self.tower.reduced(self.top * other.top), self.bottom * other.bottom)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Element:
        return self * self.tower.reciprocal(self.tower.element(other))

    def __eq__(self, other: object) -> bool:
        return (self - other).is_zero()

    __hash__ = None  # type: ignore[assignment]

    def is_zero(self) -> bool:
        return bool(self.top.is_zero())

    def __repr__(self) -> str:
        return f"({self.top})/({self.bottom})"


class Tower(Algebra[Element]):
    """The algebra of ``Element`` over the named ``parameters``; ``roots`` holds the squares s_i^2 in order."""

    def __init__(self, parameters: Sequence[str] = ()) -> None:
        self.parameters = tuple(parameters)
        names = [f"s{k}" for k in reversed(range(MOST_ROOTS))] + [f"p{k}" for k in range(len(self.parameters))]
        self.context = fmpq_mpoly_ctx.get(names, Ordering.lex)
        gens = self.context.gens()
        self._roots, self._free = gens[:MOST_ROOTS][::-1], gens[MOST_ROOTS:]
        #: Whether an element is known to be positive.
        self.is_positive: Callable[[Element], bool] = lambda x: False
        #: s_i^2, polynomials in what stands before them.
        self.squares: list[fmpq_mpoly] = []
        #: Roots that are sines of parameters, and those: name and denominator.
        self._sines: dict[int, tuple[str, int]] = {}
        self._unit, self.work = self.context.constant(1), 0
        self.zero, self.one = self.element(0), self.element(1)

    def spend(self, work: int) -> None:
        """Counts products of terms.  Raises NoClosedForm where they are too many."""
        self.work += 8 + work
        if self.work > MOST_WORK:
            raise NoClosedForm("more than [[most]] products of terms", most=MOST_WORK, limit=Limit.WORK)

    def element(self, x: Any) -> Element:
        if isinstance(x, Element):
            return x
        if isinstance(x, Fraction):
            x = rationals.exact(x)
        return Element(self, self.context.constant(x), self._unit)

    def number(self, value: Fraction | int) -> Element:
        return self.element(Fraction(value))

    def parameter(self, name: str) -> Element:
        return Element(self, self._free[self.parameters.index(name)], self._unit)

    def reduced(self, top: fmpq_mpoly) -> fmpq_mpoly:
        """Every s_i^2 replaced, the latest first."""
        for k in reversed(range(len(self.squares))):
            if top.degrees()[MOST_ROOTS - 1 - k] > 1:
                top = divmod(top, self._roots[k] ** 2 - self.squares[k])[1]
        if len(top) > MOST_TERMS:
            raise NoClosedForm("more than [[most]] terms of one coefficient", most=MOST_TERMS, limit=Limit.TERMS)
        return top

    def made(self, top: fmpq_mpoly, bottom: fmpq_mpoly) -> Element:
        """top / bottom with common factors cancelled; top is reduced."""
        if top.is_zero():
            return self.zero
        if not bottom.is_constant():
            self.spend(len(top) * len(bottom))
            common = top.gcd(bottom)
            if not common.is_constant():
                top, bottom = divmod(top, common)[0], divmod(bottom, common)[0]
        leading = bottom.leading_coefficient()
        return Element(self, top / leading, bottom / leading)

    def times(self, a: Element, b: Element) -> Element:
        return a * b

    def vanishes(self, x: Element) -> bool:
        return x.is_zero()

    def reciprocal(self, x: Element) -> Element:
        """1/x by the product of its conjugates.  Raises SingularPoint where that is zero."""
        norm, others = x.top, self._unit
        for k in reversed(range(len(self.squares))):
            if norm.degrees()[MOST_ROOTS - 1 - k]:
                conjugate = self._conjugate(norm, k)
                norm = self.reduced(norm * conjugate)
                others = self.reduced(others * conjugate)
        if norm.is_zero():
            raise SingularPoint("division by zero")
        return self.made(self.reduced(others * x.bottom), norm)

    def _conjugate(self, x: fmpq_mpoly, k: int) -> fmpq_mpoly:
        images = list(self.context.gens())
        images[MOST_ROOTS - 1 - k] = -images[MOST_ROOTS - 1 - k]
        return x.compose(*images, ctx=self.context)

    def conjugate(self, x: Element, k: int) -> Element:
        """x with -s_k for s_k; what was adjoined later and contains s_k is left as it is."""
        return Element(self, self._conjugate(x.top, k), x.bottom)

    def square_root(self, x: Element) -> Element:
        """A root of x, of either sign: squares that are factors of x taken out, and of what is left one adjoined, once.

        That matters: with s^2 = 4 adjoined s - 2 would be neither zero nor have a reciprocal.
        """
        outside, inside = self._apart(self.reduced(x.top * x.bottom))
        if inside == self._unit:
            return self.made(outside, x.bottom)
        if inside not in self.squares:
            if len(self.squares) == MOST_ROOTS:
                raise NoClosedForm("more than [[most]] square roots", most=MOST_ROOTS, limit=Limit.FUNCTIONS)
            self.squares.append(inside)
        return self.made(outside * self._roots[self.squares.index(inside)], x.bottom)

    def principal_root(self, x: Element) -> Element:
        """The root of x that is not negative: |g| s/|bottom|, where x = g^2 s^2/bottom^2.

        Raises NoClosedForm where the sign of g or of the denominator is not known.
        """
        outside, _ = self._apart(self.reduced(x.top * x.bottom))
        root = self.square_root(x)
        for p in (outside, x.bottom):
            sign = Element(self, p, self._unit)
            if p.is_constant() or self.is_positive(sign):
                root = -root if p.is_constant() and p.leading_coefficient() < 0 else root
            elif self.is_positive(-sign):
                root = -root
            else:
                raise NoClosedForm(
                    "the root of a square is taken of what may have either sign",
                    remedy="say in 'assumptions' which sign it has, as a > b for sqrt((a - b)**2)",
                )
        return root

    def _apart(self, x: fmpq_mpoly) -> tuple[fmpq_mpoly, fmpq_mpoly]:
        """(g, h) with x = g^2 h, h without square factors but numbers; h = x where x holds a root."""
        return (self._unit, x) if self.places(x) else square_apart(x)

    def rational(self, x: Element) -> fmpq | None:
        """The number that x is, if it is written as one."""
        if not (x.top.is_constant() and x.bottom.is_constant()):
            return None
        return fmpq(0) if x.is_zero() else x.top.leading_coefficient() / x.bottom.leading_coefficient()

    def kind(self, index: int) -> str | fmpq_mpoly:
        """What a generator of ``context`` is: a parameter's name, a cosine or sine of one, or a root's square."""
        if index >= MOST_ROOTS:
            return self.parameters[index - MOST_ROOTS]
        place = MOST_ROOTS - 1 - index
        return f"sin({_angle(*self._sines[place])})" if place in self._sines else self.squares[place]

    def places(self, x: fmpq_mpoly) -> list[int]:
        """Which s_k occur in x; one of a root that was adjoined, none of a rational one."""
        degrees = x.degrees()
        return [k for k in range(len(self.squares)) if degrees[MOST_ROOTS - 1 - k] > 0]

    def sin_cos(self, angle: LinearForm) -> tuple[Element, Element]:
        if len(angle.coefficients) == 1 and angle == LinearForm(angle.coefficients):
            ((name, share),) = angle.coefficients
            cosine = f"cos({_angle(name, share.denominator)})"
            if share.numerator == 1 and cosine in self.parameters:
                c = self.parameter(cosine)
                s = self.square_root(1 - c * c)
                self._sines[self.places(s.top)[0]] = name, share.denominator
                return s, c
        raise NoClosedForm(
            "sines and cosines of parameters or numbers in the coefficients: only square roots are exact here"
        )

    def sin_cos_of(self, argument: Element) -> tuple[Element, Element]:
        raise NoClosedForm(
            "sines and cosines of parameters or numbers in the coefficients: only square roots are exact here"
        )

    def function(self, name: str, x: Element) -> Element:
        raise NoClosedForm("[[name]] in the coefficients: only square roots are exact here", name=name)

    def enclosed(self, x: Element, values: Mapping[str, Any]) -> acb:
        """x at values of the parameters, of angles, too; roots by their principal values, sines by the angle."""
        point = [acb(0)] * MOST_ROOTS + [_value(name, values) for name in self.parameters]
        for k, square in enumerate(self.squares):
            angle, share = self._sines.get(k, ("", 1))
            known = angle in values
            point[MOST_ROOTS - 1 - k] = (
                (acb(values[angle]) / share).sin() if known else value_at(square, point, acb).sqrt()
            )
        return value_at(x.top, point, acb) / value_at(x.bottom, point, acb)


def _angle(name: str, denominator: int) -> str:
    return name if denominator == 1 else f"{name}/{denominator}"


def angle_in(name: str) -> tuple[str, str, int] | None:
    """("cos", "x", 2) of ``cos(x/2)``; None of a plain name."""
    if name[3:4] != "(":
        return None
    angle, _, share = name[4:-1].partition("/")
    return name[:3], angle, int(share or 1)


def _value(name: str, values: Mapping[str, Any]) -> acb:
    if name == PI:
        return acb.pi()
    inside = angle_in(name)
    if name in values or inside is None:
        return acb(values[name])
    return (acb(values[inside[1]]) / inside[2]).cos()
