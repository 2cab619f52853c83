"""What divides its derivative, of a system: linear forms, Darboux polynomials, integrals where another one is zero."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mbsym.analysis.polynomial import Setting
from mbsym.problems.polynomial_integrals import (
    DarbouxPolynomials,
    OnLevel,
    PolynomialIntegrals,
    Relations,
    darboux_of,
    levels,
    linear_relations,
    on_level,
)


@dataclass(frozen=True)
class InvariantRelations:
    """``linear`` forms with conditions on the parameters; ``darboux`` polynomials of any weight for almost all of them.

    ``levels``: integrals that hold where one of those found is zero, one item for each that was looked at; None where
    the equations are not quasi-homogeneous, and none was.
    """

    linear: Relations
    darboux: DarbouxPolynomials
    levels: tuple[OnLevel, ...] | None


def invariant_relations(there: Setting, found: PolynomialIntegrals, positive: Sequence[str]) -> InvariantRelations:
    """All three, up to the degree of ``found``; ``positive``: parameters that are.

    Raises NoClosedForm where more monomials are coupled than the bounds allow.
    """
    grading = found.grading
    apart = grading.homogeneous and (grading.free or not found.field.relations)
    return InvariantRelations(
        linear_relations(there.field, grading.weights, positive, grading.free),
        darboux_of(found, there.kinds, there.known),
        tuple(on_level(found, one) for one in levels(found)) if apart else None,
    )
