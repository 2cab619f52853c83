"""A run as what a page plays: coordinates at frames, energy, drift, and the sentences of the run.

Poses are computed from the coordinates by the program of the picture, at every frame and between frames from
coordinates that are joined by straight lines.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import Any

import numpy as np

from mbsym.expressions.tree import Expression
from mbsym.model.quantities import energy_unit, time_unit
from mbsym.model.system import System, velocity_name
from mbsym.numerics.scenario import scenario
from mbsym.report.figures.animation_page import drift_of, run_sentences
from mbsym.report.runs.constrained_run_words import constraint_lines
from mbsym.report.unit_text import pretty
from mbsym.simulation import Request, Simulation, simulate
from mbsym.simulation.request import COORDINATES

#: At most so many frames, and so many numbers in all of them.
MOST_FRAMES, MOST_NUMBERS = 2_400, 400_000


@dataclass(frozen=True)
class Motion:
    """``coordinates`` and ``velocities`` by name, each (m,) like ``times``; ``stride`` samples of the run are a frame.

    ``energy`` is T - U, ``kinetic`` T; ``drift`` is the relative change of what ``drift_of`` names.
    """

    times: Any
    coordinates: Mapping[str, Any]
    velocities: Mapping[str, Any]
    kinetic: Any
    energy: Any
    drift: Any
    drift_of: str
    stride: int
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


def motion_of(run: Simulation) -> Motion:
    """The frames of a run in coordinates."""
    found, n = run.trajectory, len(run.system.coordinates)
    each = 2 * n + 4
    most = max(2, min(MOST_FRAMES, MOST_NUMBERS // each))
    stride = max(1, -(-len(found.times) // most))
    chosen = np.arange(0, len(found.times), stride)
    if len(found.times) and chosen[-1] != len(found.times) - 1:
        chosen = np.append(chosen, len(found.times) - 1)
    states = np.asarray(found.states[:, chosen], dtype=float)
    units = {"time": pretty(time_unit(run.system)), "energy": pretty(energy_unit(run.system))}
    return Motion(
        times=np.asarray(found.times[chosen], dtype=float),
        coordinates=dict(zip(run.system.coordinates, states[:n], strict=True)),
        velocities=dict(zip(map(velocity_name, run.system.coordinates), states[n:], strict=True)),
        kinetic=np.asarray(found.kinetic[chosen], dtype=float),
        energy=np.asarray(found.energy[chosen], dtype=float),
        drift=np.asarray(found.drift[chosen], dtype=float),
        drift_of=drift_of(run),
        stride=stride,
        sentences=(*run_sentences(run), *_constrained(run), _frames(len(chosen), stride)),
        units=tuple((name, unit) for name, unit in units.items() if unit),
    )


def _constrained(run: Simulation) -> list[str]:
    """``Drift: ...`` of the constraints."""
    lines = constraint_lines(run)  # without a title they begin with a name, which keeps its spelling: c is not C
    return [f"{title[:1].upper()}{title[1:]}: {text}." if title else f"{text}." for title, text in lines]


def _frames(count: int, stride: int) -> str:
    which = "every sample" if stride == 1 else f"one of {stride} samples"
    return f"{count} frames ({which} of the run); between frames coordinates are joined by straight lines."


def rounded(values: Iterable[float]) -> list[float | None]:
    """Numbers of ten digits, enough for a page; what is not finite is null."""
    return [float(f"{x:.10g}") if isfinite(x) else None for x in values]


def motion_json(found: Motion, wanted: Sequence[str] = ()) -> dict[str, Any]:
    """What a page reads; of the velocities those that are ``wanted`` (inputs of the picture's program)."""
    return {
        "times": rounded(found.times),
        "coordinates": {name: rounded(values) for name, values in found.coordinates.items()},
        "velocities": {name: rounded(found.velocities[name]) for name in wanted if name in found.velocities},
        "kinetic": rounded(found.kinetic),
        "energy": rounded(found.energy),
        "drift": rounded(found.drift),
        "driftOf": found.drift_of,
        "units": dict(found.units),
        "sentences": list(found.sentences),
    }
