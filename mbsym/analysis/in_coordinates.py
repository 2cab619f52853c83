"""Problems 4 to 6 of a system in speeds: in generalised coordinates and velocities, where these follow from the speeds.

With  u = S(q, t) q' + s0  and det S different from 0 on the unperturbed motion, (q, q') and the state in speeds and
unit vectors are smooth functions of each other near it: the one satisfies its equations where the other does, and
stability, asymptotic stability and instability are the same for both.  The theorems about second-order equations
(Lagrange, Kelvin and Chetaev) hold in q and q'.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mbsym.algebra.matrices import determinant
from mbsym.analysis.deriving import in_other_angles
from mbsym.analysis.stages import NoResult, Unavailable
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import relations, unperturbed_with
from mbsym.mechanics.variables import ring_environment

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis
    from mbsym.model.system import System


def analysis(source: Analysis) -> Analysis:
    """The analysis of the same system without speeds.  Raises Unavailable where det S vanishes, or may do so."""
    form = source.speed_form
    assert form is not None
    system = source.system.without_speeds
    ring = source.ring
    if system.motion:
        plain = Scene(system, ring, ring_environment(system, ring), ring, bodies=False)
        at = unperturbed_with(plain, relations(plain))
        rows = [
            [x.derivative(ring.index("velocity", name)) for name in system.coordinates] for x in form.in_coordinates
        ]
        if ring.is_zero(ring.substitute(determinant(ring, rows), at)) is not False:
            reason = "on the given motion the angles are singular: the speeds do not determine their rates there"
            hint = "choose other axes of 'rotation'; those of unit vectors may be any"
            raise Unavailable("motion", NoResult(reason, hint, "singular angles", "singular-angles"))
    return _same(source, system)


def told(source: Analysis, name: str) -> Any:
    """A result there; of angles that are singular on the motion the verdict may be had in others."""
    try:
        return getattr(source.in_coordinates, name)
    except Unavailable as failure:
        singular = name == "stability" and failure.failure.code == "singular-angles"
        found = in_other_angles(_same(source, source.system.without_speeds)) if singular else None
        if found is None or found.presumed:  # conditions that no problem 4 tells would be presumed
            raise
        return found


def _same(source: Analysis, system: System) -> Analysis:
    there = type(source)(system, source.problems, source.terms, source.suggests, source.angles)
    there.__dict__["ring"] = source.ring
    return there
