"""Problem 6 where the first approximation leaves the verdict at the description's values open.

The system is taken at its numbers, the unperturbed motion as one of its relative equilibria, and judged as
``mbsym equilibria`` judges these: by an energy that the equations have though L knows the time, by terms of higher
order of the potential energy (``stability.degenerate``) and by combinations of first integrals (``stability.bundle``).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mbsym.algebra.failures import NOT_THERE
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.rest import at_numbers, rest
from mbsym.problems.relative_equilibria.place import candidate_at, described_place, exact_rates
from mbsym.problems.relative_equilibria.verdict import linear_at_rest
from mbsym.problems.stability.verdict import Verdict

#: Larger systems are not derived again at their numbers.
MOST_COORDINATES = 8


def decided_at(verdict: Verdict, scene: Scene, values: Mapping[str, Any]) -> Verdict:
    """An open verdict at rational values of all parameters of an open tree, decided where that is possible."""
    system = scene.system
    if len(system.coordinates) > MOST_COORDINATES:
        return verdict
    try:
        there = rest(at_numbers(system, values))
        forms = described_place(system, there, values)
        if forms is None:
            return verdict
        candidate = candidate_at(there, forms)
        if not all(candidate.vanishes(x) for x in there.at_rest):
            return verdict
        place = candidate.place(there, exact_rates(there))
        again = linear_at_rest(there).verdict(place)
        return verdict if again.word.open else again
    except NOT_THERE:
        return verdict
