"""Problem 9."""

from __future__ import annotations

from typing import Annotated

from mbsym.report.documents.base import told_apart_by
from mbsym.report.documents.integrals import PolynomialBasis, SymmetryBasis, ZeroLevel


class PolynomialIntegrals(PolynomialBasis, frozen=True, kw_only=True):
    """problem 9: polynomial first integrals up to a weighted degree"""

    on_levels: Annotated[list[ZeroLevel], "that hold where another one vanishes", told_apart_by("zero")]
    symmetries: SymmetryBasis | None
