"""What each body does along a trajectory: place, velocity, acceleration, turning and kinetic energy.

    r_C,  v_C = dr_C/dt,  a_C = dv_C/dt          of the mass centre, in the axes of a frame F, from its origin
    R                                            direction cosines of the body's axes in F, v^body = R v^F
    omega                                        absolute angular velocity, in the body's axes
    T = 1/2 m V.V + 1/2 omega.Theta_C omega      absolute kinetic energy

Velocity and acceleration are those seen in F: the rates of r_C's components.  They are exact derivatives of the
straight-line program for r_C, along q' and q'', not differences.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mbsym.algebra.base import Lowering
from mbsym.algebra.derivative import jacobian
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.program import Node, Program
from mbsym.algebra.vectors import axis_vector
from mbsym.expressions.tree import names
from mbsym.mechanics.energy import body_energy
from mbsym.mechanics.loads.kinds import force_function
from mbsym.mechanics.programs import scene_without_accelerations
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.variables import program_environment, ring_of
from mbsym.model.states import InStates, described
from mbsym.model.system import INERTIAL, acceleration_name
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code, Kernel
from mbsym.numerics.kernels.llvm import kernels
from mbsym.numerics.scenario import Scenario, bound, substituted


@dataclass(frozen=True)
class BodyMotions:
    """Bodies in the order of ``names``, times last: ``places``, ``velocities``, ``accelerations`` and
    ``angular_velocities`` have shape (bodies, 3, m), ``axes`` (bodies, 3, 3, m) with body axis i in row i,
    ``kinetic`` (bodies, m); ``force_function`` is U, shape (m,)."""

    names: tuple[str, ...]
    frame: str
    times: Any
    places: Any
    velocities: Any
    accelerations: Any
    angular_velocities: Any
    axes: Any
    kinetic: Any
    force_function: Any


def body_motions(scenario: Scenario, times: Any, states: Any, rates: Any, frame: str = INERTIAL) -> BodyMotions:
    """Of every body that ``frame`` carries, massless ones too, along ``states`` (2n, m) with q'' = ``rates`` (n, m).

    In declared variables along (s, u) with the rates of both.  Raises Failure where there is no program for the force
    function.
    """
    return followed_bodies(scenario, frame)(times, states, rates)


def followed_bodies(scenario: Scenario, frame: str = INERTIAL) -> Callable[[Any, Any, Any], BodyMotions]:
    """``body_motions`` of times, states and rates, for whoever has them bit by bit."""
    system = scenario.system
    program = Program()
    carried: list[Node] = []
    if isinstance(system, InStates):
        form = SpeedForm(described(system), ring_of(described(system)))
        environment = dict(program_environment(form.system, program))
        scene, carry = form.scene_over(program, environment), Carrier(form.ring, program, environment)
        carried = [carry(form.rates[name]) for name in system.coordinates]
    else:
        scene = scene_without_accelerations(system, ring_of(system), program)
    algebra = scene.algebra
    names = tuple(body.name for body in system.bodies if frame in system.path(body.name)[:-1])
    fixed: list[Node] = []
    for name in names:
        motion = scene.motions[name]
        fixed += scene.position(motion.mass_centre, frame)
        for axis in (1, 2, 3):
            fixed += scene.to_axes(axis_vector(algebra, axis, algebra.one, name), frame)
        fixed += [*motion.angular_velocity, body_energy(scene, motion)]
    fixed.append(force_function(scene))
    fresh = bound(scenario)
    nodes = substituted(program, fixed, fresh)
    each = 3 + 9 + 3 + 1
    places = [node for k in range(len(names)) for node in nodes[each * k : each * k + 3]]
    state, accelerations = (*system.coordinates, *system.velocities), [*map(acceleration_name, system.coordinates)]
    moving = [*map(fresh.input, system.velocities)]
    rates = [*system.velocities, *accelerations]
    if isinstance(system, InStates):
        rates = accelerations = [f"rate of {name}" for name in state]
        moving = substituted(program, carried, fresh)
    first = _rate(fresh, places, system.coordinates, moving)
    second = _rate(fresh, first, state, [*map(fresh.input, rates)])
    inputs = ("t", *state, *accelerations)
    compiled = kernels({"bodies": Code(fresh, inputs, (*nodes, *first, *second))})
    return lambda times, states, rates: _evaluated(compiled["bodies"], names, frame, times, states, rates)


def _evaluated(kernel: Kernel, names: tuple[str, ...], frame: str, times: Any, states: Any, rates: Any) -> BodyMotions:
    moments = np.vstack([times, np.asarray(states, dtype=float), np.asarray(rates, dtype=float)])
    with np.errstate(all="ignore"):
        outputs = np.array(kernel(moments), dtype=float)
    each = 3 + 9 + 3 + 1
    m, count = moments.shape[1], len(names)
    own = outputs[: each * count].reshape(count, each, m)
    moving = outputs[each * count + 1 :].reshape(2, count, 3, m)
    return BodyMotions(
        names=names,
        frame=frame,
        times=moments[0],
        places=own[:, :3],
        velocities=moving[0],
        accelerations=moving[1],
        angular_velocities=own[:, 12:15],
        axes=own[:, 3:12].reshape(count, 3, 3, m),
        kinetic=own[:, 15],
        force_function=outputs[each * count],
    )


def _rate(program: Program, outputs: Sequence[Node], names: Sequence[str], rates: Sequence[Node]) -> list[Node]:
    """d/dt of nodes: the partial derivative by t, and those by ``names`` times their ``rates``."""
    if not outputs:
        return []
    rows = jacobian(program, outputs, [program.input("t"), *map(program.input, names)])
    nodes = []
    for row in rows:
        total = row[0]
        for partial, rate in zip(row[1:], rates, strict=True):
            total = total + partial * rate
        nodes.append(total)
    return nodes


# Columns of a trajectory besides the state: inputs by their laws, and speeds, unit vectors and quaternions.
#
#     u = S(q, t) q' + s0(q, t),      e = the columns of the direction cosines R(q), or turns by half angles, one by one
#
# as the straight-line program of their closed formulas (``mbsym.mechanics.speeds``).


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
        columns = kernel(np.vstack([times, np.asarray(states, dtype=float)]))
    return dict(zip(formulas, columns, strict=True))


def input_columns(scenario: Scenario, times: Any, positions: Any, velocities: Any) -> dict[str, Any]:
    """u(t, q, q') of shape (m,) by name, at times (m,) with q and q' of shape (n, m)."""
    if not scenario.inputs:
        return {}
    program = bound(scenario)
    used = set().union(*(names(signal.in_coordinates) for signal in scenario.inputs))
    lower = Lowering(program, {name: program.input(name) for name in (*sorted(used), "pi")})
    nodes = tuple(lower(signal.in_coordinates) for signal in scenario.inputs)
    inputs = ("t", *scenario.system.coordinates, *scenario.system.velocities)
    points = np.vstack([times, np.asarray(positions, dtype=float), np.asarray(velocities, dtype=float)])
    values = arrays.kernel(Code(program, inputs, nodes))(points)
    shaped = (np.broadcast_to(value, np.shape(times)) for value in values)
    return dict(zip((signal.name for signal in scenario.inputs), shaped, strict=True))
