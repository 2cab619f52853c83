"""Pictures: the poses of their programs against the positions that figures are drawn from, and what is said of them."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED

import mbsym
from mbsym.algebra.failures import Failure, GivenByMatrices
from mbsym.numerics.positions import AXIS, END, JOINT, MASS_CENTRE, positions
from mbsym.numerics.scenario import Incomplete
from mbsym.picture import as_json, picture, picture_at
from mbsym.picture.build import closed, gaps, start
from mbsym.picture.values import Acting, Measure, Picture, Stretch
from mbsym.source import read

CASES = sorted((Path(__file__).parents[1] / "cases").glob("*/*.yaml"))

#: Given by matrices: no bodies.
MATRICES = ("gyroscopic-pair", "triangular-points")
DRAWN = [path for path in sorted(SHIPPED.glob("*.yaml")) if path.stem not in MATRICES]


def placed(found: Picture, state: dict[str, float]) -> list[float]:
    """All values of the program at one state."""
    given = dict.fromkeys(found.program.inputs, 0.0) | state
    return [float(x) for x in found.program.evaluate(given)]


def vector(values: list[float], operands: tuple[int, int, int]) -> Any:
    return np.array([values[k] for k in operands])


def of(text: str) -> Any:
    return mbsym.loads(text).system


@pytest.mark.parametrize("path", DRAWN, ids=lambda path: path.stem)
def test_poses_against_positions(path: Path) -> None:
    """Two routes to every joint, mass centre and axis: from the frame outwards, and every vector turned back."""
    begun = start(mbsym.load(path).system)
    scenario, n = begun.scenario, len(begun.scenario.system.coordinates)
    source = np.random.default_rng(1)
    times = np.array([0.0, 0.3, 1.1])
    away = source.uniform(-1.5, 1.5, (2 * n, 3))
    states = np.array([[float(x)] for x in scenario.state]) + away
    drawn = positions(scenario, times, states)
    assert drawn is not None
    found = picture_at(begun, drawn.frame)
    bodies = {body.name: body for body in found.bodies}
    names = (*scenario.system.coordinates, *scenario.system.velocities)
    for k, t in enumerate(times):
        values = placed(found, {"t": t} | dict(zip(names, states[:, k], strict=True)))
        size = max(1.0, float(np.max(np.abs(drawn.places[:, :, k]))))
        for point, place in zip(drawn.points, drawn.places[:, :, k], strict=True):
            body = bodies.get(point.body)
            if point.kind == JOINT and body is not None:
                assert vector(values, body.origin) == pytest.approx(place, abs=1e-12 * size)
            if point.kind == MASS_CENTRE and body is not None:
                assert vector(values, body.centre) == pytest.approx(place, abs=1e-12 * size)
            if point.kind == AXIS and body is not None:
                arm = place - vector(values, body.origin)
                own = vector(values, body.axes[point.axis - 1])
                assert own == pytest.approx(arm / np.linalg.norm(arm), abs=1e-12 * size / np.linalg.norm(arm))
            assert point.kind != END or body is not None
        for body in found.bodies:
            rows = np.array([vector(values, row) for row in body.axes])
            assert rows @ rows.T == pytest.approx(np.eye(3), abs=1e-12)
            assert np.linalg.det(rows) == pytest.approx(1, abs=1e-12)
            for hinge in body.joint.hinges:
                if not hinge.slides:
                    assert np.linalg.norm(vector(values, hinge.along)) == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("path", [*DRAWN, *CASES], ids=lambda path: path.stem)
def test_every_description_is_drawn(path: Path) -> None:
    """Values or none, the picture is JSON without nan, and every operand is a value of the program."""
    system, _ = read(path.read_text(encoding="utf-8"), str(path))
    if system is None:
        return
    if system.linear is not None:
        with pytest.raises(GivenByMatrices):
            picture(system)
        return
    found = picture(system)
    told = as_json(found)
    json.dumps(told, allow_nan=False)
    count = len(found.program.inputs) + len(found.program.constants) + len(found.program.steps)
    for body in found.bodies:
        assert all(0 <= k < count for row in (*body.axes, body.origin, body.centre) for k in row)
    assert found.extent > 0
    assert np.linalg.norm(found.view.up) == pytest.approx(1)


PENDULUM = """mbsym: 1
name: by hand
parameters: {{m: positive, l: positive, g: positive, F: real}}
bodies:
  - {{name: rod, attached to: 0, rotation: {{axes: [3], angles: [a]}}, mass centre: [0, -l, 0], mass: m}}
  - {{name: slider, attached to: rod, connection point: [s, -l, 0], mass: 2*m, coordinates: [s]}}
