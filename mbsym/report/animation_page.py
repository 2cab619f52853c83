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
from mbsym.expressions.counting import counted
from mbsym.model.system import INERTIAL
from mbsym.report.animation import Animation, basis, dots, extent, moving_points, view
from mbsym.report.html_environment import embedded, page
from mbsym.report.simulation_words import conservation_line, error_lines, warnings
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
    parameters = [(item.name, f"{float(values[item.name]):.9g}", item.meaning) for item in system.parameters]
    parameters += [(name, f"{value:.9g}", "initial value") for name, value in start.items()]
    return page(
        "animation.html.j2",
        {},
        ("motion.js",),
        system=system,
        motion=run_motion(found, run),
        parameters=parameters,
        version=__version__,
    )


def run_motion(found: Animation, run: Simulation) -> Motion:
    """What the template needs of a run, with what is to be said of it."""
    shown = motion(found, tuple(_sentences(found, run)))
    # What is conserved drifts by errors alone; anything else may well change.
    what = "drift" if run.conservation.standing.conserved is True else "change"
    return replace(shown, drift_of=f"{what} of the {run.conservation.quantity}")


def motion(found: Animation, sentences: tuple[str, ...]) -> Motion:
    """What the template of the moving system needs."""
    drawn = found.positions
    up, azimuth, elevation = view(drawn)
    middle, size = _room(found)
    joints, centres = dots(drawn)
    end = float(found.times[-1])
    rate = 1.0 if AS_IT_IS[0] <= end <= AS_IT_IS[1] else end / LASTS
    data = {
        "times": _packed(found.times),
        "places": _packed(drawn.places),
        "ellipsoids": [{"axes": _packed(item.axes), "places": _packed(item.places)} for item in found.ellipsoids],
        "kinetic": _packed(found.kinetic),
        "energy": _packed(found.energy),
        "drift": _packed(found.drift),
        "links": drawn.links,
        "slides": drawn.slides,
        "joints": joints,
        "centres": centres,
        "trails": moving_points(drawn),
        "basis": [[float(x) for x in direction] for direction in basis(up)],
        "azimuth": azimuth,
        "elevation": elevation,
        "middle": middle,
        "size": size,
        "rate": rate,
    }
    bodies = ", ".join(body.name for body in found.system.bodies)
    moves = found.frames > 1
    label = f"{'The moving' if moves else 'The'} system: {bodies}" + (f"; t = 0 to {end:.6g}" if moves else "")
    return Motion(embedded(data), label, sentences, moves)


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
    every = np.concatenate(points, axis=1)
    low, high = np.min(every, axis=1), np.max(every, axis=1)
    middle = (low + high) / 2
    size = 2 * float(np.max(np.linalg.norm(every - middle[:, None], axis=0)))
    return [float(x) for x in middle], size or extent(found.positions)


def _sentences(found: Animation, run: Simulation) -> Iterator[str]:
    trajectory, setting = run.trajectory, run.trajectory.setting
    how = f"tolerance {setting.tolerance:g} per step" if setting.step is None else f"step {setting.step:g}"
    yield (
        f"Integrated from t = 0 to {float(trajectory.times[-1]):.9g} by {run.chosen.method.traits.title} ({how}, "
        f"{run.arithmetic}; {run.why})."
    )
    if not run.whole:
        why = run.ended.kind if run.ended is not None else "interrupted"
        yield f"The run ended early ({why}); {float(run.chosen.times[-1]):.9g} was asked for."
    yield f"Energy: {conservation_line(run.conservation)}."
    errors = list(error_lines(run.error))
    yield f"Error of the run: {'; '.join(errors)}." if errors else "The error of the run was not estimated."
    for text in warnings(run.conservation, run.error):
        yield f"Warning: {text}."
    yield from drawn_sentences(found)


def drawn_sentences(found: Animation) -> Iterator[str]:
    """What is drawn, and what is not computed."""
    drawn = found.positions
    if found.frames > 1:
        step = float(found.times[1] - found.times[0])
        which = "every sample" if found.stride == 1 else f"one of {found.stride} samples"
        yield (
            f"{counted(found.frames, 'frame')} ({which} of the run), {step:.4g} apart; between frames points are "
            "joined by straight lines, nothing is computed there."
        )
    where = "inertial axes" if drawn.frame == INERTIAL else f"the frame '{drawn.frame}'"
    yield f"Seen in {where}; lines join joints and mass centres."
    if drawn.tips:
        yield "Lines from a joint with nothing at their end are axes of the body; their length means nothing."
    if found.ellipsoids:
        scale = "true to scale" if found.true_size else "not to scale"
        yield f"Ellipsoids are homogeneous bodies with the same mass and inertia, {scale}."
