"""The options of ``mbsym simulate`` as they were typed, in groups; a group of one's own is a file like this one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import click

from mbsym.studies.simulate import Request
from mbsym_cli.console import OutPath
from mbsym_cli.options import group
from mbsym_cli.requests import decorators

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.simulation import Request as Simulated
    from mbsym_cli.options import Options


class Group(Protocol):
    """What a group of further options adds to the request."""

    def added(self, request: Simulated, system: System | None, asked: Options) -> Simulated:
        """The request with what this group asks for; what is wrong joins the complaints of ``asked``."""


@dataclass(frozen=True)
class Output:
    """What is written where, and printed."""

    formats: str
    bodies: bool
    animate: bool
    out: Path | None
    quiet: bool
    verbose: bool

    @property
    def wanted(self) -> str:
        """All formats, those with an option of their own included."""
        more = [*(["bodies-csv"] if self.bodies else []), *(["html", "gif"] if self.animate else [])]
        return ",".join([self.formats, *more])


#: What is simulated, how long, and at which times it is shown; how it is integrated, and what is found out about it.
SPAN = ("time", "values", "samples", "every")
WAY = (
    *("method", "tolerance", "step", "max_step", "arithmetic", "step_limit"),
    *("invariants", "estimate", "whole"),
)
span_options = group("span", dict, *decorators(Request, *SPAN))
way_options = group("way", dict, *decorators(Request, *WAY))

output_options = group(
    "output",
    Output,
    click.option("--format", "-f", "formats", default="csv,svg,png", show_default=True),
    click.option("--bodies", is_flag=True, help="What each body does, in bodies.csv; the same as format bodies-csv."),
    click.option("--animate", is_flag=True, help="animation.html and animation.gif; the same as formats html,gif."),
    click.option("--out", "-o", type=OutPath(path_type=Path, file_okay=False), help="Folder.  [default: reports/NAME]"),
    click.option("--quiet", "-q", is_flag=True, help="Print only what went wrong."),
    click.option("--verbose", "-v", is_flag=True, help="Tell how it was done, too: method, setting, work, what rests."),
)
