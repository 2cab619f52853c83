"""Periodic motions, multipliers, Lyapunov exponents and derivatives of motions as files and sentences.

``orbit.csv`` holds one period: t, coordinates, velocities, as numbers that read back exactly.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite

import numpy as np

from mbsym.expressions.message import Counted, Message, joined
from mbsym.model.quantities import marked, unit_of
from mbsym.model.system import System
from mbsym.numerics.orbits.floquet import Judged, Multiplier, Word
from mbsym.numerics.orbits.lyapunov import Exponents, Parting
from mbsym.numerics.orbits.periodic import Orbit
from mbsym.report.documents import orbit as doc
from mbsym.report.documents.base import file_of
from mbsym.report.documents.orbit import DIGITS
from mbsym.report.runs.trajectory_csv import written
from mbsym.simulation.motions import PeriodicMotion, Sensitivities


def orbit_csv(motion: PeriodicMotion) -> str:
    system = motion.scenario.system
    names = ("t", *motion.orbit.names)
    return written([marked(name, unit_of(system, name)) for name in names], [motion.times, *motion.states])


def orbit_json(motion: PeriodicMotion) -> str:
    """The file's text."""
    orbit, system = motion.orbit, motion.scenario.system
    return file_of(
        doc.Orbit,
        system,
        orbit,
        initial=zip(orbit.names, map(float, orbit.state), strict=True),
        repeats=motion.repeats,
        turns={name: float(turn) for name, turn in zip(orbit.names, orbit.turns, strict=True) if turn},
        verified=(orbit.verified, orbit.verifier),
        multipliers=[(float(mu.real), float(mu.imag), float(abs(mu))) for mu in orbit.multipliers],
        trivial=(orbit.trivial, orbit.reasons),
    )


def sentences(motion: PeriodicMotion) -> Iterator[tuple[str, str]]:
    """(title, text)."""
    orbit = motion.orbit
    period, n = f"{orbit.period:.15g}", motion.repeats
    text = "[[period]], in which the motion is run through [[n]] times: it repeats after [[shorter]]"
    shorter = f"{orbit.period / n:.15g}"
    yield Message("period"), Message(text, period=period, n=n, shorter=shorter) if n > 1 else period
    yield Message("motion"), _judged(orbit)
    values = zip(orbit.names, orbit.state, strict=True)
    yield Message("state"), ", ".join(f"{name} = {value:.12g}" for name, value in values)
    if orbit.shifted:
        by = (f"{name} = {orbit.turns[orbit.names.index(name)]:.12g}" for name in orbit.shifted)
        yield Message("shifted by"), ", ".join(by)
    steps = Counted(orbit.steps, "Newton step")
    text = "to [[size]] of the motion's size after [[steps]]"
    yield Message("closes"), Message(text, size=f"{orbit.closure:.1e}", steps=steps)
    if isfinite(orbit.verified):
        text = "numerically: by [[method]] the same motion closes to [[size]]"
        yield Message("verified"), Message(text, method=orbit.verifier, size=f"{orbit.verified:.1e}")
    else:
        yield Message("warning"), Message("no other method could verify it")
    listed = ", ".join(_shown(mu) for mu in orbit.multipliers)
    text = "[[values]] (to about [[error]])"
    yield Message("multipliers"), Message(text, values=listed, error=f"{orbit.uncertainty:.0e}")
    for reason in orbit.reasons:
        yield Message("one is 1"), reason.reason


def _judged(orbit: Orbit) -> Message:
    """What the multipliers that are not trivial say; a number is told from 1 if it is farther than its uncertainty."""
    others = np.abs(orbit.others)
    doubt = max(10 * orbit.uncertainty, 1e-9)
    if not len(others):
        return Message("all multipliers are 1 for a reason: they tell nothing of stability")
    largest = float(others[0])
    if largest > 1 + doubt:
        text = "unstable in floating point: a multiplier of size [[size]]; not proved"
        return Message(text, size=f"{largest:.6g}")
    if largest < 1 - doubt:
        text = "neighbouring motions come nearer, in floating point: the largest other multiplier is [[size]]"
        return Message(text, size=f"{largest:.6g}")
    return Message(
        "no multiplier is distinguishable from one on the unit circle or inside: numbers decide nothing "
        "about stability here"
    )


def _shown(mu: complex) -> str:
    if abs(mu.imag) < 1e-12 * (1 + abs(mu)):
        return f"{mu.real:.9g}"
    return f"{mu.real:.6g}{mu.imag:+.6g}i"


# What the multipliers of a periodic first approximation prove, as a file and in floquet_sentences.


