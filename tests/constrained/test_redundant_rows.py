"""Rows that follow from others: accelerations, ranks and exports at regular states, wherever a fixed choice would fail.

Expected values come from places alone, which are written down here in a dozen lines (``Chain``): velocities by central
differences, M, f and J' q' from them, and the accelerations as d'Alembert's principle has them with the singular values
of *all* rows,

    q'' = a0 + Z (Z^T M Z)^-1 Z^T (f - M a0),        J a0 = -J' q' (least squares),  Z the null space of J.
"""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from math import atan, cos, pi, sin
from pathlib import Path
from random import Random
from typing import Any

import mpmath
import numpy as np
import pytest
from conftest import filed, invoked
from flint import arb, ctx, fmpq
from hypothesis import assume, given

import mbsym
from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.point import Balls
from mbsym.mechanics.constraints import dependence
from mbsym.mechanics.constraints import dynamics as constraint_dynamics
from mbsym.mechanics.constraints.dynamics import conditions
from mbsym.mechanics.programs import programs
from mbsym.model.system import System, acceleration_name
from mbsym.numerics import simulate as breakdowns
from mbsym.numerics.closing import closed
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels import arrays
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.report.code import c_source
from mbsym.report.code.identifiers import prefix_of
from mbsym.report.exports import fmu
from mbsym.report.targets import FORMATS
from mbsym.simulation import Request, simulate
from mbsym.source import read
from tests.properties import settings
from tests.random_systems import coupled, mechanisms
from tests.report.readers import unreadable

CASES = Path(__file__).parents[1] / "cases" / "constraints"
GRAVITY = 9.81


# --- places, and d'Alembert's principle with all rows ---


def turned(axis: int, angle: float) -> Any:
    i, j = (axis % 3, (axis + 1) % 3)  # axes 1, 2, 3: the plane of the other two
    found = np.eye(3)
    found[i, i] = found[j, j] = cos(angle)
    found[j, i] = sin(angle)
    found[i, j] = -sin(angle)
    return found


@dataclass
class Link:
    """A body: where it is attached, its axis and angle (the number of a coordinate, or a value), mass and inertia."""

    parent: int
    point: tuple[float, float, float]
    axis: int
    angle: int | float
    mass: float = 0.0
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)
    inertia: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass
class Chain:
    """Links; rows f(places) = 0, or g(places, rates) = 0; gravity along an axis."""

    names: tuple[str, ...]
    links: list[Link]
    gravity: tuple[float, float, float]
    positions: Callable[[Any], Any] | None = None
    velocities: Callable[[Any, Any], Any] | None = None
    base: Callable[[Any], Any] = field(default=lambda q: np.zeros(3))

    def places(self, q: Any) -> list[tuple[Any, Any]]:
        """(origin, axes) of every link; link -1 is the ground."""
        found: list[tuple[Any, Any]] = []
        for link in self.links:
            origin, axes = (self.base(q), np.eye(3)) if link.parent < 0 else found[link.parent]
            angle = q[link.angle] if isinstance(link.angle, int) else link.angle
            found.append((origin + axes @ np.array(link.point), axes @ turned(link.axis, angle)))
        return found

    def moving(self, q: Any) -> Any:
        """Mass centres and axes, weighed so that T is half the sum of squares of the rates; for bodies with mass."""
        parts = []
        for link, (origin, axes) in zip(self.links, self.places(q), strict=True):
            if link.mass:
                parts.append(np.sqrt(link.mass) * (origin + axes @ np.array(link.centre)))
            a, b, c = link.inertia  # T = sum |e_i'|^2 (second moments)/2: those of the three axes
            for k, second in enumerate(((b + c - a) / 2, (c + a - b) / 2, (a + b - c) / 2)):
                parts.append(np.sqrt(max(second, 0.0)) * axes[:, k])
        return np.concatenate(parts)

    def accelerations(self, q: Any, qd: Any, forces: Any = 0.0) -> tuple[Any, int]:
        """(q'', rank of J)."""
        n = len(q)
        slopes = slope(self.moving, q)
        mass = slopes.T @ slopes
        potential = lambda x: np.array([-sum(  # noqa: E731
            link.mass * np.dot(self.gravity, origin + axes @ np.array(link.centre))
            for link, (origin, axes) in zip(self.links, self.places(x), strict=True)
        )])  # fmt: skip
        bent = second(lambda s: self.moving(q + s * qd))
        right = forces - slopes.T @ bent - slope(potential, q)[0]
        rows, gamma = [np.zeros((0, n))], [np.zeros(0)]
        if self.positions is not None:
            rows.append(slope(self.positions, q))
            gamma.append(second(lambda s: self.positions(q + s * qd)))
        if self.velocities is not None:
            rows.append(np.array([self.velocities(q, x) for x in np.eye(n)]).T)
            gamma.append((self.velocities(q + STEP * qd, qd) - self.velocities(q - STEP * qd, qd)) / (2 * STEP))
        whole, bias = np.vstack(rows), np.concatenate(gamma)
        sizes, turned_ = np.linalg.svd(whole)[1:]
        rank = int(np.sum(sizes > 1e-6 * sizes[0]))
        free = turned_[rank:].T
        first = np.linalg.lstsq(whole, -bias, rcond=1e-6)[0]
        if not free.size:
            return first, rank
        return first + free @ np.linalg.solve(free.T @ mass @ free, free.T @ (right - mass @ first)), rank


