"""A sweep as files: ``sweep.csv`` or ``sweep.parquet``, a row a point, and ``sweep.json``, what they say on the whole.

Numbers have 17 digits, so that a row can be tried again; words stand for themselves, and what is no number is empty.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from io import BytesIO
from typing import Any

import numpy as np

from mbsym.expressions.message import Counted, Message
from mbsym.model.system import System
from mbsym.numerics.ensembles.variation import Grid, Points, Variation
from mbsym.report.documents import ensemble as doc
from mbsym.report.documents.base import file_of, finite
from mbsym.report.runs.trajectory_csv import header, rows
from mbsym.sweeps.judged import VERDICT, WORDS
from mbsym.sweeps.points import Column
from mbsym.sweeps.statistics import LEVEL, Share, Totals

#: More changes along a parameter are left to the table.
MOST_CHANGES = 6

Part = tuple[Any, Mapping[str, Any]]


def sweep_csv(names: Sequence[str], columns: Sequence[Column], parts: Iterable[Part]) -> Iterator[str]:
    """The file, a chunk after the other; ``parts`` are (points, columns)."""
    yield header([*names, *(column.name for column in columns)])
    for points, measured in parts:
        numbers = [*points, *(measured[column.name] for column in columns if not column.whole)]
        text = rows([np.asarray(row, dtype=float) for row in numbers])
        lines = text.replace("nan", "").split("\n")[:-1]
        tails = [_told(column, measured[column.name]) for column in columns if column.whole]
        if tails and len(tails) == len(columns):  # words and whole numbers alone: they come last anyway
            lines = [",".join(cells) for cells in zip(lines, *tails, strict=True)]
        elif tails:
            raise ValueError("columns of words and of numbers are not mixed")
        yield "\n".join(lines) + "\n"


def _told(column: Column, values: Any) -> list[str]:
    if column.words:
        return np.array(column.words, dtype=object)[values].tolist()
    return list(map(str, values.tolist()))


def sweep_parquet(names: Sequence[str], columns: Sequence[Column], parts: Iterable[Part]) -> bytes:
    """The same as Apache Parquet, a row group a chunk.  Raises ImportError where PyArrow is not installed."""
    import pyarrow
    import pyarrow.parquet

    types = [(name, pyarrow.float64()) for name in names]
    types += [(column.name, _type(pyarrow, column)) for column in columns]
    stream = BytesIO()
    with pyarrow.parquet.ParquetWriter(stream, pyarrow.schema(types)) as writer:
        for points, measured in parts:
            cells = [pyarrow.array(row) for row in points]
            for column, (_, kind) in zip(columns, types[len(names) :], strict=True):
                values = measured[column.name]
                if column.words:
                    cells.append(pyarrow.DictionaryArray.from_arrays(values, list(column.words)))
                else:
                    cells.append(pyarrow.array(values, type=kind))
            writer.write_table(pyarrow.Table.from_arrays(cells, schema=pyarrow.schema(types)))
    return stream.getvalue()


def _type(pyarrow: Any, column: Column) -> Any:
    if column.words:
        return pyarrow.dictionary(pyarrow.int8(), pyarrow.string())
    return pyarrow.int16() if column.whole else pyarrow.float64()


def sweep_json(
    system: System,
    points: Points,
    settings: Mapping[str, str],
    measure: str,
    columns: Sequence[Column],
    totals: Totals,
    table: str,
    left_out: Sequence[str] = (),
) -> str:
    """The file's text; ``table`` is the name of the file of points, ``settings`` what was put in for other names.

    ``left_out``: what parameters have to keep but could not be looked at.
    """
    random = not points.grids and points.sampling == "random"
    judged = any(column.name == VERDICT.name for column in columns)
    return file_of(
        doc.Sweep,
        system,
        totals,
        measure=measure,
        points=points.count,
        table=table,
        varied=[_variation(variation) for variation in points.variations],
        sampling=None if points.grids else points.sampling,
        seed=None if points.grids else points.seed,
        settings=settings,
        columns=[doc.Column.from_result(column) for column in columns],
        shares=[_share(share) for share in totals.shares(random)] if judged else [],
        stable=_share(totals.stable(random)) if judged else None,
        singly=totals.singly if judged else None,
        ranges=[
            doc.Range.from_result(
                extent, least=finite(extent.least), mean=finite(extent.mean), greatest=finite(extent.greatest)
            )
            for extent in totals.ranges()
        ],
        dependence=[doc.Dependence(name=name, value=value) for name, value in totals.dependence()],
        left_out=left_out,
    )


def _variation(varied: Variation) -> doc.Swept:
    if isinstance(varied, Grid):
        return doc.Swept(name=varied.name, kind="grid", low=varied.low, high=varied.high, count=varied.count)
    return doc.Swept.from_result(varied, first=varied.first, second=varied.second)


def _share(share: Share) -> doc.Share:
    interval = None
    if share.interval is not None:
        interval = doc.Interval(low=share.interval[0], high=share.interval[1], confidence=LEVEL)
    return doc.Share.from_result(share, interval=interval)


# What a sweep says, in sentences for the terminal.


#: Dependences below this are noise and are not listed.
_WORTH_TELLING = 0.01


def sentences(
    points: Points, columns: Sequence[Column], totals: Totals, left_out: Sequence[str]
) -> Iterator[tuple[str, str]]:
    """(title, text)."""
    random = not points.grids and points.sampling == "random"
    if any(column.name == VERDICT.name for column in columns):
        for share in totals.shares(random):
            yield Message(share.word), _sweep_words_share(share)
        if random:
            text = "[[share]]; stable means proved to be, and nothing weaker"
            yield Message("P(stable)"), Message(text, share=_sweep_words_share(totals.stable(random)))
        if points.grids and len(totals.changes) <= MOST_CHANGES:
            for (low, before), (high, after) in totals.changes:
                between = f"{points.names[0]} = {low:.6g} .. {high:.6g}"
                text = Message("[[before]], then [[after]]", before=Message(WORDS[before]), after=Message(WORDS[after]))
                yield between, text
    for extent in totals.ranges():
        gaps = {"least": f"{extent.least:.6g}", "most": f"{extent.greatest:.6g}", "mean": f"{extent.mean:.6g}"}
        text = Message("[[least]] to [[most]], mean [[mean]]", **gaps)
        if extent.missing:
            text = Message("[[range]]; none at [[points]]", range=text, points=Counted(extent.missing, "point"))
        yield extent.column, text
    count = f"{totals.points:,}"
    if len(points.grids) == 1:
        yield Message("points"), count
    else:
        yield Message("points"), Message("[[count]] [[how]]", count=count, how=_how(points))
    pairs = [(name, value) for name, value in totals.dependence() if abs(value) >= _WORTH_TELLING]
    if pairs and len(points.names) > 1:
        text = "[[values]] (rank correlation with [[column]]: 0, none; 1 or -1, it alone decides)"
        if columns[0].words:
            text = "[[values]] (0: it makes no difference, 1: it alone decides; distance of stable points from others)"
        values = ", ".join(f"{name} {value:.2f}" for name, value in pairs)
        gaps = {} if columns[0].words else {"column": columns[0].name}
        yield Message("depends on"), Message(text, values=values, **gaps)
    if left_out:
        yield Message("not looked at"), ", ".join(left_out)


def _how(points: Points) -> str:
    if points.grids:
        return f"({' x '.join(str(grid.count) for grid in points.grids)})"
    text = "drawn at random, seed [[seed]]" if points.sampling == "random" else "of Sobol's sequence, seed [[seed]]"
    return Message(text, seed=points.seed)


def _sweep_words_share(share: Share) -> str:
    message = Message(
        "[[count]] of [[total]] ([[share]])",
        count=f"{share.count:,}",
        total=f"{share.total:,}",
        share=f"{100 * share.count / max(1, share.total):.4f}".rstrip("0").rstrip(".") + "%",
    )
    if share.interval is None:
        return message
    low, high = (f"{end:.5f}" for end in share.interval)
    return Message(
        "[[share]]; probability [[low]] to [[high]] ([[level]] confidence)",
        share=message,
        low=low,
        high=high,
        level=f"{LEVEL:.0%}",
    )
