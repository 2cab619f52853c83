"""``mbsym lyapunov``: how fast neighbouring motions part."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import KW_ONLY, dataclass, field
from typing import TYPE_CHECKING, Annotated

from mbsym.expressions.message import Message
from mbsym.studies.closing import closed_motion, not_closed
from mbsym.studies.described import public
from mbsym.studies.request import Number, Values, Whole, duration
from mbsym.studies.study import Answer, Asked, Exit, Folder, Refusal, Study, Unfit, Watch, no_program

if TYPE_CHECKING:
    from mbsym.numerics.orbits.lyapunov import Exponents


@dataclass(frozen=True)
class Request:
    """Measure the Lyapunov exponents of FILE's motion over the time T.

    Exponents of a finite time, with the statistical uncertainty of their means; no number proves a motion chaotic or
    regular.  Where all are asked for their sum is checked against the mean divergence of the equations.  With
    constraints the initial state is led to them, and there are as many exponents as dimensions of what they allow.

    Written are lyapunov.csv (the exponents up to each time), lyapunov.svg/.png and lyapunov.json.  Exit codes: 0 done,
    1 not written, 2 something is missing or wrong, 3 ended early, 130 interrupted.

    \b
    Examples:
      mbsym lyapunov systems/double-pendulum.yaml --time 500 --set theta1=2 --count 1
      mbsym lyapunov systems/spring-pendulum.yaml --time 1000
    """

    time: Annotated[float, duration("Over so long (1000, 200*pi).")]
    _: KW_ONLY
    values: Values = field(default_factory=dict)
    count: Annotated[int | None, Whole("N", "How many exponents.", usual="all, two for each coordinate")] = None
    every: Annotated[
        float | None, Number("DT", "Make directions orthogonal so often.", usual="a 400th of the time")
    ] = None
    tolerance: Annotated[float, Number("X", "Error of one step.", least=1e-14, most=1e-2)] = 1e-10


def unfit(context: Asked, request: Request) -> Iterator[Unfit]:
    """More exponents than there are; too many intervals, and too few for the statistics of means."""
    from mbsym.numerics.orbits.lyapunov import LEAST_INTERVALS

    system = context.system
    count, every, time = request.count, request.every, request.time
    there = 2 * len(system.coordinates)
    if count is not None and count > there:
        yield Unfit(
            "--count", "bad-number", Message("[[value]] is out of bounds: at most [[most]]", value=count, most=there)
        )
    if every is None or time is None:
        return
    if time / every > 1e6:
        yield Unfit(
            "--every",
            "too-large",
            Message("[[count]] intervals are too many", count=f"{time / every:.3g}"),
            "at most a million",
        )
    if time / every < LEAST_INTERVALS * (1 - 1e-12):
        message = Message(
            "--every [[every]] goes with a --time of [[time]] and more: [[least]] intervals",
            every=f"{every:g}", time=f"{LEAST_INTERVALS * every:g}", least=LEAST_INTERVALS,
        )  # fmt: skip
        hint = Message(
            "at most [[most]] here; with fewer nothing can be said of the uncertainty",
            most=f"{time / LEAST_INTERVALS:.3g}",
        )
        yield Unfit("--every", "too-large", message, hint)


@public(Request)
def lyapunov(context: Asked, request: Request, watch: Watch) -> Exponents:
    """Lyapunov exponents over ``time``, the largest first, with their uncertainty: ``mbsym lyapunov``.

    Raises DescriptionError, ValueError, ``mbsym.numerics.scenario.Incomplete``.
    """
    from mbsym.simulation.motions import lyapunov_exponents

    def at(t: float) -> None:
        watch("", t, request.time)

    scenario, _ = closed_motion(context.motion)
    return lyapunov_exponents(scenario, request.time, request.every, request.count, request.tolerance, at)


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    return not_closed(error, context.system) or no_program(error, context, request)


def answer(context: Asked, request: Request, exponents: Exponents) -> Answer:
    from mbsym.report.content import facts
    from mbsym.report.runs.orbit_files import lyapunov_csv, lyapunov_figure, lyapunov_json, lyapunov_sentences

    files: dict[str, str | bytes] = {"lyapunov.csv": lyapunov_csv(exponents)}
    files |= lyapunov_figure(context.system, exponents, ("svg", "png")) if len(exponents.times) > 1 else {}
    files["lyapunov.json"] = lyapunov_json(context.system, exponents)
    lines, notes = [facts(lyapunov_sentences(exponents))], closed_motion(context.motion)[1]
    if exponents.ended is None:
        return Answer(lines, files, notes)
    code = Exit.INTERRUPTED if exponents.ended.kind == "interrupted" else Exit.BROKEN_DOWN
    return Answer(lines, files, (*notes, f"ended early: {exponents.ended}"), code)


STUDY = Study("lyapunov", Request, lyapunov.derive, answer, refusal, unfit, constraints=True, out=Folder(json=True))
