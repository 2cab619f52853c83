"""The JSON files follow the schemas that are made from their types, and the schemas' words are those of the code."""

from __future__ import annotations

import json
from collections.abc import Iterator
from enum import Enum
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Annotated, Any

import pytest
from conftest import OWN, SHIPPED, derived, invoked
from jsonschema import Draft202012Validator
from msgspec import UNSET, Meta, UnsetType

import mbsym
from mbsym.algebra.failures import Limit
from mbsym.batch.summary_json import schema as of_batches
from mbsym.numerics.conservation import Doubt
from mbsym.problems.checks import EXACT, FAILED, NUMERICAL, SINGULAR, UNDECIDED
from mbsym.problems.normal_forms.result import Theorem
from mbsym.problems.stability.words import THEOREMS, Because, Word
from mbsym.report.documents.base import From, Part, told_apart_by, words, written
from mbsym.report.results_json import render
from mbsym.report.runs.simulation_json import simulation_json
from mbsym.report.schemas import names, schema, schema_of
from mbsym_cli.schema import DESCRIPTION, SUMMARY

SYSTEMS = sorted([*SHIPPED.glob("*.yaml"), *OWN.glob("*.yaml")])
RESULTS = schema("results")


def complaints(name: str, content: Any) -> list[str]:
    return [f"{list(x.absolute_path)}: {x.message}" for x in Draft202012Validator(schema(name)).iter_errors(content)]


def parts(found: Any) -> Iterator[dict[str, Any]]:
    """Every schema within a schema."""
    if isinstance(found, dict):
        yield found
        for item in found.values():
            yield from parts(item)
    elif isinstance(found, list):
        for item in found:
            yield from parts(item)


@pytest.mark.parametrize("path", SYSTEMS, ids=lambda path: path.stem)
def test_results_of_every_system_follow_their_schema(path: Path) -> None:
    analysis = derived(path)
    assert complaints("results", json.loads(render(analysis, analysis.problems))) == []


def test_a_misspelt_property_or_word_is_caught() -> None:
    analysis = derived(SHIPPED / "ziegler.yaml")
    text = render(analysis, analysis.problems)
    for right, wrong in (
        ('"mass_matrix"', '"mass_matirx"'),
        ('"unstable"', '"instable"'),
        ('"place": "necessary"', '"place": "necesary"'),
        ('"format": 1', '"format": 2'),
        ('"code": "see_cases"', '"code": "See the cases."'),
        ('"relation": ">"', '"relation": "=>"'),
    ):
        assert right in text
        assert complaints("results", json.loads(text.replace(right, wrong))), wrong


def test_results_without_closed_forms_follow_it_too() -> None:
    analysis = mbsym.load(SHIPPED / "satellite.yaml")
    analysis.terms = 60
    found = json.loads(render(analysis, analysis.problems))
    assert found["unavailable"]["equations"]["limit"] == "terms of a formula"
    assert complaints("results", found) == []


@pytest.mark.parametrize("name", [*names(), SUMMARY])
def test_a_schema_is_one_and_describes_every_property(name: str) -> None:
    whole = of_batches() if name == SUMMARY else schema(name)
    Draft202012Validator.check_schema(whole)
    assert whole["$id"].startswith("urn:mbsym:") or whole["$id"].startswith("https://")
    assert undocumented(whole) == []


def undocumented(whole: dict[str, Any]) -> list[str]:
    """The properties that do not say what they are."""
    objects = [part for part in parts(whole) if isinstance(part.get("properties"), dict)]
    assert all(part.get("additionalProperties") is False for part in objects)
    return [key for part in objects for key, value in part["properties"].items() if not value.get("description")]


class Rod(Part, frozen=True):
    """a rod"""

    length: Annotated[float, "in metres", Meta(ge=0)]
    mass: float
    from_: Annotated[str | UnsetType, "the body that it comes from"] = UNSET


class Rods(Part, frozen=True):
    longest: Rod
    others: Annotated[list[Rod], "the others", told_apart_by("length")]


def test_a_schema_is_what_its_type_says() -> None:
    """What stands twice is told once; what may be left out is not required; a type without a word says nothing."""
    assert schema_of(Rods, "rods", "rods.json") == {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": "urn:mbsym:rods:1",
        "title": "rods.json",
        "type": "object",
        "additionalProperties": False,
        "required": ["longest", "others"],
        "properties": {
            "longest": {"description": "a rod", "$ref": "#/$defs/rod"},
            "others": {
                "description": "the others",
                "type": "array",
                "items": {"$ref": "#/$defs/rod"},
                "x-tell-apart": ["length"],
            },
        },
        "$defs": {
            "rod": {
                "description": "a rod",
                "type": "object",
                "additionalProperties": False,
                "required": ["length", "mass"],
                "properties": {
                    "length": {"description": "in metres", "type": "number", "minimum": 0},
                    "mass": {"description": "", "type": "number"},
                    "from": {"description": "the body that it comes from", "type": "string"},
                },
            }
        },
    }


