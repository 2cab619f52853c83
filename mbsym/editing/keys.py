"""Which keys may stand where in a description: the tables of the reader by the path of a place."""

from __future__ import annotations

from collections.abc import Mapping

from mbsym.source.keys import (
    ALIASES,
    AXIS,
    BODY,
    CLAIM,
    CONSTRAINT_MEANINGS,
    CONSTRAINTS,
    INERTIA,
    INITIAL,
    INPUT,
    LINEAR_SYSTEM,
    LOAD_MEANINGS,
    LOADS,
    MATRIX_FILE,
    MOTION,
    PARAMETER,
    POINT,
    PRESCRIBED,
    ROTATION,
    SHAPE,
    SIGNS,
    SMALL_PARAMETER,
    SYSTEM,
    TABLE,
)

_SIGN_WORDS = {sign: f"true, short for sign: {sign}" for sign in SIGNS}

#: Top-level key -> keys of the record that each of its names has.
_RECORDS: dict[str, Mapping[str, str]] = {
    "parameters": {**PARAMETER, **_SIGN_WORDS},
    "prescribed": PRESCRIBED,
    "inputs": INPUT,
    "tables": TABLE,
    "motion": MOTION,
    "initial": INITIAL,
}

#: Key inside a body -> keys inside it.
_IN_BODY: dict[str, Mapping[str, str]] = {"rotation": ROTATION, "inertia": INERTIA, "shapes": SHAPE}


def keys_in(path: tuple[str, ...]) -> Mapping[str, str]:
    """The keys that a mapping at this place may have, with their meanings; none where names are chosen freely."""
    plain = tuple(ALIASES.get(key, key) for key in path)
    match plain:
        case ():
            return SYSTEM
        case ("bodies",):
            return BODY
        case ("bodies", *_, "shapes", "rotation"):
            return ROTATION
        case ("bodies", *_, key):
            return _IN_BODY.get(key, {})
        case ("small parameter", _):
            return SMALL_PARAMETER
        case ("linear system",):
            return LINEAR_SYSTEM
        case ("linear system", _):
            return MATRIX_FILE
        case ("loads",):
            return LOAD_MEANINGS
        case ("loads", kind):
            return LOADS.get(kind, {})
        case ("loads", _, "between"):
            return POINT
        case ("constraints",):
            return CONSTRAINT_MEANINGS
        case ("constraints", "coincide") | ("constraints", "distance", "between"):
            return POINT
        case ("constraints", "parallel"):
            return AXIS
        case ("constraints", kind):
            return CONSTRAINTS.get(kind, {})
        case ("claims",):
            return CLAIM
        case (section, _):
            return _RECORDS.get(section, {})
    return {}
