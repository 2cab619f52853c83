"""A run as what a page plays: coordinates at frames, energy, drift, and the sentences of the run.

Poses are computed from the coordinates by the program of the picture, at every frame and between frames from
coordinates that are joined by straight lines.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import Any

import numpy as np

from mbsym.algebra.failures import Failure
from mbsym.expressions.message import Message, joined
from mbsym.expressions.tree import Expression
from mbsym.model.quantities import energy_unit, time_unit, with_unit
from mbsym.model.system import System, velocity_name
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.numerics.states import StateDynamics, in_coordinates
from mbsym.picture.build import Start, picture_at
from mbsym.picture.values import Picture
from mbsym.report.language import Language
from mbsym.report.runs.constrained_run_words import constraint_lines
from mbsym.report.runs.simulation_words import energy_lines, quality, setting_words
from mbsym.report.unit_text import pretty
from mbsym.simulation import Request, Simulation, simulate
from mbsym.simulation.request import COORDINATES

#: At most so many frames, and so many numbers in all of them.
MOST_FRAMES, MOST_NUMBERS = 2_400, 400_000


@dataclass(frozen=True)
class Motion:
    """``coordinates`` and ``velocities`` by name, each (m,) like ``times``.

    ``energy`` is T - U, ``kinetic`` T; ``drift`` is the relative change of what ``drift_of`` names.  ``doubts`` are why
    it may be wrong, ``sentences`` how it was computed.
    """

    times: Any
    coordinates: Mapping[str, Any]
    velocities: Mapping[str, Any]
    kinetic: Any
    energy: Any
    drift: Any
    drift_of: str
    doubts: tuple[str, ...]
    sentences: tuple[str, ...]
    units: tuple[tuple[str, str], ...] = ()


def motion(
    system: System,
    request: Request,
    overrides: Mapping[str, Expression] | None = None,
    watch: Callable[[float], None] = lambda t: None,
) -> Motion:
    """The run of a system, in coordinates and their velocities whatever the description has.

    Raises Incomplete where a number is missing (nothing is made up for a run), and what ``simulate`` raises.
    """
    return motion_of(simulate(scenario(system, overrides), replace(request, variables=COORDINATES), watch))


def moving_picture(run: Simulation) -> tuple[Picture, Motion]:
    """A run with the system that moves in it.  Raises Failure with why there is nothing to be seen."""
    if len(run.times) < 2:
        raise Failure("the run ended where it began")
    return picture_at(Start(_drawn(run))), motion_of(run)


def _drawn(run: Simulation) -> Scenario:
    """What is drawn of a run: in coordinates, whatever it was integrated in."""
    if isinstance(run.dynamics, StateDynamics) and run.given is not None:
        return replace(run.given, system=run.dynamics.plain)
    return run.scenario


def motion_of(run: Simulation) -> Motion:
    """The frames of a run in coordinates.  Raises Failure where these do not follow from what it was integrated in."""
    trajectory, system = run.trajectory, _drawn(run).system
    n = len(system.coordinates)
    each = 2 * n + 4
    most = max(2, min(MOST_FRAMES, MOST_NUMBERS // each))
    stride = max(1, -(-len(trajectory.times) // most))
    chosen = np.arange(0, len(trajectory.times), stride)
    if len(trajectory.times) and chosen[-1] != len(trajectory.times) - 1:
        chosen = np.append(chosen, len(trajectory.times) - 1)
    states = np.asarray(trajectory.states[:, chosen], dtype=float)
    if isinstance(run.dynamics, StateDynamics):
        states = _unwound(run.dynamics, states)
    say = Language(system.language).say
    units = {"time": pretty(time_unit(system)), "energy": pretty(energy_unit(system))}
    constrained = [(title, _line(title, text, say)) for title, text in constraint_lines(run)]
    return Motion(
        times=np.asarray(trajectory.times[chosen], dtype=float),
        coordinates=dict(zip(system.coordinates, states[:n], strict=True)),
        velocities=dict(zip(map(velocity_name, system.coordinates), states[n:], strict=False)),
        kinetic=np.asarray(trajectory.kinetic[chosen], dtype=float),
        energy=np.asarray(trajectory.energy[chosen], dtype=float),
        drift=np.asarray(trajectory.drift[chosen], dtype=float),
        drift_of=say(drift_of(run)),
        doubts=(*map(say, doubts(run)), *(text for title, text in constrained if title == "warning")),
        sentences=(
            *map(say, run_sentences(run)),
            *(text for title, text in constrained if title != "warning"),
            say(_frames(len(chosen), stride)),
        ),
        units=tuple((name, unit) for name, unit in units.items() if unit),
    )


def _unwound(dynamics: StateDynamics, states: Any) -> Any:
    """The coordinates of states, without jumps of whole turns, which would be seen between frames."""
    rows = in_coordinates(dynamics, states)
    if rows is None:
        raise Failure("the coordinates do not follow from the declared variables")
    return np.unwrap(rows, axis=1)


def _line(title: str, text: Message, say: Callable[[str], str]) -> str:
    """``Drift: ...`` of the constraints.  Without a title they begin with a name, which keeps its spelling."""
    return f"{say(title).capitalize()}: {say(text)}." if title else f"{say(text)}."


def _frames(count: int, stride: int) -> Message:
    text = "Frames: [[count]] ([[which]]); between frames coordinates are joined by straight lines."
    which = Message("every sample") if stride == 1 else Message("one of [[count]] samples", count=stride)
    return Message(text, count=count, which=which)


def drift_of(run: Simulation) -> Message:
    """What is conserved drifts by errors alone; anything else may well change."""
    conserved, quantity = run.conservation.standing.conserved is True, Message(run.conservation.quantity)
    return Message("drift of the [[quantity]]" if conserved else "change of the [[quantity]]", quantity=quantity)


def doubts(run: Simulation) -> Iterator[Message]:
    """Why it may be wrong: warnings, an error that nobody could judge, an end before the time."""
    warned, messages, unknown = quality(run)
    yield from (Message("Warning: [[text]].", text=text) for text in warned)
    if unknown:
        yield _error(messages)
    if not run.whole:
        why = Message(run.ended.kind if run.ended is not None else "interrupted")
        end = with_unit(f"{float(run.chosen.times[-1]):.9g}", pretty(time_unit(run.system)))
        yield Message("The run ended early ([[why]]); [[time]] was asked for.", why=why, time=end)


def run_sentences(run: Simulation) -> Iterator[Message]:
    """How it was integrated, what it keeps, how wrong it is."""
    _, messages, unknown = quality(run)
    setting, unit = replace(run.trajectory.setting, longest=None), pretty(time_unit(run.system))
    until = with_unit(f"{float(run.times[-1]):.9g}", unit)
    method, how = run.chosen.method.traits.title, setting_words(setting, run.arithmetic)
    text = "Integrated from t = 0 to [[time]] by [[method]] ([[how]]; [[why]])."
    yield Message(text, time=until, method=method, how=how, why=run.why)
    for which, what in energy_lines(run):
        yield Message("Energy ([[which]]): [[what]].", which=which, what=what)
    if not unknown:
        yield _error(messages)


def _error(messages: Sequence[Message]) -> Message:
    if not messages:
        return Message("The error of the run was not estimated.")
    return Message("Error of the run: [[error]].", error=joined(messages, "; "))


def rounded(values: Iterable[float]) -> list[float | None]:
    """Numbers of ten digits, enough for a page; what is not finite is null."""
    return [float(f"{x:.10g}") if isfinite(x) else None for x in values]


def motion_json(found: Motion, velocity_names: Sequence[str] = ()) -> dict[str, Any]:
    """What a page reads; of the velocities those that are ``velocity_names`` (inputs of the picture's program)."""
    return {
        "times": rounded(found.times),
        "coordinates": {name: rounded(values) for name, values in found.coordinates.items()},
        "velocities": {name: rounded(found.velocities[name]) for name in velocity_names if name in found.velocities},
        "kinetic": rounded(found.kinetic),
        "energy": rounded(found.energy),
        "drift": rounded(found.drift),
        "driftOf": found.drift_of,
        "units": dict(found.units),
        "doubts": list(found.doubts),
        "sentences": list(found.sentences),
    }
