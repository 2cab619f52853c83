"""What is conserved where formulas outgrow the budget of terms: named by structure, or not at all."""

from __future__ import annotations

import pytest
from bench.chains import chain, description

import mbsym
from mbsym.algebra.failures import NoClosedForm

ARM = """
mbsym: 1
name: arm
parameters: [a, b, g]
bodies:
  - {name: column, attached to: 0, rotation: {axes: [3], angles: [q1]}, mass: 2, mass centre: [a, 0, b],
     inertia about: mass centre, inertia: [3, 3, 3]}
  - {name: arm, attached to: column, connection point: [a, b, 0], rotation: {axes: [1], angles: [q2]}, mass: 1,
     mass centre: [0, a, b], inertia about: mass centre, inertia: [2, 2, 2]}
"""
VERTICAL = "  - uniform gravity: {acceleration: g, direction: [0, 0, -1]}\n"
SLANTED = "  - uniform gravity: {acceleration: g, direction: [0, -3/5, -4/5]}\n"
FREE = """
mbsym: 1
name: free body
bodies:
  - {name: body, attached to: 0, connection point: [x, y, z], rotation: {axes: [3, 2, 1], angles: [u, v, w]}, mass: 2,
     mass centre: [1, 2, 3], inertia about: mass centre, inertia: [3, 3, 4], coordinates: [x, y, z, u, v, w]}
loads:
  - uniform gravity: {acceleration: 1, direction: [0, 0, -1]}
"""
MOTOR = ARM.replace("bodies:", "prescribed: {chi: 2}\nbodies:").replace(
    "angles: [q2]}", "angles: [q2 + chi]}, coordinates: [q2]"
)


@pytest.mark.parametrize(
    ("text", "conserved"),
    [
        (ARM + "loads:\n" + VERTICAL, "the energy T - U, the momentum of q1"),
        (ARM + "loads:\n" + SLANTED, "the energy T - U"),
        (ARM, "the energy T - U, the momentum of q1"),
        (ARM + "loads:\n" + VERTICAL + "  - damper: {coordinate: q2, coefficient: 1}\n", ""),
        (ARM + "loads:\n" + VERTICAL + "  - generalized force: {q1: 1}\n", ""),
        (ARM + "loads:\n  - potential: q1*t\n", ""),
        (ARM + "loads:\n  - spring: {coordinate: q1, stiffness: 3, rest: 1}\n", "the energy T - U"),
        (MOTOR + "loads:\n" + VERTICAL, "the momentum of q1"),
        (FREE, "the energy T - U, the momentum of x, the momentum of y"),  # that of u, too, but T reads u in body axes,
    ],
)
def test_what_is_conserved_without_a_formula(text: str, conserved: str) -> None:
    analysis = mbsym.loads(text)
    analysis.terms = 3
    failure = analysis.stage(7).failure
    assert failure is not None
    assert "beyond the budget of 3" in failure.reason
    found = failure.reason.partition("; conserved all the same, by structure: ")[2]
    assert found == conserved
    assert failure.hint  # what to try for the formula


@pytest.mark.parametrize("text", [ARM + "loads:\n" + VERTICAL, ARM + "loads:\n" + SLANTED, FREE])
def test_the_formulas_agree(text: str) -> None:
    """With all the terms they need, the same are proved by identities."""
    analysis = mbsym.loads(text)
    proved = {
        x.name
        for x in analysis.integrals
        if x.status == "proved" and x.kind in ("generalised energy", "cyclic momentum")
    }
    analysis = mbsym.loads(text)
    analysis.terms = 3
    words = analysis.stage(7).failure.reason.partition("by structure: ")[2].split(", ")
    names = {"generalised energy" if "energy" in x else x.removeprefix("the ") for x in words}
    assert names <= proved


def test_the_hint_at_a_motion_stays_short() -> None:
    """A chain of 40 without a motion: what is left out of one is 0 at rest, so that one name is enough."""
    bodies = [
        f"  - {{name: b{k}, attached to: {'0' if k == 1 else f'b{k - 1}'}, rotation: {{axes: [3], angles: [q{k}]}},"
        " connection point: [1, 0, 0], mass centre: [1, 0, 0], mass: 1}"
        for k in range(1, 41)
    ]
    text = "\n".join(["mbsym: 1", "name: chain", "bodies:", *bodies, ""])
    hint = mbsym.loads(text, problems=(4,)).stage(4).failure.hint
    assert hint == "add for example  motion: {q1: 0}; what is left out is 0 at rest"
    assert mbsym.loads(text + "motion: {q1: 0}\n", problems=(4,)).stage(4).failure is None


def test_rest_of_a_long_chain_is_called_a_motion() -> None:
    """It hangs at rest whatever its length; expanded to second order it outgrew the budget."""
    analysis = mbsym.loads(description(chain(100, full=False)), problems=(4,))
    assert analysis.stage(4).failure.hint == "add for example  motion: {q1: 0}; what is left out is 0 at rest"


def test_where_the_budget_ends_nothing_is_said_of_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    def out_of_terms(*_: object, **__: object) -> None:
        raise NoClosedForm("too many terms")

    monkeypatch.setattr("mbsym.analysis.approximation.expansion", out_of_terms)
    assert mbsym.loads(FALL, problems=(4,)).stage(4).failure.hint == "say with 'motion:' about which one"


FALL = "mbsym: 1\nname: fall\nbodies:\n  - {name: p, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}\n"


@pytest.mark.parametrize(
    ("text", "proposed"),
    [
        (FALL, True),
        (FALL + "loads:\n  - uniform gravity: {vector: [0, -10, 0]}\n", False),  # y'' = -10
        (FALL + "constraints:\n  - relation: x = 1 + y\n", False),
        (FALL + "constraints:\n  - relation: x = sin(y)\n", True),
    ],
)
def test_no_motion_is_proposed_that_does_not_exist(text: str, proposed: bool) -> None:
    failure = mbsym.loads(text, problems=(4,)).stage(4).failure
    assert failure is not None
    assert ("add for example" in str(failure.hint)) == proposed
    if proposed:
        assert mbsym.loads(text + "motion: {x: 0, y: 0}\n", problems=(4,)).equilibrium.satisfied
