"""What was printed has a dimension, too: that of the quantity, where claims are no equations up to a factor."""

from __future__ import annotations

from collections.abc import Container

from mbsym.expressions.rates import acceleration_name, velocity_name
from mbsym.expressions.tree import Name
from mbsym.model.claims import CLAIMS, Claim
from mbsym.model.units import ENERGY, LENGTH, NONE, RATE, SPEED, Dimension
from mbsym.source.units.expressions import Dimensions
from mbsym.source.units.inference import Form

#: Claims whose dimension is fixed.  Those in notation and dimensionless time, and those that hold up to a factor, are
#: only asked to add like to like.
_FIXED: dict[str, tuple[Dimension, str]] = {
    "kinetic energy": (ENERGY, "a kinetic energy"),
    "force function": (ENERGY, "a force function"),
    "potential energy": (ENERGY, "a potential energy"),
    "lagrangian": (ENERGY, "a Lagrangian"),
    "hamiltonian": (ENERGY, "a Hamiltonian"),
    "routh function": (ENERGY, "a Routh function"),
    "reduced potential": (ENERGY, "a potential"),
    "angular velocity": (RATE, "an angular velocity"),
    "relative angular velocity": (RATE, "an angular velocity"),
    "direction cosine": (NONE, "a direction cosine"),
    "position": (LENGTH, "a position"),
    "velocity": (SPEED, "a velocity"),
}


def check_claim(claim: Claim, dimensions: Dimensions, scaled: bool, speeds: Container[str] = ()) -> None:
    """Complains where what was printed cannot be the quantity that it is said to be; ``scaled``: time is a number."""
    if claim.right is not None:
        dimensions.alike(claim.equals, claim.right, "compared")
    elif claim.kind in _FIXED:
        wanted, what = _FIXED[claim.kind]
        dimensions.expect(claim.equals, Form(wanted), what)
    elif claim.kind == "acceleration":
        rate = Name(velocity_name(claim.of) if claim.of in speeds else acceleration_name(claim.of))
        dimensions.alike(rate, claim.equals, "equal")
    elif claim.of_expression is not None and not CLAIMS[claim.kind].order:
        dimensions.alike(claim.of_expression, claim.equals, "equal")
    elif claim.kind in CLAIMS:
        dimensions.with_name(claim.variable, Form() if scaled else Form(RATE)).of(claim.equals)
