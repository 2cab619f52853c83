"""The JSON Schemas (draft 2020-12) of the files that mbsym writes, made from the types of ``mbsym.report.documents``.

A type that stands at several places, or has a name of its own, is told once under ``$defs``.

Keywords of our own stand in them, which validators pass over and ``mbsym.diff`` reads: ``x-tell-apart`` names the
properties by which the items of a list are told apart, ``x-indices`` says that items are about coordinates, ``x-first``
with which number they begin, and ``x-aside`` marks what is no result (versions, measured seconds, sentences beside
codes).
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Mapping
from enum import Enum
from importlib import import_module
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from msgspec import Meta, Struct, UnsetType

from mbsym.algebra.parts import missing
from mbsym.report.documents.base import Named, headed

Schema = dict[str, Any]

#: What each kind of file is: a type of this name, in a module of this name unless another one has it.
TITLES = {
    "average": "What mbsym average --json prints",
    "branches": "mbsym equilibria --vary: branches.json",
    "diff": "mbsym diff --format json",
    "ensemble": "ensemble.json of mbsym simulate --vary",
    "equilibria": "mbsym equilibria --json",
    "equilibria_map": "mbsym map --of equilibria: equilibria-map.json",
    "expansion": "What mbsym expand --json prints",
    "extremes": "extremes.json of mbsym extremes",
    "floquet": "floquet.json of mbsym floquet",
    "groups": "What mbsym groups --json prints",
    "integrals": "What mbsym integrals --json prints",
    "inverse": "What mbsym inverse --json prints",
    "lyapunov": "lyapunov.json of mbsym lyapunov",
    "map": "mbsym map: map.json",
    "nonlinear": "mbsym nonlinear --json",
    "orbit": "orbit.json of mbsym orbit",
    "oscillations": "What mbsym oscillations --json prints",
    "regressor": "regressor.json of mbsym regressor",
    "results": "results.json of mbsym run",
    "simulation": "simulation.json of mbsym simulate",
    "sweep": "sweep.json of mbsym sweep",
    "symmetries": "What mbsym symmetries --json prints",
    "tradeoff": "tradeoff.json of mbsym tradeoff",
    "trim": "What mbsym trim --json prints",
}

_MODULES = {
    "average": "expansion",
    "equilibria_map": "branches",
    "floquet": "orbit",
    "groups": "parameters",
    "inverse": "parameters",
    "lyapunov": "orbit",
    "regressor": "parameters",
    "sweep": "ensemble",
    "symmetries": "integrals",
    "trim": "parameters",
}

_SIMPLE: Mapping[Any, str] = {str: "string", int: "integer", float: "number", bool: "boolean", NoneType: "null"}
_BOUNDS = {
    "ge": {"integer": "minimum", "number": "minimum"},
    "le": {"integer": "maximum", "number": "maximum"},
    "pattern": {"string": "pattern"},
    "min_length": {"string": "minLength", "array": "minItems", "object": "minProperties"},
    "max_length": {"string": "maxLength", "array": "maxItems", "object": "maxProperties"},
}


def names() -> tuple[str, ...]:
    """The kinds of files that have a schema: results, simulation, ..."""
    return tuple(TITLES)


def document(name: str) -> type[Struct]:
    """The type of a kind of file.  Raises KeyError for a name that is not among ``names()``."""
    if name not in TITLES:
        raise KeyError(name)
    module = import_module(f"mbsym.report.documents.{_MODULES.get(name, name)}")
    for kind, where in getattr(module, "LATER", {}).items():
        setattr(module, kind, _later(f"{module.__name__}.{where}", kind))
    document_type: type[Struct] = getattr(module, "".join(word.title() for word in name.split("_")))
    return document_type


def _later(module: str, kind: str) -> Any:
    """A type of a section; anything may stand there whose problem is not installed."""
    try:
        return getattr(import_module(module), kind)
    except ImportError as error:
        if not missing(error):
            raise
        return Any


def schema(name: str) -> Schema:
    """The schema of a kind of file.  Raises KeyError for a name that is not among ``names()``."""
    return schema_of(document(name), name, TITLES[name])


def schema_of(of: type[Struct], name: str, title: str) -> Schema:
    """The schema of a type."""
    head = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:mbsym:{name.replace('_', '-')}:1",
        "title": title,
    }
    return head | _Writer(of).whole()


class _Writer:
    """Writes the schema of one type."""

    def __init__(self, of: type[Struct]) -> None:
        self.of = of
        #: How often a type is met, and how its places name it.
        self.met: Counter[Any] = Counter()
        self.named: dict[Any, str] = {}
        self.definitions: dict[str, Schema] = {}
        self._count(of, {})

    def whole(self) -> Schema:
        found = self._object(self.of, _generic(self.of, {})[2])
        return found | ({"$defs": self.definitions} if self.definitions else {})

    def _count(self, hint: Any, bindings: Mapping[Any, Any]) -> None:
        origin, hint, bindings = _generic(hint, bindings)
        if isinstance(origin, type) and issubclass(origin, Struct):
            self.met[hint] += 1
            if self.met[hint] == 1:
                for inner in _fields(origin).values():
                    self._count(inner, bindings)
        else:
            for inner in get_args(hint):
                if origin is not Literal:
                    self._count(inner, bindings)

    def _of(self, hint: Any, bindings: Mapping[Any, Any]) -> Schema:
        origin, hint, bindings = _generic(hint, bindings)
        if origin is Annotated:
            return self._annotated(hint, bindings)
        if origin in (Union, UnionType):
            return self._one_of([x for x in get_args(hint) if x is not UnsetType], bindings)
        if origin is Literal:
            choices = list(get_args(hint))
            return {"const": choices[0]} if len(choices) == 1 else {"enum": choices}
        if hint in _SIMPLE:
            return {"type": _SIMPLE[hint]}
        if origin in (list, tuple):
            return {"type": "array", "items": self._of(get_args(hint)[0], bindings)}
        if origin is dict:
            key, value = get_args(hint)
            return self._mapping(key, value, bindings)
        if isinstance(hint, type) and issubclass(hint, Enum):
            return {"enum": [item.value for item in hint]}
        if isinstance(origin, type) and issubclass(origin, Struct):
            if self.met[hint] == 1:
                return self._object(origin, bindings)
            return self._defined(hint, _snake(origin.__name__), lambda: self._object(origin, bindings))
        assert hint is Any, hint
        return {}

    def _annotated(self, hint: Any, bindings: Mapping[Any, Any]) -> Schema:
        kind, *remarks = get_args(hint)
        named = next((k for k, item in enumerate(remarks) if isinstance(item, Named)), None)
        if named is None:
            return _remarked(self._of(kind, bindings), remarks)
        name, of_type, remarks = str(remarks[named]), remarks[:named], remarks[named + 1 :]
        return _remarked(self._defined(name, name, lambda: _remarked(self._of(kind, bindings), of_type)), remarks)

    def _defined(self, key: Any, name: str, write: Callable[[], Schema]) -> Schema:
        if key not in self.named:
            while name in self.definitions:
                name += "_2"
            self.named[key] = name
            self.definitions[name] = {}
            self.definitions[name] = write()
        return {"$ref": f"#/$defs/{self.named[key]}"}

    def _object(self, of: type[Struct], bindings: Mapping[Any, Any]) -> Schema:
        fields = _fields(of)
        needed = [key for key, hint in fields.items() if not _left_out(hint)]
        found: Schema = {"description": text} if (text := _documented(of)) else {}
        found |= {"type": "object", "additionalProperties": False, "required": needed}
        return found | {"properties": {key: self._property(hint, bindings) for key, hint in fields.items()}}

    def _property(self, hint: Any, bindings: Mapping[Any, Any]) -> Schema:
        """Where a field does not say what it is, its type does."""
        found = self._of(hint, bindings)
        return found if "description" in found else {"description": _documented(hint)} | found

    def _mapping(self, key: Any, value: Any, bindings: Mapping[Any, Any]) -> Schema:
        found: Schema = {"type": "object"}
        if key is not str:
            found["propertyNames"] = self._of(key, bindings)
        inner = self._of(value, bindings)
        return found | {"additionalProperties": inner} if inner else found

    def _one_of(self, choices: list[Any], bindings: Mapping[Any, Any]) -> Schema:
        written = [self._of(choice, bindings) for choice in choices]
        others = [one for one in written if one != {"type": "null"}]
        if len(written) == 1:
            return written[0]
        if all(set(one) == {"type"} for one in written):
            return {"type": [one["type"] for one in written]}
        if len(others) == 1 and not {"$ref", "properties", "oneOf"} & set(others[0]):
            return _or_null(others[0])
        return {"oneOf": [*([{"type": "null"}] if len(others) < len(written) else []), *others]}


def _or_null(found: Schema) -> Schema:
    kinds = {"type": [found["type"], "null"]} if "type" in found else {}
    return found | kinds | ({"enum": [*found["enum"], None]} if "enum" in found else {})


def _generic(hint: Any, bindings: Mapping[Any, Any]) -> tuple[Any, Any, Mapping[Any, Any]]:
    """The origin of a type, the type with what is given for its variables, and what is given within it."""
    if isinstance(hint, TypeVar):
        return _generic(bindings[hint], bindings)
    origin = get_origin(hint)
    if isinstance(origin, type) and issubclass(origin, Struct):
        values = tuple(bindings.get(x, x) if isinstance(x, TypeVar) else x for x in get_args(hint))
        variables = origin.__parameters__  # type: ignore[attr-defined]
        return origin, origin[values], dict(zip(variables, values, strict=True))  # type: ignore[index]
    if isinstance(hint, type) and issubclass(hint, Struct):
        bindings = {}
        for base in (x for ancestor in hint.__mro__ for x in vars(ancestor).get("__orig_bases__", ())):
            bindings |= dict(zip(getattr(get_origin(base), "__parameters__", ()), get_args(base), strict=False))
    return (origin or hint), hint, bindings


def _documented(hint: Any) -> str:
    """What a type says of itself, or the first of a union that does."""
    of = get_origin(hint) or hint
    if of in (Annotated, Union, UnionType):
        return next(filter(None, map(_documented, get_args(hint))), "")
    return " ".join((of.__doc__ or "").split()) if isinstance(of, type) and issubclass(of, Struct) else ""


def _left_out(hint: Any) -> bool:
    """Whether a field may be left out of the file."""
    return UnsetType in get_args(get_args(hint)[0] if get_origin(hint) is Annotated else hint)


def _fields(of: type[Struct]) -> dict[str, Any]:
    """Key in the file -> type, in the order of the file."""
    hints = get_type_hints(of, include_extras=True)
    typed = {key: hints[name] for name, key in zip(of.__struct_fields__, of.__struct_encode_fields__, strict=True)}
    return headed(typed)


def _remarked(found: Schema, remarks: list[Any]) -> Schema:
    described: Schema = {}
    for item in remarks:
        if isinstance(item, str):
            described["description"] = item
        elif isinstance(item, Meta):
            described |= item.extra_json_schema or {}
            kinds = found.get("type", ())
            if "enum" in described:
                described["enum"] = [*described["enum"], *([None] if "null" in kinds else [])]
                found = {key: value for key, value in found.items() if key != "type"}
            for bound, keys in _BOUNDS.items():
                if (value := getattr(item, bound)) is not None:
                    described[next(word for kind, word in keys.items() if kind in kinds)] = value
    return {**{key: value for key, value in described.items() if key == "description"}, **found, **described}


def _snake(name: str) -> str:
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()
