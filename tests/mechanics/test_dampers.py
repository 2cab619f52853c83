"""Dampers between two points: along their line (an internal force, which makes no couple), and the isotropic one."""

from __future__ import annotations

from itertools import product
from typing import Any

import pytest
from conftest import system_of

import mbsym
from mbsym.analysis import Analysis, Unavailable
from mbsym.mechanics.loads.kinds import generalized_forces
from mbsym.problems.checks import EXACT
from mbsym.source.document import read
from mbsym.source.text_writer import to_text
from mbsym.source.yaml_writer import to_yaml

ENDS = "[{body: A, point: [0, 0, 0]}, {body: B, point: [0, 0, 0]}]"
DUMBBELL = """
mbsym: 1
name: Two free masses and what joins them
parameters: {{m: positive, M: positive, c: positive, l: positive}}
bodies:
  - {{name: A, attached to: 0, connection point: [x1, y1, z1], mass: m, coordinates: [x1, y1, z1]}}
  - {{name: B, attached to: 0, connection point: [x2, y2, z2], mass: M, coordinates: [x2, y2, z2]}}
loads:
  - {damper}: {{between: {ends}, coefficient: c}}
motion: {{x2: l}}
"""

#: Bodies that turn, and ends off their connection points; the second hangs on the first.
ROTATING = """
mbsym: 1
name: Two links with a damper between points of theirs
parameters: {{m: positive, M: positive, J: positive, c: positive, a: positive, l: positive, h: real}}
bodies:
  - name: upper
    attached to: 0
    rotation: {{axes: [1, 3], angles: [phi, theta]}}
    connection point: [x, 0, h]
    mass centre: [0, -a, 0]
    mass: m
    inertia about: mass centre
    inertia: [J, J, J]
    coordinates: [x, phi, theta]
  - name: lower
    attached to: upper
    rotation: {{axes: [3], angles: [psi]}}
    connection point: [0, -l, 0]
    mass centre: [0, -a, a]
    mass: M
    coordinates: [psi]
loads:
  - {damper}: {{between: [{{body: {first}, point: [a, 0, 0]}}, {{body: lower, point: [0, -a, h]}}], coefficient: c}}
motion: {{x: 0}}
"""


def dumbbell(damper: str) -> Analysis:
    return mbsym.loads(DUMBBELL.format(damper=damper, ends=ENDS))


def in_ring(analysis: Analysis) -> tuple[dict[str, Any], dict[str, Any]]:
    """(generalised forces, every name as its generator)."""
    return generalized_forces(analysis.scene), analysis.scene.environment


def test_a_damper_along_the_line_makes_no_couple_and_takes_the_power_of_the_changing_distance():
    analysis = dumbbell("damper")
    forces, name = in_ring(analysis)
    ring = analysis.ring
    r = [name[f"{axis}2"] - name[f"{axis}1"] for axis in "xyz"]
    v = [name[f"{axis}2_dot"] - name[f"{axis}1_dot"] for axis in "xyz"]
    for index, first, second in ((0, "y", "z"), (1, "z", "x"), (2, "x", "y")):  # dH/dt = sum of r x F
        torque = sum(
            (name[f"{first}{end}"] * forces[f"{second}{end}"] - name[f"{second}{end}"] * forces[f"{first}{end}"])
            for end in (1, 2)
        )
        assert ring.is_zero(torque), index
        assert ring.is_zero(forces[f"{'xyz'[index]}1"] + forces[f"{'xyz'[index]}2"])
    power = sum((forces[one] * name[one + "_dot"] for one in forces), ring.zero)
    distance_rate_squared = ring.dot(r, v) * ring.dot(r, v) * ring.reciprocal(ring.dot(r, r))  # d' = r.v/d
    assert ring.is_zero(power + name["c"] * distance_rate_squared)
    assert not ring.is_zero(power)


