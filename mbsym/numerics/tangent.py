"""Constraints to first order about the unperturbed motion: where a linear model of a scenario begins.

    C (x - x0) = 0,      C = [df/dq, 0; dg/dq, J]  on the unperturbed motion x0 = (value + rate t, rate)

What is given of the independent deviations stays, the dependent ones follow: of N with C N = 0 the rows that are kept
determine z, and x - x0 = N z.  Kept are, in this order, what is fixed, what the description states and does not call
dependent, what the motion names, and the rest, each if those before it do not determine it.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from fractions import Fraction

import numpy as np

from mbsym.algebra.failures import Constrained
from mbsym.expressions.message import Message
from mbsym.model.system import velocity_name
from mbsym.numerics.constrained import drift
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.probes import motion_state
from mbsym.numerics.scenario import Scenario

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


def along_motion(dynamics: Dynamics) -> tuple[Fraction, ...]:
    """(q, q') of the unperturbed motion at t = 0, whose rates are constant.

    Raises NoTangent where it does not keep the constraints, or these lose their rank on it.
    """
    constraints, state = dynamics.constraints, motion_state(dynamics.scenario)
    assert constraints is not None
    if state is None:
        raise NoTangent("there is no unperturbed motion")
    n, base = constraints.size, np.array([float(x) for x in state])
    rates = np.concatenate([base[n:], np.zeros(n)])
    states = np.array([base + rates * time for time in LOOKED_AT]).T
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


def on_tangent(scenario: Scenario, fixed: Collection[str] = ()) -> Scenario:
    """The scenario with an initial state that keeps its constraints to first order; itself where there are none.

    Raises NoTangent.
    """
    system = scenario.system
    if not system.constraints:
        return scenario
    dynamics = Dynamics(scenario)
    motion, constraints = along_motion(dynamics), dynamics.constraints
    assert constraints is not None
    base = np.array([float(x) for x in motion])
    basis = constraints.tangent(0.0, base)
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
