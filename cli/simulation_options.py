"""The options of ``mbsym simulate`` as they were typed, in groups; a group of one's own is a file like this one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import click

from mbsym_cli.console import OutPath
from mbsym_cli.option_groups import group
from mbsym_cli.simulation_request import ARITHMETIC

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.simulation import Request
    from mbsym_cli.options import Options


class Group(Protocol):
    """What a group of further options adds to the request."""

    def added(self, request: Request, system: System | None, asked: Options) -> Request:
        """The request with what this group asks for; what is wrong joins the complaints of ``asked``."""


@dataclass(frozen=True)
class Span:
    """What is simulated, how long, and at which times it is shown."""

    end: str | None
    settings: tuple[str, ...]
    samples: str | None
    every: str | None


@dataclass(frozen=True)
class Way:
    """How it is integrated, and what is found out about it."""

    method: str
    tolerance: str | None
    step: str | None
    max_step: str | None
    arithmetic: str
    step_limit: str
    invariants: bool
    estimate: bool | None
    whole: bool


@dataclass(frozen=True)
class Output:
    """What is written where, and printed."""

    formats: str
    bodies: bool
    animate: bool
    out: Path | None
    quiet: bool

    @property
    def wanted(self) -> str:
        """All formats, those with an option of their own included."""
        more = [*(["bodies-csv"] if self.bodies else []), *(["html", "gif"] if self.animate else [])]
        return ",".join([self.formats, *more])


span_options = group(
    "span",
    Span,
    click.option("--time", "-t", "end", metavar="T", help="Simulate from 0 to T (60, 2*pi, 1e3).  [required]"),
    click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable."),
    click.option("--samples", metavar="N", help="Rows of the table.  [default: 2001, more for fast motion]"),
    click.option("--every", metavar="DT", help="A row every DT instead."),
)

way_options = group(
    "way",
    Way,
    click.option("--method", "-m", default="auto", show_default=True, help="auto or one of those above."),
    click.option(
        "--tolerance", metavar="X", help="Error of one step, relative and absolute.  [default: 1e-10 in float64]"
    ),
    click.option("--step", metavar="H", help="Length of a step, for methods of fixed step."),
    click.option("--max-step", metavar="H", help="No step is longer (0.01), so that nothing short is stepped over."),
    click.option("--arithmetic", metavar=f"[{'|'.join(ARITHMETIC)}]", default="float64", show_default=True),
    click.option("--step-limit", metavar="N", default="10000000", show_default=True),
    click.option(
        "--invariants",
        is_flag=True,
        help="Add first integrals as columns: those of problem 7; of small systems others found at these numbers, too.",
    ),
    click.option(
        "--estimate/--no-estimate",
        default=None,
        help="Estimate the error by a better run.  [default: of short runs, as far as little work goes]",
    ),
    click.option(
        "--whole",
        is_flag=True,
        help="Integrate the coordinates that provably rest as well, all parts with the same steps, and keep welded "
        "bodies apart.",
    ),
)

output_options = group(
    "output",
    Output,
    click.option("--format", "-f", "formats", default="csv,svg,png", show_default=True),
    click.option("--bodies", is_flag=True, help="What each body does, in bodies.csv; the same as format bodies-csv."),
    click.option("--animate", is_flag=True, help="animation.html and animation.gif; the same as formats html,gif."),
    click.option("--out", "-o", type=OutPath(path_type=Path, file_okay=False), help="Folder.  [default: reports/NAME]"),
    click.option("--quiet", "-q", is_flag=True, help="Print only what went wrong."),
)


def typed(span: Span, way: Way, output: Output) -> dict[str, str | None]:
    """The texts of the options by their names."""
    return {
        "--time": span.end,
        "--samples": span.samples,
        "--every": span.every,
        "--method": way.method,
        "--tolerance": way.tolerance,
        "--step": way.step,
        "--max-step": way.max_step,
        "--arithmetic": way.arithmetic,
        "--step-limit": way.step_limit,
        "--format": output.wanted,
    }
