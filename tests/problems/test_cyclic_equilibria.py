"""Steady motions that may be turned about an axis are one: counted up to the cyclic angle, against hand calculation."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import permutations

import numpy as np
import pytest
from conftest import SHIPPED, TESTS

import mbsym
from mbsym.mechanics.rest import given_values
from mbsym.problems.relative_equilibria.equilibria import Equilibria, RelativeEquilibrium, equilibria

FRAME = """
mbsym: 1
name: Body in a rotating frame
parameters: {{W: 2, A: 4, B: 5, C: 6, h: {h}}}
prescribed: {{chi: {{rate: W}}}}
bodies:
  - {{name: frame, attached to: 0, rotation: {{axes: [3], angles: [chi]}}, mass: 0}}
  - name: body
    attached to: frame
    rotation: {{axes: [{axes}], angles: [psi, theta, phi]}}
    mass: 1
    inertia about: mass centre
    inertia: [A, B, C]
    gyrostatic moment: [0, 0, h]
"""


def at(text: str, **values: str) -> Equilibria:
    system = mbsym.loads(text).system
    return equilibria(system, given_values(system, {name: Fraction(x) for name, x in values.items()}))


def seen_axis(one: RelativeEquilibrium, described: tuple[int, int, int]) -> tuple[float, ...]:
    """Axis 3 of the frame in the axes of the body."""
    axes = described
    if one.coordinates_of:
        axes = eval(one.coordinates_of.removeprefix("body ").replace("{", "(").replace("}", ")"))
    values = {item.name: item.value for item in one.values}
    n = np.array([0.0, 0.0, 1.0])
    for axis, name in zip(axes, ("psi", "theta", "phi"), strict=True):
        i, j = axis % 3, (axis + 1) % 3
        c, s = math.cos(values.get(name, 0.7)), math.sin(values.get(name, 0.7))
        n[i], n[j] = c * n[i] + s * n[j], c * n[j] - s * n[i]
    return tuple(float(round(x, 9)) + 0.0 for x in n)


SEQUENCES = [*list(permutations((1, 2, 3), 3)), (3, 1, 3), (3, 2, 3), (1, 3, 1), (2, 1, 2), (1, 2, 1)]


@pytest.mark.parametrize("axes", SEQUENCES, ids=str)
def test_a_free_body_has_six_permanent_rotations(axes: tuple[int, int, int]) -> None:
    """n x J n = 0 has the six solutions +-e_i; the angle about the axis of the frame is any."""
    found = at(FRAME.format(h=0, axes=", ".join(map(str, axes))))
    assert found.complete
    assert not found.families
    assert not found.singular
    directions = {seen_axis(one, axes): one.verdict.word for one in found.equilibria}
    assert len(found.equilibria) == 6
    assert set(directions) == {tuple(s * float(i == k) + 0.0 for i in range(3)) for k in range(3) for s in (1, -1)}
    for n, word in directions.items():
        assert (word == "unstable") == (n[1] != 0), "about the middle axis, and only there"


@pytest.mark.parametrize("axes", [(3, 1, 3), (1, 2, 3), (3, 2, 1)], ids=str)
@pytest.mark.parametrize(("h", "count"), [("1", 6), ("3", 4), ("9", 2)])
def test_a_gyrostat_in_a_rotating_frame(axes: tuple[int, int, int], h: str, count: int) -> None:
    """n x (W J n + h e3) = 0: +-e3; n2 = 0, n3 = h/(W (A - C)); n1 = 0, n3 = h/(W (B - C)), where less than 1."""
    found = at(FRAME.format(h=h, axes=", ".join(map(str, axes))))
    expected = {(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)}
    for place, moment in ((0, 4), (1, 5)):
        along = float(Fraction(h) / (2 * (moment - 6)))
        if abs(along) < 1:
            for sign in (1, -1):
                n = [0.0, 0.0, along]
                n[place] = sign * math.sqrt(1 - along**2)
                expected.add((round(n[0], 9), round(n[1], 9), round(n[2], 9)))
    assert len(expected) == count
    assert {seen_axis(one, axes) for one in found.equilibria} == expected
    assert found.complete
    assert not found.families


def test_the_rests_of_the_shipped_gyrostat_by_a_secular_equation() -> None:
    """n x (M g r - N J n) = 0 at rest: n_i = M g r_i/(x + N J_i) with |n| = 1, an equation of degree 6 in x."""
    a = mbsym.load(SHIPPED / "gyrostat.yaml")
    found = a.equilibria
    scale = 3 * 9.81 / 3.924
    weight, moments = 9.81 * np.array([0.02, 0.03, 0.06]), scale * np.array([0.02, 0.021, 0.03])
    squares = [np.poly1d([1, x]) ** 2 for x in moments]
    secular = squares[0] * squares[1] * squares[2]
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        secular = secular - squares[j] * squares[k] * float(weight[i] ** 2)
    roots = [r.real for r in secular.roots if abs(r.imag) < 1e-9]
    expected = sorted(tuple(float(y) for y in np.round(weight / (x + moments), 6)) for x in roots)
    assert found.complete
    assert not found.families
    seen = []
    for one in found.equilibria:
        assert one.free == ("psi",)
        theta, phi = (next(item.value for item in one.values if item.name == name) for name in ("theta", "phi"))
        n = (math.sin(theta) * math.sin(phi), math.sin(theta) * math.cos(phi), math.cos(theta))
        seen.append(tuple(round(x, 6) for x in n))
    assert sorted(seen) == expected


SPHERICAL = """
mbsym: 1
name: Spherical pendulum in a rotating frame
parameters: {g: 10, l: 1, W: 4}
prescribed: {chi: {rate: W}}
bodies:
  - {name: frame, attached to: 0, rotation: {axes: [3], angles: [chi]}, mass: 0}
  - name: rod
    attached to: frame
    rotation: {axes: [3, 1], angles: [psi, theta]}
    coordinates: [psi, theta]
    mass: 1
    mass centre: [0, 0, -l]
