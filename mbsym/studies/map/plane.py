"""A map of a plane or a line: its verdicts with their theorems, what part of the whole each has, and its files."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

from flint import fmpq

from mbsym.expressions.counting import counted
from mbsym.maps.boundaries import Origin
from mbsym.maps.result import LineMap, Of, PlaneMap, Standing, Stratum
from mbsym.maps.soft_borders import Onset
from mbsym.model.system import System
from mbsym.report.language import Language
from mbsym.report.maps.words import STANDINGS, condition_words, row_words, signature_words, telling
from mbsym.studies.study import Answer, Column, Exit, Line, Rows, line

if TYPE_CHECKING:
    from mbsym.studies.map import Request


def answer(system: System, request: Request, found: PlaneMap | LineMap) -> Answer:
    lines, files = _lines(found), _files(system, request, found)
    if found.check is not None and not found.check.holds:
        return Answer(lines, files, _doubts(found), Exit.FAILED)
    if found.interrupted:
        told = "interrupted; what was proved before that is written"
        return Answer(lines, files, (told,), Exit.INTERRUPTED)
    return Answer(lines, files)


def _doubts(found: PlaneMap | LineMap) -> list[str]:
    """What the map's own check does not confirm."""
    from mbsym.studies.map import MOST_TOLD

    told = []
    for one in found.check.findings[:MOST_TOLD] if found.check is not None else ():
        named = (("region", one.region), ("arc", one.arc), ("corner", one.corner))
        what = next((f"{name} {number}" for name, number in named if number is not None), "the whole")
        told.append(f"withdrawn, as the map's own check fails in {what}: {one.mistake}")
    return told


def _files(system: System, request: Request, found: PlaneMap | LineMap) -> dict[str, str | bytes]:
    from mbsym.report.maps.json import map_json
    from mbsym.report.maps.tex import map_tex

    spoken = Language(request.language)
    files: dict[str, str | bytes] = {}
    if request.pictures and isinstance(found, LineMap):
        from mbsym.report.maps.line_figure import line_figure

        files |= line_figure(system, found, spoken, request.pictures)
    elif request.pictures and isinstance(found, PlaneMap):
        from mbsym.report.maps.figure import map_figure

        files |= map_figure(system, found, spoken, request.pictures)
    if "json" in request.format:
        files["map.json"] = map_json(system, found)
    if "tex" in request.format:
        files["map.tex"] = map_tex(system, found, spoken)
    if (points := request.located[0]) is not None:
        from mbsym.report.maps.located import located_csv

        files["located.csv"] = located_csv(points, found)
    return files


def _lines(found: PlaneMap | LineMap) -> Iterator[Line | Rows]:
    """A row for each verdict, then what there is to know besides."""
    yield _table(found)
    for text in remarks(found):
        yield line(f"  {text}")


def _table(found: PlaneMap | LineMap) -> Rows:
    rows: dict[tuple[str, str], tuple[set[int], float]] = {}
    for stratum, place, (area, _) in zip(found.regions, found.together, found.areas, strict=True):
        parts, total = rows.setdefault(_row(found, stratum), (set(), 0.0))
        rows[_row(found, stratum)] = parts | {place}, total + area
    one_axis = isinstance(found, LineMap)
    columns = (
        Column("verdict" if found.of is Of.STABILITY else "signature of K", fold=True),
        Column("theorem", style="dim", fold=True),
        Column("intervals" if one_axis else "regions", right=True),
        Column("length" if one_axis else "area", right=True),
        Column("of the whole", right=True),
    )
    return Rows(
        columns,
        [
            (verdict, theorem, str(len(parts)), f"{area:.4g}", f"{100 * area / found.whole:.2f} %")
            for (verdict, theorem), (parts, area) in sorted(rows.items(), key=lambda item: -item[1][1])
        ],
    )


def _row(found: PlaneMap | LineMap, stratum: Stratum) -> tuple[str, str]:
    judged = stratum.judged
    if judged is None:
        return STANDINGS[stratum.standing], ""
    if found.of is Of.SIGNATURE:
        return signature_words(judged), ""
    return row_words(judged), judged.verdict.theorem


