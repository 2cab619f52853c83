"""Problem 10 of Lagrange's equations in angles: conical motions, precessions of the top, pendulums, by hand."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest
from conftest import SHIPPED, derived, invoked

import mbsym
from mbsym.analysis.stages import Unavailable
from mbsym.problems.invariant_sets.branches import identifiers
from mbsym.problems.invariant_sets.result import Definiteness, Gap, Kind, StationarySet


def value(formula, **numbers):
    return Fraction(str(formula.subs(numbers)))


def holds(relations, **numbers):
    """Whether all relations hold at the numbers."""
    found = [(value(one.formula, **numbers), one.relation) for one in relations]
    return all({">": x > 0, ">=": x >= 0, "!=": x != 0}[relation] for x, relation in found)


def sufficient(one: StationarySet, **numbers):
    sides = [x for x in (one.variation.positive, one.variation.negative) if x is not None]
    return any(holds(side, **numbers) for side in sides)


def test_conical_motions_of_the_spherical_pendulum():
    """psi'^2 l cos(theta) = g, stable wherever they are (Routh); the poles are singular in these angles."""
    found = derived(SHIPPED / "spherical-pendulum.yaml").invariant_sets
    family = found.families[0]
    (one,) = family.sets
    assert (one.kind, one.invariant, one.union) == (Kind.STEADY, True, 1)
    assert (family.unfinished, family.parts) == (0, 0)
    assert family.singular > 0
    assert not found.complete
    solved = dict(one.solved)
    numbers = {"g": 8, "l": 1, "lambda1": 4}  # cos = 1/2
    assert value(solved["cos_theta"], **numbers) == Fraction(1, 2)
    assert value(solved["psi_dot"], **numbers) == -4
    # sin = 4/5, cos = 3/5: psi'^2 = 5 g/(3 l); g = 15, l = 1
    assert sufficient(one, g=15, l=1, m=1, lambda1=5, sin_theta=Fraction(4, 5))
    assert value(one.relations[0], g=15, l=1, lambda1=5, sin_theta=Fraction(4, 5)) == 0
    assert not sufficient(one, g=15, l=1, m=1, lambda1=3, sin_theta=Fraction(4, 5))
    assert one.gap is Gap.NONE_FOUND


@pytest.fixture(scope="module")
def top():
    return derived(SHIPPED / "heavy-top.yaml").invariant_sets


def test_the_sleeping_top(top):
    """C^2 W^2 > 4 A m g l (Lagrange): necessary and, for some multiplier, sufficient."""
    one = next(x for x in top.families[0].sets if x.kind is Kind.STEADY and "phi_dot" in x.free)
    assert one.invariant is True
    upright = {"A": 1, "C": 1, "m": 1, "l": 1, "g": 1, "cos_alpha": 1, "cos_beta": 1}
    assert not all(holds([x], **upright, phi_dot=Fraction(19, 10)) for x in one.first.necessary)
    assert all(holds([x], **upright, phi_dot=Fraction(21, 10)) for x in one.first.necessary)
    (free,) = one.variation.chosen
    tried = [Fraction(k, 8) for k in range(-40, 41)]
    assert any(sufficient(one, **upright, phi_dot=3, **{free: x}) for x in tried)
    assert not any(sufficient(one, **upright, phi_dot=Fraction(3, 2), **{free: x}) for x in tried)
    hanging = upright | {"cos_beta": -1}
    assert any(sufficient(one, **hanging, phi_dot=0, **{free: x}) for x in tried)


def test_regular_precessions_of_the_top(top):
    """In these angles the axis moves: for given multipliers a closed curve of dimension 1."""
    one = next(x for x in top.families[0].sets if x.kind is Kind.MANIFOLD)
    assert (one.invariant, one.dimension) == (True, 1)
    assert one.variation.outcome is Definiteness.LEFT_OUT
    # The axis turns about the vertical at the rate -lambda1: with (n1, n2) = (sin b, -sin a cos b) horizontally,
    # b' = -lambda1 sin a  is  n1' = -lambda1 sin a cos b = lambda1 n2.
    rate = dict(one.solved)["beta_dot"]
    assert value(rate, lambda1=2, sin_alpha=Fraction(3, 5)) == Fraction(-6, 5)


def test_the_double_pendulum_rests_stably_only_hanging():
    """V has its minimum at 0, 0 alone."""
    (one,) = derived(SHIPPED / "double-pendulum.yaml").invariant_sets.families[0].sets
    numbers = {"m1": 1, "m2": 2, "l1": 1, "l2": 3, "g": 10}
    stable = {(a, b): sufficient(one, **numbers, cos_theta1=a, cos_theta2=b) for a in (1, -1) for b in (1, -1)}
    assert stable == {(1, 1): True, (1, -1): False, (-1, 1): False, (-1, -1): False}