def test_an_isotropic_damper_takes_the_power_of_all_relative_motion():
    analysis = dumbbell("isotropic damper")
    forces, name = in_ring(analysis)
    v = [name[f"{axis}2_dot"] - name[f"{axis}1_dot"] for axis in "xyz"]
    power = sum((forces[one] * name[one + "_dot"] for one in forces), analysis.ring.zero)
    assert analysis.ring.is_zero(power + name["c"] * analysis.ring.dot(v, v))
    torque = sum(name[f"x{end}"] * forces[f"y{end}"] - name[f"y{end}"] * forces[f"x{end}"] for end in (1, 2))
    assert not analysis.ring.is_zero(torque)  # the couple that its name warns of


def test_the_linear_forms_of_the_two_dampers():
    # At the distance l along axis 1 only the first components of the velocities change it.
    along, isotropic = (dumbbell(kind).linearisation.D for kind in ("damper", "isotropic damper"))
    for row, column in product(range(6), repeat=2):
        same = row % 3 == column % 3
        value = "0" if not same else "c" if row == column else "-c"
        assert str(isotropic[row, column]) == value
        assert str(along[row, column]) == (value if row % 3 == 0 else "0")


@pytest.mark.parametrize("damper", ["damper", "isotropic damper"])
@pytest.mark.parametrize("first", ["0", "upper"])
def test_two_routes_agree_for_dampers_on_turning_bodies(damper: str, first: str) -> None:
    analysis = mbsym.loads(ROTATING.format(damper=damper, first=first))
    checks = {check.name: check.outcome for check in analysis.checks}
    assert checks["equations of motion"] == EXACT
    assert checks["linearisation"] == EXACT


def test_points_on_one_axis_may_pass_each_other():
    text = """
mbsym: 1
name: Two carts on one rail
parameters: {m: positive, c: positive}
bodies:
  - {name: A, attached to: 0, connection point: [x1, 0, 0], mass: m, coordinates: [x1]}
  - {name: B, attached to: 0, connection point: [x2, 0, 0], mass: m, coordinates: [x2]}
loads:
  - damper: {between: %s, coefficient: c}
motion: {x1: 0, x2: 0}
"""
    analysis = mbsym.loads(text % ENDS)
    assert [[str(analysis.linearisation.D[i, j]) for j in range(2)] for i in range(2)] == [["c", "-c"], ["-c", "c"]]
    checks = {check.name: check.outcome for check in analysis.checks}
    assert checks["equations of motion"] == checks["linearisation"] == EXACT


def test_meeting_points_have_no_line_and_that_is_said():
    text = DUMBBELL.format(damper="damper", ends=ENDS).replace("motion: {x2: l}", "motion: {x1: 0}")
    analysis = mbsym.loads(text)
    assert str(analysis.equations.mass_matrix[0, 0]) == "m"
    with pytest.raises(Unavailable, match="the points of a damper coincide"):
        analysis.linearisation  # noqa: B018
    _, complaints = read(text.replace("body: B", "body: A"))
    assert [one.code for one in complaints.errors] == ["coinciding-points"]


def test_the_meaning_is_told_where_the_key_is_used():
    text = DUMBBELL.format(damper="damper", ends=ENDS)
    system, complaints = read(text)
    assert system is not None
    (told,) = complaints.items
    assert (told.code, told.severity) == ("damper-along-line", "warning")
    assert told.span is not None
    assert text.split("\n")[told.span.line - 1][told.span.column - 1 :].startswith("between")
    assert "'isotropic damper'" in (told.hint or "")
    followed, complaints = read(text.replace("- damper", "- isotropic damper"))
    assert followed is not None
    assert not complaints.items


@pytest.mark.parametrize("damper", ["damper", "isotropic damper"])
@pytest.mark.parametrize("write", [to_text, to_yaml])
def test_both_spellings_keep_the_two_dampers_apart(damper: str, write: Any) -> None:
    system = system_of(DUMBBELL.format(damper=damper, ends=ENDS))
    again, complaints = read(write(system))
    assert again == system
    assert not complaints.errors
