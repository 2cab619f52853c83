"""Two results compared, guided by their schema: it says what is a formula and how items of lists are told apart."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from itertools import permutations, product
from typing import Any

from mbsym.diff.formulas import Comparison, Known, compared
from mbsym.diff.walk import Difference, pairs
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
    """``path`` leads to the place: property names, names of items, numbers counted from 1 as text.

    ``before`` and ``after`` are what stands there, None where nothing does.  Of a formula, ``difference`` is
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
    for one in (a, b):
        if not isinstance(one, Mapping) or one.get("format") != 1 or not isinstance(one.get("coordinates"), list):
            raise ValueError("it is no results.json of format 1")
    whole = schema("results")
    known = _known(a, b)
    memory: dict[tuple[str, str], Comparison] = {}

    def compare(first: str, second: str) -> Comparison:
        if (first, second) not in memory:
            memory[first, second] = compared(first, second, known)
        return memory[first, second]

    found: tuple[Renaming, ...] = ()
    old: Mapping[str, Any] = a
    for proposal in candidates(a, b):
        replaced = renamed(a, proposal)
        known = _known(replaced, b)
        memory.clear()
        if _used(b, proposal) and not any(_contradicts(item, proposal, compare) for item in pairs(whole, replaced, b)):
            found, old = proposal, replaced
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
    return Diff(found, tuple(changes), tuple(restated), versions)


def _change(item: Difference, compare: Callable[[str, str], Comparison]) -> Change | None:
    """None for a formula that is printed otherwise."""
    before, after = item.before, item.after
    if not item.formula:
        return Change(item.path, Kind(item.kind), before, after)
    if not isinstance(before, str) or not isinstance(after, str):  # at least one is counted only
        return Change(item.path, Kind.UNDECIDED, before, after)
    found = compare(before, after)
    if found.equal:
        return None
    if found.equal is None:
        return Change(item.path, Kind.UNDECIDED, before, after, points=found.points)
    kind = Kind.FORMULA if found.terms else Kind.CHANGED
    return Change(item.path, kind, before, after, found.difference, found.terms, found.first)


def _contradicts(item: Difference, proposal: tuple[Renaming, ...], compare: Callable[[str, str], Comparison]) -> bool:
    """Whether a difference speaks against a renaming: a formula with one of the names, or a body of that name."""
    change = _change(item, compare)
    if change is None:
        return False
    for one in proposal:
        if one.kind == "body":
            if one.after in item.path:
                return True
            continue
        if one.after in item.path and item.kind in ("added", "removed"):
            return True
        name = re.compile(rf"\b{re.escape(one.after)}(_dot|_ddot)?\b")
        if item.formula and any(isinstance(x, str) and name.search(x) for x in (item.before, item.after)):
            if item.path[:1] == ("parameters",):
                continue  # its value may be another one
            return True
    return False


def _used(b: Mapping[str, Any], proposal: tuple[Renaming, ...]) -> bool:
    """Whether every new name stands in some result: a name that nothing holds is no evidence of a renaming."""
    results = {key: value for key, value in b.items() if key not in ("coordinates", "parameters", "claims", "system")}
    text = json.dumps(results, ensure_ascii=False)
    return all(re.search(rf"(?<![A-Za-z0-9_]){re.escape(one.after)}(?![A-Za-z0-9])", text) for one in proposal)


def _known(a: Mapping[str, Any], b: Mapping[str, Any]) -> Known:
    coordinates = {str(name) for one in (a, b) for name in one["coordinates"]}
    signs: list[dict[str, str]] = [dict(_signs(one)) for one in (a, b)]
    agreed = {
        name: sign
        for name, sign in (signs[0] | signs[1]).items()
        if signs[0].get(name, sign) == signs[1].get(name, sign)
    }
    tables = [_tables(one) for one in (a, b)]
    alike = {name: x for name, x in (tables[0] | tables[1]).items() if tables[0].get(name, x) == tables[1].get(name, x)}
    return Known(frozenset(coordinates), agreed, alike)


def _tables(one: Mapping[str, Any]) -> dict[str, Table]:
    """What formulas call: of a table that jumps, what keeps its end values outside."""
    found: dict[str, Table] = {}
    for item in one.get("tables") or ():
        points = tuple((Fraction(x), Fraction(y)) for x, y in item["points"])
        held = item.get("held")
        name, outside = (held, HOLD) if held else (item["name"], item["outside"])
        found[name] = Table(name, points, item["between"], outside)
        if held:  # its slopes go by its own name
            found[item["name"]] = Table(item["name"], points, item["between"], outside)
    return found


def _signs(one: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    for item in one.get("parameters") or ():
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
        yield tuple(one for part in chosen for one in part)
    if len(ways) > 1:
        for way in ways:
            yield from way


def renamed(a: Mapping[str, Any], proposal: tuple[Renaming, ...]) -> dict[str, Any]:
    """The document with the names replaced wherever they stand as words."""
    names: dict[str, str] = {}
    for one in proposal:
        names[one.before] = one.after
        if one.kind == "coordinate":
            names |= {one.before + rate: one.after + rate for rate in (VELOCITY_ENDING, ACCELERATION_ENDING)}
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

    found: dict[str, Any] = replaced(a)
    return found


def _names(one: Mapping[str, Any], kind: str) -> list[str]:
    if kind == "coordinate":
        return list(map(str, one["coordinates"]))
    listed = one.get("parameters") if kind == "parameter" else (one.get("kinematics") or {}).get("bodies")
    return [str(item["name"]) for item in listed or () if isinstance(item, Mapping) and "name" in item]
