"""Polynomial integrals as JSON: everything that the table shows, as codes and formulas."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import fmpq, fmpz

from mbsym.analysis.polynomial import InvariantRelations, Setting
from mbsym.model.system import System
from mbsym.problems.polynomial_integrals.result import (
    Along,
    Cases,
    DarbouxAlong,
    DarbouxPolynomials,
    PolynomialIntegrals,
)
from mbsym.report.documents import integrals as doc
from mbsym.report.documents.base import Write, file_of


def integrals_json(
    system: System,
    values: Mapping[str, Fraction],
    setting: Setting,
    basis: PolynomialIntegrals,
    line: Along | None = None,
    special: Cases | None = None,
    invariant: InvariantRelations | None = None,
    at: DarbouxAlong | None = None,
) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""

    def text(value: Any) -> str:
        return str(value) if isinstance(value, Fraction | fmpq | fmpz) else str(setting.formula(value))

    def factor(p: Any) -> str:
        return str(setting.quotient(p, setting.field.denominator))

    linear, darboux, levels, others = (
        None if invariant is None else getattr(invariant, name) for name in ("linear", "darboux", "levels", "others")
    )
    return file_of(
        doc.Integrals,
        system,
        basis,
        text,
        values=values,
        weights=zip(basis.field.variables, basis.grading.weights, strict=True),
        along=None
        if line is None
        else doc.Along.from_result(
            line,
            text,
            weights=None if line.weights is None else zip(setting.field.variables, line.weights, strict=True),
        ),
        cases=special,
        relations=linear,
        darboux=None if darboux is None else _darboux(darboux, setting.field.variables, text, factor),
        darboux_along=None if at is None else _darboux_along(setting, at, text),
        zero_levels=None if levels is None else levels.levels,
        other_levels=None
        if others is None
        else [
            doc.OtherLevel.from_result(
                level,
                text,
                complete=level.looked and level.complete and not level.drops and not level.undecided,
                at_any_value=level.looked and level.complete and level.whole,
                known="proved" if not (level.by_rank and setting.field.parameters) else "verified numerically",
            )
            for level in others.levels
        ],
    )


def _darboux(darboux: DarbouxPolynomials, variables: Sequence[str], text: Write, factor: Write) -> doc.Darboux:
    return doc.Darboux.from_result(
        darboux,
        text,
        weights=zip(variables, darboux.weights, strict=True),
        polynomials=[
            doc.Polynomial.from_result(polynomial, text, cofactor=factor(polynomial.cofactor))
            for polynomial in darboux.polynomials
        ],
        not_found=[
            (count.weight, factor(count.cofactor), count.most - count.products)
            for count in darboux.counts
            if not count.complete
        ],
    )


def _darboux_along(setting: Setting, darboux: DarbouxAlong, text: Write) -> doc.DarbouxAlong:
    values = []
    for value in darboux.values:
        factors = [str(setting.quotient_over(value.field, f.cofactor)) for f in value.polynomials]
        polynomials = [
            doc.Polynomial.from_result(f, text, cofactor=factor)
            for f, factor in zip(value.polynomials, factors, strict=True)
        ]
        values.append((value.value, polynomials, value.complete))
    return doc.DarbouxAlong.from_result(darboux, text, values=values)