loads:
  - uniform gravity: {{acceleration: g, direction: [0, -1, 0]}}
  - force: {{body: slider, point: [0, 0, 0], components: [F, 0, 0], axes: rod}}
  - torque: {{body: slider, components: [0, 0, 3], axes: rod, reaction on: rod}}
  - spring: {{coordinate: s, stiffness: 2}}
{more}"""


def test_poses_and_forces_by_hand() -> None:
    """The new axes are e1 = (cos a, sin a, 0), e2 = (-sin a, cos a, 0); the slider is at s e1 - l e2."""
    system = of(PENDULUM.format(more="values: {m: 2, l: 3, g: 10, F: 5}\ninitial: {a: 0.4, s: 0.7}\n"))
    found = picture(system)
    rod, slider = found.bodies
    for a, s in ((0.4, 0.7), (-2.0, -1.5)):
        values = placed(found, {"a": a, "s": s})
        e1, e2 = np.array([np.cos(a), np.sin(a), 0]), np.array([-np.sin(a), np.cos(a), 0])
        assert vector(values, rod.origin) == pytest.approx(np.zeros(3))
        assert vector(values, rod.centre) == pytest.approx(-3 * e2)
        assert vector(values, slider.origin) == pytest.approx(s * e1 - 3 * e2)
        assert vector(values, slider.axes[0]) == pytest.approx(e1)
        assert vector(values, slider.axes[1]) == pytest.approx(e2)
        arrows = [(x.of, x.body, vector(values, x.point), vector(values, x.along)) for x in found.arrows]
        wanted = [
            (Acting.GRAVITY, "rod", -3 * e2, np.array([0, -20, 0])),
            (Acting.GRAVITY, "slider", s * e1 - 3 * e2, np.array([0, -40, 0])),
            (Acting.FORCE, "slider", s * e1 - 3 * e2, 5 * e1),
            (Acting.TORQUE, "slider", s * e1 - 3 * e2, np.array([0, 0, 3])),
            (Acting.TORQUE, "rod", -3 * e2, np.array([0, 0, -3])),
        ]
        for (of_, body, point, along), (of_0, body_0, point_0, along_0) in zip(arrows, wanted, strict=True):
            assert (of_, body) == (of_0, body_0)
            assert point == pytest.approx(point_0)
            assert along == pytest.approx(along_0, abs=1e-12)
    hinge = rod.joint.hinges[0]
    assert not hinge.slides
    assert hinge.coordinates == ("a",)
    assert vector(values, hinge.along) == pytest.approx([0, 0, 1])
    assert [(x.slides, x.coordinates) for x in slider.joint.hinges] == [(True, ("s",))]
    assert vector(values, slider.joint.hinges[0].along) == pytest.approx(e1)
    assert slider.joint.sprung == ("s",)
    assert [x.kind for x in found.lines] == [Stretch.BODY, Stretch.SLIDE]
    assert [x.kind for x in found.coordinates] == [Measure.ANGLE, Measure.LENGTH]
    assert found.view.plane
    assert found.view.up == pytest.approx((0, 1, 0))
    assert not found.notes.stand_ins


def test_stand_ins_are_told_and_only_where_something_is_missing() -> None:
    found = picture(of(PENDULUM.format(more="values: {m: 2, g: 10}\n")))
    assert found.notes.stand_ins == (("l", 1.0), ("F", 1.0))
    assert found.notes.at_zero == ("a", "s")
    assert as_json(found)["atZero"] == ["a", "s"]
    said = as_json(found)["sentences"]
    assert "Stand-ins for values that are not given, only to draw: l = 1, F = 1." in said
    assert "No initial value is given for a, s: drawn at 0." in said
    whole = as_json(picture(of(PENDULUM.format(more="values: {m: 2, l: 3, g: 10, F: 5}\ninitial: {a: 0, s: 1}\n"))))
    assert not any("Stand-in" in x or "No initial" in x for x in whole["sentences"])


def test_values_that_contradict_each_other_are_refused() -> None:
    text = PENDULUM.format(more="values: {m: 2, l: 3, g: 10, F: 5}\nrelations: {F: 2*m}\ninitial: {a: 0, s: 1}\n")
    with pytest.raises((Incomplete, Failure, ValueError)):
        picture(of(text))


def test_no_picture_of_matrices() -> None:
    with pytest.raises(Failure, match="no bodies to draw"):
        picture(mbsym.load(SHIPPED / "gyroscopic-pair.yaml").system)


def test_loops_are_closed_for_the_slider_that_moves() -> None:
    """Four rods: the crank is turned, coupler and rocker follow; a crank angle that no linkage has stays open."""
    found = picture(mbsym.load(SHIPPED / "four-bar.yaml").system)
    assert found.closure is not None
    start_ = {x.name: x.value for x in found.coordinates}
    assert max(gaps(found.program, found.closure, start_)) < 1e-12
    there, good = closed(found.program, found.closure, start_ | {"q1": 2.6}, ("q1",))
    assert good
    assert there["q1"] == 2.6
    rods, turned, tip = (0.24, 0.21, 0.34), 0.0, np.array([0.13, 0.0])
    for rod, name in zip(rods, ("q1", "q2", "q3"), strict=True):
        turned += there[name]
        tip = tip + rod * np.array([np.cos(turned), np.sin(turned)])
    assert tip == pytest.approx([0, 0], abs=1e-9)
    # The tip of the crank at (0.37, 0) is 0.37 from the ground: rods of 0.21 and 0.34 reach that; with a rocker of
    # 0.05 they do not.
    text = (SHIPPED / "four-bar.yaml").read_text(encoding="utf-8").replace("l4: 0.34", "l4: 0.05")
    short = picture(of(text))
    assert short.closure is not None
    _, good = closed(short.program, short.closure, {x.name: x.value for x in short.coordinates} | {"q1": 0.0}, ("q1",))
    assert not good


CRANK = """
mbsym: 1
name: Crank and slider
parameters: {{r: {r}, l: {l}}}
bodies:
  - {{name: crank, attached to: 0, rotation: {{axes: [3], angles: [phi]}}, mass centre: [r, 0, 0], mass: 1}}
  - {{name: slider, attached to: 0, connection point: [s, 0, 0], coordinates: [s], mass: 1}}
