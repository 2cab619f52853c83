"""Roots of polynomials in balls (Arb): made sharp, divided out, and their ends as rational numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from flint import acb, arb, fmpq

from mbsym.algebra.plane.numbers import Ball, Rational

#: Steps of Newton's method; it squares its error.
MOST_STEPS = 60


def ends(ball: Ball) -> tuple[Rational, Rational]:
    """Rational numbers that enclose a ball."""

    def rational(x: Any) -> Rational:
        mantissa, exponent = x.man_exp()
        return fmpq(int(mantissa)) * fmpq(2) ** int(exponent)

    return rational(arb(ball).lower()), rational(arb(ball).upper())


def sharpened(p: Any, slope: Any, ball: Any) -> Any:
    """A ball as small as the working precision allows around the only root of p in a ball, a simple one.

    Newton's method, whose end z is a guess; the disc about z of radius n |p(z)/p'(z)|, n the degree, holds a root of p,
    and is the answer if it lies in the ball.
    """
    z, last = _middle(ball), None
    for _ in range(MOST_STEPS):
        step = p(z) / slope(z)
        size = abs(step).upper()
        if not step.is_finite() or (last is not None and not size < last):
            break
        z, last = _middle(z - step), size
    radius = abs(p(z) / slope(z)).upper() * p.degree()
    if not radius.is_finite():
        return ball
    real, imaginary = (x + arb(0, radius) for x in (z.real, z.imag))
    return acb(real, imaginary) if ball.real.contains(real) and ball.imag.contains(imaginary) else ball


def _middle(ball: Any) -> Any:
    return acb(ball.real.mid(), ball.imag.mid())


def deflated(coefficients: Sequence[Ball], root: Ball) -> list[Ball]:
    """The quotient by (y - root), in balls; coefficients from low to high powers."""
    quotient: list[Ball] = []
    carried = acb(0)
    for c in reversed(coefficients[1:]):
        carried = carried * root + c
        quotient.append(carried)
    return quotient[::-1]
