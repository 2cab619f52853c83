"""First integrals beyond problem 7: at numbers for all parameters, for runs; and those of problem 9, for reports."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from fractions import Fraction
from typing import TYPE_CHECKING

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Failure
from mbsym.analysis.polynomial import DEGREE, Setting, integrals_of, setting, with_known
from mbsym.analysis.symmetric import symmetries_of
from mbsym.expressions.message import Message
from mbsym.problems.integrals import Integral

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis
    from mbsym.problems.polynomial_integrals.result import PolynomialIntegrals
    from mbsym.problems.symmetries.search import Symmetries

#: Of systems with more coordinates it is not tried: a run would wait for it.
MOST_COORDINATES = 3

SYMMETRY, POLYNOMIAL = "symmetry", "polynomial"


def found_integrals(analysis: Analysis, values: Mapping[str, Fraction]) -> tuple[Integral, ...]:
    """Integrals that are no functions of those of problem 7 and of each other, each proved at these ``values``.

    What outgrows a bound, or is no polynomial, is left out: the list claims nothing.
    """
    system = analysis.system
    if system.constraints or system.linear is not None or len(system.coordinates) > MOST_COORDINATES:
        return ()
    numbers = {parameter.name: values[parameter.name] for parameter in system.parameters if parameter.name in values}
    integrals: list[Integral] = []
    with suppress(Failure):
        integrals += _of_symmetries(symmetries_of(analysis, numbers))
    with suppress(Failure, ZeroDivisionError):
        there = with_known(setting(analysis, numbers, driven=True), integrals)
        integrals += _polynomials(there, integrals_of(there, DEGREE))
    return tuple(integrals)


def beyond(analysis: Analysis) -> tuple[Integral, ...]:
    """Those of problem 9 that are no functions of problem 7's and of each other; each proved for the symbols there are.

    Raises Unavailable where problem 9 has no result, or stands on a check that has failed.
    """
    result = analysis.polynomial_integrals
    integrals = [] if result.symmetries is None else _of_symmetries(result.symmetries)
    there = setting(analysis, driven=True)
    if not integrals:
        return tuple(_polynomials(there, result.integrals))
    try:
        return (*integrals, *_polynomials(there, integrals_of(with_known(there, integrals), DEGREE)))
    except Failure:
        return tuple(integrals)


def _of_symmetries(symmetries: Symmetries) -> list[Integral]:
    of_symmetries = []
    for symmetry in symmetries.new:
        along = ", ".join(name for name, _ in symmetry.directions) or "time"
        of_symmetries.append(
            Integral(
                Message("integral of a symmetry ([[along]])", along=along),
                SYMMETRY,
                along,
                symmetry.integral,
                Certainty.PROVED,
            )
        )
    return of_symmetries


def _polynomials(there: Setting, integrals: PolynomialIntegrals) -> list[Integral]:
    """The second of one weight is called by its number, too."""
    listed: list[Integral] = []
    count: dict[int, int] = {}
    for generator in integrals.new:
        if generator.independent:
            number = count[generator.weight] = count.get(generator.weight, 0) + 1
            which = str(generator.weight) if number == 1 else f"{generator.weight} ({number})"
            formula = there.formula(generator.polynomial)
            listed.append(
                Integral(
                    Message("integral of weight [[weight]]", weight=which), POLYNOMIAL, which, formula, Certainty.PROVED
                )
            )
    return listed
