"""Conditions as text: what they say, and every complaint with its place."""

from __future__ import annotations

import pytest

from mbsym.expressions.condition import Condition, parse_condition
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.tree import names, text

KNOWN = ("t", "theta", "theta_dot", "r", "Omega", "energy")


def read(written: str) -> tuple[Condition | None, list[tuple[str, int]]]:
    """The condition, and (code, column) of every complaint."""
    complaints = Complaints()
    found = parse_condition(written, KNOWN, complaints, lambda start, end: Span(1, start + 1, end - start))
    return found, [(one.code, one.span.column if one.span else 0) for one in complaints.sorted()]


@pytest.mark.parametrize(
    ("written", "title", "difference", "side", "direction", "period"),
    [
        ("theta = 0", "theta = 0", "theta", 0, "both", None),
        ("theta = pi/2 rising", "theta = pi/2 rising", "theta - pi/2", 0, "rising", None),
        ("top: theta_dot == 0 falling", "top", "theta_dot", 0, "falling", None),
        ("r < 1/10", "r < 1/10", "r - 1/10", -1, "falling", None),
        ("r >= 2*energy", "r >= 2*energy", "r - 2*energy", 1, "rising", None),
        ("t = 0 mod 2*pi/Omega", "t = 0 mod 2*pi/Omega", "t", 0, "both", "2*pi/Omega"),
        ("theta=0 mod 2*pi rising", "theta=0 mod 2*pi rising", "theta", 0, "rising", "2*pi"),
    ],
)
def test_what_a_condition_says(
    written: str, title: str, difference: str, side: int, direction: str, period: str | None
) -> None:
    found, complaints = read(written)
    assert complaints == []
    assert found is not None
    assert (found.title, text(found.difference), found.side, found.direction) == (title, difference, side, direction)
    assert (None if found.period is None else text(found.period)) == period
    assert names(found.difference) <= set(KNOWN)


@pytest.mark.parametrize(
    ("written", "complaints"),
    [
        ("theta", [("bad-condition", 1)]),
        ("", [("bad-condition", 1)]),
        ("0 < theta < 1", [("bad-condition", 11)]),
        ("thata = phi", [("unknown-name", 1), ("unknown-name", 9)]),
        ("thata + 1 = 2 + rr mod q", [("unknown-name", 1), ("unknown-name", 17), ("unknown-name", 24)]),
        ("theta = 0 mod 1 mod 2", [("bad-condition", 17)]),
        ("theta = 0 rising falling", [("bad-condition", 11)]),
        ("r < 1 rising", [("bad-condition", 7)]),
        ("theta = 0 rising now", [("bad-condition", 11)]),
        ("1+: theta = 0", [("bad-title", 1)]),
        ("theta = __import__('os')", [("bad-character", 20)]),
        ("theta = 9**9**9**9", [("bad-exponent", 15)]),
    ],
)
def test_every_complaint_has_its_place(written: str, complaints: list[tuple[str, int]]) -> None:
    found, met = read(written)
    assert found is None
    assert met == complaints


def test_a_condition_has_a_bounded_length() -> None:
    assert read("theta = " + "1+" * 2000 + "1")[1] == [("too-long", 1)]
