"""mbsym diff: what changed is found, exactly and completely; nothing else is."""

from __future__ import annotations

import copy
import json
import math
import random
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from conftest import SHIPPED, filed, invoked
from hypothesis import given
from jsonschema import Draft202012Validator
from properties import settings
from random_systems import systems

import mbsym
from mbsym.diff import Kind, Renaming, diff
from mbsym.report.results_json import render
from mbsym.report.schemas import schema

FORMULAS = {
    "rotation", "angular_velocity", "velocity_origin", "velocity_mass_centre", "kinetic_energy", "A2", "A1", "A0",
    "force_function", "mass_matrix", "forcing", "M", "D", "G", "K", "N", "formula", "characteristic_polynomial",
    "notation", "time", "claimed", "derived", "difference",
}  # fmt: skip


def results(text: str) -> dict[str, Any]:
    analysis = mbsym.loads(text)
    found: dict[str, Any] = json.loads(render(analysis, analysis.problems))
    return found


@cache
def shipped(name: str) -> dict[str, Any]:
    return results((SHIPPED / f"{name}.yaml").read_text(encoding="utf-8"))


def places(found: Any, inside: bool = False) -> Iterator[tuple[Any, Any]]:
    """(container, key) of every formula of a document."""
    items = found.items() if isinstance(found, dict) else enumerate(found) if isinstance(found, list) else ()
    for key, value in items:
        within = inside or key in FORMULAS
        if isinstance(value, str):
            if within:
                yield found, key
        else:
            yield from places(value, within)


# --- nothing changed --------------------------------------------------------------------------------------------------


@settings(max_examples=8)
@given(systems())
def test_a_system_is_itself(description: dict[str, Any]) -> None:
    found = results(json.dumps(description))
    assert diff(found, copy.deepcopy(found)).same


def test_another_way_to_print_is_no_change() -> None:
    other = copy.deepcopy(shipped("ziegler"))
    other["equations"]["mass_matrix"][0][1] = "m*l**2*cos(theta2 - theta1)"
    other["linearisation"]["K"][0][0] = "-P*l + k + k"
    found = diff(shipped("ziegler"), other)
    assert found.same
    assert found.restated == (
        ("equations", "mass_matrix", "theta1", "theta2"),
        ("linearisation", "K", "theta1", "theta1"),
    )


# --- something did ----------------------------------------------------------------------------------------------------

NUMBERS = {name: getattr(math, name) for name in ("sin", "cos", "tan", "sqrt", "exp", "log", "atan", "pi")}


def value(text: str, seed: int) -> float | None:
    """The number at random values of all names: an evaluation of our own texts, independent of mbsym's ring."""
    names = sorted(set(re.findall(r"[A-Za-z_]\w*", text)))
    numbers = {name: random.Random(f"{name}{seed}").uniform(1, 2) for name in names} | NUMBERS
    try:
        return float(eval(text, {"__builtins__": {}}, numbers))
    except (ValueError, ZeroDivisionError, OverflowError):
        return None


def mutated(text: str, source: random.Random) -> str | None:
    """The formula with one sign, exponent or name changed; None where there is none of the chosen kind."""
    kind = source.choice(("sign", "exponent", "name"))
    if kind == "sign":
        signs = list(re.finditer(r"(?<=[\w)] )[+-](?= )", text)) or list(re.finditer(r"^-", text))
        if not signs:
            return f"-({text})" if text != "0" else None
        one = source.choice(signs)
        return text[: one.start()] + ("-" if one[0] == "+" else "+") + text[one.end() :]
    if kind == "exponent":
        powers = list(re.finditer(r"(?<=\*\*)\d+", text))
        if not powers:
            return None
        one = source.choice(powers)
        return text[: one.start()] + str(int(one[0]) + 1) + text[one.end() :]
    names = [one for one in re.finditer(r"[A-Za-z_]\w*", text) if one[0] not in NUMBERS]
    if not names:
        return None
    one = source.choice(names)
    return text[: one.start()] + one[0] + "x" + text[one.end() :]


@pytest.mark.parametrize("name", ["ziegler", "heavy-top", "tethered-satellites", "gyrostat"])
def test_one_sign_exponent_or_name_anywhere_is_found(name: str) -> None:
    a, source, tried = shipped(name), random.Random(name), 0
    everywhere = [(place, key) for place, key in places(copy.deepcopy(a)) if place[key] != "0"]
    assert len(everywhere) > 40
    for place, key in source.sample(everywhere, 40):
        before, after = place[key], mutated(place[key], source)
        if after is None:
            continue
        numbers = [(value(before, seed), value(after, seed)) for seed in range(3)]
        if all(x is None or y is None or math.isclose(x, y, rel_tol=1e-9, abs_tol=1e-9) for x, y in numbers):
            continue  # the same formula: -0, sin(x) of nothing, ...
        b = copy.deepcopy(a)
        paired = zip(places(b), places(a), strict=True)
        other = next(p for (p, k), (q, j) in paired if (k, q[j]) == (key, before))
        other[key] = after
        found = diff(a, b)
        assert [change.kind for change in found.changes] == [Kind.FORMULA], (before, after)
        tried += 1
    assert tried > 15


