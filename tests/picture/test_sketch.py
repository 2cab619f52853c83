"""The drawing of a system: what stands where, by hand; letters apart; one drawing in every medium."""

from __future__ import annotations

import re
from itertools import combinations
from math import cos, dist, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mbsym.source
from mbsym.formulas.latex import LatexNames
from mbsym.formulas.mathml import MathNames
from mbsym.picture import lettering, picture
from mbsym.picture.looking import principal, projection
from mbsym.picture.outlined import hull, outlined
from mbsym.picture.program import Varied
from mbsym.picture.sketch import Dot, Film, Sketch, Stroke, sketch
from mbsym.picture.values import View
from mbsym.report.html.writer import Writer as HtmlWriter
from mbsym.report.language import Language
from mbsym.report.latex.labels import Form, Labels
from mbsym.report.latex.writer import Writer as LatexWriter
from mbsym.report.plain_writer import Writer as PlainWriter
from mbsym.report.sections.summary import drawing

SYSTEMS = sorted((Path(__file__).parents[2] / "systems").glob("*.yaml"))
CASES = sorted((Path(__file__).parents[1] / "cases").glob("*/*.yaml"))
FRONT = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def drawn(text: str) -> Sketch:
    found = sketch(mbsym.loads(text).system)
    assert found is not None
    return found


def strokes(found: Sketch, of: str) -> list[Stroke]:
    return [x for x in found.marks if isinstance(x, Stroke) and x.of == of]


def stroke(found: Sketch, of: str) -> Any:
    """The points of the only line that is that."""
    (one,) = strokes(found, of)
    return np.array(one.points)


def letters(found: Sketch) -> set[str]:
    return {str(x.text) if isinstance(x.text, int) else mbsym.expressions.tree.text(x.text) for x in found.letters}


PENDULUM = """mbsym: 1
name: pendulum
parameters: {m: positive, l: positive, g: positive, k: positive}
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [theta]}, mass centre: [0, -l, 0], mass: m}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - spring: {coordinate: theta, stiffness: k}
motion: {theta: 0}
"""


def test_a_pendulum_hangs_at_its_angle() -> None:
    """At theta = 1.2 from the downward vertical, e2 = (-sin, cos): the mass centre is at l (sin theta, -cos theta)."""
    found = drawn(PENDULUM + "values: {m: 1, l: 2, g: 9.8, k: 1}\ninitial: {theta: 1.2}\n")
    assert found.at == (("theta", 1.2),)
    joint, end = stroke(found, "rod")
    along = (end - joint) / np.linalg.norm(end - joint)
    assert along == pytest.approx([sin(1.2), -cos(1.2)])
    zero = stroke(found, "zero: theta")
    assert zero[0] == pytest.approx(joint)
    assert (zero[1] - joint) / np.linalg.norm(zero[1] - joint) == pytest.approx([0, -1])
    arc = stroke(found, "angle theta") - joint
    radii = np.linalg.norm(arc, axis=1)
    assert radii == pytest.approx(np.full(len(arc), radii[0]))
    assert arc[0] / radii[0] == pytest.approx([0, -1])
    assert arc[-1] / radii[0] == pytest.approx(along)
    assert strokes(found, "angle theta")[0].arrow
    centre = next(x for x in found.marks if isinstance(x, Dot) and x.of == "rod")
    assert centre.place == pytest.approx(end)
    # A spring that turns with the joint is wound about it.
    assert np.max(np.linalg.norm(stroke(found, "spring: theta") - joint, axis=1)) < 0.3
    assert letters(found) >= {"theta", "l", "m", "k", "g"}
    head, tip = stroke(found, "gravity")
    assert tip - head == pytest.approx([0, -np.linalg.norm(tip - head)])


def test_what_would_not_be_seen_is_moved_and_told() -> None:
    """A small angle is drawn larger; a given one stays; nothing is to scale without a length."""
    small = drawn(PENDULUM + "values: {m: 1, l: 2, g: 9.8, k: 1}\ninitial: {theta: 0.01}\n")
    assert 0.3 < small.at[0][1] < 1
    assert small.unknown == ()
    assert drawn(PENDULUM).unknown == ("l",)
    (block,) = drawing(mbsym.loads(PENDULUM))
    assert [x.text for x in block.caption] == [
        "Drawn at [[values]].",
        "Not to scale: no value is given for $[[names]]$.",
    ]


HOOP = """mbsym: 1
name: bead
parameters: {m: positive, R: positive, g: positive, Omega: positive}
prescribed: {psi: {rate: Omega}}
bodies:
  - {name: hoop, attached to: 0, mass: 0, rotation: {axes: [3], angles: [psi]}}
  - {name: bead, attached to: hoop, mass: m, coordinates: [theta],
     connection point: [R*sin(theta), 0, -R*cos(theta)]}
loads: [{uniform gravity: {acceleration: g, direction: [0, 0, -1]}}]
motion: {theta: 0}
values: {m: 1, R: 3, g: 9.8, Omega: 2}
initial: {theta: 0.7}
"""


