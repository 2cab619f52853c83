"""What is said and written of a map: what is known of its cells, what part of the whole that is, and its files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from flint import fmpq

from mbsym.algebra.plane import Point
from mbsym.expressions.counting import counted
from mbsym.maps.boundaries import Origin
from mbsym.maps.boxes import BoxMap, Method
from mbsym.maps.equilibria_map import EquilibriaMap
from mbsym.maps.mapping import float_of
from mbsym.maps.result import Cell, Lack, Map, Of
from mbsym.maps.slices import Picture, Stack
from mbsym.maps.soft_borders import Onset
from mbsym.maps.subdivision import End
from mbsym.model.system import System
from mbsym.report.language import Language
from mbsym.report.maps.words import LACKS, cell_words, condition_words, row_words, share, stem, telling
from mbsym.studies.study import Answer, Column, Exit, Line, Rows, line

if TYPE_CHECKING:
    from mbsym.report.maps.located import Points
    from mbsym.studies.map import Request


def answer(system: System, request: Request, found: Map) -> Answer:
    from mbsym.studies.map import MOST_TOLD

    lines = _lines(system, found)
    files = files_of(system, found, request.format, request.language, request.located[0])
    doubts = list(_doubts(found))
    if doubts:
        return Answer(lines, files, doubts[:MOST_TOLD], Exit.FAILED)
    if found.interrupted:
        missed = [one for one in found.layers if one.lack is Lack.NOT_REACHED] if isinstance(found, Stack) else []
        left = f"{counted(len(missed), 'slice')} not reached, " if missed else ""
        white = "; other boxes are white" if isinstance(found, BoxMap) else ""
        told = f"interrupted; {left}what was proved before that is written{white}"
        return Answer(lines, files, (told,), Exit.INTERRUPTED)
    return Answer(lines, files)


def _doubts(found: Map) -> Iterator[str]:
    """What the map's own check does not confirm."""
    from mbsym.report.maps.figure import number

    withdrawn = [one.number for one in found.regions if one.lack is Lack.WITHDRAWN]
    if isinstance(found, EquilibriaMap) and withdrawn:
        yield f"withdrawn, as another point has another number: region {', '.join(map(str, withdrawn))}"
    if not isinstance(found, Stack):
        yield from _findings(found, "")
        return
    for one in found.layers:
        at = f"{found.axis.name} = {number(one.z)}"
        if not one.confirmed:
            told = f"the slice at {number(one.second)}, between the same critical values, does not correspond to it"
            yield f"at {at} the map's own check fails: {told}"
        if one.plane is not None:
            yield from _findings(one.plane, f" at {at}")


def _findings(found: Map, at: str) -> Iterator[str]:
    for one in found.check.findings if found.check is not None else ():
        region = "box" if isinstance(found, BoxMap) else "region"
        names = ((region, one.region), ("arc", one.arc), ("corner", one.corner))
        what = next((f"{name} {number}" for name, number in names if number is not None), "the whole")
        yield f"withdrawn{at}, as the map's own check fails in {what}: {one.mistake}"


def files_of(
    system: System, found: Map, formats: Sequence[str], language: str, points: Points | None = None
) -> dict[str, str | bytes]:
    """The picture, JSON, LaTeX, and the given points located."""
    from mbsym.report.maps.figure import map_figure
    from mbsym.report.maps.json import map_json
    from mbsym.report.maps.located import located_csv
    from mbsym.report.maps.tex import map_tex

    spoken, files = Language(language), dict[str, str | bytes]()
    drawn = [kind for kind in formats if kind in ("svg", "pdf", "png")]
    if drawn:
        files |= map_figure(system, found, spoken, drawn)
    if "json" in formats:
        files[f"{stem(found)}.json"] = map_json(system, found)
    if "tex" in formats:
        files[f"{stem(found)}.tex"] = map_tex(system, found, spoken)
    if points is not None:
        files["located.csv"] = located_csv(points, found)
    return files


# --- the terminal -----------------------------------------------------------------------------------------------------


