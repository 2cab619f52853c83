"""System 6: the rigid satellite and the dumbbell in a circular orbit, against the classical results."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from conftest import SHIPPED, Exact, at_values, derived, reference

import mbsym

ORBIT = reference("gravity_gradient")["reference"]


def characteristic(a: mbsym.analysis.Analysis, *names: str) -> list:
    (part,) = (x for x in a.stability.subsystems if set(x.coordinates) == set(names))
    return list(part.characteristic)


def test_frequencies_of_the_dumbbell() -> None:
    """lambda^2 + 3 in the plane of the orbit, lambda^2 + 4 across it, in units of the orbital rate."""
    a = derived(SHIPPED / "dumbbell.yaml")
    assert ORBIT["dumbbell"] == {"pitch": "sqrt(3) n", "roll": "2 n"}
    for name, square in (("alpha", 3), ("beta", 4)):
        constant, linear, leading = characteristic(a, name)
        assert linear.is_zero
        assert Exact(a).ratio(constant, leading) == square


def test_stability_of_the_dumbbell() -> None:
    a = derived(SHIPPED / "dumbbell.yaml")
    assert a.stability.verdict.word == "stable"
    assert not [check for check in a.checks if check.outcome != "exact"]


def test_the_dumbbell_has_six_equilibria() -> None:
    """Along the radius (stable), along the velocity and along the normal; the last two hide behind the angles."""
    found = derived(SHIPPED / "dumbbell.yaml").equilibria
    assert found.complete
    assert len(found.equilibria) == 6
    stable = [tuple(x.text for x in one.values) for one in found.equilibria if one.verdict.word == "stable"]
    assert stable == [("0", "0"), ("pi", "0")]
    assert sum(bool(one.coordinates_of) for one in found.equilibria) == 2


def test_a_thin_satellite_is_a_dumbbell() -> None:
    """Pitch: 3 (A - B)/C in units of the orbital rate squared, which is 3 for a rod along the radius."""
    a = derived(SHIPPED / "gravity-gradient.yaml")
    assert ORBIT["pitch_frequency"] == "n sqrt(3(Ix-Iz)/Iy)"  # x along the velocity, y the normal, z the radius
    exact = Exact(a)
    constant, linear, leading = (exact.same(x) for x in characteristic(a, "theta"))
    assert linear.is_zero
    assert exact.ratio(constant, exact("3*(A - B)")) == exact.ratio(leading, exact("C"))


def linear_roots(along: float, outward: float, normal: float) -> np.ndarray:
    """The roots of the three linear equations of the references, by numpy."""
    x, y, z = along, normal, outward
    mass = np.diag([x, y, z])
    stiffness = np.diag([4 * (y - z), 3 * (x - z), y - x])
    coupling = np.zeros((3, 3))
    coupling[0, 2], coupling[2, 0] = y - x - z, x - y + z
    inverse = np.linalg.inv(mass)
    block = np.block([[np.zeros((3, 3)), np.eye(3)], [-inverse @ stiffness, -inverse @ coupling]])
    return np.linalg.eigvals(block)


POINTS = [(a, b) for a in range(-9, 10, 3) for b in range(-8, 9, 4)]


@pytest.mark.parametrize(("roll", "yaw"), POINTS)
def test_regions_of_debra_and_delp(roll: int, yaw: int) -> None:
    """Smelt's parameters kR, kY on a grid of the square; A = 1, and C from kR and kY."""
    k, h = Fraction(roll, 10) + Fraction(1, 37), Fraction(yaw, 10) + Fraction(1, 41)
    # kR = (C - B)/A, kY = (C - A)/B with A = 1:  C = B + kR, so B (1 - kY) = 1 - kR
    outward = (1 - k) / (1 - h)
    normal = outward + k
    if not (outward > 0 and normal > 0 and outward + normal > 1 and 1 + outward > normal and 1 + normal > outward):
        pytest.skip("no body has these moments")
    a = at_values(SHIPPED / "gravity-gradient.yaml", A=1, B=outward, C=normal)
    verdict = a.stability.numerical
    assert verdict is not None
    roots = linear_roots(1.0, float(outward), float(normal))
    middle = 1 + 3 * k + k * h
    inside = k > h and k * h > 0 and middle > 0 and middle**2 > 16 * k * h
    assert bool(np.abs(roots.real).max() < 1e-7) == inside, "the references' conditions are those of the roots"
    if not inside:
        assert verdict.word == "unstable"
    elif k > 0:  # then C > A > B: Lagrange's region
        assert verdict.word == "stable"
    else:
        assert verdict.word == "gyroscopically stabilised only"


def test_the_grid_meets_every_region() -> None:
    kinds = set()
    for roll, yaw in POINTS:
        k, h = roll / 10 + 1 / 37, yaw / 10 + 1 / 41
        middle = 1 + 3 * k + k * h
        stable = k > h and k * h > 0 and middle > 4 * math.sqrt(k * h)
        kinds.add((stable, k > 0))
    assert {(True, True), (False, True), (False, False)} <= kinds
