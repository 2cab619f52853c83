"""One table of keys: what follows from it for each kind of load and constraint, and for one that is added."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from conftest import system_of

from mbsym.editing import explanation, suggestions
from mbsym.editing.document.changing import changes
from mbsym.editing.document.view import look
from mbsym.expressions.place import Span
from mbsym.expressions.tree import ZERO, Expression, Name, Number
from mbsym.model.loads import Acting
from mbsym.source import json_schema, read, to_text, to_yaml, topics
from mbsym.source.examples import example_text
from mbsym.source.grammar import Ends, Equation, Formula, Key, Kind, Record, Type, Vector, Way, plain
from mbsym.source.keys import AXIS, CONSTRAINTS, DESCRIPTION, LOADS
from mbsym.source.scope import Allowed
from mbsym.source.yaml_writer import constraint_shape, load_shape

KINDS = [*LOADS.items(), *CONSTRAINTS.items()]


def types_in(one: Type) -> list[Type]:
    """All types of a table, from the whole inwards."""
    found = []
    for inner in plain(one):
        keys = getattr(inner, "keys", None) or getattr(inner, "kinds", None) or {}
        value = getattr(inner, "value", None)
        found += [inner, *(x for key in keys.values() for x in types_in(key.type))]
        found += types_in(value) if value is not None else []
    return found


# --- the table --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "kind"), KINDS, ids=[name for name, _ in KINDS])
def test_each_way_of_a_kind_goes_there_and_back(name: str, kind: Kind) -> None:
    """What is made of values that are all different is written as these, under the keys of its way."""
    numbers = iter(range(1, 100))

    def some(of: Type) -> Any:
        match of:
            case Formula():
                return Number(next(numbers))
            case Vector():
                return (Number(next(numbers)), Number(next(numbers)), Number(next(numbers)))
            case Ends(record):
                values = [(f"body {next(numbers)}", some(Vector())) for _ in range(2)]
                return tuple(record.made(*x) for x in values)  # type: ignore[misc]
            case Equation():
                return Name("x"), Number(next(numbers))
        return ((f"q{next(numbers)}", Number(next(numbers))),) if not kind.keys else f"name {next(numbers)}"

    shape = load_shape if name in LOADS else constraint_shape
    for way in kind.ways:
        assert set(way.keys) <= set(kind.keys)
        types = [kind.keys[key].type for key in way.keys] or [kind.type]
        values = [some(of) for of in types]
        flat = [x for of, v in zip(types, values, strict=True) for x in (v if isinstance(of, Ends | Equation) else [v])]
        made = way.of(flat, Span(1, 1))
        if way.make is not None and way.parts is None:
            continue  # another way writes it
        assert way.values(made) == tuple(flat)
        found, data = shape(made)
        assert found == name
        assert not way.keys or list(data) == list(way.keys)


def test_every_key_has_a_meaning_and_a_schema() -> None:
    """A type without a schema would raise; a key without a meaning would be explained by nothing."""
    assert json_schema()["$defs"]["axis"]["required"] == list(AXIS)
    records = [one for one in types_in(DESCRIPTION) if isinstance(one, Record)]
    assert len(records) > 20
    assert not [key for record in records for key, one in record.keys.items() if not one.meaning]
    assert all(kind.meaning and kind.ways for _, kind in KINDS)


def test_explain_lists_every_key() -> None:
    """As the README says; constraints, tables, matrices, small parameters, motions and states were missing."""
    said = "\n".join([topics.description(), topics.loads(), topics.constraints(), topics.claim_kinds()])
    records = [one for one in types_in(DESCRIPTION) if isinstance(one, Record)]
    for name, key in [pair for record in records for pair in topics.keys_of(record).items()]:
        assert re.search(rf"^    {re.escape(name)} +{re.escape(key.meaning[:20])}", said, re.MULTILINE), name
    assert all(f"{name}: {kind.meaning}" in said for name, kind in KINDS)


# --- what the reader refuses, the schema refuses ----------------------------------------------------------------------

POINTS = [{"body": "b", "point": [0, 0, 0]}, {"body": "0", "point": [1, 0, 0]}]
DESCRIBED: dict[str, Any] = {
    "mbsym": 1,
    "name": "x",
    "parameters": {"k": "positive"},
    "bodies": [{"name": "b", "mass": 1, "connection point": ["x", 0, 0], "coordinates": ["x"]}],
}


@pytest.mark.parametrize(
    ("load", "at_fault"),
    [
        ({"spring": {"between": POINTS, "stiffness": "k"}}, "length"),
        ({"spring": {"between": POINTS, "stiffness": "k", "length": 1, "rest": 1}}, "rest"),
        ({"spring": {"coordinate": "x", "stiffness": "k", "length": 1}}, "length"),
        ({"damper": {"coordinate": "x", "between": POINTS, "coefficient": "k"}}, "coordinate"),
        ({"spring": {"stiffness": "k"}}, "coordinate"),
        ({"uniform gravity": {"direction": [0, 0, 1]}}, "acceleration"),
        ({"uniform gravity": {"acceleration": "k"}}, "direction"),
        ({"uniform gravity": {"vector": [0, 0, "k"], "direction": [0, 0, 1]}}, "direction"),
        ({"newtonian gravity": {"constant": "k", "about": "b"}}, "centre"),
        ({"force": {"body": "b", "components": ["k", 0, 0], "axes": "b"}}, "point"),
    ],
)
def test_the_schema_and_the_reader_refuse_the_same(load: dict[str, Any], at_fault: str) -> None:
    """Of a kind that is given in two ways the schema took any mixture of their keys, and gravity without its centre."""
    described = {**DESCRIBED, "loads": [load]}
    _, complaints = read(to_json(described), "x.json")
    errors = [one for one in complaints if one.severity == "error"]
    assert any(at_fault in one.message for one in errors)
    told = list(jsonschema.Draft202012Validator(json_schema()).iter_errors(described))
    assert told
    places = [{*one.absolute_path, *one.message.split("'")} for one in told]
    assert all(at_fault in place or "between" in place for place in places), "of two that do not go together, either"


def test_the_schema_knows_other_spellings_of_what_must_be_there() -> None:
    load = {"newtonian gravity": {"constant": "k", "center": 0, "about": "b"}}
    jsonschema.validate({**DESCRIBED, "loads": [load]}, json_schema())


def to_json(data: Any) -> str:
    import json

    return json.dumps(data)


# --- a new kind -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Cubic(Acting):
    """U = -stiffness (coordinate - rest)^4 / 4."""

    coordinate: str
    stiffness: Expression
    rest: Expression
    span: Span | None = field(default=None, compare=False)

    @property
    def coordinates(self) -> tuple[str, ...]:
        return (self.coordinate,)


NEW = """mbsym: 1
name: A mass on a cubic spring
parameters: {k: positive, m: positive, x0: real}
bodies:
  - {name: mass, mass: m, connection point: [x, 0, 0], coordinates: [x]}
