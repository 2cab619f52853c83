"""Polynomial integrals as JSON: everything that the table shows, as codes and formulas."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

from mbsym.analysis.polynomial import InvariantRelations, Setting
from mbsym.model.system import System
from mbsym.problems.polynomial_integrals import (
    Along,
    Cases,
    DarbouxAlong,
    DarbouxPolynomials,
    OnLevel,
    OtherLevels,
    PolynomialIntegrals,
    Relations,
    Special,
    ZeroLevels,
)
from mbsym.problems.symmetries import Symmetries, Symmetry
from mbsym.report.documents import integrals as doc
from mbsym.report.documents import symmetries
from mbsym.report.documents.base import written


def integrals_json(
    system: System,
    values: Mapping[str, Fraction],
    there: Setting,
    found: PolynomialIntegrals,
    line: Along | None = None,
    special: Cases | None = None,
    invariant: InvariantRelations | None = None,
    at: DarbouxAlong | None = None,
) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    data = doc.Integrals(
        system=system.name,
        values={name: str(value) for name, value in values.items()},
        **_basis(there, found),
        along=None if line is None else _along(there, line),
        cases=None if special is None else _cases(there, special),
        relations=None if invariant is None else _relations(there, invariant.linear),
        darboux=None if invariant is None else _darboux(there, invariant.darboux),
        darboux_along=None if at is None else _darboux_along(there, at),
        zero_levels=None if invariant is None else _levels(there, invariant.levels),
        other_levels=None if invariant is None else _others(there, invariant.others),
    )
    return written(data)


def _basis(there: Setting, found: PolynomialIntegrals) -> dict[str, Any]:
    return {
        "degree": found.degree,
        "weights": dict(zip(found.field.variables, found.grading.weights, strict=True)),
        "quasi_homogeneous": found.grading.homogeneous,
        "complete": found.complete,
        "independent": found.independent,
        "not_contained": list(found.aside),
        "rational": list(found.rational),
        "integrals": [
            doc.Integral.from_result(
                one, new=one.is_new, formula=str(there.formula(one.polynomial)), independence=one.certainty.value
            )
            for one in found.generators
        ],
        "counts": [doc.Count.from_result(one, at_most=one.most, found=one.products) for one in found.counts],
    }


def _along(there: Setting, line: Along) -> doc.Along:
    return doc.Along(
        parameter=line.name,
        low=str(line.low),
        high=str(line.high),
        values=[doc.SpecialValue(value=str(one.value), **_special(there, one)) for one in line.values],
        undecided_at=[str(one) for one in line.undecided],
        undecided_at_zeros_of=[[str(c) for c in p.coeffs()] for p in line.irrational],
        weights=None if line.weights is None else dict(zip(there.field.variables, line.weights, strict=True)),
        no_others=line.whole,
        no_other_rational=line.usual,
    )


def _cases(there: Setting, special: Cases) -> doc.Cases:
    return doc.Cases(
        families=special.families,
        families_left=special.left,
        conditions_not_found=special.unread,
        cases=[
            doc.SpecialCase(vanishing=[str(there.formula(p)) for p in case.conditions], **_special(there, case.special))
            for case in special.cases
        ],
    )


def _relations(there: Setting, linear: Relations) -> doc.InvariantRelations:
    def write(polynomials: Iterable[Any]) -> list[str]:
        return [str(there.formula(p)) for p in polynomials]

    return doc.InvariantRelations(
        complete=linear.complete,
        relations=[
            doc.InvariantRelation(
                formula=str(there.formula(one.polynomial)),
                vanishing=write(one.conditions),
                nonzero=write(one.nonzero),
            )
            for one in linear.relations
        ],
    )


def _darboux(there: Setting, found: DarbouxPolynomials) -> doc.Darboux:
    def factor(p: Any) -> str:
        return str(there.quotient(p, there.field.denominator))

    return doc.Darboux.from_result(
        found,
        weights=dict(zip(there.field.variables, found.weights, strict=True)),
        polynomials=[
            doc.Polynomial.from_result(one, formula=str(there.formula(one.polynomial)), cofactor=factor(one.cofactor))
            for one in found.polynomials
        ],
        not_found=[
            doc.NotFound(weight=one.weight, cofactor=factor(one.cofactor), at_most=one.most - one.products)
            for one in found.counts
            if not one.complete
        ],
    )


def _darboux_along(there: Setting, found: DarbouxAlong) -> doc.DarbouxAlong:
    return doc.DarbouxAlong(
        parameter=found.name,
        low=str(found.low),
        high=str(found.high),
        values=[
            doc.DarbouxValue(
                value=str(one.value),
                polynomials=[
                    doc.Polynomial.from_result(
                        f,
                        formula=str(there.formula(f.polynomial)),
                        cofactor=str(there.quotient_over(one.field, f.cofactor)),
                    )
                    for f in one.polynomials
                ],
                complete=one.complete,
            )
            for one in found.values
        ],
        undecided_at=[str(one) for one in found.undecided],
        undecided_at_zeros_of=[[str(c) for c in p.coeffs()] for p in found.irrational],
        undecided_where_square=[str(there.formula(p)) for p in found.square],
        cofactors_left=found.left,
        all_followed=found.followed,
        no_other_rational=found.complete,
    )


def _levels(there: Setting, found: ZeroLevels | None) -> list[doc.ZeroLevel] | None:
    if found is None:
        return None
    return [doc.ZeroLevel.from_result(_level(there, one), complete=one.complete) for one in found.levels]


def _others(there: Setting, found: OtherLevels | None) -> list[doc.OtherLevel] | None:
    if found is None:
        return None
    return [
        doc.OtherLevel.from_result(
            one,
            integral=one.level.name,
            values=[
                doc.Value(
                    value=str(at.value),
                    integrals=[doc.WeightedIntegral(weight=w, formula=str(there.formula(f))) for w, f in at.integrals],
                    complete=at.complete,
                )
                for at in one.values
            ],
            undecided_at=[str(value) for value in one.undecided],
            undecided_at_zeros_of=[[str(c) for c in p.coeffs()] for p in one.irrational],
            complete=one.looked and one.complete and not one.drops and not one.undecided,
            at_any_value=one.looked and one.complete and one.whole,
            known="proved" if not (one.by_rank and there.field.parameters) else "verified numerically",
        )
        for one in found.levels
    ]


def _level(there: Setting, level: OnLevel) -> doc.OnLevel:
    return doc.OnLevel(
        zero=level.level.name,
        integrals=[doc.WeightedIntegral(weight=weight, formula=str(there.formula(f))) for weight, f in level.integrals],
    )


def _special(there: Setting, one: Special) -> dict[str, Any]:
    return {
        "integrals": [
            doc.WeightedIntegral(weight=weight, formula=str(there.formula(f))) for weight, f in one.integrals
        ],
        "on_levels": [_level(there, level) for level in one.levels],
        "complete": one.complete,
    }


# Symmetries as JSON: everything that the table shows, as codes and formulas.


def symmetries_json(system: System, values: Mapping[str, Fraction], found: Symmetries) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    return written(symmetries.Symmetries.from_result(symmetries_data(found), system=system.name, values=values))


def symmetries_data(found: Symmetries) -> symmetries.SymmetryBasis:
    """What is found, without what it belongs to."""
    return symmetries.SymmetryBasis(
        directions="speeds" if found.in_speeds else "coordinates",
        complete=found.complete,
        symmetries=[_one(one) for one in found.symmetries],
    )


def _one(one: Symmetry) -> symmetries.Symmetry:
    return symmetries.Symmetry(
        field={name: str(xi) for name, xi in one.directions},
        time=str(one.time),
        gauge=str(one.gauge),
        integral=str(one.integral),
        name=one.name,
        new=one.is_new,
        told_apart=one.certainty.value,
        substituted=one.substituted.value,
    )
