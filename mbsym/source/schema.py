"""The JSON Schema of the YAML format, for editors that complete and check while one types.

It follows from the table of keys (``mbsym.source.keys``): it knows shapes and keys; what names mean and what is
physically possible, only :func:`mbsym.source.read` knows.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mbsym.source import grammar
from mbsym.source.keys import ALIASES, DESCRIPTION, VERSION, spellings

Schema = dict[str, Any]

_NAME = "^[A-Za-z][A-Za-z0-9_]*$"

#: What a text has to hold, if it is one: a blank one is no value.
_SOMETHING = r"\S"

_EXPRESSION: Schema = {
    "type": ["string", "number"],
    "pattern": _SOMETHING,
    "description": "numbers, names, + - * / **, parentheses, sin cos tan sqrt exp log atan sinh cosh tanh; "
    "in loads abs sign step pulse and tables",
}

#: Types that have no parts.
_PLAIN: dict[type[grammar.Type], Schema] = {
    grammar.Text: {"type": ["string", "number", "boolean"], "pattern": _SOMETHING},
    grammar.BodyName: {"type": ["string", "number", "boolean"], "pattern": _SOMETHING},
    grammar.Unit: {"type": ["string", "integer"], "pattern": _SOMETHING},
    grammar.Name: {"type": "string", "pattern": _NAME},
    grammar.Index: {"type": ["string", "integer"], "pattern": _SOMETHING},
    grammar.About: {"type": ["string", "integer"], "pattern": _SOMETHING},
    grammar.Equation: {"type": "string", "pattern": _SOMETHING},
    grammar.Nothing: {"type": "null"},
}


def json_schema() -> Schema:
    """The schema (draft 2020-12) of a description in YAML."""
    definitions: Schema = {"expression": _EXPRESSION}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:mbsym:description:{VERSION}",
        "title": "mbsym description of a mechanical system",
        **_record(DESCRIPTION, definitions),
        "$defs": definitions,
    }


def _schema(value: grammar.Type, definitions: Schema) -> Schema:
    """The schema of a type; those that have a name there are put into ``definitions``."""
    match value:
        case grammar.Formula() | grammar.Figure():
            return _reference("expression")
        case grammar.Vector():
            return _defined("vector", lambda: _list(_reference("expression"), 3, 3), definitions)
        case grammar.BodyName(new=False):
            return _defined("body name", lambda: _PLAIN[grammar.BodyName], definitions)
        case grammar.Word(choices):
            return {"enum": _choices(choices)}
        case grammar.Integer(least, most):
            number = {"type": "integer", "minimum": least, **({} if most is None else {"maximum": most})}
            return {"anyOf": [number, {"type": "string", "pattern": f"^{'-?' if least < 0 else ''}[0-9]{{1,4}}$"}]}
        case grammar.String(longest):
            return {"type": "string", "pattern": _SOMETHING, **({} if longest is None else {"maxLength": longest})}
        case grammar.Flag(false):
            return {"enum": [True, False, "true", "false"]} if false else {"const": True}
        case grammar.Listed(item, least, most, unique):
            return _list(_schema(item, definitions), least, most) | ({"uniqueItems": True} if unique else {})
        case grammar.Named(item, one=one):
            names = {"type": "object", "patternProperties": {_NAME: _schema(item, definitions)}}
            return {**names, "additionalProperties": False, **(_ONE if one else {})}
        case grammar.Either(types, called):
            schema: Schema = {"anyOf": [_schema(alternative, definitions) for alternative in types]}
            return _defined(called, lambda: schema, definitions) if called else schema
        case grammar.Ends(record):
            return _list(_schema(record, definitions), 2, 2)
        case grammar.Record():
            if not value.called:
                return _record(value, definitions)
            return _defined(value.called, lambda: _record(value, definitions), definitions)
        case grammar.Kinds(kinds, called):
            return _defined(called, lambda: _kinds(kinds, called, definitions), definitions)
    return _PLAIN[type(value)]


#: Validators tell the place of a value that ``false`` forbids as that of what holds it.
_NEVER: Schema = {"not": {}}
_ONE: Schema = {"minProperties": 1, "maxProperties": 1}


def _reference(definition: str) -> Schema:
    return {"$ref": f"#/$defs/{definition}"}


def _defined(name: str, make: Any, definitions: Schema) -> Schema:
    if name not in definitions:
        definitions[name] = make()
    return _reference(name)


def _list(item: Schema, least: int, most: int | None) -> Schema:
    schema: Schema = {"type": "array", "items": item}
    return schema | ({"minItems": least} if least else {}) | ({} if most is None else {"maxItems": most})


def _choices(choices: tuple[str | int, ...]) -> list[str | int]:
    """Words in all their spellings; numbers may be quoted."""
    words = [other for choice in choices for other in (choice, *spellings(str(choice)))]
    return [*words, *(str(choice) for choice in choices if isinstance(choice, int))]


def _spellings(keys: Mapping[str, Schema]) -> Schema:
    """Keys in all their spellings."""
    return {**keys, **{other: keys[key] for other, key in ALIASES.items() if key in keys}}


def _key(key: grammar.Key, definitions: Schema) -> Schema:
    return {**_schema(key.type, definitions), "description": key.meaning}


def _record(record: grammar.Record, definitions: Schema) -> Schema:
    """A mapping with a fixed set of keys."""
    properties = {name: _key(key, definitions) for name, key in record.keys.items()}
    schema: Schema = {"type": "object", "properties": _spellings(properties), "additionalProperties": False}
    schema |= _required([name for name, key in record.keys.items() if key.required])
    return schema | ({"oneOf": [{"required": [name]} for name in record.one_of]} if record.one_of else {})


def _required(names: list[str], any_of: tuple[str, ...] = ()) -> Schema:
    """That keys are there, in one of their spellings, and one of several others."""
    plain = [name for name in names if not spellings(name)]
    several = [(name, *spellings(name)) for name in names if spellings(name)]
    several += [any_of] if any_of else []
    either = [
        {"if": {"not": {"anyOf": [{"required": [other]} for other in others]}}, "then": {"required": [first]}}
        for first, *others in several
    ]
    return {**({"required": plain} if plain else {}), **({"allOf": either} if either else {})}


def _kinds(kinds: Mapping[str, grammar.Kind], called: str, definitions: Schema) -> Schema:
    """One object with a property for each kind, not a choice of objects: a validator then points at the wrong key."""
    properties = {name: _kind(kind, definitions) for name, kind in kinds.items()}
    return {
        "type": "object",
        "description": f"one kind of {called} with its data",
        "properties": _spellings(properties),
        "additionalProperties": False,
        **_ONE,
    }


def _kind(kind: grammar.Kind, definitions: Schema) -> Schema:
    """Of a kind that is given in several ways the first key of a way says which others go with it."""
    schema = _key(kind, definitions)
    if len(kind.ways) == 1:
        return schema
    required = [set(kind.required_in(way)) for way in kind.ways]
    always = [key for key in schema.pop("required") if key in set.intersection(*required)]
    ways = {
        way.keys[0]: {
            "title": way.words,
            "required": [key for key in way.keys if key in needed],
            "properties": {key: _NEVER for key in kind.keys if key not in way.keys},
        }
        for way, needed in zip(kind.ways, required, strict=True)
    }
    return {**schema, **_required(always, tuple(ways)), "dependentSchemas": ways}