STEP = 1e-3


def slope(f: Callable[[Any], Any], q: Any) -> Any:
    """Central differences, extrapolated twice."""
    columns = []
    for k in range(len(q)):
        d = np.eye(len(q))[k]
        one, two, four = ((f(q + h * d) - f(q - h * d)) / (2 * h) for h in (STEP, 2 * STEP, 4 * STEP))
        a, b = (4 * one - two) / 3, (4 * two - four) / 3
        columns.append((16 * a - b) / 15)
    return np.array(columns).T


def second(f: Callable[[float], Any]) -> Any:
    one, two, four = ((f(h) - 2 * f(0.0) + f(-h)) / h**2 for h in (4 * STEP, 8 * STEP, 16 * STEP))
    a, b = (4 * one - two) / 3, (4 * two - four) / 3
    return (16 * a - b) / 15


# --- systems, as a description and as a chain ---


@cache
def segway() -> Chain:
    """Two wheels on an axle: x, y, yaw, tilt, pl, pr.  Contacts at -r below the centres, in the axle's axes."""
    r, d, length, mw = 0.2, 0.3, 0.7, 1.0
    wheel = (mw * r**2 / 4, mw * r**2 / 2, mw * r**2 / 4)
    links = [
        Link(-1, (0, 0, r), 3, 2),
        Link(0, (0, 0, 0), 2, 3, 10.0, (0, 0, length), (0.4, 0.4, 0.1)),
        Link(0, (0, d, 0), 2, 4, mw, (0, 0, 0), wheel),
        Link(0, (0, -d, 0), 2, 5, mw, (0, 0, 0), wheel),
    ]

    def rolling(q: Any, qd: Any) -> Any:
        # The axle turns by yaw' and carries a centre at side s d; the wheel turns by p' about the axle: r p' forward.
        forward, aside = np.array([cos(q[2]), sin(q[2])]), np.array([-sin(q[2]), cos(q[2])])
        found = []
        for side, p in ((1, 4), (-1, 5)):
            velocity = np.array([qd[0], qd[1]]) - side * d * qd[2] * forward - r * qd[p] * forward
            found += [velocity @ forward, velocity @ aside]
        return np.array(found)

    return Chain(
        ("x", "y", "yaw", "tilt", "pl", "pr"), links, (0, 0, -GRAVITY), None, rolling, lambda q: np.array([*q[:2], 0])
    )


def parallelogram(seed: int) -> tuple[str, Chain]:
    """Bars of one length that carry a coupler, on a plane that is tilted; some with a pendulum at the coupler."""
    source = Random(f"bars {seed}")
    bars, pendulum = source.randint(3, 5), source.random() < 0.5
    feet = [0.0, *sorted(round(source.uniform(0.5, 4), 2) for _ in range(bars - 1))]
    length, tilt = round(source.uniform(0.5, 2), 2), source.choice((0.0, atan(0.75)))
    masses = [round(source.uniform(0.5, 2), 2) for _ in range(bars + 2)]
    links = [Link(-1, (0, 0, 0), 1, tilt)]
    lines = [
        f"  - {{name: plane, attached to: 0, rotation: {{axes: [1], angles: [{'atan(3/4)' if tilt else 0}]}}, mass: 0}}"
    ]

    def add(name: str, on: tuple[str, int], at: float, angle: int, own: str, mass: float, size: float) -> int:
        links.append(
            Link(on[1], (at, 0, 0), 3, angle, mass, (size / 2, 0, 0), (0, mass * size**2 / 12, mass * size**2 / 12))
        )
        lines.append(
            f"  - {{name: {name}, attached to: {on[0]}, connection point: [{at}, 0, 0], "
            f"rotation: {{axes: [3], angles: [{own}]}}, mass: {mass}, mass centre: [{size / 2}, 0, 0], "
            f"inertia about: mass centre, inertia: [0, {mass * size**2 / 12}, {mass * size**2 / 12}]}}"
        )
        return len(links) - 1

    names = [f"a{k}" for k in range(bars)]
    arms = [add(f"bar{k}", ("plane", 0), feet[k], k, f"a{k}", masses[k], length) for k in range(bars)]
    names.append("b")
    coupler = add("coupler", ("bar0", arms[0]), length, bars, "b", masses[bars], feet[-1])
    if pendulum:
        names.append("c")
        add("pendulum", ("coupler", coupler), feet[-1], bars + 1, "c", masses[bars + 1], 0.7)
    ties = [
        f"  - coincide: [{{body: coupler, point: [{feet[k]}, 0, 0]}}, {{body: bar{k}, point: [{length}, 0, 0]}}]"
        for k in range(1, bars)
    ]
    initial = ", ".join(f"{name}: {-0.4 if name == 'b' else -1 if name == 'c' else 0.4}" for name in names)
    text = "\n".join(
        [
            "mbsym: 1",
            f"name: bars {seed}",
            "bodies:",
            *lines,
            f"loads: [{{uniform gravity: {{vector: [0, -{GRAVITY}, 0]}}}}]",
            "constraints:",
            *ties,
            f"initial: {{{initial}}}",
        ]
    )
    chain = Chain(tuple(names), links, (0, -GRAVITY, 0))

    def apart(q: Any) -> Any:
        places = chain.places(q)
        return np.concatenate([
            places[coupler][0] + places[coupler][1] @ np.array([feet[k], 0, 0])
            - places[arms[k]][0] - places[arms[k]][1] @ np.array([length, 0, 0])
            for k in range(1, bars)
        ])  # fmt: skip

    chain.positions = apart
    return text, chain


