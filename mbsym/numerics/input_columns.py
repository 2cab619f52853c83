"""The inputs of a run as numbers: what each is by its law, row by row."""

from __future__ import annotations

from typing import Any

import numpy as np

from mbsym.algebra.base import Lowering
from mbsym.expressions.tree import names
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.specialise import bound


def input_columns(given: Scenario, times: Any, positions: Any, velocities: Any) -> dict[str, Any]:
    """u(t, q, q') of shape (m,) by name, at times (m,) with q and q' of shape (n, m)."""
    if not given.inputs:
        return {}
    program = bound(given)
    used = set().union(*(names(one.law) for one in given.inputs))
    lower = Lowering(program, {name: program.input(name) for name in (*sorted(used), "pi")})
    nodes = tuple(lower(one.law) for one in given.inputs)
    inputs = ("t", *given.system.coordinates, *given.system.velocities)
    points = np.vstack([times, np.asarray(positions, dtype=float), np.asarray(velocities, dtype=float)])
    values = arrays.kernel(Code(program, inputs, nodes))(points)
    shaped = (np.broadcast_to(value, np.shape(times)) for value in values)
    return dict(zip((one.name for one in given.inputs), shaped, strict=True))
