"""Motion in a plane that is none of the coordinates': a symmetric body on a ball joint, swung about a slanting axis."""

from __future__ import annotations

import numpy as np
import pytest

import mbsym
from mbsym.algebra.certainty import Certainty
from mbsym.numerics.ledger.table import skew_plane
from mbsym.numerics.ledger.work import AccuracyGoal, Work
from mbsym.numerics.planning.kinds import Kind

#: Hangs straight down at first, and is turned at the rate 3 about (0.6, 0.8, 0).
SWUNG = """
mbsym: 1
name: A body of revolution on a ball joint
parameters: {m: positive, J: positive, C: positive, L: positive, g: positive}
bodies:
  - {name: body, attached to: 0, rotation: {axes: [1, 2, 3], angles: [a, b, c]}, mass: m, mass centre: [0, 0, -L],
     inertia about: mass centre, inertia: [[J, 0, 0], [0, J, 0], [0, 0, C]]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, 0, -1]}
values: {m: 1, J: 0.2, C: 0.1, L: 1, g: 9.81}
initial: {a: {position: 0, velocity: 1.8}, b: {position: 0, velocity: 2.4}, c: {position: 0, velocity: 0}}
"""

#: The same with no inertia of its own, on two angles: its rod twists, which no mass feels.
POINT = (
    SWUNG.replace("axes: [1, 2, 3], angles: [a, b, c]", "axes: [1, 2], angles: [a, b]")
    .replace(",\n     inertia about: mass centre, inertia: [[J, 0, 0], [0, J, 0], [0, 0, C]]", "")
    .replace(", c: {position: 0, velocity: 0}", "")
    .replace(" J: positive, C: positive,", "")
    .replace(" J: 0.2, C: 0.1,", "")
)


def directions(text: str, time: float = 3.0) -> list[str]:
    found = list(skew_plane(Work(mbsym.loads(text, ()), goal=AccuracyGoal(1e-6, time))))
    assert all((item.kind, item.how) == (Kind.SKEW, Certainty.VERIFIED) for item in found)
    return [item.why for item in found]


@pytest.mark.parametrize("text", [SWUNG, POINT], ids=["body", "point"])
def test_a_plane_that_no_coordinate_shows_is_found(text: str) -> None:
    (why,) = directions(text)
    inside = why[why.index("(") + 1 : why.index(")")]
    np.testing.assert_allclose([float(x) for x in inside.split(",")], [0.6, 0.8, 0], atol=1e-6)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("c: {position: 0, velocity: 0}", "c: {position: 0, velocity: 0.01}"),  # it spins: gyroscopic moments
        ("[0, J, 0]", "[0, 5*J/4, 0]"),  # no body of revolution: the axis is no principal one
        ("direction: [0, 0, -1]", "direction: [3/5, 0, -4/5]"),  # its weight is not in the plane
    ],
)
def test_what_leaves_the_plane_is_not_listed(old: str, new: str) -> None:
    assert old in SWUNG
    assert directions(SWUNG.replace(old, new)) == []


def test_a_plane_of_the_coordinates_is_no_skew_one() -> None:
    assert directions(SWUNG.replace("velocity: 1.8", "velocity: 0")) == []


def test_without_a_time_nothing_is_said() -> None:
    assert list(skew_plane(Work(mbsym.loads(SWUNG, ())))) == []
