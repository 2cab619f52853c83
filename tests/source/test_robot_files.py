"""Robots' files: hostile and wrong ones are answered with places; turns against matrices; URDF that nobody has seen."""

from __future__ import annotations

import html
import math
from pathlib import Path

import numpy as np
import pytest
from conftest import filed, invoked, system_of

import mbsym
from mbsym.expressions.place import Complaints
from mbsym.expressions.tree import text as written
from mbsym.model.constraints import Coincide, Relation
from mbsym.problems.claims import Outcome
from mbsym.report.targets import TARGETS
from mbsym.source import read, to_text
from mbsym.source.robots import Converted, convert, is_robot
from mbsym.source.robots.reader import MAX_DEPTH
from mbsym.source.robots.robot import turns_about

PENDULUM = """<?xml version="1.0"?>
<robot name="pen: # dulum">
  <link name="world"/>
  <link name="rod &lt;1&gt;">
    <inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.01"/></inertial>
    <visual><geometry><cylinder radius="0.02" length="1"/></geometry></visual>
    <collision><geometry><box size="1 1 1"/></geometry></collision>
  </link>
  <joint name="pivot&#10;x: y" type="revolute">
    <parent link="world"/><child link="rod &lt;1&gt;"/><axis xyz="0 1 0"/><origin rpy="0 0 0.3" xyz="0 0 2"/>
    <limit lower="-2" upper="2.5"/><dynamics damping="0.7" friction="0.1"/>
  </joint>
</robot>
"""


def converted(text: str, **options: bool) -> Converted:
    complaints = Complaints()
    made = convert(text, complaints, **options)
    assert made is not None, [one.message for one in complaints]
    return made


def complaints_of(text: str) -> list[tuple[str, int]]:
    complaints = Complaints()
    assert convert(text, complaints) is None
    return [(one.code, one.span.line if one.span else 0) for one in complaints.items]


def test_a_urdf_in_every_part() -> None:
    made = converted(PENDULUM)
    system, complaints = read(made.yaml, "p.yaml")
    assert system is not None, [one.message for one in complaints]
    assert not complaints.items
    assert system.name == "pen: # dulum"
    (rod,) = [body for body in system.bodies if body.coordinates]
    assert rod.name == "rod -1-"
    assert [written(angle) for angle in rod.rotation.angles] == ["0.3", "q1"]
    assert rod.rotation.axes == (3, 2)
    assert [(written(one.lower), written(one.upper)) for one in system.limits] == [("-2", "2.5")]
    assert [(one.kind, [written(size) for size in one.size]) for one in rod.shapes] == [("cylinder", ["0.02", "1"])]
    assert any("0.7" in repr(load) or "7, 10" in repr(load) for load in system.loads)
    assert set(made.left_out) == {"contact (<collision>)", "dry friction of a joint"}
    again, _ = read(to_text(system), "p.txt")
    assert again == system


def test_symbols_have_the_printed_values() -> None:
    plain, _ = read(converted(PENDULUM).yaml, "p.yaml")
    named, _ = read(converted(PENDULUM, symbols=True).yaml, "p.yaml")
    assert plain is not None
    assert named is not None
    assert not plain.parameters
    values = {one.name: written(one.value) for one in named.parameters if one.value is not None}
    assert values == {
        "g": "9.81", "p2z": "2", "c2z": "0.5", "m2": "2", "J2xx": "0.1", "J2yy": "0.1", "J2zz": "0.01", "b1": "0.7",
    }  # fmt: skip
    meanings = {one.name: one.meaning for one in named.parameters}
    assert meanings["p2z"] == "origin of rod <1> on its carrier along z"
    assert meanings["c2z"] == "mass centre of rod <1> along z"


@pytest.mark.parametrize(
    ("old", "new", "code", "line"),
    [
        ('value="2"', 'value="two"', "bad-number", 5),
        ('value="2"', 'value="1e999"', "bad-number", 5),
        ('value="2"', 'value="nan"', "bad-number", 5),
        ('value="2"', 'value="-2"', "impossible-mass", 5),
        ('value="2"', "", "missing-key", 5),
        ('<mass value="2"/>', "", "missing-key", 5),
        ('xyz="0 1 0"', 'xyz="0 0 0"', "bad-axis", 10),
        ('xyz="0 1 0"', 'xyz="0 1"', "wrong-shape", 11),
        ('type="revolute"', 'type="spherical"', "unsupported", 10),
        ('link="world"/><child', 'link="nowhere"/><child', "unknown-name", 11),
        ('<parent link="world"/>', '<parent link="rod &lt;1&gt;"/>', "no-tree", 4),
        ("</robot>", "", "syntax", 15),
        ("<robot", '<!DOCTYPE r [<!ENTITY a "b">]><robot', "unsupported", 2),
        ('<link name="world"/>', '<link name="world"/><link name="world"/>', "repeated-name", 3),
        ('<link name="world"/>', '<link name="world"/><link name="alone"/>', "no-tree", 2),
    ],
)
def test_what_is_wrong_has_its_place(old: str, new: str, code: str, line: int) -> None:
    assert old in PENDULUM
    assert (code, line) in complaints_of(PENDULUM.replace(old, new, 1))


def test_a_link_that_is_misspelt_is_guessed() -> None:
    links = '<robot name="r"><link name="base"/><link name="upper_arm"/><joint name="j" type="fixed">'
    text = links + '<parent link="base"/><child link="uper_arm"/></joint></robot>'
    complaints = Complaints()
    assert convert(text, complaints) is None
    assert "did you mean 'upper_arm'?" in [one.hint for one in complaints.items]


def test_depth_and_size_are_bounded() -> None:
    deep = "<robot>" + "<a>" * (MAX_DEPTH + 5) + "</a>" * (MAX_DEPTH + 5) + "</robot>"
    assert complaints_of(deep)[0][0] == "too-large"


