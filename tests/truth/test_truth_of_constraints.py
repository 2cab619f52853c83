"""What is said to be kept with constraints, on systems where it must be said and on systems where it must be denied."""

from __future__ import annotations

from dataclasses import replace

import pytest

import mbsym
from mbsym.analysis.constrained import programs_of
from mbsym.analysis.pipeline import Analysis
from mbsym.analysis.polynomial import setting
from mbsym.formulas.formula import Formula
from mbsym.problems.checks import EXACT, FAILED
from mbsym.problems.constraints.checks import check_integrals

PLANE = """
mbsym: 1
name: A particle and a wheel
parameters: {m: positive, J: positive, r: positive, k: positive, c: positive, Om: positive}
prescribed: {s: {rate: Om}}
bodies:
  - {name: wheel, attached to: 0, connection point: [x, y, z], mass: m, rotation: {axes: [3], angles: [phi]},
     inertia about: mass centre, inertia: [J, J, J], coordinates: [x, y, z, phi]}
"""


def kept(constraints: str, loads: str = "") -> set[str]:
    analysis = analysed(constraints, loads)
    assert all(check.outcome == EXACT for check in analysis.checks), analysis.checks
    return {item.name for item in analysis.integrals if item.status == "proved"}


def analysed(constraints: str, loads: str = "") -> Analysis:
    text = PLANE + (f"loads:\n  - {loads}\n" if loads else "")
    return mbsym.loads(
        text + "constraints:\n" + "".join(f"  - {one}\n" for one in constraints.split("; ")), (1, 2, 3, 7)
    )


ENERGY = "generalised energy"


def test_a_wheel_that_rolls_straight_on_keeps_one_momentum_of_two() -> None:
    """x = r phi: neither m x' nor J phi' is kept if the other is pushed, (m r^2 + J) phi' is."""
    found = kept("relation: x = r*phi")
    assert {ENERGY, "momentum of y", "momentum of z"} <= found
    assert not {"momentum of x", "momentum of phi"} & found
    assert any("along the displacement" in name for name in found)


def test_the_blade_takes_the_momentum_of_cyclic_coordinates() -> None:
    found = kept("velocity: x_dot*sin(phi) = y_dot*cos(phi)")
    assert {ENERGY, "momentum of z"} <= found
    assert not {"momentum of x", "momentum of y", "linear momentum along axis 1"} & found
    # Through its mass centre the blade makes no moment: J phi' is kept.
    assert "momentum of phi" in found


@pytest.mark.parametrize(
    ("constraint", "is_kept"),
    [
        ("relation: x = r", True),
        ("relation: x = r*sin(s)", False),  # a moving wall works
        ("relation: x = y*sin(t)", False),  # j = -y cos t
        ("velocity: x_dot = r*Om", False),  # a belt works
        ("velocity: x_dot*cos(t) = y_dot*sin(t)", True),  # homogeneous: no work, although it turns with time
        ("distance: {between: [{body: wheel, point: [0, 0, 0]}, {body: 0, point: [0, 0, 0]}], length: r}", True),
        ("distance: {between: [{body: wheel, point: [0, 0, 0]}, {body: 0, point: [0, 0, 0]}], length: r + c*t}", False),
    ],
)
def test_energy_is_kept_where_the_constraints_do_no_work(constraint: str, is_kept: bool) -> None:
    found = {item.name for item in analysed(constraint).integrals}
    assert (ENERGY in found) == is_kept


def test_damping_is_no_less_felt_with_constraints() -> None:
    assert ENERGY not in kept("relation: x = r*phi", "damper: {coordinate: phi, coefficient: c}")
    # A spring has a force function.
    assert ENERGY in kept("relation: y = r", "spring: {coordinate: x, stiffness: k}")


def test_a_false_integral_fails_its_check() -> None:
    analysis = analysed("relation: x = r*phi")
    first, *_ = (item for item in analysis.integrals if "along the displacement" in item.name)
    ring, programs = analysis.ring, programs_of(analysis)
    assert check_integrals(analysis.form, [first], analysis.constraints, programs).outcome == EXACT
    wrong = replace(first, formula=Formula(ring, first.formula.polynomial * ring.generator("coordinate", "x")))
    assert check_integrals(analysis.form, [wrong], analysis.constraints, programs).outcome == FAILED


@pytest.mark.parametrize("rate", ["0", "w"])
def test_a_wheel_that_rolls_steadily_on_the_level_is_stable_but_for_a_drift(rate: str) -> None:
    """(m + J/r^2) x'' = 0 with x' = -r phi': a disturbance keeps its velocity, whatever the speed of the wheel."""
    found = mbsym.loads(
        f"""
mbsym: 1
name: Wheel
parameters: {{m: positive, r: positive, J: positive, w: real, g: positive}}
bodies:
  - {{name: W, attached to: 0, connection point: [x, r, 0], rotation: {{axes: [3], angles: [phi]}}, mass: m,
     coordinates: [x, phi], inertia about: mass centre, inertia: [J, J, J]}}
loads: [{{uniform gravity: {{vector: [0, -g, 0]}}}}]
constraints: [{{rolling: {{body: W, point: [0, -r, 0], axes: 0, on: ground}}}}]
motion: {{x: {{rate: -r*{rate}}}, phi: {{rate: {rate}}}}}
"""
    ).stability
    assert found.verdict.word == "stable but for a drift of cyclic coordinates"


@pytest.mark.parametrize(
    ("relation", "judged"), [("y - v*t", True), ("y - v*t - l*sin(q)/3", True), ("y - v*t*t", False)]
)
def test_a_pendulum_whose_pivot_a_constraint_carries_along_evenly(relation: str, judged: bool) -> None:
    """With y = v t + eta the time is nowhere: K = m g l > 0.  Of y = v t^2, the motion y = v t is none."""
    analysis = mbsym.loads(
        f"""
mbsym: 1
name: Carried
parameters: {{m: positive, l: positive, g: positive, v: real}}
bodies:
  - {{name: A, attached to: 0, connection point: [y, 0, 0], coordinates: [y], mass: m}}
  - {{name: B, attached to: A, rotation: {{axes: [3], angles: [q]}}, mass centre: [0, -l, 0], mass: m}}
loads: [{{uniform gravity: {{vector: [0, -g, 0]}}}}]
constraints: [{{relation: {relation} = 0}}]
motion: {{y: {{rate: v}}, q: 0}}
"""
    )
    found = analysis.optional("stability")
    assert (found is not None) == judged
    if found is not None:
        assert found.verdict.word in ("stable", "stable in first approximation only")


@pytest.mark.parametrize(
    ("body", "constraint", "unfelt"),
    [
        # x' = u cos(phi), u' = 0: y phi' + x' is constant, but holds y, on which no equation depends
        ("[x, y, phi]", "velocity: x_dot*sin(phi) = y_dot*cos(phi)", ("x", "y")),
        ("[x, y, phi]", "relation: x + y = r", ("x", "y", "phi")),  # either gives the other, and neither is felt
    ],
)
def test_positions_that_no_equation_knows_are_named(body: str, constraint: str, unfelt: tuple[str, ...]) -> None:
    text = PLANE.replace("[x, y, z, phi]", body).replace("[x, y, z]", "[x, y, 0]")
    assert setting(mbsym.loads(f"{text}constraints: [{constraint}]\n", (3, 7))).aside == unfelt
