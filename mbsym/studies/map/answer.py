"""What is said and written of a map: what is known of its cells, what part of the whole that is, and its files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from flint import fmpq

from mbsym.algebra.plane import Point
from mbsym.algebra.plane.numbers import in_square_roots
from mbsym.expressions.message import Counted, Message, joined
from mbsym.expressions.tree import Expression
from mbsym.expressions.tree import text as written
from mbsym.maps.boundaries import Origin
from mbsym.maps.boxes import BoxMap, Method
from mbsym.maps.equilibria_map import EquilibriaMap
from mbsym.maps.mapping import float_of
from mbsym.maps.result import Cell, Lack, Map, Of
from mbsym.maps.slices import Picture, Stack
from mbsym.maps.soft_borders import Onset
from mbsym.maps.subdivision import End
from mbsym.model.system import System
from mbsym.report.content import Block, Table, aligned, column, paragraph
from mbsym.report.language import Language
from mbsym.report.maps.words import cell_words, condition_words, row_words, share, stem, telling
from mbsym.studies.section import against_sign, unless_parameter
from mbsym.studies.study import Answer, Asked, Exit, Unfit, Watch, missing

if TYPE_CHECKING:
    from mbsym.maps.equilibria_map import EquilibriaMap
    from mbsym.report.maps.located import Points
    from mbsym.studies.map import Request


def answer(system: System, request: Request, chart: Map) -> Answer:
    from mbsym.studies.map import MOST_TOLD

    lines = _lines(system, chart)
    files = files_of(system, chart, request.format, request.language or system.language, request.located[0])
    doubts = list(_doubts(chart))
    if doubts:
        return Answer(lines, files, doubts[:MOST_TOLD], Exit.FAILED)
    if chart.interrupted:
        missed = [layer for layer in chart.layers if layer.lack is Lack.NOT_REACHED] if isinstance(chart, Stack) else []
        message = Message("interrupted; what was proved before that is written")
        if missed:
            text = "interrupted; [[missed]] not reached, what was proved before that is written"
            message = Message(text, missed=Counted(len(missed), "slice"))
        if isinstance(chart, BoxMap):
            message = joined((message, Message("other boxes are white")), "; ")
        return Answer(lines, files, (message,), Exit.INTERRUPTED)
    return Answer(lines, files)


def _doubts(chart: Map) -> Iterator[str]:
    """What the map's own check does not confirm."""
    from mbsym.report.maps.figure import number

    withdrawn = [region.number for region in chart.regions if region.lack is Lack.WITHDRAWN]
    if isinstance(chart, EquilibriaMap) and withdrawn:
        text = "withdrawn, as another point has another number: regions [[regions]]"
        yield Message(text, regions=", ".join(map(str, withdrawn)))
    if not isinstance(chart, Stack):
        yield from _findings(chart, "")
        return
    for layer in chart.layers:
        at = f"{chart.axis.name} = {number(layer.z)}"
        if not layer.confirmed:
            text = (
                "at [[at]] the map's own check fails: the slice at [[second]], between the same critical "
                "values, does not "
                "correspond to it"
            )
            yield Message(text, at=at, second=number(layer.second))
        if layer.plane is not None:
            yield from _findings(layer.plane, at)


def _findings(chart: Map, at: str) -> Iterator[str]:
    for flaw in chart.check.findings if chart.check is not None else ():
        what = Message("the whole")
        if flaw.region is not None:
            what = Message("box [[number]]" if isinstance(chart, BoxMap) else "region [[number]]", number=flaw.region)
        elif flaw.arc is not None:
            what = Message("arc [[number]]", number=flaw.arc)
        elif flaw.corner is not None:
            what = Message("corner [[number]]", number=flaw.corner)
        text = "withdrawn, as the map's own check fails in [[what]]: [[mistake]]"
        message = Message(text, what=what, mistake=flaw.mistake)
        yield joined((f"{at}:", message)) if at else message


def files_of(
    system: System, chart: Map, formats: Sequence[str], language: str, points: Points | None = None
) -> dict[str, str | bytes]:
    """The picture, JSON, LaTeX, and the given points located."""
    from mbsym.report.maps.figure import map_figure
    from mbsym.report.maps.json import map_json
    from mbsym.report.maps.located import located_csv
    from mbsym.report.maps.tex import map_tex

    spoken, files = Language(language), dict[str, str | bytes]()
    drawn = [kind for kind in formats if kind in ("svg", "pdf", "png")]
    if drawn:
        files |= map_figure(system, chart, spoken, drawn)
    if "json" in formats:
        files[f"{stem(chart)}.json"] = map_json(system, chart)
    if "tex" in formats:
        files[f"{stem(chart)}.tex"] = map_tex(system, chart, spoken)
    if points is not None:
        files["located.csv"] = located_csv(points, chart)
    return files


