"""What the self-check of large systems costs, what it leaves out, and that it says so."""

from __future__ import annotations

import pytest
from flint import arb, ctx

import mbsym
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.point import Balls, BallsAtRationals
from mbsym.analysis import Analysis
from mbsym.formulas.formula import Matrix
from mbsym.mechanics.oracle import Displacement, Oracle, Placement, dot
from mbsym.mechanics.states import enclosed_states, rational_states
from mbsym.problems import checks, kinematics

#: q1 turns two joints, q2 stands in a place and an angle, q3 is an angle only.
SHARED = """
mbsym: 1
name: shared
parameters: [a, b, m, J]
bodies:
  - {name: one, attached to: 0, rotation: {axes: [3, 1], angles: [q1, q2]}, connection point: [a, q2, 0],
     mass centre: [0, b, 1], mass: m, inertia about: mass centre, inertia: [J, J, J], coordinates: [q1, q2]}
  - {name: two, attached to: one, rotation: {axes: [2], angles: [q3 - q1]}, connection point: [0, a, b],
     mass centre: [b, 0, a], mass: m, inertia about: mass centre, inertia: [J, 2*J, 2*J], coordinates: [q3]}
  - {name: three, attached to: two, rotation: {axes: [1], angles: [pi/4]}, connection point: [b, a, 1],
     mass centre: [a, a, 0], mass: m, inertia about: joint, inertia: [[9, 1, 0], [1, 9, 0], [0, 0, 9]]}
  - {name: aside, attached to: 0, rotation: {axes: [2], angles: [q4]}, mass: m, mass centre: [a, 0, b],
     coordinates: [q4]}
loads:
  - uniform gravity: {vector: [1, 2, -9]}
"""


def arm(joints: int, quarter: str = "0") -> Analysis:
    """A spatial chain of bodies of unit mass."""
    bodies = [
        f"  - {{name: link {k}, attached to: {'0' if k == 1 else f'link {k - 1}'},"
        f" rotation: {{axes: [{k % 3 + 1}, {(k + 1) % 3 + 1}], angles: [q{k}, {quarter}]}},"
        f" connection point: [1, 0, {k}], mass centre: [0, 1, 1], mass: 1, coordinates: [q{k}]}}"
        for k in range(1, joints + 1)
    ]
    text = "\n".join(["mbsym: 1", "name: arm", "bodies:", *bodies])
    return mbsym.loads(text)


def test_a_displacement_moves_what_hangs_on_a_joint_as_one_body() -> None:
    """The same as placing every body anew; so is the work of forces and moments, from their sums alone."""
    analysis = mbsym.loads(SHARED)
    with ctx.workprec(200):
        (state,) = enclosed_states(analysis.system, analysis.ring, 1)
        oracle = Oracle(analysis.system, state)
        for name in analysis.system.coordinates:
            anew = Placement(analysis.system, state, oracle._displaced(name))
            moved = oracle.displaced(name)
            assert isinstance(moved, Displacement)
            for body in analysis.system.bodies:
                pairs = list(zip(anew.mass_centre(body), moved.mass_centre(body), strict=True))
                pairs += zip(anew.origin[body.name], moved.origin[body.name], strict=True)
                for one, other in zip(anew.axes[body.name], moved.axes[body.name], strict=True):
                    pairs += zip(one, other, strict=True)
                for x, y in pairs:
                    assert (x.a - y.a).contains(0)
                    assert (x.b - y.b).contains(0)
                    assert (x.b - y.b).rad() < 1e-40
                spins = zip(anew.spin(body.name)[0], moved.spin(body.name)[0], strict=True)
                assert all((x - y).contains(0) for x, y in spins)
                if moved.origin[body.name] is oracle.rest.origin[body.name]:
                    assert all(x.b.contains(0) for x in anew.mass_centre(body))
            work = moved.work(oracle.weights(analysis.system.loads[0]))
            masses = [(anew.lower(body.mass), anew.mass_centre(body)) for body in analysis.system.bodies]
            field = anew.lower.vector(analysis.system.loads[0].acceleration)
            assert (work - sum(((m * dot(field, r)).b for m, r in masses), start=state.numbers.zero)).contains(0)
            assert work.rad() < 1e-40


