"""The ring has a place for every reciprocal, root and function that a description can bring, and hardly more."""

from __future__ import annotations

import json

import pytest

import mbsym

#: 12 places are free in any case, and 4 for the load.
FREE = 12 + 4


def places(formula: str) -> int:
    """Those of a rod with this force function."""
    body: dict[str, object] = {
        "name": "rod",
        "attached to": 0,
        "rotation": {"axes": [3, 0, 0], "angles": ["phi", 0, 0]},
        "mass": "m",
        "inertia about": "joint",
        "inertia": ["A", "A", "A"],
    }
    loads = [{"force function": formula}]
    parameters = dict.fromkeys(["m", "A", "a", "b"], "positive")
    description = {"mbsym": 1, "name": "rod", "parameters": parameters, "bodies": [body], "loads": loads}
    return mbsym.loads(json.dumps(description)).ring.spare


@pytest.mark.parametrize("polynomial", ["a", "a**2*b/4 - b**3", "a*sin(phi) + cos(2*phi)**2", "2*a/3", "a**0"])
def test_what_is_polynomial_takes_no_place(polynomial: str) -> None:
    assert places(polynomial) == FREE


@pytest.mark.parametrize("formula", ["a/b", "b**(-1)", "a**(1/2)", "sqrt(a)", "exp(a)", "tan(phi)", "sin(a*b)"])
def test_what_is_not_has_one(formula: str) -> None:
    assert places(formula) >= FREE + 2


def test_there_is_a_place_for_each_of_many_reciprocals() -> None:
    """24 different ones, where 16 places are free in any case."""
    many = " + ".join(f"1/(a + {k})" for k in range(1, 25))
    assert places(many) >= FREE + 24
