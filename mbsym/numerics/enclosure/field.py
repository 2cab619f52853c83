"""A right-hand side f(t, x) and its Jacobian over whatever has arithmetic: balls, series of balls, models on a disc.

Balls enclose the values over all points that they contain.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import exp, inf, isfinite, log, nan
from typing import Any

import numpy as np
from flint import arb, arb_series, ctx

from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.kernels.precise import written

# Functions of complex time on a disc |s| <= R: a polynomial with balls as coefficients, and a bound of the rest.
#
#     g(s) = sum_{k<=d} c_k s^k + r(s),      |r|_R <= rest,      |g|_R = sum_k |g_k| R^k
#
# r has terms of higher degree than d only, so that the c_k contain the Taylor coefficients of g.
# The norm is that of absolutely convergent series: |g h|_R <= |g|_R |h|_R, and it bounds |g(s)| on the disc.  So sums,
# products, quotients and functions of such models are models again.  What a function F leaves out beyond degree d is
# bounded by its majorant G (F about c0 has coefficients no larger than those of G):
#
#     sum_{k>d} |[F(c0 + u)]_k| R^k <= G(u~(l)) / l^(d+1),   u~(l) = sum_k |u_k| R^k l^k,   for any l > 1
#
# Bounds are floats, made larger by far more than their roundings at every step.


#: What a float bound is multiplied by and added to after every operation: sums of some dozens of terms lie within.
LARGER, TINY = 1 + 2.0**-40, 1e-290

#: Ratios l that are tried for the tail of a function.
RATIOS = (1.25, 1.6, 2.2, 3.2, 5.0, 8.0)


def _up(value: float) -> float:
    return value * LARGER + TINY


def _bound(value: arb) -> float:
    """A float no smaller than |value|."""
    return _up(float(value.abs_upper()))


@dataclass(frozen=True)
class Ring:
    """The disc: degree d and the powers 1, R, ..., R^d of its radius."""

    degree: int
    radius: float

    @property
    def powers(self) -> Any:
        """Rounded to nearest; the bounds that are made of them leave room for that."""
        return np.cumprod(np.concatenate(([1.0], np.full(self.degree, self.radius))))


class Model:
    """A polynomial ``poly`` (its series is cut off after s^d) and a ``rest``; ``sizes`` bound |c_k| R^k."""

    __slots__ = ("_sizes", "poly", "rest", "ring")

    def __init__(self, ring: Ring, poly: Any, rest: float = 0.0) -> None:
        self.ring, self.poly, self.rest = ring, poly, rest
        self._sizes: Any = None

    @property
    def sizes(self) -> Any:
        if self._sizes is None:
            d = self.ring.degree
            poly = self.poly
            bounds = np.array([_bound(poly[k]) for k in range(d + 1)])
            self._sizes = bounds * self.ring.powers * LARGER + TINY
        return self._sizes

    @property
    def norm(self) -> float:
        """A bound of |g| on the disc."""
        return _up(float(np.sum(self.sizes)) + self.rest)

    def _of(self, other: Any) -> Model:
        return other if isinstance(other, Model) else Model(self.ring, arb_series([other]))

    def __neg__(self) -> Model:
        return Model(self.ring, -self.poly, self.rest)

    def __add__(self, other: Any) -> Model:
        other = self._of(other)
        return Model(self.ring, self.poly + other.poly, _up(self.rest + other.rest))

    __radd__ = __add__

    def __sub__(self, other: Any) -> Model:
        other = self._of(other)
        return Model(self.ring, self.poly - other.poly, _up(self.rest + other.rest))

    def __rsub__(self, other: Any) -> Model:
        return self._of(other) - self

    def __mul__(self, other: Any) -> Model:
        if not isinstance(other, Model):
            return Model(self.ring, self.poly * other, _up(self.rest * _bound(arb(other))))
        a, b = self.sizes, other.sizes
        beyond = np.cumsum(b[::-1])  # beyond[i - 1]: the sizes of b from degree d - i + 1 on
        rest = float(np.sum(a[1:] * beyond[:-1])) * LARGER
        rest += self.rest * other.norm + float(np.sum(a)) * other.rest
        return Model(self.ring, self.poly * other.poly, _up(rest))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Model:
        return self * (other.reciprocal() if isinstance(other, Model) else 1 / arb(other))

    def __rtruediv__(self, other: Any) -> Model:
        return self.reciprocal() * other

    def _composed(self, poly: Any, majorant: Callable[[float], float], slope: Callable[[float], float]) -> Model:
        """F of it: ``poly`` is F of its polynomial; ``majorant`` G and ``slope`` G' take sizes without the constant."""
        sizes = self.sizes[1:]
        total = _up(float(np.sum(sizes)))
        degrees = np.arange(1, self.ring.degree + 1)
        left = inf
        for ratio in RATIOS:
            wide = _up(float(np.sum(sizes * ratio**degrees)))
            bound = majorant(wide)
            if isfinite(bound):
                left = min(left, _up(bound / ratio ** (self.ring.degree + 1)))
        return Model(self.ring, poly, _up(left + self.rest * slope(_up(total + self.rest))))

    def exp(self) -> Model:
        """exp(c0 + u): G = exp(c0) exp(u)."""
        size = _bound(self.poly[0].exp())
        return self._composed(self.poly.exp(), *[lambda w: size * _exp(w)] * 2)

    def sin(self) -> Model:
        """No derivative of sin and cos at a real c0 is beyond 1: G = exp(u)."""
        return self._composed(self.poly.sin(), _exp, _exp)

    def cos(self) -> Model:
        return self._composed(self.poly.cos(), _exp, _exp)

    def reciprocal(self) -> Model:
        """Y(s), the polynomial of 1/g, with  1/g = Y/(1 - v),  v = 1 - g Y: sharp even where u is as large as c0."""
        if not _least(self.poly[0]) > 0:
            return self._nothing()
        near = Model(self.ring, 1 / self.poly)
        missed = (self._of(arb(1)) - self * near).norm
        if not missed < 1:
            return self._nothing()
        return Model(self.ring, near.poly, _up(near.norm * missed / (1 - missed)))

    def sqrt(self) -> Model:
        """Y(s), the polynomial of the root, with  sqrt(g) = Y sqrt(1 + v),  v = g/Y^2 - 1."""
        if not (self.poly[0] > 0):
            return self._nothing()
        near = Model(self.ring, self.poly.sqrt())
        missed = (self / (near * near) - arb(1)).norm
        if not missed < 1:
            return self._nothing()
        return Model(self.ring, near.poly, _up(near.norm * missed))

    def log(self) -> Model:
        """G = -log(1 - u/c0), but for its constant."""
        least = _least(self.poly[0])
        if not (least > 0 and self.poly[0] > 0):
            return self._nothing()
        return self._within(self.poly.log(), least)

    def atan(self) -> Model:
        """The singularities +-i are sqrt(1 + c0^2) away: coefficients are at most 1/(k rho^k)."""
        least = _least((1 + self.poly[0] * self.poly[0]).sqrt())
        return self._within(self.poly.atan(), least)

    def _within(self, poly: Any, least: float) -> Model:
        """Of functions whose coefficients are at most 1/(k rho^k), rho = ``least`` the way to a singularity."""
        return self._composed(
            poly,
            lambda w: _up(-log(1 - w / least)) if w < least * (1 - 1e-9) else inf,
            lambda w: _up(1 / (least - w)) if w < least else inf,
        )

    def _nothing(self) -> Model:
        return Model(self.ring, arb_series([arb(nan)]), inf)


