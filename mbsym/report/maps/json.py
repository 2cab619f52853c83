"""A map as JSON: every region, arc and corner with its exact point, what was proved there, and the polynomials."""

from __future__ import annotations

from typing import Any

from flint import fmpq
from msgspec.structs import asdict

from mbsym.algebra.plane import AlgebraicNumber, Point
from mbsym.algebra.plane.numbers import enclosure
from mbsym.maps.admissible import Demand
from mbsym.maps.boundaries import Boundaries, Condition
from mbsym.maps.boxes import BoxMap
from mbsym.maps.check import Check
from mbsym.maps.result import LineMap, PlaneMap, Stratum
from mbsym.maps.slices import Stack
from mbsym.model.system import System
from mbsym.report.documents import map as doc
from mbsym.report.documents import parts
from mbsym.report.documents.writer import written
from mbsym.report.sections.stability import verdict_data
from mbsym.source.meaning import meaning


def map_json(system: System, found: PlaneMap | LineMap) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    places = _of_line(found) if isinstance(found, LineMap) else plane_data(found)
    return written(
        doc.Map(**head(system, found), interrupted=found.interrupted, check=check_data(found.check), **places)
    )


def head(system: System, found: PlaneMap | LineMap | Stack | BoxMap) -> dict[str, Any]:
    """What maps over any number of axes have in common."""
    return {
        "system": system.name,
        "description_sha256": meaning(system),
        "of": found.of,
        "axes": [parts.Axis(name=x.name, low=str(x.low), high=str(x.high)) for x in found.section.axes],
        "values": {name: str(value) for name, value in sorted(found.section.told.items())},
        "constant": None if found.section.constant is None else found.section.constant.text,
        "subsystems": [list(names) for names in found.section.coordinates],
        "demands": [_demand(one) for one in found.admissibility.demands],
        "left_out": list(found.admissibility.left_out),
        "curves": curves_data(found.boundaries),
        "vanishing": [_condition(one) for one in found.boundaries.vanishing],
    }


def curves_data(found: Boundaries, start: int = 0) -> list[doc.Curve]:
    """The boundary polynomials from number ``start`` on."""
    return [
        doc.Curve(number=k, polynomial=str(p), conditions=[_condition(one) for one in conditions])
        for k, (p, conditions) in enumerate(zip(found.factors, found.conditions, strict=True))
        if k >= start
    ]


def plane_data(found: PlaneMap) -> dict[str, Any]:
    """Regions, arcs and corners."""
    arrangement = found.arrangement
    return {
        "regions": [
            doc.Region(
                **_place(one, _point(found.point_of(one))),
                signs=list(there.signs),
                arcs=list(there.arcs),
                area=area,
                area_error=error,
            )
            for one, there, (area, error) in zip(found.regions, arrangement.regions, found.areas, strict=True)
        ],
        "arcs": [
            doc.Arc(
                **_place(one, _point(found.point_of(one))),
                soft_or_hard=_soft(one),
                curves=list(there.factors),
                regions=list(there.regions),
                corners=list(there.corners),
                separates=found.separates(one),
            )
            for one, there in zip(found.arcs, arrangement.arcs, strict=True)
        ],
        "corners": [
            doc.Corner(
                **_place(one, _point(found.point_of(one))),
                soft_or_hard=_soft(one),
                curves=list(there.factors),
                arcs=list(there.arcs),
                kind=str(there.kind),
            )
            for one, there in zip(found.corners, arrangement.corners, strict=True)
        ],
    }


def _of_line(found: LineMap) -> dict[str, Any]:
    """Intervals are the regions, with their ends; zeros the corners."""
    return {
        "regions": [
            doc.Region(
                **_place(one, [coordinate(there.sample)]),
                signs=list(there.signs),
                arcs=[],
                ends=list(there.ends),
                area=area,
                area_error=error,
            )
            for one, there, (area, error) in zip(found.regions, found.line.intervals, found.areas, strict=True)
        ],
        "arcs": [],
        "corners": [
            doc.Corner(
                **_place(one, [coordinate(there.number)]),
                soft_or_hard=_soft(one),
                curves=list(there.factors),
                arcs=[],
                kind="zero",
            )
            for one, there in zip(found.corners, found.line.zeros, strict=True)
        ],
    }


def check_data(found: Check | None) -> doc.MapCheck | None:
    """What was tried a second time, and what did not agree."""
    if found is None:
        return None
    findings = [
        doc.Finding(
            mistake=one.mistake,
            region=one.region,
            arc=one.arc,
            corner=one.corner,
            near=list(one.near),
        )
        for one in found.findings
    ]
    return doc.MapCheck(points=found.points, arcs=found.arcs, enclosed=found.enclosed, findings=findings)


def _place(one: Stratum, point: list[parts.Number]) -> dict[str, Any]:
    return {"number": one.number, "point": point} | asdict(judged_data(one))


def judged_data(one: Stratum) -> doc.Statement:
    """What is proved at a place, or why nothing is."""
    judged = one.judged
    return doc.Statement(
        standing=one.standing,
        broken=[x.condition.about or str(x.condition.polynomial) for x in one.broken],
        stability=None if judged is None else verdict_data(judged.verdict),
        unstable_roots=None if judged is None else judged.right,
        real_unstable_roots=None if judged is None else judged.real_right,
        negative_eigenvalues_of_K=None if judged is None else judged.degree,
        zero_eigenvalues_of_K=None if judged is None else judged.null,
        border=None if judged is None else judged.border,
    )


def _soft(one: Stratum) -> doc.SoftOrHard | None:
    """What terms of third order decide where a pair of roots is imaginary."""
    found = one.soft
    if found is None:
        return None
    along = None
    if found.stretches is not None:
        along = [
            doc.Along(axis=x.axis, from_=coordinate(x.start), to=coordinate(x.end), onset=x.onset)
            for x in found.stretches
        ]
    return doc.SoftOrHard(
        onset=found.onset,
        reason=found.why.value,
        frequency=None if found.frequency is None else float(found.frequency),
        coefficient=None if found.coefficient is None else float(found.coefficient),
        amplitude_of=found.amplitude_of,
        along=along,
    )


def _condition(one: Condition) -> doc.Condition:
    return doc.Condition(origin=one.origin, subsystem=one.part, about=one.about, reduced=one.reduced)


def _demand(one: Demand) -> doc.Demand:
    condition = asdict(_condition(one.condition))
    return doc.Demand(**condition, polynomial=str(one.condition.polynomial), relation=one.relation)


def _point(point: Point) -> list[parts.Number]:
    return [coordinate(x) for x in (point.x, point.y)]


def coordinate(x: Any) -> parts.Number:
    """A rational number as text, an algebraic one by its minimal polynomial and an interval with no other root."""
    if isinstance(x, fmpq):
        return parts.Number(exact=str(x), polynomial=None, between=None, number=float(enclosure(x).mid()))
    ball = x.enclosure(64)
    between = [str(x.low), str(x.high)]
    polynomial = [str(c) for c in x.polynomial.coeffs()] if isinstance(x, AlgebraicNumber) else None
    return parts.Number(exact=None, polynomial=polynomial, between=between, number=float(ball.mid()))
