"""Symmetries as JSON: everything that the table shows, as codes and formulas."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from mbsym.model.system import System
from mbsym.problems.symmetries import Symmetries, Symmetry
from mbsym.report.documents import symmetries as doc
from mbsym.report.documents.base import written


def symmetries_json(system: System, values: Mapping[str, Fraction], found: Symmetries) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    return written(doc.Symmetries.from_result(symmetries_data(found), system=system.name, values=values))


def symmetries_data(found: Symmetries) -> doc.SymmetryBasis:
    """What is found, without what it belongs to."""
    return doc.SymmetryBasis(
        directions="speeds" if found.in_speeds else "coordinates",
        complete=found.complete,
        symmetries=[_one(one) for one in found.symmetries],
    )


def _one(one: Symmetry) -> doc.Symmetry:
    return doc.Symmetry(
        field={name: str(xi) for name, xi in one.directions},
        time=str(one.time),
        gauge=str(one.gauge),
        integral=str(one.integral),
        name=one.name,
        new=one.is_new,
        told_apart=one.certainty.value,
        substituted=one.substituted.value,
    )
