"""What a sweep says, in sentences for the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mbsym.expressions.message import Counted, Message
from mbsym.sweeps.judged import VERDICT
from mbsym.sweeps.points import Column, Points
from mbsym.sweeps.statistics import LEVEL, Share, Totals

#: Dependences below this are noise and are not listed.
_WORTH_TELLING = 0.01


def sentences(
    points: Points, columns: Sequence[Column], totals: Totals, left_out: Sequence[str]
) -> Iterator[tuple[str, str]]:
    """(title, text)."""
    random = not points.grids and points.sampling == "random"
    if any(column.name == VERDICT.name for column in columns):
        for one in totals.shares(random):
            yield Message(one.word), _share(one)
        if random:
            told = "[[share]]; stable means proved to be, and nothing weaker"
            yield Message("P(stable)"), Message(told, share=_share(totals.stable(random)))
        if totals.singly:
            told = "[[points]] decided one by one, exactly"
            yield Message("near borders"), Message(told, points=Counted(totals.singly, "point"))
    for found in totals.ranges():
        gaps = {"least": f"{found.least:.6g}", "most": f"{found.greatest:.6g}", "mean": f"{found.mean:.6g}"}
        told = Message("[[least]] to [[most]], mean [[mean]]", **gaps)
        if found.missing:
            told = Message("[[range]]; none at [[points]]", range=told, points=Counted(found.missing, "point"))
        yield found.column, told
    yield Message("points"), Message("[[count]] [[how]]", count=f"{totals.points:,}", how=_how(points))
    pairs = [(name, value) for name, value in totals.dependence() if abs(value) >= _WORTH_TELLING]
    if pairs and len(points.names) > 1:
        told = "[[values]] (rank correlation with [[column]])"
        if columns[0].words:
            told = "[[values]] (distance of stable points from unstable ones)"
        values = ", ".join(f"{name} {value:.2f}" for name, value in pairs)
        gaps = {} if columns[0].words else {"column": columns[0].name}
        yield Message("depends on"), Message(told, values=values, **gaps)
    if left_out:
        yield Message("not looked at"), ", ".join(left_out)


def _how(points: Points) -> str:
    if points.grids:
        return f"({' x '.join(str(one.count) for one in points.grids)})"
    told = "drawn at random, seed [[seed]]" if points.sampling == "random" else "of Sobol's sequence, seed [[seed]]"
    return Message(told, seed=points.seed)


def _share(one: Share) -> str:
    told = Message(
        "[[count]] of [[total]] ([[share]])",
        count=f"{one.count:,}",
        total=f"{one.total:,}",
        share=f"{one.count / max(1, one.total):.4%}",
    )
    if one.interval is None:
        return told
    low, high = (f"{end:.5f}" for end in one.interval)
    return Message(
        "[[share]]; probability [[low]] to [[high]] ([[level]] confidence)",
        share=told,
        low=low,
        high=high,
        level=f"{LEVEL:.0%}",
    )
