"""A map as JSON: every cell with its exact point, what was proved there, and the polynomials of its borders."""

from __future__ import annotations

from collections.abc import Mapping
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
from mbsym.report.documents.base import written
from mbsym.source.yaml_writer import meaning


def map_json(system: System, found: Map) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    head = {
        "system": system.name,
        "description_sha256": meaning(system),
        "values": {name: str(value) for name, value in sorted(found.values.items())},
    }
    if isinstance(found, Branches):
        return written(_branches(head, found))
    if isinstance(found, EquilibriaMap):
        return written(_equilibria(head, found))
    return written(
        doc.Map.from_result(
            found,
            **head,
            demands=[doc.Demand.from_result(x.condition, relation=x.relation) for x in found.admissibility.demands],
            curves=_curves(found.boundaries),
            **_places(None if isinstance(found, BoxMap | Stack) else found),
            pictures=[_picture(found, picture) for picture in found.pictures] if isinstance(found, Stack) else UNSET,
            slices=[_layer(found, layer) for layer in found.layers] if isinstance(found, Stack) else UNSET,
            subdivision=_boxes(found) if isinstance(found, BoxMap) else UNSET,
        )
    )


def _curves(found: Boundaries, start: int = 0) -> list[tuple[Any, ...]]:
    """The boundary polynomials from number ``start`` on, each with its number and its conditions."""
    return list(zip(count(), found.factors, found.conditions))[start:]


def _places(found: Map | None) -> dict[str, Any]:
    """Regions, arcs and corners; of a line intervals, with their ends, and points."""
    if found is None:
        return {"regions": [], "arcs": [], "corners": []}
    line = isinstance(found.ground, Line)
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
            for region, (area, error) in zip(found.regions, found.areas, strict=True)
            for there in [found.place(region)]
        ],
        "arcs": [
            doc.Arc.from_result(
                arc,
                soft_or_hard=arc.soft,
                curves=there.factors,
                regions=there.regions,
                corners=there.corners,
                separates=found.separates(arc),
            )
            for arc in found.arcs
            for there in [found.place(arc)]
        ],
        "corners": [
            doc.Corner.from_result(
                corner,
                soft_or_hard=corner.soft,
                curves=there.factors,
                arcs=[] if line else there.arcs,
                kind="zero" if line else str(there.kind),
            )
            for corner in found.corners
            for there in [found.place(corner)]
        ],
    }


def _boxes(found: BoxMap) -> doc.Subdivision:
    """Each statement once, and the boxes with the numbers of theirs; exact edges."""
    statements: list[Cell] = []
    places: dict[tuple[object, ...], int] = {}
    boxes = []
    for cell, tile in zip(found.regions, found.subdivision.tiles, strict=True):
        key = (*cell.kind, tuple(x.condition.about for x in cell.broken), cell.judged and cell.judged.null)
        if cell.lack is not Lack.UNPROVED and key not in places:
            places[key] = len(statements)
            statements.append(cell)
        boxes.append(((tile.box.x0, tile.box.x1, tile.box.y0, tile.box.y1), places.get(key)))
    return doc.Subdivision.from_result(found, statements=statements, boxes=boxes)


def _picture(found: Stack, picture: Picture) -> doc.Picture:
    low, closed_low, high, closed_high = found.ends(picture)
    return doc.Picture.from_result(picture, low=low, low_belongs=closed_low, high=high, high_belongs=closed_high)


def _layer(found: Stack, layer: Layer) -> doc.Slice:
    plane = layer.plane
    return doc.Slice.from_result(
        layer,
        further_curves=[] if plane is None else _curves(plane.boundaries, len(found.boundaries.factors)),
        interrupted=plane is not None and plane.interrupted,
        **_places(plane),
    )


def _equilibria(head: Mapping[str, Any], found: EquilibriaMap) -> branches.EquilibriaMap:
    return branches.EquilibriaMap.from_result(
        found,
        **head,
        curves=[(k, p, [x.origin for x in conditions]) for k, p, conditions in _curves(found.boundaries)],
        regions=[_numbered(region, area) for region, (area, _) in zip(found.regions, found.areas, strict=True)],
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


def _branches(head: Mapping[str, Any], found: Branches) -> branches.Branches:
    return branches.Branches.from_result(
        found,
        **head,
        parameter=found.axes[0],
        intervals=[_interval(found, interval) for interval in found.intervals],
        critical_values=[_critical(found, critical) for critical in found.criticals],
    )


def _interval(found: Branches, cell: Cell) -> branches.Interval:
    low, high = found.ends(cell)
    constant = cell.certainty is Certainty.PROVED
    return branches.Interval.from_result(cell.counted, low=low, high=high, sample=cell.sample, constant=constant)


def _critical(found: Branches, at: Cell) -> branches.CriticalValue:
    return branches.CriticalValue.from_result(
        found.critical(at),
        value=at.sample,
        intervals=[None if side is None else side.number for side in found.sides(at)],
        verdict_changes=found.verdict_changes(at),
    )
