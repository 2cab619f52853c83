"""What an editor is told at a cursor: keys of the right mapping, names, meanings, derived quantities."""

from __future__ import annotations

import re

import pytest
from conftest import system_of

import mbsym
from mbsym.analysis import Analysis
from mbsym.editing import explanation, suggestions
from mbsym.editing.completion import keys_in
from mbsym.editing.hover import _name
from mbsym.source import read
from mbsym.source.keys import BODY, CLAIM, LOADS, MOTION, PARAMETER, POINT, PRESCRIBED, ROTATION, SYSTEM

TEXT = """mbsym: 1
name: Pendulum on a cart
parameters:
  m: {sign: positive, meaning: mass of the bob}
  l: positive
  g: positive
prescribed:
  chi: {rate: g/l}
bodies:
  - name: cart
    attached to: 0
    connection point: [x, 0, 0]
    mass: m
    coordinates: [x]
  - name: bob
    attached to: cart
    rotation: {axes: [3], angles: [theta]}
    mass centre: [0, -l, 0]
    mass: m
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - damper: {coordinate: theta, coefficient: m}
motion: {x: 0, theta: 0}
"""


def at(marked: str) -> tuple[str, int, int]:
    """A text without its ``|``, and where that stood."""
    before, _, after = marked.partition("|")
    return before + after, before.count("\n"), len(before) - before.rfind("\n") - 1


def labels(marked: str, kind: str | None = None) -> list[str]:
    system, _ = read(TEXT, "x.yaml")
    text, line, column = at(marked)
    return [one.label for one in suggestions(text, line, column, system) if kind in (None, one.kind)]


def replaced(old: str, new: str) -> str:
    assert old in TEXT
    return TEXT.replace(old, new, 1)


@pytest.mark.parametrize(
    ("marked", "keys"),
    [
        (TEXT + "|", SYSTEM),
        (TEXT + "lo|", SYSTEM),
        (replaced("    mass: m\n    coordinates", "    |\n    mass: m\n    coordinates"), BODY),
        (replaced("  - name: bob", "  - |\n  - name: bob"), BODY),
        (replaced("{axes: [3], angles: [theta]}", "{axes: [3], |}"), ROTATION),
        (replaced("{sign: positive, meaning: mass of the bob}", "{sign: positive, |}"), PARAMETER),
        (replaced("{rate: g/l}", "{|}"), PRESCRIBED),
        (TEXT + "initial:\n  x: {position: 1, |}\n", {"position": "", "velocity": ""}),
        (replaced("{x: 0, theta: 0}", "{x: {|}}"), MOTION),
        (replaced("  - damper:", "  - |\n  - damper:"), LOADS),
        (replaced("{coordinate: theta, coefficient: m}", "{|}"), LOADS["damper"].keys),
        (replaced("{coordinate: theta, coefficient: m}", "{between: [{|"), POINT),
        (TEXT + "claims:\n  - claim: kinetic energy\n    |\n", CLAIM),
    ],
)
def test_keys_are_those_of_the_mapping(marked: str, keys: dict[str, str]) -> None:
    found = labels(marked, "key")
    assert set(found) <= set(keys_of_everything())
    assert set(keys) - set(found) <= set(beside(marked)), (found, list(keys))


def keys_of_everything() -> set[str]:
    paths = [(), ("bodies",), ("bodies", "rotation"), ("loads",), ("claims",), ("loads", "x", "between")]
    paths += [(section, "x") for section in ("parameters", "prescribed", "motion", "initial")]
    return {key for path in paths for key in keys_in(path)} | {key for kind in LOADS.values() for key in kind.keys}


def beside(marked: str) -> list[str]:
    """Keys that stand there already need not be offered."""
    return [line.split(":")[0].strip(" -") for line in marked.replace("|", "").split("\n")]


def test_keys_that_are_there_are_not_offered_again() -> None:
    found = labels(replaced("    mass: m\n    coordinates", "    |\n    mass: m\n    coordinates"), "key")
    assert "inertia" in found
    assert not {"mass", "name", "attached to", "coordinates"} & set(found)