def rotation(axis: int, angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    first, second = {1: (1, 2), 2: (2, 0), 3: (0, 1)}[axis]
    matrix = np.eye(3)
    matrix[first, first] = matrix[second, second] = c
    matrix[first, second], matrix[second, first] = -s, s
    return matrix


def product(turns: list[tuple[int, str]], q: float = 0.0) -> np.ndarray:
    """The active rotation whose columns are the new axes: turns about the turned axes multiply from the right."""
    matrix = np.eye(3)
    for axis, words in turns:
        matrix = matrix @ rotation(axis, eval(words, {"pi": math.pi, "q": q}))
    return matrix


@pytest.mark.parametrize("axis", [("1", "2", "-1"), ("0", "-1", "0"), ("0.3", "0", "0.4"), ("-1", "-1", "0")])
def test_a_turn_about_any_axis_is_rodrigues_s(axis: tuple[str, str, str]) -> None:
    q = 0.7
    n = np.array(list(map(float, axis)))
    n /= np.linalg.norm(n)
    cross = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    expected = np.eye(3) + math.sin(q) * cross + (1 - math.cos(q)) * cross @ cross
    assert np.allclose(product(list(turns_about(axis, "q")), q), expected, atol=1e-15)


def orientation_of(attributes: str, compiler: str = "") -> np.ndarray:
    """The rotation of a body that a file turns so."""
    inertial = '<inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/>'
    body = f'<body name="b" {attributes}><joint name="j" type="slide"/>{inertial}</body>'
    text = f"<mujoco><compiler {compiler}/><worldbody>{body}</worldbody></mujoco>"
    system = system_of(converted(text).yaml, "x.yaml")
    turns = [(axis, written(angle)) for body in system.bodies for axis, angle in body.rotation.turns()]
    return product(turns)


def test_euler_angles_about_fixed_and_about_turned_axes() -> None:
    a, b, c = (math.radians(value) for value in (20, 30, 50))
    moving = orientation_of('euler="20 30 50"')
    assert np.allclose(moving, rotation(1, a) @ rotation(2, b) @ rotation(3, c))
    fixed = orientation_of('euler="20 30 50"', 'eulerseq="XYZ"')
    assert np.allclose(fixed, rotation(3, c) @ rotation(2, b) @ rotation(1, a))
    radians = orientation_of('euler="0.2 0.3 0.5"', 'angle="radian" eulerseq="zyx"')
    assert np.allclose(radians, rotation(3, 0.2) @ rotation(2, 0.3) @ rotation(1, 0.5))


@pytest.mark.parametrize(
    ("attributes", "columns"),
    [
        ('axisangle="1 1 0 180"', [[0, 1, 0], [1, 0, 0], [0, 0, -1]]),  # of any length
        ('quat="1 1 0 0"', [[1, 0, 0], [0, 0, 1], [0, -1, 0]]),
        ('quat="0 0 0 -3"', [[-1, 0, 0], [0, -1, 0], [0, 0, 1]]),
        ('xyaxes="0 2 0 5 7 0"', [[0, 1, 0], [1, 0, 0], [0, 0, -1]]),
        ('zaxis="0 0 -2"', [[1, 0, 0], [0, -1, 0], [0, 0, -1]]),
        ('zaxis="3 0 0"', [[0, 0, -1], [0, 1, 0], [1, 0, 0]]),
        ('axisangle="0 -1 0 90"', [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]),
    ],
)
def test_other_ways_to_turn(attributes: str, columns: list[list[float]]) -> None:
    """The new axes, by hand, in the old ones."""
    assert np.allclose(orientation_of(attributes).T, columns, atol=1e-12)


@pytest.mark.parametrize(
    "printed", ["0.499998 0.5 0.500002 0.5", "0.5 0.49999999999 -0.5 0.50000000001", "1 1e-9 1 3e-9"]
)
def test_a_quaternion_near_the_singular_pitch_loses_no_digits(printed: str) -> None:
    """R = 1 + 2 (w [u] + [u]^2)/|q|^2."""
    w, x, y, z = map(float, printed.split())
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix = np.eye(3) + 2 * (w * cross + cross @ cross) / (w * w + x * x + y * y + z * z)
    assert np.abs(orientation_of(f'quat="{printed}"') - matrix).max() < 1e-15


@pytest.mark.parametrize(
    ("axis", "place", "axes"),
    [
        ("0 0 1", "[q1x, q1y, 0]", "[3]"),
        ("0 -1 0", "[q1y, 0, q1x]", "[2]"),
        ("1 0 0", "[0, q1x, q1y]", "[1]"),
        ("1 1 0", "[q1x, q1y, 0]", "[3, 2, 3]"),
    ],
)
def test_a_planar_joint_slides_across_its_axis_and_turns_about_it(axis: str, place: str, axes: str) -> None:
    text = PENDULUM.replace('type="revolute"', 'type="planar"').replace("0 1 0", axis)
    text = text.replace('rpy="0 0 0.3" xyz="0 0 2"', "")
    made = converted(text)
    assert f"connection point: {place}" in made.yaml
    assert f"axes: {axes}" in made.yaml
    assert made.left_out == ("contact (<collision>)", "damping of a planar joint", "dry friction of a joint")
    system = system_of(made.yaml, "p.yaml")
    assert system.coordinates == ("q1x", "q1y", "q1yaw")


def test_a_floating_joint_moves_from_where_it_is_placed_and_quaternions_turn_origins() -> None:
    """A third of a turn about (1, 1, 1) takes the axes 1, 2, 3 to 2, 3, 1."""
    free = PENDULUM.replace('type="revolute"', 'type="floating"')
    assert "connection point: [0, 0, 2]" in converted(free).yaml
    assert "angles: [0.3]" in converted(free).yaml
    turned = PENDULUM.replace('rpy="0 0 0.3"', 'quat_xyzw="1 1 1 1"')
    system = system_of(converted(turned).yaml, "p.yaml")
    turns = [(axis, written(angle)) for body in system.bodies for axis, angle in body.rotation.turns()]
    assert np.allclose(product([turn for turn in turns if turn[1] != "q1"]), np.eye(3)[:, [1, 2, 0]].T.T)
    assert "conflicting-keys" in [code for code, _ in complaints_of(PENDULUM.replace("rpy", 'quat_xyzw="1 0 0 0" rpy'))]


def test_the_command_tells_what_it_leaves_out_and_writes_what_runs(tmp_path: Path) -> None:
    file, out = tmp_path / "p.urdf", tmp_path / "p.yaml"
    file.write_text(PENDULUM, encoding="utf-8")
    done = invoked("convert", file, "--out", out, code=0)
    assert "left out: contact" in done.stderr
    assert invoked("check", out).exit_code == 0
    done = invoked("convert", out, "--symbols", code=2)
    file.write_text(PENDULUM.replace('value="2"', 'value="two"'), encoding="utf-8")
    done = invoked("convert", file, "--out", tmp_path / "no.yaml", code=2)
    assert f"{file}:5:" in done.stderr
    assert not (tmp_path / "no.yaml").exists()


def test_a_tensor_that_is_left_out_is_told_with_its_link(tmp_path: Path) -> None:
    """A sign: a turn about the first axis would have a negative energy."""
    file, out = tmp_path / "p.urdf", tmp_path / "p.yaml"
    file.write_text(PENDULUM.replace('ixx="0.1"', 'ixx="-0.1"'), encoding="utf-8")
    done = invoked("convert", file, "-o", out, code=0)
    assert "tensor of inertia of link 'rod <1>' with which" in " ".join(done.stderr.split())
    assert invoked("check", out).exit_code == 0


def test_what_is_a_robot() -> None:
    assert is_robot('<?xml version="1.0"?>\n<!-- made by hand -->\n<robot name="x"/>')
    assert is_robot("<mujoco model='x'/>")
    assert not is_robot("mbsym: 1\nname: <robot>")
    assert not is_robot("<sdf><robot/></sdf>")
    assert not is_robot("<!---->" * 60 + "x")  # at once, not in 2^60 ways
    assert is_robot("<!-- a --> <!-- <b> -->\n<robot/>")


#: Its mass is pi at a density of 6.
POINT = '<inertial pos="0 0 -1" mass="1" diaginertia="1 1 1"/>'
BALL = '<body name="b"><joint axis="0 1 0"/><geom size="0.5"/></body>'


def mujoco(before: str, body: str = BALL, after: str = "") -> str:
    return f"<mujoco>{before}<worldbody>{body}</worldbody>{after}</mujoco>"


def masses(text: str, **options: bool) -> list[str]:
    system = system_of(converted(text, **options).yaml, "x.yaml")
    return [written(body.mass) for body in system.bodies]


def test_sections_that_come_twice_are_one() -> None:
    defaults = '<default><geom density="6"/></default><default><joint damping="3"/></default>'
    assert masses(mujoco(defaults)) == ["pi*1"]
    assert "coefficient: 3" in converted(mujoco(defaults)).yaml
    again = '<worldbody><body name="c"><joint/><geom size="0.5"/></body></worldbody>'
    assert masses(mujoco('<default><geom density="6"/></default>', after=again)) == ["pi*1", "pi*1"]
    assert "acceleration: 2" in converted(mujoco('<option timestep="1"/><option gravity="0 0 -2"/>')).yaml


def test_gravity_may_be_off_and_geoms_of_other_groups_weigh_nothing() -> None:
    assert "gravity" not in converted(mujoco('<option gravity="0 0 -2"><flag gravity="disable"/></option>')).yaml
    two = '<body name="b"><joint/><geom size="0.5" density="6" group="1"/><geom size="0.5" group="2"/></body>'
    assert masses(mujoco('<compiler inertiagrouprange="0 1"/>', two)) == ["pi*1"]


def test_the_first_class_holds_for_all_whatever_it_is_called() -> None:
    assert masses(mujoco('<default class="robot"><geom density="6"/></default>')) == ["pi*1"]


def test_one_way_to_turn_stands_for_the_default_s() -> None:
    box = '<body name="b"><joint/><geom type="box" size="1 2 3" axisangle="0 0 1 90"/></body>'
    made = converted(mujoco('<default><geom euler="20 30 40"/></default>', box))
    assert "rotation: {axes: [3], angles: [pi/2]}" in made.yaml
    assert "20" not in made.yaml.partition("bodies:")[2].partition("mass:")[0]


def test_only_the_first_link_is_freed_and_once() -> None:
    two = '<body name="a"><joint/><geom size="1"/></body><body name="b"><joint/><geom size="1"/></body>'
    system = system_of(converted(mujoco("", two), floating=True).yaml, "x.yaml")
    assert system.coordinates == ("x", "y", "z", "yaw", "pitch", "roll", "q1", "q2")
    free = system_of(
        converted(mujoco("", '<body name="a"><freejoint/><geom size="1"/></body>'), floating=True).yaml, "x.yaml"
    )
    assert len(free.coordinates) == 6


@pytest.mark.parametrize(
    ("before", "body", "code"),
    [
        ("", '<body childclass="nope"><joint/><geom size="1"/></body>', "unknown-name"),
        ("", '<body><joint class="nope"/><geom size="1"/></body>', "unknown-name"),
        ("", '<body><joint/><geom type="mesh" mesh="m"/></body>', "unsupported"),  # or the robot would be too light
        ("", '<body><joint/><geom size="1" shellinertia="true"/></body>', "unsupported"),
        ("", '<body><joint springdamper="1 1"/><geom size="1"/></body>', "unsupported"),
        ("", '<body><joint/><geom size="-1"/></body>', "bad-size"),
        ("", '<body><joint/><geom size="1" mass="-1"/></body>', "impossible-mass"),
        ("", '<body><joint/><geom type="sfere" size="1"/></body>', "unsupported"),
        ("", '<body euler="1 2 3" quat="1 0 0 0"><joint/><geom size="1"/></body>', "conflicting-keys"),
        ('<compiler angle="grad"/>', BALL, "bad-word"),
    ],
)
def test_what_would_be_read_wrongly_is_refused(before: str, body: str, code: str) -> None:
    assert complaints_of(mujoco(before, body)) == [(code, 1)]


def test_meshes_that_weigh_nothing_are_left_out() -> None:
    body = '<body name="b"><joint/><geom type="mesh" mesh="m" mass="0"/><geom size="0.5" density="6"/></body>'
    made = converted(mujoco("", body))
    assert "geom of the type mesh" in made.left_out
    assert masses(mujoco("", body)) == ["pi*1"]


def test_a_template_is_told_to_be_one() -> None:
    text = PENDULUM.replace("<robot ", '<robot xmlns:xacro="http://x" ').replace(
        '<link name="world"/>', '<xacro:macro name="m"/><link name="world"/>'
    )
    assert complaints_of(text) == [("unsupported", 3)]


@pytest.mark.parametrize(
    ("old", "new", "what", "meant"),
    [
        ("<origin rpy", "<orign rpy", "element <orign> in <joint>", "origin"),
        ("<mass value", "<mas value", "element <mas> in <inertial>", "mass"),
        ('damping="', 'dampng="', "attribute 'dampng' of <dynamics>", "damping"),
        ('ixy="', 'Ixy="', "attribute 'Ixy' of <inertia>", "ixy"),
        (' xyz="0 0 -0.5"', ' XYZ="0 0 -0.5"', "attribute 'XYZ' of <origin>", "xyz"),
    ],
)
def test_what_is_misspelt_in_urdf_is_complained_about_with_a_guess(old: str, new: str, what: str, meant: str) -> None:
    assert old in PENDULUM
    complaints = Complaints()
    assert convert(PENDULUM.replace(old, new, 1), complaints) is None
    found = next(one for one in complaints.items if one.code == "unknown-key")
    assert what in found.message
    assert found.hint == f"did you mean '{meant}'?"


@pytest.mark.parametrize(
    ("old", "new", "what", "where"),
    [
        ("<inertial>", "<inertia/>\n<inertial>", "<inertia> stands in <link>", "<inertial>"),
        ("</inertial>", "<limit/></inertial>", "<limit> stands in <inertial>", "<joint>"),
        ("<axis ", '<limit>\n<mimic joint="j"/></limit><axis ', "<mimic> stands in <limit>", "<joint>"),
        ("<axis ", '<origin>\n<axis xyz="1 0 0"/></origin><axis ', "<axis> stands in <origin>", "<joint>"),
        ("<inertial>", "<visual>\n<inertial/></visual><inertial>", "<inertial> stands in <visual>", "<link>"),
        ("</robot>", '<group>\n<link name="l"/></group></robot>', "<link> stands in <group>", "<robot>"),
    ],
)
def test_what_stands_in_another_element_of_a_urdf_is_not_lost_in_silence(
    old: str, new: str, what: str, where: str
) -> None:
    assert old in PENDULUM
    complaints = Complaints()
    assert convert(PENDULUM.replace(old, new, 1), complaints) is None
    found = next(one for one in complaints.items if one.code == "misplaced-key")
    assert found.message == f"{what}, where it is not read"
    assert found.hint == f"it belongs into {where}"


@pytest.mark.parametrize(
    ("before", "body", "what"),
    [
        ("", f"<body><joint>{POINT}</joint></body>", "<inertial> stands in <joint>"),
        ("", f"<joint/><body>{POINT}</body>", "<joint> stands in <worldbody>"),
        ("", f"<body><joint/><geom size='1'>{POINT}</geom></body>", "<inertial> stands in <geom>"),
        (f"<default>{POINT}</default>", BALL, "<inertial> stands in <default>"),
        (f"<body>{POINT}</body>", BALL, "<body> stands in <mujoco>"),
    ],
)
def test_what_stands_in_another_element_of_an_mjcf_is_not_lost_in_silence(before: str, body: str, what: str) -> None:
    """MuJoCo refuses all of these but the last one, of which it loses a body."""
    complaints = Complaints()
    assert convert(mujoco(before, body), complaints) is None
    assert f"{what}, where it is not read" in [one.message for one in complaints.items]


def test_what_urdf_files_have_of_their_own_is_left_out_by_name() -> None:
    """They stand in files of robots that are sold; none is a slip of the pen."""
    text = PENDULUM.replace('<link name="world"/>', '<link name="world"><origin/><collision_checking/></link>')
    made = converted(text.replace("<dynamics ", '<dynamics gear_damping="2" '))
    assert "unknown element <collision_checking> in <link>" in made.left_out
    assert "unknown attribute 'gear_damping' of <dynamics>" in made.left_out
    assert "place of a link (<origin> in <link>)" in made.left_out


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ('<mass value="2"/>', '<mass value="2"/>\n<mass value="3"/>', "repeated-key"),
        ("<dynamics ", '<dynamics damping="9"/>\n<dynamics ', "repeated-key"),
        ("<axis ", '<axis xyz="1 0 0"/>\n<axis ', "repeated-key"),
        ('value="2"', 'value="1_0"', "bad-number"),
        ('value="2"', 'value="\u0662"', "bad-number"),
    ],
)
def test_of_two_elements_where_one_holds_none_is_taken(old: str, new: str, code: str) -> None:
    assert old in PENDULUM
    assert [one for one, _ in complaints_of(PENDULUM.replace(old, new, 1))] == [code]


