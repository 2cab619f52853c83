"""The parts of a page as JSON, by what is asked for: a part that cannot be had says why, in ``why``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

from mbsym.algebra.failures import Failure
from mbsym.analysis import Analysis
from mbsym.expressions.tree import Expression, substitute
from mbsym.model.system import System, rational, with_values
from mbsym.picture.build import picture
from mbsym.picture.encode import as_json
from mbsym.picture.modes import modes, modes_json
from mbsym.picture.motion import motion, motion_json
from mbsym.picture.resting import at_rest, at_rest_json
from mbsym.simulation import Request

Values = Mapping[str, Expression]


def picture_part(system: System, overrides: Values) -> dict[str, Any]:
    """See ``picture``."""
    return as_json(picture(system, overrides))


def motion_part(
    system: System, drawn: dict[str, Any], time: float, overrides: Values, watch: Callable[[float], None]
) -> dict[str, Any]:
    """The motion from 0 to ``time``; raises what ``motion`` raises."""
    return motion_json(motion(system, Request(time), overrides, watch), drawn["program"]["inputs"])


def modes_part(system: System, overrides: Values) -> dict[str, Any]:
    """The modes at the values of the description and of ``overrides``."""
    try:
        return modes_json(modes(Analysis(with_values(system, overrides))))
    except Failure as reason:
        return {"why": f"{reason}"}


def equilibria_part(system: System, overrides: Values) -> dict[str, Any]:
    """The relative equilibria at exact values; a value that is not rational has none."""
    try:
        return at_rest_json(at_rest(with_values(system, overrides), exact_values(system, overrides)))
    except Failure as reason:
        return {"why": f"{reason}"}


def exact_values(system: System, overrides: Values) -> dict[str, Fraction]:
    """The ``overrides`` of parameters that are rational numbers, those in terms of other parameters evaluated."""
    known = {item.name: item.value for item in system.parameters if item.value is not None} | dict(overrides)
    found = {}
    for name in (x for x in overrides if x in system.parameter_names):
        value = rational(substitute(overrides[name], {k: v for k, v in known.items() if k != name}))
        if value is not None:
            found[name] = value
    return found
