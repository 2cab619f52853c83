"""Figures of a trajectory: time histories, phase planes, drift of the energy, as SVG, PNG or PDF.

Drawn without a display, in settings of its own that are put back; equal trajectories give equal bytes (with one
version of matplotlib).
Many coordinates are spread over pages: ``histories.svg``, ``histories-2.svg``, ...
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator
from matplotlib.transforms import ScaledTranslation

from mbsym.expressions.message import Message
from mbsym.formulas.latex import LatexNames
from mbsym.mechanics.variables import angle_denominators
from mbsym.model.quantities import energy_unit, time_unit, unit_of
from mbsym.model.states import InStates
from mbsym.model.system import System
from mbsym.numerics.between import between
from mbsym.numerics.ensembles.ensemble import QUANTILES, Ensemble
from mbsym.numerics.ensembles.variation import NORMAL, Grid, Variation
from mbsym.numerics.simulate import Trajectory
from mbsym.report.figures.drawing import (
    BLUE,
    GREY,
    MOST_VALUES,
    RED,
    pictures,
    saved,
    spoken,
    styled,
    symbol,
    thinned,
    title_of,
)
from mbsym.report.unit_text import labelled

#: Rows of time histories, and rows and columns of phase planes, on one page.
HISTORY_ROWS, PLANE_ROWS, PLANE_COLUMNS = 5, 3, 3

#: Of several curves in one picture: no more are told apart.
COLOURS = (BLUE, RED, "#2e8540", "#8b5fbf", "#c77700", "#00838f")

#: Inches in a legend: a line and what is around it, and a letter.
SAMPLE, LETTER = 0.6, 0.085

#: Planes with more points become pixels.
MOST_POINTS = 20_000

#: Rounding of one double, and where the drift's axis ends: what is exactly zero is drawn there.
ROUNDING, FLOOR = 2.0**-53, 1e-18

#: A curve in a plane turns by no more than this from one drawn point to the next, unless they are so close (as parts
#: of the picture's size); an interval is cut into so many parts at most.
CORNER, CLOSE, MOST_PIECES = np.radians(4), 2e-3, 24


@dataclass(frozen=True)
class Curve:
    """A motion to be drawn, ``label`` beside others.

    ``rates`` are the accelerations, of shape (n, m): with them phase planes are drawn as smooth curves through the
    samples, without them as lines from one to the next.  Of a run in declared variables they are the rates of all of
    these; without them it has no phase planes.
    """

    trajectory: Trajectory
    rates: Any = None
    label: str = ""


def figures(
    trajectory: Trajectory, formats: Sequence[str], note: str = "", conserved: bool = True, rates: Any = None
) -> dict[str, bytes]:
    """Every figure in every format, by file name.

    ``rates`` as those of a ``Curve``.  ``note`` is written under each title (a trajectory that is
    not whole must say so); ``conserved`` says whether the
    energy ought to be constant, so that what it changes by is an error.  A single state gives no figures.
    """
    if len(trajectory.times) < 2:
        return {}
    images = curves([Curve(trajectory, rates)], formats, note)
    with styled():
        return images | saved("drift", _drift(trajectory, note, conserved), formats)


def curves(drawn: Sequence[Curve], formats: Sequence[str], note: str = "") -> dict[str, bytes]:
    """Time histories and phase planes of several motions of one system, by file name."""
    images: dict[str, bytes] = {}
    with styled():
        # One page after the other: a hundred coordinates have fifty of them, and a page in memory is some 20 MB.
        histories = _variables if isinstance(drawn[0].trajectory.system, InStates) else _histories
        for stem, figure in chain(histories(drawn, note), _planes(drawn, note)):
            images |= saved(stem, figure, formats)
            figure.clear()  # a figure and its axes hold each other
    return images


def _page_of(drawn: Sequence[Curve], axis: Any, figure: Figure) -> Figure:
    """The page with what tells several curves apart."""
    if len(drawn) > 1:
        handles, labels = axis.get_legend_handles_labels()
        widest = SAMPLE + LETTER * max(len(label.replace("$", "")) for label in labels)
        columns = max(1, min(len(labels), int(figure.get_figwidth() / widest)))
        figure.legend(handles, labels, loc="outside lower center", ncols=columns, frameon=False, fontsize=9)
    return figure


def _over_time(axis: Any, drawn: Sequence[Curve], place: int) -> None:
    for colour, curve in zip(COLOURS, drawn, strict=False):
        axis.plot(
            *thinned(curve.trajectory.times, curve.trajectory.states[place]), color=colour, label=curve.label or None
        )


def _longest(drawn: Sequence[Curve]) -> Any:
    return max((curve.trajectory.times for curve in drawn), key=lambda times: times[-1])


def _page(width: float, height: float, title: str, note: str) -> Figure:
    figure = Figure(figsize=(width, height), layout="constrained")
    figure.suptitle(title.replace("$", r"\$") + (f"\n{note}" if note else ""), fontsize=12)
    return figure


def _pages(stem: str, items: Sequence[str], size: int, system: System) -> Iterator[tuple[str, list[str], str]]:
    """(file name, items, title) of each page; pages are filled evenly."""
    count = -(-len(items) // size)
    for page in range(count):
        part = list(items[page * len(items) // count : (page + 1) * len(items) // count])
        yield stem + (f"-{page + 1}" if page else ""), part, title_of(system, page + 1, count)


def coordinate_labels(system: System, between: str = " ") -> tuple[dict[str, str], dict[str, str]]:
    """Coordinates and velocities as mathematical text in the user's names, ``between`` them and their units."""
    positions, velocities = {}, {}
    for name, (position, velocity) in _labels(system.coordinates).items():
        positions[name] = position + labelled("", unit_of(system, name)).replace(" ", between, 1)
        velocities[name] = velocity + labelled("", system.units.rate_of(name)).replace(" ", between, 1)
    return positions, velocities


