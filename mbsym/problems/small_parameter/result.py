"""What is known of a slow integral manifold: coefficients, the flow on it, who attracts whom, what was checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.quotients import Quotient, Series
from mbsym.algebra.terms import grouped


class Outcome(Enum):
    """Of a Hurwitz condition for all sufficiently small eps > 0."""

    HOLDS = "holds"
    FAILS = "fails"
    CONDITIONAL = "conditional"
    UNDECIDED = "undecided"


class Choice(Enum):
    """Which root of the lowest order an expansion begins at."""

    ONLY = "only"
    ON_MOTION = "on the motion"
    ATTRACTING = "attracting"
    FIRST = "first"


@dataclass(frozen=True)
class Hurwitz:
    """Conditions under which a monic polynomial has roots with negative real parts alone, as eps -> +0.

    ``polynomial``: its coefficients from S^n down, series in eps; ``minors``: the leading minors of Hurwitz's matrix
    D_1, ..., D_n, of which only the first coefficients that are not zero count.
    """

    polynomial: tuple[Series, ...]
    minors: tuple[Series, ...]

    @property
    def decided(self) -> bool:
        """Whether a coefficient of every minor is known that is not zero."""
        return all(minor.lowest is not None for minor in self.minors)

    @property
    def bounded(self) -> bool:
        """Whether a root is seen to stay bounded as eps -> +0.

        All roots grow where every side of Newton's polygon falls: where the last coefficient begins with a lower power
        of eps than all before it.
        """
        *before, last = (series.lowest for series in self.polynomial)
        return last is not None and any(k is not None and k <= last for k in before)


@dataclass(frozen=True)
class SteadyStates:
    """The first approximation about a steady state on the manifold.

    det(S - A) = S^zeros slow(S) fast(S); ``remainder``: the order of eps to which slow(S) is seen to divide it.

    ``free``: variables that may have any values while the others keep theirs, where every such state is steady and
    they are as many as roots are zero: a set Omega of steady states.  Empty where none is seen.  By Lyapunov and Malkin
    Omega is then asymptotically stable with respect to the other variables, and stabilizable, where all roots but the
    zero ones have negative real parts: disturbed motions tend to points of Omega (V. V. Rumyantsev, A. S. Oziraner,
    Stability and stabilization of motion with respect to a part of the variables, 1987).
    """

    zeros: int
    slow: Hurwitz
    fast: Hurwitz
    remainder: int
    free: tuple[str, ...] = ()


@dataclass(frozen=True)
class Adjoined:
    """rho = sqrt(``square``) under the name ``label`` at ``place``, where the generator ``instead`` stood before.

    ``square`` is over the context without rho, ``value`` what ``instead`` is in that with rho.
    """

    label: str
    place: int
    instead: str
    square: Polynomial
    value: Quotient


@dataclass(frozen=True)
class SlowManifold:
    """z = h(s, eps) = sum_k h_k(s) eps^k, k <= order, with s' = flow(s, eps) on it.

    ``functions``: h by name of the fast variables; ``flow`` by name of the slow ones; ``residuals``: for each fast
    variable the order of eps that is left when h, cut off, is put into the equations exactly (None: nothing is left).
    ``root``: the square root in the coefficients, which ``field`` holds as one of its generators.
    """

    field: ScaledField
    order: int
    fast: tuple[str, ...]
    slow: tuple[str, ...]
    functions: tuple[Series, ...]
    flow: tuple[Series, ...]
    residuals: tuple[int | None, ...]
    steady: SteadyStates | None = None
    root: Adjoined | None = None

    @property
    def verified(self) -> bool:
        """Whether what is left is of higher order than the expansion in every equation."""
        return all(residual is None or residual > self.order for residual in self.residuals)


# A polynomial field sorted by powers of a small parameter.


Polynomial = Any  # a flint.fmpq_mpoly: python-flint carries no types
#: Exponent of eps -> coefficient; none is zero.
Graded = Mapping[int, Polynomial]


@dataclass(frozen=True)
class ScaledField:
    """x'_i = (sum_k rows[i][k] eps^k) / (sum_k denominator[k] eps^k), over the context of ``field``.

    ``powers``: every parameter P in it stands for P eps^power.  The small parameter itself, where it is one of the
    parameters, occurs in no coefficient.  The lowest exponent of the denominator is 0.
    """

    field: PolynomialField
    small: str
    powers: tuple[tuple[str, int], ...]
    rows: tuple[Graded, ...]
    denominator: Graded

    @property
    def scales(self) -> tuple[int, ...]:
        """k_i for which eps^k_i x'_i is regular at eps = 0 and not zero there; negative for what moves slowly."""
        return tuple(-min(row, default=0) for row in self.rows)


def scaled(field: PolynomialField, small: str, powers: Mapping[str, int]) -> ScaledField:
    """The field with P eps^power in place of parameters P; without ``powers`` the small parameter is one of them."""
    names = tuple(field.context.names())
    weights = [0] * len(names)
    if small in names:
        weights[names.index(small)] = 1
    for name, power in powers.items():
        if name in names:
            weights[names.index(name)] = power
    own = [names.index(small)] if small in names else []

    def graded(p: Polynomial) -> dict[int, Polynomial]:
        return grouped(p, lambda m: sum(weights[k] * int(e) for k, e in enumerate(m) if e), own)

    denominator = graded(field.denominator)
    least = min(denominator)
    return ScaledField(
        field,
        small,
        tuple(powers.items()),
        tuple({k - least: p for k, p in graded(row).items()} for row in field.numerators),
        {k - least: p for k, p in denominator.items()},
    )
