"""``mbsym view``: a system in three dimensions, as one page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import TYPE_CHECKING, Annotated

from mbsym.expressions.message import Message
from mbsym.studies.request import Flag, Number, Settings, Value
from mbsym.studies.study import Answer, Asked, Document, Refusal, Single, Study, Watch, line, no_program, refused

if TYPE_CHECKING:
    from mbsym.report.viewer.page import Page

MODES = "Show the linear modes about the given motion, with its verdict."
EQUILIBRIA = "List the relative equilibria to click through, with their verdicts."
SETTINGS = Settings(
    "NAME=VALUE", "Replace a value; repeatable.", "-s", "--set", whole=lambda texts: texts["time"] is not None
)


@dataclass(frozen=True)
class Request:
    """Write FILE's system in three dimensions as one self-contained page, with sliders for its coordinates.

    Bodies with their shapes, or the ellipsoids of their inertia; joints, mass centres, forces.  The page works without
    network and server, for talks and supplements of papers.  Values that are missing are stood in for, and told so, if
    no motion is asked for.

    Exit codes: 0 written, 1 not written (the reason is given), 2 something is missing or wrong, 130 interrupted.

    \b
    Examples:
      mbsym view systems/double-pendulum.yaml --time 10 --modes
      mbsym view systems/satellite.yaml -o satellite.html
    """

    _: KW_ONLY
    time: Annotated[float | None, Number("T", "Show the motion until T, too (20, 4*pi).", "-t")] = None
    modes: Annotated[bool, Flag(None, MODES)] = False
    equilibria: Annotated[bool, Flag(None, EQUILIBRIA)] = False
    values: Annotated[Mapping[str, Value], SETTINGS] = field(default_factory=dict)


def derive(context: Asked, request: Request, watch: Watch) -> Page:
    from mbsym.report.viewer.page import viewed
    from mbsym.simulation.request import read_values

    def at(t: float) -> None:
        watch("", t, request.time or 1.0)

    values = read_values(context.system, request.values)
    return viewed(context.system, values, request.time, request.modes, request.equilibria, at)


def answer(context: Asked, request: Request, page: Page) -> Answer:
    from mbsym.report.language import Language

    say = Language(context.system.language).say
    return Answer(line(f"  {say(text)}") for text in page.said)


def document(context: Asked, request: Request, page: Page) -> Document:
    size = f"{len(page.text) / 1e6:.1f}"
    return Document(page.text, told=Message("[[size]] MB, opens in a browser without network", size=size))


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    from mbsym.numerics.scenario import Incomplete

    return refused("cannot be drawn", error) if isinstance(error, Incomplete) else no_program(error, context, request)


STUDY = Study(
    "view", Request, derive, answer, refusal,
    constraints=True, held=False, out=Single("Default: reports/NAME/view.html", "view.html"), document=document,
)  # fmt: skip
