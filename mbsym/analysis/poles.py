"""Values at which a description divides by zero: nothing is said of a motion there."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from flint import fmpq

from mbsym.algebra.generators import occurring
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.mechanics.generalized import generalized_forces

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis


def at_a_pole(analysis: Analysis, values: Mapping[str, Any]) -> bool:
    """Whether T, U or an applied force holds the reciprocal of a polynomial in parameters that is zero at ``values``.

    The first approximation need not hold it: in U = -k x^2/2 - x^4/(b - 4) it does not, and there is no U for b = 4.
    """
    ring = analysis.ring
    poles = {
        k
        for k, g in enumerate(ring.generators)
        if g.kind == "reciprocal" and g.argument is not None and _vanishes(ring, g.argument, values)
    }
    if not poles:
        return False
    energy = analysis.optional("energy")
    if energy is None:
        return False
    told = [energy.force_function, energy.A0, *energy.A1, *(x for row in energy.A2 for x in row)]
    applied = generalized_forces(analysis.held_scene).values()
    return bool(poles.intersection(occurring([*(x.polynomial for x in told), *applied])))


def _vanishes(ring: Ring, p: Polynomial, values: Mapping[str, Any]) -> bool:
    """Whether p is zero, exactly; False where it holds more than parameters with rational values."""
    at = [fmpq(0)] * len(ring.generators)
    for k in occurring([p]):
        g = ring.generators[k]
        value = values.get(g.name) if g.kind == "parameter" else None
        if not isinstance(value, Fraction):
            return False
        at[k] = fmpq(value.numerator, value.denominator)
    return bool(p(*at) == 0)
