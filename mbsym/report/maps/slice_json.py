"""A map over three axes as JSON: every slice with its regions, arcs and corners, and which slices are one picture."""

from __future__ import annotations

from typing import Any

from mbsym.maps.slices import Layer, Picture, Stack
from mbsym.model.system import System
from mbsym.report.documents import map as doc
from mbsym.report.documents.writer import written
from mbsym.report.maps.json import check_data, coordinate, curves_data, head, plane_data


def slices_json(system: System, found: Stack) -> str:
    """One JSON object in the format of ``map_json``, its places in ``slices``."""
    return written(
        doc.Map(
            **head(system, found),
            interrupted=found.interrupted,
            check=None,
            regions=[],
            arcs=[],
            corners=[],
            pictures=[_picture(found, one) for one in found.pictures],
            slices=[_layer(found, one) for one in found.layers],
        )
    )


def _picture(found: Stack, one: Picture) -> doc.Picture:
    low, closed_low, high, closed_high = found.ends(one)
    return doc.Picture(
        slices=list(one.layers),
        shown=one.shown,
        not_looked_at=list(one.unseen),
        low=coordinate(low),
        low_belongs=closed_low,
        high=coordinate(high),
        high_belongs=closed_high,
    )


def _layer(found: Stack, one: Layer) -> doc.Slice:
    plane = one.plane
    places: dict[str, Any] = {"regions": [], "arcs": [], "corners": []} if plane is None else plane_data(plane)
    further = [] if plane is None else curves_data(plane.boundaries, len(found.boundaries.factors))
    return doc.Slice(
        number=one.number,
        value=coordinate(one.z),
        critical=one.critical,
        missing=one.missing,
        broken=[x.condition.about or str(x.condition.polynomial) for x in one.broken],
        further_curves=further,
        second=None if one.second is None else str(one.second),
        confirmed=one.confirmed,
        interrupted=plane is not None and plane.interrupted,
        check=None if plane is None else check_data(plane.check),
        **places,
    )
