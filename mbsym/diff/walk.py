"""Both documents walked together along their schema: every place at which they are not the same text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isclose
from typing import Any

Schema = Mapping[str, Any]

#: Doubles (eigenvalues) count as the same up to this, relative to their size: machines round differently.
ROUNDING = 1e-12


@dataclass(frozen=True)
class Difference:
    """``kind`` is added, removed, changed or order; of two ``formula``s it is open whether they differ."""

    path: tuple[str, ...]
    kind: str
    before: Any
    after: Any
    formula: bool = False


@dataclass(frozen=True)
class _Place:
    """A schema within the whole one, the way to it, and the coordinates that matrices there are about."""

    whole: Schema
    schema: Schema
    path: tuple[str, ...] = ()
    labels: tuple[Sequence[str], Sequence[str]] = ((), ())

    def to(self, schema: Schema, *step: str) -> _Place:
        return replace(self, schema=schema, path=(*self.path, *step))


def pairs(schema: Schema, a: Any, b: Any) -> Iterator[Difference]:
    """The places where two documents of a schema differ, in the order of the schema."""
    yield from _walk(_Place(schema, schema), a, b)


def _walk(place: _Place, a: Any, b: Any) -> Iterator[Difference]:
    if place.schema.get("x-aside") or a == b:
        return
    schema, formula = _resolved(place, a if b is None else b)
    if formula:
        one_sided = a is None or b is None
        yield Difference(place.path, _kind(a, b), a, b, formula=not one_sided)
    elif isinstance(a, Mapping) and isinstance(b, Mapping):
        yield from _objects(replace(place, schema=schema), a, b)
    elif isinstance(a, list) and isinstance(b, list):
        yield from _lists(replace(place, schema=schema), a, b)
    elif not _same_number(a, b):
        yield Difference(place.path, _kind(a, b), a, b)


def _kind(a: Any, b: Any) -> str:
    return "added" if a is None else "removed" if b is None else "changed"


def _resolved(place: _Place, sample: Any) -> tuple[Schema, bool]:
    """The schema behind references and alternatives, and whether it is that of a formula."""
    schema = place.schema
    for _ in range(8):
        reference = schema.get("$ref")
        if reference is not None:
            if reference == "#/$defs/formula":
                return schema, True
            schema = place.whole
            for name in str(reference).removeprefix("#/").split("/"):
                schema = schema[name]
        elif "oneOf" in schema:
            schema = _alternative(place, schema["oneOf"], sample)
        else:
            break
    return schema, False


def _alternative(place: _Place, choices: Sequence[Schema], sample: Any) -> Schema:
    choices = [choice for choice in choices if choice.get("type") != "null"]
    for choice in choices:
        shape, formula = _resolved(replace(place, schema=choice), sample)
        if formula or (isinstance(sample, Mapping) and set(sample) <= set(shape.get("properties", ()))):
            return choice
    return choices[0]


def _objects(place: _Place, a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[Difference]:
    properties, other = place.schema.get("properties", {}), place.schema.get("additionalProperties")
    for rows in ("coordinates", "speeds"):
        if isinstance(a.get(rows), list) and isinstance(b.get(rows), list):
            place = replace(place, labels=(a[rows], b[rows]))
    known = [key for key in properties if key in a or key in b]
    for key in [*known, *sorted({*a, *b} - {*known}, key=str)]:
        inner = properties.get(key, other if isinstance(other, Mapping) else {})
        if inner.get("x-aside"):
            continue
        yield from _member(place.to(inner, str(key)), a.get(key), b.get(key), key in a, key in b)


def _member(place: _Place, a: Any, b: Any, in_a: bool, in_b: bool) -> Iterator[Difference]:
    """What stands in one of them only is told as a whole."""
    if in_a and in_b:
        yield from _walk(place, a, b)
    else:
        yield Difference(place.path, "added" if in_b else "removed", a, b)


def _lists(place: _Place, a: list[Any], b: list[Any]) -> Iterator[Difference]:
    schema = place.schema
    names_a, names_b = _names(place.whole, schema, a, place.labels[0]), _names(place.whole, schema, b, place.labels[1])
    left, right = dict(zip(names_a, a, strict=True)), dict(zip(names_b, b, strict=True))
    for name in [*names_a, *(name for name in names_b if name not in left)]:
        yield from _member(
            place.to(schema.get("items", {}), name), left.get(name), right.get(name), name in left, name in right
        )
    shared = [name for name in names_a if name in right], [name for name in names_b if name in left]
    if shared[0] != shared[1]:
        yield Difference(place.path, "order", shared[0], shared[1])


def _names(whole: Schema, schema: Schema, items: list[Any], labels: Sequence[str]) -> list[str]:
    """A name for each item, all different: what tells it apart, itself if it is a word, or its number."""
    apart = schema.get("x-tell-apart")
    if apart and all(isinstance(item, Mapping) for item in items):
        found = [", ".join(_words(item.get(key)) for key in apart) for item in items]
    elif _are_words(whole, schema, items) and len(set(items)) == len(items):
        found = list(map(str, items))
    elif schema.get("x-indices") and len(labels) == len(items):
        found = list(map(str, labels))
    else:
        first = int(schema.get("x-first", 1))
        return [str(k) for k in range(first, first + len(items))]
    count: Counter[str] = Counter()
    for k, name in enumerate(found):
        count[name] += 1
        found[k] = name if count[name] == 1 else f"{name} ({count[name]})"
    return found


def _are_words(whole: Schema, schema: Schema, items: list[Any]) -> bool:
    """Whether they are words, not formulas."""
    if not all(isinstance(item, str) for item in items):
        return False
    return not _resolved(_Place(whole, schema.get("items", {})), "")[1]


def _words(value: Any) -> str:
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)


def _same_number(a: Any, b: Any) -> bool:
    if isinstance(a, bool) or isinstance(b, bool) or not isinstance(a, (int, float)) or not isinstance(b, (int, float)):
        return False
    floats = isinstance(a, float) or isinstance(b, float)
    return floats and isclose(a, b, rel_tol=ROUNDING, abs_tol=ROUNDING)
