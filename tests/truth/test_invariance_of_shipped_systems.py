"""The motion does not know our letters: shipped systems, each described otherwise, are judged alike.

Tried are coordinates with the other sign, parameters in other units, bodies of two halves that are welded, and names
and entries in another order.  Held against each other are the verdicts with their theorems, in symbols and at the given
values, the eigenvalues there, the first integrals, and under how many conditions the motion exists.
"""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable, Mapping
from random import Random
from typing import Any

import pytest
import yaml

import mbsym
from mbsym.analysis import Analysis
from mbsym.problems.stability.enclosed import numbers
from tests.conftest import SHIPPED

Description = dict[str, Any]

SYSTEMS = (
    *("bead-on-hoop", "cart-pole", "double-pendulum", "dumbbell", "four-bar", "heavy-top"),
    *("orbital-gyrostat", "rolling-disc", "simple-pendulum", "spring-pendulum", "ziegler-damped"),
)
#: Where values of formulas are names of bodies and points, or words of ours.
NAMES = (
    "name",
    "attached to",
    "body",
    "coordinate",
    "coordinates",
    "dependent",
    "inertia about",
    "description",
    "source",
)
#: What is not compared: it says how the system is told.
TOLD = ("claims", "abbreviations", "latex", "description", "source", "label", "order")


def shipped(name: str) -> Description:
    """The description as texts, with the coordinates and carriers of all bodies."""

    def plain(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: plain(x) for key, x in value.items()}
        if isinstance(value, list):
            return [plain(x) for x in value]
        return int(value) if re.fullmatch(r"-?\d+", value) else value == "true" if value in ("true", "false") else value

    text = (SHIPPED / f"{name}.yaml").read_text(encoding="utf-8")
    found: Description = plain(yaml.load(text, yaml.BaseLoader))
    for body, read in zip(found["bodies"], mbsym.loads(text, ()).system.bodies, strict=True):
        body |= {"coordinates": list(read.coordinates), "attached to": read.attached_to}
    return {key: value for key, value in found.items() if key not in TOLD}


def put(value: Any, images: Mapping[str, str]) -> Any:
    """Every formula with something else in place of names, of their rates too."""
    if isinstance(value, dict):
        return {key: x if key in NAMES and not isinstance(x, dict) else put(x, images) for key, x in value.items()}
    if isinstance(value, list):
        return [put(x, images) for x in value]
    if not isinstance(value, str):
        return value
    return re.sub(r"(?<![\w.])[A-Za-z]\w*", lambda match: images.get(match[0], match[0]), value)


def negated(found: Description, chance: Random) -> Description:
    """Every coordinate is told by the opposite one."""
    names = [name for body in found["bodies"] for name in body["coordinates"]]
    images = {name + end: f"(-{name}{end})" for name in names for end in ("", "_dot")}
    changed = put(found | {"parameters": {}}, images) | {"parameters": found["parameters"]}
    for load in changed.get("loads", []):
        for one in (x for x in load.values() if isinstance(x, dict)):
            one |= {key: f"-({x})" for key, x in one.items() if key == "rest" or "generalized force" in load}
    for key in ("motion", "initial"):
        for name, value in changed.get(key, {}).items():
            given = value if isinstance(value, dict) else {"position" if key == "initial" else "value": value}
            changed[key][name] = {end: f"-({x})" for end, x in given.items()}
    return changed


def in_other_units(found: Description, chance: Random, values: bool = True) -> Description:
    """A parameter p is k p', its value a k-th; those of which angles are made stay."""
    angles = re.findall(r"\w+", json.dumps([body.get("rotation") for body in found["bodies"]]))
    angles += re.findall(r"(?:sin|cos|tan)\(([^)]*)\)", json.dumps(found))
    kept = {*found.get("relations", {}), *re.findall(r"\w+", " ".join(angles))}
    units = {name: chance.choice((2, 3, 7)) for name in found["parameters"] if name not in kept}
    images = {name: f"({unit}*{name})" for name, unit in units.items()}
    changed = put(found | {"parameters": {}}, images) | {"parameters": copy.deepcopy(found["parameters"])}
    for name, unit in units.items() if values else ():
        one = found["parameters"][name]
        if isinstance(one, dict) and "value" in one:
            changed["parameters"][name] = one | {"value": f"({put(one['value'], images)})/{unit}"}
        if name in found.get("values", {}):
            changed["values"][name] = f"({put(found['values'][name], images)})/{unit}"
    return changed


