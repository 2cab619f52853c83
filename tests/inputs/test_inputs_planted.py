"""Mistakes in input terms, planted in the source: each is found by the self-check."""

from __future__ import annotations

import json

import pytest
from test_self_check import DYNAMICS, EQUATIONS, LINEARISATION, PERTURBED, SPINNING, SYSTEMS, Mistake, failing, plant

import mbsym

#: The spinning machine, pushed and turned by inputs of every kind, one of them held at a value.
DRIVEN = {
    **SPINNING,
    "name": "spinning machine with inputs",
    "inputs": ["u", "v", "w"],
    "loads": [
        *SPINNING["loads"],
        {"generalized force": {"p": "v**2*q_dot - u"}},
        {"force": {"body": "bead", "point": [0, "l", 1], "components": ["u", "v", 0], "axes": "arm"}},
        {"torque": {"body": "arm", "components": ["w", 0, "2*w + v*p"], "axes": "shaft", "reaction on": "shaft"}},
    ],
    "motion": {**SPINNING["motion"], "v": "k", "w": 1},
}

MISTAKES = [
    Mistake(
        "the sign of B in one route",
        "mechanics.expansion:projected",
        "tuple(-x for x in row)",
        "tuple(x for x in row)",
        "driven",
        (LINEARISATION, PERTURBED),
    ),
    Mistake(
        "the values of inputs in one route",
        "mechanics.motion:unperturbed",
        "system_input.name, system_input.held)",
        "system_input.name, ZERO)",
        "driven",
        (LINEARISATION,),
    ),
    Mistake(
        "the values of inputs in matrices of the other route",
        "mechanics.expansion:over_jets",
        "jets.deviation(numbers[name], value)",
        "jets.deviation(numbers[name], ring.zero)",
        "driven",
        (LINEARISATION, PERTURBED),
    ),
    Mistake(
        "columns of B in another order in both routes",
        "problems.linearisation:assemble",
        "B=Matrix.of(ring, B.rows)",
        "B=Matrix.of(ring, [row[::-1] for row in B.rows])",
        "driven",
        (PERTURBED,),
    ),
    Mistake(
        "an input torque without its reaction",
        "mechanics.loads.kinds:_torque_action",
        "((load.body, vector), (load.reaction_on, -vector))",
        "((load.body, vector),)",
        "driven",
        (EQUATIONS, PERTURBED),
    ),
    Mistake(
        "the sign of an input torque",
        "mechanics.loads.kinds:_torque_action",
        "scene.to_axes(torque, body)",
        "-scene.to_axes(torque, body)",
        "driven",
        (*DYNAMICS, PERTURBED),
    ),
]


@pytest.fixture(autouse=True)
def known(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(SYSTEMS, "driven", (DRIVEN, (1, 2, 3, 4, 5)))


def test_without_a_mistake_nothing_fails() -> None:
    analysis = mbsym.loads(json.dumps(DRIVEN), (1, 2, 3, 4, 5))
    assert {check.outcome for check in analysis.checks} <= {"exact", "verified numerically"}
    assert {"linearisation", "perturbed motion"} <= {check.name for check in analysis.checks}
    linear = analysis.linearisation
    assert linear.B is not None
    assert linear.B.shape == (4, 3)


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.what)
def test_a_planted_mistake_in_input_terms_is_caught(monkeypatch: pytest.MonkeyPatch, mistake: Mistake) -> None:
    assert failing("driven") == set()
    plant(monkeypatch, mistake)
    assert failing("driven") >= set(mistake.caught)
