"""The tree that a formula is shown as: sums, products and powers of generators, waves and brackets.

Printers walk it; ``shape`` makes it.  How angles stand in it is asked for once around all that is written.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, Literal, NamedTuple

from mbsym.formulas.numerals import writable

Rational = Any  # flint.fmpq

#: Sines and cosines as products of those of single angles, as waves of sums of angles, or what is shorter to read.
Angles = Literal["products", "sums", "shorter"]


class Wave(NamedTuple):
    """sin or cos (``kind`` sine or cosine) of ``q1 + 2*q2 - q3/2``: (name, coefficient) in reading order."""

    kind: str
    angle: tuple[tuple[str, Fraction], ...]


class Factor(NamedTuple):
    """``base ** exponent``; the base is the number of a generator (never a reciprocal), a wave or a sum."""

    base: int | Wave | Sum
    exponent: int = 1


class Product(NamedTuple):
    """coefficient * (product of ``over``) / (product of ``under``)."""

    coefficient: Rational
    over: tuple[Factor, ...] = ()
    under: tuple[Factor, ...] = ()

    @property
    def magnitude(self) -> tuple[int, int]:
        """|coefficient| as numerator and denominator.  Raises NoClosedForm where one of them is too long to write."""
        top, bottom = abs(int(self.coefficient.p)), int(self.coefficient.q)
        writable(top, bottom)
        return top, bottom


@dataclass(frozen=True, eq=False)
class Sum:
    """The sum of the terms; zero is the empty sum.  Equal brackets of one ring are mostly one object."""

    terms: tuple[Product, ...]

    @cached_property
    def leaves(self) -> int:
        """How many symbols and numbers a reader meets."""
        return sum([_leaves(term) for term in self.terms])


def leaves(shape: Sum) -> int:
    """How many symbols and numbers a reader meets."""
    return shape.leaves


def _leaves(product: Product) -> int:
    total = abs(product.coefficient) != 1
    for base, _ in product.over:
        total += base.leaves if isinstance(base, Sum) else 1
    for base, _ in product.under:
        total += base.leaves if isinstance(base, Sum) else 1
    return total or 1


_ASKED: ContextVar[Angles | None] = ContextVar("angles", default=None)


@contextmanager
def angles_as(choice: Angles | None) -> Iterator[None]:
    """Within this block every formula that is written has its angles so; None leaves it to each kind of text."""
    token = _ASKED.set(choice)
    try:
        yield
    finally:
        _ASKED.reset(token)


def angles_or(usual: Angles) -> Angles:
    """What was asked for, else what a kind of text usually has."""
    return _ASKED.get() or usual
