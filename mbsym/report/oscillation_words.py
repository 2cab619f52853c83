"""What is said of a periodic solution in powers of a small parameter: sentences with gaps, filled by whoever writes."""

from __future__ import annotations

from collections.abc import Iterator

from mbsym.algebra.tower import Element
from mbsym.analysis.oscillating import Oscillating
from mbsym.formulas.formula import Formula
from mbsym.problems.small_parameter.oscillation_result import Amplitude
from mbsym.report.said import Said
from mbsym.simulation.oscillating import MeasuredOrders

SOLUTION = "Periodic solution up to order [[order]] of [[small]], led by [[leading]]"
RATE = "The rate of the phase"
DRIFTS = "Variables that no equation needs, but for their initial values"

_FREE = (
    "Secular terms are removed up to this order with any [[amplitude]]: the value of [[leading]] at the phase 0, where "
    "it has no term sin([[phase]])."
)
_DETERMINED = (
    "Secular terms are removed for one amplitude only: in first approximation [[leading]] is [[value]]*cos([[phase]])."
)
_CONSTANTS = "[[names]]: the values of [[variables]] at the phase 0, which are constant where [[small]] = 0."
_LEFT = (
    "Put into the equations at random rational parameters, it leaves terms of order [[left]] of [[small]] (verified)."
)
_NOTHING = "Put into the equations at random rational parameters, it leaves nothing (verified)."
_TAYLOR = (
    "Of the equations, terms up to degree [[degree]] in the deviations were taken; the others are of higher order."
)
_REAL = "The frequency without [[small]] is real and not zero where [[square]] > 0."
_NONZERO = "It holds where the frequency without [[small]] is not zero: [[frequency]] != 0."
_RESONANCES = "Resonance, and in general no such solution, where one of these vanishes: [[divisors]]."
_HARMONIC = "[[value]] (harmonic [[harmonic]], order [[order]], [[names]])"
_OTHERS = "Free oscillations of [[names]], whose frequency has the square [[square]], are left out."
_DAMPED = "Without [[small]], roots of [[names]] are not all imaginary: only what is forced of them is here."
_MEASURED = (
    "Measured at the numbers of the description, over one period, against motions that begin in the same state: with "
    "[[small]] halved from [[from]] to [[to]] the errors fall by 2^k, k = [[orders]] (not proved)."
)
_EXPECTED = "k = [[expected]] or more is expected of a right solution to this order, where [[small]] is small enough."
_TOO_SLOW = (
    "The errors of [[names]] fall more slowly than expected: [[small]] is too large there, or something is wrong."
)
#: How far below the expected order a measured one may be.
SLACK = 0.25


def sentences(told: Oscillating) -> Iterator[Said]:
    """What kind of solution it is, what was checked and where it holds."""
    found = told.found
    values: dict[str, object] = {
        "small": found.small,
        "leading": found.leading,
        "phase": told.phase,
        "order": found.order,
    }
    shown = told.formula(found.amplitude)
    free = found.kind is Amplitude.FREE
    yield (_FREE, values | {"amplitude": shown}) if free else (_DETERMINED, values | {"value": shown})
    if found.constants:
        names = ", ".join(str(told.formula(x)) for _, x in found.constants)
        yield _CONSTANTS, values | {"names": names, "variables": ", ".join(name for name, _ in found.constants)}
    least = [one for one in found.residuals if one is not None]
    yield (_LEFT, values | {"left": min(least)}) if least else (_NOTHING, values)
    if told.taylor:
        yield _TAYLOR, {"degree": found.order + 1}
    square = found.frequency * found.frequency
    if not told.real:
        rooted = any(d > 0 for d in found.frequency.top.degrees()[: -len(found.tower.parameters)])
        if rooted:
            yield _REAL, values | {"square": told.formula(square)}
        else:
            yield _NONZERO, values | {"frequency": told.formula(found.frequency)}
    if told.resonances:
        listed = "; ".join(
            _HARMONIC.replace("[[value]]", str(numerator(told, one.value)))
            .replace("[[harmonic]]", str(one.harmonic))
            .replace("[[order]]", str(one.order))
            .replace("[[names]]", ", ".join(one.variables))
            for one in told.resonances
        )
        yield _RESONANCES, {"divisors": listed}
    for group, other in found.others:
        yield _OTHERS, {"names": ", ".join(group), "square": told.formula(other)}
    for group in found.damped:
        yield _DAMPED, values | {"names": ", ".join(group)}


def numerator(told: Oscillating, value: Element) -> Formula:
    """What has to vanish for a quotient to vanish."""
    tower = told.found.tower
    return told.formula(tower.made(value.top, tower.context.constant(1)))


def measured_sentences(told: Oscillating, measured: MeasuredOrders) -> Iterator[Said]:
    """The slopes, and whether they are what they have to be."""
    expected = told.found.order + 1
    values: dict[str, object] = {"small": told.found.small, "expected": expected}
    orders = ", ".join(
        f"{'?' if order is None else format(order, '.2f')} ({name})"
        for name, order in zip(measured.names, measured.orders, strict=True)
    )
    ends = {
        "from": f"{measured.small * float(measured.parts[-2]):.3g}",
        "to": f"{measured.small * float(measured.parts[-1]):.3g}",
    }
    yield _MEASURED, values | ends | {"orders": orders}
    yield _EXPECTED, values
    late = [n for n, k in zip(measured.names, measured.orders, strict=True) if k is not None and k < expected - SLACK]
    if late:
        yield _TOO_SLOW, values | {"names": ", ".join(late)}
