"""Random sequences of operations on one description: after each its three views agree, and undo gives back the bytes.

What an operation means is written here a second time, for plain data, and what a text says is read by PyYAML.
MBSYM_EDIT_SEQUENCES=1000 with --hypothesis-profile=thorough tries so many sequences of each spelling.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from copy import deepcopy
from typing import Any

import pytest
import yaml
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from properties import settings

from mbsym.editing.document import changes, look
from mbsym.source import read, to_text

Json = dict[str, Any]
Edits = list[tuple[int, int, str]]

BLOCK = """# A cart 🚋 and a bob.
mbsym: 1
name: Pendulum   # on a cart
parameters:
  m: positive
  l: {positive: true, meaning: "length, of the rod"}   # of the rod alone
  g: positive

bodies:

    - name: cart
      connection point:  [x,0 ,0]   # along the rail
      mass: m
      coordinates: [x]
    # the bob
    - name: bob
      attached to: cart
      rotation: {axes: [3], angles: [theta]}
      mass centre:
        - 0
        - -l   # downwards
        - 0
      mass: 'm'
loads:
- uniform gravity: {acceleration: g, direction: [0, -1, 0]}   # the earth
- damper: {coordinate: theta, coefficient: m}
motion: {theta: 0}
initial: {theta: {position: 0.1}, x: 0}
# the end
"""

FLOW = """{mbsym: 1, name: "Pendulum: ä", parameters: {m: positive, l: positive, g: positive},
 bodies: [{name: cart, connection point: [x, 0, 0], mass: m, coordinates: [x]},
   {name: bob, attached to: cart, rotation: {axes: [3], angles: [theta]}, mass centre: [0, -l, 0], mass: m}],
 loads: [{uniform gravity: {acceleration: g, direction: [0, -1, 0]}}, {damper: {coordinate: theta, coefficient: m}}],
 motion: {theta: 0}}
"""

LISTED = """mbsym: 1
name: >-
  Pendulum
  on a cart
parameters: [m, l,
  g]
bodies:
- {name: cart, connection point: [x, 0, 0], mass: m, coordinates: [x]}
-   name: bob   # "attached to" below
    mass: m
    rotation:
        axes: [3]
        angles:
        - theta
    mass centre: [0, -l,
       0]
    attached to: cart