# --- the terminal -----------------------------------------------------------------------------------------------------


def _lines(system: System, chart: Map) -> Iterator[Block]:
    """A row for what is said of cells, or for each picture of a stack, then what there is to know besides."""
    yield _pictures(chart) if isinstance(chart, Stack) else _table(chart)
    for text in remarks(chart, system):
        yield paragraph(text)


#: What is said of cells, by what a map is of.
HEADS = {
    Of.STABILITY: Message("verdict"),
    Of.SIGNATURE: Message("signature of K"),
    Of.EQUILIBRIA: Message("relative equilibria"),
}


def _table(chart: Map) -> Table:
    rows: dict[tuple[str, str], tuple[set[int], float]] = {}
    for cell, place, (area, _) in zip(chart.regions, chart.together, chart.areas, strict=True):
        words = row_words(chart, cell)
        parts, total = rows.setdefault(words, (set(), 0.0))
        rows[words] = parts | {place}, total + area
    line = len(chart.axes) == 1
    pieces = Message("boxes") if isinstance(chart, BoxMap) else Message("intervals") if line else Message("regions")
    size = Message("length") if line else Message("area")
    heads = (HEADS[chart.of], Message("theorem"), pieces, size, Message("share"))
    cells = [
        (*words, str(len(parts)), f"{area:.4g}", share(area / chart.whole if len(rows) > 1 else 1))
        for words, (parts, area) in sorted(rows.items(), key=lambda item: -item[1][1])
    ]
    shown = [k for k in range(len(heads)) if k != 1 or any(theorem for _, theorem in rows)]
    columns = (column(heads[k], right=k > 1, fold=k < 2) for k in shown)
    return aligned(columns, ([row[k] for k in shown] for row in cells))


def _pictures(stack: Stack) -> Table:
    heads = (stack.axis.name, Message("shown at"), Message("what is seen, by area"))
    return aligned((column(name, fold=True) for name in heads), [_picture(stack, page) for page in stack.pictures])


def _picture(stack: Stack, picture: Picture) -> tuple[str, str, str]:
    from mbsym.report.maps.figure import number

    shown = stack.layers[picture.shown]
    low, closed_low, high, closed_high = stack.ends(picture)
    name = stack.axis.name
    alone = len(picture.layers) == 1 and shown.critical
    span = f"{number(low)} <{'=' * closed_low} {name} <{'=' * closed_high} {number(high)}" + "*" * bool(picture.unseen)
    label = f"{name} = {number(shown.z)}" if alone else span
    if shown.plane is not None:
        return label, number(shown.z), _seen(shown.plane)
    assert shown.lack is not None
    broken = ", ".join(dict.fromkeys(demand.condition.about for demand in shown.broken))
    return label, "", joined((shown.lack.told, *([broken] if broken else [])), ": ")


def _seen(plane: Map) -> str:
    """What is said, each with what part of the slice it has, the largest first."""
    rows: dict[Message, float] = {}
    for region, (area, _) in zip(plane.regions, plane.areas, strict=True):
        words = cell_words(plane, region)
        rows[words] = rows.get(words, 0.0) + area
    largest = sorted(rows.items(), key=lambda item: -item[1])
    return joined((joined((words, f"{100 * area / plane.whole:.3g}%")) for words, area in largest), ", ")


# --- remarks ----------------------------------------------------------------------------------------------------------


def remarks(chart: Map, system: System | None = None) -> list[str]:
    """Sentences on what the table does not show."""
    match chart:
        case Stack():
            sentences = _of_stack(chart)
        case BoxMap():
            sentences = _of_boxes(chart)
        case EquilibriaMap():
            sentences = _of_equilibria(chart, system)
        case _:
            sentences = _of_cells(chart)
    if chart.admissibility.left_out:
        text = "not expressible in the axes, so not looked at: [[conditions]]"
        sentences.append(Message(text, conditions=", ".join(chart.admissibility.left_out)))
    planes = chart.planes if isinstance(chart, Stack) else [chart]
    large = sum(cell.lack is Lack.TOO_LARGE for plane in planes for cell in plane.cells)
    if large:
        text = "no verdict at [[points]] between regions: too large to be decided"
        sentences.append(Message(text, points=Counted(large, "exact point")))
    sentences += borders_of_slices(planes) if isinstance(chart, Stack) else borders(chart)
    sentences += _nonlinear(chart, planes)
    return sentences + list(_checked(chart, planes))


