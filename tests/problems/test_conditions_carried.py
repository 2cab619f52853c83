"""Conditions of problem 4 are used wherever the motion is: in relations, too; and rates that are zero in disguise."""

from __future__ import annotations

import json
from typing import Any

import pytest
from conftest import TESTS, Exact

import mbsym
from mbsym.analysis import Analysis

ROD = {"name": "rod", "attached to": 0, "rotation": {"axes": [3], "angles": ["q"]}, "mass": "m"}


def bead(**more: Any) -> Analysis:
    """x'' = -dV/dx with V = k x^2/2 + d x (1 + x), and d = rho b0: at rest in x = 0 only if rho = 0; then K = k."""
    body = {"name": "bead", "attached to": 0, "connection point": ["x", 0, 0], "mass": 1, "coordinates": ["x"]}
    description = {
        "mbsym": 1,
        "name": "bead",
        "parameters": {"k": "positive", "b0": "positive", "rho": "real", "d": "real"},
        "bodies": [body],
        "loads": [{"potential": "k*x**2/2 + d*x*(1 + x)"}],
        "relations": {"d": "rho*b0"},
        "motion": {"x": 0},
    }
    return mbsym.loads(json.dumps(description | more))


def test_a_solved_condition_reaches_what_relations_make_of_it() -> None:
    analysis = bead()
    assert [(name, str(value)) for name, value in analysis.equilibrium.solved] == [("rho", "0")]
    assert analysis.linearisation.K[0, 0] == Exact(analysis)("k")
    assert (str(analysis.stability.verdict.word), analysis.stability.verdict.theorem) == (
        "stable",
        "Lagrange-Dirichlet",
    )
    assert {check.outcome for check in analysis.checks} == {"exact"}


def test_claims_about_the_first_approximation_use_the_condition() -> None:
    claims = [{"claim": "linear matrix K", "entry": ["x", "x"], "equals": "k + 2*d"}]
    assert [result.holds for result in bead(claims=claims).claims] == [True]


def test_a_chain_of_relations_is_followed_to_the_end() -> None:
    """c = 1 + d and d = rho b0 with rho = 0: the spring is k."""
    analysis = bead(
        parameters={"k": "positive", "b0": "positive", "rho": "real", "d": "real", "c": "real"},
        relations={"d": "rho*b0", "c": "1 + d"},
        loads=[{"potential": "c*k*x**2/2 + d*x"}],
    )
    assert analysis.linearisation.K[0, 0] == Exact(analysis)("k")
    assert not [check for check in analysis.checks if check.failed]


def test_the_satellite_whose_tube_is_off_its_place_passes_its_checks() -> None:
    """The offset d = rho b0 of the shipped relations must vanish there; matrices and checks agree about it."""
    analysis = mbsym.load(TESTS / "cases" / "hostile" / "swd1.yaml", (4, 5, 6))
    assert [name for name, _ in analysis.equilibrium.solved] == ["rho"]
    assert {check.outcome for check in analysis.checks} == {"exact"}
    used = {name for matrix in analysis.linearisation.matrices for row in matrix for x in row for name in names(str(x))}
    assert "rho" not in used


def names(text: str) -> set[str]:
    return {*"".join(c if c.isalnum() else " " for c in text).split()}


@pytest.mark.parametrize(
    ("rate", "relations"), [("-0", {}), ("0*w", {}), ("w - w", {}), ("w", {"w": 0}), ("2*w + v", {"w": "-v/2"})]
)
def test_a_rate_that_is_zero_in_disguise_is_rest(rate: str, relations: dict[str, Any]) -> None:
    analysis = mbsym.loads(
        json.dumps(
            {
                "mbsym": 1,
                "name": "pendulum",
                "parameters": {"m": "positive", "g": "positive", "w": "real", "v": "real"},
                "bodies": [ROD | {"mass centre": [0, -1, 0]}],
                "loads": [{"uniform gravity": {"vector": [0, "-g", 0]}}],
                "relations": relations,
                "motion": {"q": {"value": 0, "rate": rate}},
            }
        )
    )
    assert analysis.linearisation.K[0, 0] == Exact(analysis)("m*g")
    assert str(analysis.stability.verdict.word) == "stable"
    assert {check.outcome for check in analysis.checks} == {"exact"}


def tilted(alpha: str) -> Analysis:
    """U = m g cos(q + alpha): at rest in q = 0 only if sin(alpha) = 0; K = m g cos(alpha)."""
    return mbsym.loads(
        json.dumps(
            {
                "mbsym": 1,
                "name": "tilted",
                "parameters": {"m": "positive", "g": "positive", "alpha": "real", "beta": "real"},
                "bodies": [ROD | {"mass centre": [0, -1, 0]}],
                "loads": [{"force function": "m*g*cos(q + alpha)"}],
                "relations": {"alpha": alpha},
                "motion": {"q": 0},
            }
        )
    )


@pytest.mark.parametrize(("alpha", "stiffness"), [("0", "m*g"), ("pi", "-m*g"), ("4*pi", "m*g"), ("atan(0)", "m*g")])
def test_a_related_angle_is_that_angle_under_sines_too(alpha: str, stiffness: str) -> None:
    analysis = tilted(alpha)
    assert analysis.equilibrium.satisfied
    assert analysis.linearisation.K[0, 0] == Exact(analysis)(stiffness)
    assert {check.outcome for check in analysis.checks} <= {"exact", "verified numerically"}


def test_an_angle_may_be_related_to_another() -> None:
    analysis = tilted("2*beta")
    assert not analysis.equilibrium.satisfied
    assert analysis.linearisation.K[0, 0] == Exact(analysis)("m*g*(2*cos(beta)**2 - 1)")
    assert not [check for check in analysis.checks if check.failed]


def test_a_related_rate_is_used_on_the_motion() -> None:
    """A bead at the radius 1 of a table that turns at the rate w: the spring must pull with w^2, w = 2 v."""
    table = {"name": "table", "attached to": 0, "rotation": {"axes": [3], "angles": ["psi"]}, "mass": 0}
    inertia = {"inertia about": "joint", "inertia": [0, 0, "C"]}
    analysis = mbsym.loads(
        json.dumps(
            {
                "mbsym": 1,
                "name": "table",
                "parameters": {"C": "positive", "k": "positive", "w": "real", "v": "real"},
                "bodies": [
                    table | inertia,
                    {"name": "bead", "attached to": "table", "connection point": ["r", 0, 0], "mass": 1}
                    | {"coordinates": ["r"]},
                ],
                "loads": [{"spring": {"coordinate": "r", "stiffness": "k", "rest": 0}}],
                "relations": {"w": "2*v"},
                "motion": {"psi": {"value": 0, "rate": "w"}, "r": 1},
            }
        )
    )
    assert [str(x) for x in analysis.equilibrium.conditions] == [str(Exact(analysis)("k - 4*v**2"))]
    assert [(name, str(x)) for name, x in analysis.equilibrium.solved] == [("k", "4*v**2")]
    assert not [check for check in analysis.checks if check.failed]
