"""The numbers a picture begins with: those of a run, and stand-ins where nobody gave any.

A simulation refuses to make numbers up.  A description that is being written is drawn nevertheless, at stand-ins that
are told: 1 for a parameter (-1 where its sign is negative), 0 for a coordinate.  Assumptions may then be broken: the
picture proves nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from mbsym.algebra.failures import Failure
from mbsym.expressions.tree import Expression, number
from mbsym.mechanics.given_matrices import refuse_matrices
from mbsym.model.system import System
from mbsym.numerics.scenario import Incomplete, Scenario, initial_values, own_values, scenario

NEGATIVE = ("negative", "nonpositive")


@dataclass(frozen=True)
class Start:
    """``scenario`` at the start; ``stand_ins`` by name; ``at_zero``; ``moved`` (name, given, found); ``open_loop``."""

    scenario: Scenario
    stand_ins: tuple[tuple[str, float], ...] = ()
    at_zero: tuple[str, ...] = ()
    moved: tuple[tuple[str, float, float], ...] = ()
    open_loop: str = ""


def start(system: System, overrides: Mapping[str, Expression] | None = None) -> Start:
    """The start of a system.

    Raises Incomplete with what cannot be (two numbers for one parameter), Failure for a system given by its matrices.
    """
    refuse_matrices(system, "there are no bodies to draw")
    given = dict(overrides or {})
    found, stand_ins, at_zero = _numbers(system, given)
    if not found.system.constraints:
        return Start(found, stand_ins, at_zero)
    from mbsym.numerics.closing import closed

    try:
        there = closed(found)
    except Failure as reason:
        return Start(found, stand_ins, at_zero, (), str(reason))
    coordinates = system.coordinates
    moves = tuple((x.name, x.given, x.found) for x in there.moves if x.name in coordinates)
    return Start(there.scenario, stand_ins, at_zero, moves)


def _numbers(
    system: System, given: dict[str, Expression]
) -> tuple[Scenario, tuple[tuple[str, float], ...], tuple[str, ...]]:
    try:
        return scenario(system, given, declared=True), (), ()
    except Incomplete as error:
        if not error.lack.names:
            raise
        missing = {*error.lack.names} & {*system.parameter_names}
    chosen: dict[str, Expression] = {}
    while missing:
        # What follows from others is left to do so; only where nothing else is left is it stood in for as well.
        related = {item.name for item in system.relations}
        own = [x for x in system.parameters if x.name in missing and x.value is None and x.name not in related]
        for item in own or [x for x in system.parameters if x.name in missing]:
            chosen[item.name] = number(-1 if item.sign in NEGATIVE else 1)
        missing = _lacking(system, given | chosen)
    if chosen:  # numbers that mean nothing need not agree with signs
        system = replace(system, parameters=tuple(replace(item, sign="real") for item in system.parameters))
    told = tuple((name, -1.0 if item == number(-1) else 1.0) for name, item in chosen.items())
    try:
        return scenario(system, given | chosen, assumed=not chosen, declared=True), told, ()
    except Incomplete as error:
        if not error.lack.names:
            raise
    begun = {} if own_values(system, given) else initial_values(system, given)
    at_zero = tuple(x for x in system.coordinates if x not in begun or begun[x].position is None)
    return scenario(system, given | chosen, state=False, assumed=not chosen), told, at_zero


def _lacking(system: System, given: Mapping[str, Expression]) -> set[str]:
    """The parameters that have no value yet."""
    try:
        scenario(system, given, state=False, assumed=False)
    except Incomplete as error:
        return {*error.lack.names} & {*system.parameter_names} - {*given}
    return set()