def test_a_hoop_is_a_hoop() -> None:
    """The bead is R (sin theta, -cos theta) from the middle, axis 3 upwards, 1 to the right; the hoop is round."""
    found = drawn(HOOP)
    hoop = stroke(found, "guide: hoop")
    middle, bead = stroke(found, "radius: theta")
    radius = np.linalg.norm(bead - middle)
    assert np.linalg.norm(hoop - middle, axis=1) == pytest.approx(np.full(len(hoop), radius))
    assert (bead - middle) / radius == pytest.approx([sin(0.7), -cos(0.7)])
    assert strokes(found, "guide: hoop")[0].closed
    axes = [stroke(found, f"axis {k}") for k in (1, 3)]
    assert [(b - a) / np.linalg.norm(b - a) for a, b in axes] == [pytest.approx([1, 0]), pytest.approx([0, 1])]
    assert not strokes(found, "bead"), "nothing like a stick"
    foot, top = stroke(found, "axis of hoop")
    assert foot[0] == pytest.approx(middle[0])
    assert top[1] > middle[1] + radius
    turn = stroke(found, "turn: psi")
    lowest = turn[np.argmin(turn[:, 1])]
    assert lowest[0] == pytest.approx(top[0], abs=0.12)
    assert turn[-1][0] > turn[0][0], "about the upward axis, in front to the right"
    assert letters(found) >= {"theta", "R", "m", "g", "psi"}


CART = """mbsym: 1
name: cart
parameters: {M: positive, m: positive, l: positive, k: positive, c: positive, g: positive}
bodies:
  - {name: cart, attached to: 0, connection point: [x, 0, 0], mass: M, coordinates: [x]}
  - {name: pole, attached to: cart, rotation: {axes: [3], angles: [a]}, mass centre: [0, l, 0], mass: m}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
  - spring: {coordinate: x, stiffness: k}
  - damper: {coordinate: x, coefficient: c}
  - force: {body: cart, point: [0, 0, 0], components: [F, 0, 0], axes: 0}
inputs: {F: {}}
values: {M: 1, m: 1, l: 1, k: 1, c: 1, g: 10}
initial: {x: 0, a: 0.6}
"""


def test_a_cart_has_wheels_on_the_ground_and_its_spring_a_wall() -> None:
    """Cart, wheels, ground in this order from above; spring and damper from the wall to it; x from where it is zero."""
    found = drawn(CART)
    box = stroke(found, "cart")
    wheels = [x for x in found.marks if isinstance(x, Dot) and x.of == "wheel of cart"]
    ground = stroke(found, "ground")
    assert len(wheels) == 2
    assert all(x.place[1] - x.radius == pytest.approx(ground[0][1]) for x in wheels)
    assert all(x.place[1] + x.radius == pytest.approx(np.min(box[:, 1])) for x in wheels)
    wall = stroke(found, "wall")
    spring, damper = stroke(found, "spring: x"), strokes(found, "damper: x")
    assert spring[0][0] == pytest.approx(wall[0][0])
    assert spring[-1][0] == pytest.approx(np.min(box[:, 0]))
    assert damper[0].points[0][0] == pytest.approx(wall[0][0])
    start, end = stroke(found, "length: x")
    joint, tip = stroke(found, "pole")
    unit = np.linalg.norm(tip - joint)  # of the length 1
    assert end[0] == pytest.approx(joint[0])
    assert (end[0] - start[0]) / unit == pytest.approx(dict(found.at)["x"])
    assert (tip - joint) / unit == pytest.approx([-sin(0.6), cos(0.6)])
    first, last = stroke(found, "force 4")
    assert last[0] > first[0] >= np.max(box[:, 0])
    assert first[1] == last[1]
    assert letters(found) >= {"M", "m", "l", "k", "x", "a", "F", "g"}


def test_a_guide_that_turns_in_time_is_no_track() -> None:
    """Of a bead on a rod that turns as prescribed nothing stands still: no ground, no cart, the spring alone."""
    turning = CART.replace("[x, 0, 0]", "[x*cos(w*t), x*sin(w*t), 0]").replace(
        "g: positive}", "g: positive, w: positive}"
    )
    turning = turning.replace("g: 10}", "g: 10, w: 1}")
    assert {body.name: body.cart for body in picture(mbsym.loads(CART).system).bodies} == {"cart": True, "pole": False}
    assert not any(body.cart for body in picture(mbsym.loads(turning).system).bodies)
    assert not strokes(drawn(turning), "ground")