def _exp(w: float) -> float:
    return _up(exp(w)) if w < 600 else inf


def _least(value: arb) -> float:
    """A float no larger than |value|."""
    return float(value.abs_lower()) / LARGER


def model(ring: Ring, coefficients: Sequence[arb], rest: float = 0.0) -> Model:
    """A model with the coefficients of s^0 to s^d."""
    return Model(ring, arb_series(list(coefficients)), rest)


class NotAnalytic(Exception):
    """A function in the equations without a power series; its name.

    ``rows``: the labels of constraints that follow from others, where the choice among them brings it in.
    """

    def __init__(self, name: str, rows: tuple[str, ...] = ()) -> None:
        super().__init__(name)
        self.rows = rows


def _exponential(x: Any) -> tuple[Any, Any]:
    return x.exp(), (-x).exp()


def _sinh(x: Any) -> Any:
    up, down = _exponential(x)
    return (up - down) / 2


def _cosh(x: Any) -> Any:
    up, down = _exponential(x)
    return (up + down) / 2


def _tanh(x: Any) -> Any:
    up, down = _exponential(x)
    return (up - down) / (up + down)


#: Functions of the language, from those that balls, series and models have themselves.
FUNCTIONS: dict[str, Callable[[Any], Any]] = {
    "sin": lambda x: x.sin(),
    "cos": lambda x: x.cos(),
    "tan": lambda x: x.sin() / x.cos(),
    "exp": lambda x: x.exp(),
    "sqrt": lambda x: x.sqrt(),
    "log": lambda x: x.log(),
    "atan": lambda x: x.atan(),
    "sinh": _sinh,
    "cosh": _cosh,
    "tanh": _tanh,
}


