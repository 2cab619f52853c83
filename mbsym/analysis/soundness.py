"""What is wrong with constraints and given matrices that only mechanics can tell, as complaints with places."""

from __future__ import annotations

from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Ring
from mbsym.expressions.place import Complaints
from mbsym.mechanics.kinematics import Scene, over_ring
from mbsym.mechanics.variables import ring_of
from mbsym.model.system import System
from mbsym.problems import given_system, knowledge
from mbsym.problems.constraints.analysis import Fault, Unsound, constraints, faults


def complain(system: System, complaints: Complaints) -> None:
    """Everything that only mechanics and algebra can tell of a description."""
    complain_of_constraints(system, complaints)
    complain_of_matrices(system, complaints)


def complain_of_constraints(system: System, complaints: Complaints) -> None:
    """Adds an error for every constraint that contradicts others or ties nothing, and for a wrong dependent set."""
    if not system.constraints:
        return
    ring, plain = ring_of(system), system.without_speeds if system.speeds else system
    try:
        scene = over_ring(plain, ring)
        detected = faults(scene)
        if system.speeds and system.dependent and not detected:
            detected = _in_speeds(system, ring, scene)
    except Failure:  # nothing is known to be wrong; the derivation says what it has met
        return
    for fault in detected:
        _complain(fault, system, complaints)


def complain_of_matrices(system: System, complaints: Complaints) -> None:
    """Adds an error for every given matrix without the symmetry that its key promises, and for a bad mass matrix."""
    if system.linear is None:
        return
    ring = ring_of(system)
    scene = over_ring(system, ring, bodies=False)
    try:
        for fault in given_system.faults(scene, knowledge.signs(scene)):
            complaints.error(fault.code, fault.message, fault.span, fault.hint or None)
    except Failure:
        return


def _in_speeds(system: System, ring: Ring, plain: Scene) -> tuple[Fault, ...]:
    """What is wrong with the dependent set among speeds; ``plain`` is the system in coordinates."""
    from mbsym.mechanics.constraints.programs import constrained_programs  # few systems have speeds and constraints
    from mbsym.mechanics.speeds import SpeedForm
    from mbsym.problems.constraints.analysis import constraints_in_speeds

    tied, form = constraints(plain), SpeedForm(system, ring)
    components = [(name.constraint, name.component) for name in tied.names]
    try:
        constraints_in_speeds(form, form.scene(), tied, constrained_programs(plain.system, ring, components))
    except Unsound as reason:
        return reason.faults
    return ()


def _complain(fault: Fault, system: System, complaints: Complaints) -> None:
    places = {row.constraint: row.span for row in fault.rows}
    for span in places.values() or [system.dependent_span]:
        complaints.error(fault.code, fault.message, span, fault.hint or None)
