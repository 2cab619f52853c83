"""Units of mass, length and time change nothing that `mbsym extremes` says, but for values that have a dimension."""

from __future__ import annotations

import re
from fractions import Fraction as F
from pathlib import Path
from typing import Any

import pytest
from conftest import system_of

from mbsym.expressions.tree import Number
from mbsym.mechanics.variables import ring_of
from mbsym.numerics.borders import BORDER
from mbsym.numerics.extremes.extremes import Extremes, extremes
from mbsym.numerics.extremes.extremes_told import sentences
from mbsym.numerics.planning import sizes as scales
from mbsym.numerics.scenario import scenario
from mbsym.numerics.trade import digits
from mbsym.report.runs.extremes_tables import tables

ROOT = Path(__file__).parents[2]

#: Exponents of mass, length and time of all values, and the values in kg, m and s.
SPRING = {
    "m": ((1, 0, 0), F(1)), "k": ((1, 0, -2), F(40)), "l0": ((0, 1, 0), F(1)), "g": ((0, 1, -2), F(981, 100)),
    "r": ((0, 1, 0), F(13, 10)), "r_dot": ((0, 1, -1), F(1, 5)), "theta": ((0, 0, 0), F(1, 10)),
    "theta_dot": ((0, 0, -1), F(3, 10)),
}  # fmt: skip


def measured(name: str, dimensions: dict[str, Any], units: tuple[F, F, F]) -> Extremes:
    """The scenario written in units so many times smaller than kg, m and s."""
    system = system_of(ROOT / "systems" / f"{name}.yaml")
    mass, length, time = units
    values = {
        key: Number(value * mass**m * length**l * time**t)
        for key, ((m, l, t), value) in dimensions.items()
        if key in system.parameter_names or key.removesuffix("_dot") in system.coordinates
    }
    given = scenario(system, values)
    return extremes(given, ring_of(system), dict(values), budget=120)


def printed(found: Extremes) -> list[str]:
    """All that is printed of float64; values of parameters at a border have a dimension, and float32 ends at 1e38."""
    lines = [re.sub(r"(\w+) -> [-+.\de]+", r"\1 -> #", line) for line in sentences(found)]
    lines = [re.sub(r"(\|\w+\| <=|\w+ =) [-+.\de]+", r"\1 #", line) for line in lines]
    for columns, rows in tables(found):
        lines.append(" ".join(columns))
        lines += [re.sub(r"(\w+) -> [-+.\de]+", r"\1 -> #", " ".join(row)) for row in rows]
    lines = [line for line in lines if not line.startswith("Eigenvalues of")]  # rates: see below
    kept = [re.sub(r" / \d+", "", line) for line in lines if " -> #: float" not in line]
    return [re.sub(r"float32 [^;.]*(\.\d+)?[^;.]*[;.]", "", line) for line in kept]


@pytest.fixture(scope="module")
def usual() -> Extremes:
    return measured("spring-pendulum", SPRING, (F(1), F(1), F(1)))


@pytest.mark.parametrize(
    "units", [(F(1024), F(1), F(1)), (F(1), F(4096), F(1)), (F(1), F(1), F(64)), (F(1, 2**10), F(2**20), F(2**6))]
)
def test_powers_of_two_change_no_printed_number(usual: Extremes, units: tuple[F, F, F]) -> None:
    """Rounding is the same then, so every digit that is printed is."""
    assert printed(measured("spring-pendulum", SPRING, units)) == printed(usual)


@pytest.mark.parametrize("units", [(F(1000), F(1), F(1)), (F(1), F(1000), F(1)), (F(1), F(1), F(1, 3600))])
def test_grams_and_millimetres_and_hours(usual: Extremes, units: tuple[F, F, F]) -> None:
    """Rounding differs; conditions and verdicts do not, nor digits beyond the chance of one rounding."""
    other = measured("spring-pendulum", SPRING, units)
    rows = [row for row in usual.rows if row.kind != BORDER]
    assert len(rows) > 200
    for one, two in zip(rows, (row for row in other.rows if row.kind != BORDER), strict=True):
        assert (one.subject, one.size, one.quantity) == (two.subject, two.size, two.quantity)
        assert two.digits.condition == pytest.approx(one.digits.condition, rel=1e-6)
        if one.digits.condition < 1e3:  # else it is chance whether the constants' rounding shows
            assert abs(one.digits.formula - two.digits.formula) < 1.3, one
        assert (one.digits.verdict == "formula") == (two.digits.verdict == "formula")


def test_eigenvalues_are_rates(usual: Extremes) -> None:
    """Sixty-four times smaller units of time: as many times smaller numbers, within the enclosures."""
    other = measured("spring-pendulum", SPRING, (F(1), F(1), F(64)))
    assert len(usual.eigenvalues) == 4
    for one, two in zip(usual.eigenvalues, other.eigenvalues, strict=True):
        assert one.overlaps(64 * two)


def test_a_norm_in_metres_and_radians_is_noticed(monkeypatch: pytest.MonkeyPatch, usual: Extremes) -> None:
    """Planted: the largest entry as the size of all, as if a metre were a radian."""
    monkeypatch.setattr(
        digits, "scales", lambda name, exact, masses, alike: [max(abs(x.mid()) for x in exact)] * len(exact)
    )
    plain = measured("spring-pendulum", SPRING, (F(1), F(1), F(1)))
    other = measured("spring-pendulum", SPRING, (F(1), F(2**20), F(1)))
    conditions = [[row.digits.condition for row in found.rows] for found in (plain, other)]
    assert any(a != pytest.approx(b, rel=1e-3) for a, b in zip(*conditions, strict=True))


def test_scales_of_a_mixed_matrix() -> None:
    """M = [[4, 1], [1, 9]] by [[4, 6], [6, 9]]; an angle's acceleration that vanishes is measured by the other's."""
    from flint import arb

    masses = [arb(4), arb(9)]
    matrix = [arb(x) for x in (4, 1, 1, 9)]
    assert [float(x) for x in scales.scales("mass matrix", matrix, masses, ("angle", "r"))] == [4, 6, 6, 9]
    still = scales.scales("accelerations", [arb(0), arb(8)], masses, ("angle", "r"))
    assert [float(x) for x in still] == [12, 8]
    alike = scales.scales("accelerations", [arb(2), arb(8)], masses, ("angle", "angle"))
    assert [float(x) for x in alike] == [8, 8]
