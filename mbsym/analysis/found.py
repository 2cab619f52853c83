"""First integrals beyond problem 7 at numbers for all parameters: of symmetries, and polynomials; for runs."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING

from mbsym.algebra.failures import Failure
from mbsym.analysis.polynomial import DEGREE, integrals_of, setting, with_known
from mbsym.analysis.symmetric import symmetries_of
from mbsym.problems.integrals import PROVED, Integral

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis

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
    numbers = {one.name: values[one.name] for one in system.parameters if one.name in values}
    found: list[Integral] = []
    try:
        for one in symmetries_of(analysis, numbers).new:
            along = ", ".join(name for name, _ in one.directions) or "time"
            found.append(Integral(f"integral of a symmetry ({along})", SYMMETRY, along, one.integral, PROVED))
    except Failure:
        pass
    try:
        there = with_known(setting(analysis, numbers), found)
        for new in integrals_of(there, DEGREE).new:
            if new.independent:
                name = f"integral of weight {new.weight}"
                found.append(Integral(name, POLYNOMIAL, str(new.weight), there.formula(new.polynomial), PROVED))
    except (Failure, ZeroDivisionError):
        pass
    return tuple(found)
