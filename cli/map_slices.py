"""The work of ``mbsym map`` over three axes: slices are made, drawn, written and told."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from flint import fmpq
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from mbsym.expressions.counting import counted
from mbsym_cli.console import BAD_INPUT, FAILED, INTERRUPTED, OK, complain, console, printable, reason_of
from mbsym_cli.files import deliver
from mbsym_cli.map_run import MOST_TOLD, Request, watched
from mbsym_cli.options import Options
from mbsym_cli.section_options import complain_unfit

if TYPE_CHECKING:
    from mbsym.maps.result import PlaneMap
    from mbsym.maps.slices import Picture, Stack


def run_slices(request: Request) -> int:
    """The exit code."""
    from mbsym.algebra.failures import Failure
    from mbsym.analysis import Analysis
    from mbsym.maps.given import Unfit
    from mbsym.maps.result import Of
    from mbsym.maps.slices import stack

    started = time.perf_counter()
    try:
        with watched(request.quiet, request.file.name) as watch:
            found = stack(Analysis(request.system), request.axes, request.settings, Of(request.of), watch)
            watch("drawing", 0, 1)
            files = _files(request, found)
        deliver(request.folder, files, "map")
    except Unfit as unfit:
        asked = Options()
        complain_unfit(unfit.complaints, "--x/--y/--z", asked)
        asked.refused(request.file)
        return BAD_INPUT
    except Failure as failure:
        complain(request.file, f"no map: {failure.reason}" + (f"; {failure.remedy}" if failure.remedy else ""))
        return FAILED
    except OSError as error:
        complain(request.file, f"the map cannot be written: {reason_of(error)}")
        return FAILED
    if not request.quiet:
        _show(request, found, list(files), time.perf_counter() - started)
    if not found.sound:
        for told in list(_doubts(found))[:MOST_TOLD]:
            complain(request.file, told)
        return FAILED
    if found.interrupted:
        missing = counted(sum(one.missing == "not reached" for one in found.layers), "slice")
        complain(request.file, f"interrupted; {missing} not reached, what was proved before that is written")
        return INTERRUPTED
    return OK


def _files(request: Request, found: Stack) -> dict[str, str | bytes]:
    from mbsym.report.language import Language

    language = Language(request.language)
    files: dict[str, str | bytes] = {}
    pictures = [kind for kind in request.formats if kind in ("svg", "pdf", "png")]
    if pictures:
        from mbsym.report.maps.slice_figure import slice_figure

        files |= slice_figure(request.system, found, language, pictures)
    if "json" in request.formats:
        from mbsym.report.maps.slice_json import slices_json

        files["map.json"] = slices_json(request.system, found)
    if "tex" in request.formats:
        from mbsym.report.maps.slice_tex import slices_tex

        files["map.tex"] = slices_tex(request.system, found, language)
    if request.points is not None:
        from mbsym.report.maps.slice_located import located_slices

        files["located.csv"] = located_slices(request.points, found)
    return files


# --- the terminal -----------------------------------------------------------------------------------------------------


def _show(request: Request, found: Stack, names: list[str], seconds: float) -> None:
    out = console()
    out.print(Text.assemble((request.system.name, "bold"), (f"  {printable(request.file)}, {seconds:.2f} s", "dim")))
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold cyan")
    table.add_column(found.axis.name, overflow="fold")
    table.add_column("shown at", overflow="fold")
    table.add_column("what is seen, by area", overflow="fold")
    for picture in found.pictures:
        table.add_row(*map(escape, _row(found, picture)))
    out.print(table)
    for line in remarks(found):
        out.print(Text(f"  {line}"))
    out.print(Text.assemble("  files in ", (printable(request.folder), "bold"), ": ", ", ".join(names)))


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
    from mbsym_cli.map_table import borders_of_slices

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
