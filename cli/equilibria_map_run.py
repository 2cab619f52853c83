"""``mbsym map --of equilibria``: how many relative equilibria there are over a plane, made, written and told."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from rich.markup import escape
from rich.table import Table
from rich.text import Text

from mbsym.expressions.counting import counted
from mbsym_cli.console import FAILED, INTERRUPTED, OK, complain, console, printable, reason_of
from mbsym_cli.files import deliver
from mbsym_cli.lacking import missing
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from mbsym.maps.equilibria_map import EquilibriaMap
    from mbsym.maps.section import Axis
    from mbsym.model.system import System


@dataclass(frozen=True)
class Request:
    """What was asked for, sound as far as options go."""

    file: Path
    folder: Path
    system: System
    axes: tuple[Axis, Axis]
    values: Mapping[str, Fraction]
    formats: Sequence[str]
    language: str
    quiet: bool


#: What --of equilibria does not know, and what does the same.
INSTEAD = {
    "--locate": "leave it out; 'mbsym equilibria FILE --set NAME=VALUE' lists and judges them at one point",
    "--by boxes": "leave it out: its regions are exact wherever they can be had",
}


def fitting(
    file: Path,
    system: System,
    texts: Sequence[str | None],
    axes: Sequence[Axis],
    settings: Mapping[str, Fraction],
    refused: Sequence[str],
    asked: Options,
) -> dict[str, Fraction]:
    """The numbers of the parameters besides the axes; every complaint joins those of ``asked``.

    ``texts``: what --x, --y and --z said; ``refused``: options of maps of one motion that were given.
    """
    from mbsym.mechanics.rest import given_values, missing_values, rational_values
    from mbsym_cli.equilibria_branches import complain_of_sign, complain_unless_parameter

    if texts[1] is None and texts[0] is not None:
        hint = "give the second parameter as --y, or use mbsym equilibria --vary"
        asked.complain("--y", "missing-option", "numbers of equilibria are mapped over a plane", hint)
    if texts[2] is not None:
        hint = "leave it out, and map at some of its values, each with an --out: --set NAME=VALUE"
        asked.complain("--z", "not-of-equilibria", "there are no slices of numbers of equilibria", hint)
    for option in refused:
        told = "maps of the stability of one motion have it, numbers of equilibria have not"
        asked.complain(option, "not-of-equilibria", told, INSTEAD[option])
    for option, axis in zip(("--x", "--y"), axes, strict=False):
        complain_unless_parameter(option, axis.name, system, asked)
        complain_of_sign(option, axis, system, asked)
    for name in settings:
        complain_unless_parameter("--set", name, system, asked)
    chosen = {axis.name for axis in axes}
    given = given_values(system, {name: x for name, x in settings.items() if name in system.parameter_names})
    values = {name: x for name, x in rational_values(given).items() if name not in chosen}
    lacking = [name for name in missing_values(system, values) if name not in chosen]
    if lacking:
        asked.complaints.append(missing(file, lacking, "rational number"))
    return values


def of_equilibria(
    file: Path,
    folder: Path,
    system: System,
    axes: Sequence[Axis],
    values: Mapping[str, Fraction],
    formats: Sequence[str],
    language: str,
    quiet: bool,
) -> int:
    """The exit code."""
    return run(Request(file, folder, system, (axes[0], axes[1]), values, formats, language, quiet))


def run(request: Request) -> int:
    """The exit code."""
    from mbsym.algebra.failures import Failure
    from mbsym.analysis import Analysis
    from mbsym.maps.equilibria_map import Standing, equilibria_map
    from mbsym.report.language import Language
    from mbsym.report.maps.equilibria_map_files import equilibria_map_figure, equilibria_map_json, equilibria_map_tex
    from mbsym_cli.map_run import watched

    started = time.perf_counter()
    file, language = request.file, Language(request.language)
    files: dict[str, str | bytes] = {}
    try:
        with watched(request.quiet, file.name) as watch:
            found = equilibria_map(request.system, request.axes, request.values, watch)
            withdrawn = Analysis(request.system, ()).broken(Analysis.equilibria.stands_on)
            if withdrawn is not None:
                complain(file, f"no map: {withdrawn.reason}")
                return FAILED
            watch("drawing", 0, 1)
            pictures = [kind for kind in request.formats if kind in ("svg", "pdf", "png")]
            if pictures:
                files |= equilibria_map_figure(request.system, found, language, pictures)
            if "json" in request.formats:
                files["equilibria-map.json"] = equilibria_map_json(request.system, found)
            if "tex" in request.formats:
                files["equilibria-map.tex"] = equilibria_map_tex(request.system, found, language)
        deliver(request.folder, files, "map")
    except Failure as failure:
        complain(file, f"no map: {failure}")
        return FAILED
    except OSError as error:
        complain(file, f"the map cannot be written: {reason_of(error)}")
        return FAILED
    if not request.quiet:
        _show(request, found, list(files), time.perf_counter() - started)
    fallen = [one.number for one in found.cells if one.standing is Standing.WITHDRAWN]
    if fallen:
        complain(file, f"withdrawn, as another point has another number: region {', '.join(map(str, fallen))}")
        return FAILED
    if found.interrupted:
        complain(file, "interrupted; what was proved before that is written")
        return INTERRUPTED
    return OK


def _show(request: Request, found: EquilibriaMap, names: Sequence[str], seconds: float) -> None:
    """A row for each pair of numbers, then what there is to know besides."""
    from mbsym.maps.equilibria_map import Standing
    from mbsym.report.maps.equilibria_map_words import cell_words

    out = console()
    out.print(Text.assemble((request.system.name, "bold"), (f"  {printable(request.file)}, {seconds:.2f} s", "dim")))
    rows: dict[str, tuple[int, float]] = {}
    for one, (area, _) in zip(found.cells, found.areas, strict=True):
        count, total = rows.get(cell_words(one), (0, 0.0))
        rows[cell_words(one)] = count + 1, total + area
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold cyan")
    table.add_column("relative equilibria", overflow="fold")
    for head in ("regions", "area", "of the whole"):
        table.add_column(head, justify="right")
    whole = float(found.arrangement.box.area)
    for words, (count, area) in sorted(rows.items(), key=lambda item: -item[1][1]):
        table.add_row(escape(words), str(count), f"{area:.4g}", f"{100 * area / whole:.2f} %")
    out.print(table)
    told = [f"{counted(len(found.arrangement.factors), 'curve')}, between which the number is constant"]
    if found.unfinished:
        told = [f"not proved between samples: {'; '.join(found.unfinished)}"]
    told.append("on the curves and where they meet: not counted")
    if any(one.throughout for one in found.cells):
        told.append("'stable' without 'at the sample': at least so many in the whole region, by the signs of K")
    if request.system.assumptions:
        told.append("the assumptions of the description, and triangle inequalities of inertias, are not looked at")
    asked = [one for one in found.cells if one.confirmed is not None and one.counted]
    if asked:
        same = sum(one.confirmed == one.count for one in asked)
        exact = "the exact numbers agree, and " if not found.unfinished else ""
        told.append(
            f"check at another point of {counted(len(asked), 'region')}: {exact}Newton's method from many points finds "
            f"no more than the list there; as many as at the sample in {counted(same, 'region')}"
        )
    if any(one.standing is Standing.INCOMPLETE for one in found.cells):
        told.append("where the list is not complete nothing is counted")
    for line in told:
        out.print(Text(f"  {line}"))
    out.print(Text.assemble("  files in ", (printable(request.folder), "bold"), ": ", ", ".join(names)))
