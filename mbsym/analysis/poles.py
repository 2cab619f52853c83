"""Values at which a description divides by zero: nothing is said of a motion there."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from flint import fmpq

from mbsym.algebra import rationals
from mbsym.algebra.factors import occurring
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.formulas.formula import Formula
from mbsym.mechanics.loads.kinds import generalized_forces

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis


def pole(analysis: Analysis, values: Mapping[str, Any]) -> Formula | None:
    """A polynomial in parameters that is zero at ``values`` and by which the description divides; None for none.

    It does in T, in U, in an applied force or in the unperturbed motion.  The first approximation need not hold it: in
    U = -k x^2/2 - x^4/(b - 4) it does not, and there is no U for b = 4; of the motion r = k a/(k - m w^2) of a bead on
    a turning rod neither, and there is no such motion for k = m w^2.
    """
    ring = analysis.ring
    poles = {
        k
        for k, g in enumerate(ring.generators)
        if g.kind == "reciprocal" and g.argument is not None and _vanishes(ring, g.argument, values)
    }
    energy = analysis.optional("energy") if poles else None
    if energy is None:
        return None
    coefficients = [energy.force_function, energy.A0, *energy.A1, *(x for row in energy.A2 for x in row)]
    applied = generalized_forces(analysis.held_scene).values()
    moves = (analysis.parameters_scene.lower(x) for entry in analysis.system.motion for x in (entry.value, entry.rate))
    held = sorted(poles.intersection(occurring([*(x.polynomial for x in coefficients), *applied, *moves])))
    divisor = ring.generators[held[0]].argument if held else None
    return None if divisor is None else Formula(ring, divisor)


def _vanishes(ring: Ring, p: Polynomial, values: Mapping[str, Any]) -> bool:
    """Whether p is zero, exactly; False where it holds more than parameters with rational values."""
    at = [fmpq(0)] * len(ring.generators)
    for k in occurring([p]):
        g = ring.generators[k]
        value = values.get(g.name) if g.kind == "parameter" else None
        if not isinstance(value, Fraction):
            return False
        at[k] = rationals.exact(value)
    return bool(p(*at) == 0)
