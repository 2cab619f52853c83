"""Numbers of CSV files: they read back exactly, and in the fewest digits that do."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from properties import settings

from mbsym.report.runs.trajectory_csv import rows, shortest, written

POWERS = [float(f"1e{k}") for k in range(-330, 309)]

TABLES = {
    "any bits": lambda source: source.integers(0, 2**64, (3, 20_000), dtype=np.uint64).view(float),
    "usual sizes": lambda source: source.normal(size=(4, 10_000)),
    "few digits": lambda source: np.round(source.normal(size=(4, 10_000)) * 1e3, 3),
    "times": lambda source: np.arange(100_000)[None] * 0.0005,
    "powers of two": lambda source: 2.0 ** np.arange(-1074, 1024)[None],
    "powers of ten and their neighbours": lambda source: np.array(
        [np.nextafter(POWERS, -np.inf), POWERS, np.nextafter(POWERS, np.inf)]
    ),
    "what is special": lambda source: np.array([[0.0, -0.0, np.inf, -np.inf, np.nan, 5e-324, 1.7976931348623157e308]]),
}


def digits(text: str) -> str:
    return text.lower().partition("e")[0].lstrip("-").replace(".", "").strip("0")


def read_back(text: str) -> Any:
    return np.array([[float(cell) for cell in line.split(",")] for line in text.splitlines()]).T


@pytest.mark.parametrize("name", TABLES)
def test_numbers_read_back_in_the_fewest_digits(name: str) -> None:
    table = TABLES[name](np.random.default_rng(5))
    text = rows(table)
    assert np.array_equal(read_back(text).view(np.int64), table.view(np.int64)) or np.isnan(table).any()
    assert np.array_equal(read_back(text), table, equal_nan=True)
    cells = [cell for line in text.splitlines() for cell in line.split(",")]
    assert all(digits(cell) == digits(repr(x)) for cell, x in zip(cells, table.T.ravel().tolist(), strict=True))


@settings()
@given(st.lists(st.floats(), min_size=1, max_size=20))
def test_numbers_of_any_kind(numbers: list[float]) -> None:
    assert np.array_equal(read_back(rows([numbers]))[0], numbers, equal_nan=True)
    assert np.array_equal([float(shortest(x)) for x in numbers], numbers, equal_nan=True)


def test_whole_numbers_have_no_point() -> None:
    assert rows([[0.0, 10.0, 100.5], [-3.0, 1.05, 20.0]]) == "0,-3\n10,1.05\n100.5,20\n"
    assert shortest(10.0) == "10"


def test_blocks_of_rows_follow_each_other() -> None:
    table = np.random.default_rng(7).normal(size=(3, 25_000))
    text = written(["a", "b", "c"], list(table))
    assert text.startswith("a,b,c\n")
    assert np.array_equal(read_back(text.partition("\n")[2]), table)
