"""A map as JSON: every cell with its exact point, what was proved there, and the polynomials of its borders."""

from __future__ import annotations

from typing import Any

from flint import fmpq
from msgspec import UNSET
from msgspec.structs import asdict

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.plane import AlgebraicNumber, Point
from mbsym.algebra.plane.line import Line
from mbsym.algebra.plane.numbers import enclosure
from mbsym.maps.admissible import Demand
from mbsym.maps.boundaries import Boundaries, Condition
from mbsym.maps.boxes import BoxMap
from mbsym.maps.branches_result import Branches, Meeting, Piece
from mbsym.maps.check import Check
from mbsym.maps.equilibria_map import EquilibriaMap
from mbsym.maps.result import Cell, Counted, Lack, Map
from mbsym.maps.slices import Layer, Picture, Stack
from mbsym.model.system import System
from mbsym.report.documents import branches, parts
from mbsym.report.documents import map as doc
from mbsym.report.documents.base import written
from mbsym.report.maps.equilibria_json import coordinate_value
from mbsym.report.sections.stability import verdict_data
from mbsym.source.yaml_writer import meaning

#: Digits of numbers that are followed in floating point.
DIGITS = 10


def map_json(system: System, found: Map) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    if isinstance(found, Branches):
        return written(_branches(system, found))
    if isinstance(found, EquilibriaMap):
        return written(_equilibria(system, found))
    assert found.section is not None
    return written(
        doc.Map(
            **_head(system, found),
            of=found.of,
            constant=None if found.section.constant is None else found.section.constant.text,
            subsystems=[list(names) for names in found.section.coordinates],
            demands=[_demand(one) for one in found.admissibility.demands],
            left_out=list(found.admissibility.left_out),
            curves=_curves(found.boundaries),
            vanishing=[_condition(one) for one in found.boundaries.vanishing],
            check=_check(found.check),
            **_places(None if isinstance(found, BoxMap | Stack) else found),
            pictures=[_picture(found, one) for one in found.pictures] if isinstance(found, Stack) else UNSET,
            slices=[_layer(found, one) for one in found.layers] if isinstance(found, Stack) else UNSET,
            subdivision=_boxes(found) if isinstance(found, BoxMap) else UNSET,
        )
    )


def _head(system: System, found: Map) -> dict[str, Any]:
    """What all maps have in common."""
    return {
        "system": system.name,
        "description_sha256": meaning(system),
        "axes": [parts.Axis(name=x.name, low=str(x.low), high=str(x.high)) for x in found.axes],
        "values": {name: str(value) for name, value in sorted(found.values.items())},
        "interrupted": found.interrupted,
    }


def _curves(found: Boundaries, start: int = 0) -> list[doc.Curve]:
    """The boundary polynomials from number ``start`` on."""
    return [
        doc.Curve(number=k, polynomial=str(p), conditions=[_condition(one) for one in conditions])
        for k, (p, conditions) in enumerate(zip(found.factors, found.conditions, strict=True))
        if k >= start
    ]


def _places(found: Map | None) -> dict[str, Any]:
    """Regions, arcs and corners; of a line intervals, with their ends, and points."""
    if found is None:
        return {"regions": [], "arcs": [], "corners": []}
    line = isinstance(found.ground, Line)
    return {
        "regions": [
            doc.Region(
                **_place(one),
                signs=list(there.signs),
                arcs=[] if line else list(there.arcs),
                ends=list(there.ends) if line else UNSET,
                area=area,
                area_error=error,
            )
            for one, (area, error) in zip(found.regions, found.areas, strict=True)
            for there in [found.place(one)]
        ],
        "arcs": [
            doc.Arc(
                **_place(one),
                soft_or_hard=_soft(one),
                curves=list(there.factors),
                regions=list(there.regions),
                corners=list(there.corners),
                separates=found.separates(one),
            )
            for one in found.arcs
            for there in [found.place(one)]
        ],
        "corners": [
            doc.Corner(
                **_place(one),
                soft_or_hard=_soft(one),
                curves=list(there.factors),
                arcs=[] if line else list(there.arcs),
                kind="zero" if line else str(there.kind),
            )
            for one in found.corners
            for there in [found.place(one)]
        ],
    }