def system_of(text: str) -> System:
    system, complaints = read(text)
    assert system is not None, list(complaints)
    return system


def begun(text: str) -> Scenario:
    return closed(scenario(system_of(text))).scenario


def case(name: str) -> str:
    return (CASES / f"{name}.yaml").read_text(encoding="utf-8")


def kept_velocities(chain: Chain, q: Any, source: Any) -> Any:
    """Random velocities that keep the rows."""
    qd = source.normal(size=len(q))
    rows = [slope(chain.positions, q)] if chain.positions else []
    rows += [np.array([chain.velocities(q, x) for x in np.eye(len(q))]).T] if chain.velocities else []
    whole = np.vstack(rows)
    return qd - np.linalg.lstsq(whole, whole @ qd, rcond=1e-6)[0]


def yaws() -> list[Any]:
    return [np.array([0.3, -0.2, yaw, 0.2, 1.0, 2.0]) for yaw in (0.0, pi / 2, pi, -pi / 2, 0.77)]


# --- kernels ---


@pytest.mark.parametrize("seed", range(8))
def test_accelerations_of_bars_are_those_of_all_rows(seed: int) -> None:
    """At random angles of the bars, which are all alike, and at random angles of a pendulum."""
    text, chain = parallelogram(seed)
    dynamics = Dynamics(begun(text))
    constraints = dynamics.constraints
    assert constraints is not None
    rates = arrays.kernel(dynamics.right_hand_side)
    source = np.random.default_rng(seed)
    for _ in range(3):
        q = np.array([source.uniform(0.3, 2.8)] * len(chain.names))
        q[chain.names.index("b")] *= -1
        if "c" in chain.names:
            q[-1] = source.uniform(-3, 3)
        qd = kept_velocities(chain, q, source)
        wanted, rank = chain.accelerations(q, qd)
        found = rates(np.concatenate([[0.0], q, qd]))[len(q) :]
        assert rank == constraints.rank == len(chain.names) - constraints.freedom
        assert found == pytest.approx(wanted, abs=1e-6 * (1 + np.max(np.abs(wanted))))


def test_a_segway_at_any_yaw() -> None:
    """Of four rows three are independent at every yaw, but not the same three."""
    chain, dynamics = segway(), Dynamics(begun(case("segway")))
    assert dynamics.constraints is not None
    assert dynamics.constraints.rank == 3
    rates, correction = arrays.kernel(dynamics.right_hand_side), arrays.kernel(dynamics.correction)
    source = np.random.default_rng(1)
    for q in yaws():
        qd = kept_velocities(chain, q, source)
        wanted, rank = chain.accelerations(q, qd)
        assert rank == 3
        point = np.concatenate([[0.0], q, qd])
        assert rates(point)[6:] == pytest.approx(wanted, abs=1e-6 * (1 + np.max(np.abs(wanted))))
        assert correction(point)[-1] < 1e-3  # far from singular
        beside = qd + 0.1 * source.normal(size=6)
        led = beside + correction(np.concatenate([[0.0], q, beside]))[6:12]
        assert chain.velocities is not None
        assert chain.velocities(q, led) == pytest.approx(0, abs=1e-12)


def test_rows_of_a_long_axle_are_taken_in_turn() -> None:
    """26 rows of 13 wheels, of which 14 are independent at every yaw, but never the same: d'Alembert as in ``Chain``.

    At yaw 90 degrees, where the rows chosen at yaw 0 are two, and closely beside it.
    """
    count, r = 13, 0.2
    wheels = range(count)
    bodies = [
        "{name: axle, attached to: 0, connection point: [x, y, 1/5], coordinates: [x, y, yaw], "
        "rotation: {axes: [3], angles: [yaw]}, mass: 2, mass centre: [1/10, 0, 0], inertia about: mass centre, "
        "inertia: [1, 1, 1]}"
    ]
    bodies += [
        f"{{name: w{k}, attached to: axle, connection point: [0, {k}/10, 0], rotation: {{axes: [2], angles: [p{k}]}}, "
        "mass: 1, inertia about: mass centre, inertia: [1/100, 1/50, 1/100]}"
        for k in wheels
    ]
    rolling = [f"rolling: {{body: w{k}, point: [0, 0, -1/5], axes: axle, on: ground}}" for k in wheels]
    start = ", ".join([f"{name}: 0" for name in ("x", "y", "yaw", *(f"p{k}" for k in wheels))])
    text = "\n".join(["mbsym: 1", "name: axle", "bodies:", *(f"  - {x}" for x in bodies), "constraints:",
                      *(f"  - {x}" for x in rolling), f"initial: {{{start}}}"])  # fmt: skip
    links = [Link(-1, (0, 0, r), 3, 2, 2.0, (0.1, 0, 0), (1, 1, 1))]
    links += [Link(0, (0, k / 10, 0), 2, 3 + k, 1.0, (0, 0, 0), (0.01, 0.02, 0.01)) for k in wheels]

    def slips(q: Any, qd: Any) -> Any:
        forward, aside = np.array([cos(q[2]), sin(q[2])]), np.array([-sin(q[2]), cos(q[2])])
        centres = [qd[:2] - k / 10 * qd[2] * forward for k in wheels]
        return np.array(
            [
                x
                for k, v in zip(wheels, centres, strict=True)
                for x in ((v - r * qd[3 + k] * forward) @ forward, v @ aside)
            ]
        )

    names = ("x", "y", "yaw", *(f"p{k}" for k in wheels))
    chain = Chain(names, links, (0, 0, -GRAVITY), None, slips, lambda q: np.array([*q[:2], 0]))
    dynamics, source = Dynamics(begun(text)), np.random.default_rng(2)
    assert dynamics.constraints is not None
    assert [(len(one.rows), one.rank) for one in dynamics.constraints.chosen.dependent] == [(26, 14)]
    rates = arrays.kernel(dynamics.right_hand_side)
    for yaw in (0.0, pi / 2, pi / 2 - 1e-3, pi / 2 + 1e-6, -pi / 2, 0.77):
        q = np.array([0.3, -0.2, yaw, *source.uniform(-1, 1, count)])
        qd = kept_velocities(chain, q, source)
        wanted, rank = chain.accelerations(q, qd)
        assert rank == 14
        found = rates(np.concatenate([[0.0], q, qd]))[len(q) :]
        assert found == pytest.approx(wanted, abs=1e-6 * (1 + np.max(np.abs(wanted))))


