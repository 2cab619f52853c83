"""The table of published mechanisms in docs/howto/constraints.md: its errors are those of the bench."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

from tests.mechanisms import MECHANISMS

TESTS = Path(__file__).parents[1]
PAGE = TESTS.parent / "docs" / "howto" / "constraints.md"
ROW = re.compile(
    r"^\| (?P<name>[^|]+) \| (?P<end>[\d.]+) \| 1e(?P<power>-\d+) \| (?P<error>[\de.-]+) \| \d+ \| [\d.]+ ms \|"
    r" (?P<published>[^|]*) ?\|$",
    re.M,
)

sys.path.insert(0, str(TESTS / "bench"))
import loops_bench  # noqa: E402

TOLD = [*ROW.finditer(PAGE.read_text(encoding="utf-8"))]
WANTED = [(one, target) for one in MECHANISMS for target in one.targets]


def test_the_table_has_all_mechanisms_in_their_order() -> None:
    told = [(one["name"], float(one["end"]), one["published"].strip()) for one in TOLD]
    assert told == [(one.name, one.end, one.published) for one, _ in WANTED]


@pytest.mark.parametrize("number", range(len(TOLD)), ids=[f"{one['name']}, 1e{one['power']}" for one in TOLD])
def test_errors_are_those_told(number: int) -> None:
    """Within a factor of three, or of rounding; and within the target, which a larger tolerance misses."""
    power, told = int(TOLD[number]["power"]), float(TOLD[number]["error"])
    mechanism, target = WANTED[number]
    dynamics = loops_bench.dynamics_at_start(mechanism)
    error = loops_bench.error_at(mechanism, dynamics, power)
    assert error == pytest.approx(told, rel=2, abs=1e-12)
    assert error <= target
    assert power == -3 or loops_bench.error_at(mechanism, dynamics, power + 1) > target