_SAID = {
    Word.UNSTABLE: Message("unstable: a multiplier is outside the unit circle (Lyapunov)"),
    Word.ASYMPTOTICALLY_STABLE: Message("asymptotically stable: all multipliers are inside the unit circle (Lyapunov)"),
    Word.STABLE: Message(
        "stable: the equations are linear, and every multiplier is inside the unit circle or a simple one on it "
        "(coordinates that are not coupled may have equal ones)"
    ),
    Word.ASYMPTOTIC_BUT_CYCLIC: Message(
        "asymptotically stable but for a drift of cyclic coordinates: no equation of motion contains them, and all "
        "other multipliers are inside the unit circle (Lyapunov)"
    ),
    Word.STABLE_BUT_CYCLIC: Message(
        "stable but for a drift of cyclic coordinates: no equation of motion contains them, the equations are linear, "
        "and every other multiplier is inside the unit circle or a simple one on it"
    ),
    Word.STABLE_FIRST_APPROXIMATION: Message(
        "the first approximation is stable: the equations follow from a Lagrangian, and the multipliers are on the "
        "unit circle and simple (coordinates that are not coupled may have equal ones); of the motion itself that "
        "proves nothing (a critical case)"
    ),
    Word.UNDECIDED: Message(
        "undecided: no multiplier is proved to be outside the unit circle, and neither are all proved to be inside nor "
        "all to be simple ones on it"
    ),
}


def floquet_json(system: System, floquet: Judged) -> str:
    """The file's text."""
    return file_of(doc.Floquet, system, floquet)


def floquet_sentences(floquet: Judged) -> Iterator[tuple[str, str]]:
    """(title, text)."""
    if floquet.rests:
        yield Message("motion"), _SAID[floquet.word]
    else:
        text = "that the unperturbed motion satisfies the equations is verified numerically, not proved"
        yield Message("warning"), Message(text)
        yield Message("motion"), Message("if it does: [[verdict]]", verdict=_SAID[floquet.word])
    period = floquet.period.str(15, radius=False)
    text = "[[period]] is a period of the coefficients (2 pi over [[frequency]])"
    yield Message("period"), Message(text, period=period, frequency=floquet.frequency)
    for mu in floquet.multipliers:
        where = Message("size between [[least]] and [[most]]", least=f"{mu.least:.12g}", most=f"{mu.greatest:.12g}")
        text = Message("on the unit circle") if mu.on_circle else where
        yield Message("multiplier"), joined((_multiplier_shown(mu), text), "; ")
    text = "enclosed in balls with proved remainders, [[steps]]"
    yield Message("how"), Message(text, steps=Counted(floquet.steps, "step"))


def _multiplier_shown(multiplier: Multiplier) -> str:
    real = multiplier.ball.real.str(DIGITS, radius=False)
    if multiplier.ball.imag.contains(0):
        return real
    imaginary = multiplier.ball.imag.str(DIGITS, radius=False)
    return f"{real} {'-' if imaginary.startswith('-') else '+'} {imaginary.lstrip('-')} i"


# Lyapunov exponents as files and lyapunov_sentences.
#
# ``lyapunov.csv``: t and every exponent up to t.


def lyapunov_csv(exponents: Exponents) -> str:
    names = [f"exponent_{k + 1}" for k in range(len(exponents.values))]
    return written(["t", *names], [exponents.times, *exponents.history.T])


def lyapunov_json(system: System, exponents: Exponents) -> str:
    """The file's text."""
    return file_of(
        doc.Lyapunov,
        system,
        exponents,
        exponents=list(zip(exponents.values, exponents.uncertainty, strict=True)),
        largest=exponents.parting.name.lower().removesuffix("_over_this_time") if len(exponents.times) else None,
    )


def lyapunov_figure(system: System, exponents: Exponents, formats: Sequence[str]) -> dict[str, bytes]:
    """Every exponent up to t against t."""
    from matplotlib.figure import Figure  # the other files need no figures

    from mbsym.report.figures.drawing import BLUE, GREY, pictures

    def drawn() -> Figure:
        figure = Figure(figsize=(8, 4), layout="constrained")
        axes = figure.subplots()
        for place, row in enumerate(exponents.history.T):
            axes.plot(exponents.times, row, color=BLUE if place == 0 else GREY, linewidth=1.4 if place == 0 else 0.9)
        axes.axhline(0, color="#444444", linewidth=0.7)
        axes.set_xlim(0, exponents.times[-1])
        axes.set_xlabel("t")
        axes.set_ylabel("exponents up to t")
        figure.suptitle(f"{system.name}: Lyapunov exponents", fontsize=12, parse_math=False)
        return figure

    return pictures({"lyapunov": drawn}, formats)


