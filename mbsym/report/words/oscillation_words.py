"""What is said of a periodic solution in powers of a small parameter."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

from mbsym.algebra.tower import Element
from mbsym.expressions.message import worded
from mbsym.expressions.rates import without_velocity
from mbsym.formulas.formula import Formula
from mbsym.problems.small_parameter.result import Amplitude, Harmonics, multiples
from mbsym.report.content import (
    Definitions,
    Gaps,
    Listed,
    Math,
    Name,
    Notation,
    Phrase,
    Raised,
    Relation,
    Said,
    named,
    say,
)
from mbsym.report.words.expansion_measured import SLACK, VALID
from mbsym.report.words.expansion_words import Coefficient, Sums, scaled, summed

if TYPE_CHECKING:
    from mbsym.analysis.oscillating import Oscillating
    from mbsym.simulation.oscillating import MeasuredOrders

FIGURE = "[[system]]: series to order [[order]] at [[small]] = [[value]], and the motion"
NO_ANGLES = "(no angles: [[why]])"
SERIES_LINE, MOTION_LINE = "series", "motion (simulation)"
DRIFTS = "What no equation needs follows by integration, but for its initial value ($t$: the time):"

_SERIES = (
    "Periodic solution up to order [[order]] of [[small]], led by [[leading]]: all variables as functions of "
    "[[phase]], and the rate of it. The coefficient of the power $k$ of [[small]] has the index $(k)$."
)
_SEVERAL = (
    "Oscillation with the phases [[phases]] up to order [[order]] of [[small]], led by [[leading]]: all variables as "
    "functions of the phases, and the rates of these. The coefficient of the power $k$ of [[small]] has the index "
    "$(k)$."
)
_DEVIATING = "[[names]]: here deviations from the unperturbed motion."
_ALL_FREE = (
    "Secular terms are removed up to this order with any amplitudes. Here [[amplitudes]] are what stands before the "
    "cosines of the phases in [[leading]], where their sines do not stand."
)
_QUASIPERIODIC = (
    "Sums of multiples of the frequencies are divided by. Whether there is such a motion, or only one near it for a "
    "long time, is not looked at: the series are formal."
)
_FREE = (
    "Secular terms are removed up to this order with any amplitude. Here it is [[amplitude]], the value of [[leading]] "
    "at the phase 0, where it has no term [[sine]]."
)
_FREE_ABOUT = (
    "Secular terms are removed up to this order with any amplitude. Here it is [[amplitude]]: at the phase 0, where "
    "[[leading]] has no term [[sine]], it is [[value]]."
)
_FORMAL = (
    "Whether some remain in higher orders, so that there is no such periodic motion, is not looked at: it is periodic "
    "up to this order."
)
_OTHER_AMPLITUDES = "Other amplitudes are left out, at which they are removed, too: those of [[condition]], where real."
_DETERMINED = (
    "Secular terms are removed for certain amplitudes only. That of this solution: in first approximation [[leading]] "
    "is [[value]]."
)
_REAL_AMPLITUDE = "The amplitude is real and not zero where [[condition]]."
_CONSTANTS = "[[names]]: the values of [[variables]] at the phase 0, which are constant where $[[small]] = 0$."
_LEFT = (
    "Put into the equations at random rational parameters, it leaves terms of order [[left]] of [[small]] (verified)."
)
_NOTHING = "Put into the equations at random rational parameters, it leaves nothing (verified)."
_TAYLOR = (
    "Of the equations, terms up to degree [[degree]] in the deviations were taken; the others are of higher order."
)
_LEFT_OF_TAYLOR = (
    "Put into the equations cut off so, at random rational parameters, it leaves terms of order [[left]] of [[small]] "
    "(verified)."
)
_NOTHING_OF_TAYLOR = (
    "Put into the equations cut off so, at random rational parameters, it leaves nothing (verified); of those that are "
    "not cut off it may leave terms of order [[next]] of [[small]]."
)
_EXPONENT = {
    True: "Poincare's exponent of this cycle is [[exponent]] times the power [[power]] of [[small]] in the lowest "
    "order: for all sufficiently small [[small]] > 0 it is asymptotically orbitally stable.",
    False: "Poincare's exponent of this cycle is [[exponent]] times the power [[power]] of [[small]] in the lowest "
    "order: for all sufficiently small [[small]] > 0 it is unstable.",
    None: "Poincare's exponent of this cycle is [[exponent]] times the power [[power]] of [[small]] in the lowest "
    "order: for all sufficiently small [[small]] > 0 it is asymptotically orbitally stable where that is negative, "
    "unstable where it is positive.",
}
_REAL = "The frequency without [[small]] is real and not zero where [[condition]]."
_NONZERO = "It holds where the frequency without [[small]] is not zero: [[condition]]."
_RESONANCE = (
    "Resonance, and in general no such solution, where [[condition]] (harmonic [[harmonic]], order [[order]], of "
    "[[names]])."
)
_BOTH = (
    "Resonance, and in general no such solution, where [[condition]] and [[other]] (harmonic [[harmonic]], order "
    "[[order]], of [[names]])."
)
_OTHERS = "Free oscillations of [[names]], whose frequency has the square [[square]], are left out."
_DAMPED = (
    "Without [[small]], roots of [[names]] are not all imaginary: free motions that belong to the others are left out."
)
_ZERO = "Without [[small]], [[names]] have the root zero: free displacements and drifts that belong to it are left out."
_NOT_KNOWN = (
    "Without [[small]], not all roots of [[names]] were found: free motions that belong to the others are left out."
)
_MEASURED = (
    "Measured at the given numbers, over one period, against motions that begin in the same state: with [[small]] "
    "halved from [[from]] to [[to]] the errors fall like its powers [[orders]] (not proved)."
)
_ROUNDING = (
    "Measured at the given numbers, over one period, against motions that begin in the same state: with [[small]] = "
    "[[to]] the errors of [[names]] are no more than rounding."
)
_VALID = (
    "Over one period it stays within [[error]] of each variable's largest value with [[small]] = [[given]], as given "
    "(measured)."
)
_VALID_UP_TO = (
    "Over one period it stays within 1 % of each variable's largest value up to [[small]] = [[bound]], of the values "
    "that were tried, not with [[given]], as given (measured)."
)
_NOWHERE_VALID = (
    "Over one period it is not within 1 % of each variable's largest value with [[small]] = [[bound]], the smallest "
    "value that was tried (measured)."
)
_UNMOVED = "Not counted in this are variables that it sets to zero to this order: [[names]]."
_EXPECTED = "[[expected]] or more is expected of a right solution to this order, where [[small]] is small enough."
_TOO_SLOW = (
    "The errors of [[names]] fall more slowly than expected: [[small]] is too large there, or something is wrong."
)
_NOT_MEASURED = "The error of this solution was not measured: [[why]]."
_NONE = "No periodic solution was expanded in powers of [[small]]: [[why]]."
_NOT_ASKED = "Periodic solutions in powers of [[small]] are looked for by mbsym oscillations."


def opening(solution: Oscillating) -> Iterator[Said]:
    """What is expanded in what."""
    oscillation = solution.oscillation
    if solution.deviating:
        yield say(_DEVIATING, names=named(solution.deviating))
    yield from scaled(oscillation.powers, oscillation.small)
    yield Said(_SERIES if len(solution.phases) == 1 else _SEVERAL, _values(solution))


def coefficients(solution: Oscillating) -> Iterator[Coefficient]:
    """Of all variables, then of the rate of the phase; those that are zero are left out."""
    return _coefficients(solution, solution.wave, solution.formula)


def _coefficients(
    solution: Oscillating, wave: Callable[[Harmonics], Any], rate: Callable[[Element], Any]
) -> Iterator[Coefficient]:
    oscillation = solution.oscillation
    for name, series in zip(oscillation.names, oscillation.series, strict=True):
        plain = without_velocity(name) if name in solution.velocities else name
        for order, harmonics in enumerate(series):
            if not harmonics.is_zero:
                yield Coefficient(plain, plain != name, order, wave(harmonics))
    for phase, order, x in _rates(solution):
        yield Coefficient(phase, True, order, rate(x))


def _rates(solution: Oscillating) -> Iterator[tuple[str, int, Element]]:
    """Coefficients of the rates of the phases, but those that are zero."""
    for name, phase in zip(solution.phases, solution.oscillation.phases, strict=True):
        for order, x in enumerate((solution.oscillation.tower.one, *phase.corrections)):
            if not x.is_zero():
                yield name, order, phase.frequency * x


def as_function(solution: Oscillating) -> Sums:
    """The solution as a function of the time."""
    return summed(
        "periodic_solution",
        solution.oscillation.small,
        coefficients(solution),
        solution.oscillation.powers,
        solution.phase,
    )


def collected(solution: Oscillating) -> Iterator[Relation]:
    """The same for people: factors that divide several coefficients have letters (``denominators``)."""

    def constant(x: Element) -> Any:
        return solution.shortest(Harmonics.constant(solution.oscillation.tower, x))

    return (each.equation for each in _coefficients(solution, solution.shortest, constant))


def denominators(solution: Oscillating, equations: Iterable[Relation]) -> Definitions | None:
    """What the letters in the equations stand for."""
    tower, ring = solution.oscillation.tower, solution.told_ring
    parts = [
        x for row in equations for part in row.parts for x in (part.items if isinstance(part, Listed) else (part,))
    ]
    formulas = [x.polynomial for x in parts if isinstance(x, Formula) and x.ring is ring]
    held = {ring.generators[k].name for k in ring.held(formulas)}
    made = [
        (name, tower.made(factor, tower.context.constant(1))) for factor, name in solution.denominators if name in held
    ]
    items = tuple(Relation(Name(name, ring=ring), "=", solution.formula(x)) for name, x in made)
    return Definitions(Said("with"), items) if items else None


def drifting(solution: Oscillating) -> Iterator[Relation]:
    """Coefficients of variables that follow by integration: a rate times t, and what is periodic."""
    for drift in solution.oscillation.drifts:
        plain = without_velocity(drift.variable) if drift.variable in solution.velocities else drift.variable
        for order, (rate, wave) in enumerate(zip_longest(drift.rates, drift.waves)):
            parts: list[Math | str] = []
            if rate is not None and not rate.is_zero():
                parts += [
                    Notation("t"),
                    Listed((solution.shortest(Harmonics.constant(solution.oscillation.tower, rate)),), brackets=True),
                ]
            if wave is not None and not wave.is_zero:
                parts += [*(["+"] if parts else []), solution.shortest(wave)]
            if parts:
                yield Relation(Raised(Name(plain, int(plain != drift.variable)), order), "=", *parts)


def sentences(solution: Oscillating) -> Iterator[Said]:
    """What kind of solution it is, what was checked and where it holds."""
    series, values = solution.oscillation, _values(solution)
    least = [residual for residual in series.residuals if residual is not None]
    if len(series.phases) > 1:
        yield say(_ALL_FREE, **values, amplitudes=tuple(solution.formula(phase.amplitude) for phase in series.phases))
        if least or solution.taylor:
            yield Said(_QUASIPERIODIC)
    elif series.kind is Amplitude.FREE:
        gaps: Gaps = {**values, "amplitude": solution.formula(series.amplitude), "sine": _wave(solution, False)}
        if series.centre.is_zero():
            yield Said(_FREE, gaps)
        else:
            yield Said(_FREE_ABOUT, gaps | {"value": solution.formula(series.amplitude + series.centre)})
        if least or solution.taylor:  # else it is a solution
            yield Said(_FORMAL)
    else:
        yield say(_DETERMINED, **values, value=_wave(solution, True))
        if not solution.real_amplitude:
            square = solution.formula(series.amplitude * series.amplitude)
            yield say(_REAL_AMPLITUDE, condition=Relation(square, ">", 0))
        if series.other_amplitudes is not None:
            yield say(_OTHER_AMPLITUDES, condition=Relation(solution.formula(series.other_amplitudes), "=", 0))
    if series.exponent is not None:
        power, x = series.exponent
        yield say(_EXPONENT[solution.attracts], **values, exponent=solution.formula(x), power=str(power))
    if series.constants:
        names = tuple(solution.formula(x) for _, x in series.constants)
        yield say(_CONSTANTS, **values, names=names, variables=named(name for name, _ in series.constants))
    left = values | {"left": str(min(least, default="")), "next": str(series.order + 1)}
    if solution.taylor:
        yield say(_TAYLOR, degree=str(series.order + 1))
        yield Said(_LEFT_OF_TAYLOR if least else _NOTHING_OF_TAYLOR, left)
    else:
        yield Said(_LEFT if least else _NOTHING, left)
    for frequency in (phase.frequency for phase in series.phases if not solution.real):
        rooted = any(d > 0 for d in frequency.top.degrees()[: -len(series.tower.parameters)])
        real = Relation(solution.formula(frequency * frequency), ">", 0)
        nonzero = Relation(solution.formula(frequency), "!=", 0)
        yield say(_REAL, **values, condition=real) if rooted else say(_NONZERO, **values, condition=nonzero)
    for divisor in solution.resonances:
        zeros = (Relation(numerator(solution, x), "=", 0) for x in divisor.parts)
        turns = ", ".join(map(str, multiples(divisor.harmonic, len(series.phases))))
        gaps = {"harmonic": turns, "order": str(divisor.order), "names": named(divisor.variables)}
        gaps |= dict(zip(("condition", "other"), zeros, strict=False))
        yield Said(_RESONANCE if divisor.damping is None else _BOTH, gaps)
    for group, other in series.others:
        yield say(_OTHERS, names=named(group), square=solution.formula(other))
    for sentence, groups in ((_DAMPED, series.damped), (_ZERO, series.with_zero), (_NOT_KNOWN, series.not_known)):
        for group in groups:
            yield Said(sentence, values | {"names": named(group)})


def _values(solution: Oscillating) -> Gaps:
    oscillation = solution.oscillation
    leading = named(phase.leading for phase in oscillation.phases)
    phases: Gaps = {"phase": Name(solution.phase), "phases": named(solution.phases)}
    return {"order": str(oscillation.order), "small": Name(oscillation.small), "leading": leading, **phases}


def _wave(solution: Oscillating, whole: bool) -> Formula:
    """The amplitude times the cosine of the phase, about its centre; or its sine."""
    series = solution.oscillation
    zero, one = series.tower.zero, series.tower.one
    waves = {0: (series.centre, zero), 1: (series.amplitude, zero)} if whole else {1: (zero, one)}
    return solution.wave(Harmonics(series.tower, waves))


def numerator(solution: Oscillating, value: Element) -> Formula:
    """What has to vanish for a quotient to vanish, without a number as a factor."""
    tower = solution.oscillation.tower
    return solution.formula(tower.made(value.top / abs(value.top.factor()[0]), tower.context.constant(1)))


def measured_sentences(solution: Oscillating, measured: MeasuredOrders | str) -> Iterator[Said]:
    """The slopes, and whether they are what they have to be; or why there are none."""
    if isinstance(measured, str):
        yield say(_NOT_MEASURED, why=worded(measured))
        return
    expected = solution.oscillation.order + 1
    values: Gaps = {"small": Name(solution.oscillation.small), "expected": str(expected)}
    rows = tuple(zip(measured.names, measured.orders, measured.halved, strict=True))
    at = [f"{measured.small * float(part):.3g}" for part in measured.parts]
    beyond = [k for k, error in enumerate(measured.relative) if error > VALID]
    within = beyond[-1] + 1 if beyond else 0
    if measured.relative[0] <= VALID:
        yield say(_VALID, **values, given=at[0], error=_percent(measured.relative[0]))
    elif within == len(at):
        yield say(_NOWHERE_VALID, **values, bound=at[-1])
    else:
        yield say(_VALID_UP_TO, **values, given=at[0], bound=at[within])
    if measured.unmoved:
        yield say(_UNMOVED, names=named(measured.unmoved))
    if rounding := tuple(name for name, order, _ in rows if order is None):
        yield say(_ROUNDING, **values, to=at[-1], names=named(rounding))
    for place in sorted({k for _, order, k in rows if order is not None}):
        orders = tuple(
            Phrase((f"{order:.2f} (", Name(name), ")")) for name, order, k in rows if order is not None and k == place
        )
        yield say(_MEASURED, **values, **{"from": at[place], "to": at[place + 1]}, orders=orders)
    if len(rounding) < len(rows):
        yield Said(_EXPECTED, values)
    late = [name for name, order, _ in rows if order is not None and order < expected - SLACK]
    if late:
        yield say(_TOO_SLOW, **values, names=named(late))


def _percent(part: float) -> str:
    """A part of a whole in per cent, rounded up to two digits."""
    shown = float(f"{part * 100:.1e}")
    return f"{shown if shown >= part * 100 else float(f'{part * 105:.1e}'):g} %"


def of_no_oscillation(small: str, reason: str) -> Iterator[Said]:
    """Where none was found, or none was asked for."""
    if reason:
        yield say(_NONE, small=Name(small), why=worded(reason))
    else:
        yield say(_NOT_ASKED, small=Name(small))
