"""A right-hand side f(t, x) and its Jacobian over whatever has arithmetic: balls, series of balls, models on a disc.

Balls enclose the values over all points that they contain.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from flint import arb, arb_series, ctx

from mbsym.numerics.enclosure.model import Model, model
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.kernels.precise import written


class NotAnalytic(Exception):
    """A function in the equations without a power series; its name."""


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
        found = [[value] for value in y]
        for k in range(order):
            with cap(k + 1):
                slopes = self.rates(series([t, arb(1)]), [series(item) for item in found])
                for item, slope in zip(found, slopes, strict=True):
                    item.append(_coefficient(slope, k) / (k + 1))
        return found

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
            found = self.jacobian(model(ring, [t, arb(1)]), solutions)
            return [value.norm if isinstance(value, Model) else model(ring, [value]).norm for value in found]
