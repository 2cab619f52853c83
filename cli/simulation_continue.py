"""``mbsym simulate --continue``: its option, and what of an earlier run keeps another one from going on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.option_groups import group

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.scenario import Scenario
    from mbsym.simulation import Request
    from mbsym_cli.options import Options


@dataclass(frozen=True)
class Continuing:
    """The path of an earlier run's simulation.json; None where a run begins at t = 0."""

    path: Path | None

    def added(self, request: Request, system: System | None, asked: Options) -> Request:
        """The request with the earlier run, integrated as that was unless another method is asked for."""
        from mbsym.report.earlier_run import Unfit, read_earlier

        if self.path is None or system is None:
            return request
        try:
            earlier = read_earlier(self.path, system)
        except Unfit as reason:
            asked.complain("--continue", "unfit-run", str(reason), "take the simulation.json of a run of this FILE")
            return request
        if 0 < request.time <= earlier.time:
            hint = f"--time is counted from the start: take one beyond {earlier.time:.9g}"
            asked.complain("--time", "conflicting-options", f"that run is at t = {earlier.time:.9g} already", hint)
        request = replace(request, earlier=earlier)
        if request.method != "auto":
            return request
        return replace(
            request,
            method=earlier.method,
            tolerance=None if earlier.step is not None else request.tolerance or earlier.tolerance,
            step=earlier.step,
            arithmetic=earlier.arithmetic,
        )


def check_values(request: Request, given: Scenario | None, asked: Options) -> None:
    """Complains about values that are not those of the run that is gone on from."""
    from mbsym.report.earlier_run import changed

    if request.earlier is None or given is None:
        return
    different = list(changed(request.earlier, given))
    if different:
        message = f"that run had other values: {'; '.join(different)}"
        asked.complain("--continue", "unfit-run", message, "repeat the --set of that run, or leave out --continue")


continue_options = group(
    "continuing",
    Continuing,
    click.option(
        "--continue",
        "path",
        type=click.Path(path_type=Path),
        metavar="simulation.json",
        help="Go on from where an earlier run of FILE ended, up to T; its rows come first.",
    ),
)
