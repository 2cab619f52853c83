"""``mbsym map --of equilibria``: how many relative equilibria there are over a plane."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING

from mbsym.expressions.counting import counted
from mbsym.model.system import System
from mbsym.studies.section import against_sign, unless_parameter
from mbsym.studies.study import Answer, Column, Exit, Line, Rows, Unfit, Watch, line, missing

if TYPE_CHECKING:
    from mbsym.maps.equilibria_map import EquilibriaMap
    from mbsym.studies.map import Request

#: What --of equilibria does not know, and what does the same.
INSTEAD = {
    "--locate": "leave it out; 'mbsym equilibria FILE --set NAME=VALUE' lists and judges them at one point",
    "--by boxes": "leave it out: its regions are exact wherever they can be had",
}


def fitting(request: Request, system: System, typed: Collection[str]) -> Iterator[Unfit]:
    """What keeps numbers of equilibria from being mapped."""
    if "y" not in typed and "x" in typed:
        hint = "give the second parameter as --y, or use mbsym equilibria --vary"
        yield Unfit("--y", "missing-option", "numbers of equilibria are mapped over a plane", hint)
    if "z" in typed:
        hint = "leave it out, and map at some of its values, each with an --out: --set NAME=VALUE"
        yield Unfit("--z", "not-of-equilibria", "there are no slices of numbers of equilibria", hint)
    for option, given in (("--locate", "locate" in typed), ("--by boxes", request.by == "boxes")):
        if given:
            told = "maps of the stability of one motion have it, numbers of equilibria have not"
            yield Unfit(option, "not-of-equilibria", told, INSTEAD[option])
    for option, axis in (("--x", request.x), ("--y", request.y)):
        if axis is not None:
            yield from unless_parameter(option, axis.name, system)
            yield from against_sign(option, axis, system)
    for name in request.values:
        yield from unless_parameter("--set", name, system)
    from mbsym.mechanics.rest import missing_values

    chosen = {axis.name for axis in request.axes}
    lacking = [name for name in missing_values(system, _numbers(system, request)) if name not in chosen]
    if lacking and all(name not in typed or getattr(request, name) is not None for name in ("x", "y", "z")):
        yield missing(lacking, "rational number")


def _numbers(system: System, request: Request) -> Mapping[str, Fraction]:
    """Those of the parameters besides the axes."""
    from mbsym.mechanics.rest import given_values, rational_values

    chosen = {axis.name for axis in request.axes}
    given = given_values(system, {name: x for name, x in request.values.items() if name in system.parameter_names})
    return {name: x for name, x in rational_values(given).items() if name not in chosen}


def mapped(system: System, request: Request, watch: Watch) -> EquilibriaMap:
    """Raises Failure, also where what it stands on was withdrawn."""
    from mbsym.analysis import Analysis
    from mbsym.maps.equilibria_map import equilibria_map
    from mbsym.studies.map import NoMap

    found = equilibria_map(system, (request.axes[0], request.axes[1]), _numbers(system, request), watch)
    withdrawn = Analysis(system, ()).broken(Analysis.equilibria.stands_on)
    if withdrawn is not None:
        raise NoMap(f"no map: {withdrawn.reason}")
    return found


def answer(system: System, request: Request, found: EquilibriaMap) -> Answer:
    from mbsym.maps.equilibria_map import Standing

    lines, files = _lines(system, found), _files(system, request, found)
    fallen = [one.number for one in found.cells if one.standing is Standing.WITHDRAWN]
    if fallen:
        told = f"withdrawn, as another point has another number: region {', '.join(map(str, fallen))}"
        return Answer(lines, files, (told,), Exit.FAILED)
    if found.interrupted:
        told = "interrupted; what was proved before that is written"
        return Answer(lines, files, (told,), Exit.INTERRUPTED)
    return Answer(lines, files)


def _files(system: System, request: Request, found: EquilibriaMap) -> dict[str, str | bytes]:
    from mbsym.report.language import Language
    from mbsym.report.maps.equilibria_map_files import equilibria_map_figure, equilibria_map_json, equilibria_map_tex

    spoken = Language(request.language)
    files: dict[str, str | bytes] = {}
    if request.pictures:
        files |= equilibria_map_figure(system, found, spoken, request.pictures)
    if "json" in request.format:
        files["equilibria-map.json"] = equilibria_map_json(system, found)
    if "tex" in request.format:
        files["equilibria-map.tex"] = equilibria_map_tex(system, found, spoken)
    return files


def _lines(system: System, found: EquilibriaMap) -> Iterator[Line | Rows]:
    """A row for each pair of numbers, then what there is to know besides."""
    from mbsym.maps.equilibria_map import Standing
    from mbsym.report.maps.equilibria_map_words import cell_words

    rows: dict[str, tuple[int, float]] = {}
    for one, (area, _) in zip(found.cells, found.areas, strict=True):
        count, total = rows.get(cell_words(one), (0, 0.0))
        rows[cell_words(one)] = count + 1, total + area
    whole = float(found.arrangement.box.area)
    columns = (
        Column("relative equilibria", fold=True),
        *(Column(name, right=True) for name in ("regions", "area", "of the whole")),
    )
    largest = sorted(rows.items(), key=lambda item: -item[1][1])
    cells = [(told, str(n), f"{area:.4g}", f"{100 * area / whole:.2f} %") for told, (n, area) in largest]
    yield Rows(columns, cells)
    told = [f"{counted(len(found.arrangement.factors), 'curve')}, between which the number is constant"]
    if found.unfinished:
        told = [f"not proved between samples: {'; '.join(found.unfinished)}"]
    told.append("on the curves and where they meet: not counted")
    if any(one.throughout for one in found.cells):
        told.append("'stable' without 'at the sample': at least so many in the whole region, by the signs of K")
    if system.assumptions:
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
    for text in told:
        yield line(f"  {text}")
