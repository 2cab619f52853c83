"""Satellites with gimballed gyroscopes in a circular orbit: their limits are the gyrostat and the rigid satellite.

The characteristic polynomials of these are those of references/orbit-gyrostat-and-clebsch, section 3.1; a gimbal that
an infinitely stiff spring locks adds its moments of inertia to the satellite's.
"""

from __future__ import annotations

from fractions import Fraction as F
from typing import Any

import pytest
from conftest import SHIPPED

import mbsym
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.point import Rationals
from mbsym.analysis import Analysis
from mbsym.problems.stability import problem as stability

BASE = {name: F(value) for name, value in {"R": 100, "omega0": 1, "nu": 10**6, "m": 1, "mg": "1/10"}.items()}
BODY = {"A": F(4), "B": F(5), "C": F(3), "Jx": F(1, 5), "Jy": F(3, 10), "Jz": F(1, 10)}


@pytest.fixture(scope="module")
def one() -> Analysis:
    return mbsym.load(SHIPPED / "satellite-with-gyroscope.yaml", (6, 8))


@pytest.fixture(scope="module")
def two() -> Analysis:
    return mbsym.load(SHIPPED / "satellite-with-two-gyroscopes.yaml", (6, 8))


def gyrostat(A: F, B: F, C: F, h: F) -> list[F]:
    """Roll and yaw in S^2, low to high (references/orbit-gyrostat-and-clebsch)."""
    middle = h**2 + (2 * B - A - C) * h + B**2 - A * B + 2 * A * C + 2 * B * C - 3 * C**2
    return [(B - A + h) * (4 * (B - C) + h), F(0), middle, F(0), A * C]


def characteristic(analysis: Analysis, values: dict[str, F]) -> list[F]:
    """Of the part with roll, low to high."""
    part = next(x for x in analysis.stability.subsystems if "phi" in x.coordinates)
    algebra = Rationals({}, {})
    carry = Carrier(analysis.ring, algebra, {name: algebra.number(x) for name, x in values.items()})
    found = [carry(x.polynomial) for x in part.characteristic]
    return [F(int(x.p), int(x.q)) for x in found]


def minus(first: list[F], second: list[F]) -> list[F]:
    return [a - b for a, b in zip(first, second, strict=True)]


def same_up_to_a_factor(first: list[F], second: list[F]) -> bool:
    kept = [x for x in (first, second) if any(x)]
    first, second = ([*x, *[F(0)] * (10 - len(x))] for x in kept)
    k = next(i for i, x in enumerate(second) if x)
    return first[k] != 0 and all(a * second[k] == b * first[k] for a, b in zip(first, second, strict=True))


@pytest.mark.parametrize("h", [F(0), F(1, 2), F(-7, 3)], ids=["rotor at rest", "h = 1/2", "h = -7/3"])
def test_a_locked_gimbal_makes_the_gyrostat_and_the_rigid_satellite(one: Analysis, h: F) -> None:
    """The determinant is linear in k: its slope is that of the locked gimbal, of the rigid satellite where h = 0."""
    given = {**BASE, **BODY, "h": h, "d": F(2, 7)}
    slope = minus(characteristic(one, {**given, "k": F(1)}), characteristic(one, {**given, "k": F(0)}))
    locked = gyrostat(BODY["A"] + BODY["Jx"], BODY["B"] + BODY["Jz"], BODY["C"] + BODY["Jy"], h)
    assert same_up_to_a_factor(slope, locked)
    assert not same_up_to_a_factor(slope, gyrostat(BODY["A"], BODY["B"], BODY["C"], h))


@pytest.mark.parametrize(("h1", "h2"), [(F(0), F(0)), (F(1, 2), F(1, 3)), (F(2), F(-2))])
def test_two_locked_gimbals_carry_the_sum_of_the_momenta(two: Analysis, h1: F, h2: F) -> None:
    given = {**BASE, **BODY, "h1": h1, "h2": h2, "d1": F(1, 3), "d2": F(1, 5)}

    def at(k1: int, k2: int) -> list[F]:
        return characteristic(two, {**given, "k1": F(k1), "k2": F(k2)})

    mixed = minus(minus(at(1, 1), at(1, 0)), minus(at(0, 1), at(0, 0)))
    gimbals = BODY["Jx"] + BODY["Jy"]
    whole = gyrostat(BODY["A"] + gimbals, BODY["B"] + 2 * BODY["Jz"], BODY["C"] + gimbals, h1 + h2)
    assert same_up_to_a_factor(mixed, whole)


def word(analysis: Analysis, **values: Any) -> str:
    judge = stability.ExactVerdicts(
        analysis.parameters_scene, analysis.balance, analysis.linearisation, analysis.equilibrium, analysis.signs
    )
    return str(judge({**BASE, **BODY, **{name: F(x) for name, x in values.items()}}).word)


def test_friction_damps_roll_and_yaw_and_not_pitch(one: Analysis, two: Analysis) -> None:
    for analysis in (one, two):
        parts = {x.coordinates: x.theory.at_point for x in analysis.stability.subsystems}
        (rolling,) = (x for names, x in parts.items() if "phi" in names)
        assert rolling is not None
        assert rolling.verdict.word == "asymptotically stable"
        pitch = parts[("theta",)]
        assert pitch is not None
        assert pitch.verdict.word == "stable"
        assert analysis.stability.numerical is not None
        assert analysis.stability.numerical.word == "stable"
        (damped,) = analysis.stabilisation.dissipation
        assert "theta" not in damped.coordinates
        assert (damped.rank.full, damped.at_values) == (True, True)


def test_the_sufficient_conditions_are_those_of_k(one: Analysis) -> None:
    """By hand: B' - A' + h > 0,  4 (B - C)(q + k) + q k > 0 with q = 4 (Jz - Jy) + h, and one of the diagonal."""
    judged = next(x for x in one.stabilisation.energy if "phi" in x.coordinates)
    yaw = next(x for x in judged.minors if "k" not in str(x) and "4" not in str(x))
    assert str(yaw) in ("B - A - Jx + Jz + h", "B - A + Jz - Jx + h")
    assert word(one, h=F(1, 2), k=1, d=1) == "stable"
    assert word(one, h=F(-2), k=1, d=1) == "unstable"  # B' - A' + h = 0.9 - 2 < 0: one negative eigenvalue


def test_friction_destroys_what_the_rotor_alone_holds_up(one: Analysis) -> None:
    """Kelvin-Chetaev: two negative eigenvalues of K, bounded without friction, unstable with the least of it."""
    held = {"A": 6, "B": 6, "C": 4, "h": F(-33, 2), "k": 40}
    assert word(one, **held, d=0) == "gyroscopically stabilised only"
    assert word(one, **held, d=F(1, 1000)) == "unstable"
