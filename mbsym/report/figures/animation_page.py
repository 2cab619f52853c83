"""``animation.html``: the moving system in three dimensions with time controls, in one file without network.

The page says what was integrated, how, with what error, and what is drawn between its frames.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from markupsafe import Markup

from mbsym import __version__
from mbsym.expressions.message import Message, joined
from mbsym.model.quantities import energy_unit, time_unit, unit_of, with_unit
from mbsym.model.system import INERTIAL
from mbsym.picture.looking import basis
from mbsym.report.figures.animation import Animation, dots, extent, moving_points, view
from mbsym.report.html.environment import embedded, page
from mbsym.report.language import Language
from mbsym.report.runs.simulation_words import energy_lines, quality, setting_words
from mbsym.report.unit_text import pretty
from mbsym.simulation import Simulation

#: A motion of so many units of time runs at one a second; a shorter or longer one takes ``LASTS`` seconds.
AS_IT_IS, LASTS = (4.0, 30.0), 12.0


@dataclass(frozen=True)
class Motion:
    """What the template shows: ``data`` for the script, ``label`` for those who cannot see, ``sentences`` below."""

    data: Markup
    label: str
    sentences: tuple[str, ...]
    moves: bool
    drift_of: str = "change of the energy"


def animation_page(found: Animation, run: Simulation) -> str:
    """The file's text."""
    system = found.system
    values = run.scenario.parameters
    start = dict(zip([*system.coordinates, *system.velocities], map(float, run.scenario.state), strict=True))
    units = {name: pretty(unit_of(system, name)) for name in (*system.parameter_names, *start)}
    parameters = [
        (item.name, with_unit(f"{float(values[item.name]):.9g}", units[item.name]), item.meaning)
        for item in system.parameters
    ]
    parameters += [(name, with_unit(f"{value:.9g}", units[name]), "initial value") for name, value in start.items()]
    return page(
        "animation.html.j2",
        {},
        ("motion.js",),
        system=system,
        motion=run_motion(found, run, Language(system.language)),
        parameters=parameters,
        version=__version__,
    )


def run_motion(found: Animation, run: Simulation, language: Language) -> Motion:
    """What the template needs of a run, with what is to be said of it."""
    shown = motion(found, tuple(map(language.say, (*run_sentences(run), *drawn_sentences(found)))))
    return replace(shown, drift_of=language.say(drift_of(run)))


def drift_of(run: Simulation) -> Message:
    """What is conserved drifts by errors alone; anything else may well change."""
    kept, quantity = run.conservation.standing.conserved is True, Message(run.conservation.quantity)
    return Message("drift of the [[quantity]]" if kept else "change of the [[quantity]]", quantity=quantity)


def motion(found: Animation, sentences: tuple[str, ...]) -> Motion:
    """What the template of the moving system needs."""
    drawn = found.positions
    seen = view(drawn)
    middle, size = _room(found)
    joints, centres = dots(drawn)
    end = float(found.times[-1])
    rate = 1.0 if AS_IT_IS[0] <= end <= AS_IT_IS[1] else end / LASTS
    data = {
        "times": _packed(found.times),
        "places": _packed(drawn.places),
        "ellipsoids": [{"axes": _packed(item.axes), "places": _packed(item.places)} for item in found.ellipsoids],
        **_outlines(found),
        "kinetic": _packed(found.kinetic),
        "energy": _packed(found.energy),
        "drift": _packed(found.drift),
        "links": drawn.links,
        "slides": drawn.slides,
        "joints": joints,
        "centres": centres,
        "trails": moving_points(drawn),
        "basis": [list(direction) for direction in basis(seen.up)],
        "azimuth": seen.azimuth,
        "elevation": seen.elevation,
        "middle": middle,
        "size": size,
        "rate": rate,
    }
    bodies = ", ".join(body.name for body in found.system.bodies)
    moves = found.frames > 1
    units = {"time": pretty(time_unit(found.system)), "measure": pretty(energy_unit(found.system))}
    data |= {name: unit for name, unit in units.items() if unit}
    until = with_unit(f"{end:.6g}", units["time"])
    label = f"{'The moving' if moves else 'The'} system: {bodies}" + (f"; t = 0 to {until}" if moves else "")
    return Motion(embedded(data), label, sentences, moves)


