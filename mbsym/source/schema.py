"""The JSON Schema of the YAML format, for editors that complete and check while one types.

It knows shapes and keys; what names mean and what is physically possible, only :func:`mbsym.source.read` knows.
"""

from __future__ import annotations

from typing import Any

from mbsym.expressions.table import CUBIC, ENDS, EXTRAPOLATE, HOLD, LINEAR, OUTSIDE_ZERO
from mbsym.model.claims import CLAIMS, INITIAL_STATE, MOST_ORDER, NECESSARY, SUFFICIENT
from mbsym.model.linear import MATRICES
from mbsym.model.loads import EXACT, GRAVITY_ORDERS
from mbsym.model.system import LANGUAGES, SHAPES
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
    VERSION,
)
from mbsym.source.linear import MOST_COORDINATES
from mbsym.source.small import MOST_POWER
from mbsym.source.speeds import ANGLES, COSINES, QUATERNION
from mbsym.source.symbols import LONGEST
from mbsym.source.tables import MAX_POINTS

Schema = dict[str, Any]

_NAME = "^[A-Za-z][A-Za-z0-9_]*$"


def _reference(definition: str, description: str = "") -> Schema:
    found: Schema = {"$ref": f"#/$defs/{definition}"}
    return {**found, "description": description} if description else found


