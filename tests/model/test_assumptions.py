"""Assumptions against the given values, and against each other: complaints with a place, never a crash or silence."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from conftest import TESTS, filed
from hypothesis import given
from hypothesis import strategies as st
from properties import settings
from scipy.optimize import linprog

import mbsym
from mbsym import DescriptionError
from mbsym.model.assumptions import contradictory

CASES = TESTS / "cases" / "statements"
BEAD = {
    "mbsym": 1,
    "name": "bead",
    "bodies": [{"name": "p", "attached to": 0, "connection point": ["x", 0, 0], "mass": 1, "coordinates": ["x"]}],
    "loads": [{"potential": "(a + b*b + c*c)*x**2/2"}],
    "motion": {"x": 0},
}
SIGNS = {"a": "real", "b": "positive", "c": "real"}


def bead(assumptions: list[str], signs: dict[str, Any] = SIGNS, **more: Any) -> str:
    return json.dumps(BEAD | {"parameters": signs, "assumptions": assumptions} | more, indent=1)


@pytest.mark.parametrize(
    ("name", "place", "message"),
    [
        ("s_sgn9", "12:22", "contradictory-assumptions"),
        ("s_sgn10", "12:15", "broken-assumption"),
    ],
)
def test_the_cases_are_refused_with_their_place(tmp_path: Path, name: str, place: str, message: str) -> None:
    from mbsym_cli.main import main

    path = CASES / f"{name}.yaml"
    for arguments in (["check", str(path)], ["run", str(path), "--out", str(tmp_path)]):
        done = CliRunner().invoke(main, arguments)
        assert done.exit_code == 2
        assert f"{path}:{place}: error[{message}]" in done.output
    with pytest.raises(DescriptionError, match=message):
        mbsym.load(path)


@pytest.mark.parametrize(
    "assumptions",
    [
        ["a > 1", "a < 0"],
        ["a > 1", "a < 1"],
        ["a >= 1", "a < 1"],
        ["a > b", "b > c", "c > a"],
        ["b < 0"],  # declared positive
        ["a + b < 0", "a > 0"],
        ["a > pi", "a < 3"],
        ["2*a - 3 > 2*c", "c > a"],
        ["a != a"],
    ],
)
def test_what_no_values_keep_is_told(assumptions: list[str]) -> None:
    with pytest.raises(DescriptionError, match="contradictory-assumptions"):
        mbsym.loads(bead(assumptions))


@pytest.mark.parametrize(
    "assumptions", [["a > 1", "a < 2"], ["a >= 1", "a <= 1"], ["a > b", "b > c"], ["a > 3", "a < pi"], ["a != 0"]]
)
def test_what_some_values_keep_is_accepted(assumptions: list[str]) -> None:
    assert contradictory(mbsym.loads(bead(assumptions)).system) is None


def test_relations_and_notation_are_used() -> None:
    with pytest.raises(DescriptionError, match="contradictory-assumptions"):
        mbsym.loads(bead(["c > a"], relations={"c": "a - b"}))
    with pytest.raises(DescriptionError, match="contradictory-assumptions"):
        mbsym.loads(bead(["n > 3", "a < 1", "b < 1"], notation={"n": "a + b"}))


@pytest.mark.parametrize("assumptions", [["a*c > 1", "a*c < 0"], ["a**2 < 0"], ["a**2 + c**2 < -1", "a > 1"]])
def test_a_contradiction_that_is_not_linear_is_no_crash(assumptions: list[str]) -> None:
    """Where it is noticed only while signs are sought, the problem says so and has no result."""
    analysis = mbsym.loads(bead(assumptions))
    for number in analysis.problems:
        failure = analysis.stage(number).failure
        assert failure is None or "contradict" in failure.reason or "is false" in failure.reason


numbers = st.integers(-3, 3)


@settings(max_examples=150, derandomize=True)
@given(st.lists(st.tuples(numbers, numbers, numbers, numbers), min_size=1, max_size=6))
def test_elimination_agrees_with_linear_programming(rows: list[tuple[int, int, int, int]]) -> None:
    """p a + q b + r c + s > 0 for every row, b > 0: possible exactly where the largest common margin is positive."""
    rows = [row for row in rows if any(row[:3])]
    texts = [f"{p}*a + {q}*b + {r}*c + {s} > 0" for p, q, r, s in rows]
    coefficients = [[-p, -q, -r, 1] for p, q, r, _ in rows] + [[0, -1, 0, 1]]
    best = linprog([0, 0, 0, -1], coefficients, [*(s for *_, s in rows), 0], bounds=[(None, None)] * 3 + [(None, 1)])
    assert best.status == 0
    possible = -best.fun > 1e-9
    if possible:
        assert contradictory(mbsym.loads(bead(texts)).system) is None
    else:
        assert -best.fun < 1e-9
        with pytest.raises(DescriptionError, match="contradictory-assumptions"):
            mbsym.loads(bead(texts))


# --- values ---


@pytest.mark.parametrize(
    ("assumption", "values", "kept"),
    [
        ("a > 1", {"a": 2}, True),
        ("a > 1", {"a": 1}, False),
        ("a >= 1", {"a": 1}, True),
        ("a != c", {"a": 1, "c": 1}, False),
        ("a > sqrt(2)", {"a": 1.4}, False),
        ("a > sqrt(2)", {"a": 1.5}, True),
        ("a*c > b", {"a": 1, "b": 2, "c": 1}, False),
        ("a > b", {"a": "sqrt(2)", "b": 2}, False),
        ("a > c", {"a": 1}, True),  # c is not known
    ],
)
def test_given_values_keep_the_assumptions(assumption: str, values: dict[str, Any], kept: bool) -> None:
    if kept:
        mbsym.loads(bead([assumption], values=values))
    else:
        with pytest.raises(DescriptionError, match="broken-assumption"):
            mbsym.loads(bead([assumption], values=values))


@pytest.mark.parametrize("command", ["simulate", "equilibria"])
@pytest.mark.parametrize(("setting", "kept"), [("a=1", False), ("a=1.4142", False), ("a=2", True)])
def test_values_of_the_command_line_keep_them_too(tmp_path: Path, command: str, setting: str, kept: bool) -> None:
    from mbsym_cli.main import main

    path = filed(tmp_path / "bead.yaml", bead(["a > sqrt(2)"], values={"a": 3, "b": 1, "c": 0}, initial={"x": 0.1}))
    further = ["--time", "0.1", "--out", str(tmp_path / "out")] if command == "simulate" else []
    done = CliRunner().invoke(main, [command, str(path), "--set", setting, *further])
    assert done.exit_code == (0 if kept else 2), done.output
    assert ("broken-assumption" in done.output) is not kept