def test_the_dumbbell_on_a_circular_orbit():
    """Along the radius: frequencies sqrt(3) and 2 times the orbit's (Beletsky); along the tangent unstable."""
    radial, tangential = sorted(
        derived(SHIPPED / "dumbbell.yaml").invariant_sets.families[0].sets, key=lambda one: one.first.unstable
    )
    assert radial.variation.outcome is Definiteness.STABLE
    squares = {value(low, omega0=1) / value(high, omega0=1) for low, high in radial.first.factors}
    assert squares == {3, 4}
    assert tangential.first.unstable
    assert tangential.variation.outcome is Definiteness.NEVER


def test_a_disc_that_rolls_has_the_freedoms_that_its_constraints_leave():
    """Of five coordinates three velocities are free: at rest, upright, 5 r lean'' = 4 g lean (Appell, Routh)."""
    (one,) = derived(SHIPPED / "rolling-disc.yaml").invariant_sets.families[0].sets
    assert (one.kind, one.invariant) == (Kind.STEADY, True)
    ((low, high),) = one.first.factors
    numbers = {"r": 2, "g": 10, "cos_lean": 1}
    assert value(low, **numbers) / value(high, **numbers) == Fraction(-4 * 10, 5 * 2)
    assert [sufficient(one, **numbers | {"m": 1, "cos_lean": c}) for c in (1, -1)] == [False, True]


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("simple-pendulum", "no polynomial integrals are known"),
        ("gravity-gradient", "9 rates, sines, cosines and positions"),
        ("spatial-arm", "6 coordinates"),
        ("four-bar", "constraints tie positions"),
        ("shaken-pendulum", "not polynomial"),
    ],
)
def test_refused_with_the_reason(name, why):
    with pytest.raises(Unavailable, match=why):
        mbsym.load(f"systems/{name}.yaml").invariant_sets  # noqa: B018


def test_names_that_every_language_may_write():
    assert identifiers(("x_dot", "sin(theta)", "cos(theta/2)"), ("sin_theta",)) == [
        "x_dot", "sin_theta_", "cos_theta_2"
    ]  # fmt: skip


def test_branches_without_points_are_not_counted(top):
    """det M ~ m1 + m2 sin(theta2)^2 > 0: none is singular.  Of the top's, A sin(b)^2 + C cos(b)^2 = 0 has none."""
    path = Path("systems/double-pendulum.yaml")
    found = mbsym.load(path).invariant_sets
    assert [(x.unfinished, x.singular, x.parts) for x in found.families] == [(0, 0, 0)]
    assert found.complete
    assert top.families[0].unfinished == 0
    # where m2 < -m1 is allowed it vanishes somewhere
    text = path.read_text(encoding="utf-8").replace("m2: {sign: positive", "m2: {sign: real")
    other = mbsym.loads(text).invariant_sets
    assert other.families[0].singular == 1


def test_sines_are_written_as_such_but_for_names_in_json(tmp_path):
    words = "run systems/double-pendulum.yaml --problems 10 --format html,latex,json --out"
    done = invoked(*words.split(), tmp_path, code=0)
    assert "sin(theta1)^2 + cos(theta1)^2 - 1 = 0" in done.output
    assert "_theta" not in done.output
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "<msub><mi>sin</mi>" not in page
    assert "<msub><mi>cos</mi>" not in page
    section = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))["invariant_sets"]
    assert section["stand_for"]["sin_theta1"] == "sin(theta1)"
    tex = (tmp_path / "fragments" / "invariant_sets.tex").read_text(encoding="utf-8")
    assert r"(\sin \theta_{1})^{2}" in tex


def test_what_makes_the_equations_shorter_is_named():
    """And what is named works: systems/gravity-gradient-quaternion.yaml has it."""
    text = Path("systems/gravity-gradient.yaml").read_text(encoding="utf-8")
    with pytest.raises(Unavailable) as told:
        mbsym.loads(text).invariant_sets  # noqa: B018
    added = [part for part in str(told.value).split("'") if part.startswith(("speeds:", "orientation:"))]
    assert len(added) == 2
    line = "    inertia: [A, B, C]\n"
    assert text.count(line) == 1
    system = mbsym.loads(text.replace(line, line + "".join(f"    {one}\n" for one in added))).system
    assert system.bodies[1].orientation
    assert len(system.speeds) == 3