def test_a_choice_that_is_not_made_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without exchanges the first three rows of the segway would be used everywhere: at yaw 90 degrees they are two."""
    monkeypatch.setattr(dependence._Chosen, "_exchange", lambda *_: None)
    chain, dynamics = segway(), Dynamics(begun(case("segway")))
    q = yaws()[1]
    qd = kept_velocities(chain, q, np.random.default_rng(1))
    found = arrays.kernel(dynamics.right_hand_side)(np.concatenate([[0.0], q, qd]))[6:]
    assert not np.allclose(found, chain.accelerations(q, qd)[0], atol=1e-3)


def test_nothing_jumps_where_the_choice_changes() -> None:
    """A choice is no switch of the equations: nothing is looked for along the motion."""
    assert Dynamics(begun(case("segway"))).features.none


# --- ranks that are told ---


@pytest.mark.parametrize(("name", "rank"), [("par3", 3), ("segway", 3), ("bricard", 4)])
def test_ranks_are_those_of_the_branch(name: str, rank: int) -> None:
    """Three bars: four rows, one freedom.  Bricard's linkage: five angles, one freedom (IFToMM benchmark A04)."""
    dynamics = Dynamics(begun(case(name)))
    assert dynamics.constraints is not None
    assert dynamics.constraints.rank == rank
    found = mbsym.loads(case(name)).constraints
    assert (found.velocity_rank, found.demanded.count) == (rank, 0)
    assert [len(one.rows) - one.rank for one in found.dependent_sets] == [1]


def test_whole_turns_do_not_change_a_rank() -> None:
    """Bricard's linkage has one freedom wherever its first angle is counted from; near 10^6 rad, too."""
    text = case("bricard")
    begun_there = text.replace("q1: 0", "q1: 1000000")
    assert begun_there.count("q1: 1000000") == 1
    assert mbsym.loads(begun_there).constraints.velocity_rank == 4


@pytest.mark.parametrize(
    ("name", "rank"),
    [
        ("sarrus-linkage", 4),  # two chains of hinges at a right angle lift a plate: five angles, one freedom
        ("four-wheels-on-an-axle", 5),  # four wheels roll forward, none aside: of seven velocities two are free
        ("ball-in-a-cylinder", 4),  # two relations, two of the contact; its radial one follows from the relations
        ("tied-twice", 1),  # one distance, said three times
    ],
)
def test_mechanisms_with_redundant_rows(name: str, rank: int) -> None:
    """Ranks by hand; accelerations by the singular values of all rows, J' q' by differences of J q' + j."""
    dynamics = Dynamics(begun(case(name)))
    constraints = dynamics.constraints
    assert constraints is not None
    assert constraints.rank == mbsym.loads(case(name)).constraints.velocity_rank == rank
    as_d_alembert_has_them(dynamics, np.random.default_rng(3))


def as_d_alembert_has_them(dynamics: Dynamics, source: Any) -> None:
    """Ranks and accelerations of the kernels at some positions of the branch."""
    rates = arrays.kernel(dynamics.right_hand_side)
    for state, wanted in by_all_rows(dynamics, source):
        found = rates(np.concatenate([[0.0], state]))[len(wanted) :]
        assert found == pytest.approx(wanted, abs=1e-7 * (1 + np.max(np.abs(wanted))))