def _lines(system: System, found: Map) -> Iterator[Line | Rows]:
    """A row for what is said of cells, or for each picture of a stack, then what there is to know besides."""
    yield _pictures(found) if isinstance(found, Stack) else _table(found)
    for text in remarks(found, system):
        yield line(f"  {text}")


def _table(found: Map) -> Rows:
    rows: dict[tuple[str, str], tuple[set[int], float]] = {}
    for cell, place, (area, _) in zip(found.regions, found.together, found.areas, strict=True):
        parts, total = rows.setdefault(row_words(found, cell), (set(), 0.0))
        rows[row_words(found, cell)] = parts | {place}, total + area
    heads = {Of.STABILITY: "verdict", Of.SIGNATURE: "signature of K", Of.EQUILIBRIA: "relative equilibria"}
    one_axis, boxes = len(found.axes) == 1, isinstance(found, BoxMap)
    columns = [Column(heads[found.of], fold=True), Column("theorem", style="dim", fold=True)]
    columns += [
        Column(name, right=True)
        for name in ("boxes" if boxes else "intervals" if one_axis else "regions", "length" if one_axis else "area")
    ]
    columns.append(Column("of the whole", right=True))
    cells = [
        (*words, str(len(parts)), f"{area:.4g}", share(area / found.whole if len(rows) > 1 else 1))
        for words, (parts, area) in sorted(rows.items(), key=lambda item: -item[1][1])
    ]
    if not any(theorem for _, theorem in rows):
        return Rows([columns[0], *columns[2:]], [(words, *others) for words, _, *others in cells])
    return Rows(columns, cells)


def _pictures(found: Stack) -> Rows:
    columns = [Column(name, fold=True) for name in (found.axis.name, "shown at", "what is seen, by area")]
    return Rows(columns, [_picture(found, picture) for picture in found.pictures])


def _picture(found: Stack, picture: Picture) -> tuple[str, str, str]:
    from mbsym.report.maps.figure import number

    shown = found.layers[picture.shown]
    low, closed_low, high, closed_high = found.ends(picture)
    name = found.axis.name
    alone = len(picture.layers) == 1 and shown.critical
    span = f"{number(low)} <{'=' * closed_low} {name} <{'=' * closed_high} {number(high)}" + "*" * bool(picture.unseen)
    told = f"{name} = {number(shown.z)}" if alone else span
    if shown.plane is not None:
        return told, number(shown.z), _seen(shown.plane)
    assert shown.lack is not None
    broken = ", ".join(dict.fromkeys(one.condition.about for one in shown.broken))
    return told, "", LACKS[shown.lack] + (f": {broken}" if broken else "")


def _seen(plane: Map) -> str:
    """What is said, each with what part of the slice it has, the largest first."""
    rows: dict[str, float] = {}
    for one, (area, _) in zip(plane.regions, plane.areas, strict=True):
        words = cell_words(plane, one)
        rows[words] = rows.get(words, 0.0) + area
    largest = sorted(rows.items(), key=lambda item: -item[1])
    return ", ".join(f"{words} {100 * area / plane.whole:.3g}%" for words, area in largest)


# --- remarks ----------------------------------------------------------------------------------------------------------


def remarks(found: Map, system: System | None = None) -> list[str]:
    """Sentences on what the table does not show."""
    match found:
        case Stack():
            told = _of_stack(found)
        case BoxMap():
            told = _of_boxes(found)
        case EquilibriaMap():
            told = _of_equilibria(found, system)
        case _:
            told = _of_cells(found)
    if found.admissibility.left_out:
        told.append(f"not expressible in the axes, so not looked at: {', '.join(found.admissibility.left_out)}")
    planes = found.planes if isinstance(found, Stack) else [found]
    large = sum(one.lack is Lack.TOO_LARGE for plane in planes for one in plane.cells)
    if large:
        told.append(f"no verdict at {counted(large, 'exact point')} between regions: too large to be decided")
    told += borders_of_slices(planes) if isinstance(found, Stack) else borders(found)
    told += _nonlinear(found, planes)
    return told + list(_checked(found, planes))


