"""What ``mbsym simulate`` writes: the table, the figures, and simulation.json that names them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mbsym_cli.console import status
from mbsym_cli.files import write_whole
from mbsym_cli.simulation_request import Request
from mbsym_cli.simulation_summary import note

if TYPE_CHECKING:
    from mbsym.numerics.dynamics import Dynamics
    from mbsym.numerics.scenario import Scenario
    from mbsym.numerics.simulate import Trajectory
    from mbsym_cli.simulate import Chosen

#: More samples than this are not drawn.
MOST_DRAWN = 20_001

#: Paths are drawn with so many points from one sample to the next, to be smooth.
SMOOTHER = 8


def write_files(
    folder: Path,
    dynamics: Dynamics,
    found: Trajectory,
    chosen: Chosen,
    request: Request,
    summary: Mapping[str, Any],
    further: Mapping[str, Any],
    conserved: bool,
) -> list[Path]:
    """The table first, the figures last; names tell whether the trajectory is whole."""
    from mbsym.report.simulation_json import simulation_json
    from mbsym.report.trajectory_csv import trajectory_csv

    mark = "" if found.whole else "-partial"
    written: list[Path] = []

    def write(name: str, content: str | bytes) -> None:
        path = folder / name
        write_whole(path, content)
        written.append(path)

    if "csv" in request.formats:
        write(f"trajectory{mark}.csv", trajectory_csv(found, further))
    images: dict[str, bytes] = {}
    kinds = [kind for kind in request.formats if kind != "csv"]
    if kinds:
        from mbsym.numerics.between import accelerations
        from mbsym.report.figures import figures

        with status(request.quiet, "drawing"):
            rates = accelerations(dynamics, found.times, found.states)
            images = figures(found, kinds, note(found), conserved, rates)
            images |= _motion(dynamics.scenario, found, kinds, rates)
    for name, content in images.items():
        stem, _, kind = name.rpartition(".")
        write(f"{stem}{mark}.{kind}", content)
    listed = [path.name for path in written]
    write(
        "simulation.json",
        simulation_json(
            found, dynamics.scenario, chosen.method, chosen.why, request.arithmetic, chosen.times, summary, listed
        ),
    )
    # Figures and tables of an earlier simulation would contradict simulation.json.
    for path in sorted(folder.iterdir()):
        if path not in written and _ours(path.name):
            path.unlink(missing_ok=True)
    return written


def _motion(scenario: Scenario, found: Trajectory, kinds: Sequence[str], rates: Any) -> dict[str, bytes]:
    """Pictures of the bodies themselves, where there is something to be seen."""
    from mbsym.algebra.failures import Failure
    from mbsym.numerics.between import between
    from mbsym.numerics.positions import positions
    from mbsym.report.motion_figure import motion_figures

    every = -(-len(found.times) // MOST_DRAWN)  # a picture of a million samples would only be slow
    times, states = found.times[::every], found.states[:, ::every]
    pieces = min(MOST_DRAWN // len(times), SMOOTHER)
    if pieces > 1:
        times, states = between(times, states, rates, [pieces] * (len(times) - 1))
    try:
        places = positions(scenario, times, states)
    except Failure:
        return {}
    return motion_figures(places, kinds, note(found)) if places is not None else {}


def _ours(name: str) -> bool:
    """Whether a file name is one that this command writes."""
    drawn = r"(trajectory|(histories|phase-planes|mass-centres)(-\d+)?|drift|motion)(-partial)?\.(csv|svg|png)"
    return re.fullmatch(drawn, name) is not None