def by_all_rows(dynamics: Dynamics, source: Any) -> Iterator[tuple[Any, Any]]:
    """(state, q'') at some positions of the branch by the singular values of all rows, which have the rank told."""
    constraints = dynamics.constraints
    assert constraints is not None
    n = constraints.size
    kernels = [arrays.kernel(code) for code in (dynamics.mass_matrix, dynamics.forcing)]
    for place in constraints.near:
        state = place.copy()
        state[n:] = source.normal(size=n)
        here = constraints.at(0.0, state)
        state[n:] -= np.linalg.lstsq(here.partials, here.velocities, rcond=1e-9)[0]

        def rows_after(step: float, state: Any = state) -> Any:
            return constraints.at(step, np.concatenate([state[:n] + step * state[n:], state[n:]])).velocities

        mass, force = (kernel(np.concatenate([[0.0], state])) for kernel in kernels)
        mass = mass.reshape(n, n)
        sizes, basis = np.linalg.svd(here.partials)[1:]
        assert int(np.sum(sizes > 1e-7 * sizes[0])) == constraints.rank
        free = basis[constraints.rank :].T
        bent = (rows_after(STEP) - rows_after(-STEP)) / (2 * STEP)
        bent = (4 * (rows_after(STEP / 2) - rows_after(-STEP / 2)) / STEP - bent) / 3
        first = np.linalg.lstsq(here.partials, -bent, rcond=1e-9)[0]
        yield state, first + free @ np.linalg.solve(free.T @ mass @ free, free.T @ (force - mass @ first))


@settings(max_examples=100)
@given(mechanisms)
def test_random_mechanisms(text: str) -> None:
    """Wherever a run may begin; where it may not the position is singular, or a coordinate moves no mass.

    The rank that is derived is that of the branch, too.
    """
    try:
        dynamics = Dynamics(begun(text))
        constraints = dynamics.constraints
        assert constraints is not None
        start = np.array([float(x) for x in dynamics.scenario.state])
        assume(constraints.freedom and not breakdowns._lost_rank(dynamics, start))
        assert dynamics.right_hand_side
    except SingularPoint:
        assume(False)
    as_d_alembert_has_them(dynamics, np.random.default_rng(len(text)))
    assert mbsym.loads(text, (3,)).constraints.velocity_rank == constraints.rank


@settings(max_examples=60)
@given(mechanisms)
def test_digits_of_accelerations(text: str) -> None:
    """No more are lost than S = J M^-1 J^T of all rows loses by its condition: solved anew with 50 digits, by its axes.

    M, f, J and J' q' are the kernels' own formulas, in balls of 300 bits.
    """
    try:
        dynamics = Dynamics(begun(text))
        constraints = dynamics.constraints
        assert constraints is not None
        start = np.array([float(x) for x in dynamics.scenario.state])
        assume(constraints.freedom and not breakdowns._lost_rank(dynamics, start))
        rates = arrays.kernel(dynamics.right_hand_side)
    except SingularPoint:
        assume(False)
    n, source = constraints.size, np.random.default_rng(len(text))
    for place in constraints.near:
        state = place.copy()
        state[n:] = source.normal(size=n)
        here = constraints.at(0.0, state)
        state[n:] -= np.linalg.lstsq(here.partials, here.velocities, rcond=1e-9)[0]
        wanted, condition = in_many_digits(dynamics, state, constraints.rank)
        if wanted is not None:
            found = rates(np.concatenate([[0.0], state]))[n:]
            assert np.max(np.abs(found - wanted)) <= 1e-14 * condition * (1 + np.max(np.abs(wanted)))


def in_many_digits(dynamics: Dynamics, state: Any, rank: int) -> tuple[Any, float]:
    """(q'', the largest eigenvalue of S over the last of the ``rank`` largest ones); None where M is singular."""
    system, ring = dynamics.system, dynamics.ring
    given = {name: arb(fmpq(x.numerator, x.denominator)) for name, x in dynamics.scenario.parameters.items()}
    given |= {"pi": arb.pi(), "t": arb(0)} | {acceleration_name(name): arb(0) for name in system.coordinates}
    given |= {name: arb(x) for name, x in zip((*system.coordinates, *system.velocities), state, strict=True)}
    tree, equations = programs(system, ring, open_tree=True), conditions(system, ring)
    with ctx.workprec(300), mpmath.workdps(50):
        numbers = Balls(dict(given))

        def values(program: Any, nodes: Any) -> Any:
            return [mpmath.mpf(arb(x).mid().str(60, radius=False)) for x in program.evaluate(nodes, given, numbers)]

        def matrix(program: Any, rows: Any) -> Any:
            width, found = len(rows[0]), values(program, [x for row in rows for x in row])
            return mpmath.matrix([found[i : i + width] for i in range(0, len(found), width)])

        rows = equations.rows
        mass, force = matrix(tree.program, tree.mass_matrix), matrix(tree.program, [[x] for x in tree.forcing])
        slopes = matrix(equations.program, [row.partials for row in rows])
        bent = matrix(equations.program, [[row.acceleration] for row in rows])
        try:
            inverse = mass**-1
        except ZeroDivisionError:
            return None, 1.0
        sizes, axes = mpmath.eigsy(slopes * inverse * slopes.T)
        order = sorted(range(len(sizes)), key=lambda k: -abs(sizes[k]))[:rank]
        needed = -(bent + slopes * inverse * force)
        multipliers = mpmath.matrix(len(rows), 1)
        for k in order:
            multipliers += axes[:, k] * ((axes[:, k].T * needed)[0] / sizes[k])
        found = inverse * (force + slopes.T * multipliers)
        return np.array([float(x) for x in found]), float(abs(sizes[order[0]] / sizes[order[-1]]))


