"""Coordinates as sliders see them: what they are, where they start, how far they go."""

from __future__ import annotations

from math import pi

from mbsym.algebra.failures import Failure
from mbsym.expressions.tree import names
from mbsym.mechanics.variables import angles_of
from mbsym.model.quantities import unit_of
from mbsym.model.system import System
from mbsym.numerics.scenario import Scenario, exact
from mbsym.picture.values import Coordinate, Measure


def coordinates(scenario: Scenario) -> tuple[Coordinate, ...]:
    """In the order of the system.  An angle goes half a turn either way of its start, a length as far as it is long."""
    system = scenario.system
    limits = {item.coordinate: item for item in system.limits}
    found = []
    for name, position, velocity in zip(system.coordinates, scenario.positions, scenario.velocities, strict=True):
        kind, value = measure(system, name), float(position)
        far = pi if kind is Measure.ANGLE else max(1.0, abs(value))
        low, high, limited = value - far, value + far, False
        if name in limits:
            try:
                bounds = [float(exact(x, scenario.parameters)) for x in (limits[name].lower, limits[name].upper)]
            except (Failure, KeyError):
                bounds = []
            if bounds and bounds[0] < bounds[1]:
                low, high, limited = min(bounds[0], value), max(bounds[1], value), True
        unit = unit_of(system, name) or ""
        found.append(Coordinate(name, kind, unit, value, float(velocity), low, high, limited))
    return tuple(found)


def measure(system: System, name: str) -> Measure:
    """An angle stands under a sine or turns a body; a length moves a connection point and is none."""
    if any(name in names(angle) for angle in angles_of(system)):
        return Measure.ANGLE
    moving = (x for body in system.bodies for x in body.connection_point)
    return Measure.LENGTH if any(name in names(x) for x in moving) else Measure.OTHER
