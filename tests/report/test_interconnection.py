"""The layout of the bodies' tree: every body once, every joint drawn, nothing over anything else, within a page."""

import json
import re
from itertools import combinations
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import mbsym
from mbsym.formulas.latex import LatexNames
from mbsym.model.system import System
from mbsym.report.code.interconnection import MOST_COLUMNS, MOST_ROWS, Interconnection, Kind, interconnection
from mbsym.report.latex.report import diagram
from mbsym.report.targets import TARGETS
from tests.conftest import SHIPPED, compiled_latex, needs_pdflatex


def tree(parents: list[int]) -> System:
    """Body k attached to body parents[k - 1] by a turn about its third axis."""
    bodies = [
        {
            "name": f"b{k}",
            "attached to": f"b{parent}" if parent else "0",
            "rotation": {"axes": [3], "angles": [f"q{k}"]},
            "connection point": ["l", "0", "0"],
            "mass": "m",
        }
        for k, parent in enumerate(parents, start=1)
    ]
    text = json.dumps({"mbsym": "1", "name": "tree", "parameters": ["l", "m"], "bodies": bodies})
    return mbsym.loads(text, ()).system


def laid_out(parents: list[int], most_rows: int = MOST_ROWS, most_columns: int = MOST_COLUMNS) -> Interconnection:
    """The layout, after everything that must hold of each was checked."""
    found = interconnection(tree(parents), most_rows, most_columns)
    own = [node.number for node in found.nodes if not node.repeated]
    assert sorted(own) == list(range(len(parents) + 1))
    drawn = {(found.nodes[j.before].number, found.nodes[j.after].number) for j in found.joints}
    assert drawn == {(parent, k) for k, parent in enumerate(parents, start=1)}
    assert len(found.joints) == len(parents)
    places = [(node.column, node.row) for node in found.nodes]
    for (x, y), (u, v) in combinations(places, 2):
        assert y != v or abs(x - u) >= 1
    assert all(0 <= x <= found.columns - 1 and 0 <= y <= found.rows - 1 for x, y in places)
    assert found.columns <= most_columns
    lines = [(found.nodes[j.before], found.nodes[j.after]) for j in found.joints]
    assert all(after.row == before.row + 1 for before, after in lines)
    for (a, b), (c, d) in combinations(lines, 2):  # between two rows, lines keep the order of their ends
        if a.row == c.row:
            assert (a.column - c.column) * (b.column - d.column) >= 0
    return found


def test_bodies_of_the_published_satellite() -> None:
    # Banshchikov & Vetrov, section 3: the orbital frame, on it the satellite, on it the rod, at its end a point mass.
    found = interconnection(mbsym.load(SHIPPED / "satellite.yaml", ()).system)
    assert [(n.number, n.kind, n.column, n.row) for n in found.nodes] == [
        (0, Kind.INERTIAL, 0, 0),
        (1, Kind.FRAME, 0, 1),
        (2, Kind.BODY, 0, 2),
        (3, Kind.BODY, 0, 3),
        (4, Kind.BODY, 0, 4),
    ]
    joint = found.joints[1]
    assert [axis for axis, _ in joint.turns] == [2, 3, 1]
    assert joint.coordinates == ("psi", "theta", "phi")
    assert [joint.slides for joint in found.joints] == [True, False, False, False]


def test_carrier_stands_above_the_middle() -> None:
    found = laid_out([0, 1, 1, 1, 2])
    assert {node.number: (node.column, node.row) for node in found.nodes} == {
        0: (1, 0), 1: (1, 1), 2: (0, 2), 3: (1, 2), 4: (2, 2), 5: (0, 3)
    }  # fmt: skip


def test_chain_of_sixty_is_folded() -> None:
    found = laid_out(list(range(60)))
    assert found.rows <= MOST_ROWS
    assert [node.number for node in found.nodes if node.repeated] == [10, 20, 30, 40, 50]