def test_a_row_that_vanishes_in_passing_is_not_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wheels whose pins stand in line with their rods, written as relations: measured by itself such a row has no size,
    and the largest pivot is 0."""
    text = coupled(Random("coupled 0"), "relation", Fraction(0))
    as_d_alembert_has_them(Dynamics(begun(text)), np.random.default_rng(1))
    monkeypatch.setattr(constraint_dynamics, "measures", lambda program, names, diagonal, usual: list(diagonal))
    with pytest.raises(AssertionError):
        as_d_alembert_has_them(Dynamics(begun(text)), np.random.default_rng(1))


def test_a_mechanism_that_moves_at_its_values_only() -> None:
    """Three bars whose lengths are parameters, all 1: four rows of four angles, three of them independent.

    With other lengths the rank is 4 and nothing moves; at these values one velocity is free, which is what is said.
    """
    text = case("par3").replace(
        "parameters: {", "parameters: {k: {value: 1, sign: positive}, l: {value: 1, sign: positive}, "
    )
    for bar, length in (("v1", "k"), ("v2", "l")):
        text = text.replace(f"{{body: {bar}, point: [1, 0, 0]}}", f"{{body: {bar}, point: [{length}, 0, 0]}}")
    found = mbsym.loads(text).constraints
    assert (found.velocity_rank, found.rank_beside, found.demanded.count) == (3, 4, 0)
    failure = mbsym.loads(text).stage(4).failure
    assert failure is not None
    assert "only where" in failure.reason
    assert "1 - k = 0" in failure.reason or "k - 1 = 0" in failure.reason


@pytest.mark.parametrize("angle", [0.0, 0.3])
@pytest.mark.parametrize("speed", [0.0, 2.0])
def test_wheels_with_a_coupling_rod(angle: float, speed: float) -> None:
    """A rod between two wheels that roll moves alike with both: one velocity is free, also where crank and rod are in
    line, where the rod alone could turn the wheels against each other.

    With x' = r p' the frame and two discs have (3 m r^2 + 2 m r^2/2) p'^2/2, the rod, at (x + e cos p, -e sin p) but
    for a constant, the rest.
    """
    text = case("coupling-rod").replace("velocity: 1", f"velocity: {speed / 2}")
    text = text.replace("p: 0.3, s: 0.3, b: -0.3", f"p: {angle}, s: {angle}, b: {-angle}")
    assert mbsym.loads(text).constraints.velocity_rank == 3
    given = begun(text)
    constraints = Dynamics(given).constraints
    assert constraints is not None
    assert constraints.freedom == 1
    run = simulate(given, Request(time=2.0, samples=21, estimate=False))
    assert run.trajectory.whole
    m, r, e, p, rate = 1.0, 0.5, 0.2, run["p"], run["p_dot"]
    assert run["s"] == pytest.approx(p, abs=1e-9)
    forward, up = r * rate - e * np.sin(p) * rate, -e * np.cos(p) * rate
    energy = 4 * m * r**2 * rate**2 / 2 + m / 20 * (forward**2 + up**2) - m / 10 * GRAVITY * e * np.sin(p)
    assert energy == pytest.approx(np.full(21, energy[0]), abs=1e-8)
    assert np.ptp(p) > 0.1


@pytest.mark.parametrize(("b", "satisfied"), [(5, False), (4, True)])
def test_bennett_s_condition_is_told_and_tried(b: int, satisfied: bool) -> None:
    """Bennett (1903): sin(alpha)/a = sin(beta)/b, here 3/5 and 4/5, so that 4 a = 3 b; given are a = 3 and b."""
    text = case("bennett-no").replace("b: {value: 5", f"b: {{value: {b}").replace("q2: 1, q3: -1", "q2: 2.9, q3: -1")
    analysis = mbsym.loads(text)
    demanded = analysis.constraints.demanded
    (relation,) = demanded.relations
    assert demanded.count == 1
    assert str(relation) in ("4*a - 3*b", "-4*a + 3*b")
    assert demanded.satisfied is satisfied


@pytest.mark.parametrize(
    "words", ["simulate --time 1", "lyapunov --time 3", "tradeoff --time 1", "orbit --period 2", "extremes"]
)
def test_what_cannot_move_is_not_run(words: str, tmp_path: Path) -> None:
    """a = 3, b = 5: no Bennett linkage.  It was led to a rigid place and its energy called conserved."""
    path = filed(tmp_path / "bennett-no.yaml", case("bennett-no"))
    command, *options = words.split()
    done = invoked(command, path, *options, "--out", tmp_path / "out", code=3)
    assert "error[no-freedom]" in done.output
    assert not (tmp_path / "out").exists()
    assert "nothing can move from q1 = 0" in done.output


def test_full_stretch_is_singular(tmp_path: Path) -> None:
    """Two links of length sqrt(2) between points 2 sqrt(2) apart: J has rank 1 of 2 in the one position that they have.

    To first order the elbow moves across, to second order it does not; the pendulum alone has a freedom.  It was run as
    a mechanism of two freedoms, off its constraints, with exit code 0.
    """
    file = CASES / "held-at-full-stretch.yaml"
    result = invoked("simulate", file, "--time", "1", "-v", "--out", tmp_path / "out", code=3)
    assert "their rank is 1) they stop at second order" in result.stderr
    assert "free velocities: at most 2 of 3" in " ".join(result.stdout.split())


@pytest.mark.parametrize("name", ["par3", "bricard", "sarrus-linkage", "tied-twice", "coupling-rod"])
def test_regular_positions_are_held_no_further(name: str) -> None:
    """Rows that follow from others all along: also beside the start."""
    constraints = Dynamics(begun(case(name))).constraints
    assert constraints is not None
    assert len(constraints.kept) < len(constraints)
    assert not any(constraints.obstructed(place) for place in constraints.near)


def test_runs_of_regular_positions_end_whole() -> None:
    """From a = -0.1, where 4 rows seemed independent beside the start; the energy is kept."""
    run = simulate(begun(case("par3")), Request(time=2.0, samples=21, estimate=False))
    assert run.trajectory.whole
    # One freedom: three bars (1/3) and the coupler, whose points all move alike (1): J a'' = -m l g cos a, by hand.
    inertia, weight = 3 / 3 + 1, 3 * 0.5 + 1
    a = run["a0"]
    energy = inertia * run["a0_dot"] ** 2 / 2 + weight * GRAVITY * np.sin(a)
    assert energy == pytest.approx(np.full(21, energy[0]), abs=1e-7)


def test_extremes_list_what_is_singular_only() -> None:
    """Three bars lose a rank where they are in line with the coupler, at 0 and pi, and nowhere else."""
    from mbsym.numerics.extremes.singular_positions import singular_positions

    given = begun(case("par3"))
    found = singular_positions(given, [1.0] * 4, 10.0)
    assert found is not None
    assert {tuple(one.labels.values()) for one in found.found} <= {("0",) * 4, ("pi",) * 4}
    assert all((one.rank, one.usual, one.proved) == (2, 3, True) for one in found.found)


# --- exports ---


@cache
def analysis_of_segway() -> Any:
    return mbsym.loads(case("segway"), (3, 5, 7))


def rendered(kind: str) -> str:
    text = FORMATS[kind].render(analysis_of_segway(), (5, 7))
    assert isinstance(text, str)
    return text


def at_all_yaws(rates: Callable[[Any], Any], tolerance: float = 1e-6) -> None:
    """q'' without inputs at the yaws at which a fixed choice of rows fails, and at another."""
    chain, source = segway(), np.random.default_rng(2)
    for q in yaws():
        qd = kept_velocities(chain, q, source)
        wanted, _ = chain.accelerations(q, qd)
        found = rates(np.concatenate([q, qd]))
        assert found == pytest.approx(wanted, abs=tolerance * (1 + np.max(np.abs(wanted))))


@cache
def module() -> dict[str, Any]:
    found: dict[str, Any] = {}
    exec(compile(rendered("python"), "segway", "exec"), found)
    return found


def test_python() -> None:
    model = module()
    p = model["complete"]()
    at_all_yaws(lambda x: model["rhs"](0.0, x, p, [0.0, 0.0])[6:])
    start = model["consistent"](model["initial_state"](p), p, held=model["GIVEN"])
    assert np.all(np.isfinite(model["rhs"](0.0, start, p, [0.0, 0.0])))
    several = np.array([yaws()[0], yaws()[1]]).T
    both = model["rhs"](0.0, np.vstack([several, 0 * several]), p, [0.0, 0.0])
    assert both[:, 1] == pytest.approx(model["rhs"](0.0, np.r_[yaws()[1], np.zeros(6)], p, [0.0, 0.0]), abs=1e-12)


def test_forces_of_constraints_are_those_of_the_equations() -> None:
    """J^T lambda = M q'' - f, which is unique although lambda is not."""
    model, chain = module(), segway()
    p, source = model["complete"](), np.random.default_rng(3)
    for q in yaws():
        x = np.concatenate([q, kept_velocities(chain, q, source)])
        force = model["constraint_jacobian"](q, p).T @ model["multipliers"](0.0, x, p, [0.0, 0.0])
        needed = model["mass_matrix"](q, p) @ model["rhs"](0.0, x, p, [0.0, 0.0])[6:]
        needed = needed - model["forcing"](q, x[6:], p, 0.0, [0.0, 0.0])
        assert force == pytest.approx(needed, abs=1e-9 * (1 + np.max(np.abs(needed))))


def test_linear_matrices_are_of_the_coordinates_that_they_name() -> None:
    """Three bars that hang: 2 a'' + 5/2 g a = 0 (by hand: bars 3/3, coupler 1; weights 3/2 + 1), of one angle.

    They were padded with zeros to four coordinates, under the names of others.
    """
    model: dict[str, Any] = {}
    text = FORMATS["python"].render(mbsym.loads(case("par3"), (3, 5)), (3, 5))
    assert isinstance(text, str)
    assert not unreadable("model.py", text)
    exec(compile(text, "par3", "exec"), model)
    (name,) = model["LINEAR"]
    assert name in model["COORDINATES"]
    mass, damping, gyroscopic, stiffness, circulatory = model["linear_matrices"]({"g": GRAVITY})
    assert stiffness / mass == pytest.approx(np.array([[1.25 * GRAVITY]]))
    assert not any(map(np.any, (damping, gyroscopic, circulatory)))


def test_inputs_act_on_the_coordinates_that_are_named() -> None:
    """A motor turns the left wheel, and the body the other way: -1 and 1, nothing on the other wheel."""
    model = module()
    assert model["LINEAR"] == ("tilt", "pl", "pr")
    gains = model["input_matrix"](model["complete"]())
    assert gains == pytest.approx(np.array([[-1, -1], [1, 0], [0, 1]]))


def test_c(tmp_path: Path) -> None:
    (tmp_path / "model.c").write_text(rendered("c"), encoding="utf-8")
    (tmp_path / "model.h").write_text(c_source.header(analysis_of_segway(), ()), encoding="utf-8")
    library = tmp_path / "model.so"
    options = ["-std=c99", "-O1", "-Wall", "-Wextra", "-pedantic", "-Werror", "-shared", "-fPIC"]
    subprocess.run(["cc", *options, "-o", str(library), str(tmp_path / "model.c"), "-lm"], check=True)
    functions, prefix = ctypes.CDLL(str(library)), prefix_of(analysis_of_segway().system.name)
    array = lambda values: (ctypes.c_double * len(values))(*values)  # noqa: E731
    values = list(module()["complete"]().values())

    def rates(x: Any) -> Any:
        out = (ctypes.c_double * 12)()
        told = getattr(functions, f"{prefix}_right_hand_side")(
            ctypes.c_double(0), array(x), array(values), array([0.0, 0.0]), out
        )
        assert told == 0
        return np.array(out)[6:]

    at_all_yaws(rates)
    start = array(module()["initial_state"](module()["complete"]()))
    assert getattr(functions, f"{prefix}_consistent")(ctypes.c_double(0), start, array(values), None) == 0


def test_casadi_and_jax() -> None:
    pytest.importorskip("casadi")
    model: dict[str, Any] = {}
    exec(compile(rendered("casadi"), "casadi", "exec"), model)
    values = list(module()["complete"]().values())
    casadi = model["functions"]()["accelerations"]
    at_all_yaws(lambda x: np.array(casadi(0.0, list(x), values, [0.0, 0.0])).ravel())
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    other: dict[str, Any] = {}
    exec(compile(rendered("jax"), "jax", "exec"), other)
    at_all_yaws(lambda x: np.array(other["accelerations"](0.0, x, np.array(values), np.zeros(2))))
    # The derivative is that of the solution, also where the choice of rows changes: J'' by differences of the truth.
    x = np.concatenate([yaws()[0], kept_velocities(segway(), yaws()[0], np.random.default_rng(5))])
    slopes = np.array(jax.jacfwd(lambda y: other["accelerations"](0.0, y, np.array(values), np.zeros(2)))(x))
    assert np.all(np.isfinite(slopes))
    around = [segway().accelerations((x + d)[:6], (x + d)[6:])[0] for d in 1e-4 * np.eye(12)]
    before = [segway().accelerations((x - d)[:6], (x - d)[6:])[0] for d in 1e-4 * np.eye(12)]
    tangent = np.eye(12)[3]  # the tilt moves freely: the constraints stay kept
    assert slopes @ tangent == pytest.approx((around[3] - before[3]) / 2e-4, abs=1e-4)


@pytest.mark.parametrize("kind", ["octave", "julia", "modelica"])
def test_other_exports_can_be_read(kind: str) -> None:
    """A choice of rows is no event of Modelica's."""
    text = rendered(kind)
    assert not unreadable(FORMATS[kind].filename, text)
    assert text.count("sign(") == text.count("noEvent(sign(") or kind != "modelica"


