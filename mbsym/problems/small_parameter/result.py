"""What is known of a slow integral manifold: coefficients, the flow on it, who attracts whom, what was checked."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from mbsym.algebra.quotients import Series
from mbsym.problems.small_parameter.scaled import ScaledField


class Outcome(Enum):
    """Of a Hurwitz condition for all sufficiently small eps > 0."""

    HOLDS = "holds"
    FAILS = "fails"
    CONDITIONAL = "conditional"
    UNDECIDED = "undecided"


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
        return all(one.lowest is not None for one in self.minors)

    @property
    def bounded(self) -> bool:
        """Whether a root is seen to stay bounded as eps -> +0.

        All roots grow where every side of Newton's polygon falls: where the last coefficient begins with a lower power
        of eps than all before it.
        """
        *before, last = (one.lowest for one in self.polynomial)
        return last is not None and any(k is not None and k <= last for k in before)


@dataclass(frozen=True)
class SteadyStates:
    """The first approximation about a steady state on the manifold.

    det(S - A) = S^zeros slow(S) fast(S); ``remainder``: the order of eps to which slow(S) is seen to divide it.
    """

    zeros: int
    slow: Hurwitz
    fast: Hurwitz
    remainder: int


@dataclass(frozen=True)
class SlowManifold:
    """z = h(s, eps) = sum_k h_k(s) eps^k, k <= order, with s' = flow(s, eps) on it.

    ``functions``: h by name of the fast variables; ``flow`` by name of the slow ones; ``residuals``: for each fast
    variable the order of eps that is left when h, cut off, is put into the equations exactly (None: nothing is left).
    """

    field: ScaledField
    order: int
    fast: tuple[str, ...]
    slow: tuple[str, ...]
    functions: tuple[Series, ...]
    flow: tuple[Series, ...]
    residuals: tuple[int | None, ...]
    steady: SteadyStates | None = None

    @property
    def verified(self) -> bool:
        """Whether what is left is of higher order than the expansion in every equation."""
        return all(one is None or one > self.order for one in self.residuals)
