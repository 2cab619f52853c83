"""What a sweep says, in sentences for the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mbsym.expressions.counting import counted
from mbsym.sweeps.judged import VERDICT
from mbsym.sweeps.measure import Column
from mbsym.sweeps.points import Points
from mbsym.sweeps.statistics import LEVEL, Share, Totals

#: Dependences below this are noise and are not listed.
_WORTH_TELLING = 0.01


def sentences(
    points: Points, columns: Sequence[Column], totals: Totals, left_out: Sequence[str]
) -> Iterator[tuple[str, str]]:
    """(title, text)."""
    random = not points.grids and points.sampling == "random"
    yield "points", f"{totals.points:,}{_how(points)}"
    if any(column.name == VERDICT.name for column in columns):
        for one in totals.shares(random):
            yield one.word, _share(one)
        if random:
            yield "P(stable)", f"{_share(totals.stable(random))}; stable means proved to be, and nothing weaker"
        if totals.singly:
            yield "near borders", f"{counted(totals.singly, 'point was', 'points were')} judged singly, exactly"
    for found in totals.ranges():
        missing = f"; {counted(found.missing, 'point has', 'points have')} none" if found.missing else ""
        yield found.column, f"{found.least:.6g} to {found.greatest:.6g}, mean {found.mean:.6g}{missing}"
    pairs = [(name, value) for name, value in totals.dependence() if abs(value) >= _WORTH_TELLING]
    if pairs and len(points.names) > 1:
        judged = bool(columns[0].words)
        kind = "distance of stable points from unstable ones" if judged else f"rank correlation with {columns[0].name}"
        yield "depends on", ", ".join(f"{name} {value:.2f}" for name, value in pairs) + f" ({kind})"
    if left_out:
        yield "not looked at", ", ".join(left_out)


def _how(points: Points) -> str:
    if points.grids:
        return " (" + " x ".join(str(one.count) for one in points.grids) + ")"
    how = "drawn at random" if points.sampling == "random" else "of Sobol's sequence"
    return f" {how}, seed {points.seed}"


def _share(one: Share) -> str:
    told = f"{one.count:,} of {one.total:,} ({one.count / max(1, one.total):.4%})"
    if one.interval is None:
        return told
    low, high = one.interval
    return f"{told}; probability {low:.5f} to {high:.5f} ({LEVEL:.0%} confidence)"
