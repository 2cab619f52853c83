"""Forms of what is neither a line nor an item: each field changes its place of the text, and nothing else."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import windows
import yaml
from windows import Window, serving

browser, opened = windows.browser, windows.opened
TEXT = """mbsym: 1
name: Everything
parameters: [m, l, g]   # a list of names
tables:
  push: {points: [[0, 0], [1, 2.5], [2, 1]], between: cubic}   # measured
bodies:
  - name: crank
    rotation: {axes: [3], angles: [q]}
    mass centre: [0, -l, 0]
    mass: m
    shapes: [{cylinder: [l/20, l], at: [0, -l/2, 0]}]
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - torque: {body: crank, components: [0, 0, push(t)], axes: 0}
limits: {q: [-pi, pi]}
initial: {q: 0.3}
claims:
  - {claim: kinetic energy, equals: m*l**2*q_dot**2/2}
"""

MATRICES = """mbsym: 1
name: Two masses
parameters: {k: positive, e: positive}
linear system:
  coordinates: [x, y]
  K: [[2*k, -k], [-k, k]]
"""


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Path]]:
    path = tmp_path_factory.mktemp("forms") / "system.yaml"
    path.write_text(TEXT, encoding="utf-8")
    with serving(path) as address:
        yield address, path


def test_tables_limits_states_turns_and_the_small_parameter_are_fields(
    served: tuple[str, Path], opened: Callable[..., Window]
) -> None:
    window = opened(*served)
    window.form_of("System")
    window.field("Table push, point 2: value", "3")
    window.field("Table push: outside", "zero")
    window.add("Add a point to push", {"argument": "3", "value": "0"})
    window.field("Limits of q: greatest", "pi/2")
    window.field("m: meaning", "mass of the rod")
    window.add("Add a number to state of claim 1", {"name": "q_dot", "number": "1.5"})
    window.add("Add a small parameter", {"name": "eps", "stands in": "g", "power": "2"})
    window.field("Power of eps in g", "1")
    window.add("Add limits of a coordinate", {"coordinate": "q_dot", "least": "-1", "greatest": "1"})
    window.body("crank").click()
    window.form_of("Body")
    window.field("shape 1: Rotation axis 1", "1")
    window.field("shape 1: Rotation angle 1", "pi/2")
    window.form_of("System")
    wanted = yaml.load(TEXT, yaml.BaseLoader)
    wanted["tables"]["push"] = {
        "points": [["0", "0"], ["1", "3"], ["2", "1"], ["3", "0"]],
        "between": "cubic",
        "outside": "zero",
    }
    wanted["parameters"] = {"m": {"meaning": "mass of the rod"}, "l": "real", "g": "real"}
    wanted["limits"] = {"q": ["-pi", "pi/2"], "q_dot": ["-1", "1"]}
    wanted["claims"][0]["state"] = {"q_dot": "1.5"}
    wanted["small parameter"] = {"eps": {"powers": {"g": "1"}}}
    wanted["bodies"][0]["shapes"][0]["rotation"] = {"axes": ["1", "0", "0"], "angles": ["pi/2", "0", "0"]}
    text = window.text
    assert yaml.load(text, yaml.BaseLoader) == wanted
    assert "# measured" in text
    # What is deleted or moved by a key leaves the focus where one was.
    window.page.get_by_label("Move load 2 up").press("Enter")
    window.settled()
    assert window.page.evaluate("document.activeElement.closest('#form') !== null")
    window.page.get_by_label("Delete load 2").press("Enter")
    window.told("load 2 deleted")
    assert window.page.evaluate("document.activeElement.closest('#form') !== null")
    while window.page.locator("#do-undo").is_enabled():
        window.page.locator("#do-undo").click()
        window.settled()
    assert window.text == TEXT


def test_matrices_are_fields_where_there_are_no_bodies(served: tuple[str, Path], opened: Callable[..., Window]) -> None:
    served[1].write_text(MATRICES, encoding="utf-8")
    window = opened(*served)
    window.field("Matrix K, row 1, column 2", "-2*k")  # the form of the system, as there is no body
    window.add("Add a matrix", {"matrix": "D"})
    window.field("Matrix D, row 2, column 2", "e")
    window.add("Add a matrix", {"matrix": "G"})
    window.field("Matrix G, row 1, column 2", "e - 1")
    assert yaml.load(window.text, yaml.BaseLoader)["linear system"] == {
        "coordinates": ["x", "y"],
        "K": [["2*k", "-2*k"], ["-2*k", "k"]],  # symmetric: both places
        "D": [["0", "0"], ["0", "e"]],
        "G": [["0", "e - 1"], ["-(e - 1)", "0"]],
    }
    assert window.complaints == []
    assert "by its matrices" in window.page.locator("#graph .hint").inner_text()
