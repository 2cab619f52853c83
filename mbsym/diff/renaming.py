"""Names that may have been replaced: proposals only, which exact comparison accepts or not."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import permutations, product
from typing import Any

from mbsym.expressions.rates import ACCELERATION_ENDING, VELOCITY_ENDING

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
