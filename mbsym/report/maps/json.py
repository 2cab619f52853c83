"""A map as JSON: every cell with its exact point, what was proved there, and the polynomials of its borders."""

from __future__ import annotations

from itertools import count
from typing import Any

from msgspec import UNSET

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.plane.line import Line
from mbsym.maps.boundaries import Boundaries
from mbsym.maps.boxes import BoxMap
from mbsym.maps.branches_result import Branches
from mbsym.maps.equilibria_map import EquilibriaMap
from mbsym.maps.result import Cell, Counted, Lack, Map
from mbsym.maps.slices import Layer, Picture, Stack
from mbsym.model.system import System
from mbsym.report.documents import branches
from mbsym.report.documents import map as doc
from mbsym.report.documents.base import file_of


def map_json(system: System, chart: Map) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    values = {name: str(value) for name, value in sorted(chart.values.items())}
    if isinstance(chart, Branches):
        return file_of(
            branches.Branches,
            system,
            chart,
            values=values,
            parameter=chart.axes[0],
            intervals=[_interval(chart, interval) for interval in chart.intervals],
            critical_values=[_critical(chart, critical) for critical in chart.criticals],
        )
    if isinstance(chart, EquilibriaMap):
        return file_of(
            branches.EquilibriaMap,
            system,
            chart,
            values=values,
            curves=[(k, p, [x.origin for x in conditions]) for k, p, conditions in _curves(chart.boundaries)],
            regions=[_numbered(region, area) for region, (area, _) in zip(chart.regions, chart.areas, strict=True)],
        )
    return file_of(
        doc.Map,
        system,
        chart,
        values=values,
        demands=[doc.Demand.from_result(x.condition, relation=x.relation) for x in chart.admissibility.demands],
        curves=_curves(chart.boundaries),
        **_places(None if isinstance(chart, BoxMap | Stack) else chart),
        pictures=[_picture(chart, picture) for picture in chart.pictures] if isinstance(chart, Stack) else UNSET,
        slices=[_layer(chart, layer) for layer in chart.layers] if isinstance(chart, Stack) else UNSET,
        subdivision=_boxes(chart) if isinstance(chart, BoxMap) else UNSET,
    )


def _curves(boundaries: Boundaries, start: int = 0) -> list[tuple[Any, ...]]:
    """The boundary polynomials from number ``start`` on, each with its number and its conditions."""
    return list(zip(count(), boundaries.factors, boundaries.conditions))[start:]


def _places(chart: Map | None) -> dict[str, Any]:
    """Regions, arcs and corners; of a line intervals, with their ends, and points."""
    if chart is None:
        return {"regions": [], "arcs": [], "corners": []}
    line = isinstance(chart.ground, Line)
    return {
        "regions": [
            doc.Region.from_result(
                region,
                signs=there.signs,
                arcs=[] if line else there.arcs,
                ends=there.ends if line else UNSET,
                area=area,
                area_error=error,
            )
            for region, (area, error) in zip(chart.regions, chart.areas, strict=True)
            for there in [chart.place(region)]
        ],
        "arcs": [
            doc.Arc.from_result(
                arc,
                soft_or_hard=arc.soft,
                curves=there.factors,
                regions=there.regions,
                corners=there.corners,
                separates=chart.separates(arc),
            )
            for arc in chart.arcs
            for there in [chart.place(arc)]
        ],
        "corners": [
            doc.Corner.from_result(
                corner,
                soft_or_hard=corner.soft,
                curves=there.factors,
                arcs=[] if line else there.arcs,
                kind="zero" if line else str(there.kind),
            )
            for corner in chart.corners
            for there in [chart.place(corner)]
        ],
    }


def _boxes(chart: BoxMap) -> doc.Subdivision:
    """Each statement once, and the boxes with the numbers of theirs; exact edges."""
    statements: list[Cell] = []
    places: dict[tuple[object, ...], int] = {}
    boxes = []
    for cell, tile in zip(chart.regions, chart.subdivision.tiles, strict=True):
        key = (*cell.kind, tuple(x.condition.about for x in cell.broken), cell.judged and cell.judged.null)
        if cell.lack is not Lack.UNPROVED and key not in places:
            places[key] = len(statements)
            statements.append(cell)
        boxes.append(((tile.box.x0, tile.box.x1, tile.box.y0, tile.box.y1), places.get(key)))
    return doc.Subdivision.from_result(chart, statements=statements, boxes=boxes)


def _picture(stack: Stack, picture: Picture) -> doc.Picture:
    low, closed_low, high, closed_high = stack.ends(picture)
    return doc.Picture.from_result(picture, low=low, low_belongs=closed_low, high=high, high_belongs=closed_high)


def _layer(stack: Stack, layer: Layer) -> doc.Slice:
    plane = layer.plane
    return doc.Slice.from_result(
        layer,
        further_curves=[] if plane is None else _curves(plane.boundaries, len(stack.boundaries.factors)),
        interrupted=plane is not None and plane.interrupted,
        **_places(plane),
    )


def _numbered(cell: Cell, area: float) -> branches.Region:
    known = branches.PROVED if cell.certainty is Certainty.PROVED else branches.SAMPLE
    said = cell.said if isinstance(cell.said, Counted) else Counted(())
    return branches.Region.from_result(
        said,
        number=cell.number,
        sample=(cell.sample.x, cell.sample.y),
        standing=cell.lack or known,
        count=None if cell.counted is None else said.count,
        stable=None if cell.counted is None else said.stable,
        area=area,
    )


def _interval(diagram: Branches, cell: Cell) -> branches.Interval:
    low, high = diagram.ends(cell)
    constant = cell.certainty is Certainty.PROVED
    return branches.Interval.from_result(cell.counted, low=low, high=high, sample=cell.sample, constant=constant)


def _critical(diagram: Branches, at: Cell) -> branches.CriticalValue:
    return branches.CriticalValue.from_result(
        diagram.critical(at),
        value=at.sample,
        intervals=[None if side is None else side.number for side in diagram.sides(at)],
        verdict_changes=diagram.verdict_changes(at),
    )