@pytest.mark.parametrize(
    ("before", "body", "what", "meant"),
    [
        ("", '<body>\n<joint dampng="3"/><geom size="1"/></body>', "attribute 'dampng' of <joint>", "damping"),
        ("", '<body><joint/>\n<geom size="1" densty="9"/></body>', "attribute 'densty' of <geom>", "density"),
        ("", '<body><joint/>\n<geom size="1" Mass="9"/></body>', "attribute 'Mass' of <geom>", "mass"),
        ("", '\n<body poss="0 0 1"><joint/><geom size="1"/></body>', "attribute 'poss' of <body>", "pos"),
        ('\n<compiler angel="radian"/>', BALL, "attribute 'angel' of <compiler>", "angle"),
        ('\n<option gravty="0 0 0"/>', BALL, "attribute 'gravty' of <option>", "gravity"),
        ('<default><default class="a">\n<joint axs="1 0 0"/></default></default>', BALL, "<joint>", "axis"),
        ("", '<body><joint/>\n<geon size="1"/></body>', "element <geon> in <body>", "geom"),
    ],
)
def test_what_is_misspelt_in_mjcf_is_complained_about_with_a_guess(
    before: str, body: str, what: str, meant: str
) -> None:
    complaints = Complaints()
    assert convert(mujoco(before, body), complaints) is None
    (found,) = complaints.items
    assert what in found.message
    assert found.hint == f"did you mean '{meant}'?"
    assert found.span is not None
    assert found.span.line == 2


