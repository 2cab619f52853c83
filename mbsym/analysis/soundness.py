"""What is wrong with constraints and given matrices that only mechanics can tell, as complaints with places."""

from __future__ import annotations

from mbsym.algebra.failures import Failure
from mbsym.expressions.place import Complaints
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.variables import ring_environment, ring_of
from mbsym.model.system import System
from mbsym.problems import given_system, knowledge
from mbsym.problems.constraints import Fault, faults


def complain(system: System, complaints: Complaints) -> None:
    """Everything that only mechanics and algebra can tell of a description."""
    complain_of_constraints(system, complaints)
    complain_of_matrices(system, complaints)


def complain_of_constraints(system: System, complaints: Complaints) -> None:
    """Adds an error for every constraint that contradicts others or ties nothing, and for a wrong dependent set."""
    if not system.constraints:
        return
    if system.speeds:
        message = "constraints are not taken into account yet where there are 'speeds' or an 'orientation'"
        complaints.error("constraints", message, system.constraints[0].span, "write the system in its coordinates")
        return
    ring = ring_of(system)
    try:
        found = faults(Scene(system, ring, ring_environment(system, ring), ring))
    except Failure:  # nothing is known to be wrong; the derivation says what it has met
        return
    for fault in found:
        _complain(fault, system, complaints)


def complain_of_matrices(system: System, complaints: Complaints) -> None:
    """Adds an error for every given matrix without the symmetry that its key promises, and for a bad mass matrix."""
    if system.linear is None:
        return
    ring = ring_of(system)
    scene = Scene(system, ring, ring_environment(system, ring), ring, bodies=False)
    try:
        for fault in given_system.faults(scene, knowledge.signs(scene)):
            complaints.error(fault.code, fault.message, fault.span, fault.hint or None)
    except Failure:
        return


def _complain(fault: Fault, system: System, complaints: Complaints) -> None:
    places = {row.constraint: row.span for row in fault.rows}
    for span in places.values() or [system.dependent_span]:
        complaints.error(fault.code, fault.message, span, fault.hint or None)
