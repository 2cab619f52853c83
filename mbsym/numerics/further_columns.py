"""Columns of a trajectory besides the state: inputs by their laws, and speeds, unit vectors and quaternions.

    u = S(q, t) q' + s0(q, t),      e = the columns of the direction cosines R(q), or turns by half angles, one by one

as the straight-line program of their closed formulas (``mbsym.mechanics.speeds``).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mbsym.algebra.base import Lowering
from mbsym.algebra.program import Program
from mbsym.expressions.tree import names
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.variables import ring_of
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.kernels.llvm import kernels
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.specialise import bound, substituted


def speed_columns(scenario: Scenario, times: Any, states: Any) -> dict[str, Any]:
    """By name the values, of shape (m,), at times (m,) and states (2n, m); empty where a system has no speeds.

    Raises Failure where the speeds have no closed formulas.
    """
    system = scenario.system
    if not system.speeds:
        return {}
    ring = ring_of(system)
    form = SpeedForm(system, ring)
    program = Program()
    formulas = form.variables_in_coordinates(program)
    fresh = bound(scenario)
    nodes = substituted(program, list(formulas.values()), fresh)
    inputs = ("t", *system.coordinates, *system.velocities)
    kernel = kernels({"speeds": Code(fresh, inputs, tuple(nodes))})["speeds"]
    with np.errstate(all="ignore"):
        found = kernel(np.vstack([times, np.asarray(states, dtype=float)]))
    return dict(zip(formulas, found, strict=True))


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