@pytest.mark.parametrize(
    ("body", "after", "codes"),
    [
        (f"<body><joint name='j'/>{POINT}</body><body><joint name='j'/>{POINT}</body>", "", ["repeated-name"]),
        (f"<body><joint/>{POINT}{POINT}</body>", "", ["repeated-key"]),
        ("<body><joint/>" + POINT.replace('pos="0 0 -1"', "") + "</body>", "", ["missing-key"]),
        ("<body><joint/>" + POINT.replace("/>", ' fullinertia="1 1 1 0 0 0"/>') + "</body>", "", ["conflicting-keys"]),
        (
            f"<body><joint name='j'/>{POINT}</body>",
            "<equality><joint joint1='j' polycoeff='1 2'/></equality>",
            ["unknown-key"],
        ),
    ],
)
def test_what_mujoco_refuses_is_refused(body: str, after: str, codes: list[str]) -> None:
    """A joint's name twice, two inertias, one that stands nowhere, a tensor told twice, a slip in a tie."""
    assert [code for code, _ in complaints_of(mujoco("", body, after))] == codes


@pytest.mark.parametrize(
    ("flag", "gone"),
    [
        ("damper", ["damper"]),
        ("spring", ["spring"]),
        ("passive", ["damper", "spring"]),
        ("equality", ["constraints"]),
        ("constraint", ["constraints", "limits"]),
        ("limit", ["limits"]),
        ("gravity", ["gravity"]),
    ],
)
def test_what_flags_switch_off_is_off(flag: str, gone: list[str]) -> None:
    option = f'<compiler angle="radian"/><option><flag {flag}="disable"/></option>'
    body = f'<body><joint name="j" damping="3" stiffness="4" range="-1 1"/>{POINT}</body>'
    after = '<equality><joint joint1="j" polycoef="0.5"/></equality>'
    words = ("damper", "spring", "constraints", "limits", "gravity")
    plain, switched = (
        converted(mujoco(before, body, after)).yaml for before in (option.replace(flag, "energy"), option)
    )
    assert all(f"{word}:" in plain for word in words)
    assert [word for word in words if f"{word}:" not in switched] == gone


def test_a_class_may_switch_off_a_tie() -> None:
    """As MuJoCo has it: the class of a tie is that of <equality>."""
    before = '<default><default class="off"><equality active="false"/></default></default>'
    body = f'<body><joint name="j"/>{POINT}</body>'
    made = converted(mujoco(before, body, '<equality><joint class="off" joint1="j"/></equality>'))
    assert "constraints:" not in made.yaml
    assert "inactive constraint (<joint>)" in made.left_out


def test_a_tie_is_of_the_joint_of_its_name_and_of_no_nameless_one() -> None:
    """The joint ``elbow`` is q1; the nameless one in the body ``elbow``, with another reference, is q3."""
    bodies = [
        f'<body name="upper"><joint name="elbow" ref="30"/>{POINT}</body>',
        f'<body name="lower"><joint name="x"/>{POINT}</body>',
        f'<body name="elbow"><joint ref="60"/>{POINT}</body>',
    ]
    after = '<equality><joint joint1="elbow" joint2="x"/></equality>'
    assert "relation: q1 - pi/6 = (1)*(q2)" in converted(mujoco("", "".join(bodies), after)).yaml


def test_a_joint_s_name_stands_once_in_urdf_and_a_floating_joint_s_damping_is_told() -> None:
    text = PENDULUM.replace(
        "</robot>",
        """<link name="more"/><joint name="pivot&#10;x: y" type="fixed">
<parent link="world"/><child link="more"/></joint></robot>""",
    )
    assert "repeated-name" in [code for code, _ in complaints_of(text)]
    free = PENDULUM.replace('type="revolute"', 'type="floating"')
    assert "damping of a floating joint" in converted(free).left_out
    without = 'xyz="0 1 0"', 'xyz="0 0 0"'  # of the axis, which urdfdom reads of no floating joint
    assert converted(free.replace(*without)).yaml == converted(free).yaml
    follows = free.replace("</joint>", '<mimic joint="pivot"/></joint>', 1)
    assert "mimicry of a floating joint" in converted(follows).left_out
    loop = PENDULUM.replace("</robot>", '<loop_joint name="l" type="revolute"/></robot>')
    assert "joint that closes a loop (<loop_joint>)" in converted(loop).left_out


def test_of_ties_all_that_is_wrong_is_told_and_once() -> None:
    text = """<mujoco><worldbody><body name="a"><joint/><inertial mass="1" pos="0 0 1" diaginertia="1 1 1"/></body>
</worldbody><equality>
<weld body1="a" body2="z" anchor="1 2"/>
<weld site1="q" site2="w" torquescale="x"/>
<weld body2="a"/>
</equality></mujoco>"""
    assert sorted(complaints_of(text), key=lambda x: x[::-1]) == [
        ("unknown-name", 3),
        ("wrong-shape", 3),
        ("bad-number", 4),
        ("unknown-name", 4),
        ("unknown-name", 4),
        ("missing-key", 5),
    ]


