"""The work of ``mbsym map``: the map is made, drawn, written and told."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym_cli.console import BAD_INPUT, FAILED, INTERRUPTED, OK, complain, console, printable, reason_of
from mbsym_cli.files import deliver
from mbsym_cli.options import Options
from mbsym_cli.section_options import complain_unfit

if TYPE_CHECKING:
    from mbsym.maps.result import LineMap, PlaneMap
    from mbsym.maps.section import Axis
    from mbsym.model.system import System
    from mbsym.report.maps.located import Points

#: Larger files of points are not read.
MOST_BYTES = 200_000_000
#: So many mistakes in a file of points are told.
MOST_TOLD = 20


@dataclass(frozen=True)
class Request:
    """What was asked for, sound as far as options go."""

    file: Path
    folder: Path
    system: System
    axes: Sequence[Axis]
    settings: Mapping[str, Fraction]
    of: str
    formats: Sequence[str]
    language: str
    points: Points | None
    quiet: bool
    route: str = "regions"


def read_located(path: Path, axes: Sequence[str], asked: Options) -> Points | None:
    """The points of ``--locate``; every complaint joins those of ``asked``."""
    from mbsym.report.maps.located import read_points

    try:
        if path.stat().st_size > MOST_BYTES:
            asked.complain("--locate", "too-large", f"more than {MOST_BYTES} bytes in {printable(path)}")
            return None
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        asked.complain("--locate", "unreadable", reason_of(error))
        return None
    except UnicodeDecodeError:
        asked.complain("--locate", "unreadable", f"{printable(path)} is no text in UTF-8")
        return None
    if not axes:
        return None  # that is complained about already
    found, wrong = read_points(text, axes)
    hint = f"the columns {' and '.join(axes)} hold rational or decimal numbers"
    for one in wrong[:MOST_TOLD]:
        asked.complain(f"--locate {printable(path)}:{one.line}", "bad-point", one.message, hint)
    if len(wrong) > MOST_TOLD:
        asked.complain(f"--locate {printable(path)}", "bad-point", f"{len(wrong) - MOST_TOLD} more lines are wrong")
    return found


def run(request: Request) -> int:
    """The exit code."""
    from mbsym.algebra.failures import Failure, TooLargeError
    from mbsym.analysis import Analysis
    from mbsym.maps.given import Unfit
    from mbsym.maps.irrational import irrational
    from mbsym.maps.line_map import line_map
    from mbsym.maps.mapping import plane_map
    from mbsym.maps.result import Of

    if len(request.axes) == 3:
        from mbsym_cli.map_slices import run_slices

        return run_slices(request)
    if request.route == "boxes":
        from mbsym_cli.map_boxes import run_boxes

        return run_boxes(request)
    started, of = time.perf_counter(), Of(request.of)
    try:
        with watched(request.quiet, request.file.name) as watch:
            analysis = Analysis(request.system)
            found: PlaneMap | LineMap
            if len(request.axes) == 1:
                found = line_map(analysis, request.axes[0], request.settings, of, watch)
            else:
                found = plane_map(analysis, request.axes, request.settings, of, watch)
            watch("drawing", 0, 1)
            files = _files(request, found)
        deliver(request.folder, files, "map")
    except Unfit as unfit:
        if irrational(unfit) and len(request.axes) == 2 and of is Of.STABILITY:
            from mbsym_cli.map_boxes import run_boxes

            return run_boxes(request)
        asked = Options()
        complain_unfit(unfit.complaints, "--x/--y", asked)
        asked.refused(request.file)
        return BAD_INPUT
    except Failure as failure:
        if isinstance(failure, TooLargeError) and len(request.axes) == 2:
            from mbsym_cli.map_boxes import run_boxes

            return run_boxes(request, str(failure))
        complain(request.file, f"no map: {failure}")
        return FAILED
    except OSError as error:
        complain(request.file, f"the map cannot be written: {reason_of(error)}")
        return FAILED
    if not request.quiet:
        from mbsym_cli.map_table import show_map

        show_map(request.file, request.system, found, request.folder, list(files), time.perf_counter() - started)
    if found.check is not None and not found.check.holds:
        for one in found.check.findings[:MOST_TOLD]:
            named = (("region", one.region), ("arc", one.arc), ("corner", one.corner))
            what = next((f"{name} {number}" for name, number in named if number is not None), "the whole")
            complain(request.file, f"withdrawn, as the map's own check fails in {what}: {one.mistake}")
        return FAILED
    if found.interrupted:
        complain(request.file, "interrupted; what was proved before that is written")
        return INTERRUPTED
    return OK


def _files(request: Request, found: PlaneMap | LineMap) -> dict[str, str | bytes]:
    from mbsym.maps.result import LineMap, PlaneMap
    from mbsym.report.language import Language
    from mbsym.report.maps.json import map_json
    from mbsym.report.maps.tex import map_tex

    language = Language(request.language)
    files: dict[str, str | bytes] = {}
    pictures = [kind for kind in request.formats if kind in ("svg", "pdf", "png")]
    if pictures and isinstance(found, LineMap):
        from mbsym.report.maps.line_figure import line_figure

        files |= line_figure(request.system, found, language, pictures)
    elif pictures and isinstance(found, PlaneMap):
        from mbsym.report.maps.figure import map_figure

        files |= map_figure(request.system, found, language, pictures)
    if "json" in request.formats:
        files["map.json"] = map_json(request.system, found)
    if "tex" in request.formats:
        files["map.tex"] = map_tex(request.system, found, language)
    if request.points is not None:
        from mbsym.report.maps.located import located_csv

        files["located.csv"] = located_csv(request.points, found)
    return files


@contextmanager
def watched(quiet: bool, name: str) -> Iterator[Callable[[str, int, int], None]]:
    """A bar on standard error that says what is being done; nothing where that is no terminal."""
    if quiet or not sys.stderr.isatty():
        yield lambda text, done, whole: None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console(stderr=True), transient=True) as bar:
        task = bar.add_task(printable(name))
        shown = 0.0

        def watch(text: str, done: int, whole: int) -> None:
            nonlocal shown
            now = time.monotonic()
            if now - shown > 0.05 or done == 0:
                shown = now
                bar.update(task, description=f"{printable(name)}: {text}", completed=done, total=max(whole, 1))

        yield watch