def _histories(drawn: Sequence[Curve], note: str) -> Iterator[tuple[str, Figure]]:
    """q(t) on the left, q'(t) on the right, a row a coordinate."""
    system = drawn[0].trajectory.system
    positions, velocities = coordinate_labels(system, "\n")
    place = {name: i for i, name in enumerate(system.coordinates)}
    for file, names, title in _pages("histories", system.coordinates, HISTORY_ROWS, system):
        figure = _page(10, 1.0 + 1.75 * len(names) + (0.3 if note else 0), title, note)
        axes = figure.subplots(len(names), 2, squeeze=False, sharex=True)
        left = ScaledTranslation(-0.6, 0, figure.dpi_scale_trans)
        for row, name in zip(axes, names, strict=True):
            for side, (axis, label) in enumerate(zip(row, (positions[name], velocities[name]), strict=True)):
                _over_time(axis, drawn, place[name] + side * len(place))
                _label(axis, label)
                axis.yaxis.set_label_coords(0, 0.5, axis.transAxes + left)
        yield file, _ended(figure, axes, drawn)


def _variables(drawn: Sequence[Curve], note: str) -> Iterator[tuple[str, Figure]]:
    """Each variable of a run in declared ones over the time, positions, then speeds."""
    system = drawn[0].trajectory.system
    states = (*system.coordinates, *system.velocities)
    labels, place = _labels(states), {name: i for i, name in enumerate(states)}
    for file, shown, title in _pages("histories", states, 2 * HISTORY_ROWS, system):
        rows = -(-len(shown) // 2)
        figure = _page(10, 1.0 + 1.75 * rows + (0.3 if note else 0), title, note)
        axes = figure.subplots(rows, 2, squeeze=False, sharex=True)
        left = ScaledTranslation(-0.6, 0, figure.dpi_scale_trans)
        for axis, name in zip(axes.T.ravel(), shown, strict=False):
            _over_time(axis, drawn, place[name])
            _label(axis, labels[name][0] + labelled("", unit_of(system, name)).replace(" ", "\n", 1))
            axis.yaxis.set_label_coords(0, 0.5, axis.transAxes + left)
        for axis in axes.T.ravel()[len(shown) :]:
            axis.set_visible(False)
        yield file, _ended(figure, axes, drawn)


def _ended(figure: Figure, axes: Any, drawn: Sequence[Curve]) -> Figure:
    """A page of histories, with the time below the last row."""
    for axis in axes[-1]:
        axis.set_xlabel(labelled("$t$", time_unit(drawn[0].trajectory.system)))
        _span(axis, _longest(drawn))
    return _page_of(drawn, axes.flat[0], figure)


def _labels(states: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Each variable and its rate as mathematical text."""
    names = LatexNames(["t", *states])
    labels = {}
    for name in states:
        symbol = names[name]
        plain = "$\\mathrm{" + name.replace("_", r"\_") + "}$"  # matplotlib knows no \mathtt{a\_b}
        odd = "mathtt" in symbol.stem
        labels[name] = (plain, f"d{plain}/d$t$") if odd else (f"${symbol}$", f"${symbol.accented('dot')}$")
    return labels


def _label(axis: Any, label: str) -> None:
    axis.set_ylabel(label, rotation=0, ha="right", va="center", labelpad=8, fontsize=13)
    axis.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10], min_n_ticks=3))
    low, high = axis.get_ylim()
    size = max(abs(low), abs(high))
    # A constant is drawn as one, not as its rounding.
    if high - low < 1e-9 * size:
        axis.set_ylim(low - 0.05 * size, high + 0.05 * size)


def _span(axis: Any, times: Any) -> None:
    if times[-1] > 0:
        axis.set_xlim(0, times[-1])


def _planes(drawn: Sequence[Curve], note: str) -> Iterator[tuple[str, Figure]]:
    """q' over q, one plane a coordinate, or variable; initial points are marked.  An angle that winds is shown modulo
    2 pi."""
    system = drawn[0].trajectory.system
    if isinstance(system, InStates):
        if any(drawn_curve.rates is None for drawn_curve in drawn):
            return
        states, turning = (*system.coordinates, *system.velocities), {}
        positions = {x: labels[0] + labelled("", unit_of(system, x)) for x, labels in _labels(states).items()}
        velocities = {x: labels[1] for x, labels in _labels(states).items()}
    else:
        states, turning = system.coordinates, angle_denominators(system)
        positions, velocities = coordinate_labels(system)[0], coordinate_labels(system, "\n")[1]
    place = {name: i for i, name in enumerate(states)}
    for file, names, title in _pages("phase-planes", states, PLANE_ROWS * PLANE_COLUMNS, system):
        columns = min(PLANE_COLUMNS, len(names))
        rows = -(-len(names) // columns)
        size = 4.6 if columns == 1 else 3.6
        figure = _page(max(5.4, size * columns), 0.7 + 0.85 * size * rows + (0.3 if note else 0), title, note)
        axes = figure.subplots(rows, columns, squeeze=False).ravel()
        for axis in axes[len(names) :]:
            axis.set_visible(False)
        for axis, name in zip(axes, names, strict=False):
            both = [_curve(drawn_curve, place[name]) for drawn_curve in drawn]
            label = positions[name]
            if turning.get(name) == 1 and any(np.ptp(q) > 3 * np.pi for q, _ in both):
                both = [_wrapped(q, v) for q, v in both]
                label += f"  {spoken(system)('modulo')} $2\\pi$"
                axis.set_xlim(-np.pi, np.pi)
                axis.set_xticks(
                    np.array([-1, -0.5, 0, 0.5, 1]) * np.pi,
                    ["\u2212\u03c0", "\u2212\u03c0/2", "0", "\u03c0/2", "\u03c0"],
                )
            for colour, curve, (q, v) in zip(COLOURS, drawn, both, strict=False):
                axis.plot(q, v, color=colour, linewidth=0.9, rasterized=len(q) > MOST_POINTS, label=curve.label or None)
                axis.plot(q[:1], v[:1], "o", color=RED if len(drawn) == 1 else colour, markersize=4)
            axis.set_xlabel(label, fontsize=12)
            _label(axis, velocities[name])
            if label == positions[name]:
                axis.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10], min_n_ticks=3))
        yield file, _page_of(drawn, axes[0], figure)


def _curve(drawn: Curve, i: int) -> tuple[Any, Any]:
    """q and q' of one coordinate, between the samples too where the curve turns; a variable and its rate."""
    trajectory, rates = drawn.trajectory, drawn.rates
    if isinstance(trajectory.system, InStates):
        return np.asarray(trajectory.states[i], dtype=float), rates[i]
    state = np.asarray(trajectory.states[[i, i + len(trajectory.states) // 2]], dtype=float)
    size = np.ptp(state, axis=1)
    if rates is None or len(trajectory.times) > MOST_POINTS or not np.all(size > 0):
        return state[0], state[1]
    with np.errstate(all="ignore"):
        direction = np.arctan2(rates[i] / size[1], state[1] / size[0])
        turn = np.abs((np.diff(direction) + np.pi) % (2 * np.pi) - np.pi)
        chord = np.hypot(*(np.diff(state, axis=1) / size[:, None]))
        subdivisions = np.minimum(np.ceil(turn / CORNER), np.ceil(chord / CLOSE))
    pieces = np.clip(np.nan_to_num(subdivisions, nan=1.0), 1, MOST_PIECES).astype(int)
    _, (q, v) = between(trajectory.times, state, rates[i : i + 1], pieces)
    return q, v


def _wrapped(q: Any, v: Any) -> tuple[Any, Any]:
    """The angle in [-pi, pi), with a gap where it jumps; the first point stays the first."""
    turns = np.floor((q + np.pi) / (2 * np.pi))
    breaks = np.flatnonzero(np.diff(turns)) + 1
    return np.insert(q - 2 * np.pi * turns, breaks, np.nan), np.insert(v, breaks, np.nan)


def _drift(trajectory: Trajectory, note: str, conserved: bool) -> Figure:
    """|h - h(0)| over the largest kinetic energy on a logarithmic scale, or h itself where it may well change.

    h is the generalised energy, which is the energy where nothing is prescribed.
    """
    figure = _page(10, 3.4 + (0.3 if note else 0), title_of(trajectory.system), note)
    say = spoken(trajectory.system)
    axis = figure.subplots(1, 1)
    axis.set_xlabel(labelled("$t$", time_unit(trajectory.system)))
    energy = "energy" if trajectory.generalized_energy is trajectory.energy else "generalised energy"
    if not conserved:
        axis.plot(*thinned(trajectory.times, trajectory.generalized_energy), color=BLUE)
        axis.set_title(say(energy))
        _label(axis, labelled("$h$", energy_unit(trajectory.system)).replace(" ", "\n", 1))
        _span(axis, trajectory.times)
        return figure
    drift = np.maximum(np.abs(np.asarray(trajectory.drift, dtype=float)), FLOOR)
    axis.set_yscale("log")
    # At the start it is zero by definition.
    axis.plot(*thinned(trajectory.times[1:], drift[1:]), color=BLUE, linewidth=0.9)
    axis.set_ylim(FLOOR, max(float(np.max(drift)), ROUNDING) * 5)
    axis.axhline(ROUNDING, color=GREY, linewidth=0.8, linestyle="--")
    axis.annotate(
        say("rounding of one double"),
        (1, ROUNDING),
        xycoords=("axes fraction", "data"),
        xytext=(-4, -3),
        textcoords="offset points",
        ha="right",
        va="top",
        color="#555555",
        fontsize=9,
    )
    axis.yaxis.set_major_locator(LogLocator(numticks=8))
    axis.yaxis.set_minor_locator(NullLocator())
    axis.set_ylabel(r"$|h-h_0|\,/\,\max T$" if np.any(trajectory.kinetic) else "$|h-h_0|$")
    axis.set_title(say(Message("relative drift of the [[energy]]", energy=Message(energy))))
    _span(axis, trajectory.times)
    return figure


# Fan charts: how the members of an ensemble are spread over time, a panel a coordinate or velocity.


def fan_charts(ensemble: Ensemble, variations: Sequence[Variation], formats: Sequence[str]) -> dict[str, bytes]:
    """``fan.svg`` and ``.png``; further pages, ``fan-2.svg``, where there are many coordinates."""
    system = ensemble.members.dynamics.system
    names = system.coordinates
    count = -(-len(names) // HISTORY_ROWS)
    images: dict[str, bytes] = {}
    for page in range(count):
        part = range(page * len(names) // count, (page + 1) * len(names) // count)
        stem = "fan" + (f"-{page + 1}" if page else "")
        images |= pictures({stem: lambda part=part: _ensemble_figure_page(ensemble, variations, part)}, formats)  # type: ignore[misc]
    return images


def _spread(variation: Variation) -> str:
    """How a parameter or a start is spread, as mathematics: a normal or uniform distribution, or an interval."""
    if isinstance(variation, Grid):
        return rf"{symbol(variation.name)} $= {variation.low:.4g}\ldots {variation.high:.4g}$"
    letter, power = ("N", "^2") if variation.kind == NORMAL else ("U", "")
    return (
        rf"{symbol(variation.name)} $\sim \mathcal{{{letter}}}({variation.first:.4g},\ {variation.second:.4g}{power})$"
    )


def _ensemble_figure_page(ensemble: Ensemble, variations: Sequence[Variation], part: range) -> Figure:
    system = ensemble.members.dynamics.system
    positions, velocities = coordinate_labels(system, "\n")
    say = spoken(system)
    members = Message("members: [[count]]", count=ensemble.count)
    if ensemble.fates:
        members = Message("members: [[count]], ended early: [[lost]]", count=ensemble.count, lost=len(ensemble.fates))
    several = Message("varied: [[count]]", count=len(variations))
    spread = ",  ".join(map(_spread, variations)) if len(variations) <= MOST_VALUES else say(several)
    figure = _page(10, 1.6 + 1.9 * len(part), f"{title_of(system)}: {say(members)}", spread)
    axes = figure.subplots(len(part), 2, squeeze=False, sharex=True)
    drawn: dict[str, Any] = {}
    left = ScaledTranslation(-0.6, 0, figure.dpi_scale_trans)
    for row, place in zip(axes, part, strict=True):
        name = system.coordinates[place]
        for side, (axis, label) in enumerate(zip(row, (positions[name], velocities[name]), strict=True)):
            drawn |= _fan(axis, ensemble, place + side * len(system.coordinates))
            axis.set_ylabel(label, rotation=0, ha="right", va="center", labelpad=8, fontsize=13)
            axis.yaxis.set_label_coords(0, 0.5, axis.transAxes + left)
    for axis in axes[-1]:
        axis.set_xlabel(labelled("$t$", time_unit(system)))
        if ensemble.times[-1] > 0:
            axis.set_xlim(0, ensemble.times[-1])
    figure.legend(
        list(drawn.values()), list(map(say, drawn)), loc="outside lower center", ncols=5, frameon=False, fontsize=9
    )
    return figure


def _fan(axis: Any, ensemble: Ensemble, place: int) -> dict[str, Any]:
    """A panel, and its curves by name."""
    spread, times = ensemble.statistics, ensemble.times
    rows = {chance: row[:, place] for chance, row in zip(QUANTILES, spread.quantiles, strict=True)}
    wide = axis.fill_between(times, rows[0.05], rows[0.95], color=BLUE, alpha=0.18, linewidth=0)
    narrow = axis.fill_between(times, rows[0.25], rows[0.75], color=BLUE, alpha=0.30, linewidth=0)
    (median,) = axis.plot(times, rows[0.5], color=BLUE)
    (mean,) = axis.plot(times, spread.mean[:, place], color=RED, linewidth=0.9, linestyle="--")
    (ends,) = axis.plot(times, spread.least[:, place], color=GREY, linewidth=0.6)
    axis.plot(times, spread.greatest[:, place], color=GREY, linewidth=0.6)
    return {"median": median, "mean": mean, "middle 50 %": narrow, "middle 90 %": wide, "least and greatest": ends}