def test_polynomials_with_roots_are_enclosed_as_term_by_term() -> None:
    """Splitting off what is irrational gives the ball that the sum of all terms gives."""
    analysis = arm(4, "pi/4")
    with ctx.workprec(200):
        (state,) = enclosed_states(analysis.system, analysis.ring, 1)
        assert isinstance(state.numbers, BallsAtRationals)
        split = Carrier(analysis.ring, state.numbers, state.values)
        summed = Carrier(analysis.ring, _plain(state.numbers), state.values)
        for entry in analysis.equations.forcing:
            one, other = split(entry.polynomial), summed(entry.polynomial)
            assert (one - other).contains(0)
            assert one.rad() < abs(one.mid()) * arb(2) ** -150


def _plain(numbers: BallsAtRationals) -> Balls:
    """Balls with the same sines and cosines, to which nothing is known to be rational."""

    class Plain(Balls):
        sin_cos = lambda self, angle: numbers.sin_cos(angle)  # noqa: E731

    return Plain(numbers.values)


def test_long_formulas_are_checked_at_fewer_states_and_what_is_left_out_is_said(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    analysis = arm(5)
    lengths = [checks._terms(body) for body in analysis.kinematics.bodies]
    truth, found = analysis.oracles, analysis.kinematics
    assert checks.check_kinematics(truth, found).detail == "3 states"
    monkeypatch.setattr(checks, "MOST_EVALUATED", 2 * sum(lengths))
    assert checks.check_kinematics(truth, found).detail == "2 states"
    monkeypatch.setattr(checks, "MOST_EVALUATED", sum(lengths) - 1)
    assert checks.check_kinematics(truth, found).detail == "1 state; 4 of 5 bodies, the others are longer"
    monkeypatch.setattr(checks, "MOST_EVALUATED", 1)
    assert checks.check_kinematics(truth, found).detail == "1 state; 1 of 5 bodies, the others are longer"
    assert (
        checks.check_equations(truth, analysis.equations).detail == "1 state; 1 of 5 equations, the others are longer"
    )


@pytest.mark.parametrize("quarter", ["0", "pi/4"])
def test_one_state_is_enough_for_a_wrong_sign(monkeypatch: pytest.MonkeyPatch, quarter: str) -> None:
    analysis = arm(3, quarter)
    monkeypatch.setattr(checks, "MOST_EVALUATED", 1_000)
    body = analysis.kinematics.bodies[1]
    rows = [list(row) for row in body.rotation.polynomials]
    rows[0][1] = -rows[0][1] if rows[0][1] else analysis.ring.one
    wrong = kinematics.BodyKinematics(**{**vars(body), "rotation": Matrix.of(analysis.ring, rows)})
    others = [wrong if item is body else item for item in analysis.kinematics.bodies]
    outcome = checks.check_kinematics(analysis.oracles, kinematics.Kinematics(tuple(others)))
    assert outcome.failed
    assert outcome.detail.startswith("R of link 2")


def test_checks_have_work_of_their_own() -> None:
    """What the derivation used up keeps no finished result from being checked, and nothing is charged twice."""
    analysis = arm(3)
    for number in (1, 2, 3):
        analysis.stage(number)
    ring = analysis.ring
    ring.work = ring.work_budget
    before = ring.work
    outcome = analysis.check("energy")
    assert outcome is not None
    assert outcome.outcome == checks.EXACT
    assert (ring.work, ring.work_budget) == (before, before)


def test_a_check_beyond_its_budget_is_undecided_not_failed() -> None:
    analysis = arm(3)
    analysis.stage(2)
    analysis.ring.work_budget = 2
    outcome = analysis.check("energy")
    assert outcome is not None
    assert outcome.outcome == checks.UNDECIDED
    assert "more than 1 steps" in outcome.detail


def test_a_budget_counts_by_itself_and_is_given_back() -> None:
    ring = arm(1).ring
    ring.spend(10)
    limit = ring.work_budget
    with ring.budget(100) as outer:
        ring.spend(30)
        with ring.budget(5) as inner, pytest.raises(NoClosedForm, match="more than 5 steps"):
            ring.spend(6)
        assert inner.work == 6
        with pytest.raises(NoClosedForm), ring.budget(-1):
            ring.spend(1)
        ring.spend(20)
    assert outer.work == 50
    assert (ring.work, ring.work_budget) == (10, limit)


def test_rational_states_stay_rational() -> None:
    """The states of the exact checks are those they always were."""
    analysis = arm(2)
    (state,) = rational_states(analysis.system, analysis.ring, 1)
    for s, c in state.numbers.basic.values():  # type: ignore[attr-defined]
        assert s * s + c * c == 1
