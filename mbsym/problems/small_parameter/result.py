"""What is known of slow integral manifolds, and of periodic solutions near those of a linear system.

Of a manifold: coefficients, the flow on it, who attracts whom, what was checked.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.quotients import Quotient, Series
from mbsym.algebra.terms import grouped
from mbsym.algebra.tower import Element, Tower


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


# What is known of a periodic solution near one of a linear system: series, frequency, divisors, what was checked.


class Amplitude(Enum):
    """Whether periodic solutions are a family, or one with a certain amplitude, near those of the linear system."""

    FREE = "free"
    DETERMINED = "determined"


@dataclass(frozen=True)
class Divisor:
    """What was divided by at ``harmonic``, a wave number, in the equations of ``variables``: resonance where it is 0.

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
class Phase:
    """T' = frequency (1 + sum_n eps^n corrections[n - 1]) of an oscillation in the variables of a ``block``.

    ``leading``: the variable whose term cos T is ``amplitude`` at eps = 0 and that has no term sin T.
    """

    leading: str
    block: tuple[str, ...]
    frequency: Element
    corrections: tuple[Element, ...]
    amplitude: Element


@dataclass(frozen=True)
class Oscillation:
    """x_i = sum_n eps^n series[i][n](T), n <= order, in one phase T or several, which turn independently.

    Where an amplitude is free it is the leading variable's value at T = 0 in all orders, less ``centre``, about which
    it oscillates; where it is ``DETERMINED`` its first approximation; of several phases all are free, and each is the
    whole coefficient of cos T.  ``constants``: variables that keep their value at eps = 0, with it; it is theirs at
    T = 0 in all orders.  ``names`` are the variables in the order of ``series``; ``powers``: x stands for x eps^power.
    ``others``: variables and the square of a frequency that is left out; ``damped``, ``with_zero``, ``not_known``:
    variables with roots that are surely not imaginary, zero, or not found.
    ``residuals``: the order of eps that is left in each equation when all this is put into it (None: nothing).
    """

    tower: Tower
    small: str
    order: int
    names: tuple[str, ...]
    powers: tuple[tuple[str, int], ...]
    phases: tuple[Phase, ...]
    kind: Amplitude
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
    def leading(self) -> str:
        """Of the first phase, as the next three."""
        return self.phases[0].leading

    @property
    def frequency(self) -> Element:
        return self.phases[0].frequency

    @property
    def corrections(self) -> tuple[Element, ...]:
        return self.phases[0].corrections

    @property
    def amplitude(self) -> Element:
        return self.phases[0].amplitude

    @property
    def centre(self) -> Element:
        """The mean of the leading variable where eps is zero."""
        return self.series[self.names.index(self.leading)][0].waves.get(0, (self.tower.zero,))[0]

    @property
    def verified(self) -> bool:
        """Whether what is left is of higher order than the expansion in every equation."""
        return bool(self.residuals) and all(residual is None or residual > self.order for residual in self.residuals)


# Trigonometric polynomials of phases over the elements of a tower: sum_k C_k cos(k T) + S_k sin(k T).
#
# Of several phases the wave number is  k = k_1 + k_2 APART + k_3 APART^2 + ...  (Kronecker's substitution): sums of
# wave numbers are those of all multiples at once, so that products are those of one phase.


#: More than twice any multiple of a phase.
APART = 1 << 20


def multiples(k: int, phases: int) -> tuple[int, ...]:
    """(k_1, k_2, ...) of a wave number."""
    parts = []
    for _ in range(phases):
        part = (k + APART // 2) % APART - APART // 2
        parts.append(part)
        k = (k - part) // APART
    return tuple(parts)


def speed_of(k: int, frequencies: Sequence[Element]) -> Element:
    """k_1 w_1 + k_2 w_2 + ..."""
    first, *rest = (w * n for n, w in zip(multiples(k, len(frequencies)), frequencies, strict=True))
    return sum(rest, first)


#: k >= 0 -> (C_k, S_k); S_0 is zero.  What is zero is left out.
Waves = Mapping[int, tuple[Element, Element]]


class Harmonics:
    """sum of ``waves`` in the phase T, or in several."""

    __slots__ = ("tower", "waves")

    def __init__(self, tower: Tower, waves: Waves) -> None:
        self.tower = tower
        self.waves = {k: (c, s) for k, (c, s) in waves.items() if not (c.is_zero() and s.is_zero())}

    @classmethod
    def constant(cls, tower: Tower, value: Element) -> Harmonics:
        return cls(tower, {0: (value, tower.zero)})

    @property
    def is_zero(self) -> bool:
        return not self.waves

    def wave(self, k: int) -> tuple[Element, Element]:
        return self.waves.get(k, (self.tower.zero, self.tower.zero))

    @property
    def mean(self) -> Element:
        return self.wave(0)[0]

    @property
    def start(self) -> Element:
        """The value at T = 0."""
        return sum((c for c, _ in self.waves.values()), self.tower.zero)

    def __add__(self, other: Harmonics) -> Harmonics:
        total = dict(self.waves)
        for k, (c, s) in other.waves.items():
            total[k] = (total[k][0] + c, total[k][1] + s) if k in total else (c, s)
        return Harmonics(self.tower, total)

    def __sub__(self, other: Harmonics) -> Harmonics:
        return self + other.scaled(-self.tower.one)

    def scaled(self, factor: Element) -> Harmonics:
        return Harmonics(self.tower, {k: (c * factor, s * factor) for k, (c, s) in self.waves.items()})

    def __mul__(self, other: Harmonics) -> Harmonics:
        total: dict[int, tuple[Element, Element]] = {}
        half, zero = self.tower.number(1) / self.tower.number(2), self.tower.zero

        def add(k: int, c: Element, s: Element) -> None:
            if k < 0:
                k, s = -k, -s
            if k == 0:
                s = zero
            total[k] = (total[k][0] + c, total[k][1] + s) if k in total else (c, s)

        for m, (a, b) in self.waves.items():
            for n, (c, d) in other.waves.items():
                if m == 0 or n == 0:
                    # exact: neither product with sin(0) is there
                    add(m + n, a * c, a * d if m == 0 else b * c)
                    continue
                ac, bd, ad, bc = a * c, b * d, a * d, b * c
                add(m + n, (ac - bd) * half, (ad + bc) * half)
                add(m - n, (ac + bd) * half, (bc - ad) * half)
        return Harmonics(self.tower, total)

    def slope(self, phase: int = 0) -> Harmonics:
        """The derivative by one of the phases."""
        turns = {k: multiples(k, phase + 1)[phase] for k in self.waves}
        return Harmonics(self.tower, {k: (s * turns[k], -(c * turns[k])) for k, (c, s) in self.waves.items()})

    def integral(self, frequencies: Sequence[Element]) -> Harmonics:
        """The integral over the time, from where all phases are 0, of what has no mean.

        Raises SingularPoint where a sum of multiples of the frequencies is zero.
        """
        tower, parts = self.tower, {}
        total = tower.zero
        for k, (c, s) in self.waves.items():
            if k:
                back = tower.reciprocal(speed_of(k, frequencies))
                parts[k] = (-(s * back), c * back)
                total = total - parts[k][0]
        parts[0] = (total, tower.zero)
        return Harmonics(tower, parts)

    def mapped(self, change: Any) -> Harmonics:
        return Harmonics(self.tower, {k: (change(c), change(s)) for k, (c, s) in self.waves.items()})
