"""``mbsym tradeoff``: measures what accuracy costs for one system on this machine."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from typing import TYPE_CHECKING, Annotated

from mbsym.expressions.message import Message, duration, joined
from mbsym.report.language import Language
from mbsym.studies.closing import closed_motion, not_closed
from mbsym.studies.request import Anew, Flag, Number, Settings, Value, Words
from mbsym.studies.request import duration as length
from mbsym.studies.study import BEFORE, Answer, Asked, Exit, Folder, Line, Refusal, Study, Watch, failed, line, refused

if TYPE_CHECKING:
    from mbsym.numerics.methods.interface import Breakdown
    from mbsym.numerics.trade import tradeoff as trade_study
    from mbsym.report.content import Block


def _methods() -> tuple[str, ...]:
    from mbsym.numerics.methods.table import METHODS

    return tuple(METHODS)


SETTINGS = Settings("NAME=VALUE", "Replace a value; repeatable.", "-s", "--set", declared=lambda texts: True)
METHODS = Words(None, "Some of them, separated by commas.", "-m", choices=_methods, what="method", every="all")
BUDGET = "Work worth so many seconds on a usual machine, counted, not timed; less than 30 may be too little."


@dataclass(frozen=True)
class Request:
    """Measure what accuracy costs when FILE is simulated from 0 to T, on this machine.

    Every method climbs a ladder of tolerances or steps, in every arithmetic it knows; its error is measured over the
    whole interval against a reference solution, whose own error is printed: an extrapolation in 160 bits, or, where
    that takes too long, one of two methods in extended arithmetic that agree, or of two implicit ones.  Simpler models
    (gravity of lower order; without constraints linearised equations, and coordinates that rest taken out) are compared
    with the most faithful one.  Of a description with speeds these are integrated, and unit vectors or quaternions.

    Written are tradeoff.csv, fidelity.csv, tradeoff.json and work-precision.svg/.png; Ctrl-C keeps what was measured in
    files named ...-partial.  Asked again, with another --target say, it answers from what was measured before.  Of
    several FILEs one table compares what the target costs, and each has its own files (--json prints one after the
    other).

    Exit codes: 0 done, 1 files could not be written, or a trial ended in an internal error (the others are kept), 2
    something is missing or wrong, 3 there is no solution up to T, 130 interrupted.

    \b
    Examples:
      mbsym tradeoff systems/double-pendulum.yaml --time 60 --target 1e-9
      mbsym tradeoff systems/spring-pendulum.yaml systems/double-pendulum.yaml --time 20
    """

    time: Annotated[float, length("Simulate from 0 to T (60, 2*pi).")]
    _: KW_ONLY
    target: Annotated[float, Number("X", "The error that is good enough.", least=1e-15, most=0.1)] = 1e-9
    values: Annotated[Mapping[str, Value], SETTINGS] = field(default_factory=dict)
    methods: Annotated[tuple[str, ...], METHODS] = ("all",)
    budget: Annotated[float, Number("S", BUDGET)] = 60.0
    fidelity: Annotated[bool, Flag(None, "Compare simpler models too.", both=True)] = True
    all_rows: Annotated[bool, Flag(None, "Print every run, its work, and measured orders.")] = False
    anew: Anew = False


@dataclass(frozen=True)
class Found:
    """What was measured, ``before`` if by an earlier command; ``notes``: how the state was led to the constraints."""

    measured: trade_study.Study
    notes: tuple[str, ...]
    before: bool = False


def derive(context: Asked, request: Request, watch: Watch) -> Found:
    """Raises NotClosed, Breakdown where there is no reference solution, Failure where the equations have no program."""
    from mbsym.numerics.methods import table
    from mbsym.numerics.trade.tradeoff import studied

    scenario, notes = closed_motion(context.motion, declared=True)
    methods = [table.METHODS[name] for name in request.methods]

    def measure() -> trade_study.Study:
        return studied(scenario, methods, request.time, request.budget, request.fidelity, watch)

    how = request.methods, request.time, request.budget, request.fidelity
    whole = context.measured("tradeoff", scenario, how, measure, request.anew, lambda x: not x.trade.interrupted)
    return Found(whole[0], notes, whole[1])


def answer(context: Asked, request: Request, derived: Found) -> Answer:
    trade, say = derived.measured.trade, Language(context.system.language).say
    stopped = trade.interrupted
    if not trade.rows:
        return Answer(complaints=(say(Message("interrupted")),), code=Exit.INTERRUPTED) if stopped else Answer()
    lines, files = _lines(request, derived, say), _files(context, request, derived.measured)
    after = f", t = 0 .. {request.time:g}"
    if stopped:
        complaints = (*derived.notes, say(Message("interrupted; what was measured is kept")))
        return Answer(lines, files, complaints, Exit.INTERRUPTED, after)
    return Answer(lines, files, derived.notes, after=after)


def _files(context: Asked, request: Request, study: trade_study.Study) -> dict[str, str | bytes]:
    from mbsym.model.quantities import time_unit
    from mbsym.report.figures.tradeoff_figure import work_precision
    from mbsym.report.runs.tradeoff_table import fidelity_csv, tradeoff_csv, tradeoff_json

    trade, models, unit = study.trade, study.models, time_unit(context.system)
    mark = "-partial" if trade.interrupted else ""
    files: dict[str, str | bytes] = {f"tradeoff{mark}.csv": tradeoff_csv(trade, unit)}
    if models:
        files["fidelity.csv"] = fidelity_csv(models)
    sentence = str(_advised(request, study))  # programs read English
    files[f"tradeoff{mark}.json"] = tradeoff_json(
        context.system, study, sentence, request.time, request.target, request.budget
    )
    pictures = work_precision(context.system, request.time, trade, request.target, models, ("svg", "png"))
    return files | {name.replace(".", f"{mark}."): content for name, content in pictures.items()}


def _lines(request: Request, answered: Found, say: Callable[[str], str]) -> Iterator[Line | Block]:
    study = answered.measured
    trade = study.trade
    truth = trade.reference
    yield line((say(_advised(request, study)), "bold"), always=True)
    if answered.before:
        yield line("  ", say(Message(BEFORE)))
    every = request.all_rows or not any(row.front for row in trade.rows)  # where all failed there is no front
    if not every:
        text = "no other run is as exact as these in as little time (--all-rows shows every run):"
        yield line("  ", say(Message(text)))
    yield _runs(study, every)
    for reason in dict.fromkeys(reason for _, reason in trade.unusable):
        names = ", ".join(name for name, why in trade.unusable if why == reason)
        yield line("  ", (say(Message("[[method]]: not used: [[why]]", method=names, why=reason)), "yellow"))
    if len(study.models) > 1:
        yield _models(study)
    text = "reference: [[method]], estimated error [[error]], [[time]]; errors below [[least]] are not told apart"
    error, least, time = f"{truth.error:.1e}", f"{trade.smallest_judged:.1e}", duration(truth.seconds)
    yield line("  ", say(Message(text, method=truth.method, error=error, time=time, least=least)))
    if request.all_rows:
        yield from _measured(request, trade, say)


def _measured(request: Request, trade: trade_study.Tradeoff, say: Callable[[str], str]) -> Iterator[Line]:
    """The orders of methods, and what measuring cost."""
    for order in trade.orders:
        if order.pairs > 1:
            text = "measured order [[order]], nominal [[nominal]] (halvings of the step: [[count]])"
            message = Message(text, order=f"{order.measured:.2f}", nominal=order.nominal, count=order.pairs)
            yield line(f"  {order.method}, {order.scalar}: ", say(message))
    text = (
        "cost: [[reference]] for the reference, [[runs]] for the runs, of a budget of [[budget]]; counted work, in "
        "seconds of a usual machine, as in the column cost"
    )
    costs = {"reference": f"{trade.reference.cost:.2g}", "runs": f"{trade.spent:.2g}"}
    yield line("  ", say(Message(text, budget=f"{request.budget:g}", **costs)))


def _advised(request: Request, found: trade_study.Study) -> Message:
    from mbsym.numerics.trade.fidelity import model_advice
    from mbsym.numerics.trade.tradeoff import advice

    said = (advice(found.trade, request.target), model_advice(found.models, request.target))
    return joined(filter(None, said))


#: What is told of a run only where all are.
_OF_ALL = ("evaluations", "steps", "cost", "front")


def _runs(study: trade_study.Study, every: bool) -> Block:
    """Runs on the front, from the least exact to the most exact one; or every run, method by method."""
    from mbsym.report.content import aligned, column
    from mbsym.report.runs.tradeoff_table import constrained, shown

    rows = study.trade.rows
    if not every:
        rows = tuple(sorted((row for row in rows if row.front), key=lambda row: -row.error))
    drift_columns = ("constraints",) if constrained(rows) else ()
    names = ("method", "setting", "error", "drift", *drift_columns, "evaluations", "steps", "time", "cost", "front")
    told = [k for k, name in enumerate(names) if every or name not in _OF_ALL]
    columns = [column(Message(names[k]), right=names[k] not in ("method", "setting", "front")) for k in told]
    return aligned(columns, [[cells[k] for k in told] for cells in shown(rows, study.trade.smallest_judged)])


def _models(study: trade_study.Study) -> Block:
    from mbsym.report.content import aligned, column
    from mbsym.report.runs.tradeoff_table import models_shown

    names = ("model", "what it neglects", "error", "operations", "time")
    columns = [column(Message(name), right=place > 1, fold=place < 2) for place, name in enumerate(names)]
    return aligned(columns, models_shown(study.models))


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    from mbsym.numerics.methods.interface import Breakdown
    from mbsym.numerics.simulate import Rests

    if isinstance(error, Breakdown):
        return Refusal(Language(context.system.language).say(_without_reference(error, request)), Exit.BROKEN_DOWN)
    if isinstance(error, Rests):
        return refused("error[rests]: there is nothing to compare", error)
    failure = failed(error, "the equations have no program")
    return not_closed(error, context.system) or (failure and Refusal(failure.text, Exit.BROKEN_DOWN))


def _without_reference(error: Breakdown, request: Request) -> Message:
    """A solution that ends is one thing, one that takes too long another."""
    from mbsym.numerics.methods.interface import Cause
    from mbsym.numerics.trade.reference_search import BROKEN, DISAGREE

    time = f"{request.time:g}"
    if error.kind == DISAGREE:
        text = (
            "there is no reference solution up to t = [[time]]: no two solutions agree, [[which]]: the motion may be "
            "chaotic over such a time; a shorter --time helps"
        )
        return Message(text, time=time, which=error.message)
    if error.kind not in (BROKEN, Cause.STEP_LIMIT):
        return Message("there is no reference solution up to t = [[time]]: [[why]]", time=time, why=error.told)
    why = error.message
    if error.kind == Cause.STEP_LIMIT:
        text = "the budget ended at t = [[time]]; a shorter --time or a larger --budget helps"
        why = Message(text, time=f"{error.time:.3g}")
    return Message("no reference solution up to t = [[time]] was found: [[why]]", time=time, why=why)


def together(runs: Sequence[tuple[Asked, Request, Found]]) -> Iterator[Block]:
    """What the target costs, scene by scene: the setting of least time, or the most accurate one where none does."""
    from mbsym.report.content import aligned, column, paragraph
    from mbsym.report.runs.tradeoff_table import compared

    names = ("scene", "method", "setting", "error", "evaluations", "steps", "time", "cost", "reached")
    columns = [column(Message(name), right=name not in ("scene", "method", "setting", "reached")) for name in names]
    rows = [(context.system.name, derived.measured.trade, request.target) for context, request, derived in runs]
    yield aligned(columns, compared(rows))
    before = [context.system.name for context, _, derived in runs if derived.before]
    if before:
        message = Message(BEFORE)
        yield paragraph(message if len(before) == len(runs) else joined([", ".join(before), message], ": "))


STUDY = Study(
    "tradeoff",
    Request,
    derive,
    answer,
    refusal,
    constraints=True,
    out=Folder("Print only the recommendation.", json=True),
    several=True,
    together=together,
)