def test_what_looks_like_nothing_known_is_left_out_by_name() -> None:
    """It may be of a later MuJoCo; the same names in sections that are not read are nobody's business."""
    after = '<tendon><joint joint1="a" polycoef="1"/></tendon><sensor><geom obj="b"/></sensor>'
    made = converted(mujoco("", '<body name="b"><joint quux="1"/><geom size="0.5" density="6"/></body>', after))
    assert "unknown attribute 'quux' of <joint>" in made.left_out
    assert not any("polycoef" in one or "obj" in one for one in made.left_out)


# --- angles that are printed ---

#: Two turns of the fixed link; the second is no rounded part of pi.
TILTED = """<robot name="tilted"><link name="base"/>
<link name="a"><inertial><origin xyz="0 0.3 0"/><mass value="1"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><origin rpy="1.5708 0.2 -0.785398"/><parent link="base"/><child link="a"/>
  <axis xyz="0 1 0"/></joint></robot>"""


def angles_of(yaml: str, name: str) -> list[str]:
    system = system_of(yaml, "p.yaml")
    (body,) = [body for body in system.bodies if body.name == name]
    return [written(angle) for angle in body.rotation.angles]


def test_an_angle_that_is_read_as_a_part_of_pi_is_told_and_left_where_that_is_asked_for(tmp_path: Path) -> None:
    """1.5708 is pi/2 + 3.7e-6 and -0.785398 is -pi/4 + 1.6e-7, within half of their last digits; 0.2 is neither."""
    made = converted(TILTED)
    assert set(made.snapped) == {"1.5708 as pi/2", "-0.785398 as -pi/4"}
    assert "1.5708 as pi/2" in made.yaml.partition("mbsym:")[0]
    assert angles_of(made.yaml, "a frame 1") + angles_of(made.yaml, "a") == ["-pi/4", "0.2", "pi/2", "q1"]
    exact = converted(TILTED, exact_angles=True)
    assert exact.snapped == ()
    assert angles_of(exact.yaml, "a frame 1") + angles_of(exact.yaml, "a") == ["-0.785398", "0.2", "1.5708", "q1"]
    file = filed(tmp_path / "t.urdf", TILTED)
    assert "1.5708 as pi/2" in invoked("convert", file).stderr
    done = invoked("convert", file, "--angles", "exact", code=0)
    assert "1.5708" in done.stdout
    assert "as pi/2" not in done.stderr
    (tmp_path / "t.yaml").write_text(exact.yaml, encoding="utf-8")
    assert invoked("convert", tmp_path / "t.yaml", "--angles", "exact").exit_code == 2


def test_angles_of_mjcf_in_radians_are_told_and_those_in_degrees_are_exact() -> None:
    body = '<body name="b" euler="{} 0 0"><joint name="h" axis="0 1 0"/><geom size="0.1" pos="0 0 -1"/></body>'
    text = '<mujoco><compiler angle="{}"/><worldbody>{}</worldbody></mujoco>'
    assert converted(text.format("radian", body.format("0.7854"))).snapped == ("0.7854 as pi/4",)
    degrees = converted(text.format("degree", body.format("45")))
    assert (degrees.snapped, angles_of(degrees.yaml, "b")) == ((), ["pi/4", "q1"])


# --- frames ---

#: An arm in the plane with a massless flange, a camera on that, and a finger that moves nothing.
ARM = """<robot name="arm"><link name="base"/>
<link name="upper"><inertial><origin xyz="0 0 0.2"/><mass value="2"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0 0.1"/><mass value="1"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="tool0"/><link name="camera"><visual><geometry><box size="1 2 3"/></geometry></visual></link>
<link name="finger"/>
<joint name="s" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
<joint name="e" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0 0 0.4"/>
  <axis xyz="0 1 0"/></joint>
<joint name="t" type="fixed"><parent link="lower"/><child link="tool0"/><origin xyz="0 0 0.3"/></joint>
<joint name="c" type="fixed"><parent link="tool0"/><child link="camera"/><origin xyz="0.1 0 0"/></joint>
<joint name="f" type="revolute"><parent link="tool0"/><child link="finger"/><origin xyz="0 0 0.05"/></joint></robot>"""


def test_links_without_mass_are_frames_that_can_be_named() -> None:
    """A turn by q about axis 2 takes (x, 0, z) to (x cos q + z sin q, 0, z cos q - x sin q).

    So with p = q1 + q2 the flange is at x = 0.4 sin q1 + 0.3 sin p, the camera at z = 0.4 cos q1 + 0.3 cos p -
    0.1 sin p, and the finger, held at zero, at z = 0.4 cos q1 + 0.35 cos p.  The frames carry nothing:
    2 T = (2*0.2^2 + 0.1) q1'^2 + 0.4^2 q1'^2 + 2*0.4*0.1 cos q2 q1' p' + (0.1^2 + 0.1) p'^2.
    """
    made = converted(ARM)
    claims = (
        "{claim: position, of: tool0, component: 1, equals: 0.4*sin(q1) + 0.3*sin(q1 + q2)}",
        "{claim: position, of: camera, component: 3, equals: 0.4*cos(q1) + 0.3*cos(q1 + q2) - 0.1*sin(q1 + q2)}",
        "{claim: position, of: finger, component: 3, equals: 0.4*cos(q1) + 0.35*cos(q1 + q2)}",
        "{claim: position, of: tool0, component: 1, equals: 0.4*sin(q1) + 0.2*sin(q1 + q2)}",
        "{claim: angular velocity, of: camera, component: 2, equals: q1_dot + q2_dot}",
        "{claim: kinetic energy, equals: 0.09*q1_dot**2 + (0.16*q1_dot**2 + 0.08*cos(q2)*q1_dot*(q1_dot + q2_dot))/2"
        " + 0.055*(q1_dot + q2_dot)**2}",
    )
    analysis = mbsym.loads(made.yaml + "claims:\n" + "".join(f"  - {claim}\n" for claim in claims))
    assert [one.outcome for one in analysis.claims] == [
        Outcome.EXACT,
        Outcome.EXACT,
        Outcome.EXACT,
        Outcome.DIFFERS,
        Outcome.EXACT,
        Outcome.EXACT,
    ]
    assert made.still == ("f",)
    assert made.joints == ("s", "e")
    assert [body.name for body in analysis.system.bodies if body.shapes] == ["camera"]


SITES = """<mujoco><worldbody><site name="home" pos="0 0 1"/>
<body name="b"><joint name="h" type="hinge" axis="0 1 0"/><geom type="sphere" size="0.1" pos="0 0 -1"/>
  <site name="b" pos="0 0 -2"/><site pos="1 0 0"/>
  <body name="flag" pos="0 0 -3"><joint name="dead" type="hinge" axis="1 0 0"/></body></body></worldbody></mujoco>"""


def test_named_sites_and_bodies_without_mass_are_frames_and_other_sites_are_listed() -> None:
    """Turned by q1 about axis 2 the site at (0, 0, -2) is at x = -2 sin q1, the flag at x = -3 sin q1."""
    made = converted(SITES)
    assert "site without a name" in made.left_out
    text = (
        made.yaml + "claims:\n"
        "  - {claim: position, of: site b, component: 1, equals: -2*sin(q1)}\n"
        "  - {claim: position, of: flag, component: 1, equals: -3*sin(q1)}\n"
        "  - {claim: position, of: home, component: 3, equals: 1}\n"
    )
    assert [one.outcome for one in mbsym.loads(text).claims] == [Outcome.EXACT] * 3
    freed = system_of(converted(SITES, floating=True).yaml, "p.yaml")
    assert [body.name for body in freed.bodies if "x" in body.coordinates] == ["b frame 1"]
    assert (
        complaints_of('<mujoco><worldbody><site name="home" pos="0 0 1"/></worldbody></mujoco>')[0][0] == "missing-key"
    )