def function_of(code: Code, bits: int) -> Callable[[Sequence[Any]], list[Any]]:
    """The code as a function of balls, series or models, in the order of its inputs.

    Raises NotAnalytic where it has a function without a power series.
    """

    def meaning(name: str) -> Callable[[Any], Any]:
        if name not in FUNCTIONS:
            raise NotAnalytic(name)
        return FUNCTIONS[name]

    return written(code, bits, meaning)


def upper(value: arb) -> arb:
    """An exact bound of |value|, rounded up; not finite where there is none."""
    return value.abs_upper()


def series(coefficients: Sequence[arb]) -> arb_series:
    """sum_k coefficients_k s^k, cut off by the context."""
    return arb_series(list(coefficients))


def _coefficient(value: Any, k: int) -> arb:
    if isinstance(value, arb_series):
        return value[k]
    return value if k == 0 else arb(0)


class cap:
    """Series are cut off after so many coefficients, as long as this lasts."""

    def __init__(self, length: int) -> None:
        self.length = length

    def __enter__(self) -> None:
        self.before, ctx.cap = ctx.cap, self.length

    def __exit__(self, *_: object) -> None:
        ctx.cap = self.before


class Field:
    """f: (t, y) -> y' (n numbers) and J = df/dy (n*n numbers, row by row), both at ``bits`` bits.

    The components are those of the equations, x_i, as parts of ``sizes``: y_i = x_i / u_i, f_i = x_i' / u_i,
    J_ij = dx_i'/dx_j u_j / u_i.  So boxes, axes and discs are no matter of the units of a description.
    """

    def __init__(self, rates: Code, jacobian: Code, bits: int, sizes: Sequence[float] | None = None) -> None:
        self.bits = bits
        self.size = len(rates.outputs)
        self.sizes = [arb(size) for size in sizes or [1.0] * self.size]
        self._parts = [1 / size for size in self.sizes]
        self._slopes = [over * part for part in self._parts for over in self.sizes]
        self._rates = function_of(rates, bits)
        self._jacobian = function_of(jacobian, bits)

    def rates(self, t: Any, y: Sequence[Any]) -> list[Any]:
        """f at numbers of one kind."""
        return [x * part for x, part in zip(self._rates([t, *self.whole(y)]), self._parts, strict=True)]

    def jacobian(self, t: Any, y: Sequence[Any]) -> list[Any]:
        """J at numbers of one kind."""
        return [x * part for x, part in zip(self._jacobian([t, *self.whole(y)]), self._slopes, strict=True)]

    def whole(self, y: Sequence[Any]) -> list[Any]:
        """x, in the units of the equations."""
        return [value * size for value, size in zip(y, self.sizes, strict=True)]

    def solution(self, t: arb, y: Sequence[arb], order: int) -> list[list[arb]]:
        """Taylor coefficients of the solutions through y (a point or a box): those of s^0 to s^order, n lists.

        y_(k+1) = [f(t + s, y(s))]_k / (k + 1): each pass gives one coefficient more.
        """
        coefficients = [[value] for value in y]
        for k in range(order):
            with cap(k + 1):
                slopes = self.rates(series([t, arb(1)]), [series(item) for item in coefficients])
                for item, slope in zip(coefficients, slopes, strict=True):
                    item.append(_coefficient(slope, k) / (k + 1))
        return coefficients

    def gradients(self, t: arb, solution: Sequence[Sequence[arb]], order: int) -> list[list[list[arb]]]:
        """Taylor coefficients of J along solutions: ``found[i][j][k]`` of s^k, k < order."""
        with cap(order):
            rows = self.jacobian(series([t, arb(1)]), [series(item[:order]) for item in solution])
            n = self.size
            return [[[_coefficient(rows[n * i + j], k) for k in range(order)] for j in range(n)] for i in range(n)]

    def jacobian_sizes(self, t: arb, solutions: Sequence[Model]) -> list[float]:
        """|J_ij|_R of the models of solutions, row by row."""
        ring = solutions[0].ring
        with cap(ring.degree + 1):
            entries = self.jacobian(model(ring, [t, arb(1)]), solutions)
            return [value.norm if isinstance(value, Model) else model(ring, [value]).norm for value in entries]
