"""Relative equilibria, each judged as ``run`` would judge it if the description gave it as the unperturbed motion."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

from mbsym.algebra.failures import NOT_THERE, Failure
from mbsym.algebra.parts import installed
from mbsym.analysis import higher
from mbsym.analysis.judge import Judge
from mbsym.analysis.pipeline import Analysis
from mbsym.analysis.stages import Unavailable
from mbsym.expressions.tree import Expression, Name, multiply, number
from mbsym.mechanics.motion import motion_values
from mbsym.mechanics.rest import Value, at_numbers
from mbsym.model.substitution import with_free_rates
from mbsym.model.system import MotionEntry, Parameter, System
from mbsym.problems.relative_equilibria.equilibria import WITHIN, Equilibria, equilibria
from mbsym.problems.relative_equilibria.listing import CoordinateValue, RelativeEquilibrium
from mbsym.problems.relative_equilibria.verdict import MOST_COORDINATES
from mbsym.problems.stability.words import Because


def relative_equilibria(system: System, values: Mapping[str, Value], within: float = WITHIN) -> Equilibria:
    """``problems.equilibria`` with the verdicts that terms of higher order decide; raises as that does.

    Raises Unavailable, too, where a check fails that the list stands on.
    """
    judged_equilibria = judged(system, values, equilibria(system, values, within))
    withdrawn = Analysis(system, ()).broken(Analysis.equilibria.stands_on)
    if withdrawn is not None:
        raise Unavailable("equilibria", withdrawn)
    return judged_equilibria


def judged(system: System, values: Mapping[str, Value], candidates: Equilibria) -> Equilibria:
    """Verdicts at isolated places that are open, or rest on an energy that may fall, judged further."""
    if not installed("mbsym.problems.normal_forms") or len(system.coordinates) > MOST_COORDINATES:
        return candidates
    bare = at_numbers(system, values)
    judge = Judge(Analysis(bare, ()))
    listed = (
        _decided(bare, equilibrium)
        if equilibrium.verdict.word.open or judge.may_add(equilibrium.verdict)
        else equilibrium
        for equilibrium in candidates.equilibria
    )
    return replace(candidates, equilibria=tuple(listed))


def _decided(bare: System, equilibrium: RelativeEquilibrium) -> RelativeEquilibrium:
    """Coordinates without an exact text are parameters that are known by their enclosures."""
    if equilibrium.coordinates_of:
        return equilibrium
    enclosed = {
        f"{_PLACE}{x.name}": equilibrium.enclosures[x.name]
        for x in equilibrium.values
        if not x.exact and x.name in bare.coordinates
    }
    places = {x.name: _exact(x) if x.exact else Name(f"{_PLACE}{x.name}") for x in equilibrium.values}
    described = {entry.coordinate for entry in bare.motion}
    follow = {name for name, velocity in zip(bare.coordinates, bare.velocities, strict=True) if velocity in places}
    motion = tuple(
        MotionEntry(name, places.get(name, value), rate)
        for name, (value, rate) in motion_values(bare).items()
        if name not in follow and (name in places or not bare.constraints or name in described)
    )
    there = replace(bare, motion=motion, parameters=tuple(map(Parameter, enclosed)))
    analysis = Analysis(with_free_rates(there) if bare.constraints else there, ())
    try:
        if any(map(equilibrium.verdict.because, _KNOWN_BETTER)) and bare.constraints:
            stability = None if enclosed else analysis.stability
            return (
                equilibrium
                if stability is None
                else replace(equilibrium, verdict=stability.numerical or stability.verdict)
            )
        if (bare.constraints and equilibrium.free) or not {*equilibrium.free} <= higher.ignorable(analysis)[1]:
            return equilibrium
        return replace(equilibrium, verdict=Judge(analysis).decided(equilibrium.verdict, enclosed))
    except (Failure, *NOT_THERE):
        return equilibrium


#: Why the list leaves open what the whole of problem 6 may decide, where constraints tie velocities.
_KNOWN_BETTER = (Because.NO_EQUATIONS, Because.MORE_ZERO_ROOTS, Because.NEAR_BORDER)

#: How names of parameters begin that are coordinates of a place; parameters of the description are numbers by then.
_PLACE = "place_dot_"


def _exact(value: CoordinateValue) -> Expression:
    """The value of a coordinate whose text is exact: a rational number, or an angle as twelfths of pi."""
    if not value.angle:
        return number(Fraction(value.text))
    return multiply(number(Fraction(round(12 * value.value / math.pi), 12)), Name("pi"))
