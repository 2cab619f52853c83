"""Branches of equilibria as JSON: every interval with its equilibria, every critical value with what happens there."""

from __future__ import annotations

from mbsym.maps.branches_result import Branches, Critical, Meeting, Piece
from mbsym.model.system import System
from mbsym.report.documents import branches as doc
from mbsym.report.documents import parts
from mbsym.report.documents.writer import written
from mbsym.report.maps.equilibria_json import coordinate_value
from mbsym.report.maps.json import coordinate
from mbsym.report.sections.stability import verdict_data
from mbsym.source.meaning import meaning

#: Digits of numbers that are followed in floating point.
DIGITS = 10


def branches_json(system: System, found: Branches) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    data = doc.Branches(
        system=system.name,
        description_sha256=meaning(system),
        parameter=parts.Axis(name=found.axis.name, low=str(found.axis.low), high=str(found.axis.high)),
        values={name: str(value) for name, value in sorted(found.given.items())},
        coordinates=list(found.coordinates),
        proved=found.proved,
        interrupted=found.interrupted,
        remarks=[doc.Remark(doubt=one.doubt, about=one.about) for one in found.remarks],
        intervals=[
            doc.Interval(
                low=coordinate(one.low),
                high=coordinate(one.high),
                sample=str(one.sample),
                count=len(one.equilibria),
                stable=one.stable,
                constant=one.constant,
                equilibria=[
                    doc.Equilibrium(
                        coordinates=[coordinate_value(x) for x in there.values],
                        angles_of=there.coordinates_of or None,
                        stability=verdict_data(there.verdict),
                    )
                    for there in one.equilibria
                ],
            )
            for one in found.intervals
        ],
        critical_values=[_critical(found, one) for one in found.criticals],
        branches=[_piece(one) for one in found.pieces],
    )
    return written(data)


def _critical(found: Branches, one: Critical) -> doc.CriticalValue:
    below, above = found.sides(one)
    return doc.CriticalValue(
        value=coordinate(one.number),
        intervals=[below, above],
        events=[event.value for event in one.events],
        verdict_changes=found.verdict_changes(one),
        continuum=one.continuum,
        border=one.border,
        counts_agree=one.balance,
        equilibria=None if one.meetings is None else [_meeting(x) for x in one.meetings],
    )


def _meeting(one: Meeting) -> doc.CriticalValueEquilibrium:
    return doc.CriticalValueEquilibrium(
        coordinates=[coordinate_value(x) for x in one.values],
        angles_of=one.coordinates_of or None,
        event=one.named.event,
        below=one.named.below,
        above=one.named.above,
        derivatives=dict(one.named.derivatives),
        stability=None if one.verdict is None else verdict_data(one.verdict),
    )


def _piece(one: Piece) -> doc.Branch:
    return doc.Branch(
        interval=one.interval,
        equilibrium=one.number,
        throughout=one.throughout,
        start=one.start,
        end=one.end,
        parameter=[_rounded(x) for x in one.parameter],
        points=[[_rounded(x) for x in q] for q in one.values],
    )


def _rounded(x: float) -> float:
    return float(f"{x:.{DIGITS}g}")
