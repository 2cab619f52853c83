"""The moving system: snapshots of its bodies as lines, darker as time passes, with the paths of the mass centres.

A planar system is drawn in its plane, any other from an elevated point with the direction away from gravity upwards; a
system whose bodies have no extent as the paths of the tips of its axes, which a body that has no line of its own shows
besides.  ``mass-centres`` shows the places over time.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, floor, log10
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from mbsym.expressions.message import Message
from mbsym.model.quantities import length_unit, time_unit, with_unit
from mbsym.model.system import INERTIAL
from mbsym.numerics.positions import AXIS, JOINT, Positions
from mbsym.picture.looking import looked_at, projection
from mbsym.picture.values import View
from mbsym.report.figures.drawing import pictures, spoken, thinned, title_of
from mbsym.report.outlines import Outline
from mbsym.report.unit_text import labelled, pretty

#: Early and late; the eye reads darker as later, in print too.
_TIME = LinearSegmentedColormap.from_list("time", ["#c3d3e8", "#5b87bd", "#173a6b"])

#: Paths, by body (or by axis).
_PATHS = ("#b3372f", "#2e8b57", "#d9822b", "#8e5ea2", "#17a2b8", "#7a5c3e", "#c2528b", "#6b8e23")

#: About so many snapshots.
SNAPSHOTS = 12

#: At most so many snapshots show shapes: lines of more of them hide each other.
OUTLINED = 6

#: Rows of places over time on one page.
ROWS = 6


def motion_figures(
    positions: Positions, formats: Sequence[str], note: str = "", shapes: Sequence[Outline] = ()
) -> dict[str, bytes]:
    """``motion`` and, where a mass centre moves, ``mass-centres`` in every format, by file name.

    ``shapes`` are outlines of bodies at the same times, in the same frame.
    """
    if len(positions.times) < 2:
        return {}
    drawings = {"motion": lambda: _motion(positions.readable(), note, float(positions.times[-1]), shapes)}
    pages = _pages(positions)
    for number, page in enumerate(pages):
        name = "mass-centres" + (f"-{number + 1}" if number else "")
        title = title_of(positions.system, number + 1, len(pages))
        drawings[name] = lambda page=page, title=title: _histories(positions, page, title, note)  # type: ignore[misc]
    return pictures(drawings, formats)


def view(positions: Positions) -> View:
    """The first look: into the plane of a plane motion, else from above."""
    return looked_at(positions.up, None if positions.plane is None else positions.plane - 1)


# --- the picture ---


class _View:
    """Two directions on the paper, and one towards the eye, in the axes of the frame."""

    def __init__(self, found: Positions) -> None:
        self.plane = found.plane
        self.right, self.up, self.towards = np.array(projection(view(found)))

    def __call__(self, places: Any) -> Any:
        """(..., 3, m) -> (..., 2, m) on the paper."""
        return np.stack([np.tensordot(places, self.right, (-2, 0)), np.tensordot(places, self.up, (-2, 0))], axis=-2)

    def depth(self, places: Any) -> Any:
        return np.tensordot(places, self.towards, (-2, 0))


def _motion(motion: Positions, note: str, end: float, shapes: Sequence[Outline] = ()) -> Figure:
    view, say = _View(motion), spoken(motion.system)
    flat = view(motion.places)
    low, high = np.min(flat, axis=(0, 2)), np.max(flat, axis=(0, 2))
    for shape in shapes:
        whole = view(shape.places[:, : len(motion.times)])
        low = np.minimum(low, np.min(whole, axis=1) - shape.reach)
        high = np.maximum(high, np.max(whole, axis=1) + shape.reach)
    if motion.tips:
        for centre, radius in _spheres(motion, flat):  # the whole sphere on which the tips move
            low, high = np.minimum(low, centre - radius), np.maximum(high, centre + radius)
    spread = np.maximum(high - low, 0.25 * float(np.max(high - low)))
    centre = (low + high) / 2
    low, high = centre - 0.55 * spread, centre + 0.55 * spread
    wide, tall = _paper(high - low)
    figure = Figure(figsize=(wide + 1.9, tall + 1.35 + (0.25 if note else 0)), layout="constrained")
    axis = figure.subplots()
    axis.set_aspect("equal")
    axis.set_xlim(low[0], high[0])
    axis.set_ylim(low[1], high[1])
    step = _step(motion.times)
    shown = _snapshots(motion.times, step)
    time = Normalize(float(motion.times[0]), float(motion.times[-1]))
    if motion.tips:
        _tips(axis, motion, view, flat, shown, time)
    if motion.bodied:
        _paths(axis, motion, view, flat)
        _bodies(axis, motion, flat, shown, time)
        _outlines(axis, motion, view, shapes, shown, time)
    _scale(axis, motion, view)
    from matplotlib.cm import ScalarMappable

    bar = figure.colorbar(ScalarMappable(time, _TIME), ax=axis, shrink=0.75, pad=0.02, aspect=28)
    bar.set_label(labelled("$t$", time_unit(motion.system)).replace(" ", "\n", 1), rotation=0, fontsize=13, labelpad=8)
    bar.outline.set_visible(False)
    handles, labels = axis.get_legend_handles_labels()
    if handles:
        columns = max(1, int(12 * figure.get_figwidth() / (max(map(len, labels)) + 8)))
        figure.legend(
            handles,
            labels,
            loc="outside lower center",
            ncols=min(columns, len(handles)),
            frameon=False,
            fontsize=9,
            title=None if motion.tips else say("paths of the mass centres"),
            title_fontsize=9,
        )
    lines = [title_of(motion.system), *_caption(motion, step, end), note]
    figure.suptitle("\n".join(filter(None, lines)), fontsize=11, parse_math=False)
    return figure


def _caption(motion: Positions, step: float, end: float) -> list[str]:
    last, unit = float(motion.times[-1]), pretty(time_unit(motion.system))
    say = spoken(motion.system)
    reached, whole, every = (with_unit(_rounded(x), unit) for x in (last, end, step))
    span = Message("t = 0 to [[last]] (of [[end]])", last=reached, end=whole)
    shown = [say(Message("t = 0 to [[last]]", last=reached) if last == end else span)]
    if motion.bodied:
        shown.append(say(Message("a snapshot every [[step]]", step=every)))
    frame = [] if motion.frame == INERTIAL else [say(Message("seen in the frame '[[frame]]'", frame=motion.frame))]
    return [", ".join(shown), *frame]


def _rounded(value: float) -> str:
    return f"{float(f'{value:.3g}'):g}"


def _paper(spread: Any) -> tuple[float, float]:
    """Inches for a picture of this shape."""
    ratio = float(spread[1] / spread[0])
    wide = 6.5 if ratio < 0.8 else 5.2 / max(ratio, 1.0) ** 0.5
    return max(wide, 3.6), min(max(wide * ratio, 1.6), 6.5)


def _step(times: Any) -> float:
    """A round distance of about SNAPSHOTS snapshots."""
    ideal = float(times[-1] - times[0]) / SNAPSHOTS
    power = 10.0 ** floor(log10(ideal))
    return min((factor * power for factor in (1, 2, 2.5, 5, 10)), key=lambda x: abs(log10(x / ideal)))


def _snapshots(times: Any, step: float) -> list[int]:
    """The samples nearest to multiples of ``step``."""
    count = int(float(times[-1] - times[0]) / step * (1 + 1e-9)) + 1
    return sorted({int(np.argmin(np.abs(times - (times[0] + k * step)))) for k in range(count)})


def _paths(axis: Any, positions: Positions, view: _View, flat: Any) -> None:
    """The paths of the mass centres, one colour a body; where two coincide the first is drawn."""
    moving, say = positions.moving(positions.centres.values()), spoken(positions.system)
    for place, (body, i) in enumerate(positions.centres.items()):
        if i in moving:
            colour = _PATHS[place % len(_PATHS)]
            label = say(Message("mass centre of [[body]]", body=body)) if positions.tips else body
            axis.plot(*flat[i], color=colour, linewidth=0.9, alpha=0.85, label=label, zorder=2)


def _bodies(axis: Any, motion: Positions, flat: Any, shown: Sequence[int], time: Normalize) -> None:
    thin = max(0.5, 1.0 - 0.02 * len(motion.points))
    for k in shown:
        colour = _TIME(time(motion.times[k]))
        zorder = 3 + k / len(motion.times)
        for pairs, width, dash in ((motion.links, 2.0 * thin, "solid"), (motion.slides, 1.2, (0, (3, 1.5)))):
            ends = [(flat[i, :, k], flat[j, :, k]) for i, j in pairs if j not in motion.tips]
            axis.add_collection(LineCollection(ends, colors=[colour], linewidths=width, linestyles=dash, zorder=zorder))
        joints = [i for i, point in enumerate(motion.points) if i not in motion.centres.values() and point.kind != AXIS]
        axis.plot(*flat[joints, :, k].T, "o", color=colour, markersize=3.2, markerfacecolor="white", zorder=zorder)
        for place, i in enumerate(motion.centres.values()):
            edge = _PATHS[place % len(_PATHS)] if k in (shown[0], shown[-1]) else colour
            size = 5 * thin
            axis.plot(*flat[i, :, k], "o", color=colour, markeredgecolor=edge, markersize=size, zorder=zorder + 0.01)


def _outlines(
    axis: Any, positions: Positions, view: _View, shapes: Sequence[Outline], shown: Sequence[int], time: Normalize
) -> None:
    """The bodies' shapes, thinner than their links, and in every second or third snapshot."""
    every = -(-len(shown) // OUTLINED)
    for k in shown[::-1][::every]:
        colour, zorder = _TIME(time(positions.times[k])), 3 + k / len(positions.times)
        lines = [view(line).T for shape in shapes for line in shape.at(k)]
        axis.add_collection(LineCollection(lines, colors=[colour], linewidths=0.8, zorder=zorder))


def _spheres(positions: Positions, flat: Any) -> list[tuple[Any, float]]:
    """(centre on the paper, radius) of the spheres on which tips of axes move, where these are at rest."""
    joints = {point.body: i for i, point in enumerate(positions.points) if point.kind == JOINT}
    still = set(joints.values()) - set(positions.moving(joints.values()))
    spheres = []
    for body, joint in joints.items():
        own = [i for i in positions.tips if positions.points[i].body == body]
        if own and joint in still:
            radius = float(np.linalg.norm(positions.places[own[0], :, 0] - positions.places[joint, :, 0]))
            spheres.append((flat[joint, :, 0], radius))
    return spheres


def _tips(axis: Any, positions: Positions, view: _View, flat: Any, shown: Sequence[int], time: Normalize) -> None:
    """Paths of the tips of the axes, dimmed behind the sphere; the axes themselves at the start and at the end."""
    joints = {point.body: i for i, point in enumerate(positions.points) if point.kind == JOINT}
    around, say = np.linspace(0, 2 * np.pi, 361), spoken(positions.system)
    for centre, radius in _spheres(positions, flat):
        circle = centre[:, None] + radius * np.array([np.cos(around), np.sin(around)])
        axis.plot(*circle, color="#bbbbbb", linewidth=0.8, zorder=1)
    first = len(positions.centres) if positions.extended else 0  # colours that no path of a mass centre has
    for body, joint in joints.items():
        own = [i for i in positions.tips if positions.points[i].body == body]
        for i in own:
            number = positions.points[i].axis
            colour = _PATHS[(first + number - 1) % len(_PATHS)]
            behind = view.depth(positions.places[i] - positions.places[joint]) < 0
            front = np.where(behind, np.nan, flat[i])
            back = np.where(behind, flat[i], np.nan)
            several = positions.extended or len(joints) > 1
            text = Message("axis [[number]] of the body", number=number)
            label = say(Message("axis [[number]] of [[body]]", number=number, body=body) if several else text)
            axis.plot(*front, color=colour, linewidth=1.1, label=label, zorder=3)
            axis.plot(*back, color=colour, linewidth=0.8, alpha=0.35, zorder=2)
            for k in (shown[0], shown[-1]):
                ends = np.array([flat[joint, :, k], flat[i, :, k]]).T
                dash = "--" if k == shown[0] else "-"
                axis.plot(*ends, dash, color=_TIME(time(positions.times[k])), linewidth=1.3, zorder=4)
                axis.plot(*flat[i, :, k], "o", color=colour, markersize=4, zorder=5)


def _length(positions: Positions) -> str | None:
    """The unit of places; none where only tips of unit vectors are drawn."""
    return length_unit(positions.system) if positions.bodied else None


def _scale(axis: Any, positions: Positions, view: _View) -> None:
    """Numbers along axes that lie in the paper; else the directions of the axes, and a length."""
    if view.plane is not None:
        for label, direction in ((axis.set_xlabel, view.right), (axis.set_ylabel, view.up)):
            number = int(np.argmax(np.abs(direction))) + 1
            text = "axis [[number]]" if direction[number - 1] > 0 else "against axis [[number]]"
            label(labelled(spoken(positions.system)(Message(text, number=number)), _length(positions)))
        axis.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]))
        axis.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]))
        return
    axis.set_axis_off()
    low, high = np.array([axis.get_xlim()[0], axis.get_ylim()[0]]), np.array([axis.get_xlim()[1], axis.get_ylim()[1]])
    length = 0.09 * float(np.max(high - low))
    corner = low + length * np.array([1.0, 1.3])
    for number, direction in enumerate(np.eye(3), start=1):
        tip = length * np.array([direction @ view.right, direction @ view.up])
        axis.annotate(
            "",
            corner + tip,
            corner,
            arrowprops={"arrowstyle": "->", "color": "#444444", "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0},
            annotation_clip=False,
        )
        axis.annotate(
            str(number),
            corner + 1.28 * tip,
            annotation_clip=False,
            ha="center",
            va="center",
            fontsize=9,
            color="#444444",
        )
    if not positions.bodied:
        return
    bar = 10.0 ** floor(log10(0.3 * float(high[0] - low[0])))
    bar = max(x * bar for x in (1, 2, 5) if x * bar <= 0.3 * float(high[0] - low[0]))
    start = np.array([high[0] - bar, low[1]])
    axis.plot([start[0], start[0] + bar], [start[1], start[1]], color="#444444", linewidth=1.6, clip_on=False)
    axis.annotate(
        with_unit(f"{bar:g}", pretty(_length(positions))),
        (start[0] + bar / 2, start[1]),
        (0, 4),
        textcoords="offset points",
        ha="center",
        fontsize=9,
    )


# --- places over time ---


def _pages(positions: Positions) -> list[list[tuple[str, int]]]:
    moving = positions.moving(positions.centres.values())
    rows = [(body, i) for body, i in positions.centres.items() if i in moving]
    count = ceil(len(rows) / ROWS)
    return [rows[k * len(rows) // count : (k + 1) * len(rows) // count] for k in range(count)]


def _histories(positions: Positions, rows: Sequence[tuple[str, int]], title: str, note: str) -> Figure:
    """The coordinates of each mass centre over time, in the axes of the frame, a row a body."""
    figure = Figure(figsize=(8, 0.9 + 1.75 * len(rows) + (0.3 if note else 0)), layout="constrained")
    grid = figure.subplots(len(rows), 1, squeeze=False, sharex=True)[:, 0]
    drawn, say = [number for number in (1, 2, 3) if number != positions.plane], spoken(positions.system)
    for axis, (body, i) in zip(grid, rows, strict=True):
        for number in drawn:
            style = ("-", (0, (5, 2)), (0, (1.5, 1.5)))[number - 1]
            axis.plot(
                *thinned(positions.times, positions.places[i, number - 1]),
                color=_PATHS[number - 1],
                linestyle=style,
                label=say(Message("axis [[number]]", number=number)),
            )
        axis.set_title(body, loc="left", fontsize=10, parse_math=False)
        axis.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10], min_n_ticks=3))
    grid[0].legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=3, frameon=False, fontsize=9, borderaxespad=0.1)
    grid[-1].set_xlabel(labelled("$t$", time_unit(positions.system)))
    grid[-1].set_xlim(0, float(positions.times[-1]))
    text = "places of the mass centres"
    if positions.frame != INERTIAL:
        text = Message("places of the mass centres in the frame '[[frame]]'", frame=positions.frame)
    what = labelled(say(text), length_unit(positions.system))
    lines = (title, what, note)
    figure.suptitle("\n".join(filter(None, lines)), fontsize=11, parse_math=False)
    return figure
