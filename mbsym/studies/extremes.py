"""``mbsym extremes``: how many digits each quantity keeps at the extremes, and where the model breaks down."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import KW_ONLY, dataclass, field
from typing import TYPE_CHECKING, Annotated

from mbsym.expressions.message import Message
from mbsym.model.constraints import listed
from mbsym.studies.closing import closed_motion, not_closed
from mbsym.studies.request import Anew, Flag, Number, Values
from mbsym.studies.study import BEFORE, Answer, Asked, Folder, Refusal, Study, Unfit, Watch, failed

if TYPE_CHECKING:
    from mbsym.numerics.extremes.extremes import Extremes
    from mbsym.numerics.scenario import Scenario
    from mbsym.numerics.sequences import Ranking
    from mbsym.report.content import Block, Table


@dataclass(frozen=True)
class Request:
    """Measure how many digits each quantity of FILE keeps at the extremes, and where the model breaks down.

    Extremes are: states near singular configurations (they are found: factors of det M and their real zeros, and it is
    told whether the coordinates fail there or the model), rates 1e-8 to 1e8 times the usual, states near the
    unperturbed motion, every positive parameter times 1e-12 to 1e12, and parameters at a border of stability.  Nothing
    depends on the units of the description, but for the range of float32.  Mass matrix, forcing, accelerations, pivots,
    energy, Jacobian, linear matrices and eigenvalues are evaluated in float32, float64 and in rigorous balls; the
    condition tells what no formula could keep.  Verdicts of stability are exact, or "undecided"; eigenvalues at the
    given values are enclosed.  With constraints every state is led to them, and positions are sought in which they lose
    their rank (links in line).

    Written are extremes.csv, extremes.json and extremes.svg/.png.  Exit codes: 0 done, 1 files could not be written,
    2 something is missing or wrong, 3 no state satisfies the constraints, 130 interrupted.

    \b
    Examples:
      mbsym extremes systems/satellite.yaml --set R=7000000 --set omega0=1/1000
      mbsym extremes systems/heavy-top.yaml --sequences
    """

    _: KW_ONLY
    values: Values = field(default_factory=dict)
    sequences: Annotated[bool, Flag(None, "Rank the 12 rotation sequences of each body instead.")] = False
    budget: Annotated[float, Number("S", "Counted work, worth some S seconds.")] = 60.0
    anew: Anew = False


def unfit(context: Asked, request: Request) -> Iterator[Unfit]:
    system = context.system
    if request.sequences and "as_json" in context.typed:
        yield Unfit("--json", "conflicting-options", "there is no JSON of a ranking", "leave --sequences out")
    if request.sequences and system.constraints:
        message = Message(
            "sequences are ranked without constraints, and here are some ([[which]])", which=listed(system.constraints)
        )
        yield Unfit("--sequences", "constraints", message, "without them this would be another system")


@dataclass(frozen=True)
class Measured:
    """Digits at the extremes, ``before`` if by an earlier command; ``notes``: how the state was led to constraints."""

    extremes: Extremes
    notes: tuple[str, ...]
    before: bool = False


@dataclass(frozen=True)
class Ranked:
    """The rotation sequences of each body, by their distance from a singularity."""

    rankings: tuple[Ranking, ...]


def derive(context: Asked, request: Request, watch: Watch) -> Measured | Ranked:
    """Raises NotClosed, Failure where the equations have no program."""
    if request.sequences:
        return _ranked(context.motion, watch)
    from mbsym.mechanics.variables import ring_of
    from mbsym.numerics.extremes.extremes import extremes
    from mbsym.simulation.request import read_values

    scenario, notes = closed_motion(context.motion)
    values = read_values(context.system, request.values)

    def measure() -> Extremes:
        return extremes(scenario, ring_of(scenario.system), values, request.budget, watch)

    found, before = context.measured("extremes", scenario, (values, request.budget), measure, request.anew)
    return Measured(found, notes, before)


def _ranked(scenario: Scenario, watch: Watch) -> Ranked:
    from mbsym.numerics.probes import motion_state
    from mbsym.numerics.sequences import rankings

    states = [[float(x) for x in scenario.state]]
    moving = motion_state(scenario)
    if moving is not None:
        states.append([float(x) for x in moving])
    return Ranked(tuple(rankings(scenario, states, watch)))


def answer(context: Asked, request: Request, derived: Measured | Ranked) -> Answer:
    from mbsym.report.content import Graded, paragraph

    if isinstance(derived, Ranked):
        said = [ranking.sentence for ranking in derived.rankings] or [Message("no body is oriented by three turns.")]
        brief = [paragraph(text) for text in said]
        return Answer((*brief, *_sequences(derived.rankings)), brief=brief)
    from mbsym.numerics.extremes.extremes_told import sentences
    from mbsym.report.figures.extremes_figure import extremes_figure
    from mbsym.report.runs.extremes_tables import extremes_csv, extremes_json

    measured = derived.extremes
    files: dict[str, str | bytes] = {"extremes.csv": extremes_csv(measured), "extremes.json": extremes_json(measured)}
    files |= extremes_figure(measured, ("svg", "png"))
    brief = [paragraph("- ", text) for text in sentences(measured, context.file)]
    left = (Message("left out: [[what]]", what=text) for text in measured.left_out)
    brief += [paragraph("- ", Graded(text, "open")) for text in left]
    told = [paragraph(Message(BEFORE))] if derived.before else []
    return Answer((*told, *brief, *_tables(measured)), files, derived.notes, brief=brief)


def _tables(measured: Extremes) -> Iterator[Block]:
    from mbsym.report.content import paragraph
    from mbsym.report.runs.extremes_tables import tables

    text = "fewest digits kept along each ladder, float64 / float32; * lost by the formula, not by the question"
    yield paragraph(Message(text))
    for columns, rows in tables(measured):
        yield digits(columns, rows)


def digits(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> Table:
    """Names, verdicts and titles fold where the terminal is narrow; numbers never do."""
    from mbsym.report.content import aligned, column
    from mbsym.report.runs.extremes_tables import APPROXIMATION, EXTREME

    names = (EXTREME, APPROXIMATION)
    return aligned((column(name, right=name not in names, fold=name in names) for name in columns), rows)


def _sequences(rankings: Sequence[Ranking]) -> Iterator[Block]:
    from mbsym.report.content import aligned, column, paragraph

    numbers = ("distance from singularity", "smallest / largest pivot", "operations", "M and f")
    heads = (Message("sequence"), *map(Message, numbers), "")
    for ranking in rankings:
        if ranking.alternatives:
            rows = [
                (
                    *(a.text, f"{a.distance:.4f}", f"{a.pivot:.2e}", str(a.operations), str(a.equations)),
                    Message("in the description") if a.own else "",
                )
                for a in ranking.alternatives
            ]
            yield paragraph(ranking.body)
            yield aligned((column(name, right=bool(name)) for name in heads), rows)


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    return not_closed(error, context.system) or failed(error, "the equations have no program")


STUDY = Study(
    "extremes", Request, derive, answer, refusal, unfit,
    constraints=True, timed=True, writes=lambda typed: "sequences" not in typed,
    out=Folder("Print only the sentences.", json=True),
)  # fmt: skip