loads:
  - uniform gravity: {vector: [0, 0, -g]}
"""


@pytest.mark.parametrize(
    "change",
    [("", ""), ("[3, 1]", "[1, 2]"), ("[psi, theta]}", "[-psi, pi/2 - theta]}")],
    ids=["3, 1", "1, 2", "signs"],
)
def test_a_spherical_pendulum_in_a_rotating_frame(change: tuple[str, str]) -> None:
    """Down, up, and one cone cos = g/(l W^2), whatever the azimuth."""
    found = at(SPHERICAL.replace(*change) if change[0] else SPHERICAL)
    assert found.complete
    assert not found.families
    assert not found.singular
    assert len(found.equilibria) == 3
    (cone,) = [one for one in found.equilibria if one.free]
    tilt = next(item.value for item in cone.values if item.name == "theta")
    tilt = math.pi / 2 - tilt if "pi/2" in change[1] else tilt
    assert math.cos(tilt) == pytest.approx(10 / 16)
    assert len(at(SPHERICAL, W="3").equilibria) == 2, "too slow for a cone: 10 > 9"


def test_a_tilted_zero_of_an_angle_hides_no_rest() -> None:
    """A top hangs or stands where the angle theta - pi/6 is pi or 0."""
    found = mbsym.load(TESTS / "cases" / "statements" / "toptilt.yaml").equilibria
    assert found.complete
    assert not found.singular
    tilts = {
        one.verdict.word.split(" ")[0]: next(item.text for item in one.values if item.name == "theta")
        for one in found.equilibria
    }
    assert tilts == {"stable": "-5*pi/6", "unstable": "pi/6"}


DEPENDENT = """
mbsym: 1
name: Damping that depends on the place
parameters: {m: 1, k: 1}
bodies:
  - {name: block, attached to: 0, connection point: [x, y, 0], mass: m, coordinates: [x, y]}
loads:
  - spring: {coordinate: y, stiffness: k}
  - rayleigh: (1 + x)*y_dot**2/2
"""


def test_a_verdict_at_one_place_is_not_said_of_all() -> None:
    """y = 0 is an equilibrium for every x, with friction for x > -1 and without a brake below.

    L does not contain x, but the friction does: x is not cyclic, and drifts out of every region of friction.
    """
    (one,) = at(DEPENDENT).equilibria
    assert one.free == ("x",)
    assert one.verdict.word == "undecided"
    assert "growing solutions" in one.verdict.explanation
