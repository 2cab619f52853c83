"""Constraints to first order about the unperturbed motion: where a linear model of a scenario begins.

    C (x - x0) = 0,      C = [df/dq, 0; dg/dq, J]  on the unperturbed motion x0 = (value + rate t, rate)

In declared variables x0 is what these are along it, and rows of C besides are e of a quaternion, of unit vectors those
of their products: the angles may be singular.

What is given of the independent deviations stays, the dependent ones follow: of N with C N = 0 the rows that are kept
determine z, and x - x0 = N z.  Kept are, in this order, what is fixed, what the description states and does not call
dependent, what the motion names, and the rest, each if those before it do not determine it.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations_with_replacement
from typing import Any

import numpy as np

from mbsym.algebra.base import Lowering
from mbsym.algebra.failures import Constrained
from mbsym.algebra.program import Node, Program
from mbsym.expressions.message import Message
from mbsym.mechanics.motion import motion_values
from mbsym.mechanics.speed_programs import orthonormal
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.variables import ring_of
from mbsym.model.speeds import Quaternion
from mbsym.model.states import InStates, described
from mbsym.model.system import velocity_name
from mbsym.numerics.constrained import drift
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.probes import motion_state
from mbsym.numerics.scenario import Scenario, Specialised, bound, substituted
from mbsym.numerics.states import dynamics_of, scenario_in_states

#: A motion that is further off the constraints than this part of its size does not keep them; times of looking.
KEPT, LOOKED_AT = 1e-9, (0.0, 1 / 3, 7 / 5, 29 / 7)

#: A deviation of which others leave less than this part is determined by them.
DETERMINED = 1e-6

#: What deviates by less than this part of what others do is rounding.
NOUGHT = 1e-12

#: A value that moves by less than this part of its size, or deviates by less than this part of the largest deviation,
#: does so by roundings.
ROUNDED = 1e-14


class NoTangent(Constrained):
    """There is no motion near which the constraints could be told to first order."""


def unperturbed(scenario: Scenario, program: Specialised) -> dict[str, Node]:
    """x0(t) by name, in a program of the scenario; velocities that the motion does not name follow from constraints."""
    lower, time, nodes = Lowering(program, program.bound), program.input("t"), dict[str, Node]()
    plain = _in_coordinates(scenario)
    system = plain.system
    along: list[tuple[Node, Node]] = [(lower(at), lower(rate)) for at, rate in motion_values(system).values()]
    if system.constraints:
        state, n = motion_state(plain), len(system.coordinates)
        assert state is not None
        along = [(program.number(at), program.number(rate)) for at, rate in zip(state[:n], state[n:], strict=True)]
    rates = dict(zip(system.velocities, (rate for _, rate in along), strict=True))
    for name, (at, rate) in zip(system.coordinates, along, strict=True):
        nodes[name] = at + program.product(rate, time)
    nodes |= rates
    if not isinstance(scenario.system, InStates):
        return nodes
    told = Program()
    made = SpeedForm(system, ring_of(system)).state_in_coordinates(told)
    placed = substituted(told, made, Placed(program, nodes))
    return dict(zip((*scenario.system.coordinates, *scenario.system.velocities), placed, strict=True))


class Placed(Specialised):
    """Writes into another program, with nodes of that program in place of some inputs."""

    def __init__(self, target: Specialised, images: dict[str, Node]) -> None:
        self.__dict__.update(target.__dict__)  # the same instructions and tables: nodes belong to the target
        self.bound = {**target.bound, **images}

    def __hash__(self) -> int:
        return id(self)


def _in_coordinates(scenario: Scenario) -> Scenario:
    """The scenario as it is described, its initial state left out where that is in declared variables."""
    if not isinstance(scenario.system, InStates):
        return scenario
    system = described(scenario.system)
    rest = (Fraction(0),) * len(system.coordinates)
    return replace(scenario, system=system, positions=rest, velocities=rest, typed={}, declared=())


def along_motion(dynamics: Dynamics) -> tuple[Fraction, ...]:
    """x0 at t = 0, of a motion whose rates are constant.

    Raises NoTangent where it does not keep the constraints, or these lose their rank on it.
    """
    scenario, constraints = dynamics.scenario, dynamics.constraints
    plain = _in_coordinates(scenario)
    state = motion_state(plain)
    if state is None:
        raise NoTangent("there is no unperturbed motion")
    if plain is not scenario:
        half = len(state) // 2
        state = scenario_in_states(replace(plain, positions=state[:half], velocities=state[half:])).state
    if constraints is None:
        return state
    program, base = bound(scenario), np.array([float(x) for x in state])
    code = Code(program, ("t",), tuple(unperturbed(scenario, program).values()))
    states = np.array([arrays.kernel(code)(np.array([time])) for time in LOOKED_AT]).T
    strayed = drift(constraints, np.array(LOOKED_AT), states, constraints.sizes(base))
    if not max(strayed.largest) <= KEPT:
        worst = max(range(2), key=lambda k: strayed.largest[k])
        row = strayed.worst[worst]
        text = "the motion that 'motion:' gives does not keep the constraints at these values ([[row]])"
        if (strayed.positions[0], strayed.velocities[0]) <= (KEPT, KEPT):
            text = "the motion that 'motion:' gives keeps the constraints at t = 0 only, not with its rates ([[row]])"
        hint = "linear equations are about a motion that they allow; without --linear any motion is integrated"
        raise NoTangent(Message(text, row="" if row is None else row.label), remedy=Message(hint))
    if len(constraints.independent(0.0, base)) < constraints.rank:
        hint = "about such a position there is no first approximation; without --linear the equations are integrated"
        raise NoTangent("the constraints lose their rank on the unperturbed motion", remedy=Message(hint))
    return state


def _allowed(dynamics: Dynamics, base: Any) -> Any:
    """A basis of the changes of x0 that keep constraints, norms and right angles to first order, in columns."""
    place = {name: k for k, name in enumerate(dynamics.inputs[1:])}
    basis = dynamics.tangent(0.0, base)
    rows = []
    for vectors in orthonormal(dynamics.system) if dynamics.in_states else ():
        at = [[place[name] for name in components] for components in vectors]
        for one, other in combinations_with_replacement(at, 2):
            row = np.zeros(len(base))
            row[one] += base[other]
            row[other] += base[one]
            rows.append(row)
    if not rows:
        return basis
    sizes, free = np.linalg.svd(np.array(rows) @ basis)[1:]
    return basis @ free[int(np.sum(sizes > DETERMINED)) :].T


def on_tangent(scenario: Scenario, fixed: Collection[str] = ()) -> Scenario:
    """The scenario with an initial state that keeps its constraints to first order, and norms of what it declares;
    itself where there is nothing to keep.

    Raises NoTangent.
    """
    system = scenario.system
    if not system.constraints and not isinstance(system, InStates):
        return scenario
    dynamics = dynamics_of(scenario)
    motion = along_motion(dynamics)
    scenario = _on_one_side(scenario, motion)
    basis = _allowed(dynamics, np.array([float(x) for x in motion]))
    names = (*system.coordinates, *system.velocities)
    named = {entry.coordinate for entry in system.motion}
    named |= {velocity_name(name) for name in named}
    dependent = {*system.dependent, *map(velocity_name, system.dependent), *scenario.unstated}

    def wanted(place: int) -> tuple[bool, bool, bool]:
        name = names[place]
        return name not in fixed, name in dependent, name not in named

    kept, left, sizes = list[int](), np.array(basis), np.linalg.norm(basis, axis=1)
    for place in sorted(range(len(names)), key=wanted):
        size = np.linalg.norm(left[place])
        if len(kept) < basis.shape[1] and size > max(DETERMINED * sizes[place], NOUGHT * np.max(sizes)):
            kept.append(place)
            left = left - np.outer(left @ left[place], left[place]) / size**2
    given = [float(x - y) for x, y in zip(scenario.state, motion, strict=True)]
    found = basis @ np.linalg.solve(basis[kept], np.array(given)[kept])
    found[np.abs(found) <= ROUNDED * np.max(np.abs(found), initial=0.0)] = 0.0
    state, moved = list(scenario.state), set[str]()
    for place, deviation in enumerate(found):
        new = motion[place] + Fraction(float(deviation))
        scale = max(abs(float(new)), abs(given[place]))
        if place not in kept and abs(float(new - state[place])) > ROUNDED * scale:
            state[place] = new
            moved.add(names[place])
    n = len(system.coordinates)
    typed = {name: value for name, value in scenario.typed.items() if name not in moved}
    return replace(scenario, positions=tuple(state[:n]), velocities=tuple(state[n:]), typed=typed)


def _on_one_side(scenario: Scenario, motion: Sequence[Fraction]) -> Scenario:
    """With the one of the quaternions e, -e of an orientation that is near that of the motion."""
    system, state = scenario.system, list(scenario.state)
    place = {name: k for k, name in enumerate((*system.coordinates, *system.velocities))}
    for body in system.bodies if isinstance(system, InStates) else ():
        for attitude in body.orientation:
            at = [place[name] for name in attitude.components]
            if isinstance(attitude, Quaternion) and sum(state[k] * motion[k] for k in at) < 0:
                for k in at:
                    state[k] = -state[k]
    n = len(system.coordinates)
    return replace(scenario, positions=tuple(state[:n]), velocities=tuple(state[n:]))
