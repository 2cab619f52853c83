"""Rows of constraints: rates and J by recursion against derivatives in the ring and against the oracle's places."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from conftest import system_of
from kinds_of_constraints import BODIES, KINDS

from mbsym.algebra.failures import Constrained
from mbsym.algebra.program import Program
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.mechanics.constraints.rows import Row, constraint_rows, kept_rows, said_rows
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.oracle import Oracle
from mbsym.mechanics.programs import forward_dynamics, programs, scene_without_accelerations
from mbsym.mechanics.states import rational_states
from mbsym.mechanics.variables import program_environment, ring_environment, ring_of
from mbsym.model.constraints import Coincide, Rolling
from mbsym.model.system import System, acceleration_name, velocity_name


def described(*kinds: str) -> System:
    return system_of(BODIES + "\n".join(f"  - {KINDS[kind]}" for kind in kinds))


def over_ring(system: System) -> tuple[Scene, Ring]:
    ring = ring_of(system)
    return Scene(system, ring, ring_environment(system, ring), ring), ring


def time_rate(scene: Scene, ring: Ring, x: Polynomial) -> Polynomial:
    """dx/dt of a closed formula: the second route."""
    total = ring.derivative(x, "t")
    for name in scene.system.coordinates:
        total += ring.times(ring.derivative(x, name), ring.generator("velocity", name))
        total += ring.times(ring.velocity_derivative(x, name), ring.generator("acceleration", name))
    for item in scene.system.prescribed:
        total += ring.times(ring.derivative(x, item.name), scene.lower(item.rate))
    return ring.reduce(total)


def same(ring: Ring, x: Polynomial, y: Polynomial) -> bool:
    return ring.is_zero(x - y) is True


@pytest.mark.parametrize("kind", KINDS)
def test_rates_and_partials_are_derivatives_in_the_ring(kind: str) -> None:
    system = described(kind)
    scene, ring = over_ring(system)
    rows = constraint_rows(scene)
    assert len(rows) == {"coincide": 3, "parallel": 2, "rolling": 3}.get(kind.split()[0], 1)
    for row in rows:
        assert row.name.holonomic == (row.position is not None)
        if row.position is not None:
            assert same(ring, time_rate(scene, ring, row.position), row.velocity)
        assert same(ring, time_rate(scene, ring, row.velocity), row.acceleration)
        for name, slope in zip(system.coordinates, row.partials, strict=True):
            assert same(ring, ring.velocity_derivative(row.velocity, name), slope)


@pytest.mark.parametrize("kind", ["coincide", "rolling on a table that turns"])
def test_a_planted_error_is_seen(kind: str) -> None:
    """The comparison above is worth something: a moved point has other rates."""
    system = described(kind)
    one = system.constraints[0]
    if isinstance(one, Coincide):
        moved: Coincide | Rolling = replace(one, first=replace(one.first, position=one.second.position))
    else:
        assert isinstance(one, Rolling)
        moved = replace(one, on="0")
    scene, ring = over_ring(system)
    other, _ = Scene(replace(system, constraints=(moved,)), ring, scene.environment, ring), ring
    right, wrong = constraint_rows(scene), constraint_rows(other)
    assert not all(same(ring, x.velocity, y.velocity) for x, y in zip(right, wrong, strict=True))
    assert not all(same(ring, x.acceleration, y.acceleration) for x, y in zip(right, wrong, strict=True))


def test_points_move_as_the_oracle_places_them() -> None:
    """Another route: series in time of the places in inertial axes, (f, f', f''/2) at rational states."""
    system = described("coincide")
    one = system.constraints[0]
    assert isinstance(one, Coincide)
    ring = ring_of(system)
    for state in rational_states(system, ring, 2):
        place = Oracle(system, state).moving
        ends = [place.point(x.body, place.lower.vector(x.position)) for x in (one.first, one.second)]
        program = Program()
        inputs = program_environment(system, program)
        rows = constraint_rows(Scene(system, program, inputs, ring))
        nodes = [x for row in rows for x in (row.position, row.velocity, row.acceleration)]
        found = program.evaluate(nodes, state.values, state.numbers)
        apart = [x - y for x, y in zip(*ends, strict=True)]
        assert found == [value for x in apart for value in (x.a, x.b, 2 * x.c)]


def test_a_program_gives_the_same_numbers_as_the_ring() -> None:
    system = described(*KINDS)
    scene, ring = over_ring(system)
    rows = said_rows(scene)
    program = Program()
    inputs = program_environment(system, program)
    nodes = constraint_rows(scene_without_accelerations(system, ring, program, inputs), kept_rows(rows))
    still = {ring.index("acceleration", name): ring.zero for name in system.coordinates}

    def listed(found: tuple[Row, ...]) -> list[Any]:
        return [x for row in found for x in (row.velocity, row.acceleration, *row.partials)]

    for state in rational_states(system, ring, 1):
        values = {**state.values, **{acceleration_name(name): 0 for name in system.coordinates}}
        at_rest = [ring.substitute(x, still) for x in listed(rows)]
        lower = Scene(system, state.numbers, {**state.values, **values}, ring, bodies=False)
        assert program.evaluate(listed(nodes), state.values, state.numbers) == [lower.carry(x) for x in at_rest]


PLANAR = """
mbsym: 1
name: Four-bar
parameters: {l: positive, d: positive, m: positive}
bodies:
  - {name: crank, attached to: 0, mass: m, rotation: {axes: [3], angles: [q1]}, mass centre: [l, 0, 0]}
  - {name: coupler, attached to: crank, mass: m, rotation: {axes: [3], angles: [q2]}, connection point: [l, 0, 0],
     mass centre: [l, 0, 0]}
constraints:
  - coincide: [{body: coupler, point: [l, 0, 0]}, {body: 0, point: [d, 0, 0]}]
  - parallel: [{body: coupler, axis: [0, 0, 1]}, {body: 0, axis: [0, 0, 2]}]
"""


def test_what_is_planar_has_two_rows_worked_out_by_hand() -> None:
    """l cos q1 + l cos(q1 + q2) - d and l sin q1 + l sin(q1 + q2); axes normal to the plane say nothing."""
    system = system_of(PLANAR)
    scene, ring = over_ring(system)
    rows = said_rows(scene)
    assert [row.name.label for row in rows] == ["coincide 1, component 1", "coincide 1, component 2"]
    known = {name: scene.environment[name] for name in ("l", "d", *system.coordinates)}
    (s1, c1), (s2, c2) = ((ring.generator("sine", name), ring.generator("cosine", name)) for name in system.coordinates)
    expected = known["l"] * (c1 + c1 * c2 - s1 * s2) - known["d"], known["l"] * (s1 + s1 * c2 + c1 * s2)
    assert all(same(ring, row.position, x) for row, x in zip(rows, expected, strict=True))
    q1, q2 = (ring.generator("velocity", name) for name in system.coordinates)
    speed = -known["l"] * (s1 * q1 + (s1 * c2 + c1 * s2) * (q1 + q2))
    assert same(ring, rows[0].velocity, speed)


def test_what_leaves_constraints_out_refuses() -> None:
    system = described("relation")
    ring = ring_of(system)
    with pytest.raises(Constrained, match="relation 1"):
        forward_dynamics(system, ring)
    with pytest.raises(Constrained, match="relation 1"):
        programs(system, ring)
    assert velocity_name("x") in programs(system, ring, open_tree=True).environment