def _outlines(found: Animation) -> dict[str, Any]:
    """Outlines of shapes; nothing where no body has any."""
    made = [
        {
            "axes": _packed(item.axes),
            "places": _packed(item.places),
            "lines": [[[float(f"{x:.6g}") for x in point] for point in line] for line in item.lines],
        }
        for item in found.outlines
    ]
    return {"outlines": made} if made else {}


def _packed(values: Any) -> str:
    """Numbers of single precision, little end first, in base 64: what is not finite stays so."""
    with np.errstate(over="ignore"):
        return b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode()


def _room(found: Animation) -> tuple[list[float], float]:
    """The middle of everything, and the diameter of a ball about it in which everything moves."""
    points = [found.positions.places.transpose(1, 0, 2).reshape(3, -1)]
    for item in found.ellipsoids:
        reach = np.sqrt(np.sum(item.axes**2, axis=0))
        points += [item.places - reach, item.places + reach]
    for outline in found.outlines:
        points += [outline.places - outline.reach, outline.places + outline.reach]
    every = np.concatenate(points, axis=1)
    low, high = np.min(every, axis=1), np.max(every, axis=1)
    middle = (low + high) / 2
    size = 2 * float(np.max(np.linalg.norm(every - middle[:, None], axis=0)))
    return [float(x) for x in middle], size or extent(found.positions)


def run_sentences(run: Simulation) -> Iterator[Message]:
    """What makes it doubtful, how it was integrated, whether it reached its end, what it keeps, how wrong it is."""
    doubts, told, unknown = quality(run)
    yield from (Message("Warning: [[text]].", text=text) for text in doubts)
    error = Message("The error of the run was not estimated.")
    if told:
        error = Message("Error of the run: [[error]].", error=joined(told, "; "))
    if unknown:
        yield error
    setting, unit = replace(run.trajectory.setting, longest=None), pretty(time_unit(run.system))
    how = (
        Message("tolerance [[tolerance]] per step", tolerance=f"{setting.tolerance:g}")
        if setting.step is None
        else None
    )
    how = how or Message("step [[step]]", step=f"{setting.step:g}")
    until = with_unit(f"{float(run.times[-1]):.9g}", unit)
    method, how = run.chosen.method.traits.title, setting_words(setting, run.arithmetic)
    text = "Integrated from t = 0 to [[time]] by [[method]] ([[how]]; [[why]])."
    yield Message(text, time=until, method=method, how=how, why=run.why)
    if not run.whole:
        why = Message(run.ended.kind if run.ended is not None else "interrupted")
        end = with_unit(f"{float(run.chosen.times[-1]):.9g}", unit)
        yield Message("The run ended early ([[why]]); [[time]] was asked for.", why=why, time=end)
    for which, what in energy_lines(run):
        yield Message("Energy ([[which]]): [[what]].", which=which, what=what)
    if not unknown:
        yield error


def drawn_sentences(found: Animation) -> Iterator[Message]:
    """What is drawn, and what is not computed."""
    drawn = found.positions
    if found.frames > 1:
        step = with_unit(f"{float(found.times[1] - found.times[0]):.4g}", pretty(time_unit(found.system)))
        text = (
            "Frames: [[count]] ([[which]]), [[step]] apart; between frames points are joined by straight lines, "
            "nothing is computed there."
        )
        yield Message(text, count=found.frames, which=frames_of(found.stride), step=step)
    if drawn.frame == INERTIAL:
        yield Message("Seen in inertial axes; lines join joints and mass centres.")
    else:
        yield Message("Seen in the frame '[[frame]]'; lines join joints and mass centres.", frame=drawn.frame)
    if drawn.tips:
        yield Message("Lines from a joint with nothing at their end are axes of the body; their length means nothing.")
    if found.outlines:
        yield Message("Outlines are the shapes that the description gives, true to scale; no force depends on them.")
    if found.ellipsoids and found.true_size:
        yield Message("Ellipsoids are homogeneous bodies with the same mass and inertia, true to scale.")
    elif found.ellipsoids:
        yield Message("Ellipsoids are homogeneous bodies with the same mass and inertia, not to scale.")


def frames_of(stride: int) -> Message:
    """Which rows of a run are frames."""
    return Message("every sample") if stride == 1 else Message("one of [[count]] samples", count=stride)
