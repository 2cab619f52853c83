"""Places of joints and mass centres along a trajectory, and the picture of the moving system."""

from __future__ import annotations

from math import cos, pi, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED, parsed, reference, system_of
from scipy.spatial.transform import Rotation

from mbsym.numerics.body_motion import body_motions
from mbsym.numerics.positions import AXIS, END, JOINT, MASS_CENTRE, ORIGIN, Positions, positions
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.report.figures.motion_figure import motion_figures
from mbsym.report.outlines import outlines

TRUTH = reference("tethered-satellites")["trajectories"]["table1"]["states"]


def scenario_of(path: Path, **values: object) -> Scenario:
    system = system_of(path)
    return scenario(system, {name: parsed(str(value)) for name, value in values.items()})


def along(found: Scenario, times: Any, **coordinates: Any) -> Positions:
    """Positions on a path q(t) that is given, whether or not it satisfies any equations."""
    n = len(found.system.coordinates)
    states = np.array([float(x) for x in found.state])[:, None] + np.zeros(len(times))
    for name, values in coordinates.items():
        states[found.system.coordinates.index(name)] = values
    assert states.shape == (2 * n, len(times))
    drawn = positions(found, np.asarray(times, dtype=float), states)
    assert drawn is not None
    return drawn


def place(found: Positions, body: str, kind: str) -> Any:
    (number,) = [i for i, point in enumerate(found.points) if (point.body, point.kind) == (body, kind)]
    return found.places[number]


# --- places ---


def test_the_tether_is_where_equations_11_and_12_put_it() -> None:
    """B at the states of the reference: x_B = x_A + d_AC cos(theta1) + L1 cos(alpha1 + theta1) + ... (the paper)."""
    names = ("x_A", "y_A", "theta1", "theta2", "alpha1", "alpha2")
    rows = {name: np.array([float(state["q"][name]) for state in TRUTH]) for name in names}
    found = along(scenario_of(SHIPPED / "tethered-satellites.yaml"), [float(state["t"]) for state in TRUTH], **rows)
    assert (found.frame, found.plane, found.up) == ("0", 3, None)
    first, second = rows["theta1"], rows["theta2"]
    rod1, rod2 = first + rows["alpha1"], second + rows["alpha2"]
    for axis, (start, wave) in enumerate(((rows["x_A"], np.cos), (rows["y_A"], np.sin))):
        wanted = start + wave(first) + 50 * wave(rod1) + wave(second) - 50 * wave(rod2)
        assert np.max(np.abs(place(found, "satellite B", MASS_CENTRE)[axis] - wanted)) < 1e-12 * 300
        centre = start + wave(first) + 4 * wave(rod1)
        assert np.max(np.abs(place(found, "rod 1", MASS_CENTRE)[axis] - centre)) < 1e-12 * 300
    for axis, name in enumerate(("x_B", "y_B")):
        truth = [float(state["B"][name]) for state in TRUTH]
        assert np.max(np.abs(place(found, "satellite B", MASS_CENTRE)[axis] - truth)) < 1e-12 * 300
    assert not np.any(found.places[:, 2])
    # The centre of mass of the whole moves uniformly: only where all four masses are does it.
    masses = {"satellite A": 1000, "rod 1": 400, "rod 2": 400, "satellite B": 1000}
    whole = sum(masses[body] * found.places[i] for body, i in found.centres.items()) / sum(masses.values())
    straight = whole[:, :1] + (whole[:, -1:] - whole[:, :1]) * found.times / 60
    assert np.max(np.abs(whole - straight)) < 1e-9


def test_lines_follow_the_tree_and_leave_out_what_is_not_there() -> None:
    def named(found: Positions, pairs: Any) -> set[tuple[tuple[str, str], ...]]:
        return {tuple((found.points[i].body, found.points[i].kind) for i in pair) for pair in pairs}

    tether = along(scenario_of(SHIPPED / "tethered-satellites.yaml"), [0.0, 1.0], x_A=[0, 1])
    assert named(tether, tether.slides) == set()
    assert named(tether, tether.links) == {
        (("satellite A", JOINT), ("rod 1", JOINT)),
        (("rod 1", JOINT), ("rod 1", MASS_CENTRE)),
        (("rod 1", JOINT), ("rod 2", JOINT)),
        (("rod 2", JOINT), ("rod 2", MASS_CENTRE)),
        (("rod 2", JOINT), ("satellite B", JOINT)),
        (("satellite B", JOINT), ("satellite B", MASS_CENTRE)),
    }
    spring = along(scenario_of(SHIPPED / "spring-pendulum.yaml"), [0.0, 1.0], r=[1, 2])
    assert named(spring, spring.slides) == {(("direction of the spring", JOINT), ("bob", JOINT))}
    assert spring.up == (0.0, 1.0, 0.0)


