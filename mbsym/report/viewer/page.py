"""``view.html``: picture, motion, modes and equilibria of one system in one file that asks the network for nothing.

The script and style are the viewer's bundle (editor/src/view.ts), which a content security policy knows by their
hashes; what the description says stands in the file as text and as JSON, and never becomes an element.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from markupsafe import escape

from mbsym import __version__
from mbsym.algebra.failures import Failure, NoValue
from mbsym.analysis import Analysis
from mbsym.analysis.resting import relative_equilibria
from mbsym.analysis.stages import Unavailable
from mbsym.expressions.message import Message
from mbsym.expressions.tree import Expression, substitute
from mbsym.mechanics.rest import given_values, missing_values
from mbsym.model.quantities import energy_unit, time_unit
from mbsym.model.system import System, rational, velocity_name, with_values
from mbsym.numerics.scenario import scenario
from mbsym.picture.build import picture
from mbsym.picture.encode import as_json, number
from mbsym.problems.relative_equilibria.equilibria import CoordinateValue
from mbsym.problems.stability.verdict import Verdict
from mbsym.report.documents.base import plain
from mbsym.report.figures.animation_page import drift_of, frames_of, run_sentences
from mbsym.report.html.environment import embedded, hash_of
from mbsym.report.language import Language
from mbsym.report.runs.constrained_run_words import constraint_lines
from mbsym.report.sections.stability import verdict_data
from mbsym.report.unit_text import pretty
from mbsym.report.viewer.modes import modes, modes_json
from mbsym.simulation import Request, Simulation, simulate
from mbsym.simulation.request import COORDINATES

#: Where the bundles are that `make page` builds.
BUNDLES = Path(__file__).parents[2] / "serving" / "page"


Values = Mapping[str, Expression]


class Page(NamedTuple):
    """The file's text, and what is said with it."""

    text: str
    said: list[str]


def viewed(
    system: System,
    overrides: Values,
    time: float | None = None,
    modes: bool = False,
    equilibria: bool = False,
    watch: Callable[[float], None] = lambda t: None,
) -> Page:
    """The page of a system with what is asked for, and the sentences that are told with it.

    Modes and equilibria that cannot be had are told of; a motion that cannot is not: raises what ``motion`` and
    ``picture`` raise.
    """
    drawn = picture_part(system, overrides)
    moving = None if time is None else motion_part(system, drawn, time, overrides, watch)
    further = {
        "modes": modes_part(system, overrides) if modes else None,
        "equilibria": equilibria_part(system, overrides) if equilibria else None,
    }
    said = [*drawn["sentences"]]
    said += [f"no {name}: {part['why']}" for name, part in further.items() if part is not None and "why" in part]
    return Page(view_page(system, drawn, moving, further["modes"], further["equilibria"]), said)


def view_page(
    system: System,
    picture: dict[str, Any],
    motion: dict[str, Any] | None = None,
    modes: dict[str, Any] | None = None,
    equilibria: dict[str, Any] | None = None,
) -> str:
    """The file's text, of what ``as_json``, ``motion_json``, ``modes_json`` and ``at_rest_json`` give."""
    script = _inside((BUNDLES / "view.js").read_text(encoding="utf-8"), "script")
    style = _inside((BUNDLES / "view.css").read_text(encoding="utf-8"), "style")
    policy = (
        f"default-src 'none'; script-src {hash_of(script)}; style-src {hash_of(style)}; img-src data: blob:; "
        "base-uri 'none'; form-action 'none'"
    )
    data = embedded({"picture": picture, "motion": motion, "modes": modes, "equilibria": equilibria})
    said = " ".join(system.description.split())
    source = f" After {escape(system.source)}." if system.source else ""
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n<meta name="referrer" '
        f'content="no-referrer">\n<title>{escape(system.name)}</title>\n<style>{style}</style>\n</head>\n<body>\n'
        f"<header>\n<h1>{escape(system.name)}</h1>\n<p>{escape(said)}{source}</p>\n</header>\n"
        '<main id="viewer"><noscript>The picture needs JavaScript; nothing of it comes from the network.</noscript>'
        f"</main>\n<footer>Made by mbsym {escape(__version__)}. Drag or arrow keys: turn; Shift: move; "
        "wheel or + and -: closer; 0: first view; space: play; comma and full stop: a hundredth on.</footer>\n"
        f'<script type="application/json" id="picture-data">{data}</script>\n<script>{script}</script>\n'
        "</body>\n</html>\n"
    )


def _inside(text: str, element: str) -> str:
    """Text that cannot end the element in which it stands.  Raises ValueError where it would."""
    if f"</{element}" in text.lower() or "<!--" in text:
        raise ValueError(f"the bundle holds what ends a <{element}> element")
    return text


def picture_part(system: System, overrides: Values) -> dict[str, Any]:
    """See ``picture``."""
    return as_json(picture(system, overrides))


def motion_part(
    system: System, drawn: dict[str, Any], time: float, overrides: Values, watch: Callable[[float], None]
) -> dict[str, Any]:
    """The motion from 0 to ``time``; raises what ``motion`` raises."""
    return motion_json(motion(system, Request(time), overrides, watch), drawn["program"]["inputs"])