WHEEL = """mbsym: 1
name: wheel
parameters: {m: positive, l: positive, g: positive, J: positive}
bodies:
  - {name: wheel, attached to: 0, mass: 0, rotation: {axes: [3], angles: [a]}, inertia about: joint, inertia: [J, J, J]}
  - {name: bob, attached to: wheel, mass: m, mass centre: [0, -l, 0]}
loads: [{uniform gravity: {vector: [0, -g, 0]}}]
values: {m: 1, l: 1, g: 10, J: 1}
initial: {a: 1}
"""


def test_a_film_is_as_large_as_what_is_seen_in_it() -> None:
    """The size of an ellipsoid that has only proportions is not one that could be seen."""
    units = []
    for inertia in ("1", "10000"):
        system = mbsym.loads(WHEEL.replace("J: 1}", f"J: {inertia}}}")).system
        film = Film(picture(system), system, [0.0, 1.0], {"a": [1.0, -1.0]})
        units.append(film.unit)
    assert units[0] == units[1]


def test_a_spring_between_points_and_a_follower_force() -> None:
    """The spring from (0, 0) to (a, b) goes along that; a force into a rod comes from outside."""
    found = drawn(
        """mbsym: 1
name: between
parameters: {m: positive, l: positive, k: positive, P: positive}
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [q]}, mass centre: [l, 0, 0], mass: m}
loads:
  - spring: {between: [{body: rod, point: [l, 0, 0]}, {body: 0, point: [0, 2*l, 0]}], stiffness: k, length: l}
  - force: {body: rod, point: [l, 0, 0], components: [-P, 0, 0], axes: rod}
values: {m: 1, l: 2, k: 1, P: 1}
initial: {q: 0.4}
"""
    )
    joint, end = stroke(found, "rod")[:2] if len(strokes(found, "rod")) == 1 else strokes(found, "rod")[0].points
    unit = dist(joint, end) / 2
    spring = stroke(found, "load 1")
    assert spring[0] == pytest.approx(end)
    assert (spring[-1] - np.array(joint)) / unit == pytest.approx([0, 4])
    tail, tip = stroke(found, "force 2")
    assert (tip - tail) / dist(tip, tail) == pytest.approx([-cos(0.4), -sin(0.4)])
    assert dist(tip, end) < dist(tail, end)
    assert dist(tail, joint) > dist(end, joint)


@pytest.mark.parametrize("path", ["gyroscopic-pair", "kirchhoff"])
def test_nothing_is_drawn_of_what_has_no_extent(path: str) -> None:
    """Of matrices, and of a body at a point of whose inertia only the proportions are those of a body."""
    analysis = mbsym.load(SYSTEMS[0].with_stem(path))
    assert sketch(analysis.system) is None
    assert drawing(analysis) == ()


def test_outlines_by_hand() -> None:
    """A sphere is a circle; an ellipsoid along an axis has the other two; a cube along its diagonal is a hexagon."""
    ball, _ = outlined("sphere", (2.0,), (1.0, 5.0, 0.0), FRONT, FRONT)
    assert [dist(x, (1.0, 5.0)) for x in ball] == pytest.approx([2.0] * len(ball))
    oval, edges = outlined("ellipsoid", (3.0, 1.0, 2.0), (0.0, 0.0, 0.0), FRONT, FRONT)
    assert [(x / 3) ** 2 + y**2 for x, y in oval] == pytest.approx([1.0] * len(oval))
    assert len(edges) == 2, "the ellipse in the plane of the paper is the outline itself"
    diagonal = projection(View((0.0, 0.0, 1.0), 45.0, np.degrees(np.arctan(1 / sqrt(2))), False))
    hexagon, edges = outlined("box", (1.0, 1.0, 1.0), (0.0, 0.0, 0.0), FRONT, diagonal)
    assert len(hexagon) == 6
    assert [dist(x, (0.0, 0.0)) for x in hexagon] == pytest.approx([sqrt(2 / 3)] * 6)
    assert len(edges) == 3
    assert all(dist(edge[0], (0.0, 0.0)) < 1e-9 for edge in edges), "the three that meet at the nearest corner"
    front = ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))  # along the first axis: the side of a lying disc
    side, rims = outlined("cylinder", (1.0, 4.0), (0.0, 0.0, 0.0), FRONT, front)
    assert rims == ()
    xs, ys = zip(*side, strict=True)
    assert (min(xs), max(xs), min(ys), max(ys)) == pytest.approx((-1, 1, -2, 2))
    assert hull([(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0.5)]) == ((0, 0), (1, 0), (1, 1), (0, 1))