def test_angles_that_are_read_as_parts_of_pi_are_told_in_one_line(tmp_path: Path) -> None:
    """Five of them: a count and the first three on the terminal, all five in the description."""
    angles = ("1.5708", "0.7854", "-1.5708", "0.5236", "1.0472")
    parts = ("pi/2", "pi/4", "-pi/2", "pi/6", "pi/3")
    body = '<body name="b{0}"><joint name="q{0}" axis="0 0 1"/><geom size="1" mass="1" euler="{1} 0 0"/>'
    inside = "".join(body.format(k, angle) for k, angle in enumerate(angles)) + "</body>" * len(angles)
    file = filed(tmp_path / "r.xml", f'<mujoco><compiler angle="radian"/><worldbody>{inside}</worldbody></mujoco>')
    done = invoked("convert", file, "--out", tmp_path / "r.yaml")
    told = [line for line in done.stderr.split("\n") if "of pi" in line]
    assert len(told) == 1
    three = "1.5708 as pi/2, 0.7854 as pi/4, -1.5708 as -pi/2, ..."
    assert f"angles read as parts of pi (5): {three} (all are listed" in told[0]
    head = (tmp_path / "r.yaml").read_text(encoding="utf-8").partition("name:")[0]
    assert all(f"{angle} as {part}" in " ".join(head.split()) for angle, part in zip(angles, parts, strict=True))


@pytest.mark.parametrize("tag", ["replicate", "attach"])
def test_what_stands_for_other_elements_is_refused_with_what_to_do(tag: str) -> None:
    complaints = Complaints()
    inside = f'<{tag}><body name="b"><geom size="1" mass="1"/></body></{tag}>'
    assert convert(f"<mujoco><worldbody>{inside}</worldbody></mujoco>", complaints) is None
    (found,) = complaints.errors
    assert found.message.startswith(f"<{tag}> is not read: ")
    assert "mj_saveLastXML" in found.hint


# --- torques, rotors, joints that follow others, the ground ---


def outcomes(yaml: str, *claims: str) -> list[object]:
    return [one.outcome for one in mbsym.loads(yaml + "claims:\n" + "".join(f"  - {one}\n" for one in claims)).claims]


def test_every_joint_that_something_can_drive_has_its_torque_as_an_input() -> None:
    """The pendulum by hand: (J + m l^2) q'' + b q' + m g l sin q = tau, J + m l^2 = 0.1 + 2/4, m g l = 9.81.

    Its axes are turned about the vertical, which gravity does not feel.
    """
    made = converted(PENDULUM.replace('upper="2.5"', 'upper="2.5" effort="40"').replace("pivot&#10;x: y", "x-dot"))
    system = system_of(made.yaml, "p.yaml")
    (one,) = system.inputs
    assert (one.name, one.meaning) == ("tau_x_dot_joint", "torque in joint x-dot, at most 40 N*m")
    claim = "{{claim: equation of motion, of: q1, equals: 0.6*q1_ddot + 0.7*q1_dot + 9.81*sin(q1) {} tau_x_dot_joint}}"
    assert outcomes(made.yaml, claim.format("-"), claim.format("+")) == [Outcome.EXACT, Outcome.DIFFERS]
    assert "inputs:" not in converted(PENDULUM, inputs=False).yaml


def test_an_actuator_of_mjcf_drives_its_joint_and_others_stay_passive() -> None:
    body = '<body name="a"><joint name="j"/><joint name="k" axis="1 0 0"/><geom size="1"/></body>'
    actuators = '<actuator><position joint="k"/><motor joint="k" gear="9"/><motor site="s"/></actuator>'
    made = converted(mujoco("", body, actuators))
    system = system_of(made.yaml, "p.yaml")
    assert system.input_names == ("tau_k",)
    assert {"law of an actuator (position)", "actuator of no joint (motor)"} <= set(made.left_out)
    gear = "gear of an actuator (the input is the torque or force in the joint)"
    assert gear in made.left_out
    assert gear not in converted(mujoco("", body, '<actuator><motor joint="k" gear="1"/></actuator>')).left_out
    default = '<default><motor gear="9"/></default>'
    assert gear in converted(mujoco(default, body, '<actuator><motor joint="k"/></actuator>')).left_out


def test_angles_that_an_oblique_axis_needs_are_parts_of_pi_where_they_are() -> None:
    """(1, 1, 0) is the third axis turned by pi/2 about the second and by pi/4 about the third."""
    assert [words for _, words in turns_about(("1", "1", "0"), "q")] == ["pi/4", "pi/2", "q", "-pi/2", "-pi/4"]


def test_armature_is_a_term_of_the_mass_matrix_and_weighs_nothing() -> None:
    """2 T = (1/2^2 + 0.3) q1'^2 + ... for a point of mass 1 at the distance 1/2; U does not hold 0.3."""
    body = (
        '<body name="a"><joint name="j" axis="0 1 0" armature="0.3"/><inertial mass="1" pos="0 0 -0.5"/>'
        '<body name="b"><joint name="s" type="slide" axis="0 0 1" armature="0.7"/>'
        '<inertial mass="2" pos="0 0 0"/></body></body>'
    )
    made = converted(mujoco("", body))
    energy = "0.125*q1_dot**2 + q2**2*q1_dot**2 + q2_dot**2"
    assert outcomes(
        made.yaml,
        f"{{claim: kinetic energy, equals: {energy} + 0.15*q1_dot**2 + 0.35*q2_dot**2}}",
        f"{{claim: kinetic energy, equals: {energy}}}",
        "{claim: force function, equals: 9.81*(0.5*cos(q1) - 2*q2*cos(q1))}",
    ) == [Outcome.EXACT, Outcome.DIFFERS, Outcome.EXACT]
    assert not any("armature" in one for one in made.left_out)


def test_an_armature_is_an_inertia() -> None:
    hinge = '<body name="a"><joint armature="A"/><inertial mass="1" pos="0 0 1" diaginertia="1 1 1"/></body>'
    codes = [code for code, _ in complaints_of(mujoco("", hinge.replace("A", "-0.1")))]
    assert codes == ["impossible-inertia"]
    assert "armature" not in str(converted(mujoco("", hinge.replace("A", "0.1"))).left_out)


def test_a_joint_with_armature_alone_moves_by_its_rotor() -> None:
    """0.2 q'' + 3 q = 0 of a link without mass; one that has no rotor, either, is held still."""
    joint = '<body name="NAME"><joint name="JOINT" axis="0 1 0" stiffness="3" ROTOR/></body>'
    made = converted(
        mujoco(
            "",
            '<body name="a"><joint name="j" axis="0 1 0"/><inertial mass="1" pos="0 0 -0.5"/>'
            + joint.replace("NAME", "b").replace("JOINT", "k").replace("ROTOR", 'armature="0.2"')
            + joint.replace("NAME", "c").replace("JOINT", "l").replace("ROTOR", "")
            + "</body>",
        )
    )
    assert made.still == ("l",)
    assert outcomes(made.yaml, "{claim: kinetic energy, equals: 0.125*q1_dot**2 + 0.1*q2_dot**2}") == [Outcome.EXACT]


