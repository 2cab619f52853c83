"""Welded bodies: lumped into what carries them, the motion is that of a description where they are one body."""

from __future__ import annotations

from typing import Any

import pytest
from flint import arb, ctx

import mbsym
from mbsym.algebra.point import Balls
from mbsym.mechanics import articulation
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.programs import METHODS, constants, forward_dynamics
from mbsym.mechanics.states import ball_states
from mbsym.mechanics.variables import ring_of
from mbsym.model.system import System, acceleration_name
from mbsym.model.welded import lumped, welded

#: Bits of the balls, and how near to each other their midpoints are where values are equal.
BITS, CLOSE = 256, 1e-60

#: Two links and what is welded to them: a plate aslant, a rotor in it, a mass on the plate; a spring and a force hold
#: on to the welded ones.  ``bracket`` has no mass; ``slider`` slides on what is welded.
ARM = """
mbsym: 1
name: An arm with welded parts
parameters: {m: positive, M: positive, a: real, b: real, c: real, g: positive, k: positive, F: real, h: real,
             J1: positive, J2: positive, J3: positive, J12: real, beta: real}
prescribed:
  kappa: {rate: 0, initial: beta/3}
bodies:
  - {name: link, attached to: 0, rotation: {axes: [3, 1], angles: [x, y]}, mass: M, mass centre: [a, b, 0],
     inertia about: joint, inertia: [[J1, J12, 0], [J12, J2, 0], [0, 0, J3]]}
  - {name: bracket, attached to: link, connection point: [a, c, b], mass: 0,
     rotation: {axes: [1, 3], angles: [beta, pi/6]}}
  - {name: plate, attached to: bracket, connection point: [b, a, 0], rotation: {axes: [2], angles: [beta]}, mass: m,
     mass centre: [c, a, b], inertia about: mass centre, inertia: [[J2, 0, J12], [0, J3, 0], [J12, 0, J1]],
     gyrostatic moment: [h, 0, J12]}
  - {name: weight, attached to: plate, connection point: [0, kappa, c], rotation: {axes: [3], angles: [kappa]},
     mass: 2*m, mass centre: [b, 0, 0]}
  - {name: slider, attached to: weight, coordinates: [s], connection point: [s, 0, a], mass: m, mass centre: [0, c, 0]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - spring: {between: [{body: plate, point: [a, b, c]}, {body: 0, point: [a, 0, 0]}], stiffness: k, length: b}
  - force: {body: weight, point: [0, c, a], components: [F, 0, F], axes: weight}
"""

#: The same in a Newtonian field, whose expansion is about a point that is welded.
SATELLITE = """
mbsym: 1
name: A satellite with a welded boom
parameters: {nu: positive, m: positive, M: positive, a: real, J1: positive, J2: positive, J3: positive, beta: real}
bodies:
  - {name: hub, attached to: 0, coordinates: [r, z, x, y], connection point: [r, 0, z],
     rotation: {axes: [3, 2], angles: [x, y]},
     mass: M, mass centre: [a, 0, 0], inertia about: mass centre, inertia: [[J1, 0, 0], [0, J2, 0], [0, 0, J3]]}
  - {name: boom, attached to: hub, connection point: [0, a, a], rotation: {axes: [1], angles: [beta]}, mass: m,
     mass centre: [0, 0, a], inertia about: joint, inertia: [[J3, 0, 0], [0, J1, 0], [0, 0, J2]]}
loads:
  - newtonian gravity: {constant: nu, centre: 0, about: boom, order: 2}
"""


def accelerations(system: System, state: State, method: str | None = None, apart: bool = False) -> list[arb]:
    """q'' in balls at a state."""
    found = forward_dynamics(system, ring_of(system), method, apart)
    values: Any = state.values
    return list(found.program.evaluate(found.accelerations, values, Balls(values)))


def same(left: list[arb], right: list[arb]) -> bool:
    return all(
        float(abs(a - b).upper()) <= CLOSE * (1 + float(abs(b).upper())) for a, b in zip(left, right, strict=True)
    )


@pytest.mark.parametrize("text", [ARM, SATELLITE], ids=["arm", "satellite"])
@pytest.mark.parametrize("method", METHODS)
def test_lumped_or_apart_the_accelerations_are_equal(text: str, method: str) -> None:
    system = mbsym.loads(text, ()).system
    with ctx.workprec(BITS):
        for state in ball_states(system, ring_of(system), 3):
            assert same(accelerations(system, state, method), accelerations(system, state, method, apart=True))


