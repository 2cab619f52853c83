"""Forward dynamics as straight-line code: every route against every other, exactly, and operations as claimed."""

from __future__ import annotations

import dataclasses
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from flint import fmpq, fmpq_mat
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from random_systems import Description, analysed, orbiting, systems

import mbsym
from mbsym.algebra.base import NoClosedForm, NotRational, SingularPoint
from mbsym.algebra.program import Program
from mbsym.analysis import Analysis
from mbsym.mechanics import articulated, factorisation
from mbsym.mechanics.articulation import Articulation, articulation
from mbsym.mechanics.coasting import coasting, forcing
from mbsym.mechanics.composite import mass_matrix
from mbsym.mechanics.forward_dynamics import ARTICULATED, FACTORISED, forward_dynamics
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.programs import accelerated, coasting_scene
from mbsym.mechanics.states import rational_states
from mbsym.mechanics.variables import program_environment
from mbsym.model.system import acceleration_name, velocity_name

SHIPPED = sorted(Path(__file__).parents[1].joinpath("systems").glob("*.yaml"))


def frames_of(analysis: Analysis) -> tuple[Program, Articulation]:
    program = Program()
    inputs = program_environment(analysis.system, program)
    return program, articulation(coasting_scene(analysis.system, analysis.ring, program, inputs))


def by_columns(analysis: Analysis, state: State) -> tuple[list[list[Any]], list[Any]]:
    """M and f at one state by the general Newton-Euler recursion over rational numbers."""
    system, names, zero = analysis.system, analysis.system.coordinates, fmpq(0)
    rest = {velocity_name(name): zero for name in names}
    columns = []
    for moving in names:
        unit = {acceleration_name(name): fmpq(name == moving) for name in names}
        here = Scene(system, state.numbers, {**state.values, **rest, **unit}, analysis.ring, frozen=True)
        columns.append(residuals(here, loads=False))
    still = {acceleration_name(name): zero for name in names}
    coast = residuals(Scene(system, state.numbers, {**state.values, **still}, analysis.ring))
    return [[column[name] for column in columns] for name in names], [-coast[name] for name in names]


def check_routes(analysis: Analysis, states: int = 1) -> None:
    """M, f, and the accelerations of both methods at exact states."""
    system, n = analysis.system, len(analysis.system.coordinates)
    program, frames = frames_of(analysis)
    mass, force = mass_matrix(frames), forcing(frames, coasting(frames))
    methods = [FACTORISED, ARTICULATED] if articulated.applies(frames) else [FACTORISED]
    try:
        found = [forward_dynamics(system, analysis.ring, method) for method in methods]
    except SingularPoint:
        found = []
    for state in rational_states(system, analysis.ring, states):
        rows, right = by_columns(analysis, state)
        values = program.evaluate([*(x for row in mass for x in row), *force], state.values, state.numbers)
        assert values[: n * n] == [x for row in rows for x in row]
        assert values[n * n :] == right
        matrix = fmpq_mat(n, n, [x for row in rows for x in row])
        determinant = matrix.det()
        if not found:
            assert determinant == 0
            continue
        for dynamics in found:
            if determinant == 0:
                continue
            nodes = [*dynamics.accelerations, *dynamics.pivots]
            values = dynamics.program.evaluate(nodes, state.values, state.numbers)
            assert fmpq_mat(n, 1, values[:n]) == matrix.solve(fmpq_mat(n, 1, right))
            product = fmpq(1)
            for pivot in values[n:]:
                product *= pivot
            assert product == determinant


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.one_of(systems(), systems(), orbiting()))
def test_every_route_gives_the_same_accelerations(description: Description) -> None:
    analysis = analysed(description)
    assume(analysis.system.coordinates)
    try:
        check_routes(analysis)
    except (NotRational, ZeroDivisionError):
        assume(False)


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_systems(path: Path) -> None:
    check_routes(mbsym.load(path), 2)


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_accelerations_satisfy_d_alembert(path: Path) -> None:
    """The truth shares nothing but the description with the recursions."""
    analysis = mbsym.load(path)
    dynamics = forward_dynamics(analysis.system, analysis.ring)
    compared = 0
    for state in rational_states(analysis.system, analysis.ring, 3):
        try:
            expected = accelerated(analysis.system, state, analysis.programs)
        except ZeroDivisionError:  # the parameters of a random state need not be those of a body
            continue
        values = dynamics.program.evaluate(dynamics.accelerations, state.values, state.numbers)
        names = [acceleration_name(name) for name in analysis.system.coordinates]
        moving = State(state.numbers, {**state.values, **dict(zip(names, values, strict=True))})
        assert set(Oracle(analysis.system, moving).residuals.values()) == {fmpq(0)}
        assert expected.values == moving.values
        compared += 1
    assert compared
