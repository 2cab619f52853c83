"""Problem 6 where the first approximation leaves the verdict at the description's values open.

The system is taken at its numbers, the unperturbed motion as one of its relative equilibria, and judged as
``mbsym equilibria`` judges these: by an energy that the equations have though L knows the time, by terms of higher
order of the potential energy (``stability.degenerate``) and by combinations of first integrals (``stability.bundle``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

from mbsym.algebra.failures import NOT_THERE
from mbsym.expressions.angles import LinearForm, linear_form
from mbsym.expressions.tree import number, substitute
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import motion_values
from mbsym.mechanics.rest import Rest, at_numbers, rest
from mbsym.model.system import System
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.rest_candidates import candidate_at
from mbsym.problems.rest_place import exact_rates
from mbsym.problems.rest_verdict import linear_at_rest
from mbsym.problems.stability import Stability, parameter_values

#: Larger systems are not derived again at their numbers.
MOST_COORDINATES = 8


def decided(found: Stability, scene: Scene, equilibrium: Equilibrium) -> Stability:
    """``found`` with its verdict at the values decided where that is possible; values have to be rational."""
    verdict, system = found.numerical, scene.system
    if verdict is None or not verdict.word.open or len(system.coordinates) > MOST_COORDINATES:
        return found
    values = parameter_values(scene, equilibrium)
    if values is None or not all(isinstance(x, Fraction) for x in values.values()):
        return found
    try:
        there = rest(at_numbers(system, values))
        forms = _motion(system, there, values)
        if forms is None:
            return found
        candidate = candidate_at(there, forms)
        if not all(candidate.vanishes(x) for x in there.at_rest):
            return found
        place = candidate.place(there, exact_rates(there))
        again = linear_at_rest(there).verdict(place)
        return found if again.word.open else replace(found, numerical=again)
    except NOT_THERE:
        return found


def _motion(system: System, there: Rest, values: Mapping[str, Fraction]) -> dict[str, LinearForm] | None:
    """The constant coordinates on the unperturbed motion; None where one is no number and no multiple of pi."""
    numbers = {name: number(x) for name, x in values.items()}
    forms = {}
    for name, (value, _) in motion_values(system).items():
        if name in there.constant:
            form = linear_form(substitute(value, numbers))
            if form is None or form.coefficients:
                return None
            forms[name] = form
    return forms