def modes_part(system: System, overrides: Values) -> dict[str, Any]:
    """The modes at the values of the description and of ``overrides``."""
    try:
        return modes_json(modes(Analysis(with_values(system, overrides))))
    except Failure as reason:
        return {"why": f"{reason}"}


def equilibria_part(system: System, overrides: Values) -> dict[str, Any]:
    """The relative equilibria at exact values; a value that is not rational has none."""
    try:
        return at_rest_json(at_rest(with_values(system, overrides), exact_values(system, overrides)))
    except Failure as reason:
        return {"why": f"{reason}"}


def exact_values(system: System, overrides: Values) -> dict[str, Fraction]:
    """The ``overrides`` of parameters that are rational numbers, those in terms of other parameters evaluated."""
    known = {item.name: item.value for item in system.parameters if item.value is not None} | dict(overrides)
    found = {}
    for name in (x for x in overrides if x in system.parameter_names):
        value = rational(substitute(overrides[name], {k: v for k, v in known.items() if k != name}))
        if value is not None:
            found[name] = value
    return found


# A run as what a page plays: coordinates at frames, energy, drift, and the sentences of the run.
#
# Poses are computed from the coordinates by the program of the picture, at every frame and between frames from
# coordinates that are joined by straight lines.


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
    say = Language(run.system.language).say
    units = {"time": pretty(time_unit(run.system)), "energy": pretty(energy_unit(run.system))}
    return Motion(
        times=np.asarray(found.times[chosen], dtype=float),
        coordinates=dict(zip(run.system.coordinates, states[:n], strict=True)),
        velocities=dict(zip(map(velocity_name, run.system.coordinates), states[n:], strict=True)),
        kinetic=np.asarray(found.kinetic[chosen], dtype=float),
        energy=np.asarray(found.energy[chosen], dtype=float),
        drift=np.asarray(found.drift[chosen], dtype=float),
        drift_of=say(drift_of(run)),
        stride=stride,
        sentences=(*map(say, run_sentences(run)), *_constrained(run, say), say(_frames(len(chosen), stride))),
        units=tuple((name, unit) for name, unit in units.items() if unit),
    )


def _constrained(run: Simulation, say: Callable[[str], str]) -> Iterator[str]:
    """``Drift: ...`` of the constraints."""
    # Without a title they begin with a name, which keeps its spelling: c is not C.
    for title, text in constraint_lines(run):
        yield f"{say(title).capitalize()}: {say(text)}." if title else f"{say(text)}."


def _frames(count: int, stride: int) -> Message:
    text = "Frames: [[count]] ([[which]]); between frames coordinates are joined by straight lines."
    return Message(text, count=count, which=frames_of(stride))


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


# Relative equilibria as positions to click through, each with its verdict.


@dataclass(frozen=True)
class Resting:
    """``values`` of the coordinates that it fixes, ``free`` those that may have any value.

    ``texts`` are the values as they are told, exact where they are.  ``other_angles`` names the joints whose values are
    in other angles than the description's, because these are singular there: no slider shows it.  ``family``: one of a
    continuum, ``sample`` of it.
    """

    values: Mapping[str, float]
    texts: Mapping[str, str]
    free: tuple[str, ...]
    verdict: Verdict
    proof: str
    other_angles: str = ""
    family: bool = False


@dataclass(frozen=True)
class AtRest:
    """``complete``: it is proved that there are no others but those of the families."""

    listed: tuple[Resting, ...]
    complete: bool
    remarks: tuple[str, ...]
    turning: Mapping[str, float]


def at_rest(system: System, overrides: Mapping[str, Fraction] | None = None) -> AtRest:
    """All relative equilibria at exact values.  Raises NoValue for one that is missing, and what the search raises."""
    values = given_values(system, overrides or {})
    for name in missing_values(system, values):
        raise NoValue(name)
    try:
        found = relative_equilibria(system, values)
    except Unavailable as withdrawn:
        return AtRest((), False, (withdrawn.failure.reason,), {})
    listed = [_resting(x.values, x.free, x.verdict, x.proof, x.coordinates_of) for x in found.equilibria]
    listed += [_resting(x.sample, x.free, x.verdict, "", x.coordinates_of, True) for x in found.families]
    return AtRest(tuple(listed), found.complete, found.remarks, dict(found.turning))


def _resting(
    values: Iterable[CoordinateValue],
    free: tuple[str, ...],
    verdict: Verdict,
    proof: str,
    other: str,
    family: bool = False,
) -> Resting:
    listed = list(values)
    return Resting(
        {x.name: x.value for x in listed}, {x.name: x.text for x in listed}, free, verdict, proof, other, family
    )


def at_rest_json(found: AtRest) -> dict[str, Any]:
    """What a page reads."""
    return {
        "equilibria": [
            {
                "values": {name: number(value) for name, value in x.values.items()},
                "texts": dict(x.texts),
                "free": list(x.free),
                "verdict": plain(verdict_data(x.verdict)),
                "proof": x.proof,
                "otherAngles": x.other_angles,
                "family": x.family,
            }
            for x in found.listed
        ],
        "complete": found.complete,
        "remarks": list(found.remarks),
        "turning": {name: number(value) for name, value in found.turning.items()},
    }