def remarks(found: PlaneMap | LineMap) -> list[str]:
    """Sentences on what the table does not show."""
    if isinstance(found, LineMap):
        told = [
            f"at {_exactly(there.number)}: {_why(found, one)}"
            for one, there in zip(found.corners, found.line.zeros, strict=True)
            if found.changes(one)
        ]
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
    vanishing = dict.fromkeys(condition_words(one, found.section) for one in found.boundaries.vanishing)
    told += [f"an equality everywhere: {words}" for words in vanishing]
    if found.admissibility.left_out:
        listed = ", ".join(found.admissibility.left_out)
        told.append(f"not expressible in the axes, so not looked at: {listed}")
    large = sum(one.standing is Standing.TOO_LARGE for one in found.strata)
    if large:
        told.append(f"no verdict at {counted(large, 'exact point')} between regions: too large to be decided")
    told += borders(found)
    if found.check is not None and found.check.holds:
        arcs = f" and {counted(found.check.arcs, 'arc')}" if found.check.arcs else ""
        by_balls = f"at {found.check.enclosed} of them eigenvalues in balls confirm the counts"
        if not found.check.enclosed:
            by_balls = "eigenvalues in balls exclude none of the counts, and decide none"
        told.append(f"check: {counted(found.check.points, 'more point')} in regions{arcs} agree; {by_balls}")
    return told


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


def borders_of_slices(planes: Iterable[PlaneMap]) -> Iterator[str]:
    """The same of all slices, counted; map.json has each arc."""
    arcs = [one for plane in planes for one in plane.arcs if one.soft is not None]
    for onset, words in ONSETS.items():
        alike = sum(_onset(one) is onset for one in arcs)
        if alike:
            yield f"imaginary pair, {counted(alike, 'arc')} of slices: {words}"
    changing = sum(_onset(one) is None for one in arcs)
    if changing:
        yield f"imaginary pair, {counted(changing, 'arc')} of slices: soft in parts, hard in others"


def borders(found: PlaneMap | LineMap) -> Iterator[str]:
    """Where a pair of roots is imaginary and the others are to the left: how stability is lost."""
    line = isinstance(found, LineMap)
    strata = [one for one in (found.corners if line else found.arcs) if one.soft is not None]
    for onset, words in ONSETS.items():
        alike = [one for one in strata if _onset(one) is onset]
        if alike:
            places = [_place(found, one) for one in alike]
            yield f"imaginary pair, {', '.join(places)}: {words}"
    for one in strata:
        stretches = one.soft.stretches or () if one.soft is not None else ()
        if len(stretches) > 1:
            name = found.section.axes[stretches[0].axis].name
            parts = [f"{x.onset} for {name} from {float_of(x.start):.6g} to {float_of(x.end):.6g}" for x in stretches]
            yield f"imaginary pair, {_place(found, one)}: {'; '.join(parts)}"


def _onset(one: Stratum) -> Onset | None:
    """That of the whole place; None where it is different along an arc."""
    if one.soft is None or len(one.soft.stretches or ()) > 1:
        return None
    return one.soft.onset


def _place(found: PlaneMap | LineMap, one: Stratum) -> str:
    if isinstance(found, LineMap):
        return f"at {float_of(found.line.zeros[one.number].number):.10g}"
    partial = one.soft is not None and one.soft.stretches is None
    return f"arc {one.number}" + (" (at its point in map.json)" if partial else "")


def float_of(x: Any) -> float:
    """A rational or algebraic number in floats."""
    return float(x.p) / float(x.q) if isinstance(x, fmpq) else float(x)


def _exactly(x: Any) -> str:
    """A rational number, or the first digits of an algebraic one."""
    return str(x) if isinstance(x, fmpq) else f"{float(x):.10g} ({_degree(x)})"


def _degree(x: Any) -> str:
    return f"exactly: a root of a polynomial of degree {int(x.polynomial.degree())}, in map.json"


def _why(found: LineMap, one: Stratum) -> str:
    """The condition that is an equality there, and what is said of the point."""
    of = [found.boundaries.conditions[k] for k in found.line.zeros[one.number].factors]
    words = "; ".join(dict.fromkeys(condition_words(telling(x), found.section) for x in of))
    border = one.judged.border if one.judged is not None else None
    return words + (f": {border}" if border is not None else "")