def json_schema() -> Schema:
    """The schema (draft 2020-12) of a description in YAML."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:mbsym:description:{VERSION}",
        "title": "mbsym description of a mechanical system",
        **_record(SYSTEM, _system_values(), required=("mbsym", "name")),
        "oneOf": [{"required": ["bodies"]}, {"required": ["linear system"]}],
        "$defs": _definitions(),
    }


def _record(keys: dict[str, str], values: dict[str, Schema], required: tuple[str, ...] = ()) -> Schema:
    """A mapping with a fixed set of keys (other spellings included), each an expression unless ``values`` says more."""
    default = _reference("expression")
    properties = {key: {**values.get(key, default), "description": meaning} for key, meaning in keys.items()}
    properties |= {other: properties[key] for other, key in ALIASES.items() if key in keys}
    schema: Schema = {"type": "object", "properties": properties, "additionalProperties": False}
    return {**schema, "required": list(required)} if required else schema


def _named(value: Schema) -> Schema:
    """A mapping whose keys are names that the author chooses."""
    return {"type": "object", "patternProperties": {_NAME: value}, "additionalProperties": False}


def _system_values() -> dict[str, Schema]:
    names = {"type": "array", "items": {"type": "string", "pattern": _NAME}, "uniqueItems": True}
    expression = _reference("expression")
    return {
        "mbsym": {"enum": [1, "1"]},
        "name": _TEXT,
        "description": _TEXT,
        "source": _TEXT,
        "latex": _named({"type": "string", "maxLength": LONGEST}),
        "order": names,
        "language": {"enum": list(LANGUAGES)},
        "dimensionless time": expression,
        "parameters": {"anyOf": [_named(_reference("parameter")), names]},
        "prescribed": _named({"anyOf": [expression, _record(PRESCRIBED, _TEXTS, required=("rate",))]}),
        "inputs": {"anyOf": [_named({"anyOf": [_TEXT, {"type": "null"}, _record(INPUT, _TEXTS)]}), names]},
        "outputs": _named(expression),
        "tables": _named(_table_record()),
        "bodies": {"type": "array", "items": _reference("body"), "minItems": 1},
        "linear system": _linear_record(),
        "loads": {"type": "array", "items": _reference("load")},
        "constraints": {"type": "array", "items": _reference("constraint")},
        "dependent": names,
        "reactions": {"type": "array", "items": _BODY_NAME, "uniqueItems": True},
        "relations": _named(expression),
        "assumptions": {"type": "array", "items": {"type": "string"}},
        "motion": _named({"anyOf": [expression, _record(MOTION, {})]}),
        "notation": _named(expression),
        "values": _named(expression),
        "small parameter": _small_parameter(names),
        "initial": _named({"anyOf": [expression, _record(INITIAL, {})]}),
        "abbreviations": _named(expression),
        "units": _named(_UNIT),
        "limits": _named({**_list(2), "minItems": 2}),
        "claims": {"type": "array", "items": _reference("claim")},
    }


_UNIT: Schema = {"type": ["string", "integer"]}
#: What is for people: a name may be 2024 or yes, and nobody needs quotes for it.
_TEXT: Schema = {"type": ["string", "number", "boolean"]}
_TEXTS: dict[str, Schema] = {"meaning": _TEXT, "unit": _UNIT}
_BODY_NAME = _TEXT


def _table_values() -> dict[str, Schema]:
    points: Schema = {"type": "array", "items": {**_list(2), "minItems": 2}, "minItems": 2, "maxItems": MAX_POINTS}
    words: dict[str, Schema] = {"between": {"enum": [LINEAR, CUBIC]}}
    words["outside"] = {"enum": [HOLD, OUTSIDE_ZERO, EXTRAPOLATE, ENDS]}
    columns: Schema = {"type": "array", "items": _UNIT, "minItems": 2, "maxItems": 2}
    own: dict[str, Schema] = {"file": {"type": "string"}, "columns": columns, "sha256": {"type": "string"}}
    return {"points": points, **own, **words, "unit": _UNIT}


def _table_record() -> Schema:
    """A table has points, or a file of them."""
    return {**_record(TABLE, _table_values()), "oneOf": [{"required": ["points"]}, {"required": ["file"]}]}


def _small_parameter(names: Schema) -> Schema:
    """A name, or one name with what is said of it."""
    powers = _named({"type": "integer", "minimum": -MOST_POWER, "maximum": MOST_POWER})
    record = _record(
        SMALL_PARAMETER,
        {"powers": powers, "fast": names, "slow": names, "leading": {"type": "string", "pattern": _NAME}},
    )
    return {"anyOf": [{"type": "string", "pattern": _NAME}, {**_named(record), "minProperties": 1, "maxProperties": 1}]}


def _linear_record() -> Schema:
    row: Schema = {"type": "array", "items": _reference("expression"), "minItems": 1, "maxItems": MOST_COORDINATES}
    rows: Schema = {"type": "array", "items": row, "minItems": 1, "maxItems": MOST_COORDINATES}
    file = _record(MATRIX_FILE, {"file": {"type": "string"}, "sha256": {"type": "string"}}, required=("file",))
    names: Schema = {"type": "array", "items": {"type": "string", "pattern": _NAME}, "uniqueItems": True, "minItems": 1}
    values: dict[str, Schema] = {key: {"anyOf": [rows, file]} for key in MATRICES}
    return _record(LINEAR_SYSTEM, {**values, "coordinates": names}, required=("coordinates",))


def _definitions() -> dict[str, Schema]:
    return {
        "expression": {
            "type": ["string", "number"],
            "description": "numbers, names, + - * / **, parentheses, sin cos tan sqrt exp log atan sinh cosh tanh; "
            "in loads abs sign step pulse and tables",
        },
        "vector": {"type": "array", "items": _reference("expression"), "minItems": 3, "maxItems": 3},
        "parameter": {"anyOf": [{"enum": list(SIGNS)}, _reference("expression"), _parameter_record()]},
        "body": _record(BODY, _body_values(), required=("name", "mass")),
        "point": _record(POINT, {"body": _BODY_NAME, "point": _reference("vector")}, required=("body", "point")),
        "claim": _record(CLAIM, _claim_values(), required=("claim",)),
        "load": _loads(),
        "axis": _record(AXIS, {"body": _BODY_NAME, "axis": _reference("vector")}, required=("body", "axis")),
        "constraint": _constraints(),
    }


def _parameter_record() -> Schema:
    """``sign`` may also be written as ``positive: true``."""
    keys = {**PARAMETER, **{sign: "true, short for sign: " + sign for sign in SIGNS}}
    return _record(keys, {**_TEXTS, "sign": {"enum": list(SIGNS)}, **{sign: {"const": True} for sign in SIGNS}})


def _body_values() -> dict[str, Schema]:
    vector = _reference("vector")
    axes: Schema = {"type": "array", "items": {"enum": [0, 1, 2, 3]}, "maxItems": 3}
    angles: Schema = {"type": "array", "items": _reference("expression"), "maxItems": 3}
    matrix: Schema = {"type": "array", "items": vector, "minItems": 3, "maxItems": 3}
    return {
        "name": _TEXT,
        "attached to": _BODY_NAME,
        "rotation": _record(ROTATION, {"axes": axes, "angles": angles}, required=("axes", "angles")),
        "connection point": vector,
        "relative velocity": vector,
        "mass centre": vector,
        "inertia about": {"enum": ["joint", "mass centre", "mass center"]},
        "inertia": {
            "anyOf": [
                vector,
                matrix,
                _record(
                    INERTIA,
                    {"tensor": {"anyOf": [vector, matrix]}, "accept": {"enum": [True, False, "true", "false"]}},
                    required=("tensor",),
                ),
            ]
        },
        "gyrostatic moment": vector,
        "coordinates": {"type": "array", "items": {"type": "string", "pattern": _NAME}},
        "shapes": {"type": "array", "items": _record(SHAPE, _shape_values())},
        "speeds": _named(_reference("expression")),
        "orientation": {
            "anyOf": [
                {"enum": [ANGLES, COSINES, QUATERNION]},
                _named({"enum": [1, 2, 3, "1", "2", "3", QUATERNION]}),
            ]
        },
    }


def _shape_values() -> dict[str, Schema]:
    several = {kind: {**_list(count), "minItems": count} for kind, count in SHAPES.items() if count > 1}
    turns: dict[str, Schema] = {"axes": {"type": "array", "items": {"enum": [0, 1, 2, 3]}}, "angles": {"type": "array"}}
    return {**several, "at": _reference("vector"), "rotation": _record(ROTATION, turns, required=("axes", "angles"))}


def _list(most: int) -> Schema:
    return {"type": "array", "items": _reference("expression"), "maxItems": most}


_ORDERS = [str(k) for k in range(MOST_ORDER + 1)]


def _claim_values() -> dict[str, Schema]:
    state: Schema = {"type": "object", "patternProperties": {_NAME: _reference("expression")}}
    return {
        "claim": {"enum": list(CLAIMS)},
        "of": {"type": ["string", "integer"]},
        "entry": {"type": "array", "items": {"type": ["string", "integer"]}, "minItems": 2, "maxItems": 2},
        "component": {"enum": [1, 2, 3, "1", "2", "3"]},
        "variable": {"type": "string", "pattern": _NAME},
        "order": {"anyOf": [{"type": "integer", "minimum": 0, "maximum": MOST_ORDER}, {"enum": _ORDERS}]},
        "that": {"type": "string"},
        "as": {"enum": [NECESSARY, SUFFICIENT]},
        "digits": {"anyOf": [{"type": "integer", "minimum": 1}, {"type": "string", "pattern": "^[1-9][0-9]{0,3}$"}]},
        "state": {"anyOf": [{"const": INITIAL_STATE}, {**state, "additionalProperties": False}]},
        "place": _TEXT,
    }


_REQUIRED = {
    "newtonian gravity": ("constant", "about"),
    "spring": ("stiffness",),
    "damper": ("coefficient",),
    "isotropic damper": ("between", "coefficient"),
    "force": ("body", "point", "components", "axes"),
    "torque": ("body", "components", "axes"),
}


def _constraints() -> Schema:
    """One object with a property for each kind, as for loads."""
    pairs = {
        kind: {"type": "array", "items": _reference(end), "minItems": 2, "maxItems": 2}
        for kind, end in (("coincide", "point"), ("parallel", "axis"), ("distance", "point"))
    }
    bodies = dict.fromkeys(("body", "axes", "on"), _BODY_NAME)
    equation: Schema = {"type": "string"}
    kinds = {
        "coincide": pairs["coincide"],
        "parallel": pairs["parallel"],
        "distance": _record(CONSTRAINTS["distance"], {"between": pairs["distance"]}, required=("between", "length")),
        "relation": equation,
        "rolling": _record(
            CONSTRAINTS["rolling"], {**bodies, "point": _reference("vector")}, required=("body", "point", "on")
        ),
        "velocity": equation,
    }
    return {
        "type": "object",
        "description": "one kind of constraint with its data",
        "properties": {kind: {**data, "description": CONSTRAINT_MEANINGS[kind]} for kind, data in kinds.items()},
        "additionalProperties": False,
        "minProperties": 1,
        "maxProperties": 1,
    }


def _loads() -> Schema:
    """One object with a property for each kind, not a choice of objects: a validator then points at the wrong key."""
    return {
        "type": "object",
        "description": "one kind of load with its data",
        "properties": {spelling: data for kind in LOADS for spelling, data in _load(kind).items()},
        "additionalProperties": False,
        "minProperties": 1,
        "maxProperties": 1,
    }


def _load(kind: str) -> dict[str, Schema]:
    """A kind of load in all its spellings."""
    vector = _reference("vector")
    values: dict[str, Schema] = {
        **dict.fromkeys(("vector", "direction", "components"), vector),
        **dict.fromkeys(("body", "axes", "centre", "about", "reaction on"), _BODY_NAME),
        "order": {"enum": [*GRAVITY_ORDERS, *(str(order) for order in GRAVITY_ORDERS if order != EXACT)]},
        "coordinate": {"type": "string", "pattern": _NAME},
        "between": {"type": "array", "items": _reference("point"), "minItems": 2, "maxItems": 2},
        "point": vector,
    }
    if LOADS[kind]:
        data = _record(LOADS[kind], values, required=_REQUIRED.get(kind, ()))
    elif kind == "generalized force":
        data = _named(_reference("expression"))
    else:
        data = _reference("expression")
    spellings = [kind, *(other for other, key in ALIASES.items() if key == kind)]
    return {spelling: {**data, "description": LOAD_MEANINGS[kind]} for spelling in spellings}