def _boxes(found: BoxMap) -> doc.Subdivision:
    """Each statement once, and the boxes with the numbers of theirs; exact edges."""
    statements: list[doc.Statement] = []
    places: dict[tuple[object, ...], int] = {}
    boxes = []
    for cell, tile in zip(found.regions, found.subdivision.tiles, strict=True):
        key = (*cell.kind, tuple(x.condition.about for x in cell.broken), cell.judged and cell.judged.null)
        if cell.lack is not Lack.UNPROVED and key not in places:
            places[key] = len(statements)
            statements.append(_statement(cell))
        edges = [str(x) for x in (tile.box.x0, tile.box.x1, tile.box.y0, tile.box.y1)]
        boxes.append(doc.Box(edges=edges, statement=places.get(key)))
    return doc.Subdivision(
        because=found.because or None,
        method=found.method,
        end=found.subdivision.end,
        white=str(found.subdivision.white),
        statements=statements,
        boxes=boxes,
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
    return doc.Slice(
        number=one.number,
        value=coordinate(one.z),
        critical=one.critical,
        missing=one.lack,
        broken=_broken(one),
        further_curves=[] if plane is None else _curves(plane.boundaries, len(found.boundaries.factors)),
        second=None if one.second is None else str(one.second),
        confirmed=one.confirmed,
        interrupted=plane is not None and plane.interrupted,
        check=None if plane is None else _check(plane.check),
        **_places(plane),
    )


def _equilibria(system: System, found: EquilibriaMap) -> branches.EquilibriaMap:
    boundaries = zip(found.boundaries.factors, found.boundaries.conditions, strict=True)
    return branches.EquilibriaMap(
        **_head(system, found),
        unfinished=list(found.unfinished),
        curves=[
            branches.Curve(number=k, polynomial=str(p), origins=[x.origin.value for x in conditions])
            for k, (p, conditions) in enumerate(boundaries)
        ],
        regions=[_numbered(one, area) for one, (area, _) in zip(found.regions, found.areas, strict=True)],
    )


def _numbered(one: Cell, area: float) -> branches.Region:
    known = branches.PROVED if one.certainty is Certainty.PROVED else branches.SAMPLE
    said = one.said if isinstance(one.said, Counted) else Counted(())
    return branches.Region(
        number=one.number,
        sample=[str(x) for x in (one.sample.x, one.sample.y)],
        standing=one.lack or known,
        count=None if one.counted is None else said.count,
        stable=None if one.counted is None else said.stable,
        stable_throughout=said.throughout,
        found_by_newton_elsewhere=said.confirmed,
        area=area,
        equilibria=_listed(said),
    )


def _listed(found: Counted) -> list[branches.Equilibrium]:
    return [
        branches.Equilibrium(
            coordinates=[coordinate_value(x) for x in one.values],
            angles_of=one.coordinates_of or None,
            stability=verdict_data(one.verdict),
        )
        for one in found.equilibria
    ]


def _branches(system: System, found: Branches) -> branches.Branches:
    head = _head(system, found)
    return branches.Branches(
        parameter=head.pop("axes")[0],
        **head,
        coordinates=list(found.coordinates),
        proved=found.proved,
        remarks=[branches.Remark.from_result(one) for one in found.remarks],
        intervals=[_interval(found, one, one.counted) for one in found.intervals if one.counted is not None],
        critical_values=[_critical(found, one) for one in found.criticals],
        branches=[_piece(one) for one in found.pieces],
    )


def _interval(found: Branches, one: Cell, counted: Counted) -> branches.Interval:
    low, high = map(coordinate, found.ends(one))
    return branches.Interval.from_result(
        counted,
        low=low,
        high=high,
        sample=str(one.sample),
        constant=one.certainty is Certainty.PROVED,
        equilibria=_listed(counted),
    )


def _critical(found: Branches, at: Cell) -> branches.CriticalValue:
    one = found.critical(at)
    return branches.CriticalValue.from_result(
        one,
        value=coordinate(at.sample),
        intervals=[None if side is None else side.number for side in found.sides(at)],
        events=[event.value for event in one.events],
        verdict_changes=found.verdict_changes(at),
        counts_agree=one.balance,
        equilibria=None if one.meetings is None else [_meeting(x) for x in one.meetings],
    )


def _meeting(one: Meeting) -> branches.CriticalValueEquilibrium:
    return branches.CriticalValueEquilibrium.from_result(
        one.named,
        coordinates=[coordinate_value(x) for x in one.values],
        angles_of=one.coordinates_of or None,
        stability=None if one.verdict is None else verdict_data(one.verdict),
    )


def _piece(one: Piece) -> branches.Branch:
    return branches.Branch.from_result(
        one,
        equilibrium=one.number,
        parameter=[_rounded(x) for x in one.parameter],
        points=[[_rounded(x) for x in q] for q in one.values],
    )


def _rounded(x: float) -> float:
    return float(f"{x:.{DIGITS}g}")


def _check(found: Check | None) -> doc.MapCheck | None:
    """What was tried a second time, and what did not agree."""
    if found is None:
        return None
    findings = [doc.Finding.from_result(one) for one in found.findings]
    return doc.MapCheck.from_result(found, findings=findings)


def _place(one: Cell) -> dict[str, Any]:
    further = UNSET if one.nonlinear is None else verdict_data(one.nonlinear)
    return {"number": one.number, "point": _point(one.sample), "nonlinear": further} | asdict(_statement(one))


def _broken(one: Cell | Layer) -> list[str]:
    return [x.condition.about or str(x.condition.polynomial) for x in one.broken]


def _statement(one: Cell) -> doc.Statement:
    """What is proved at a place, or why nothing is."""
    judged = one.judged
    return doc.Statement(
        standing=one.lack or "judged",
        broken=_broken(one),
        stability=None if judged is None else verdict_data(judged.verdict),
        unstable_roots=None if judged is None else judged.right,
        real_unstable_roots=None if judged is None else judged.real_right,
        negative_eigenvalues_of_K=None if judged is None else judged.degree,
        zero_eigenvalues_of_K=None if judged is None else judged.null,
        border=None if judged is None else judged.border,
    )


def _soft(one: Cell) -> doc.SoftOrHard | None:
    """What terms of third order decide where a pair of roots is imaginary."""
    found = one.soft
    if found is None:
        return None
    along = None
    if found.stretches is not None:
        along = [doc.Along.from_result(x, from_=coordinate(x.start), to=coordinate(x.end)) for x in found.stretches]
    return doc.SoftOrHard.from_result(
        found,
        reason=found.why.value,
        frequency=None if found.frequency is None else float(found.frequency),
        coefficient=None if found.coefficient is None else float(found.coefficient),
        along=along,
    )


def _condition(one: Condition) -> doc.Condition:
    return doc.Condition.from_result(one, origin=one.origin.value, subsystem=one.part)


def _demand(one: Demand) -> doc.Demand:
    condition = _condition(one.condition)
    return doc.Demand.from_result(condition, polynomial=str(one.condition.polynomial), relation=one.relation)


def _point(point: Any) -> list[parts.Number]:
    return [coordinate(x) for x in ((point.x, point.y) if isinstance(point, Point) else (point,))]


def coordinate(x: Any) -> parts.Number:
    """A rational number as text, an algebraic one by its minimal polynomial and an interval with no other root."""
    if isinstance(x, fmpq):
        return parts.Number(exact=str(x), polynomial=None, between=None, number=float(enclosure(x).mid()))
    ball = x.enclosure(64)
    between = [str(x.low), str(x.high)]
    polynomial = [str(c) for c in x.polynomial.coeffs()] if isinstance(x, AlgebraicNumber) else None
    return parts.Number(exact=None, polynomial=polynomial, between=between, number=float(ball.mid()))
