"""A system with some coordinates held at constant values: one with fewer degrees of freedom, described the same way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from mbsym.expressions.tree import ZERO, Expression
from mbsym.model.substitution import put
from mbsym.model.system import System, acceleration_name, velocity_name


def held(system: System, values: Mapping[str, Expression]) -> System:
    """The system with q_i = values[i] (and q_i' = 0) put in everywhere and those coordinates taken out.

    Forces on a coordinate that is held do no work and are left out with it.  Whether the coordinates stay where they
    are held is another question (``mbsym.numerics.planning.reduction``); claims about the whole system are dropped.
    """
    images: dict[str, Expression] = {}
    for name, value in values.items():
        images |= {name: value, velocity_name(name): ZERO, acceleration_name(name): ZERO}
    bodies = []
    for body in system.bodies:
        kept = tuple(name for name in body.coordinates if name not in values)
        bodies.append(replace(put(body, images), coordinates=kept))
    loads = [put(left, images) for load in system.loads if (left := load.without(values)) is not None]
    changes: dict[str, Any] = {
        "bodies": tuple(bodies),
        "loads": tuple(loads),
        "motion": tuple(put(e, images) for e in system.motion if e.coordinate not in values),
        "initial": tuple(put(e, images) for e in system.initial if e.coordinate not in values),
        "claims": (),
    }
    return replace(system, **changes)