#: Two fingers on rails; the second one mimics the first, and a third one the second.
GRIPPER = """<robot name="gripper"><link name="world"/><link name="palm"/>
<link name="f1"><inertial><mass value="1"/></inertial></link>
<link name="f2"><inertial><mass value="2"/></inertial></link>
<link name="f3"><inertial><origin xyz="0 0 0.5"/><mass value="3"/></inertial></link>
<joint name="p" type="fixed"><parent link="world"/><child link="palm"/><origin xyz="0 0 1"/></joint>
<joint name="j1" type="prismatic"><parent link="palm"/><child link="f1"/><axis xyz="1 0 0"/>
  <limit lower="0" upper="0.1" effort="0" velocity="0"/></joint>
<joint name="j2" type="prismatic"><parent link="palm"/><child link="f2"/><axis xyz="0 1 0"/>
  <dynamics damping="5"/><mimic joint="j1" multiplier="-0.5" offset="0.25"/></joint>
<joint name="j3" type="revolute"><parent link="palm"/><child link="f3"/><axis xyz="0 1 0"/>
  <mimic joint="j2" multiplier="4"/></joint></robot>"""


def test_joints_that_mimic_others_follow_them() -> None:
    """q_2 = 1/4 - q/2 and q_3 = 4 q_2 = 1 - 2 q: 2 T = (1 + 2/4 + 3 (0.5*2)^2) q'^2 = 4.5 q'^2, R = 5 (q'/2)^2/2."""
    made = converted(GRIPPER)
    system = system_of(made.yaml, "p.yaml")
    assert (system.coordinates, made.joints, system.input_names) == (("q1",), ("j1",), ("tau_j1",))
    assert (
        outcomes(
            made.yaml,
            "{claim: kinetic energy, equals: 2.25*q1_dot**2}",
            "{claim: position, of: f2, component: 2, equals: 0.25 - q1/2}",
            "{claim: equation of motion, of: q1,"
            " equals: 4.5*q1_ddot + 1.25*q1_dot + 3*9.81*0.5*2*sin(1 - 2*q1) - tau_j1}",
        )
        == [Outcome.EXACT] * 3
    )
    assert not any("mimic" in one for one in made.left_out)
    limited = GRIPPER.replace('<dynamics damping="5"/>', '<dynamics damping="5"/><limit lower="0" upper="1"/>')
    assert "limits of a joint that mimics another" in converted(limited).left_out


def test_a_joint_that_only_leads_has_a_coordinate_and_one_that_follows_nothing_that_moves_is_at_its_offset() -> None:
    """The first finger without mass: 2 T = 3.5 q'^2.  A follower of the fixed joint stands at 1 + 2*0 all the time."""
    light = GRIPPER.replace('<inertial><mass value="1"/></inertial>', "")
    assert outcomes(converted(light).yaml, "{claim: kinetic energy, equals: 1.75*q1_dot**2}") == [Outcome.EXACT]
    fixed = GRIPPER.replace('<mimic joint="j2" multiplier="4"/>', '<mimic joint="p" multiplier="2" offset="1"/>')
    assert outcomes(converted(fixed).yaml, "{claim: position, of: f3, component: 1, equals: 0.5*sin(1)}") == [
        Outcome.EXACT
    ]
    assert "angles: [1]" in converted(fixed).yaml


@pytest.mark.parametrize(("leader", "code"), [("nobody", "unknown-name"), ("j2", "no-tree"), ("j3", "no-tree")])
def test_what_mimics_nothing_or_itself_is_complained_about(leader: str, code: str) -> None:
    text = GRIPPER.replace('<mimic joint="j1"', f'<mimic joint="{leader}"')
    assert {found for found, _ in complaints_of(text)} == {code}


def test_the_link_world_is_the_ground() -> None:
    system = system_of(converted(GRIPPER).yaml, "p.yaml")
    assert [(body.name, body.attached_to) for body in system.bodies][:1] == [("palm", "0")]
    floating = system_of(converted(GRIPPER, floating=True).yaml, "p.yaml")
    assert "world" in [body.name for body in floating.bodies]


def test_what_is_left_out_stands_in_the_description_that_every_report_begins_with() -> None:
    """The description is a part of reports; here they are asked in every form that has words."""
    analysis = mbsym.loads(converted(PENDULUM).yaml, problems=(1,))
    said = "Of the robot's file is left out: contact (<collision>); dry friction of a joint."
    assert analysis.system.description == said
    (header,) = TARGETS["c"].companions
    for target in (*(TARGETS[form] for form in ("latex", "html", "json", "python", "wolfram")), header):
        text = " ".join(html.unescape(str(target.render(analysis, (1,)))).split())
        assert "dry friction of a joint" in text, target.name


def test_a_joint_with_ref_has_it_as_its_coordinate_where_it_is_straight() -> None:
    """A point of mass 1 at the distance 1/2, turned by q1 - pi/6 out of the vertical; the slide is at q2 - 0.25."""
    body = (
        '<body name="a"><joint name="j" axis="0 1 0" ref="30"/><inertial mass="1" pos="0 0 -0.5"/>'
        '<body name="b"><joint name="s" type="slide" axis="1 0 0" ref="0.25"/>'
        '<inertial mass="2" pos="0 0 0"/></body></body>'
    )
    assert outcomes(
        converted(mujoco("", body)).yaml,
        "{claim: position, of: a, component: 3, equals: -cos(q1 - pi/6)/2}",
        "{claim: position, of: b, component: 1, equals: (q2 - 0.25)*cos(q1 - pi/6)}",
    ) == [Outcome.EXACT, Outcome.EXACT]


def test_the_total_mass_may_be_set() -> None:
    """Masses 1 and 3 become 2 and 6, and moments twice as large; with pi in them the sum stays a formula."""
    two = '<body name="a"><joint/><inertial mass="1" pos="0 0 0" diaginertia="0.2 0.2 0.2"/></body>' + (
        '<body name="b"><joint/><inertial mass="3" pos="0 0 0"/></body>'
    )
    text = mujoco('<compiler settotalmass="8"/>', two)
    system = system_of(converted(text).yaml, "x.yaml")
    assert [eval(written(body.mass)) for body in system.bodies] == [2, 6]
    assert system.bodies[0].inertia is not None
    assert eval(written(system.bodies[0].inertia.tensor[0][0])) == pytest.approx(0.4)
    assert masses(mujoco('<compiler settotalmass="8"/>', BALL)) != masses(mujoco("", BALL))
    assert not any("settotalmass" in one for one in converted(text).left_out)


def test_a_tensor_that_no_body_has() -> None:
    """3 > 1 + 1: MuJoCo refuses it, or with 'balanceinertia' takes the mean 5/3; in URDF it stands, and is told."""
    body = '<body name="a"><joint/><inertial mass="1" pos="0 0 0" diaginertia="1 1 3"/></body>'
    assert [code for code, _ in complaints_of(mujoco("", body))] == ["impossible-inertia"]
    full = body.replace('diaginertia="1 1 3"', 'fullinertia="1.4 1.4 1 1.2 0 0"')  # 2.6 > 1 + 0.2
    assert [code for code, _ in complaints_of(mujoco("", full))] == ["impossible-inertia"]
    balanced = converted(mujoco('<compiler balanceinertia="true"/>', body))
    assert not balanced.left_out
    system = system_of(balanced.yaml, "x.yaml")
    assert system.bodies[0].inertia is not None
    assert [eval(written(system.bodies[0].inertia.tensor[k][k])) for k in range(3)] == pytest.approx([5 / 3] * 3)


