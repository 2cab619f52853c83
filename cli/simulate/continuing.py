"""``mbsym simulate --continue``: its option, and what of an earlier run keeps another one from going on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym_cli.options import group

if TYPE_CHECKING:
    from collections.abc import Collection

    from mbsym.model.system import System
    from mbsym.numerics.planning.models import Model
    from mbsym.numerics.scenario import Scenario
    from mbsym.simulation import Request
    from mbsym.simulation.request import Earlier
    from mbsym_cli.options import Options


@dataclass(frozen=True)
class Continuing:
    """The path of an earlier run's simulation.json; None where a run begins at t = 0."""

    path: Path | None

    def added(self, request: Request, system: System | None, asked: Options) -> Request:
        """The request with the earlier run; how it is gone on from is settled by ``going_on``."""
        from mbsym.report.runs.earlier_run import Unfit, read_earlier

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
        return replace(request, earlier=earlier)


def going_on(request: Request, given: Scenario | None, typed: Collection[str], asked: Options) -> Request:
    """The request, integrated as the earlier run was but for what was ``typed``; what does not fit is complained about.

    The model and the arithmetic stay: rows of two models, or of a state that was rounded on the way, are no run.
    """
    from mbsym.numerics.methods.table import METHODS

    earlier = request.earlier
    if earlier is None:
        return request
    if request.model != earlier.model:
        for option in sorted({"--gravity", "--linear", "--without"} & set(typed)):
            message = f"{option} does not go with --continue: that run was one {_worded(earlier.model)}"
            asked.complain(option, "conflicting-options", message, "leave it out: the model of that run is taken")
    request = replace(request, model=earlier.model, arithmetic=earlier.arithmetic)
    if request.method == "auto":
        request = _as_before(request, earlier, typed, asked)
    elif earlier.arithmetic not in METHODS[request.method].traits.scalars:
        message = f"--method {request.method} does not go with --continue: that run was one in {earlier.arithmetic}"
        able = ", ".join(name for name, one in METHODS.items() if earlier.arithmetic in one.traits.scalars)
        asked.complain("--method", "conflicting-options", message, f"these compute in it: {able}")
    _check_values(request, given, asked)
    return request


def _as_before(request: Request, earlier: Earlier, typed: Collection[str], asked: Options) -> Request:
    """With the method of the earlier run, its tolerance unless one was typed, or its step."""
    if earlier.step is not None:
        for option in sorted({"--tolerance", "--max-step"} & set(typed)):
            message = f"{option} does not go with --continue: that run took steps of one length by {earlier.method}"
            asked.complain(option, "conflicting-options", message, "--method dop853 chooses its steps")
    tolerance = None if earlier.step is not None else request.tolerance or earlier.tolerance
    return replace(request, method=earlier.method, tolerance=tolerance, step=earlier.step)


def _worded(model: Model) -> str:
    return model.label if model.label == "as described" else f"of another model: {model.label}"


def _check_values(request: Request, given: Scenario | None, asked: Options) -> None:
    """Complains about values that are not those of the run that is gone on from."""
    from mbsym.report.runs.earlier_run import changed

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
