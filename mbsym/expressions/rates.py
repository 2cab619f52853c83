"""What derivatives with respect to time are called: ``theta_dot``, ``theta_ddot``; such names are put together here."""

from __future__ import annotations

import re

#: Behind the name of a coordinate, a speed or a component of a unit vector.
VELOCITY_ENDING, ACCELERATION_ENDING = "_dot", "_ddot"

#: The same by the kinds of the ring's generators.
ENDINGS = {"velocity": VELOCITY_ENDING, "acceleration": ACCELERATION_ENDING}


def velocity_name(name: str) -> str:
    """theta_dot of theta."""
    return name + VELOCITY_ENDING


def acceleration_name(name: str) -> str:
    """theta_ddot of theta."""
    return name + ACCELERATION_ENDING


def derivative_names(name: str, order: int) -> tuple[str, ...]:
    """a, a_dot, a_ddot, a_dddot, ...: of a function of time, and of its derivatives up to an order."""
    return (name, *(f"{name}_{'d' * k}ot" for k in range(1, order + 1)))


def without_derivatives(name: str) -> str:
    """a of a, a_dot, a_ddot, a_dddot, ...."""
    return re.sub(r"_d+ot\Z", "", name)


def derivative_of(kind: str, name: str) -> tuple[str, str]:
    """(kind, name) as a generator is written: what is prescribed by the name a_dot as the velocity of a."""
    if kind == "prescribed":
        for rate, ending in ENDINGS.items():
            if name.endswith(ending):
                return rate, name.removesuffix(ending)
    return kind, name


def without_velocity(name: str) -> str:
    """theta of theta_dot; any other name as it is."""
    return name.removesuffix(VELOCITY_ENDING)


def is_velocity(name: str) -> bool:
    """Whether it is a name of a velocity, by its ending."""
    return name.endswith(VELOCITY_ENDING)


def is_rate(name: str) -> bool:
    """Whether it is a name of a velocity or an acceleration, by its ending."""
    return name.endswith((VELOCITY_ENDING, ACCELERATION_ENDING))