def _of_cells(chart: Map) -> list[str]:
    if len(chart.axes) == 1:
        corners = [corner for corner in chart.corners if chart.drawn(corner)]
        sentences: list[str] = [
            Message("at [[point]]: [[why]]", point=_exactly(x.sample), why=_why(chart, x)) for x in corners
        ]
    else:
        text = "[[regions]], [[arcs]] and [[corners]] in map.json, each with an exact point"
        if len({*chart.together}) < len(chart.regions):
            text = (
                "[[regions]], [[arcs]] and [[corners]] in map.json, each with an exact point, also of "
                "curves at which no "
                "verdict changes"
            )
        gaps = {"regions": Counted(len(chart.regions), "region"), "arcs": Counted(len(chart.arcs), "arc")}
        gaps["corners"] = Counted(len(chart.corners), "corner")
        sentences = [Message(text, **gaps)]
    origins = (Origin.SIGN, Origin.ASSUMPTION, Origin.INERTIA)
    if all(condition.origin in origins for conditions in chart.boundaries.conditions for condition in conditions):
        open_ = any(region.word is not None and region.word.open for region in chart.regions)
        text = "no condition of stability depends on the axes"
        if open_:
            text = "no condition of the first approximation depends on the axes; terms of higher order may"
        sentences.append(Message(text))
    if not any(region.judged is not None for region in chart.regions):
        sentences.append(Message("no verdict anywhere: map.json says at every point what is not kept there"))
    vanishing = dict.fromkeys(condition_words(condition, chart) for condition in chart.boundaries.vanishing)
    return sentences + [Message("an equality everywhere: [[condition]]", condition=words) for words in vanishing]


def _of_boxes(chart: BoxMap) -> list[str]:
    said: list[str] = []
    if chart.because:
        said.append(Message("no exact regions: [[because]]; boxes instead", because=chart.because))
    if chart.method is Method.BOUNDARIES:
        text = "what is said of a box holds at all of its points: no condition is an equality in it"
    else:
        text = (
            "what is said of a box holds at all of its points, by theorems for enclosures of the "
            "matrices; these may say "
            "less than is true"
        )
    said.append(Message(text))
    if chart.subdivision.end is End.BUDGET:
        text = "[[boxes]], as many as are made: smaller ones were not tried"
        said.append(Message(text, boxes=Counted(len(chart.regions), "box", "boxes")))
    return [*said, Message("white, nothing proved: [[share]] of the area", share=share(float(chart.subdivision.white)))]


def _of_equilibria(chart: EquilibriaMap, system: System | None) -> list[str]:
    curves = Counted(len(chart.boundaries.factors), "curve")
    sentences: list[str] = [Message("[[curves]], between which the number is constant", curves=curves)]
    if chart.unfinished:
        sentences = [Message("not proved between samples: [[what]]", what=joined(chart.unfinished, "; "))]
    sentences.append(Message("on the curves and where they meet: not counted"))
    if any(region.counted is not None and region.counted.throughout for region in chart.regions):
        text = "'stable' without 'at the sample': at least so many in the whole region, by the signs of K"
        sentences.append(Message(text))
    if system is not None and system.assumptions:
        text = "the assumptions of the description, and triangle inequalities of inertias, are not looked at"
        sentences.append(Message(text))
    checked = [
        region.counted
        for region in chart.regions
        if region.counted is not None and region.counted.confirmed is not None
    ]
    if checked:
        text = (
            "check at another point of [[regions]]: Newton's method from many points finds no more than "
            "the list there; "
            "as many as at the sample in [[same]]"
        )
        if not chart.unfinished:
            text = (
                "check at another point of [[regions]]: the exact numbers agree, and Newton's method from many points "
                "finds no more than the list there; as many as at the sample in [[same]]"
            )
        same = Counted(sum(counted.confirmed == counted.count for counted in checked), "region")
        sentences.append(Message(text, regions=Counted(len(checked), "region"), same=same))
    if any(region.lack is Lack.INCOMPLETE for region in chart.regions):
        sentences.append(Message("where the list is not complete nothing is counted"))
    return sentences