def welded(found: Description, chance: Random) -> Description:
    """A body is made of two equal ones."""

    def half(value: Any) -> Any:
        return [half(x) for x in value] if isinstance(value, list) else f"({value})/2" if value else value

    body = chance.choice([x for x in found["bodies"] if x.get("mass")])
    halved = ("mass", "inertia", "gyrostatic moment")
    body |= {key: half(body[key]) for key in halved if key in body}
    other = {key: body[key] for key in (*halved, "mass centre", "inertia about") if key in body}
    found["bodies"].append({"name": "half", "attached to": body["name"], "coordinates": []} | other)
    return found


def renamed(found: Description, chance: Random) -> Description:
    """Parameters and coordinates have other names, and stand, like loads and bodies, in another order."""
    names = [*found["parameters"], *(name for body in found["bodies"] for name in body["coordinates"])]
    others = [f"{chance.choice('abcmpqswxyz')}{k}" for k in chance.sample(range(100), len(names))]
    images = dict(zip(names, others, strict=True))
    rates = {f"{name}_dot": f"{other}_dot" for name, other in images.items()}

    def told(value: Any) -> Any:
        if isinstance(value, dict):
            keys = {key: images.get(key, key) for key in value}
            return {keys[key]: x if key in ("name", "attached to", "body") else told(x) for key, x in value.items()}
        return [told(x) for x in value] if isinstance(value, list) else put(value, images | rates)

    changed: Description = {key: x if key == "name" else told(x) for key, x in found.items()}
    parameters = list(changed["parameters"].items())
    for listed in (parameters, changed.get("loads", []), changed.get("constraints", [])):
        chance.shuffle(listed)
    waiting, placed = changed["bodies"], list[Any]()
    while waiting:
        ready = [x for x in waiting if x["attached to"] not in [y["name"] for y in waiting]]
        placed.append(waiting.pop(waiting.index(chance.choice(ready))))
    return changed | {"parameters": dict(parameters), "bodies": placed}


def judged(description: Description) -> tuple[object, ...]:
    found: Analysis = mbsym.loads(json.dumps(description), (4, 5, 6, 7))
    stages = [found.stage(number) for number in (4, 5, 6, 7)]
    missing = [None if stage.failure is None else stage.failure.code for stage in stages]
    integrals = sorted((x.kind, x.status.value) for x in stages[3].value or ())
    if stages[2].failure is not None:
        return missing, integrals
    stability = found.stability
    verdicts = [(x.word, sorted(x.theorems)) for x in (stability.verdict, stability.numerical) if x is not None]
    parts = sorted((len(part.coordinates), part.theory.verdict.word) for part in stability.subsystems)
    roots = [root for spectrum in stability.spectra for root in numbers(spectrum)]
    told = sorted((round(root.real, 6) + 0.0, round(root.imaginary, 6), root.multiplicity) for root in roots)
    return missing, integrals, verdicts, parts, told, len(stability.presumed)


CHANGES: tuple[Callable[[Description, Random], Description], ...] = (negated, in_other_units, welded, renamed)


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.__name__)
@pytest.mark.parametrize("name", SYSTEMS)
def test_another_description_is_judged_alike(name: str, change: Callable[..., Description]) -> None:
    description = shipped(name)
    assert judged(change(copy.deepcopy(description), Random(name))) == judged(description)


def test_values_that_are_not_converted_are_noticed() -> None:
    """Negative control."""
    description = shipped("ziegler-damped")
    changed = in_other_units(copy.deepcopy(description), Random(1), values=False)
    assert judged(changed) != judged(description)