@pytest.mark.parametrize(
    ("marked", "wanted", "unwanted"),
    [
        (replaced("mass: m\n    coordinates", "mass: |\n    coordinates"), {"m", "l", "g", "sin", "pi"}, {"x_dot"}),
        (replaced("attached to: cart", "attached to: |"), {"0", "cart", "bob"}, {"m"}),
        (replaced("coefficient: m", "coefficient: |"), {"m", "theta_dot"}, set()),
        (replaced("coordinate: theta", "coordinate: |"), {"x", "theta"}, {"m"}),
        (replaced("  l: positive", "  l: |"), {"positive", "nonzero"}, {"m"}),
        (TEXT + "claims:\n  - claim: |\n", {"kinetic energy", "mass matrix"}, {"m"}),
        (replaced("mass of the bob", "|"), set(), {"m", "sin"}),
        (replaced("{x: 0, theta: 0}", "\n  |"), {"x", "theta"}, {"m"}),
    ],
)
def test_values_are_what_may_stand_there(marked: str, wanted: set[str], unwanted: set[str]) -> None:
    found = set(labels(marked))
    assert wanted <= found
    assert not unwanted & found


def test_claims_about_oscillations_name_their_symbols() -> None:
    small = TEXT.replace("bodies:", "small parameter: {eps: {powers: {m: 1}}}\nbodies:", 1)
    claim = "claims:\n  - claim: oscillation\n    equals: |\n"
    names = [
        {one.label for one in suggestions(*at(text + claim), read(text, "x.yaml")[0])}
        & {"amplitude", "phase", "theta_0"}
        for text in (small, TEXT)
    ]
    assert names == [{"amplitude", "phase", "theta_0"}, set()]


def test_without_a_system_the_declared_names_are_found() -> None:
    text, line, column = at(replaced("    mass: m\n    coordinates", "    mass: |\n    coordinates"))
    found = {one.label for one in suggestions(text, line, column) if one.kind == "name"}
    assert found == {"m", "l", "g"}


def hover(marked: str) -> str | None:
    text, line, column = at(marked)
    return explanation(text, line, column, mbsym.loads(TEXT))


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("mass centre: [0", "mass cen|tre: [0", BODY["mass centre"].meaning),
        ("{axes: [3]", "{ax|es: [3]", ROTATION["axes"].meaning),
        ("coefficient: m", "coeffi|cient: m", LOADS["damper"].keys["coefficient"].meaning),
        ("mass: m\n    coord", "mass: |m\n    coord", "mass of the bob"),
        ("angles: [theta]", "angles: [the|ta]", "a coordinate of bob"),
        ("[x, 0, 0]", "[|x, 0, 0]", "cyclic"),
        ("rate: g/l", "rate: |g/l", "positive"),
    ],
)
def test_words_are_explained(old: str, new: str, told: str) -> None:
    found = hover(replaced(old, new))
    assert found is not None
    assert told in found


def test_a_body_is_told_with_what_is_derived() -> None:
    """By hand: the bob turns by theta about the third axis, and is carried along with the cart."""
    found = hover(replaced("- name: bob", "- name: bo|b"))
    assert found is not None
    assert "angular velocity: `[0, 0, theta_dot]`" in found
    assert "x_dot*cos(theta)" in found


@pytest.mark.parametrize("text", ["", "\n\n", "{{{", "- - - ", ":", "a: [b, {c: ", "\t\tx", "parameters:\n  é: 𝒳", "#"])
def test_anything_may_be_written(text: str) -> None:
    lines = text.split("\n")
    for line, content in enumerate(lines):
        for column in range(len(content) + 1):
            suggestions(text, line, column)
            explanation(text, line, column)


def test_what_people_wrote_is_no_markdown() -> None:
    text = replaced("meaning: mass of the bob", 'meaning: "![x](http://a/b.png) <img src=y> [g](command:z) _k_ `c`"')
    system = system_of(text, "x.yaml")
    told = explanation(*at(text.replace("    mass: m", "    mass: |m", 1)), Analysis(system))
    assert told is not None
    for one in ("![", "](", "<img", "[g]", " _k"):
        assert not re.search(r"(?<!\\)" + re.escape(one), told), told


def test_a_formula_keeps_its_asterisks() -> None:
    text = replaced("rate: g/l", "rate: g*m/l*g")
    system = system_of(text, "x.yaml")
    assert "`g*m/l*g`" in (_name("chi", Analysis(system)) or "")


def test_no_place_breaks_completion() -> None:
    lines = TEXT.replace("name: Pen", "na\nme: Pen: x").split("\n")
    for number, line in enumerate(lines):
        for column in range(len(line) + 3):
            suggestions("\n".join(lines), number, column)
            suggestions("\n".join([*lines[:number], "[x", *lines[number:]]), number, column)
