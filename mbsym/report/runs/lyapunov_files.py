"""Lyapunov exponents as files and sentences.

``lyapunov.csv``: t and every exponent up to t.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite

import numpy as np
from matplotlib.figure import Figure

from mbsym.expressions.message import Message
from mbsym.model.system import System
from mbsym.numerics.orbits.lyapunov import Exponents, Parting
from mbsym.report.documents import orbit as doc
from mbsym.report.documents.base import file_of
from mbsym.report.figures.drawing import BLUE, GREY, pictures
from mbsym.report.runs.trajectory_csv import written


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


def sentences(exponents: Exponents) -> Iterator[tuple[str, str]]:
    """(title, text)."""
    if not len(exponents.times):
        yield Message("warning"), Message("nothing was measured")
        return
    yield Message("motion"), _judged(exponents)
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


def _judged(exponents: Exponents) -> Message:
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