def test_a_spring_to_the_origin_is_drawn(tmp_path: Path) -> None:
    text = """\
mbsym: 1
name: Point on a spring
parameters: {m: positive, k: positive}
bodies:
  - name: bob
    attached to: 0
    connection point: [x, y, 0]
    mass: m
    coordinates: [x, y]
loads:
  - spring: {coordinate: x, stiffness: k, rest: 0}
values: {m: 1, k: 1}
initial: {x: 1, y: 2}
"""
    (tmp_path / "bob.yaml").write_text(text, encoding="utf-8")
    found = along(scenario_of(tmp_path / "bob.yaml"), [0.0, 1.0], x=[1, 2])
    assert [point.kind for point in found.points] == [ORIGIN, JOINT]
    assert (found.links, found.slides) == ((), ((0, 1),))


@pytest.mark.parametrize("name", ["satellite", "dumbbell", "gravity-gradient", "orbital-gyrostat"])
def test_what_runs_on_an_orbit_is_seen_from_the_orbit(name: str) -> None:
    found = scenario_of(SHIPPED / f"{name}.yaml")
    drawn = along(found, [0.0, 1000.0])
    assert drawn.frame == "orbital frame"
    assert drawn.size < 50
    assert drawn.up == (0.0, 1.0, 0.0)


def test_a_frame_that_is_carried_slowly_does_not_hide_its_motion(tmp_path: Path) -> None:
    """A pivot that is driven to and fro by less than the pendulum's length is seen moving."""
    text = """\
mbsym: 1
name: Driven pendulum
parameters: {m: positive, l: positive, g: positive, h: positive}
prescribed: {s: {rate: 1}}
bodies:
  - {name: pivot, attached to: 0, connection point: [h*sin(s), 0, 0], mass: 0}
  - name: rod
    attached to: pivot
    rotation: {axes: [3], angles: [theta]}
    mass centre: [0, -l, 0]
    mass: m
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
values: {m: 1, l: 1, g: 9.81, h: 0.5}
initial: {theta: 0.1}
"""
    for h, frame in ((0.5, "0"), (500, "pivot")):
        (tmp_path / "driven.yaml").write_text(text.replace("h: 0.5}", f"h: {h}}}"), encoding="utf-8")
        found = along(scenario_of(tmp_path / "driven.yaml"), [0.0, pi / 2], theta=[0.1, -0.2])
        assert found.frame == frame
        shift = h if frame == "0" else 0
        assert np.allclose(place(found, "rod", MASS_CENTRE)[0], [sin(0.1), shift - sin(0.2)], rtol=0, atol=1e-13)
        assert np.allclose(place(found, "rod", MASS_CENTRE)[1], [-cos(0.1), -cos(0.2)], rtol=0, atol=1e-13)


def test_a_body_without_extent_shows_its_axes() -> None:
    """Rotations by another library: angles c, a, b about the axes 3, 1, 2 that the former ones have moved."""
    angles = np.array([[0.3, 0.5, -0.4], [1.1, -0.7, 2.0]])
    found = along(scenario_of(SHIPPED / "clebsch.yaml"), [0.0, 1.0], c=angles[:, 0], a=angles[:, 1], b=angles[:, 2])
    assert found.frame == "fixed point"
    assert found.up == (0.0, 0.0, -1.0)  # the attracting centre is below
    tips = {found.points[i].axis: found.places[i] for i in found.tips}
    for k, triple in enumerate(angles):
        rows = Rotation.from_euler("ZXY", triple).as_matrix().T
        for axis in (1, 2, 3):
            assert np.allclose(tips[axis][:, k], rows[axis - 1], rtol=0, atol=1e-14)
    assert {point.kind for point in found.points} == {JOINT, AXIS}


