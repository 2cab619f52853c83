"""Slices of three parameters: what is seen between and at critical values of the third, and their files."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from flint import fmpq

from mbsym.expressions.counting import counted
from mbsym.model.system import System
from mbsym.report.language import Language
from mbsym.studies.map.plane import borders_of_slices
from mbsym.studies.study import Answer, Column, Exit, Line, Rows, line

if TYPE_CHECKING:
    from mbsym.maps.result import PlaneMap
    from mbsym.maps.slices import Picture, Stack
    from mbsym.studies.map import Request


def answer(system: System, request: Request, found: Stack) -> Answer:
    from mbsym.studies.map import MOST_TOLD

    lines, files = _lines(found), _files(system, request, found)
    if not found.sound:
        return Answer(lines, files, list(_doubts(found))[:MOST_TOLD], Exit.FAILED)
    if found.interrupted:
        left = counted(sum(one.missing == "not reached" for one in found.layers), "slice")
        told = f"interrupted; {left} not reached, what was proved before that is written"
        return Answer(lines, files, (told,), Exit.INTERRUPTED)
    return Answer(lines, files)


def _files(system: System, request: Request, found: Stack) -> dict[str, str | bytes]:
    spoken = Language(request.language)
    files: dict[str, str | bytes] = {}
    if request.pictures:
        from mbsym.report.maps.slice_figure import slice_figure

        files |= slice_figure(system, found, spoken, request.pictures)
    if "json" in request.format:
        from mbsym.report.maps.slice_json import slices_json

        files["map.json"] = slices_json(system, found)
    if "tex" in request.format:
        from mbsym.report.maps.slice_tex import slices_tex

        files["map.tex"] = slices_tex(system, found, spoken)
    if (points := request.located[0]) is not None:
        from mbsym.report.maps.slice_located import located_slices

        files["located.csv"] = located_slices(points, found)
    return files


def _lines(found: Stack) -> Iterator[Line | Rows]:
    columns = [Column(name, fold=True) for name in (found.axis.name, "shown at", "what is seen, by area")]
    yield Rows(columns, [_row(found, picture) for picture in found.pictures])
    for text in remarks(found):
        yield line(f"  {text}")


def _row(found: Stack, picture: Picture) -> tuple[str, str, str]:
    from mbsym.report.maps.slice_figure import value

    shown = found.layers[picture.shown]
    low, closed_low, high, closed_high = found.ends(picture)
    name = found.axis.name
    alone = len(picture.layers) == 1 and shown.critical
    span = f"{value(low)} <{'=' * closed_low} {name} <{'=' * closed_high} {value(high)}" + "*" * bool(picture.unseen)
    told = f"{name} = {value(shown.z)}" if alone else span
    if shown.plane is not None:
        return told, value(shown.z), _seen(shown.plane)
    assert shown.missing is not None
    broken = ", ".join(dict.fromkeys(one.condition.about for one in shown.broken))
    return told, "", shown.missing.value + (f": {broken}" if broken else "")


def _seen(plane: PlaneMap) -> str:
    """Its verdicts, each with what part of the slice it has, the largest first."""
    from mbsym.report.maps.words import look_words

    rows: dict[str, float] = {}
    for one, (area, _) in zip(plane.regions, plane.areas, strict=True):
        words = look_words(plane, one)
        rows[words] = rows.get(words, 0.0) + area
    return ", ".join(f"{words} {100 * area / plane.whole:.3g}%" for words, area in sorted(rows.items(), key=_largest))


def _largest(item: tuple[str, float]) -> float:
    return -item[1]


def remarks(found: Stack) -> list[str]:
    """Sentences on what the table does not show."""
    name = found.axis.name
    critical = [one for one in found.layers if one.critical]
    unseen = [one for one in critical if one.missing is not None and not one.broken]
    told = [
        f"{counted(len(critical), 'value')} of {name} at which the curves may be arranged in another way; between them "
        "regions are deformed into each other with their verdicts"
        if critical
        else f"the curves are arranged in one way at all values of {name}, and regions keep their verdicts"
    ]
    if unseen:
        irrational = sum(not isinstance(one.z, fmpq) for one in unseen)
        told.append(f"at {len(unseen)} of these values nothing was looked at ({irrational} are irrational)")
    if any(one.unseen and len(one.layers) > 1 for one in found.pictures):
        told.append(f"* but for single values of {name} that were not looked at: map.json lists them")
    if found.admissibility.left_out:
        told.append(f"not expressible in the axes, so not looked at: {', '.join(found.admissibility.left_out)}")
    large = sum(one.standing == "too large to be decided" for plane in _planes(found) for one in plane.strata)
    if large:
        told.append(f"no verdict at {counted(large, 'exact point')} between regions: too large to be decided")
    told += borders_of_slices(_planes(found))
    seconds = sum(one.second is not None and one.confirmed for one in found.layers)
    checks = [plane.check for plane in _planes(found) if plane.check is not None]
    if seconds and found.sound:
        told.append(
            f"check: {counted(sum(one.points for one in checks), 'more point')} in regions agree; a second slice "
            + (f"between each two of the values, {seconds} in all, corresponds" if critical else "corresponds")
            + " to the first"
        )
    return told


def _planes(found: Stack) -> Iterator[Any]:
    return (one.plane for one in found.layers if one.plane is not None)


def _doubts(found: Stack) -> Iterator[str]:
    """What the checks do not confirm."""
    from mbsym.report.maps.slice_figure import value

    for one in found.layers:
        where = f"{found.axis.name} = {value(one.z)}"
        if not one.confirmed:
            told = f"the slice at {value(one.second)}, between the same critical values, does not correspond to it"
            yield f"at {where} the map's own check fails: {told}"
        if one.plane is not None and one.plane.check is not None:
            for finding in one.plane.check.findings:
                yield f"withdrawn at {where}, as the map's own check fails: {finding.mistake}"