def test_an_fmu_begins_where_its_description_does(tmp_path: Path) -> None:
    """At yaw 0, where the rows that were used were two; it ends where the simulation does."""
    fmpy = pytest.importorskip("fmpy")
    path = tmp_path / "segway.fmu"
    path.write_bytes(fmu.render(analysis_of_segway(), (), 2))
    names = [*segway().names]
    run = fmpy.simulate_fmu(
        str(path), stop_time=0.5, solver="CVode", relative_tolerance=1e-9, output=names, output_interval=0.1
    )
    own = simulate(begun(case("segway")), Request(time=0.5, samples=2, estimate=False))
    assert [run[name][-1] for name in names] == pytest.approx([own[name][-1] for name in names], abs=1e-6)


@pytest.mark.parametrize(("crank", "kept"), [("1", True), ("15/2", False), ("8", False), (None, None)])
def test_a_four_bar_that_cannot_be_closed_is_told_so(crank: str | None, kept: bool | None, tmp_path: Path) -> None:
    """A crank of at least 3 + 5/2 + 2 reaches no point that the other bars do, or them in line alone."""
    links = {"crank": ("s", "q1", "0, 0"), "coupler": ("3", "q2", "s, 0"), "rocker": ("5/2", "q3", "2, 0")}
    bodies = [
        f"{{name: {name}, attached to: {'crank' if name == 'coupler' else 0}, connection point: [{at}, 0], rotation: "
        f"{{axes: [3], angles: [{angle}]}}, mass centre: [{length}/2, 0, 0], mass: 1}}"
        for name, (length, angle, at) in links.items()
    ]
    tie = "coincide: [{body: coupler, point: [3, 0, 0]}, {body: rocker, point: [5/2, 0, 0]}]"
    value = "" if crank is None else f", value: {crank}"
    text = f"mbsym: 1\nname: four-bar\nparameters: {{s: {{sign: positive{value}}}}}\nbodies: [{', '.join(bodies)}]\n"
    text += f"constraints: [{tie}]\n"
    assert mbsym.loads(text).constraints.kept_at_values is kept
    done = invoked("run", filed(tmp_path / "four-bar.yaml", text), "--problems", 3, "--out", tmp_path / "out")
    told = "at the given values no regular configuration that keeps all constraints was found"
    assert (told in " ".join(done.output.split())) is (kept is False)
