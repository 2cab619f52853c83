"""What ``mbsym simulate`` writes: the table, the figures, and simulation.json that names them, as one set."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from typing import TYPE_CHECKING, Any

from mbsym.algebra.failures import Failure, message_of
from mbsym.expressions.message import Message
from mbsym.model.quantities import time_unit, with_unit
from mbsym.report.language import Language
from mbsym.report.unit_text import pretty

if TYPE_CHECKING:
    from mbsym.numerics.body_motion import BodyMotions
    from mbsym.numerics.simulate import Trajectory
    from mbsym.simulation import Simulation
    from mbsym.simulation.motions import Sensitivities
    from mbsym.studies.simulate import Command
    from mbsym.studies.simulate.fitting import Many, Member

#: Formats that are figures.
FIGURES = ("svg", "png", "pdf")

#: More samples than this are not drawn.
MOST_DRAWN = 20_001

#: Paths are drawn with so many points from one sample to the next, to be smooth, and with so many numbers in all.
SMOOTHER, MOST_PLACES = 8, 2_000_000


class Hashed:
    """Parts of a text as they are, and the SHA-256 of all that have been taken."""

    def __init__(self, parts: Iterable[str]) -> None:
        self._parts, self._found = parts, sha256()

    def __iter__(self) -> Iterator[str]:
        for part in self._parts:
            self._found.update(part.encode())
            yield part

    @property
    def digest(self) -> str:
        return self._found.hexdigest()


@dataclass(frozen=True)
class Files:
    """Contents by name, what is to be said of them, what broke off the drawing of some."""

    contents: Mapping[str, str | bytes | Iterable[str]]
    notes: tuple[str, ...] = ()
    stopped: BaseException | None = None


def motion_files(run: Simulation, derivatives: Sensitivities | None, formats: Sequence[str]) -> Files:
    """Of one motion; names tell whether the trajectory is whole.

    Files of an earlier simulation go with it: they would contradict simulation.json.  What stops the drawing, as Ctrl-C
    does, stops nothing else.
    """
    from mbsym.model.quantities import unit_of
    from mbsym.numerics.body_motion import input_columns
    from mbsym.report.runs.certificate import enclosure_csv
    from mbsym.report.runs.constrained_run_words import drift_columns
    from mbsym.report.runs.simulation_json import simulation_json
    from mbsym.report.runs.simulation_words import norm_columns
    from mbsym.report.runs.trajectory_csv import bodies_parts, trajectory_parts

    mark = "" if run.whole else "-partial"
    files: dict[str, str | bytes | Iterable[str]] = {}
    table: Hashed | None = None
    if "csv" in formats:
        shown = {} if run.dynamics.in_states else run.speeds  # they are columns already
        further = shown | {integral.column: integral.values for integral in run.invariants}
        units: dict[str, str | None] = {name: unit_of(run.system, name) for name in shown}
        units |= {integral.column: integral.unit for integral in run.invariants}
        if run.trajectory.table is None and not run.dynamics.in_states:
            further |= input_columns(run.scenario, run.times, run.coordinates, run.velocities)
        drifts = {**drift_columns(run), **norm_columns(run)}
        further, units = further | dict(drifts), units | dict.fromkeys(drifts, "")
        table = Hashed(trajectory_parts(run.trajectory, further, units))
        files[f"trajectory{mark}.csv"] = table
    if run.certificate is not None and run.certificate.rows and "csv" in formats:
        files[f"enclosure{mark}.csv"] = enclosure_csv(run.certificate, run.times, run.system)
    files |= {f"{stem}{mark}.csv": text for stem, text in _happened(run).items()}
    if "bodies-csv" in formats:
        files[f"bodies{mark}.csv"] = bodies_parts(_bodies(run), run.system)
    kinds = [kind for kind in formats if kind in FIGURES]
    stopped: BaseException | None = None
    notes: tuple[str, ...] = ()
    try:
        pictures = _pictures(run, kinds) if kinds else {}
        moving, notes = _animation(run, formats)
        pictures |= moving | _section(run, kinds)
    except (Exception, KeyboardInterrupt) as error:
        stopped, pictures = error, {}
    for name, content in pictures.items():
        stem, _, kind = name.rpartition(".")
        files[f"{stem}{mark}.{kind}"] = content
    names = list(files)
    # Made when the table, which stands before it, has been written: until then there is no hash of it.
    files["simulation.json"] = (simulation_json(run, names, None if table is None else table.digest) for _ in range(1))
    if derivatives is not None:
        from mbsym.report.runs.orbit_files import sensitivity_csv  # few ask for them

        files["sensitivity.csv"] = sensitivity_csv(derivatives)
    return Files(files, notes, stopped)


def ensemble_files(result: Many, request: Command) -> Mapping[str, str | bytes]:
    """Of many motions: curves of few, else fan charts."""
    from mbsym.report.figures.figures import Curve, curves, fan_charts
    from mbsym.report.runs.ensemble_tables import ensemble_csv, ensemble_json, members_csv
    from mbsym.studies.simulate.fitting import variations_of

    files: dict[str, str | bytes] = {}
    ensemble, kinds = result.ensemble, [kind for kind in request.formats if kind != "csv"]
    if "csv" in request.formats:
        files |= {"ensemble.csv": ensemble_csv(ensemble), "members.csv": members_csv(ensemble)}
    if kinds and result.few and all(len(run.times) > 1 for run in result.few.values()):
        legend = zip(result.few.values(), _legend(result.few), strict=True)
        drawn = [Curve(run.trajectory, rates_along(run), words) for run, words in legend]
        files |= curves(drawn, kinds, _fixed(result.few))
    elif kinds and len(ensemble.times) > 1:
        files |= fan_charts(ensemble, variations_of(request), kinds)
    how = (variations_of(request), request.seed, request.sampling)
    return files | {"ensemble.json": ensemble_json(ensemble, *how, list(files))}


def _legend(few: Mapping[Member, Simulation]) -> list[str]:
    """What varies of each, in as many digits, from four on, as tell them apart."""
    from mbsym.report.figures.drawing import equalities

    written: list[str] = []
    for digits in range(4, 18):
        written = [equalities(dict(member), digits) for member in few]
        if len({*written}) == len(written):
            break
    return written


def _fixed(few: Mapping[Member, Simulation]) -> str:
    """The parameters that are the same on all curves."""
    from mbsym.report.figures.drawing import equalities

    known = [run.scenario.parameters for run in few.values()]  # what a relation gives may vary with the others
    same = {name: value for name, value in known[0].items() if all(other[name] == value for other in known)}
    return equalities(same)


def note(trajectory: Trajectory) -> str:
    """What figures say of a trajectory that is not whole, in the language of the description."""
    unit, say = pretty(time_unit(trajectory.system)), Language(trajectory.system.language).say
    if trajectory.breakdown is not None:
        time, kind = with_unit(f"{trajectory.breakdown.time:.6g}", unit), Message(trajectory.breakdown.kind)
        return say(Message("ended early: [[kind]] at t = [[time]]", kind=kind, time=time))
    time = with_unit(f"{trajectory.times[-1]:.6g}", unit)
    return say(Message("interrupted at t = [[time]]", time=time)) if trajectory.interrupted else ""


def _bodies(run: Simulation) -> Iterator[BodyMotions]:
    """What the bodies do, some rows after the other."""
    from mbsym.numerics.between import accelerations
    from mbsym.numerics.body_motion import followed_bodies

    path, motions = run.trajectory, followed_bodies(run.scenario)
    own = [(path.times, path.states)]
    for times, states in own if path.table is None else ((rows[0], rows[1:]) for rows, _ in path.table.blocks()):
        yield motions(times, states, accelerations(run.dynamics, times, states))


def _happened(run: Simulation) -> dict[str, str]:
    """What was watched for is written whatever the formats are: it was asked for by options of its own."""
    from mbsym.report.runs.events import events_csv, section_csv

    if run.happened is None:
        return {}
    radii = run.certificate.passages or None if run.certificate is not None else None
    tables = (
        {"events": events_csv(run.happened.occurrences, run.system, radii)} if run.happened.occurrences.events else {}
    )
    return tables | ({} if run.section is None else {"section": section_csv(run.section, run.system)})


def _section(run: Simulation, kinds: Sequence[str]) -> dict[str, bytes]:
    if run.section is None or not kinds:
        return {}
    from mbsym.report.figures.section_figure import section_figure

    return section_figure(run.section, run.system, note(run.trajectory), kinds)


def _animated_page(run: Simulation) -> bytes:
    from mbsym.report.viewer.page import animation_page

    return animation_page(run).encode()


def _animated_gif(run: Simulation) -> bytes:
    from mbsym.report.figures.animation import animation_gif

    return animation_gif(run)


def _video(run: Simulation) -> bytes:
    from mbsym.report.figures.animation import animation_mp4

    return animation_mp4(run)


def _animation(run: Simulation, formats: Sequence[str]) -> tuple[dict[str, bytes], tuple[str, ...]]:
    """The moving system; nothing, and a word about it, where there is nothing to be seen."""
    made: dict[str, bytes] = {}
    lacking = []
    for kind, drawn in (("html", _animated_page), ("gif", _animated_gif), ("mp4", _video)):
        name = f"animation.{kind}"
        try:
            made |= {name: drawn(run)} if kind in formats else {}
        except Failure as reason:
            lacking.append(Message("no [[file]]: [[why]]", file=name, why=message_of(reason)))
    return made, tuple(lacking)


def _pictures(run: Simulation, kinds: Sequence[str]) -> dict[str, bytes]:
    from mbsym.report.figures.figures import figures

    trajectory, rates = run.trajectory, rates_along(run)
    conserved = run.conservation.standing.conserved is True
    if run.dynamics.in_states:
        return figures(trajectory, kinds, note(trajectory), conserved, rates) | _places(run, kinds)
    return figures(trajectory, kinds, note(trajectory), conserved, rates) | _motion(run, kinds, rates)


def rates_along(run: Simulation) -> Any:
    """The accelerations at every row, or the rates of all declared variables."""
    from mbsym.numerics.between import accelerations

    return accelerations(run.dynamics, run.times, run.trajectory.states)


def _places(run: Simulation, kinds: Sequence[str]) -> dict[str, bytes]:
    """The same pictures of a run in declared variables, through the coordinates of its rows."""
    from dataclasses import replace

    import numpy as np

    from mbsym.algebra.failures import Failure
    from mbsym.numerics.positions import positions
    from mbsym.numerics.states import StateDynamics, in_coordinates
    from mbsym.report.figures.motion_figure import motion_figures

    trajectory, dynamics, scenario = run.trajectory, run.dynamics, run.given
    assert isinstance(dynamics, StateDynamics)
    every = -(-len(trajectory.times) // min(MOST_DRAWN, MOST_PLACES // (3 * len(run.system.bodies))))
    rows = in_coordinates(dynamics, trajectory.states[:, ::every])
    if rows is None or scenario is None or len(trajectory.times) < 2:
        return {}
    try:
        plain = replace(scenario, system=dynamics.plain)
        places = positions(plain, trajectory.times[::every], np.vstack([rows, np.zeros_like(rows)]))
    except Failure:
        return {}
    return motion_figures(places, kinds, note(trajectory)) if places is not None else {}


def _motion(run: Simulation, kinds: Sequence[str], rates: Any) -> dict[str, bytes]:
    """Pictures of the bodies themselves, where there is something to be seen."""
    import numpy

    from mbsym.algebra.failures import Failure
    from mbsym.numerics.between import between
    from mbsym.numerics.body_motion import body_motions
    from mbsym.numerics.positions import positions
    from mbsym.report.figures.motion_figure import motion_figures
    from mbsym.report.outlines import Outline, outlines

    trajectory = run.trajectory
    most = min(MOST_DRAWN, MOST_PLACES // (3 * len(run.system.bodies)))
    every = -(-len(trajectory.times) // most)  # a picture of a million samples would only be slow
    times, states, rates = trajectory.times[::every], trajectory.states[:, ::every], rates[:, ::every]
    pieces = min(most // len(times), SMOOTHER)
    if pieces > 1:
        times, states = between(times, states, rates, [pieces] * (len(times) - 1))
    try:
        places = positions(run.scenario, times, states)
        if places is None:
            return {}
        shapes: tuple[Outline, ...] = ()
        if places.bodied and any(body.shapes for body in run.system.bodies):
            still = numpy.zeros((len(states) // 2, len(times)))  # places and axes do not need accelerations
            shapes = outlines(run.scenario, body_motions(run.scenario, times, states, still, places.frame))
    except Failure:
        return {}
    return motion_figures(places, kinds, note(trajectory), shapes)