loads:
  - cubic spring: {coordinate: x, stiffness: k, rest: x0}
"""


@pytest.fixture
def cubic_spring(monkeypatch: pytest.MonkeyPatch) -> Kind:
    """A kind of load that is nothing but a row."""
    spring = LOADS["spring"].keys
    keys = {
        "coordinate": spring["coordinate"],
        "stiffness": Key("force per displacement cubed", Formula(Allowed("a cubic stiffness")), required=True),
        "rest": spring["rest"],
    }
    kind = Kind("a spring that hardens", Record(keys), ways=(Way(Cubic, tuple(keys)),))
    monkeypatch.setitem(LOADS, "cubic spring", kind)
    return kind


def test_a_new_kind_of_load_is_a_row(cubic_spring: Kind) -> None:
    """Read, written in both spellings, explained, completed, in the schema and in renaming, by its row alone."""
    system = system_of(NEW, "new.yaml")
    assert system.loads == (Cubic("x", Name("k"), Name("x0")),)
    for spelled, name in ((to_yaml(system), "a.yaml"), (to_text(system), "a.txt")):
        again, _ = read(spelled, name)
        assert again == system
    assert "  Type of load: cubic spring\n  Coordinate: x\n  Stiffness: k\n  Rest: x0" in to_text(system)
    assert "cubic spring: a spring that hardens" in topics.loads()
    line = NEW.split("\n").index("  - cubic spring: {coordinate: x, stiffness: k, rest: x0}")
    assert explanation(NEW, line, 40) == "**stiffness**: force per displacement cubed"
    begun = NEW.replace("coordinate: x, stiffness: k, rest: x0}", "")
    column = len("  - cubic spring: {")
    assert [one.label for one in suggestions(begun, line, column, system)] == ["coordinate", "stiffness", "rest"]
    validator = jsonschema.Draft202012Validator(json_schema())
    data = {**DESCRIBED, "loads": [{"cubic spring": {"coordinate": "x", "stiffness": "k"}}]}
    assert not list(validator.iter_errors(data))
    (shown,) = look(NEW, "new.yaml")["loads"]
    assert (shown["kind"], shown["bodies"]) == ("cubic spring", ["mass"])
    renamed = changes(NEW, "new.yaml", [{"op": "rename", "kind": "parameter", "name": "k", "to": "c"}])
    assert [one["insert"] for one in renamed["edits"]] == ["c", "c"]


@pytest.mark.parametrize(
    ("load", "said"),
    [
        ("{coordinate: x}", "'cubic spring' has no 'stiffness'"),
        ("{coordinate: y, stiffness: k}", "unknown name 'y'"),
        ("{coordinate: x, stifness: k}", "unknown key 'stifness' in 'cubic spring'"),
        ("{coordinate: x, stiffness: x}", "'x' is a coordinate, and a cubic stiffness holds only parameters"),
        ("{coordinate: x, stiffness: k, rest: [1]}", "a rest position must be a single value, not a list"),
    ],
)
def test_what_is_wrong_with_a_new_kind_is_told(cubic_spring: Kind, load: str, said: str) -> None:
    _, complaints = read(NEW.replace("{coordinate: x, stiffness: k, rest: x0}", load), "new.yaml")
    assert said in [one.message for one in complaints if one.severity == "error"]


def test_zero_is_left_out_where_it_goes_without_saying(cubic_spring: Kind) -> None:
    assert load_shape(Cubic("x", Name("k"), ZERO)) == ("cubic spring", {"coordinate": "x", "stiffness": "k"})  # type: ignore[arg-type]


# --- places -----------------------------------------------------------------------------------------------------------


def completed(marked: str) -> list[str]:
    """What is offered at the ``|`` of a text; its system is that of ``tests/everything.yaml``."""
    system, _ = read((Path(__file__).parents[1] / "everything.yaml").read_text(encoding="utf-8"), "everything.yaml")
    before = marked.partition("|")[0]
    offered = suggestions(marked.replace("|", ""), before.count("\n"), len(before) - before.rfind("\n") - 1, system)
    return [one.label for one in offered]


@pytest.mark.parametrize(
    ("marked", "some"),
    [
        ("constraints:\n  - rolling: {body: arm, on: |", ["0", "cart", "arm"]),
        ("loads:\n  - newtonian gravity: {order: |", ["2", "3", "4", "exact"]),
        ("loads:\n  - generalized force: {|", ["x", "phi"]),
        ("claims:\n  - {claim: angular velocity, component: |", ["1", "2", "3"]),
        ("language: |", ["en", "ru", "es"]),
    ],
)
def test_a_value_is_completed_by_its_type(marked: str, some: list[str]) -> None:
    found = completed(marked)
    assert set(some) <= set(found)
    assert "sin" not in found


@pytest.mark.parametrize("marked", ["loads: |", "bodies:\n  - name: a\n    rotation: |", "loads:\n  - spring: |"])
def test_no_name_is_offered_where_a_mapping_is_wanted(marked: str) -> None:
    assert completed(marked) == []


def test_a_word_is_no_name() -> None:
    """A parameter may be called as the word for the initial state is; that word stays where it is renamed."""
    text = NEW.replace(
        "cubic spring: {coordinate: x, stiffness: k, rest: x0}", "spring: {coordinate: x, stiffness: initial}"
    )
    text = text.replace("k: positive", "initial: positive") + "initial: {x: 1}\nvalues: {initial: 2, m: 1}\nclaims:\n"
    text += "  - {claim: value, of: x, state: initial, equals: 1}\n"
    done = changes(text, "x.yaml", [{"op": "rename", "kind": "parameter", "name": "initial", "to": "k"}])
    assert len(done["edits"]) == 3, done


@pytest.mark.parametrize("words", ["F = m a", "plain: x", "a; b", 'with "quotes" = \\', "= 3", "a = b; c = d"])
def test_texts_for_people_come_back_from_the_editors_text(words: str) -> None:
    """What an input means was read as a key of its own where it held an equals sign."""
    described = {**DESCRIBED, "name": words, "description": words, "inputs": {"u": {"meaning": words}, "v": words}}
    described["parameters"] = {"k": {"sign": "positive", "meaning": words}}
    described["prescribed"] = {"w": {"rate": "k", "meaning": words}}
    described["loads"] = [{"generalized force": {"x": "u + v*w"}}]
    described["claims"] = [{"claim": "kinetic energy", "equals": "x_dot**2/2", "place": words}]
    system, complaints = read(to_json(described), "x.json")
    assert system is not None, list(complaints)
    again, complaints = read(to_text(system), "x.txt")
    assert again == system, list(complaints)


def test_a_kind_is_shown_as_it_stands_in_a_shipped_system() -> None:
    """Whole, where the description has it: what is copied from there into a list of the same name is read."""
    shown = set()
    for section, kinds in (("loads", LOADS), ("constraints", CONSTRAINTS)):
        for kind in kinds:
            told = re.search(rf"As in (\S+)\.yaml .*\n\n    {section}:\n      - (.+)$", topics.meanings(kind)[0])
            if told:
                shown.add(kind)
                text = example_text(told[1])
                assert f"- {told[2]}\n" in text
                (item,) = yaml.safe_load(f"- {told[2]}")
                assert item in yaml.safe_load(text)[section]
    assert {"spring", "damper", "uniform gravity", "rolling", "distance", "coincide"} <= shown
