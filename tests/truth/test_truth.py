"""The truth suite: every verdict, conserved quantity and equilibrium that is printed, against what is known by hand.

Nothing may be false; and lies, planted in the outputs and in the laws that make them, must all be found.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import Any

import pytest
from terminal import told
from truth.known_systems import KNOWN
from truth.linear_systems import random_system
from truth.statements import (
    ASYMPTOTIC,
    ASYMPTOTIC_BUT_DRIFTS,
    CRITICAL,
    DRIFTS,
    GYROSCOPIC,
    NOTHING,
    STABLE,
    TRUE_OF,
    UNSTABLE,
    WORDS,
    Known,
    false_equilibria,
    false_integrals,
    false_verdict,
    undecided_verdict,
)

import mbsym
from mbsym.analysis import ALL_PROBLEMS, Analysis
from mbsym.problems.dissipation import Balance, EnergyLaw
from mbsym.problems.stability import problem
from mbsym.report.results_json import results

RANDOM = [random_system(seed) for seed in range(48)]
RESTING = [known for known in KNOWN if known.rests is not None]

#: From the most to the least that can be said of a motion that is not unstable.
STRONGER = {STABLE: ASYMPTOTIC, CRITICAL: STABLE, GYROSCOPIC: STABLE, DRIFTS: ASYMPTOTIC_BUT_DRIFTS, UNSTABLE: CRITICAL}


def word_of(found: dict[str, Any]) -> str:
    """The verdict of results.json: at the values if there are any; where there is none, nothing is said."""
    told = found.get("stability")
    return NOTHING[0] if told is None else str((told["at_values"] or told)["verdict"])


def said_of(known: Known) -> tuple[Analysis, dict[str, Any]]:
    analysis = mbsym.loads(known.text)
    return analysis, results(analysis, ALL_PROBLEMS)


@pytest.mark.parametrize("known", [*KNOWN, *RANDOM], ids=lambda known: known.name)
def test_every_verdict_and_every_integral_is_true(known: Known) -> None:
    analysis, found = said_of(known)
    word = word_of(found)
    assert false_verdict(known, word) == []
    assert false_integrals(known, found["coordinates"], found.get("integrals", [])) == []
    assert undecided_verdict(known, word) == []
    assert not [check["name"] for check in found["checks"] if check["outcome"] == "FAILED"]
    # The terminal says the same as the file.
    lines = told(analysis, 6)
    if "stability" in found:
        assert any(word in line for line in lines), (word, lines)
    else:
        assert lines[0].startswith("No result: ")


def test_the_catalogue_has_everything_that_can_be_said() -> None:
    """A suite that never sees a verdict cannot find it false."""
    assert len(KNOWN) + len(RANDOM) > 100
    natures = {known.nature for known in [*KNOWN, *RANDOM]}
    assert natures >= {*TRUE_OF} - {"turned", "open, gyroscopic"}


@pytest.mark.parametrize("known", RESTING, ids=lambda known: known.name)
def test_every_list_of_equilibria_is_true(known: Known) -> None:
    analysis = mbsym.loads(known.text)
    found = analysis.equilibria
    states = [[item.value for item in one.values] for one in found.equilibria]
    assert false_equilibria(known, states, found.complete) == []
    assert found.complete
    assert false_equilibria(known, states[1:], True), "a list called complete with one left out"
    assert false_equilibria(known, [*states, [x + 0.1 for x in states[0]]], False), "a state that is none"
    assert false_equilibria(known, [*states, states[0]], False), "one state told as two"


@pytest.mark.parametrize("known", [*KNOWN, *RANDOM], ids=lambda known: known.name)
def test_a_verdict_raised_by_a_word_is_found(known: Known) -> None:
    """Whatever is beyond the whole truth is told to be false."""
    true = TRUE_OF[known.nature]
    if not true:
        assert all(false_verdict(known, word) for word in WORDS - {*NOTHING})
        return
    raised = STABLE if known.nature == "unstable, critical" else STRONGER.get(true[0])
    if raised is not None:
        assert false_verdict(known, raised)
    against = UNSTABLE if true[0] != UNSTABLE else STABLE
    assert false_verdict(known, against)


def test_a_quantity_falsely_called_conserved_is_found() -> None:
    """The energy of a damped spring, and x itself."""
    known = next(known for known in KNOWN if known.name == "damped spring")
    lies = [{"name": "energy", "formula": "x_dot**2/2 + x**2/2"}, {"name": "place", "formula": "x"}]
    assert len(false_integrals(known, ["x"], lies)) == len(lies)


# --- lies planted in the laws ---


def lying(known: Known) -> list[str]:
    """What is found to be false in the output of a run, with whatever has been planted."""
    _, found = said_of(known)
    return false_verdict(known, word_of(found))


def planted(monkeypatch: pytest.MonkeyPatch, name: str, right: Any, wrong: Any) -> None:
    """``wrong`` in the place of a function, wherever a module has imported it."""
    places = [
        module for key, module in sys.modules.items() if key.startswith("mbsym") and vars(module).get(name) is right
    ]
    assert places
    for module in places:
        monkeypatch.setattr(module, name, wrong)


def test_parts_combined_by_the_best_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    right = problem.combine
    order = [ASYMPTOTIC, ASYMPTOTIC_BUT_DRIFTS, STABLE, DRIFTS, GYROSCOPIC, CRITICAL]

    def best(verdicts: Any, *more: Any) -> Any:
        parts = list(verdicts)
        ranked = [part for word in order for part in parts if str(part.word) == word]
        return ranked[0] if ranked else right(parts, *more)

    planted(monkeypatch, "combine", right, best)
    unlike = [known for known in KNOWN if known.name in ("half damped", "saddle")]
    assert all(lying(known) for known in unlike)
    assert [lie for known in RANDOM for lie in lying(known)]


def test_dissipation_taken_for_granted_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    pushed = [known for known in KNOWN if known.name in ("cubic push", "subcritical border")]
    assert not [lie for known in pushed for lie in lying(known)]
    monkeypatch.setattr(Balance, "law", EnergyLaw.NOT_GROWING)
    assert all(lying(known) for known in pushed)


def test_a_known_system_turned_round_is_found() -> None:
    """The catalogue itself: a nature exchanged for its opposite does not pass unnoticed."""
    for known in KNOWN:
        if TRUE_OF[known.nature] and known.decided:
            word = word_of(said_of(known)[1])
            opposite = "stable" if known.nature.startswith("unstable") else "unstable"
            assert word in NOTHING or false_verdict(replace(known, nature=opposite), word), known.name
