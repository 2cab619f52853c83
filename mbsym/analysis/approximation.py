"""The first approximation in the pipeline: about which motion it is, and why there may be none."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mbsym.algebra.failures import Failure
from mbsym.analysis.stages import NoResult, Unavailable
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.rotation_orders import rotation_orders
from mbsym.problems import linearisation
from mbsym.problems.linearisation import Linearisation

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis


#: A hint lists so many coordinates; of more it shows one.
MOST_LISTED = 12


def expanded(analysis: Analysis) -> Scene:
    """The system over second-order jets about the unperturbed motion.  Raises Unavailable where none is given."""
    if not analysis.system.motion:
        names = analysis.system.coordinates
        listed = names if len(names) <= MOST_LISTED else names[:1]
        hint = "add for example  motion: {" + ", ".join(f"{name}: 0" for name in listed) + "}"
        if listed != names:
            hint += "; what is left out is 0 at rest"
        reason = "the description gives no unperturbed motion"
        raise Unavailable("motion", NoResult(reason, hint, "no motion", "no-motion"))
    return linearisation.quadratised(analysis.parameters_scene)


def first_approximation(analysis: Analysis) -> Linearisation:
    """The equations of perturbed motion, time-dependent or not (their ``varying`` says which).

    Raises Unavailable where the motion does not exist or is not steady in these coordinates.
    """
    if analysis.equilibrium.impossible:
        never = ", ".join(f"{item} = 0" for item in analysis.equilibrium.impossible)
        reason = f"the given motion does not exist: {never} is impossible"
        raise Unavailable("motion", NoResult(reason, "", "no such motion", "impossible-motion"))
    if analysis.equilibrium.unsteady:
        varying = ", ".join(analysis.equilibrium.unsteady)
        reason = f"on the given motion the equations still vary with {varying}"
        hint = steady_order(analysis) or "it is no steady motion in these coordinates"
        raise Unavailable("motion", NoResult(reason, hint, "not steady", "not-steady"))
    return linearisation.by_quadratisation(analysis.parameters_scene, analysis.expanded, analysis.equilibrium)


def autonomous(analysis: Analysis) -> Linearisation:
    """Problem 5: the first approximation where its coefficients are constant: the theorems of problem 6 are about it.

    Raises Unavailable where they vary with time.
    """
    found = analysis.first_approximation
    if found.varying:
        hint = steady_order(analysis) or "choose coordinates in which the motion is steady, if there are any"
        why = NoResult(found.time_dependence, hint, "time-dependent", "time-dependent")
        raise Unavailable("linearisation", why)
    return found


def steady_order(analysis: Analysis) -> str:
    """A hint at the rotation sequence in which the first approximation is steady; "" where none is known."""
    if not analysis.suggests:
        return ""
    for other in rotation_orders(analysis.system):
        try:
            type(analysis)(other.system, (), analysis.terms, suggests=False).linearisation  # noqa: B018
        except Failure:
            continue
        axes, angles = ", ".join(map(str, other.axes)), ", ".join(other.angles)
        order = f"rotation: {{axes: [{axes}], angles: [{angles}]}}"
        return f"with '{order}' of body '{other.body}' the coefficients are constant"
    return ""