def test_principal_axes() -> None:
    """Of diag(2, 1, 3) turned by 0.3 about the third axis: 1, 2, 3 about what was turned; NumPy agrees elsewhere."""
    c, s = cos(0.3), sin(0.3)
    turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    moments, rows = principal((turn.T @ np.diag([2.0, 1.0, 3.0]) @ turn).tolist())
    assert moments == pytest.approx((1, 2, 3))
    assert abs(np.dot(rows[1], turn[0])) == pytest.approx(1)
    assert np.linalg.det(np.array(rows)) == pytest.approx(1)
    source = np.random.default_rng(3)
    for _ in range(20):
        any_ = source.normal(size=(3, 3))
        tensor = any_ @ any_.T
        moments, rows = principal(tensor.tolist())
        assert moments == pytest.approx(np.linalg.eigvalsh(tensor))
        assert np.array(rows).T @ np.diag(moments) @ np.array(rows) == pytest.approx(tensor)


def overlapping(found: Sketch) -> list[tuple[Any, Any]]:
    """Letters less than the height of one apart, and less than the widths of both."""
    boxes = [(x.text, x.place) for x in found.letters]
    return [
        (a, b)
        for (a, p), (b, q) in combinations(boxes, 2)
        if abs(p[0] - q[0]) < lettering.FIRST and abs(p[1] - q[1]) < 0.9 * lettering.HIGH
    ]


@pytest.mark.parametrize("path", [*SYSTEMS, *CASES], ids=lambda path: path.stem)
def test_every_system_is_drawn_on_its_paper(path: Path) -> None:
    """Everything is inside of the box, no letter upon another, and numbers without NumPy are those with it."""
    system, _ = mbsym.source.read(path.read_text(encoding="utf-8"), str(path))
    found = None if system is None else sketch(system)
    if system is None or found is None:
        return
    for mark in found.marks:
        for x, y in mark.points if isinstance(mark, Stroke) else [mark.place]:
            assert found.low[0] - 0.2 <= x <= found.high[0] + 0.2
            assert found.low[1] - 0.2 <= y <= found.high[1] + 0.2
    assert found.high[0] - found.low[0] < 12
    assert found.high[1] - found.low[1] < 9
    assert not overlapping(found)
    program = picture(system).program
    state = {name: 0.1 * (k + 1) for k, name in enumerate(program.inputs)}
    with_it = [float(x) for x in program.evaluate(state)]
    assert program.at(state) == pytest.approx(with_it, nan_ok=True, rel=1e-9, abs=1e-9)
    for name in program.inputs:
        some = Varied(program, program.at(state), {name: 0.7, "no input": 1.0})
        whole = program.at(state | {name: 0.7})
        backwards = [some[k] for k in reversed(range(len(some)))]
        assert backwards[::-1] == pytest.approx(whole, nan_ok=True, rel=0, abs=0)


def test_letters_upon_each_other_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: letters do not know of each other."""
    found = lettering.Letters[str]()
    for what in "ab":
        found.add(what, what, (0.0, 0.0), (0.0, 1.0), 0.1)
    first, second = found.placed()
    assert dist(first[1], second[1]) > 0.2
    monkeypatch.setattr(lettering, "_meet", lambda *given: False)
    found = lettering.Letters[str]()
    for what in "ab":
        found.add(what, what, (0.0, 0.0), (0.0, 1.0), 0.1)
    first, second = found.placed()
    assert first[1] == second[1]


def test_one_drawing_in_every_medium() -> None:
    """As many lines and letters in TikZ and SVG as there are; a terminal has none."""
    analysis = mbsym.loads(CART)
    (block,) = drawing(analysis)
    found, language = block.drawn, Language("ru")
    tex = LatexWriter(LatexNames.of(analysis.ring), language, Labels("x:"), Form.REPORT).block(block)
    html = str(HtmlWriter(MathNames.of(analysis.ring), language).block(block))
    lines = [x for x in found.marks if isinstance(x, Stroke)]
    dots = [x for x in found.marks if isinstance(x, Dot)]
    assert len(re.findall(r"<path class=\"(?!tip)", html)) == len(lines)
    assert html.count("<circle") == len(dots)
    assert html.count("<foreignObject") == tex.count(" node {$") == len(found.letters)
    assert tex.count(" circle (") == len(dots)
    drawn_lines = [x for x in lines if not x.smooth]
    assert tex.count(" -- ") == sum(len(x.points) - 1 + x.closed for x in drawn_lines)
    assert tex.count("plot[smooth") == len(lines) - len(drawn_lines)
    assert "Изображена при" in tex
    assert "Изображена при" in html
    assert list(PlainWriter().document([block])) == []
    assert sum(x.arrow for x in lines) == len(re.findall("marker-end", html))
