"""A map in boxes: asked for with ``--by boxes``, or where an exact arrangement is too large."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.expressions.counting import counted
from mbsym.model.system import System
from mbsym.report.language import Language
from mbsym.studies.study import Answer, Column, Exit, Line, Rows, line

if TYPE_CHECKING:
    from mbsym.maps.boxes import BoxMap
    from mbsym.studies.map import Request


def answer(system: System, request: Request, found: BoxMap) -> Answer:
    from mbsym.studies.map import MOST_TOLD

    lines, files = _lines(found), _files(system, request, found)
    if found.check is not None and not found.check.holds:
        doubts = [
            f"withdrawn, as the map's own check fails in box {one.region}: {one.mistake}"
            for one in found.check.findings[:MOST_TOLD]
        ]
        return Answer(lines, files, doubts, Exit.FAILED)
    if found.interrupted:
        told = "interrupted; the boxes that were proved before that are written, the rest is white"
        return Answer(lines, files, (told,), Exit.INTERRUPTED)
    return Answer(lines, files)


def _files(system: System, request: Request, found: BoxMap) -> dict[str, str | bytes]:
    from mbsym.report.maps.box_map import box_figure, box_json, box_located, box_tex

    spoken = Language(request.language)
    files: dict[str, str | bytes] = {}
    if request.pictures:
        files |= box_figure(system, found, spoken, request.pictures)
    if "json" in request.format:
        files["map.json"] = box_json(system, found)
    if "tex" in request.format:
        files["map.tex"] = box_tex(system, found, spoken)
    if (points := request.located[0]) is not None:
        files["located.csv"] = box_located(points, found)
    return files


def _lines(found: BoxMap) -> Iterator[Line | Rows]:
    yield _table(found)
    for text in remarks(found):
        yield line(f"  {text}")


def _table(found: BoxMap) -> Rows:
    from mbsym.maps.result import Of
    from mbsym.report.maps.box_map import row_of, share

    rows: dict[tuple[str, str], list[float]] = {}
    for tile in found.tiles:
        key = ("nothing is proved", "") if tile.proved is None else row_of(found, tile.proved)
        rows.setdefault(key, []).append(float(tile.box.area))
    whole = float(found.subdivision.box.area)
    columns = (
        Column("verdict" if found.of is Of.STABILITY else "signature of K", fold=True),
        Column("theorem", style="dim", fold=True),
        Column("boxes", right=True),
        Column("of the whole", right=True),
    )
    largest = sorted(rows.items(), key=lambda item: -sum(item[1]))
    return Rows(columns, [(*key, str(len(sizes)), share(sum(sizes) / whole)) for key, sizes in largest])


def remarks(found: BoxMap) -> list[str]:
    """Sentences on what the table does not show."""
    from mbsym.maps.boxes import Method
    from mbsym.maps.subdivision import End
    from mbsym.report.maps.box_map import share

    told = [f"no exact regions: {found.because}; boxes instead"] if found.because else []
    told.append(
        "what is said of a box holds at all of its points: no condition is an equality in it"
        if found.method is Method.BOUNDARIES
        else "what is said of a box holds at all of its points, by theorems for enclosures of the matrices; "
        "these may say less than is true"
    )
    if found.subdivision.end is End.BUDGET:
        told.append(f"{counted(len(found.tiles), 'box', 'boxes')}, as many as are made: smaller ones were not tried")
    told.append(f"white, nothing proved: {share(found.subdivision.white)} of the area")
    if found.admissibility.left_out:
        told.append(f"not expressible in the axes, so not looked at: {', '.join(found.admissibility.left_out)}")
    if found.check is not None and found.check.holds and found.check.points:
        told.append(
            f"check: at {counted(found.check.points, 'random point')} of boxes the verdict at the point alone agrees"
        )
    return told
