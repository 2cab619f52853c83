"""``mbsym map`` in boxes: asked for with ``--by boxes``, or where an exact arrangement is too large."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

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
    from mbsym.maps.boxes import BoxMap


def run_boxes(request: Request, because: str = "") -> int:
    """The exit code; ``because``: why there is no exact arrangement, empty where boxes were asked for."""
    from mbsym.algebra.failures import Failure
    from mbsym.analysis import Analysis
    from mbsym.maps.boxes import box_map
    from mbsym.maps.given import Unfit
    from mbsym.maps.result import Of

    started = time.perf_counter()
    try:
        with watched(request.quiet, request.file.name) as watch:
            analysis = Analysis(request.system)
            found = box_map(analysis, request.axes, request.settings, Of(request.of), watch, because)
            watch("drawing", 0, 1)
            files = _files(request, found)
        deliver(request.folder, files, "map")
    except Unfit as unfit:
        asked = Options()
        complain_unfit(unfit.complaints, "--x/--y", asked)
        asked.refused(request.file)
        return BAD_INPUT
    except Failure as failure:
        complain(request.file, f"no map: {because}; no boxes: {failure}" if because else f"no map: {failure}")
        return FAILED
    except OSError as error:
        complain(request.file, f"the map cannot be written: {reason_of(error)}")
        return FAILED
    if not request.quiet:
        _show(request, found, list(files), time.perf_counter() - started)
    if found.check is not None and not found.check.holds:
        for one in found.check.findings[:MOST_TOLD]:
            complain(request.file, f"withdrawn, as the map's own check fails in box {one.region}: {one.mistake}")
        return FAILED
    if found.interrupted:
        complain(request.file, "interrupted; the boxes that were proved before that are written, the rest is white")
        return INTERRUPTED
    return OK


def _files(request: Request, found: BoxMap) -> dict[str, str | bytes]:
    from mbsym.report.language import Language
    from mbsym.report.maps.box_map import box_figure, box_json, box_located, box_tex

    language = Language(request.language)
    files: dict[str, str | bytes] = {}
    drawn = [kind for kind in request.formats if kind in ("svg", "pdf", "png")]
    if drawn:
        files |= box_figure(request.system, found, language, drawn)
    if "json" in request.formats:
        files["map.json"] = box_json(request.system, found)
    if "tex" in request.formats:
        files["map.tex"] = box_tex(request.system, found, language)
    if request.points is not None:
        files["located.csv"] = box_located(request.points, found)
    return files


def _show(request: Request, found: BoxMap, names: list[str], seconds: float) -> None:
    out = console()
    out.print(Text.assemble((request.system.name, "bold"), (f"  {printable(request.file)}, {seconds:.2f} s", "dim")))
    out.print(_table(found))
    for line in remarks(found):
        out.print(Text(f"  {line}"))
    out.print(Text.assemble("  files in ", (printable(request.folder), "bold"), ": ", ", ".join(names)))


def _table(found: BoxMap) -> Table:
    from mbsym.maps.result import Of
    from mbsym.report.maps.box_map import row_of, share

    rows: dict[tuple[str, str], list[float]] = {}
    for tile in found.tiles:
        key = ("nothing is proved", "") if tile.proved is None else row_of(found, tile.proved)
        rows.setdefault(key, []).append(float(tile.box.area))
    whole = float(found.subdivision.box.area)
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold cyan")
    table.add_column("verdict" if found.of is Of.STABILITY else "signature of K", overflow="fold")
    table.add_column("theorem", style="dim", overflow="fold")
    for name in ("boxes", "of the whole"):
        table.add_column(name, justify="right")
    for (verdict, theorem), sizes in sorted(rows.items(), key=lambda item: -sum(item[1])):
        table.add_row(escape(verdict), escape(theorem), str(len(sizes)), share(sum(sizes) / whole))
    return table


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
