"""Claimed equations are decided along the motion: every combination of the equations of motion holds, nothing else.

The systems' equations are typed here by hand; combinations and mistakes are random, with fixed seeds.
"""

from __future__ import annotations

import json
import random
from fractions import Fraction
from math import cos, sin
from typing import Any

import pytest
from conftest import TESTS

import mbsym
from mbsym.problems.claims import ClaimResult

#: Cart with a hanging pendulum: (M + m) x'' + m l (th'' cos th - th'^2 sin th) = 0, l th'' + x'' cos th + g sin th = 0.
CART: dict[str, Any] = {
    "mbsym": 1,
    "name": "cart and pendulum",
    "parameters": {"M": "positive", "m": "positive", "l": "positive", "g": "positive"},
    "bodies": [
        {"name": "cart", "attached to": 0, "connection point": ["x", 0, 0], "coordinates": ["x"], "mass": "M"},
        {
            "name": "bob",
            "attached to": "cart",
            "rotation": {"axes": [3], "angles": ["th"]},
            "mass centre": [0, "-l", 0],
            "mass": "m",
        },
    ],
    "loads": [{"uniform gravity": {"vector": [0, "-g", 0]}}],
}
OF_X = "((M + m)*x_ddot + m*l*th_ddot*cos(th) - m*l*th_dot**2*sin(th))"
OF_TH = "(l*th_ddot + x_ddot*cos(th) + g*sin(th))"
#: Solved for the accelerations, by hand: th'' = -(x'' cos th + g sin th)/l put into the first.
X_DDOT = "m*sin(th)*(l*th_dot**2 + g*cos(th))/(M + m*sin(th)**2)"
TH_DDOT = "-(m*l*th_dot**2*sin(th)*cos(th) + (M + m)*g*sin(th))/(l*(M + m*sin(th)**2))"


def judged(*claims: dict[str, Any], **more: Any) -> tuple[ClaimResult, ...]:
    return tuple(mbsym.loads(json.dumps({**CART, **more, "claims": list(claims)}, indent=1)).claims)


def equation(of: str, equals: str) -> dict[str, str]:
    return {"claim": "equation of motion", "of": of, "equals": equals}


def value(expression: str, **state: float) -> float:
    """At x'' and th'' of the motion, by the formulas typed above."""
    names = {"M": 2.0, "m": 0.7, "l": 1.3, "g": 9.81, "sin": sin, "cos": cos, **state}
    names |= {"x_ddot": eval(X_DDOT, {}, names), "th_ddot": eval(TH_DDOT, {}, names)}
    return float(eval(expression, {}, names))


def test_solved_forms_and_sums_hold_and_say_what_they_are_made_of() -> None:
    found = mbsym.load(TESTS / "cases" / "statements" / "solved-form-refuted.yaml").claims
    assert [one.outcome for one in found] == ["holds on every motion"] * 3
    assert all(one.holds for one in found)
    # (M + m sin^2) x'' = ... is the equation of x less cos th times m l times (l th'' + ...)/l: by hand.
    assert found[0].remark == "it is 1 times the equation of x plus -cos(th)/l times the equation of th"
    assert found[2].remark == "it is 1 times the equation of x plus 1/(m*l) times the equation of th"


@pytest.mark.parametrize("seed", range(8))
def test_combinations_hold_and_mistakes_in_them_do_not(seed: int) -> None:
    source = random.Random(seed)
    factors = ["2", "-1", "sin(th)", "(1 + x**2)", "cos(th)/l", "l*m", "th_dot", "(M - 2*m)"]
    first, second = source.sample(factors, 2)
    true = f"{first}*{OF_X} + {second}*{OF_TH}"
    mistakes = {
        "sign": true.replace("+ g*sin(th)", "- g*sin(th)"),
        "factor": true.replace("m*l*th_dot**2", "2*m*l*th_dot**2"),
        "missing": true.replace(" - m*l*th_dot**2*sin(th)", ""),
        "term": f"{true} + {source.choice(('x', 'g', 'th_dot**2', 'm*sin(th)'))}",
    }
    state = {"x": 0.4, "th": 0.7, "x_dot": -0.3, "th_dot": 1.1}
    assert abs(value(true, **state)) < 1e-12
    assert all(abs(value(wrong, **state)) > 1e-3 for wrong in mistakes.values())
    right, *wrong = judged(*(equation(source.choice(("x", "th")), one) for one in (true, *mistakes.values())))
    assert right.holds
    for one in wrong:
        assert one.refuted, one.title
        assert one.difference is not None
        assert not one.difference.is_zero


