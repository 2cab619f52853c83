"""Two results compared, guided by their schema: it says what is a formula and how items of lists are told apart."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction
from itertools import permutations, product
from math import isclose
from typing import Any

from mbsym.diff.formulas import Comparison, Known, compared
from mbsym.expressions.rates import ACCELERATION_ENDING, VELOCITY_ENDING
from mbsym.expressions.table import HOLD, Table
from mbsym.report.schemas import schema


class Kind(StrEnum):
    """What happened at a place."""

    ADDED = "added"
    REMOVED = "removed"
    #: A word, a number or a text is another one.
    CHANGED = "changed"
    #: The same items in another order.
    ORDER = "order"
    #: A formula is another one, as the ring or an enclosure proves.
    FORMULA = "formula"
    #: Whether a formula is another one cannot be decided.
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class Change:
    """``path`` leads to the place: properties (``Key``), names of items, numbers counted from 1 as text.

    ``before`` and ``after`` are what stands there, None where nothing does; a ``word`` is one of ours.  Of a formula,
    ``difference`` is
    after - before; where that is long it is empty, ``terms`` is its length and ``first`` its first term.  An undecided
    formula agrees with the other one in enclosures at ``points`` points.
    """

    path: tuple[str, ...]
    kind: Kind
    before: Any = None
    after: Any = None
    difference: str = ""
    terms: int = 0
    first: str = ""
    points: int = 0
    word: bool = False


@dataclass(frozen=True)
class Diff:
    """``restated`` are the places of formulas that are equal and printed otherwise; that is no change."""

    renamed: tuple[Renaming, ...]
    changes: tuple[Change, ...]
    restated: tuple[tuple[str, ...], ...]
    versions: tuple[str, str]

    @property
    def same(self) -> bool:
        """Whether both say the same: nothing is renamed, changed or undecided."""
        return not self.renamed and not self.changes


def diff(a: Mapping[str, Any], b: Mapping[str, Any]) -> Diff:
    """What changed from one ``results.json`` to the other, both as they are read.

    A parameter, coordinate or body counts as renamed only if every formula that holds the new name is, exactly, the old
    one with the name replaced.  Raises ValueError for what is no result of format 1.
    """
    for document in (a, b):
        if (
            not isinstance(document, Mapping)
            or document.get("format") != 1
            or not isinstance(document.get("coordinates"), list)
        ):
            raise ValueError("it is no results.json of format 1")
    whole = schema("results")
    known = _known(a, b)
    memory: dict[tuple[str, str], Comparison] = {}

    def compare(first: str, second: str) -> Comparison:
        if (first, second) not in memory:
            memory[first, second] = compared(first, second, known)
        return memory[first, second]

    renamings: tuple[Renaming, ...] = ()
    old: Mapping[str, Any] = a
    for proposal in candidates(a, b):
        replaced = renamed(a, proposal)
        known = _known(replaced, b)
        memory.clear()
        if _used(b, proposal) and not any(_contradicts(item, proposal, compare) for item in pairs(whole, replaced, b)):
            renamings, old = proposal, replaced
            break
    known = _known(old, b)
    memory.clear()
    changes: list[Change] = []
    restated: list[tuple[str, ...]] = []
    for item in pairs(whole, old, b):
        change = _change(item, compare)
        if change is None:
            restated.append(item.path)
        else:
            changes.append(change)
    versions = str(a.get("version", "")), str(b.get("version", ""))
    return Diff(renamings, tuple(changes), tuple(restated), versions)


def _change(item: Difference, compare: Callable[[str, str], Comparison]) -> Change | None:
    """None for a formula that is printed otherwise."""
    before, after = item.before, item.after
    if not item.formula:
        return Change(item.path, Kind(item.kind), before, after, word=item.word)
    if not isinstance(before, str) or not isinstance(after, str):  # at least one is counted only
        return Change(item.path, Kind.UNDECIDED, before, after)
    comparison = compare(before, after)
    if comparison.equal:
        return None
    if comparison.equal is None:
        return Change(item.path, Kind.UNDECIDED, before, after, points=comparison.points)
    kind = Kind.FORMULA if comparison.terms else Kind.CHANGED
    return Change(item.path, kind, before, after, comparison.difference, comparison.terms, comparison.first)


def _contradicts(item: Difference, proposal: tuple[Renaming, ...], compare: Callable[[str, str], Comparison]) -> bool:
    """Whether a difference speaks against a renaming: a formula with one of the names, or a body of that name."""
    change = _change(item, compare)
    if change is None:
        return False
    for renaming in proposal:
        if renaming.kind == "body":
            if renaming.after in item.path:
                return True
            continue
        if renaming.after in item.path and item.kind in ("added", "removed"):
            return True
        name = re.compile(rf"\b{re.escape(renaming.after)}(_dot|_ddot)?\b")
        if item.formula and any(isinstance(x, str) and name.search(x) for x in (item.before, item.after)):
            if item.path[:1] == ("parameters",):
                continue  # its value may be another one
            return True
    return False


def _used(b: Mapping[str, Any], proposal: tuple[Renaming, ...]) -> bool:
    """Whether every new name stands in some result: a name that nothing holds is no evidence of a renaming."""
    results = {key: value for key, value in b.items() if key not in ("coordinates", "parameters", "claims", "system")}
    text = json.dumps(results, ensure_ascii=False)
    return all(
        re.search(rf"(?<![A-Za-z0-9_]){re.escape(renaming.after)}(?![A-Za-z0-9])", text) for renaming in proposal
    )


def _known(a: Mapping[str, Any], b: Mapping[str, Any]) -> Known:
    coordinates = {str(name) for document in (a, b) for name in document["coordinates"]}
    signs: list[dict[str, str]] = [dict(_signs(document)) for document in (a, b)]
    agreed = {
        name: sign
        for name, sign in (signs[0] | signs[1]).items()
        if signs[0].get(name, sign) == signs[1].get(name, sign)
    }
    tables = [_tables(document) for document in (a, b)]
    alike = {name: x for name, x in (tables[0] | tables[1]).items() if tables[0].get(name, x) == tables[1].get(name, x)}
    return Known(frozenset(coordinates), agreed, alike)


def _tables(document: Mapping[str, Any]) -> dict[str, Table]:
    """What formulas call: of a table that jumps, what keeps its end values outside."""
    tables: dict[str, Table] = {}
    for item in document.get("tables") or ():
        points = tuple((Fraction(x), Fraction(y)) for x, y in item["points"])
        held = item.get("held")
        name, outside = (held, HOLD) if held else (item["name"], item["outside"])
        tables[name] = Table(name, points, item["between"], outside)
        if held:  # its slopes go by its own name
            tables[item["name"]] = Table(item["name"], points, item["between"], outside)
    return tables


def _signs(document: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    for item in document.get("parameters") or ():
        if isinstance(item, Mapping):
            yield str(item.get("name")), str(item.get("sign"))


#: Up to so many names of one kind every pairing is tried; of more, the one in the order of the lists.
MOST_PERMUTED = 3


@dataclass(frozen=True)
class Renaming:
    """``kind`` is parameter, coordinate or body."""

    kind: str
    before: str
    after: str


def candidates(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[tuple[Renaming, ...]]:
    """Ways to pair the names that are only in a with those that are only in b, the likeliest first; never none."""
    ways: list[list[tuple[Renaming, ...]]] = []
    for kind in ("parameter", "coordinate", "body"):
        left, right = _names(a, kind), _names(b, kind)
        gone, new = [x for x in left if x not in right], [x for x in right if x not in left]
        if not gone or len(gone) != len(new):
            continue
        orders = permutations(new) if len(new) <= MOST_PERMUTED else iter([tuple(new)])
        ways.append([tuple(map(Renaming, [kind] * len(gone), gone, order)) for order in orders])
    if not ways:
        return
    for chosen in product(*ways):
        yield tuple(renaming for part in chosen for renaming in part)
    if len(ways) > 1:
        for way in ways:
            yield from way


def renamed(a: Mapping[str, Any], proposal: tuple[Renaming, ...]) -> dict[str, Any]:
    """The document with the names replaced wherever they stand as words."""
    names: dict[str, str] = {}
    for renaming in proposal:
        names[renaming.before] = renaming.after
        if renaming.kind == "coordinate":
            names |= {renaming.before + rate: renaming.after + rate for rate in (VELOCITY_ENDING, ACCELERATION_ENDING)}
    longest = sorted(names, key=len, reverse=True)
    pattern = re.compile(r"(?<![A-Za-z0-9_])(" + "|".join(map(re.escape, longest)) + r")(?![A-Za-z0-9_])")

    def replaced(value: Any) -> Any:
        if isinstance(value, str):
            return pattern.sub(lambda match: names[match[1]], value)
        if isinstance(value, list):
            return [replaced(item) for item in value]
        if isinstance(value, Mapping):
            return {replaced(key) if key in names else key: replaced(item) for key, item in value.items()}
        return value

    document: dict[str, Any] = replaced(a)
    return document


def _names(document: Mapping[str, Any], kind: str) -> list[str]:
    if kind == "coordinate":
        return list(map(str, document["coordinates"]))
    listed = document.get("parameters") if kind == "parameter" else (document.get("kinematics") or {}).get("bodies")
    return [str(item["name"]) for item in listed or () if isinstance(item, Mapping) and "name" in item]


# Both documents walked together along their schema: every place at which they are not the same text.


Schema = Mapping[str, Any]

#: Doubles (eigenvalues) count as the same up to this, relative to their size: machines round differently.
ROUNDING = 1e-12


class Key(str):
    """A step of a path that is a property of results.json; the others are names and numbers."""

    __slots__ = ()


@dataclass(frozen=True)
class Difference:
    """``kind`` is added, removed, changed or order; of two ``formula``s it is open whether they differ.

    ``word``: what stands there is one of a few words of ours.
    """

    path: tuple[str, ...]
    kind: str
    before: Any
    after: Any
    formula: bool = False
    word: bool = False


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
        yield Difference(place.path, _kind(a, b), a, b, word="enum" in schema)


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
        step = Key(key) if key in properties else str(key)
        yield from _member(place.to(inner, step), a.get(key), b.get(key), key in a, key in b)


def _member(place: _Place, a: Any, b: Any, in_a: bool, in_b: bool) -> Iterator[Difference]:
    """What stands in one of them only is told as a whole."""
    if in_a and in_b:
        yield from _walk(place, a, b)
    else:
        yield Difference(place.path, "added" if in_b else "removed", a, b)


def _lists(place: _Place, a: list[Any], b: list[Any]) -> Iterator[Difference]:
    schema = place.schema
    names_a, names_b = (
        _walk_names(place.whole, schema, a, place.labels[0]),
        _walk_names(place.whole, schema, b, place.labels[1]),
    )
    left, right = dict(zip(names_a, a, strict=True)), dict(zip(names_b, b, strict=True))
    for name in [*names_a, *(name for name in names_b if name not in left)]:
        yield from _member(
            place.to(schema.get("items", {}), name), left.get(name), right.get(name), name in left, name in right
        )
    shared = [name for name in names_a if name in right], [name for name in names_b if name in left]
    if shared[0] != shared[1]:
        yield Difference(place.path, "order", shared[0], shared[1])


def _walk_names(whole: Schema, schema: Schema, items: list[Any], labels: Sequence[str]) -> list[str]:
    """A name for each item, all different: what tells it apart, itself if it is a word, or its number."""
    apart = schema.get("x-tell-apart")
    if apart and all(isinstance(item, Mapping) for item in items):
        walk_names = [", ".join(_words(item.get(key)) for key in apart) for item in items]
    elif _are_words(whole, schema, items) and len(set(items)) == len(items):
        walk_names = list(map(str, items))
    elif schema.get("x-indices") and len(labels) == len(items):
        walk_names = list(map(str, labels))
    else:
        first = int(schema.get("x-first", 1))
        return [str(k) for k in range(first, first + len(items))]
    count: Counter[str] = Counter()
    for k, name in enumerate(walk_names):
        count[name] += 1
        walk_names[k] = name if count[name] == 1 else f"{name} ({count[name]})"
    return walk_names


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
