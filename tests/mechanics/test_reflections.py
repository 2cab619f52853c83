"""Negative lengths of polar coordinates: the same places described twice, or states that are not meant."""

from __future__ import annotations

from fractions import Fraction

import pytest
from click.testing import CliRunner
from conftest import SHIPPED

import mbsym
from mbsym.mechanics.rest import at_numbers, given_values, rest
from mbsym.mechanics.symmetry import reflections
from mbsym.problems.relative_equilibria.equilibria import Equilibria, equilibria
from mbsym.studies.equilibria import STUDY
from mbsym_cli.study import command_of

TURNED = """
mbsym: 1
name: Spring pendulum
parameters: {m: 1, k: 40, l0: 1/10, g: 10}
bodies:
  - {name: arm, attached to: 0, rotation: {axes: [3], angles: [theta]}, mass: 0}
  - {name: bob, attached to: arm, connection point: [0, -r, 0], mass: m, coordinates: [r]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - spring: {coordinate: r, stiffness: k, rest: l0}
"""
CARTESIAN = """
mbsym: 1
name: Spring pendulum without a rotation
parameters: {m: 1, k: 40, l0: 1/10, g: 10}
bodies:
  - name: bob
    attached to: 0
    connection point: [r*sin(theta), -r*cos(theta), 0]
    mass: m
    coordinates: [r, theta]
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - spring: {coordinate: r, stiffness: k, rest: l0}
"""
SPATIAL = (
    TURNED.replace("axes: [3], angles: [theta]", "axes: [1, 2], angles: [phi, theta]")
    .replace("[0, -r, 0]", "[0, 0, -r]")
    .replace("[0, -1, 0]", "[0, 0, -1]")
)
MASSIVE = TURNED.replace("mass: 0}", "mass: 1, inertia about: joint, inertia: [1, 1, 1]}")


def at(text: str, **values: str) -> Equilibria:
    system = mbsym.loads(text).system
    return equilibria(system, given_values(system, {name: Fraction(x) for name, x in values.items()}))


def lengths(found: Equilibria) -> list[float]:
    return [next(item.value for item in one.values if item.name == "r") for one in found.equilibria]


@pytest.mark.parametrize("text", [TURNED, CARTESIAN, SPATIAL], ids=["turned", "cartesian", "spatial"])
def test_a_spring_does_not_push_through_its_pivot(text: str) -> None:
    """m g > k l0: only hanging is an equilibrium, at r = l0 + m g/k; standing at l0 - m g/k < 0 is none."""
    found = at(text)
    assert lengths(found) == [pytest.approx(0.1 + 10 / 40)]
    assert [one.verdict.word for one in found.equilibria] == ["stable"]
    assert [one.beyond for one in found.beyond] == [("r",)]
    # With m g < k l0 it stands, and topples.
    found = at(text, l0="1")
    assert sorted(lengths(found)) == [pytest.approx(1 - 10 / 40), pytest.approx(1 + 10 / 40)]
    assert found.beyond == ()


@pytest.mark.parametrize("text", [TURNED, CARTESIAN, SPATIAL], ids=["turned", "cartesian", "spatial"])
def test_a_spring_without_length_has_one_rest(text: str) -> None:
    """k r^2/2 knows no sign of r: r, theta and -r, theta + pi are one configuration."""
    found = at(text.replace("rest: l0", "rest: 0"))
    assert lengths(found) == [pytest.approx(10 / 40)]
    assert found.equilibria[0].described >= 2
    assert found.beyond == ()


def test_an_arm_that_has_a_mass_itself_may_be_passed() -> None:
    """Half a turn of the arm is another configuration: a bead on the other side of the pivot is where it says.

    m g r sin = 0 and m g cos = k (r - l0): sin = 0, or r = 0 with cos = -k l0/(m g), twice.
    """
    found = at(MASSIVE)
    assert sorted(lengths(found)) == [pytest.approx(-0.15), 0, 0, pytest.approx(0.35)]
    assert found.beyond == ()


def test_polar_coordinates_are_recognised() -> None:
    def pairs(text: str) -> list[tuple[str, str, bool]]:
        system = mbsym.loads(text).system
        found = rest(at_numbers(system, given_values(system, {})))
        return [(x.length, x.angle, x.same_forces) for x in reflections(found)]

    assert pairs(TURNED) == [("r", "theta", False)]
    assert pairs(SPATIAL) == [("r", "theta", False)]
    assert pairs(TURNED.replace("rest: l0", "rest: 0")) == [("r", "theta", True)]
    assert pairs(MASSIVE) == []


def test_the_command_says_what_is_left_out() -> None:
    result = CliRunner().invoke(command_of(STUDY), [str(SHIPPED / "spring-pendulum.yaml"), "--set", "l0=0.1"])
    assert result.exit_code == 0
    assert "1 relative equilibrium: 1 stable" in result.output
    assert "1 more solution with r < 0, not counted" in result.output
    assert "complete apart from the solutions below that are not counted" in result.output