def test_a_field_without_a_word_and_a_key_without_a_field_are_caught() -> None:
    assert undocumented(schema_of(Rods, "rods", "rods.json")) == ["mass"]
    with pytest.raises(TypeError, match="colour"):
        Rod(length=1.0, mass=2.0, colour="red")  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="mass"):
        Rod(length=1.0)  # type: ignore[call-arg]
    rods = Rods(longest=Rod(length=1.0, mass=2.0, from_="pole"), others=[Rod(length=0.5, mass=1.0)])
    assert json.loads(written(rods)) == {
        "longest": {"length": 1.0, "mass": 2.0, "from": "pole"},
        "others": [{"length": 0.5, "mass": 1.0}],
    }


@pytest.mark.parametrize("name", [DESCRIPTION, *names()])
def test_the_command_prints_it(name: str) -> None:
    done = invoked("schema", name, code=0)
    assert name == DESCRIPTION or json.loads(done.stdout) == schema(name)
    assert "$schema" in json.loads(done.stdout)


def test_the_words_of_the_schemas_are_those_of_the_code() -> None:
    """Of each way in which words come into a schema: an enumeration, its names, a list, a list with null."""
    stability = RESULTS["properties"]["stability"]["properties"]
    assert set(stability["verdict"]["enum"]) == set(Word)
    names = {theorem.name for theorem in THEOREMS} | {item.value for item in Theorem if item is not Theorem.NONE}
    assert set(stability["theorems"]["items"]["enum"]) == names
    assert set(RESULTS["$defs"]["reason"]["properties"]["code"]["enum"]) == {item.name.lower() for item in Because}
    failure = RESULTS["properties"]["unavailable"]["additionalProperties"]["properties"]
    assert set(failure["limit"]["enum"]) == {None, *(item.value for item in Limit)}
    outcomes = {EXACT, NUMERICAL, UNDECIDED, SINGULAR, FAILED}
    assert set(RESULTS["properties"]["checks"]["items"]["properties"]["outcome"]["enum"]) == outcomes
    energy = schema("simulation")["properties"]["energy"]["properties"]
    assert set(energy["doubt"]["enum"]) == {None, *(item.name.lower() for item in Doubt)}


def test_the_other_files_follow_theirs() -> None:
    for name in ("satellite", "spring-pendulum"):
        run = mbsym.simulate(SHIPPED / f"{name}.yaml", 0.2, samples=5, invariants=True)
        content = json.loads(simulation_json(run, ["trajectory.csv"]))
        assert complaints("simulation", content) == []
        assert complaints("simulation", content | {"enrgy": 1})
    for name in ("double-pendulum", "cart-pendulum"):
        done = invoked("equilibria", SHIPPED / f"{name}.yaml", "--json")
        found = json.loads(done.stdout)
        assert complaints("equilibria", found) == []
        assert complaints("equilibria", found | {"complete": "yes"})


class Rank(Enum):
    FULL = "of full rank"


class Kept(Part, frozen=True):
    length: Annotated[str, "exact", From("size.length")]
    rank: Annotated[str, words(Rank), "in small letters"]
    largest: Annotated[float | None, "null where it is infinite"]
    rods: Annotated[list[Rod], "as tuples"]
    names: Annotated[dict[str, str], "from pairs"]
    beside: Annotated[str | UnsetType, "left out where it is empty", From()] = UNSET
    given: Annotated[int, "where nothing is given"] = 7


def test_a_part_fills_itself_from_a_result() -> None:
    """By names, paths and types: what has to be text is written, None stays, what is empty may be left out."""
    result = SimpleNamespace(
        size=SimpleNamespace(length=Fraction(1, 3)), rank=Rank.FULL, largest=float("inf"), rods=[(1.0, 2.0, "pole")],
        names=(("a", Fraction(1, 2)),), beside=(), given=8,
    )  # fmt: skip
    rod = {"length": 1.0, "mass": 2.0, "from": "pole"}
    filled = {"length": "1/3", "rank": "full", "largest": None, "rods": [rod], "names": {"a": "1/2"}, "given": 7}
    assert json.loads(written(Kept.from_result(result))) == filled
    assert Kept.from_result(result, lambda x: f"<{x}>").names == {"a": "<1/2>"}
    assert Kept.from_result(result, beside="b").beside == "b"
    assert Kept.from_result(SimpleNamespace(**vars(result) | {"size": None}), length="2").length == "2"
    with pytest.raises(AttributeError, match="rank"):
        Kept.from_result(SimpleNamespace(size=result.size))
    with pytest.raises(ValueError, match="longer"):
        Rod.from_result((1.0, 2.0, "pole", "one more"))