def test_accelerations_are_claimed_in_symbols() -> None:
    right, other, wrong = judged(
        {"claim": "acceleration", "of": "x", "equals": X_DDOT},
        {"claim": "acceleration", "of": "th", "equals": TH_DDOT},
        {"claim": "acceleration", "of": "x", "equals": X_DDOT.replace("g*cos", "2*g*cos")},
    )
    assert (right.outcome, other.outcome) == ("holds exactly", "holds exactly")
    assert wrong.refuted


def test_what_says_nothing_or_little_is_not_said_to_be_an_equation_of_motion() -> None:
    """0 = 0 says nothing; a square of an equation vanishes on every motion, and is no combination of the equations."""
    nothing, squared = judged(equation("x", "x - x"), equation("x", f"{OF_TH}**2"))
    assert (nothing.outcome, nothing.remark) == ("undecided", "it says 0 = 0")
    assert squared.holds
    assert "not linear in the accelerations" in squared.remark


def test_inputs_may_stand_in_claims() -> None:
    """A force F on the cart: (M + m) x'' + ... = F."""
    (right, wrong) = judged(
        equation("x", f"{OF_X} - F + {OF_TH}"),
        equation("x", f"{OF_X} + F + {OF_TH}"),
        inputs={"F": 0},
        loads=[*CART["loads"], {"generalized force": {"x": "F"}}],
    )
    assert right.holds
    assert wrong.refuted


def test_equations_of_speeds_are_combined_too() -> None:
    """Euler: A p' + (C - B) q r = m g (z0 gamma2 - y0 gamma3), B q' + (A - C) p r = m g (x0 gamma3 - z0 gamma1), gamma
    upwards and the weight along -gamma at the mass centre."""
    text = (TESTS.parent / "systems" / "euler-poisson.yaml").read_text(encoding="utf-8").partition("claims:")[0]
    first = "A*p_dot + (C - B)*q*r - m*g*(z0*gamma2 - y0*gamma3)"
    second = "B*q_dot + (A - C)*p*r - m*g*(x0*gamma3 - z0*gamma1)"
    both = [f"q*({first}) + gamma1*({second})", f"q*({first}) + gamma1*({second.replace('(A - C)', '(C - A)')})"]
    lines = "".join(f"  - {{claim: equation of motion, of: p, equals: '{one}'}}\n" for one in (first, *both))
    single, right, wrong = mbsym.loads(f"{text}claims:\n{lines}").claims
    assert single.holds
    assert right.outcome == "holds on every motion"
    assert wrong.refuted


def test_a_planted_wrong_mass_matrix_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Combinations are formed with M: with the equation of th turned in sign the true sum is no longer said to hold."""
    from mbsym.problems.claims import equations

    honest = equations.Dynamics.of

    def turned(derived: Any) -> equations.Dynamics:
        found = honest(derived)
        ring = found.ring
        rows = (found.rows[0], found.rows[1] + ring.generator("coordinate", "th"))
        return equations.Dynamics(ring, found.names, found.places, rows)

    true = f"{OF_X} + {OF_TH}"
    assert judged(equation("x", true))[0].holds
    monkeypatch.setattr(equations.Dynamics, "of", staticmethod(turned))
    assert not judged(equation("x", true))[0].holds


def test_numbers_are_rational_where_they_are_put_in() -> None:
    """With numbers for the parameters nothing is rounded: 1/3 stays 1/3."""
    third = Fraction(1, 3)
    text = X_DDOT.replace("M", "2").replace("g", f"({third})")
    (found,) = judged(
        {"claim": "acceleration", "of": "x", "equals": text},
        parameters={"m": "positive", "l": "positive"},
        bodies=json.loads(json.dumps(CART["bodies"]).replace('"M"', "2")),
        loads=[{"uniform gravity": {"vector": [0, "-1/3", 0]}}],
    )
    assert found.outcome == "holds exactly"