constraints:
  - distance: {{between: [{{body: crank, point: [r, 0, 0]}}, {{body: slider, point: [0, 0, 0]}}], length: l}}
"""


@pytest.mark.parametrize("unit", [1e-10, 1.0, 1e10])
def test_a_loop_is_closed_whatever_the_unit_of_length(unit: float) -> None:
    """r = 1, l = 3, phi = 1: s = cos 1 + sqrt(9 - sin(1)^2), in any unit; ten per cent off is open."""
    drawn = picture(of(CRANK.format(r=unit, l=3 * unit) + f"initial: {{phi: 0, s: {4 * unit}}}\n"))
    assert drawn.closure is not None
    there, good = closed(
        drawn.program, drawn.closure, {"t": 0.0, "phi": 1.0, "s": 4 * unit, "phi_dot": 0, "s_dot": 0}, ("phi",)
    )
    assert good
    assert there["s"] == pytest.approx(unit * (np.cos(1) + np.sqrt(9 - np.sin(1) ** 2)), rel=1e-8)
    assert max(gaps(drawn.program, drawn.closure, there | {"s": 1.1 * there["s"]})) > 1e-2


def test_a_loop_that_cannot_be_closed_is_told() -> None:
    """A ground of 1.3: crank, coupler and rocker have 0.79 together."""
    text = (SHIPPED / "four-bar.yaml").read_text(encoding="utf-8").replace("l1: 0.13", "l1: 1.3")
    found = picture(of(text))
    assert found.notes.open_loop
    assert any(x.startswith("The constraints are open here") for x in as_json(found)["sentences"])
    good = as_json(picture(mbsym.load(SHIPPED / "four-bar.yaml").system))["sentences"]
    assert not any("open" in x for x in good)


@pytest.mark.parametrize("length", ["1", "1e-8"])
def test_a_rod_that_is_a_tenth_too_long_is_open_in_all_units(length: str) -> None:
    """A bob at (0, -l) and a rod of 1.1 l: with l = 1e-8 it counted as closed, beside 1 + |y|."""
    text = f"""mbsym: 1
