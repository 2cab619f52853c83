"""``mbsym average``: the effective potential of a system that is shaken fast, and how good it is."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import TYPE_CHECKING, Annotated

from mbsym.studies.request import Named, Names, Number, Text
from mbsym.studies.study import (
    Answer,
    Asked,
    Document,
    Line,
    Refusal,
    Single,
    Study,
    Unfit,
    Watch,
    failed,
    line,
)

if TYPE_CHECKING:
    from mbsym.algebra.failures import Failure
    from mbsym.analysis import Analysis
    from mbsym.model.system import System
    from mbsym.problems.small_parameter.averaging import Averaged
    from mbsym.simulation.averaged import Measured

ORDER = (
    "Of which power of eps an amplitude of the phase is, as -1 for a force that is as large as the rate; where it "
    "is not plain; all amplitudes have to be named then; repeatable."
)


@dataclass(frozen=True)
class Request:
    """Average FILE over a fast phase (prescribed, its rate a parameter): Kapitza's effective potential, exactly.

    With the rate of order 1/eps, lengths h that the phase shakes of order eps (--order h=1) and forces of zero mean of
    order 1/eps (--order v=-1), the motion is within a distance of order eps of one in an effective potential, for times
    of order 1.  The orders are printed with the result: it holds for them only.  What problem 6 says of that is
    printed; where the description has numbers both motions are simulated at eps, eps/2 and eps/4, and the order of
    their distance is measured: where that contradicts the result, it is withdrawn.

    With --out the averaged system is written as a description of its own (YAML), for 'run', 'map', 'simulate' and all
    others.

    Exit codes: 0 found, 1 there is no such potential or it is withdrawn (the reason is given), or the file cannot be
    written,
    2 something is wrong.

    \b
    Examples:
      mbsym average systems/shaken-pendulum.yaml
      mbsym average systems/shaken-pendulum.yaml --order h=1 --out averaged.yaml
    """

    _: KW_ONLY
    phase: Annotated[str | None, Text("NAME", "The fast prescribed quantity, where there are several.")] = None
    small: Annotated[tuple[str, ...], Names("NAME", "The same as --order NAME=1; repeatable.")] = ()
    order: Annotated[Mapping[str, int], Named("NAME=POWER", ORDER, least=-9, most=9, example="v=-1")] = field(
        default_factory=dict
    )
    time: Annotated[float | None, Number("T", "How long the motions are compared.", most=1e9, usual="60 periods")] = (
        None
    )

    @property
    def powers(self) -> dict[str, int]:
        return dict.fromkeys(self.small, 1) | dict(self.order)


def unfit(request: Request, system: System, typed: Collection[str]) -> Iterator[Unfit]:
    from mbsym.analysis.averaged import fast_phases

    known, phase = fast_phases(system), request.phase
    listed = ", ".join(known) or "none"
    if phase is None and len(known) != 1:
        hint = "name one of them" if known else "prescribed: {phi: {rate: nu}}, nu a parameter"
        yield Unfit("--phase", "no-phase", f"prescribed quantities whose rate is a parameter: {listed}", hint)
    elif phase is not None and phase not in known:
        told = f"{phase!r} is no prescribed quantity whose rate is a parameter"
        yield Unfit("--phase", "unknown-name", told, listed)
    for option, names in (("--small", request.small), ("--order", request.order)):
        for name in names:
            if name not in system.parameter_names:
                yield Unfit(option, "unknown-name", f"there is no parameter called {name!r}")


@dataclass(frozen=True)
class Found:
    """The averaged system, and how far its motion is from the other; why that was not measured where it was not."""

    analysis: Analysis
    averaged: Averaged
    system: System
    measured: Measured | str


class Withdrawn(Exception):
    """What was measured contradicts the result."""


class Unsound(Exception):
    """What averaging stands on does not hold."""


def derive(asked: Asked, request: Request, watch: Watch) -> Found:
    from mbsym.analysis import Analysis
    from mbsym.analysis.averaged import averaged_system, averaging_of, fast_phases
    from mbsym.report.words.expansion_measured import average_or_why, contradicts

    watch("deriving")
    analysis = Analysis(asked.system)
    found = averaging_of(analysis, request.phase or fast_phases(asked.system)[0], request.powers)
    broken = analysis.broken(("energy",))
    if broken is not None:
        raise Unsound(broken.reason)
    averaged = averaged_system(asked.system, found)
    watch("measuring")
    told = average_or_why(asked.system, averaged, found, request.time)
    if contradicts(told):
        raise Withdrawn(f"the result is withdrawn ({found.scaling}): {'; '.join(_measured(told))}")
    return Found(analysis, found, averaged, told)


def answer(asked: Asked, request: Request, found: Found) -> Answer:
    return Answer(_lines(found))


def _lines(found: Found) -> Iterator[Line]:
    for text in (*_told(found.averaged), *_verdict(found.system), *_measured(found.measured)):
        yield line(f"  {text}")


def _told(found: Averaged) -> Iterator[str]:
    yield f"fast: {found.phase}; {found.scaling}"
    yield f"vibrational potential: {found.vibrational}"
    yield f"effective potential:   {found.potential}"
    if found.beside:
        yield f"beside it act the forces on {', '.join(found.beside)} that have no force function here, as they did"


def _verdict(averaged: System) -> Iterator[str]:
    from mbsym.analysis import Analysis
    from mbsym.report.sections.stability import lines

    about = Analysis(averaged, (6,))
    stage = about.stage(6)
    if stage.failure is not None:
        hint = f" ({stage.failure.hint})" if stage.failure.hint else ""
        yield f"stability of the averaged motion: no result: {stage.failure.reason}{hint}"
        return
    yield "stability of the averaged motion, not of the motion itself (problem 6):"
    yield from (f"  {line}" for line in lines(stage.value, about))


def _measured(told: Measured | str) -> Iterator[str]:
    if isinstance(told, str):
        yield f"not measured: {told}"
        return
    parts = ("eps", "eps/2", "eps/4")
    distances = ", ".join(f"{x:.2g} at {part}" for part, x in zip(parts, told.distances, strict=True))
    yield f"measured over {told.time:.4g}: largest distance, as a part of the averaged motion: {distances}"
    orders = ", ".join(f"{x:.2f}" for x in told.orders)
    yield f"order of the distance: {orders} (1 is expected where eps is small enough)"


def document(asked: Asked, request: Request, found: Found) -> Document:
    """The averaged system."""
    from mbsym.source import to_yaml

    return Document(to_yaml(found.system))


def refusal(error: Exception, asked: Asked, request: Request) -> Refusal | None:
    def said(failure: Failure) -> str:
        return f"{failure}{f' ({failure.remedy})' if failure.remedy else ''}"

    if isinstance(error, Withdrawn):
        return Refusal(str(error))
    if isinstance(error, Unsound):
        return Refusal(f"it cannot be averaged: {error}")
    return failed(error, "it cannot be averaged", said)


STUDY = Study(
    "average", Request, derive, answer, refusal, unfit,
    matrices=True, held=False, out=Single("Write the averaged description here."), document=document,
)  # fmt: skip
