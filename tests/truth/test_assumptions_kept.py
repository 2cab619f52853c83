"""What is assumed of parameters holds wherever something is tried: in claims, and at the points of self-checks.

Derived by hand.  The ball of the governor hangs down: V'' = m l (g - l w^2), negative under l w^2 > g, so K has one
negative eigenvalue.  Under a < b, -1 < m < 0, n < 0 the roots are sqrt(n^2) = -n, sqrt((a - b)^2) = b - a,
sqrt((1 + m)^2) = 1 + m and sqrt((m - 1)^2) = 1 - m.
"""

from __future__ import annotations

import random

import pytest
from conftest import STATEMENTS

import mbsym
from mbsym.mechanics.states import drawn
from mbsym.problems.checks import EXACT
from mbsym.problems.stabilisation.checks import check_stabilisation


def test_the_degree_of_instability_is_checked_where_the_assumptions_hold() -> None:
    found = mbsym.load(STATEMENTS / "assumed_unstable.yaml")
    assert [region.degree for part in found.stabilisation.gyroscopic for region in part.regions] == [1]
    check = check_stabilisation(found.parameters_scene, found.judgeable, found.stabilisation)
    assert check is not None
    assert check.outcome == EXACT


@pytest.mark.parametrize("name", ["assumed_roots", "assumed_opposite_signs", "assumed_in_speeds"])
def test_roots_of_squares_have_the_sign_that_is_assumed(name: str) -> None:
    for one in mbsym.load(STATEMENTS / f"{name}.yaml").claims:
        assert one.holds is one.claim.place.startswith("true"), one.claim


def test_states_keep_assumptions_and_declared_signs() -> None:
    found = mbsym.load(STATEMENTS / "assumed_roots.yaml")
    source = random.Random(1)
    for _ in range(5):
        values = drawn(found.system, found.ring, source)
        assert 0 < values["a"] < values["b"]
        assert -1 < values["m"] < 0
        assert values["n"] < 0


def test_a_motion_that_exists_under_the_assumptions_has_no_conditions() -> None:
    """The spring pulls to sqrt((a - b)^2), which is b - a."""
    found = mbsym.loads(
        """
mbsym: 1
name: spring
parameters: {a: positive, b: positive, k: positive}
assumptions: [a < b]
bodies:
  - {name: p, mass: 1, connection point: [x, 0, 0], coordinates: [x]}
loads:
  - potential: k*(x - sqrt((a - b)**2))**2/2
motion: {x: b - a}
"""
    )
    assert found.equilibrium.satisfied
    assert str(found.energy.force_function) == "-k*(x + a - b)**2/2"


@pytest.mark.parametrize(
    ("potential", "assumptions", "kept"),
    [
        # c x^2 + y^2 with c = a and 1, while a = b = 1 is what the description gives; then c = 1 and 1
        ("a*x**2/2 + (1 - (a - b))*y**2/2", "[a >= b, a <= b]", False),
        ("(1 + a - b)*x**2/2 + (1 - (a - b))*y**2/2", "[a >= b, a <= b]", True),
        # no multiple of 1 and 1 keeps a b = 1: nothing is said
        ("a*x**2/2 + (1/b + a*b - 1)*y**2/2", "[a*b >= 1, a*b <= 1]", False),
        ("(a**2 + b)*x**2/2 + (a**2 + b)*y**2/2", "[a*b >= 1, a*b <= 1]", True),
    ],
)
def test_assumptions_that_force_an_equality_make_the_given_values_no_proof(
    potential: str, assumptions: str, kept: bool
) -> None:
    """Of V = c x^2 + d y^2 the angular momentum is kept where c = d, and nowhere else."""
    found = mbsym.loads(
        f"""
mbsym: 1
name: plane
parameters: {{a: positive, b: positive}}
assumptions: {assumptions}
bodies:
  - {{name: p, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}}
loads: [potential: {potential}]
values: {{a: 1, b: 1}}
"""
    )
    assert any(one.kind == "angular momentum" for one in found.integrals) is kept
