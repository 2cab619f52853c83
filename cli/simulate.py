"""``mbsym simulate``: integrates the equations of motion and writes the trajectory as a table and as figures."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import ceil, pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mbsym_cli.assignments import given_numbers
from mbsym_cli.console import (
    BAD_INPUT,
    BROKEN_DOWN,
    FAILED,
    INTERRUPTED,
    OK,
    console,
    read_description,
    status,
)
from mbsym_cli.files import alone, folder_for, obstacle
from mbsym_cli.options import Options
from mbsym_cli.simulation_files import write_files
from mbsym_cli.simulation_request import ARITHMETIC, FINEST, Flags, Request, read_request
from mbsym_cli.simulation_summary import broken, print_summary

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.dynamics import Dynamics
    from mbsym.numerics.invariants import Invariant
    from mbsym.numerics.methods.interface import Method, Setting
    from mbsym.numerics.reduced import Reduced
    from mbsym.numerics.scenario import Scenario
    from mbsym.numerics.simulate import Trajectory

#: Unless asked for otherwise: the local error, and samples (more of them where the motion is fast).
TOLERANCE = {"float64": 1e-10, "float32": 1e-5, "extended": 1e-14}
SAMPLES, MOST_SAMPLES, SAMPLES_A_PERIOD = 2001, 20_001, 100

#: A run shorter than this many seconds is repeated more finely, to see how good it is.
SOON_DONE = 2.0


class Unsuited(Exception):
    """A method that turned out not to apply here; the message says why."""


@click.command("simulate")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--time", "-t", "end", metavar="T", help="Simulate from 0 to T (60, 2*pi, 1e3).  [required]")
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable.")
@click.option("--samples", metavar="N", help="Rows of the table.  [default: 2001, more for fast motion]")
@click.option("--every", metavar="DT", help="A row every DT instead.")
@click.option("--method", "-m", default="auto", show_default=True, help="auto or one of those above.")
@click.option("--tolerance", metavar="X", help="Error of one step, relative and absolute.  [default: 1e-10 in float64]")
@click.option("--step", metavar="H", help="Length of a step, for methods of fixed step.")
@click.option("--arithmetic", metavar=f"[{'|'.join(ARITHMETIC)}]", default="float64", show_default=True)
@click.option("--step-limit", metavar="N", default="10000000", show_default=True)
@click.option("--invariants", is_flag=True, help="Add the first integrals of problem 7 as columns.")
@click.option(
    "--estimate/--no-estimate",
    default=None,
    help="Repeat the run more finely to estimate its error.  [default: if the run was short]",
)
@click.option("--whole", is_flag=True, help="Integrate the coordinates that provably rest as well.")
@click.option("--format", "-f", "formats", default="csv,svg,png", show_default=True)
@click.option("--out", "-o", type=click.Path(path_type=Path, file_okay=False), help="Folder.  [default: reports/NAME]")
@click.option("--quiet", "-q", is_flag=True, help="Print only what went wrong.")
def command(
    file: Path,
    end: str | None,
    settings: tuple[str, ...],
    samples: str | None,
    every: str | None,
    method: str,
    tolerance: str | None,
    step: str | None,
    arithmetic: str,
    step_limit: str,
    invariants: bool,
    estimate: bool | None,
    whole: bool,
    formats: str,
    out: Path | None,
    quiet: bool,
) -> None:
    """Integrate the equations of motion of FILE from 0 to T; write a table and figures.

    Parameters and the initial state come from the description (values:, initial:); --set replaces them, a coordinate's
    name meaning its initial position and NAME_dot its initial velocity.  Written are trajectory.csv (t, coordinates,
    velocities, energy, relative drift), time histories, phase planes, drift, the moving system itself and the paths of
    its mass centres, and simulation.json.

    Coordinates that provably rest (a spatial system that moves in a plane) are not integrated but put back into every
    state, as the summary says; --whole integrates everything.

    Methods: auto looks at the system and says why it chose what; dop853, rk45 (explicit); radau, lsoda, bdf (stiff
    systems); taylor (very exact, needs heyoka); with a fixed step rk4 and, for conservative systems, midpoint,
    midpoint4, midpoint6 (whose energy does not drift).

    A blow-up, a singular mass matrix or too many steps end a simulation early, and so does Ctrl-C: what was computed is
    kept in files named ...-partial.  Exit codes: 0 done, 1 files could not be written, 2 something is missing or
    wrong, 3 ended early, 130 interrupted.

    \b
    Examples:
      mbsym simulate systems/double-pendulum.yaml --time 60
      mbsym simulate systems/spring-pendulum.yaml --time 20 --set theta=pi/6 --set r=3/2 --set theta_dot=0
      mbsym simulate systems/heavy-top.yaml --time 5 --method rk4 --step 1e-4 --format csv --out top
    """
    texts = {
        "--time": end,
        "--samples": samples,
        "--every": every,
        "--method": method,
        "--tolerance": tolerance,
        "--step": step,
        "--arithmetic": arithmetic,
        "--step-limit": step_limit,
        "--format": formats,
    }
    folder = folder_for(file, out)
    try:
        sys.exit(_command(file, folder, settings, texts, Flags(invariants, estimate, quiet, whole)))
    except KeyboardInterrupt:
        print(f"{file}: interrupted; what has been written is whole", file=sys.stderr)
        sys.exit(INTERRUPTED)


def _command(file: Path, folder: Path, settings: Sequence[str], texts: Mapping[str, str | None], flags: Flags) -> int:
    """Reads everything, complains about everything, then simulates."""
    system = read_description(file)
    asked = Options()
    given = None if system is None else given_numbers(file, system, settings, asked)[0]
    request = read_request(system, texts, flags, asked)
    refused = asked.refused(None if system is None else file)
    if refused or given is None:
        return BAD_INPUT
    reason = obstacle(folder)
    if reason:
        print(f"{file}: the results cannot be written: {reason}", file=sys.stderr)
        return FAILED
    try:
        return _simulate(file, given, folder, request)
    except Unsuited as error:
        asked.complain("--method", "unsuitable-method", str(error), "--method auto chooses one that can")
        asked.refused(file)
        return BAD_INPUT
    except OSError as error:
        print(f"{file}: the results cannot be written: {error}", file=sys.stderr)
    except MemoryError:
        print(f"{file}: out of memory; ask for fewer --samples", file=sys.stderr)
    return FAILED


def _simulate(file: Path, given: Scenario, folder: Path, request: Request) -> int:
    from mbsym.algebra.failures import Failure, SingularPoint
    from mbsym.numerics.dynamics import Dynamics
    from mbsym.numerics.methods.interface import Unusable
    from mbsym.numerics.reduced import reduced

    try:
        with status(request.quiet, f"{file.name}: compiling"):
            further = _integrals(given.system, request)
            dynamics = Dynamics(given, further[1]) if further else Dynamics(given)
            chosen = _chosen(dynamics, request, None if request.whole else reduced(dynamics))
    except SingularPoint as error:
        print(f"{file}: error[singular]: singular at these values: {error}", file=sys.stderr)
        print(f"{file}: nothing was written.", file=sys.stderr)
        return BROKEN_DOWN
    except Failure as error:
        print(f"{file}: error[no-program]: there is no program for these equations: {error}", file=sys.stderr)
        print(f"{file}: nothing was written.", file=sys.stderr)
        return FAILED
    except Unusable as error:
        raise Unsuited(str(error)) from None
    return _integrate(file, folder, dynamics, chosen, request, further[0] if further else ())


# --- choosing ---


@dataclass(frozen=True)
class Chosen:
    """Everything settled before the first step; ``frequency`` is the greatest at the initial state, in rad per time.

    ``resting`` are the coordinates that rest; where that is proved, ``method`` integrates the others only.
    """

    method: Method
    why: str
    measured: str
    setting: Setting
    times: Any
    frequency: float
    resting: Reduced | None = None


def _chosen(dynamics: Dynamics, request: Request, resting: Reduced | None) -> Chosen:
    from mbsym.numerics.choice import choose, rates
    from mbsym.numerics.methods.interface import Setting
    from mbsym.numerics.methods.table import METHODS

    taken = resting if resting is not None and resting.proved else None
    integrated = dynamics if taken is None else taken.dynamics
    tolerance = request.tolerance or TOLERANCE[request.arithmetic]
    if request.method == "auto":
        choice = choose(integrated, tolerance, request.end, request.arithmetic)
        method, why, measured, frequency = choice.method, choice.why, choice.measured, choice.frequency
    else:
        method, why, measured, frequency = METHODS[request.method], "as asked for", "", rates(integrated)[1]
    traits = method.traits
    setting = Setting(None if traits.fixed else tolerance, request.step, request.step_limit)
    if taken is not None:
        method = taken.method(method)
    return Chosen(method, why, measured, setting, _times(request, frequency, dynamics.system), frequency, resting)


def _times(request: Request, frequency: float, system: System) -> Any:
    """Times from 0 to the end, the end included."""
    import numpy as np

    from mbsym.report.trajectory_csv import most_rows

    if request.every is not None:
        times = np.arange(ceil(request.end / request.every * (1 - 1e-12)) + 1) * request.every
        times[-1] = request.end
        return times
    if request.samples is not None:
        return np.linspace(0.0, request.end, request.samples)
    wanted = SAMPLES_A_PERIOD * frequency * request.end / (2 * pi)
    fitting = min(max(SAMPLES, int(min(wanted, MOST_SAMPLES))), MOST_SAMPLES, most_rows(system))
    if request.step is None:
        return np.linspace(0.0, request.end, fitting)
    # A method of fixed step knows nothing between its steps: rows stand at whole numbers of them, and at the end.
    steps = max(1, ceil(request.end / request.step * (1 - 1e-12)))
    apart = max(1, ceil(steps / (fitting - 1)))
    return np.append(np.arange(0, steps, apart) * request.step, request.end)


def _integrals(system: System, request: Request) -> tuple[tuple[Any, ...], Any] | None:
    """The first integrals of problem 7 and the ring they are written in, if they were asked for."""
    if not request.invariants:
        return None
    from mbsym.analysis import Analysis, Unavailable

    analysis = Analysis(system, (7,))
    try:
        return analysis.integrals, analysis.ring
    except Unavailable as reason:
        print(f"no first integrals: {reason}", file=sys.stderr)
        return None


# --- running ---


def _integrate(
    file: Path, folder: Path, dynamics: Dynamics, chosen: Chosen, request: Request, integrals: Sequence[Any]
) -> int:
    from mbsym.numerics.invariants import CONSERVED, energy_status
    from mbsym.numerics.methods.interface import Unusable
    from mbsym.numerics.simulate import simulate

    try:
        with _progress(request.quiet, file.name, request.end) as watch:
            found = simulate(dynamics, chosen.method, chosen.setting, chosen.times, request.arithmetic, watch)
    except Unusable as error:
        raise Unsuited(str(error)) from None
    conserved = energy_status(dynamics)
    further, drifts = _further(dynamics, found, integrals)
    estimated = None
    if found.whole and (request.estimate or (request.estimate is None and found.seconds < SOON_DONE)):
        with status(request.quiet, f"{file.name}: the same more finely, to see how good it is"):
            estimated = _estimated(dynamics, found, chosen, request)
    summary = {
        "energy": {"conserved": conserved, "largest_relative_drift": _largest(found.drift)},
        "invariants": drifts,
        "estimated_error": estimated,
        "resting": _resting(chosen.resting),
    }
    with alone(folder):
        paths = write_files(folder, dynamics, found, chosen, request, summary, further, conserved == CONSERVED)
    if not request.quiet:
        print_summary(file, dynamics, found, chosen, request, summary, paths)
    if found.breakdown is not None:
        print(broken(file, found.breakdown, found, paths), file=sys.stderr)
        return BROKEN_DOWN
    if found.interrupted or (estimated or {}).get("interrupted"):
        kept = f"; kept up to t = {found.times[-1]:.9g} in {paths[0].parent}" if found.interrupted else ""
        print(f"{file}: interrupted{kept}", file=sys.stderr)
        return INTERRUPTED
    return OK


def _resting(found: Reduced | None) -> dict[str, Any] | None:
    """Which coordinates rest, how that is known, and the operations of one right-hand side with and without them."""
    if found is None:
        return None
    known = {"coordinates": list(found.names), "how": found.reduction.how, "taken_out": found.proved}
    return known | (
        {"operations": dict(zip(("whole", "reduced"), found.operations, strict=True))} if found.proved else {}
    )


def _largest(values: Any) -> float:
    return max((abs(float(x)) for x in values), default=0.0)


def _further(
    dynamics: Dynamics, found: Trajectory, integrals: Sequence[Any]
) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
    """Columns of first integrals, and how far each one drifts; the energy is there already."""
    from mbsym.numerics.invariants import invariants, values
    from mbsym.report.trajectory_csv import columns

    wanted = [item for item in integrals if item.kind != "energy"]
    known: tuple[Invariant, ...] = invariants(dynamics, wanted, columns(dynamics.system)) if wanted else ()
    if not known:
        return {}, {}
    table, drifts = {}, {}
    for item, (column, size) in zip(known, values(known, found.times, found.states), strict=True):
        table[item.column] = column
        drifts[item.column] = {"name": item.name, "status": item.status, "drift": _largest(column - column[0]) / size}
    return table, drifts


def _estimated(dynamics: Dynamics, found: Trajectory, chosen: Chosen, request: Request) -> dict[str, Any] | None:
    """The difference from a run a hundred times finer (a quarter of the step), relative to each row's largest value."""
    import numpy as np

    from mbsym.numerics.methods.interface import Unusable
    from mbsym.numerics.simulate import simulate

    setting = chosen.setting
    if setting.step is not None:
        finer = replace(setting, step=setting.step / 4)
    else:
        finer = replace(setting, tolerance=max((setting.tolerance or 0.0) / 100, FINEST))
    try:
        better = simulate(dynamics, chosen.method, finer, chosen.times, request.arithmetic)
    except Unusable:
        return None
    if not better.whole:
        return {"interrupted": True} if better.interrupted else None
    size = np.max(np.abs(better.states), axis=1)
    size[size == 0] = 1.0
    errors = np.max(np.abs(found.states - better.states) / size[:, None], axis=0)
    against = f"tolerance {finer.tolerance:.0e}" if finer.step is None else f"step {finer.step:g}"
    return {"final": float(errors[-1]), "largest": float(np.max(errors)), "against": against}


# --- progress ---


@contextmanager
def _progress(quiet: bool, name: str, end: float) -> Iterator[Callable[[float], None]]:
    """A bar over simulated time on standard error; nothing where that is no terminal."""
    if quiet or not sys.stderr.isatty():
        yield lambda t: None
        return
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    bar = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("t = {task.completed:.4g}"),
        TimeRemainingColumn(),
        console=console(stderr=True),
        transient=True,
    )
    with bar:
        task = bar.add_task(name, total=end)
        shown = 0.0

        def watch(t: float) -> None:
            nonlocal shown
            now = time.monotonic()
            if now - shown > 0.05:
                shown = now
                bar.update(task, completed=t)

        yield watch