#: A frame turned by a right angle about z and moved along x; in it a body, and in that a frame with a geom and a site.
FRAMES = """<frame name="mount" pos="1 0 0" euler="0 0 90"><body name="b" pos="0 0 2"><joint name="h" axis="0 1 0"/>
<frame pos="0 0 -1"><geom name="g" type="sphere" size="0.1" mass="5"/><site name="tip" pos="0 0 -1"/>
<body name="c"><joint name="s" type="slide" axis="0 0 1"/><inertial mass="3" pos="0 0 0"/></body>
</frame></body></frame>"""


def test_what_stands_in_frames_is_placed_relative_to_them() -> None:
    """Turned by q1 about its axis 2, which is -x of space, the geom is at (1, 0, 2) + 1*(0, -sin q1, -cos q1)."""
    made = converted(mujoco("", FRAMES))
    assert (
        outcomes(
            made.yaml,
            "{claim: position, of: frame, component: 2, equals: -sin(q1)}",
            "{claim: position, of: frame, component: 1, equals: 1}",
            "{claim: position, of: tip, component: 3, equals: 2 - 2*cos(q1)}",
            "{claim: position, of: c, component: 2, equals: (q2 - 1)*sin(q1)}",
        )
        == [Outcome.EXACT] * 4
    )
    inside = FRAMES.replace("<site", '<joint name="x"/><site')
    assert complaints_of(mujoco("", inside))[0][0] == "unsupported"


def test_joints_and_points_that_are_tied_are_constraints() -> None:
    """y - pi/6 = 1/2 + 2 (x - 1/4)^2 between the joints; (0, 0, -1) of body a is 1.5 above body b, hung at 2.5."""
    bodies = (
        '<body name="a"><joint name="y" axis="0 1 0" ref="30"/><inertial mass="1" pos="0 0 -1"/></body>'
        '<body name="b" pos="0 0 -2.5"><joint name="x" type="slide" axis="1 0 0" ref="0.25"/>'
        '<inertial mass="1" pos="0 0 0"/></body>'
    )
    after = (
        '<equality><joint joint1="y" joint2="x" polycoef="0.5 0 2"/><connect body1="a" body2="b" anchor="0 0 -1"/>'
        '<connect body1="a" anchor="0 0 -1" active="false"/><tendon tendon1="t"/></equality>'
    )
    made = converted(mujoco("", bodies, after))
    system = system_of(made.yaml, "p.yaml")
    relation, coincide = system.constraints
    assert isinstance(relation, Relation)
    assert isinstance(coincide, Coincide)
    assert (written(relation.left), written(relation.right)) == ("q1 - pi/6", "0.5 + 2*(q2 - 0.25)**2")
    assert [written(x) for x in coincide.second.position] == ["0", "0", "1.5"]
    assert {"inactive constraint (<connect>)", "constraint (<tendon> in <equality>)"} <= set(made.left_out)
    assert any("softness" in one for one in made.left_out)
    assert complaints_of(mujoco("", bodies, '<equality><joint joint1="z"/></equality>'))[0][0] == "unknown-name"


def test_files_beside_are_included_and_no_others(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    inside = '<mujocoinclude><body name="b"><joint/><geom size="0.5" density="6"/></body></mujocoinclude>'
    (tmp_path / "parts" / "b.xml").write_text(inside, encoding="utf-8")
    file = tmp_path / "r.xml"
    text = '<mujoco>\n<worldbody><include file="{}"/></worldbody></mujoco>'
    file.write_text(text.format("parts/b.xml"), encoding="utf-8")
    done = invoked("convert", file, code=0)
    assert "pi*1" in done.stdout
    (tmp_path / "parts" / "b.xml").write_text(inside.replace("density", "densty"), encoding="utf-8")
    done = invoked("convert", file, code=2)
    assert "r.xml:2:" in done.stderr
    secret = filed(tmp_path.parent / f"{tmp_path.name}.xml", inside)
    for name in (f"../{secret.name}", str(secret), "missing.xml"):
        file.write_text(text.format(name), encoding="utf-8")
        done = invoked("convert", file, code=2)
        assert "<include> is not read" in done.stderr


def test_coordinates_may_be_called_as_the_joints() -> None:
    """Letters, digits and single underscores; a name that means something else, or stands twice, stays a number."""
    inertia = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    links = "".join(f'<link name="{x}">{inertia}</link>' for x in "abcde")
    named = [("0", "a", "lambda"), ("a", "b", "hip-1"), ("b", "c", "hip 1"), ("c", "d", "q1"), ("d", "e", "knee_dot")]
    joints = "".join(
        f'<joint name="{name}" type="revolute"><parent link="{"base" if at == "0" else at}"/><child link="{link}"/>'
        '<axis xyz="0 0 1"/><dynamics damping="0.1"/></joint>'
        for at, link, name in named
    )
    robot = f'<robot name="r"><link name="base"/>{links}{joints}</robot>'
    made = converted(robot, joint_names=True, symbols=True)
    system, complaints = read(made.yaml, "r.yaml")
    assert not complaints.items
    assert system is not None
    assert system.coordinates == ("q1", "hip_1", "q3", "q4", "q5")
    assert {"b1", "b2", "b5"} <= {*system.parameter_names}  # dampers are numbered as before
    plain = system_of(converted(robot, symbols=True).yaml, "r.yaml")
    assert plain.coordinates == ("q1", "q2", "q3", "q4", "q5")


def test_states_limits_and_actuators_that_have_no_place_are_listed_and_what_is_not_known_is_refused() -> None:
    inertial = '<inertial pos="0 0 1" mass="1" diaginertia="1 1 1"/>'
    ball = f'<body name="b"><joint name="j" type="ball" range="0 1"/>{inertial}</body>'
    key = '<keyframe><key qpos="1 0 0 0"/></keyframe>'
    assert converted(mujoco("", ball, key)).left_out == ("limit of a ball joint", "state to begin in (<key>)")
    motor = '<actuator><motor joint="j" damping="1"/></actuator>'
    hinge = ball.replace('type="ball" range="0 1"', "")
    assert converted(mujoco("", hinge, motor)).left_out == ("armature and damping of an actuator",)
    for wrong in ('<joint stiffness="1 2 3"/><inertial', '<geom type="box" mesh="m" size="1 1 1"/><joint/><none'):
        assert [code for code, _ in complaints_of(mujoco("", f"<body>{wrong} pos='0 0 0' mass='1'/></body>"))] == [
            "unsupported", *["wrong-shape"] * ("stiffness" in wrong)
        ]  # fmt: skip


def test_limits_that_a_description_has_no_place_for_are_listed() -> None:
    """How fast a joint may turn says nothing of its dynamics; limits upside down exclude every position."""
    limits = '<axis xyz="0 1 0"/><limit lower="{}" upper="{}" effort="1" velocity="{}"/>'
    robot = (
        '<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
        '<joint name="j" type="revolute"><parent link="a"/><child link="b"/>LIMITS</joint></robot>'
    )
    fast, unread, upside_down = (
        converted(robot.replace("LIMITS", limits.format(*x))).left_out for x in ((-1, 1, 3), (-1, 1, "inf"), (1, -1, 0))
    )
    assert fast == unread == ("limit of the velocity of a joint",)  # a number that is not used may be any
    assert upside_down == ("limits of a joint that exclude every position, or all but one",)