loads:
  -
    uniform gravity:
      acceleration: g
      direction: [0, -1, 0]

  - damper: {coordinate: theta, coefficient: m}"""


def _plain() -> str:
    system, _ = read(BLOCK, "x.yaml")
    text = to_text(system).replace("Body description (2)", "# the bob, ä\n\nBody description (2)   # two")
    return text.replace("  Body mass: m\n", "  Body mass:   m   # of it\n", 1)


SPELLINGS: dict[str, tuple[str, str]] = {
    "block": (BLOCK, "x.yaml"),
    "block, CRLF": (BLOCK.replace("\n", "\r\n"), "x.yaml"),
    "mark, no last line end": ("\ufeff" + BLOCK.rstrip("\n"), "x.yaml"),
    "flow": (FLOW, "x.yaml"),
    "listed": (LISTED, "x.yaml"),
    "editor text": (_plain(), "x.txt"),
    "editor text, CRLF": (_plain().replace("\n", "\r\n"), "x.txt"),
}

FORMULAS = ("2*m", "m/3 + 1", "17", "l", "1.50")
LOADS = (
    "{damper: {coordinate: x, coefficient: 2*m}}",
    "{uniform gravity: {acceleration: g, direction: [1, 0, 0]}}",
    "{potential: {force function: -m*x**2/2}}",
)
VECTORS = ("[0, -l, 0]", "[1, l/2, m]", "[0,0,  1/3]")
TEXTS = ("plain", "a: b # c", "ä 🚋", "'q'", "- x", "true", "1")

#: After these a description without errors has none.
KEEPING = ("add body", "rename body", "rename", "reattach", "duplicate branch", "move")

#: Why an operation may be refused; anything else is a defect.
REFUSALS = {"used-elsewhere", "cyclic-bodies"}


# --- what an operation means, for plain data --------------------------------------------------------------------------


def _bodies(data: Json) -> list[str]:
    return [one["name"] for one in data["bodies"]]


def _branch(data: Json, name: str) -> set[str]:
    gone = {name}
    for one in data["bodies"]:  # each behind the one it hangs on
        if one.get("attached to") in gone:
            gone.add(one["name"])
    return gone


def _words(value: Any) -> set[str]:
    if isinstance(value, dict):
        return set().union(*(_words(key) | _words(one) for key, one in value.items()))
    if isinstance(value, list):
        return set().union(*map(_words, value))
    return {value, *re.findall(r"[A-Za-z_]\w*", value)}


def _everywhere(value: Any, change: Callable[[str], str]) -> Any:
    """The same with every formula and name changed; not what is said to people."""
    if isinstance(value, dict):
        spoken = ("meaning", "description")
        return {change(key): one if key in spoken else _everywhere(one, change) for key, one in value.items()}
    return [_everywhere(one, change) for one in value] if isinstance(value, list) else change(value)


def _own(body: Json) -> set[str]:
    """Coordinates of a body: declared, or else its angles."""
    angles = body.get("rotation", {}).get("angles", [])
    return set(body.get("coordinates", [one for one in angles if re.fullmatch(r"[a-z]\w*", one)]))


def meant(data: Json, op: Json) -> Json:
    """What a description says after an operation that is neither a copy (``_copied``) nor refused."""
    data = deepcopy(data)
    match op["op"]:
        case "set" if op["path"][0] == "bodies":
            data["bodies"][op["path"][1]][op["path"][2]] = yaml.load(op["source"], yaml.BaseLoader)
        case "set" if len(op["path"]) == 2:
            section = data.setdefault(op["path"][0], {})
            if isinstance(section, list):
                section = data["parameters"] = dict.fromkeys(section, "real")
            section[op["path"][1]] = op["source"]
        case "set":
            data[op["path"][0]] = op["source"].strip("'")  # as YAML reads it
        case "insert":
            data.setdefault("loads", []).insert(op["path"][1], yaml.load(op["source"], yaml.BaseLoader))
        case "delete":
            del data["loads"][op["path"][1]]
            if not data["loads"]:
                del data["loads"]
        case "move":
            item, before = data["loads"].pop(op["path"][1]), op["before"]
            place = len(data["loads"]) if before is None else before[1] - (before[1] > op["path"][1])
            data["loads"].insert(place, item)
        case "add body":
            data["bodies"].append({"name": op["name"], "attached to": op["to"] or "0", "mass": "0"})
        case "rename body":
            old, new = op["body"], op["name"]
            said = data.pop("name", None), data.pop("description", None)
            data = _everywhere(data, lambda text: new if text == old else text)
            data |= {key: one for key, one in zip(("name", "description"), said, strict=True) if one is not None}
        case "rename":
            word, names = re.compile(rf"(?<!\w){op['name']}(?!\w)"), _bodies(data)
            said = data.pop("name", None), data.pop("description", None)
            data = _everywhere(data, lambda text: text if text in names else word.sub(op["to"], text))
            data |= {key: one for key, one in zip(("name", "description"), said, strict=True) if one is not None}
        case "reattach":
            next(one for one in data["bodies"] if one["name"] == op["body"])["attached to"] = op["to"] or "0"
        case "delete branch":
            gone = _branch(data, op["body"])
            words = gone.union(*(_own(one) for one in data["bodies"] if one["name"] in gone))
            data["bodies"] = [one for one in data["bodies"] if one["name"] not in gone]
            if "loads" in data:
                data["loads"] = [one for one in data["loads"] if not words & _words(one)]
                if not data["loads"]:
                    del data["loads"]
            for section in ("motion", "initial"):
                data[section] = {k: v for k, v in data.get(section, {}).items() if not words & (_words(v) | {k})}
    return data


def _without_order(data: Json) -> Json:
    """Empty sections are none; bodies by name, for what may move them."""
    found = {key: one for key, one in data.items() if one not in ({}, []) or key == "bodies"}
    return found | {"bodies": sorted(data["bodies"], key=lambda one: str(one["name"]))}


# --- operations -------------------------------------------------------------------------------------------------------


def operation(view: Json, kind: int, a: int, b: int, fresh: str) -> Json | None:
    """One of each kind, on what a and b choose of the description that is there."""
    bodies = [one["name"] for one in view["bodies"]]
    loads = len(view["loads"])
    sections = {one["path"][0]: one for one in view["tree"]["children"]}
    if not bodies and kind not in (0, 3, 4):
        return None
    body = bodies[a % len(bodies)] if bodies else None
    other = [None, *bodies][b % (len(bodies) + 1)]
    made: list[Callable[[], Json | None]] = [
        lambda: {"op": "add body", "name": f"body {fresh}", "to": other},
        lambda: {"op": "set", "path": ["bodies", a % len(bodies), "mass"], "source": FORMULAS[b % len(FORMULAS)]},
        lambda: {
            "op": "set",
            "path": ["bodies", a % len(bodies), ("connection point", "mass centre", "gyrostatic moment")[b % 3]],
            "source": VECTORS[b % len(VECTORS)],
        },
        lambda: {"op": "set", "path": [("name", "description")[b % 2]], "source": TEXTS[a % len(TEXTS)]},
        lambda: {"op": "set", "path": ["parameters", f"k{fresh}"], "source": ("positive", "2/3", "real")[b % 3]},
        lambda: {"op": "insert", "path": ["loads", a % (loads + 1)], "source": LOADS[b % len(LOADS)]},
        lambda: {"op": "delete", "path": ["loads", a % loads]} if loads else None,
        lambda: (
            {"op": "move", "path": ["loads", a % loads], "before": [None, ["loads", b % loads]][b % 2]}
            if loads
            else None
        ),
        lambda: {"op": "rename body", "body": body, "name": f"other {fresh}"},
        lambda: {"op": "reattach", "body": body, "to": other},
        lambda: {"op": "delete branch", "body": body},
        lambda: {"op": "duplicate branch", "body": body},
        lambda: _renaming(sections, a, fresh),
    ]
    return made[kind]()


KINDS = 13


def _renaming(sections: Json, a: int, fresh: str) -> Json | None:
    written = sections.get("parameters", {"children": []})["children"]
    names = [str(one["source"] if isinstance(one["path"][1], int) else one["path"][1]) for one in written]
    return {"op": "rename", "kind": "parameter", "name": names[a % len(names)], "to": f"new{fresh}"} if names else None


def edited(text: str, answer: Json) -> tuple[str, Edits]:
    """The text after an answer, and the edits that take it back, as a history keeps them."""
    result, position, back = "", 0, []
    for one in answer["edits"]:
        assert position <= one["from"] <= one["to"] <= len(text), "in order, none over another"
        result += text[position : one["from"]]
        back.append((len(result), len(result) + len(one["insert"]), text[one["from"] : one["to"]]))
        result += one["insert"]
        position = one["to"]
    return result + text[position:], back


def taken_back(text: str, back: Edits) -> str:
    for start, end, insert in reversed(back):
        text = text[:start] + insert + text[end:]
    return text


# --- laws -------------------------------------------------------------------------------------------------------------


def _nodes(node: Json) -> Iterator[Json]:
    yield node
    for one in node.get("children", ()):
        yield from _nodes(one)


def agreed(text: str, name: str, view: Json) -> None:
    """Form, graph and text: what each shows is what the text says."""
    system, complaints = read(text, name)
    assert [one["code"] for one in view["complaints"]] == [one.code for one in complaints]
    assert view["format"] == ("yaml" if name.endswith("yaml") else "text")
    places = {tuple(node["path"]): node for node in _nodes(view["tree"])}
    for index, body in enumerate(view["bodies"]):
        for field in body["fields"].values():
            if field["source"] is None:
                continue
            node = places[tuple(field["path"])]
            assert (node["from"], node["to"]) == (field["from"], field["to"])
            assert node.get("source", field["source"]) == field["source"]
        assert body["path"] == ["bodies", index]
    if system is not None:
        assert view["name"] == system.name
        graph = [(one["name"], one["parent"] or "0") for one in view["bodies"]]
        assert graph == [(one.name, one.attached_to) for one in system.bodies]
        assert len(view["loads"]) == len(system.loads)
    if name.endswith("yaml"):
        assert _said(view["tree"]) == yaml.load(text.removeprefix("\ufeff"), yaml.BaseLoader)


def _said(node: Json) -> Any:
    """The tree that form and graph are made of, as plain data."""
    children = node.get("children", [])
    if node["kind"] == "mapping":
        return {one["path"][-1]: _said(one) for one in children}
    if node["kind"] == "sequence":
        return [_said(one) for one in children]
    source = node["source"]
    return "" if not source else yaml.load(source, yaml.BaseLoader)


def untouched(text: str, view: Json, answer: Json, op: Json) -> None:
    """Outside of what the operation names the bytes stay."""
    removed = "".join(text[one["from"] : one["to"]] for one in answer["edits"])
    if op["op"] == "set":
        node = next((one for one in _nodes(view["tree"]) if one["path"] == op["path"]), None)
        if node is not None:
            for one in answer["edits"]:  # a block becomes a line: the line end before it goes
                assert not text[one["from"] : node["from"]].strip()
                assert one["to"] <= node["to"]
            return
    if op["op"] in ("add body", "insert", "duplicate branch"):
        counted = "0123456789" if view["format"] == "text" else ""  # bodies and loads have numbers there
        assert not removed.strip(" \r\n[]{}" + counted), removed
    if op["op"] == "rename":
        assert {text[one["from"] : one["to"]] for one in answer["edits"]} <= {op["name"]}
        assert {one["insert"] for one in answer["edits"]} <= {op["to"]}
    if op["op"] == "rename body":
        assert {text[one["from"] : one["to"]].strip("'\"") for one in answer["edits"]} <= {op["body"]}


def _copied(before: Json, after: Json, op: Json) -> None:
    """The branch again by other names, behind it; so what acts on its coordinates, and how they move and begin."""
    branch, old = _branch(before, op["body"]), _bodies(before)
    first = [one for one in before["bodies"] if one["name"] in branch]
    copies = [one for one in after["bodies"] if one["name"] not in old]
    assert len(copies) == len(first)
    own = map(_own, copies)
    assert not set().union(*own) & set().union(*(_own(one) for one in before["bodies"]))
    pairs = [(_listed(one), _listed(copy)) for one, copy in zip(first, copies, strict=True)]
    names = {name: new for one, copy in pairs for name, new in zip(one, copy, strict=True)}
    bodies = {one["name"]: copy["name"] for one, copy in zip(first, copies, strict=True)}
    word = re.compile(rf"(?<!\w)({'|'.join(names)})(?!\w)") if names else None

    def renamed(text: str) -> str:
        return bodies.get(text, text if word is None else word.sub(lambda found: names[found[1]], text))

    for one, copy in zip(first, copies, strict=True):
        assert copy == {"attached to": "0"} | _everywhere(one, renamed)
    wanted = deepcopy(before)
    acting = [one for one in before.get("loads", []) if set(names) & _words(one)]
    if acting:
        wanted["loads"] += [_everywhere(one, renamed) for one in acting]
    for section in ("motion", "initial"):
        told = {name: one for name, one in before.get(section, {}).items() if name in names}
        if told:
            wanted[section] |= {names[name]: _everywhere(one, renamed) for name, one in told.items()}
    assert after | {"bodies": [one for one in after["bodies"] if one["name"] in old]} == wanted


def _listed(body: Json) -> list[str]:
    """Coordinates of a body, in their order."""
    own = _own(body)
    angles = body.get("rotation", {}).get("angles", [])
    return [one for one in body.get("coordinates", angles) if one in own]


def _same_meaning(before: Json, after: Json, op: Json) -> None:
    if op["op"] == "duplicate branch":
        _copied(before, after, op)
        return
    wanted = meant(before, op)
    if op["op"] in ("reattach", "delete branch"):
        wanted, after = _without_order(wanted), _without_order(after)
    assert after == wanted, op


STEP = st.tuples(st.integers(0, KINDS - 1), st.integers(0, 11), st.integers(0, 11))
MANY = int(os.environ.get("MBSYM_EDIT_SEQUENCES", "16"))
LAW = settings(
    max_examples=MANY,
    derandomize=MANY < 50,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)


@pytest.mark.parametrize("spelling", SPELLINGS)
@LAW
@given(steps=st.lists(STEP, min_size=5, max_size=9))
def test_views_agree_and_undo_gives_back_the_bytes(spelling: str, steps: list[tuple[int, int, int]]) -> None:
    first, name = SPELLINGS[spelling]
    text, history = first, []
    for number, (kind, a, b) in enumerate(steps):
        view = look(text, name)
        op = operation(view, kind, a, b, str(number))
        if op is None:
            continue
        answer = changes(text, name, [op])
        if "complaints" in answer:
            assert answer["complaints"][0]["code"] in REFUSALS, (op, answer, text)
            continue
        after, back = edited(text, answer)
        assert taken_back(after, back) == text
        shown = look(after, name)
        agreed(after, name, shown)
        untouched(text, view, answer, op)
        if name.endswith("yaml"):
            _same_meaning(_said(view["tree"]), _said(shown["tree"]), op)
        system = read(text, name)[0]
        if system is not None and op["op"] in KEEPING:
            assert read(after, name)[0] is not None, (op, after)
        assert ("\r\n" in after) == ("\r\n" in first)
        assert after.count("\n") == after.count("\r\n") or "\r\n" not in first
        history.append((text, after, answer, back))
        text = after
    for before, after, answer, back in reversed(history):
        text = taken_back(text, back)
        assert text == before
        assert edited(text, answer)[0] == after  # redo
    assert text == first


@LAW
@given(steps=st.lists(STEP, min_size=5, max_size=9))
def test_both_spellings_become_the_same_system(steps: list[tuple[int, int, int]]) -> None:
    """YAML and editor text, each changed by its own code."""
    texts = {"x.yaml": BLOCK, "x.txt": _plain()}
    for number, (kind, a, b) in enumerate(steps):
        op = operation(look(texts["x.yaml"], "x.yaml"), kind, a, b, str(number))
        if op is None:
            continue
        answers = {name: changes(text, name, [op]) for name, text in texts.items()}
        refused = {name: answer["complaints"][0]["code"] for name, answer in answers.items() if "edits" not in answer}
        if refused:
            assert len(refused) == 2, (op, refused)
            continue
        texts = {name: edited(text, answers[name])[0] for name, text in texts.items()}
        yaml_system, text_system = (read(text, name)[0] for name, text in texts.items())
        assert yaml_system == text_system, (op, texts)


def test_names_that_stand_for_others_are_never_changed_through_one_of_them() -> None:
    """Anchors: said to be wrong, and no operation is done, for it would change another place as well."""
    text = BLOCK.replace("mass: m\n", "mass: &m m\n", 1).replace("mass: 'm'", "mass: *m")
    assert "alias" in [one["code"] for one in look(text, "x.yaml")["complaints"]]
    view = look(BLOCK, "x.yaml")
    for kind in range(KINDS):
        op = operation(view, kind, 1, 1, "9")
        if op is not None:
            assert changes(text, "x.yaml", [op])["complaints"][0]["code"] == "alias"


@pytest.mark.parametrize("what", ["another place", "a neighbour's bytes", "a body too many"])
def test_planted_mistakes_are_seen(what: str) -> None:
    """The laws deny what is not so: an edit beside its node, one that takes a comment, a graph of its own."""
    op = {"op": "set", "path": ["bodies", 0, "mass"], "source": "2*m"}
    view, answer = look(BLOCK, "x.yaml"), changes(BLOCK, "x.yaml", [op])
    if what == "another place":
        place = BLOCK.rindex("'m'")
        wrong = {"edits": [{"from": place, "to": place + 3, "insert": "2*m"}]}
        with pytest.raises(AssertionError):
            _same_meaning(_said(view["tree"]), _said(look(edited(BLOCK, wrong)[0], "x.yaml")["tree"]), op)
    elif what == "a neighbour's bytes":
        wrong = {"edits": [answer["edits"][0] | {"to": answer["edits"][0]["to"] + 3}]}
        with pytest.raises(AssertionError):
            untouched(BLOCK, view, wrong, op)
    else:
        view["bodies"].append(view["bodies"][0] | {"path": ["bodies", 2]})
        with pytest.raises(AssertionError):
            agreed(BLOCK, "x.yaml", view)
