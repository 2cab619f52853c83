"""Oscillations of quasi-linear equations by Poincare's and Lindstedt's method, exactly.

    x = X_0(T) + eps X_1(T) + ...,       dT/dt = omega (1 + eps nu_1 + eps^2 nu_2 + ...),       X_n of period 2 pi in T

with one phase T, or several, each with its omega and nu.

In the order n, with G_n from lower orders, constant variables c and the others z

    omega c_n' = G_n,          omega z_n' = A z_n + G_n - omega nu_n z_0'.

The mean of G_n must vanish in the equations of c.  At the harmonic k the equations of z are (i k omega - A) Z = G;
where k omega is a frequency of the linear system they have a solution for special G only: nu_n and conditions on the
amplitude follow from the leading block at k = 1, anything else is a resonance.  Of several phases k omega is  sum_j k_j
omega_j, and each has its leading block.  (A. Nayfeh, Perturbation methods,
Wiley 1973, section 3.1; I. Malkin, Some problems in the theory of nonlinear oscillations, chapter II.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from mbsym.algebra.failures import NoClosedForm, SingularPoint
from mbsym.algebra.matrices import echelon, faddeev
from mbsym.algebra.tower import MOST_ROOTS, Element, Tower
from mbsym.expressions.message import Message
from mbsym.problems.small_parameter.generating import Generating, Mode, without_zeros
from mbsym.problems.small_parameter.result import APART, Divisor, Drift, Harmonics, multiples, speed_of


class Resonance(NoClosedForm):
    """A divisor vanishes where something is to be divided by it."""

    code = "resonance"


class NotPeriodic(NoClosedForm):
    """Secular terms cannot be removed."""

    code = "not-periodic"


class Demand(Exception):
    """``condition`` must vanish for secular terms to vanish; it holds no correction of the amplitude."""

    def __init__(self, condition: Element, order: int) -> None:
        self.condition, self.order = condition, order


@dataclass(eq=False)
class Led:
    """A phase: the ``mode`` that turns with it, the ``leading`` variable, its ``amplitude``, and nu_1, nu_2, ..."""

    system: Generating
    mode: Mode
    leading: int
    amplitude: Element
    shifts: list[Element] = field(default_factory=list)

    def __post_init__(self) -> None:
        tower = self.system.tower
        self.frequency = tower.square_root(self.mode.square)
        self.matrix = matrix = self.system.block_matrix(self.mode.block)
        adjugates = faddeev(matrix, tower.zero, tower.one)[0]
        size = len(matrix)
        real, imaginary = _at_imaginary(tower, adjugates, self.frequency)
        place = self.mode.block.index(self.leading)
        for column in range(size):
            entry = real[place][column], imaginary[place][column]
            if not (entry[0].is_zero() and entry[1].is_zero()):
                break
        else:
            raise NoClosedForm("[[name]] does not take part in this mode", name=self.system.names[self.leading])
        #: v with (i omega - A) v = 0 and v = 1 in the leading variable; l with l (i omega - A) = 0.
        self.right = [_over(tower, (real[r][column], imaginary[r][column]), entry) for r in range(size)]
        self.left = [(real[place][c], imaginary[place][c]) for c in range(size)]


@dataclass
class Orders:
    """The solution order by order; ``corrections`` are the symbols of unknown terms of the amplitude, if any."""

    system: Generating
    phases: Sequence[Led]
    constants: dict[int, Element]
    corrections: Sequence[str] = ()
    series: list[list[Harmonics]] = field(default_factory=list)
    divisors: list[Divisor] = field(default_factory=list)

    def __post_init__(self) -> None:
        tower = self.tower = self.system.tower
        self.frequencies = [led.frequency for led in self.phases]
        self.nothing = Harmonics(tower, {})
        self.products: dict[tuple[tuple[int, ...], int], Harmonics] = {}
        self._generating()

    # --- what the field is along the series ---

    def product(self, exponents: tuple[int, ...], order: int) -> Harmonics:
        """The coefficient of eps^order in a product of powers of the variables."""
        known = (exponents, order)
        if known in self.products:
            return self.products[known]
        place = next((i for i, e in enumerate(exponents) if e), None)
        if place is None:
            return Harmonics.constant(self.tower, self.tower.one) if order == 0 else self.nothing
        rest = (*exponents[:place], exponents[place] - 1, *exponents[place + 1 :])
        own, total = self.series[place], self.nothing
        if not any(rest):
            total = own[order] if order < len(own) else self.nothing
        else:
            for j in range(min(order, len(own) - 1) + 1):
                if not own[j].is_zero:
                    total = total + own[j] * self.product(rest, order - j)
        if order < self.complete:
            self.products[known] = total
        return total

    def right_side(self, i: int, order: int) -> Harmonics:
        """The coefficient of eps^order in f_i; what is not known yet of this order counts as zero."""
        total = self.nothing
        for power, terms in self.system.rows[i].items():
            if power <= order:
                for exponents, c in terms.items():
                    total = total + self.product(exponents, order - power).scaled(c)
        return total

    def forcing(self, i: int, order: int) -> Harmonics:
        total = self.right_side(i, order)
        for place, led in enumerate(self.phases):
            for j, shift in enumerate(led.shifts[:order], start=1):
                if not shift.is_zero():
                    total = total - self.series[i][order - j].slope(place).scaled(shift * led.frequency)
        return total

    # --- orders ---

    def _generating(self) -> None:
        tower, system = self.tower, self.system
        self.complete = 0
        self.series = [[self.nothing] for _ in system.names]
        for i, value in self.constants.items():
            self.series[i] = [Harmonics.constant(tower, value)]
        for block in system.blocks:
            forcing = [self.forcing(i, 0) for i in block]
            for i, harmonics in zip(block, self._answer(block, forcing, 0), strict=True):
                self.series[i][0] = harmonics
            for place, led in enumerate(self.phases):
                if block == led.mode.block:
                    for i, (c, s) in zip(block, led.right, strict=True):
                        wave = Harmonics(tower, {APART**place: (c * led.amplitude, -(s * led.amplitude))})
                        self.series[i][0] = self.series[i][0] + wave
        self.complete = 1
        self.products.clear()

    def go_on(self) -> None:
        """One order more.  Raises Demand, Resonance."""
        system, order = self.system, self.complete
        for series in self.series:
            series.append(self.nothing)
        for i in system.constant:
            slope = self.forcing(i, order)
            if not slope.mean.is_zero():
                raise Demand(slope.mean, order)
            try:
                self.series[i][order] = slope.integral(self.frequencies)
            except SingularPoint:
                raise Resonance(
                    "resonance: in the order [[order]] of the small parameter [[name]] is driven at a sum of multiples "
                    "of the frequencies that is zero",
                    order=order,
                    name=system.names[i],
                ) from None
            self._integrated(i, slope, order)
        for block in system.blocks:
            forcing = [self.forcing(i, order) for i in block]
            own = {APART**place: led for place, led in enumerate(self.phases) if block == led.mode.block}
            rest = [
                Harmonics(self.tower, {k: wave for k, wave in harmonics.waves.items() if k not in own})
                for harmonics in forcing
            ]
            answer = self._answer(block, rest, order)
            for k, led in own.items():
                answer = self._led(led, k, forcing, answer, order)
            for i, harmonics in zip(block, answer, strict=True):
                self.series[i][order] = harmonics
        self.complete = order + 1

    def _answer(self, block: tuple[int, ...], forcing: Sequence[Harmonics], order: int) -> list[Harmonics]:
        """The forced oscillations of a block."""
        oscillations: list[dict[int, Any]] = [{} for _ in block]
        for k in sorted({k for harmonics in forcing for k in harmonics.waves}):
            cosines, sines = self._at(block, [harmonics.wave(k) for harmonics in forcing], k, order)
            for place, wave in enumerate(zip(cosines, sines, strict=True)):
                oscillations[place][k] = wave
        return [Harmonics(self.tower, waves) for waves in oscillations]

    def _at(
        self, block: tuple[int, ...], forcing: Sequence[tuple[Element, Element]], k: int, order: int
    ) -> tuple[list[Element], list[Element]]:
        """k omega S = A C + F_c,  -k omega C = A S + F_s."""
        tower, size, zero = self.tower, len(block), self.tower.zero
        matrix = self.system.block_matrix(block)
        speed = speed_of(k, self.frequencies)
        if k == 0:
            right = [-c for c, _ in forcing]
            answer = solved(tower, matrix, right)
        else:
            upper = [[*row, *(-speed if i == j else zero for j in range(size))] for i, row in enumerate(matrix)]
            lower = [[*(speed if i == j else zero for j in range(size)), *row] for i, row in enumerate(matrix)]
            right = [*(-c for c, _ in forcing), *(-s for _, s in forcing)]
            answer = solved(tower, [*upper, *lower], right)
        names = tuple(self.system.names[i] for i in block)
        if answer is None:
            raise Resonance(_driven(names, k, order, len(self.phases)))
        self._divided(block, k, order, answer)
        return answer[:size], answer[size:] or [zero] * size

    def _divided(self, block: tuple[int, ...], k: int, order: int, answer: Sequence[Element]) -> None:
        """Notes chi(i k omega), chi the characteristic polynomial of a block; chi(0) without roots zero.

        Of a block that oscillates by itself, chi without lambda^2 + omega^2 at the multiples of that omega; nothing
        where no denominator of the ``answer`` shares a factor with it (oscillations that the force does not couple).
        """
        tower, names = self.tower, tuple(self.system.names[i] for i in block)
        polynomial = faddeev(self.system.block_matrix(block), tower.zero, tower.one)[1]
        turns, own = multiples(k, len(self.phases)), [led for led in self.phases if led.mode.block == block]
        for place, led in enumerate(self.phases):
            if led in own and not any((*turns[:place], *turns[place + 1 :])):
                polynomial = _without(polynomial, led.mode.square)
        speed = speed_of(k, self.frequencies)
        square = -(speed * speed)
        parts = [without_zeros(polynomial)[0]]
        if k:  # chi(i k omega) = parts[0] + i k omega parts[1], of one phase k omega != 0
            even, odd = (_at(tower, polynomial[first::2], square) for first in range(2))
            parts = [even, odd * speed if sum(map(bool, turns)) > 1 else odd]
        parts = [x for x in parts if not x.is_zero()]
        if any(divisor.variables == names and divisor.harmonic == k for divisor in self.divisors):
            return
        if not parts or any(self._is_multiple(x, len(block)) for x in parts):
            return  # of multiples of the frequency itself it is said already that they are not zero
        whole = parts[0] if len(parts) == 1 else parts[0] * parts[0] - square * parts[1] * parts[1]
        if own and _cancelled(whole, answer):
            return
        self.divisors.append(Divisor(names, k, order, *parts))

    def _integrated(self, i: int, slope: Harmonics, order: int) -> None:
        """Notes the sums of multiples of several frequencies by which an integral over the time divides."""
        for k in slope.waves:
            if sum(map(bool, multiples(k, len(self.phases)))) > 1:
                self._note(Divisor((self.system.names[i],), k, order, speed_of(k, self.frequencies)))

    def _note(self, divisor: Divisor) -> None:
        """Once of each harmonic and variables; of numbers there is nothing to say."""
        known = {(other.variables, other.harmonic) for other in self.divisors}
        if (divisor.variables, divisor.harmonic) not in known and self.tower.rational(divisor.value) is None:
            self.divisors.append(divisor)

    def _is_multiple(self, x: Element, most: int) -> bool:
        """Whether it is a number, or one times a power of an omega^2."""
        for led in self.phases:
            y = x
            for _ in range(most // 2 + 1):
                if self.tower.rational(y) is not None:
                    return True
                y = y / led.mode.square
        return False

    def _led(
        self, led: Led, k: int, forcing: Sequence[Harmonics], forced: Sequence[Harmonics], order: int
    ) -> list[Harmonics]:
        """What oscillates by itself, with the wave number k, added to what is ``forced``.

        Its frequency is corrected, its amplitude may be determined.
        """
        tower, block, size, oscillations = self.tower, led.mode.block, len(led.mode.block), list(forced)
        # l G = i omega nu a (l v), G = F_c - i F_s.
        top = bottom = (tower.zero, tower.zero)
        for l, harmonics, v in zip(led.left, forcing, led.right, strict=True):
            c, s = harmonics.wave(k)
            top = _sum(top, _times(l, (c, -s)))
            bottom = _sum(bottom, _times(l, v))
        real, imaginary = _over(tower, top, bottom)
        back = tower.reciprocal(led.amplitude)
        if not real.is_zero():
            raise Demand(real * back, order)
        shift = imaginary * tower.reciprocal(led.frequency) * back
        led.shifts.append(shift)
        # What is left has solutions; the one without the leading variable is taken.
        speed, zero, place = led.frequency, tower.zero, block.index(led.leading)
        turned = shift * speed * led.amplitude
        loads = []
        for harmonics, (c, s) in zip(forcing, led.right, strict=True):
            a, b = harmonics.wave(k)
            loads.append((a + s * turned, b + c * turned))  # - nu omega d/dT of a (c cos T - s sin T)
        others = [j for j in range(size) if j != place]
        upper = [
            [*(row[j] for j in others), *(-speed if i == j else zero for j in others)]
            for i, row in enumerate(led.matrix)
        ]
        lower = [
            [*(speed if i == j else zero for j in others), *(row[j] for j in others)]
            for i, row in enumerate(led.matrix)
        ]
        answer = solved(tower, [*upper, *lower], [*(-c for c, _ in loads), *(-s for _, s in loads)])
        if answer is None:
            raise Resonance(
                "resonance: two oscillations of [[block]] have one frequency",
                block=", ".join(self.system.names[i] for i in block),
            )
        self._divided(block, k, order, [*answer, shift])
        known = [(zero, zero)] * size
        for n, j in enumerate(others):
            known[j] = (answer[n], answer[len(others) + n])
        correction = -oscillations[place].start if len(self.phases) == 1 else zero
        if self.corrections:
            correction = tower.parameter(self.corrections[order - 1])
        for j, (c, s) in enumerate(led.right):
            wave = (known[j][0] + c * correction, known[j][1] - s * correction)
            oscillations[j] = oscillations[j] + Harmonics(tower, {k: wave})
        return oscillations

    def quadratures(self, order: int) -> list[Drift]:
        """The variables that no equation needs; those that depend on one that drifts are left out."""
        drifts: list[Drift] = []
        drifting: set[int] = set()
        for i in self.system.aside:
            held = {j for part in self.system.rows[i].values() for key in part for j, e in enumerate(key) if e}
            if held & drifting:
                drifting.add(i)
                continue
            slopes = [self.right_side(i, n) for n in range(order + 1)]
            for n, slope in enumerate(slopes):
                self._integrated(i, slope, n)
            drift = integrated(
                self.system.names[i], slopes, self.frequencies, [tuple(led.shifts[:order]) for led in self.phases]
            )
            self.series[i] = list(drift.waves)
            if any(not x.is_zero() for x in drift.rates):
                drifting.add(i)
            drifts.append(drift)
        return drifts


def integrated(
    name: str, slopes: Sequence[Harmonics], frequencies: Sequence[Element], shifts: Sequence[Sequence[Element]]
) -> Drift:
    """The integral over the time of  sum_n eps^n slopes[n](T),  T_j' = frequencies_j (1 + sum_n eps^n shifts_j[n - 1]).

    Raises SingularPoint where a sum of multiples of the frequencies is zero.
    """
    tower = frequencies[0].tower
    rates: list[Element] = []
    waves: list[Harmonics] = []
    for n, slope in enumerate(slopes):
        for place, own in enumerate(shifts):
            for j, shift in enumerate(own[:n], start=1):
                slope = slope - waves[n - j].slope(place).scaled(shift * frequencies[place])
        rates.append(slope.mean)
        rest = slope - Harmonics.constant(tower, slope.mean)
        waves.append(rest.integral(frequencies))
    return Drift(name, tuple(rates), tuple(waves))


def _driven(names: Sequence[str], k: int, order: int, phases: int) -> str:
    """Why a forced oscillation, or a forced displacement (k = 0), does not exist."""
    where = Message(
        "resonance: in the order [[order]] of the small parameter, [[names]] are driven",
        order=order,
        names=", ".join(names),
    )
    if k == 0:
        return Message(
            "[[where]] at a constant rate, and the root zero is one of theirs: these terms grow with "
            "time; solutions in which other variables keep them from that are not looked for",
            where=where,
        )
    message = Message("[[k]] times the frequency", k=k) if k > 1 else Message("the frequency")
    if phases > 1:
        message = Message(
            "the sum of the multiples [[turns]] of the frequencies", turns=", ".join(map(str, multiples(k, phases)))
        )
    return Message(
        "[[where]] at [[told]], which is a frequency of their own: secular terms are not removed; "
        "solutions in which these oscillate by themselves from the beginning are not looked for",
        where=where,
        told=message,
    )


Pair = tuple[Element, Element]


def _without(polynomial: Sequence[Element], square: Element) -> list[Element]:
    """The quotient by lambda^2 + square, of which it is a multiple; coefficients from low to high."""
    elements: list[Element] = []
    for k, c in enumerate(reversed(polynomial[2:])):
        elements.append(c - square * elements[k - 2] if k > 1 else c)
    return elements[::-1]


def _at(tower: Any, polynomial: Sequence[Element], x: Element) -> Element:
    total: Element = tower.zero
    for c in reversed(polynomial):
        total = total * x + c
    return total


def _cancelled(value: Element, answer: Sequence[Element]) -> bool:
    """Whether surely nothing of ``value`` is left in denominators; of one with square roots there is no telling."""
    if all(x.is_zero() for x in answer):
        return True
    if any(d > 0 for p in (value.top, *(x.bottom for x in answer)) for d in p.degrees()[:MOST_ROOTS]):
        return False
    return all(value.top.gcd(x.bottom).is_constant() for x in answer)


def _at_imaginary(tower: Any, adjugates: Sequence[Any], speed: Element) -> tuple[Any, Any]:
    """adj(i omega - A) = sum_k (i omega)^(m - 1 - k) adjugates[k], real and imaginary parts."""
    size = len(adjugates[0])
    parts = [[[tower.zero] * size for _ in range(size)] for _ in range(2)]
    power, signs = tower.one, (1, 1, -1, -1)
    for k, adjugate in enumerate(reversed(adjugates)):
        for r in range(size):
            for c in range(size):
                parts[k % 2][r][c] = parts[k % 2][r][c] + adjugate[r][c] * power * signs[k % 4]
        power = power * speed
    return parts[0], parts[1]


def _times(a: Pair, b: Pair) -> Pair:
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def _sum(a: Pair, b: Pair) -> Pair:
    return a[0] + b[0], a[1] + b[1]


def _over(tower: Any, a: Pair, b: Pair) -> Pair:
    back = tower.reciprocal(b[0] * b[0] + b[1] * b[1])
    real, imaginary = _times(a, (b[0], -b[1]))
    return real * back, imaginary * back


def solved(tower: Tower, rows: Sequence[Sequence[Element]], right: Sequence[Element]) -> list[Element] | None:
    """x with rows x = right, free unknowns zero; None where there is none."""
    work = [[*row, value] for row, value in zip(rows, right, strict=True)]
    count = len(rows[0]) if rows else 0
    work, pivots = echelon(tower, work, count, lambda x: None if x.is_zero() else len(x.top) + len(x.bottom))
    if any(not row[-1].is_zero() for row in work[len(pivots) :]):
        return None
    elements = [tower.zero] * count
    for place, column in enumerate(pivots):
        elements[column] = work[place][-1]
    return elements
