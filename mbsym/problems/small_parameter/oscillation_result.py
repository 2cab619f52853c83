"""What is known of a periodic solution near one of a linear system: series, frequency, divisors, what was checked."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from mbsym.algebra.tower import Element, Tower
from mbsym.problems.small_parameter.harmonics import Harmonics


class Amplitude(Enum):
    """Whether periodic solutions are a family, or one with a certain amplitude, near those of the linear system."""

    FREE = "free"
    DETERMINED = "determined"


@dataclass(frozen=True)
class Divisor:
    """What was divided by at ``harmonic`` in the equations of ``variables``: resonance where it vanishes.

    With damping that is ``value`` + i k omega ``damping``: resonance where both vanish.
    """

    variables: tuple[str, ...]
    harmonic: int
    order: int
    value: Element
    damping: Element | None = None

    @property
    def parts(self) -> tuple[Element, ...]:
        return (self.value,) if self.damping is None else (self.value, self.damping)


@dataclass(frozen=True)
class Drift:
    """A variable that no equation needs: x = x(0) + sum_n eps^n (rates[n] t + waves[n](T))."""

    variable: str
    rates: tuple[Element, ...]
    waves: tuple[Harmonics, ...]


@dataclass(frozen=True)
class Oscillation:
    """x_i = sum_n eps^n series[i][n](T), n <= order, T' = frequency (1 + sum_n eps^n corrections[n - 1]).

    ``leading``: the variable whose term cos T is ``amplitude`` at eps = 0 and that has no term sin T.  Where the
    amplitude is free it is the variable's value at T = 0 in all orders, where it is ``DETERMINED`` its first
    approximation; ``constants``: variables that keep their value at eps = 0, with it; it is theirs at T = 0 in all
    orders.  ``names`` are the variables in the order of ``series``; ``powers``: x stands for x eps^power.
    ``others``: variables and the square of a frequency that is left out; ``damped``, ``with_zero``, ``not_known``:
    variables with roots that are surely not imaginary, zero, or not found.
    ``residuals``: the order of eps that is left in each equation when all this is put into it (None: nothing).
    """

    tower: Tower
    small: str
    order: int
    names: tuple[str, ...]
    powers: tuple[tuple[str, int], ...]
    leading: str
    block: tuple[str, ...]
    frequency: Element
    corrections: tuple[Element, ...]
    kind: Amplitude
    amplitude: Element
    constants: tuple[tuple[str, Element], ...]
    series: tuple[tuple[Harmonics, ...], ...]
    drifts: tuple[Drift, ...]
    divisors: tuple[Divisor, ...]
    others: tuple[tuple[tuple[str, ...], Element], ...]
    damped: tuple[tuple[str, ...], ...]
    with_zero: tuple[tuple[str, ...], ...] = ()
    not_known: tuple[tuple[str, ...], ...] = ()
    residuals: tuple[int | None, ...] = ()
    #: What is zero for other amplitudes at which secular terms are removed, too; in the symbol of the amplitude.
    other_amplitudes: Element | None = None
    #: Of a single cycle in a plane: (m, c), so that motions near it come closer or part like exp(c eps^m t).
    exponent: tuple[int, Element] | None = None

    @property
    def verified(self) -> bool:
        """Whether what is left is of higher order than the expansion in every equation."""
        return bool(self.residuals) and all(one is None or one > self.order for one in self.residuals)