def test_the_difference_is_exact() -> None:
    other = copy.deepcopy(shipped("ziegler"))
    other["linearisation"]["K"][0][0] = "3*k - l*P"
    (change,) = diff(shipped("ziegler"), other).changes
    assert change.path == ("linearisation", "K", "theta1", "theta1")
    assert (change.kind, change.difference, change.terms) == (Kind.FORMULA, "k", 1)


def test_a_coefficient_is_told_by_its_power() -> None:
    other = copy.deepcopy(shipped("ziegler"))
    other["stability"]["subsystems"][0]["characteristic_polynomial"][2] += " + k"
    (change,) = diff(shipped("ziegler"), other).changes
    assert change.path[-2:] == ("characteristic_polynomial", "2")


def test_words_conditions_claims_and_checks_are_compared() -> None:
    a = shipped("tethered-satellites")
    b = copy.deepcopy(a)
    b["claims"][0]["outcome"] = "does not hold"
    b["checks"][1]["outcome"] = "FAILED"
    b["parameters"].pop()
    found = diff(a, b).changes
    kinds = {change.path[0]: change.kind for change in found}
    assert kinds == {"claims": Kind.CHANGED, "checks": Kind.CHANGED, "parameters": Kind.REMOVED}
    a = shipped("ziegler")
    b = copy.deepcopy(a)
    part = b["stability"]["subsystems"][0]
    part["conditions"] = part["conditions"][:1]
    part["cases"][0]["verdict"] = "stable"
    part["cases"][1]["theorems"] = ["Routh"]
    b["stability"]["at_values"]["verdict"] = "unstable"
    paths = {change.path[-1]: change.kind for change in diff(a, b).changes}
    assert paths.pop("verdict") == Kind.CHANGED
    assert paths == {"discriminant": Kind.REMOVED, "Lyapunov's first method": Kind.REMOVED, "Routh": Kind.ADDED}
    assert len(diff(a, b).changes) == 5


def test_a_matrix_is_compared_by_coordinates() -> None:
    """Of a double pendulum whose coordinates are listed the other way round, no entry is another one."""
    text = (SHIPPED / "double-pendulum.yaml").read_text(encoding="utf-8")
    a = shipped("double-pendulum")
    b = copy.deepcopy(a)
    b["coordinates"] = a["coordinates"][::-1]
    b["equations"]["mass_matrix"] = [row[::-1] for row in a["equations"]["mass_matrix"][::-1]]
    found = [change for change in diff(a, b).changes if "mass_matrix" in change.path]
    assert {change.kind for change in found} == {Kind.ORDER}
    assert text


def test_numbers_are_the_same_up_to_rounding() -> None:
    a = shipped("ziegler")
    b = copy.deepcopy(a)
    root = b["stability"]["eigenvalues_at_values"][0]["roots"][0]
    root["imaginary"] *= 1 + 1e-15
    assert diff(a, b).same
    root["imaginary"] *= 1 + 1e-9
    assert not diff(a, b).same


def test_counted_formulas_are_equal_by_their_digest_or_undecided() -> None:
    a = copy.deepcopy(shipped("ziegler"))
    a["energy"]["kinetic_energy"] = {"terms": 7000, "sha256": "0" * 64}
    b = copy.deepcopy(a)
    assert diff(a, b).same
    b["energy"]["kinetic_energy"]["sha256"] = "1" * 64
    (change,) = diff(a, b).changes
    assert change.kind is Kind.UNDECIDED


# --- names ------------------------------------------------------------------------------------------------------------


def test_a_name_that_is_replaced_throughout_is_renamed() -> None:
    text = (SHIPPED / "ziegler.yaml").read_text(encoding="utf-8")
    b = results(re.sub(r"\btheta2\b", "beta", re.sub(r"\bP\b", "F", text)))
    found = diff(shipped("ziegler"), b)
    assert set(found.renamed) == {Renaming("parameter", "P", "F"), Renaming("coordinate", "theta2", "beta")}
    assert [change for change in found.changes if change.path[0] != "system"] == []
    assert not found.same


