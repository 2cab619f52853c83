"""``mbsym expand``: the slow integral manifold of a system with a small parameter."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import KW_ONLY, dataclass, field
from typing import TYPE_CHECKING, Annotated

from mbsym.expressions.message import Message
from mbsym.studies.request import Number, Numbers, Whole
from mbsym.studies.study import DESCRIPTION, Answer, Asked, Exit, Refusal, Study, Unfit, Watch, failed, refused

if TYPE_CHECKING:
    from mbsym.analysis.expanding import Expansion
    from mbsym.simulation.expanded import Measured


@dataclass(frozen=True)
class Request:
    """Expand the slow integral manifold of FILE in powers of its small parameter, exactly.

    FILE names the parameter ('small parameter: eps') and has equations that are polynomial in
    speeds, velocities and positions.  Fast variables
    are found, or declared under that key.  The functions that express them by the slow ones, and the flow on the
    manifold, are found by comparing coefficients and put into the equations; about the unperturbed motion it is said
    whether the manifold attracts, and what the flow on it needs for asymptotic stability.  Where the description gives
    numbers and an initial state, the flow is compared with a simulation of all equations at eps, eps/2 and eps/4, and
    the order of its error is measured.

    Exit codes: 0 found and checked; 1 there is none, or none was found within the budget; 2 something is wrong.

    \b
    Examples:
      mbsym expand systems/satellite-with-damper-slow.yaml --order 3
      mbsym expand systems/satellite-with-damper-slow.yaml --set rho=0 --json
    """

    _: KW_ONLY
    order: Annotated[int, Whole("N", "Up to this power.", "-n", most=8)] = 2
    values: Numbers = field(default_factory=dict)
    time: Annotated[
        float | None, Number("T", "How long the motions are compared.", "-t", most=1e9, usual="found from the flow")
    ] = None


def unfit(context: Asked, request: Request) -> Iterator[Unfit]:
    system = context.system
    small = system.small
    if small is None:
        hint = "add 'small parameter: eps'"
        yield Unfit(DESCRIPTION, "missing-key", "the description names no small parameter", hint)
        return
    for name in request.values:
        if name == small.name or name in dict(small.powers):
            yield stays_a_symbol(name)


def stays_a_symbol(name: str) -> Unfit:
    text = "[[name]] belongs to the small parameter: it stays a symbol"
    return Unfit("--set", "bad-assignment", Message(text, name=name))


@dataclass(frozen=True)
class Found:
    """The expansion, and how far it is from a simulation; why it was not compared where it was not."""

    expansion: Expansion
    measured: Measured | str


def derive(context: Asked, request: Request, watch: Watch) -> Found:
    from mbsym.analysis import Analysis
    from mbsym.analysis.expanding import expansion
    from mbsym.report.words.expansion_measured import measured_or_why

    watch("slow manifold")
    analysis = Analysis(context.system).in_free_coordinates
    expanded = expansion(analysis, request.order, request.values)
    watch("measuring")
    return Found(expanded, measured_or_why(analysis.system, expanded, request.time, request.values))


def answer(context: Asked, request: Request, derived: Found) -> Answer:
    from mbsym.report.sections.small_parameters import of_slow

    return Answer(of_slow(derived.expansion, derived.measured))


def as_json(context: Asked, request: Request, derived: Found) -> str:
    from mbsym.report.expansion_json import expansion_json

    return expansion_json(context.system, request.values, derived.expansion, derived.measured)


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    if isinstance(error, ZeroDivisionError):
        return refused("no expansion", error, Exit.BAD_INPUT)
    return failed(error, "no expansion")


STUDY = Study(
    "expand", Request, derive, answer, refusal, unfit, as_json, constraints=True, held=False, out=None, letters=True
)
