"""Initial states in declared variables: the coordinates that belong to them, and what is given twice."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest

import mbsym
from mbsym.mechanics.frames import product as turned
from mbsym.numerics.scenario import Incomplete, scenario
from mbsym.numerics.states import StateDynamics, in_coordinates, scenario_in_states
from mbsym.source import to_yaml
from mbsym.source.yaml_writer import meaning

BODY = """
mbsym: 1
name: Free rigid body
parameters: {{A: positive, B: positive, C: positive}}
values: {{A: 2, B: 3, C: 4}}
bodies:
  - name: body
    attached to: 0
    rotation: {{axes: {axes}, angles: [a, b, c]}}
    mass: 0
    inertia about: joint
    inertia: [A, B, C]
    speeds: {{p: omega1, q: omega2, r: omega3}}
    orientation: {orientation}
initial: {initial}
"""


def described(initial: str, axes: str = "[3, 1, 3]", orientation: str = "{e: quaternion}") -> mbsym.Analysis:
    return mbsym.loads(BODY.format(axes=axes, orientation=orientation, initial=initial), (3,))


SEQUENCES = [axes for axes in product((1, 2, 3), repeat=3) if axes[0] != axes[1] != axes[2]]


@pytest.mark.parametrize("axes", SEQUENCES, ids=str)
def test_angles_and_rates_belong_to_the_state_for_every_sequence_of_axes(axes: tuple[int, int, int]) -> None:
    """There and back: e and w of the angles and rates that were found for them are those that were given."""
    system = described("{e0: 1/2, e1: -1/2, e2: 7/10, e3: 1/10, p: 1, q: -2, r: 3}", str(list(axes))).system
    found = scenario(system)
    q, v = (dict(zip(system.coordinates, map(float, x), strict=True)) for x in (found.positions, found.velocities))
    again = described(
        "{" + ", ".join(f"{x}: {{position: {q[x]!r}, velocity: {v[x]!r}}}" for x in system.coordinates) + "}",
        str(list(axes)),
    )
    run = mbsym.simulate(again, 1e-9, samples=2, estimate=False)
    e = np.array([run[f"e{k}"][0] for k in range(4)])
    given = np.array([0.5, -0.5, 0.7, 0.1])
    assert min(np.max(np.abs(e - given)), np.max(np.abs(e + given))) < 1e-13
    assert [run[x][0] for x in "pqr"] == pytest.approx([1, -2, 3], abs=1e-12)


@pytest.mark.parametrize("axes", [(3, 1, 3), (1, 2, 3), (2, 1, 3), (2, 3, 2)], ids=str)
def test_rows_as_coordinates_have_the_same_orientation_where_angles_are_singular_too(axes: tuple[int, ...]) -> None:
    """There and back through the elementary turns, at 1, at half turns and between."""
    start = "{e0: 1, e1: 0, e2: 0, e3: 0, p: 0, q: 0, r: 0}"
    dynamics = StateDynamics(scenario_in_states(scenario(described(start, str(list(axes))).system, declared=True)))
    half = math.sqrt(0.5)
    given = [
        (1, 0, 0, 0),
        (half, half, 0, 0),
        (half, 0, half, 0),
        (half, 0, 0, -half),
        (0, 1, 0, 0),
        (0.5, -0.5, 0.7, 0.1),
    ]
    for e in given:
        (q,) = in_coordinates(dynamics, np.array([[*e, 0, 0, 0]]).T).T
        found = np.array([1.0, 0, 0, 0])
        for axis, angle in zip(axes, q, strict=True):
            turn = [math.cos(angle / 2), *(math.sin(angle / 2) * (axis == k) for k in (1, 2, 3))]
            found = np.array(turned(found, turn))
        assert min(np.max(np.abs(found - e)), np.max(np.abs(found + e))) < 1e-14


def test_a_run_begins_where_angles_are_singular() -> None:
    """At theta = 0 of {3, 1, 3}: about axis 2 of the body, e = (cos w t/2, 0, sin w t/2, 0)."""
    start = "{e0: 1, e1: 0, e2: 0, e3: 0, p: 0, q: 2, r: 0}"
    run = mbsym.simulate(described(start), 1.0, samples=5, tolerance=1e-13, estimate=False)
    assert np.allclose(run["e2"], np.sin(run.times), atol=1e-13)
    assert np.allclose(run["e0"], np.cos(run.times), atol=1e-13)
    for variables in ("coordinates", "declared"):
        if variables == "coordinates":
            with pytest.raises(Incomplete, match="angles are singular"):
                mbsym.simulate(described(start), 1.0, variables=variables)
    with pytest.raises(Incomplete, match="angles are singular"):
        scenario(described(start).system)


def test_unit_vectors_and_angles_with_speeds() -> None:
    orientation = "{gamma: 3}"
    text = "{alpha1: 0, alpha2: 1, alpha3: 0, beta1: 0, beta2: 0, beta3: 1, gamma1: 1, gamma2: 0, gamma3: 0, "
    found = scenario(described(text + "p: 1, q: 0, r: 0}", "[1, 2, 3]", orientation).system, declared=True)
    assert [float(x) for x in found.declared[-3:]] == [1, 0, 0]
    mixed = scenario(described("{a: 0, b: 0, c: pi/2, p: 1, q: 2, r: 3}", "[1, 2, 3]").system)
    assert [float(x) for x in mixed.declared[:4]] == pytest.approx([math.sqrt(0.5), 0, 0, math.sqrt(0.5)], abs=1e-15)
    # At c = pi/2 of {1, 2, 3} with b = 0: a' = -q, b' = p, c' = r (w = a' (0, -1, 0) + b' (1, 0, 0) + c' (0, 0, 1)).
    assert [float(x) for x in mixed.velocities] == pytest.approx([-2, 1, 3], abs=1e-14)


@pytest.mark.parametrize(
    ("initial", "told"),
    [
        ("{e0: 1, e1: 1, e2: 0, e3: 0, p: 0, q: 0}", "no value for r (its initial value); the norm squared of e is 2"),
        ("{e0: 1, e1: 0, e2: 0, p: 0, q: 0, r: 0}", "no value for e3 (its initial value)"),
        ("{a: 0, b: 1, c: 0, p: 1}", "no value for q (its initial value), r (its initial value)"),
        ("{a: 0, b: 1, c: 0, e0: 1, e1: 0, e2: 0, e3: 0, p: 0, q: 0, r: 0}", "given twice: by a, b, c and by e0"),
        ("{a: 0, b: {position: 1, velocity: 2}, c: 0, p: 0, q: 0, r: 0}", "the initial velocity of b follows"),
        ("{e0: 1, e1: 0, e2: 0, e3: 0}", None),
    ],
)
def test_what_contradicts_itself_or_lacks_something(initial: str, told: str | None) -> None:
    analysis = described(initial)
    if told is None:  # velocities that are left out are zero
        assert mbsym.simulate(analysis, 1.0, samples=2, estimate=False)["p"][0] == 0
        return
    with pytest.raises(Incomplete) as found:
        mbsym.simulate(analysis, 1.0)
    assert told in str(found.value)


def test_what_is_given_twice_may_agree() -> None:
    """Angles and e of a turn by pi/2 about axis 3, rates and speeds of one about axis 1."""
    angles = "a: {position: 0, velocity: 0}, b: {position: 0, velocity: 0}, c: {position: pi/2, velocity: 3}"
    own = "e0: sqrt(2)/2, e1: 0, e2: 0, e3: sqrt(2)/2, p: 0, q: 0, r: 3"
    found = scenario(described(f"{{{angles}, {own}}}", "[1, 2, 3]").system)
    assert [float(x) for x in found.velocities] == [0, 0, 3]
    with pytest.raises(Incomplete, match="given twice, by coordinates and by speeds"):
        scenario(described(f"{{{angles}, {own.replace('r: 3', 'r: 4')}}}", "[1, 2, 3]").system)


@pytest.mark.parametrize("rate", ["1e-30", "1e-9", "1e9"])
def test_what_is_given_twice_may_agree_in_any_unit_of_time(rate: str) -> None:
    """The speed of the turn above: half of it is no agreement, however small it is beside 1; ten digits of it are."""
    text = "{{a: 0, b: 0, c: {{position: pi/2, velocity: {0}}}, e0: 1, e1: 0, e2: 0, e3: 1, p: 0, q: 0, r: {0}{1}}}"
    text = text.replace("e0: 1", "e0: sqrt(2)/2").replace("e3: 1", "e3: sqrt(2)/2")
    text = text.replace("a: 0, b: 0", "a: {{position: 0, velocity: 0}}, b: {{position: 0, velocity: 0}}")
    found = scenario(described(text.format(rate, "*(1 + 1e-10)"), "[1, 2, 3]").system)
    assert float(found.velocities[2]) == pytest.approx(float(rate), rel=1e-9)
    with pytest.raises(Incomplete, match="given twice, by coordinates and by speeds"):
        scenario(described(text.format(rate, "/2"), "[1, 2, 3]").system)


def test_values_of_declared_variables_are_replaced() -> None:
    analysis = described("{e0: 1, e1: 0, e2: 0, e3: 0, p: 1, q: 0, r: 0}", "[1, 2, 3]")
    run = mbsym.simulate(analysis, 1.0, samples=2, estimate=False, values={"p": "5/2"})
    assert run["p"][0] == 2.5
    text = to_yaml(analysis.system)
    assert mbsym.loads(text).system.start == analysis.system.start
    assert meaning(analysis.system) != meaning(mbsym.loads(text.replace("p: 1", "p: 2")).system)
