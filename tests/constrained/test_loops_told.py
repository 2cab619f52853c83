"""The table of published mechanisms in docs/howto/constraints.md: its errors and steps are those of the bench."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

from mbsym.numerics.closing import closed
from mbsym.numerics.dynamics import Dynamics

TESTS = Path(__file__).parents[1]
PAGE = TESTS.parent / "docs" / "howto" / "constraints.md"
ROW = re.compile(
    r"^\| (?P<name>[^|]+) \| (?P<end>[\d.]+) \| 1e(?P<power>-\d+) \| (?P<error>[\de.-]+) \| \d+ \| [\d.]+ ms \|", re.M
)

sys.path.insert(0, str(TESTS / "bench"))
import loops_bench  # noqa: E402

TOLD = [(one["name"], int(one["power"]), float(one["error"])) for one in ROW.finditer(PAGE.read_text(encoding="utf-8"))]


def test_the_table_has_all_problems_in_their_order() -> None:
    assert [name for name, *_ in TOLD] == [one.name for one in loops_bench.problems(large=False)]


@pytest.mark.parametrize("number", range(len(TOLD)), ids=[f"{name}, 1e{power}" for name, power, _ in TOLD])
def test_errors_are_those_told(number: int) -> None:
    """Within a factor of three, or of rounding; and within the target, which a larger tolerance misses."""
    _, power, told = TOLD[number]
    problem = [*loops_bench.problems(large=False)][number]
    dynamics = Dynamics(closed(problem.made()).scenario)
    error = loops_bench.error_at(problem, dynamics, power)
    assert error == pytest.approx(told, rel=2, abs=1e-12)
    assert error <= problem.target
    assert power == -3 or loops_bench.error_at(problem, dynamics, power + 1) > problem.target