DAMPED = """\
mbsym: 1
name: Satellite with a ball in a tube
parameters: {A: 3, C: 5, mu: 0.1, b: 0.6, k: 0.3}
bodies:
  - name: platform
    attached to: 0
    rotation: {axes: [3, 1, 2], angles: [phi, alpha, beta]}
    mass: 100
    inertia about: mass centre
    inertia: [A, A, C]
  - {name: ball, attached to: platform, connection point: [b, 0, z], mass: mu, coordinates: [z]}
loads:
  - spring: {coordinate: z, stiffness: k}
initial: {alpha: 0.1, beta: 0.05, phi: 0, z: 0.01}
"""


def test_a_body_that_carries_others_shows_its_axes_where_nothing_else_shows_them(tmp_path: Path) -> None:
    """Directions by another library; a body with a line of its own, or in plane motion, needs no axes."""
    (tmp_path / "damped.yaml").write_text(DAMPED, encoding="utf-8")
    angles = np.array([[0.3, 0.5, -0.4], [1.1, -0.7, 2.0]])
    found = along(
        scenario_of(tmp_path / "damped.yaml"), [0.0, 1.0], phi=angles[:, 0], alpha=angles[:, 1], beta=angles[:, 2]
    )
    assert found.extended
    tips = {found.points[i].axis: found.places[i] for i in found.tips}
    assert {found.points[i].body for i in found.tips} == {"platform"}
    for k, triple in enumerate(angles):
        rows = Rotation.from_euler("ZXY", triple).as_matrix().T
        for axis in (1, 2, 3):
            length = np.linalg.norm(tips[axis][:, k])
            assert length > 0.6
            assert np.allclose(tips[axis][:, k] / length, rows[axis - 1], rtol=0, atol=1e-14)
    assert set(motion_figures(found, ["svg"])) == {"motion.svg", "mass-centres.svg"}
    flat = along(scenario_of(tmp_path / "damped.yaml"), [0.0, 1.0], phi=[0, 1], alpha=[0, 0], beta=[0, 0], z=[0, 0])
    assert flat.plane == 3
    assert flat.tips == ()
    lined = along(scenario_of(SHIPPED / "satellite.yaml"), [0.0, 1000.0])
    assert lined.tips == ()


def test_a_picture_ends_before_its_paths_fill_it() -> None:
    times = np.linspace(0, 100, 5001)
    found = along(scenario_of(SHIPPED / "simple-pendulum.yaml"), times, theta=np.sin(times))
    shown = found.readable()
    length = float(np.sum(np.linalg.norm(np.diff(place(shown, "pendulum", MASS_CENTRE), axis=1), axis=0)))
    assert 4.5 * found.size < length <= 5 * found.size
    assert shown.times[0] == 0
    slow = along(scenario_of(SHIPPED / "simple-pendulum.yaml"), times, theta=np.sin(times / 100))
    assert len(slow.readable().times) == len(times)


def test_nothing_is_drawn_of_what_has_no_places() -> None:
    found = scenario_of(SHIPPED / "double-pendulum.yaml")
    assert positions(found, np.array([0.0, 1.0]), np.full((4, 2), np.inf)) is None


# --- pictures ---


@pytest.mark.parametrize(
    ("name", "files"),
    [
        ("tethered-satellites", {"motion.svg", "mass-centres.svg"}),
        ("spherical-pendulum", {"motion.svg", "mass-centres.svg"}),
        ("clebsch", {"motion.svg"}),
    ],
)
def test_pictures_of_planar_spatial_and_turning_motion(name: str, files: set[str]) -> None:
    found = scenario_of(SHIPPED / f"{name}.yaml")
    times = np.linspace(0, 3, 301)
    start = zip(found.system.coordinates, found.positions, strict=True)
    moved = {name: float(x) + 0.2 * np.sin(times * (1 + i)) for i, (name, x) in enumerate(start)}
    drawn = along(found, times, **moved)
    images = motion_figures(drawn, ["svg"], "not whole")
    assert images.keys() == files
    assert images == motion_figures(drawn, ["svg"], "not whole")
    assert all(content.startswith(b"<?xml") for content in images.values())
    assert images["motion.svg"] != motion_figures(drawn, ["svg"])["motion.svg"]


def test_a_title_is_not_read_as_a_formula(tmp_path: Path) -> None:
    text = (SHIPPED / "double-pendulum.yaml").read_text(encoding="utf-8").replace("Double pendulum", "A $x^$ pendulum")
    (tmp_path / "odd.yaml").write_text(text, encoding="utf-8")
    drawn = along(scenario_of(tmp_path / "odd.yaml"), np.linspace(0, 1, 11), theta1=np.linspace(0, 1, 11))
    assert drawn.system.name == "A $x^$ pendulum"
    assert set(motion_figures(drawn, ["png"])) == {"motion.png", "mass-centres.png"}


