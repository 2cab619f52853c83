"""Bodies that are welded to the one they hang on: rotation and connection point hold nothing that moves."""

from __future__ import annotations

from mbsym.expressions.tree import names
from mbsym.model.system import INERTIAL, Body, System, rational


def still_names(system: System) -> frozenset[str]:
    """The names whose values never change: parameters, and what is prescribed with the rate 0."""
    standing = (item.name for item in system.prescribed if rational(item.rate) == 0)
    return frozenset((*system.parameter_names, *standing))


def welded(system: System) -> dict[str, str]:
    """Each body that is welded to another, with the one that carries it: the first on its way to the base that moves
    against the one that it hangs on itself, or the inertial frame."""
    still = still_names(system)
    carriers: dict[str, str] = {}
    for body in system.bodies:
        if _fixed(body, still):
            carriers[body.name] = carriers.get(body.attached_to, body.attached_to)
    return carriers


def lumped(system: System) -> dict[str, str]:
    """Those of them that have a mass or an inertia, and are carried by a body that moves."""
    heavy = {body.name for body in system.bodies if rational(body.mass) != 0 or body.inertia is not None}
    return {name: carrier for name, carrier in welded(system).items() if name in heavy and carrier != INERTIAL}


def _fixed(body: Body, still: frozenset[str]) -> bool:
    angles = (angle for _, angle in body.rotation.turns())
    return all(names(x) <= still for x in (*angles, *body.connection_point))
