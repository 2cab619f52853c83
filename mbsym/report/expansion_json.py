"""A slow manifold as JSON: everything that the terminal shows, as codes and formulas."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from msgspec import UNSET

from mbsym.algebra.quotients import Series
from mbsym.algebra.signs import Condition
from mbsym.analysis.expanding import Expansion
from mbsym.formulas.formula import Formula
from mbsym.model.system import System
from mbsym.problems.small_parameter.result import Choice, Hurwitz, Outcome
from mbsym.report.documents import expansion as doc
from mbsym.report.documents.base import Write, file_of

if TYPE_CHECKING:
    from mbsym.simulation.expanded import Measured


def expansion_json(
    system: System, values: Mapping[str, Fraction], expansion: Expansion, measured: Measured | str = ""
) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    manifold = expansion_data(expansion, str)
    return file_of(doc.Expansion, system, manifold, values=values, measured=measured_data(measured))


def expansion_data(expansion: Expansion, write: Write) -> doc.SlowManifold[Any]:
    """A slow manifold; ``write`` turns formulas into text."""
    manifold = expansion.manifold
    steady = manifold.steady
    return doc.SlowManifold.from_result(
        manifold.field,
        order=manifold.order,
        provided_nonzero=[write(x) for x in expansion.provided],
        manifold=[
            doc.FastVariable(variable=name, residual=left, coefficients=_series(expansion, function, write))
            for name, function, left in zip(manifold.fast, manifold.functions, manifold.residuals, strict=True)
        ],
        flow=[
            doc.SlowVariable(variable=name, coefficients=_series(expansion, series, write))
            for name, series in zip(manifold.slow, manifold.flow, strict=True)
        ],
        roots=UNSET
        if expansion.choice is Choice.ONLY
        else doc.Roots(
            chosen=expansion.choice,
            others=[{n: write(x) for n, x in zip(manifold.fast, values, strict=True)} for values in expansion.others],
            unknown=expansion.unknown,
            positive=_positive(expansion, expansion.real, write),
        ),
        missing=expansion.missing if steady is None else UNSET,
        steady=UNSET
        if steady is None
        else doc.Steady(
            zeros=steady.zeros,
            divided_up_to=steady.remainder - 1,
            attracts=_hurwitz(expansion, steady.fast, *expansion.fast, write),
            flow=_hurwitz(expansion, steady.slow, *expansion.slow, write),
            free=list(steady.free),
            stabilizable=expansion.stabilizable[0] if steady.free else None,
        ),
    )


def measured_data(measurement: Measured | str) -> doc.Measured:
    """A measurement in two digits, so that it is the same wherever it is made; ``reason``: why there is none."""
    if isinstance(measurement, str):
        return doc.Measured(reason=measurement)
    return doc.Measured(
        time=float(f"{measurement.time:.4g}"),
        parts=[str(part) for part in measurement.parts],
        distances=[float(f"{x:.2g}") for x in measurement.distances],
        orders=[round(x, 1) for x in measurement.orders],
        expected=measurement.expected,
    )


def _series(expansion: Expansion, series: Series, write: Write) -> list[doc.Coefficient[Any]]:
    return [
        doc.Coefficient(order=k, formula=write(expansion.formula(series.coefficients[k])))
        for k in sorted(series.coefficients)
    ]


def _hurwitz(
    expansion: Expansion, hurwitz: Hurwitz, outcome: Outcome, conditions: tuple[Condition, ...], write: Write
) -> doc.Hurwitz[Any]:
    ring = expansion.transfer.ring
    positive = _positive(expansion, conditions, write)
    nonzero = [write(Formula(ring, p)) for c in conditions for p in c.nonzero]
    polynomial = [_series(expansion, c, write) for c in hurwitz.polynomial]
    return doc.Hurwitz(outcome=outcome, positive=positive, nonzero=nonzero, polynomial=polynomial)


def _positive(expansion: Expansion, conditions: tuple[Condition, ...], write: Write) -> list[Any]:
    ring = expansion.transfer.ring
    return [write(Formula(ring, c.polynomial)) for c in conditions if c.kind == "inequality"]