def test_a_single_state_gives_no_picture() -> None:
    found = scenario_of(SHIPPED / "double-pendulum.yaml")
    assert motion_figures(along(found, [0.0]), ["png"]) == {}


def test_of_several_paths_the_longest_counts() -> None:
    times = np.linspace(0, 200, 20_001)
    found = along(
        scenario_of(SHIPPED / "double-pendulum.yaml"), times, theta1=0.1 * np.sin(times), theta2=np.sin(times)
    )
    shown = found.readable()
    paths = np.sum(np.linalg.norm(np.diff(shown.places, axis=2), axis=1), axis=1)
    assert 4.9 * found.size < max(paths) <= 5 * found.size


def test_of_the_axes_of_a_body_the_slowest_counts() -> None:
    """Tilted by 0.3 and turned: the third axis runs on a small circle."""
    times = np.linspace(0, 400, 20_001)
    found = along(scenario_of(SHIPPED / "clebsch.yaml"), times, c=times, a=0.3 + 0 * times, b=0 * times)
    shown = found.readable()
    paths = np.sum(np.linalg.norm(np.diff(shown.places[list(shown.tips)], axis=2), axis=1), axis=1)
    assert 14.9 * found.size < min(paths) <= 15 * found.size


def test_a_hub_that_turns_by_one_angle_shows_no_axes(tmp_path: Path) -> None:
    text = DAMPED.replace("axes: [3, 1, 2], angles: [phi, alpha, beta]", "axes: [3], angles: [phi]")
    (tmp_path / "hub.yaml").write_text(text.replace("alpha: 0.1, beta: 0.05, ", ""), encoding="utf-8")
    found = along(scenario_of(tmp_path / "hub.yaml"), [0.0, 1.0], phi=[0, 1], z=[0, 0.3])
    assert (found.plane, found.tips) == (None, ())


def test_a_damper_to_the_origin_is_drawn(tmp_path: Path) -> None:
    text = """\
mbsym: 1
name: Point on a damper
parameters: {m: positive, k: positive}
bodies:
  - {name: bob, attached to: 0, connection point: [x, y, 0], mass: m, coordinates: [x, y]}
loads:
  - damper: {coordinate: x, coefficient: k}
values: {m: 1, k: 1}
initial: {x: 1, y: 2}
"""
    (tmp_path / "bob.yaml").write_text(text, encoding="utf-8")
    found = along(scenario_of(tmp_path / "bob.yaml"), [0.0, 1.0], x=[1, 2])
    assert [point.kind for point in found.points] == [ORIGIN, JOINT]
    assert (found.links, found.slides) == ((), ((0, 1),))


def test_a_loop_is_closed_and_a_rod_is_drawn() -> None:
    """Four-bar: the rocker reaches the ground where it is tied; the pendulum's rod leads to the origin."""
    loop = along(scenario_of(SHIPPED / "four-bar.yaml"), [0.0, 1.0])
    (end,) = [i for i, point in enumerate(loop.points) if point.kind == END]
    assert loop.points[end].body == "rocker"
    assert np.max(np.abs(loop.places[end])) < 1e-7  # at the state that the description gives, the loop is closed
    assert any(j == end and loop.points[i].body == "rocker" for i, j in loop.links)
    rod = along(scenario_of(SHIPPED / "cartesian-pendulum.yaml"), [0.0, 1.0], y=np.array([0.0, -0.5]))
    assert [(rod.points[i].kind, rod.points[j].kind) for i, j in rod.links] in ([(ORIGIN, JOINT)], [(JOINT, ORIGIN)])


def test_shapes_are_seen_in_a_picture() -> None:
    disc = scenario_of(SHIPPED / "rolling-disc.yaml")
    times = np.linspace(0, 1, 5)
    places = along(disc, times, x=times)
    states = np.array([float(x) for x in disc.state])[:, None] + np.zeros(5)
    shapes = outlines(disc, body_motions(disc, times, states, np.zeros((5, 5)), places.frame))
    assert len(shapes) == 1
    plain, shaped = (motion_figures(places, ["png"], "", some)["motion.png"] for some in ((), shapes))
    assert plain != shaped
