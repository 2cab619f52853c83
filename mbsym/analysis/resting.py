"""Relative equilibria, each judged as ``run`` would judge it if the description gave it as the unperturbed motion."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, TypeVar

from mbsym.algebra.failures import NOT_THERE, Failure
from mbsym.algebra.parts import installed
from mbsym.algebra.rationals import fraction
from mbsym.analysis.judge import Judge
from mbsym.analysis.pipeline import Analysis
from mbsym.analysis.stages import Unavailable
from mbsym.expressions.tree import Expression, Name, multiply, names, number
from mbsym.mechanics.motion import motion_values
from mbsym.mechanics.rest import Value, at_numbers
from mbsym.model.substitution import with_free_rates
from mbsym.model.system import MotionEntry, Parameter, System
from mbsym.problems.constrained_balance import ConstrainedBalance
from mbsym.problems.relative_equilibria.equilibria import WITHIN, Equilibria, equilibria
from mbsym.problems.relative_equilibria.listing import (
    ELSEWHERE,
    CoordinateValue,
    EquilibriumFamily,
    RelativeEquilibrium,
    also_elsewhere,
)
from mbsym.problems.relative_equilibria.verdict import MOST_COORDINATES
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.words import Because

Listed = TypeVar("Listed", RelativeEquilibrium, EquilibriumFamily)


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
    """Verdicts that are open, or rest on an energy that may fall, judged further: of families at their samples."""
    if not installed("mbsym.problems.normal_forms") or len(system.coordinates) > MOST_COORDINATES:
        return candidates
    bare = at_numbers(system, values)
    judge = Judge(Analysis(bare, ()))

    def further(listed: Sequence[Listed]) -> tuple[Listed, ...]:
        return tuple(
            replace(one, verdict=_decided(one.system if one.coordinates_of and one.system else bare, one))
            if one.verdict.word.open or judge.may_add(one.verdict)
            else one
            for one in listed
        )

    return replace(candidates, equilibria=further(candidates.equilibria), families=further(candidates.families))


def _decided(bare: System, listed: RelativeEquilibrium | EquilibriumFamily) -> Verdict:
    """The verdict there; where any value of some coordinates will do at 0 of them, and in samples elsewhere."""
    known = listed.verdict
    if isinstance(listed, EquilibriumFamily):
        if bare.constraints and known.because(Because.NOT_ENCLOSED):  # the constraints are singular there
            return known
        return _decided_at(_at(bare, listed.sample, listed), known)
    if bare.constraints and listed.free and not any(map(known.because, _KNOWN_BETTER)):
        return known

    def sampled(free: Sequence[str], t: Fraction) -> _Rest:
        return _at(bare, (*listed.values, *(_sampled(bare, name, t) for name in free)), listed)

    zero = sampled(listed.free, Fraction(0))
    at_zero = _decided_at(zero, known)
    free = () if bare.constraints and at_zero.word.open else _telling(bare, listed.free, zero)
    if not free:
        return at_zero
    words = {_decided_at(sampled(free, t), known).word for t in map(fraction, ELSEWHERE)}
    return also_elsewhere(at_zero, words, free)


def _telling(bare: System, free: Sequence[str], zero: _Rest) -> tuple[str, ...]:
    """The coordinates of which the equations of motion know more than that any value is one of rest."""
    if not free:
        return ()
    try:
        balance = (zero.rest if bare.constraints else Analysis(bare, ())).balance
        if isinstance(balance, ConstrainedBalance):
            return tuple(name for name in free if not balance.shifts(name))
        return tuple(free) if bare.constraints else tuple(name for name in free if name not in balance.ignorable)
    except (Failure, *NOT_THERE):
        return tuple(free)


def _sampled(bare: System, name: str, t: Fraction) -> CoordinateValue:
    """t, or t pi/12 of an angle."""
    angle = any(name in names(x) for body in bare.bodies for _, x in body.rotation.turns())
    return CoordinateValue(name, str(t), float(t) * math.pi / 12 if angle else float(t), angle, True)


@dataclass(frozen=True)
class _Rest:
    """A rest; coordinates that are not known exactly are parameters, ``enclosed`` by balls."""

    rest: Analysis
    enclosed: Mapping[str, Any]


def _at(bare: System, values: Sequence[CoordinateValue], listed: RelativeEquilibrium | EquilibriumFamily) -> _Rest:
    """The rest at one place."""
    known_places = {x.name: _exact(x) for x in values}
    enclosed = {
        f"{_PLACE}{name}": listed.enclosures[name]
        for name, x in known_places.items()
        if x is None and name in bare.coordinates
    }
    places = {name: Name(f"{_PLACE}{name}") if x is None else x for name, x in known_places.items()}
    described = {entry.coordinate for entry in bare.motion}
    follow = {name for name, velocity in zip(bare.coordinates, bare.velocities, strict=True) if velocity in places}
    motion = tuple(
        MotionEntry(name, places.get(name, value), rate)
        for name, (value, rate) in motion_values(bare).items()
        if name not in follow and (name in places or not bare.constraints or name in described)
    )
    there = replace(bare, motion=motion, parameters=tuple(map(Parameter, enclosed)))
    return _Rest(Analysis(with_free_rates(there) if bare.constraints else there, ()), enclosed)


def _decided_at(place: _Rest, known: Verdict) -> Verdict:
    """The verdict at one place."""
    analysis, enclosed = place.rest, place.enclosed
    try:
        judge = Judge(analysis)
        if not analysis.system.constraints:  # problem 6 knows symmetries that the list does not, and other words
            return judge.decided(known, enclosed) if enclosed else judge({})
        better = any(map(known.because, _KNOWN_BETTER))
        verdict = known if better else judge.decided(known, enclosed)
        if enclosed or not verdict.word.open or any(map(known.because, _SINGULAR)):
            return verdict
        return analysis.stability.numerical or analysis.stability.verdict
    except (Failure, *NOT_THERE):
        return known


#: Why the list leaves open what the whole of problem 6 may decide, where constraints tie velocities.
_KNOWN_BETTER = (Because.NO_EQUATIONS, Because.MORE_ZERO_ROOTS, Because.NEAR_BORDER)

#: Where the constraints have another rank than near by.
_SINGULAR = (Because.RANK_LOST, Because.OTHER_BRANCH)

#: How names of parameters begin that are coordinates of a place; parameters of the description are numbers by then.
_PLACE = "place_dot_"


def _exact(value: CoordinateValue) -> Expression | None:
    """A coordinate that is known exactly: of an exact text a rational number, or an angle as twelfths of pi."""
    if not value.exact:
        return value.exactly
    if not value.angle:
        return number(Fraction(value.text))
    return multiply(number(Fraction(round(12 * value.value / math.pi), 12)), Name("pi"))
