"""Truncated Taylor polynomials over the ring, of any order: expansion while formulas are built, never afterwards.

A jet of order n is the sum over k <= n of homogeneous polynomials of degree k in small deviations x_i; everything of
higher order is dropped.  Running the kinetic energy and force function over jets expands the Lagrangian about the
unperturbed motion while it is being built, so a system whose closed equations are out of reach can still be linearised
(order 2: "quadratisation"; Banshchikov & Vetrov, Problem 5), and has its normal form (order 4 or 6).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from math import factorial

from mbsym.algebra import rationals
from mbsym.algebra.base import Algebra
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.angles import LinearForm, linear_form
from mbsym.expressions.message import Message
from mbsym.expressions.table import Tabulated
from mbsym.expressions.tree import Expression

#: The deviations in a product, in ascending order: (0, 0, 3) is x_0^2 x_3.
Key = tuple[int, ...]
Terms = dict[Key, Polynomial]

_KINK = Message("[[name]] has a [[what]] at the motion that is expanded about", name="abs or sqrt", what="kink")


class Jet:
    """``value`` + ``parts[0]`` + ``parts[1]`` + ..., the terms of degree 1, 2, ...; absent coefficients are zero."""

    __slots__ = ("parts", "value")

    def __init__(self, value: Polynomial, *parts: Terms) -> None:
        self.value = value
        self.parts = parts

    def degree(self, k: int) -> Terms:
        """The terms of degree k > 0.  Raises NoClosedForm where |u| of a small u, or a root, stands among them."""
        part = self._part(k)
        if any(key[0] < 0 for key in part):
            raise NoClosedForm(_KINK)
        return part

    def _part(self, k: int) -> Terms:
        return self.parts[k - 1] if k <= len(self.parts) else {}

    @property
    def first(self) -> dict[int, Polynomial]:
        """The coefficients of x_i."""
        return {key[0]: value for key, value in self.degree(1).items()}

    @property
    def second(self) -> Terms:
        """The coefficients of x_i x_j by (i, j), i <= j."""
        return self.degree(2)

    @property
    def is_constant(self) -> bool:
        return not any(self.parts)

    def __add__(self, other: Jet) -> Jet:
        long, short = (self, other) if len(self.parts) >= len(other.parts) else (other, self)
        parts = [_sum(a, short.parts[k]) if k < len(short.parts) else a for k, a in enumerate(long.parts)]
        return Jet(self.value + other.value, *parts)

    def __neg__(self) -> Jet:
        return Jet(-self.value, *({key: -value for key, value in part.items()} for part in self.parts))

    def __sub__(self, other: Jet) -> Jet:
        return self + (-other)


def _sum(a: Terms, b: Terms) -> Terms:
    if not b:
        return a
    total = dict(a)
    for key, value in b.items():
        total[key] = total[key] + value if key in total else value
    return total


def _accumulate(ring: Ring, into: Terms, terms: Terms, factor: Polynomial) -> None:
    if not factor.is_zero():
        for key, value in terms.items():
            product = ring.times(value, factor)
            into[key] = into[key] + product if key in into else product


def _multiply(ring: Ring, into: Terms, a: Terms, b: Terms) -> None:
    for i, x in a.items():
        for j, y in b.items():
            key = i + j if i[-1] <= j[0] else tuple(sorted(i + j))
            product = ring.times(x, y)
            into[key] = into[key] + product if key in into else product


class Jets(Algebra[Jet]):
    """Jets over a ring, to the given ``order``.

    ``motion`` gives each coordinate's unperturbed value as an expression in parameters; a coordinate that is not in it
    (one that turns uniformly) stays the ring's own generator.  ``deviations`` are the indices of the x_i, or the jets
    of what deviates as a function of these; ``values`` holds the unperturbed value of every name as a polynomial.
    """

    def __init__(
        self,
        ring: Ring,
        motion: Mapping[str, Expression],
        deviations: Mapping[str, int | Jet],
        values: Mapping[str, Polynomial],
        order: int = 2,
    ) -> None:
        self.ring = ring
        self.order = order
        self.values = values
        self.motion = motion
        self.deviations = deviations
        self.zero, self.one = Jet(ring.zero), Jet(ring.one)
        self._kinks = 0

    def number(self, value: Fraction | int) -> Jet:
        return Jet(self.ring.number(value))

    def deviation(self, index: int, base: Polynomial) -> Jet:
        """base + x_index."""
        return Jet(base, {(index,): self.ring.one})

    def derivative(self, x: Jet, index: int) -> Jet:
        """dx/dx_index."""
        parts: list[Terms] = [{} for _ in x.parts]
        for part, terms in zip(parts, x.parts, strict=True):
            for key, value in terms.items():
                if count := key.count(index):
                    at = key.index(index)
                    part[key[:at] + key[at + 1 :]] = value * count
        return Jet(parts[0].get((), self.ring.zero) if parts else self.ring.zero, *parts[1:])

    def eulerian(self, x: Jet) -> Jet:
        """sum_i x_i dx/dx_i: each term times its degree."""
        parts = ({key: value * k for key, value in part.items()} for k, part in enumerate(x.parts, start=1))
        return Jet(self.ring.zero, *parts)

    def vanishes(self, x: Jet) -> bool:
        return x.is_constant and bool(x.value.is_zero())

    def times(self, a: Jet, b: Jet) -> Jet:
        """a*b; jets themselves do not multiply, because every product has to keep within the ring's budgets."""
        ring, parts, terms = self.ring, [], 0
        for k in range(1, min(self.order, len(a.parts) + len(b.parts)) + 1):
            part: Terms = {}
            _accumulate(ring, part, a._part(k), b.value)
            _accumulate(ring, part, b._part(k), a.value)
            for i in range(1, k):
                _multiply(ring, part, a._part(i), b._part(k - i))
            terms += len(part)
            parts.append(part)
        ring.spend(20 * (8 + terms))
        return Jet(ring.times(a.value, b.value), *parts)

    def reduce(self, x: Jet) -> Jet:
        reduce = self.ring.reduce
        parts = [{k: r for k, v in part.items() if not (r := reduce(v)).is_zero()} for part in x.parts]
        return Jet(reduce(x.value), *parts)

    def sin_cos(self, angle: LinearForm) -> tuple[Jet, Jet]:
        base = LinearForm(turns=angle.turns)
        elsewhere: list[tuple[str, Fraction, Polynomial]] = []
        small = self.zero
        for name, coefficient in angle.coefficients:
            if name in self.deviations:
                by = self.deviations[name]
                moved = self.deviation(by, self.ring.zero) if isinstance(by, int) else _small(by)
                small = small + self.times(self.number(coefficient), moved)
            form: LinearForm | None = LinearForm(((name, Fraction(1)),))
            if name in self.motion:
                form = linear_form(self.motion[name])
            if form is None or (form.constant and not self.adds_constant(form.scaled(self._basic(name)))):
                elsewhere.append((name, coefficient, self.values[name]))
                continue
            base = base + LinearForm(form.coefficients, form.turns).scaled(coefficient)
            if form.constant:
                elsewhere.append((name, coefficient, self.ring.number(form.constant)))
        sine, cosine = self.ring.sin_cos(base)
        for name, coefficient, value in elsewhere:
            s, c = self._at_rest_elsewhere(name, coefficient, value)
            sine, cosine = map(self.ring.reduce, self.ring.sum_of_angles(sine, cosine, s, c))
        return self._turned(sine, cosine, small)

    def adds_constant(self, angle: LinearForm) -> bool:
        return self.ring.adds_constant(angle)

    def _basic(self, name: str) -> Fraction:
        """1/denominator: the share of a name whose sine and cosine are generators."""
        return Fraction(1, self.ring.angles.get(name, 1))

    def _at_rest_elsewhere(self, name: str, coefficient: Fraction, value: Polynomial) -> tuple[Polynomial, Polynomial]:
        """sin and cos of coefficient * value, where the unperturbed value of a name (or what a constant adds to it) is
        no linear form in angles (1/2, l*w).

        Like everywhere in the ring they are made of those of name / denominator, so that both routes meet.
        """
        basic = self.ring.sin_cos_of(value * self.ring.number(self._basic(name)))
        return self.ring.multiple_angle(*basic, int(coefficient / self._basic(name)))

    def sin_cos_of(self, argument: Jet) -> tuple[Jet, Jet]:
        return self._turned(*self.ring.sin_cos_of(argument.value), _small(argument))

    def _turned(self, sine: Polynomial, cosine: Polynomial, u: Jet) -> tuple[Jet, Jet]:
        """sin(a + u) and cos(a + u) for small u."""
        times, number, s, c = self.times, self.ring.number, Jet(sine), Jet(cosine)
        signs = [Fraction((0, 1, 0, -1)[k % 4], factorial(k)) for k in range(self.order + 2)]
        small_sine = self._composed(u, [number(x) for x in signs[: self.order + 1]])
        small_cosine = self._composed(u, [number(x * (k + 1)) for k, x in enumerate(signs[1:])])
        return (
            self.reduce(times(s, small_cosine) + times(c, small_sine)),
            self.reduce(times(c, small_cosine) - times(s, small_sine)),
        )

    def _series(self, x: Jet, coefficients: Sequence[Polynomial]) -> Jet:
        """f(a + u) = c_0 + c_1 u + c_2 u^2 + ..., c_k = f^(k)(a)/k!, for x = a + u; missing coefficients are zero."""
        return self.reduce(self._composed(_small(x), coefficients))

    def _composed(self, u: Jet, coefficients: Sequence[Polynomial]) -> Jet:
        """c_0 + c_1 u + c_2 u^2 + ...; the powers of u are formed up to the order only."""
        total, power = Jet(coefficients[0]), u
        for k, coefficient in enumerate(coefficients[1 : self.order + 1]):
            if k:
                power = self.reduce(self.times(power, u))
            if power.is_constant:
                break
            if not coefficient.is_zero():
                total = total + self.times(Jet(coefficient), power)
        return total

    def _powers(self, x: Polynomial) -> list[Polynomial]:
        """1, x, x^2, ... up to the order."""
        powers = [self.ring.one]
        for _ in range(self.order):
            powers.append(self.ring.reduce(self.ring.times(powers[-1], x)))
        return powers

    def reciprocal(self, x: Jet) -> Jet:
        inverse = self.ring.reciprocal(x.value)
        return self._series(x, [self.ring.times(inverse, power) for power in self._powers(-inverse)])

    def square_root(self, x: Jet) -> Jet:
        """The root; that of a small form of second order is of the size of the deviations, as |u| is."""
        if not x.is_constant and not x._part(1) and self.ring.is_zero(x.value) is True:
            return self._of_their_size()
        root = self.ring.square_root(x.value)
        if x.is_constant:
            return Jet(root)
        inverse = self.ring.reciprocal(root)
        binomial, coefficients = Fraction(1), []
        for k, power in enumerate(self._powers(self.ring.times(inverse, inverse))):
            coefficients.append(self.ring.times(self.ring.number(binomial), self.ring.times(root, power)))
            binomial *= (Fraction(1, 2) - k) / (k + 1)
        return self._series(x, coefficients)

    def function(self, name: str, x: Jet) -> Jet:
        ring = self.ring
        half = ring.number(Fraction(1, 2))
        if name in ("sinh", "cosh", "tanh"):
            up, down = self.function("exp", x), self.function("exp", -x)
            sinh, cosh = self.times(up - down, Jet(half)), self.times(up + down, Jet(half))
            if name == "tanh":
                return self.ratio(sinh, cosh)
            return sinh if name == "sinh" else cosh
        if name in ("abs", "sign"):
            return self._off_the_kink(name, x)
        if isinstance(name, Tabulated):
            return self._tabulated(name, x)
        value, count = ring.function(name, x.value), self.order + 1
        if name == "exp":
            return self._series(x, [ring.times(ring.number(Fraction(1, factorial(k))), value) for k in range(count)])
        if name == "log":
            powers = self._powers(-ring.reciprocal(x.value))
            rest = (ring.times(ring.number(Fraction(-1, k)), powers[k]) for k in range(1, count))
            return self._series(x, [value, *rest])
        return self._series(x, [value, *self._arc_tangent(x.value)])

    def _arc_tangent(self, a: Polynomial) -> Iterable[Polynomial]:
        """The coefficients of u, u^2, ... of atan(a + u): those of 1/(1 + a^2 + 2 a u + u^2), divided by 1, 2, ..."""
        ring = self.ring
        inverse = ring.reciprocal(ring.one + ring.times(a, a))
        before, now = ring.zero, inverse
        for k in range(1, self.order + 1):
            yield ring.times(ring.number(Fraction(1, k)), now)
            following = ring.times(ring.number(2), ring.times(a, now)) + before
            before, now = now, ring.reduce(-ring.times(inverse, following))

    def _off_the_kink(self, name: str, x: Jet) -> Jet:
        """|a + u| = |a| + sign(a) u and sign(a + u) = sign(a) for small u, where a is not 0.

        |u| is of the size of u: a term of its own, with a negative index, that products may make small of higher order;
        u |u| is differentiable.  Raises NoClosedForm where sign(u) is asked for, or a is not known to be 0 or not.
        """
        ring = self.ring
        if x.is_constant:
            return Jet(ring.function(name, x.value))
        if name == "abs" and ring.is_zero(x.value) is True:
            return self._of_their_size()
        if ring.is_zero(x.value) is not False:
            raise NoClosedForm(
                _KINK
                if name == "abs"
                else Message("[[name]] has a [[what]] at the motion that is expanded about", name=name, what="jump")
            )
        sign = ring.function("sign", x.value)
        if name == "sign":
            return Jet(sign)
        return self._series(x, [ring.function("abs", x.value), sign])

    def _of_their_size(self) -> Jet:
        """What is no more than a multiple of the deviations, and has no expansion."""
        self._kinks += 1
        return Jet(self.ring.zero, {(-self._kinks,): self.ring.one})

    def _tabulated(self, name: Tabulated, x: Jet) -> Jet:
        """The Taylor polynomial off the knots.

        Raises NoClosedForm where a is a knot at which a derivative jumps, or is not known to be none: it is a number,
        but no rational one, and its ball holds a knot.
        """
        ring = self.ring
        if x.is_constant:
            return Jet(ring.function(name, x.value))
        ball = ring.constant_value(x.value)
        if ball is not None and any(
            name.curve.kinked_at(knot) and ball.contains(rationals.exact(knot)) for knot in name.curve.knots
        ):
            raise NoClosedForm(
                "the table [[table]] has a kink at the motion that is expanded about", table=name.table.name
            )
        coefficients, curve = [], name
        for k in range(self.order + 1):
            coefficients.append(ring.times(ring.number(Fraction(1, factorial(k))), ring.function(curve, x.value)))
            curve = curve.slope
        return self._series(x, coefficients)


def _small(x: Jet) -> Jet:
    return Jet(x.value * 0, *x.parts)
