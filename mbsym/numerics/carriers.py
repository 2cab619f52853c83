"""The frames in which a system may be seen: the inertial one, and those that it carries whatever its coordinates do."""

from __future__ import annotations

from mbsym.expressions.tree import ZERO, names
from mbsym.mechanics.variables import expressions
from mbsym.model.system import INERTIAL, System

#: A frame further out is taken as long as the system, its origin included, looks at most so much larger in it.
COMPACT = 2.0

#: What moves less than this part of the whole does not move.
STILL = 1e-9


def frames(system: System) -> list[str]:
    """The inertial frame, and further in those that carry everything and that no coordinate moves."""
    moving = {*system.coordinates, *system.velocities}
    chain = [INERTIAL]
    while True:
        carried = [body for body in system.bodies if body.attached_to == chain[-1]]
        if len(carried) != 1 or carried[0].mass != ZERO or carried[0].inertia is not None:
            return chain
        (body,) = carried
        alone = not any(other.attached_to == body.name for other in system.bodies)
        if alone or any(moving & names(x) for x in expressions((body.rotation, body.connection_point))):
            return chain
        chain.append(body.name)
