"""The drawing of a system as SVG, in the colours of the page; letters are MathML."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

from markupsafe import Markup

from mbsym.picture.sketch import Dot, Mark, Place, Sketch

#: Pixels of a centimetre, and around everything.
SCALE, MARGIN = 46, 6

#: The room of a letter; it is in its middle.
WIDE, TALL = 120, 26


def svg(found: Sketch, title: Markup, letter: Callable[[Any], Markup]) -> Markup:
    """An ``<svg>``; ``letter`` writes what stands beside the lines."""

    def on(place: Place) -> Place:
        x, y = place
        return SCALE * (x - found.low[0]) + MARGIN, SCALE * (found.high[1] - y) + MARGIN

    wide, tall = (SCALE * (b - a) + 2 * MARGIN for a, b in zip(found.low, found.high, strict=True))
    drawn = Markup("\n").join(_mark(mark, on) for mark in found.marks)
    letters = Markup("\n").join(
        Markup(
            '<foreignObject x="{:.0f}" y="{:.0f}" width="{}" height="{}">'
            '<div xmlns="http://www.w3.org/1999/xhtml" class="letter">{}</div></foreignObject>'
        ).format(on(one.place)[0] - WIDE / 2, on(one.place)[1] - TALL / 2, WIDE, TALL, letter(one.text))
        for one in found.letters
    )
    return Markup(
        '<svg class="drawing" role="img" aria-label="{}" width="{:.0f}" height="{:.0f}" '
        'viewBox="0 0 {:.0f} {:.0f}">\n'
        '<defs><marker id="tip" viewBox="0 0 8 6" markerWidth="8" markerHeight="6" refX="7.5" refY="3" '
        'markerUnits="userSpaceOnUse" orient="auto-start-reverse">'
        '<path class="tip" d="M0 0L8 3L0 6Z"/></marker></defs>\n'
        "{}\n{}\n</svg>"
    ).format(title, wide, tall, wide, tall, drawn, letters)


def _mark(mark: Mark, on: Callable[[Place], Place]) -> Markup:
    if isinstance(mark, Dot):
        x, y = on(mark.place)
        kind = "joint" if mark.open else "centre"
        return Markup('<circle class="{}" cx="{:.1f}" cy="{:.1f}" r="{:.1f}"/>').format(kind, x, y, SCALE * mark.radius)
    points = [on(place) for place in mark.points]
    path = _curve(points, mark.closed) if mark.smooth else "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
    kind = mark.ink.value + (" tint" if mark.tinted else "")
    tips = Markup(' marker-end="url(#tip)"' if mark.arrow else "") + Markup(
        ' marker-start="url(#tip)"' if mark.both else ""
    )
    return Markup('<path class="{}" d="M{}{}"{}/>').format(kind, path, "Z" if mark.closed else "", tips)


def _curve(points: Sequence[Place], closed: bool) -> str:
    """A smooth curve through the points: between two of them its handles are a sixth of the chord around each."""
    ring = [points[-1], *points, points[0], points[1]] if closed else [points[0], *points, points[-1]]
    written = "{:.1f} {:.1f}".format(*points[0])
    for k, (first, second) in enumerate(pairwise(ring[1:-1])):
        before, after = ring[k], ring[k + 3]
        handles = (
            (first[0] + (second[0] - before[0]) / 6, first[1] + (second[1] - before[1]) / 6),
            (second[0] - (after[0] - first[0]) / 6, second[1] - (after[1] - first[1]) / 6),
            second,
        )
        written += "C" + " ".join(f"{x:.1f} {y:.1f}" for x, y in handles)
    return written