def _of_cells(found: Map) -> list[str]:
    if len(found.axes) == 1:
        told = [f"at {_exactly(one.sample)}: {_why(found, one)}" for one in found.corners if found.drawn(one)]
    else:
        told = [
            f"{counted(len(found.regions), 'region')}, {counted(len(found.arcs), 'arc')} and "
            f"{counted(len(found.corners), 'corner')} in map.json, each with an exact point"
            + (", also of curves at which no verdict changes" if len({*found.together}) < len(found.regions) else "")
        ]
    kept = (Origin.SIGN, Origin.ASSUMPTION, Origin.INERTIA)
    if all(one.origin in kept for conditions in found.boundaries.conditions for one in conditions):
        told.append("no condition of stability depends on the axes")
    if not any(one.judged is not None for one in found.regions):
        told.append("no verdict anywhere: map.json says at every point what is not kept there")
    vanishing = dict.fromkeys(condition_words(one, found) for one in found.boundaries.vanishing)
    return told + [f"an equality everywhere: {words}" for words in vanishing]


def _of_boxes(found: BoxMap) -> list[str]:
    told = [f"no exact regions: {found.because}; boxes instead"] if found.because else []
    told.append(
        "what is said of a box holds at all of its points: no condition is an equality in it"
        if found.method is Method.BOUNDARIES
        else "what is said of a box holds at all of its points, by theorems for enclosures of the matrices; "
        "these may say less than is true"
    )
    if found.subdivision.end is End.BUDGET:
        told.append(f"{counted(len(found.regions), 'box', 'boxes')}, as many as are made: smaller ones were not tried")
    return [*told, f"white, nothing proved: {share(float(found.subdivision.white))} of the area"]


def _of_equilibria(found: EquilibriaMap, system: System | None) -> list[str]:
    told = [f"{counted(len(found.boundaries.factors), 'curve')}, between which the number is constant"]
    if found.unfinished:
        told = [f"not proved between samples: {'; '.join(found.unfinished)}"]
    told.append("on the curves and where they meet: not counted")
    if any(one.counted is not None and one.counted.throughout for one in found.regions):
        told.append("'stable' without 'at the sample': at least so many in the whole region, by the signs of K")
    if system is not None and system.assumptions:
        told.append("the assumptions of the description, and triangle inequalities of inertias, are not looked at")
    asked = [one.counted for one in found.regions if one.counted is not None and one.counted.confirmed is not None]
    if asked:
        same = sum(one.confirmed == one.count for one in asked)
        exact = "the exact numbers agree, and " if not found.unfinished else ""
        told.append(
            f"check at another point of {counted(len(asked), 'region')}: {exact}Newton's method from many points finds "
            f"no more than the list there; as many as at the sample in {counted(same, 'region')}"
        )
    if any(one.lack is Lack.INCOMPLETE for one in found.regions):
        told.append("where the list is not complete nothing is counted")
    return told


def _of_stack(found: Stack) -> list[str]:
    name = found.axis.name
    critical = [one for one in found.layers if one.critical]
    unseen = [one for one in critical if one.lack is not None and not one.broken]
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
    return told


def _nonlinear(found: Map, planes: Sequence[Map]) -> Iterator[str]:
    """What the nonlinear system shows at single points where the first approximation and the energy show nothing."""
    decided: dict[str, list[str]] = {}
    for plane in planes:
        for one in plane.cells:
            if one.nonlinear is not None:
                point: tuple[Any, ...] = (one.sample,)
                if isinstance(one.sample, Point):
                    point = (one.sample.x, one.sample.y)
                if isinstance(found, Stack):  # the slice's own value; without a rational one nothing is asked
                    point = (*point, plane.values[found.axis.name])
                at = ", ".join(f"{axis.name} = {x}" for axis, x in zip(found.axes, point, strict=True))
                decided.setdefault(one.nonlinear.word.value, []).append(at)
    for word, places in decided.items():
        where = "; ".join(places[:MOST_POINTS]) + ("; ..." if len(places) > MOST_POINTS else "")
        yield f"{word} by the nonlinear system, at the exact point alone: {where}"