def lyapunov_sentences(exponents: Exponents) -> Iterator[tuple[str, str]]:
    """(title, text)."""
    if not len(exponents.times):
        yield Message("warning"), Message("nothing was measured")
        return
    yield Message("motion"), _parting(exponents)
    for place, (value, doubt) in enumerate(zip(exponents.values, exponents.uncertainty, strict=True)):
        if isfinite(doubt):
            message = Message(
                "[[value]] +- [[doubt]] (95 %, statistics of this run only)", value=f"{value:.6g}", doubt=f"{doubt:.2g}"
            )
        else:
            message = Message("[[value]], uncertainty not estimated", value=f"{value:.6g}")
        yield f"lambda {place + 1}", message
    yield Message("time"), f"{exponents.time:g}"
    if isfinite(exponents.sum_error):
        yield (
            Message("check"),
            Message(
                "the sum is [[sum]], the mean divergence of the equations [[divergence]]: they differ by [[error]]",
                sum=f"{float(np.sum(exponents.values)):.3e}",
                divergence=f"{exponents.divergence:.3e}",
                error=f"{exponents.sum_error:.1e}",
            ),
        )


def _parting(exponents: Exponents) -> Message:
    match exponents.parting:
        case Parting.POSITIVE if exponents.linear:
            return Message(
                "neighbouring motions part exponentially over this time; the equations are linear: all of their "
                "motions part alike, and none is chaotic"
            )
        case Parting.POSITIVE if exponents.resting:
            return Message("the motion is a rest, and neighbouring motions leave it exponentially over this time")
        case Parting.POSITIVE if exponents.planar:
            return Message(
                "neighbouring motions part exponentially over this time; states of two dimensions and no time in the "
                "equations: none of their motions is chaotic"
            )
        case Parting.POSITIVE:
            return Message(
                "neighbouring motions part exponentially over this time, as chaotic ones do; this is no proof of chaos"
            )
        case Parting.NEGATIVE:
            return Message("neighbouring motions come together over this time")
    bound = f"{exponents.regular:.2g}"
    if exponents.linear:
        return Message(
            "the largest exponent is not distinguishable from zero, which takes three times its "
            "uncertainty and three times "
            "log(T)/T = [[bound]]; the equations are linear: none of their motions is chaotic",
            bound=bound,
        )
    if exponents.planar:
        return Message(
            "the largest exponent is not distinguishable from zero, which takes three times its "
            "uncertainty and three times "
            "log(T)/T = [[bound]]; states of two dimensions and no time in the equations: none of their motions is "
            "chaotic",
            bound=bound,
        )
    if exponents.falling:
        return Message(
            "the largest exponent is not distinguishable from zero, which takes three times its "
            "uncertainty and three times "
            "log(T)/T = [[bound]], and it is still falling, as that of regular motion does: whether the motion is "
            "regular or chaotic is undecided",
            bound=bound,
        )
    return Message(
        "the largest exponent is not distinguishable from zero, which takes three times its uncertainty "
        "and three times "
        "log(T)/T = [[bound]]: whether the motion is regular or chaotic is undecided",
        bound=bound,
    )


# Derivatives along a motion as plain CSV: ``t``, then ``d theta/d m1`` for every quantity and every name.
#
# Derivatives by an initial value carry its name with (0): ``d theta/d theta(0)``.


def derivative_by(sensitivities: Sensitivities, name: str) -> str:
    """``m1``, ``theta(0)``."""
    return name if name in sensitivities.system.parameter_names else f"{name}(0)"


def sensitivity_csv(sensitivities: Sensitivities) -> str:
    """Numbers that read back exactly."""
    names, columns = [marked("t", unit_of(sensitivities.system, "t"))], [sensitivities.times]
    for j, name in enumerate(sensitivities.names):
        for i, quantity in enumerate(sensitivities.quantities):
            names.append(f"d {quantity}/d {derivative_by(sensitivities, name)}")
            columns.append(sensitivities.values[j, i])
    return written(names, columns)


def sensitivity_sentences(sensitivities: Sensitivities) -> Iterator[tuple[str, str]]:
    """(title, text): the greatest answers at the end, and how good they are."""
    for j, name in enumerate(sensitivities.names):
        last, of = (
            sensitivities.values[j, : len(sensitivities.system.coordinates), -1],
            derivative_by(sensitivities, name),
        )
        pairs = zip(sensitivities.system.coordinates, last, strict=True)
        summary = ", ".join(f"d {q}/d {of} = {value:.6g}" for q, value in pairs)
        time = f"{sensitivities.times[-1]:g}"
        yield Message("by [[name]]", name=of), Message("[[values]] at t = [[time]]", values=summary, time=time)
    summary = Message("not estimated")
    if np.isfinite(sensitivities.error):
        text = "about [[size]] of each derivative's largest size: the difference from a finer integration"
        summary = Message(text, size=f"{sensitivities.error:.1e}")
    yield Message("error"), summary