name: rod
bodies:
  - {{name: bob, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}}
constraints:
  - distance: {{between: [{{body: bob, point: [0, 0, 0]}}, {{body: 0, point: [0, 0, 0]}}], length: {length}}}
initial: {{x: 0, y: -{length}}}
"""
    found = picture(of(text))
    assert found.closure is not None
    bob = {x.name: x.value for x in found.coordinates}
    assert max(gaps(found.program, found.closure, bob)) <= found.closure.tolerance
    assert max(gaps(found.program, found.closure, bob | {"y": 1.1 * bob["y"]})) > found.closure.tolerance


def test_what_orbits_is_seen_from_its_orbit() -> None:
    found = picture(mbsym.load(SHIPPED / "satellite.yaml").system)
    assert found.frame == "orbital frame"
    assert found.extent < 10
    assert picture(mbsym.load(SHIPPED / "double-pendulum.yaml").system).frame == "0"


def test_ellipsoids_have_the_moments_of_their_body() -> None:
    """Of a homogeneous ellipsoid A = m (b^2 + c^2)/5; a principal tensor (2, 3, 4) with m = 5."""
    text = """mbsym: 1
name: one
bodies:
  - {name: b, attached to: 0, rotation: {axes: [3, 1, 3], angles: [x, y, z]}, mass: 5, inertia about: joint,
     inertia: [2, 3, 4]}
"""
    (body,) = picture(of(text)).bodies
    assert body.ellipsoid is not None
    half = np.array(body.ellipsoid.half_axes) ** 2
    assert sorted(half.sum() - half) == pytest.approx([2.0, 3.0, 4.0])
    assert body.ellipsoid.true_size
    (plane,) = picture(of(text.replace("[2, 3, 4]", "[0, 0, 4]"))).bodies  # no body has this tensor
    assert plane.ellipsoid is None


def test_a_mistake_in_a_turn_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """With C_a transposed the poses part from the positions."""
    from mbsym.picture.build import Places

    right = Places._turned

    def wrong(self: Any, axes: Any, turn: Any) -> Any:
        return right(self, axes, type(turn)(**{k: getattr(turn, k) for k in turn.__slots__} | {"sine": -turn.sine}))

    monkeypatch.setattr(Places, "_turned", wrong)
    with pytest.raises(AssertionError):
        test_poses_against_positions(SHIPPED / "double-pendulum.yaml")


def test_tables_are_the_curves_of_the_description() -> None:
    """A joint that follows a table: a cubic spline through (0, 0), (1, 2), (3, 0)."""
    text = """mbsym: 1
name: cam
tables: {lift: {points: [[0, 0], [1, 2], [3, 0]], between: cubic, outside: extrapolate}}
bodies:
  - {name: follower, attached to: 0, connection point: [x, lift(x), 0], mass: 1, coordinates: [x]}
initial: {x: 0}
"""
    found = picture(of(text))
    assert len(found.program.tables) == 2  # the curve, and its slope: the direction in which x moves the joint
    for x, y in ((Fraction(0), 0.0), (Fraction(1), 2.0), (Fraction(3), 0.0)):
        assert placed(found, {"x": float(x)})[found.bodies[0].origin[1]] == pytest.approx(y, abs=1e-12)