def _of_stack(stack: Stack) -> list[str]:
    name = stack.axis.name
    critical = [layer for layer in stack.layers if layer.critical]
    unseen = [layer for layer in critical if layer.lack is not None and not layer.broken]
    text = "the curves are arranged in one way at all values of [[name]], and regions keep their verdicts"
    sentences: list[str] = [Message(text, name=name)]
    if critical:
        text = (
            "[[values]] of [[name]] at which the curves may be arranged in another way; between them "
            "regions are deformed "
            "into each other with their verdicts"
        )
        sentences = [Message(text, values=Counted(len(critical), "value"), name=name)]
    if unseen:
        irrational = sum(not isinstance(layer.z, fmpq) for layer in unseen)
        text = "at [[count]] of these values nothing was looked at ([[irrational]] are irrational)"
        sentences.append(Message(text, count=len(unseen), irrational=irrational))
    if any(picture.unseen and len(picture.layers) > 1 for picture in stack.pictures):
        sentences.append(
            Message(("* but for single values of [[name]] that were not looked at: map.json lists them"), name=name)
        )
    return sentences


def _nonlinear(chart: Map, planes: Sequence[Map]) -> Iterator[str]:
    """What the nonlinear system shows at single points where the first approximation and the energy show nothing."""
    decided: dict[str, list[str]] = {}
    for plane in planes:
        for cell in plane.cells:
            if cell.nonlinear is not None:
                point: tuple[Any, ...] = (cell.sample,)
                if isinstance(cell.sample, Point):
                    point = (cell.sample.x, cell.sample.y)
                if isinstance(chart, Stack):  # the slice's own value; without a rational one nothing is asked
                    point = (*point, plane.values[chart.axis.name])
                told = (written(root) if isinstance(root := in_square_roots(x), Expression) else x for x in point)
                at = ", ".join(f"{axis.name} = {x}" for axis, x in zip(chart.axes, told, strict=True))
                decided.setdefault(cell.nonlinear.word.value, []).append(at)
    for word, places in decided.items():
        where = "; ".join(places[:MOST_POINTS]) + ("; ..." if len(places) > MOST_POINTS else "")
        text = "[[verdict]] by the nonlinear system, at the exact point alone: [[points]]"
        yield Message(text, verdict=Message(word), points=where)


def _checked(chart: Map, planes: Sequence[Map]) -> Iterator[str]:
    """What the map's own check tried, where it confirms all."""
    checks = [plane.check for plane in planes if plane.check is not None]
    points = sum(check.points for check in checks)
    if not chart.sound or not points:
        return
    if isinstance(chart, BoxMap):
        text = "check: at [[points]] of boxes the verdict at the point alone agrees"
        yield Message(text, points=Counted(points, "random point"))
        return
    more = Counted(points, "more point")
    if isinstance(chart, Stack):
        seconds = sum(layer.second is not None and layer.confirmed for layer in chart.layers)
        if seconds and any(x.critical for x in chart.layers):
            text = (
                "check: [[points]] in regions agree; a second slice between each two of the values, "
                "[[seconds]] in all, "
                "corresponds to the first"
            )
            yield Message(text, points=more, seconds=seconds)
        elif seconds:
            yield Message("check: [[points]] in regions agree; a second slice corresponds to the first", points=more)
        return
    arcs, enclosed = sum(check.arcs for check in checks), sum(check.enclosed for check in checks)
    message = Message("check: [[points]] in regions agree", points=more)
    if arcs:
        message = Message("check: [[points]] in regions and [[arcs]] agree", points=more, arcs=Counted(arcs, "arc"))
    by_balls = Message("enclosures of the eigenvalues exclude none of the counts, and decide none")
    if enclosed:
        by_balls = Message("at [[count]] of them enclosures of the eigenvalues confirm the counts", count=enclosed)
    yield joined((message, by_balls), "; ")


#: So many points are told; map.json has all.
MOST_POINTS = 6


def borders_of_slices(planes: Sequence[Map]) -> Iterator[str]:
    """How stability is lost at imaginary pairs in all slices, counted; map.json has each arc."""
    arcs = [one for plane in planes for one in plane.arcs if one.soft is not None]
    for onset in Onset:
        alike = sum(_onset(arc) is onset for arc in arcs)
        if alike:
            yield Message("imaginary pair, [[arcs]] of slices: [[onset]]", arcs=Counted(alike, "arc"), onset=onset.told)
    changing = sum(_onset(arc) is None for arc in arcs)
    if changing:
        text = "imaginary pair, [[arcs]] of slices: soft in parts, hard in others"
        yield Message(text, arcs=Counted(changing, "arc"))


