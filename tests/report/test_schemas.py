"""The JSON files follow the schemas that are shipped, and the schemas' words are those of the code."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from conftest import OWN, SHIPPED, derived
from jsonschema import Draft202012Validator

import mbsym
from mbsym.algebra.failures import Limit, Severity
from mbsym.model.claims import CLAIMS
from mbsym.numerics.accuracy import Lacking
from mbsym.numerics.conservation import Doubt, Standing
from mbsym.problems.checks import EXACT, FAILED, NUMERICAL, SINGULAR, UNDECIDED
from mbsym.problems.normal_forms import Theorem
from mbsym.problems.stability.reasons import Because
from mbsym.problems.stability.requirements import Method, Place
from mbsym.problems.stability.theorems import THEOREMS
from mbsym.problems.stability.word import Word
from mbsym.report.results_json import render
from mbsym.report.schemas import names, schema
from mbsym.report.simulation_json import simulation_json
from mbsym_cli.main import main
from mbsym_cli.schema import DESCRIPTION

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


@pytest.mark.parametrize("name", names())
def test_a_schema_is_one_and_describes_every_property(name: str) -> None:
    whole = schema(name)
    Draft202012Validator.check_schema(whole)
    assert whole["$id"].startswith("urn:mbsym:") or whole["$id"].startswith("https://")
    for part in parts(whole):
        if isinstance(part.get("properties"), dict):
            assert part.get("additionalProperties") is False, part.get("description")
            for key, value in part["properties"].items():
                assert value.get("description"), key


@pytest.mark.parametrize("name", [DESCRIPTION, *names()])
def test_the_command_prints_it(name: str) -> None:
    done = CliRunner().invoke(main, ["schema", name])
    assert done.exit_code == 0
    assert name == DESCRIPTION or json.loads(done.stdout) == schema(name)
    assert "$schema" in json.loads(done.stdout)


def test_the_words_of_the_schemas_are_those_of_the_code() -> None:
    words = RESULTS["$defs"]
    assert set(words["verdict"]["enum"]) == set(Word)
    names = {theorem.name for theorem in THEOREMS} | {item.value for item in Theorem if item is not Theorem.NONE}
    assert set(words["theorem"]["enum"]) == names
    assert set(words["place"]["enum"]) == {place.name.lower() for place in Place}
    assert set(words["failure"]["properties"]["severity"]["enum"]) == {item.value for item in Severity}
    assert set(words["failure"]["properties"]["limit"]["enum"]) == {None, *(item.value for item in Limit)}
    of = RESULTS["properties"]
    assert set(of["claims"]["items"]["properties"]["kind"]["enum"]) == set(CLAIMS)
    outcomes = {EXACT, NUMERICAL, UNDECIDED, SINGULAR, FAILED}
    assert set(of["checks"]["items"]["properties"]["outcome"]["enum"]) == outcomes
    stability = of["stability"]["properties"]
    reasons = stability["reasons"]["items"]["properties"]["code"]["enum"]
    assert set(reasons) == {item.name.lower() for item in Because}
    methods = stability["subsystems"]["items"]["properties"]["method"]["enum"]
    assert set(methods) == {item.name.lower() for item in Method}
    energy = schema("simulation")["properties"]["energy"]["properties"]
    assert set(energy["how"]["enum"]) == {item.value for item in Standing}
    assert set(energy["doubt"]["enum"]) == {None, *(item.name.lower() for item in Doubt)}
    none = schema("simulation")["properties"]["estimated_error"]["oneOf"][0]
    assert set(none["properties"]["why"]["enum"]) == {item.name.lower() for item in Lacking}


def test_the_other_files_follow_theirs() -> None:
    for name in ("satellite", "spring-pendulum"):
        run = mbsym.simulate(SHIPPED / f"{name}.yaml", 0.2, samples=5, invariants=True)
        content = json.loads(simulation_json(run, ["trajectory.csv"]))
        assert complaints("simulation", content) == []
        assert complaints("simulation", content | {"enrgy": 1})
    for name in ("double-pendulum", "cart-pendulum"):
        done = CliRunner().invoke(main, ["equilibria", str(SHIPPED / f"{name}.yaml"), "--json"])
        found = json.loads(done.stdout)
        assert complaints("equilibria", found) == []
        assert complaints("equilibria", found | {"complete": "yes"})