def test_star_of_forty_is_cut_to_the_width_of_a_page() -> None:
    found = laid_out([0] * 40)
    assert found.rows <= MOST_ROWS
    assert {node.number for node in found.nodes if node.repeated} == {0}


@given(st.data(), st.integers(1, 40), st.integers(2, 6), st.integers(2, 6))
def test_any_tree(data: st.DataObject, count: int, most_rows: int, most_columns: int) -> None:
    parents = [data.draw(st.integers(0, k)) for k in range(count)]
    laid_out(parents, most_rows, most_columns)


def test_loads_between_bodies() -> None:
    system = mbsym.loads(
        """
mbsym: 1
name: two
parameters: [m, l, k]
bodies:
  - {name: a, attached to: 0, rotation: {axes: [3], angles: [x]}, mass centre: [l, 0, 0], mass: m}
  - {name: b, attached to: 0, rotation: {axes: [3], angles: [y]}, mass centre: [l, 0, 0], mass: m}
loads:
  - spring: {between: [{body: a, point: [l, 0, 0]}, {body: b, point: [l, 0, 0]}], stiffness: k, length: 0}
  - torque: {body: b, components: [0, 0, k], axes: 0, reaction on: a}
  - torque: {body: b, components: [0, 0, k], axes: 0}
""",
        (),
    ).system
    found = interconnection(system)
    pairs = [(found.nodes[i.first].name, found.nodes[i.second].name, i.kind) for i in found.interactions]
    assert pairs == [("a", "b", "spring"), ("a", "b", "torque")]


def test_planted_overlap_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    from mbsym.report.code import interconnection as module

    monkeypatch.setattr(module, "_places", lambda strip: {k: (0.0, n) for n, k in enumerate(strip.children)})
    with pytest.raises(AssertionError):
        laid_out([0, 0, 0], 4)


@needs_pdflatex
@pytest.mark.parametrize("width", [15.0, 7.6])
def test_pictures_of_long_and_wide_trees_fit_their_page(width: float, tmp_path: Path) -> None:
    fingers = [0, 1, 2, 3, 4, 5, 3, 7, 8, 9, 10, 10, 10, 10, 10, 3, 16, 17, 18, 19, 19, 19, 19, 19, 1, 25, 26, 27, 28]
    humanoid = [*fingers, 1, 30, 31, 32, 33, 6, 6, 35, 36, 29, 34]
    systems = [tree(parents) for parents in (list(range(60)), humanoid, [0] * 40, [0, 1, 1, 1, 2, 3, 4])]
    pictures = [diagram(one, LatexNames(one.coordinates), str, "inertial frame", width) for one in systems]
    box = "\\newbox\\held\n"
    sizes = "".join(
        f"\\setbox\\held=\\hbox{{{picture}}}\\typeout{{size \\the\\wd\\held, \\the\\ht\\held}}\n"
        for picture in pictures
    )
    text = (
        f"\\documentclass{{article}}\\usepackage{{amsmath,tikz}}\\begin{{document}}\n{box}{sizes}x\\end{{document}}\n"
    )
    log = compiled_latex(text, tmp_path)
    found = re.findall(r"size ([\d.]+)pt, ([\d.]+)pt", log)
    assert len(found) == 4
    for across, down in found:
        assert float(across) / 28.45 <= width + 1
        assert 2 < float(down) / 28.45 <= 19


def test_a_coordinate_inside_an_angle_is_not_told_again() -> None:
    """The tethers turn by theta2 + alpha2 - theta1 - alpha1: neither theta2 nor alpha2 is a coordinate besides."""
    system = mbsym.load(SHIPPED / "tethered-satellites.yaml").system
    joints = interconnection(system).joints
    assert [joint.others for joint in joints] == [("x_A", "y_A"), (), (), ()]
    text = TARGETS["latex"].render(mbsym.load(SHIPPED / "tethered-satellites.yaml"), (1,))
    assert "{$3\\colon -\\alpha_{2}$}" in text
