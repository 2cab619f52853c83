"""Numbers as text: digit for digit what C's and Python's ``%.17g`` give, however the bits lie."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from properties import settings

from mbsym.numerics.kernels import decimals
from mbsym.report.runs.trajectory_csv import written

POWERS = [float(f"1e{k}") for k in range(-330, 309)]


def by_python(table: Any) -> str:
    line = ",".join(["%.17g"] * len(table)) + "\n"
    return "".join(line % tuple(row) for row in table.T.tolist())


TABLES = {
    "any bits": lambda source: source.integers(0, 2**64, (3, 60_000), dtype=np.uint64).view(float),
    "usual sizes": lambda source: source.normal(size=(4, 30_000)),
    "few digits": lambda source: np.round(source.normal(size=(4, 10_000)) * 1e3, 3),
    "times": lambda source: np.arange(100_000)[None] * 0.0005,
    "halves of the last digit": lambda source: source.integers(2**50, 2**53, (2, 50_000)) / 4.0,
    "powers of two": lambda source: 2.0 ** np.arange(-1074, 1024)[None],
    "powers of ten and their neighbours": lambda source: np.array(
        [np.nextafter(POWERS, -np.inf), POWERS, np.nextafter(POWERS, np.inf)]
    ),
    "what is special": lambda source: np.array([[0.0, -0.0, np.inf, -np.inf, np.nan, 5e-324, 1.7976931348623157e308]]),
}


@pytest.mark.parametrize("name", TABLES)
def test_every_digit_is_that_of_the_c_library(name: str) -> None:
    table = TABLES[name](np.random.default_rng(5))
    assert decimals.lines(table) == by_python(table)


@settings(suppress_health_check=[HealthCheck.too_slow])  # the first example compiles
@given(st.lists(st.floats(), min_size=1, max_size=20))
def test_numbers_of_any_kind(numbers: list[float]) -> None:
    table = np.array([numbers])
    text = decimals.lines(table)
    assert text == by_python(table)
    back = np.array([float(line) for line in text.splitlines()])
    assert np.array_equal(back, table[0], equal_nan=True)


def test_a_wrong_power_of_ten_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """The negative control: one bit of one table entry."""
    library, function, (words, shifts, *rest) = decimals._writer()
    wrong = words.copy()
    wrong[16 - decimals.LEAST, 1] ^= np.uint64(1 << 11)
    monkeypatch.setattr(decimals, "_writer", lambda: (library, function, (wrong, shifts, *rest)))
    table = np.random.default_rng(6).uniform(1, 10, (1, 100))
    assert decimals.lines(table) != by_python(table)


def test_large_tables_read_as_small_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    table = np.random.default_rng(7).normal(size=(3, 25_000))
    small = written(["a", "b", "c"], list(table))
    monkeypatch.setattr("mbsym.report.runs.trajectory_csv.MANY", 1)
    assert written(["a", "b", "c"], list(table)) == small
    assert small.startswith("a,b,c\n")
    assert small.count("\n") == 25_001