@pytest.mark.parametrize("text", [ARM, SATELLITE], ids=["arm", "satellite"])
def test_both_satisfy_the_equations_in_inertial_axes(text: str) -> None:
    """d'Alembert's principle with a geometry of its own: M q'' - f = 0."""
    system = mbsym.loads(text, ()).system
    with ctx.workprec(BITS):
        (state,) = ball_states(system, ring_of(system), 1)
        for apart in (False, True):
            assert satisfied(system, state, accelerations(system, state, apart=apart))


def satisfied(system: System, state: State, found: list[arb]) -> bool:
    moving = dict(zip(map(acceleration_name, system.coordinates), found, strict=True))
    values: Any = {**state.values, **moving}
    residuals: Any = Oracle(system, State(Balls(values), values)).residuals
    return all(float(abs(x).upper()) < CLOSE for x in residuals.values())


#: A compound pendulum: a rod on a hinge, and a disc whose axis is turned by 30 degrees welded to its end.
PENDULUM = """
mbsym: 1
name: A rod with a welded disc
parameters: {m: positive, M: positive, L: positive, r: positive, g: positive}
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [theta]}, mass: m, mass centre: [L/2, 0, 0],
     inertia about: joint, inertia: [[0, 0, 0], [0, m*L**2/3, 0], [0, 0, m*L**2/3]]}
  - {name: disc, attached to: rod, connection point: [L, 0, 0], rotation: {axes: [1], angles: [pi/6]}, mass: M,
     mass centre: [r, 0, 0],
     inertia about: mass centre, inertia: [[M*r**2/4, 0, 0], [0, M*r**2/4, 0], [0, 0, M*r**2/2]]}
loads:
  - uniform gravity: {acceleration: g, direction: [1, 0, 0]}
"""


def by_hand(rod: arb, disc: arb, length: arb, r: arb, g: arb, angle: arb) -> arb:
    """theta'' = -g sin(theta) (m L/2 + M (L + r)) / (m L^2/3 + J + M (L + r)^2), J = M r^2 (cos^2/2 + sin^2/4)."""
    spin = disc * r * r * (arb(3) / 8 + arb(1) / 16)
    weight, inertia = rod * length / 2 + disc * (length + r), rod * length * length / 3 + disc * (length + r) ** 2
    return -g * angle.sin() * weight / (inertia + spin)


def test_a_welded_disc_by_hand() -> None:
    system = mbsym.loads(PENDULUM, ()).system
    with ctx.workprec(BITS):
        for state in ball_states(system, ring_of(system), 2):
            v: Any = state.values
            truth = by_hand(v["m"], v["M"], v["L"], v["r"], v["g"], v["theta"])
            for apart in (False, True):
                assert same(accelerations(system, state, apart=apart), [truth])


def test_a_lost_steiner_term_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: a body that is moved to its carrier keeps its tensor.  Lumped is then neither apart nor the truth."""

    def lost(algebra: Any, x: Any, r: Any) -> Any:
        moved = shifted(algebra, x, r)
        return articulation.MassProperties(moved.mass, moved.first_moment, x.tensor)

    shifted = articulation.shifted
    system = mbsym.loads(ARM, ()).system
    with ctx.workprec(BITS):
        (state,) = ball_states(system, ring_of(system), 1)
        apart = accelerations(system, state, apart=True)
        monkeypatch.setattr(articulation, "shifted", lost)
        wrong = accelerations(system, state)
        assert not same(wrong, apart)
        assert not satisfied(system, state, wrong)


def test_what_is_welded_to_what() -> None:
    system = mbsym.loads(ARM, ()).system
    assert welded(system) == {"bracket": "link", "plate": "link", "weight": "link"}
    assert lumped(system) == {"plate": "link", "weight": "link"}
    moving = mbsym.loads(ARM.replace("rate: 0", "rate: b"), ()).system
    assert lumped(moving) == {"plate": "link"}
    assert lumped(mbsym.loads(PENDULUM.replace("angles: [pi/6]", "angles: [phi]"), ()).system) == {}


@pytest.mark.parametrize("text", [ARM, PENDULUM], ids=["arm", "pendulum"])
def test_lumping_saves_operations(text: str) -> None:
    system = mbsym.loads(text, ()).system
    costs = []
    for apart in (False, True):
        found = forward_dynamics(system, ring_of(system), apart=apart)
        costs.append(found.program.operations(found.accelerations, constants(system)))
    assert costs[0] < 0.9 * costs[1]