def test_swapped_and_added_names_are_no_renaming() -> None:
    """k becomes a damper's coefficient: one name goes and one comes, and neither is the other."""
    text = (SHIPPED / "spring-pendulum.yaml").read_text(encoding="utf-8")
    a = results(text)
    spring = "spring: {coordinate: r, stiffness: k, rest: l0}"
    assert spring in text
    other = text.replace(spring, "damper: {coordinate: r, coefficient: c}").replace("k: ", "c: ").replace("/k", "/c")
    found = diff(a, results(other))
    assert found.renamed == ()
    assert ("parameters", "k") in [change.path for change in found.changes if change.kind is Kind.REMOVED]


@pytest.mark.parametrize(
    ("before", "after", "path"),
    [
        ("theta1: 1, theta2", "theta1: 3/2, theta2", ("initial", "theta1", "position")),
        ("theta2: 0.5}", "theta2: {position: 0.5, velocity: 1/2}}", ("initial", "theta2", "velocity")),
        ("theta2: 0.5}\n", "theta2: 0.5}\nprescribed: {chi: {rate: g, initial: 1}}\n", ("initial", "chi")),
        ("motion: {theta1: 0,", "motion: {theta1: pi,", ("motion", "theta1", "value")),
    ],
)
def test_what_no_formula_holds_is_compared(before: str, after: str, path: tuple[str, ...]) -> None:
    """Exports and simulations begin at the initial state, so that it is a part of what is derived."""
    text = (SHIPPED / "double-pendulum.yaml").read_text(encoding="utf-8")
    assert text.count(before) == 1
    other = results(text.replace(before, after))
    assert list(Draft202012Validator(schema("results")).iter_errors(other)) == []
    found = {change.path for change in diff(results(text), other).changes}
    assert path in found
    if path[1:2] != ("chi",) and path[0] == "initial":  # the others change formulas, too
        assert found == {path}


# --- the command ------------------------------------------------------------------------------------------------------


def test_the_command_checks_a_description_against_kept_results(tmp_path: Path) -> None:
    file, kept = SHIPPED / "ziegler.yaml", tmp_path / "ziegler"
    assert invoked("run", file, "--format", "json", "--problems", "1-6", "--out", kept, "--quiet").exit_code == 0
    same = invoked("diff", file, kept, "--check")
    assert (same.exit_code, same.output.strip()) == (0, "ziegler: no change")
    content = json.loads((kept / "results.json").read_text(encoding="utf-8"))
    content["linearisation"]["K"][0][0] = "2*k + l*P"
    (kept / "results.json").write_text(json.dumps(content), encoding="utf-8")
    changed = invoked("diff", file, kept, "--check", code=1)
    assert "linear form K [theta1, theta1]: B - A = 2*l*P" in changed.output
    assert invoked("diff", file, kept).exit_code == 0
    told = json.loads(invoked("diff", file, kept / "results.json", "--check", "--json").output)
    assert list(Draft202012Validator(schema("diff")).iter_errors(told)) == []
    assert told["systems"][0]["changes"][0]["difference"] == "2*l*P"


def test_folders_are_compared_system_by_system(tmp_path: Path) -> None:
    folder = tmp_path / "systems"
    folder.mkdir()
    for name in ("ziegler", "simple-pendulum"):
        (folder / f"{name}.yaml").write_text((SHIPPED / f"{name}.yaml").read_text(encoding="utf-8"), encoding="utf-8")
    kept = tmp_path / "kept"
    assert invoked("run", folder, "--format", "json", "-p", "1-5", "--out", kept, "--quiet").exit_code == 0
    assert invoked("diff", folder, kept, "--check").exit_code == 0
    (folder / "simple-pendulum.yaml").unlink()
    done = invoked("diff", folder, kept, "--check", code=1)
    assert "simple-pendulum: only in B" in done.output
    assert "ziegler: no change" in done.output


@pytest.mark.parametrize(
    "content", ["{", "[]", '{"format": 2, "coordinates": []}', '{"coordinates": []}', "[" * 100_000]
)
def test_what_cannot_be_read_is_code_2(content: str, tmp_path: Path) -> None:
    bad = filed(tmp_path / "results.json", content)
    for pair in ((bad, SHIPPED / "ziegler.yaml"), (SHIPPED / "ziegler.yaml", bad), (tmp_path / "none", bad)):
        done = invoked("diff", *pair, code=2)
        assert "internal error" not in done.output


def test_a_description_with_errors_is_code_2(tmp_path: Path) -> None:
    bad = filed(tmp_path / "bad.yaml", "mbsym: 1\nname: nothing\n")
    assert invoked("diff", bad, SHIPPED / "ziegler.yaml", "--check").exit_code == 2


