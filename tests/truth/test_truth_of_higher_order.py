"""Whatever problem 11 says of the systems whose motions are known by hand is true."""

from __future__ import annotations

import pytest
from truth.known_systems import KNOWN
from truth.statements import TRUE_OF, Known, false_verdict

import mbsym
from mbsym.problems.normal_forms.result import Outcome

#: What is no statement about stability in Lyapunov's sense.
OPEN = (Outcome.UNDECIDED, Outcome.FORMAL, Outcome.MOST)


@pytest.mark.parametrize("known", KNOWN, ids=lambda known: known.name)
def test_every_verdict_is_true(known: Known) -> None:
    found = mbsym.loads(known.text).optional("normal_forms")
    if found is None or found.at_values is None or found.at_values.outcome in OPEN or not TRUE_OF[known.nature]:
        return
    word = found.at_values.outcome.value
    if found.cyclic and found.at_values.outcome is not Outcome.UNSTABLE:
        word += " but for a drift of cyclic coordinates"
    assert false_verdict(known, word) == []


def test_something_is_said() -> None:
    """A suite in which nothing is decided could find nothing false."""
    said = [mbsym.loads(known.text).optional("normal_forms") for known in KNOWN]
    outcomes = [one.at_values.outcome for one in said if one is not None and one.at_values is not None]
    assert min(map(outcomes.count, (Outcome.STABLE, Outcome.ASYMPTOTIC, Outcome.UNSTABLE))) > 9