def borders(chart: Map) -> Iterator[str]:
    """Where a pair of roots is imaginary and the others are to the left: how stability is lost."""
    soft = [border for border in chart.borders if border.soft is not None]
    for onset in Onset:
        alike = [_place(chart, border) for border in soft if _onset(border) is onset]
        if alike:
            yield Message("imaginary pair, [[places]]: [[onset]]", places=joined(alike, ", "), onset=onset.told)
    for cell in soft:
        stretches = cell.soft.stretches or () if cell.soft is not None else ()
        if len(stretches) > 1:
            name = chart.axes[stretches[0].axis].name
            ends = [(x.onset, f"{float_of(x.start):.6g}", f"{float_of(x.end):.6g}") for x in stretches]
            text = "[[onset]] for [[name]] from [[start]] to [[end]]"
            parts = [Message(text, onset=Message(o), name=name, start=start, end=end) for o, start, end in ends]
            message = joined(parts, "; ")
            yield Message("imaginary pair, [[places]]: [[onset]]", places=_place(chart, cell), onset=message)


def _onset(cell: Cell) -> Onset | None:
    """That of the whole place; None where it is different along an arc."""
    if cell.soft is None or len(cell.soft.stretches or ()) > 1:
        return None
    return cell.soft.onset


def _place(chart: Map, cell: Cell) -> Message:
    if len(chart.axes) == 1:
        return Message("at [[point]]", point=f"{float_of(cell.sample):.10g}")
    partial = cell.soft is not None and cell.soft.stretches is None
    return Message("arc [[number]] (at its point in map.json)" if partial else "arc [[number]]", number=cell.number)


def _exactly(x: Any) -> str:
    """A rational number, or the first digits of an algebraic one."""
    if isinstance(x, fmpq):
        return str(x)
    text = "[[digits]] (exactly: a root of a polynomial of degree [[degree]], in map.json)"
    return Message(text, digits=f"{float(x):.10g}", degree=int(x.polynomial.degree()))


def _why(chart: Map, cell: Cell) -> Message:
    """The condition that is an equality there, and what is said of the point."""
    of = [chart.boundaries.conditions[k] for k in chart.place(cell).factors]
    words = joined(dict.fromkeys(condition_words(telling(x), chart) for x in of), "; ")
    border = cell.judged.border if cell.judged is not None else None
    return words if border is None else joined((words, Message(border)), ": ")


# ``mbsym map --of equilibria``: what fits, and the numbers of relative equilibria over a plane.


def fitting(context: Asked, request: Request) -> Iterator[Unfit]:
    """What keeps numbers of equilibria from being mapped."""
    system = context.system
    if "y" not in context.typed and "x" in context.typed:
        hint = "give the second parameter as --y, or use mbsym equilibria --vary"
        yield Unfit("--y", "missing-option", "numbers of equilibria are mapped over a plane", hint)
    if "z" in context.typed:
        hint = "leave it out, and map at some of its values, each with an --out: --set NAME=VALUE"
        yield Unfit("--z", "not-of-equilibria", "there are no slices of numbers of equilibria", hint)
    if request.by == "boxes":
        hint = "leave it out: its regions are exact wherever they can be had"
        yield Unfit("--by boxes", "not-of-equilibria", "numbers of equilibria have no boxes", hint)
    for option, axis in (("--x", request.x), ("--y", request.y)):
        if axis is not None:
            yield from unless_parameter(option, axis.name, system)
            yield from against_sign(option, axis, system)
    for name in request.values:
        yield from unless_parameter("--set", name, system)
    from mbsym.mechanics.rest import missing_values

    chosen = {axis.name for axis in request.axes}
    lacking = [name for name in missing_values(system, _numbers(system, request)) if name not in chosen]
    if lacking and all(name not in context.typed or getattr(request, name) is not None for name in ("x", "y", "z")):
        yield missing(lacking, "rational number")


def _numbers(system: System, request: Request) -> Mapping[str, Fraction]:
    """Those of the parameters besides the axes."""
    from mbsym.mechanics.rest import given_values, rational_values

    chosen = {axis.name for axis in request.axes}
    values = given_values(system, {name: x for name, x in request.values.items() if name in system.parameter_names})
    return {name: x for name, x in rational_values(values).items() if name not in chosen}


def mapped(system: System, request: Request, watch: Watch) -> EquilibriaMap:
    """Raises Failure, also where what it stands on was withdrawn."""
    from mbsym.analysis import Analysis
    from mbsym.maps.equilibria_map import equilibria_map
    from mbsym.studies.map import NoMap

    chart = equilibria_map(system, (request.axes[0], request.axes[1]), _numbers(system, request), watch)
    withdrawn = Analysis(system, ()).broken(Analysis.equilibria.stands_on)
    if withdrawn is not None:
        raise NoMap(Message("no map: [[reason]]", reason=withdrawn.reason))
    return chart