WHOLE = """
mbsym: 1
name: pushed
parameters: {m: positive, l: positive, g: positive, c: positive, k: positive}
tables: {push: {points: [[0, 1], [1, 5/2]]}}
bodies: [{name: rod, attached to: 0, rotation: {axes: [3], angles: [theta]}, mass centre: [0, -l, 0], mass: m}]
loads: [{uniform gravity: {acceleration: g, direction: [0, -1, 0]}}, {generalized force: {theta: c*push(t)}}]
relations: {k: g*c}
assumptions: [l < 2]
claims: [{claim: condition, that: k < m, as: sufficient, place: (1)}]
"""


@pytest.mark.parametrize(
    ("before", "after", "path"),
    [
        ("5/2", "7/2", ("tables", "push", "points")),
        ("g*c", "g*c**2", ("relations", "k")),
        ("l < 2", "l < 3", ("assumptions", "1", "right")),
        ("l < 2", "l > 2", ("assumptions", "1", "relation")),
        ("as: sufficient", "as: necessary", ("claims", "(1), condition k < m", "role")),
    ],
)
def test_what_a_description_says_is_part_of_what_is_compared(before: str, after: str, path: tuple[str, ...]) -> None:
    # No formula of these results changes, but what they are about does: it is not the same.
    found = diff(results(WHOLE), results(WHOLE.replace(before, after)))
    assert not found.same
    assert all(change.path[: len(path)] == path for change in found.changes)


def test_an_assumption_that_is_written_otherwise_is_no_change() -> None:
    assert diff(results(WHOLE), results(WHOLE.replace("l < 2", "l < 4/2"))).same


TABULATED = """
mbsym: 1
name: pushed
parameters: {PARAMETERS}
tables: {push: {points: [[0, 1], [1, 5/2], [2, 3]], SHAPE}}
bodies: [{name: car, attached to: 0, mass: m, connection point: [x, 0, 0], coordinates: [x]}]
loads: [{generalised force: {x: k*push(FIRST) + m*l*x}}]
motion: {x: 0}
"""


@pytest.mark.parametrize("shape", ["between: cubic, outside: extrapolate", "outside: zero", "outside: hold"])
def test_formulas_with_tables_are_compared_like_others(shape: str) -> None:
    def of(parameters: str, first: str) -> dict[str, Any]:
        text = TABULATED.replace("SHAPE", shape).replace("PARAMETERS", parameters).replace("FIRST", first)
        return results(text)

    one = of("m: positive, k: positive, l: positive", "m*x + l")
    # The same in another order of declaration: sums and products are printed in another order.
    found = diff(one, of("l: positive, m: positive, k: positive", "l + x*m"))
    assert [(change.path, change.kind) for change in found.changes] == [(("parameters",), Kind.ORDER)]
    assert ("equations", "forcing", "x") in found.restated
    # Elsewhere in the table: k (push(m x + 2 l) - push(m x + l)) is not zero.
    forced = [
        x for x in diff(one, of("m: positive, k: positive, l: positive", "m*x + 2*l")).changes if "forcing" in x.path
    ]
    assert [change.kind for change in forced] == [Kind.FORMULA]


@pytest.mark.parametrize(
    ("before", "after", "path"),
    [
        ("{c: 1}", "{c: 2}", ("small_parameter", "powers", "c")),
        ("powers: {c: 1}", "powers: {g: 1}", ("small_parameter",)),
    ],
)
def test_what_is_small_is_part_of_what_is_compared(before: str, after: str, path: tuple[str, ...]) -> None:
    # Problem 12 is not among these results, but what it expands in is another parameter, or power: it is not the same.
    text = WHOLE.replace("claims:", "small parameter: {eps: {powers: {c: 1}}}\nclaims:").replace(
        "relations: {k: g*c}\n", ""
    )
    found = diff(results(text), results(text.replace(before, after)))
    assert not found.same
    assert all(change.path[: len(path)] == path for change in found.changes)


def test_a_body_that_is_called_like_a_property_keeps_its_name(tmp_path: Path) -> None:
    """A body "energy" was not said at all, a parameter "motion" called the unperturbed motion."""
    text = (SHIPPED / "double-pendulum.yaml").read_text(encoding="utf-8").replace("second rod", "energy")
    text = re.sub(r"\bl2\b", "motion", text)
    for name, point in (("a", "[0, -l1, 0]"), ("b", "[0, -2*l1, 0]")):
        changed = text.replace("connection point: [0, -l1, 0]", f"connection point: {point}")
        changed = changed if name == "a" else changed.replace("motion: 1", "motion: 2")
        (tmp_path / f"{name}.yaml").write_text(changed, encoding="utf-8")
    lines = invoked("diff", tmp_path / "a.yaml", tmp_path / "b.yaml").output.splitlines()
    assert any(line.startswith("  * energy velocity of the mass centre [1]: ") for line in lines), lines
    assert any(line.startswith("  * parameter motion value: ") for line in lines), lines
