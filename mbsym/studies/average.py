"""``mbsym average``: the effective potential of a system that is shaken fast, and how good it is."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import TYPE_CHECKING, Annotated

from mbsym.expressions.message import Message
from mbsym.studies.request import Named, Names, Number
from mbsym.studies.study import Answer, Asked, Document, Refusal, Single, Study, Unfit, Watch, failed, refused

if TYPE_CHECKING:
    from mbsym.analysis.small import Averaging
    from mbsym.model.system import System
    from mbsym.problems.small_parameter.averaging import Averaged
    from mbsym.simulation.expanded import Measured

ORDER = (
    "Of which power of eps an amplitude of the phase is, as -1 for a force that is as large as the rate; where it "
    "is not plain; all amplitudes have to be named then; repeatable."
)


@dataclass(frozen=True)
class Request:
    """Average FILE over fast phases (prescribed, their rates parameters): Kapitza's effective potential, exactly.

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
    phase: Annotated[
        tuple[str, ...], Names("NAME", "The fast prescribed quantity, where there are several; repeatable.")
    ] = ()
    small: Annotated[tuple[str, ...], Names("NAME", "The same as --order NAME=1; repeatable.")] = ()
    order: Annotated[Mapping[str, int], Named("NAME=POWER", ORDER, least=-9, most=9, example="v=-1")] = field(
        default_factory=dict
    )
    time: Annotated[
        float | None, Number("T", "How long the motions are compared.", "-t", most=1e9, usual="60 periods")
    ] = None

    @property
    def powers(self) -> dict[str, int]:
        return dict.fromkeys(self.small, 1) | dict(self.order)


def unfit(context: Asked, request: Request) -> Iterator[Unfit]:
    from mbsym.analysis.averaged import fast_phases

    system = context.system
    known, phases = fast_phases(system), request.phase
    listed = Message("prescribed quantities whose rate is a parameter: [[names]]", names=", ".join(known))
    if not known:
        listed = Message("there is no prescribed quantity whose rate is a parameter")
    if not phases and len(known) != 1:
        hint = "name one of them" if known else "prescribed: {phi: {rate: nu}}, nu a parameter"
        yield Unfit("--phase", "no-phase", listed, hint)
    for phase in phases:
        if phase not in known:
            message = Message("[[name]] is no prescribed quantity whose rate is a parameter", name=repr(phase))
            yield Unfit("--phase", "unknown-name", message, listed)
    for option, names in (("--small", request.small), ("--order", request.order)):
        for name in names:
            if name not in system.parameter_names:
                yield Unfit(option, "unknown-name", Message("there is no parameter called [[name]]", name=repr(name)))


@dataclass(frozen=True)
class Found:
    """The averaged system, and how far its motion is from the other; why that was not measured where it was not."""

    averaged: Averaged
    system: System
    measured: Measured | str


class Withdrawn(Exception):
    """What was measured contradicts the result."""


class Unsound(Exception):
    """What averaging stands on does not hold."""


def derive(context: Asked, request: Request, watch: Watch) -> Found:
    from mbsym.analysis import Analysis
    from mbsym.analysis.averaged import averaged_system, averaging_of, fast_phases
    from mbsym.report.words.expansion_measured import average_or_why, contradicts

    watch("deriving")
    analysis = Analysis(context.system)
    average = averaging_of(analysis, request.phase or fast_phases(context.system), request.powers)
    broken = analysis.broken(("energy",))
    if broken is not None:
        raise Unsound(broken.reason)
    averaged = averaged_system(context.system, average)
    watch("measuring")
    measured = average_or_why(context.system, averaged, average, request.time)
    if contradicts(measured):
        raise Withdrawn(_withdrawn(context.system, average, measured))
    return Found(average, averaged, measured)


def _withdrawn(system: System, average: Averaged, measured: Measured | str) -> str:
    from mbsym.analysis.small import Averaging
    from mbsym.report.content import Phrase, joined
    from mbsym.report.language import Language
    from mbsym.report.plain_writer import Writer
    from mbsym.report.words.expansion_measured import JudgedAverage
    from mbsym.report.words.expansion_words import of_averaging

    said = of_averaging(JudgedAverage(Averaging(average.phases, average), measured, True))
    return Writer(Language(system.language)).inline(Phrase((joined(said, " "),)))


def answer(context: Asked, request: Request, derived: Found) -> Answer:
    from mbsym.report.content import ragged
    from mbsym.report.words.expansion_measured import JudgedAverage
    from mbsym.report.words.expansion_words import of_averaging

    return Answer(map(ragged, of_averaging(JudgedAverage(_judged(derived), derived.measured, False))))


def _judged(derived: Found) -> Averaging:
    """With what problem 6 says of the averaged motion."""
    from mbsym.analysis import Analysis
    from mbsym.analysis.small import Averaging

    return Averaging(derived.averaged.phases, derived.averaged, Analysis(derived.system, (6,)))


def document(context: Asked, request: Request, derived: Found) -> Document:
    """The averaged system."""
    from mbsym.source import to_yaml

    return Document(to_yaml(derived.system))


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    if isinstance(error, Withdrawn):
        return Refusal(str(error))
    if isinstance(error, Unsound):
        return refused("it cannot be averaged", error)
    return failed(error, "it cannot be averaged")


def as_json(context: Asked, request: Request, derived: Found) -> str:
    from mbsym.report.documents.base import file_of
    from mbsym.report.documents.expansion import Average
    from mbsym.report.expansion_json import measured_data

    return file_of(
        Average,
        context.system,
        derived.averaged,
        averaged_motion_at_values=_judged(derived).word_at_values,
        measured=measured_data(derived.measured),
    )


#: Under constraints.
INSTEAD = Message("'mbsym simulate' takes constraints, and runs through every period of the fast phase")

STUDY = Study(
    "average", Request, derive, answer, refusal, unfit, as_json, instead=INSTEAD,
    matrices=True, held=False, out=Single("Write the averaged description here."), document=document,
    letters=True,
)  # fmt: skip