def _checked(found: Map, planes: Sequence[Map]) -> Iterator[str]:
    """What the map's own check tried, where it confirms all."""
    checks = [one.check for one in planes if one.check is not None]
    points = sum(one.points for one in checks)
    if not found.sound or not points:
        return
    if isinstance(found, BoxMap):
        yield f"check: at {counted(points, 'random point')} of boxes the verdict at the point alone agrees"
    elif isinstance(found, Stack):
        seconds = sum(one.second is not None and one.confirmed for one in found.layers)
        between = f"between each two of the values, {seconds} in all, " if any(x.critical for x in found.layers) else ""
        if seconds:
            told = f"in regions agree; a second slice {between}corresponds to the first"
            yield f"check: {counted(points, 'more point')} {told}"
    else:
        arcs, enclosed = sum(one.arcs for one in checks), sum(one.enclosed for one in checks)
        by_balls = f"at {enclosed} of them eigenvalues in balls confirm the counts"
        if not enclosed:
            by_balls = "eigenvalues in balls exclude none of the counts, and decide none"
        beside = f" and {counted(arcs, 'arc')}" if arcs else ""
        yield f"check: {counted(points, 'more point')} in regions{beside} agree; {by_balls}"


#: So many points are told; map.json has all.
MOST_POINTS = 6

#: What a border is called; the reason behind the last one is in map.json.
ONSETS = {
    Onset.SOFT: "soft: asymptotically stable at the border, small oscillations arise beyond",
    Onset.HARD: "hard: unstable at the border already",
    Onset.OPEN: "open: terms of third order do not decide, or are not at hand",
    Onset.NEITHER: (
        "neither soft nor hard: roots are to the right on both sides or on none, one side is not judged, or the "
        "equations are exactly linear"
    ),
}


def borders_of_slices(planes: Sequence[Map]) -> Iterator[str]:
    """How stability is lost at imaginary pairs in all slices, counted; map.json has each arc."""
    arcs = [one for plane in planes for one in plane.arcs if one.soft is not None]
    for onset, words in ONSETS.items():
        alike = sum(_onset(one) is onset for one in arcs)
        if alike:
            yield f"imaginary pair, {counted(alike, 'arc')} of slices: {words}"
    changing = sum(_onset(one) is None for one in arcs)
    if changing:
        yield f"imaginary pair, {counted(changing, 'arc')} of slices: soft in parts, hard in others"


def borders(found: Map) -> Iterator[str]:
    """Where a pair of roots is imaginary and the others are to the left: how stability is lost."""
    soft = [one for one in found.borders if one.soft is not None]
    for onset, words in ONSETS.items():
        alike = [_place(found, one) for one in soft if _onset(one) is onset]
        if alike:
            yield f"imaginary pair, {', '.join(alike)}: {words}"
    for one in soft:
        stretches = one.soft.stretches or () if one.soft is not None else ()
        if len(stretches) > 1:
            name = found.axes[stretches[0].axis].name
            parts = [f"{x.onset} for {name} from {float_of(x.start):.6g} to {float_of(x.end):.6g}" for x in stretches]
            yield f"imaginary pair, {_place(found, one)}: {'; '.join(parts)}"


def _onset(one: Cell) -> Onset | None:
    """That of the whole place; None where it is different along an arc."""
    if one.soft is None or len(one.soft.stretches or ()) > 1:
        return None
    return one.soft.onset


def _place(found: Map, one: Cell) -> str:
    if len(found.axes) == 1:
        return f"at {float_of(one.sample):.10g}"
    partial = one.soft is not None and one.soft.stretches is None
    return f"arc {one.number}" + (" (at its point in map.json)" if partial else "")


def _exactly(x: Any) -> str:
    """A rational number, or the first digits of an algebraic one."""
    if isinstance(x, fmpq):
        return str(x)
    return f"{float(x):.10g} (exactly: a root of a polynomial of degree {int(x.polynomial.degree())}, in map.json)"


def _why(found: Map, one: Cell) -> str:
    """The condition that is an equality there, and what is said of the point."""
    of = [found.boundaries.conditions[k] for k in found.place(one).factors]
    words = "; ".join(dict.fromkeys(condition_words(telling(x), found) for x in of))
    border = one.judged.border if one.judged is not None else None
    return words + (f": {border}" if border is not None else "")
