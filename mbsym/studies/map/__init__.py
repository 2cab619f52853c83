"""``mbsym map``: where a motion is stable, exactly, in a plane of two parameters.

What is said and written of a map, whatever it is over and of, is in ``answer.py``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from mbsym.expressions.message import Message
from mbsym.expressions.safe import safe
from mbsym.maps.axis import Axis
from mbsym.studies.request import ExactSettings, Place, Range, Word, formats, language
from mbsym.studies.section import distinct, unfit_section
from mbsym.studies.study import Answer, Asked, Folder, NotFit, Refusal, Study, Unfit, Watch, failed

if TYPE_CHECKING:
    from mbsym.maps.result import Map
    from mbsym.report.maps.located import Points

KINDS = ("stability", "signature", "equilibria")
ROUTES = ("regions", "boxes")
FORMATS = ("svg", "pdf", "png", "json", "tex")

#: Larger files of points are not read.
MOST_BYTES = 200_000_000
#: So many mistakes in a file of points are told.
MOST_TOLD = 20


@dataclass(frozen=True)
class Request:
    """Divide a plane of two parameters of FILE, or a line of one, into regions of one verdict of problem 6, exactly.

    The boundaries are the polynomials on which the verdict depends (constant terms, Hurwitz minors, discriminants,
    det K, assumptions, triangle inequalities of inertias).  Their arrangement is exact: every region is judged at a
    rational point, every arc and corner at an algebraic one, by the first approximation and the energy.  With --x
    alone a line is divided into intervals; with --z the plane is shown at the critical values of a third parameter
    and between them, on pages map.pdf, map-2.pdf, ....  Numbers are taken exactly, from the description (values:)
    or --set; axes and settings are parameters, or symbols of the notation.  Where the arrangement of a plane is too
    large, and with --by boxes, boxes are halved until one verdict is proved on each, or they are small: white,
    nothing is proved of them.

    With --of equilibria every region of the plane says how many relative equilibria there are, and how many of them
    are stable; written are equilibria-map.svg, .pdf, .png, .json and .tex, and located.csv with the numbers at points.

    Where stability is lost by a pair of imaginary roots terms of third order say whether the border is soft or hard
    (problem 11): at the arc's exact point and, where formulas are small enough, along the whole arc, with points where
    it changes; of slices, too.  Boxes have no borders, and nothing is said of any.

    Written are map.svg, map.pdf, map.png, map.json (every region, arc and corner), map.tex (to \\input) and, with
    --locate, located.csv.  Exit codes: 0 done, 1 there is nothing to judge or files could not be written, 2 something
    is missing or wrong, 130 interrupted (what was proved is written).

    \b
    Examples:
      mbsym map systems/satellite.yaml --x alpha=-1:1 --y gamma=0:1 --set p1=2/5 --set p2=1/5
      mbsym map systems/ziegler-damped.yaml --x P=0:4 --y b1=0:1 --locate points.csv
      mbsym map systems/triangular-points.yaml --x mu=0:1/2
      mbsym map systems/gravity-gradient.yaml --x A=0:2 --y B=0:2 --z C=1/2:3/2
      mbsym map systems/ziegler-damped.yaml --x P=0:4 --y b1=0:1 --by boxes
      mbsym map systems/orbital-gyrostat.yaml --x h=-9:9 --y A=2:8 --of equilibria
    """

    x: Annotated[Axis, Range("NAME=LOW:HIGH", "The parameter or symbol to the right, and its interval.")]
    y: Annotated[Axis | None, Range("NAME=LOW:HIGH", "The one upwards; without it: a line.")] = None
    _: KW_ONLY
    z: Annotated[Axis | None, Range("NAME=LOW:HIGH", "A third one: slices, so that no picture is missed.")] = None
    values: Annotated[
        Mapping[str, Fraction], ExactSettings("NAME=VALUE", "Another's number; repeatable.", "-s", "--set")
    ] = field(default_factory=dict)
    of: Annotated[str, Word("WHAT", "stability, signature: of K, or equilibria.", choices=KINDS, what="map")] = (
        "stability"
    )
    by: Annotated[str, Word("HOW", "regions (exact), or boxes.", choices=ROUTES, what="route")] = "regions"
    locate: Annotated[Path | None, Place("CSV", "Points: where each lies, the verdict.")] = None
    format: Annotated[tuple[str, ...], formats("Files to write.", FORMATS)] = FORMATS
    language: Annotated[str | None, language("Of picture and map.tex")] = None

    @property
    def axes(self) -> tuple[Axis, ...]:
        """Those that are given; one that could not be read is left out."""
        return tuple(axis for axis in (self.x, self.y, self.z) if axis is not None)

    @cached_property
    def located(self) -> tuple[Points | None, tuple[Unfit, ...]]:
        """The points of ``locate``, and what is wrong with the file."""
        return (None, ()) if self.locate is None else _points(self.locate, [axis.name for axis in self.axes])


def _points(path: Path, axes: list[str]) -> tuple[Points | None, tuple[Unfit, ...]]:
    from mbsym.report.maps.located import read_points

    name = safe(str(path))
    try:
        if path.stat().st_size > MOST_BYTES:
            return None, (
                Unfit(
                    "--locate", "too-large", Message("more than [[most]] bytes in [[file]]", most=MOST_BYTES, file=name)
                ),
            )
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        return None, (Unfit("--locate", "unreadable", f"{name}: {error.strerror or error}"),)
    except UnicodeDecodeError:
        return None, (Unfit("--locate", "unreadable", Message("[[file]] is no text in UTF-8", file=name)),)
    points, wrong = read_points(text, axes)
    hint = Message("the columns [[names]] hold rational or decimal numbers", names=", ".join(axes))
    complaints = [Unfit(f"--locate {name}:{item.line}", "bad-point", item.message, hint) for item in wrong[:MOST_TOLD]]
    if len(wrong) > MOST_TOLD:
        complaints.append(
            Unfit(
                f"--locate {name}", "bad-point", Message("[[count]] more lines are wrong", count=len(wrong) - MOST_TOLD)
            )
        )
    return points, tuple(complaints)


def unfit(context: Asked, request: Request) -> Iterator[Unfit]:
    from mbsym.studies.map.answer import fitting

    of_one = request.of != "equilibria"
    if "as_json" in context.typed and "json" not in (request.format or FORMATS):
        yield Unfit("--json", "conflicting-options", "--format leaves JSON out", "add json to --format")
    if "z" in context.typed and "y" not in context.typed:
        yield Unfit("--z", "missing-option", "slices of a line are no pictures", "give the second parameter as --y")
    if request.by == "boxes" and of_one and ("y" not in context.typed or "z" in context.typed):
        yield Unfit("--by", "missing-option", "boxes are of planes", "give two parameters, as --x and --y")
    yield from distinct(request.axes, request.values)
    read = len(request.axes) == sum(name in context.typed for name in ("x", "y", "z")) > 0
    if read:
        yield from request.located[1]
    if not of_one:
        yield from fitting(context, request)


class NoMap(Exception):
    """Neither regions nor boxes."""


def derive(context: Asked, request: Request, watch: Watch) -> Map:
    """Raises NotFit where the section cannot be made."""
    from mbsym.algebra.failures import Failure, TooLargeError, message_of
    from mbsym.analysis import Analysis
    from mbsym.maps.boxes import box_map
    from mbsym.maps.mapping import exact_map
    from mbsym.maps.result import Of
    from mbsym.maps.section import Unfit as Wrong
    from mbsym.maps.slices import stack

    if request.of == "equilibria":
        from mbsym.studies.map.answer import mapped

        return mapped(context.system, request, watch)
    of, axes, values, analysis = Of(request.of), request.axes, request.values, Analysis(context.system)
    try:
        if len(axes) == 3:
            return stack(analysis, axes, values, of, watch)
        if request.by == "boxes":
            return box_map(analysis, axes, values, of, watch, "")
        try:
            return exact_map(analysis, axes, values, of, watch)
        except Wrong as wrong:
            if len(axes) == 1 or not (wrong.irrational and of is Of.STABILITY):
                raise
            return box_map(analysis, axes, values, of, watch, "")
        except TooLargeError as large:
            if len(axes) == 1:
                raise
            try:
                return box_map(analysis, axes, values, of, watch, str(large))
            except Failure as failure:
                text = "no map: [[large]]; no boxes: [[failure]]"
                gaps = {"large": message_of(large), "failure": message_of(failure)}
                raise NoMap(Message(text, **gaps)) from failure
    except Wrong as wrong:
        option = "--x/--y/--z" if len(axes) == 3 else "--x/--y"
        raise NotFit(tuple(unfit_section(wrong.complaints, option))) from wrong


def answer(context: Asked, request: Request, chart: Map) -> Answer:
    from mbsym.studies.map.answer import answer

    return answer(context.system, request, chart)


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    from mbsym.algebra.failures import message_of

    if isinstance(error, NoMap):
        return Refusal(message_of(error))
    return failed(error, "no map")


STUDY = Study(
    "map", Request, derive, answer, refusal, unfit,
    constraints=True, matrices=True, timed=True, out=Folder("Print nothing but complaints.", json=True),
)  # fmt: skip
