"""Staude's permanent rotations: the verdicts against the amended potential and Euler's and Poisson's equations."""

from __future__ import annotations

import math
from collections import Counter
from fractions import Fraction

import numpy as np
import pytest
from conftest import TESTS
from numpy.typing import NDArray

import mbsym
from mbsym.mechanics.rest import given_values
from mbsym.problems.relative_equilibria.equilibria import RelativeEquilibrium, equilibria

MOMENTS = np.diag([4.0, 5.0, 6.0])
CENTRE = np.array([0.1, 0.2, 0.3])  # times m g = 1


def vertical(one: RelativeEquilibrium) -> NDArray[np.float64]:
    """The upward unit vector in the axes of the body, from its angles about the axes {3, 1, 3}."""
    angles = {item.name: item.value for item in one.values}
    th, phi = angles["th"], angles["phi"]
    return np.array([math.sin(th) * math.sin(phi), math.sin(th) * math.cos(phi), math.cos(th)])


def amended_potential(n: NDArray[np.float64], momentum: float) -> float:
    """V + p^2 / (2 n.J n) at the constant momentum p about the vertical."""
    return float(CENTRE @ n + momentum**2 / (2 * n @ MOMENTS @ n))


def least_curvature(n: NDArray[np.float64], rate: float) -> float:
    """The smaller eigenvalue of the second derivative of the amended potential on the unit sphere at n."""
    momentum = rate * float(n @ MOMENTS @ n)
    across = np.linalg.svd(n[None, :])[2][1:]
    h = 1e-4

    def at(x: float, y: float) -> float:
        point = n + x * across[0] + y * across[1]
        return amended_potential(point / np.linalg.norm(point), momentum)

    xx = (at(h, 0) - 2 * at(0, 0) + at(-h, 0)) / h**2
    yy = (at(0, h) - 2 * at(0, 0) + at(0, -h)) / h**2
    xy = (at(h, h) - at(h, -h) - at(-h, h) + at(-h, -h)) / (4 * h**2)
    return float(np.linalg.eigvalsh([[xx, xy], [xy, yy]])[0])


def growth(n: NDArray[np.float64], rate: float) -> float:
    """The largest real part of J w' = J w x w + n x r (gravity pulls along -n), n' = n x w, linearised."""

    def skew(v: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])

    w = rate * n
    inverse = np.linalg.inv(MOMENTS)
    rest = np.cross(MOMENTS @ w, w) + np.cross(n, CENTRE)
    assert np.abs(rest).max() < 1e-9, "a permanent rotation"
    turning = inverse @ (skew(MOMENTS @ w) - skew(w) @ MOMENTS)
    whole = np.block([[turning, -inverse @ skew(CENTRE)], [skew(n), -skew(w)]])
    return float(np.linalg.eigvals(whole).real.max())


@pytest.mark.parametrize(("rate", "expected"), [("1/2", (1, 1, 0)), ("1", (2, 2, 2)), ("2", (2, 2, 2))])
def test_permanent_rotations_are_judged_by_the_reduced_potential(rate: str, expected: tuple[int, int, int]) -> None:
    """Routh: a strict minimum of the amended potential is stable; a growing solution is not; the others stay open."""
    system = mbsym.load(TESTS / "cases" / "statements" / "staude2.yaml").system
    found = equilibria(system, given_values(system, {"W": Fraction(rate)}))
    assert found.complete
    kinds: Counter[str] = Counter()
    for one in found.equilibria:
        n, w = vertical(one), float(Fraction(rate))
        if least_curvature(n, w) > 1e-5:
            kind = "stable but for a drift of cyclic coordinates"
            assert one.verdict.theorem == "Routh"
        elif growth(n, w) > 1e-5:
            kind = "unstable"
        else:
            kind = "gyroscopically stabilised only"
        assert one.verdict.word == kind
        kinds[kind.split(" ")[0]] += 1
    assert (kinds["stable"], kinds["unstable"], kinds["gyroscopically"]) == expected
