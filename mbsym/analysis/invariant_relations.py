"""What divides its derivative, of a system: linear forms, Darboux polynomials, integrals where another one is zero."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from mbsym.analysis.polynomial import Setting
from mbsym.problems.polynomial_integrals import (
    DarbouxAlong,
    DarbouxPolynomials,
    OtherLevels,
    PolynomialIntegrals,
    Relations,
    ZeroLevels,
    darboux_along_of,
    darboux_of,
    linear_relations,
    other_levels_of,
    zero_levels_of,
)


@dataclass(frozen=True)
class InvariantRelations:
    """``linear`` forms with conditions on the parameters; ``darboux`` polynomials of any weight for almost all of them.

    ``levels``: integrals that hold where one of those found is zero, ``others``: where it has another value; None where
    several unit vectors or angles are related, and none was looked at.
    """

    linear: Relations
    darboux: DarbouxPolynomials
    levels: ZeroLevels | None
    others: OtherLevels | None


def invariant_relations(there: Setting, found: PolynomialIntegrals, positive: Sequence[str]) -> InvariantRelations:
    """All four, up to the degree of ``found``; ``positive``: parameters that are.

    Raises NoClosedForm where more monomials are coupled than the bounds allow.
    """
    grading = found.grading
    return InvariantRelations(
        linear_relations(there.field, grading.weights, positive, grading.free),
        darboux_of(found, there.kinds, there.known),
        zero_levels_of(found, there.kinds, there.known),
        other_levels_of(found, there.kinds, there.known),
    )


def special_relations(there: Setting, found: PolynomialIntegrals, low: Fraction, high: Fraction) -> DarbouxAlong:
    """At which values of the only parameter there are more Darboux polynomials, up to the degree of ``found``.

    Raises NoClosedForm where more monomials are coupled than the bounds allow.
    """
    return darboux_along_of(found, there.kinds, there.known, low, high)
